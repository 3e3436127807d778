"""rigidarea's flexible submodule: generalised-alpha steps of rigid, compliant and modal bodies.

It is the paper's own setting, frictionless and without losses: scenes with friction, or with a restitution other
than 1, are refused. One mechanism of two bodies at a time (all static bodies are one ground): it has no broad phase.
"""

from __future__ import annotations

import copy
import math
from functools import cache
from typing import Any

import numpy as np

from ...geometry.outline import Outline
from ..scene import ANGLE, Array, Body, Scene, get_scene, shape_rings
from .base import Run, Settings, combined, has_curves, knob

MARGIN = 0.05
"""How far bodies move before contact is searched anew, in body sizes."""


def _placed(ring: Array, body: Body) -> Array:
    c, s = math.cos(body.angle), math.sin(body.angle)
    return ring @ np.array(((c, s), (-s, c))) + np.array(body.position)


@cache
def elastic_body(scene: str, name: str, level: str, modes: int) -> Any:
    """A scene's body as the flexible submodule has it, meshed and reduced once a process."""
    from ...flexible.body import elastic_body as build
    from ...flexible.element import Material

    described = get_scene(scene)
    body = next(body for body in described.bodies if body.name == name)
    assert body.elastic is not None  # asked only for those
    rings = [ring for shape in body.shapes for ring in shape_rings(shape, 1e-2 * body.elastic.mesh)]
    area = Outline(rings[0], rings[1:]).area
    made = body.elastic
    material = Material(made.young, made.poisson, body.mass / (area * made.thickness), made.thickness)
    return build(rings, made.mesh, material, level, modes=modes, refine=4)[0]


class FlexibleRun:
    """A simulation of the flexible submodule; a step that does not converge leaves states that are not finite."""

    def __init__(self, scene: Scene, settings: Settings, level: str) -> None:
        from ...flexible.boundary import build
        from ...flexible.integrate import Body as FlexibleBody
        from ...flexible.integrate import Simulation

        tolerance = settings.get("sampling", 1e-4) * scene.size
        held = {hinge.a: hinge for hinge in scene.hinges}  # by the world, at their origins
        moving = [body for body in scene.bodies if body.kind != "static"]
        made = []
        for body in moving:
            velocity = (*body.velocity, body.angular_velocity)
            keys: dict[str, Any] = {"position": body.position, "angle": body.angle, "velocity": velocity}
            if body.kind == "kinematic":
                keys |= {"anchor": body.position, "drive": (body.angle, body.angular_velocity, 0.0)}
            elif body.name in held:
                hinge = held[body.name]
                keys |= {"anchor": body.position, "torque": -hinge.turns * hinge.brake}
            if level != "rigid" and body.elastic is not None:
                flexible = copy.copy(elastic_body(scene.name, body.name, level, settings.get("modes", 0)))
                for key, value in keys.items():
                    setattr(flexible, key, value)
            else:
                rings = [ring for shape in body.shapes for ring in shape_rings(shape, tolerance)]
                flexible = FlexibleBody(build(rings), body.mass, body.moment, **keys)
            made.append(flexible)
        ground = [
            _placed(ring, body)
            for body in scene.bodies
            if body.kind == "static"
            for shape in body.shapes
            for ring in shape_rings(shape, tolerance)
        ]
        if ground:
            made.append(FlexibleBody(build(ground), 1.0, 1.0, fixed=True))
        self.scene, self.steps, self.h = scene, settings["steps"], scene.frame / settings["steps"]
        self.failed = ""
        k, margin, rho = settings["stiffness"] * scene.pressure, MARGIN * scene.size, settings["rho"]
        self.simulation = Simulation(made, k=k, margin=margin, rho=rho, gravity=scene.gravity)

    def advance(self, frames: int) -> None:
        """All steps in one compiled call."""
        if self.failed:
            return
        steps = frames * self.steps
        try:
            self.simulation.run(steps * self.h, self.h, every=steps)
        except RuntimeError as error:
            self.failed = str(error)

    def state(self) -> Array:
        """States (n_body, 6) of the bodies' frames."""
        now = self.simulation.state
        rows, moving = [], 0
        for body in self.scene.bodies:
            if body.kind == "static":
                rows.append(np.array([*body.position, body.angle, 0.0, 0.0, 0.0]))
            else:
                rows.append(np.concatenate((now.x[moving], now.v[moving])))
                moving += 1
        found = np.array(rows)
        if self.failed:
            found[:, ANGLE] = math.nan
        return found


class Flexible:
    """One level of the flexible submodule.

    Settings: `stiffness` in multiples of the scene's pressure; `steps` a frame; `rho`, the scheme's spectral radius at
    infinity; `sampling` of curves over the body size (rigid level); `modes` (modal level).
    """

    ours = True

    def __init__(self, name: str, level: str) -> None:
        self.name, self.level = name, level

    def refuses(self, scene: Scene) -> str:
        """Friction, losses, more than two bodies; for levels that deform, a scene that does not say of what."""
        moving = sum(body.kind != "static" for body in scene.bodies)
        bodies = moving + any(body.kind == "static" for body in scene.bodies)
        if self.level != "rigid" and not any(body.elastic for body in scene.bodies):
            return "nothing in it is elastic"
        if scene.friction > 0:
            return "friction: the flexible submodule is the paper's, frictionless"
        if scene.elasticity < 1 and "impact" in scene.tags:
            return "restitution: the flexible submodule loses nothing at an impact"
        if bodies > 2:
            return f"{bodies} bodies: the flexible submodule takes one pair"
        return ""

    def settings(self, scene: Scene, quick: bool) -> list[Settings]:
        """Stiffness × steps × ρ∞ × sampling or modes."""
        stiffness: tuple[float, ...] = (1e4, 1e6) if quick else (1e4, 1e6, 1e7)
        steps: tuple[int, ...] = (1, 3) if quick else (1, 2, 4, 10)
        rhos: tuple[float, ...] = (0.8,) if quick else (0.4, 0.8)
        if "impact" in scene.tags:  # several steps within a contact, and none of its energy damped away
            stiffness, steps, rhos = (1e2, 4e3) if quick else (1e2, 1e3, 4e3, 1e5), (10, 40), (0.8,)
        elif self.level != "rigid" and not quick:  # of stiff bodies: as the rigid level, at a cost
            stiffness, steps, rhos = (1e5, 1e7), (1, 4), (0.4,)
        finer: list[dict[str, float]] = [{}]
        if self.level == "modal":
            finer = [{"modes": 40}] if quick else [{"modes": 10}, {"modes": 40}]
        elif self.level == "rigid" and has_curves(scene):
            finer = [{"sampling": 1e-4}] if quick else [{"sampling": 1e-4}, {"sampling": 1e-5}]
        return combined(knob("stiffness", stiffness), knob("steps", steps), knob("rho", rhos), finer)

    def default(self, scene: Scene) -> None:
        """A submodule that is set up by hand."""
        return None

    def build(self, scene: Scene, settings: Settings) -> Run:
        """A simulation at this level."""
        return FlexibleRun(scene, settings, self.level)


PEERS = (
    Flexible("rigidarea-implicit", "rigid"),
    Flexible("compliant", "compliant"),
    Flexible("modal", "modal"),
)
