"""A Geneva mechanism (the paper's section 3.4, Fig. 14–20, Tables 3 and 4).

Left open by the paper and chosen here: the crank's start angle (so that first contact is due at the paper's 0.0329
s), the wheel's rim (no locking arc takes part in the contact: as in the paper, the damper alone holds the wheel),
a bore of 8 mm, step 0.2 ms, ρ∞ = 0.8, no structural damping. The driver is its pin, an elastic disc on a rigid
crank. E is 207×10⁸ Pa as its Table 4 prints; k = 6×10⁸ N/m² without the thickness.

Eq. 41 divides by 1/φ_eff, which is no number: errors are given as a part of the index angle 2π/n, and beside it as
a part of the mean |φ_eff|.

Steps. The paper's cost has its minimum at 0.4 ms and rises beyond, as its Newton iterations grow. Here they grow too,
from 3 to 7 a step at 50 ms, but far slower than the number of steps falls, so the minimum lies there, two orders
beyond. At 0.1 s, when the whole engagement is a few steps, iterations multiply, steps are halved, and the cost rises
again; at 0.2 s the step is given up. Accuracy ends before, at 30 ms, and bounds the step, not cost (Fig. 19,
``steps``).
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from scipy.optimize import brentq

from rigidarea.cases.case_report import Array
from rigidarea.cases.rigid_level import turn
from rigidarea.flexible.body import elastic_body
from rigidarea.flexible.element import Material
from rigidarea.flexible.integrate import Record, Simulation
from rigidarea.shapes import geneva

CENTRES, PIN, CLEARANCE, THICKNESS = 0.050, 0.008, 1e-5, 0.005
STEEL = Material(207e8, 0.29, 7800.0, THICKNESS)
K, DAMPER, SPEED, STEP, RHO = 6e8, 0.1, np.pi, 2e-4, 0.8
DUE = 0.0329  # s, the paper's time of first contact
MESH = 1.0  # mm
REFINE = 16  # contact points a mesh edge: on the pin a sagitta of 0.1 µm
STEPS = (
    *(5e-5, 1e-4, 2e-4, 4e-4, 5e-4, 8e-4, 1.6e-3, 3.2e-3, 6.4e-3),
    *(0.0125, 0.025, 0.03, 0.04, 0.05, 0.1, 0.2),
)
PLAY_S = 6.4e-3  # s, in which the pin crosses the play and touches: the shortest event
PAPER: dict[str, Any] = {
    "rms_percent": 1.13,
    "contact_due_s": 0.0329,
    "contact_s": 0.0414,
    "contact_delay_ms": 8.5,
    "cheapest_step_s": 4e-4,
}


def ideal(slots: int, theta: Array) -> Array:
    """Eq. 38 and 40 with the play taken up: the wheel's angle φ_eff at crank angle θ (0 on the line of centres)."""
    r = CENTRES * np.sin(np.pi / slots)
    phi = np.arctan2(r * np.sin(theta), CENTRES - r * np.cos(theta))
    rho = np.sqrt(CENTRES**2 + r**2 - 2 * CENTRES * r * np.cos(theta))  # Eq. 37
    return phi - np.arcsin(0.5 * CLEARANCE / rho)  # Eq. 39


def first_touch(slots: int) -> float:
    """Crank angle at which the pin has used up the play and begins to turn the wheel at rest."""
    entry = 0.5 * np.pi - np.pi / slots
    rest = -np.pi / slots
    return float(brentq(lambda x: float(ideal(slots, np.array(x))) - rest, -entry, -0.5 * entry, xtol=1e-14))


