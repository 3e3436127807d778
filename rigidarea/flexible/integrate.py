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

from rigidarea.contact.impact import damping_ratio
from rigidarea.flexible import nodal
from rigidarea.flexible.bodies import table
from rigidarea.flexible.boundary import Boundary, workspace
from rigidarea.flexible.check import (
    check_bodies,
    check_joints,
    check_pairs,
    check_settings,
    check_start,
    of_pairs,
)
from rigidarea.flexible.contacts import replay
from rigidarea.flexible.linear_limits import watch
from rigidarea.flexible.mechanism_joints import JOINT, Joint
from rigidarea.flexible.run import BODY, COARSE, HALVINGS, HEAD, IMPACT_HALVINGS, NOT_FINITE, run_steps
from rigidarea.flexible.scratch import FULL, MANY, SLICED, TORN, searches
from rigidarea.flexible.start import moving, settle, start, weighed
from rigidarea.flexible.system import REGIONS, Buffers, Settings, State, System, buffers
from rigidarea.flexible.tension import tense
from rigidarea.geometry.gate import positive, whole

Array = NDArray[np.float64]

MOST_STEPS = 10**9  # a run of more would take days, and its record more memory than there is
CHUNK = 5000  # steps a compiled call: a Python signal waits at most this long
ROOM = 120  # loaded FE nodes of all contacts at once, to begin with; doubled when they are more. (Rows of 128 would all
# fall on the same few lines of the processor's cache.)


