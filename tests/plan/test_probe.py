"""A space tried out on copies: what a copy is, how far two runs are apart, what a plan makes of it."""

import itertools
import math

import numpy as np
import pymunk
import pytest

import rigidarea as ra
from harness.trial import at_settings
from harness.unseen import box_dropped_askew, chain_on_a_peg, heavy_dropped, over_a_step
from rigidarea.plan.probe import LADDER, RATIO, Probe, Setting, copied, reference
from rigidarea.study.peers.base import record
from rigidarea.study.user_space import space_of

G = 9.81


@pytest.mark.parametrize("make", [chain_on_a_peg, heavy_dropped, over_a_step])
@pytest.mark.parametrize("setting", [Setting("rigid", 3, 10, 1e-5), Setting("pymunk", 2, 10, 1e-3)])
def test_a_copy_runs_as_the_space_does(make, setting):
    """Bit by bit, after runs at other settings too."""
    scene = make()
    space = space_of(scene)[0]
    moving = [body for body in space.bodies if body.body_type != pymunk.Body.STATIC]
    probe = Probe(space, scene.frame, scene.frames, None, {}, 0.01, moving)
    probe.run(Setting("rigid", 7, 20, 1e-4), None)
    states, _ = probe.run(setting, None)
    settings = setting._asdict()
    if setting.level == "pymunk":  # of a scene's size there, of what moves here
        settings["penetration"] *= probe.extent[probe.free].min() / scene.size
    moving = [body.kind != "static" for body in scene.bodies]
    real = record(at_settings(scene, settings), scene).states[-1][moving]
    assert np.array_equal(states[-1][:, :3], real[:, :3])


def test_a_copy_has_joints_filters_and_outlines():
    space = pymunk.Space()
    gear = ra.shapes.involute_gear(module=0.1, teeth=20)
    wheel, other = pymunk.Body(2, 3), pymunk.Body(1, 1)
    wheel.position, wheel.angle, wheel.velocity, other.position = (1, 2), 0.3, (4, 5), (3, 2)
    shape = gear.add_to(wheel)
    shape.friction, shape.filter = 0.7, pymunk.ShapeFilter(group=3)
    motor = pymunk.SimpleMotor(wheel, other, 2.0)
    motor.max_force, motor.pre_solve = 6.0, lambda *_: None
    space.add(wheel, other, shape, motor)
    made, bodies = copied(space, space.bodies, {}, 1e-3)
    (twin,), (joint,) = made.shapes, made.constraints
    assert twin.friction == 0.7 and twin.filter == shape.filter
    assert len(twin.outline.rings[0]) == len(gear.sample(1e-3 * gear.smallest_extent).rings[0])
    assert (joint.rate, joint.max_force, joint.pre_solve) == (2.0, 6.0, None)
    assert {joint.a, joint.b} == set(bodies) and motor.a is wheel and motor.pre_solve is not None
    assert (bodies[0].position, bodies[0].angle, bodies[0].velocity) == ((1, 2), 0.3, (4, 5))


def test_how_far_apart_two_runs_are():
    """A body that goes 4 and ends 0.02 off: 0.005. At rest, over its smallest extent. Turned, over a radian."""
    space = pymunk.Space()
    body = pymunk.Body(1, 1)
    space.add(body, pymunk.Poly.create_box(body, (3.0, 1.0)))
    probe = Probe(space, 0.1, 4, None, {}, 0.1, space.bodies)
    fine = np.zeros((5, 1, 6))
    moved = fine.copy()
    moved[-1, 0, 1] = 0.02
    assert probe.apart(moved, fine) == pytest.approx([0.02])
    turned = fine.copy()
    turned[2, 0, 2] = -0.02
    assert probe.apart(turned, fine) == pytest.approx([0.02])
    fine[3:, 0, 2] = turned[3:, 0, 2] = 4.0  # or over what it turns in all
    assert probe.apart(turned, fine) == pytest.approx([0.005])
    fine[:] = 0.0
    fine[:, 0, 0] = moved[:, 0, 0] = np.arange(5)
    assert probe.apart(moved, fine) == pytest.approx([0.005])
    moved[2, 0, 1] = 0.02  # sooner: over what it has gone by then
    assert probe.apart(moved, fine) == pytest.approx([0.005])
    assert probe.apart(moved, fine, so_far=True) == pytest.approx([0.01])
    assert probe.apart(moved[:0], fine) == [math.inf]


@pytest.mark.parametrize("driven", [False, True])
def test_spin_is_compared_of_what_is_driven(driven):
    """A plank on a pivot that a blow turns a frame late is where it should be, but for that frame; a drive is not."""
    space = pymunk.Space()
    plank = pymunk.Body(1, 1)
    space.add(
        plank, pymunk.Poly.create_box(plank, (1, 0.1)), pymunk.PivotJoint(space.static_body, plank, (0, 0))
    )
    if driven:
        space.add(pymunk.SimpleMotor(space.static_body, plank, 1.0))
    probe = Probe(space, 0.1, 4, None, {}, 0.1, space.bodies)
    fine = np.zeros((60, 1, 6))
    fine[30:, 0, 5] = 3.0
    fine[:, 0, 2] = np.cumsum(fine[:, 0, 5]) / 60
    late = np.roll(fine, 1, axis=0)
    late[0] = 0.0
    spins = math.sqrt(1 / 30)
    assert probe.apart(late, fine)[0] == pytest.approx(spins if driven else 1 / 30, rel=0.02)


