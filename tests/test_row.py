"""One row of the solve against closed forms: its limits, the bed of two ends, friction, impacts; its stiffness."""

from __future__ import annotations

import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

# --- one row of the solve, against closed forms ---


def body(kernel: Any, **fields: float) -> Any:
    made = np.zeros(1, kernel.dtypes.BODY)
    for name, value in (dict(extent=1e9) | fields).items():
        made[name] = value
    return made[0]


def row_of(kernel: Any, a: Any, b: Any, h: float, **changes: Any) -> SimpleNamespace:
    """A row between two bodies: region, pair and law as given by name, arms from where the bodies are."""
    tables = kernel.tables
    r = np.zeros(1, kernel.dtypes.REGION)
    pair = np.zeros(1, kernel.dtypes.PAIR)
    law = tables.Law(1e4, 2e-4, 10.0, tables.LAW_AREA, 1.0, tables.CHORD, 0.5, 0.0, kernel.constants.FOLLOWED)
    law = law._replace(**{n: changes.pop(n) for n in list(changes) if n in ("followed", "law", "length")})
    for name in ("friction", "elasticity", "surface_x", "surface_y"):
        pair[name] = changes.pop(name, 1.0 if name == "elasticity" else 0.0)
    fields = dict(area=0.02, depth=DEPTH, chord=0.5, nx=0.0, ny=-1.0, stiffness=1e4, step=h) | changes
    for name, value in fields.items():
        r[name] = value
    r = r[0]
    tx, ty = -r["ny"], r["nx"]
    for side, one in (("a", a), ("b", b)):
        x, y = r["x"] - one["x"], r["y"] - one["y"]
        r[f"arm_{side}"] = x * r["ny"] - y * r["nx"]
        r[f"lean_{side}"] = x * ty - y * tx
    row = np.zeros(1, kernel.dtypes.ROW)[0]
    kernel.row.make_row(row, r, law, a, b, pair[0], h)
    return SimpleNamespace(row=row, region=r, law=law, pair=pair[0])


def closing(row: Any, a: Any, b: Any) -> float:
    normal = (a["vx"] - b["vx"]) * row["nx"] + (a["vy"] - b["vy"]) * row["ny"]
    return float(normal + a["w"] * row["arm_a"] - b["w"] * row["arm_b"])


def damping(kernel: Any, stiffness: float, inverse: float, h: float, e: float, followed: float) -> float:
    """C of the row, after its docstring: c + theta (1 + S) h k L."""
    phase2 = stiffness * inverse * h * h
    theta = max(0.0, 1.0 - (followed / phase2) ** 2) if phase2 > followed else 0.0
    c = 2.0 * kernel.impact.damping_ratio(e) * math.sqrt(stiffness / inverse)
    return c + theta * (1.0 + kernel.constants.RELEASE_STEPS) * h * stiffness


FOLLOWED = 0.05
DEPTH = 0.04  # of a row's region, unless it is said
speeds = st.floats(-10, 10, allow_subnormal=False)
places = st.floats(-2, 2, allow_subnormal=False)
inverses = st.floats(1e-2, 10)
bodies = st.fixed_dictionaries(
    dict(x=places, y=places, vx=speeds, vy=speeds, w=speeds, inverse_mass=inverses, inverse_moment=inverses)
)
contacts = st.fixed_dictionaries(
    dict(
        area=st.floats(1e-6, 1), chord=st.floats(1e-2, 3), x=places, y=places, stiffness=st.floats(1e1, 1e7),
        elasticity=st.floats(0, 1), friction=st.floats(0, 2), surface_x=speeds, surface_y=speeds,
        spring=speeds, tangent_stiffness=st.floats(0, 1e4),
    )
)  # fmt: skip
substeps = st.floats(1e-5, 0.1)
angles = st.floats(0, 6.3)


