"""Force of one region: direction after the paper's Algorithm 2, and the damping that returns a restitution."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
import shapely
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

import rigidarea as ra

EPS = 2.0**-52


def radial(rng: np.random.Generator, n: int, jag: float) -> np.ndarray:
    t = 2 * np.pi * (np.arange(n) + rng.uniform(-0.3, 0.3, n)) / n
    r = 1 - jag * rng.random(n)
    return np.stack([r * np.cos(t), r * np.sin(t)], axis=1)


# --- direction ---


def arc_inside(outline: Any, other: Any) -> np.ndarray | None:
    """The one piece of a placed ring inside the other outline, end points on its boundary, counter-clockwise."""
    ring = np.array(outline.exterior.coords)
    ring = ring if outline.exterior.is_ccw else ring[::-1]
    outside = [i for i, p in enumerate(ring[:-1]) if not other.covers(shapely.Point(p))]
    if not outside:
        return None
    ring = np.roll(ring[:-1], -outside[0], axis=0)
    piece = shapely.LineString(np.concatenate([ring, ring[:1]])).intersection(other)
    if piece.geom_type != "LineString" or piece.is_empty:
        return None
    xy = np.array(piece.coords)
    line = shapely.LineString(np.concatenate([ring, ring[:1]]))
    return xy if line.project(shapely.Point(xy[0])) < line.project(shapely.Point(xy[-1])) else xy[::-1]


def algorithm_2(slave: np.ndarray, master: np.ndarray, q: float) -> np.ndarray:
    """F_contact of Eq. 15 from the arcs of slave and master, literally; shapely finds the points of Eq. 9."""
    forces = []
    for arc, other in ((slave, shapely.LineString(master)), (master, shapely.LineString(slave))):
        total = np.zeros(2)
        for before, node, after in zip(arc, arc[1:], arc[2:]):
            n = np.array([[0, -1], [1, 0]]) @ (after - before)  # Eq. 8
            n /= np.hypot(*n)
            hits = shapely.get_coordinates(shapely.LineString([node, node + 10 * n]).intersection(other))
            depth = np.hypot(*(hits - node).T).min() if len(hits) else 0.0  # Eq. 9
            tributary = 0.5 * (np.hypot(*(node - before)) + np.hypot(*(after - node)))  # Eq. 11
            total += tributary * depth**q * n  # Eq. 10 with 12
        forces.append(total / np.hypot(*total) if total.any() else total)  # Eq. 13, 14
    contact = forces[0] - forces[1]
    return contact / np.hypot(*contact)


@pytest.mark.parametrize("q", [0.0, 0.5, 1.0, 2.0])
@pytest.mark.parametrize("corners", [(3, 7), (8, 40)], ids=["clipped", "general"])
def test_nodal_direction_is_algorithm_2(kernel: Any, q: float, corners: tuple[int, int]) -> None:
    rng = np.random.default_rng([10, *corners])
    tried = 0
    for _ in range(150):
        a, b = (
            ra.Outline(radial(rng, int(rng.integers(*corners)), rng.choice([0.0, 0.2]))) for _ in range(2)
        )
        place = (
            *(rng.uniform(1.2, 1.9) * np.array([np.cos(t := rng.uniform(0, 6)), np.sin(t)])),
            rng.uniform(0, 6),
        )
        turn = np.array([[np.cos(place[2]), np.sin(place[2])], [-np.sin(place[2]), np.cos(place[2])]])
        placed = shapely.Polygon(b.rings[0] @ turn + place[:2])
        arcs = arc_inside(a.polygon, placed), arc_inside(placed, a.polygon)
        regions = kernel.polygons(a, (0, 0, 0), b, place)
        if len(regions) != 1 or any(arc is None or len(arc) < 3 for arc in arcs):
            continue  # Algorithm 2 speaks of one region, two crossings, and nodes of both bodies inside
        tried += 1
        polygon, label = regions[0]
        direction = kernel.direction.nodal_direction(polygon, label, 0, len(polygon), q)
        # F_contact acts on the slave, A: the direction from A to B is its opposite. 1e-9: a node that GEOS's
        # crossing and ours see half an ulp apart, weighted like any other
        assert np.allclose(direction, -algorithm_2(*arcs, q), atol=1e-9)
    assert tried >= 15


def disc(n: int, radius: float = 1.0) -> Any:
    t = 2 * np.pi * (np.arange(n) + 0.5) / n
    return ra.Outline(radius * np.stack([np.cos(t), np.sin(t)], axis=1))


@pytest.mark.parametrize("q", [0.0, 0.5, 1.0, 3.0])
def test_nodal_direction_of_symmetric_contacts(kernel: Any, q: float) -> None:
    """Disc on a floor, disc on disc, corner in a floor: along the line of symmetry, and turned with the scene."""
    floor = ra.Outline([(-5, -1), (5, -1), (5, 0), (2, 0), (0.4, 0), (-0.4, 0), (-2, 0), (-5, 0)])
    corner = ra.Outline([(-1, 1), (0, 0), (1, 1)])
    for a, b, y in ((disc(64), floor, -0.95), (disc(64), disc(64, 0.5), -1.45), (corner, floor, 0.1)):
        for angle in (0.0, 0.7, 3.0):
            place = (-y * math.sin(angle), y * math.cos(angle), angle)
            [(polygon, label)] = kernel.polygons(a, (0, 0, angle), b, place)
            # in A's axes, which turn with the scene
            assert np.allclose(
                kernel.direction.nodal_direction(polygon, label, 0, len(polygon), q), (0, -1), atol=1e-9
            )


def test_nodal_direction_depends_on_q(kernel: Any) -> None:
    """The deeper nodes count for more, the larger q: the direction turns to the normal of the deep side."""
    blade = ra.Outline([(-2, 2), (-1.0, -0.5), (-0.8, -0.62), (-0.6, -0.65), (1.5, -0.1), (2, 2)])
    floor = ra.Outline([(-5, -2), (5, -2), (5, 0), (-5, 0)])
    [(polygon, label)] = kernel.polygons(blade, (0, 0, 0), floor, (0, 0, 0))
    angles = [
        math.atan2(*kernel.direction.nodal_direction(polygon, label, 0, len(polygon), q)[::-1])
        for q in (0, 1, 4)
    ]
    assert angles[0] != angles[1] != angles[2]
    assert (angles[0] < angles[1] < angles[2]) or (angles[0] > angles[1] > angles[2])


def test_nodal_direction_tends_to_the_chord(kernel: Any) -> None:
    """For q = 0 the sum of Eq. 13 is the integral of the normal: with finer sampling the chord's, to first order."""
    wedge = ra.Outline([(-3, -3), (3, -3), (3, 0.3), (-3, -0.2)])
    counts, errors = [32, 64, 128, 256, 512, 1024], []
    for n in counts:
        found = kernel.one(disc(n), (0, 0, 0.1), wedge, (0, -0.7, 0.0))
        [(polygon, label)] = kernel.polygons(disc(n), (0, 0, 0.1), wedge, (0, -0.7, 0.0))
        chord = kernel.direction.chord_direction(*found.chord[0], found.area[0])
        turn = np.array([[math.cos(0.1), math.sin(0.1)], [-math.sin(0.1), math.cos(0.1)]])
        nodal = np.array(kernel.direction.nodal_direction(polygon, label, 0, len(polygon), 0.0)) @ turn
        errors.append(abs(nodal[0] * chord[1] - nodal[1] * chord[0]))
    # first order, unevenly: an arc's two ends, nearer to a crossing than half an edge or not, belong to no node
    assert -1.3 < np.polyfit(np.log(counts), np.log(errors), 1)[0] < -0.6


