"""Files as data: nothing they hold starts a program, waits, or takes more than 512 MB and 2 s; see `fuzz`."""

import io
import itertools
import math
import os
import random
import re
import signal
import socket
import subprocess
import sys
import time
from pathlib import Path

import fuzz
import numpy as np
import pytest
import shapely

import rigidarea as ra
from rigidarea import bring
from rigidarea.geometry.thin import thinned
from rigidarea.io.formats import stripped
from rigidarea.io.svg_path import Segments
from rigidarea.io.svg_values import transform

READERS = [bring.load_scene, bring.outlines_from_svg, bring.outlines_from_geojson, bring.outlines_from_image]


# --- what is no file ---


@pytest.mark.parametrize("read", READERS)
def test_what_is_no_regular_file_is_refused_without_waiting(read, tmp_path):
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "link").symlink_to("pipe")
    (tmp_path / "folder").mkdir()
    with socket.socket(socket.AF_UNIX) as listener:
        listener.bind(str(tmp_path / "socket"))
        start = time.monotonic()
        for name in ("pipe", "link", "folder", "socket", "/dev/zero", "/dev/tty"):
            with pytest.raises(ValueError, match="expected a regular file"):
                read(tmp_path / name)
        assert time.monotonic() - start < 1
    with pytest.raises(ValueError, match="expected the path of a file"):
        read("a\0b")
    with pytest.raises(FileNotFoundError):
        read(tmp_path / "none")


def test_a_pipe_put_in_a_files_place_is_refused_too(tmp_path, monkeypatch):
    """Between the question what a path is and its opening another may be put there."""
    os.mkfifo(tmp_path / "pipe")
    regular = os.stat(__file__)
    monkeypatch.setattr(Path, "stat", lambda path: regular)
    with pytest.raises(ValueError, match="expected a regular file"):
        bring.load_scene(tmp_path / "pipe")


# --- formats ---


def test_a_picture_that_is_postscript_starts_no_program(tmp_path, monkeypatch):
    marker, program = tmp_path / "marker", tmp_path / "gs"
    program.write_text(f"#!/bin/sh\ntouch {marker}\n")
    program.chmod(0o755)
    monkeypatch.setenv("PATH", f"{tmp_path}:{os.environ['PATH']}")
    picture = tmp_path / "a.png"
    picture.write_bytes(b"%!PS-Adobe-3.0 EPSF-3.0\n%%BoundingBox: 0 0 9 9\n%%EndComments\nshowpage\n")
    with pytest.raises(ValueError, match="expected one of PNG, JPEG, BMP, GIF, WEBP, got a file that begins"):
        bring.outlines_from_image(picture)
    assert not marker.exists()


def test_formats_beyond_the_list_are_refused(tmp_path):
    image = pytest.importorskip("PIL.Image")
    for kind in ("TIFF", "PPM", "TGA", "PCX", "ICO", "PDF"):
        image.new("L", (20, 20)).save(tmp_path / "a.png", kind)
        with pytest.raises(ValueError, match="expected one of PNG"):
            bring.outlines_from_image(tmp_path / "a.png")


def test_stripping_keeps_the_pixels():
    image = pytest.importorskip("PIL.Image")
    count = 0
    for kind, several in fuzz.pictures().items():
        for data in several:
            name, width, height, less = stripped(data)
            assert name.lower() == kind
            before, after = image.open(io.BytesIO(data)), image.open(io.BytesIO(less))
            assert before.size == after.size == (width, height)
            assert np.array_equal(before.convert("RGBA"), after.convert("RGBA"))
            count += 1
    assert count >= 12


def test_every_format_gives_the_same_disc(tmp_path):
    pytest.importorskip("PIL.Image")
    for kind, several in fuzz.pictures().items():
        for i, data in enumerate(several):
            (tmp_path / "a").write_bytes(data)
            outline = bring.outlines_from_image(tmp_path / "a")[0]
            # half a pixel is thinned away along a circumference of 2 pi 15.5; a hole instead where all is solid
            area = math.pi * 15**2
            assert min(abs(outline.area - area), abs(48 * 40 - outline.area - area)) < 50, (kind, i, outline)


