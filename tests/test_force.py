"""Force of one region: direction after the paper's Algorithm 2, restitution, damping, friction, one term at a time."""

from __future__ import annotations

import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st
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
    """alpha (1 + e) = ln[(1 + alpha) / (1 - alpha e)], design 2.4; by Brent's method, away from the root at 0."""

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


# --- the force of a region, one term at a time ---

STILL = dict(x=0.0, y=0.0, vx=0.0, vy=0.0, w=0.0, inverse_mass=0.0, inverse_moment=0.0)


def contact(kernel: Any, **changes: Any) -> SimpleNamespace:
    """A region (A above B, direction down) between two bodies; every number can be changed by name."""
    force = kernel.force
    region = np.zeros(1, kernel.region.REGION)
    region["next"] = -1
    fields = dict(area=0.02, x=0.3, y=-0.1, nx=0.0, ny=-1.0, chord=0.5)
    for name in [n for n in changes if n in kernel.region.REGION.names and n != "friction"]:
        fields[name] = changes.pop(name)
    for name, value in fields.items():
        region[name] = value
    law = kernel.region.Law(1e4, kernel.region.LAW_AREA, 1.0, kernel.region.CHORD, 0.5, 0.05)
    law = law._replace(**{n: changes.pop(n) for n in list(changes) if n in law._fields})
    a = kernel.region.Motion(**STILL)._replace(inverse_mass=0.5, inverse_moment=2.0, **changes.pop("a", {}))
    b = kernel.region.Motion(**STILL)._replace(y=-1.0, **changes.pop("b", {}))
    args = dict(friction=0.0, elasticity=1.0, surface_x=0.0, surface_y=0.0, dt=1e-9, born=False) | changes
    pull = force.region_force(region[0], law, a, b, *args.values())
    return SimpleNamespace(pull=pull, region=region[0], row=region, law=law, a=a, b=b)


@pytest.mark.parametrize("resting", [0, 1])
def test_elastic_force_is_k_times_area(kernel: Any, resting: int) -> None:
    """Eq. 5, at the region's point: on B down, on A up, no more and no less than k A, at rest."""
    got = contact(kernel, resting=resting, first_speed=1.0)  # an impact at its turning point
    assert got.region["force"] == pytest.approx(1e4 * 0.02, rel=1e-12)
    assert np.allclose(got.pull[:2], (0, -200))
    assert got.pull.moment_b == pytest.approx(0.3 * -200)
    assert got.pull.moment_a == pytest.approx(0.3 * 200)
    assert got.region["rate2"] == pytest.approx(1e4 * 0.5 * (0.5 + 0.3**2 * 2.0))


def test_energy_law_is_the_gradient_of_its_energy(kernel: Any) -> None:
    """U = k A^2 / (2 l), so F = dU/d(depth) = k A L / l with dA/d(depth) = L."""
    got = contact(kernel, law=kernel.region.LAW_ENERGY, length=0.25, resting=1)
    assert got.region["force"] == pytest.approx(1e4 * 0.02 * 0.5 / 0.25)


def test_impact_damping(kernel: Any) -> None:
    """F = k A (1 + a speed), a = alpha / v0 fixed at first touch; A falls on B with speed 2."""
    falls = dict(vy=-2.0)
    born = contact(kernel, a=falls, elasticity=0.5, born=True)
    alpha = kernel.impact.restitution_damping(0.5)
    assert born.region["first_speed"] == 2.0 and born.region["resting"] == 0
    assert born.region["force"] == pytest.approx(200 * (1 + alpha), rel=1e-6)
    # slower later, the same a
    later = contact(
        kernel, a=dict(vy=-0.5), elasticity=0.5, damping=float(born.region["damping"]), first_speed=2.0
    )
    assert later.region["force"] == pytest.approx(200 * (1 + alpha * 0.25), rel=1e-6)


