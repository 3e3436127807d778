"""A scene of the studies as a user would have it: its space, run with given settings or by a plan."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import pymunk
from pymunk._chipmunk_cffi import lib

from rigidarea import chipmunk as area
from rigidarea.plan.plan import Plan
from rigidarea.study import user_space
from rigidarea.study.peers.base import drive
from rigidarea.study.peers.pymunk_peer import SpaceRun
from rigidarea.study.records import Row
from rigidarea.study.scene import Array, Scene

Joints = Callable[[dict[str, pymunk.Body]], list[pymunk.Constraint]]
"""Joints between bodies by name; "" is the space's static body."""


@dataclass(frozen=True)
class Tied(Scene):
    """A scene with joints of pymunk's own: springs, strings, motors, grooves."""

    ties: Joints = lambda _: []


def space_of(scene: Scene) -> tuple[pymunk.Space, list[pymunk.Body]]:
    """A scene as a user would build it."""
    space, bodies = user_space.space_of(scene)
    if isinstance(scene, Tied):
        named = {body.name: made for body, made in zip(scene.bodies, bodies)}
        space.add(*scene.ties({**named, "": space.static_body}))
    return space, bodies


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
