"""Bodies of a pymunk space that yield, moved through a frame in steps of their own: the compiled part of ``assembly``.

Frames are rigid bodies of Chipmunk's, by the leapfrog: half a drift; contact (``step`` with the frames given: loads and
modes are found for where they are); the contacts' forces, gravity and the user's forces change velocities; then
joints do, by Chipmunk's own functions, sequential impulses as in its solver but at this finer step; the other half of
the drift. Under constant forces that is exact, whatever the number of steps, and a step that changes with the motion
gives no energy, as symplectic Euler's does (E. Hairer, C. Lubich, G. Wanner, Geometric Numerical Integration, VIII.2).
What joints do to a body is the load on its hub, as far as it has one.

What bodies of no part do to a member is known once a frame, after its steps, and acts in the next one ahead of time: as
far as it has balanced the other loads, as a constant acceleration (``bear_x`` …), which is taken out again before they
answer themselves (impulses of several time steps: J. J. Biesiadecki and R. D. Skeel, J. Comput. Phys. 109, 1993,
doi:10.1006/jcph.1993.1220). So what lies on a floor lies still, and what lies on it is carried.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from rigidarea.compile.jit import entry, kernel
from rigidarea.compile.raw_memory import array_at, caller, record
from rigidarea.contact.space_record import OFFSETS
from rigidarea.flexible.bodies import work_at
from rigidarea.flexible.resist import keep_springs
from rigidarea.flexible.step import spin_of_modes, step

Ints = NDArray[np.int64]

#: One body that moves in steps of ours.
MEMBER = record(
    [
        ("address", "u8"),  # Chipmunk's body
        ("led", "i8"),  # 1: moves as told (kinematic, static) and has no part: Chipmunk goes on moving it
        ("hub", "i8"),  # 1: has a hub, which joints load
        ("x", "f8"), ("y", "f8"), ("angle", "f8"),  # centre of gravity, world
        ("vx", "f8"), ("vy", "f8"), ("w", "f8"),
        ("inverse_mass", "f8"), ("inverse_moment", "f8"),
        ("ax", "f8"), ("ay", "f8"), ("alpha", "f8"),  # by gravity and the user's forces, constant in a frame
        ("bear_x", "f8"), ("bear_y", "f8"), ("bear_w", "f8"),  # of that, by the space's own frame before
        ("rest_x", "f8"), ("rest_y", "f8"), ("rest_w", "f8"),  # all that this did, over its length
        ("mend_x", "f8"), ("mend_y", "f8"), ("mend_w", "f8"),  # drift that takes it out of overlaps: no velocity
        ("was_x", "f8"), ("was_y", "f8"), ("was_w", "f8"),  # its velocity at the frame's start
        ("turn", "f8"),  # angular acceleration of the last step, which modes feel
        ("cog_x", "f8"), ("cog_y", "f8"),  # in the body's coordinates
        ("off_x", "f8"), ("off_y", "f8"),  # from there to the origin of the part's boundary
        ("hub_x", "f8"), ("hub_y", "f8"),  # and from the centre of gravity to its hub
    ]
)  # fmt: skip
#: One of their joints.
LINK = record(
    [
        ("address", "u8"),
        ("a", "i8"), ("b", "i8"),  # members
        ("at", "i8"), ("count", "i8"),  # where it keeps its impulse (bytes), and how many numbers that is
        ("arms", "i8"),  # of a pivot: where it keeps its anchors (bytes); -1
        ("x", "f8"), ("y", "f8"),  # impulse summed over the frame
        ("warm_x", "f8"), ("warm_y", "f8"),  # of the last step
    ]
)  # fmt: skip
#: Where Chipmunk's structs have what: byte offsets, by the names of ``store.OFFSETS``.
PLACES = record([(name, "i8") for name in OFFSETS])

#: Part of a joint's load that reaches its hub in a step: the hub yields to the loads of the step before, which is
#: stable while contacts are less than 2 / this - 1 times as stiff as the body between hub and contact.
HUB_SHARE = 0.1

_call = caller("void(uintp, float64)")
_PRE_STEP, _APPLY_CACHED, _APPLY = 0, 1, 2  # places of a joint's functions in its class


@kernel(inline="always")
def _floats(address, n):  # type: ignore[no-untyped-def]
    return array_at(np.uint64(address), (n,), np.float64)


@entry
def gather(members: Any, offsets: Any, gx: float, gy: float, damping: float, dt: float) -> None:
    """Where Chipmunk has the members, how they move, and what acts on them for a frame of dt."""
    for m in range(len(members)):
        a = members[m]
        p = _floats(a.address + np.uint64(offsets.body_position), 2)
        v = _floats(a.address + np.uint64(offsets.body_velocity), 2)
        cog = _floats(a.address + np.uint64(offsets.body_cog), 2)
        f = _floats(a.address + np.uint64(offsets.body_force), 2)
        a.x, a.y = p[0], p[1]
        a.angle = _floats(a.address + np.uint64(offsets.body_angle), 1)[0]
        a.vx, a.vy = v[0], v[1]
        a.w = _floats(a.address + np.uint64(offsets.body_spin), 1)[0]
        # the part and its hub stay where they are in the body, its centre of gravity may have been moved
        a.off_x += a.cog_x - cog[0]
        a.off_y += a.cog_y - cog[1]
        a.hub_x += a.cog_x - cog[0]
        a.hub_y += a.cog_y - cog[1]
        a.cog_x, a.cog_y = cog[0], cog[1]
        a.inverse_mass = _floats(a.address + np.uint64(offsets.body_inverse_mass), 1)[0]
        a.inverse_moment = _floats(a.address + np.uint64(offsets.body_inverse_moment), 1)[0]
        a.ax = a.ay = a.alpha = 0.0
        if a.inverse_mass > 0.0:
            keep = damping**dt
            a.vx *= keep
            a.vy *= keep
            a.w *= keep
            a.was_x, a.was_y, a.was_w = a.vx, a.vy, a.w
            a.ax = gx + f[0] * a.inverse_mass + a.bear_x
            a.ay = gy + f[1] * a.inverse_mass + a.bear_y
            torque = _floats(a.address + np.uint64(offsets.body_torque), 1)[0]
            a.alpha = torque * a.inverse_moment + a.bear_w


@kernel
def _write_place(a, offsets):  # type: ignore[no-untyped-def]
    p = _floats(a.address + np.uint64(offsets.body_position), 2)
    p[0], p[1] = a.x, a.y
    _floats(a.address + np.uint64(offsets.body_angle), 1)[0] = a.angle
    c, s = np.cos(a.angle), np.sin(a.angle)
    t = _floats(a.address + np.uint64(offsets.body_transform), 6)
    t[0], t[1], t[2], t[3] = c, s, -s, c
    t[4] = a.x - (c * a.cog_x - s * a.cog_y)
    t[5] = a.y - (s * a.cog_x + c * a.cog_y)


@kernel
def _write_motion(a, offsets):  # type: ignore[no-untyped-def]
    v = _floats(a.address + np.uint64(offsets.body_velocity), 2)
    v[0], v[1] = a.vx, a.vy
    _floats(a.address + np.uint64(offsets.body_spin), 1)[0] = a.w


@entry
def give_back(members: Any, start: Any, offsets: Any, dt: float) -> None:
    """Chipmunk's bodies where the members are, forces and what was borne ahead of time used up in ``dt`` (0: not);
    those that are led as in ``start``."""
    for m in range(len(members)):
        a = members[m]
        if a.led == 1:
            _write_place(start[m], offsets)
            continue
        a.vx -= dt * a.bear_x
        a.vy -= dt * a.bear_y
        a.w -= dt * a.bear_w
        _write_place(a, offsets)
        _write_motion(a, offsets)
        if dt == 0.0:
            continue
        f = _floats(a.address + np.uint64(offsets.body_force), 2)
        f[0] = f[1] = 0.0
        _floats(a.address + np.uint64(offsets.body_torque), 1)[0] = 0.0


@entry
def note_rest(members: Any, offsets: Any, dt: float) -> None:
    """What the space's own frame of dt has done to the members, for the next one.

    Of an acceleration so much lasts as was there in the frame before (minmod), and as it left the velocity as it was
    when the frame began: one that made half of itself, or more, of a change of velocity was a blow.
    """
    for m in range(len(members)):
        a = members[m]
        if a.led == 1 or a.inverse_mass == 0.0:
            continue
        v = _floats(a.address + np.uint64(offsets.body_velocity), 2)
        w = _floats(a.address + np.uint64(offsets.body_spin), 1)[0]
        x, y, turn = (v[0] - a.vx) / dt, (v[1] - a.vy) / dt, (w - a.w) / dt
        arm = a.inverse_mass / a.inverse_moment if a.inverse_moment > 0.0 else 0.0  # mass is the metric
        square = x * x + y * y + arm * turn * turn
        part = 0.0
        if square > 0.0:
            changed = x * (v[0] - a.was_x) + y * (v[1] - a.was_y) + arm * turn * (w - a.was_w)
            before = x * a.rest_x + y * a.rest_y + arm * turn * a.rest_w
            part = max(0.0, 1.0 - 2.0 * abs(changed) / (dt * square)) * min(1.0, max(0.0, before / square))
        a.rest_x, a.rest_y, a.rest_w = x, y, turn
        a.bear_x, a.bear_y, a.bear_w = part * x, part * y, part * turn
        # Chipmunk's v_bias and w_bias, behind its transform and the user's pointer: used once
        mend = _floats(a.address + np.uint64(offsets.body_transform) + np.uint64(56), 3)
        a.mend_x, a.mend_y, a.mend_w = mend[0], mend[1], mend[2]
        mend[0] = mend[1] = mend[2] = 0.0


@kernel
def _drift(members, h):  # type: ignore[no-untyped-def]
    for m in range(len(members)):
        a = members[m]
        a.x += h * (a.vx + a.mend_x)
        a.y += h * (a.vy + a.mend_y)
        a.angle += h * (a.w + a.mend_w)


@kernel
def _place_frame(state, members, b, h):  # type: ignore[no-untyped-def]
    """The frame of part b, such that the scheme's predictor, which moves all frames, takes it to its place."""
    a = members[b]
    c, s = np.cos(a.angle), np.sin(a.angle)
    state.x[b, 0] = a.x + c * a.off_x - s * a.off_y
    state.x[b, 1] = a.y + s * a.off_x + c * a.off_y
    for i in range(2):
        state.v[b, i] = state.acc[b, i] = state.aux[b, i] = 0.0
    state.acc[b, 2] = state.aux[b, 2] = a.turn
    state.v[b, 2] = a.w - h * a.turn
    state.x[b, 2] = a.angle - h * state.v[b, 2] - 0.5 * h * h * a.turn


