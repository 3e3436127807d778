"""A plan: it reads a space and changes nothing, says why, takes overrides, and makes it so."""

import math

import numpy as np
import pymunk
import pytest

import rigidarea as ra
from rigidarea.plan import elastic
from rigidarea.plan import estimates as est
from rigidarea.plan.facts import facts
from rigidarea.plan.predict import Setting, causes, total
from rigidarea.plan.survey import bases, survey

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


# --- what a survey sees ---


@pytest.mark.parametrize("size", [(1.0, 1.0), (3.0, 0.1), (0.2, 2.0)])
@pytest.mark.parametrize("angle", [0.0, 0.3, 0.8])
def test_thickness_of_boxes_is_exact(size, angle):
    space = pymunk.Space()
    box(space, (0, 0), size, mass=2.0, angle=angle)
    assert survey(space).thickness[0] == pytest.approx(min(size), rel=1e-9)


def test_layers_and_loads():
    space, _ = stack(5)
    box(space, (0, 5.5), mass=40.0)
    seen = survey(space)
    from rigidarea.plan.survey import support

    layers, load, heavier, shared = support(seen)
    assert not shared
    assert layers[:6].tolist() == [1, 2, 3, 4, 5, 6]
    assert load[:6] == pytest.approx([45, 44, 43, 42, 41, 40])
    assert heavier == 40


def test_where_a_load_presses_on_its_base():
    """Books over an edge, each 0.9 of the classical overhang: by statics the load of n of them lies 0.1 of half a
    book inside the edge of what is below."""
    space = pymunk.Space()
    space.gravity = 0, -G
    table = pymunk.Poly(space.static_body, [(-10, -1), (0, -1), (0, 0), (-10, 0)])
    space.add(table)
    edge, count = 0.0, 4
    for i in range(count):
        edge += 0.9 / (2 * (count - i))
        box(space, (edge - 0.5, 0.2 * i + 0.1), (1.0, 0.2))
    margin, width = bases(survey(space))
    overlap = 1.0 - 0.9 / (2 * np.array([4, 3, 2, 1]))
    assert width[:count] == pytest.approx(overlap)
    assert margin[:count] == pytest.approx(0.05 / (overlap / 2))
    straight, _ = stack(3)
    assert bases(survey(straight))[0][:3] == pytest.approx(1.0)


def test_a_load_is_shared():
    space = pymunk.Space()
    space.gravity = 0, -G
    ground(space)
    for x in (-0.75, 0.75):
        box(space, (x, 0.5))
    box(space, (0, 1.5), (2.5, 1.0), mass=10.0)
    from rigidarea.plan.survey import support

    _, load, _, shared = support(survey(space))
    assert shared
    assert load[:3] == pytest.approx([6, 6, 10])


def test_filters_sensors_and_pairs():
    space, _ = stack(2)
    assert len(survey(space).pairs) == 2
    for shape in space.shapes:
        shape.filter = pymunk.ShapeFilter(group=1)
    assert len(survey(space).pairs) == 0
    for shape in space.shapes:
        shape.filter = pymunk.ShapeFilter()
        shape.sensor = True
    assert len(survey(space).shapes) == 0


def test_curvature_of_outlines():
    from rigidarea.plan.survey import curvature_radius

    disc = ra.Outline.circle(0.7)
    assert curvature_radius(disc) == pytest.approx(0.7)
    assert curvature_radius(disc.sample(1e-4)) == pytest.approx(0.7, rel=1e-2)
    hole = ra.Outline([(-2, -2), (2, -2), (2, 2), (-2, 2)], [disc.sample(1e-4).rings[0]])
    assert curvature_radius(hole) == pytest.approx(-0.7, rel=1e-2)
    assert curvature_radius(ra.Outline([(0, 0), (1, 0), (1, 1), (0, 1)])) == 0


# --- what is predicted ---


def test_a_hole_is_read_as_arcs_and_as_points():
    """A disc in a journal: the hole's radius, hollow, whether it is an arc or sampled."""
    hole = ra.Outline.from_bulges(
        [(-2, -2, 0), (2, -2, 0), (2, 2, 0), (-2, 2, 0)], holes=[[(1.0, 0.0, -1.0), (-1.0, 0.0, -1.0)]]
    )
    for outline in (hole, hole.sample(1e-4)):
        space = pymunk.Space()
        space.gravity = 0, -G
        outline.add_to(space.static_body)
        space.add(*space.static_body.shapes)
        pin = pymunk.Body(1, 1)
        pin.position = 0, -0.1
        space.add(pin, pymunk.Circle(pin, 0.9))
        seen = survey(space)
        assert sorted(seen.radius) == pytest.approx([-1.0, 0.9], rel=1e-3)


