"""Outlines from SVG drawings: paths and basic shapes, curves sampled by a tolerance."""

from __future__ import annotations

import math
import os
import re
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any, NamedTuple, Unpack
from xml.parsers import expat

import pymunk

from ..geometry.gate import ShapeAttributes, size, truth
from ..geometry.outline import Outline
from .limits import LIMITS, Limits, allowed, check, read, shown, text
from .rings import outlines_of_polygons, polygons_of_rings
from .svg_path import Matrix, Segments, numbers
from .svg_strokes import Stroke, stroked
from .svg_values import STRAIGHT, length_of, times, transform, viewport

#: A drawing is read in Python, some megabyte a second.
SVG_BYTES = 2 * 2**20
#: Things that can make a small file a large drawing, or reach beyond the file.
REFUSED = ("script", "foreignObject")
#: What is inside these is drawn only where something else asks for it.
ASIDE = ("defs", "symbol", "clipPath", "mask", "marker", "pattern")
NAMESPACE = "http://www.w3.org/2000/svg"
_QUOTED = r"""\s++(?>"[^"]*+"|'[^']*+')"""
#: What may come before the root; in group 2 a document type that names a DTD, which is not read, and declares nothing.
_PROLOG = re.compile(
    rf"((?>\s|<\?.*?\?>|<!--.*?-->)*+)(<!DOCTYPE\s++svg(?>\s++PUBLIC{_QUOTED}{_QUOTED}|\s++SYSTEM{_QUOTED})?\s*+>)",
    re.DOTALL,
)

#: Attributes that a style may set too.
_STYLED = {"display", "transform", "x", "y", "width", "height", "rx", "ry", "cx", "cy", "r"}
#: What an element takes from those around it, and what it is where none says.
_INK = {
    "fill": "black",
    "stroke": "none",
    "stroke-width": "1",
    "stroke-linecap": "butt",
    "stroke-linejoin": "miter",
}
_SHAPES = ("path", "rect", "circle", "ellipse", "polyline", "polygon", "line")
_CLOSED = ("rect", "circle", "ellipse", "polygon")
LABEL = "http://www.inkscape.org/namespaces/inkscape label"
HREF = "http://www.w3.org/1999/xlink href"


class Element(NamedTuple):
    """A solid of an SVG file, with the names that it has there."""

    outline: Outline
    id: str
    """The element's `id`, or that of the <use> that drew it; empty: it has none."""
    name: str
    """Its label in Inkscape, or else its id."""
    layers: tuple[str, ...]
    """Names of the groups around it, the outermost first."""

    def add_to(self, body: pymunk.Body, **shape_attrs: Unpack[ShapeAttributes]) -> pymunk.Shape:
        """`Outline.add_to`, the shape with its `name` and `layers` as attributes."""
        shape = self.outline.add_to(body, **shape_attrs)
        shape.name, shape.layers = self.name, self.layers  # type: ignore[attr-defined]
        return shape


def outlines_from_svg(
    source: str | os.PathLike[str],
    *,
    scale: float = 1.0,
    flip: bool = False,
    tolerance: float | None = None,
    limits: Limits = LIMITS,
) -> list[Outline]:
    """Outlines from an SVG file: those of `elements_from_svg`, without their names."""
    found = elements_from_svg(source, scale=scale, flip=flip, tolerance=tolerance, limits=limits)
    return [element.outline for element in found]