def png(width: int, height: int) -> bytes:
    image = pytest.importorskip("PIL.Image")
    file = io.BytesIO()
    image.new("L", (9, 9)).save(file, "PNG")
    data = bytearray(file.getvalue())
    data[16:24] = width.to_bytes(4, "big") + height.to_bytes(4, "big")
    return bytes(data)


@pytest.mark.parametrize("size", [(2**31 - 1, 2**31 - 1), (10**5, 10**5), (4000, 3000), (0, 5)])
def test_pixels_are_counted_before_decoding(size, tmp_path):
    (tmp_path / "a.png").write_bytes(png(*size))
    with pytest.raises(ValueError, match=r"at most 8388608 pixels|at least 1 pixel"):
        bring.outlines_from_image(tmp_path / "a.png")


# --- time and memory: what was seen, and its relatives ---


def star(n: int) -> str:
    """All edges through the middle: their boxes overlap pairwise."""
    return ",".join(
        f"[{math.cos(i):.9g},{math.sin(i):.9g}]" for i in np.arange(n) * math.pi * (1 - 2 / (2 * n + 1))
    )


def scene(points: str) -> str:
    return '{"rigidarea":1,"bodies":[{"shapes":[{"outline":{"points":[' + points + ']},"density":1}]}]}'


SVG = '<svg xmlns="http://www.w3.org/2000/svg">{}</svg>'
LARGE = {
    "dotted.toml": "rigidarea = 1\n" + ".".join("a" * 30_000) + " = 1",
    "header.toml": "[" + ".".join("a" * 30_000) + "]",
    "arrays.toml": "a = " + "[" * 30_000,
    "hexadecimal.toml": "rigidarea = 0x" + "f" * 900_000,
    "quotes.toml": '"""\\' * 200_000,
    "comments.svg": SVG.format("<style>" + "/*" * 10**6 + "</style>"),
    "rotate.svg": SVG.format('<rect transform="' + "rotate(" * 250_000 + '" width="1" height="1"/>'),
    "stairs.svg": SVG.format('<path d="M0,0' + "h1v1" * 500_000 + 'z"/>'),
    "digits.svg": SVG.format('<path d="M' + "1" * 2_000_000 + '"/>'),
    "elements.svg": SVG.format('<rect width="1" height="1"/>' * 60_000),
    "star.svg": SVG.format('<polygon points="' + star(60_000).strip("[]").replace("],[", " ") + '"/>'),
    "star.json": scene(star(100_000)),
    "arcs.json": scene(star(20_000).replace("]", ",1e-5]")),
    "lists.json": "[" + "[]," * 5_000_000 + "1]",
    "objects.json": "[" + "{}," * 5_000_000 + "1]",
    "wrong.json": scene("[0,0]," * 900_000 + '[0,"x"]'),
    "deep.geojson": '{"type":"GeometryCollection","geometries":[' * 50_000,
}


#: Seconds each, most of them for writing and reading what is large.
SLOW = ("wrong.json", "star.json", "star.svg", "objects.json", "stairs.svg")


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=pytest.mark.slow) if name in SLOW else name for name in LARGE]
)
def test_large_files_are_refused_in_time(name, tmp_path):
    fuzz.preload({"svg": [fuzz.SVG.encode()]}, tmp_path)
    file = tmp_path / name
    file.write_text(LARGE[name])
    assert fuzz.outcome(file.suffix[1:], str(file)) in ("refused", "read")


@pytest.mark.parametrize("kind", ["svg", "toml", "json", "geojson", "png", "jpeg", "bmp", "gif", "webp"])
@pytest.mark.parametrize("count", [12, pytest.param(400, marks=pytest.mark.slow)])
def test_mutants_are_read_or_refused(kind, count, tmp_path):
    pytest.importorskip("PIL.Image")
    known = fuzz.seeds()
    fuzz.preload(known, tmp_path)
    told, bad = fuzz.run(kind, count, 5, known, tmp_path)
    assert not bad and sum(told.values()) == count and set(told) <= {"read", "refused"}