@given(bodies, bodies, contacts, substeps, angles)
def test_a_visit_solves_its_row(kernel: Any, a: Any, b: Any, c: Any, h: float, angle: float) -> None:
    """l = h (F0 + C v') with the speed v' that comes out, or l = 0 where that would pull."""
    a, b = body(kernel, **a), body(kernel, **b)
    c = c | dict(friction=0.0, nx=math.cos(angle), ny=math.sin(angle))
    row = row_of(kernel, a, b, h, **c).row
    row["l1"] = 0.0
    inverse = (
        a["inverse_mass"] + b["inverse_mass"]
        + row["arm_a"] ** 2 * a["inverse_moment"] + row["arm_b"] ** 2 * b["inverse_moment"]
    )  # fmt: skip
    force = c["stiffness"] * c["area"]
    slope = max(c["stiffness"] * c["chord"], force / DEPTH)  # no less than the secant
    damper = damping(kernel, slope, inverse, h, c["elasticity"], FOLLOWED)
    kernel.row.visit(row, a, b)
    asked = h * (force + damper * closing(row, a, b))
    # the speed after is a difference of nearly equal ones: rounding times h C
    rounding = 1e-12 * (1 + h * damper * 50)
    assert row["l1"] == pytest.approx(max(asked, 0.0), rel=1e-9, abs=rounding)
    assert asked <= row["l1"] + 1e-9 * abs(asked) + rounding


@given(
    arm=st.floats(-1, 1), lean=st.sampled_from([-1.0, 1.0]), slip=st.floats(-50, 50), speed=st.floats(-9, 9),
    friction=st.floats(0.1, 1), easily=st.floats(0, 6),
)  # fmt: skip
@example(arm=-0.73, lean=-1.0, slip=-24.0, speed=0.0, friction=0.5, easily=3.9)
@example(arm=0.74, lean=-1.0, slip=44.0, speed=-2.0, friction=0.8, easily=2.5)
def test_whatever_friction_does_a_visit_solves_its_normal(
    kernel: Any, arm: float, lean: float, slip: float, speed: float, friction: float, easily: float
) -> None:
    """The same with friction, of a body that turns easily: also where what slides would draw the two together.

    (Its normal force was then what it is where friction grips, and left any speed.)
    """
    a = body(kernel, x=arm, y=lean, vx=slip, vy=speed, inverse_mass=1.0, inverse_moment=10.0**easily)
    b = body(kernel)
    row = row_of(kernel, a, b, 1e-2, elasticity=0.0, friction=friction, straight=0.5).row
    row["l1"] = row["l2"] = row["lt"] = 0.0
    assert row["ends"] == 2
    most = abs(closing(row, a, b)) + abs(row["t1"]) + abs(row["t2"])
    kernel.row.visit(row, a, b)
    ends = np.array([row["l1"], row["l2"]])
    speeds = closing(row, a, b) - a["w"] * np.array([row["e1"], row["e2"]])
    bed = row["own"] * np.eye(2) + row["other"] * (1.0 - np.eye(2))
    missing = row["alpha"] * bed @ ([row["f1"], row["f2"]] - ends)
    left = missing + row["gamma"] * (speeds - [row["t1"], row["t2"]])
    # speeds after are differences of those before and of what the impulses change
    most += (row["w11"] + row["w22"]) * ends.max() + (abs(row["slip1"]) + abs(row["slip2"])) * abs(row["lt"])
    rounding = 1e-9 * (row["alpha"] * abs(bed).sum() * (row["f1"] + row["f2"]) + row["gamma"] * most)
    assert (left <= rounding).all()
    assert (abs(left[ends > 0.0]) <= rounding).all()


@pytest.mark.parametrize("speed", [-3.0, 0.0, 5.0])
def test_a_row_that_the_step_follows_is_k_times_area(kernel: Any, speed: float) -> None:
    """alpha = 1, gamma = 0: the explicit law, F = k A whatever the speed; by the energy law k A L / l."""
    for law, force in ((0, 200.0), (1, 200.0 * 0.5 / 0.25)):
        a, b = body(kernel, inverse_mass=0.5, vy=-speed), body(kernel)
        got = row_of(kernel, a, b, 1e-2, followed=math.inf, law=law, length=0.25)
        kernel.row.visit(got.row, a, b)
        assert (got.row["alpha"], got.row["gamma"]) == (1.0, 0.0)
        assert got.row["l1"] == pytest.approx(force * 1e-2, rel=1e-12)
        assert a["vy"] == pytest.approx(-speed + 0.5 * force * 1e-2, rel=1e-12)