def elements_from_svg(
    source: str | os.PathLike[str],
    *,
    scale: float = 1.0,
    flip: bool = False,
    tolerance: float | None = None,
    limits: Limits = LIMITS,
) -> list[Element]:
    """What an SVG file draws: an element for every connected solid of every path, rectangle, circle, ellipse, polygon.

    Within one element what lies within an odd number of its rings is solid, so letters keep their holes. What has a
    stroke and `fill: none` is the stroke, as wide as it is drawn; lines too. Else what is inside counts, filled or not,
    unless `display: none`. <use> draws what it names. Transforms and units are applied; lengths are CSS pixels
    times `scale`. y points down as in the file, or up with `flip`. tolerance: largest sagitta of a chord in place of a
    curve (length; None: a thousandth of the element's smaller extent, of a stroke's width).

    Raises ValueError, with the element and its line, for what is no SVG, for a file with entities or scripts, for path
    data with an error in it (of which a browser would draw the beginning), for rings that cross, for a <use> of nothing
    or of itself, and for more than `limits` allow, what is used again counted again.
    """
    allowed(limits), truth(flip, "flip"), size(scale, "scale")
    if tolerance is not None:
        size(tolerance, "tolerance")
    content = text(read(source, limits._replace(bytes=min(limits.bytes, SVG_BYTES))), str(source))
    try:
        tree = _Tree(limits)
        _parsed(content, tree)
        drawing = _Drawing(limits, tree)
        made: list[Element] = []
        for mark, rings in zip(drawing.marks, drawing.segments.rings(scale, flip, tolerance, 2)):
            with _at(mark.node):
                polygons = (
                    polygons_of_rings([ring for ring in rings if len(ring) >= 3], limits)
                    if mark.stroke is None
                    else stroked(rings, mark.stroke._replace(width=scale * mark.stroke.width), tolerance)
                )
                found = outlines_of_polygons(polygons, 0.0, limits)
            made += [Element(outline, mark.id, mark.name, mark.layers) for outline in found]
            check(len(made), limits.rings, "outlines")
        return made
    except expat.ExpatError as error:
        raise ValueError(f"{source}: expected an SVG drawing: {error}") from None
    except ValueError as error:
        raise ValueError(f"{source}: {error}") from None


class _Node(NamedTuple):
    """An element of the file."""

    space: str
    tag: str
    given: dict[str, str]
    line: int
    children: list[_Node]

    def __str__(self) -> str:
        named = f" id={shown(self.given['id'])}" if "id" in self.given else ""
        return f"line {self.line}, <{self.tag[:40]}{named}>"


class _Mark(NamedTuple):
    """What is drawn: an element of the file, its names, its pen."""

    node: _Node
    id: str
    name: str
    layers: tuple[str, ...]
    stroke: Stroke | None


@contextmanager
def _at(node: _Node) -> Iterator[None]:
    """Within it, a ValueError says at which element it was."""
    try:
        yield
    except ValueError as error:
        raise ValueError(f"{node}: {error}") from None


class _Tree:
    """Reading: all elements, no more than are allowed; the style sheets."""

    def __init__(self, limits: Limits) -> None:
        self.limits = limits
        self.elements = 0
        self.open: list[_Node] = []
        self.root: _Node | None = None
        self.named: dict[str, _Node] = {}
        self.styled = 0
        self.style: list[str] = []

    def start(self, name: str, given: dict[str, str], line: int) -> None:
        space, _, tag = name.rpartition(" ")
        if tag in REFUSED:
            raise ValueError(f"expected a plain drawing, got '<{tag}'")
        if self.root is None and name not in ("svg", f"{NAMESPACE} svg"):
            raise ValueError(f"expected an SVG drawing, got one with <{tag[:40]}> around it")
        self.elements += 1
        check(self.elements, self.limits.parts, "elements")
        node = _Node(space, tag, given, line, [])
        if self.open:
            self.open[-1].children.append(node)
        else:
            self.root = node
        self.open.append(node)
        check(len(self.open), self.limits.depth, "elements within each other")
        if "id" in given:
            self.named.setdefault(given["id"], node)
        self.styled += tag == "style"

    def end(self, name: str) -> None:
        self.styled -= self.open.pop().tag == "style"

    def words(self, found: str) -> None:
        if self.styled:
            self.style.append(found)


class _Place(NamedTuple):
    """Where an element is drawn: what those around it say."""

    node: _Node
    matrix: Matrix
    view: tuple[float, float]
    """What percentages are of (length)."""
    ink: dict[str, str]
    layers: tuple[str, ...]
    depth: int
    used: dict[str, str] | None
    """The attributes of the <use> that draws it."""


