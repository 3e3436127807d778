"""What a plan looks at: a space's bodies, shapes and near pairs as arrays. Read once, before stepping; nothing is
changed.

Only what pymunk itself tells is used, so that a space may be planned before anything is attached to it.
"""

from __future__ import annotations

import math
from functools import lru_cache
from typing import Any, NamedTuple
from weakref import WeakKeyDictionary

import numpy as np
import pymunk
from numpy.typing import NDArray

from ..arcs import reversed_ring
from ..outline import Outline

Array = NDArray[np.float64]
Ints = NDArray[np.int64]

#: Shapes closer than this part of the smaller one's extent count as touching: what rests is put down at touch.
TOUCH = 1e-3
#: Relative difference up to which a polygon fills its box: rounding of pymunk's areas and boxes.
FLUSH = 1e-6


class Survey(NamedTuple):
    """A space in arrays. Bodies: those that move on their own first to last as in the space, then the others."""

    bodies: list[pymunk.Body]
    shapes: list[pymunk.Shape]
    outlines: list[Outline | None]  # those that shapes stand in for
    gravity: tuple[float, float]
    mass: Array  # (bodies,), infinite where nothing moves it
    moment: Array
    fastest: float  # of all that moves, whatever part of it is looked at (length/time)
    mobile: NDArray[np.bool_]  # (bodies,) which move on their own, likewise
    static: NDArray[np.bool_]  # (bodies,)
    inertia: Array  # (bodies,) mass, likewise
    velocity: Array  # (bodies, 2)
    speed: Array
    spin: Array
    extent: Array  # (bodies,) smallest extent of its shapes (length); infinite where nothing moves it
    reach: Array  # (bodies,) half the diagonal of what it covers (length)
    held: NDArray[np.bool_]  # (bodies,) by a pivot on what does not move: it does not fall
    owner: Ints  # (shapes,) body
    boxes: Array  # (shapes, 4) left, bottom, right, top
    thickness: Array  # (shapes,) smallest extent (length)
    radius: Array  # (shapes,) of curvature, negative for hollow curves, 0 for corners (length)
    corners: NDArray[np.bool_]  # (shapes,) lies with a corner or an edge that is not flush
    concave: NDArray[np.bool_]  # (shapes,) an outline that is not convex
    friction: Array
    elasticity: Array
    pairs: Ints  # (pairs, 2) shapes whose boxes meet, or may within the time looked ahead
    gaps: Array  # (pairs,) between their boxes (length); negative: how deep
    apart: float  # largest velocity of a body that moves, relative to their mean (length/time)

    @property
    def g(self) -> float:
        """Size of the gravity (length/time²)."""
        return math.hypot(*self.gravity)

    @property
    def moves(self) -> NDArray[np.bool_]:
        """Which bodies move on their own."""
        return np.isfinite(self.mass)


_curvatures: WeakKeyDictionary[Outline, float] = WeakKeyDictionary()


def curvature_radius(outline: Outline) -> float:
    """Radius of the curved parts of an outline: the middle one (length); negative: hollow; 0: it has corners only.

    A sampled curve is known by its turns: between chords of equal sign, small, over half their lengths.
    """
    if outline not in _curvatures:
        _curvatures[outline] = _curvature_radius(outline)
    return _curvatures[outline]


#: Turn between two chords (radians) below which they are taken for a sampled curve, not for a corner.
SMOOTH = 0.5


def _curvature_radius(outline: Outline) -> float:
    if outline.arcs:
        radii = np.concatenate([arc[:, 2] for arc in outline.arcs])
        radii = radii[radii != 0.0]
        return float(np.median(radii)) if len(radii) else 0.0
    found, lengths = [], []
    for ring in outline.rings:
        ahead = np.roll(ring, -1, axis=0) - ring
        behind = np.roll(ahead, 1, axis=0)
        turn = np.arctan2(
            behind[:, 0] * ahead[:, 1] - behind[:, 1] * ahead[:, 0], np.sum(behind * ahead, axis=1)
        )
        length = 0.5 * (np.hypot(*ahead.T) + np.hypot(*behind.T))
        smooth = (np.abs(turn) < SMOOTH) & (np.abs(turn) > 1e-9)
        found.append(length[smooth] / turn[smooth])
        lengths.append(length[smooth])
    radii, weights = np.concatenate(found), np.concatenate(lengths)
    if len(radii) < 8:  # fewer turns than an octagon has: corners
        return 0.0
    order = np.argsort(radii)
    return float(radii[order][np.searchsorted(np.cumsum(weights[order]), 0.5 * weights.sum())])