@pytest.mark.parametrize("h", [1e-4, 1e-2, 1.0])
@pytest.mark.parametrize("k", [1e2, 1e5, 1e9])
@pytest.mark.parametrize("straight", [0.0, 0.5])
def test_at_rest_nothing_is_softened(kernel: Any, k: float, h: float, straight: float) -> None:
    """A = m g / k, the kick g h: the row gives it back, to rounding, whatever the step and the stiffness."""
    a, b = body(kernel, inverse_mass=0.5, inverse_moment=3.0, vy=-10 * h), body(kernel)
    got = row_of(
        kernel, a, b, h, area=20.0 / k, depth=40.0 / k, stiffness=k, elasticity=0.0, straight=straight
    )
    for _ in range(3):
        kernel.row.visit(got.row, a, b)
    assert got.row["l1"] + got.row["l2"] == pytest.approx(20 * h, rel=1e-10)
    assert abs(a["vy"]) <= 1e-10 * 10 * h and abs(a["w"]) <= 1e-10 * 10 * h


def test_a_put_overlap_opens_at_a_bounded_speed(kernel: Any) -> None:
    """At PUT_SPEED smallest extents a second, or in RELEASE_STEPS substeps, the slower of both (damping: 2e-3)."""
    for h in (1e-3, 1e-2, 1e-1, 10.0):
        a, b = body(kernel, inverse_mass=1.0, extent=0.3), body(kernel)
        got = row_of(kernel, a, b, h, stiffness=1e7, placed=1)
        kernel.row.visit(got.row, a, b)
        steps = got.region["area"] / got.region["chord"] / ((1.0 + kernel.constants.RELEASE_STEPS) * h)
        assert a["vy"] == pytest.approx(min(0.3 * kernel.constants.PUT_SPEED, steps), rel=2e-3)


@pytest.mark.parametrize("straight", [0.25, 0.3, 0.5])
def test_two_ends_are_a_bed(kernel: Any, straight: float) -> None:
    """Against turning C s^3 / 12 L, which of C = h k L is the bed's k s^3 / 12 (times h); k A at the centroid."""
    h, moment = 1e-2, 1e-3
    a, b = body(kernel, inverse_mass=0.5, inverse_moment=1 / moment, y=0.0, w=1e-3), body(kernel)
    got = row_of(kernel, a, b, h, stiffness=1e5, elasticity=0.0, straight=straight)
    row = got.row
    assert row["ends"] == 2 and row["e2"] - row["e1"] == pytest.approx(straight)
    assert row["f1"] * row["e1"] + row["f2"] * row["e2"] == pytest.approx(0.0, abs=1e-12)
    damper = damping(kernel, 1e5 * 0.5, 0.5, h, 0.0, FOLLOWED)
    kernel.row.visit(row, a, b)
    assert row["l1"] > 0 and row["l2"] > 0  # both ends press: it is linear
    turn = row["l1"] * row["e1"] + row["l2"] * row["e2"]
    assert turn == pytest.approx(-h * damper * straight**3 / (12 * 0.5) * a["w"], rel=1e-9)
    assert a["w"] == pytest.approx(1e-3 + turn / moment, rel=1e-9)


def test_a_facet_of_what_is_round_is_one_point(kernel: Any) -> None:
    """A straight stretch of less than half the chord resists no turning: so a disc of many facets rolls."""
    a, b = body(kernel, inverse_mass=0.5, inverse_moment=1e3, w=1e-3), body(kernel)
    row = row_of(kernel, a, b, 1e-2, stiffness=1e5, elasticity=0.0, straight=0.24).row
    kernel.row.visit(row, a, b)
    assert row["ends"] == 1 and row["l1"] > 0 and a["w"] == 1e-3


