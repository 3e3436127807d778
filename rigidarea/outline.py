"""What a body's boundary is: rings with holes, sampled by a chord tolerance, with exact mass properties.

Conventions: lengths in the unit of the space; points are `(n, 2)` arrays in body coordinates (pymunk's
local coordinates); the outer ring runs counter-clockwise and holes clockwise, so the solid is always on the
left of an edge; no ring repeats its first point at the end.

Curves become chords. `tolerance` is everywhere the same length: the largest sagitta of a chord. Arcs are
sampled so that the **area is kept exactly**: the vertices lie a little outside the arc and the chords'
middles a little inside (2/3 and 1/3 of the sagitta on a full circle), because a force proportional to area
feels area, not vertices. The inertia of a disc is then right to fourth order in the chord's angle. Without
a tolerance a curve gets `DEFAULT_TOLERANCE` times half the smaller extent of its shape (for a disc: its
radius).
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterable
from functools import cached_property, lru_cache, partial
from typing import Any

import numpy as np
import pymunk
import shapely
from numpy.typing import ArrayLike, NDArray

Points = NDArray[np.float64]

DEFAULT_TOLERANCE = 5e-5
"""Largest sagitta of a chord over half the shape's smaller extent (dimensionless): a disc gets 316 points. An eighth
of the penetration that `attach` allows by default, so that a rolling disc hardly feels its facets. Contacts cost what
the contact is, not the outline."""

SEGMENT_THICKNESS = 2.0
"""Depth of the solid behind a segment of radius 0 over the segment's length (dimensionless). See
`Outline.from_pymunk`."""

MIN_CHORDS = 3
"""Fewest chords of an arc with fixed ends: from 3 on, keeping the area moves no vertex further than the
sagitta."""

MAX_STAND_IN_VERTICES = 8
"""Most vertices of a polygonal stand-in: Chipmunk's GJK walks them all."""

_EPS = float(np.finfo(np.float64).eps)
_LARGEST = 1e75  # coordinates; their fourth powers, in the moments, stay finite


