"""What a frame costs at worst: 40 boxes in any state, half of them jointed, a few frames each.

    python tests/exploding.py [--states 300] [--boxes 40] [--seed 0]

Prints the dearest frames (processor time, s) and the states that they began in; exit code 1 if one took over 0.2 s.
"""

import argparse
import math
import random
import sys
import time

import pymunk

import rigidarea as ra

DT = 1 / 60
#: A frame of 40 boxes may take so long (s of processor time).
LONGEST = 0.2


def joint(draw: random.Random, a: pymunk.Body, b: pymunk.Body) -> pymunk.Constraint:
    """Any of pymunk's ten, its anchors on the two bodies or far off, as strong as may be."""
    far = draw.choice([0, 0.3, 0.3, 100])
    at, on = [(draw.uniform(-far, far), draw.uniform(-far, far)) for _ in range(2)]
    stiff, damped = 10 ** draw.uniform(-2, 12), 10 ** draw.uniform(-2, 12)
    made: pymunk.Constraint = draw.choice(
        [
            lambda: pymunk.PivotJoint(a, b, a.position),
            lambda: pymunk.PivotJoint(a, b, at, on),
            lambda: pymunk.PinJoint(a, b, at, on),
            lambda: pymunk.SlideJoint(a, b, at, on, 0, draw.choice([0.1, 2])),
            lambda: pymunk.GrooveJoint(a, b, (-1, 0), (1, 0), on),
            lambda: pymunk.DampedSpring(a, b, at, on, 1, stiff, damped),
            lambda: pymunk.DampedRotarySpring(a, b, 0, stiff, damped),
            lambda: pymunk.RotaryLimitJoint(a, b, -0.1, 0.1),
            lambda: pymunk.RatchetJoint(a, b, 0, 0.2),
            lambda: pymunk.GearJoint(a, b, 0, draw.choice([1, 2, 100])),
            lambda: pymunk.SimpleMotor(a, b, 10 ** draw.uniform(0, 12)),
        ]
    )()
    made.collide_bodies = draw.random() < 0.5
    if draw.random() < 0.2:
        made.max_force = 10 ** draw.uniform(-2, 12)
    return made


def state(seed: int, n: int = 40) -> tuple[pymunk.Space, str]:
    """n boxes: at rest in a heap, in each other, of any mass and moment, at speeds of 1 to 1e40 sizes a second.

    Each second one has 1 to 120 joints, in a chain or between any two.
    """
    draw = random.Random(seed)
    space = pymunk.Space()
    space.gravity = 0, -10
    for at in ((-9, 0), (9, 0)), ((-9, 0), (-9, 20)), ((9, 0), (9, 20)):
        space.add(pymunk.Segment(space.static_body, *at, draw.choice([0, 0.1])))
    width = 10 ** draw.uniform(-1, 1)
    light, fast, spin = 10 ** draw.uniform(-9, 0), 10 ** draw.uniform(0, 12), 10 ** draw.uniform(0, 12)
    if draw.random() < 0.2:
        fast, spin = fast ** draw.uniform(1, 3.3), spin ** draw.uniform(1, 3.3)
    moving = draw.choice(["nobody", "one", "all"])
    for i in range(n):
        body = pymunk.Body(draw.choice([1, 1, 20]), light * draw.choice([0.1, 1]))
        body.position = draw.uniform(-width, width), draw.uniform(0.5, 0.5 + 2 * width)
        body.angle = draw.uniform(-math.pi, math.pi)
        if moving == "all" or (moving == "one" and i == 0):
            body.velocity = fast * draw.uniform(-1, 1), fast * draw.uniform(-1, 1)
            body.angular_velocity = spin * draw.uniform(-1, 1)
        box = pymunk.Poly.create_box(body, (draw.uniform(0.3, 1), draw.uniform(0.1, 1)))
        box.friction, box.elasticity = 0.5, draw.choice([0, 0.5, 1])
        space.add(body, box)
    told = f"seed {seed}: width {width:.2g}, moment {light:.1g}, {moving} at {fast:.1g}, spin {spin:.1g}"
    if seed % 2:
        bodies, many = list(space.bodies), draw.choice([1, n // 4, n - 1, 3 * n])
        for i in range(many):
            a, b = bodies[i : i + 2] if many == n - 1 else draw.sample(bodies, 2)
            space.add(joint(draw, a, b))
        told += f", {many} joints"
    return space, told


def dearest(seed: int, n: int = 40, frames: int = 6) -> tuple[float, str]:
    """The processor time of its dearest frame (s), and the state."""
    space, told = state(seed, n)
    ra.attach(space)
    most = 0.0
    for frame in range(frames):
        start = time.process_time()
        try:
            space.step(DT)
        except ra.SimulationError:
            told += f"; refused in frame {frame}"
            break
        finally:
            most = max(most, time.process_time() - start)
    return most, told


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--states", type=int, default=300)
    parser.add_argument("--boxes", type=int, default=40)
    parser.add_argument("--seed", type=int, default=0, help="of the first")
    given = parser.parse_args()
    dearest(given.seed)  # the machine code is there
    found = sorted((dearest(given.seed + i, given.boxes) for i in range(given.states)), reverse=True)
    for seconds, told in found[:8]:
        print(f"{seconds:.3f} s  {told}")
    return int(found[0][0] > LONGEST)


if __name__ == "__main__":
    sys.exit(main())
