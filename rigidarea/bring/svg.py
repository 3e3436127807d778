"""Outlines from SVG drawings: paths and basic shapes, curves sampled by a tolerance."""

from __future__ import annotations

import math
import os
import re
from typing import Any
from xml.parsers import expat

from ..gate import size, truth
from ..outline import Outline
from .limits import LIMITS, Limits, allowed, check, read, shown, text
from .rings import outlines_of_polygons, polygons_of_rings
from .svg_path import NUMBER, Matrix, Segments, finite_numbers, numbers

#: A drawing is read in Python, some megabyte a second.
SVG_BYTES = 2 * 2**20
#: Things that can make a small file a large drawing, or reach beyond the file.
REFUSED = ("use", "script", "foreignObject")
#: What is inside these is drawn only where something else asks for it.
ASIDE = ("defs", "symbol", "clipPath", "mask", "marker", "pattern")
NAMESPACE = "http://www.w3.org/2000/svg"

_UNITS = {
    "": 1.0,
    "px": 1.0,
    "pt": 4 / 3,
    "pc": 16.0,
    "in": 96.0,
    "cm": 96 / 2.54,
    "mm": 9.6 / 2.54,
    "q": 2.4 / 2.54,
}
_TURNS = {"": 1.0, "deg": 1.0, "grad": 0.9, "rad": 180 / math.pi, "turn": 360.0}
_LENGTH = re.compile(rf"\s*+({NUMBER})\s*+([A-Za-z]*+|%)\s*+")
_TRANSFORM = re.compile(r"[\s,]*+([A-Za-z]++)\s*+\(([^()]*+)\)[\s,]*+")
#: Attributes that a style may set too.
_STYLED = {"display", "transform", "x", "y", "width", "height", "rx", "ry", "cx", "cy", "r"}
_SHAPES = ("path", "rect", "circle", "ellipse", "polyline", "polygon")


def outlines_from_svg(
    source: str | os.PathLike[str],
    *,
    scale: float = 1.0,
    flip: bool = False,
    tolerance: float | None = None,
    limits: Limits = LIMITS,
) -> list[Outline]:
    """Outlines from an SVG file: one for every connected solid of every path, rectangle, circle, ellipse, polygon.

    Within one element what lies within an odd number of its rings is solid, so letters keep their holes; whether it
    is filled or stroked is not asked, `display: none` is. Transforms and units are applied; lengths are CSS pixels
    times `scale`. y points down as in the file, or up with `flip`. tolerance: largest sagitta of a chord in place of a
    curve (length; None: a thousandth of the element's smaller extent).

    Raises ValueError for what is no SVG, for a file that uses entities, scripts or <use> (a short one can unfold
    without end), for rings that cross, and for more than `limits` allow.
    """
    allowed(limits), truth(flip, "flip"), size(scale, "scale")
    if tolerance is not None:
        size(tolerance, "tolerance")
    content = text(read(source, limits._replace(bytes=min(limits.bytes, SVG_BYTES))), str(source))
    try:
        sheet = _Sheet(limits)
        _parsed(content, sheet)
        drawing = _Drawing(limits, _rules("".join(sheet.style)))
        _parsed(content, drawing)
        made: list[Outline] = []
        for rings in drawing.segments.rings(scale, flip, tolerance):
            made += outlines_of_polygons(polygons_of_rings(rings, limits), 0.0, limits)
            check(len(made), limits.rings, "outlines")
        return made
    except expat.ExpatError as error:
        raise ValueError(f"{source}: expected an SVG drawing: {error}") from None
    except ValueError as error:
        raise ValueError(f"{source}: {error}") from None


