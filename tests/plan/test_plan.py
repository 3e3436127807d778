"""A plan: it reads a space and changes nothing, says why, takes overrides, and makes it so."""

import math

import numpy as np
import pymunk
import pytest

import rigidarea as ra
from rigidarea.plan import elastic

G = 9.81


def ground(space, **more):
    floor = pymunk.Segment(space.static_body, (-50, 0), (50, 0), 0)
    floor.friction = more.get("friction", 0.6)
    floor.elasticity = more.get("elasticity", 0.0)
    space.add(floor)


def box(space, at, size=(1.0, 1.0), mass=1.0, angle=0.0, **more):
    body = pymunk.Body(mass, mass * (size[0] ** 2 + size[1] ** 2) / 12)
    body.position, body.angle = at, angle
    shape = pymunk.Poly.create_box(body, size)
    shape.friction, shape.elasticity = more.get("friction", 0.6), more.get("elasticity", 0.0)
    space.add(body, shape)
    return body


def stack(n=6, gravity=(0, -G)):
    space = pymunk.Space()
    space.gravity = gravity
    ground(space)
    return space, [box(space, (0, i + 0.5)) for i in range(n)]


def state(space):
    return [(*b.position, b.angle, *b.velocity, b.angular_velocity) for b in space.bodies], space.iterations


# --- what is found ---


def test_what_starts_overlapped_is_not_promised():
    from rigidarea.study.scene import get_scene
    from rigidarea.study.user_space import space_of

    scene = get_scene("parted")
    made = ra.plan(space_of(scene)[0], 0.001, scene.duration)
    assert any("deep: by this solve's own law" in reason for reason in made.unpromised)


def test_two_hits_in_a_row_arrive():
    """Equal discs hand on the blow: the last one goes on with it."""
    space = pymunk.Space()
    gap, speed = 0.02, 4.0
    for i in range(4):
        body = pymunk.Body(1, 1)
        body.position = i * (1 + gap) - (i == 0), 0
        body.velocity = (speed * (i == 0), 0)
        disc = pymunk.Circle(body, 0.5)
        disc.elasticity = 1.0
        space.add(body, disc)
    made = ra.plan(space, 0.01, 0.5).override(level="rigid")
    made.apply()
    made.step(frames=30)
    assert made.reachable and body.velocity.x == pytest.approx(speed, rel=0.01)


def test_what_is_out_of_reach_is_said_beforehand():
    space, _ = tilted()
    made = ra.plan(space, 1e-6, 2.0).override(steps=1, level="rigid")
    assert not made.reachable and made.error > 1e-6
    assert "no setting that was tried is within it" in str(made)


def test_a_tower_that_would_buckle_is_not_planned_soft():
    """Twelve boxes stand where a box sinks by no more than 0.65/n³ of its side; what is planned stands."""
    space, bodies = stack(12)
    bodies[-1].velocity = 0.02, 0.0  # so that it may buckle
    made = ra.plan(space, 0.1, 5.0).override(level="rigid")
    assert made.penetration <= 0.65 / 12**3
    made.apply()
    made.step(frames=300)
    assert all(abs(body.position.x) < 0.1 for body in bodies)


@pytest.mark.parametrize("ratio", [50.0, 1000.0])
def test_what_is_heavy_on_light_stands_as_planned(ratio):
    space = pymunk.Space()
    space.gravity = 0, -G
    ground(space)
    light = [box(space, (x, 0.5)) for x in (-0.75, 0.75)]
    heavy = box(space, (0.05, 1.5), (2.5, 1.0), mass=ratio)
    made = ra.plan(space, 0.01, 2.0)
    made.apply()
    made.step(frames=120)
    off = [
        math.dist(body.position, at)
        for body, at in zip((*light, heavy), ((-0.75, 0.5), (0.75, 0.5), (0.05, 1.5)))
    ]
    assert made.reachable and max(off) <= 0.01  # the tolerance, of a side


# --- the plan ---


def test_planning_changes_nothing():
    space, _ = stack()
    before = state(space), space.collision_slop
    str(ra.plan(space, 0.01, 5.0))
    assert (state(space), space.collision_slop) == before
    assert ra.attached(space) is None


def tilted():
    space = pymunk.Space()
    space.gravity = 0, -G
    ground(space)
    return space, [box(space, (0, 1.1), (0.4, 2.0), angle=0.1)]


