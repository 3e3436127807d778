"""How fast the flexible mode converges: mesh, modes, step, with fitted orders and what they are measured against.

Linear triangles (T3) converge with the mesh size squared in energy, so in compliance and in squared frequency;
generalised-alpha with the step squared. What modes leave out of a static compliance shrinks slowly with their number;
with residual flexibility nothing is left out at rest, and of a vibration only the square of its frequency over that
of the modes left out.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
import scipy.sparse as sp
import scipy.sparse.linalg as spl
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from ..flexible.body import elastic_body
from ..flexible.boundary import build
from ..flexible.element import Material, stiffness
from ..flexible.integrate import Body, Simulation
from ..flexible.mesh import Mesh, resample, triangulate
from ..flexible.modes import elastic, hub_rows, reduce
from ..shapes import involute_gear
from .records import Row
from .scene import Array, full_circle
from .timing import exponent


@dataclass(frozen=True)
class Study:
    """Errors (relative) of one quantity over one knob, and the order fitted to them: error ∝ knob^order.

    `expected` is the order that theory gives, null where it gives none; `against` says what the errors are
    differences from.
    """

    study: str
    quantity: str
    knob: str
    x: tuple[float, ...]
    error: tuple[float, ...]
    against: str
    expected: float | None = None

    @property
    def order(self) -> float:
        """Slope of log error over log knob, by least squares."""
        return exponent(self.x, self.error)

    def row(self) -> Row:
        """The study as it is written to files."""
        return {**asdict(self), "order": self.order}


def timoshenko_cantilever(
    length: float, height: float, young: float, poisson: float, density: float
) -> Array:
    """The first three angular frequencies of a cantilever of rectangular section, shear and rotary inertia included.

    T. C. Huang, The effect of rotatory inertia and of shear deformation on the frequency and normal mode equations
    of uniform beams, J. Appl. Mech. 28 (1961), doi:10.1115/1.3641787; shear coefficient 5/6. With neither it is the
    Euler-Bernoulli equation 1 + cos β cosh β = 0.
    """
    r2 = (height / length) ** 2 / 12
    s2 = r2 * 2 * (1 + poisson) / (5 / 6)

    def zero(b: float) -> float:
        root = np.sqrt((r2 - s2) ** 2 + 4 / b**2)
        low, high = np.sqrt(0.5 * (root - r2 - s2)), np.sqrt(0.5 * (root + r2 + s2))
        mixed = b * (r2 + s2) / np.sqrt(1 - b * b * r2 * s2)
        return float(
            2 / np.cosh(b * low)
            + (b * b * (r2 - s2) ** 2 + 2) * np.cos(b * high)
            - mixed * np.tanh(b * low) * np.sin(b * high)
        )

    # b = β² of Euler-Bernoulli: 3.516, 22.03, 61.70, lowered by shear and rotary inertia
    found = [brentq(zero, *bracket) for bracket in ((2.0, 4.0), (15.0, 22.5), (40.0, 62.5))]
    return np.array(found) * np.sqrt(young * height**2 / (12 * density * length**4))


def bar(length: float, height: float, n: int) -> Any:
    """Mesh of a bar along x, clamped end at x = 0, with n nodes' spacings over its height; ring 1 is that end."""
    m = round(length / height * n)
    x, y = np.linspace(0, length, m + 1), np.linspace(0, height, n + 1)
    sides = (
        np.column_stack([x, 0 * x]), np.column_stack([0 * y + length, y]),
        np.column_stack([x[::-1], 0 * x + height]), np.column_stack([0 * y, y[::-1]]),
    )  # fmt: skip
    mesh = triangulate([np.vstack([s[:-1] for s in sides])], growth=0.0)
    end = np.flatnonzero(mesh.points[: mesh.n_boundary, 0] < 1e-9 * length)
    return Mesh(mesh.points, mesh.triangles, (mesh.rings[0], end))


def cantilever_mesh(sizes: Sequence[int] = (3, 6, 12)) -> list[Study]:
    """Tip deflection under a tip load and first three frequencies of a slender cantilever (20 : 1, plane stress)."""
    length, height = 1.0, 0.05
    steel = Material(207e9, 0.29, 7800.0, 1.0)
    inertia, shear = height**3 / 12, steel.young / (2 * (1 + steel.poisson))
    tip = length**3 / (3 * steel.young * inertia) + 1.2 * length / (shear * height)
    frequency = timoshenko_cantilever(length, height, steel.young, steel.poisson, steel.density)
    errors = []
    for n in sizes:
        mesh = bar(length, height, n)
        response = elastic(mesh, steel, clamped=1)
        end = np.flatnonzero(mesh.points[: mesh.n_boundary, 0] > length * (1 - 1e-9))
        load = np.zeros((2 * len(mesh.points), 1))
        load[2 * end + 1] = 1.0 / len(end)
        found = float((load * response(load)).sum())
        errors.append([abs(found / tip - 1), *np.abs(response.modes(3)[1] / frequency - 1)])
    names = ["tip deflection", *(f"frequency {i}" for i in (1, 2, 3))]
    h = tuple(height / n for n in sizes)
    return [
        Study("cantilever, mesh", name, "mesh size (m)", h, tuple(e), "Timoshenko beam", 2.0)
        for name, e in zip(names, np.transpose(errors), strict=True)
    ]


