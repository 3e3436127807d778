"""The same lines, compiled and interpreted: the same bits."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest

from rigidarea.compile.raw_memory import record

SCENE = """
import pymunk, rigidarea as ra
space = pymunk.Space()
space.gravity = 0, -10
floor = pymunk.Segment(space.static_body, (-9, 0), (9, 0), 0.1)
floor.friction = 0.5
space.add(floor)
def add(body, shape, x, y):
    body.position = x, y
    shape.friction = 0.5
    space.add(body, shape)
for i in range(3):
    body = pymunk.Body(10.0**i, 10.0**i / 6)
    add(body, pymunk.Poly.create_box(body, (1, 1)), 0.1 * i, 0.6 + 1.05 * i)
ball = pymunk.Body(1, 0.1)
add(ball, pymunk.Circle(ball, 0.4), -0.6, 5)
hook = ra.Outline([(0, 0), (2, 0), (2, 1), (1.6, 1), (1.6, 0.4), (0, 0.4)])
body = hook.body(mass=2)
add(body, hook.add_to(body), 1.5, 1)
hung = pymunk.Body(1, 0.1)
add(hung, pymunk.Circle(hung, 0.3), -3, 0.5)
space.add(pymunk.PivotJoint(space.static_body, hung, (-3, 3)))
space.sleep_time_threshold = 0.3
contact = ra.attach(space)
for i in range(24):
    hung.force, hung.torque = (0.5 * (i % 5), 0), 0.1
    contact.step(1 / 60)
for b in space.bodies:
    print(*(float.hex(v) for v in (*b.position, b.angle, *b.velocity, b.angular_velocity)))
"""


def test_interpreted_and_compiled_are_the_same_to_the_bit():
    """Rest, sleep, impacts, friction, a joint, forces, a disc, a concave outline, mass ratios of 100."""
    seen = []
    for off in ("0", "1"):
        run = subprocess.run(
            [sys.executable, "-W", "error", "-c", SCENE],
            env=os.environ | {"NUMBA_DISABLE_JIT": off},
            capture_output=True,
            text=True,
            check=True,
        )
        seen.append(run.stdout)
    assert seen[0].count("0x") == 36
    assert seen[0] == seen[1]


@pytest.mark.parametrize("name", ["put", "size", "mean"])
def test_no_field_is_named_as_what_numpy_has(name):
    """Interpreted, `row.put` was numpy's method, and always true."""
    with pytest.raises(ValueError, match=name):
        record([("x", "f8"), (name, "f8")])