@dataclass
class Body:
    """One body of a system; SI or any consistent units.

    boundary: from ``boundary.build``, about the centre of mass. mass, inertia; position (2,) and angle of the
    frame at t = 0. frequency, coupling, stretch: of the modes in ``boundary.modes`` (see ``modes.Reduced``).
    damping: modal damping ratio. fixed: the frame is held: a ground, or a clamped body, whose modes move, and which
    has stood under its weight before t = 0. (Gravity acts on frames: free-free modes do not feel it.) hub (2,): hub
    centre in the body frame; anchor (2,): the world point it is pinned to by a revolute joint, None for a free body.
    drive: (angle at t = 0, final angular velocity, ramp time) of a prescribed hub rotation, None if free. damper:
    torsional, moment/(rad/time). torque: constant, on the hub. velocity (3,): of the frame at t = 0. young:
    Young's modulus, named in errors (0: rigid). geometric (3, m, m): of ``modes.Reduced``, None: none. slowest:
    the first elastic angular frequency, for the watch on spin (0: not known). shape: a ``recover.Shape``, None
    where there is no mesh.
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
    young: float = 0.0
    geometric: Array | None = None
    slowest: float = 0.0
    shape: Any = None


@dataclass(frozen=True)
class Record:
    """What a run leaves, n rows, b bodies, p pairs.

    t (n,); x, v (n, b, 3) frames; hub, hub_rate (n, b) hub rotation; forces (n, p, 2) contact force on the second body
    of each pair; regions (n, r, 5): force on the second body of its pair, direction, point, zeros beyond the regions
    of the instant, r the most at one; pair (n, r) which pair, -1 beyond; iterations (n,) of Newton; halved (n,) times
    the step was halved; elastic, kinetic (n,) strain energy of modes and static flexibility, kinetic energy; q (m,),
    dq (m,) at the end. joints (n, j, 3): force and moment of each joint on its second body. evaluations: of the
    contact, in all. shapes: what ``recover`` makes stresses of, None unless the run kept it.
    """

    t: Array
    x: Array
    v: Array
    hub: Array
    hub_rate: Array
    forces: Array
    regions: Array
    pair: NDArray[np.int64]
    iterations: Array
    halved: Array
    elastic: Array
    kinetic: Array
    q: Array
    dq: Array
    joints: Array
    evaluations: int
    shapes: Shapes | None = None

    @property
    def force(self) -> Array:
        """Contact force (n, 2) on the second body, in a system of one pair. Raises ValueError with several."""
        if self.forces.shape[1] > 1:
            raise ValueError(
                f"force is that of the one pair: expected 1, got {self.forces.shape[1]}; see forces"
            )
        return self.forces[:, 0] if self.forces.shape[1] else np.zeros((len(self.t), 2))


@dataclass(frozen=True)
class Shapes:
    """The deformed state at each of n recorded times.

    modal (n, m): coordinates of all bodies' modes; hub (n, b, 3): force and moment on each hub, body frame; loads: n
    arrays (l, 4) of body, FE boundary node, and force on it, body frame.
    """

    modal: Array
    hub: Array
    loads: list[Array]


class Simulation:
    """Bodies, contact pairs and the stepper.

    pairs: of body numbers; forces are recorded on the second of each. k: contact stiffness, force per area. q: pressure
    exponent of Alg. 3. contact: "area" or "sts". reach: STS only, the deepest penetration looked at (length). margin:
    length a leaf pair may move before the search is renewed. rho: spectral radius at infinity ρ∞, in [0, 1]; below 1
    where there are constraints (index 3). friction, restitution: of all pairs, or one a pair (``resist``). joints:
    see ``joints``. Bodies start where they are said to be, but for what their static flexibility moves a pivot or a
    drive by under the first forces, and what the weight of a clamped body does. Raises ValueError for bodies, pairs,
    joints or settings out of range, or an overlap at t = 0 deeper than ``depth_limit`` or than ``check_start`` says.
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
        friction: float | Sequence[float] = 0.0,
        restitution: float | Sequence[float] = 1.0,
        joints: Sequence[Joint] = (),
    ) -> None:
        check_settings(k, q, contact, reach, margin, rho, gravity)
        check_bodies(bodies, rho, constrained=len(joints) > 0)
        self.pairs = check_pairs(pairs, len(bodies))
        held = (
            of_pairs("friction", friction, len(self.pairs)),
            of_pairs("restitution", restitution, len(self.pairs)),
        )
        self.joints = check_joints(joints, len(bodies))
        check_start(bodies, self.pairs, depth_limit)
        self.bodies = list(bodies)
        placed = [weighed(moving(b, i), gravity) for i, b in enumerate(bodies)]
        bodies, self.sag = [b for b, _ in placed], [u for _, u in placed]
        count = [len(b.frequency) for b in bodies]
        first = np.concatenate([[0], np.cumsum(count)])
        omega = np.concatenate([np.asarray(b.frequency, float) for b in bodies])
        zeta = np.repeat([b.damping for b in bodies], count)

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
            column([(0.0, 0.0) if b.fixed else (1 / b.mass, 1 / b.inertia) for b in bodies]),
            held[0], np.array([tense(b) for b in bodies]), np.array([damping_ratio(e) for e in held[1]]),
            np.array([j.row() for j in self.joints], JOINT),
        )  # fmt: skip
        self.couplings = tuple(np.ascontiguousarray(b.coupling, float) for b in bodies)
        self.boundaries = tuple(b.boundary for b in bodies)
        self.works = tuple(workspace(b.boundary) for b in bodies)
        for b, w in zip(bodies, self.works, strict=True):
            w.still[0] = b.fixed and b.boundary.modes.shape[1] == 0 and len(b.boundary.flexibility) == 0
        self._geometric = tuple(
            np.zeros((0, m, m)) if b.geometric is None else np.ascontiguousarray(b.geometric, float)
            for b, m in zip(bodies, count, strict=True)
        )
        self._table = table(self.boundaries, self.works, self.couplings, self._geometric)
        spread = any(bd.modes.shape[1] > 0 or len(bd.flexibility) for bd in self.boundaries)
        bound = any(b.anchor is not None or b.drive is not None or b.damper or b.torque for b in bodies)
        loose = not (bound or self.joints or sum(count))
        self.settings = Settings(float(k), float(reach if contact == "sts" else q), contact == "sts", spread,
                                 float(margin), float(rho), loose)  # fmt: skip
        m = int(first[-1])
        self.state, self._saved = self._new_state(bodies, m), self._new_state(bodies, m)
        self.time = 0.0
        self._searches = searches(len(self.pairs))
        self._make_room(ROOM if spread else 0)
        for n, u in enumerate(self.sag):
            self._buffers.most[n] = 0.0 if u is None else np.hypot(*u.T).max()

    def _make_room(self, loads: int, old: Buffers | None = None) -> None:
        """Scratch arrays with room for so many loads as unknowns."""
        sizes = [len(b.points) for b in self.boundaries]
        largest = max((sizes[i] + sizes[j] for i, j in self.pairs), default=0)
        self.scratch = nodal.scratch(largest, loads)
        modes = [len(b.frequency) for b in self.bodies]
        made = buffers(len(self.bodies), len(self.pairs), len(self.joints), modes, loads)
        if old is not None:
            made.counts[1], made.most[:] = old.counts[1], old.most
            made.springs[:], made.held[:], made.met[:] = old.springs, old.held, old.met
        self._buffers: Buffers = made
        # regions are numbered anew: no node belongs to one
        for w in self.works:
            w.slot_region[:] = 0

    def counts(self) -> tuple[int, int]:
        """Contact evaluations so far, and contact regions in the last one."""
        return int(self._buffers.counts[1]), int(self._buffers.counts[0])

    def _new_state(self, bodies: Sequence[Body], modes: int) -> State:
        x = np.array([[*b.position, b.angle] for b in bodies], float)
        v = np.array([b.velocity for b in bodies], float)
        v[[b.fixed for b in bodies]] = 0.0
        acc, mu = start(bodies, self.joints, self.system.gravity)
        z, turn = np.zeros(modes), np.zeros((len(x), 4))
        for b, w, *own in zip(bodies, self.works, x, mu[: len(bodies)], turn, strict=True):
            w.hub_load[:] = settle(b, self.system.gravity, *own)
        return State(x, v, acc, acc.copy(), z, z.copy(), z.copy(), z.copy(), mu, turn)

    def run(self, duration: float, h: float, every: int = 1, shapes: bool = False) -> Record:
        """Advances by ``duration``, a whole number of steps ``h`` (rounded), recording every ``every`` of them; shapes
        too if asked for.

        Raises ValueError for lengths of time or ``every`` out of range, RuntimeError naming step, residual, pair and
        its stiffness if a step does not converge after HALVINGS halvings, or does not follow a blow after
        IMPACT_HALVINGS. Warns (``watch.LinearityWarning``) where a body went beyond linear elasticity. What was
        computed until then, or until an interrupt, is in ``self.record``.
        """
        positive(duration, "duration"), positive(h, "h")
        if h > duration * (1 + 1e-9):
            raise ValueError(f"h must be at most the duration, {duration:g}, got {h:g}")
        if duration / h > MOST_STEPS:
            raise ValueError(
                f"h must be at least {duration / MOST_STEPS:.4g} for a duration of {duration:g}, got {h:g}"
            )
        steps = round(duration / h)
        every = whole(every, "every", 1, steps)
        n, m, p = len(self.bodies), len(self.state.q), len(self.pairs)
        out = np.zeros(
            (steps // every, HEAD + BODY * n + 2 * p + 3 * len(self.joints) + (m + 3 * n if shapes else 0))
        )
        chunk = every * max(1, CHUNK // every)
        nodes = sum(len(w.node_load) for w in self.works)
        regions = np.zeros((REGIONS + 4 * CHUNK, 6))
        loads = np.zeros((max(nodes, 40 * CHUNK) if shapes else 0, 4))
        kept = [np.zeros((0, 6))], [np.zeros((0, 4))]
        filled = np.zeros(5, np.int64)
        start = int(self._buffers.counts[1])
        begin, done, code = self.time, 0, 0
        try:
            while done < steps and code >= 0:
                done, code = run_steps(
                    self._table, self.system, self.state, self._saved, self.pairs, self.settings, self.scratch,
                    self._searches, self._buffers, begin, h, done, min(done + chunk, steps), every, out, regions,
                    loads, filled,
                )  # fmt: skip
                for part, source, end in zip(kept, (regions, loads), filled[1:3], strict=True):
                    part.append(source[:end].copy())
                filled[1:3] = 0
                if code == FULL:
                    self._make_room(2 * len(self.scratch.load.force), self._buffers)
                    code = 0
        finally:  # an interrupt arrives between chunks: what was computed stays readable
            self.time = begin + h * done
            evaluations = int(self._buffers.counts[1]) - start
            self.record = self._rows(
                out[: filled[0]], np.vstack(kept[0]), np.vstack(kept[1]), evaluations, shapes
            )
        if code < 0:
            raise RuntimeError(
                f"step {done} (t = {self.time:.6g}, h = {h:g}, halved {IMPACT_HALVINGS if code == COARSE else HALVINGS}"
                f" times): {self._trouble(code)}"
            )
        # a column at a time: a maximum over the long axis of a narrow array takes numpy fifty times as long
        spin = np.array([np.abs(w).max(initial=0.0) for w in self.record.v[:, :, 2].T])
        watch(self.bodies, self.system.size, self._buffers.most, spin)
        return self.record

    def _trouble(self, code: int) -> str:
        """What stopped a run, where, and what may help."""
        told = {
            MANY: "more contact points than the work arrays hold",
            TORN: "a boundary crosses itself, or the bodies overlap deeper than a feature",
            SLICED: "one body passes through the other",
            COARSE: "a blow too short to follow: it would gain energy",
            NOT_FINITE: "the state is not finite: expected forces, stiffnesses and speeds whose products are numbers",
        }.get(code, "no convergence")
        if len(self.pairs):
            p = int(np.argmax(np.abs(self._buffers.force).sum(1)))
            i, j = (int(b) for b in self.pairs[p])
            young = [f"{b.young:.4g}" if b.young else "rigid" for b in (self.bodies[i], self.bodies[j])]
            told += (
                f"; residual {self._buffers.rhs[-2]:.3g} against forces of {self._buffers.rhs[-1]:.3g}, pair ({i}, {j})"
                f" under k = {self.settings.k:.4g}, E of its bodies {young[0]} and {young[1]}"
            )
        return told + "; try a shorter step, a finer mesh under the contact, or a smaller k"

    def _rows(self, rows: Array, regions: Array, loads: Array, evaluations: int, shapes: bool) -> Record:
        n, p, m = len(self.bodies), len(self.pairs), len(self.state.q)
        at = HEAD + BODY * n
        body = rows[:, HEAD:at].reshape(len(rows), n, BODY)
        forces = rows[:, at : at + 2 * p].reshape(len(rows), p, 2)
        at += 2 * p
        joints = rows[:, at : at + 3 * len(self.joints)].reshape(len(rows), len(self.joints), 3)
        at += 3 * len(self.joints)
        counts, loaded = rows[:, 5].astype(int), rows[:, 6].astype(int)
        regions = regions[: counts.sum()]
        hit = np.flatnonzero(counts)
        times = counts[hit]
        row = np.repeat(hit, times)
        place = row, np.arange(len(row)) - np.repeat(np.cumsum(times) - times, times)
        table = np.zeros((len(rows), max(1, counts.max(initial=0)), 5))
        table[place] = regions[:, 1:]
        pair = np.full(table.shape[:2], -1)
        pair[place] = regions[:, 0]
        kept = None
        if shapes:
            ends = np.cumsum(loaded)
            kept = Shapes(
                rows[:, at : at + m].copy(), rows[:, at + m :].reshape(len(rows), n, 3).copy(),
                np.split(loads[: loaded.sum()], ends[:-1]) if len(rows) else [],
            )  # fmt: skip
        return Record(
            rows[:, 0], body[:, :, :3], body[:, :, 3:6], body[:, :, 6], body[:, :, 7], forces, table, pair,
            rows[:, 1], rows[:, 2], rows[:, 3], rows[:, 4], self.state.q.copy(), self.state.dq.copy(), joints,
            evaluations, kept,
        )  # fmt: skip

    def contact_seconds(self, x: Array, repeat: int = 5) -> float:
        """Seconds of one contact evaluation, search included, at the frames ``x`` (n, b, 3); best of ``repeat``."""
        x = np.ascontiguousarray(x)
        args = (self._table, self.system, self.state.q, self.pairs, self.settings, self.scratch, self._searches,
                self._buffers, x)  # fmt: skip
        replay(*args)
        best = np.inf
        for _ in range(repeat):
            start = time.perf_counter()
            replay(*args)
            best = min(best, time.perf_counter() - start)
        self.scratch.load.made[0] = 0  # loads of these frames foresee nothing of a run that goes on
        return best / len(x)
