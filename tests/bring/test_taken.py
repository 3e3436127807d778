"""What other programs write and hand over is taken as they have it, or refused with a word."""

from __future__ import annotations

import numpy as np
import pytest
import shapely

from rigidarea import bring

SVG11 = (
    '<!DOCTYPE svg PUBLIC "-//W3C//DTD SVG 1.1//EN"\n  "http://www.w3.org/Graphics/SVG/1.1/DTD/svg11.dtd">'
)
RECT = '<svg xmlns="http://www.w3.org/2000/svg">\n<rect width="9" height="9"/>{}</svg>'


@pytest.mark.parametrize(
    "before",
    [
        SVG11,
        f'<?xml version="1.0"?>\n<!-- <!DOCTYPE svg [ -->\n{SVG11}\n<!-- made by hand -->',
        "<!DOCTYPE svg>",
        "<!DOCTYPE svg SYSTEM 'a.dtd' >",
    ],
)
def test_a_drawing_with_a_document_type(before, tmp_path):
    """As Inkscape, Illustrator and Graphviz write it. Lines are still the file's; entities are still refused."""
    file = tmp_path / "a.svg"
    file.write_text(before + RECT.format(""))
    (outline,) = bring.outlines_from_svg(file)
    assert outline.area == 81
    file.write_text(before + RECT.format('<path d="hello"/>'))
    with pytest.raises(ValueError, match=f"line {before.count(chr(10)) + 2}, <path>"):
        bring.outlines_from_svg(file)
    for use in ("<text>&name;</text>", '<path d="M0,0h1&name;v1z"/>'):
        file.write_text(before + RECT.format(use))
        with pytest.raises(ValueError, match="undefined entity"):
            bring.outlines_from_svg(file)


@pytest.mark.parametrize(
    "before",
    [
        "<!DOCTYPE svg []>",
        '<!DOCTYPE svg [<!ENTITY name "M0,0">]>',
        SVG11[:-1] + ' [<!ENTITY name "M0,0">]>',
        '<!DOCTYPE svg [<!ENTITY % more SYSTEM "file:///etc/passwd"> %more;]>',
        "<!DOCTYPE html>",
    ],
)
def test_declarations_are_refused(before, tmp_path):
    file = tmp_path / "a.svg"
    file.write_text(before + RECT.format(""))
    with pytest.raises(ValueError, match="expected a plain drawing, got '<!DOCTYPE'"):
        bring.outlines_from_svg(file)


def test_a_long_beginning_costs_no_more_than_its_length(tmp_path):
    file = tmp_path / "a.svg"
    for part in ("<!-- -->", "<?a?>", "<!--", "<?", " ", "<!DOCTYPE svg "):
        file.write_text(part * (10**6 // len(part)) + "x")
        with pytest.raises(ValueError, match="expected"):
            bring.outlines_from_svg(file)


def test_a_mask_is_from_0_to_1():
    """Of 0 and 255 it would come out larger, by nearly half a pixel on each side."""
    pytest.importorskip("contourpy")
    mask = np.zeros((40, 40))
    mask[10:30, 10:30] = 1
    areas = [
        bring.outlines_from_mask(one, tolerance=0.01)[0].area
        for one in (mask, mask > 0, mask.astype(np.uint8), mask.tolist(), mask * np.float32(1 + 1e-6))
    ]
    assert areas == pytest.approx(5 * [areas[0]], rel=1e-4)  # of a millionth more than 1
    for one, message in (
        (255 * mask.astype(np.uint8), "mask must be from 0 to 1, got 0 to 255; divide it by 255"),
        (1000 * mask, "mask must be from 0 to 1, got 0 to 1000$"),
        (mask - 3, "mask must be from 0 to 1, got -3 to -2"),
    ):
        with pytest.raises(ValueError, match=message):
            bring.outlines_from_mask(one)


@pytest.mark.parametrize(
    ("geometry", "areas"),
    [
        (shapely.box(0, 0, 2, 1), [2]),
        (shapely.Polygon([(0, 0, 5), (4, 0, 5), (0, 4, 5)], [[(1, 1, 5), (1, 2, 5), (2, 1, 5)]]), [7.5]),
        (shapely.MultiPolygon([shapely.box(0, 0, 1, 1), shapely.box(3, 0, 5, 1)]), [1, 2]),
        (shapely.GeometryCollection([shapely.Point(0, 0), shapely.box(0, 0, 1, 3)]), [3]),
    ],
)
def test_what_shapely_hands_over(geometry, areas):
    found = geometry.__geo_interface__
    assert [o.area for o in bring.outlines_from_geojson(found)] == areas
    feature = {"type": "Feature", "properties": {}, "geometry": found}
    assert [o.area for o in bring.outlines_from_geojson(feature)] == areas


def test_bad_tuples_are_refused():
    for ring, message in (
        (((0, 0), (1, 0), (0, "1"), (0, 0)), r"expected a point as \[x, y\], got \[0, '1'\]"),
        (((0, 0), (1, 0), (0, 10**400), (0, 0)), "expected finite coordinates"),
        (((0, 0), (1,), (0, 1), (0, 0)), r"expected a point as \[x, y\], got \[1\]"),
    ):
        with pytest.raises(ValueError, match=message):
            bring.outlines_from_geojson({"type": "Polygon", "coordinates": (ring,)})