@pytest.mark.parametrize("build", [stack, tilted])
def test_a_finer_tolerance_is_never_cheaper(build):
    costs = [ra.plan(build()[0], tolerance, 2.0).cost_s_per_s for tolerance in (0.1, 0.01, 0.001)]
    assert costs == sorted(costs)


@pytest.mark.parametrize("build", [stack, tilted])
def test_the_table_says_what_decided(build):
    space, _ = build()
    made = ra.plan(space, 0.01, 2.0)
    text = str(made)
    lines = made.lines
    assert f"{made.steps} x {made.sweeps} sweeps" in text or made.level == "pymunk"
    assert lines[0].what == "space" and lines[0].error == made.error
    assert "box at (" in text and "tried out: 2 s in" in text
    assert len(text.splitlines()) == len(lines) + 3 + len(made.unpromised)


def test_what_may_sleep_lies_flush_and_still():
    space, bodies = stack(3)
    flying = box(space, (5, 9))
    rolling = pymunk.Body(1, 1)
    rolling.position, rolling.velocity = (-5, 0.5), (-1, 0)  # away: it would push the lowest by 1.7 %
    space.add(rolling, pymunk.Circle(rolling, 0.5))
    assert set(ra.plan(space, 0.01).may_sleep) == set(bodies)
    bodies[2].velocity = 0.5, 0
    assert bodies[2] not in ra.plan(space, 0.01).may_sleep  # it slides, and stops
    assert flying not in ra.plan(space, 0.01).may_sleep


def test_overrides_hold_and_show():
    space, _ = stack()
    made = ra.plan(space, 0.01, 2.0).override(steps=7, penetration=1e-6)
    assert (made.steps, made.penetration) == (7, 1e-6)
    assert "yours: penetration, steps" in str(made)
    made.override(steps=None, penetration=None)
    assert "yours" not in str(made) and made.steps != 7
    made.override(level="pymunk")
    assert made.level == "pymunk" and made.apply() is None


def test_a_shape_sampled_as_asked():
    space = pymunk.Space()
    space.gravity = 0, -G
    gear = ra.shapes.involute_gear(module=0.1, teeth=20)
    body = gear.body(mass=1.0)
    body.angular_velocity = 1.0
    shape = gear.add_to(body)
    space.add(body, shape)
    made = ra.plan(space, 0.01, 1.0)
    assert shape in made.sampling and "sampled to" in str(made)
    made.override(shape, sampling=1e-3)
    assert made.sampling[shape] == 1e-3 and "1.0e-03 (yours)" in str(made)
    made.override(level="rigid").apply()
    assert len(shape.outline.rings[0]) == len(gear.sample(1e-3).rings[0]) < len(gear.rings[0])


@pytest.mark.parametrize(
    ("target", "settings", "message"),
    [
        (None, {"steps": 0}, "whole number from 1 to 1024, got 0"),
        (None, {"steps": 1.5}, "whole number from 1 to 1024, got 1.5"),
        (None, {"level": "modal"}, "'rigid', 'pymunk', got 'modal'"),
        (None, {"colour": 3}, "got 'colour'"),
        (None, {"penetration": -1.0}, "penetration"),
        ("body", {"level": "rigid"}, "one of steps to override"),
    ],
)
def test_bad_overrides_change_nothing(target, settings, message):
    space, bodies = stack()
    made = ra.plan(space, 0.01)
    before = made.steps, made.sweeps, made.penetration, made.level, dict(made.overrides)
    with pytest.raises(ValueError, match=message):
        made.override(bodies[0] if target else None, **settings)
    assert (made.steps, made.sweeps, made.penetration, made.level, made.overrides) == before


@pytest.mark.parametrize("bad", [{"tolerance": 0}, {"tolerance": math.nan}, {"seconds": -1}, {"frame": 0}])
def test_bad_settings(bad):
    space, _ = stack()
    with pytest.raises(ValueError, match=next(iter(bad))):
        ra.plan(space, **{"tolerance": 0.01, **bad})
    with pytest.raises(ValueError, match=r"pymunk\.Space"):
        ra.plan(None, 0.01)


def test_apply_makes_it_so_and_steps_by_it():
    space, bodies = stack()
    made = ra.plan(space, 0.01, 1.0).override(level="rigid")
    contact = made.apply()
    assert contact is ra.attached(space)
    assert space.iterations == made.sweeps and contact.penetration == made.penetration
    made.step(frames=60)
    moved = max(abs(body.position.y - (i + 0.5)) for i, body in enumerate(bodies))
    assert moved < 0.01  # the tolerance, of a side
    made.override(penetration=1e-6)
    assert made.apply() is contact and contact.penetration == 1e-6  # in the same state


