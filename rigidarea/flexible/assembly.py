"""Flexible bodies in a pymunk space, beside rigid ones: a gear pair that yields, in a game.

    gears = ra.flexible.Assembly(k=6e8)  # N/m²: contact force per overlap area, between its parts
    gears.part(pinion_shape, steel, mesh=1e-3, hub=1)  # a shape of a body in the space: outline.add_to(body)
    gears.part(wheel_shape, steel, mesh=1e-3, hub=1, level="modal")
    contact = ra.attach(space, flexible=gears)
    space.step(1 / 60)

**Who does what.** A part's rigid motion is its pymunk body's: mass, moment, gravity, damping, forces, joints and motors
are those of the space. In each frame all parts, and the bodies that joints tie to them, are moved first, in steps as
short as their contacts ask for (``inspace``): contacts between parts act on deformed boundaries, joints by Chipmunk's
own functions. Then the rest of the space has its frame as ever, with parts in the places and at the velocities that
came out. What a part has to do with other bodies is the area contact's: its impulses change the part's velocity,
and its joints answer, within what is left of their ``max_force``. So every impulse is exchanged between two bodies at
one time, and momentum is kept to rounding. What lasts of it acts ahead of time in the next frame's steps (``inspace``).

What follows from it: rigid bodies feel a part at the end of the frame; a blow on a part reaches its mate in the next
frame, as a change of velocity. Contacts between parts have the friction and elasticity of their shapes (``resist``),
but no arbiter: no callbacks. A joint's callbacks see the impulse that it has in the second half of the frame, its
``impulse`` afterwards is that of both. Neither parts nor what touches them fall asleep.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from itertools import combinations
from pathlib import Path
from typing import Any

import numpy as np
import pymunk
from numpy.typing import NDArray
from pymunk._chipmunk_cffi import lib

from rigidarea.contact.impact import damping_ratio
from rigidarea.flexible.body import outline_body
from rigidarea.flexible.element import Material
from rigidarea.flexible.inspace import advance, gather, give_back, note_rest
from rigidarea.flexible.integrate import Body, Simulation
from rigidarea.flexible.recover import State
from rigidarea.flexible.run import RESOLVED
from rigidarea.flexible.scratch import FULL
from rigidarea.flexible.tied import Tied
from rigidarea.geometry.gate import finite, not_negative, positive
from rigidarea.geometry.outline import Outline

Array = NDArray[np.float64]

TRAVEL = 0.25  # of the mesh size: how far a boundary moves in a step, before a contact is seen
COARSER = 2.0  # how fast steps grow again where contacts have gone or become softer, a factor a frame
LASTS = 1.0  # for so long (time) steps stay as short as what joints hold has asked for: steps that follow the phase
# of a swing pump it, also at the second order
SPRINGS_KEPT = 256  # contact regions whose friction a frame that is run again remembers
MOST_STEPS = 100_000  # of a frame: a second or more of it, for what moves faster than a game can have meant
TRIES = 8  # a frame whose steps turn out too long is run again with shorter ones, so many times at the most


class Assembly:
    """Bodies of a pymunk space that yield, and touch each other by their deformed boundaries.

    k: contact stiffness between parts, force per overlap area. q: exponent of the nodal pressures (Alg. 3). step: the
    longest step of the parts' motion (time); None: as long as their contacts allow. cache: a directory for meshes and
    reductions. Raises ValueError for settings out of range.
    """

    def __init__(
        self, k: float, *, q: float = 1.0, step: float | None = None, cache: Path | str | None = None
    ) -> None:
        for name, value in (("k", k), ("step", 1.0 if step is None else step)):
            positive(value, name)
        not_negative(q, "q")
        self._k, self._q, self._longest, self._cache = float(k), float(q), step, cache
        self._parts: list[tuple[pymunk.Shape, Body]] = []
        self._size = math.inf
        self._space: pymunk.Space | None = None
        self._memory: Any = None  # of the original, in a copy
        self.simulation: Simulation | None = None
        """The parts as the flexible stepper has them; None before the space is attached."""
        self.steps = 0
        """Steps of the last frame."""

    def part(
        self,
        shape: pymunk.Shape,
        material: Material,
        *,
        mesh: float | Sequence[float] | None = None,
        level: str = "compliant",
        hub: int | None = None,
        contact: Sequence[int] = (0,),
        modes: int = 40,
        refine: int = 4,
        damping: float = 0.0,
    ) -> int:
        """Makes the body of ``shape`` a part; returns its number.

        shape: of a body of the space, dynamic or kinematic (``Outline.add_to``, or one of pymunk's with an area); its
        outline is meshed. material: for elasticity and the inertia of modes; mass and moment of the body are pymunk's.
        mesh: spacing of the boundary nodes (length), one or one a ring. level: "rigid" (then neither mesh nor hub),
        "compliant" or "modal" with ``modes`` and their ``damping`` ratio. hub: the ring (1 … the holes) that the
        body's joints hold; None: they pull at all of the body at once. contact: the rings that touch other parts.
        refine: contact points a mesh edge. Raises ValueError for settings out of range and a body that is a part
        already; RuntimeError once attached.
        """
        if self._space is not None:
            raise RuntimeError("part() on an attached assembly: add parts before attach()")
        if not isinstance(shape, pymunk.Shape):
            raise ValueError(f"shape must be a pymunk.Shape, got {type(shape).__name__}")
        if isinstance(shape, pymunk.Segment) and shape.radius == 0.0:
            raise ValueError("expected a shape with an area, got a Segment of radius 0")
        body = shape.body
        if body is None or body.body_type == pymunk.Body.STATIC:
            raise ValueError("expected the shape of a dynamic or kinematic body, got one of a static body")
        if any(other.body is body for other, _ in self._parts):
            raise ValueError("expected one part a body, got a second shape of the same body")
        made = outline_body(
            Outline.from_pymunk(shape), material, level, mesh, contact=contact, hub=hub, modes=modes, refine=refine,
            damping=damping, cache=self._cache,
        )  # fmt: skip
        if level != "rigid" and mesh is not None:
            self._size = min(self._size, float(np.min(mesh)))
        self._parts.append((shape, made))
        return len(self._parts) - 1

    # --- what it shows ---

    def forces(self) -> dict[tuple[int, int], tuple[float, float]]:
        """Contact force on the second of each pair of parts that touch, at the end of the last frame."""
        sim = self._running()
        out = {}
        for (i, j), force in zip(sim.pairs.tolist(), sim._buffers.force, strict=True):
            if force.any():
                out[i, j] = (float(force[0]), float(force[1]))
        return out

    def rows(self, kind: np.dtype) -> NDArray[Any]:
        """Contact regions between parts at the end of the last frame, as `AreaContact.regions` has them (dtype
        ``kind``)."""
        sim = self._running()
        rows = sim._buffers.regions[: sim.counts()[1]]
        out = np.zeros(len(rows), kind)
        for row, (pair, force, nx, ny, x, y, chord) in zip(out, rows[:, :7].tolist(), strict=True):
            for side, part in zip("ab", sim.pairs[int(pair)], strict=True):
                shape = self._parts[part][0]
                row[f"shape_{side}"], row[f"body_{side}"] = shape, shape.body
            row["area"], row["stiffness"], row["force"] = force / self._k, self._k, force
            row["direction"], row["centroid"], row["chord"] = (nx, ny), (x, y), chord
        return out

    def state(self, part: int) -> State:
        """Displacements and stresses of a part at the end of the last frame. ValueError for a rigid part."""
        sim = self._running()
        if not 0 <= part < len(self._parts):
            raise ValueError(f"expected a part from 0 to {len(self._parts) - 1}, got {part}")
        shape = sim.bodies[part].shape
        if shape is None:
            raise ValueError(f"part {part} is rigid: expected one with a mesh")
        work, first = sim.works[part], sim.system.first
        nodes = work.loaded[: work.loaded[-1]]
        loads = np.column_stack([nodes, work.node_load[nodes]])
        modal = sim.state.q[first[part] : first[part + 1]]
        u = shape.displacement(modal, loads, work.hub_load, float(np.sqrt(work.spin[0])))
        owner, made = self._parts[part]
        body = owner.body
        assert body is not None
        frame = np.array([*body.local_to_world(made.position), body.angle])
        return State(shape, frame, shape.turned(u), shape.stress(u))

    def _running(self) -> Simulation:
        if self.simulation is None or self._space is None:
            raise RuntimeError("this assembly is in no space: rigidarea.attach(space, flexible=…) first")
        return self.simulation

    # --- in a space: what the area contact calls ---

    def enter(self, space: pymunk.Space) -> None:
        """Takes its parts' motion over. ValueError for bodies of another space, parts that overlap too deeply, and
        position and velocity functions of the user's on a part or on what joints tie to one."""
        if self._space is not None:
            raise ValueError("this assembly is in a space already: expected one that is free")
        if len(self._parts) == 0:
            raise ValueError("an assembly needs at least 1 part, got 0")
        for n, (shape, _) in enumerate(self._parts):
            if shape.space is not space or shape.body is None or shape.body.space is not space:
                raise ValueError(f"part {n}: expected its shape and body in the space, got them elsewhere")
        self._tied = Tied(self._parts, tuple(space.constraints))
        self._space, self._apart = space, []  # from here on leave() undoes it
        self._start()
        # a joint that does nothing but keep Chipmunk and the area contact from colliding them, unseen by pymunk
        for (one, _), (two, _) in combinations(self._parts, 2):
            joint = lib.cpSimpleMotorNew(one.body._body, two.body._body, 0.0)  # type: ignore[union-attr]
            lib.cpConstraintSetMaxForce(joint, 0.0)
            lib.cpConstraintSetCollideBodies(joint, False)
            lib.cpSpaceAddConstraint(space._space, joint)
            self._apart.append(joint)
        if self._memory is not None:
            self._tied.recall(self._memory[-1])
            self._memory = None
        self._compile(space)

    def leave(self, space: pymunk.Space) -> None:
        """Gives the bodies back to pymunk, if they are in this space."""
        if self._space is not space:
            return
        for joint in self._apart:
            lib.cpSpaceRemoveConstraint(space._space, joint)
            lib.cpConstraintFree(joint)
        self._tied.release()
        self._space = None

    def _pairs(self) -> list[tuple[int, int]]:
        """Which parts may touch, as pymunk has it: not sensors, nor what filters or a joint keep apart."""
        apart = self._tied.apart()
        told = [(n, s.body, s.filter) for n, (s, _) in enumerate(self._parts) if not s.sensor]
        return [
            (i, j)
            for (i, one, a), (j, two, b) in combinations(told, 2)
            if not a.rejects_collision(b) and frozenset((one, two)) not in apart
        ]

    def _start(self) -> None:
        """The stepper, with every frame given: it finds loads and modes."""
        bodies = []
        for shape, made in self._parts:
            body = shape.body
            assert body is not None
            x, y = body.local_to_world(made.position)
            bodies.append(replace(made, position=(float(x), float(y)), angle=body.angle, fixed=True))
        size = min(float(np.linalg.norm(b.boundary.points, axis=1).max()) for b in bodies)
        self.simulation = Simulation(bodies, self._pairs(), self._k, self._q, margin=0.01 * size)
        self._step, self._before = math.inf, 0.0
        # fastest that joints have held: for how long it has been looked at, in that time, in the LASTS before
        self._swings = 0.0, 0.0, 0.0
        if self._memory is not None:
            self._step, self._before, self._swings, arrays, _ = self._memory
            for array, old in zip(self._kept(), arrays, strict=True):
                array[:] = old

    def _pair_anew(self, pairs: list[tuple[int, int]]) -> None:
        """The stepper goes on with these pairs of parts, where they are others than before."""
        sim = self.simulation
        assert sim is not None
        before = list(map(tuple, sim.pairs.tolist()))
        if pairs == before:
            return
        for spring in sim._buffers.springs[1]:  # friction's, of the pairs that stay
            pair = before[int(spring[0])] if 0 <= spring[0] < len(before) else ()
            spring[0] = pairs.index(pair) if pair in pairs else -1
        self._memory = self._step, self._before, self._swings, self._kept(), None
        self._start()
        self._memory = None

    def _compile(self, space: pymunk.Space) -> None:
        """Has what a frame calls compiled now, on no bodies and for no steps, and not in the first frame."""
        sim, tied = self.simulation, self._tied
        assert sim is not None
        none = tied.members[:0]
        gather(none, tied.offsets, *space.gravity, space.damping, 0.0)
        advance(
            sim._table, sim.system, sim.state, sim.pairs, sim.settings, sim.scratch, sim._searches, sim._buffers,
            tied.members, tied.links, tied.offsets, 0.0, 0, space.iterations, 1.0,
        )  # fmt: skip
        give_back(none, none.copy(), tied.offsets, 0.0)
        note_rest(none, tied.offsets, 1.0)

    # --- a frame ---

    def step(self, dt: float, rest: Callable[[], None], idle: int) -> None:
        """A frame of dt: the parts' motion, then ``rest``, the space's own frame.

        idle: address of the class of a joint that does nothing. Raises RuntimeError, all bodies as before, where the
        parts' motion fails or a part has left the space, ValueError for what ``enter`` refuses and has come since.
        """
        space = self._space
        assert space is not None
        finite(dt, "dt")
        if dt > 0:
            for n, (shape, _) in enumerate(self._parts):
                if shape.space is not space:
                    raise RuntimeError(f"part {n} has left the space: expected it there until detach()")
            constraints = tuple(space.constraints)
            if constraints != self._tied.constraints or not self._tied.holds():
                self._tied.release()
                self._tied = Tied(self._parts, constraints, self._tied)
            self._pair_anew(self._pairs())
            if math.isfinite(space.sleep_time_threshold):
                self._tied.stay_awake()
            self._move(space, dt)
        self._tied.rest_of_frame(dt, rest, idle)
        if dt > 0:
            note_rest(self._tied.members, self._tied.offsets, dt)

    def _move(self, space: pymunk.Space, dt: float) -> None:
        sim, tied = self.simulation, self._tied
        assert sim is not None
        gather(tied.members, tied.offsets, *space.gravity, space.damping, dt)
        tied.check()
        self._read_shapes(sim)
        start, links = tied.members.copy(), tied.links.copy()
        kept = [a.copy() for a in self._kept()]
        longest = min(self._step, self._longest or math.inf, self._travel(start, dt))
        asked, tries, code, stiffest = max(1.0, dt / longest - 1e-9), 0, 0, 0.0
        while tries < TRIES and asked <= MOST_STEPS:
            steps, tries = math.ceil(asked), tries + 1
            links["x"] = links["y"] = 0.0
            tied.links[:] = links
            code, stiffest = advance(
                sim._table, sim.system, sim.state, sim.pairs, sim.settings, sim.scratch, sim._searches, sim._buffers,
                tied.members, tied.links, tied.offsets, dt / steps, steps, space.iterations,
                self._before or dt / steps,
            )  # fmt: skip
            fits = stiffest * (dt / steps) ** 2 <= (2 * RESOLVED) ** 2
            if code >= 0 and fits and np.isfinite(tied.members["vx"]).all():
                break
            if code == FULL:
                sim._make_room(2 * len(sim.scratch.load.force), sim._buffers)
            else:
                asked = max(2.0 * steps, math.sqrt(stiffest) * dt / RESOLVED)
            tied.members[:] = start
            for array, old in zip(self._kept(), kept, strict=True):
                array[:] = old
        else:
            tied.links[:] = links
            give_back(start, start, tied.offsets, 0.0)
            told = f"a frame of {dt:g} of the flexible parts, tried {tries} times"
            if code < 0:
                raise RuntimeError(f"{told}, at last with h = {dt / steps:g}: {sim._trouble(code)}")
            raise RuntimeError(
                f"{told}, asks for {asked:.3g} steps, expected at most {MOST_STEPS}: velocities up to"
                f" {np.hypot(start['vx'], start['vy']).max():.3g}, contacts' angular frequencies up to"
                f" {math.sqrt(stiffest):.3g}"
            )
        self._before, self.steps = dt / steps, steps
        fastest = RESOLVED / math.sqrt(stiffest) if stiffest > 0 else math.inf
        self._step = min(fastest, COARSER * (dt / steps if tries > 1 else self._step))
        give_back(tied.members, start, tied.offsets, dt)

    def _read_shapes(self, sim: Simulation) -> None:
        """Inertia, and each pair's friction and elasticity: the products of its shapes', as pymunk has them."""
        for n, a in enumerate(self._tied.members[: len(self._parts)]):
            sim.system.inverse[n] = a["inverse_mass"], a["inverse_moment"]
        for p, (i, j) in enumerate(sim.pairs.tolist()):
            one, two = self._parts[i][0], self._parts[j][0]
            sim.system.friction[p] = one.friction * two.friction
            sim.system.ratio[p] = damping_ratio(one.elasticity * two.elasticity)

    def _kept(self) -> list[Any]:
        """What a frame starts from, beside the members: modes, loads and friction's springs of the step before."""
        sim = self.simulation
        assert sim is not None
        loads = [a for w in sim.works for a in (w.node_load, w.node_flag, w.hub_load, w.loaded)]
        return [*sim.state, *loads, sim._buffers.held, sim._buffers.springs[1, :SPRINGS_KEPT]]

    def _travel(self, members: Any, dt: float) -> float:
        """Time in which no boundary moves by more than TRAVEL of the mesh size: of parts that may meet another in dt,
        against it; of parts that joints hold, in the world. What flies alone flies as exactly in one step."""
        sim = self.simulation
        assert sim is not None
        size = self._size if math.isfinite(self._size) else 0.05 * float(sim.system.size.min())
        parts = members[: len(self._parts)]
        turn = np.exp(1j * parts["angle"])
        arm = turn * (parts["off_x"] + 1j * parts["off_y"])
        at = parts["x"] + 1j * parts["y"] + arm
        v = parts["vx"] + 1j * parts["vy"] + 1j * parts["w"] * arm
        a = parts["ax"] + 1j * parts["ay"]
        spin = np.abs(parts["w"]) * sim.system.size
        i, j = sim.pairs.T
        speed = np.abs(v[i] - v[j])
        reach = 2.0 * (speed + np.abs(a[i] - a[j]) * dt) * dt + size  # contacts and joints may make it faster
        near = np.abs(at[i] - at[j]) < sim.system.size[i] + sim.system.size[j] + reach
        links = self._tied.links
        held = np.isin(np.arange(len(parts)), [links["a"], links["b"]])
        swings = float((np.abs(v) + spin)[held].max(initial=0.0))
        since, most, before = self._swings
        if since >= LASTS:
            since, most, before = 0.0, 0.0, most
        self._swings = since + dt, max(most, swings), before
        fastest = max(float((speed + np.maximum(spin[i], spin[j]))[near].max(initial=0.0)), *self._swings[1:])
        return TRAVEL * size / fastest if fastest > 0 else math.inf

    # --- copies ---

    def __getstate__(self) -> dict[str, Any]:
        names = ("_k", "_q", "_longest", "_cache", "_parts", "_size", "steps")
        memory = None
        if self._space is not None:
            arrays = [a.copy() for a in self._kept()]
            memory = self._step, self._before, self._swings, arrays, self._tied.memory()
        kept = {name: self.__dict__[name] for name in names}
        return kept | {"_space": None, "simulation": None, "_memory": memory}
