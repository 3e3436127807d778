"""A box or a bar that stands on a corner topples, and its other corner comes down: it bounces there as elasticity says.

Its first corner rests meanwhile, so that nothing of the pair's is new. Reference: pymunk's own response at 64 steps a
frame and 60 iterations, where 256 steps have the same energy after that blow. Compared is the energy that is left to
fall and turn (of the lying box: none), sampled when it has ceased to turn down.
"""

import math
import random
import statistics
from typing import NamedTuple

import pymunk
import pytest

import rigidarea

GRAVITY = 900.0
#: A bounce is well above rest where the corner leaves faster than this many frames' gravity: it is up for three frames.
FRAMES_OF_GRAVITY = 2.0


class Topple(NamedTuple):
    """A box of mass 1, `wide` and `high`, tilted about its lower left corner by `tilt`; what it falls on."""

    wide: float
    high: float
    tilt: float
    e: float
    friction: float
    dt: float
    ground: str

    @property
    def moment(self) -> float:
        """About the centre."""
        return pymunk.moment_for_box(1, (self.wide, self.high))

    def at_rest(self) -> float:
        """The energy with which its far corner leaves, turning about the near one, at what is hardly a bounce."""
        turn = FRAMES_OF_GRAVITY * GRAVITY * self.dt / self.wide
        return 0.5 * (self.moment + 0.25 * (self.wide**2 + self.high**2)) * turn**2


def draw(seed: int, dt: float, ground: str) -> Topple:
    """A random one."""
    rng = random.Random(seed)
    wide = rng.uniform(20, 60)
    high = wide * (1.0 if rng.random() < 0.5 else rng.uniform(0.15, 1.0))
    return Topple(
        wide, high, rng.uniform(0.1, 0.5), rng.uniform(0.2, 1), rng.choice([0, rng.random()]), dt, ground
    )


def put_ground(space: pymunk.Space, ground: str) -> None:
    """What it falls on, its surface at 0: elasticity and friction of 1."""
    if ground == "segment":
        shape = pymunk.Segment(space.static_body, (-900, -9), (900, -9), 9)
    elif ground == "block":
        shape = pymunk.Poly(space.static_body, [(-900, -90), (900, -90), (900, 0), (-900, 0)])
    else:  # a heavy plate that lies on a floor off which nothing bounces
        floor = pymunk.Segment(space.static_body, (-900, -29), (900, -29), 9)
        floor.friction = 1.0
        plate = pymunk.Body(100, pymunk.moment_for_box(100, (400, 20)))
        plate.position = 0, -10
        shape = pymunk.Poly.create_box(plate, (400, 20))
        space.add(floor, plate)
    shape.elasticity = shape.friction = 1.0
    space.add(shape)


def left(case: Topple, steps: int, until: float = 0.0) -> float:
    """Its energy after the blow of its far corner, or at a time.

    steps a frame, by pymunk's own response; 0: one, by ours.
    """
    space = pymunk.Space()
    space.gravity = 0, -GRAVITY
    box = pymunk.Body(1, case.moment)
    shape = pymunk.Poly.create_box(box, (case.wide, case.high))
    shape.elasticity, shape.friction = case.e, case.friction
    box.angle = case.tilt
    box.position = 0, 0.5 * (case.wide * math.sin(case.tilt) + case.high * math.cos(case.tilt))
    space.add(box, shape)
    put_ground(space, case.ground)
    if steps == 0:
        rigidarea.attach(space)
    else:
        space.iterations = 60
    fastest = 0.0
    for _ in range(round((until or 1.0) / case.dt)):
        for _ in range(max(1, steps)):
            space.step(case.dt / max(1, steps))
        fastest = min(fastest, box.angular_velocity)
        if until == 0.0 and fastest < -0.5 and box.angular_velocity > 0.1 * fastest:
            break
    energy = 0.5 * box.velocity.y**2 + 0.5 * case.moment * box.angular_velocity**2
    return energy + GRAVITY * max(0.0, box.position.y - 0.5 * case.high)


def ratios(dt: float, ground: str, seeds: range) -> list[float]:
    """Energy left by ours over that left by the reference, where that is sure and well above rest; sorted."""
    found = []
    for seed in seeds:
        case = draw(seed, dt, ground)
        fine = left(case, 64)
        if fine > case.at_rest() and abs(left(case, 256) / fine - 1.0) < 0.1:
            found.append(left(case, 0) / fine)
    return sorted(found)


@pytest.mark.parametrize("ground", ["segment", "block", "plate"])
@pytest.mark.parametrize("dt", [1 / 60, 1 / 120])
def test_the_second_corner_bounces(dt: float, ground: str) -> None:
    """Of a hundred hardly one loses half of the energy (41 to 49 on what does not move, 2 on the plate, when a face
    that had grown from a corner was rest); of pymunk's single step none.

    The median is the reference's to a twentieth. The worst tenth has .82 to .93 of it, as of pymunk's single step: the
    corner is found up to a substep's way inside, and leaves from there.
    """
    found = ratios(dt, ground, range(100))
    assert len(found) > 80
    assert sum(ratio < 0.5 for ratio in found) <= 2
    assert statistics.median(found) == pytest.approx(1.0, abs=0.05)
    assert found[len(found) // 10] > 0.75


@pytest.mark.parametrize("ground", ["segment", "block", "plate"])
def test_it_comes_to_rest(ground: str) -> None:
    """Bounce follows upon bounce, each lower by e^2: after three seconds nothing is left, for e up to .6."""
    for seed in range(20):
        case = draw(seed, 1 / 60, ground)._replace(e=0.2 + 0.02 * seed)
        assert left(case, 0, 3.0) < 1e-3 * case.at_rest()
