"""A scene of the studies as a user would have it: its space, run with given settings or by a plan."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache, partial
from typing import Any

import numpy as np
import pymunk
from pymunk._chipmunk_cffi import lib

from .. import contact as area
from ..outline import Outline
from ..study.peers.base import drive
from ..study.peers.chipmunk import SpaceRun, add_joints, make_body, plain_shape, surface
from ..study.records import Row
from ..study.scene import Array, Curve, Scene
from .plan import Plan


@cache
def _outline(curve: Curve, tolerance: float) -> Outline:
    """A curve's outline, which knows how to be sampled anew."""
    outer, holes = curve.rings(tolerance)
    return Outline(outer, holes).with_curve(partial(_outline, curve))


def space_of(scene: Scene) -> tuple[pymunk.Space, list[pymunk.Body]]:
    """A scene as a user would build it: arcs are arcs, other curves are sampled to a thousandth of its size."""
    space = pymunk.Space()
    space.gravity = scene.gravity
    made: dict[str, pymunk.Body] = {}
    for body in scene.bodies:
        made[body.name] = here = make_body(body)
        shapes: list[pymunk.Shape] = []
        for shape in body.shapes:
            if not isinstance(shape, Curve):
                shapes.append(plain_shape(shape, here))
            elif shape.exact is not None:
                shapes.append(shape.exact().add_to(here))
            else:
                shapes.append(_outline(shape, 1e-3 * scene.size).add_to(here))
        for made_shape in shapes:
            surface(made_shape, scene, body)
        space.add(here, *shapes)
    add_joints(scene, space, made)
    return space, list(made.values())


class Trial(SpaceRun):
    """A run of a scene's space, `steps` a frame: by its contact (None: Chipmunk's own response)."""

    def __init__(
        self,
        scene: Scene,
        space: pymunk.Space,
        bodies: list[pymunk.Body],
        steps: int,
        contact: area.AreaContact | None,
        plan: Plan | None = None,
    ) -> None:
        super().__init__(scene, space, bodies, steps)
        self.frame, self.contact, self.plan, self.failed = scene.frame, contact, plan, False

    def advance(self, frames: int) -> None:
        """All frames in one call, in machine code."""
        if self.contact is None:
            drive(lib.cpSpaceStep, frames * self.steps, self.space._space, self.h)
        elif not self.failed:
            try:
                self.contact.step(self.frame, frames, steps=self.steps)
            except area.SimulationError:
                self.failed = True

    def state(self) -> Array:
        """States (n_body, 6); no numbers once a contact has failed."""
        states = super().state()
        return np.full_like(states, np.nan) if self.failed else states


def planned(scene: Scene, chosen: Callable[[pymunk.Space], Plan]) -> Trial:
    """The run of a plan that is given the scene's space alone."""
    space, bodies = space_of(scene)
    plan = chosen(space)
    contact = plan.apply()
    return Trial(scene, space, bodies, plan.steps, contact, plan)


def at_settings(scene: Scene, settings: Row) -> Trial:
    """The run with settings of the grid: `level`, `steps`, `sweeps`, `penetration`, perhaps `sampling`."""
    space, bodies = space_of(scene)
    space.iterations = settings["sweeps"]
    if settings.get("sampling"):
        for shape in space.shapes:
            outline: Any = getattr(shape, "outline", None)
            if outline is not None and not outline.arcs:
                shape.outline = outline.sample(settings["sampling"] * scene.size)  # type: ignore[attr-defined]
    contact = None
    if settings["level"] == "pymunk":
        space.collision_slop = settings["penetration"] * scene.size
    else:
        contact = area.attach(space, penetration=settings["penetration"])
    return Trial(scene, space, bodies, int(settings["steps"]), contact)
