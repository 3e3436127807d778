"""What a study scene is: an engine-neutral set-up, its exact answer and its error measure.

A scene names no engine. Bodies have their centre of mass at the local origin; angles are counter-clockwise;
SI units. A peer (`rigidarea.study.peers`) builds it, runs it and hands back a `Trace`, from which the scene
measures one dimensionless error.
"""

from __future__ import annotations

import importlib
import math
import pkgutil
from collections.abc import Callable, Collection, Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cache
from types import ModuleType
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from ..geometry.arcs import arc_points, circle_points, circle_ring
from ..geometry.outline import Outline

Array = NDArray[np.float64]
Rings = Sequence[Array]
"""An outer ring (n, 2) and holes, none closed."""

G = 9.81
"""Acceleration of gravity in every scene (length/time²)."""

X, Y, ANGLE, VX, VY, OMEGA = range(6)
"""Columns of a body's state."""


@dataclass(frozen=True)
class Circle:
    """A disc; `radius` (length), `center` in the body's coordinates (length)."""

    radius: float
    center: tuple[float, float] = (0.0, 0.0)


@dataclass(frozen=True)
class Polygon:
    """A convex polygon, counter-clockwise; `points` of shape (n, 2) (length). Its corners are rounded by `radius`
    (length), which makes it larger by that much all around.
    """

    points: tuple[tuple[float, float], ...]
    radius: float = 0.0


@dataclass(frozen=True)
class Segment:
    """A line from `a` to `b` (length), `radius` thick on either side: what the floors and walls of games are."""

    a: tuple[float, float]
    b: tuple[float, float]
    radius: float


@dataclass(frozen=True)
class Curve:
    """An outline that may be curved, concave, holed.

    `rings(tolerance)` gives its rings, chords within `tolerance` (length) of the true curve. `exact()` gives the same
    with its arcs, for whoever takes them; None where there are other curves than arcs.
    """

    rings: Callable[[float], Rings]
    exact: Callable[[], Outline] | None = None


Shape = Circle | Polygon | Segment | Curve


@dataclass(frozen=True)
class Elastic:
    """What a body is made of, for the levels that let it deform; its density follows from its mass.

    `young` (force/length²), `poisson`; plane stress in a plate of `thickness` (length). `mesh` is the spacing of the
    finite-element boundary (length).
    """

    young: float
    poisson: float
    thickness: float
    mesh: float


@dataclass(frozen=True)
class Body:
    """One body: shapes, inertia and start.

    `mass` (mass) and `moment` (mass·length²) matter to dynamic bodies only. A kinematic body keeps its
    velocity and angular velocity. `surface_speed` (length/time) moves the surface like a belt: a body
    resting on top of it is dragged towards +x. `elastic` says what it is made of, where that is asked.
    """

    name: str
    shapes: tuple[Shape, ...]
    position: tuple[float, float] = (0.0, 0.0)
    angle: float = 0.0
    velocity: tuple[float, float] = (0.0, 0.0)
    angular_velocity: float = 0.0
    mass: float = 1.0
    moment: float = 1.0
    kind: Literal["dynamic", "kinematic", "static"] = "dynamic"
    surface_speed: float = 0.0
    elastic: Elastic | None = None


@dataclass(frozen=True)
class Hinge:
    """A revolute joint at the world's `point` (length) between two bodies, or one and the world (`b` empty).

    What it joins does not collide with each other. `brake` (force·length) is the largest torque with which the bearing
    opposes rotation, `turns` the sense in which the body turns (1 counter-clockwise): levels without dry friction brake
    with that torque all the time.
    """

    a: str
    b: str
    point: tuple[float, float]
    brake: float = 0.0
    turns: int = 1


@dataclass(frozen=True)
class Trace:
    """States of all bodies, one row a frame, the start included.

    `times` has shape (n_frame + 1,), `states` (n_frame + 1, n_body, 6) with columns x, y, angle, vx, vy,
    omega; the angle is continuous (not wrapped).
    """

    names: tuple[str, ...]
    times: Array
    states: Array

    def __getitem__(self, name: str) -> Array:
        """States (n_frame + 1, 6) of the body called `name`."""
        return self.states[:, self.names.index(name)]