@given(bodies, bodies, contacts, substeps, angles, st.floats(0, 1), st.floats(-0.6, 0.6))
def test_every_bound_holds(
    kernel: Any, a: Any, b: Any, c: Any, h: float, angle: float, share: float, middle: float
) -> None:
    """Ends only push, so the resultant is within the face; friction within mu times it; momenta are kept."""
    a, b = body(kernel, **a), body(kernel, **b)
    c = c | dict(
        straight=share * c["chord"], middle=middle * c["chord"], nx=math.cos(angle), ny=math.sin(angle)
    )
    got = row_of(kernel, a, b, h, **c)
    row = got.row

    def momenta() -> np.ndarray:
        total = np.zeros(3)
        for one in (a, b):
            m = 1 / one["inverse_mass"]
            turning = m * (one["x"] * one["vy"] - one["y"] * one["vx"]) + one["w"] / one["inverse_moment"]
            total += m * one["vx"], m * one["vy"], turning
        return total

    before = momenta()
    given_most = h * c["stiffness"] * c["area"]
    for _ in range(4):
        kernel.row.visit(row, a, b)
        normal = row["l1"] + row["l2"]
        assert row["l1"] >= 0 and row["l2"] >= 0
        assert abs(row["lt"]) <= c["friction"] * normal * (1 + 1e-12)
    # 1e-11 of what has been exchanged and of what there was
    scale = 1 + np.abs(before).max() + 10 * (normal + given_most) * (1 + c["friction"])
    assert np.abs(momenta() - before).max() <= 1e-11 * scale
    kernel.row.settle(row, got.region, got.law, got.pair, a, b, h, True)
    r = got.region
    assert r["force"] == pytest.approx(normal / h)
    # subnormal numbers round as they like
    most = c["friction"] * r["force"] * (1 + 1e-12) + 1e-300
    assert abs(r["spring"]) <= most or c["friction"] == 0


def same(kernel: Any, one: Any, other: Any, turned: Any) -> None:
    """Impulses alike, up to rounding of what was exchanged."""
    scale = 1 + np.abs([one[n] for n in ("l1", "l2", "lt", "f1", "f2")]).max()
    for name in ("l1", "l2", "lt"):
        assert other[turned.get(name, name)] == pytest.approx(one[name], abs=1e-7 * scale)


@given(bodies, bodies, contacts, substeps, angles)
def test_a_and_b_are_alike(kernel: Any, a: Any, b: Any, c: Any, h: float, angle: float) -> None:
    """Exchanged, direction reversed, friction's along with it: the same impulses; the ends change places."""
    results = []
    for sign, first, second in ((1, a, b), (-1, b, a)):
        p, q = body(kernel, **first), body(kernel, **second)
        change = dict(nx=sign * math.cos(angle), ny=sign * math.sin(angle), straight=0.5 * c["chord"])
        change |= dict(surface_x=sign * c["surface_x"], surface_y=sign * c["surface_y"])
        row = row_of(kernel, p, q, h, **(c | change)).row
        for _ in range(2):
            kernel.row.visit(row, p, q)
        results.append(row)
    same(kernel, results[0], results[1], dict(l1="l2", l2="l1"))


@given(bodies, bodies, contacts, substeps, angles, st.floats(-10, 10), angles)
def test_same_impulses_in_any_frame(
    kernel: Any, a: Any, b: Any, c: Any, h: float, angle: float, drift: float, turn: float
) -> None:
    """Turned, shifted and seen from a moving frame."""
    co, si = math.cos(turn), math.sin(turn)

    def turned(x: float, y: float) -> tuple[float, float]:
        return co * x - si * y, si * x + co * y

    def there(one: Any) -> Any:
        (x, y), (vx, vy) = turned(one["x"], one["y"]), turned(one["vx"], one["vy"])
        return one | dict(x=x + drift, y=y - drift, vx=vx + drift, vy=vy + 0.5 * drift)

    (x, y), (sx, sy) = turned(c["x"], c["y"]), turned(c["surface_x"], c["surface_y"])
    moved = c | dict(x=x + drift, y=y - drift, surface_x=sx, surface_y=sy)
    results = []
    for p, q, there_c, at in ((a, b, c, angle), (there(a), there(b), moved, angle + turn)):
        p, q = body(kernel, **p), body(kernel, **q)
        change = dict(nx=math.cos(at), ny=math.sin(at), straight=0.5 * c["chord"])
        row = row_of(kernel, p, q, h, **(there_c | change)).row
        for _ in range(2):
            kernel.row.visit(row, p, q)
        results.append(row)
    same(kernel, results[0], results[1], {})


