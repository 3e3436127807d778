"""Mutated files of every kind that `rigidarea.bring` reads, each in a process of its own.

    python tests/bring/fuzz.py --count 10000 [--seed 0] [--kinds svg toml ...] [--keep DIR]

A process may take 512 MB more than what is loaded before it begins, and 2 s of processor time; it ends in what was read
or in a ValueError in words ("expected", "must"), and starts no other program, connects nowhere and writes no file
(Python's audit events). Same seed, same files. A file that did otherwise is kept, and named at the end (exit code 1).
"""

from __future__ import annotations

import argparse
import faulthandler
import io
import json
import math
import os
import random
import re
import resource
import signal
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Callable
from pathlib import Path

import numpy as np

from rigidarea import bring

MEMORY, SECONDS = 512 << 20, 2
#: Seconds after which a process that takes no processor time is one that waits: long, for busy machines.
WALL = 300
READ, REFUSED, RAW, PROGRAM, BAD = 0, 3, 4, 5, 6
WHAT = {RAW: "another error", PROGRAM: "started something", BAD: "not finite"}

SVG = """<svg xmlns="http://www.w3.org/2000/svg" width="10cm" height="80" viewBox="0 0 100 80">
<style>/* a */ .b { display: inline; transform: rotate(3deg) } #c, rect { rx: 1 }</style>
<g transform="rotate(30 5 5) scale(2,3) skewX(10) matrix(1 0 0 1 2 3)"><path class="b" d="M0,0 C 3,-2 7,-2 10,0 S 13 7
10 10 Q 7,12 5,10 T 0,10 A 6 7 0 0 1 0 0 z m 3 3 l 2 0 0 2z"/><rect id="c" x="1" y="2" width="3mm" height="4" rx="1"/>
</g><ellipse cx="3" cy="30%" rx="2" ry="1" style="display:block;fill:#123"/><polygon points="0,0 1,1 2,0"/>
<svg x="5" viewBox="0 0 2 2" width="4" preserveAspectRatio="xMinYMax slice"><circle r=".5"/></svg><!-- end --><g id="d"
fill="none" stroke="red" stroke-width="2" stroke-linecap="round"><path d="M0,0 C 3,-2 7,-2 10,0 H4"/>
<line x2="5%"/></g><use href="#d" x="9"/></svg>"""
TOML = """rigidarea = 1 # one
gravity = [0, -9.81]
[contact]
penetration = 1e-4
[materials.steel]
density = 7800
[outlines."a.b"]
points = [[0, 0], [4, 0, 0.25], [4, 1], [1, 1], [1, 4], [0, 4]]
holes = [[[0.3, 0.3], [0.7, 0.3], [0.7, 0.7], [0.3, 0.7]]]
[[bodies]]
name = 'part'
position = [0, 5]
shapes = [{ outline = "a.b", material = "steel" }, { circle = 0.5, density = 1, offset = [0, 1] }]
[[bodies]]
name = \"\"\"floor\"\"\"
type = "static"
shapes = [{ segment = [[-20, 0], [20, 0]], radius = 0.1, friction = 0.8 }]
[[joints]]
type = "pivot"
a = "part"
b = "floor"
"""
GEOJSON = {
    "type": "FeatureCollection",
    "features": [
        {"type": "Feature", "properties": {"a": "[{"}, "geometry": {"type": "Polygon", "coordinates": [
            [[0, 0], [4, 0], [4, 4.5], [0, 4], [0, 0]], [[1, 1], [1, 2], [2, 2], [2, 1], [1, 1]]]}},
        {"type": "Feature", "geometry": {"type": "GeometryCollection", "geometries": [
            {"type": "Point", "coordinates": [0, 0]},
            {"type": "MultiPolygon", "coordinates": [[[[9, 0, 7], [13, 0, 7], [13, 4, 7], [9, 0, 7]]]]}]}},
    ],
}  # fmt: skip


