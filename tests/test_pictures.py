"""What a notebook shows: SVG whose shapes are the outlines, read back by a library that nobody here wrote."""

import math
import xml.etree.ElementTree as ET

import numpy as np
import pymunk
import pytest
import shapely

import rigidarea as ra

OUTLINES = {
    "polygon": ra.Outline([(0, 0), (60, 0), (60, 50), (45, 50), (45, 15), (15, 15), (15, 50), (0, 50)]),
    "hole": ra.Outline([(0, 0), (4, 0), (4, 3), (0, 3)], [[(1, 1), (1, 2), (2, 2), (2, 1)]]),
    "arcs": ra.Outline.from_bulges([(-30, -20, 0), (30, -20, 0.7), (30, 25, -0.6), (-30, 25, 0.3)]),
    "disc": ra.Outline.circle(3, (1, 2)),
}


def read(text):
    """Polygons of a picture's paths, transforms applied: by svgelements, in the picture's own pixels."""
    svgelements = pytest.importorskip("svgelements")
    import io

    drawing = svgelements.SVG.parse(io.StringIO(text), reify=True)
    found = []
    for path in drawing.elements(lambda e: isinstance(e, svgelements.Path)):
        rings = []
        for part in path.as_subpaths():
            points = np.asarray(svgelements.Path(part).npoint(np.linspace(0, 1, 4001)))
            rings.append(points.reshape(-1, 2))
        found.append((rings, drawing))
    return found


def scale_of(text):
    root = ET.fromstring(text)
    return float(root.get("width")) / float(root.get("viewBox").split()[2])


@pytest.mark.parametrize("name", OUTLINES)
def test_an_outline(name):
    outline = OUTLINES[name]
    text = outline._repr_svg_()
    ((rings, _),) = read(text)
    outer, *holes = sorted((shapely.Polygon(ring) for ring in rings), key=lambda p: -p.area)
    area = outer.area - sum(hole.area for hole in holes)
    assert area / scale_of(text) ** 2 == pytest.approx(outline.area, rel=2e-3)
    html = outline._repr_html_()
    assert text in html and "Outline of" in html and "<Outline" not in html


def test_a_space():
    """Every shape is there, where its body is; y down where gravity says so."""
    for g in (-900, 900):
        space = pymunk.Space()
        space.gravity = 0, g
        for i, outline in enumerate(OUTLINES.values()):
            body = outline.body(mass=1)
            body.position, body.angle = (100 * i, 30), 0.4 * i
            space.add(body, outline.add_to(body))
        space.add(pymunk.Segment(space.static_body, (-50, -60), (400, -60), 0))
        contact = ra.attach(space)
        text = space._repr_svg_()
        assert text.count("<path ") == 5
        found = read(text)
        middles = [np.concatenate(rings).mean(axis=0) for rings, _ in found]
        heights = [y for _, y in middles]
        assert (heights[4] > max(heights[:4])) == (g < 0)  # pixels run down
        assert middles[0][0] < middles[1][0] < middles[2][0] < middles[3][0]
        assert "4 bodies" in space._repr_html_() and "5 shapes" in repr(contact)
        contact.detach()
        assert repr(contact) == "<AreaContact, detached>" and not hasattr(space, "_repr_svg_")


def test_an_empty_space_and_a_frame_in_progress():
    space = pymunk.Space()
    contact = ra.attach(space)
    assert space._repr_svg_().startswith("<svg") and "0 bodies" in repr(contact)
    body = pymunk.Body(1, math.inf)
    said = []
    body.velocity_func = lambda *_: said.append(repr(contact))
    space.add(body, pymunk.Circle(body, 1))
    space.step(1 / 60)
    assert said and "1 bodies" in said[0]