@dataclass(frozen=True)
class Scene:
    """A set-up with an exact answer.

    One of `scenes()` is called as its module. `friction` and `elasticity` are the values of every pair (engines combine
    the two bodies' values differently, so a scene states the result). `size` (length) is that of a typical moving body:
    peers choose their slop, sampling and units of length by it. `pressure` (force/length²) is the typical load on that
    size (unless said, the weight of a unit mass); area stiffnesses are multiples of it. `deforms` says that the exact
    answer is that of elastic bodies: rigid ones give back the restitution that is put in, and need not try.
    """

    title: str
    bodies: tuple[Body, ...]
    duration: float
    error_name: str
    error: Callable[[Trace], float]
    source: str
    name: str = ""
    gravity: tuple[float, float] = (0.0, -G)
    friction: float = 0.0
    elasticity: float = 0.0
    hinges: tuple[Hinge, ...] = ()
    size: float = 1.0
    pressure: float = math.nan
    frame: float = 1 / 60
    tags: frozenset[str] = frozenset()
    deforms: bool = False

    def __post_init__(self) -> None:
        if math.isnan(self.pressure):
            object.__setattr__(self, "pressure", G / self.size**2)

    @property
    def frames(self) -> int:
        """Number of frames in the scene's duration."""
        return round(self.duration / self.frame)

    def measure(self, trace: Trace) -> float:
        """The error of a trace: a finite number >= 0, or infinity if the run left the numbers or the scene."""
        if not np.all(np.isfinite(trace.states)):
            return math.inf
        value = float(self.error(trace))
        return value if math.isfinite(value) else math.inf


# Small builders ---------------------------------------------------------------------------------------------


def box(width: float, height: float, center: tuple[float, float] = (0.0, 0.0)) -> Polygon:
    """A rectangle about a point (lengths)."""
    (x, y), w, h = center, width / 2, height / 2
    return Polygon(((x - w, y - h), (x + w, y - h), (x + w, y + h), (x - w, y + h)))


def box_moment(mass: float, width: float, height: float) -> float:
    """Moment of inertia of a uniform rectangle about its centre (mass·length²): m (w² + h²)/12."""
    return mass * (width**2 + height**2) / 12


def disc(name: str, radius: float, position: tuple[float, float], mass: float = 1.0, **more: object) -> Body:
    """A uniform disc, moment m r²/2, its centre at `position` (length). more: other fields of `Body`."""
    return Body(name, (Circle(radius),), position, mass=mass, moment=mass * radius**2 / 2, **more)  # type: ignore[arg-type]


def block(
    name: str, width: float, height: float, position: tuple[float, float], mass: float = 1.0, **more: object
) -> Body:
    """A uniform rectangle, moment m (w² + h²)/12, its centre at `position` (length). more: other fields of `Body`."""
    moment = box_moment(mass, width, height)
    return Body(name, (box(width, height),), position, mass=mass, moment=moment, **more)  # type: ignore[arg-type]


def floor(width: float = 100.0, depth: float = 1.0, name: str = "floor", **more: object) -> Body:
    """A static slab, `width` by `depth` (length), whose upper face is y = 0. more: other fields of `Body`."""
    return Body(name, (box(width, depth),), (0.0, -depth / 2), kind="static", **more)  # type: ignore[arg-type]


def arc(radius: float, start: float, stop: float, tolerance: float) -> Array:
    """Points (n, 2) of the arc about the origin from angle `start` to `stop` (rad), both ends included.

    Sampled so that the area is kept (`rigidarea.geometry.arcs`), for all peers alike.
    tolerance: largest sagitta (length).
    """
    return arc_points((0.0, 0.0), radius, start, stop - start, tolerance)


def full_circle(radius: float, tolerance: float) -> Array:
    """Points (n, 2) of a circle about the origin, counter-clockwise, not closed, its area kept.

    tolerance: largest sagitta of a chord (length).
    """
    return circle_points((0.0, 0.0), radius, tolerance)


