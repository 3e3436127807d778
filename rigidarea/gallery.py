"""Game scenes, run and measured: what a demo is, the two engines that run it, and the numbers of a run.

A demo is a module of `rigidarea.demos` with a function `build() -> Scene`. It says what is in the space and
how it is to be looked at; it names no engine. `Run` attaches area contact to it, or hands it to Chipmunk's own
response, and steps it frame by frame. Drawing (`rigidarea.draw`) looks at a run and changes nothing in it.
"""

from __future__ import annotations

import importlib
import math
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, NamedTuple, Unpack

import numpy as np
import pymunk
from numpy.typing import NDArray

from .chipmunk import AreaContact, attach
from .geometry.gate import ShapeAttributes
from .geometry.outline import Outline, outline_on

ENGINES = ("area", "pymunk")

#: Every demo, in the order in which `demo all` shows them.
NAMES = ("pyramid", "tower", "cradle", "journal", "gears", "rubber", "geneva", "platformer", "bowl")

#: Steps that Chipmunk's own response gets a frame of 1/60 s, unless a scene says otherwise.
CHIPMUNK_STEPS = 4


class Headline(NamedTuple):
    """The number that a scene is about."""

    name: str
    """snake_case, the unit last."""
    value: Callable[[], float]
    """Called after the last frame."""
    exact: float | None = None
    """What it would be without error, where that is known."""


class Lens(NamedTuple):
    """A magnified view beside the scene, in which overlaps are visible."""

    center: Callable[[], tuple[float, float]]
    """The place looked at, world (length)."""
    width: float
    """What the lens shows (length)."""


class Part(NamedTuple):
    """One outline on one body, as it is drawn."""

    body: pymunk.Body
    outline: Outline
    face: bool
    """True for a segment of radius 0: a face without a solid of its own."""


@dataclass
class Scene:
    """A scene: a space, what moves it, what is measured, and how it is looked at.

    Lengths in `unit`, time in seconds.
    """

    name: str
    title: str
    shows: str
    """One line: what there is to see."""
    space: pymunk.Space
    view: tuple[float, float, float, float]
    """What the picture shows at least: xmin, ymin, xmax, ymax (length)."""
    headline: Headline
    chipmunk: str
    """How Chipmunk's own response runs it."""
    attach: dict[str, Any] = field(default_factory=dict)
    """Keyword arguments of `rigidarea.attach`."""
    frame: float = 1 / 60
    """Simulated time from one frame to the next (time)."""
    frames: int = 300
    still: float = 1.0
    """When the still is taken: a fraction of the frames."""
    drive: Callable[[float], None] | None = None
    """Called with the time before every frame: what a player would do."""
    watch: Callable[[float], None] | None = None
    """Called with the time after every frame: what is measured."""
    energy: str = "falls"
    """"kept" (no friction, e = 1, no drive), "falls" (dissipation only), "driven" (not a measure)."""
    energy_scale: float = 1.0
    """What the energy drift is divided by (force length)."""
    chipmunk_steps: int = CHIPMUNK_STEPS
    unit: str = "m"
    force: float = 1.0
    """Force that is drawn `force_px` long (force); lengths go with the square root."""
    force_px: float = 40.0
    lens: Lens | None = None
    colors: dict[pymunk.Body, int] = field(default_factory=dict)
    """Numbers in the palette; bodies not named here get them in turn."""

    @property
    def slowdown(self) -> float:
        """How much slower than life a film of 60 frames a second shows it."""
        return 1 / (60 * self.frame)


def load(name: str) -> Scene:
    """Build the demo called `name`. ValueError lists the known ones."""
    if name not in NAMES:
        raise ValueError(f"unknown demo {name!r}; expected one of {', '.join(NAMES)}, or all")
    scene: Scene = importlib.import_module(f".demos.{name}", __package__).build()
    return scene


def new_space(slop: float, g: float = 0.0) -> pymunk.Space:
    """An empty space, gravity `g` downwards. slop: Chipmunk's (length), whose default is meant for pixels."""
    space = pymunk.Space()
    space.collision_slop = slop
    space.gravity = 0, -g
    return space


def static_body(space: pymunk.Space, outline: Outline, **attributes: Unpack[ShapeAttributes]) -> pymunk.Shape:
    """Add an outline to the space's static body; returns its shape. attributes: as in `Outline.add_to`."""
    shape = outline.add_to(space.static_body, **attributes)
    space.add(shape)
    return shape


def add_body(
    space: pymunk.Space,
    outline: Outline,
    position: tuple[float, float],
    *,
    density: float,
    angle: float = 0.0,
    **attributes: Unpack[ShapeAttributes],
) -> pymunk.Body:
    """Add a dynamic body of this outline to the space; returns the body.

    position (length), angle (radians): of the body, whose origin is the outline's. density: mass/length². attributes:
    of the shape, as in `Outline.add_to`.
    """
    body = outline.body(density=density)
    body.angle = angle
    body.position = position
    space.add(body, outline.add_to(body, **attributes))
    return body


def decompose(space: pymunk.Space) -> int:
    """Replace the stand-in of every exact outline by convex polygons that tile it; returns how many.

    That is how Chipmunk can run concave scenes: outlines that came with `Outline.add_to` become pymunk polygons on
    the same body, with the same friction, elasticity, collision type, filter, sensor and surface velocity.
    """
    from .study.decompose import convex_pieces

    added = 0
    known: dict[Outline, list[NDArray[np.float64]]] = {}
    for shape in list(space.shapes):
        outline = outline_on(shape)
        if outline is None or outline.two_sided:
            continue
        if outline not in known:
            rings = [np.asarray(ring) for ring in outline.polygon_rings]
            known[outline] = rings[:1] if outline.convex else convex_pieces(rings, most=12)
        space.remove(shape)
        for piece in known[outline]:
            poly = pymunk.Poly(shape.body, piece.tolist())
            for name in ("friction", "elasticity", "collision_type", "filter", "sensor", "surface_velocity"):
                setattr(poly, name, getattr(shape, name))
            space.add(poly)
            added += 1
    return added


