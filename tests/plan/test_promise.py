"""What a plan does not promise, what blows do to its levels, what it is told: tolerances, names, materials."""

import json
import subprocess
import sys

import numpy as np
import pymunk
import pytest
from scipy.integrate import solve_ivp

import rigidarea as ra
from harness.judged import JUDGED
from harness.trial import space_of
from harness.unseen import UNSEEN, billiard, chain_on_a_peg, islands
from rigidarea.flexible import Material
from rigidarea.plan import estimates as est
from rigidarea.plan.probe import Probe, Setting
from rigidarea.plan.promise import name_of

STEEL = Material(207e9, 0.29, 7800.0, 0.02)
RUBBER = Material(2e6, 0.45, 1100.0, 0.02)


def space_with(*bodies, gravity=0.0):
    space = pymunk.Space()
    space.gravity = 0.0, -gravity
    space.add(pymunk.Segment(space.static_body, (-50, 0), (50, 0), 0))
    for body, shape in bodies:
        space.add(body, shape)
    return space


def box(width, height, mass, at, velocity=(0.0, 0.0)):
    body = pymunk.Body(mass, mass * (width**2 + height**2) / 12)
    body.position, body.velocity = at, velocity
    return body, pymunk.Poly.create_box(body, (width, height))


def disc(radius, mass, at, velocity=(0.0, 0.0)):
    body = pymunk.Body(mass, mass * radius**2 / 2)
    body.position, body.velocity = at, velocity
    return body, pymunk.Circle(body, radius)


@pytest.mark.parametrize(("given", "means"), [("5%", 0.05), ("0.1 %", 0.001), ("0.02", 0.02), (0.01, 0.01)])
def test_tolerances(given, means):
    assert ra.plan(space_with(), given).tolerance == pytest.approx(means)


@pytest.mark.parametrize("given", ["five", "", "%", "-1%", 0.0])
def test_tolerances_that_are_none(given):
    with pytest.raises(ValueError, match="tolerance must be"):
        ra.plan(space_with(), given)


def test_names():
    """The user's, else what it is and where."""
    (crate, shape), (other, round_) = box(1.0, 1.0, 1.0, (0.0, 0.5)), disc(0.5, 1.0, (3.0, 0.5))
    crate.name = "the crate"
    space = space_with((crate, shape), (other, round_), gravity=9.81)
    made = ra.plan(space, 0.01).override(crate, steps=3).override(other, steps=3)
    named = {line.what for line in made.lines}
    assert {"the crate", "disc at (3, 0.5)"} <= named and "bodies[" not in str(made)
    assert "their island is outside" not in str(made)  # the user says so, not the plan
    assert (
        name_of(space, round_) == "disc of disc at (3, 0.5)"
        and name_of(space, space.static_body) == "static_body"
    )
    tilted = pymunk.Poly(other, [(0, 0), (2, 1), (1, 3), (-1, 2)])
    assert name_of(space, tilted).startswith("box of")
    assert name_of(space, pymunk.Poly(other, [(0, 0), (2, 0), (1, 3)])).startswith("polygon of")


def test_a_place_that_rounding_left_of_zero_is_told_as_zero():
    """As small as that beside the body itself; what is small with it is told."""
    (crate, shape), (grain, round_) = box(1.0, 1.0, 1.0, (-7.239e-26, 0.5)), disc(1e-12, 1.0, (3e-12, 0.0))
    space = space_with((crate, shape), (grain, round_))
    assert name_of(space, crate) == "box at (0, 0.5)" and name_of(space, grain) == "disc at (3e-12, 0)"


def test_a_pile_and_what_rests_are_promised():
    pile = [box(1.0, 1.0, 1.0, (0.0, 0.5 + i)) for i in range(5)]
    assert ra.plan(space_with(*pile, gravity=9.81), 0.01).unpromised == []
    assert ra.plan(space_with(), 0.01).unpromised == []  # nothing moves
    assert ra.plan(space_of(islands())[0], 0.01, 1.5).unpromised == []


def test_what_is_not_promised():
    """What was not tried out is said, and no number stands for it."""
    fallen = [box(1.0, 1.0, 1.0, (2.0 * i, 0.5)) for i in range(200)]
    made = ra.plan(space_with(*fallen, gravity=9.81), 0.01, 3.0)
    assert made.looked < 3.0 and made.unpromised[0].startswith("what comes after the first")
    assert f"not promised: {made.unpromised[0]}" in str(made)
    space = space_with(box(1.0, 1.0, 1.0, (0.0, 2.0)), gravity=9.81)
    called = []
    space.on_collision(0, 0, begin=lambda *_: called.append(1))
    made = ra.plan(space, 0.01, 1.0)
    assert made.unpromised == ["what your callbacks do: they were not run"] and not called
    made.apply()
    made.step(frames=60)
    assert called
    (crate, shape), (other, round_) = box(1.0, 1.0, 1.0, (0.0, 0.5)), disc(0.5, 1.0, (3.0, 0.5))
    space = space_with((crate, shape), (other, round_), gravity=9.81)
    spring = pymunk.DampedSpring(crate, other, (0, 0), (0, 0), 3.0, 1.0, 0.0)
    spring.force_func = lambda *_: 0.0
    space.add(spring)
    assert ra.plan(space, 0.01, 1.0).unpromised == ["what your callbacks do: they were not run"]


