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
from functools import lru_cache, partial
from typing import Any, Literal

import numpy as np
import pymunk
import shapely
from numpy.typing import ArrayLike

from . import arcs as curves
from .arcs import Points
from .gate import (
    check_valid,
    checked_bulges,
    checked_ring,
    finite,
    listed,
    numbers,
    positive,
)
from .measured import measured
from .simple import check_simple
from .solid import Solid
from .svg_picture import FILL, figure, path_data, svg

SEGMENT_THICKNESS = 2.0
"""Depth of the solid behind a segment of radius 0 over the segment's length (dimensionless). See
`Outline.from_pymunk`."""


class Outline(Solid):
    """The boundary of a rigid body: an outer ring and any number of holes. Immutable.

    points: (n, 2) array-like, n >= 3, the outer ring. Either sense, closed or not; repeated points are
        dropped, collinear ones kept.
    holes: array-likes (m, 2), each inside the outer ring and apart from the others (touching in a point is
        allowed).

    Raises ValueError, naming what was expected and what came, for wrong shapes, NaN or infinite
    coordinates, fewer than three distinct points, zero area, a ring that crosses itself (with the place), a
    hole outside its ring, holes that overlap.
    """

    _resample: Callable[..., Outline] | None

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
        straight edge, and so is less than 1e-8, to rounding; 1 a half circle to the right of its chord. Two points are
        enough for a ring with an arc.
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
        found = measured(rings, arcs)
        self.__dict__.update(
            **{name: getattr(found, name) for name in ("rings", "arcs", "area", "centroid", "bounds")},
            mirror=None,
            _resample=resample,
        )

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
        if outline := outline_on(shape):
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

    # --- immutable: copies share it ---

    def __setattr__(self, name: str, value: Any) -> None:
        raise AttributeError(
            f"an Outline is immutable: make another one; {name} cannot be set to {value!r:.80}"
        )

    def __delattr__(self, name: str) -> None:
        raise AttributeError(f"an Outline is immutable: make another one; {name} cannot be deleted")

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


def outline_on(shape: pymunk.Shape) -> Outline | None:
    """The outline that somebody has put on a shape (`shape.outline`, see `Outline.add_to`); None: nobody has."""
    outline = getattr(shape, "__dict__", {}).get("outline")  # (pymunk's `__getattr__` takes 1 us to say no)
    return outline if isinstance(outline, Outline) else None


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
    one.__dict__["mirror"], other.__dict__["mirror"] = other, one


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
