"""rigidarea itself, the rigid level: its settings swept, its defaults, and the paper's explicit steps."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pymunk
import shapely
from pymunk._chipmunk_cffi import lib

import rigidarea

from ..scene import Array, Body, Circle, Curve, Scene
from .base import Run, Settings, combined, drive, knob, rigid_only
from .pymunk_peer import SpaceRun, make_space, plain_shape

STEPPING = ("steps", "tolerance", "phase")
"""Settings that say how the space is stepped."""
BUILDING = ("stiffness", "sampling", "iterations")
"""Settings that say how it is built; what is neither goes to `rigidarea.attach` as it is."""


def area_shapes(body: Body, made: pymunk.Body, tolerance: float | None) -> list[pymunk.Shape]:
    """Shapes for area contact: outlines as they are, concave or holed; arcs are arcs, unless a tolerance is given."""
    shapes: list[pymunk.Shape] = []
    for shape in body.shapes:
        if not isinstance(shape, Curve):
            plain = plain_shape(shape, made)
            if tolerance is not None and isinstance(shape, Circle):
                plain.outline = rigidarea.Outline.from_pymunk(plain, tolerance)  # type: ignore[attr-defined]
            shapes.append(plain)
        elif tolerance is None and shape.exact is not None:
            shapes.append(shape.exact().add_to(made))
        else:
            outer, *holes = shape.rings(1e-3 if tolerance is None else tolerance)
            shapes.append(rigidarea.Outline(outer, holes).add_to(made))
    return shapes


def area_space(scene: Scene, settings: Settings) -> tuple[pymunk.Space, list[pymunk.Body], Any]:
    """A space with the scene's bodies and area contact attached: (space, bodies, contact).

    Settings: `stiffness` in multiples of the scene's pressure (none: the library chooses); `sampling` of curves over
    the body size; `iterations` of the solver; those of `STEPPING` are for whoever steps; any other goes to
    `rigidarea.attach`.
    """
    tolerance = settings["sampling"] * scene.size if "sampling" in settings else None
    space, bodies = make_space(scene, lambda body, made: area_shapes(body, made, tolerance))
    if "iterations" in settings:
        space.iterations = settings["iterations"]
    more = {k: v for k, v in settings.items() if k not in (*STEPPING, *BUILDING)}
    stiffness = settings.get("stiffness")
    contact = rigidarea.attach(space, None if stiffness is None else stiffness * scene.pressure, **more)
    return space, bodies, contact


class FrameRun(SpaceRun):
    """Frames as `contact.step` has them, at the defaults or with `steps` or `tolerance`: from C, as the peers' steps.

    `contact.step` itself is Python (10 to 50 µs a call, beside 2 for a body's frame): what the peers are not asked for.
    """

    def __init__(
        self, scene: Scene, space: pymunk.Space, bodies: list[pymunk.Body], contact: Any, settings: Settings
    ) -> None:
        super().__init__(scene, space, bodies, settings.get("steps", 1))
        self.contact, self.frame, self.failed = contact, scene.frame, False
        state = contact._state
        if "steps" in settings:
            state["substeps"], state["steps_given"] = settings["steps"], True
        state["tolerance"] = settings.get("tolerance", 0.0)

    def advance(self, frames: int) -> None:
        """Frames of the scene's length; once a contact has failed, none any more."""
        if not self.failed:
            drive(lib.cpSpaceStep, frames, self.space._space, self.frame)
            self.failed = self.contact._error is not None
            self.steps = int(self.contact._state["taken"])

    def state(self) -> Array:
        """States (n_body, 6); no numbers once a contact has failed."""
        states = super().state()
        return np.full_like(states, np.nan) if self.failed else states

    def contacts(self) -> int:
        """Pairs of shapes that touch."""
        return len({(id(row["shape_a"]), id(row["shape_b"])) for row in self.contact.regions})


FACE_DEPTH = 0.02
"""How deep a straight edge is pressed into an outline, over the outline's extent, for the chord that it cuts off."""
MOST_SIDES = 64
"""Of a hull, along which that is tried."""


def explicit_steps(scene: Scene, space: pymunk.Space, stiffness: float, phase: float) -> int:
    """Explicit steps a frame that no contact of the scene takes at more than w h = `phase`.

    w² = k L/m_eff for the longest chord L with which a body can lie on a straight edge, 1/m_eff = 1/m + d²/I with d
    the chord's leverage. A chain of such bodies has no frequency above twice that (Gershgorin), and the step is
    that chain's: a phase of 2 is where a stack, undamped, goes unstable.
    """
    worst = 0.0
    for shape in space.shapes:
        body = shape.body
        if body is not None and body.body_type == pymunk.Body.DYNAMIC:
            outline = rigidarea.Outline.from_pymunk(shape)
            for chord, arm in _faces(outline.polygon):
                worst = max(worst, chord * (1 / body.mass + arm**2 / body.moment))
    frequency = 2 * math.sqrt(stiffness * worst)
    return max(1, math.ceil(scene.frame * frequency / phase))


def _faces(polygon: shapely.Polygon) -> list[tuple[float, float]]:
    """(chord, its middle's distance from the origin along itself) of what lines along the hull's sides cut off."""
    hull = shapely.orient_polygons(polygon.convex_hull)
    ring = np.asarray(hull.exterior.coords)
    sides = np.diff(ring, axis=0)[:: max(1, (len(ring) - 1) // MOST_SIDES)]
    extent = max(np.ptp(ring[:, 0]), np.ptp(ring[:, 1]))
    found = []
    for along in sides / np.hypot(*sides.T)[:, None]:
        outwards = np.array((along[1], -along[0]))
        level = np.max(ring @ outwards) - FACE_DEPTH * extent
        middle = level * outwards + np.mean(ring @ along) * along
        line = shapely.LineString((middle - 2 * extent * along, middle + 2 * extent * along))
        for piece in shapely.get_parts(polygon.intersection(line)):
            if piece.length > 0:
                where = np.asarray(piece.coords) @ along
                found.append((float(np.ptp(where)), float(abs(where.mean()))))
    return found


def area_samplings(scene: Scene, quick: bool) -> list[dict[str, float]]:
    """Chord tolerances over body size for curves that are no arcs; finer than the peers', whose pieces are many."""
    shapes = [shape for body in scene.bodies for shape in body.shapes]
    if all(shape.exact is not None for shape in shapes if isinstance(shape, Curve)):
        return [{}]
    return knob("sampling", (1e-3, 1e-5) if quick else (1e-2, 1e-3, 1e-4, 1e-5))


class Area:
    """Frames as a user may tune them: stiffness, steps a frame, iterations.

    Settings: `stiffness` (or `penetration`, from which the library chooses it), `steps` a frame, `iterations` of a
    step, `sampling`; see `area_space`.
    """

    name = "rigidarea"
    ours = True

    def default(self, scene: Scene) -> Settings | None:
        """The library's defaults are a peer of their own."""
        return None

    def refuses(self, scene: Scene) -> str:
        """What only elastic bodies answer."""
        return rigid_only(scene)

    def settings(self, scene: Scene, quick: bool) -> list[Settings]:
        """Stiffness or penetration × steps × iterations × sampling."""
        stiffness = (1e6, 1e12) if quick else (1e4, 1e6, 1e8, 1e12)
        soft = knob("stiffness", stiffness)
        if scene.gravity != (0.0, 0.0) and not quick:
            soft += knob("penetration", (1e-3, 1e-5))
        steps = (1, 4, 16) if quick else (1, 2, 4, 8, 16, 32, 64)
        # one body's contacts are solved in a few sweeps; piles and trains want more, as pymunk's do
        more = scene.tags & {"stack", "gears"} and not quick
        iterations: list[dict[str, int]] = [{}, {"iterations": 40}] if more else [{}]
        return combined(soft, knob("steps", steps), iterations, area_samplings(scene, quick))

    def build(self, scene: Scene, settings: Settings) -> Run:
        """An attached space, stepped by frames."""
        return FrameRun(scene, *area_space(scene, settings), settings)


class AreaDefault(Area):
    """As a user runs it who reads one line of the README: `attach(space)` and `contact.step(1/60)`, nothing else."""

    name = "rigidarea-default"

    def refuses(self, scene: Scene) -> str:
        """Also that from which no stiffness can be chosen: without gravity, with nothing free that moves."""
        if rigid_only(scene) or scene.gravity != (0.0, 0.0):
            return rigid_only(scene)
        try:
            area_space(scene, {})
        except ValueError as error:
            return str(error)
        return ""

    def default(self, scene: Scene) -> Settings:
        """All there is."""
        return {}

    def settings(self, scene: Scene, quick: bool) -> list[Settings]:
        """None to choose among."""
        return [{}]


class AreaExplicit(Area):
    """Equal explicit steps (symplectic Euler) of F = k A, their number from `stiffness` and `phase` (ω h), kept."""

    name = "rigidarea-explicit"

    def settings(self, scene: Scene, quick: bool) -> list[Settings]:
        """Stiffness × phase × sampling."""
        stiffness = (1e3, 1e5) if quick else (1e3, 1e4, 1e5, 1e6)
        phases = (3.0,) if quick else (0.5, 3.0)
        if "impact" in scene.tags:  # restitution wants several steps within a contact
            phases = (0.5,) if quick else (0.25, 1.0)
        return combined(knob("stiffness", stiffness), knob("phase", phases), area_samplings(scene, quick))

    def build(self, scene: Scene, settings: Settings) -> Run:
        """An attached space, stepped by Chipmunk's own function."""
        return explicit_run(scene, settings)


PHASE = 0.5
"""w h of explicit steps for which no phase is set."""


def explicit_run(scene: Scene, settings: Settings) -> SpaceRun:
    """Explicit steps, straight through Chipmunk's step function, as for pymunk's own solver."""
    space, bodies, contact = area_space(scene, {"integration": "explicit", **settings})
    steps = settings.get("steps")
    if steps is None:
        k = settings["stiffness"] * scene.pressure if "stiffness" in settings else contact.stiffness
        steps = explicit_steps(scene, space, k, settings.get("phase", PHASE))
    run = SpaceRun(scene, space, bodies, steps)
    run.contact = contact
    return run


PEERS = (Area(), AreaDefault(), AreaExplicit())