def test_friction_spring_then_cap(kernel: Any) -> None:
    """Sliding: mu F against the slip of A over B. Sticking: the spring holds what it has, and grows by k_t slip h."""
    h, kt = 1e-3, kernel.constants.TANGENT_STIFFNESS * 1e4 * 0.5
    for speed in (10.0, -10.0):
        a, b = body(kernel, inverse_mass=0.5, vx=speed), body(kernel)
        got = row_of(kernel, a, b, h, friction=0.4)
        kernel.row.visit(got.row, a, b)
        assert got.row["lt"] == pytest.approx(math.copysign(0.4 * got.row["l1"], speed))
        assert abs(a["vx"]) == pytest.approx(10 - 0.5 * abs(got.row["lt"]))
    a, b = body(kernel, inverse_mass=0.5), body(kernel)
    held = row_of(kernel, a, b, h, friction=0.4, spring=30.0, tangent_stiffness=kt)
    half = row_of(kernel, a, b, h, friction=0.4, spring=30.0, tangent_stiffness=2 * kt)
    # what it asks for: the spring's force, which shrinks with its region
    assert (held.row["ft"], half.row["ft"]) == pytest.approx((30.0 * h, 15.0 * h))
    a = body(kernel, inverse_mass=0.5, vx=1e-3)
    stick = row_of(kernel, a, b, h, friction=0.4)
    kernel.row.visit(stick.row, a, b)
    kernel.row.settle(stick.row, stick.region, stick.law, stick.pair, a, b, h, True)
    assert 0 < stick.row["lt"] < 0.4 * stick.row["l1"]
    assert stick.region["spring"] == pytest.approx(kt * h * a["vx"])


def test_surface_velocity_shifts_the_slip(kernel: Any) -> None:
    """A surface that runs with the slip sees none; one that runs alone drags."""

    def impulse(vx: float, **surface: float) -> float:
        a, b = body(kernel, inverse_mass=0.5, vx=vx), body(kernel)
        row = row_of(kernel, a, b, 1e-3, friction=0.4, **surface).row
        kernel.row.visit(row, a, b)
        return float(row["lt"])

    assert impulse(1.5, surface_x=1.5) == 0
    assert impulse(0.0, surface_x=-1.5) == impulse(1.5) != 0
    assert impulse(0.0, surface_y=7.0) == 0  # along the normal: nothing


# --- impacts ---


@given(bodies, bodies, contacts, substeps, angles)
def test_a_bounce_shorter_than_the_step(kernel: Any, a: Any, b: Any, c: Any, h: float, angle: float) -> None:
    """alpha = 0, a given speed: e times the closing speed comes back in one visit, whatever masses, k and step."""
    a, b = body(kernel, **a), body(kernel, **b)
    c = c | dict(friction=0.0, nx=math.cos(angle), ny=math.sin(angle), first_speed=1.0)
    row = row_of(kernel, a, b, h, mode=kernel.tables.STRUCK, **c).row
    speed = closing(row, a, b)
    kernel.row.visit(row, a, b)
    # 1e-11: the impulse goes through the effective mass, up to 1e2 of it
    expected = -c["elasticity"] * speed if speed > 0 else speed
    assert closing(row, a, b) == pytest.approx(expected, abs=1e-11)