def _thickness(area: float, width: float, height: float, gyration2: float) -> float:
    """Smallest extent of a convex shape (length), from its area, its box, and its body's I/m.

    A rectangle of that area and radius of gyration has the sides (sqrt(12 i² + 2 A) ± sqrt(12 i² - 2 A))/2;
    whatever the shape, area/diameter is no larger than its least thickness, and no side of its box is smaller.
    """
    most = min(width, height)
    least = area / math.hypot(width, height)
    if not math.isfinite(gyration2):
        return most
    wide = math.sqrt(12.0 * gyration2 + 2.0 * area)
    narrow = math.sqrt(max(12.0 * gyration2 - 2.0 * area, 0.0))
    return min(max(0.5 * (wide - narrow), least), most)


def survey(space: pymunk.Space, ahead: float = 0.0, frame: float = 0.0) -> Survey:
    """Read a space. ahead: time for which pairs that a moving body may reach are looked for at its present speed;
    so are those no further apart than what is fastest goes in a `frame` (time).
    """
    gravity = (float(space.gravity[0]), float(space.gravity[1]))
    every = [*space.bodies, space.static_body]
    dynamic = pymunk.Body.DYNAMIC
    kinds = [body.body_type for body in every]
    free = np.array([kind == dynamic for kind in kinds])
    mass = np.array([body.mass if kind == dynamic else math.inf for body, kind in zip(every, kinds)])
    moment = np.array([body.moment if kind == dynamic else math.inf for body, kind in zip(every, kinds)])
    velocity = np.array([body.velocity for body in every], dtype=np.float64).reshape(-1, 2)
    spin = np.array([body.angular_velocity for body in every])
    index = {body: i for i, body in enumerate(every)}
    shapes: list[pymunk.Shape] = []
    outlines: list[Outline | None] = []
    rows: list[tuple[float, ...]] = []
    for shape in space.shapes:
        body = shape.body
        if shape.sensor or body not in index:
            continue
        i = index[body]
        box = shape.bb
        width, height = box.right - box.left, box.top - box.bottom
        outline = vars(shape).get("outline")  # (getattr on a shape without one costs ten times as much)
        radius, corner, hollow = 0.0, False, False
        if isinstance(outline, Outline):
            thick = outline.smallest_extent if free[i] else min(width, height)
            radius = curvature_radius(outline)
            hollow = not outline.convex
            corner = radius == 0.0 and abs(width * height - outline.area) > FLUSH * outline.area
        elif isinstance(shape, pymunk.Circle):
            thick, radius = width, shape.radius
        elif isinstance(shape, pymunk.Segment):
            thick = 2.0 * shape.radius or min(width, height)
            radius = shape.radius
        else:
            area = shape.area
            gyration2 = moment[i] / mass[i] if free[i] else math.inf
            thick = _thickness(area, width, height, gyration2)
            corner = abs(width * height - area) > FLUSH * area
        shapes.append(shape)
        outlines.append(outline if isinstance(outline, Outline) else None)
        rows.append(
            (
                *(i, box.left, box.bottom, box.right, box.top, thick, radius, corner, hollow),
                *(shape.friction, shape.elasticity),
            )
        )
    table = np.array(rows, dtype=np.float64).reshape(-1, 11)
    owner = table[:, 0].astype(np.int64)
    extent = np.full(len(every), math.inf)
    reach = np.zeros(len(every))
    if len(table):
        np.minimum.at(extent, owner, table[:, 5])
        diagonal = 0.5 * np.hypot(table[:, 3] - table[:, 1], table[:, 4] - table[:, 2])
        np.maximum.at(reach, owner, diagonal)
    extent[~free] = math.inf
    speed = np.hypot(velocity[:, 0], velocity[:, 1])
    boxes = table[:, 1:5]
    grown = boxes
    close = frame * float(speed[free].max(initial=0.0))
    if ahead > 0.0 and len(table):
        way = np.abs(velocity[owner]) * ahead + 0.5 * close
        grown = np.column_stack((boxes[:, :2] - way, boxes[:, 2:] + way))
    pairs = _near(grown, owner, free[owner] if len(table) else free[:0], TOUCH * table[:, 5], shapes)
    a, b = boxes[pairs[:, 0]], boxes[pairs[:, 1]]
    gaps = np.maximum(
        np.maximum(a[:, 0] - b[:, 2], b[:, 0] - a[:, 2]), np.maximum(a[:, 1] - b[:, 3], b[:, 1] - a[:, 3])
    )
    radii = _inner_radii(table[:, 6], boxes, pairs, outlines)
    return Survey(
        bodies=every,
        shapes=shapes,
        outlines=outlines,
        gravity=gravity,
        mass=mass,
        moment=moment,
        fastest=float(speed[free].max(initial=0.0)),
        mobile=free,
        static=np.array([kind == pymunk.Body.STATIC for kind in kinds]),
        inertia=mass,
        velocity=velocity,
        speed=speed,
        spin=np.abs(spin),
        extent=extent,
        reach=reach,
        held=_held(space, index, free),
        owner=owner,
        boxes=boxes,
        thickness=table[:, 5],
        radius=radii,
        corners=table[:, 7] > 0.0,
        concave=table[:, 8] > 0.0,
        friction=table[:, 9],
        elasticity=table[:, 10],
        pairs=pairs,
        gaps=gaps,
        apart=float(np.hypot(*(velocity[free] - velocity[free].mean(axis=0)).T).max()) if free.any() else 0.0,
    )


