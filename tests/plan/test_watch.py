"""While a plan runs: measured beside predicted, one warning each, a new plan without a jump."""

import warnings

import pymunk
import pytest

import rigidarea as ra
from rigidarea.plan.watch import Indicator, PlanWarning
from rigidarea.study.scene import get_scene
from rigidarea.study.user_space import space_of

G = 9.81


def pile(rows=4):
    space = pymunk.Space()
    space.gravity = 0, -G
    floor = pymunk.Segment(space.static_body, (-50, 0), (50, 0), 0)
    floor.friction = 0.6
    space.add(floor)
    for row in range(rows):
        for i in range(rows - row):
            add(space, (i + 0.5 * row, row + 0.5))
    return space


def add(space, at, mass=1.0, velocity=(0, 0)):
    body = pymunk.Body(mass, mass / 6)
    body.position, body.velocity = at, velocity
    box = pymunk.Poly.create_box(body, (1, 1))
    box.friction = 0.6
    space.add(body, box)
    return body


def watched(space, adapt=False, tolerance=0.01):
    made = ra.plan(space, tolerance, 5.0).override(level="rigid")
    made.apply()
    return made, made.watch(adapt)


def test_outgrown_is_a_factor():
    assert not Indicator(2.9, 1.0, "here").outgrown
    assert Indicator(3.1, 1.0, "here").outgrown


def test_a_pile_at_rest_keeps_to_its_plan():
    space = pile()
    _, watch = watched(space)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        watch.step(frames=60)
    found = watch.indicators
    assert set(found) == {"penetration", "phase", "load", "speed", "sweeps", "energy"}
    assert 0 < found["penetration"].measured <= 2 * found["penetration"].predicted
    assert 0 < found["load"].measured <= 4  # of a pile of four rows
    assert "box at (" in found["load"].where
    assert not watch.warned


def test_a_heavy_crate_is_warned_of_and_planned_for():
    """1,000 times as heavy, put a little above the pile: warned at once, and stiffer before it lands."""
    space = pile()
    made, watch = watched(space, adapt=True)
    watch.step(frames=10)
    before = made.steps, made.sweeps, made.penetration
    crate = add(space, (1.5, 4.8), mass=1000.0)
    with pytest.warns(PlanWarning, match=r"outgrown its plan: bodies of the space is 11, planned for 10"):
        watch.step(frames=1)
    assert made.steps * made.sweeps > before[0] * before[1] and made.penetration <= before[2]
    assert space.iterations == made.sweeps and ra.attached(space).penetration == made.penetration
    assert crate.position.y < 4.8


def test_planning_anew_leaves_the_state():
    space = pile()
    made, watch = watched(space)
    watch.step(frames=30)
    contact = ra.attached(space)
    state = [(*b.position, *b.velocity, b.angle) for b in space.bodies]
    energy = contact.energy()
    made.overrides[None]["steps"] = 16
    made.again(keep=True)
    made.apply()
    assert made.steps == 16 and ra.attached(space) is contact
    assert [(*b.position, *b.velocity, b.angle) for b in space.bodies] == state
    assert contact.energy() == energy
    made.step(frames=1)
    assert (
        abs(contact.energy() - energy) < 0.01 * 10 * G
    )  # 1 % of what its bodies would get in falling by a side


def test_a_drive_that_speeds_up():
    """What comes round faster strikes harder what it strikes: warned of once, and planned for."""
    space = pymunk.Space()
    wheel = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
    wheel.angular_velocity = 1.0
    space.add(wheel, pymunk.Poly.create_box(wheel, (2.0, 0.2)))
    add(space, (0.2, 1.2))
    made, watch = watched(space, adapt=True)
    watch.step(frames=5)
    before = made.steps
    wheel.angular_velocity = 10.0
    with pytest.warns(PlanWarning, match=r"speed of box at \(0, 0\)") as told:
        watch.step(frames=3)
    assert len(told) == 1  # once
    assert made.steps > before


def test_each_indicator_warns_once():
    space = pile(1)
    _, watch = watched(space)
    watch.step(frames=5)
    next(iter(space.bodies)).velocity = 0, 300
    with pytest.warns(PlanWarning) as told:
        watch.step(frames=5)
    assert [str(each.message).count("speed of") for each in told].count(1) == 1


def test_energy_from_nowhere():
    space = pile(2)
    _, watch = watched(space)
    watch.step(frames=10)
    for body in space.bodies:
        body.position += 0, 2.0  # lifted by hand
    with pytest.warns(PlanWarning, match="energy of the space"):
        watch.step(frames=1)


def test_penetration_is_set_between_frames():
    """What rests keeps its stiffness in that frame; it grows to what the new penetration asks for."""
    space = pile(1)
    contact = ra.attach(space, penetration=1e-3)
    contact.step(1 / 60, 60)
    before, energy = contact.regions["stiffness"][0], contact.energy()
    contact.penetration = 1e-4
    assert contact.penetration == 1e-4 and contact.regions["stiffness"][0] == before
    assert contact.energy() == energy
    contact.step(1 / 60, 300)
    assert contact.regions["stiffness"][0] == pytest.approx(10 * before, rel=0.1)
    with pytest.raises(ValueError, match="penetration"):
        contact.penetration = 0.0
    assert contact.penetration == 1e-4


@pytest.mark.slow
@pytest.mark.parametrize("drop", [0.3, 1.0])
def test_a_heavy_crate_lands_within_the_tolerance_again(drop):
    """1,000 times as heavy as what it falls on: warned within 3 frames; ten after it has landed nothing is deeper than
    the tolerance; planning anew takes and gives no energy."""
    space = pile()
    made, watch = watched(space, adapt=True)
    watch.step(frames=30)
    crate = add(space, (1.5, 4.5 + drop), mass=1000.0)
    contact = ra.attached(space)
    landed, warned, frame = None, None, 0
    deep = []
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        while landed is None or frame < landed + 20:
            frame += 1
            made.step()
            before = contact.energy()
            watch.look()
            assert contact.energy() == before
            warned = warned or (frame if told else None)
            if landed is None and any(crate in (r["body_a"], r["body_b"]) for r in contact.regions):
                landed = frame
            elif landed is not None and frame > landed + 10:
                deep.append(watch.indicators["penetration"].measured)
    assert warned is not None and warned <= 3
    assert max(deep) <= made.tolerance


@pytest.mark.slow
def test_a_pair_of_gears_whose_drive_speeds_up():
    """Tenfold: warned within 3 frames, within the tolerance again within 10; no energy comes or goes in planning."""
    space, (driver, driven) = space_of(get_scene("gears"))
    made = ra.plan(space, 0.01, 2.0)
    made.apply()
    watch = made.watch(adapt=True)
    watch.step(frames=30)
    driver.angular_velocity *= 10.0
    exact = -driver.angular_velocity * 20 / 30
    contact = ra.attached(space)
    errors, warned = [], None
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        for frame in range(1, 61):
            made.step()
            before = contact.energy()
            watch.look()
            assert contact.energy() == before
            warned = warned or (frame if told else None)
            errors.append(abs(driven.angular_velocity / exact - 1.0))
    assert warned is not None and warned <= 3
    later = [error * error for error in errors[10:]]  # root mean square, as the study has a drive's error
    assert (sum(later) / len(later)) ** 0.5 <= made.tolerance