class _Sheet:
    """First reading: nothing in it that is not read, nor too much; its style sheets."""

    def __init__(self, limits: Limits) -> None:
        self.limits = limits
        self.elements = self.depth = 0
        self.styled = 0
        self.style: list[str] = []

    def start(self, name: str, given: dict[str, str]) -> None:
        tag = name.rpartition(" ")[2]
        if tag in REFUSED:
            raise ValueError(f"expected a plain drawing, got '<{tag}'")
        if self.depth == 0 and name not in ("svg", f"{NAMESPACE} svg"):
            raise ValueError(f"expected an SVG drawing, got one with <{tag[:40]}> around it")
        self.elements += 1
        self.depth += 1
        check(self.elements, self.limits.parts, "elements")
        check(self.depth, self.limits.depth, "elements within each other")
        self.styled += tag == "style"

    def end(self, name: str) -> None:
        self.depth -= 1
        self.styled -= name.rpartition(" ")[2] == "style"

    def words(self, found: str) -> None:
        if self.styled:
            self.style.append(found)


class _Drawing:
    """Second reading: what is drawn."""

    def __init__(self, limits: Limits, rules: dict[str, dict[str, str]]) -> None:
        self.segments = Segments(limits)
        self.rules = rules
        #: Of every open element: its transform, the size that percentages are of, whether it is drawn.
        self.open: list[tuple[Matrix, tuple[float, float], bool]] = []

    def start(self, name: str, given: dict[str, str]) -> None:
        space, _, tag = name.rpartition(" ")
        matrix, view, drawn = (
            self.open[-1] if self.open else ((1.0, 0.0, 0.0, 1.0, 0.0, 0.0), (0.0, 0.0), True)
        )
        if drawn and space in ("", NAMESPACE):
            given = self._styled(tag, given)
            drawn = tag not in ASIDE and given.get("display", "").strip().lower() != "none"
            if drawn:
                matrix = _times(matrix, _transform(given.get("transform", "")))
                if tag == "svg":
                    matrix, view = _viewport(matrix, view, given)
                    drawn = view[0] > 0 and view[1] > 0
                elif tag in _SHAPES:
                    self._shape(tag, given, view)
                    self.segments.element(matrix)
        self.open.append((matrix, view, drawn))

    def end(self, name: str) -> None:
        self.open.pop()

    def words(self, found: str) -> None:
        pass

    def _styled(self, tag: str, given: dict[str, str]) -> dict[str, str]:
        """Attributes, then what style sheets say in the order of their selectors' weight, then the element's style."""
        known = ["*", tag] if self.rules else []
        if self.rules and "class" in given:
            for name in given["class"].split():
                known += (f".{name}", f"{tag}.{name}")
        if self.rules and "id" in given:
            known.append(f"#{given['id']}")
        told = [self.rules[name] for name in known if name in self.rules]
        if "style" in given:
            told.append(_declarations(given["style"]))
        for more in told:
            given = given | more
        return given

    def _shape(self, tag: str, given: dict[str, str], view: tuple[float, float]) -> None:
        def length(name: str, whole: float) -> float | None:
            return _length(given.get(name), whole, f"{tag}.{name}")

        w, h = view
        if tag == "path":
            self.segments.path(given.get("d", ""))
        elif tag in ("polyline", "polygon"):
            found = numbers(given.get("points", ""), f"{tag}.points")
            if len(found) % 2:
                raise ValueError(f"{tag}.points: expected an even count of numbers, got {len(found)}")
            self.segments.polyline(list(map(complex, found[::2], found[1::2])))
        elif tag == "rect":
            width, height = length("width", w) or 0.0, length("height", h) or 0.0
            rx, ry = length("rx", w), length("ry", h)
            rx, ry = rx if rx is not None else ry or 0.0, ry if ry is not None else rx or 0.0
            if width > 0 and height > 0:
                at = length("x", w) or 0.0, length("y", h) or 0.0
                self.segments.rectangle(*at, width, height, min(rx, width / 2), min(ry, height / 2))
        else:
            if tag == "circle":
                rx = ry = length("r", math.hypot(w, h) / math.sqrt(2))
            else:
                rx, ry = length("rx", w), length("ry", h)
                rx, ry = rx if rx is not None else ry, ry if ry is not None else rx
            if rx and ry and rx > 0 and ry > 0:
                self.segments.ellipse(complex(length("cx", w) or 0.0, length("cy", h) or 0.0), rx, ry)