def test_the_fuzzer_sees_what_it_looks_for(tmp_path, monkeypatch):
    """Each fault planted once."""
    file = tmp_path / "a.json"
    file.write_text("{}")
    monkeypatch.setattr(fuzz, "SECONDS", 1)
    faults = {
        "another error": lambda: {}["a"],
        "started something": lambda: subprocess.run(["true"]),
        "not finite": lambda: False,
        "ended by SIGKILL": lambda: sum(1 for _ in iter(int, 1)),
        "ended by SIGTERM": lambda: os.kill(os.getpid(), signal.SIGTERM),
    }
    for wanted, fault in faults.items():
        monkeypatch.setattr(fuzz, "use", lambda kind, path, fault=fault: fault())
        assert fuzz.outcome("json", str(file)).startswith(wanted)
    monkeypatch.setattr(fuzz, "use", lambda kind, path: bool(bytearray(1 << 30)))
    assert fuzz.outcome("json", str(file)) == "another error"  # MemoryError


# --- no n² in points ---


@pytest.mark.slow
@pytest.mark.parametrize("shape", ["circle", "wave"])
def test_a_million_points_on_a_body(shape):
    """At most 500 MB and 5 s of processor time, beside what loading the code takes."""
    program = """
import resource, sys, time
import numpy as np, pymunk, rigidarea as ra

def make(n):
    t = np.linspace(0, 2 * np.pi, n, endpoint=False)
    r = 1 + 0.1 * np.cos(50 * t) if sys.argv[1] == "wave" else 1.0 + 0 * t
    outline = ra.Outline(np.column_stack((r * np.cos(t), r * np.sin(t))))
    space = pymunk.Space()
    space.gravity = (0, -10)
    body = outline.body(density=1.0)
    space.add(body, outline.add_to(body))
    ra.attach(space)
    space.step(1 / 60)
    return body.position.y

make(500)
start = time.process_time()
y = make(1_000_000)
print(time.process_time() - start, resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024, y)
"""
    done = subprocess.run([sys.executable, "-c", program, shape], capture_output=True, text=True, check=True)
    seconds, megabytes, y = map(float, done.stdout.split())
    assert seconds < 5 and megabytes < 500 and y < 0


def test_the_width_of_a_hull_by_all_pairs():
    chance = np.random.default_rng(3)
    for i in range(300):
        n = int(chance.integers(3, 60))
        angle = np.sort(chance.random(n)) * 2 * math.pi
        points = [
            chance.normal(size=(n, 2)),
            np.column_stack((np.cos(angle), 10.0 ** -(i % 7) * np.sin(angle))),
        ][i % 2]
        hull = shapely.get_coordinates(shapely.convex_hull(shapely.MultiPoint(points)))
        along = np.diff(hull, axis=0)
        normal = np.column_stack((along[:, 1], -along[:, 0])) / np.hypot(*along.T)[:, None]
        wanted = np.ptp(hull @ normal.T, axis=0).min()
        assert ra.Outline(hull).smallest_extent == pytest.approx(wanted, rel=1e-9)


def test_the_proxy_of_a_circle_of_points_is_the_circle():
    angle = np.arange(100_000) * (2 * math.pi / 100_000)
    outline = ra.Outline(np.column_stack((3 + 2 * np.cos(angle), 2 * np.sin(angle))))
    shape = outline.add_to(ra.Outline.circle(1).body(mass=1))
    assert shape.radius == pytest.approx(2, rel=1e-9) and tuple(shape.offset) == pytest.approx(
        (3, 0), abs=1e-8
    )
    assert outline.smallest_extent == pytest.approx(4, rel=1e-8)


