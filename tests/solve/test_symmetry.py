"""What a scene must not depend on: handedness, order, scale, process, being copied."""

import copy
import hashlib
import math
import pickle
import subprocess
import sys
import textwrap
from pathlib import Path

import numpy as np
import pymunk
import pytest
from solve_world import ENGINE, World, regular

STEPS = [1, 4, None]


def heap(order=1, mirror=1.0, scale=1.0, seed=3, friction=0.4, elasticity=0.3):
    """Fourteen bodies that fall into a heap on a floor between slopes, in either hand, order and size.

    Added in the order of their list or backwards; `bodies` is in the list's order whatever that was.
    """
    draw = np.random.default_rng(seed)
    world = World(10.0 * scale, friction=friction, elasticity=elasticity)
    kinds = []
    for i in range(14):
        at = (i % 4 - 1.5) * 1.3 + draw.uniform(-0.2, 0.2), 1.0 + 1.3 * (i // 4)
        kinds.append(
            (i % 3, at, float(draw.uniform(-1, 1)), float(draw.uniform(-1, 1)), float(draw.uniform(1, 3)))
        )
    slopes = [((-9.0, 4.0), (-3.0, 0.0)), ((-3.0, 0.0), (3.0, 0.0)), ((3.0, 0.0), (9.0, 4.0))]
    made: dict[int, pymunk.Body] = {}
    items = [("slope", s) for s in slopes] + [("body", i) for i in range(len(kinds))]
    for what, item in items[::order]:
        if what == "slope":
            (ax, ay), (bx, by) = item
            world.segment((mirror * ax * scale, ay * scale), (mirror * bx * scale, by * scale), 0.25 * scale)
            continue
        kind, (x, y), angle, speed, mass = kinds[item]
        motion = {
            "angle": mirror * angle,
            "velocity": (mirror * speed * scale, 0.0),
            "mass": mass * scale**2,
        }
        at = (mirror * x * scale, y * scale)
        if kind == 0:
            made[item] = world.box(at, (0.9 * scale, 0.6 * scale), **motion)
        elif kind == 1:
            made[item] = world.disc(at, 0.4 * scale, **motion)
        else:
            ring = [(mirror * px * scale, py * scale) for px, py in regular(5, 0.5)]
            made[item] = world.polygon(at, ring, **motion)
    world.bodies = [made[i] for i in range(len(kinds))]
    return world


def differ(a, b):
    """Largest difference, for a message."""
    return float(np.abs(a - b).max())


@pytest.mark.parametrize("steps", STEPS)
def test_the_mirrored_scene_gives_mirrored_bits(steps):
    """x, angle and their velocities change sign, y stays: to the bit, 2 s."""
    left, right = heap(mirror=1.0), heap(mirror=-1.0)
    sign = np.array((-1.0, 1.0, -1.0, -1.0, 1.0, -1.0))
    for frame in range(120):
        left.step(steps)
        right.step(steps)
        assert (left.state() == sign * right.state()).all(), (
            frame,
            differ(left.state(), sign * right.state()),
        )


@pytest.mark.parametrize("steps", STEPS)
def test_the_order_of_insertion_changes_nothing(steps):
    """Added backwards: the same bits, 2 s."""
    one, other = heap(order=1), heap(order=-1)
    for frame in range(120):
        one.step(steps)
        other.step(steps)
        assert (one.state() == other.state()).all(), (frame, differ(one.state(), other.state()))


@pytest.mark.parametrize("steps", STEPS)
@pytest.mark.parametrize("scale", [2.0**-10, 1e-3, 2.0**10, 1e3])
def test_scale_changes_nothing(scale, steps):
    """Lengths and gravity × scale, masses × scale²: 1e-3 to 1e3; to 1e-6 of a size.

    (0.6 s, 0.4 of them in touch: a heap is chaotic, rounding grows tenfold in a few frames.)
    """
    one, other = heap(), heap(scale=scale)
    one.run(0.6, steps)
    other.run(0.6, steps)
    found = other.state() / np.array((scale, scale, 1.0, scale, scale, 1.0))
    assert found == pytest.approx(one.state(), abs=1e-6)


def digest(world):
    return hashlib.sha256(world.state().tobytes()).hexdigest()


PROGRAM = """
import sys
sys.path.insert(0, {folder!r})
from test_symmetry import digest, heap
world = heap()
junk = [object() for _ in range({junk})]  # other addresses
world.run(2.0, {steps})
print(digest(world))
"""


@pytest.mark.parametrize("steps", [1, None])
def test_two_processes_give_the_same_bits(steps):
    """Whatever the hash seed and the addresses."""
    found = set()
    for junk in (0, 100_000):
        program = textwrap.dedent(PROGRAM).format(folder=str(Path(__file__).parent), junk=junk, steps=steps)
        done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
        found.add(done.stdout.strip())
    assert len(found) == 1


@pytest.mark.skipif(ENGINE == "pymunk", reason="pymunk's copies forget their contacts' impulses")
@pytest.mark.parametrize("steps", STEPS)
@pytest.mark.parametrize("how", ["copy", "pickle"])
@pytest.mark.parametrize("frame", [0, 20, 90])
def test_a_copy_in_mid_contact_goes_on_as_the_original(frame, how, steps):
    """What contacts remember too: the same bits a second later, and the original undisturbed."""
    import rigidarea as ra

    world, undisturbed = heap(), heap()
    for w in (world, undisturbed):
        if frame:
            w.step(steps, frame)
    order = [list(world.space.bodies).index(b) for b in world.bodies]
    space = copy.deepcopy(world.space) if how == "copy" else pickle.loads(pickle.dumps(world.space))
    twin = World.__new__(World)
    twin.space, twin.contact = space, ra.attached(space)
    twin.bodies = [list(space.bodies)[i] for i in order]
    assert (twin.state() == world.state()).all()
    for _ in range(60):
        for w in (world, twin, undisturbed):
            w.step(steps)
    assert (world.state() == undisturbed.state()).all()
    assert (twin.state() == world.state()).all(), differ(twin.state(), world.state())


@pytest.mark.parametrize("steps", STEPS)
def test_a_rolling_frame_of_reference_changes_nothing(steps):
    """Everything, the kinematic floor too, at a common 64 m/s: the same motion beside it, to 1e-5 of a size.

    Of one substep to 1e-4: what is still is solved farther in one of four. At the defaults to 1e-2: what has come to
    rest beside the floor takes one substep a frame, what rolls with it two.
    """
    found = []
    for common in (0.0, 64.0):
        world = World(10.0, friction=0.5, elasticity=0.2)
        world.box((0, -0.5), (40.0, 1.0), kind=pymunk.Body.KINEMATIC, velocity=(common, 0))
        for i in range(4):
            world.box((1.5 * i, 1.0), angle=0.2 + 0.3 * i, velocity=(common + math.sin(i), 0))
        world.run(1.0, steps)
        found.append(world.state() - np.array((common, 0, 0, common, 0, 0)))
    assert found[1] == pytest.approx(
        found[0], abs={1: 1e-4, None: 1e-2}.get(steps, 1e-5) if ENGINE == "area" else 0.1
    )
