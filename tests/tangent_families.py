"""Families of pairs that touch along a tangent or coincide, by construction, with their exact overlap; and pairs on one
lattice of lengths, where whatever can touch or coincide does, somewhere."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

import rigidarea as ra
from rigidarea import shapes
from rigidarea.geometry import arcs as ring_arcs
from tangent_pairs import (
    NONE,
    Pair,
    Posed,
    any_shape,
    chord,
    crescent,
    gear,
    line,
    pieces_of,
    plate,
    rounded,
)


def pin_in_slot(rng: np.random.Generator, size: float) -> Pair:
    r, length = size * rng.uniform(0.05, 1), size * rng.uniform(0.1, 3)
    pin = ra.Outline.circle(r)
    where = float(rng.choice([-1, -1 + 2 * rng.random(), 0, 1]))
    end = pieces_of(pin, lambda arcs: arcs[:, 2] != 0)
    against = NONE
    if abs(where) == 1:  # the slot's round end
        top, bottom = np.array([0, r]), np.array([0, -r])
        p, q = (bottom, top) if where > 0 else (top, bottom)
        against = (p[None], q[None], end[2][:1])
    return Pair(
        "pin in slot",
        plate(shapes.capsule(length, r)),
        pin,
        (where * (length / 2), 0.0),
        0.0,
        np.zeros(2),
        against,
        NONE,
        (0,),
        r,
    )


def capsule_over_bore(rng: np.random.Generator, size: float) -> Pair:
    r, length = size * rng.uniform(0.05, 1), size * rng.uniform(0.1, 1)
    w = 3 * (length + r)
    square = np.array([(-w, -w), (w, -w), (w, w), (-w, w)])
    hole = ring_arcs.circle_ring((0.0, 0.0), r)
    bored = ra.Outline.from_curve([square, hole[0]], arcs=[np.zeros((4, 3)), hole[1]])
    return Pair(
        "capsule over bore",
        bored,
        shapes.capsule(length, r),
        (0.0, 0.0),
        2 * r * length,
        np.zeros(2),
        NONE,
        NONE,
        (1, 2),
        r,
    )


def plug(rng: np.random.Generator, size: float) -> Pair:
    shape = any_shape(rng, size)
    flat = max(float(np.abs(arc[:, 2]).max()) for arc in shape.arcs)
    return Pair("plug", plate(shape), shape, (0.0, 0.0), 0.0, np.zeros(2), pieces_of(shape), NONE, (0,), flat)


def twins(rng: np.random.Generator, size: float) -> Pair:
    shape = any_shape(rng, size) if rng.random() < 0.7 else gear(rng, size, True)[0]
    flat = max(float(np.abs(arc[:, 2]).max()) for arc in shape.arcs)
    return Pair(
        "twins", shape, shape, (0.0, 0.0), shape.area, np.zeros(2), NONE, pieces_of(shape), (1,), flat
    )


def disc_outside(rng: np.random.Generator, size: float) -> Pair:
    """A disc that touches a face, where the face is, at its very end (which is an arc's), or on a round end."""
    disc = ra.Outline.circle(size * rng.uniform(0.05, 1))
    r = disc.arcs[0][0, 2]
    if rng.random() < 0.5:
        half, thick = size * rng.uniform(0.05, 1), size * rng.uniform(0.05, 1)
        body: ra.Outline = shapes.capsule(2 * half, thick)
        face, top = half, thick
    else:
        body, w, top, bend = rounded(rng, size)
        face = w - bend
    x = face * float(rng.choice([-1, rng.uniform(-1, 1), 0, 1]))
    place = (x, (top + r) * float(rng.choice([-1, 1])))
    return Pair("disc outside", body, disc, place, 0.0, np.zeros(2), NONE, NONE, (0,), 4 * size)


def disc_inside(rng: np.random.Generator, size: float) -> Pair:
    """A disc in a capsule, at its side, between both sides, or in its end."""
    half, r = size * rng.uniform(0.05, 1), size * rng.uniform(0.05, 1)
    body = shapes.capsule(2 * half, r)
    how = rng.integers(3)
    small = r * rng.uniform(0.1, 0.95) if how == 0 else r
    disc = ra.Outline.circle(small)
    x = (
        half
        if how == 2
        else half * float(rng.choice([-1, rng.uniform(-1, 1), 0, 1])) * (1 if how == 0 else 0.9)
    )
    along = NONE
    if how == 2:
        along = (np.array([[0, -r]]), np.array([[0, r]]), np.array([[0, 0, r]]))
    return Pair(
        "disc inside",
        body,
        disc,
        (x, r - small),
        math.pi * small**2,
        -chord(along),
        NONE,
        along,
        (1,),
        20 * r,
    )


def slid_capsules(rng: np.random.Generator, size: float) -> Pair:
    length, r = size * rng.uniform(0.2, 2), size * rng.uniform(0.05, 1)
    body = shapes.capsule(length, r)
    a = length * rng.uniform(0.05, 0.95)
    low, high = -length / 2, length / 2 - a  # of B's faces on A's
    along = line((low, -r), (high, -r), (high, r), (low, r))
    inside = np.array([0.0, -2 * r])  # B's left end
    return Pair(
        "slid capsules",
        body,
        body,
        (a, 0.0),
        2 * r * (length - a) + math.pi * r * r,
        inside,
        NONE,
        along,
        (1,),
        4 * r,
    )


def stacked_boxes(rng: np.random.Generator, size: float) -> Pair:
    body, w, h, r = rounded(rng, size)
    half = w - r
    x = float(rng.choice([0.0, 2 * half * rng.uniform(-1, 1), 2 * half, 2 * w]))
    low, high = max(-half, -half - x), min(half, half - x)  # of B's lower face on A's upper
    against = line((low, -h), (high, -h)) if high > low else NONE
    return Pair("stacked boxes", body, body, (x, 2 * h), 0.0, np.zeros(2), against, NONE, (0,), 4 * r)


def disc_in_crescent(rng: np.random.Generator, size: float) -> Pair:
    moon = crescent(rng, size)
    p, q, arcs = pieces_of(moon, lambda arcs: arcs[:, 2] < 0)
    x, y, r = arcs[0]
    disc = ra.Outline.circle(-r)
    against = (q - (x, y), p - (x, y), np.array([[0, 0, -r]] * len(p)))
    return Pair(
        "disc in crescent", moon, disc, (float(x), float(y)), 0.0, np.zeros(2), against, NONE, (0,), -r
    )


def gear_in_bore(rng: np.random.Generator, size: float) -> Pair:
    wheel, tip, _ = gear(rng, size, False)
    tips = pieces_of(wheel, lambda arcs: (arcs[:, 2] > 0) & (arcs[:, 2] > 0.97 * tip))
    return Pair(
        "gear in bore",
        plate(ra.Outline.circle(tip)),
        wheel,
        (0.0, 0.0),
        0.0,
        np.zeros(2),
        tips,
        NONE,
        (0,),
        tip,
    )


def disc_in_gear(rng: np.random.Generator, size: float) -> Pair:
    wheel, tip, root = gear(rng, size, False)
    along = pieces_of(wheel, lambda arcs: (arcs[:, 2] > 0) & (arcs[:, 2] < 0.97 * tip))
    return Pair(
        "disc in gear",
        wheel,
        ra.Outline.circle(root),
        (0.0, 0.0),
        math.pi * root**2,
        -chord(along),
        NONE,
        along,
        (1,),
        root,
    )


def off_centre_over_bore(rng: np.random.Generator, size: float) -> Pair:
    """A tongue in a bore of its width: the bore's middle anywhere on the tongue's axis, or in its end's middle."""
    r, length = size * rng.uniform(0.05, 1), size * rng.uniform(0.1, 1)
    hole = ra.Outline.circle(r)
    w = 3 * (length + r)
    square = np.array([(-w, -w), (w, -w), (w, w), (-w, w)])
    bored = ra.Outline.from_curve([square, hole.rings[0]], arcs=[np.zeros((4, 3)), hole.arcs[0]])
    tongue = shapes.capsule(length, r)
    where = float(rng.choice([-1, rng.uniform(-1, 1), 1]))
    against, inside = NONE, np.zeros(2)
    if abs(where) == 1:  # its end lies in the bore's wall, and only the other end within the plate
        p, q = ((0.0, r), (0.0, -r)) if where > 0 else ((0.0, -r), (0.0, r))
        against = (np.array([p]), np.array([q]), np.array([[0.0, 0.0, r]]))
        inside = np.array([0.0, 2 * r * where])
    return Pair(
        "tongue in bore", bored, tongue, (where * length / 2, 0.0), 2 * r * length, inside, against, NONE,
        (1,) if abs(where) == 1 else (1, 2), r,
    )  # fmt: skip


def tongue_in_slot(rng: np.random.Generator, size: float) -> Pair:
    """A capsule in a longer slot of its width, anywhere or at its end: faces coincide, solids opposite."""
    r, length = size * rng.uniform(0.05, 1), size * rng.uniform(0.2, 2)
    short = length * rng.uniform(0.1, 0.9)
    room = (length - short) / 2
    where = float(rng.choice([-1, rng.uniform(-1, 1), 0, 1]))
    faces = line((-short / 2, -r), (short / 2, -r), (short / 2, r), (-short / 2, r))
    against = faces
    if abs(where) == 1:
        x = where * short / 2
        p, q = ((x, -r), (x, r)) if where > 0 else ((x, r), (x, -r))
        end = np.array([p]), np.array([q]), np.array([[x, 0.0, r]])
        against = tuple(np.concatenate(both) for both in zip(faces, end))  # type: ignore[assignment]
    return Pair(
        "tongue in slot", plate(shapes.capsule(length, r)), shapes.capsule(short, r), (where * room, 0.0), 0.0,
        np.zeros(2), against, NONE, (0,), 4 * r,
    )  # fmt: skip


def discs(rng: np.random.Generator, size: float) -> Pair:
    """Two discs that touch from outside or from inside, along an axis or in a point of a Pythagorean triangle."""
    a, b = size * rng.uniform(0.05, 1, 2)
    within = rng.random() < 0.5
    if within:
        a, b = max(a, b), min(a, b)
    ux, uy = ((1, 0), (0, -1), (0.6, 0.8), (-0.28, 0.96))[int(rng.integers(4))]
    far = a - b if within else a + b
    one, other = ra.Outline.circle(a), ra.Outline.circle(b)
    if rng.random() < 0.5:  # in a plate's stead of a disc: its bore
        if within:
            return Pair(
                "disc in bore", plate(one), other, (far * ux, far * uy), 0.0, np.zeros(2), NONE, NONE, (0,),
                40 * size,
            )  # fmt: skip
    area = math.pi * b * b if within else 0.0
    return Pair(
        "discs", one, other, (far * ux, far * uy), area, np.zeros(2), NONE, NONE, (1,) if within else (0,), 40 * size
    )  # fmt: skip


def nested_boxes(rng: np.random.Generator, size: float) -> Pair:
    """A rounded box in a corner of a larger one with corners of the same radius: two faces and the corner coincide."""
    w, h = size * rng.uniform(0.4, 1.0, 2)
    r = min(w, h) * 10 ** rng.uniform(-2, -0.5)
    outer = shapes.rounded_polygon([(-w, -h), (w, -h), (w, h), (-w, h)], r)
    v, g = w * rng.uniform(0.5, 0.9), h * rng.uniform(0.5, 0.9)
    r = min(r, 0.99 * v, 0.99 * g)
    inner = shapes.rounded_polygon([(-v, -g), (v, -g), (v, g), (-v, g)], r)
    outer = shapes.rounded_polygon([(-w, -h), (w, -h), (w, h), (-w, h)], r)
    corner = np.array([[v, g - r]]), np.array([[v - r, g]]), np.array([[v - r, g - r, r]])
    faces = line((v, r - g), (v, g - r), (v - r, g), (r - v, g))
    along = tuple(np.concatenate(both) for both in zip(faces, corner))
    return Pair(
        "nested boxes", outer, inner, (w - v, h - g), inner.area, -chord(along), NONE, along,  # type: ignore[arg-type]
        (1,), 4 * size,
    )  # fmt: skip


def gears_at_their_tips(rng: np.random.Generator, size: float) -> Pair:
    """Two gears whose tip circles touch in the middle of a tooth of each, or where none of them has one."""
    n, m = (int(k) for k in rng.integers(3, 20, 2))
    one, tip = _symmetric_gear(rng, n, size)
    other, end = _symmetric_gear(rng, m, size * rng.uniform(0.3, 1))
    other = other.rotated(math.pi)
    return Pair(
        "gears at their tips", one, other, (tip + end, 0.0), 0.0, np.zeros(2), NONE, NONE, (0,), 40 * size
    )  # fmt: skip


def _symmetric_gear(rng: np.random.Generator, n: int, tip: float) -> tuple[ra.Outline, float]:
    """(n teeth between arcs, one of them across +x; its tip radius)."""
    root, step = tip * rng.uniform(0.5, 0.95), 2 * math.pi / n
    width = step * rng.uniform(0.2, 0.8)
    ring = []
    for k in range(n):
        t = k * step
        top, gap = math.tan(width / 4), math.tan((step - width) / 4)
        low, high = t - width / 2, t + width / 2
        for r, angle, bulge in (
            (tip, low, top),
            (tip, high, 0.0),
            (root, high, gap),
            (root, low + step, 0.0),
        ):
            ring.append((r * math.cos(angle), r * math.sin(angle), bulge))
    points, arcs = ring_arcs.bulging(np.array(ring)[:, :2], np.array(ring)[:, 2])
    return ra.Outline.from_curve([points], arcs=[arcs]), tip


def crescents(rng: np.random.Generator, size: float) -> Pair:
    """A crescent in another's hollow: the same circle, outside of the one and inside of the other."""
    moon = crescent(rng, size)
    _, _, arcs = pieces_of(moon, lambda arcs: arcs[:, 2] < 0)
    bulge = float(rng.uniform(-0.04, 0.04))
    hollow = math.tan(math.asin(min(1.0, size / -arcs[0, 2])) / 2)
    fill = ra.Outline.from_bulges([(0, -size, hollow), (0, size, -bulge)])
    against = pieces_of(fill, lambda arcs: arcs[:, 2] > 0)
    if len(against[0]) != 1:
        against = tuple(column[:1] for column in against)  # type: ignore[assignment]
    return Pair(
        "crescents", moon, fill, (0.0, 0.0), 0.0, np.zeros(2), against, NONE, (0,), 40 * size
    )  # fmt: skip


FAMILIES = (
    pin_in_slot, capsule_over_bore, plug, twins, disc_outside, disc_inside, slid_capsules, stacked_boxes,
    disc_in_crescent, gear_in_bore, disc_in_gear,
    off_centre_over_bore, tongue_in_slot, discs, nested_boxes, gears_at_their_tips, crescents,
)  # fmt: skip


def lattice(rng: np.random.Generator, size: float) -> tuple[ra.Outline, ra.Outline, Posed]:
    """Two outlines of three lengths and their sums, at places of such sums, turned by eighths: whatever can touch,
    conform or coincide does, somewhere."""
    u, v, w = size * rng.uniform(0.2, 1, 3)
    shapes_of: list[Callable[[], ra.Outline]] = [
        lambda: ra.Outline.circle(u),
        lambda: ra.Outline.circle(v),
        lambda: shapes.capsule(2 * u, v),
        lambda: shapes.capsule(2 * v, u),
        lambda: shapes.box(2 * (u + v), 2 * v),
        lambda: shapes.rounded_polygon(
            [(-u - w, -v - u), (u + w, -v - u), (u + w, v + u), (-u - w, v + u)], u
        ),
        lambda: shapes.ring(u, u + v),
        lambda: plate(ra.Outline.circle(u)),
        lambda: plate(shapes.capsule(2 * v, u)),
        lambda: ra.Outline.from_bulges(
            [
                (-u - w, -v, 0),
                (u + w, -v, 0),
                (u + w, u + v, 0),
                (u, u + v, -1),
                (-u, u + v, 0),
                (-u - w, u + v, 0),
            ]
        ),
    ]
    a, b = (shapes_of[k]() for k in rng.integers(0, len(shapes_of), 2))
    sums = [
        k * p + m * q for k in (-1, 0, 1) for m in (-1, 0, 1) for p, q in ((u, v), (v, w), (u, w), (2 * u, v))
    ]
    angle = float(rng.uniform(-7, 7)) if rng.random() < 0.5 else 0.0
    turn = float(rng.integers(0, 8)) * math.pi / 4 if rng.random() < 0.6 else 0.0
    x, y = rng.choice(sums, 2) + (
        0 if rng.random() < 0.5 else size * 10 ** rng.uniform(-17, -9)
    ) * rng.normal(size=2)
    home = size * 10 ** rng.uniform(-2, 9) * rng.uniform(-1, 1, 2) * (rng.random() < 0.3)
    c, s = math.cos(angle), math.sin(angle)
    there = home + (c * x - s * y, s * x + c * y)
    pose_a = np.array([[*home, c, s]])
    pose_b = np.array([[*there, math.cos(angle + turn), math.sin(angle + turn)]])
    return a, b, Posed(pose_a, pose_b, np.zeros((1, 2)))