def test_step_before_apply_says_so():
    space, _ = stack()
    with pytest.raises(RuntimeError, match="apply"):
        ra.plan(space, 0.001, 1.0).step()


def test_what_pymunk_is_enough_for():
    """A box that slides on a floor, at ten per cent: one step of Chipmunk's own; its slop is the plan's."""
    space = pymunk.Space()
    space.gravity = 0, -G
    ground(space, friction=0.3)
    body = box(space, (0, 0.5), friction=1.0)
    body.velocity = 6, 0
    made = ra.plan(space, 0.1, 2.0)
    assert made.level == "pymunk" and made.steps == 1
    assert made.apply() is None and ra.attached(space) is None
    assert 0 < space.collision_slop <= 0.1
    made.step(frames=120)
    exact = 6.0**2 / (2 * 0.3 * G)
    assert body.position.x == pytest.approx(exact, rel=0.1)


def test_an_outline_of_its_own_is_never_pymunks():
    space = pymunk.Space()
    space.gravity = 0, -G
    ell = ra.Outline([(0, 0), (4, 0), (4, 1), (1, 1), (1, 4), (0, 4)])
    body = ell.body(mass=1)
    space.add(body, ell.add_to(body))
    assert ra.plan(space, 0.1).level == "rigid"


# --- elastic bodies ---


def gears(spin=2.0, torque=None, bore=16e-3, load=60.0):
    space = pymunk.Space()
    pitch = [0.5 * 2e-3 * z for z in (23, 57)]
    made = []
    for z, kind in ((23, pymunk.Body.KINEMATIC), (57, pymunk.Body.DYNAMIC)):
        outline = ra.shapes.involute_gear(2e-3, z, bore=bore if z == 57 else 8e-3)
        body = outline.body(mass=1.0)
        body = body if kind == pymunk.Body.DYNAMIC else pymunk.Body(body_type=kind)
        body.position = (0, 0) if z == 23 else (sum(pitch), 0)
        body.angular_velocity = spin if z == 23 else -spin * 23 / 57
        space.add(body, outline.add_to(body))
        made.append(body)
    brake = pymunk.SimpleMotor(space.static_body, made[1], 0.0)
    brake.max_force = load
    space.add(brake, pymunk.PivotJoint(space.static_body, made[1], made[1].position))
    return space, made


def test_levels_of_gears():
    """The issue's three: rigid at 1 %, compliant below what the teeth bend, modal where the mesh meets the rim."""
    from rigidarea.flexible.element import Material

    steel = Material(207e9, 0.29, 7800.0, 0.05)
    space, bodies = gears()
    materials = dict.fromkeys(bodies, steel)
    made = ra.plan(space, 0.01, 1.0, materials=materials).override(stiffness=6e8)
    assert [choice.level for choice in made.elastic] == ["rigid", "rigid"]
    fine = ra.plan(space, 1e-5, 1.0, materials=materials).override(stiffness=2e11)
    assert {choice.level for choice in fine.elastic} == {"compliant"}
    # a thin rim, turned so fast that its teeth meet at the rim's own frequency
    thin, wheels = gears(bore=0.047)
    shape = elastic.shape_of(next(iter(wheels[1].shapes)).outline)
    first = elastic.first_frequency(shape, steel)
    wheels[1].angular_velocity = first / 57
    modal = ra.plan(thin, 1e-5, 1.0, materials={wheels[1]: steel}).override(stiffness=2e11)
    assert modal.elastic[0].level == "modal" and modal.elastic[0].modes >= 1
    for each in (made, fine, modal):
        for choice in each.elastic:
            assert choice.reason in str(each)
    modal.override(wheels[1], level="compliant")
    assert modal.elastic[0].level == "compliant" and "compliant (yours)" in str(modal)