@given(bodies, bodies, contacts, substeps, st.floats(0, 5))
def test_what_would_come_to_touch_is_let_come_so_far(
    kernel: Any, a: Any, b: Any, c: Any, h: float, speed: float
) -> None:
    """An overlap yet to come, in `back`: what is left of its gap may be closed in this substep, and no less."""
    a, b = body(kernel, **a), body(kernel, **b)
    ahead, rest = 0.01 + 0.1 * speed, 0.01
    changes = dict(friction=0.0, back=ahead, depth=0.04, rest_depth=rest, straight=0.0)
    row = row_of(kernel, a, b, h, mode=kernel.tables.NEARING, **(c | changes)).row
    before = closing(row, a, b)
    left = max(0.0, before * ahead - 0.04 + rest) / h  # what does not overlap yet is not asked to open
    kernel.row.visit(row, a, b)
    # 1e-11 of speeds of up to 1e2 over the step
    assert closing(row, a, b) == pytest.approx(min(before, left), abs=1e-11 * (1 + 1 / h))


@pytest.mark.parametrize("power", [1.0, 1.5, 2.0])
@pytest.mark.parametrize("e", [0.2, 0.5, 0.8, 1.0])
def test_stepped_impact_converges_to_what_is_asked(kernel: Any, e: float, power: float) -> None:
    """An impact that the steps follow: the restitution's error falls at least in proportion to the step."""
    errors = []
    for h in (1e-3, 5e-4, 2.5e-4):
        a, b = body(kernel, inverse_mass=1.0, vy=-1.0), body(kernel)
        depth, state = -0.37 * h, {}
        for _ in range(4000):
            depth -= a["vy"] * h
            if depth <= 0:
                if a["vy"] > 0:
                    break
                continue
            first = dict(born=1, first_speed=1.0, mode=kernel.tables.IMPACT) if not state else dict(born=0)
            shape = dict(area=depth**power, chord=power * depth ** (power - 1), depth=depth)
            got = row_of(kernel, a, b, h, elasticity=e, **(state | shape | first))
            kernel.row.push(got.row, a, b, got.row["l1"], 0.0, 0.0)  # the warm start: all of it is known
            kernel.row.visit(got.row, a, b)
            state = {n: got.region[n] for n in got.region.dtype.names}
        errors.append(abs(a["vy"] - e))
    assert errors[-1] <= 2e-3
    assert errors[-1] <= 0.7 * errors[0] or errors[-1] <= 2e-4


# --- stiffness ---


@pytest.mark.parametrize("law", [0, 1])
@given(depth=st.floats(1e-6, 0.1), k=st.floats(1e2, 1e8), n=st.sampled_from([1.0, 1.5, 2.0]))
def test_the_depth_that_bears_a_load(kernel: Any, law: int, depth: float, k: float, n: float) -> None:
    """Of a face, a disc and a corner (area as depth^n) under a k that is given: at that depth k A is the load."""
    rules = kernel.tables.Law(k, 2e-4, 10.0, law, 0.7, kernel.tables.CHORD, 0.5, 0.0, FOLLOWED)
    pair = np.zeros(1, kernel.dtypes.PAIR)[0]
    r = np.zeros(1, kernel.dtypes.REGION)[0]
    seen = 0.01
    r["area"], r["chord"], r["depth"] = 3.0 * seen**n, 3.0 * n * seen ** (n - 1), seen
    area, chord = 3.0 * depth**n, 3.0 * n * depth ** (n - 1)
    load = k * area if law == 0 else k * area * chord / 0.7
    assert kernel.stiffness.depth_for(rules, pair, r, load) == pytest.approx(depth, rel=1e-9)


def chosen(kernel: Any, **changes: Any) -> tuple[Any, Any, Any, Any]:
    """A law without a stiffness, two bodies of 20 N and 100 N, and their pair at first touch; a face of 0.5."""
    tables = kernel.tables
    law = tables.Law(0.0, 1e-3, 10.0, tables.LAW_AREA, 1.0, tables.CHORD, 0.5, 0.0, 0.0)._replace(**changes)
    a, b = body(kernel, inverse_mass=0.5, extent=0.4), body(kernel, inverse_mass=0.1, extent=2.0)
    pair = np.zeros(1, kernel.dtypes.PAIR)[0]
    kernel.stiffness.choose_stiffness(law, pair, 0.5, a, b, 1 / 60)
    return law, a, b, pair


