"""The speed that leaves no gap: curvatures of a region's sides, and how they turn under each other."""

from __future__ import annotations

import math

import numpy as np
import pytest

import rigidarea as ra
from rigidarea import shapes
from rigidarea.contact.dtypes import BODY, REGION
from rigidarea.geometry.overlap import new_work
from rigidarea.geometry.place import Pose, overlap_of_outlines
from rigidarea.geometry.turning import curvatures, turning_speed
from rigidarea.overlap_queries import _packed, _pose


def bodies(rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    """Two that move anyhow; only their motion counts."""
    made = []
    for _ in range(2):
        body = np.zeros(1, BODY)[0]
        body["vx"], body["vy"], body["w"] = rng.normal(size=3)
        made.append(body)
    return made[0], made[1]


def carried(
    body: np.ndarray, centre: np.ndarray, point: np.ndarray, time: float, push: np.ndarray
) -> np.ndarray:
    """Where a point of a body is then, the body's velocity changed by push."""
    return (
        centre + time * (np.array([body["vx"], body["vy"]]) + push) + turned(body["w"] * time, point - centre)
    )


def turned(angle: float, v: np.ndarray) -> np.ndarray:
    c, s = math.cos(angle), math.sin(angle)
    return np.array([c * v[0] - s * v[1], s * v[0] + c * v[1]])


#: Curvatures of A and of B.
KINDS = {
    "discs": (1 / 0.7, 1 / 0.2),
    "in a hole": (-1 / 0.7, 1 / 0.2),
    "on a flat": (0.0, 1 / 0.2),
    "on a corner": (1e9, 1 / 0.2),
}


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("seed", range(20))
def test_a_gap_closes_by_what_turns(kind: str, seed: int) -> None:
    """Two circles carried by two bodies, at places of their own: no gap is left at h, but for the third order.

    B's speed is changed so that the closing speed is what the row would make it.
    """
    rng = np.random.default_rng(seed)
    a, b = bodies(rng)
    n = turned(rng.uniform(0, 2 * math.pi), np.array([1.0, 0.0]))
    contact, centre_a, centre_b = rng.normal(size=(3, 2))
    r = np.zeros(1, REGION)[0]
    r["nx"], r["ny"] = n
    r["curve_a"], r["curve_b"] = KINDS[kind]
    r["lean_a"], r["lean_b"] = (contact - centre_a) @ n, (contact - centre_b) @ n
    radius_a, radius_b = (1 / k if k else math.inf for k in KINDS[kind])

    def gap(time: float, push: float) -> float:
        there = carried(b, centre_b, contact + radius_b * n, time, -push * n)
        if radius_a == math.inf:
            foot = carried(a, centre_a, contact, time, 0 * n)
            return float((there - foot) @ turned(a["w"] * time, n)) - radius_b
        here = carried(a, centre_a, contact - radius_a * n, time, 0 * n)
        return math.copysign(math.hypot(*(there - here)), radius_a) - radius_a - radius_b

    h = 1e-4
    tiny = 1e-8  # of h: the closing speed there is now, taken off
    now = (gap(-tiny, 0.0) - gap(tiny, 0.0)) / (2 * tiny)
    assert abs(gap(h, turning_speed(r, a, b, h) - now)) < 1e-2 * abs(gap(h, -now)) + 1e-11


def test_a_disc_on_a_flat_leaves_no_gap() -> None:
    """Its direction stands still, whether it rolls, slides or spins."""
    rng = np.random.default_rng(2)
    r = np.zeros(1, REGION)[0]
    r["nx"], r["ny"], r["curve_b"], r["lean_b"] = 0.0, 1.0, 4.0, -0.25
    a, b = bodies(rng)
    a["vx"] = a["vy"] = a["w"] = 0.0
    assert abs(turning_speed(r, a, b, 0.01)) < 1e-15


def test_what_the_substep_has_given_turns_nothing() -> None:
    """Round corners of two bodies, with a kick and without: contacts stop it, or what lies still turned for ever."""
    rng = np.random.default_rng(3)
    r = np.zeros(1, REGION)[0]
    r["nx"], r["ny"], r["curve_a"], r["curve_b"], r["lean_a"], r["lean_b"] = 0.6, 0.8, 2.0, 4.0, 0.7, -0.4
    a, b = bodies(rng)
    alone = turning_speed(r, a, b, 0.01)
    assert abs(alone) > 1e-4
    for body in (a, b):
        body["kick_x"], body["kick_y"], body["kick_w"] = rng.normal(size=3)
        body["vx"] += body["kick_x"]
        body["vy"] += body["kick_y"]
        body["w"] += body["kick_w"]
    assert turning_speed(r, a, b, 0.01) == pytest.approx(alone, rel=1e-12)  # rounding of the sums


@pytest.mark.parametrize(
    ("outline", "place", "want"),
    [
        (ra.Outline.circle(1.0), (0.0, 1.2499, 0.3), (1.0, 4.0)),
        (ra.Outline([(-3, -3), (3, -3), (3, 0), (-3, 0)]), (0.1, 0.2499, 0.3), (0.0, 4.0)),
        (shapes.ring(1.0, 2.0), (0.0, 0.7501, 0.0), (-1.0, 4.0)),
        (shapes.ring(0.26, 2.0), (0.0, 0.0101, 0.0), (-1 / 0.26, 4.0)),
    ],
    ids=["disc", "flat", "bowl", "journal"],
)
def test_curvatures_are_those_of_the_sides(
    outline: ra.Outline, place: tuple[float, float, float], want: tuple[float, float]
) -> None:
    """To 0.3 of the square of the half angle that the region takes of the disc: 3e-4 here, in a journal 0.015."""
    pin = ra.Outline.circle(0.25)
    pool = _packed(outline, pin)
    work = new_work(64)
    n, _ = overlap_of_outlines(pool, 0, Pose(0.0, 0.0, 1.0, 0.0), 1, Pose(*_pose(place, "place")), work)
    assert n == 1
    loop = work.loops[0]
    chord = math.hypot(loop["chord_x"], loop["chord_y"])
    got = curvatures(
        work.polygon, work.label, work.bows, int(loop["start"]), int(loop["stop"]), float(loop["area"]), chord
    )
    assert got == pytest.approx(want, rel=0.3 * (0.5 * chord / 0.25) ** 2 * 1.2 + 1e-9, abs=1e-9)


def test_a_corner_is_its_angle_spread_over_the_region() -> None:
    """A right angle, half its diagonal h in a disc far larger: side h, chord 2 h, area h^2: curvature 12 / 8 h."""
    box = ra.Outline([(0, 0), (-1, 1), (-2, 0), (-1, -1)])
    disc = ra.Outline.circle(1e4, (1e4 - 0.01, 0.0))
    work = new_work(64)
    place = Pose(*_pose((0, 0, 0), "place"))
    n, _ = overlap_of_outlines(_packed(box, disc), 0, place, 1, place, work)
    assert n == 1
    loop = work.loops[0]
    chord = math.hypot(loop["chord_x"], loop["chord_y"])
    ka, kb = curvatures(
        work.polygon, work.label, work.bows, int(loop["start"]), int(loop["stop"]), float(loop["area"]), chord
    )
    assert ka == pytest.approx(12 / (8 * 0.01), rel=1e-3)
    assert kb == pytest.approx(1e-4, rel=1e-3)
