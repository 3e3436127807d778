"""Nothing is put off to a game's first frames: whatever needs compiling is compiled when the space is attached."""

import subprocess
import sys
import textwrap
from pathlib import Path

import pytest
from solve_world import area_only

from rigidarea import backend

pytestmark = [area_only, pytest.mark.skipif(backend() != "compiled", reason="nothing is compiled")]

PROGRAM = """
import sys
sys.path.insert(0, {folder!r})
import math, numba, pymunk
from numba.core import event
import rigidarea as ra
from solve_world import World, regular

def fill(world):
    world.floor()
    body = world.box((0, 0.6), velocity=(1, 0))
    world.disc((2, 0.6))
    world.polygon((4, 0.6), regular(5, 0.5))
    rounded = pymunk.Body(1, 1)
    world.add(rounded, pymunk.Poly(rounded, regular(4, 0.5), radius=0.1), at=(6, 0.8))
    cup = ra.Outline([(-1, 0), (1, 0), (1, 1), (0.8, 1), (0.8, 0.2), (-0.8, 0.2), (-0.8, 1), (-1, 1)])
    holder = cup.body(mass=1.0)
    world.add(holder, cup.add_to(holder), at=(9, 0.2))
    world.box((9, 2.0), (0.3, 0.3))
    pin = pymunk.PivotJoint(world.space.static_body, body, (0, 2))
    world.space.add(pin)
    return world

settings = {settings}
world = World(10.0, friction=0.5, elasticity=0.3, **settings)
with event.install_recorder("numba:compile") as seen:
    fill(world)
    for steps in {steps}:
        world.step(steps, 60)
    world.space.step(1 / 60)
    world.contact.regions, world.contact.energy()
print(len(seen.buffer))
"""


@pytest.mark.parametrize("settings", [{}, {"stiffness": 1e5, "law": "energy"}, {"direction": "nodal"}])
def test_no_compilation_in_a_frame(settings):
    """numba reports no compilation from the first body on: all shapes, a joint, all kinds of steps."""
    program = textwrap.dedent(PROGRAM).format(
        folder=str(Path(__file__).parent), settings=settings, steps=[None, 1, 4]
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert done.stdout.split() == ["0"]


def test_no_compilation_for_a_tolerance():
    """`contact.step(dt, tolerance=…)` the same."""
    program = textwrap.dedent(PROGRAM).format(folder=str(Path(__file__).parent), settings={}, steps=[None])
    program = program.replace("world.step(steps, 60)", "world.contact.step(1 / 60, tolerance=1e-3)")
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert done.stdout.split() == ["0"]