class Outline:
    """The boundary of a rigid body: an outer ring and any number of holes. Immutable.

    points: (n, 2) array-like, n >= 3, the outer ring. Either sense, closed or not; repeated points are
        dropped, collinear ones kept.
    holes: array-likes (m, 2), each inside the outer ring and apart from the others (touching in a point is
        allowed).

    Raises ValueError, naming what was expected and what came, for wrong shapes, NaN or infinite
    coordinates, fewer than three distinct points, zero area, a ring that crosses itself (with the place), a
    hole outside its ring, holes that overlap.
    """

    rings: tuple[Points, ...]
    """Read-only float64 arrays (n, 2): [0] the outer ring, counter-clockwise; the rest holes, clockwise."""
    area: float
    """Area of the solid (length²), holes taken off."""
    centroid: tuple[float, float]
    """Centroid of the solid, body coordinates (length)."""
    bounds: tuple[float, float, float, float]
    """(xmin, ymin, xmax, ymax), body coordinates (length)."""
    mirror: Outline | None
    """The same segment's solid on its other side, for an outline made from a pymunk segment of radius 0;
    else None."""

    def __init__(self, points: ArrayLike, holes: Iterable[ArrayLike] = ()) -> None:
        rings = [_ring(points, "points")]
        rings += [_ring(hole, f"holes[{i}]") for i, hole in enumerate(holes)]
        _check_valid(rings)
        self._set(rings)

    @classmethod
    def from_curve(cls, rings: Iterable[Points], resample: Callable[..., Outline] | None = None) -> Outline:
        """From sampled curves known to make an outline (unchecked), and the function that samples them.

        `resample(tolerance=...)` makes the outline anew; a functools.partial of a module's function, so
        that it can be pickled. See `sample`.
        """
        self = cls.__new__(cls)
        self._set([np.array(ring, dtype=np.float64) for ring in rings], resample)
        return self

    def with_curve(self, resample: Callable[..., Outline]) -> Outline:
        """The same outline, knowing how to `sample` itself anew."""
        return Outline.from_curve(self.rings, resample)

    def _set(self, rings: list[Points], resample: Callable[..., Outline] | None = None) -> None:
        lower, upper = np.minimum.reduce(rings[0]), np.maximum.reduce(rings[0])
        middle = (
            lower + upper
        ) / 2  # sums are taken relative to it: far from the origin they lose all digits
        total, first = 0.0, np.zeros(2)
        oriented = []
        for i, ring in enumerate(rings):
            area, moment = _area_and_first_moment(ring - middle)
            if (area > 0) == (i > 0):
                ring, area, moment = np.ascontiguousarray(ring[::-1]), -area, -moment
            ring.flags.writeable = False
            oriented.append(ring)
            total += area
            first += moment
        self.rings = tuple(oriented)
        self.area = float(total)
        self.centroid = tuple((middle + first / total).tolist())
        self.bounds = (*lower.tolist(), *upper.tolist())
        self.mirror = None
        self._resample = resample

    # --- made from other things ---

    @classmethod
    def from_shapely(cls, polygon: shapely.Polygon) -> Outline:
        """From a shapely Polygon, holes included (a third coordinate is dropped).

        Raises ValueError for other geometries, empty and invalid polygons.
        """
        if not isinstance(polygon, shapely.Polygon) or polygon.is_empty:
            raise ValueError(
                f"expected one non-empty shapely Polygon (of several, each alone), got {polygon!r:.80}"
            )
        exterior, *interiors = map(shapely.get_coordinates, (polygon.exterior, *polygon.interiors))
        return cls(exterior, interiors)

    @classmethod
    def from_pymunk(
        cls,
        shape: pymunk.Shape,
        tolerance: float | None = None,
        *,
        side: str = "both",
        thickness: float | None = None,
    ) -> Outline:
        """The solid that a pymunk shape stands for, in its body's coordinates.

        An outline put on the shape (`shape.outline`, see `add_to`) is returned as it is. Otherwise: a
        Circle is sampled to `tolerance` (sagitta, length); a Poly is its convex hull, as in pymunk, its
        corners rounded by `radius`; a Segment with a radius is a capsule. Equal shapes get the same Outline
        object.

        **A Segment of radius 0** has no inside, yet most floors are one, so it becomes the face of a solid
        behind it: a rectangle on the segment, `thickness` deep (length; default `SEGMENT_THICKNESS` times
        the segment's length), its ends square, so that consecutive segments tile without a bump. Which side
        is "behind" cannot be told from a→b, since floors are drawn either way. With `side="both"`, the
        default, the contact decides it when a body first touches: solid is the side the body did not come
        from, for as long as that contact lasts. So a body rests exactly on the line, from either side. The
        outline returned is then the solid on the right of a→b, its `mirror` the one on the left, and edge 0
        of either is the segment itself. `side="left"` or `"right"` (seen from a to b) makes a one-sided
        floor: an ordinary rectangle. Limits: contact is looked for only while the line itself touches the
        other body; a body that sinks further than the thickness meets no more resistance; a needle pointed
        exactly into a concave joint of two segments can slip between.

        Raises ValueError for a shape without area (a circle of radius 0, a segment of length and radius 0,
        a polygon whose vertices are collinear and whose radius is 0), for a tolerance or thickness that is
        not positive and finite, and for an unknown side.
        """
        if tolerance is not None:
            positive(tolerance, "tolerance")
        if side not in ("both", "left", "right"):
            raise ValueError(f"side must be 'both', 'left' or 'right', got {side!r}")
        outline = getattr(shape, "outline", None)
        if isinstance(outline, Outline):
            return outline
        if isinstance(shape, pymunk.Circle):
            return _rounded((tuple(shape.offset),), shape.radius, tolerance)
        if isinstance(shape, pymunk.Poly):
            vertices = [tuple(vertex) for vertex in shape.get_vertices()]
            first = vertices.index(min(vertices))  # a pymunk copy of the shape starts elsewhere
            return _rounded(tuple(vertices[first:] + vertices[:first]), shape.radius, tolerance)
        if isinstance(shape, pymunk.Segment):
            if shape.radius > 0:
                ends = dict.fromkeys((tuple(shape.a), tuple(shape.b)))  # a segment without length is a disc
                return _rounded(tuple(ends), shape.radius, tolerance)
            return _half_space(tuple(shape.a), tuple(shape.b), side, thickness)
        raise ValueError(f"expected a pymunk Circle, Poly or Segment, got {type(shape).__name__}")

    # --- what it measures ---

    def moment(self, mass: float, offset: tuple[float, float] = (0, 0)) -> float:
        """Moment of inertia (mass·length²) of the solid about the body's origin, the outline shifted by
        `offset` (length).

        Like `pymunk.moment_for_poly`, for concave outlines and holes too. Exact for the polygon.
        Raises ValueError unless mass is finite and not negative.
        """
        if not (math.isfinite(mass) and mass >= 0):
            raise ValueError(f"mass must be finite and not negative, got {mass!r}")
        x, y = self.centroid[0] + offset[0], self.centroid[1] + offset[1]
        return mass * (self._gyration + x * x + y * y)

    @cached_property
    def _gyration(self) -> float:
        """Squared radius of gyration about the centroid (length²)."""
        return sum(_polar_moment(ring - self.centroid) for ring in self.rings) / self.area

    @cached_property
    def convex(self) -> bool:
        """True for one ring without a reflex corner; collinear points are allowed."""
        if len(self.rings) > 1:
            return False
        ring = self.rings[0]
        ahead = np.roll(ring, -1, axis=0) - ring
        behind = np.roll(ahead, 1, axis=0)
        turn = behind[:, 0] * ahead[:, 1] - behind[:, 1] * ahead[:, 0]
        # a coordinate is known to half an ulp, so a turn to that times the two edges' lengths
        noise = 2 * _EPS * np.abs(ring).max() * (np.abs(ahead).sum(axis=1) + np.abs(behind).sum(axis=1))
        return bool(np.all(turn >= -noise))

    @cached_property
    def polygon(self) -> shapely.Polygon:
        """The same region as a shapely Polygon."""
        return shapely.Polygon(self.rings[0], self.rings[1:])

    @property
    def two_sided(self) -> bool:
        """True for a segment of radius 0 that is solid on whichever side the other body did not come from."""
        return self.mirror is not None

    # --- other outlines from it ---

    def sample(self, tolerance: float) -> Outline:
        """The same boundary sampled anew, no chord's sagitta above `tolerance` (length).

        Shapes that know their curve (`rigidarea.shapes`, circles and rounded shapes of pymunk) are made
        again from it; an outline that came as points is all there is to know, and is returned itself.
        Raises ValueError unless tolerance is positive.
        """
        positive(tolerance, "tolerance")
        return self if self._resample is None else self._resample(tolerance=tolerance)

    def translated(self, dx: float, dy: float) -> Outline:
        """A copy shifted by (dx, dy), length."""
        return self._moved(0.0, dx, dy)

    def rotated(self, angle: float) -> Outline:
        """A copy turned about the body's origin by `angle` (radians, counter-clockwise)."""
        return self._moved(angle, 0.0, 0.0)

    def _moved(self, angle: float, dx: float, dy: float) -> Outline:
        if not all(map(math.isfinite, (angle, dx, dy))):
            raise ValueError(f"expected finite angle and shift, got angle {angle!r}, shift ({dx!r}, {dy!r})")
        c, s = math.cos(angle), math.sin(angle)
        turn = np.array([[c, s], [-s, c]])
        moved = [ring @ turn + (dx, dy) for ring in self.rings]  # by an angle of 0 the product is exact
        again = None if self._resample is None else partial(_resample_moved, self._resample, angle, dx, dy)
        outline = Outline.from_curve(moved, again)
        if self.mirror is not None:
            _face_each_other(outline, Outline.from_curve([r @ turn + (dx, dy) for r in self.mirror.rings]))
        return outline

    # --- into a pymunk space ---

    def add_to(self, body: pymunk.Body, **shape_attrs: Any) -> pymunk.Shape:
        """Put the outline on a body, behind a pymunk stand-in shape that contains it; returns that shape,
        to add to the space.

        The stand-in only tells the broad phase where to look; contact is computed with the exact outline,
        which hangs on it as `shape.outline` and survives copying and pickling. The stand-in is the
        outline's convex hull where that has no more than 8 vertices, else the tighter of its bounding
        circle and a bounding octagon (the circle, unless the octagon is a tenth smaller). Hence pymunk's
        own queries and drawing see the stand-in: `point_query`, `segment_query`, `shapes_collide` and
        `debug_draw` report a slot, a hole or the gap between two teeth as solid. It has no mass: give the
        body its mass and moment (`moment`, or `body`).

        shape_attrs: friction, elasticity, collision_type, filter, sensor, surface_velocity, as in pymunk.
        Raises ValueError for other names (mass and density among them).
        """
        known = ("friction", "elasticity", "collision_type", "filter", "sensor", "surface_velocity")
        unknown = sorted(set(shape_attrs) - set(known))
        if unknown:
            raise ValueError(f"expected shape attributes among {', '.join(known)}; got {', '.join(unknown)}")
        kind, form = self._stand_in
        shape = kind(body, *form)
        for name, value in shape_attrs.items():
            setattr(shape, name, value)
        shape.outline = self
        return shape

    @cached_property
    def smallest_extent(self) -> float:
        """The least distance of two parallel lines with the outline between them (length): its smallest thickness."""
        hull = shapely.get_coordinates(shapely.convex_hull(self.polygon))
        along = np.diff(hull, axis=0)  # one of the two lines lies along an edge of the hull
        normal = np.column_stack((along[:, 1], -along[:, 0])) / np.hypot(*along.T)[:, None]
        return float(np.ptp(hull @ normal.T, axis=0).min())

    @cached_property
    def _stand_in(self) -> tuple[Callable[..., pymunk.Shape], tuple[Any, ...]]:
        """The stand-in's class and its arguments after the body; the same for every body the outline is put
        on."""
        if self.mirror is not None:
            b, a = self.rings[0][:2].tolist()
            return pymunk.Segment, (a, b, 0)
        hull = shapely.get_coordinates(shapely.convex_hull(self.polygon))[:-1]
        if len(hull) <= MAX_STAND_IN_VERTICES:
            return pymunk.Poly, (hull.tolist(),)
        octagon = _bounding_octagon(hull)
        center = shapely.get_coordinates(shapely.minimum_bounding_circle(self.polygon).centroid)[0]
        radius = float(np.hypot(*(hull - center).T).max())
        if _area_and_first_moment(octagon - center)[0] > 0.9 * math.pi * radius**2:
            return pymunk.Circle, (radius, center.tolist())
        return pymunk.Poly, (octagon.tolist(),)

    def body(self, *, density: float | None = None, mass: float | None = None) -> pymunk.Body:
        """A dynamic pymunk body with this outline's mass, moment and centre of gravity (no shape on it yet).

        Give either density (mass/length²) or mass. Raises ValueError unless exactly one is given, positive
        and finite.
        """
        if density is not None and mass is None:
            mass = positive(density, "density") * self.area
        elif mass is None or density is not None:
            raise ValueError(f"expected either density or mass, got density={density!r}, mass={mass!r}")
        mass = positive(mass, "mass")
        body = pymunk.Body(mass, mass * self._gyration)
        body.center_of_gravity = self.centroid
        return body

    # --- immutable: copies share it ---

    def __copy__(self) -> Outline:
        return self

    def __deepcopy__(self, memo: dict[int, Any]) -> Outline:
        return self

    def __reduce__(self) -> tuple[Any, ...]:
        return _restore, (self.rings, self._resample, None if self.mirror is None else self.mirror.rings)

    def __repr__(self) -> str:
        points = " + ".join(str(len(ring)) for ring in self.rings)
        return f"<Outline of {points} points, area {self.area:.6g}, bounds {self.bounds}>"


