"""Lines, Bézier curves and elliptic arcs of a drawing: from path data to points, in one pass over text and table each.

Points and vectors are complex numbers, x + i y, in the units and axes of the element until `Segments.rings` applies its
transform.
"""

from __future__ import annotations

import cmath
import math
import re
from collections.abc import Iterable, Sequence

import numpy as np
from numpy.typing import NDArray

from .limits import Limits, check, shown
from .values import LARGEST, Ring

Matrix = tuple[float, float, float, float, float, float]
"""SVG's matrix(a, b, c, d, e, f): x' = a x + c y + e, y' = b x + d y + f."""

# Possessive: no digit is ever looked at twice.
NUMBER = r"[-+]?+(?>[0-9]++\.?+[0-9]*+|\.[0-9]++)(?>[eE][-+]?+[0-9]++)?+"
_GAP = r"[\s,]*+"
_NUMBERS = re.compile(NUMBER)
_COMMANDS = re.compile(r"([A-DF-Za-df-z])([^A-DF-Za-df-z]*+)")  # e is an exponent's
_RUN = re.compile(rf"(?:{_GAP}{NUMBER})*+{_GAP}")
_ARC = re.compile(
    _GAP + _GAP.join([f"({NUMBER})"] * 3 + ["([01])"] * 2 + [f"({NUMBER})"] * 2) + _GAP, re.ASCII
)
#: Segments of a drawing: some two microseconds each.
SEGMENTS = 250_000
#: Numbers that each command takes at a time.
_TAKES = {"m": 2, "l": 2, "h": 1, "v": 1, "c": 6, "s": 4, "q": 4, "t": 2, "a": 7, "z": 0}

_MOVE, _LINE, _CURVE, _ARC_OF = range(4)


def numbers(found: str, what: str) -> list[float]:
    """The numbers of a list with commas or space between; ValueError for anything else in it."""
    if rest := _NUMBERS.sub("", found).replace(",", " ").strip():
        raise ValueError(f"{what}: expected numbers, got {shown(rest)}")
    return finite_numbers(_NUMBERS.findall(found), what)


def finite_numbers(found: Iterable[str], what: str) -> list[float]:
    """The numbers; ValueError for one beyond LARGEST."""
    given = list(map(float, found))
    if given and not max(max(given), -min(given)) <= LARGEST:
        raise ValueError(
            f"{what}: expected finite numbers of at most {LARGEST:g}, got {max(given, key=abs):g}"
        )
    return given


