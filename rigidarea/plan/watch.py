"""What stands beside a plan while it runs: measured numbers next to the predicted ones, one warning each, a new
plan."""

from __future__ import annotations

import math
import warnings
from typing import Any, NamedTuple

import pymunk

from ..chipmunk import attached
from .measures import extent_of, fastest, measure
from .promise import name_of

#: A measured number so many times the predicted one has outgrown the plan: below, it is what estimates are off by.
OUTGROWN = 3.0
#: Frames after the start in which contacts find their loads: nothing is warned of.
SETTLING = 3


class PlanWarning(UserWarning):
    """A scene has outgrown its plan."""


class Indicator(NamedTuple):
    """A measured number and the predicted one, in the same unit, and the pair or body where it is largest."""

    measured: float
    predicted: float
    where: str

    @property
    def outgrown(self) -> bool:
        """Whether the measured one is more than `OUTGROWN` times the predicted one."""
        return self.measured > OUTGROWN * self.predicted


class Watch:
    """Looks between frames. `step` steps by the plan and looks; or step yourself and call `look` after each frame.

    indicators, a dict by name, as of the last look:

    - "penetration": depth over the smaller body's extent, of contacts that are not being hit;
    - "phase": w h of the stiffest contact (radians a substep);
    - "load": the largest force over the smaller body's weight;
    - "speed": the fastest body, its rim included (length/time);
    - "sweeps": what contacts still close by in a substep, over the extent: what the sweeps have left;
    - "energy": gain since the last look over the largest so far, of a space that nothing drives (dimensionless);
    - "strain": contact pressure over Young's modulus, of bodies with a material.

    "bodies" warns where some have come or gone. An indicator that outgrows the plan warns once (`PlanWarning`),
    naming pair and number. With adapt=True the plan is made anew there and then: substeps and sweeps may grow,
    stiffness and outlines stay, so that no state jumps."""

    def __init__(self, plan: Any, adapt: bool = False) -> None:
        self.plan = plan
        self.adapt = adapt
        self.indicators: dict[str, Indicator] = {}
        self.warned: set[str] = set()
        self._frames = 0
        self._energy: float | None = None
        self._scale = 0.0
        self._bodies = len(plan.space.bodies), len(plan.space.shapes)
        self.promised: dict[str, float] = {}
        self._promise()

    def _promise(self) -> None:
        """What the plan's own numbers are, as of now; where it was planned anew, for what it has grown to."""
        plan = self.plan
        # what the bodies would get in falling by their own extent (force length)
        self._weight = plan.space.gravity.length * sum(
            body.mass * min(map(extent_of, body.shapes), default=0.0)
            for body in plan.space.bodies
            if body.body_type == pymunk.Body.DYNAMIC
        )
        seen = {name: value for name, (value, _) in plan._found.seen.measured.items()}
        promised = {
            # what is no deeper than the tolerance has outgrown nothing
            "penetration": max(seen.get("penetration", plan.penetration), plan.tolerance / OUTGROWN),
            "phase": seen.get("phase", math.inf),
            "load": seen.get("load", 1.0 if plan.space.gravity.length else math.inf),
            "speed": seen.get("speed", 0.0),
            "sweeps": max(seen.get("sweeps", 0.0), plan.tolerance),
            "energy": plan.tolerance / OUTGROWN,
            "strain": plan.tolerance,
        }
        self.promised = {name: max(value, self.promised.get(name, 0.0)) for name, value in promised.items()}

    # --- looking ---

    def step(self, dt: float | None = None, frames: int = 1) -> None:
        """Frames by the plan, a look after each."""
        for _ in range(frames):
            self.plan.step(dt)
            self.look()

    def look(self) -> dict[str, Indicator]:
        """Measure, warn, and with `adapt` plan anew. Returns the indicators."""
        self._frames += 1
        found = len(self.plan.space.bodies), len(self.plan.space.shapes)
        if found != self._bodies:
            self._warn("bodies", "the space", float(found[0]), float(self._bodies[0]))
            self._bodies = found
            self._energy = None
            self._frames = 0  # what has come anew has to find its loads
            if self.adapt:
                self._plan_anew([])
        self.indicators = {
            name: Indicator(value, self.promised[name], where)
            for name, (value, where) in self._measure().items()
        }
        settled = self._frames > SETTLING
        grown = [name for name, indicator in self.indicators.items() if settled and indicator.outgrown]
        for name in grown:
            indicator = self.indicators[name]
            self._warn(name, indicator.where, indicator.measured, indicator.predicted)
        if grown and self.adapt:
            self._plan_anew(grown)
        return self.indicators

    def _warn(self, name: str, where: str, measured: float, predicted: float) -> None:
        if name not in self.warned:
            self.warned.add(name)
            text = f"the scene has outgrown its plan: {name} of {where} is {measured:.3g}, planned for {predicted:.3g}"
            warnings.warn(text, PlanWarning, stacklevel=4)

    def _plan_anew(self, grown: list[str]) -> None:
        plan = self.plan
        plan.again(keep=True)
        plan.apply()
        self._promise()
        for name in grown:  # what has been answered is what is now expected
            self.promised[name] = max(self.promised[name], self.indicators[name].measured)

    def _measure(self) -> dict[str, tuple[float, str]]:
        plan, space = self.plan, self.plan.space
        contact = attached(space)
        worst = {"speed": fastest(space)}
        if contact is not None:
            measure(contact, contact.regions, plan.frame / plan.steps, worst, plan.materials, {})
        found = {name: (value, name_of(space, where)) for name, (value, where) in worst.items()}
        if contact is not None and not _driven(space):
            energy = contact.energy()
            kinetic = 0.5 * sum(body.kinetic_energy for body in space.bodies)
            self._scale = max(self._scale, kinetic, self._weight)
            if self._energy is not None and self._scale > 0.0:
                found["energy"] = max(0.0, energy - self._energy) / self._scale, "the space"
            self._energy = energy
        return found


def _driven(space: pymunk.Space) -> bool:
    """Whether something may do work on the bodies: motors, springs, belts, kinematic bodies that move."""
    kinematic = [body for body in space.bodies if body.body_type == pymunk.Body.KINEMATIC]
    works = pymunk.SimpleMotor | pymunk.DampedSpring | pymunk.DampedRotarySpring
    return (
        any(isinstance(joint, works) for joint in space.constraints)
        or any(body.velocity.length or body.angular_velocity for body in kinematic)
        or any(shape.surface_velocity != (0.0, 0.0) for shape in space.shapes)
    )