def arc_points(
    center: tuple[float, float], radius: float, start: float, sweep: float, tolerance: float
) -> Points:
    """Points (n, 2) along a circular arc, both ends included and exactly on it, the sector's area kept
    exactly.

    start, sweep: radians; sweep > 0 runs counter-clockwise. tolerance: largest sagitta (length).
    With m chords of angle θ and inner vertices at radius ρ, the fan has the sector's area R²φ/2 when
    (m−2)/2·sin θ·ρ² + R·sin θ·ρ − R²φ/2 = 0.
    """
    chords = _chords(radius, abs(sweep), tolerance)
    step = abs(sweep) / chords
    quadratic, linear, constant = (chords - 2) / 2, 1.0, -abs(sweep) / (2 * math.sin(step))
    rho = radius * 2 * -constant / (linear + math.sqrt(linear * linear - 4 * quadratic * constant))
    angle = start + sweep * np.arange(chords + 1) / chords
    radii = np.full(chords + 1, rho)
    radii[0] = radii[-1] = radius
    return np.asarray(center) + radii[:, None] * np.column_stack((np.cos(angle), np.sin(angle)))


def circle_points(center: tuple[float, float], radius: float, tolerance: float) -> Points:
    """Vertices (n, 2), counter-clockwise, of the regular polygon with the circle's area; n a multiple of 4,
    n >= 8.

    tolerance: largest sagitta (length). The first edge stands across the x axis, so that a disc set down
        unturned lies on a face.
    """
    n = 4 * max(2, math.ceil(_chords(radius, 2 * math.pi, tolerance) / 4))
    rho = radius * math.sqrt((2 * math.pi / n) / math.sin(2 * math.pi / n))
    angle = 2 * math.pi * (np.arange(n) + 0.5) / n
    return np.asarray(center) + rho * np.column_stack((np.cos(angle), np.sin(angle)))