def test_what_comes_off_an_arc_is_seen_beforehand():
    """A ring on a peg, as stiff as its substeps do not bear: measured 0.23, against 0.0012 where it stays on."""
    from rigidarea.study.scene import get_scene
    from rigidarea.study.user_space import space_of

    scene = get_scene("ring_on_peg")
    found = facts(survey(space_of(scene)[0]), scene.frame, scene.duration)
    assert total(found, Setting("rigid", 2, 5, 1e-5)) < 0.01
    assert total(found, Setting("rigid", 2, 5, 1e-6)) > 0.1
    assert total(found, Setting("rigid", 8, 5, 1e-6)) < 0.001


def test_a_pin_in_a_slot_is_no_gear():
    """A Geneva wheel has twelve hollows, six of them for the lock: it begins from nothing with each slot."""
    from rigidarea.study.scene import get_scene
    from rigidarea.study.user_space import space_of

    scene = get_scene("geneva")
    found = facts(survey(space_of(scene)[0]), scene.frame, scene.duration)
    assert found.driven[0] == 0.0 and found.slots[0] == pytest.approx(math.pi)
    scene = get_scene("gears")
    found = facts(survey(space_of(scene)[0]), scene.frame, scene.duration)
    assert found.driven[0] > 0.0 and found.slots[0] == 0.0


def test_what_is_heavy_on_light_wants_two_substeps():
    for ratio, steps in ((50.0, 1), (1000.0, 2)):
        space = pymunk.Space()
        space.gravity = 0, -G
        ground(space)
        for x in (-0.75, 0.75):
            box(space, (x, 0.5))
        box(space, (0.05, 1.5), (2.5, 1.0), mass=ratio)
        made = ra.plan(space, 0.1).override(level="rigid")
        assert made.steps == steps and made.sweeps == est.LEAST_PILE_SWEEPS


def test_a_blow_asks_for_a_stiffer_bed_than_its_weight():
    """Dropped from ten sides: v/(g h) times as deep as it would lie, where the bed is stiff."""
    space, _ = stack(1)
    box(space, (0, 11.5))
    found = facts(survey(space), 1 / 60, 2.0)
    speed, p, h = math.sqrt(2 * G * 10.0), 1e-6, 1 / 60
    blow = next(cause for cause in causes(found, Setting("rigid", 1, 10, p)) if cause.name == "blow")
    assert blow.error == pytest.approx(p * speed / (G * h), rel=1e-2)
    resting, _ = stack(2)
    assert "blow" not in {
        c.name for c in causes(facts(survey(resting), 1 / 60, 2.0), Setting("rigid", 1, 10, p))
    }


def test_what_starts_overlapped_and_meets_nothing():
    """Chipmunk takes two free boxes apart without a speed that stays: one step a frame will do, given the time."""
    from rigidarea.study.scene import get_scene
    from rigidarea.study.user_space import space_of

    scene = get_scene("parted")
    space, bodies = space_of(scene)
    made = ra.plan(space, 0.001, scene.duration)
    assert (made.level, made.steps) == ("pymunk", 1)
    short = ra.plan(space, 0.001, 0.1)
    assert short.error > 0.1 and not short.reachable
    bodies[0].velocity = 1.0, 1.0  # now they part, or meet
    assert (made.again().level, made.steps) != ("pymunk", 1)


def test_more_is_never_worse():
    """Substeps and sweeps may only lower what is predicted: else the cheapest would not be found by growing them."""
    space, _ = stack(6)
    found = facts(survey(space), 1 / 60, 5.0)
    errors = [total(found, Setting("rigid", n, 10, 1e-5)) for n in (2, 3, 4, 8, 16)]
    assert errors == sorted(errors, reverse=True) and errors[0] > errors[-1]
    errors = [total(found, Setting("rigid", 2, m, 1e-5)) for m in (10, 20, 40)]
    assert errors == sorted(errors, reverse=True)  # a tower's loads are found by the first ten
    space, _ = stack(0)
    for row in range(6):
        for i in range(6 - row):
            box(space, (i + 0.5 * row, row + 0.5))
    found = facts(survey(space), 1 / 60, 5.0)
    errors = [total(found, Setting("rigid", 2, m, 1e-5)) for m in (10, 20, 40)]
    assert errors == sorted(errors, reverse=True) and errors[0] > errors[-1]