@given(depth=st.floats(1e-7, 0.1), n=st.sampled_from([1.0, 1.5, 2.0]), tilt=st.floats(0, 1))
def test_whatever_lies_there_bears_its_load_at_the_depth_allowed(
    kernel: Any, depth: float, n: float, tilt: float
) -> None:
    """k A = rate x depth of a level face, a disc, a corner; of a tilted face the rate times its mean thickness."""
    law, _, _, pair = chosen(kernel)
    r = np.zeros(1, kernel.dtypes.REGION)[0]
    r["area"], r["chord"], r["depth"] = 3.0 * depth**n, 3.0 * n * depth ** (n - 1), depth
    pressed = depth
    if n == 1.0:  # a face, its two ends' depths as 1 to 1 - tilt
        r["straight"], r["area"] = 3.0, 3.0 * depth * (1.0 - 0.5 * tilt)
        pressed = depth * (1.0 - 0.5 * tilt)
    k = kernel.stiffness.stiffness_of(law, pair, r)
    assert k * r["area"] == pytest.approx(pair["rate"] * pressed, rel=1e-6)
    assert pair["rate"] * 1e-3 * 0.4 == pytest.approx(20.0)  # the lighter one's weight, at the depth allowed
    # an explicit step has a k with a potential: always the face's
    law = law._replace(followed=math.inf)
    assert kernel.stiffness.stiffness_of(law, pair, r) == pytest.approx(pair["rate"] / 0.5)


def test_a_given_stiffness_is_that_of_every_region(kernel: Any) -> None:
    law, _, _, pair = chosen(kernel, stiffness=77.0)
    r = np.zeros(1, kernel.dtypes.REGION)[0]
    assert kernel.stiffness.stiffness_of(law, pair, r) == 77.0
    assert pair["rate"] == 77.0 * 0.5


@pytest.mark.parametrize("lies", ["LIES", "FOLLOWS"])
def test_the_rate_follows_the_root_of_the_load(kernel: Any, lies: str) -> None:
    """m g over the depth allowed, then as the root of the averaged load; with a potential, never down again."""
    _, _, _, pair = chosen(kernel)
    depth = 1e-3 * 0.4
    assert pair["rate"] == pytest.approx(20.0 / depth)
    for force, want in ((200.0, 10.0**0.5), (0.0, 10.0**0.5 if lies == "LIES" else 1.0)):
        for _ in range(60 * 16):
            pair["carrying"], pair["lies"] = force / 60, getattr(kernel.tables, lies)
            kernel.stiffness.carry(pair, kernel.stiffness.bear(pair, 1 / 60, math.inf, False), force, depth)
        assert pair["load"] == pytest.approx(force, abs=1e-4)
        assert pair["rate"] == pytest.approx(want * 20.0 / depth, rel=1e-5)


def test_a_blow_changes_no_rate(kernel: Any) -> None:
    """Nor more than all that pushes: what is jammed presses as far as it is stiff."""
    _, _, _, pair = chosen(kernel)
    before = float(pair["rate"])
    pair["carrying"], pair["lies"] = 1e6, kernel.tables.BLOW
    kernel.stiffness.carry(pair, kernel.stiffness.bear(pair, 1 / 60, math.inf, False), 6e7, 4e-4)
    assert pair["rate"] == before and pair["carrying"] == 0.0
    for _ in range(60 * 8):
        pair["carrying"], pair["lies"] = 1e6, kernel.tables.FOLLOWS
        kernel.stiffness.carry(pair, kernel.stiffness.bear(pair, 1 / 60, 80.0, False), 80.0, 4e-4)
    assert pair["rate"] == pytest.approx(2.0 * before, rel=1e-3)
