"""What a body's boundary is: rings of straight edges and circular arcs, holes, exact mass properties.

Conventions: lengths in the unit of the space; points are `(n, 2)` arrays in body coordinates (pymunk's
local coordinates); the outer ring runs counter-clockwise and holes clockwise, so the solid is always on the
left of an edge; no ring repeats its first point at the end.

Circles and rounded corners are kept as arcs (`Outline.arcs`, see `arcs.py`), and contact, mass and moment are
those of the arcs. Other curves (involutes) become chords, and so do arcs where somebody asks for points:
`sample(tolerance)`. `tolerance` is everywhere the same length: the largest sagitta of a chord. Arcs are
sampled so that the **area is kept exactly**: the vertices lie a little outside the arc and the chords'
middles a little inside (2/3 and 1/3 of the sagitta on a full circle), because a force proportional to area
feels area, not vertices. The inertia of a disc is then right to fourth order in the chord's angle.
`DEFAULT_TOLERANCE` times half the smaller extent of a shape is the tolerance where none is given.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from functools import cached_property, lru_cache, partial
from typing import Any, Literal, Unpack

import numpy as np
import pymunk
import shapely
from numpy.typing import ArrayLike

from . import arcs as curves
from .arcs import Points, arc_points, circle_points
from .gate import (
    LARGEST,
    ShapeAttributes,
    check_valid,
    checked_attribute,
    checked_bulges,
    checked_ring,
    finite,
    listed,
    not_negative,
    numbers,
    positive,
)
from .simple import check_simple
from .stand_in import MAX_VERTICES, hull_of, stand_in, width_of
from .svg_picture import FILL, figure, path_data, svg

DEFAULT_TOLERANCE = 5e-5
"""Largest sagitta of a chord over half the shape's smaller extent (dimensionless): a disc would get 316 points. An
eighth of the penetration that `attach` allows by default, so that what rolls on a sampled curve hardly feels its
facets. Contacts cost what the contact is, not the outline."""

SEGMENT_THICKNESS = 2.0
"""Depth of the solid behind a segment of radius 0 over the segment's length (dimensionless). See
`Outline.from_pymunk`."""

_EPS = float(np.finfo(np.float64).eps)

__all__ = [
    "DEFAULT_TOLERANCE",
    "SEGMENT_THICKNESS",
    "Outline",
    "Points",
    "arc_points",
    "circle_points",
    "positive",
]


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
    """Read-only float64 arrays (n, 2): [0] the outer ring, counter-clockwise; the rest holes, clockwise. Where there
    are `arcs` these are the ends of edges, not a polygon: whoever wants one takes `sample(tolerance)`."""
    arcs: tuple[Points, ...]
    """Empty for a polygon. Else, a ring, a read-only (n, 3) array beside its points: centre x, y and signed radius
    (length) of the arc from point i to point i + 1; radius > 0 counter-clockwise, < 0 clockwise, 0 a straight edge. No
    arc sweeps more than half a turn."""
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
        rings = [checked_ring(points, "points")]
        rings += [checked_ring(hole, f"holes[{i}]") for i, hole in enumerate(listed(holes, "holes"))]
        check_valid(rings)
        self._set(rings)

    @classmethod
    def from_curve(
        cls,
        rings: Iterable[Points],
        resample: Callable[..., Outline] | None = None,
        arcs: Iterable[Points] = (),
    ) -> Outline:
        """From sampled curves, or rings with arcs, known to make an outline (unchecked).

        `resample(tolerance=...)` makes a sampled outline anew; a functools.partial of a module's function, so
        that it can be pickled. See `sample`. arcs: as the attribute, for all rings or none; both ends of each on its
        circle to a few roundings, as doubles of centre and radius leave them (8 times 2^-52 of the largest of radius
        and coordinates): an overlap's signs allow for that, and for no more.
        """
        self = cls.__new__(cls)
        self._set(
            [np.array(ring, dtype=np.float64) for ring in rings],
            resample,
            [np.array(ring, dtype=np.float64) for ring in arcs],
        )
        return self

    @classmethod
    def circle(cls, radius: float, center: tuple[float, float] = (0.0, 0.0)) -> Outline:
        """A disc: its boundary is the circle itself (lengths).

        Raises ValueError unless radius is positive and center finite.
        """
        radius = positive(radius, "radius")
        x, y = numbers(center, "center", 2)
        ring, arcs = curves.circle_ring((x, y), radius)
        return cls.from_curve([ring], arcs=[arcs])

    @classmethod
    def from_bulges(cls, ring: ArrayLike, holes: Iterable[ArrayLike] = ()) -> Outline:
        """From rings of points and bulges, as CAD exchanges them: arrays (n, 3) of x, y, bulge.

        The edge from point i to the next is an arc that turns by 4 atan(bulge), to the left if bulge > 0; 0 is a
        straight edge, 1 a half circle to the right of its chord. Two points are enough for a ring with an arc.
        Raises ValueError as the constructor does; crossings are those of the arcs themselves (`simple.py`).
        """
        found = [checked_bulges(ring, "ring")] + [
            checked_bulges(hole, f"holes[{i}]") for i, hole in enumerate(listed(holes, "holes"))
        ]
        rings, arcs = [points for points, _ in found], [arcs for _, arcs in found]
        check_simple(rings, arcs, ["ring"] + [f"holes[{i}]" for i in range(len(rings) - 1)])
        return cls.from_curve(rings, arcs=arcs)

    def with_curve(self, resample: Callable[..., Outline]) -> Outline:
        """The same outline, knowing how to `sample` itself anew."""
        return Outline.from_curve(self.rings, resample)

    def _set(
        self,
        rings: list[Points],
        resample: Callable[..., Outline] | None = None,
        arcs: Sequence[Points] = (),
    ) -> None:
        if not all(np.isfinite(ring).all() and np.abs(ring).max() <= LARGEST for ring in rings):
            raise ValueError(f"coordinates must be finite and at most {LARGEST:g} in size")
        if not any(ring[:, 2].any() for ring in arcs):
            arcs = ()
        outer = curves.extremes(rings[0], arcs[0]) if arcs else rings[0]
        lower, upper = np.minimum.reduce(outer), np.maximum.reduce(outer)
        middle = (
            lower + upper
        ) / 2  # sums are taken relative to it: far from the origin they lose all digits
        if arcs and len(rings) == 1 and curves.is_circle(arcs[0]):
            middle = arcs[0][0, :2]
        total, first = 0.0, np.zeros(2)
        oriented, bent = [], []
        for i, ring in enumerate(rings):
            arc = curves.about(arcs[i], middle) if arcs else None
            area, moment, _ = curves.measures(ring - middle, arc)
            if (area > 0) == (i > 0):
                area, moment = -area, -moment
                if arcs:
                    ring, arc = curves.reversed_ring(ring, arcs[i])
                    bent.append(arc)
                else:
                    ring = np.ascontiguousarray(ring[::-1])
            elif arcs:
                bent.append(arcs[i])
            oriented.append(ring)
            total += area
            first += moment
        for array in (*oriented, *bent):
            array.flags.writeable = False
        if not (total > 0 and math.isfinite(total)):
            raise ValueError(
                f"an outline must enclose an area above 0, got {total:.3g} within {upper - lower}"
            )
        self.rings = tuple(oriented)
        self.arcs = tuple(bent)
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
        side: Literal["both", "left", "right"] = "both",
        thickness: float | None = None,
    ) -> Outline:
        """The solid that a pymunk shape stands for, in its body's coordinates.

        An outline put on the shape (`shape.outline`, see `add_to`) is returned as it is. Otherwise: a
        Circle is a circle; a Poly is its convex hull, as in pymunk, its corners rounded by `radius`; a Segment
        with a radius is a capsule; their arcs are arcs, or with a `tolerance` (sagitta, length) sampled to it.
        Equal shapes get the same Outline object.

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

        Like `pymunk.moment_for_poly`, for concave outlines, arcs and holes too. Exact.
        Raises ValueError unless mass is finite and not negative.
        """
        mass = not_negative(mass, "mass")
        dx, dy = numbers(offset, "offset", 2)
        x, y = self.centroid[0] + dx, self.centroid[1] + dy
        return mass * (self._gyration + x * x + y * y)

    @cached_property
    def _gyration(self) -> float:
        """Squared radius of gyration about the centroid (length²)."""
        rings = self._with_arcs()
        about = [(ring - self.centroid, curves.about(arc, self.centroid)) for ring, arc in rings]
        return sum(curves.measures(ring, arc)[2] for ring, arc in about) / self.area

    def _with_arcs(self) -> list[tuple[Points, Points | None]]:
        return list(zip(self.rings, self.arcs or (None,) * len(self.rings)))

    @cached_property
    def convex(self) -> bool:
        """True for one ring without a reflex corner or hollow arc; collinear points are allowed."""
        if len(self.rings) > 1:
            return False
        ring = self.rings[0]
        if self.arcs:
            starts, ends = curves.tangents(ring, self.arcs[0])
            behind = np.roll(ends, 1, axis=0)
            turn = behind[:, 0] * starts[:, 1] - behind[:, 1] * starts[:, 0]
            # tangents are known to the rounding of a coordinate over the shortest radius or edge
            least = np.abs(self.arcs[0][:, 2])[self.arcs[0][:, 2] != 0].min()
            least = min(least, np.hypot(*(np.roll(ring, -1, axis=0) - ring).T).min())
            return bool(
                (self.arcs[0][:, 2] >= 0).all() and np.all(turn >= -8 * _EPS * np.abs(ring).max() / least)
            )
        ahead = np.roll(ring, -1, axis=0) - ring
        behind = np.roll(ahead, 1, axis=0)
        turn = behind[:, 0] * ahead[:, 1] - behind[:, 1] * ahead[:, 0]
        # a coordinate is known to half an ulp, so a turn to that times the two edges' lengths
        noise = 2 * _EPS * np.abs(ring).max() * (np.abs(ahead).sum(axis=1) + np.abs(behind).sum(axis=1))
        return bool(np.all(turn >= -noise))

    @cached_property
    def polygon_rings(self) -> tuple[Points, ...]:
        """The rings as polygons: arcs sampled to `DEFAULT_TOLERANCE` times half the smaller extent."""
        if not self.arcs:
            return self.rings
        xmin, ymin, xmax, ymax = self.bounds
        return self.sample(DEFAULT_TOLERANCE * min(xmax - xmin, ymax - ymin) / 2).rings

    @cached_property
    def polygon(self) -> shapely.Polygon:
        """The same region as a shapely Polygon, of `polygon_rings`."""
        outer, *holes = self.polygon_rings
        return shapely.Polygon(outer, holes)

    @property
    def two_sided(self) -> bool:
        """True for a segment of radius 0 that is solid on whichever side the other body did not come from."""
        return self.mirror is not None

    # --- other outlines from it ---

    def sample(self, tolerance: float) -> Outline:
        """The same boundary as polygons, no chord's sagitta above `tolerance` (length), areas kept.

        Arcs become chords, and shapes that know their curve (`rigidarea.shapes`) are made again from it; an
        outline that came as points is all there is to know, and is returned itself.
        Raises ValueError unless tolerance is positive.
        """
        positive(tolerance, "tolerance")
        if self.arcs:
            rings = [curves.sampled(ring, arc, tolerance) for ring, arc in zip(self.rings, self.arcs)]
            return Outline.from_curve(rings, partial(_sample, self))
        return self if self._resample is None else self._resample(tolerance=tolerance)

    def translated(self, dx: float, dy: float) -> Outline:
        """A copy shifted by (dx, dy), length."""
        return self._moved(0.0, finite(dx, "dx"), finite(dy, "dy"))

    def rotated(self, angle: float) -> Outline:
        """A copy turned about the body's origin by `angle` (radians, counter-clockwise)."""
        return self._moved(finite(angle, "angle"), 0.0, 0.0)

    def _moved(self, angle: float, dx: float, dy: float) -> Outline:
        c, s = math.cos(angle), math.sin(angle)
        turn = np.array([[c, s], [-s, c]])
        moved = [ring @ turn + (dx, dy) for ring in self.rings]  # by an angle of 0 the product is exact
        again = None if self._resample is None else partial(_resample_moved, self._resample, angle, dx, dy)
        bent = [np.column_stack((arc[:, :2] @ turn + (dx, dy), arc[:, 2])) for arc in self.arcs]
        outline = Outline.from_curve(moved, again, bent)
        if self.mirror is not None:
            _face_each_other(outline, Outline.from_curve([r @ turn + (dx, dy) for r in self.mirror.rings]))
        return outline

    # --- into a pymunk space ---

    def add_to(self, body: pymunk.Body, **shape_attrs: Unpack[ShapeAttributes]) -> pymunk.Shape:
        """Put the outline on a body, behind a proxy shape of pymunk's that contains it; returns that shape,
        to add to the space.

        The proxy only tells the broad phase where to look; contact is computed with the exact outline,
        which hangs on it as `shape.outline` and survives copying and pickling. The proxy is the
        circle itself for a disc, its convex hull where that has no more than 8 vertices, else the tighter of
        its bounding circle and a bounding octagon (the circle, unless the octagon is a tenth smaller). In an attached
        space callbacks and `debug_draw` see the outline. pymunk's own queries see the proxy: `point_query`,
        `segment_query` and `shapes_collide` report a slot, a hole or the gap between two teeth as solid;
        `rigidarea.point_query` and `rigidarea.segment_query` do not. The proxy has no mass: give the body its mass
        and moment (`moment`, or `body`).

        shape_attrs: friction, elasticity, collision_type, filter, sensor, surface_velocity, as in pymunk.
        Raises ValueError for other names (mass and density among them), and for values that pymunk could not take.
        """
        if not isinstance(body, pymunk.Body):
            raise ValueError(f"body must be a pymunk.Body, got {type(body).__name__}")
        known = ShapeAttributes.__annotations__
        unknown = sorted(set(shape_attrs) - set(known))
        if unknown:
            raise ValueError(f"expected shape attributes among {', '.join(known)}; got {', '.join(unknown)}")
        for name, value in shape_attrs.items():
            checked_attribute(name, value)
        kind, form = self._stand_in
        shape = kind(body, *form)
        for name, value in shape_attrs.items():
            setattr(shape, name, value)
        shape.outline = self
        return shape

    @cached_property
    def proxied(self) -> bool:
        """Whether pymunk's broad phase sees another shape (`add_to`): not of a disc, a convex polygon of at the most
        8 points, a segment.
        """
        if self.arcs:
            return len(self.rings) > 1 or not curves.is_circle(self.arcs[0])
        return not self.two_sided and (len(self.rings[0]) > MAX_VERTICES or not self.convex)

    @cached_property
    def smallest_extent(self) -> float:
        """The least distance of two parallel lines with the outline between them (length): its smallest thickness."""
        return width_of(self._hull)

    @cached_property
    def _hull(self) -> Points:
        return hull_of(self.polygon_rings[0])

    @cached_property
    def _stand_in(self) -> tuple[Callable[..., pymunk.Shape], tuple[Any, ...]]:
        """The stand-in's class and its arguments after the body; the same for every body the outline is put
        on."""
        if self.mirror is not None:
            b, a = self.rings[0][:2].tolist()
            return pymunk.Segment, (a, b, 0)
        if self.arcs and len(self.rings) == 1 and curves.is_circle(self.arcs[0]):
            x, y, radius = self.arcs[0][0].tolist()
            return pymunk.Circle, (radius, (x, y))
        return stand_in(hull_of(curves.around(self.rings[0], self.arcs[0])) if self.arcs else self._hull)

    def body(self, *, density: float | None = None, mass: float | None = None) -> pymunk.Body:
        """A dynamic pymunk body at the origin with this outline's mass, moment, centre of gravity (no shape on it yet).

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
        body.position = 0, 0  # which pymunk moves with the centre of gravity
        return body

    # --- immutable: copies share it ---

    def __copy__(self) -> Outline:
        return self

    def __deepcopy__(self, memo: dict[int, Any]) -> Outline:
        return self

    def __reduce__(self) -> tuple[Any, ...]:
        mirror = None if self.mirror is None else self.mirror.rings
        return _restore, (self.rings, self._resample, mirror, self.arcs)

    def _repr_svg_(self) -> str:
        """A notebook's picture of it."""
        return svg([(path_data(self.rings, self.arcs), "", FILL)], self.bounds)

    def _repr_html_(self) -> str:
        return figure(self._repr_svg_(), repr(self))

    def __repr__(self) -> str:
        points = " + ".join(str(len(ring)) for ring in self.rings)
        arcs = sum(int(np.count_nonzero(arc[:, 2])) for arc in self.arcs)
        bent = f", {arcs} arcs" if arcs else ""
        return f"<Outline of {points} points{bent}, area {self.area:.6g}, bounds {self.bounds}>"


