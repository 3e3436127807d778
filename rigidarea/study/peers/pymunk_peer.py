"""pymunk's own solver (Chipmunk's sequential impulses)."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pymunk
from pymunk._chipmunk_cffi import lib

from ..decompose import convex_pieces
from ..scene import Array, Body, Circle, Curve, Polygon, Scene, Segment
from .base import Run, Settings, combined, drive, knob, rigid_only, samplings


def make_body(body: Body) -> pymunk.Body:
    """The pymunk body of a scene's body, without shapes."""
    made = pymunk.Body(body.mass, body.moment, getattr(pymunk.Body, body.kind.upper()))
    made.position, made.angle = body.position, body.angle
    if body.kind != "static":
        made.velocity, made.angular_velocity = body.velocity, body.angular_velocity
    return made


def plain_shape(shape: Circle | Polygon | Segment, made: pymunk.Body) -> pymunk.Shape:
    """A disc, polygon or segment of a scene on a pymunk body."""
    if isinstance(shape, Circle):
        return pymunk.Circle(made, shape.radius, shape.center)
    if isinstance(shape, Polygon):
        return pymunk.Poly(made, shape.points, radius=shape.radius)
    return pymunk.Segment(made, shape.a, shape.b, shape.radius)


def plain_shapes(body: Body, made: pymunk.Body) -> list[pymunk.Shape]:
    """Those of a body without curves."""
    return [plain_shape(shape, made) for shape in body.shapes if not isinstance(shape, Curve)]


def convex_shapes(body: Body, made: pymunk.Body, tolerance: float) -> list[pymunk.Shape]:
    """Shapes for an engine of convex shapes: terrain as chains of segments, moving outlines as convex pieces."""
    shapes: list[pymunk.Shape] = []
    for shape in body.shapes:
        if not isinstance(shape, Curve):
            shapes.append(plain_shape(shape, made))
        elif body.kind == "static":
            for ring in shape.rings(tolerance):
                shapes += _chain(made, ring)
        else:
            shapes += [pymunk.Poly(made, piece.tolist()) for piece in convex_pieces(shape.rings(tolerance))]
    return shapes


def _chain(made: pymunk.Body, ring: Array) -> list[pymunk.Segment]:
    """Segments along a closed ring that know their neighbours, so that nothing catches on their joints."""
    points, chain = ring.tolist(), []
    for i, point in enumerate(points):
        following, next_but_one = (points[(i + k) % len(points)] for k in (1, 2))
        chain.append(pymunk.Segment(made, point, following, 0.0))
        chain[-1].set_neighbors(points[i - 1], next_but_one)
    return chain


def add_joints(scene: Scene, space: pymunk.Space, bodies: dict[str, pymunk.Body]) -> None:
    """Revolute joints, with a motor at rest as brake."""
    for hinge in scene.hinges:
        ends = bodies[hinge.a], bodies[hinge.b] if hinge.b else space.static_body
        joint = pymunk.PivotJoint(*ends, hinge.point)
        joint.collide_bodies = False
        space.add(joint)
        if hinge.brake:
            motor = pymunk.SimpleMotor(*ends, 0.0)
            motor.max_force = hinge.brake
            space.add(motor)


class SpaceRun:
    """A pymunk space and its bodies; steps of equal length, taken by Chipmunk's own step function."""

    contact: Any = None
    """What is attached to the space."""

    def __init__(self, scene: Scene, space: pymunk.Space, bodies: list[pymunk.Body], steps: int) -> None:
        self.space, self.bodies, self.steps = space, bodies, steps
        self.h = scene.frame / steps

    def advance(self, frames: int) -> None:
        """Steps straight through Chipmunk: pymunk's bookkeeping (0.4 µs a step) is not counted either."""
        drive(lib.cpSpaceStep, frames * self.steps, self.space._space, self.h)

    def contacts(self) -> int:
        """Pairs of shapes that touch."""
        pairs: set[frozenset[pymunk.Shape]] = set()
        for body in self.bodies:
            body.each_arbiter(lambda arbiter: pairs.add(frozenset(arbiter.shapes)))
        return len(pairs)

    def state(self) -> Array:
        """States (n_body, 6)."""
        return np.array(
            [(*b.position, b.angle, *b.velocity, b.angular_velocity) for b in self.bodies], dtype=np.float64
        )


def surface(shape: pymunk.Shape, scene: Scene, body: Body) -> None:
    """Friction and elasticity so that pymunk's product of the two shapes is the scene's value."""
    shape.friction = math.sqrt(scene.friction)
    shape.elasticity = math.sqrt(scene.elasticity)
    if body.surface_speed:
        shape.surface_velocity = (body.surface_speed, 0.0)


def make_space(
    scene: Scene, shapes_of: Callable[[Body, pymunk.Body], list[pymunk.Shape]]
) -> tuple[pymunk.Space, list[pymunk.Body]]:
    """A space with the scene's bodies, the shapes of each as `shapes_of(body, its pymunk body)` makes them, and joints;
    and the bodies."""
    space = pymunk.Space()
    space.gravity = scene.gravity
    made: dict[str, pymunk.Body] = {}
    for body in scene.bodies:
        made[body.name] = make_body(body)
        shapes = shapes_of(body, made[body.name])
        for shape in shapes:
            surface(shape, scene, body)
        space.add(made[body.name], *shapes)
    add_joints(scene, space, made)
    return space, list(made.values())


class Chipmunk:
    """pymunk as its users tune it: smaller steps, more iterations, a slop that suits the scene's size.

    Settings: `steps` a frame; `iterations`; `slop` as a fraction of the body size (its documentation: as
    high as you can without noticeable overlap); `sampling` of curves. The bias keeps pymunk's default.
    """

    name = "pymunk"
    ours = False

    def refuses(self, scene: Scene) -> str:
        """What only elastic bodies answer; all else can be put together from convex shapes."""
        return rigid_only(scene)

    def settings(self, scene: Scene, quick: bool) -> list[Settings]:
        """Steps × iterations × slop × sampling."""
        steps = (1, 4, 16, 64) if quick else (1, 2, 4, 8, 16, 32, 64)
        iterations = (10, 40) if not quick and scene.tags & {"stack", "gears"} else (10,)
        slops = (1e-3,) if quick else (1e-2, 1e-3, 1e-5)
        knobs = knob("steps", steps), knob("iterations", iterations), knob("slop", slops)
        return combined(*knobs, samplings(scene, quick))

    def default(self, scene: Scene) -> Settings:
        """One step a frame, ten iterations; the slop, 0.1 by default, as on bodies of 100 pixels."""
        sampling = {"sampling": 1e-3} if samplings(scene, True) != [{}] else {}
        return {"steps": 1, "iterations": 10, "slop": 1e-3, **sampling}

    def build(self, scene: Scene, settings: Settings) -> Run:
        """A space of pymunk's own shapes."""
        tolerance = settings.get("sampling", 1e-3) * scene.size
        space, bodies = make_space(scene, lambda body, made: convex_shapes(body, made, tolerance))
        space.iterations = settings["iterations"]
        space.collision_slop = settings["slop"] * scene.size
        return SpaceRun(scene, space, bodies, settings["steps"])


PEERS = (Chipmunk(),)
