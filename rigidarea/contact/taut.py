"""What is taut turns more slowly: the stiffness that joints' forces give the turning of their bodies."""

from __future__ import annotations

from ..compile.jit import kernel
from .constants import FOLLOWED
from .joint_record import SPRING, anchor, held_by, unfollowed
from .tables import JOINTS, LIVE, Tables


@kernel
def geometric_stiffness(tables: Tables, h: float) -> None:
    """Bodies that their joints pull at turn more slowly: a taut chain sways no faster than the step can follow.

    A force f at the arm r resists turning with the stiffness r.f, which no row knows of (the second derivative of the
    joint, times its force; M. Tournier et al., "Stable constrained dynamics", ACM Trans. Graph. 34 (2015),
    doi:10.1145/2766969). A moment of inertia larger by h^2/4 of it is the trapezoidal rule: stable at any step, and no
    damping. What goes through more than a radian in a step takes the force at its end, and comes to rest: it sways to
    and fro from step to step, and each joint takes a quarter of how that has changed by which its bodies turn against
    each other, a link's two the whole of what has changed sign. (Else what a blow has left shook a light chain until it
    parted. What turns steadily, a crank, is not damped.) Only what lasts two substeps, for a blow is over, and only as
    far as no step follows it.
    """
    for k in range(tables.counters[LIVE]):
        body = tables.bodies[tables.live[k]]
        body.swayed = body.tension
        body.tension = 0.0
    for k in range(tables.counters[JOINTS]):
        joint = tables.joints[k]
        if joint.mine and 0 <= joint.kind <= SPRING:
            a = tables.bodies[joint.a]
            b = tables.bodies[joint.b]
            fx, fy, _ = held_by(joint, a, b)
            ax, ay = anchor(a, joint.p[0], joint.p[1])
            bx, by = anchor(b, joint.p[2], joint.p[3])
            a.tension -= ax * fx + ay * fy
            b.tension += bx * fx + by * fy
    for k in range(tables.counters[LIVE]):
        body = tables.bodies[tables.live[k]]
        body.own_inverse_moment = body.inverse_moment
        phase2 = h * h * min(body.tension, body.swayed) * body.inverse_moment
        body.swayed = 0.0
        if body.calm < 0 and body.inverse_moment > 0.0 and phase2 > FOLLOWED:
            fast = phase2 * unfollowed(phase2, 1.0)
            more = 0.25 * phase2 * unfollowed(phase2, FOLLOWED) + fast
            body.inverse_moment /= 1.0 + more
            body.swayed = fast / (1.0 + more)
    for k in range(tables.counters[JOINTS]):
        joint = tables.joints[k]
        if joint.mine and 0 <= joint.kind <= SPRING:
            a = tables.bodies[joint.a]
            b = tables.bodies[joint.b]
            part = max(a.swayed, b.swayed)
            if part > 0.0 and a.inverse_moment > 0.0 and b.inverse_moment > 0.0:
                change = a.w - a.kick_w - a.turned - (b.w - b.kick_w - b.turned)
                lost = 0.25 * part * change / (a.own_inverse_moment + b.own_inverse_moment)
                a.w -= lost * a.own_inverse_moment
                b.w += lost * b.own_inverse_moment
                a.came_w = a.w
                b.came_w = b.w
    for k in range(tables.counters[LIVE]):
        body = tables.bodies[tables.live[k]]
        body.turned = body.w - body.kick_w


@kernel
def free_turning(tables: Tables) -> None:
    """After the substep's solve: every body turns as it does."""
    for k in range(tables.counters[LIVE]):
        body = tables.bodies[tables.live[k]]
        body.inverse_moment = body.own_inverse_moment