def _tooth(size: float) -> tuple[Any, Any, Array]:
    """Response of a gear, and unit load on a tooth's middle flank (2 n, 1), balanced by the hub.

    The load is spread over 1.6 mm of the flank about the pitch point as cos²: a point load has no finite answer.
    """
    steel = Material(207e9, 0.29, 7800.0, 0.05)
    gear = involute_gear(2e-3, 23, bore=8e-3, tolerance=1e-7)
    # the inside refines with the boundary, else its coarse middle would be left
    mesh: Mesh = triangulate([resample(r, size) for r in gear.rings], growth=0.2 * size / 6e-4)
    ring = mesh.points[mesh.rings[0]]
    # the lower flank of tooth 0 leaves the pitch circle at (23 mm, -π/2 modules/2); 20° from the radius there
    middle = 0.023 * np.array([np.cos(np.pi / 46), -np.sin(np.pi / 46)])
    turn = np.pi / 2 - np.radians(20) - np.pi / 46
    inwards, width = np.array([np.cos(turn), np.sin(turn)]), 1.6e-3
    load = np.zeros((len(mesh.points), 2))
    a, b = ring, np.roll(ring, -1, 0)
    for t in (np.arange(20) + 0.5) / 20:
        p = a + t * (b - a)
        along = (p - middle) @ [-inwards[1], inwards[0]]
        near = (np.hypot(*(p - middle).T) < width) & (np.abs(along) < width / 2)
        weight = near * np.cos(np.pi * along / width) ** 2 * np.hypot(*(b - a).T) / 20
        for node, share in ((mesh.rings[0], 1 - t), (np.roll(mesh.rings[0], -1), t)):
            np.add.at(load, node, (share * weight)[:, None] * inwards)
    load /= np.hypot(*load.sum(0))
    x, y = mesh.points.T
    balance = np.array([*load.sum(0), (x * load[:, 1] - y * load[:, 0]).sum()])
    rows = hub_rows(mesh.points, mesh.rings[1])
    return elastic(mesh, steel), (mesh, steel), load.reshape(-1, 1) - (rows @ balance)[:, None]


def tooth_mesh(sizes: Sequence[float] = (9e-4, 6e-4, 4.5e-4, 3e-4, 2e-4)) -> list[Study]:
    """Compliance of a gear's tooth against its hub; the last two sizes give the reference, by Richardson."""
    found = []
    for size in sizes:
        response, _, load = _tooth(size)
        found.append(float((load * response(load)).sum()))
    exact = found[-1] + (found[-1] - found[-2]) / ((sizes[-2] / sizes[-1]) ** 2 - 1)
    errors = tuple(abs(value / exact - 1) for value in found[:-1])
    against = f"extrapolation to h = 0 from {1e3 * sizes[-2]:g} and {1e3 * sizes[-1]:g} mm"
    return [Study("tooth, mesh", "compliance", "mesh size (m)", tuple(sizes[:-1]), errors, against, 2.0)]


def tooth_modes(counts: Sequence[int] = (10, 20, 40, 80), size: float = 6e-4) -> list[Study]:
    """Compliance of the tooth by modes alone, and by modes and residual flexibility; at rest and in vibration.

    At rest modes and residual flexibility are exact by construction, so they are compared in vibration at half the
    first elastic frequency.
    """
    response, (mesh, steel), load = _tooth(size)
    phi, omega = response.modes(max(counts))
    static = float((load * response(load)).sum())
    share = (phi.T @ load)[:, 0] ** 2
    drive = 0.5 * omega[0]
    dynamic = (stiffness(mesh, steel) - drive**2 * sp.diags_array(response.root**2)).tocsc()
    exact = float((load[:, 0] * spl.spsolve(dynamic, load[:, 0])).sum())
    rest, alone, together = [], [], []
    for m in counts:
        rest.append(1 - (share[:m] / omega[:m] ** 2).sum() / static)
        modal = (share[:m] / (omega[:m] ** 2 - drive**2)).sum()
        alone.append(abs(modal / exact - 1))
        together.append(abs((modal + static - (share[:m] / omega[:m] ** 2).sum()) / exact - 1))
    knob, x = "free-free modes", tuple(float(m) for m in counts)
    full = "the mesh's own answer"
    return [
        Study("tooth, modes", "compliance at rest, modes alone", knob, x, tuple(rest), full),
        Study("tooth, modes", "compliance in vibration, modes alone", knob, x, tuple(alone), full),
        Study("tooth, modes", "compliance in vibration, with residual flexibility", knob, x, tuple(together), full),
    ]  # fmt: skip