@pytest.mark.parametrize("make", [billiard, chain_on_a_peg])
def test_blows_in_a_row_and_joints_are_right_or_said(make):
    """Beside a run that is finer than any the plan has looked at."""
    scene = make()
    space = space_of(scene)[0]
    moving = [body for body in space.bodies if body.body_type != pymunk.Body.STATIC]
    made = ra.plan(space, 0.001, scene.duration, frame=scene.frame)
    fine = Probe(space, scene.frame, scene.frames, None, {}, 0.001, moving)
    best = fine.track(Setting("rigid", 301, 20, 1e-8))
    chosen = Setting(made.level, made.steps, made.sweeps, made.penetration)
    within = float(fine.apart(fine.track(chosen), best).max()) <= 0.001
    assert within or not made.reachable or f"not promised: {made.unpromised[0]}" in str(made)


def test_the_force_of_a_blow():
    """A mass on a spring behind a spring, integrated: largest force and duration."""
    speed, mass, give, stiffness, chord = 2.0, 0.7, 3e-6, 5e7, 0.02
    k = 1.0 / (give + 1.0 / (stiffness * chord))
    run = solve_ivp(
        lambda _, y: [y[1], -k / mass * y[0]], (0.0, 0.02), (0.0, speed), rtol=1e-10, atol=1e-14, max_step=1e-5,
        events=[lambda t, y: y[0] if t > 0 else 1.0],
    )  # fmt: skip
    told = est.blow(speed, mass, give, stiffness, chord)
    assert k * run.y[0].max() == pytest.approx(told.force, rel=1e-4)
    assert run.t_events[0][0] == pytest.approx(np.pi / told.frequency, rel=1e-4)


def test_blows_choose_the_level():
    """A ball on a free steel beam sets it swinging (the rigid level would have it back at once); the same ball laid
    beside it does not. A rubber disc that is dropped bends, and what it does on a rigid floor is not promised."""
    beam = box(0.3, 0.01, 7800.0 * 0.3 * 0.01 * 0.02, (0.0, 1.0))
    ball = disc(0.015, 0.4, (0.0, 1.1), (0.0, -1.0))
    made = ra.plan(space_with(beam, ball), 0.01, 0.5, materials={beam[0]: STEEL}).override(stiffness=2e10)
    assert made.elastic[0].level == "modal" and made.elastic[0].reason.startswith("a blow at 1:")
    ball[0].velocity = 0.0, 0.0
    assert made.again().elastic[0].level == "rigid"
    assert any("what presses a body" in reason for reason in made.unpromised)
    rubber = disc(0.05, 1100.0 * np.pi * 0.05**2 * 0.02, (0.0, 0.5))
    space = space_with(rubber, gravity=9.81)
    soft = ra.plan(space, "0.1%", materials={rubber[0]: RUBBER})
    assert soft.elastic[0].level == "modal"
    assert "a blow at 2.97" in soft.elastic[0].reason  # √(2 g 0.45)
    assert any("undeformed outline" in reason for reason in soft.unpromised)
    rubber[0].material = RUBBER  # which says the same
    assert ra.plan(space, "0.1%").elastic[0].reason == soft.elastic[0].reason


PROGRAM = """
import pymunk
from rigidarea.flexible import Material
space = pymunk.Space()
space.gravity = 0, -9.81
space.add(pymunk.Segment(space.static_body, (-5, 0), (5, 0), 0))
disc = pymunk.Body(0.17, 2e-4)
disc.position, disc.name = (0, 0.5), "tyre"
disc.material = Material(2e6, 0.45, 1100.0, 0.02)
space.add(disc, pymunk.Circle(disc, 0.05))
space.step(1 / 120)
"""


def test_a_program_says_what_its_bodies_are_made_of(tmp_path):
    script = tmp_path / "game.py"
    script.write_text(PROGRAM)
    words = [sys.executable, "-m", "rigidarea", "plan", str(script), "--tolerance", "0.1%"]
    done = subprocess.run([*words, "--json", "-"], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    told = json.loads(done.stdout)
    assert told["settings"]["tolerance"] == pytest.approx(0.001)
    line = next(
        line for line in told["results"]["lines"] if line["what"] == "tyre" and "modal" in line["choice"]
    )
    assert line["decided_by"].startswith("a blow") and told["results"]["unpromised"]


def test_unseen_scenes_can_be_run():
    for make in (*UNSEEN, *JUDGED):
        space, bodies = space_of(make())
        assert ra.plan(space, 0.05, 0.5).steps >= 1 and len(bodies) == len(make().bodies)