def test_a_tower_that_would_buckle_is_not_planned_soft():
    space, _ = stack(12)
    found = facts(survey(space), 1 / 60, 5.0)
    assert total(found, Setting("rigid", 16, 40, 1e-3)) == 1.0
    assert causes(found, Setting("rigid", 16, 40, 1e-3))[0].name == "buckling"
    assert ra.plan(space, 0.1).penetration <= 0.65 / (3 * 12) ** 3


def test_two_hits_in_a_row_want_a_substep_each():
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
    finest = max(made.finer.values(), default=made.steps)
    assert finest >= math.ceil(1 / 60 / (gap / speed)) and made.reachable


def test_what_is_out_of_reach_is_said_beforehand():
    space = pymunk.Space()
    for x in (-0.3, 0.3):
        box(space, (x, 0))
    made = ra.plan(space, 0.01, 2.0).override(level="rigid")
    assert not made.reachable and made.error > 0.01
    assert "no setting is predicted to reach it" in str(made)


# --- the plan ---


def test_planning_changes_nothing():
    space, _ = stack()
    before = state(space), space.collision_slop
    str(ra.plan(space, 0.01, 5.0))
    assert (state(space), space.collision_slop) == before
    assert ra.attached(space) is None


def test_a_finer_tolerance_is_never_cheaper():
    for build in (stack, lambda: tilted()):
        costs = [ra.plan(build()[0], tolerance, 2.0).cost_s_per_s for tolerance in (0.1, 0.01, 0.001)]
        assert costs == sorted(costs)


def tilted():
    space = pymunk.Space()
    space.gravity = 0, -G
    ground(space)
    return space, [box(space, (0, 1.1), (0.4, 2.0), angle=0.1)]


@pytest.mark.parametrize("build", [stack, tilted])
def test_the_table_says_what_decided(build):
    space, _ = build()
    made = ra.plan(space, 0.01, 2.0)
    text = str(made)
    lines = made.lines
    assert f"{made.steps} x {made.sweeps} sweeps" in text or made.level == "pymunk"
    assert lines[0].what == "space" and lines[0].error == made.error
    assert made.causes[0].number in text and "box at (" in text
    assert len(text.splitlines()) == len(lines) + 2 + len(made.unpromised)


def test_what_may_sleep_lies_flush_and_still():
    space, bodies = stack(3)
    flying = box(space, (5, 9))
    rolling = pymunk.Body(1, 1)
    rolling.position = -5, 0.5
    space.add(rolling, pymunk.Circle(rolling, 0.5))
    assert set(ra.plan(space, 0.01).may_sleep) == set(bodies)
    bodies[2].velocity = 0.5, 0
    assert set(ra.plan(space, 0.01).may_sleep) == set(bodies[:2])
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
        (None, {"steps": 0}, "whole number >= 1, got 0"),
        (None, {"steps": 1.5}, "whole number >= 1, got 1.5"),
        (None, {"level": "modal"}, "rigid, pymunk, got 'modal'"),
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
    """A tower, a gear that drives another, a ball: three that nothing connects."""
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
    driver.position, driver.angular_velocity = (20, 10), 20.0
    driven.position, driven.angle, driven.angular_velocity = (22, 10), math.pi + math.pi / 20, -20.0
    space.add(driver, driven, outline.add_to(driver), outline.add_to(driven))
    space.add(pymunk.PivotJoint(space.static_body, driven, driven.position))
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
    assert "teeth or slots" in str(made)


def test_a_body_may_be_given_more_substeps():
    space = parts_space()
    ball = list(space.bodies)[6]
    made = ra.plan(space, 0.01, 2.0).override(ball, steps=24)
    assert made.finer[ball] == 24 and "24 substeps for its island (yours)" in str(made)
    contact = made.apply()
    assert contact.step(1 / 60, steps=made.steps) == 24
    made.override(ball, steps=None).apply()
    assert contact.step(1 / 60, steps=made.steps) == max(made.finer.values())
    with pytest.raises(ValueError, match="whole number >= 1, got 0"):
        made.override(ball, steps=0)
