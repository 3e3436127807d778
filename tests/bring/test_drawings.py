"""Outlines from SVG, GeoJSON and pictures: exact where exactness is known, refused where it must be."""

import json
import math
import random
import time

import numpy as np
import pymunk
import pytest

from rigidarea import bring
from rigidarea.bring import Limits

LIMITED = Limits(bytes=20_000, depth=8, points=500, parts=50, pixels=10_000)


def svg(tmp_path, body, head='xmlns="http://www.w3.org/2000/svg" width="100" height="100"'):
    file = tmp_path / "drawing.svg"
    file.write_text(f"<svg {head}>{body}</svg>")
    return file


# --- SVG ---


def test_shapes_and_curves_have_their_areas(tmp_path):
    body = (
        '<rect x="1" y="2" width="30" height="20"/>'
        '<circle cx="50" cy="50" r="10"/>'
        '<path d="M0,0 C 0,30 40,30 40,0 Z"/>'
        '<g transform="scale(2)"><polygon points="0,0 4,0 0,3"/></g>'
    )
    rect, disc, bump, triangle = bring.outlines_from_svg(svg(tmp_path, body), tolerance=1e-3)
    assert rect.area == pytest.approx(600) and rect.bounds == pytest.approx((1, 2, 31, 22))
    # a sagitta of at most 1e-3 along a circumference of 63
    assert disc.area == pytest.approx(100 * math.pi, abs=63e-3)
    assert disc.centroid == pytest.approx((50, 50), abs=1e-3)
    t = np.linspace(0, 1, 200_001)
    x = 3 * 40 * (1 - t) * t**2 + 40 * t**3
    y = 3 * 30 * (1 - t) ** 2 * t + 3 * 30 * (1 - t) * t**2
    assert bump.area == pytest.approx(abs(np.trapezoid(y, x)), abs=1e-3 * 90)
    assert triangle.area == pytest.approx(24)


def test_letters_keep_their_holes_and_islands(tmp_path):
    rings = [f"M{i},{i} H{100 - i} V{100 - i} H{i} Z" for i in (0, 10, 20, 30)]
    outer, island = bring.outlines_from_svg(
        svg(tmp_path, f'<path d="{" ".join(rings)}"/>'), scale=0.1, flip=True
    )
    assert len(outer.rings) == len(island.rings) == 2
    assert outer.area == pytest.approx(100 - 64) and island.area == pytest.approx(36 - 16)
    assert outer.bounds == pytest.approx((0, -10, 10, 0))


def test_finer_tolerance_is_closer(tmp_path):
    file = svg(tmp_path, '<ellipse cx="0" cy="0" rx="20" ry="5"/>')
    errors = [
        abs(bring.outlines_from_svg(file, tolerance=tolerance)[0].area - 100 * math.pi)
        for tolerance in (0.5, 0.05, 0.005)
    ]
    assert errors[0] > errors[1] > errors[2] and errors[2] < 0.005 * 90