def test_slow_touch_rests_from_the_start(kernel: Any) -> None:
    assert contact(kernel, a=dict(vy=-0.04), born=True).region["resting"] == 1
    assert contact(kernel, a=dict(vy=-0.06), born=True).region["resting"] == 0
    assert contact(kernel, a=dict(vy=-2.0), phase=1e3).region["resting"] == 1


@pytest.mark.parametrize("e", [0.0, 0.3, 0.7, 1.0])
def test_resting_dashpot(kernel: Any, e: float) -> None:
    """k A + c speed with c = 2 zeta sqrt(k L m_eff); against the oscillator's textbook formula."""
    got = contact(kernel, a=dict(vy=-0.01), x=0.0, elasticity=e, resting=1)
    c = 2 * kernel.impact.damping_ratio(e) * math.sqrt(1e4 * 0.5 * 2.0)
    assert got.region["force"] == pytest.approx(200 + c * 0.01, rel=1e-6)


def test_a_dashpot_never_reverses_the_speed_within_a_step(kernel: Any) -> None:
    """However long the step: the dashpot's impulse alone at most stops the bodies."""
    for dt in (1e-4, 1e-2, 1.0, 100.0):
        got = contact(kernel, a=dict(vy=-0.04), x=0.0, elasticity=0.01, resting=1, dt=dt, followed=math.inf)
        impulse = (got.region["force"] - 200) * dt
        assert 0 < impulse * 0.5 <= 0.04 * (1 + 1e-9)


def test_couple_of_a_resting_face(kernel: Any) -> None:
    """Against the turning of one straight face on the other, at most F L / 6; none on curves, none in an impact."""

    def couple(w: float, straight: float = 0.5, resting: int = 1) -> float:
        got = contact(kernel, a=dict(w=w), x=0.0, resting=resting, elasticity=0.5, straight=straight)
        return float(got.region["couple"])

    assert couple(0.0) == 0 and couple(1e3) == -couple(-1e3) and couple(1e-3) == -couple(-1e-3)
    assert couple(1e3) == pytest.approx(200 * 0.5 / 6)  # more would need the pressure to pull at one end
    c = 2 * kernel.impact.damping_ratio(0.5) * math.sqrt(1e4 * 0.5 / 0.5)
    # a bed of dashpots, c in all, spread over the chord: second moment of its straight stretch
    assert couple(1e-3) == pytest.approx(c * 0.5**2 / 12 * 1e-3, rel=1e-6)
    assert couple(1e-3, straight=0.25) == pytest.approx(c / 0.5 * 0.25**3 / 12 * 1e-3, rel=1e-6)
    assert couple(1e3, straight=0.0) == 0
    assert couple(1e3, resting=0) == 0


def test_friction_spring_then_cap(kernel: Any) -> None:
    """Stick: the spring's force grows by k_t slip dt a step. Slide: mu F, against the slip of A over B."""
    kt = kernel.force.TANGENT_STIFFNESS * 1e4 * 0.5
    stick = contact(kernel, a=dict(vx=1e-3), x=0.0, friction=0.4, resting=1, dt=1e-3)
    t = (1.0, 0.0)  # t = (-n_y, n_x)
    assert stick.region["slip"] == pytest.approx(1e-3)
    assert stick.region["spring"] == pytest.approx(kt * 1e-3 * 1e-3)
    assert 0 < stick.pull.fx * t[0] < 0.4 * 200
    for speed in (10.0, -10.0):
        slide = contact(kernel, a=dict(vx=speed), x=0.0, friction=0.4, resting=1, dt=1e-3)
        assert slide.pull.fx == pytest.approx(math.copysign(0.4 * slide.region["force"], speed))
    again = contact(kernel, x=0.0, friction=0.4, resting=1, dt=1e-3, spring=30.0, tangent_stiffness=kt)
    assert again.pull.fx == pytest.approx(30.0)  # holds at rest, for ever
    half = contact(kernel, x=0.0, friction=0.4, resting=1, dt=1e-3, spring=30.0, tangent_stiffness=2 * kt)
    assert half.pull.fx == pytest.approx(15.0)  # the region has shrunk to half: so has the spring's force
    assert contact(kernel, a=dict(vx=10.0), friction=0.0, resting=1).pull.fx == 0


