"""A Geneva mechanism (the paper's section 3.4, Fig. 15–20, Tables 3 and 4).

Left open by the paper and chosen here: the crank's start angle (so that first contact is due at the paper's 0.0329
s), the wheel's rim (no locking arc takes part in the contact: as in the paper, the damper alone holds the wheel),
a bore of 8 mm, step 0.2 ms, ρ∞ = 0.8, no structural damping. The driver is its pin, an elastic disc on a rigid
crank. E is 207×10⁸ Pa as its Table 4 prints; k = 6×10⁸ N/m² without the thickness.

Eq. 41 divides by 1/φ_eff, which is no number: errors are given as a part of the index angle 2π/n, and beside it as
a part of the mean |φ_eff|.
"""

from __future__ import annotations

import time
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rigidarea.cases import report
from rigidarea.flexible.body import elastic_body
from rigidarea.flexible.element import Material
from rigidarea.flexible.integrate import Record, Simulation
from rigidarea.shapes import geneva

Array = NDArray[np.float64]

CENTRES, PIN, CLEARANCE, THICKNESS = 0.050, 0.008, 1e-5, 0.005
STEEL = Material(207e8, 0.29, 7800.0, THICKNESS)
K, DAMPER, SPEED, STEP, RHO = 6e8, 0.1, np.pi, 2e-4, 0.8
DUE = 0.0329  # s, the paper's time of first contact
MESH = 1.0  # mm
REFINE = 16  # contact points a mesh edge: on the pin a sagitta of 0.1 µm
PAPER: dict[str, Any] = {
    "rms_percent": 1.13,
    "contact_due_s": 0.0329,
    "contact_s": 0.0414,
    "contact_delay_ms": 8.5,
}


def ideal(slots: int, theta: Array) -> Array:
    """Eq. 38 and 40 with the play taken up: the wheel's angle φ_eff at crank angle θ (0 on the line of centres)."""
    r = CENTRES * np.sin(np.pi / slots)
    phi = np.arctan2(r * np.sin(theta), CENTRES - r * np.cos(theta))
    rho = np.sqrt(CENTRES**2 + r**2 - 2 * CENTRES * r * np.cos(theta))  # Eq. 37
    return phi - np.arcsin(0.5 * CLEARANCE / rho)  # Eq. 39


def first_touch(slots: int) -> float:
    """Crank angle at which the pin has used up the play and begins to turn the wheel at rest."""
    from scipy.optimize import brentq

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
    pin, _ = elastic_body(
        [pin_ring],
        size,
        STEEL,
        mode,
        position=at,
        angle=start,
        anchor=(0.0, 0.0),
        drive=(start, SPEED, 0.0),
        velocity=(-SPEED * at[1], SPEED * at[0], SPEED),
        **keys,
    )
    pin.hub = (-r, 0.0)  # the crank's axis: the pin's frame is carried rigidly
    wheel, _ = elastic_body(
        drive.wheel.rings,
        size,
        STEEL,
        mode,
        hub=1,
        anchor=(CENTRES, 0.0),
        position=(CENTRES, 0.0),
        angle=drive.wheel_angle(-drive.entry_angle),
        damper=DAMPER,
        **keys,
    )
    return Simulation([pin, wheel], [(0, 1)], k=k, contact=contact, reach=2e-4, margin=2e-4, rho=RHO), start


