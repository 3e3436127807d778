"""The pre-solve hook: where Chipmunk's collision response is replaced by the area force.

Chipmunk calls the global handler's pre_solve last, after positions are integrated and before velocities are: a force
set there acts in the same step, which is symplectic Euler, with joints solved after it (design 2.6). The hook

1. looks up the two outlines,
2. lets `pair_pull` find the regions and their force,
3. adds the force to the two bodies,
4. takes the arbiter's contact points away (count = 0). Chipmunk's solver then has nothing to solve, while the
   arbiter itself stays: sleeping islands, waking, post_solve and separate go on as ever. (Where there is neither
   sleeping nor a post_solve, machine code leaves it out of the step, which is faster.) process_collision is left to
   the user: where a begin or pre_solve of theirs said no, there is no force either.

This file is the readable statement of that, and a hook that runs anywhere; `machine.py` is the same in machine code.
Both call the same kernel.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import pymunk
from pymunk import Arbiter
from pymunk._chipmunk_cffi import lib

from .kernel.crowd import expected, meet_body, put_in, remember_pull, take_out
from .kernel.jit import kernel
from .kernel.pair import DONE, GROW_REGIONS, GROW_WORK, NOT_FINITE, Surface, pair_pull
from .kernel.place import Pose
from .kernel.region import Motion
from .store import Store, load_law

#: Requests of machine code to Python.
NOTHING, NEW_SHAPE, NEW_PAIR, MORE_WORK, MORE_REGIONS, BAD_STATE = range(6)


@kernel(inline="always")
def surface_velocity(
    ax: float, ay: float, bx: float, by: float, nx: float, ny: float, given_x: float, given_y: float
) -> tuple[float, float]:
    """Surface velocity of the pair, B's minus A's: the shapes', unless a callback of the user set another.

    Chipmunk has projected the shapes' onto its own tangent, which for a stand-in is not the contact's: where
    `given` is that projection, what the shapes say is used instead.
    """
    x = bx - ax
    y = by - ay
    along = x * nx + y * ny
    if abs(given_x - (x - nx * along)) + abs(given_y - (y - ny * along)) > 1e-12 * (abs(x) + abs(y)):
        return given_x, given_y
    return x, y


def pair_of_shapes(arbiter: Arbiter) -> tuple[pymunk.Shape, pymunk.Shape]:
    """A and B: the shape that was added first is A. (Chipmunk may exchange the two from step to step.)"""
    a = pymunk.Shape._from_cp_shape(arbiter._arbiter.a)
    b = pymunk.Shape._from_cp_shape(arbiter._arbiter.b)
    assert a is not None and b is not None
    return (a, b) if a._hashid < b._hashid else (b, a)


def _python_motion(body: pymunk.Body) -> Motion:
    dynamic = body.body_type == pymunk.Body.DYNAMIC
    x, y = body.local_to_world(body.center_of_gravity)
    return Motion(
        x,
        y,
        *body.velocity,
        body.angular_velocity,
        1.0 / body.mass if dynamic else 0.0,
        1.0 / body.moment if dynamic and math.isfinite(body.moment) else 0.0,
    )


def _python_pose(body: pymunk.Body) -> Pose:
    return Pose(*body.position, *body.rotation_vector)


def pre_solve(
    arbiter: Arbiter,
    space: pymunk.Space,
    store: Store,
    pair_of: Callable[[Arbiter], int],
    ask: Callable[[int, Arbiter], None],
) -> None:
    """One touching pair of one step.

    pair_of(arbiter): the pair's number in the tables. ask(request, arbiter): what machine code asks Python for.
    Two differences: a force set through pymunk wakes a sleeping body, so bodies in contact never fall asleep; and
    it costs 30 times as much.
    """
    a, b = pair_of_shapes(arbiter)
    assert a.body is not None and b.body is not None
    if not arbiter.process_collision or a.sensor or b.sensor:
        return
    if pymunk.Body.DYNAMIC not in (a.body.body_type, b.body.body_type):
        return
    arbiter._arbiter.count = 0  # nothing for Chipmunk's solver
    if not (store.knows(a._hashid) and store.knows(b._hashid)):
        ask(NEW_SHAPE, arbiter)
    p = pair_of(arbiter)
    n = arbiter._arbiter.n
    given = arbiter._arbiter.surface_vr
    sign = 1.0 if arbiter._arbiter.a == a._shape else -1.0
    surface = Surface(
        arbiter.friction,
        arbiter.restitution,
        *surface_velocity(*a.surface_velocity, *b.surface_velocity, n.x, n.y, sign * given.x, sign * given.y),
    )
    stamp = lib.cpSpaceGetTimestamp(space._space)
    motion_a, motion_b = _python_motion(a.body), _python_motion(b.body)
    rows = int(store.slots[a._hashid]), int(store.slots[b._hashid])
    for row, motion in zip(rows, (motion_a, motion_b)):
        store.tables.shapes[row]["inverse_mass"] = motion.inverse_mass
        store.tables.shapes[row]["inverse_moment"] = motion.inverse_moment
    pair = store.tables.pairs[p]
    met = [store.tables.bodies[store.tables.shapes[row]["body"]] for row in rows]
    for body in met:
        if body.stamp != stamp:
            meet_body(body, stamp)
    if pair.stamp == stamp - 1:
        take_out(met[0], -pair.fx, -pair.fy, pair.moment_a)
        take_out(met[1], pair.fx, pair.fy, pair.moment_b)
    motion_a, motion_b = (
        expected(motion, row, *space.gravity, *body.force, body.torque)
        if motion.inverse_mass > 0.0
        else motion
        for motion, row, body in zip((motion_a, motion_b), met, (a.body, b.body))
    )
    while True:
        status, pull = pair_pull(
            store.pool, store.tables, store.work, load_law(store.state[0]), p, *rows,
            _python_pose(a.body), _python_pose(b.body), motion_a, motion_b,
            surface, space.current_time_step, stamp,
        )  # fmt: skip
        if status == DONE:
            break
        ask({GROW_WORK: MORE_WORK, GROW_REGIONS: MORE_REGIONS, NOT_FINITE: BAD_STATE}[status], arbiter)
        if status == NOT_FINITE:
            return
    remember_pull(store.tables.pairs[p], pull, stamp)
    if store.tables.pairs[p].head >= 0:
        store.state[0]["touched"] = stamp
    for body, row, sign, moment in zip((a.body, b.body), met, (-1.0, 1.0), (pull.moment_a, pull.moment_b)):
        if body.body_type == pymunk.Body.DYNAMIC:
            body.force += pymunk.Vec2d(sign * pull.fx, sign * pull.fy)
            body.torque += moment
            put_in(row, sign * pull.fx, sign * pull.fy, moment)