def _parsed(content: str, reader: _Sheet | _Drawing) -> None:
    """Every element of an XML text handed to the reader; no entity but XML's own five, nothing from elsewhere."""

    def refuse(*_: Any) -> None:
        raise ValueError("expected a plain drawing, got '<!DOCTYPE'")

    parser = expat.ParserCreate(namespace_separator=" ")
    parser.StartDoctypeDeclHandler = refuse
    parser.StartElementHandler = reader.start
    parser.EndElementHandler = reader.end
    parser.CharacterDataHandler = reader.words
    parser.Parse(content, True)


def _rules(sheet: str) -> dict[str, dict[str, str]]:
    """What a style sheet says of each of its selectors; of those with more than one part nothing is asked."""
    plain: list[str] = []
    for part in sheet.split("/*"):  # a comment ends at its first */; what begins in it begins nothing
        plain.append(part if not plain else part.partition("*/")[2])
    rules: dict[str, dict[str, str]] = {}
    for rule in "".join(plain).split("}"):
        names, _, told = rule.partition("{")
        declared = _declarations(told)
        if declared:
            for name in names.split(","):
                rules[name.strip()] = rules.get(name.strip(), {}) | declared
    return rules


def _declarations(style: str) -> dict[str, str]:
    found = (part.partition(":") for part in style.split(";"))
    told = ((name.strip(), value.replace("!important", "").strip()) for name, _, value in found)
    return {name: value for name, value in told if name in _STYLED}


def _length(found: str | None, whole: float, what: str) -> float | None:
    """CSS pixels, percentages of `whole`; None for none and "auto"."""
    if found is None or found.strip() == "auto":
        return None
    told = _LENGTH.fullmatch(found)
    unit = told[2].lower() if told else "?"
    if told is None or (unit != "%" and unit not in _UNITS):
        raise ValueError(f"{what}: expected a length in {', '.join(_UNITS)[2:]} or %, got {shown(found)}")
    return finite_numbers([told[1]], what)[0] * (whole / 100 if unit == "%" else _UNITS[unit])


def _viewport(
    matrix: Matrix, outer: tuple[float, float], given: dict[str, str]
) -> tuple[Matrix, tuple[float, float]]:
    """The transform within an <svg>, and the size that percentages are of there (SVG 2, 8.2)."""
    box = numbers(given.get("viewBox", ""), "svg.viewBox")
    if box and (len(box) != 4 or box[2] < 0 or box[3] < 0):
        raise ValueError(f"svg.viewBox: expected x, y, width, height, got {shown(given['viewBox'])}")
    top = outer == (0.0, 0.0)
    if top:
        outer = (box[2], box[3]) if box else (1000.0, 1000.0)
    found = [
        _length(given.get(name), whole, f"svg.{name}") for name, whole in zip(("width", "height"), outer)
    ]
    width, height = (outer[i] if value is None else value for i, value in enumerate(found))
    x, y = (
        0.0 if top else _length(given.get(name), whole, f"svg.{name}") or 0.0
        for name, whole in zip("xy", outer)
    )
    if not box:
        return _times(matrix, (1.0, 0.0, 0.0, 1.0, x, y)), (width, height)
    if not (box[2] > 0 and box[3] > 0):
        return matrix, (0.0, 0.0)
    sx, sy = width / box[2], height / box[3]
    align, *meet = given.get("preserveAspectRatio", "xMidYMid").split() or ["xMidYMid"]
    if align != "none":
        sx = sy = max(sx, sy) if meet == ["slice"] else min(sx, sy)
    part = {"min": 0.0, "max": 1.0}
    x += (
        part.get(align[1:4].lower(), 0.5) * (width - box[2] * sx) - box[0] * sx
        if align != "none"
        else -box[0] * sx
    )
    y += (
        part.get(align[5:8].lower(), 0.5) * (height - box[3] * sy) - box[1] * sy
        if align != "none"
        else -box[1] * sy
    )
    return _times(matrix, (sx, 0.0, 0.0, sy, x, y)), (box[2], box[3])