def through_hook(duration: float, slots: int = 6) -> Record:
    """The rigid level: exact arcs, through the pymunk hook."""
    from rigidarea.cases.hook import turn

    drive = geneva(slots, CENTRES, PIN, CLEARANCE, bore=0.004, tolerance=2e-8)
    start = first_touch(slots) - SPEED * DUE
    return turn(
        drive.pin,
        drive.wheel,
        (CENTRES, 0.0),
        STEEL.density * THICKNESS,
        (start, drive.wheel_angle(-drive.entry_angle)),
        lambda t: SPEED,
        K,
        DAMPER,
        duration,
        STEP,
    )


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
    revolution = 2 * np.pi / SPEED
    rests, drifts = [0.0], []
    n = 0
    while (end := (2 * np.pi * (n + 1) - entry - start) / SPEED - 0.02) < r.t[-1]:
        dwell = (r.t > (2 * np.pi * n + entry - start) / SPEED + 0.02) & (r.t < end)
        rests.append(float(turned[dwell].mean()))
        drifts.append(float(np.ptp(turned[dwell])))
        n += 1
    if drifts:
        # the first index also takes up the play, once
        steps = np.diff(rests)
        out["index_angle_error_deg"] = float(
            np.degrees(np.abs((steps[1:] if len(steps) > 1 else steps) - index).max())
        )
        out["first_index_error_deg"] = float(np.degrees(steps[0] - index))
        out["dwell_drift_deg"] = float(np.degrees(max(drifts)))
        out["dwells"] = len(drifts)
    out["revolution_s"] = revolution
    return out


def run(
    mode: str = "compliant",
    mesh_mm: float = MESH,
    contact: str = "area",
    out: Path | None = None,
    cache: Path | None = None,
    duration: float = 10.0,
) -> dict[str, Any]:
    """Six slots over 10 s; then 4, 5 and 8 slots, stiffer contacts, and the sweep of steps (1 s each)."""
    clock = report.Clock()
    sim, start = simulation(mode, mesh_mm, contact, cache=cache)
    clock.setup()
    begin = time.perf_counter()
    r = through_hook(duration) if mode == "rigid" and contact == "area" else sim.run(duration, STEP)
    results: dict[str, Any] = {**measure(r, start, 6), "run_s": time.perf_counter() - begin}
    report.say("geneva: other numbers of slots")
    results["slot_numbers"] = []
    for n in (4, 5, 6, 8):
        s, a = simulation(mode, mesh_mm, contact, n, cache=cache)
        results["slot_numbers"].append(measure(s.run(4.4, STEP), a, n))
    results["stiffness"] = []
    for k in (K / 4, K, 4 * K):
        s, a = simulation("rigid", mesh_mm, contact, k=k)
        results["stiffness"].append({"k": k, **measure(s.run(1.0, STEP), a, 6)})
    report.say("geneva: steps")
    steps, histories = [], {}
    for h in (5e-5, 1e-4, 2e-4, 3e-4, 4e-4, 5e-4, 8e-4, 1.2e-3, 2.5e-3, 5e-3):
        s, a = simulation("rigid", mesh_mm, contact)
        begin = time.perf_counter()
        try:
            record = s.run(1.0, h)
        except RuntimeError as error:
            steps.append({"step_s": h, "failed": str(error)})
            continue
        # at first touch the pin closes the play within a few ms: fewer than ten steps do not resolve it
        steps.append(
            {
                "step_s": h,
                "run_s": time.perf_counter() - begin,
                "under_resolved": bool(h > RESOLVED),
                "steps_halved": int(record.halved.sum()),
                **measure(record, a, 6),
            }
        )
        if h in (2e-4, 5e-4, 8e-4):
            histories[h] = record
    results["steps"] = steps
    if out is not None:
        _figures(out, r, start, sim, results, histories)
    settings = {
        "mode": mode,
        "mesh_mm": mesh_mm,
        "contact": contact,
        "k": K,
        "damper": DAMPER,
        "step_s": STEP,
        "rho": RHO,
        "start_angle_deg": float(np.degrees(start)),
        "refine": REFINE,
    }
    return report.result("geneva", settings, results, PAPER, clock, duration)


RESOLVED = 6e-4  # s: a tenth of the 6.4 ms in which the pin crosses the play


