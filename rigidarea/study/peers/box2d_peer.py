"""Box2D v3 by way of `pyb2d3` (soft-step solver, single precision, one thread)."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from ..decompose import convex_pieces
from ..scene import Array, Body, Circle, Polygon, Scene, Segment, oriented
from .base import Run, Settings, combined, drive, rigid_only, samplings

try:
    import pyb2d3 as b2
except ImportError:
    b2 = None

MOST_VERTICES = 8
"""Of a Box2D polygon (B2_MAX_POLYGON_VERTICES)."""
STEPPING = ((1, 4), (1, 8), (2, 4), (4, 1), (4, 4), (1, 16), (8, 4), (16, 1), (16, 4), (64, 1), (64, 4))
QUICK_STEPPING = ((1, 4), (4, 4), (16, 4), (64, 1))
"""Steps a frame and substeps a step that are swept."""


def _rotation(angle: float) -> Any:
    """Exact cosine and sine: Box2D's own `b2MakeRot` approximates them, which would shift the start by 2e-3 rad."""
    rotation = b2.make_rot(0.0)
    rotation.c, rotation.s = math.cos(angle), math.sin(angle)
    return rotation


class WorldRun:
    """A Box2D world in its own unit of length."""

    def __init__(self, scene: Scene, settings: Settings) -> None:
        self.unit = settings["length"] / scene.size
        steps, substeps = settings["steps"], settings["substeps"]
        self.steps, self.substeps, self.h = steps, substeps, scene.frame / steps
        gravity = tuple(self.unit * g for g in scene.gravity)
        hertz = settings.get("hertz", 30.0)
        if settings["stiff"]:
            # The stiffest contact that Box2D allows: it caps the frequency at a quarter of the substep rate.
            hertz = max(hertz, 0.25 * substeps / self.h)
        self.world = b2.World(gravity=gravity, contact_hertz=hertz, restitution_threshold=0.01)
        self.world.sleeping_enabled = False  # a sleeping scene would cost nothing and prove nothing
        tolerance = settings.get("sampling", 1e-3) * scene.size
        self.bodies = [self.add(scene, body, tolerance) for body in scene.bodies]
        self._joints(scene)

    def add(self, scene: Scene, body: Body, tolerance: float) -> Any:
        """Box2D's body of one of the scene's; curves are sampled to the tolerance (length)."""
        made = getattr(self.world, f"create_{body.kind}_body")(
            position=self._scaled(body.position),
            rotation=_rotation(body.angle),
            linear_velocity=self._scaled(body.velocity),
            angular_velocity=body.angular_velocity,
        )
        # Box2D mixes friction by the geometric mean and restitution by the maximum: equal values stay as they are.
        material = b2.surface_material(
            friction=scene.friction,
            restitution=scene.elasticity,
            tangent_speed=self.unit * body.surface_speed,
        )
        definition = b2.shape_def(density=1.0, material=material)
        for shape in body.shapes:
            if isinstance(shape, Circle):
                made.create_shape(definition, b2.circle(self._scaled(shape.center), self.unit * shape.radius))
            elif isinstance(shape, Polygon):
                corners, round_ = self.unit * np.array(shape.points), self.unit * shape.radius
                made.create_shape(definition, b2.polygon(corners, **({"radius": round_} if round_ else {})))
            elif isinstance(shape, Segment):
                ends = self._scaled(shape.a), self._scaled(shape.b)
                thick = self.unit * shape.radius
                made.create_shape(definition, b2.capsule(*ends, thick) if thick else b2.segment(*ends))
            elif body.kind == "static":
                # Box2D collides with the right-hand side of a chain; these rings have the solid on their left.
                for ring in oriented(shape.rings(tolerance)):
                    points = np.ascontiguousarray(self.unit * ring, dtype=np.float32)
                    made.create_chain(b2.chain_def(points, material=material, is_loop=True))
            else:
                for piece in convex_pieces(shape.rings(tolerance), MOST_VERTICES):
                    made.create_shape(definition, b2.polygon(self.unit * piece))
        if body.kind == "dynamic":
            data = made.mass_data
            data.mass, data.center = body.mass, (0.0, 0.0)
            # Box2D's bodies that do not turn have no inertia
            data.rotational_inertia = body.moment * self.unit**2 if math.isfinite(body.moment) else 0.0
            made.mass_data = data
        return made

    def _scaled(self, point: tuple[float, float]) -> tuple[float, float]:
        return self.unit * point[0], self.unit * point[1]

    def _joints(self, scene: Scene) -> None:
        if not scene.hinges:
            return
        ground = self.world.create_static_body(position=(0.0, 0.0))
        index = {body.name: i for i, body in enumerate(scene.bodies)}
        for hinge in scene.hinges:
            ends = self.bodies[index[hinge.a]], self.bodies[index[hinge.b]] if hinge.b else ground
            at, on = (body.local_point(self._scaled(hinge.point)) for body in ends)
            brake = {"enable_motor": hinge.brake > 0, "max_motor_torque": hinge.brake * self.unit**2}
            anchors = {"local_anchor_a": at, "local_anchor_b": on}
            self.world.create_revolute_joint(*ends, **anchors, **brake, motor_speed=0.0)

    def advance(self, frames: int) -> None:
        """World steps, called from a C loop."""
        drive(self.world.step, frames * self.steps, self.h, self.substeps)

    def state(self) -> Array:
        """States (n_body, 6) in the scene's units; angles wrapped to (−π, π]."""
        rows = []
        for body in self.bodies:
            p, v, q = body.position, body.linear_velocity, body.rotation
            angle = math.atan2(q.s, q.c)
            u = self.unit
            rows.append((p.x / u, p.y / u, angle, v.x / u, v.y / u, body.angular_velocity))
        return np.array(rows, dtype=np.float64)


class Box2D:
    """Box2D v3 as its documentation advises: metre-sized bodies, a fixed step with substeps.

    Settings: `steps` a frame; `substeps` a step; `stiff` (contact frequency at its cap instead of 30 Hz, or `hertz`);
    `length`, how many metres long a typical body is (its tolerances are fixed in metres, and it is made for
    bodies of 0.1 to 10 m); `sampling` of curves. The restitution threshold is lowered to 0.01 m/s, since the
    scenes want slow bounces.
    """

    name = "box2d"
    ours = False

    def refuses(self, scene: Scene) -> str:
        """What only elastic bodies answer; everything if `pyb2d3` is not installed."""
        return rigid_only(scene) if b2 is not None else "pyb2d3 is not installed (extra: studies)"

    def settings(self, scene: Scene, quick: bool) -> list[Settings]:
        """Steps × substeps × contact softness × sampling."""
        kinds = ((False, 1), (True, 10)) if quick else ((False, 1), (True, 1), (False, 10), (True, 10))
        stepping = [{"steps": n, "substeps": m} for n, m in (QUICK_STEPPING if quick else STEPPING)]
        contact = [{"stiff": stiff, "length": length} for stiff, length in kinds]
        return combined(stepping, contact, samplings(scene, quick))

    def default(self, scene: Scene) -> Settings:
        """One step of four substeps a frame, contacts of 30 Hz, bodies about a metre in size."""
        sampling = {"sampling": 1e-3} if samplings(scene, True) != [{}] else {}
        return {"steps": 1, "substeps": 4, "stiff": False, "length": 1, **sampling}

    def build(self, scene: Scene, settings: Settings) -> Run:
        """A world of Box2D shapes."""
        return WorldRun(scene, settings)


PEERS = (Box2D(),)
