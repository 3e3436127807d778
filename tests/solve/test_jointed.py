"""Nobody is shot by joints that do not fit, by motors against walls, by paddles: seeded scenes as users make them."""

import numpy as np
import pymunk
import pytest
from jointed_scenes import DT, run
from solve_world import ENGINE

import rigidarea as ra

pytestmark = pytest.mark.skipif(ENGINE == "pymunk", reason="of area contact beside pymunk's own response")
#: Frames of a scene, five seconds; and of those in which a body was seen shot, up to then and half a second more.
FRAMES = 300
#: Seen shot while joints began before pairs were looked at, and with all that they had borne against contacts that had
#: come off since (up to 2e6 px/s; 8e9 of a motor that turns a plank against a wall).
#: The last nine by rods, grooves and limits that nearly contradict each other (up to 8e11 px/s).
SHOT = {22: 60, 98: 90, 117: 40, 129: 160, 159: 240, 196: 40, 216: 240}
SHOT |= {195: 60, 247: 280, 273: 20, 631: 100, 864: 80, 1179: 40, 1239: 10, 1327: 300, 2296: 300}


def fastest(seed: int, frames: int, attached: bool) -> float:
    """The fastest body's speed (px/s); infinite where one is not finite."""
    seen = run(seed, frames, attached)
    return seen.fastest if seen.finite else np.inf


def flies_off(speed: float, other: float) -> bool:
    """Whether a body was faster than 1,500 px/s and three times the fastest by the other response; or not finite."""
    return not np.isfinite(speed) or speed > max(1500.0, 3 * other)


def shot(seed: int, frames: int) -> bool:
    """Whether a body flies off, beside pymunk's own response."""
    speed = fastest(seed, frames, True)
    return speed > 1500.0 and flies_off(speed, fastest(seed, frames, False))


@pytest.mark.parametrize("seed", SHOT)
def test_who_was_shot_is_not(seed):
    """The scenes in which it has happened."""
    assert not shot(seed, SHOT[seed])


@pytest.mark.slow
def test_of_many_scenes_hardly_one_shoots():
    """Of 3,000 at most 20: measured 14. By pymunk's own response one in seven or more, the other way round: 443.

    (6 to 10 before faces that bear on one end took part in the search, and a crank was no sway: 13 without the first.)

    (17 while what joints mend counted as if all their speeds were one's, and a capsule across a thin one was thrown.)

    (75 while joints that nearly contradict each other were all held, 20 while those that do gave what it took. What is
    left: paddles and platforms that wedge bodies in corners.)
    """
    speeds = [(fastest(seed, FRAMES, True), fastest(seed, FRAMES, False)) for seed in range(3000)]
    ours = sum(flies_off(here, there) for here, there in speeds)
    theirs = sum(flies_off(there, here) for here, there in speeds)
    print(f"of {len(speeds)} scenes a body flies off in {ours}, by pymunk's own response in {theirs}")
    assert ours <= 20
    assert theirs >= len(speeds) / 7


def test_there_is_room_for_joints_whose_bodies_do_not_collide():
    """As much from the start as for joints: five of them wrote past the table's end."""
    space = pymunk.Space()
    for i in range(7):
        a, b = (pymunk.Body(1, 1) for _ in range(2))
        a.position, b.position = (30 * i, 0), (30 * i + 5, 0)
        joint = pymunk.PivotJoint(a, b, (30 * i, 0))
        joint.collide_bodies = False
        space.add(a, b, pymunk.Circle(a, 5), pymunk.Circle(b, 5), joint)
    contact = ra.attach(space)
    space.step(DT)
    tables = contact._store.tables
    assert len(tables.apart) >= len(tables.joints)
    assert len(np.unique(tables.apart[:7, 0])) == 7