@kernel
def _rate(rate, a):  # type: ignore[no-untyped-def]
    """The velocity of a part's frame."""
    c, s = np.cos(a.angle), np.sin(a.angle)
    rate[0] = a.vx - a.w * (s * a.off_x + c * a.off_y)
    rate[1] = a.vy + a.w * (c * a.off_x - s * a.off_y)
    rate[2] = a.w


@kernel
def _round_the_bend(members, link, offsets, h):  # type: ignore[no-untyped-def]
    """Has a pivot's speed end on the arms' circle: a step along the tangent ends (ω h)²/2 of the arm beside it.

    As an error of place it would be taken back (``error_bias``) when ω is another: that takes energy. ω is that after
    the impulses of the step before: one that lags gives energy.
    """
    anchors = _floats(link.address + np.uint64(link.arms), 4)
    bias = link.address + np.uint64(link.at) + np.uint64(16)  # of cpPivotJoint, behind its impulse
    speed = _floats(bias, 2)
    for side in range(2):
        a, sign = (members[link.a], -0.5) if side == 0 else (members[link.b], 0.5)
        x, y = anchors[2 * side] - a.cog_x, anchors[2 * side + 1] - a.cog_y
        c, s = np.cos(a.angle), np.sin(a.angle)
        w = _floats(a.address + np.uint64(offsets.body_spin), 1)[0]
        speed[0] += sign * h * w * w * (c * x - s * y)
        speed[1] += sign * h * w * w * (s * x + c * y)