@pytest.mark.parametrize(
    ("body", "message"),
    [
        ('<path d="M0,0 L10,10 L10,0 L0,10 Z"/>', "does not cross itself"),
        ('<path d="M0,0 H20 V20 H0 Z M10,10 H30 V30 H10 Z"/>', "cross"),
        ('<use href="#a"/>', "line 1, <use>: expected href to name an element"),
        ('<g id="a"><use href="#a"/></g>', "elements"),
        (
            '<g id="a"><rect width="1" height="1"/></g><g id="b">'
            + 9 * '<use href="#a"/>'
            + "</g>"
            + 9 * '<use href="#b"/>',
            "at most 50 elements",
        ),
        ('\n<rect/>\n<path id="spawn" d="M0,0 L10,10 L10,0 L0,10 Z"/>', "line 3, <path id='spawn'>: ring 0"),
        (
            '<polyline fill="none" stroke="red" points="'
            + " ".join(f"{math.cos(i * 3.138):.5f},{math.sin(i * 3.138):.5f}" for i in range(400))
            + '"/>',
            "pairs of edges of a stroke",
        ),
        ('<g fill="none" stroke="red"><path d="M0,0' + "h1v1" * 600 + '"/></g>', "at most"),
        ("<script>alert(1)</script>", "expected a plain drawing"),
        ("<rect width='1' height='1'>", "expected an SVG drawing"),
        ("<g>" * 20 + "</g>" * 20, "within each other, got"),
        ("<g/>" * 60, "at most 50 elements"),
        (f'<path d="M0,0 {"L1,1 L0,2 " * 400}"/>', "at most 500 points"),
        ('<circle r="1e300"/>', "finite"),
        (
            '<path d="' + "".join(f"M{i},{i} H{99 - i} V{99 - i} H{i} Z" for i in range(20)) + '"/>',
            "pairs of rings",
        ),
        (f"<!-- {'x' * 30_000} -->", "at most 20000 bytes"),
    ],
)
def test_hostile_drawings_are_refused(body, message, tmp_path):
    with pytest.raises(ValueError, match=message):
        bring.outlines_from_svg(svg(tmp_path, body), limits=LIMITED)


def test_damaged_drawings_end_in_outlines_or_a_value_error(tmp_path):
    body = (
        '<g transform="rotate(30) scale(2,3) skewX(10)"><path d="M0,0 C 3,-2 7,-2 10,0 S 13 7 10 10 Q 7,12 5,10 T 0,10'
        ' A 6 7 0 0 1 0 0 z m 3 3 l 2 0 0 2z"/><rect x="1" y="2" width="3" height="4" rx="1"/>'
        '<ellipse cx="3" cy="3" rx="2" ry="1"/><polyline points="0,0 1,1 2,0"/><line x1="0" x2="3"/></g>'
    )
    chance = random.Random(2)
    file = svg(tmp_path, body)
    assert len(bring.outlines_from_svg(file)) == 4
    whole = file.read_text()
    tokens = [
        "1e999",
        "-1",
        "NaN",
        "<",
        ">",
        "z",
        "M",
        "A",
        "1e308",
        "%",
        "url(#a)",
        " ",
        "1e-320",
        "</svg>",
        "C",
    ]
    made = refused = 0
    for _ in range(600):
        at = chance.randrange(len(whole))
        file.write_text(whole[:at] + chance.choice(tokens) + whole[at + chance.randrange(6) :])
        try:
            outlines = bring.outlines_from_svg(file)
        except ValueError:
            refused += 1
            continue
        made += 1
        assert all(math.isfinite(o.area) and o.area > 0 for o in outlines)
    assert made > 50 and refused > 100  # half of the text is path data, where most of it is an error


def test_entities_are_refused_before_they_unfold(tmp_path):
    laughs = "".join(f'<!ENTITY a{i + 1} "{f"&a{i};" * 10}">' for i in range(9))
    file = tmp_path / "laughs.svg"
    file.write_text(f'<!DOCTYPE svg [<!ENTITY a0 "ha">{laughs}]><svg><text>&a9;</text></svg>')
    start = time.perf_counter()
    with pytest.raises(ValueError, match="expected a plain drawing, got '<!DOCTYPE'"):
        bring.outlines_from_svg(file)
    assert time.perf_counter() - start < 5


def test_files_that_are_none_are_refused(tmp_path):
    with pytest.raises(ValueError, match="expected a regular file"):
        bring.load_scene("/dev/zero")
    with pytest.raises(FileNotFoundError):
        bring.load_scene(tmp_path / "none.json")
    (tmp_path / "binary.json").write_bytes(b"\xff\xfe\x00")
    with pytest.raises(ValueError, match="expected UTF-8 text, got byte 0xff at 0"):
        bring.load_scene(tmp_path / "binary.json")


# --- GeoJSON ---

SQUARE = [[0, 0], [4, 0], [4, 4], [0, 4], [0, 0]]
HOLE = [[1, 1], [1, 2], [2, 2], [2, 1], [1, 1]]


