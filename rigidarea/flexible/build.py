"""A mechanism of one's own, put together by name: bodies, pivots, drives, loads, contacts, then a run.

A pinion in a ring gear, lengths in metres:

    from rigidarea.flexible import Material, Mechanism
    from rigidarea.shapes import internal_gear, involute_gear

    steel = Material(young=207e9, poisson=0.29, density=7800.0, thickness=0.02)
    m = Mechanism(k=2e10)  # N/m²: contact force per overlap area
    pinion = m.body(involute_gear(2e-3, 20, bore=6e-3), steel, mesh=1e-3, hub=1)
    ring = m.body(internal_gear(2e-3, 60), steel, mesh=1e-3, at=(-0.04, 0.0), hub=0, contact=(1,))
    m.pivot(pinion, (0.0, 0.0))
    m.drive(pinion, 20.0, ramp=0.01)  # rad/s
    m.pivot(ring, (-0.04, 0.0))
    m.load(ring, damper=0.5)  # N m s
    m.contact(pinion, ring)
    record = m.run(0.05, 2e-5, shapes=True)
    print(record.hub_rate[-1, 1] / record.hub_rate[-1, 0])  # 20/60
    stress = m.state(record, -1, pinion).stress  # (triangles, 3)
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rigidarea.flexible.body import outline_body
from rigidarea.flexible.check import check_settings
from rigidarea.flexible.element import Material
from rigidarea.flexible.integrate import Body, Record, Simulation
from rigidarea.flexible.mechanism_joints import Joint
from rigidarea.flexible.recover import State, recover
from rigidarea.geometry.gate import finite, not_negative, numbers
from rigidarea.geometry.outline import Outline

Array = NDArray[np.float64]

MARGIN = 0.01  # of the smallest contact ring's radius: how far bodies move before contact is searched anew


class Mechanism:
    """Bodies and what holds, drives and loads them; SI or any consistent units.

    k: contact stiffness, force per overlap area. gravity (2,). rho: spectral radius at infinity of the scheme, below 1
    with pivots or drives. contact: "area" or "sts" (then ``reach``, the deepest penetration looked at). cache: a
    directory for meshes and reductions. All methods raise ValueError for settings out of range.
    """

    def __init__(
        self,
        k: float,
        *,
        gravity: tuple[float, float] = (0.0, 0.0),
        rho: float = 0.8,
        contact: str = "area",
        reach: float = 0.0,
        cache: Path | str | None = None,
    ) -> None:
        check_settings(k, 1.0, contact, reach, 0.0, rho, gravity)
        self._settings: dict[str, Any] = {
            "k": k,
            "gravity": gravity,
            "rho": rho,
            "contact": contact,
            "reach": reach,
        }
        self._cache = cache
        self._bodies: list[Body] = []
        self._pairs: list[tuple[int, int]] = []
        self._held: list[tuple[float, float]] = []  # friction and restitution of each
        self._joints: list[Joint] = []
        self.simulation: Simulation | None = None
        """The simulation of the last ``run``; None before."""

    def body(
        self,
        outline: Outline,
        material: Material,
        *,
        mesh: float | Sequence[float] | None = None,
        level: str = "compliant",
        at: tuple[float, float] = (0.0, 0.0),
        angle: float = 0.0,
        velocity: tuple[float, float, float] = (0.0, 0.0, 0.0),
        hub: int | None = None,
        contact: Sequence[int] = (0,),
        clamp: int | Callable[[Array], NDArray[np.bool_]] | None = None,
        modes: int = 40,
        refine: int = 4,
        growth: float = 0.15,
        sides: int = 2,
        damping: float = 0.0,
    ) -> int:
        """Adds a body; returns its number.

        at, angle: of the outline's coordinates. mesh: spacing of the boundary nodes (length), one for all rings or one
        each; growth, sides: how it goes on inside, see ``body.elastic_body``. level: "rigid" (then no
        mesh), "compliant" or "modal" with ``modes``. hub: the ring (0 outer, 1 … the holes) whose mean is pivoted,
        driven and loaded; for a rigid body that is the pivot itself. contact: the rings that touch others; refine:
        contact points a mesh edge. clamp: a ring that is held, or a function that says which of the boundary nodes
        (n, 2) are. damping: ratio of all modes. Raises ValueError for settings out of range.
        """
        made = outline_body(
            outline, material, level, mesh, contact=contact, hub=hub, clamp=clamp, modes=modes, refine=refine,
            growth=growth, sides=sides, damping=damping, at=at, angle=angle, cache=self._cache,
        )  # fmt: skip
        made.velocity = numbers(velocity, "velocity", 3)  # type: ignore[assignment]
        self._bodies.append(made)
        return len(self._bodies) - 1

    def ground(self, outline: Outline, at: tuple[float, float] = (0.0, 0.0), angle: float = 0.0) -> int:
        """Adds a rigid body that never moves; returns its number."""
        if not isinstance(outline, Outline):
            raise ValueError(f"outline must be an Outline, got {type(outline).__name__}")
        rings = range(len(outline.rings))
        made = outline_body(
            outline, Material(1.0, 0.0, 1.0), "rigid", None, contact=rings, at=at, angle=angle
        )
        self._bodies.append(replace(made, fixed=True))
        return len(self._bodies) - 1

    def _own(self, body: int) -> Body:
        if not isinstance(body, int | np.integer) or not 0 <= body < len(self._bodies):
            raise ValueError(f"expected a body from 0 to {len(self._bodies) - 1}, got {body!r:.80}")
        return self._bodies[body]

    def pivot(self, body: int, at: tuple[float, float]) -> None:
        """Pins the body's hub to a world point by a revolute joint; a body without a hub ring at the point under it."""
        b = self._own(body)
        at = numbers(at, "at", 2)  # type: ignore[assignment]
        if b.shape is None or b.shape.hub is None:
            b.hub = self._local(body, at)
        b.anchor = at

    def _local(self, body: int | None, at: tuple[float, float]) -> tuple[float, float]:
        """A world point in a body's frame; None: the ground's."""
        if body is None:
            return at
        b = self._own(body)
        c, s = np.cos(b.angle), np.sin(b.angle)
        dx, dy = at[0] - b.position[0], at[1] - b.position[1]
        return float(c * dx + s * dy), float(-s * dx + c * dy)

    def _join(
        self,
        kind: str,
        a: int | None,
        b: int,
        at_a: tuple[float, float],
        at_b: tuple[float, float],
        **keys: Any,
    ) -> int:
        """A joint between places that the bodies have now; its number in ``Record.joints``."""
        turned = self._own(b).angle - (0.0 if a is None else self._own(a).angle)
        keys = {"angle": turned, **keys}
        for name in ("rest", "stiffness", "damping"):
            if name in keys:
                keys[name] = not_negative(keys[name], name)
        self._joints.append(
            Joint(kind, -1 if a is None else a, b, self._local(a, at_a), self._local(b, at_b), **keys)
        )
        return len(self._joints) - 1

    def revolute(self, body: int, at: tuple[float, float], to: int | None = None) -> int:
        """Pins a body to another one (None: the ground) at a world point; frames are held, see ``joints``.

        Returns the joint's number in ``Record.joints``, as ``slider``, ``weld`` and ``spring`` do.
        """
        at = numbers(at, "at", 2)  # type: ignore[assignment]
        return self._join("revolute", to, body, at, at)

    def slider(self, body: int, axis: tuple[float, float], to: int | None = None) -> int:
        """Lets a body move along ``axis`` (a direction, world; it turns with ``to``) and nowhere else, nor turn."""
        centre = self._own(body).position
        axis = numbers(axis, "axis", 2)  # type: ignore[assignment]
        c, s = (1.0, 0.0) if to is None else (np.cos(self._own(to).angle), np.sin(self._own(to).angle))
        local = (float(c * axis[0] + s * axis[1]), float(-s * axis[0] + c * axis[1]))
        return self._join("slider", to, body, centre, centre, axis=local)

    def weld(self, body: int, at: tuple[float, float], to: int | None = None) -> int:
        """Holds a body's frame to another one, or the ground; force and moment are recorded at ``at``."""
        at = numbers(at, "at", 2)  # type: ignore[assignment]
        return self._join("weld", to, body, at, at)

    def spring(
        self,
        body: int,
        at: tuple[float, float],
        other_end: tuple[float, float],
        to: int | None = None,
        *,
        stiffness: float,
        damping: float = 0.0,
        rest: float | None = None,
    ) -> int:
        """A spring and a damper from ``at`` on a body to ``other_end`` on another, or the ground (world points).

        stiffness: force/length; damping: force/velocity; rest: length without force, None: as it is now.
        """
        at, other_end = numbers(at, "at", 2), numbers(other_end, "other_end", 2)  # type: ignore[assignment]
        length = float(np.hypot(at[0] - other_end[0], at[1] - other_end[1]))
        return self._join(
            "spring", to, body, other_end, at, stiffness=stiffness, damping=damping,
            rest=length if rest is None else rest,
        )  # fmt: skip

    def drive(self, body: int, speed: float, ramp: float = 0.0) -> None:
        """Prescribes the hub's angular velocity: from 0, linearly over ``ramp``, to ``speed``.

        Something must hold the body: a pivot, or a revolute joint to what is held.
        """
        b = self._own(body)
        b.drive = (b.angle, finite(speed, "speed"), not_negative(ramp, "ramp"))

    def load(self, body: int, torque: float = 0.0, damper: float = 0.0) -> None:
        """A constant torque on the hub, and a damper (moment over angular velocity) between hub and ground."""
        b = self._own(body)
        b.torque, b.damper = finite(torque, "torque"), not_negative(damper, "damper")

    def contact(self, a: int, b: int, friction: float = 0.0, restitution: float = 1.0) -> None:
        """Lets two bodies touch; forces are recorded on ``b``. The laws of friction and damping: ``resist``."""
        self._own(a), self._own(b)
        friction, restitution = not_negative(friction, "friction"), not_negative(restitution, "restitution")
        self._pairs.append((a, b))
        self._held.append((friction, restitution))

    def run(self, duration: float, h: float, every: int = 1, shapes: bool = False) -> Record:
        """Runs the mechanism from its start; see ``Simulation.run``. Raises ValueError where parts do not fit."""
        joined = {n for j in self._joints if j.kind != "spring" for n in (j.a, j.b)}
        for n, b in enumerate(self._bodies):
            if b.drive is not None and b.anchor is None and n not in joined:
                raise ValueError(
                    f"body {n} has a drive, but nothing holds it: expected a pivot or a joint as well"
                )
        rings = [
            b.boundary.points[b.boundary.ring_of == k] for b in self._bodies for k in set(b.boundary.ring_of)
        ]
        margin = MARGIN * min((0.5 * float(np.hypot(*np.ptp(ring, axis=0))) for ring in rings), default=1.0)
        held = {"friction": [f for f, _ in self._held], "restitution": [e for _, e in self._held]}
        settings = {**self._settings, **held, "margin": margin, "joints": self._joints}
        self.simulation = Simulation(self._bodies, self._pairs, **settings)
        return self.simulation.run(duration, h, every, shapes)

    def state(self, record: Record, row: int, body: int) -> State:
        """Displacements and stresses of a body at a recorded instant of the last run (``recover.recover``)."""
        if self.simulation is None:
            raise ValueError("expected a run before its states, got none")
        return recover(self.simulation, record, row, body)