def test_surface_velocity_shifts_the_slip(kernel: Any) -> None:
    """A surface that runs with the slip sees none; one that runs alone drags."""
    kwargs: dict[str, Any] = dict(x=0.0, friction=0.4, resting=1, dt=1e-3)
    none = contact(kernel, a=dict(vx=1.5), surface_x=1.5, **kwargs)
    assert none.region["slip"] == 0 and none.pull.fx == 0
    drags, slides = contact(kernel, surface_x=-1.5, **kwargs), contact(kernel, a=dict(vx=1.5), **kwargs)
    assert drags.pull == slides.pull
    assert contact(kernel, surface_y=7.0, **kwargs).pull.fx == 0  # along the normal: nothing


@pytest.mark.parametrize("power", [1.0, 1.5, 2.0])
@pytest.mark.parametrize("e", [0.2, 0.5, 0.8, 1.0])
def test_stepped_impact_converges_to_what_is_asked(kernel: Any, e: float, power: float) -> None:
    """Symplectic Euler with this force: the restitution's error falls at least in proportion to the step."""
    force = kernel.force
    errors = []
    steps = [1e-3, 5e-4, 2.5e-4]
    for dt in steps:
        region = np.zeros(1, kernel.region.REGION)
        law = kernel.region.Law(1e4, kernel.region.LAW_AREA, 1.0, kernel.region.CHORD, 0.5, 0.0)
        b = kernel.region.Motion(**STILL)
        depth, v, born = -0.37 * dt, 1.0, True
        for _ in range(20000):
            depth += v * dt
            if depth <= 0:
                if v < 0:
                    break
                continue
            region["area"], region["chord"] = depth**power, power * depth ** (power - 1)
            region["ny"] = -1.0
            a = kernel.region.Motion(0.0, 0.0, 0.0, -v, 0.0, 1.0, 0.0)
            pull = force.region_force(region[0], law, a, b, 0.0, e, 0.0, 0.0, dt, born)
            born = False
            v += pull.fy * dt  # the force on B, downwards; on A upwards
        errors.append(abs(-v - e))
    assert errors[-1] <= 2e-3
    assert errors[-1] <= 0.7 * errors[0] or errors[-1] <= 2e-4


# --- random states ---

number = st.floats(-10, 10, allow_subnormal=False)
positive = st.floats(1e-3, 10)
motions = st.builds(
    lambda *v: dict(zip(("x", "y", "vx", "vy", "w", "inverse_mass", "inverse_moment"), v)),
    *[number] * 5,
    positive,
    positive,
)
regions = st.fixed_dictionaries(
    dict(
        area=st.floats(1e-12, 1), x=number, y=number, chord=st.floats(1e-6, 3), spring=number, damping=positive,
        tangent_stiffness=positive, phase=st.floats(0, 100), first_speed=positive,
        speed=number, straight=st.floats(0, 3),
        resting=st.integers(0, 1), opened=st.integers(0, 1), alone=st.integers(0, 1), curved=st.integers(0, 1),
    )
)  # fmt: skip
scenes = st.fixed_dictionaries(
    dict(
        friction=st.floats(0, 2), elasticity=st.floats(0, 1.2), surface_x=number, surface_y=number,
        dt=st.floats(1e-5, 1), born=st.booleans(), stiffness=st.floats(1, 1e8), law=st.integers(0, 1),
    )
)  # fmt: skip


def scene(kernel: Any, a: Any, b: Any, region: Any, args: Any, angle: float) -> SimpleNamespace:
    force = kernel.force
    row = np.zeros(1, kernel.region.REGION)
    for name, value in (region | dict(nx=math.cos(angle), ny=math.sin(angle))).items():
        row[name] = value
    law = kernel.region.Law(args["stiffness"], args["law"], 0.7, kernel.region.CHORD, 0.5, 0.01)
    rest = [args[n] for n in ("friction", "elasticity", "surface_x", "surface_y", "dt", "born")]
    pull = force.region_force(row[0], law, kernel.region.Motion(**a), kernel.region.Motion(**b), *rest)
    return SimpleNamespace(pull=np.array(pull), region=row[0])


