"""The solid within an outline's rings: what it measures, and what it is to pymunk's bodies (`outline` makes it)."""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property
from typing import Any, Self, Unpack

import pymunk
import shapely

from . import arcs as curves
from .arcs import Points
from .gate import ShapeAttributes, checked_attribute, not_negative, numbers, positive
from .measured import gyration, is_convex, measured
from .stand_in import MAX_VERTICES, hull_of, stand_in, width_of

DEFAULT_TOLERANCE = 5e-5
"""Largest sagitta of a chord over half the shape's smaller extent (dimensionless): a disc would get 316 points. An
eighth of the penetration that `attach` allows by default, so that what rolls on a sampled curve hardly feels its
facets. Contacts cost what the contact is, not the outline."""


class Solid:
    """The part of `Outline` that does not say how it was made."""

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
    mirror: Self | None
    """The same segment's solid on its other side, for an outline made from a pymunk segment of radius 0;
    else None."""

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
        return gyration(self.rings, self.arcs, self.area, self.centroid)

    @cached_property
    def convex(self) -> bool:
        """True for one ring without a reflex corner or hollow arc; collinear points are allowed."""
        return len(self.rings) == 1 and is_convex(self.rings[0], self.arcs[0] if self.arcs else None)

    @cached_property
    def polygon_rings(self) -> tuple[Points, ...]:
        """The rings as polygons: arcs sampled to `DEFAULT_TOLERANCE` times half the smaller extent."""
        if not self.arcs:
            return self.rings
        xmin, ymin, xmax, ymax = self.bounds
        tolerance = DEFAULT_TOLERANCE * min(xmax - xmin, ymax - ymin) / 2
        return measured([curves.sampled(*both, tolerance) for both in zip(self.rings, self.arcs)], ()).rings

    @cached_property
    def polygon(self) -> shapely.Polygon:
        """The same region as a shapely Polygon, of `polygon_rings`."""
        outer, *holes = self.polygon_rings
        return shapely.Polygon(outer, holes)

    @property
    def two_sided(self) -> bool:
        """True for a segment of radius 0 that is solid on whichever side the other body did not come from."""
        return self.mirror is not None

    # --- in a pymunk space ---

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