def oriented(rings: Rings) -> list[Array]:
    """Rings with the material on their left: the outer one counter-clockwise, holes clockwise."""

    def turned(ring: Array, sense: float) -> Array:
        x, y = ring.T
        area = float(np.sum(x * np.roll(y, -1) - y * np.roll(x, -1)))
        return ring if area * sense > 0 else ring[::-1]

    outer, *holes = rings
    return [turned(outer, 1.0), *(turned(hole, -1.0) for hole in holes)]


def shape_rings(shape: Shape, tolerance: float) -> list[Array]:
    """Rings (n, 2) of a shape, the material on their left: outer ones counter-clockwise, holes clockwise."""
    if isinstance(shape, Circle):
        return [full_circle(shape.radius, tolerance) + np.array(shape.center)]
    if isinstance(shape, Polygon):
        return [np.array(shape.points, dtype=np.float64)]
    if isinstance(shape, Segment):
        raise ValueError("expected a shape with an outline of its own, got a Segment")
    return oriented(shape.rings(tolerance))


def slab_with_hole(radius: float, half: float) -> Curve:
    """A square of half-side `half` with a circular hole of `radius` about the origin."""
    outer = np.array([(-half, -half), (half, -half), (half, half), (-half, half)], dtype=float)
    straight, (hole, round_) = np.zeros((4, 3)), circle_ring((0.0, 0.0), radius)
    return Curve(
        lambda tolerance: (outer, full_circle(radius, tolerance)),
        exact=lambda: Outline.from_curve([outer, hole], arcs=[straight, round_]),
    )


def relative_error(found: Array, exact: Array) -> float:
    """The largest error of values (n,) along a run, relative to the exact last one."""
    return float(np.max(np.abs(found - exact)) / exact[-1])


def place_error(states: Array, exact: Array, scale: float) -> float:
    """The largest distance of places from exact ones (n, 2), relative to `scale` (length)."""
    return float(np.max(np.linalg.norm(states[:, :2] - exact, axis=1)) / scale)


def rest_error(trace: Trace, names: Iterable[str], size: float, last: float = 1.0) -> float:
    """The largest departure from the starting placement during the `last` seconds, relative to `size`.

    Displacement of the centre, or rotation times half the size, whichever is larger.
    """
    late = trace.times >= trace.times[-1] - last - 1e-9
    worst = 0.0
    for name in names:
        state = trace[name]
        moved = state[late, :3] - state[0, :3]
        worst = max(worst, float(np.max(np.hypot(moved[:, X], moved[:, Y]))) / size)
        worst = max(worst, float(np.max(np.abs(moved[:, ANGLE]))) / 2)
    return worst


def set_up(
    name: str,
    bodies: Iterable[Body],
    duration: float,
    error: Callable[[Trace], float] = lambda trace: 0.0,
    error_name: str = "",
    **more: Any,
) -> Scene:
    """A scene that is measured by whoever made it: no title, no source. more: fields of `Scene`."""
    return Scene("", tuple(bodies), duration, error_name, error, "", name, **more)


# Registry ---------------------------------------------------------------------------------------------------


def check_known(names: Iterable[str], known: Collection[str], what: str) -> None:
    """Raise ValueError for a name that is not among the known ones, which it lists; what: what they are names of."""
    for name in names:
        if name not in known:
            raise ValueError(f"unknown {what} {name!r}; expected one of {', '.join(known)}")


def registered(package: ModuleType, function: str) -> dict[str, Any]:
    """What each module of a package makes by its `function()`, by name: `rest` is made in `rest_scene`, and so on.

    Modules whose names begin with _ make nothing.
    """
    found: dict[str, Any] = {}
    for module in sorted(info.name for info in pkgutil.iter_modules(package.__path__)):
        if not module.startswith("_"):
            made = getattr(importlib.import_module(f"{package.__name__}.{module}"), function)()
            name = module.rpartition("_")[0]
            found[name] = replace(made, name=name)
    return found


@cache
def scenes() -> dict[str, Scene]:
    """Every scene by name: each module of `rigidarea.study.scenes` has one function `scene()`."""
    from . import scenes as package

    return registered(package, "scene")


def get_scene(name: str) -> Scene:
    """The scene called `name`; `ValueError` lists the known ones."""
    check_known([name], scenes(), "scene")
    return scenes()[name]