@pytest.mark.slow
def test_what_bends_is_applied():
    """Two rubber gears under a brake: compliant parts after `apply`, their ratio kept within the tolerance."""
    from rigidarea.flexible import Material

    rubber = Material(5e7, 0.45, 1200.0, 0.05)
    space, bodies = gears(spin=3.0, load=10.0)
    made = ra.plan(space, 0.01, 0.5, materials=dict.fromkeys(bodies, rubber))
    assert [choice.level for choice in made.elastic] == ["compliant", "compliant"] and made.level == "rigid"
    contact = made.apply()
    assembly = contact._settings["flexible"]
    assert assembly is not None and made.apply() is contact  # once
    made.step(frames=10)  # through the backlash
    start = [body.angle for body in bodies]
    made.step(frames=15)
    driver, driven = (body.angle - angle for body, angle in zip(bodies, start))
    assert driver == pytest.approx(0.75)
    assert driven == pytest.approx(-driver * 23 / 57, rel=0.01)  # as planned
    assert assembly.state(0).stress.any()
    # another level: without parts, from where everything is
    made.override(bodies[0], level="rigid").override(bodies[1], level="rigid")
    again = made.apply()
    assert again._settings["flexible"] is None and again is not contact


def test_shape_of_a_gear():
    shape = elastic.shape_of(ra.shapes.involute_gear(2e-3, 57, bore=15e-3))
    assert shape.teeth == 57
    assert shape.reach == pytest.approx(0.059, rel=0.01)  # the tips: pitch radius and one module
    assert shape.bore == pytest.approx(15e-3, rel=1e-3)


def test_gears_teeth_bend_by_what_the_elements_say():
    """2.3 micrometres at 46 N/mm (polygonal flanks): both gears' teeth together."""
    from rigidarea.plan import estimates as est

    bends = 2 * est.deflection(46e3, 207e9, 1.0, 1.0, 0.5)
    assert bends == pytest.approx(2.3e-6, rel=0.5)


def test_numbers_are_plain():
    space, _ = stack()
    made = ra.plan(space, 0.01, 2.0)
    for value in (made.error, made.cost_s_per_s, made.penetration):
        assert isinstance(value, float) and np.isfinite(value)


def parts_space() -> pymunk.Space:
    """A tower, a gear that drives another, which is braked, a ball: three that nothing connects."""
    space = pymunk.Space()
    space.gravity = 0, -9.81
    ground = pymunk.Segment(space.static_body, (-50, 0), (50, 0), 0)
    ground.friction = ground.elasticity = 0.8
    space.add(ground)
    for i in range(4):
        body = pymunk.Body(1, 1 / 6)
        body.position = 0, i + 0.5
        box = pymunk.Poly.create_box(body, (1, 1))
        box.friction = 0.6
        space.add(body, box)
    outline = ra.shapes.involute_gear(0.1, 20)
    driver, driven = pymunk.Body(body_type=pymunk.Body.KINEMATIC), pymunk.Body(5, 2)
    driver.position, driver.angular_velocity = (20, 10), 2.5
    driven.position, driven.angle, driven.angular_velocity = (22, 10), math.pi + math.pi / 20, -2.5
    space.add(driver, driven, outline.add_to(driver), outline.add_to(driven))
    brake = pymunk.SimpleMotor(space.static_body, driven, 0)
    brake.max_force = 5
    space.add(pymunk.PivotJoint(space.static_body, driven, driven.position), brake)
    ball = pymunk.Body(1, 1 / 8)
    ball.position = -20, 3
    disc = pymunk.Circle(ball, 0.5)
    disc.elasticity = 0.8
    space.add(ball, disc)
    return space


def test_what_is_delicate_takes_substeps_of_its_own():
    space = parts_space()
    made = ra.plan(space, 0.01, 2.0)
    bodies = list(space.bodies)
    gears = bodies[4:6]
    assert made.reachable and set(gears) <= made.finer.keys()
    assert made.finer[gears[0]] == made.finer[gears[1]] > made.steps
    assert bodies[6] not in made.finer  # the ball
    whole = ra.plan(space, 0.01, 2.0).override(steps=made.finer[gears[0]])
    assert made.cost_s_per_s < whole.cost_s_per_s and not whole.finer
    contact = made.apply()
    assert contact.step(1 / 60, steps=made.steps) == made.finer[gears[0]]
    assert f"{made.finer[gears[0]]} substeps" in str(made)


def test_a_body_may_be_given_more_substeps():
    space = parts_space()
    ball = list(space.bodies)[6]
    made = ra.plan(space, 0.01, 2.0).override(ball, steps=24)
    assert made.finer[ball] == 24 and "24 substeps for its island (yours)" in str(made)
    contact = made.apply()
    assert contact.step(1 / 60, steps=made.steps) == 24
    made.override(ball, steps=None).apply()
    assert ball not in made.finer
    assert contact.step(1 / 60, steps=made.steps) == max(made.finer.values())
    with pytest.raises(ValueError, match="whole number from 1 to 1024, got 0"):
        made.override(ball, steps=0)