@kernel
def _joints(members, links, offsets, h, iterations, factor):  # type: ignore[no-untyped-def]
    """All joints' impulses of one step, on the members' velocities; ``factor``: this step over the last.

    Chipmunk applies the impulse of the step before times a factor but goes on from all of it: scaled here instead.
    """
    for m in range(len(members)):
        _write_place(members[m], offsets)
        _write_motion(members[m], offsets)
    for j in range(len(links)):
        link = links[j]
        if link.count > 0:
            impulse = _floats(link.address + np.uint64(link.at), link.count)
            impulse[link.count - 1] = factor * link.warm_y
            impulse[0] = factor * link.warm_x
        _run(link.address, _PRE_STEP, h)
    for j in range(len(links)):
        _run(links[j].address, _APPLY_CACHED, 1.0)
    for j in range(len(links)):
        if links[j].arms >= 0:
            _round_the_bend(members, links[j], offsets, h)
    for _ in range(iterations):
        for j in range(len(links)):
            _run(links[j].address, _APPLY, h)
    for j in range(len(links)):
        link = links[j]
        if link.count > 0:
            impulse = _floats(link.address + np.uint64(link.at), link.count)
            link.warm_x = impulse[0]
            link.warm_y = impulse[1] if link.count > 1 else 0.0
            link.x += link.warm_x
            link.y += link.warm_y
    for m in range(len(members)):
        a = members[m]
        v = _floats(a.address + np.uint64(offsets.body_velocity), 2)
        a.vx, a.vy = v[0], v[1]
        a.w = _floats(a.address + np.uint64(offsets.body_spin), 1)[0]


@kernel
def _run(joint, which, x):  # type: ignore[no-untyped-def]
    """One of a joint's own functions."""
    kind = array_at(np.uint64(joint), (1,), np.uint64)[0]
    _call(array_at(kind, (4,), np.uint64)[which], np.uint64(joint), x)


