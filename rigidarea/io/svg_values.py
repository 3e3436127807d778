"""What attributes of a drawing say: lengths with units, view boxes, transforms."""

from __future__ import annotations

import math
import re

from .limits import shown
from .svg_path import NUMBER, Matrix, finite_numbers, numbers

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

STRAIGHT: Matrix = (1.0, 0.0, 0.0, 1.0, 0.0, 0.0)

_TURNS = {"": 1.0, "deg": 1.0, "grad": 0.9, "rad": 180 / math.pi, "turn": 360.0}

_LENGTH = re.compile(rf"\s*+({NUMBER})\s*+([A-Za-z]*+|%)\s*+")

_TRANSFORM = re.compile(r"[\s,]*+([A-Za-z]++)\s*+\(([^()]*+)\)[\s,]*+")


def length_of(found: str | None, whole: float, what: str) -> float | None:
    """CSS pixels, percentages of `whole`; None for none and "auto"."""
    if found is None or found.strip() == "auto":
        return None
    told = _LENGTH.fullmatch(found)
    unit = told[2].lower() if told else "?"
    if told is None or (unit != "%" and unit not in _UNITS):
        raise ValueError(f"{what}: expected a length in {', '.join(_UNITS)[2:]} or %, got {shown(found)}")
    return finite_numbers([told[1]], what)[0] * (whole / 100 if unit == "%" else _UNITS[unit])


def viewport(
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
        length_of(given.get(name), whole, f"svg.{name}") for name, whole in zip(("width", "height"), outer)
    ]
    width, height = (outer[i] if value is None else value for i, value in enumerate(found))
    x, y = (
        0.0 if top else length_of(given.get(name), whole, f"svg.{name}") or 0.0
        for name, whole in zip("xy", outer)
    )
    if not box:
        return times(matrix, (1.0, 0.0, 0.0, 1.0, x, y)), (width, height)
    if not (box[2] > 0 and box[3] > 0):
        return matrix, (0.0, 0.0)
    sx, sy = width / box[2], height / box[3]
    align, *meet = given.get("preserveAspectRatio", "xMidYMid").split() or ["xMidYMid"]
    if align != "none":
        sx = sy = max(sx, sy) if meet == ["slice"] else min(sx, sy)
    part = {"min": 0.0, "max": 1.0}
    across, down = (0.0 if align == "none" else part.get(align[i : i + 3].lower(), 0.5) for i in (1, 5))
    x += across * (width - box[2] * sx) - box[0] * sx
    y += down * (height - box[3] * sy) - box[1] * sy
    return times(matrix, (sx, 0.0, 0.0, sy, x, y)), (box[2], box[3])


def times(a: Matrix, b: Matrix) -> Matrix:
    """First b, then a."""
    return (
        a[0] * b[0] + a[2] * b[1], a[1] * b[0] + a[3] * b[1],
        a[0] * b[2] + a[2] * b[3], a[1] * b[2] + a[3] * b[3],
        a[0] * b[4] + a[2] * b[5] + a[4], a[1] * b[4] + a[3] * b[5] + a[5],
    )  # fmt: skip


def transform(found: str) -> Matrix:
    """The matrix of SVG's transform attribute, or CSS's property."""
    made, at = STRAIGHT, 0
    if found.strip() in ("", "none"):
        return made
    while at < len(found):
        told = _TRANSFORM.match(found, at)
        if told is None:
            raise ValueError(f"transform: expected functions of numbers, got {shown(found[at : at + 40])}")
        made = times(made, _function(told[1], told[2]))
        at = told.end()
    return made


def _function(name: str, found: str) -> Matrix:
    kind, units = name.lower(), {"": 1.0}
    if kind.startswith(("rotate", "skew")):
        units = _TURNS
    elif kind.startswith("translate"):
        units = _UNITS
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