def _inner_radii(radius: Array, boxes: Array, pairs: Ints, outlines: list[Outline | None]) -> Array:
    """Radii of curvature, of outlines with holes that of the hole which something lies in (negative: hollow)."""
    found = radius.copy()
    holed = np.array([outline is not None and len(outline.rings) > 1 for outline in outlines], bool)
    for pair in pairs[holed[pairs].any(axis=1)]:
        for k, other in (pair, pair[::-1]):
            outline = outlines[k]
            if not holed[k]:
                continue
            assert outline is not None
            inside = (boxes[k, :2] < boxes[other, :2]).all() and (boxes[other, 2:] < boxes[k, 2:]).all()
            if inside:
                found[k] = -max(abs(curvature_radius(hole)) for hole in _holes(outline))
    return found


@lru_cache(maxsize=256)
def _holes(outline: Outline) -> list[Outline]:
    """Its holes as outlines of their own."""
    if not outline.arcs:
        return [Outline(ring) for ring in outline.rings[1:]]
    walked = (reversed_ring(*pair) for pair in list(zip(outline.rings, outline.arcs))[1:])
    return [Outline.from_curve([ring], arcs=[arcs]) for ring, arcs in walked]


def _near(
    boxes: Array, owner: Ints, free: NDArray[np.bool_], margin: Array, shapes: list[pymunk.Shape]
) -> Ints:
    """Pairs of shapes (n, 2) whose boxes meet within a margin, of different bodies, one of which moves."""
    n = len(boxes)
    if n < 2:
        return np.zeros((0, 2), np.int64)
    left, right = boxes[:, 0] - margin, boxes[:, 2] + margin
    order = np.argsort(left, kind="stable")
    last = np.searchsorted(left[order], right[order], side="right")
    counts = np.maximum(last - np.arange(n) - 1, 0)
    first = np.repeat(np.arange(n), counts)
    starts = np.cumsum(counts) - counts
    second = first + 1 + np.arange(counts.sum()) - starts[first]
    i, j = order[first], order[second]
    near = (
        (boxes[i, 1] - margin[i] <= boxes[j, 3] + margin[j])
        & (boxes[j, 1] - margin[j] <= boxes[i, 3] + margin[i])
        & (owner[i] != owner[j])
        & (free[i] | free[j])
    )
    i, j = i[near], j[near]
    filters = np.array([shape.filter for shape in shapes], np.int64)
    group, categories, mask = filters.T
    apart = (group[i] != 0) & (group[i] == group[j])  # as Chipmunk says that two never collide
    apart |= (categories[i] & mask[j] == 0) | (categories[j] & mask[i] == 0)
    return np.column_stack((i, j)).astype(np.int64)[~apart]