class _Drawing:
    """What is drawn, in the order of the file."""

    def __init__(self, limits: Limits, tree: _Tree) -> None:
        self.segments = Segments(limits)
        self.marks: list[_Mark] = []
        self.named = tree.named
        self.rules = _rules("".join(tree.style))
        assert tree.root is not None  # else expat would have said so
        todo = [_Place(tree.root, STRAIGHT, (0.0, 0.0), _INK, (), 1, None)]
        drawn = 0
        while todo:
            place = todo.pop()
            drawn += 1
            with _at(place.node):
                check(drawn, limits.parts, "elements")
                check(place.depth, limits.depth, "elements within each other")
                todo += reversed(self._inner(place))

    def _inner(self, place: _Place) -> list[_Place]:
        """Draw one element; what is to be drawn within it."""
        node, used = place.node, place.used
        if node.space not in ("", NAMESPACE):
            return [place._replace(node=child, depth=place.depth + 1, used=None) for child in node.children]
        given = self._styled(node.tag, node.given)
        aside = node.tag in ASIDE and not (node.tag == "symbol" and used is not None)
        if aside or given.get("display", "").strip().lower() == "none":
            return []
        matrix, view = times(place.matrix, transform(given.get("transform", ""))), place.view
        ink = {name: given.get(name, value) for name, value in place.ink.items()}
        if node.tag in ("svg", "symbol"):
            if used is not None:
                given = given | {name: used[name] for name in ("width", "height") if name in used}
            matrix, view = viewport(matrix, view, given)
            if not (view[0] > 0 and view[1] > 0):
                return []
        name = (used or {}).get("id", given.get("id", ""))
        if node.tag in _SHAPES:
            label = (used or {}).get(LABEL, given.get(LABEL, name))
            stroke = self._pen(node.tag, ink, matrix, view)
            if node.tag != "line" or stroke is not None:
                self._shape(node.tag, given, view)
                if self.segments.element(matrix):
                    self.marks.append(_Mark(node, name, label, place.layers, stroke))
        inner = place._replace(matrix=matrix, view=view, ink=ink, depth=place.depth + 1, used=None)
        if node.tag == "use":
            href = given.get("href", given.get(HREF, "")).strip()
            target = self.named.get(href[1:]) if href.startswith("#") else None
            if target is None:
                raise ValueError(f"expected href to name an element of the file, got {shown(href)}")
            x, y = (
                length_of(given.get(axis), whole, f"use.{axis}") or 0.0 for axis, whole in zip("xy", view)
            )
            return [inner._replace(node=target, matrix=times(matrix, (1.0, 0.0, 0.0, 1.0, x, y)), used=given)]
        if node.tag == "g" and (LABEL in given or name):
            inner = inner._replace(layers=(*place.layers, given.get(LABEL, name)))
        return [inner._replace(node=child) for child in node.children]

    def _pen(self, tag: str, ink: dict[str, str], matrix: Matrix, view: tuple[float, float]) -> Stroke | None:
        """The pen of what is drawn by its stroke alone; None: it is solid."""
        hollow = tag == "line" or ink["fill"].strip().lower() in ("none", "transparent")
        if not hollow or ink["stroke"].strip().lower() in ("none", "transparent"):
            return None
        width = length_of(ink["stroke-width"], math.hypot(*view) / math.sqrt(2), f"{tag}.stroke-width") or 0.0
        width *= math.sqrt(abs(matrix[0] * matrix[3] - matrix[1] * matrix[2]))
        if not width > 0:
            return None
        return Stroke(width, ink["stroke-linecap"].strip(), ink["stroke-linejoin"].strip(), tag in _CLOSED)

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
            return length_of(given.get(name), whole, f"{tag}.{name}")

        w, h = view
        if tag == "line":
            ends = [complex(length(f"x{i}", w) or 0.0, length(f"y{i}", h) or 0.0) for i in (1, 2)]
            self.segments.polyline(ends)
        elif tag == "path":
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


def _parsed(content: str, reader: _Tree) -> None:
    """Every element of an XML text handed to the reader; no entity but XML's own five, nothing from elsewhere."""

    def refuse(*_: Any) -> None:
        raise ValueError("expected a plain drawing, got '<!DOCTYPE'")

    parser = expat.ParserCreate(namespace_separator=" ")
    parser.StartDoctypeDeclHandler = refuse
    parser.StartElementHandler = lambda name, given: reader.start(name, given, parser.CurrentLineNumber)
    parser.EndElementHandler = reader.end
    parser.CharacterDataHandler = reader.words
    if named := _PROLOG.match(content):  # without it a name that it may declare is an error, not passed over
        content = named[1] + "\n" * named[2].count("\n") + content[named.end() :]
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
    return {name: value for name, value in told if name in _STYLED or name in _INK}