def pictures() -> dict[str, list[bytes]]:
    from PIL import Image

    y, x = np.ogrid[:40, :48]
    disc = np.clip(15.5 - np.hypot(x - 24, y - 20), 0, 1)
    alpha = np.zeros((40, 48, 4), np.uint8)
    alpha[..., 3] = np.round(255 * disc)
    dark = np.round(255 - 255 * disc).astype(np.uint8)

    def saved(array: np.ndarray, kind: str, mode: str | None = None, **how: object) -> bytes:
        picture, file = Image.fromarray(array), io.BytesIO()
        (picture.convert(mode) if mode else picture).save(file, kind, **how)
        return file.getvalue()

    frames = [Image.fromarray(dark)] * 2
    moving = io.BytesIO()
    frames[0].save(moving, "GIF", save_all=True, append_images=frames[1:], comment=b"x" * 300, duration=5)
    return {
        "png": [saved(alpha, "PNG"), saved(dark, "PNG", "1"), saved(dark, "PNG", "P", transparency=0)],
        "jpeg": [saved(dark, "JPEG"), saved(dark, "JPEG", "RGB", progressive=True, comment=b"y" * 50)],
        "bmp": [saved(dark, "BMP"), saved(dark, "BMP", "RGB"), saved(dark, "BMP", "1")],
        "gif": [saved(dark, "GIF"), moving.getvalue()],
        "webp": [saved(alpha, "WEBP", lossless=True), saved(alpha, "WEBP"), saved(dark, "WEBP")],
    }


def seeds() -> dict[str, list[bytes]]:
    scene = json.dumps(
        {
            "rigidarea": 1,
            "gravity": [0, -10],
            "materials": {"oak": {"density": 2.0, "friction": 0.5}},
            "outlines": {
                "u": {"points": [[0, 0], [3, 0, -0.2], [3, 2], [2, 2], [2, 1], [1, 1], [1, 2], [0, 2]]}
            },
            "bodies": [
                {
                    "name": "p",
                    "position": [0, 5],
                    "angle": 0.5,
                    "shapes": [{"outline": "u", "material": "oak"}],
                },
                {"name": "q", "mass": 2, "moment": "inf", "shapes": [{"circle": 0.5, "offset": [0.25, 0]}]},
                {"type": "static", "shapes": [{"poly": [[0, 0], [1, 0], [0, 1]], "filter": {"group": 3}}]},
            ],
            "joints": [{"type": "spring", "a": "p", "rest_length": 1, "stiffness": 5, "damping": 0.5}],
        }
    )
    texts = {"svg": SVG, "toml": TOML, "json": scene, "geojson": json.dumps(GEOJSON)}
    return {kind: [text.encode()] for kind, text in texts.items()} | pictures()


#: Words that each kind of text knows, and what has broken readers of it.
TOKENS = {
    "svg": "<g> </g> <style> /* */ // { } rotate( matrix( <!-- --> &lt; &a; <![CDATA[ ]]> M0,0 z C T1,1 a1,1,0,01 %"
    ' url(#a) <use href="#a"/> <script/> <!DOCTYPE <rect width="1" height="1"/> style="x:1" transform="scale(2)" h1'
    ' d="M',
    "toml": '[[ ]] a.b.c. . = """ \'\'\' " # { } [ ] a=1 \\ 0x 1979-05-27 inf nan [a] [[a.b]] {a=1}, [1,2],',
    "json": '[ ] { } " : , \\u0000 \\ null true NaN Infinity "a":1, [[0,0],[1,0],[0,1]], {},',
}
TOKENS["geojson"] = (
    TOKENS["json"] + ' {"type":"Polygon","coordinates":[ {"type":"GeometryCollection","geometries":['
)
NUMBERS = [
    "0",
    "-1",
    "1e308",
    "-1e308",
    "1e999",
    "1e-320",
    "nan",
    "inf",
    "9" * 400,
    "0x" + "f" * 4000,
    "1e50",
    ".5.",
    "1_0",
]