@given(motions, motions, regions, scenes, st.floats(0, 6.3))
def test_no_force_pulls_and_every_cap_holds(
    kernel: Any, a: Any, b: Any, region: Any, args: Any, angle: float
) -> None:
    got = scene(kernel, a, b, region, args, angle)
    r = got.region
    assert np.isfinite(got.pull).all()
    assert r["force"] >= 0
    assert got.pull[0] * r["nx"] + got.pull[1] * r["ny"] >= -1e-9 * (1 + np.hypot(*got.pull[:2]))
    assert abs(r["friction"]) <= args["friction"] * r["force"] * (1 + 1e-12)
    assert abs(r["spring"]) <= args["friction"] * r["force"] * (1 + 1e-12) or args["friction"] == 0
    share = 3 if r["alone"] else 6  # see region_force and _implicit_rest
    assert abs(r["couple"]) <= r["force"] * r["chord"] / share * (1 + 1e-12)


@given(motions, motions, regions, scenes, st.floats(0, 6.3))
def test_action_is_reaction(kernel: Any, a: Any, b: Any, region: Any, args: Any, angle: float) -> None:
    """Forces are opposite by construction; the moments of both about any point cancel too."""
    fx, fy, moment_a, moment_b = scene(kernel, a, b, region, args, angle).pull
    total = moment_a - (a["x"] * fy - a["y"] * fx) + moment_b + (b["x"] * fy - b["y"] * fx)
    assert abs(total) <= 1e-12 * (1 + 100 * (abs(fx) + abs(fy)))


@given(motions, motions, regions, scenes, st.floats(0, 6.3))
def test_a_and_b_are_alike(kernel: Any, a: Any, b: Any, region: Any, args: Any, angle: float) -> None:
    """Exchanged, with the direction reversed: the same force the other way round."""
    one = scene(kernel, a, b, region, args, angle)
    other_args = args | dict(surface_x=-args["surface_x"], surface_y=-args["surface_y"])
    two = scene(kernel, b, a, region, other_args, angle + math.pi)
    scale = 1 + np.abs(one.pull).max()
    # a speed within rounding of 0 or of the rest speed may go either way
    if one.region["resting"] == two.region["resting"] and one.region["opened"] == two.region["opened"]:
        assert np.allclose(
            two.pull, [-one.pull[0], -one.pull[1], one.pull[3], one.pull[2]], atol=1e-6 * scale
        )


@given(motions, motions, regions, scenes, st.floats(0, 6.3), st.floats(-10, 10), st.floats(0, 6.3))
def test_same_force_in_any_frame(
    kernel: Any, a: Any, b: Any, region: Any, args: Any, angle: float, drift: float, turn: float
) -> None:
    """Turned, shifted and seen from a moving frame."""
    c, s = math.cos(turn), math.sin(turn)

    def turned(x: float, y: float) -> tuple[float, float]:
        return c * x - s * y, s * x + c * y

    def there(body: Any) -> Any:
        (x, y), (vx, vy) = turned(body["x"], body["y"]), turned(body["vx"], body["vy"])
        return body | dict(x=x + drift, y=y - drift, vx=vx + drift, vy=vy + 0.5 * drift)

    one = scene(kernel, a, b, region, args, angle)
    x, y = turned(region["x"], region["y"])
    sx, sy = turned(args["surface_x"], args["surface_y"])
    moved = region | dict(x=x + drift, y=y - drift)
    two = scene(kernel, there(a), there(b), moved, args | dict(surface_x=sx, surface_y=sy), angle + turn)
    if one.region["resting"] == two.region["resting"] and one.region["opened"] == two.region["opened"]:
        want = [*turned(*one.pull[:2]), *one.pull[2:]]
        assert np.allclose(two.pull, want, atol=1e-6 * (1 + np.abs(one.pull).max()))
