"""rigidarea itself, the rigid level: frames in so many steps, frames as the library cuts them, explicit steps."""

from __future__ import annotations

import math
from typing import Any

import pymunk

import rigidarea

from ..scene import Body, Circle, Polygon, Scene
from .base import Run, Settings, drive, has_curves, rigid_only
from .chipmunk import SpaceRun, add_pivots, make_body, surface


def area_shapes(body: Body, made: pymunk.Body, tolerance: float | None) -> list[pymunk.Shape]:
    """Shapes for area contact: outlines as they are, concave or holed. tolerance None: the library's own."""
    shapes: list[pymunk.Shape] = []
    for shape in body.shapes:
        if isinstance(shape, Circle):
            circle = pymunk.Circle(made, shape.radius, shape.center)
            if tolerance is not None:
                circle.outline = rigidarea.Outline.from_pymunk(circle, tolerance)  # type: ignore[attr-defined]
            shapes.append(circle)
        elif isinstance(shape, Polygon):
            shapes.append(pymunk.Poly(made, shape.points))
        else:
            outer, holes = shape.rings(1e-3 if tolerance is None else tolerance)
            shapes.append(rigidarea.Outline(outer, holes).add_to(made))
    return shapes


def area_space(scene: Scene, settings: Settings) -> tuple[pymunk.Space, list[pymunk.Body], Any]:
    """A space with the scene's bodies and area contact attached: (space, bodies, contact).

    Settings: `stiffness` in multiples of the scene's pressure (none: the library chooses); `sampling` of
    curves over the body size; `phase`; any other setting but `steps` goes to `rigidarea.attach`.
    """
    space = pymunk.Space()
    space.gravity = scene.gravity
    sampling = settings.get("sampling")
    made: dict[str, pymunk.Body] = {}
    for body in scene.bodies:
        made[body.name] = make_body(body)
        shapes = area_shapes(body, made[body.name], None if sampling is None else sampling * scene.size)
        for shape in shapes:
            surface(shape, scene, body)
        space.add(made[body.name], *shapes)
    add_pivots(scene, space, made)
    more = {k: v for k, v in settings.items() if k not in ("stiffness", "sampling", "phase", "steps")}
    stiffness = settings.get("stiffness")
    contact = rigidarea.attach(space, None if stiffness is None else stiffness * scene.pressure, **more)
    if "phase" in settings:
        contact.phase = settings["phase"]
    contact.max_steps = 10**6
    return space, list(made.values()), contact


class StepRun(SpaceRun):
    """Equal steps straight through Chipmunk's step function, as for pymunk's own solver."""

    def __init__(
        self,
        scene: Scene,
        space: pymunk.Space,
        bodies: list[pymunk.Body],
        contact: Any,
        steps: int | None = None,
    ) -> None:
        super().__init__(scene, space, bodies, contact.steps(scene.frame) if steps is None else steps)
        self.contact, self.frame, self.wanted = contact, scene.frame, steps


class FrameRun(StepRun):
    """Frames in so many steps each: `contact.step(1/60, frames, steps)`, all in one call, in machine code."""

    def advance(self, frames: int) -> None:
        """Frames of the scene's length; a contact that fails leaves states that are not finite."""
        try:
            self.take(frames)
        except rigidarea.SimulationError:
            for body in self.bodies:
                body.position = (math.nan, math.nan)

    def take(self, frames: int) -> None:
        """The call itself."""
        self.contact.step(self.frame, frames, self.wanted)


class GameRun(FrameRun):
    """Frames as a game asks for them, one by one from Python: `contact.step(1/60)`."""

    def take(self, frames: int) -> None:
        """A call a frame."""
        drive(self.contact.step, frames, self.frame)


def area_samplings(scene: Scene, quick: bool) -> list[dict[str, float]]:
    """Chord tolerances over body size: finer than the peers', whose discs are exact and whose pieces are many."""
    values: tuple[float, ...] = ()
    if "gears" in scene.tags:
        values = (1e-3, 1e-5) if quick else (1e-2, 1e-3, 1e-4, 1e-5)
    elif scene.tags & {"curved", "rolling"}:
        values = (1e-3, 1e-5) if quick else (1e-3, 1e-4, 1e-5, 1e-6)
    elif has_curves(scene):
        values = (1e-4,) if quick else (1e-3, 1e-4, 1e-5)
    return [{"sampling": value} for value in values] or [{}]


class Area:
    """Frames in a given number of steps, contacts too stiff for the step taken implicitly (`integration`).

    Settings: `stiffness`, `steps` a frame, `sampling`; see `area_space`.
    """

    name = "rigidarea"
    ours = True

    def refuses(self, scene: Scene) -> str:
        """What only elastic bodies answer."""
        return rigid_only(scene)

    def settings(self, scene: Scene, quick: bool) -> list[Settings]:
        """Stiffness × steps × sampling."""
        stiffness = (1e6, 1e12) if quick else (1e4, 1e6, 1e8, 1e12)
        steps = (1, 4, 16) if quick else (1, 2, 4, 8, 16, 32, 64)
        return [
            {"stiffness": k, "steps": n, **sampling}
            for k in stiffness
            for n in steps
            for sampling in area_samplings(scene, quick)
        ]

    def build(self, scene: Scene, settings: Settings) -> Run:
        """An attached space, stepped by frames."""
        return FrameRun(scene, *area_space(scene, settings), settings.get("steps"))


class AreaFrames(Area):
    """As a user runs it: `attach(space)` and `contact.step(frame)`, stiffness and steps chosen by the library.

    Settings: the `penetration` allowed, or `stiffness` where there is no gravity to choose it by; `phase`; `sampling`.
    """

    name = "rigidarea-frame"

    def settings(self, scene: Scene, quick: bool) -> list[Settings]:
        """Penetration or stiffness × phase × sampling."""
        values = (2e-4,) if quick else (1e-2, 1e-3, 2e-4, 1e-5)
        knobs: list[dict[str, float]] = [{"penetration": value} for value in values]
        if scene.gravity == (0.0, 0.0):
            knobs = [{"stiffness": value} for value in ((1e2, 1e4) if quick else (1e2, 1e4, 1e6))]
        phases: list[dict[str, float]] = [{}] if quick else [{}, {"phase": 2.0}]
        return [
            {**knob, **phase, **sampling}
            for knob in knobs
            for phase in phases
            for sampling in area_samplings(scene, quick)
        ]

    def build(self, scene: Scene, settings: Settings) -> Run:
        """An attached space, stepped frame by frame."""
        return GameRun(scene, *area_space(scene, settings))


class AreaExplicit(Area):
    """Equal explicit steps (symplectic Euler) of F = k A, their number from `stiffness` and `phase` (ω h), kept."""

    name = "rigidarea-explicit"

    def settings(self, scene: Scene, quick: bool) -> list[Settings]:
        """Stiffness × phase × sampling."""
        stiffness = (1e3, 1e5) if quick else (1e3, 1e4, 1e5, 1e6)
        phases = (3.0,) if quick else (0.5, 3.0)
        if "impact" in scene.tags:  # restitution wants several steps within a contact
            phases = (0.5,) if quick else (0.25, 1.0)
        return [
            {"stiffness": k, "phase": phase, **sampling}
            for k in stiffness
            for phase in phases
            for sampling in area_samplings(scene, quick)
        ]

    def build(self, scene: Scene, settings: Settings) -> Run:
        """An attached space, stepped by Chipmunk's own function."""
        return StepRun(
            scene, *area_space(scene, {"integration": "explicit", **settings}), settings.get("steps")
        )


PEERS = (Area(), AreaFrames(), AreaExplicit())