def bombs(kind: str, data: bytes, chance: random.Random) -> bytes:
    """Large and deep in ways that are known to hurt."""
    n = int(10 ** chance.uniform(2, 5))
    if kind == "svg":
        ring = " ".join(f"{math.cos(2.5 * i):.4g},{math.sin(2.5 * i):.4g}" for i in range(min(n, 20_000)))
        head = '<svg xmlns="http://www.w3.org/2000/svg">'
        inner = chance.choice(
            [
                "<g>" * n, "<g>" * (n // 9) + "</g>" * (n // 9), "<style>" + "/*" * n + "</style>",
                "<style>" + "a{" * n, f'<rect transform="{"rotate(" * n}"/>', f'<path d="M0,0 {"h1v1" * n}z"/>',
                f'<path d="M0,0 {"a1,1,0,0011," * (n // 3)}z"/>', f'<path d="M{"1" * n},0z"/>',
                f'<rect width="{"1" * n}"/>',
                f'<polygon points="{ring}"/>', '<rect width="1" height="1"/>' * (n // 3),
                f'<g class="{"a " * n}"/>', "<g " + " ".join(f'a{i}=""' for i in range(n // 2)) + "/>",
                f'<rect width="1" height="1" style="{"x:1;" * n}"/>', f'<path d="{"M0,0h1v1z" * (n // 4)}"/>',
                '<g id="a"><use href="#a"/></g>', "<text>" + "&#65;" * n + "</text>",
            ]
        )  # fmt: skip
        laughs = "".join(f'<!ENTITY a{i + 1} "{f"&a{i};" * 10}">' for i in range(9))
        doctype = f'<!DOCTYPE svg [<!ENTITY a0 "ha">{laughs}]>' if chance.random() < 0.1 else ""
        return (doctype + head + inner + "</svg>").encode()
    if kind == "toml":
        return chance.choice(
            [
                "rigidarea=1\n" + ".".join("a" * n) + "=1", "a=" + "[" * n, "a=" + "{a=" * n,
                "a=[" + "[1,2]," * n + "]",
                'a="' + "\\n" * n, 'a="""' + "\\\n" * n, "".join(f"a{i}=1\n" for i in range(n)), "[[a]]\n" * n,
                "".join(f"[a.b{i}.c]\n" for i in range(n // 2)), "a=" + "1" * n, "a=0x" + "f" * n, '"""\\' * n,
                "#" * n, "a=" + "1979-05-27T" * n, "[" + "a." * n + "b]", "'''" * n, "a={" + "a.b.c=1," * n + "}",
            ]
        ).encode()  # fmt: skip
    if kind in ("json", "geojson"):
        zigzag = [[i % 2, i] for i in range(n)]
        star = [[math.cos(2.5 * i), math.sin(2.5 * i)] for i in range(min(n, 30_000))]
        circle = [[math.cos(6.283 * i / n), math.sin(6.283 * i / n)] for i in range(n)]
        ring = chance.choice([zigzag, star, circle])
        if kind == "geojson":
            made: object = {"type": "Polygon", "coordinates": [ring + ring[:1]]}
            deep = '{"type":"GeometryCollection","geometries":['
        else:
            bend = chance.choice([0, 0, 0.01])
            points = [[*point, bend] for point in ring] if bend else ring
            shape = {chance.choice(["outline", "poly"]): {"points": points}, "density": 1}
            if "poly" in shape:
                shape["poly"] = ring
            many = [{"shapes": [{"circle": 1, "density": 1}], "position": [i, 0]} for i in range(n // 9)]
            made = {"rigidarea": 1, "bodies": chance.choice([[{"shapes": [shape]}], many])}
            deep = '{"bodies":['
        return chance.choice(
            [
                json.dumps(made),
                deep * n,
                "[" * n,
                "[" + "[]," * n + "1]",
                '{"a":' * n,
                '"' + "\\u0000" * n + '"',
                "1" * n,
            ]
        ).encode()
    if chance.random() < 0.2:  # another format under this one's name
        return chance.choice(
            [b"%!PS-Adobe-3.0 EPSF-3.0\n%%BoundingBox: 0 0 9 9\n(%pipe%touch x) (w) file\n", b"II*\0" + data]
        )  # fmt: skip
    at = {
        "png": 16,
        "jpeg": max(data.find(b"\xff\xc0"), data.find(b"\xff\xc2")) + 5,
        "bmp": 18,
        "gif": 6,
        "webp": 24,
    }[kind]
    large = bytes(chance.choice([0, 1, 0x0F, 0x7F, 0x80, 0xFF]) for _ in range(chance.choice([2, 4, 8])))
    grown = data[:at] + large + data[at + len(large) :]
    if chance.random() < 0.5:
        return grown
    a = chance.randrange(len(data))
    part = data[a : a + chance.randrange(1, 300)]
    return data[:a] + part * (min(n, 400_000 // len(part)) + 1) + data[a:]


def mutated(kind: str, data: bytes, chance: random.Random) -> bytes:
    """One of a seed's descendants."""
    if chance.random() < 0.03:
        return bombs(kind, data, chance)
    gentle = kind in TOKENS and chance.random() < 0.4  # other numbers alone: most of these are read
    for _ in range(chance.choice([1, 1, 2, 3, 8])):
        a = chance.randrange(len(data) + 1)
        b = min(len(data), a + chance.choice([1, 2, 4, 30, 300]))
        way = 9 if gentle else chance.randrange(12)
        if way == 0:
            data = data[:a]
        elif way == 1:
            data = data[:a] + data[b:]
        elif way == 2:
            data = data[:b] + data[a:]
        elif way == 3 and a < len(data):
            data = data[:a] + bytes([data[a] ^ 1 << chance.randrange(8)]) + data[a + 1 :]
        elif way == 4:
            data = data[:a] + chance.randbytes(b - a) + data[b:]
        elif way == 5:
            data = data[:a] + data[a:b][::-1] + data[b:]
        elif way == 6 and kind in TOKENS and chance.random() < 0.05:
            data = data.decode("latin-1").encode(chance.choice(["utf-16", "utf-32", "utf-8-sig", "cp037"]))
        elif way <= 8 and kind in TOKENS:
            token = chance.choice(TOKENS[kind].split(" ")).encode()
            times = int(10 ** chance.uniform(0, 5)) if chance.random() < 0.02 else 1
            data = data[:a] + token * times + data[a if chance.random() < 0.5 else b :]
        elif way <= 10 and kind in TOKENS:
            found = list(re.finditer(rb"\d+\.?\d*", data))
            if found:
                one = chance.choice(found)
                other = f"{chance.uniform(-9, 9):.3g}" if chance.random() < 0.6 else chance.choice(NUMBERS)
                data = data[: one.start()] + other.encode() + data[one.end() :]
        else:
            data = data[:a] + b"\0" * (b - a) + data[b:]
    return data


def use(kind: str, path: str) -> bool:
    """Read a file as its kind; whether all of it is finite."""
    if kind in ("toml", "json"):
        bodies = bring.load_scene(path).space.bodies
        return all(math.isfinite(x) for b in bodies for x in (*b.position, b.angle, *b.velocity))
    read: Callable[[str], list] = {
        "svg": bring.outlines_from_svg,
        "geojson": bring.outlines_from_geojson,
    }.get(kind, bring.outlines_from_image)
    return all(math.isfinite(o.area) and o.area > 0 for o in read(path))


def watch(event: str, given: tuple) -> None:
    """Audit hook of a process that reads a file: it ends where anything but reading begins."""
    started = (
        "subprocess.",
        "os.exec",
        "os.posix_spawn",
        "os.fork",
        "os.system",
        "os.spawn",
        "pty.",
        "socket.",
    )
    writes = event == "open" and isinstance(given[2], int) and given[2] & (os.O_WRONLY | os.O_RDWR)
    if event.startswith(started) or writes:
        os.write(2, f"{event} {given!r}\n".encode())
        os._exit(PROGRAM)


def child(kind: str, path: str) -> None:
    """In a process of its own: read the file, and end with how it went."""
    size = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
    resource.setrlimit(resource.RLIMIT_AS, (size + MEMORY, size + MEMORY))
    used = math.ceil(time.process_time())  # nothing yet: a process starts at 0
    resource.setrlimit(resource.RLIMIT_CPU, (used + SECONDS, used + SECONDS))
    faulthandler.register(signal.SIGALRM, chain=True)
    signal.alarm(WALL)  # against waiting, which takes no processor time; it says where
    sys.addaudithook(watch)
    try:
        code = READ if use(kind, path) else BAD
    except ValueError as error:
        code = REFUSED if re.search("expected|must", str(error)) else RAW
        if code == RAW:
            os.write(2, f"{error!r}\n"[:500].encode())
    except BaseException as error:
        os.write(2, f"{error!r}\n"[:500].encode())
        code = RAW
    os._exit(code)


def outcome(kind: str, path: str) -> str:
    """ "read", "refused", or what went wrong."""
    process = os.fork()
    if process == 0:
        child(kind, path)
    _, status, used = os.wait4(process, 0)
    if os.WIFSIGNALED(status):
        seconds = used.ru_utime + used.ru_stime
        return f"ended by {signal.Signals(os.WTERMSIG(status)).name} after {seconds:.1f} s of processor time"
    code = os.WEXITSTATUS(status)
    return {READ: "read", REFUSED: "refused"}.get(code) or WHAT.get(code, f"exit code {code}")


def preload(known: dict[str, list[bytes]], folder: Path) -> None:
    """Every seed once, so that libraries and compiled code are there before processes are measured."""
    for kind, several in known.items():
        for data in several:
            file = folder / f"seed.{kind}"
            file.write_bytes(data)
            assert use(kind, str(file)), kind


def run(
    kind: str, count: int, seed: int, known: dict[str, list[bytes]], folder: Path
) -> tuple[Counter[str], list[Path]]:
    """What became of `count` mutants of a kind, and the files of those that neither were read nor refused."""
    told: Counter[str] = Counter()
    bad = []
    file = folder / f"mutant.{kind}"
    for i in range(count):
        if i and i % 1000 == 0:
            print(f"{kind} {i}", file=sys.stderr, flush=True)
        chance = random.Random(f"{kind} {seed} {i}")
        file.write_bytes(mutated(kind, chance.choice(known[kind]), chance))
        result = outcome(kind, str(file))
        told[result] += 1
        if result not in ("read", "refused"):
            bad.append(file.rename(folder / f"{seed}-{i}.{kind}"))
            print(f"{bad[-1]}: {result}", file=sys.stderr)
    return told, bad


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--count", type=int, default=10_000, help="mutants of each kind")
    parser.add_argument("--seed", type=int, default=0)
    known = seeds()
    parser.add_argument("--kinds", nargs="*", choices=list(known), default=list(known))
    parser.add_argument("--keep", type=Path, help="folder for the files that went wrong")
    given = parser.parse_args()
    folder = given.keep or Path(tempfile.mkdtemp(prefix="fuzz-"))
    folder.mkdir(parents=True, exist_ok=True)
    preload(known, folder)
    failed = 0
    for kind in given.kinds:
        start = time.monotonic()
        told, bad = run(kind, given.count, given.seed, known, folder)
        failed += len(bad)
        print(f"{kind:8} {dict(told)}  {time.monotonic() - start:.0f} s", flush=True)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