def _chords(radius: float, sweep: float, tolerance: float) -> int:
    """How many chords keep the sagitta R(1 − cos θ/2) below the tolerance, none wider than a quarter turn."""
    half = math.acos(max(1 - tolerance / radius, math.cos(math.pi / 4)))
    return max(MIN_CHORDS, math.ceil(sweep / (2 * half) * (1 - 1e-12)))


def positive(value: float, name: str) -> float:
    """The value as a float; ValueError with its name unless it is positive and finite."""
    if not (isinstance(value, int | float | np.number) and math.isfinite(value) and value > 0):
        raise ValueError(f"{name} must be positive and finite, got {value!r}")
    return float(value)


# --- the gate: what comes in ---


def _ring(points: ArrayLike, name: str) -> Points:
    """A clean copy: float64 (n, 2), finite, n >= 3, no repeated or closing point, area not zero. Either
    sense."""
    try:
        ring = np.array(points, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise ValueError(f"{name} must be numbers of shape (n, 2), got {points!r:.80}") from error
    if ring.ndim != 2 or ring.shape[1] != 2:
        raise ValueError(f"{name} must have shape (n, 2) with n >= 3, got shape {ring.shape}")
    finite = np.isfinite(ring).all(axis=1)
    if not finite.all():
        bad = int(np.argmin(finite))
        raise ValueError(f"{name} must be finite, got {tuple(ring[bad].tolist())} at point {bad}")
    given = len(ring)
    if given:
        reach = float(np.abs(ring).max())
        if reach > _LARGEST:
            raise ValueError(f"{name} must have coordinates below {_LARGEST:g}, got {reach:.6g}")
        # nearer than this two points are one, rounded differently
        apart = np.abs(ring - np.concatenate((ring[-1:], ring[:-1]))) > 2 * _EPS * reach
        keep = apart.any(axis=1)
        if not keep.all():
            ring = ring[keep]
    if len(ring) < 3:
        raise ValueError(f"{name} must have at least 3 distinct points, got {len(ring)} (of {given} given)")
    middle = (ring.min(axis=0) + ring.max(axis=0)) / 2
    size = float(np.abs(ring - middle).max())
    area = _area_and_first_moment(ring - middle)[0]
    if abs(area) <= 8 * _EPS * reach * size:  # what rounded coordinates of collinear points can enclose
        far = ring[np.argmax(((ring - ring[0]) ** 2).sum(axis=1))] - ring[0]
        width = np.abs((ring - ring[0]) @ (-far[1], far[0])).max()
        if width <= 8 * _EPS * reach * size:  # else a figure of eight: it crosses itself
            raise ValueError(f"{name} must enclose an area, got {abs(area):.3g} for a size of {2 * size:.3g}")
    return ring


def _check_valid(rings: list[Points]) -> None:
    """ValueError naming the fault and the place, unless the rings bound a simple region (GEOS judges)."""
    whole = shapely.Polygon(rings[0], rings[1:])
    if shapely.is_valid(whole):
        return
    names = ["points"] + [f"holes[{i}]" for i in range(len(rings) - 1)]
    alone = [shapely.Polygon(ring) for ring in rings]
    for name, polygon in zip(names, alone):
        if not shapely.is_valid(polygon):
            raise ValueError(f"{name} must not cross or touch itself; it does {_place(polygon)}")
    for name, hole in zip(names[1:], alone[1:]):
        if not alone[0].covers(hole):
            x, y = hole.difference(alone[0]).representative_point().coords[0]
            raise ValueError(f"{name} must lie inside the outer ring; ({x:.6g}, {y:.6g}) of it is outside")
        if hole.boundary.intersection(alone[0].boundary).length > 0:
            raise ValueError(f"{name} must not share an edge with the outer ring; it does {_place(whole)}")
    for i, first in enumerate(alone[1:]):
        for j, second in enumerate(alone[i + 2 :], start=i + 1):
            common = first.intersection(second)
            if common.area > 0 or common.length > 0:
                x, y = common.representative_point().coords[0]
                raise ValueError(f"holes[{i}] and holes[{j}] must be apart; they meet at ({x:.6g}, {y:.6g})")
    raise ValueError(f"rings must bound one connected region, got: {shapely.is_valid_reason(whole)}")


def _place(polygon: shapely.Polygon) -> str:
    """Where GEOS says it is: its reason reads like "Self-intersection[x y]"."""
    reason = str(shapely.is_valid_reason(polygon))
    found = re.search(r"\[(\S+) ([^\]\s]+)", reason)
    return f"at ({float(found[1]):.6g}, {float(found[2]):.6g})" if found else f"({reason})"


# --- sums over a ring, relative to a point near it ---


def _area_and_first_moment(ring: Points) -> tuple[float, Points]:
    """Signed area and ∫ r dA (2,) by Green's theorem (the paper's Eq. 4 and 7)."""
    following = np.concatenate((ring[1:], ring[:1]))
    cross = ring[:, 0] * following[:, 1] - ring[:, 1] * following[:, 0]
    return float(cross.sum()) / 2, cross @ (ring + following) / 6


def _polar_moment(ring: Points) -> float:
    """∫ |r|² dA, signed like the area."""
    following = np.concatenate((ring[1:], ring[:1]))
    cross = ring[:, 0] * following[:, 1] - ring[:, 1] * following[:, 0]
    square = (ring * ring + ring * following + following * following).sum(axis=1)
    return float((cross * square).sum()) / 12


# --- pymunk's shapes ---


@lru_cache(maxsize=4096)  # outlines are immutable: ten thousand equal boxes share one
def _rounded(vertices: tuple[tuple[float, float], ...], radius: float, tolerance: float | None) -> Outline:
    """The convex polygon `vertices` (counter-clockwise; one: a disc, two: a capsule) grown by `radius`."""
    points = np.array(vertices)
    if not np.isfinite(points).all():
        raise ValueError(f"coordinates of a pymunk shape must be finite, got {vertices}")
    if radius == 0 and len(vertices) > 2:
        return Outline.from_curve([_ring(points, "vertices")])  # a hull is simple, but may be flat
    positive(radius, "radius of a pymunk shape")
    if tolerance is None:
        tolerance = DEFAULT_TOLERANCE * (float(np.ptp(points, axis=0).min()) / 2 + radius)
    again = partial(_rounded, vertices, radius)
    if len(points) == 1:
        return Outline.from_curve([circle_points(vertices[0], radius, tolerance)], again)
    edge = np.roll(points, -1, axis=0) - points
    heading = np.arctan2(edge[:, 1], edge[:, 0])
    arcs = []
    for i in range(len(points)):
        sweep = (heading[i] - heading[i - 1] + 1e-6) % (2 * math.pi) - 1e-6  # 0 … π, for all rounding
        start = heading[i - 1] - math.pi / 2
        arc = arc_points(vertices[i], radius, start, max(sweep, 1e-6), tolerance)
        arcs.append(arc if sweep > 1e-6 else arc[:1])
    return Outline.from_curve([np.concatenate(arcs)], again)


@lru_cache(maxsize=4096)
def _half_space(
    a: tuple[float, float], b: tuple[float, float], side: str, thickness: float | None
) -> Outline:
    """The rectangle behind the segment a→b; edge 0 of it (and of its mirror) is the segment. See
    `Outline.from_pymunk`."""
    start, end = np.array(a), np.array(b)
    along = end - start
    length = float(np.hypot(*along))
    if not (math.isfinite(length) and length > 0):
        raise ValueError(
            f"a segment of radius 0 must have a positive, finite length, got {length!r} from {a} to {b}"
        )
    depth = SEGMENT_THICKNESS * length if thickness is None else positive(thickness, "thickness")
    left = np.array((-along[1], along[0])) * (depth / length)
    on_right = Outline.from_curve([np.array((end, start, start - left, end - left))])
    on_left = Outline.from_curve([np.array((start, end, end + left, start + left))])
    if side == "both":
        _face_each_other(on_right, on_left)
    return on_left if side == "left" else on_right


def _face_each_other(one: Outline, other: Outline) -> None:
    one.mirror, other.mirror = other, one


def _bounding_octagon(hull: Points) -> Points:
    """The smallest of a few octagons of 45° corners around a convex hull (m, 2): 8 support lines, met two
    by two."""
    best, best_area = hull, math.inf
    for turn in np.arange(8) * (math.pi / 32):
        angle = turn + np.arange(9) * (math.pi / 4)
        normal = np.column_stack((np.cos(angle), np.sin(angle)))
        support = (hull @ normal.T).max(axis=0)
        # n·x = s and n'·x = s' with n' 45° on
        s, t, n, m = support[:-1, None], support[1:, None], normal[:-1], normal[1:]
        corners = s * np.column_stack((m[:, 1], -m[:, 0])) - t * np.column_stack((n[:, 1], -n[:, 0]))
        corners /= math.sin(math.pi / 4)
        area = abs(_area_and_first_moment(corners - corners[0])[0])
        if area < best_area:
            best, best_area = corners, area
    return best


def _resample_moved(
    resample: Callable[..., Outline], angle: float, dx: float, dy: float, *, tolerance: float
) -> Outline:
    return resample(tolerance=tolerance)._moved(angle, dx, dy)


def _restore(
    rings: tuple[Points, ...], resample: Callable[..., Outline] | None, mirror: tuple[Points, ...] | None
) -> Outline:
    outline = Outline.from_curve(rings, resample)
    if mirror is not None:
        _face_each_other(outline, Outline.from_curve(mirror))
    return outline
