"""Generalised-alpha integration of the constrained equations of motion (the paper's Eq. 26): bodies, runs, records.

The scheme itself, and what Newton's matrix holds, is in ``step``.
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rigidarea.flexible import nodal
from rigidarea.flexible.boundary import Boundary, workspace
from rigidarea.flexible.contacts import replay
from rigidarea.flexible.run import HALVINGS, run_steps
from rigidarea.flexible.scratch import MANY, SLICED, TORN
from rigidarea.flexible.system import REGIONS_KEPT as REGIONS_KEPT
from rigidarea.flexible.system import Buffers, Settings, State, System, elastic

Array = NDArray[np.float64]

CHUNK = 5000  # steps a compiled call: a Python signal waits at most this long


@dataclass
class Body:
    """One body of a system; SI or any consistent units.

    boundary: from ``boundary.build``, about the centre of mass. mass, inertia; position (2,) and angle of the
    frame at t = 0. frequency, coupling, stretch: of the modes in ``boundary.modes`` (see ``modes.Reduced``).
    damping: modal damping ratio. fixed: the frame is held: a ground, or a clamped body, whose modes move. (Gravity
    acts on frames: it does not bend a clamped body, and free-free modes do not feel it.) hub (2,): hub centre in the
    body frame; anchor (2,): the world point it is pinned to by a revolute joint, None for a free body. drive: (angle
    at t = 0, final angular velocity, ramp time) of a prescribed hub rotation, None if free. damper: torsional,
    moment/(rad/time). torque: constant, on the hub. velocity (3,): of the frame at t = 0.
    """

    boundary: Boundary
    mass: float
    inertia: float
    position: tuple[float, float] = (0.0, 0.0)
    angle: float = 0.0
    frequency: Array = field(default_factory=lambda: np.zeros(0))
    coupling: Array = field(default_factory=lambda: np.zeros((0, 0)))
    stretch: Array = field(default_factory=lambda: np.zeros(0))
    damping: float = 0.0
    fixed: bool = False
    hub: tuple[float, float] = (0.0, 0.0)
    anchor: tuple[float, float] | None = None
    drive: tuple[float, float, float] | None = None
    damper: float = 0.0
    torque: float = 0.0
    velocity: tuple[float, float, float] = (0.0, 0.0, 0.0)


@dataclass(frozen=True)
class Record:
    """What a run leaves, n rows.

    t (n,); x, v (n, b, 3) frames; hub (n, b) hub rotation; force (n, 2) contact force on the second body of the pair;
    regions (n, REGIONS_KEPT, 5): force, direction, point; iterations (n,) of Newton; halved (n,) times the step
    was halved; elastic (n,) strain energy of the modes; q (m,), dq (m,) at the end. evaluations: of the contact,
    in all.
    """

    t: Array
    x: Array
    v: Array
    hub: Array
    hub_rate: Array
    force: Array
    regions: Array
    iterations: Array
    halved: Array
    elastic: Array
    kinetic: Array
    q: Array
    dq: Array
    evaluations: int


class Simulation:
    """Bodies, contact pairs and the stepper.

    k: contact stiffness, force per area. q: pressure exponent of Alg. 3. contact: "area" or "sts". reach: STS only,
    the deepest penetration looked at (length). margin: length a leaf pair may move before the search is renewed.
    rho: spectral radius at infinity ρ∞, in [0, 1]; below 1 where there are constraints (index 3). Raises
    ValueError for settings out of range or an overlap at t = 0 deeper than ``depth_limit``.
    """

    def __init__(
        self,
        bodies: Sequence[Body],
        pairs: Sequence[tuple[int, int]] = ((0, 1),),
        k: float = 1.0,
        q: float = 1.0,
        contact: str = "area",
        reach: float = 0.0,
        margin: float = 0.0,
        rho: float = 0.8,
        gravity: tuple[float, float] = (0.0, 0.0),
        depth_limit: float = np.inf,
    ) -> None:
        if not 0.0 <= rho <= 1.0:
            raise ValueError(f"rho must lie in [0, 1], got {rho}")
        if contact not in ("area", "sts"):
            raise ValueError(f"contact must be 'area' or 'sts', got {contact!r}")
        if contact == "sts" and not reach > 0:
            raise ValueError(f"reach must be positive for STS, got {reach}")
        if not k > 0:
            raise ValueError(f"k must be positive, got {k}")
        constrained = any(b.anchor is not None or b.drive is not None for b in bodies)
        if constrained and rho == 1.0:
            raise ValueError("rho must be below 1 with constraints (index 3 is unstable at 1), got 1")
        for i, b in enumerate(bodies):
            if b.fixed and (b.anchor is not None or b.drive is not None):
                raise ValueError(f"body {i} is fixed: expected neither anchor nor drive")
        self.bodies = list(bodies)
        count = [len(b.frequency) for b in bodies]
        for i, b in enumerate(bodies):
            if b.boundary.modes.shape[1] != count[i]:
                raise ValueError(
                    f"body {i}: expected {b.boundary.modes.shape[1]} frequencies, got {count[i]}"
                )
        first = np.concatenate([[0], np.cumsum(count)])
        omega = np.concatenate([np.asarray(b.frequency, float) for b in bodies])
        zeta = np.repeat([b.damping for b in bodies], count)
        n = len(bodies)

        def column(values: list[Any]) -> Array:
            return np.ascontiguousarray(np.array(values, float))

        self.system = System(
            column([b.mass for b in bodies]), column([b.inertia for b in bodies]),
            np.array([int(b.fixed) for b in bodies]), column([b.hub for b in bodies]),
            np.array([int(b.anchor is not None) for b in bodies]), column([b.anchor or (0.0, 0.0) for b in bodies]),
            np.array([int(b.drive is not None) for b in bodies]), column([b.drive or (0.0, 0.0, 0.0) for b in bodies]),
            column([b.damper for b in bodies]), column([b.torque for b in bodies]), column([*gravity]),
            first, omega**2, 2 * zeta * omega,
            np.concatenate([np.asarray(b.stretch, float) for b in bodies]),
            column([np.linalg.norm(b.boundary.points, axis=1).max() for b in bodies]),
            np.concatenate([np.hypot(b.boundary.modes[:-3:2], b.boundary.modes[1:-3:2]).max(0) for b in bodies]),
        )  # fmt: skip
        self.couplings = tuple(np.ascontiguousarray(b.coupling, float) for b in bodies)
        self.boundaries = tuple(b.boundary for b in bodies)
        self.works = tuple(workspace(b.boundary) for b in bodies)
        self._elastic = tuple(map(elastic, self.boundaries, self.works))
        self.pairs = np.array(pairs, np.int64).reshape(-1, 2)
        spread = any(bd.modes.shape[1] > 0 or len(bd.flexibility) for bd in self.boundaries)
        self.settings = Settings(float(k), float(reach if contact == "sts" else q), contact == "sts", spread,
                                 float(margin), float(rho))  # fmt: skip
        m = int(first[-1])
        self.state, self._saved = self._new_state(m), self._new_state(m)
        self.time = 0.0
        self.scratch = nodal.scratch(sum(len(b.points) for b in self.boundaries))
        self._buffers = Buffers(
            np.zeros((n, 4)), np.full((n, 4), np.inf), np.zeros((6 * n, 6 * n)), np.zeros(6 * n + 2), np.zeros((n, 3)),
            np.zeros((6 * n, 6 * n)), np.zeros(6 * n), np.zeros(2), np.zeros((REGIONS_KEPT, 5)), np.zeros(m),
            np.zeros(3 * n, np.int64), np.array([-1, 0, 0]), np.zeros((REGIONS_KEPT * n, 24)),
            np.zeros(2), np.zeros(1),
        )  # fmt: skip
        if np.isfinite(depth_limit):
            self._check_start(depth_limit)

    def counts(self) -> tuple[int, int]:
        """Contact evaluations so far, and contact regions in the last one."""
        return int(self._buffers.counts[1]), int(self._buffers.counts[2])

    def _check_start(self, limit: float) -> None:
        for i, j in self.pairs:
            pose = [np.array([x, y, np.cos(t), np.sin(t)]) for x, y, t in self.state.x[[i, j]]]
            a, b = self.boundaries[i], self.boundaries[j]
            s = self.scratch
            n_pairs = nodal.search(a, pose[0], b, pose[1], 0.0, s)
            works = workspace(a), workspace(b)
            flat = [np.zeros(x.modes.shape[1]) for x in (a, b)]
            n = nodal.contact(
                a, works[0], pose[0], flat[0], b, works[1], pose[1], flat[1], n_pairs, 1, 1.0, 1.0, False, s
            )
            depth = max((float(r["area"] / r["chord"]) for r in s.regions[: max(n, 0)]), default=0.0)
            if n < 0 or depth > limit:
                raise ValueError(
                    f"bodies {i} and {j} overlap at t = 0: expected a mean depth of at most {limit:.4g}, got "
                    + (f"{depth:.4g}" if n >= 0 else "boundaries that pass through each other")
                )

    def _new_state(self, modes: int) -> State:
        x = np.array([[*b.position, b.angle] for b in self.bodies], float)
        v = np.array([b.velocity for b in self.bodies], float)
        acc, mu = np.zeros_like(x), np.zeros_like(x)
        for i, b in enumerate(self.bodies):
            if not b.fixed:
                acc[i], mu[i] = self._start(b)
        z = np.zeros(modes)
        return State(x, v, acc, acc.copy(), z, z.copy(), z.copy(), z.copy(), mu)

    def _start(self, b: Body) -> tuple[Array, Array]:
        """Accelerations and multipliers (3,) that satisfy motion and constraints at t = 0, contacts and modes at
        rest.

        Without them the scheme starts with an error of first order.
        """
        c, s = np.cos(b.angle), np.sin(b.angle)
        arm = np.array([c * b.hub[0] - s * b.hub[1], s * b.hub[0] + c * b.hub[1]])
        omega = b.velocity[2]
        rows, right = [], []
        if b.anchor is not None:
            rows += [[1.0, 0.0, -arm[1]], [0.0, 1.0, arm[0]]]
            right += list(omega**2 * arm)
        if b.drive is not None:
            rows.append([0.0, 0.0, 1.0])
            right.append(b.drive[1] / b.drive[2] if b.drive[2] > 0 else 0.0)
        n = len(rows)
        matrix = np.zeros((3 + n, 3 + n))
        matrix[:3, :3] = np.diag([b.mass, b.mass, b.inertia])
        if n:
            matrix[3:, :3] = rows
            matrix[:3, 3:] = -np.array(rows).T
        load = [b.mass * self.system.gravity[0], b.mass * self.system.gravity[1], b.torque - b.damper * omega]
        solution = np.linalg.solve(matrix, np.array(load + right))
        mu = np.zeros(3)
        mu[: 2 if b.anchor is not None else 0] = solution[3 : 5 if b.anchor is not None else 3]
        if b.drive is not None:
            mu[2] = solution[-1]
        return solution[:3], mu

    def run(self, duration: float, h: float, every: int = 1) -> Record:
        """Advances by ``duration`` in steps of ``h``, recording every ``every`` steps.

        Raises RuntimeError naming step, residual and body if a step does not converge after HALVINGS halvings.
        What was computed until then, or until an interrupt, is in ``self.record``.
        """
        if not (h > 0 and duration > 0):
            raise ValueError(f"duration and h must be positive, got {duration} and {h}")
        steps = round(duration / h)
        n = len(self.bodies)
        out = np.zeros((steps // every, 7 + 8 * n + 5 * REGIONS_KEPT))
        start = int(self._buffers.counts[1])
        done = code = 0
        begin, chunk = self.time, every * max(1, CHUNK // every)
        try:
            while done < steps and code >= 0:
                part, code = run_steps(
                    self.boundaries, self.works, self._elastic, self.system, self.couplings, self.state, self._saved,
                    self.pairs, self.settings, self.scratch, self._buffers, begin + h * done, h,
                    min(chunk, steps - done), every, out[done // every :],
                )  # fmt: skip
                done += part
        finally:  # an interrupt arrives between chunks: what was computed stays readable
            self.time = begin + h * done
            self.record = self._rows(out[: done // every], int(self._buffers.counts[1]) - start)
        if code < 0:
            reason = {
                MANY: "more contact points than the work arrays hold",
                TORN: "a boundary crosses itself, or the bodies overlap deeper than a feature",
                SLICED: "one body passes through the other",
            }.get(code, "no convergence")
            worst = int(np.argmax(np.abs(self._buffers.load).sum(1))) if self._buffers.load.any() else 0
            raise RuntimeError(
                f"step {done} (t = {self.time:.6g}, h = {h:g}, halved {HALVINGS} times): {reason}; residual"
                f" {self._buffers.rhs[-2]:.3g} against forces of {self._buffers.rhs[-1]:.3g}, body {worst}"
            )
        return self.record

    def _rows(self, rows: Array, evaluations: int) -> Record:
        n = len(self.bodies)
        body = rows[:, 7 : 7 + 8 * n].reshape(len(rows), n, 8)
        return Record(
            rows[:, 0], body[:, :, :3], body[:, :, 3:6], body[:, :, 6], body[:, :, 7], rows[:, 1:3],
            rows[:, 7 + 8 * n :].reshape(len(rows), REGIONS_KEPT, 5), rows[:, 3], rows[:, 4], rows[:, 5], rows[:, 6],
            self.state.q.copy(), self.state.dq.copy(), evaluations,
        )  # fmt: skip

    def contact_seconds(self, x: Array, repeat: int = 5) -> float:
        """Seconds of one contact evaluation, search included, at the frames ``x`` (n, b, 3); best of ``repeat``."""
        x = np.ascontiguousarray(x)
        args = (self.boundaries, self.works, self.system, self.state.q, self.pairs, self.settings, self.scratch,
                self._buffers, x)  # fmt: skip
        replay(*args)
        best = np.inf
        for _ in range(repeat):
            start = time.perf_counter()
            replay(*args)
            best = min(best, time.perf_counter() - start)
        return best / len(x)