class Segments:
    """All segments of a drawing, in columns. A row of kind _MOVE begins a ring with its end."""

    def __init__(self, limits: Limits) -> None:
        self.limits = limits
        self.kinds = bytearray()
        self.ends: list[complex] = []
        self.bent: list[tuple[complex, complex, complex]] = []
        """Of each curve its first three control points, of each arc its centre and two conjugate half diameters."""
        self.angles: list[tuple[float, float]] = []
        """Of each arc where it starts and how far it goes on (radians)."""
        self.stops: list[int] = []
        """Where the rows of each element end."""
        self.matrices: list[Matrix] = []

    def move(self, to: complex) -> None:
        self.kinds.append(_MOVE)
        self.ends.append(to)

    def line(self, to: complex) -> None:
        self.kinds.append(_LINE)
        self.ends.append(to)

    def curve(self, a: complex, b: complex, c: complex, to: complex) -> None:
        self.kinds.append(_CURVE)
        self.ends.append(to)
        self.bent.append((a, b, c))

    def arc(self, center: complex, u: complex, v: complex, start: float, sweep: float, to: complex) -> None:
        """center + u cos t + v sin t, from t = start on by sweep (radians)."""
        self.kinds.append(_ARC_OF)
        self.ends.append(to)
        self.bent.append((center, u, v))
        self.angles.append((start, sweep))

    def polyline(self, points: Sequence[complex]) -> None:
        for i, point in enumerate(points):
            (self.line if i else self.move)(point)

    def ellipse(self, center: complex, rx: float, ry: float) -> None:
        """Four quarters, so that the ends are where it is widest."""
        around = [center + rx, center + ry * 1j, center - rx, center - ry * 1j]
        self.move(around[0])
        for i in range(4):
            self.arc(center, complex(rx), ry * 1j, i * math.pi / 2, math.pi / 2, around[(i + 1) % 4])

    def rectangle(self, x: float, y: float, width: float, height: float, rx: float, ry: float) -> None:
        if not (rx > 0 and ry > 0):
            at = complex(x, y)
            self.polyline([at, at + width, at + complex(width, height), at + height * 1j])
            return
        centers = [complex(x + width - rx, y + ry), complex(x + width - rx, y + height - ry)]
        centers += [complex(x + rx, y + height - ry), complex(x + rx, y + ry)]
        away = [-ry * 1j, complex(rx), ry * 1j, complex(-rx)]
        self.move(centers[3] + away[0])
        for i, center in enumerate(centers):
            self.line(center + away[i])
            end = center + away[(i + 1) % 4]
            self.arc(center, complex(rx), ry * 1j, (i - 1) * math.pi / 2, math.pi / 2, end)

    def elliptic(
        self, at: complex, rx: float, ry: float, turn: float, large: bool, left: bool, to: complex
    ) -> None:
        """The arc of SVG's path data (its implementation notes, B.2.4 and B.2.5); turn in degrees."""
        rx, ry = abs(rx), abs(ry)
        if at == to:
            return
        if not (rx > 0 and ry > 0):
            self.line(to)
            return
        axis = cmath.rect(1.0, math.radians(turn))
        half = (at - to) / 2 / axis
        p = complex(half.real / rx, half.imag / ry)  # where the ellipse is the unit circle
        size = math.hypot(p.real, p.imag)
        if size == 0:  # the ellipse is larger than its chord by more than a double has digits
            self.line(to)
            return
        if size > 1:
            rx, ry, p, size = rx * size, ry * size, p / size, 1.0
        c = p / size * (1j if large == left else -1j) * math.sqrt((1 - size) * (1 + size))
        start, end = cmath.phase(p - c), cmath.phase(-p - c)
        sweep = (end - start) % (2 * math.pi)
        if not left:
            sweep -= 2 * math.pi
        center = complex(c.real * rx, c.imag * ry) * axis + (at + to) / 2
        self.arc(center, rx * axis, ry * 1j * axis, start, sweep, to)

    def path(self, data: str) -> None:
        """Append SVG path data. ValueError for an error in it, where a browser would draw what comes before it."""
        if data.strip() in ("", "none"):
            return
        if not data.lstrip().startswith(("M", "m")):
            raise ValueError(f"path.d: expected M or m to begin with, got {shown(data.strip())}")
        at = start = before = 0j  # before: the last control point of the command before, of its kind
        kind = ""
        closed = False
        for letter, found in map(re.Match.groups, _COMMANDS.finditer(data)):
            last, kind = kind, letter.lower()
            takes = _TAKES.get(kind)
            if takes is None:
                raise ValueError(f"path.d: expected one of {''.join(_TAKES)}, got {shown(letter + found)}")
            given, more = _arcs(found) if kind == "a" else _run(found)
            if more or (len(given) % takes or not given if takes else given):
                wanted = f"{takes} numbers at a time" if takes else "no numbers"
                raise ValueError(f"path.d: expected {wanted} after {letter}, got {shown(found.strip())}")
            if kind == "z":
                self.line(start)
                at, closed = start, True
                continue
            told = len(self.kinds) + len(given) // takes
            check(told, self.limits.points, "points")
            check(told, SEGMENTS, "segments")
            if closed and kind != "m":
                self.move(at)
            closed = False
            near = letter == kind
            if kind in "mlt":
                pairs = zip(given[::2], given[1::2])
                if kind == "m":
                    at = (at if near else 0j) + complex(*next(pairs))
                    start = at
                    self.move(at)
                if kind == "t":
                    for x, y in pairs:
                        before = 2 * at - before if last in ("q", "t") else at
                        to = complex(x, y) + (at if near else 0j)
                        self._quadratic(at, before, to)
                        at, last = to, "t"
                else:
                    for x, y in pairs:
                        at = complex(x, y) + (at if near else 0j)
                        self.line(at)
            elif kind in "hv":
                for value in given:
                    x, y = at.real, at.imag
                    if kind == "h":
                        at = complex(value + x if near else value, y)
                    else:
                        at = complex(x, value + y if near else value)
                    self.line(at)
            elif kind == "a":
                for i in range(0, len(given), 7):
                    rx, ry, turn, large, left, x, y = given[i : i + 7]
                    to = complex(x, y) + (at if near else 0j)
                    self.elliptic(at, rx, ry, turn, bool(large), bool(left), to)
                    at = to
            else:
                points = list(map(complex, given[::2], given[1::2]))
                step = takes // 2
                for i in range(0, len(points), step):
                    base = at if near else 0j
                    p = [point + base for point in points[i : i + step]]
                    if kind == "q":
                        before = p[0]
                        self._quadratic(at, p[0], p[1])
                    else:
                        if kind == "s":
                            p.insert(0, 2 * at - before if last in ("c", "s") else at)
                        before = p[1]
                        self.curve(at, p[0], p[1], p[2])
                    at, last = p[-1], kind

    def _quadratic(self, a: complex, b: complex, to: complex) -> None:
        self.curve(a, (a + 2 * b) / 3, (to + 2 * b) / 3, to)

    def element(self, matrix: Matrix) -> bool:
        """What was appended since the last element is one, with this transform; False: nothing was."""
        if len(self.kinds) > (self.stops[-1] if self.stops else 0):
            check(len(self.stops) + 1, self.limits.parts, "elements")
            check(len(self.kinds), self.limits.points, "points")
            check(len(self.kinds), SEGMENTS, "segments")
            self.stops.append(len(self.kinds))
            self.matrices.append(matrix)
            return True
        return False

    def rings(self, scale: float, flip: bool, tolerance: float | None, least: int = 3) -> list[list[Ring]]:
        """The rings of each element, transformed, times `scale`, y upwards with `flip`; see `elements_from_svg`.

        Those of fewer than `least` points are left out.

        A curve's chord over 1/n of its parameter is off by at most max|B''| / (8 n^2), and B'' is bounded by the
        control points' second differences; of an arc it is the longer half diameter times the sweep's square.
        """
        if not self.stops:
            return []
        kinds = np.frombuffer(bytes(self.kinds), np.uint8)
        ends = np.array(self.ends)
        starts = np.array([0, *self.stops[:-1]])
        of = np.repeat(np.arange(len(starts)), np.array(self.stops) - starts)
        matrices = scale * np.array(self.matrices)
        if flip:
            matrices[:, 1::2] *= -1
        with np.errstate(all="ignore"):  # what is not finite is refused below
            found = self._sampled(kinds, ends, of, starts, matrices, tolerance)
        return [[ring for ring in rings if len(ring) >= least] for rings in found]

    def _sampled(
        self,
        kinds: NDArray[np.uint8],
        ends: NDArray[np.complex128],
        of: NDArray[np.intp],
        starts: NDArray[np.intp],
        matrices: Ring,
        tolerance: float | None,
    ) -> list[list[Ring]]:
        m = matrices[of]
        ends = _placed(ends, m)
        bends = np.flatnonzero(kinds >= _CURVE)
        bent = np.array(self.bent, complex).reshape(-1, 3)
        arc = kinds[bends] == _ARC_OF
        p, q, r = (_placed(bent[:, i], m[bends], 1.0 if i == 0 else ~arc) for i in range(3))
        angles = np.zeros((len(bends), 2))
        angles[arc] = np.array(self.angles).reshape(-1, 2)

        def at(which: NDArray[np.intp], t: Ring) -> NDArray[np.complex128]:
            a, b, c, d, s = p[which], q[which], r[which], ends[bends[which]], 1 - t
            angle = angles[which, 0] + t * angles[which, 1]
            curve = s * s * s * a + 3 * s * s * t * b + 3 * s * t * t * c + t * t * t * d
            return np.where(arc[which], a + np.cos(angle) * b + np.sin(angle) * c, curve)

        every = np.arange(len(bends))
        low, high = np.stack((ends.real, ends.imag)), np.stack((ends.real, ends.imag))
        for t in np.arange(1, 8) / 8:  # their extent, to two percent
            inner = at(every, np.full(len(bends), t))
            for axis, value in enumerate((inner.real, inner.imag)):
                low[axis, bends] = np.minimum(low[axis, bends], value)
                high[axis, bends] = np.maximum(high[axis, bends], value)
        extent = np.maximum.reduceat(high, starts, axis=1) - np.minimum.reduceat(low, starts, axis=1)
        smaller = extent.min(axis=0)
        allowed = (
            np.where(smaller > 0, 1e-3 * smaller, 1e-3)
            if tolerance is None
            else np.full(len(starts), tolerance)
        )
        both = np.abs(q) ** 2 + np.abs(r) ** 2
        area = q.real * r.imag - q.imag * r.real
        longer = np.sqrt((both + np.sqrt(np.maximum(both * both - 4 * area * area, 0.0))) / 2)
        second = 6 * np.maximum(np.abs(p - 2 * q + r), np.abs(q - 2 * r + ends[bends]))
        second = np.where(arc, longer * angles[:, 1] ** 2, second)
        if not (
            np.isfinite(second).all() and (np.abs(low) <= LARGEST).all() and (np.abs(high) <= LARGEST).all()
        ):
            raise ValueError(f"expected finite coordinates of at most {LARGEST:g} in every path")
        pieces = np.ones(len(kinds))
        pieces[bends] = np.clip(np.ceil(np.sqrt(second / (8 * allowed[of[bends]]))), 1, 1e9)
        check(int(pieces.sum()), self.limits.points, "points")
        count = pieces.astype(np.intp)
        first = np.cumsum(count) - count
        points = np.repeat(ends, count)
        row = np.repeat(bends, count[bends] - 1)
        which = np.repeat(every, count[bends] - 1)
        k = np.arange(len(row)) - np.repeat(
            np.cumsum(count[bends] - 1) - (count[bends] - 1), count[bends] - 1
        )
        points[first[row] + k] = at(which, (k + 1) / count[row])
        told = np.column_stack((points.real, points.imag))
        moves = np.flatnonzero(kinds == _MOVE)
        found: list[list[Ring]] = [[] for _ in starts]
        for element, ring in zip(of[moves].tolist(), np.split(told, first[moves[1:]])):
            found[element].append(ring)
        return found


def _placed(
    z: NDArray[np.complex128], m: Ring, shift: float | NDArray[np.bool_] = 1.0
) -> NDArray[np.complex128]:
    """Points z under the matrices m, a row each; vectors where `shift` is 0."""
    x = m[:, 0] * z.real + m[:, 2] * z.imag + shift * m[:, 4]
    y = m[:, 1] * z.real + m[:, 3] * z.imag + shift * m[:, 5]
    return x + 1j * y


def _run(found: str) -> tuple[list[float], bool]:
    """The numbers that a text begins with, and whether something else comes after them."""
    end = _RUN.match(found).end()  # type: ignore[union-attr]  # it matches nothing at all, too
    return finite_numbers(_NUMBERS.findall(found, 0, end), "path"), end < len(found)


def _arcs(found: str) -> tuple[list[float], bool]:
    """The same of arcs, seven numbers each: between flags, and after them, there need be nothing."""
    given: list[float] = []
    at = 0
    while at < len(found) and (arc := _ARC.match(found, at)):
        given += finite_numbers(arc.groups(), "path")
        at = arc.end()
    return given, at < len(found)