def test_polygons_wherever_they_are(tmp_path):
    found = {
        "type": "FeatureCollection",
        "features": [
            {
                "type": "Feature",
                "properties": {},
                "geometry": {"type": "Polygon", "coordinates": [SQUARE, HOLE]},
            },
            {"type": "Feature", "geometry": None},
            {
                "type": "Feature",
                "geometry": {
                    "type": "GeometryCollection",
                    "geometries": [
                        {"type": "Point", "coordinates": [0, 0]},
                        {
                            "type": "MultiPolygon",
                            "coordinates": [[SQUARE], [[[x + 9, y, 7] for x, y in SQUARE]]],
                        },
                    ],
                },
            },
        ],
    }
    file = tmp_path / "map.geojson"
    file.write_text(json.dumps(found))
    made = bring.outlines_from_geojson(file, scale=2.0)
    assert [o.area for o in made] == [60, 64, 64] and made[2].bounds == (18, 0, 26, 8)
    assert [o.area for o in bring.outlines_from_geojson(found)] == [15, 16, 16]


def test_points_on_a_line_are_thinned_within_tolerance():
    t = np.linspace(0, 2 * np.pi, 2001)[:-1]
    ring = np.column_stack((np.cos(t), np.sin(t))).tolist()
    (outline,) = bring.outlines_from_geojson(
        {"type": "Polygon", "coordinates": [[*ring, ring[0]]]}, tolerance=1e-3
    )
    assert 20 < len(outline.rings[0]) < 200
    assert outline.area == pytest.approx(math.pi, abs=2 * math.pi * 1e-3)


@pytest.mark.parametrize(
    ("found", "message"),
    [
        ([1], "expected a GeoJSON object with a type"),
        ({"type": "Circle"}, "expected a type of GeoJSON, got 'Circle'"),
        ({"type": "Polygon"}, "coordinates as a list, got None"),
        ({"type": "Polygon", "coordinates": []}, "at least one ring"),
        ({"type": "Polygon", "coordinates": [SQUARE[:3]]}, "at least 4 points"),
        ({"type": "Polygon", "coordinates": [[[0, "1"]] * 4]}, "point as \\[x, y\\]"),
        ({"type": "Polygon", "coordinates": [[[0, True]] * 4]}, "point as \\[x, y\\]"),
        ({"type": "Polygon", "coordinates": [[[0, 10**400]] * 4]}, "finite coordinates"),
        ({"type": "Polygon", "coordinates": [[[0, 0], [1, 1], [1, 0], [0, 1], [0, 0]]]}, "Self-intersection"),
        ({"type": "Polygon", "coordinates": [[[0, 0]] * 501]}, "at most 500 points"),
    ],
)
def test_bad_geojson_is_refused(found, message, tmp_path):
    file = tmp_path / "map.json"
    file.write_text(json.dumps(found))
    with pytest.raises(ValueError, match=message):
        bring.outlines_from_geojson(file, limits=LIMITED)


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ("[" * 15_000, "within each other"),
        ('{"type": "Polygon", "coordinates": [[[NaN, 0]]]}', "expected finite numbers, got NaN"),
        ("{", "expected JSON"),
        ("1" * 15_000, "expected"),
        ('{"type":"GeometryCollection","geometries":[' * 40 + "]}" * 40, "at most 8 collections"),
    ],
)
def test_hostile_json_is_refused(content, message, tmp_path):
    file = tmp_path / "map.json"
    file.write_text(content)
    with pytest.raises(ValueError, match=message):
        bring.outlines_from_geojson(file, limits=LIMITED)


# --- pictures ---


def disc(size: int, radius: float) -> np.ndarray:
    at = np.arange(size) + 0.5 - size / 2
    return np.clip(radius + 0.5 - np.hypot(at[:, None], at[None, :]), 0, 1)  # soft edge, one pixel wide