def _times(a: Matrix, b: Matrix) -> Matrix:
    """First b, then a."""
    return (
        a[0] * b[0] + a[2] * b[1], a[1] * b[0] + a[3] * b[1],
        a[0] * b[2] + a[2] * b[3], a[1] * b[2] + a[3] * b[3],
        a[0] * b[4] + a[2] * b[5] + a[4], a[1] * b[4] + a[3] * b[5] + a[5],
    )  # fmt: skip


def _transform(found: str) -> Matrix:
    """The matrix of SVG's transform attribute, or CSS's property."""
    made: Matrix = (1.0, 0.0, 0.0, 1.0, 0.0, 0.0)
    at = 0
    if found.strip() in ("", "none"):
        return made
    while at < len(found):
        told = _TRANSFORM.match(found, at)
        if told is None:
            raise ValueError(f"transform: expected functions of numbers, got {shown(found[at : at + 40])}")
        made = _times(made, _function(told[1], told[2]))
        at = told.end()
    return made


def _function(name: str, found: str) -> Matrix:
    kind = name.lower()
    units = (
        _TURNS
        if kind.startswith(("rotate", "skew"))
        else _UNITS
        if kind.startswith("translate")
        else {"": 1.0}
    )
    given = []
    for i, (value, unit) in enumerate(_ARGUMENTS.findall(found)):
        table = _UNITS if kind == "rotate" and i else units  # a centre is a length
        if unit.lower() not in table:
            raise ValueError(
                f"transform: expected {name} in {', '.join(table)[2:] or 'numbers'}, got {shown(unit)}"
            )
        given.append(finite_numbers([value], "transform")[0] * table[unit.lower()])
    if _ARGUMENTS.sub("", found).replace(",", " ").strip():
        raise ValueError(f"transform: expected numbers in {name}, got {shown(found)}")
    match kind, given:
        case "matrix", [a, b, c, d, e, f]:
            return (a, b, c, d, e, f)
        case "translate" | "translatex", [x]:
            return (1.0, 0.0, 0.0, 1.0, x, 0.0)
        case "translate", [x, y]:
            return (1.0, 0.0, 0.0, 1.0, x, y)
        case "translatey", [y]:
            return (1.0, 0.0, 0.0, 1.0, 0.0, y)
        case "scale", [s]:
            return (s, 0.0, 0.0, s, 0.0, 0.0)
        case "scale", [s, t]:
            return (s, 0.0, 0.0, t, 0.0, 0.0)
        case "scalex", [s]:
            return (s, 0.0, 0.0, 1.0, 0.0, 0.0)
        case "scaley", [s]:
            return (1.0, 0.0, 0.0, s, 0.0, 0.0)
        case "rotate", [angle] | [angle, _, _]:
            c, s = math.cos(math.radians(angle)), math.sin(math.radians(angle))
            x, y = given[1:] or (0.0, 0.0)
            return (c, s, -s, c, x - c * x + s * y, y - s * x - c * y)
        case "skewx", [angle]:
            return (1.0, 0.0, math.tan(math.radians(angle)), 1.0, 0.0, 0.0)
        case "skewy", [angle]:
            return (1.0, math.tan(math.radians(angle)), 0.0, 1.0, 0.0, 0.0)
    raise ValueError(
        f"transform: expected a function of SVG with its numbers, got {shown(f'{name}({found})')}"
    )


_ARGUMENTS = re.compile(rf"({NUMBER})\s*+([A-Za-z%]*+)")
