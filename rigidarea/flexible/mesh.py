"""T3 meshes whose boundary nodes are exactly the outline's.

Seeds lie on hexagonal lattices, one for each band of a graded size field, Delaunay connects them, and a few
rounds of Laplacian smoothing even them out (P.-O. Persson and G. Strang, A simple mesh generator in MATLAB,
SIAM Review 46(2), 2004, doi:10.1137/S0036144503429121, for the idea of smoothing under Delaunay). Boundary
points never move, and no point is added to the boundary: the paper's section 2 takes the contact perimeter
from the boundary of this mesh.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray
from scipy.spatial import Delaunay, cKDTree

Array = NDArray[np.float64]

BAND = 1.3  # ratio of lattice spacings of neighbouring bands of the graded size field
BOUNDARY_GAP = 0.62  # seeds keep this part of the local size from the boundary: its edges stay Delaunay
SEED_GAP = 0.72  # and this part of it from the seeds of finer bands
BATCH = 20_000  # lattice points looked at together: more cost memory, a hundred numbers each
ROUNDS = 6  # of smoothing; more gains less than a degree
MIN_ANGLE = 5.0  # degrees; below, the interpolation error of a triangle is more than ten times a good one's
CORNER = np.radians(30.0)  # a vertex that turns by more is a corner, kept as a node


@dataclass(frozen=True)
class Mesh:
    """A triangle mesh.

    points: (n, 2), length; the boundary nodes first, ring after ring, in the outline's order.
    triangles: (m, 3), counter-clockwise. rings: index arrays into ``points``, [0] the outer ring, then holes.
    """

    points: Array
    triangles: NDArray[np.int64]
    rings: tuple[NDArray[np.int64], ...]

    @property
    def n_boundary(self) -> int:
        """Number of boundary nodes; they are nodes 0 … n_boundary - 1."""
        return sum(len(r) for r in self.rings)

    def areas(self) -> Array:
        """Triangle areas (m,), length²."""
        p, q, r = (self.points[self.triangles[:, i]] for i in range(3))
        return 0.5 * ((q[:, 0] - p[:, 0]) * (r[:, 1] - p[:, 1]) - (q[:, 1] - p[:, 1]) * (r[:, 0] - p[:, 0]))

    def min_angle(self) -> float:
        """The smallest angle of any triangle, degrees."""
        return float(np.degrees(_angles(self.points, self.triangles).min()))


def _angles(points: Array, triangles: NDArray[np.int64]) -> Array:
    corner = points[triangles]
    out = np.empty(triangles.shape)
    for i in range(3):
        u, v = corner[:, i - 1] - corner[:, i], corner[:, i - 2] - corner[:, i]
        out[:, i] = np.arctan2(np.abs(u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]), np.einsum("ij,ij->i", u, v))
    return out


def turns(ring: Array) -> Array:
    """By how much a closed ring (n, 2) turns at each of its points (n,), radians, counter-clockwise positive."""
    u, v = ring - np.roll(ring, 1, 0), np.roll(ring, -1, 0) - ring
    return np.asarray(np.arctan2(u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0], np.einsum("ij,ij->i", u, v)))


def resample(ring: Array, size: float, refine: int = 1) -> Array:
    """Nodes on a closed ring about ``size`` apart, (k, 2): corners kept, arcs between them divided evenly.

    ring: (n, 2), sampled finer than ``size``. refine: points an edge, (k · refine, 2): the nodes and, between
    them, points of the ring itself: a profile finer than the mesh. Raises ValueError where ``size`` is larger than a
    feature, that is where an arc between two corners is shorter than size/2, or the ring would keep fewer than 3
    nodes.
    """
    ring = np.asarray(ring, float)
    step = np.roll(ring, -1, 0) - ring
    length = np.hypot(step[:, 0], step[:, 1])
    corner = np.flatnonzero(np.abs(turns(ring)) > CORNER)
    if len(corner) == 0:
        corner = np.array([0])
    total = np.concatenate([[0.0], np.cumsum(length)])
    at = np.concatenate([total[corner], [total[-1] + total[corner[0]]]])
    marks = []
    for a, b in itertools.pairwise(at):
        if b - a < 0.5 * size:
            where = ring[np.searchsorted(total, a % total[-1]) % len(ring)]
            raise ValueError(
                f"mesh size must not exceed a feature: expected at most {2 * (b - a):.4g} (twice the shortest arc"
                f" between corners, at {where}), got {size:.4g}"
            )
        n = max(1, round((b - a) / size)) * refine
        marks.append(a + (b - a) * np.arange(n) / n)
    s = np.concatenate(marks) % total[-1]
    if len(s) < 3 * refine:
        raise ValueError(
            f"mesh size {size:.4g} leaves {len(s) // refine} nodes on a ring of length {total[-1]:.4g}, expected 3"
        )
    closed = np.vstack([ring, ring[:1]])
    return np.column_stack([np.interp(s, total, closed[:, 0]), np.interp(s, total, closed[:, 1])])


def keep_area(ring: Array) -> Array:
    """The points (k, 2) of a ring, evenly spaced between its corners, moved out so that their polygon has its area.

    Chords of a curve lie inside it by 2/3 of their sagitta in the mean; the points go out by as much, a sixth of what
    a point stands out of the line between its neighbours. A contact over many edges then has the curve's depth. Corners
    stay.
    """
    before, after = np.roll(ring, 1, 0), np.roll(ring, -1, 0)
    out = (ring - 0.5 * (before + after)) / 6
    out[np.abs(turns(ring)) > CORNER] = 0.0
    return ring + out


def triangulate(rings: Sequence[Array], growth: float = 0.2, max_size: float | None = None) -> Mesh:
    """Mesh the region bounded by ``rings`` ([0] outer, counter-clockwise; then holes, clockwise).

    The boundary nodes are the rings' points, no more and no fewer; inside, the size grows by ``growth`` a unit of
    distance from the boundary (0: uniform), up to ``max_size``. Raises ValueError if the rings do not bound a
    valid region or a boundary edge cannot be kept (two boundaries nearer than their own spacing).
    """
    rings = [np.ascontiguousarray(r, float) for r in rings]
    polygon = shapely.Polygon(rings[0], rings[1:])
    if not polygon.is_valid:
        raise ValueError(f"rings must bound a valid region, got: {shapely.is_valid_reason(polygon)}")
    boundary = np.vstack(rings)
    index, start = [], 0
    for r in rings:
        index.append(np.arange(start, start + len(r)))
        start += len(r)
    edge = np.vstack([np.column_stack([i, np.roll(i, -1)]) for i in index])
    span = boundary[edge[:, 1]] - boundary[edge[:, 0]]
    edge_length = np.hypot(span[:, 0], span[:, 1])
    if len(rings[0]) < 3 or edge_length.min() <= 0.0:
        raise ValueError(
            f"rings need at least 3 distinct points each, got edge length {edge_length.min():.3g}"
        )
    middle = 0.5 * (boundary[edge[:, 0]] + boundary[edge[:, 1]])
    tree = cKDTree(middle)
    shapely.prepare(polygon)
    near = min(8, len(middle))

    def size_and_gap(p: Array) -> tuple[Array, Array]:
        d, i = (np.reshape(a, (len(p), near)) for a in tree.query(p, k=near))
        h = (edge_length[i] + growth * d).min(1)
        h = h if max_size is None else np.minimum(h, max_size)
        # exact distance to the near edges: on a graded boundary the nearest midpoint may not own the nearest edge
        a, s = boundary[edge[i, 0]], span[i]
        t = np.clip(np.einsum("ijk,ijk->ij", p[:, None] - a, s) / edge_length[i] ** 2, 0.0, 1.0)
        return h, np.linalg.norm(p[:, None] - a - t[..., None] * s, axis=2).min(1)

    inner = _seeds(polygon, size_and_gap, middle, edge_length, growth)
    for n in range(ROUNDS + 1):
        tri = _delaunay_inside(np.vstack([boundary, inner]), polygon)
        missing = _missing(edge, tri)
        if len(missing):  # drop the seeds inside the diametral circle of a lost edge, and try again
            near_lost = cKDTree(middle[missing]).query(inner)[1] if len(inner) else np.zeros(0, int)
            lost = missing[near_lost]
            drop = np.linalg.norm(inner - middle[lost], axis=1) < 0.5 * edge_length[lost]
            inner = inner[~drop]
            tri = _delaunay_inside(np.vstack([boundary, inner]), polygon)
        if n < ROUNDS and len(inner):
            inner = _smooth(np.vstack([boundary, inner]), tri, len(boundary))
            h, gap = size_and_gap(inner)
            inner = inner[(gap > 0.35 * h) & shapely.contains_xy(polygon, inner[:, 0], inner[:, 1])]
    points = np.vstack([boundary, inner])
    used = np.zeros(len(points), bool)
    used[tri] = True
    used[: len(boundary)] = True
    new = np.cumsum(used) - 1
    mesh = Mesh(points[used], new[tri], tuple(index))
    lost = _missing(edge, mesh.triangles)
    if len(lost):
        raise ValueError(
            f"cannot keep boundary edge at {middle[lost[0]]} (length {edge_length[lost[0]]:.4g}): mesh size larger"
            " than a feature; refine the boundary there"
        )
    if not np.isclose(mesh.areas().sum(), polygon.area, rtol=1e-9):
        raise ValueError(f"mesh area {mesh.areas().sum():.9g} differs from the outline's {polygon.area:.9g}")
    if mesh.min_angle() < MIN_ANGLE:
        raise ValueError(
            f"mesh size larger than a feature: smallest angle {mesh.min_angle():.2g}°, expected at least {MIN_ANGLE}°;"
            " refine the boundary there, or grade it more gently"
        )
    return mesh


def _seeds(
    polygon: shapely.Polygon, size_and_gap: Callable[[Array], tuple[Array, Array]], middle: Array, length: Array,
    growth: float,
) -> Array:  # fmt: skip
    """Lattice points of all bands, the finest first; ``middle`` (e, 2) and ``length`` (e,) of the boundary edges."""
    x0, y0, x1, y1 = polygon.bounds
    kept, tree = np.empty((0, 2)), cKDTree(middle)
    finest = spacing = float(length.min())
    while spacing < max(x1 - x0, y1 - y0):
        # Only points near edges finer than this band belong to it: h = length + growth × distance < BAND × spacing
        own = length < BAND * spacing
        reach = ((BAND * spacing - length[own]) / growth)[:, None] if growth > 0 else np.inf
        low = np.maximum((middle[own] - reach).min(0), [x0, y0])
        high = np.minimum((middle[own] + reach).max(0), [x1, y1])
        rows = np.arange(low[1] + 0.5 * spacing, high[1], spacing * np.sqrt(0.75))
        cols = np.arange(low[0] + 0.5 * spacing, high[0], spacing)
        lower = 0.0 if spacing == finest else spacing * (1 - 1e-9)
        # whose size is at least the finest edge's, grown over the distance to the nearest
        far = (BAND * spacing - finest) / growth if growth > 0 else np.inf
        found = [np.empty((0, 2))]
        many = max(1, BATCH // max(1, len(cols)))
        for first in range(0, len(rows), many):
            lattice = np.stack(np.meshgrid(cols, rows[first : first + many]), -1)
            lattice[(1 - first % 2) :: 2, :, 0] += 0.5 * spacing
            lattice = lattice.reshape(-1, 2)
            lattice = lattice[tree.query(lattice, distance_upper_bound=far)[0] < far]
            lattice = lattice[shapely.contains_xy(polygon, lattice[:, 0], lattice[:, 1])]
            if len(lattice):
                h, gap = size_and_gap(lattice)
                found.append(
                    lattice[(h >= lower) & (h < spacing * BAND * (1 - 1e-9)) & (gap > BOUNDARY_GAP * h)]
                )
        lattice = np.vstack(found)
        if len(kept) and len(lattice):
            lattice = lattice[cKDTree(kept).query(lattice)[0] > SEED_GAP * spacing]
        kept = np.vstack([kept, lattice])
        spacing *= BAND
    return kept


def _delaunay_inside(points: Array, polygon: shapely.Polygon) -> NDArray[np.int64]:
    tri = Delaunay(points).simplices.astype(np.int64)
    c = points[tri].mean(1)
    tri = tri[shapely.contains_xy(polygon, c[:, 0], c[:, 1])]
    p, q, r = (points[tri[:, i]] for i in range(3))
    area = (q[:, 0] - p[:, 0]) * (r[:, 1] - p[:, 1]) - (q[:, 1] - p[:, 1]) * (r[:, 0] - p[:, 0])
    scale = np.max(np.ptp(points, axis=0)) ** 2
    tri, area = tri[np.abs(area) > 1e-14 * scale], area[np.abs(area) > 1e-14 * scale]
    tri[area < 0] = tri[area < 0][:, [0, 2, 1]]
    return tri


def _missing(edge: NDArray[np.int64], tri: NDArray[np.int64]) -> NDArray[np.int64]:
    n = int(max(edge.max(), tri.max())) + 1
    sides = np.vstack([tri[:, [0, 1]], tri[:, [1, 2]], tri[:, [2, 0]]])
    return np.flatnonzero(~np.isin(edge[:, 0] * n + edge[:, 1], sides[:, 0] * n + sides[:, 1]))


def _smooth(points: Array, tri: NDArray[np.int64], fixed: int) -> Array:
    """Every inner point to the mean of its neighbours."""
    i = tri[:, [0, 1, 1, 2, 2, 0]].ravel()
    j = tri[:, [1, 0, 2, 1, 0, 2]].ravel()
    n = np.bincount(i, minlength=len(points)).astype(float)
    mean = np.column_stack([np.bincount(i, points[j, k], len(points)) for k in range(2)])
    inner = n[fixed:] > 0
    return mean[fixed:][inner] / n[fixed:][inner, None]