def _figures(
    out: Path,
    r: Record,
    start: float,
    sim: Simulation,
    results: dict[str, Any],
    histories: dict[float, Record],
) -> None:
    turned = -(r.hub[:, 1] - r.hub[0, 1])
    force = np.hypot(*r.force.T)
    fig, ax = report.figure(9, 4)
    ax.plot(r.t, np.degrees(turned), color=report.BLUE)
    ax.set(xlabel="time (s)", ylabel="angle of the driven wheel (°)")
    report.save(fig, out, "geneva_fig15")
    fig, axes = report.figure(9, 6, 2, 1, sharex=True)
    first = r.t <= 1
    theta = start + SPEED * r.t[first]
    touch, entry = first_touch(6), np.pi / 3
    exact = np.where(theta < touch, 0, np.where(theta > entry, np.nan, ideal(6, theta) + np.pi / 6))
    axes[0].plot(r.t[first], np.degrees(exact), "--", color=report.BLACK, lw=2, label="φ_eff, Eq. 40")
    axes[0].plot(r.t[first], np.degrees(turned[first]), color=report.BLUE, label="ours")
    axes[0].set(ylabel="angle (°)")
    axes[0].legend()
    axes[1].plot(r.t[first], np.degrees(turned[first] - exact), color=report.RED)
    axes[1].set(xlabel="time (s)", ylabel="ours − φ_eff (°)")
    report.save(fig, out, "geneva_fig16")
    fig, ax = report.figure(9, 4)
    ax.plot(r.t, force, color=report.BLUE)
    ax.set(xlabel="time (s)", ylabel="contact force (N)")
    report.save(fig, out, "geneva_fig17")
    # one instant of the engagement, nodal forces
    s, _ = simulation("compliant", MESH)
    s.run(0.25, STEP)
    fig, ax = report.figure(7, 6)
    for i, colour, name in ((0, report.RED, "pin"), (1, report.BLUE, "wheel")):
        w, b = s.works[i], s.boundaries[i]
        c, sn = np.cos(s.state.x[i, 2]), np.sin(s.state.x[i, 2])
        p = b.points @ np.array([[c, sn], [-sn, c]]) + s.state.x[i, :2]
        first_ring = np.flatnonzero(b.ring == 0)
        first_ring = np.append(first_ring, first_ring[0])
        ax.plot(1e3 * p[first_ring, 0], 1e3 * p[first_ring, 1], "-", lw=1, color=colour)
        on = w.touched[: w.touched[-1]]
        ax.quiver(
            1e3 * w.position[on, 0],
            1e3 * w.position[on, 1],
            w.point_load[on, 0],
            w.point_load[on, 1],
            color=colour,
            width=0.003,
            label=name,
            scale=6 * np.abs(w.point_load).max(),
        )
    x, y = 1e3 * s.state.x[0, :2]
    ax.set(
        xlim=(x - 5, x + 5),
        ylim=(y - 5, y + 5),
        aspect="equal",
        xlabel="x (mm)",
        ylabel="y (mm)",
        title="t = 0.25 s",
    )
    ax.legend()
    report.save(fig, out, "geneva_fig18")
    ok = [x for x in results["steps"] if "failed" not in x]
    fig, ax = report.figure()
    h = [1e4 * x["step_s"] for x in ok]
    ax.semilogx(h, [x["run_s"] for x in ok], "o-", color=report.BLUE, label="wall time")
    bad = [x for x in ok if x["under_resolved"]]
    ax.plot(
        [1e4 * x["step_s"] for x in bad],
        [x["run_s"] for x in bad],
        "x",
        ms=12,
        color=report.RED,
        label="under-resolved",
    )
    twin = ax.twinx()
    twin.plot(h, [x["newton_iterations_mean"] for x in ok], "s--", color=report.ORANGE)
    twin.set_ylabel("mean Newton iterations", color=report.ORANGE)
    ax.set(xlabel="time step (10⁻⁴ s)", ylabel="wall time of 1 s (s)", ylim=(0, None))
    ax.legend()
    report.save(fig, out, "geneva_fig19")
    fig, axes = report.figure(9, 7, 3, 1, sharex=True, sharey=True)
    for ax, step in zip(axes, (2e-4, 5e-4, 8e-4), strict=True):
        if step in histories:
            keep = histories[step].t <= 0.8
            ax.plot(histories[step].t[keep], histories[step].iterations[keep], ".", ms=3, color=report.BLUE)
        ax.set(ylabel="iterations", title=f"h = {step:g} s")
    axes[-1].set_xlabel("time (s)")
    report.save(fig, out, "geneva_fig20")