def _held(space: pymunk.Space, index: dict[pymunk.Body, int], free: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """(bodies,) which are held by a pivot on a body that does not move on its own."""
    found = np.zeros(len(free), bool)
    for joint in space.constraints:
        if isinstance(joint, pymunk.PivotJoint):
            a, b = (index.get(body, -1) for body in (joint.a, joint.b))
            found[b] |= b >= 0 and (a < 0 or not free[a])
            found[a] |= a >= 0 and (b < 0 or not free[b])
    return found & free


def joined(space: pymunk.Space) -> set[frozenset[pymunk.Body]]:
    """Pairs of bodies that a joint keeps from colliding."""
    return {frozenset((joint.a, joint.b)) for joint in space.constraints if not joint.collide_bodies}


def support(seen: Survey) -> tuple[Ints, Array, float, bool]:
    """How many bodies stand below each (layers, 1 on the ground), and what each carries, its own mass included (mass).

    And the largest mass of a body over that of one below it, and whether a body lies on two.

    Loads go down along the pairs that touch, from the highest body on, shared alike by all that lie below.
    """
    n = len(seen.bodies)
    layers, load = np.ones(n, np.int64), np.where(seen.moves, seen.mass, 0.0)
    touching = seen.gaps <= TOUCH * np.minimum(
        seen.thickness[seen.pairs[:, 0]], seen.thickness[seen.pairs[:, 1]]
    )
    pairs = seen.owner[seen.pairs[touching]]
    if not len(pairs) or seen.g == 0.0:
        return layers, load, 1.0, False
    boxes = seen.boxes
    middle = np.zeros((n, 2))
    weight = np.zeros(n)
    np.add.at(middle, seen.owner, 0.5 * (boxes[:, :2] + boxes[:, 2:]))
    np.add.at(weight, seen.owner, 1.0)
    middle /= np.maximum(weight, 1.0)[:, None]
    height = -(middle @ np.array(seen.gravity)) / seen.g
    height[~seen.moves] = -math.inf
    upper = np.where(height[pairs[:, 0]] >= height[pairs[:, 1]], pairs[:, 0], pairs[:, 1])
    lower = pairs.sum(axis=1) - upper
    below: list[list[int]] = [[] for _ in range(n)]
    for u, lo in zip(upper.tolist(), lower.tolist()):
        if height[u] > height[lo]:
            below[u].append(lo)
    order: Any = np.argsort(height, kind="stable")
    free = seen.moves.tolist()
    deep, carried = layers.tolist(), load.tolist()
    for u in reversed(order.tolist()):  # from the top: loads go down
        under = below[u]
        for lo in under:
            if free[lo]:
                carried[lo] += carried[u] / len(under)
    for u in order.tolist():  # from the ground: layers go up
        if free[u]:
            deep[u] = 1 + max((deep[lo] for lo in below[u] if free[lo]), default=0)
    light = seen.moves[upper] & seen.moves[lower]
    heavier = float((seen.mass[upper[light]] / seen.mass[lower[light]]).max(initial=1.0))
    shared = any(free[u] and len(set(under)) > 1 for u, under in enumerate(below))
    return np.array(deep), np.array(carried), heavier, shared


def bases(seen: Survey) -> tuple[Array, Array]:
    """Of a tower's bodies, where what each carries presses on what it stands on: (margin, width of the base (length)).

    margin: of half the base the part between the load's line of action and its edge (1: in the middle; 0 or less: it
    tips); 1 where nothing is known: what stands on nothing, or on two, or where gravity is not along an axis. A body's
    weight is in the middle of its boxes, its base what its box shares with that of what lies below.
    """
    n = len(seen.bodies)
    margin, width = np.ones(n), np.full(n, math.inf)
    axis = 1 if abs(seen.gravity[1]) >= abs(seen.gravity[0]) else 0
    if seen.g == 0.0 or seen.gravity[1 - axis] != 0.0:
        return margin, width
    touching = seen.gaps <= TOUCH * seen.thickness[seen.pairs].min(axis=1, initial=math.inf)
    free, owner, boxes = seen.moves, seen.owner, seen.boxes
    shapes = np.maximum(np.bincount(owner, minlength=n), 1)
    low, high = (np.bincount(owner, boxes[:, i], minlength=n) / shapes for i in (axis, axis + 2))
    height = np.where(free, -np.sign(seen.gravity[axis]) * (low + high), -math.inf)
    at = np.bincount(owner, 0.5 * (boxes[:, 1 - axis] + boxes[:, 3 - axis]), minlength=n) / shapes
    i, j = seen.pairs[touching].T
    left = np.maximum(boxes[i, 1 - axis], boxes[j, 1 - axis])
    right = np.minimum(boxes[i, 3 - axis], boxes[j, 3 - axis])
    a, b = owner[i], owner[j]
    upper, lower = np.where(height[a] > height[b], (a, b), (b, a))
    on = (right > left) & free[upper]
    left, right, upper, lower = left[on], right[on], upper[on], lower[on]
    off = np.maximum(
        np.abs(at[upper] - 0.5 * (left + right)), np.abs(at[lower] - 0.5 * (left + right)) * free[lower]
    )
    if not (off > 1e-9 * (right - left)).any():
        return margin, width  # all in the middle
    standing: dict[int, list[tuple[int, float, float]]] = {}
    for u, *base in zip(upper.tolist(), lower.tolist(), left.tolist(), right.tolist()):
        standing.setdefault(u, []).append(tuple(base))
    load = np.where(free, seen.mass, 0.0)
    moment = load * at
    for u in sorted(standing, key=lambda body: -height[body]):
        below = {lo for lo, _, _ in standing[u]}
        if len(below) > 1:
            continue
        (lo,) = below
        first, last = min(base[1] for base in standing[u]), max(base[2] for base in standing[u])
        width[u] = last - first
        margin[u] = 1.0 - abs(2.0 * moment[u] / load[u] - first - last) / width[u]
        load[lo] += load[u]
        moment[lo] += moment[u]
    return margin, width