def test_no_direction_without_a_chord(kernel: Any) -> None:
    assert kernel.direction.chord_direction(0.0, 0.0, 1.0) == (0.0, 0.0)
    assert kernel.direction.chord_direction(0.0, -2.0, 1.0) == (-1.0, 0.0)
    small, large = disc(12, 0.1), disc(40)
    [(polygon, label)] = kernel.polygons(small, (0, 0, 0), large, (0.2, 0, 0))
    assert np.allclose(
        kernel.direction.nodal_direction(polygon, label, 0, len(polygon), 0.5), (0, 0), atol=1e-12
    )


# --- restitution ---

ASKED = [0.1, 0.2, 0.35, 0.5, 0.65, 0.8, 0.9, 0.99, 1.0]


@pytest.mark.parametrize("e", [0.05, *ASKED[:-1], 0.999])
def test_restitution_damping_solves_its_equation(kernel: Any, e: float) -> None:
    """alpha (1 + e) = ln[(1 + alpha) / (1 - alpha e)], docs/theory.md 5; by Brent's method, away from the root at 0."""

    def equation(alpha: float) -> float:
        return math.log1p(alpha) - math.log1p(-alpha * e) - alpha * (1 + e)

    # near 0 the equation's left side is -(1 - e^2) alpha^2 / 2: negative up to 3 (1 - e^2) / 2 / (1 + e^3) and beyond
    alpha = brentq(equation, 0.5 * (1 - e * e), (1 - 1e-15) / e, xtol=1e-15, rtol=8.9e-16)
    assert kernel.impact.restitution_damping(e) == pytest.approx(alpha, rel=1e-10)


def test_no_damping_for_full_restitution(kernel: Any) -> None:
    assert kernel.impact.restitution_damping(1.0) == kernel.impact.restitution_damping(1.5) == 0.0
    assert kernel.impact.damping_ratio(1.0) == 0.0
    # towards e = 0 the root is 1 / e to rounding; below LEAST_RESTITUTION it stays
    least = kernel.impact.LEAST_RESTITUTION
    assert kernel.impact.restitution_damping(least) == pytest.approx(1 / least, rel=1e-12)
    assert kernel.impact.restitution_damping(0.0) == kernel.impact.restitution_damping(least)


def bounced(acceleration: Any) -> float:
    """Speed with which a unit mass that comes in with speed 1 at depth 0 leaves depth 0 again."""

    def leaves(_: float, y: np.ndarray) -> float:
        return float(y[0])

    leaves.terminal, leaves.direction = True, -1.0  # type: ignore[attr-defined]
    out = solve_ivp(
        lambda _, y: (y[1], acceleration(max(y[0], 0.0), y[1])),
        (0, 1e4), (1e-14, 1.0), method="DOP853", events=leaves, rtol=1e-11, atol=1e-13, max_step=0.05,
    )  # fmt: skip
    return -float(out.y_events[0][0][1])


@pytest.mark.parametrize("power", [1.0, 1.5, 2.0])
@pytest.mark.parametrize("e", ASKED)
def test_integrated_impact_returns_what_is_asked(kernel: Any, e: float, power: float) -> None:
    """Whatever the area does with depth; solve_ivp integrates, the kernel only gives alpha (v0 = 1, so a = alpha)."""
    alpha = kernel.impact.restitution_damping(e)
    assert bounced(lambda d, v: -(d**power) * (1 + alpha * v)) == pytest.approx(e, abs=1e-6)


@pytest.mark.parametrize("e", ASKED)
def test_damping_ratio_returns_what_is_asked(kernel: Any, e: float) -> None:
    """Half a period of the linear spring and dashpot (which may pull at its end), integrated."""
    zeta = kernel.impact.damping_ratio(e)
    assert bounced(lambda d, v: -d - 2 * zeta * v) == pytest.approx(e, abs=1e-6)