@pytest.mark.parametrize("tolerance", [0.003, 0.05, 0.3])
def test_what_is_thinned_away_is_near_a_chord(tolerance):
    chance = np.random.default_rng(4)
    angle = np.arange(2000) * (2 * math.pi / 2000)
    for ring in (
        np.column_stack((np.cos(angle), np.sin(angle))),
        np.column_stack((np.cos(angle), np.sin(angle))) * (1 + 0.1 * chance.random((2000, 1))),
        chance.normal(size=(500, 2)).cumsum(axis=0),
    ):
        keep = thinned(ring, tolerance)
        at = np.append(np.flatnonzero(keep), len(ring))
        assert keep[0] and len(at) < len(ring)
        for a, b in itertools.pairwise(at):
            chord = shapely.LineString([ring[a], ring[b % len(ring)]])
            assert (shapely.distance(shapely.points(ring[a:b]), chord) <= tolerance * (1 + 1e-9)).all()


def test_a_saw_is_thinned_in_linear_time():
    """Its teeth get lower from one to the next: splitting at the farthest point takes n^2 (30 s for this one)."""
    n = 60_000
    x = np.arange(n, dtype=float)
    points = np.column_stack((x, np.where(x % 2, n - x, 0.0)))
    ring = [*points.tolist(), [n, -9.0], [-1, -9.0], points[0].tolist()]
    bring.outlines_from_geojson(
        {"type": "Polygon", "coordinates": [[[0, 0], [1, 0], [0, 1], [0, 0]]]}, tolerance=0.1
    )  # compile
    start = time.process_time()
    (outline,) = bring.outlines_from_geojson({"type": "Polygon", "coordinates": [ring]}, tolerance=0.1)
    assert time.process_time() - start < 5 and len(outline.rings[0]) >= n


# --- SVG's own reader ---


@pytest.mark.parametrize(
    ("body", "area"),
    [
        ('<g transform="skewX(40) scale(2,3)"><ellipse rx="3" ry="1"/></g>', math.pi * 3 * 6),
        ('<rect width="4" height="3" rx="1"/>', 12 - (4 - math.pi)),
        ('<rect width="1in" height="2.54cm"/>', 96**2),
        ('<rect width="50%" height="10%"/>', 100 * 10),
        ('<path d="M0 0h4v3l-4,0z"/>', 12),
        ('<path d="m1-1.5.5.5-.5.5z"/>', 0.25),  # numbers part themselves
        ('<path d="M0,0a2,2,0,114,0a2,2,0,11-4,0"/>', 4 * math.pi),  # flags without gaps
        ('<path d="M0,0 T2,2 4,0z"/>', 4 + 8 / 3),  # the first is a line, the second mirrors its control point
        ('<path d=" "/><path d="none"/><path d="M0,0h2v2h-2,"/>', 4),
        ('<svg x="3" width="8" height="4" viewBox="0 0 1 1"><rect width="1" height="1"/></svg>', 16),
        ('<svg width="8" height="4" viewBox="0 0 1 1" preserveAspectRatio="none"><rect width="1" height="1"/></svg>',
         32),
        ('<style>/* */ .a,#b{display:none} rect{transform:scale(2)}</style><rect class="a" width="1" height="1"/>'
         '<rect id="b" width="1" height="1"/><rect width="1" height="1"/>', 4),
        ('<defs><rect width="9" height="9"/></defs><clipPath><rect width="9" height="9"/></clipPath>'
         '<circle r="1"/>', math.pi),
        ('<rect width="2" height="2" style="transform:rotate(.25turn) translate(1px,1in)"/>', 4),
    ],
)  # fmt: skip
def test_drawings_have_the_areas_that_svg_gives_them(body, area, tmp_path):
    file = tmp_path / "a.svg"
    file.write_text(f'<svg xmlns="http://www.w3.org/2000/svg" width="200" height="100">{body}</svg>')
    (outline,) = bring.outlines_from_svg(file, tolerance=1e-5)
    assert outline.area == pytest.approx(area, abs=1e-4 * max(1, area) ** 0.5)


