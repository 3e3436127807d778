"""Convex decomposition: tiles exactly, convex, counter-clockwise, few pieces."""

import numpy as np
import pytest
import shapely

from rigidarea.study.decompose import convex_pieces, triangles
from rigidarea.study.scene import full_circle
from rigidarea.study.scenes.bar_on_u_scene import u_shape
from rigidarea.study.scenes.gears_scene import gear

RINGS = {
    "u": u_shape().rings(0.01),
    "annulus": (full_circle(1.0, 0.01), full_circle(0.8, 0.01)),
    "gear": gear(20, 1e-4).rings[:1],
    "square": (np.array([(0.0, 0), (1, 0), (1, 1), (0, 1)]),),
}


@pytest.mark.parametrize("most", [None, 8])
@pytest.mark.parametrize("name", list(RINGS))
def test_pieces_tile_the_outline(name, most):
    """The union is the outline, areas add up (no overlap), every piece is convex and turns left."""
    outer, *holes = RINGS[name]
    whole = shapely.Polygon(outer, holes)
    pieces = [shapely.Polygon(piece) for piece in convex_pieces(RINGS[name], most)]
    assert sum(piece.area for piece in pieces) == pytest.approx(whole.area, rel=1e-12)
    assert shapely.union_all(pieces).symmetric_difference(whole).area < 1e-9 * whole.area
    for piece in pieces:
        assert piece.exterior.is_ccw
        assert piece.convex_hull.area == pytest.approx(piece.area, rel=1e-9)
        assert most is None or len(piece.exterior.coords) - 1 <= most


def test_merging_leaves_few_pieces():
    """A convex outline is one piece; an annulus of n sides at most n, from 2 n triangles; a U three."""
    assert len(convex_pieces(RINGS["square"])) == 1
    assert len(convex_pieces(RINGS["u"])) == 3
    n = len(RINGS["annulus"][0])
    assert len(triangles(RINGS["annulus"])) == n + len(RINGS["annulus"][1])
    assert len(convex_pieces(RINGS["annulus"])) <= n