class Mark(NamedTuple):
    """One contact, as it is drawn."""

    x: float
    y: float
    fx: float
    """Force on B, world (force)."""
    fy: float
    body_a: pymunk.Body
    body_b: pymunk.Body


def _mark(region: Any) -> Mark:
    """A region of area contact as it is drawn."""
    (x, y), (nx, ny) = region["centroid"], region["direction"]
    normal, friction = region["force"], region["friction"]
    fx, fy = normal * nx - friction * ny, normal * ny + friction * nx
    return Mark(x, y, fx, fy, region["body_a"], region["body_b"])


class Run:
    """One scene under one engine, stepped frame by frame, the clock running around the step only.

    Raises ValueError for an unknown engine.
    """

    def __init__(self, scene: Scene, engine: str = "area") -> None:
        if engine not in ENGINES:
            raise ValueError(f"engine must be one of {', '.join(ENGINES)}, got {engine!r}")
        self.scene, self.engine, self.space = scene, engine, scene.space
        self.parts = [
            Part(
                shape.body,
                Outline.from_pymunk(shape),
                isinstance(shape, pymunk.Segment) and shape.radius == 0,
            )
            for shape in self.space.shapes
            if shape.body is not None and not shape.sensor
        ]
        self.bodies = sum(body.body_type == pymunk.Body.DYNAMIC for body in self.space.bodies)
        self.contact: AreaContact | None = None
        if engine == "area":
            self.contact = attach(self.space, **scene.attach)
        else:
            decompose(self.space)
        self.done = 0
        self.frame_ms: list[float] = []
        self.frame_steps: list[int] = []
        self._energies: list[float] = [self.energy()]

    @property
    def time(self) -> float:
        """Simulated time so far (time)."""
        return self.done * self.scene.frame

    def advance(self) -> None:
        """One frame: drive, step (timed), watch."""
        scene = self.scene
        if scene.drive is not None:
            scene.drive(self.time)
        start = time.perf_counter()
        if self.contact is not None:
            steps = self.contact.step(scene.frame)
        else:
            steps = scene.chipmunk_steps
            for _ in range(steps):
                self.space.step(scene.frame / steps)
        self.frame_ms.append((time.perf_counter() - start) * 1e3)
        self.frame_steps.append(steps)
        self.done += 1
        if scene.watch is not None:
            scene.watch(self.time)
        if scene.energy != "driven" and self.done % 4 == 0:
            self._energies.append(self.energy())

    def energy(self) -> float:
        """Kinetic and potential energy; with area contact also what the contacts store (force length)."""
        if self.contact is not None:
            return self.contact.energy()
        gravity = self.space.gravity
        total = 0.0
        for body in self.space.bodies:
            if body.body_type == pymunk.Body.DYNAMIC:
                total += 0.5 * body.mass * body.velocity.dot(body.velocity)
                if math.isfinite(body.moment):
                    total += 0.5 * body.moment * body.angular_velocity**2
                total -= body.mass * gravity.dot(body.local_to_world(body.center_of_gravity))
        return total

    def energy_drift(self) -> float | None:
        """Energy that came from nowhere, over the scene's scale; None for a driven scene.

        Where energy is kept, the largest departure from the start; where it may only fall, the largest rise after
        any moment.
        """
        energies, scene = np.array(self._energies), self.scene
        if scene.energy == "driven":
            return None
        if scene.energy == "kept":
            return float(np.max(np.abs(energies - energies[0]))) / scene.energy_scale
        return float(np.max(energies - np.minimum.accumulate(energies))) / scene.energy_scale

    def marks(self) -> list[Mark]:
        """The contacts of the last step."""
        if self.contact is not None:
            return [_mark(row) for row in self.contact.regions]
        step = self.scene.frame / self.scene.chipmunk_steps
        marks: list[Mark] = []
        order = {body: i for i, body in enumerate(self.space.bodies)}

        def add(arbiter: pymunk.Arbiter, body: pymunk.Body) -> None:
            a, b = arbiter.bodies
            points = arbiter.contact_point_set.points
            # each_arbiter shows every contact to both of its bodies: it is taken from the one that comes first
            if not points or order.get(b if a is body else a, math.inf) <= order[body]:
                return
            x = sum(p.point_a.x + p.point_b.x for p in points) / (2 * len(points))
            y = sum(p.point_a.y + p.point_b.y for p in points) / (2 * len(points))
            marks.append(Mark(x, y, *(arbiter.total_impulse / step), a, b))

        for body in order:
            if body.body_type == pymunk.Body.DYNAMIC:
                body.each_arbiter(add, body)
        return marks

    def row(self) -> dict[str, Any]:
        """The numbers of the run so far, as in the table and the JSON."""
        scene, ms = self.scene, np.array(self.frame_ms)
        value = scene.headline.value()
        return {
            "scene": scene.name,
            "engine": self.engine,
            "bodies": self.bodies,
            "frames": self.done,
            "frame_s": scene.frame,
            "steps_per_frame": float(np.median(self.frame_steps)),
            "frame_ms_median": float(np.median(ms)),
            "frame_ms_p99": float(np.percentile(ms, 99)),
            "frame_ms_worst": float(ms.max()),
            "real_time_factor": float(1e3 * scene.frame * len(ms) / ms.sum()),
            "energy_drift_relative": self.energy_drift(),
            "headline_name": scene.headline.name,
            "headline": float(value),
            "headline_exact": scene.headline.exact,
        }