def beam_body(mesh: Any, material: Any, modes: int, **keys: Any) -> Any:
    """A clamped bar (`bar`) as a body of `Simulation`."""
    r = reduce(mesh, material, (0,), clamped=1, modes=modes)
    boundary = build([mesh.points[mesh.rings[0]] - r.centre], None, r.modes, r.how_it_yields)
    return Body(
        boundary, r.mass, r.inertia, (float(r.centre[0]), float(r.centre[1])), 0.0, r.frequency, r.coupling, r.stretch,
        fixed=True, **keys,
    )  # fmt: skip


def _far() -> Any:
    """A second body that does nothing: kernels are compiled for a number of bodies, two everywhere here."""
    return Body(build([full_circle(1.0, 0.1)]), 1.0, 1.0, (1e3, 0.0), fixed=True)


def vibration_step(points: Sequence[int] = (20, 40, 80, 160)) -> list[Study]:
    """Free vibration of a clamped beam in its first mode, ten periods, at ρ∞ = 1 and 0.8."""
    body = beam_body(bar(1.0, 0.05, 4), Material(207e9, 0.29, 7800.0, 1.0), 1)
    omega = float(body.frequency[0])
    period = 2 * np.pi / omega
    studies = []
    for rho in (1.0, 0.8):
        errors = []
        for n in points:
            sim = Simulation([body, _far()], [], rho=rho)
            sim.state.q[0], sim.state.ddq[0], sim.state.auxq[0] = 1e-3, -1e-3 * omega**2, -1e-3 * omega**2
            r = sim.run(10.125 * period, period / n)
            found = r.q[0] - 1j * r.dq[0] / omega
            errors.append(float(abs(1e3 * found - np.exp(1j * omega * r.t[-1]))))
        name = f"free vibration after ten periods, ρ∞ = {rho:g}"
        studies.append(
            Study("step", name, "step / period", tuple(1 / n for n in points), tuple(errors), "exact", 2.0)
        )
    return studies


def pendulum_step(steps: Sequence[int] = (100, 200, 400, 800)) -> list[Study]:
    """Angle of a pendulum that swings through a right angle and more for 1 s: a constraint, ρ∞ = 0.8."""
    mass, inertia, arm, g = 1.3, 0.02, 0.5, 9.81
    pull = mass * g * arm / (inertia + mass * arm**2)
    exact = solve_ivp(lambda t, y: [y[1], -pull * np.cos(y[0])], (0, 1), [0, 0], rtol=1e-12, atol=1e-12).y[
        0, -1
    ]
    errors = []
    for n in steps:
        bob = Body(
            build([full_circle(0.05, 1e-3)]), mass, inertia, (arm, 0.0), hub=(-arm, 0.0), anchor=(0.0, 0.0)
        )
        r = Simulation([bob, _far()], [], rho=0.8, gravity=(0.0, -g)).run(1.0, 1 / n)
        errors.append(float(abs(r.x[-1, 0, 2] / exact - 1)))
    name, against = "pendulum's angle after 1 s, ρ∞ = 0.8", "the equation of motion (scipy)"
    return [Study("step", name, "step (s)", tuple(1 / n for n in steps), tuple(errors), against, 2.0)]


def impact_step(
    make: Callable[[], Any], duration: float, steps: Sequence[float], finest: float
) -> list[Study]:
    """Where the first body of a scene (its y) is after an impact, against the same run at the step ``finest``."""

    def end(h: float) -> float:
        return float(make().run(duration, h).x[-1, 0, 1])

    start, exact = float(make().state.x[0, 1]), end(finest)
    errors = tuple(abs((end(h) - exact) / (exact - start)) for h in steps)
    name = "ball's way after it hit a cantilever with modes, ρ∞ = 0.8"
    return [Study("step", name, "step (s)", tuple(steps), errors, f"step of {finest:g} s", 2.0)]


def ring_energy(turns: int = 100) -> float:
    """Largest relative change of the energy of a free, undamped, flexible ring that spins and shakes, at ρ∞ = 1."""
    rings = [full_circle(0.1, 1e-5), full_circle(0.08, 1e-5)[::-1]]
    spin = 20.0
    ring, _ = elastic_body(
        rings, 0.015, Material(1e6, 0.3, 1000.0, 0.01), "modal", modes=6, velocity=(0.4, 0.0, spin)
    )
    sim = Simulation([ring, _far()], [], rho=1.0)
    # swollen by the spin and kicked, so that modes and frame exchange energy
    sim.state.q[:] = ring.stretch * spin**2 / ring.frequency**2
    sim.state.dq[0] = 1e-3
    r = sim.run(turns * 2 * np.pi / spin, 2 * np.pi / ring.frequency.max() / 60, every=20)
    energy = r.kinetic + r.elastic
    return float(np.abs(energy / energy[0] - 1).max())


def studies(make_impact: Callable[[], Any], duration: float, step: float) -> list[Study]:
    """All of them; ``make_impact`` builds the scene of `impact_step`."""
    return [
        *cantilever_mesh(),
        *tooth_mesh(),
        *tooth_modes(),
        *vibration_step(),
        *pendulum_step(),
        *impact_step(make_impact, duration, [step * 2.0**k for k in (1, 0, -1)], step / 8),
    ]