def simulation(
    mode: str,
    mesh_mm: float = MESH,
    contact: str = "area",
    slots: int = 6,
    refine: int = REFINE,
    k: float = K,
    cache: Path | None = None,
) -> tuple[Simulation, float]:
    """The mechanism at rest, and the crank's start angle."""
    drive = geneva(slots, CENTRES, PIN, CLEARANCE, bore=0.004, tolerance=2e-8)
    r = drive.crank_radius
    start = first_touch(slots) - SPEED * DUE
    pin_ring = drive.pin.rings[0] - [r, 0.0]
    keys: dict[str, Any] = {"refine": refine, "modes": 30, "cache": cache}
    size = 1e-3 * mesh_mm
    at = (r * np.cos(start), r * np.sin(start))
    moves: dict[str, Any] = {"drive": (start, SPEED, 0.0), "velocity": (-SPEED * at[1], SPEED * at[0], SPEED)}
    placed: dict[str, Any] = {"position": at, "angle": start, "anchor": (0.0, 0.0)}
    pin, _ = elastic_body([pin_ring], size, STEEL, mode, **placed, **moves, **keys)
    pin.hub = (-r, 0.0)  # the crank's axis: the pin's frame is carried rigidly
    angle = drive.wheel_angle(-drive.entry_angle)
    placed = {"position": (CENTRES, 0.0), "angle": angle, "anchor": (CENTRES, 0.0)}
    wheel, _ = elastic_body(drive.wheel.rings, size, STEEL, mode, hub=1, damper=DAMPER, **placed, **keys)
    return Simulation([pin, wheel], [(0, 1)], k=k, contact=contact, reach=2e-4, margin=2e-4, rho=RHO), start


def through_hook(duration: float, slots: int = 6) -> Record:
    """The rigid level: exact arcs, through the pymunk hook."""
    drive = geneva(slots, CENTRES, PIN, CLEARANCE, bore=0.004, tolerance=2e-8)
    start = first_touch(slots) - SPEED * DUE
    density, angles = STEEL.density * THICKNESS, (start, drive.wheel_angle(-drive.entry_angle))
    parts, at = (drive.pin, drive.wheel), (CENTRES, 0.0)
    return turn(*parts, at, density, angles, lambda t: SPEED, K, DAMPER, duration, STEP)


def measure(r: Record, start: float, slots: int) -> dict[str, Any]:
    """Errors over the first engagement, delay of the first contact, index angles and drift over all dwells."""
    theta = start + SPEED * r.t
    turned = -(r.hub[:, 1] - r.hub[0, 1])  # the wheel turns against the crank
    index = 2 * np.pi / slots
    touch, entry = first_touch(slots), 0.5 * np.pi - np.pi / slots
    engaged = (theta >= touch) & (theta <= entry)
    exact = ideal(slots, theta[engaged])
    error = turned[engaged] - 0.5 * index - exact
    force = np.hypot(*r.force.T)
    contact = float(r.t[np.argmax(force > 0)])
    rms = float(np.sqrt(np.mean(error**2)))
    out: dict[str, Any] = {
        "slots": slots,
        "rms_percent": 100 * rms / index,
        "rms_mean_norm_percent": 100 * rms / float(np.abs(exact).mean()),
        "contact_delay_ms": 1e3 * (contact - (touch - start) / SPEED),
        "contact_s": contact,
        "force_max_n": float(force.max()),
        "newton_iterations_mean": float(r.iterations.mean()),
    }
    # dwells: from 20 ms after the exit to 20 ms before the next entry
    rests, drifts, n = [0.0], [], 0
    while (end := (2 * np.pi * (n + 1) - entry - start) / SPEED - 0.02) < r.t[-1]:
        dwell = (r.t > (2 * np.pi * n + entry - start) / SPEED + 0.02) & (r.t < end)
        rests.append(float(turned[dwell].mean()))
        drifts.append(float(np.ptp(turned[dwell])))
        n += 1
    if drifts:
        steps = np.diff(rests)
        later = steps[1:] if len(steps) > 1 else steps  # the first index also takes up the play, once
        out["index_angle_error_deg"] = float(np.degrees(np.abs(later - index).max()))
        out["first_index_error_deg"] = float(np.degrees(steps[0] - index))
        out["dwell_drift_deg"] = float(np.degrees(max(drifts)))
        out["dwells"] = len(drifts)
    return out | {"revolution_s": 2 * np.pi / SPEED}