def test_a_soft_disc_is_found_finer_than_a_pixel():
    pytest.importorskip("contourpy")
    (outline,) = bring.outlines_from_mask(disc(100, 30), tolerance=0.02)
    # the contour at one half of a one-pixel ramp lies on the circle; bilinear cells are off by about 1/(8 r)
    assert outline.area == pytest.approx(900 * math.pi, rel=2e-3)
    assert outline.centroid == pytest.approx((50, 50), abs=0.02)
    (flipped,) = bring.outlines_from_mask(disc(100, 30), scale=0.1, flip=True)
    assert flipped.centroid == pytest.approx((5, -5), abs=0.01)


def test_holes_edges_and_corners():
    pytest.importorskip("contourpy")
    mask = np.zeros((12, 20))
    mask[0:10, 0:10] = 1  # touches the picture's edge
    mask[3:6, 3:6] = 0
    mask[10:12, 10:14] = 1  # meets the first in a corner
    mask[2, 18] = 1  # a speck
    made = bring.outlines_from_mask(mask, tolerance=1e-6)
    assert [len(o.rings) for o in made][:2] == [2, 1] and len(made) <= 3
    # contours between pixel centres cut each outer corner by a triangle of 1/8 and fill each of the hole's
    assert made[0].area == pytest.approx(100 - 9, abs=1.1) and made[1].area == pytest.approx(8, abs=1.1)


def test_a_picture_file_by_its_alpha(tmp_path):
    pytest.importorskip("contourpy")
    image = pytest.importorskip("PIL.Image")
    pixels = np.zeros((60, 60, 4), np.uint8)
    pixels[..., 3] = np.round(255 * disc(60, 20))
    image.fromarray(pixels).save(tmp_path / "disc.png")
    (outline,) = bring.outlines_from_image(tmp_path / "disc.png")
    assert outline.area == pytest.approx(400 * math.pi, rel=0.03)  # thinned to half a pixel
    image.fromarray(pixels[..., 3]).save(tmp_path / "dark.png")
    made = bring.outlines_from_image(tmp_path / "dark.png")
    assert made[0].area == pytest.approx(3600 - 400 * math.pi, rel=0.03) and len(made[0].rings) == 2