@pytest.mark.parametrize(
    ("data", "message"),
    [
        ("hello", "expected M or m to begin with, got 'hello'"),
        ("M0 0 h10 v10 h-10 z M20 0 h10 v10 foo", "expected one of mlhvcsqtaz, got 'f'"),
        ("M0 0 h10 v10 L x", "expected 2 numbers at a time after L, got ''"),
        ("M0 0 L 10 0 10 10 0", "expected 2 numbers at a time after L, got '10 0 10 10 0'"),
        ("M0,0h2v2h-2 L3 #", "expected 2 numbers at a time after L, got '3 #'"),
        ("M0,0h2v2h-2 z 3", "expected no numbers after z, got '3'"),
        ("M0,0 a2,2,0,2,1,4,0", "expected 7 numbers at a time after a, got '2,2,0,2,1,4,0'"),
        ("M", "expected 2 numbers at a time after M, got ''"),
    ],
)
def test_an_error_in_path_data_is_told_with_its_place(data, message, tmp_path):
    """Nothing is left out of a solid without a word."""
    file = tmp_path / "a.svg"
    file.write_text(f'<svg xmlns="http://www.w3.org/2000/svg">\n<path id="p" d="{data}"/></svg>')
    with pytest.raises(ValueError, match=re.escape(f"{file}: line 2, <path id='p'>: path.d: {message}")):
        bring.outlines_from_svg(file)


def test_random_paths_as_svgelements_reads_them(tmp_path):
    """Its own reader is the oracle: rings, their boxes and areas, under similar transforms (it bends skewed arcs)."""
    svgelements = pytest.importorskip("svgelements")

    def wide(ring: shapely.LinearRing) -> bool:  # the others are no rings to either
        return ring.convex_hull.area > 1e-6 * ring.length**2

    compared = 0
    for seed in range(80):
        chance = random.Random(seed)

        def number(chance=chance) -> str:
            return f"{chance.uniform(-9, 9):.{chance.randrange(4)}f}"

        words, last = ["M", number(), number()], "m"
        for _ in range(chance.randrange(1, 9)):
            letter = chance.choice("LlHhVvCcSsQqTtAaZzMm")
            kind = letter.lower()
            if (kind == "s" and last not in "cs") or (kind == "t" and last not in "qt"):
                continue
            words.append(letter)
            last = kind
            for _ in range(0 if kind == "z" else chance.randrange(1, 3)):
                given = [number() for _ in range({"h": 1, "v": 1, "c": 6, "s": 4, "q": 4}.get(kind, 2))]
                if kind == "a":
                    half = [f"{chance.uniform(0.5, 9):.2f}" for _ in "xy"]
                    given = [*half, number(), *chance.choices("01", k=2), *given]
                words += given
        data = chance.choice([" ", ","]).join(words)
        turn = f"rotate({number()}) scale({chance.uniform(0.5, 2):.3f}) translate({number()} {number()})"
        segments = Segments(bring.LIMITS)
        segments.path(data)
        segments.element(transform(turn))
        ours = [shapely.LinearRing(ring) for ring in segments.rings(1.0, False, 1e-4)[0]]
        ours = list(filter(wide, ours))
        theirs, points = [], []
        for segment in [*abs(svgelements.Path(data, transform=turn)), None]:
            name = type(segment).__name__
            if name in ("Move", "NoneType", "Close"):
                theirs += [points] if len(points) > 2 else []
                points = points[:1] if name == "Close" else [] if segment is None else [tuple(segment.end)]
            else:
                ends = range(1, 101) if name != "Line" else [100]
                points += [tuple(map(float, segment.point(i / 100))) for i in ends]
        others = list(filter(wide, map(shapely.LinearRing, theirs)))
        assert len(ours) == len(others), data
        for one, other in zip(ours, others):
            compared += 1
            assert shapely.hausdorff_distance(one, other) < 0.02 + 1e-3 * other.length / 2, (data, turn)
    assert compared > 60
