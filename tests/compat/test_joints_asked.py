"""Whatever of the user's runs within a step may ask its joints, as in pymunk: none has another class by then."""

import math
import subprocess
import sys
import textwrap
from pathlib import Path

import pymunk
import pytest

import rigidarea as ra

JOINTS = {
    "pin": lambda a, b: pymunk.PinJoint(a, b, (1, 0), (0, 1)),
    "slide": lambda a, b: pymunk.SlideJoint(a, b, (1, 0), (0, 1), 5, 15),
    "pivot": lambda a, b: pymunk.PivotJoint(a, b, (6, 20)),
    "groove": lambda a, b: pymunk.GrooveJoint(a, b, (-20, 0), (20, 0), (0, 0)),
    "spring": lambda a, b: pymunk.DampedSpring(a, b, (0, 0), (0, 0), 10, 50, 1),
    "rotary spring": lambda a, b: pymunk.DampedRotarySpring(a, b, 0, 500, 10),
    "rotary limit": lambda a, b: pymunk.RotaryLimitJoint(a, b, -1, 1),
    "ratchet": lambda a, b: pymunk.RatchetJoint(a, b, 0, 1),
    "gear": lambda a, b: pymunk.GearJoint(a, b, 0, 2),
    "motor": lambda a, b: pymunk.SimpleMotor(a, b, 3),
}
#: Of each kind a property of its own, which pymunk answers only for a joint of that class.
PROPERTY = {
    **{"pin": "distance", "slide": "max", "pivot": "anchor_a", "groove": "groove_b", "spring": "rest_length"},
    **{
        "rotary spring": "stiffness",
        "rotary limit": "max",
        "ratchet": "angle",
        "gear": "ratio",
        "motor": "rate",
    },
}
CALLBACKS = ("velocity_func", "position_func", "first pre_solve", "last pre_solve", "first post_solve")
CALLBACKS += ("last post_solve", "collision pre_solve", "collision post_solve", "force_func")

SCRIPT = """
    import sys
    sys.path.insert(0, {folder!r})
    import pymunk, rigidarea as ra
    import test_joints_asked as t
    print(t.asked_from({callback!r}, {before!r}))
"""


def asked_from(callback, before):
    """How often every joint answered (and took its value back) in 30 frames. before: joints are there at `attach`."""
    space = pymunk.Space()
    space.gravity = 0, -100
    space.add(pymunk.Segment(space.static_body, (-500, 0), (500, 0), 1))
    if not before:
        contact = ra.attach(space)
    bodies, joints = [], []
    for n, make in enumerate(JOINTS.values()):
        pair = []
        for i in range(2):
            body = pymunk.Body(1, 50)
            body.position = 40 * n - 200 + 12 * i, 20 if n else 6
            space.add(body, pymunk.Circle(body, 5))
            pair.append(body)
        joints.append(make(*pair))
        bodies += pair
    first, last = (pymunk.DampedSpring(bodies[0], bodies[2], (0, 0), (0, 0), 40, 1, 1) for _ in range(2))
    space.add(first, *joints, last)
    if before:
        contact = ra.attach(space)
    asked = 0

    def ask():
        nonlocal asked
        asked += 1
        for joint, name in zip(joints, PROPERTY.values()):
            setattr(joint, name, getattr(joint, name))
            assert math.isfinite(joint.impulse)
        assert space.iterations == 10

    def velocity(body, gravity, damping, dt):
        pymunk.Body.update_velocity(body, gravity, damping, dt)
        ask()

    def position(body, dt):
        pymunk.Body.update_position(body, dt)
        ask()

    if callback == "velocity_func":
        bodies[3].velocity_func = velocity
    elif callback == "position_func":
        bodies[3].position_func = position
    elif callback == "force_func":
        last.force_func = lambda spring, length: (ask(), (spring.rest_length - length) * spring.stiffness)[1]
    elif callback.startswith("collision"):
        space.on_collision(0, 0, **{callback.split()[1]: lambda arbiter, space, data: ask()})
    else:
        which, name = callback.split()
        setattr(first if which == "first" else last, name, lambda joint, space: ask())
    order = [id(joint) for joint in space.constraints]
    for _ in range(30):
        space.step(1 / 60)
    contact.detach()
    space.step(1 / 60)
    assert [id(joint) for joint in space.constraints] == order
    return asked


@pytest.mark.slow
@pytest.mark.parametrize("before", [True, False])
@pytest.mark.parametrize("callback", CALLBACKS)
def test_joints_answer_from_within(callback, before):
    """In a process of its own: where one has another's class, Chipmunk ends it."""
    script = SCRIPT.format(folder=str(Path(__file__).parent), callback=callback, before=before)
    done = subprocess.run(
        [sys.executable, "-c", textwrap.dedent(script)], capture_output=True, text=True, timeout=300
    )
    assert done.returncode == 0, done.stderr[-400:]
    assert int(done.stdout.split()[-1]) >= 29 and "Error" not in done.stderr


def test_a_springs_force_function_asks_its_spring():
    """The force as pymunk's own function says it, and as pymunk's users write it: the same digits."""
    places = []
    for own in (False, True):
        space = pymunk.Space()
        one, two = pymunk.Body(1, 1), pymunk.Body(1, 1)
        two.position = 0, 100
        spring = pymunk.DampedSpring(one, two, (0, 0), (0, 0), 40, 30, 0.5)
        if own:
            spring.force_func = lambda spring, length: (spring.rest_length - length) * spring.stiffness
        space.add(one, two, spring)
        contact = ra.attach(space)
        contact.step(1 / 60, steps=1, frames=60)
        places.append((one.position.y, two.position.y))
    assert places[0] == pytest.approx(places[1], abs=1e-12) and places[0][0] > 1


def test_a_motor_is_set_from_a_velocity_function():
    space = pymunk.Space()
    body = pymunk.Body(1, 1)
    motor = pymunk.SimpleMotor(space.static_body, body, 0)
    space.add(body, motor)

    def steer(body, gravity, damping, dt):
        pymunk.Body.update_velocity(body, gravity, damping, dt)
        motor.rate = -3

    body.velocity_func = steer
    ra.attach(space)
    for _ in range(3):
        space.step(1 / 60)
    assert abs(body.angular_velocity) == pytest.approx(3, rel=1e-9)


def test_joints_stay_in_their_order():
    """Attached and detached, Chipmunk solves a space's joints in the order in which they were added: the same bits."""
    ends = []
    for attaching in (False, True):
        space = pymunk.Space()
        space.gravity = 0, -100
        before = space.static_body
        bodies = []
        for i in range(6):
            body = pymunk.Body(1 + i, 5)
            body.position = 10 * (i + 1), 0
            space.add(body, pymunk.PivotJoint(before, body, (10 * i + 3, 1)))
            before = body
            bodies.append(body)
        if attaching:
            ra.attach(space).detach()
        for _ in range(60):
            space.step(1 / 60)
        ends.append([tuple(body.position) for body in bodies])
    assert ends[0] == ends[1]