def test_bad_pictures_are_refused(tmp_path):
    pytest.importorskip("contourpy")
    image = pytest.importorskip("PIL.Image")
    (tmp_path / "text.png").write_text("no picture")
    with pytest.raises(ValueError, match="expected a picture"):
        bring.outlines_from_image(tmp_path / "text.png")
    image.new("L", (200, 200)).save(tmp_path / "large.png")
    with pytest.raises(ValueError, match="at most 10000 pixels, got 40000"):
        bring.outlines_from_image(tmp_path / "large.png", limits=LIMITED)
    data = (tmp_path / "large.png").read_bytes()
    (tmp_path / "cut.png").write_bytes(data[: len(data) // 2])
    with pytest.raises(ValueError, match="expected a picture"):
        bring.outlines_from_image(tmp_path / "cut.png")
    for mask, message in (
        (np.zeros(3), "shape"),
        (np.full((2, 2), np.nan), "finite"),
        (np.zeros((0, 2)), "shape"),
    ):
        with pytest.raises(ValueError, match=message):
            bring.outlines_from_mask(mask)
    with pytest.raises(ValueError, match=r"between 0 and 1, got 1\.5"):
        bring.outlines_from_mask(np.ones((3, 3)), threshold=1.5)
    assert bring.outlines_from_mask(np.zeros((3, 3))) == []


def test_a_checkerboard_is_bounded():
    """The worst picture: every pixel its own solid, meeting the next in a corner."""
    pytest.importorskip("contourpy")
    board = np.indices((300, 300)).sum(axis=0) % 2
    with pytest.raises(ValueError, match=r"at most (50 solids|500 points)"):
        bring.outlines_from_mask(board, limits=LIMITED._replace(pixels=100_000))


# --- names, strokes, what is used again ---

LABELLED = """
<g id="layer1" inkscape:label="ground" transform="translate(10,0)"><rect id="floor" width="30" height="4"/>
  <g id="inner"><circle inkscape:label="lamp" cx="5" cy="20" r="2"/></g></g>
<rect id="spawn" x="50" y="60" width="2" height="2"/>
"""
INKSCAPE = (
    'xmlns="http://www.w3.org/2000/svg" width="100" height="100" '
    'xmlns:inkscape="http://www.inkscape.org/namespaces/inkscape" xmlns:xlink="http://www.w3.org/1999/xlink"'
)


def test_names_and_layers_are_carried(tmp_path):
    floor, lamp, spawn = bring.elements_from_svg(svg(tmp_path, LABELLED, INKSCAPE))
    assert (floor.id, floor.name, floor.layers) == ("floor", "floor", ("ground",))
    assert (lamp.id, lamp.name, lamp.layers) == ("", "lamp", ("ground", "inner"))
    assert (spawn.name, spawn.layers) == ("spawn", ()) and spawn.outline.centroid == pytest.approx((51, 61))
    shape = spawn.add_to(pymunk.Body(1, 1), friction=0.5)
    assert shape.name == "spawn" and shape.layers == () and shape.friction == 0.5


@pytest.mark.parametrize(
    ("body", "area"),
    [
        ('<line x1="0" y1="0" x2="30" y2="40" stroke="red" stroke-width="2"/>', 100),
        ('<path d="M0,0 H50" fill="none" stroke="red" stroke-width="2" stroke-linecap="square"/>', 104),
        (
            '<path d="M0,0 H50" fill="none" stroke="red" stroke-width="2" stroke-linecap="round"/>',
            100 + math.pi,
        ),
        ('<path d="M0,0 H50" style="fill:none;stroke:red;stroke-width:2"/>', 100),
        ('<g fill="none" stroke="red" stroke-width="2"><path d="M0,0 H20 V20"/></g>', 80),
        ('<g fill="none" stroke="red" transform="scale(2)"><path d="M0,0 H20"/></g>', 80),
        ('<rect width="20" height="10" fill="none" stroke="red" stroke-width="2"/>', 22 * 12 - 18 * 8),
        ('<path d="M0,0 H20 V10 H0 Z" fill="none" stroke="red" stroke-width="2"/>', 22 * 12 - 18 * 8),
        ('<circle r="10" fill="none" stroke="red" stroke-width="2"/>', math.pi * (11**2 - 9**2)),
        ('<path d="M0,0 H20 V10 H0 Z" stroke="red" stroke-width="2"/>', 200),
        ('<line x1="0" y1="0" x2="30" y2="40"/>', 0),
    ],
)
def test_strokes_are_as_wide_as_they_are_drawn(body, area, tmp_path):
    found = bring.outlines_from_svg(svg(tmp_path, body), tolerance=1e-4)
    assert sum(outline.area for outline in found) == pytest.approx(area, abs=2e-2)


@pytest.mark.parametrize("href", ["href", "xlink:href"])
def test_use_draws_what_it_names(href, tmp_path):
    body = (
        '<defs><g id="pair"><rect width="2" height="3"/><circle cx="10" r="1"/></g></defs>'
        f'<use id="left" {href}="#pair" x="5" y="6"/><use id="right" {href}="#pair" transform="scale(2)"/>'
        '<symbol id="s" viewBox="0 0 1 1"><rect width="1" height="1"/></symbol>'
        f'<use {href}="#s" x="50" y="50" width="8" height="8"/>'
    )
    found = bring.elements_from_svg(svg(tmp_path, body, INKSCAPE), tolerance=1e-4)
    areas = [element.outline.area for element in found]
    assert areas == pytest.approx([6, math.pi, 24, 4 * math.pi, 64], abs=1e-2)
    assert found[0].outline.bounds == pytest.approx((5, 6, 7, 9))
    assert found[4].outline.bounds == pytest.approx((50, 50, 58, 58))
    assert [element.layers for element in found] == [("left",)] * 2 + [("right",)] * 2 + [()]