# --- pymunk's shapes ---


@lru_cache(maxsize=512)  # outlines are immutable: ten thousand equal boxes share one
def _rounded(vertices: tuple[tuple[float, float], ...], radius: float, tolerance: float | None) -> Outline:
    """The convex polygon `vertices` (counter-clockwise; one: a disc, two: a capsule) grown by `radius`."""
    points = np.array(vertices)
    if not np.isfinite(points).all():
        raise ValueError(f"coordinates of a pymunk shape must be finite, got {vertices}")
    if radius == 0 and len(vertices) > 2:
        return Outline.from_curve([checked_ring(points, "vertices")])  # a hull is simple, but may be flat
    positive(radius, "radius of a pymunk shape")
    if tolerance is not None:
        return _rounded(vertices, radius, None).sample(tolerance)
    if len(points) == 1:
        return Outline.circle(radius, vertices[0])
    ring, arcs = curves.grown(points, radius)
    return Outline.from_curve([ring], arcs=[arcs])


@lru_cache(maxsize=512)
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


def _resample_moved(
    resample: Callable[..., Outline], angle: float, dx: float, dy: float, *, tolerance: float
) -> Outline:
    return resample(tolerance=tolerance)._moved(angle, dx, dy)


def _sample(outline: Outline, *, tolerance: float) -> Outline:
    return outline.sample(tolerance)


def _restore(
    rings: tuple[Points, ...],
    resample: Callable[..., Outline] | None,
    mirror: tuple[Points, ...] | None,
    arcs: tuple[Points, ...] = (),
) -> Outline:
    outline = Outline.from_curve(rings, resample, arcs)
    if mirror is not None:
        _face_each_other(outline, Outline.from_curve(mirror))
    return outline