def test_what_moves_little_is_off_by_its_share_of_the_motion():
    """A block that rocks by a twentieth of its width, 2e-3 of it off: by 0.04 of its motion. Less than the tolerance of
    the width is no motion; nor is a motion small beside one that is large in its island, but in another."""
    space = pymunk.Space()
    for i in range(2):
        body = pymunk.Body(1, 1)
        body.position = 9 * i, 0
        space.add(body, pymunk.Circle(body, 0.5))
    probe = Probe(space, 0.1, 4, None, {}, 0.01, space.bodies)
    fine = np.zeros((5, 2, 6))
    fine[:, 0, 0] = 0.0125 * np.arange(5)
    moved = fine.copy()
    moved[-1, 0, 0] += 2e-3
    assert probe.apart(moved, fine) == pytest.approx([2e-3, 0.0])  # at the end, of a width
    assert probe.apart(moved, fine, so_far=True) == pytest.approx([0.04, 0.0])
    probe.tolerance = 0.06
    assert probe.apart(moved, fine, so_far=True) == pytest.approx([2e-3, 0.0])
    probe.tolerance = 0.01
    fine[:, 1, 1] = moved[:, 1, 1] = np.arange(5)
    assert probe.apart(moved, fine, so_far=True) == pytest.approx([0.04, 0.0])
    probe.groups[1] = 0
    assert probe.apart(moved, fine, so_far=True) == pytest.approx([2e-3, 0.0])


def test_the_ladder_doubts_a_first_order_error_by_what_it_is():
    """Runs that go 1 and are off by c h: the doubt of the last is c h, whatever c."""

    class Known(Probe):
        def track(self, setting, sagitta=None):
            off = np.zeros((2, 1, 6))
            off[1, 0, 0] = 1.0 + 0.3 / setting.steps
            self.spent += 1.0
            return off

    space = pymunk.Space()
    body = pymunk.Body(1, 1)
    space.add(body, pymunk.Circle(body, 0.5))
    probe = Known(space, 0.1, 1, None, {}, 1e-6, space.bodies)
    fine = reference(probe, None, 3.5, None)
    assert fine.setting.steps == LADDER[3] and len(fine.coarser) == 3  # as far as the budget goes
    assert fine.doubt == pytest.approx(
        [0.3 / LADDER[3]], rel=0.05
    )  # Pell's quotients are within 2 % of the limit
    assert all(math.gcd(a, b) == 1 for a, b in itertools.pairwise(LADDER))
    assert LADDER[-1] / LADDER[-2] == pytest.approx(RATIO, rel=1e-3)


@pytest.mark.parametrize("tolerance", [0.05, 0.002])
def test_what_is_planned_is_off_by_what_it_says(tolerance):
    """Against a run that is finer than what the plan has looked at."""
    scene = box_dropped_askew()
    made = ra.plan(space_of(scene)[0], tolerance, scene.duration, frame=scene.frame)
    made.apply()
    space = space_of(scene)[0]
    moving = [body for body in space.bodies if body.body_type != pymunk.Body.STATIC]
    fine = Probe(space, scene.frame, scene.frames, None, {}, tolerance, moving)
    best = fine.track(Setting("rigid", 301, 20, 1e-8))
    chosen = Setting(made.level, made.steps, made.sweeps, made.penetration)
    error = float(fine.apart(fine.track(chosen), best).max())
    assert made.reachable and error <= made.error <= tolerance


def test_what_is_tried_out_costs_no_more_than_said():
    """A row of boxes as long as 300: the time looked at is cut until trying it out is within the budget."""
    space = pymunk.Space()
    space.gravity = 0, -G
    space.add(pymunk.Segment(space.static_body, (-9, 0), (900, 0), 0))
    for i in range(300):
        body = pymunk.Body(1, 1 / 6)
        body.position = 2 * i, 0.5
        space.add(body, pymunk.Poly.create_box(body, (1, 1)))
    made = ra.plan(space, 0.01, 60.0)
    assert 0.0 < made.looked < 60.0 and not ra.attached(space)
    run = made.cost_s_per_s * 60.0
    assert made._probe.spent <= 2.0 * max(0.05 * run, 0.1)  # the last run may go beyond


def test_of_a_large_space_islands_are_tried_out():
    """Fifty stacks of twenty: some whole stacks; one pile of as many: nothing, and the plan says so."""
    for apart, tried in ((1.2, True), (1.0, False)):
        space = pymunk.Space()
        space.gravity = 0, -G
        space.add(pymunk.Segment(space.static_body, (-9, 0), (90, 0), 0))
        for i in range(1000):
            body = pymunk.Body(1, 1 / 6)
            body.position = apart * (i % 50), 0.5 + i // 50
            space.add(body, pymunk.Poly.create_box(body, (1, 1)))
        made = ra.plan(space, 0.01)
        columns = {round(body.position.x, 3) for body in made._probe.bodies}
        assert len(made._probe.bodies) == 20 * len(columns) and bool(columns) == tried == bool(made.tried)
        told = f"what {1000 - 20 * len(columns)} bodies do" if tried else "anything"
        assert any(reason.startswith(told) for reason in made.unpromised)
        most = max(0.05 * made.cost_s_per_s * made.seconds, 0.1)
        assert made._probe.spent <= 1.1 * most  # the run of what is chosen comes on top


def test_what_is_finer_is_no_worse_a_promise():
    """The next finer choice of the table is off by less, the next cheaper costs less."""
    scene = over_a_step()
    made = ra.plan(space_of(scene)[0], 0.01, scene.duration, frame=scene.frame)
    named = {line.what.strip(): line for line in made.lines}
    assert named["finer"].error < made.error and named["finer"].cost_s > named["space"].cost_s
    assert "cheaper" not in named or named["cheaper"].cost_s < named["space"].cost_s