@kernel
def _stiffest(members, pairs, st, buf):  # type: ignore[no-untyped-def]
    """Largest k L W of all regions: a contact's squared angular frequency, on bodies without joints."""
    most = 0.0
    for i in range(buf.counts[0]):
        r = buf.regions[i]
        p = int(r[0])
        mobility = 0.0
        for side in range(2):
            a = members[pairs[p, side]]
            turn = (r[4] - a.x) * r[3] - (r[5] - a.y) * r[2]
            mobility += a.inverse_mass + turn * turn * a.inverse_moment
        most = max(most, st.k * r[6] * mobility)
    return most


@entry
def advance(  # type: ignore[no-untyped-def]
    bodies, sy, state, pairs, st, s, found, buf, members, links, offsets, h, steps, iterations, before
):
    """Moves members by ``steps`` steps of h; the first of them are the system's bodies. ``before``: the last step's h.

    Returns (iterations of the last step, or an error code of ``step``; the largest squared frequency of a contact).
    """
    count = len(sy.mass)
    stiffest = 0.0
    code = 0
    for n in range(steps):
        _drift(members, 0.5 * h)
        for b in range(count):
            _place_frame(state, members, b, h)
            _rate(buf.rate[b], members[b])
            buf.momentum[b] = 0.0
            if members[b].inverse_moment > 0.0:
                more, swing = spin_of_modes(bodies, sy, state, b)
                buf.momentum[b] = (1.0 / members[b].inverse_moment + more) * members[b].w + swing
            w, mu, angle = work_at(bodies, b), state.mu[b], members[b].angle
            c, sn = np.cos(angle), np.sin(angle)
            w.hub_load[0], w.hub_load[1], w.hub_load[2] = (
                c * mu[0] + sn * mu[1],
                -sn * mu[0] + c * mu[1],
                mu[2],
            )
        code = step(bodies, sy, state, pairs, st, s, found, buf, 0.0, h)
        if code < 0:
            return code, stiffest
        keep_springs(buf, 0, 1)
        stiffest = max(stiffest, _stiffest(members, pairs, st, buf))
        for m in range(len(members)):
            a = members[m]
            if a.inverse_mass == 0.0:
                continue
            fx = fy = moment = 0.0
            if m < count:
                fx, fy, moment = buf.load[m, 0], buf.load[m, 1], buf.load[m, 2]
                moment += (buf.pose[m, 0] - a.x) * fy - (buf.pose[m, 1] - a.y) * fx
            a.vx += h * (a.ax + fx * a.inverse_mass)
            a.vy += h * (a.ay + fy * a.inverse_mass)
            a.turn = a.w
            a.w += h * (a.alpha + moment * a.inverse_moment)
            # frame and modes turn together: what they exchange is in neither's sum
            if m < count and sy.first[m + 1] > sy.first[m] and a.inverse_moment > 0.0:
                more, swing = spin_of_modes(bodies, sy, state, m)
                momentum = buf.momentum[m] + h * (a.alpha / a.inverse_moment + moment)
                a.w = (momentum - swing) / (1.0 / a.inverse_moment + more)
        for b in range(count):  # what joints will have added, less what there is now
            _load_hub(state.mu[b], members[b], buf.load[b], buf.pose[b], h, -1.0)
        if len(links) > 0:
            _joints(members, links, offsets, h, iterations, h / before if n == 0 else 1.0)
        for b in range(count):
            a = members[b]
            _load_hub(state.mu[b], a, buf.load[b], buf.pose[b], h, 1.0)
            a.turn = (a.w - a.turn) / h if a.inverse_mass > 0.0 else 0.0
        _drift(members, 0.5 * h)
    return code, stiffest


@kernel
def _load_hub(mu, a, load, pose, h, sign):  # type: ignore[no-untyped-def]
    """The hub's load nears what joints do: momentum after them less momentum before, over h.

    Called with -1 before the joints and with +1 after them. Of a body that moves as told, whatever holds it carries
    the contacts.
    """
    if a.hub == 0:
        return
    share = HUB_SHARE
    if sign < 0.0:
        for i in range(3):
            mu[i] *= 1.0 - share
    if a.inverse_mass > 0.0:
        fx, fy = a.vx / (a.inverse_mass * h), a.vy / (a.inverse_mass * h)
        moment = a.w / (a.inverse_moment * h) if a.inverse_moment > 0.0 else 0.0
    elif sign > 0.0:
        fx, fy = -load[0], -load[1]
        moment = -load[2] - ((pose[0] - a.x) * load[1] - (pose[1] - a.y) * load[0])
    else:
        return
    c, s = np.cos(a.angle), np.sin(a.angle)
    x, y = c * a.hub_x - s * a.hub_y, s * a.hub_x + c * a.hub_y
    mu[0] += sign * share * fx
    mu[1] += sign * share * fy
    mu[2] += sign * share * (moment - (x * fy - y * fx))
