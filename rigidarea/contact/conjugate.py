"""Many rows at once: a direction that is exact where contacts form trees, followed as conjugate gradients do.

A sweep passes a load on from body to body, and takes as many sweeps as there are bodies, squared where they bend.
Taken in order, from the bottom to the top, each row leaves its bodies less mobile than it has found them: what stands
on the ground is as heavy as the ground, for whoever comes to stand on it. With that, one pass up and one back solve a
tower, a chain, a heavy crate on light ones exactly (Featherstone's articulated inertia,
doi:10.1177/027836498300200102; an elimination whose fill is dropped, Saad, Iterative Methods for Sparse Linear
Systems, 10.3).
In a pile, where supports are shared, it is the preconditioner of conjugate gradients (Hestenes & Stiefel, J Res NBS 49
(1952), doi:10.6028/jres.049.044).

The system is that of the rows that bear: a face on both ends, a point that presses, friction that grips. An end that
the step would pull on is let go, and the search begins anew; what ought to press again is found by the sweeps before
and after.
"""

from __future__ import annotations

from typing import Any

from ..compile.jit import kernel
from .joint import clamp_joint
from .preconditioner import take_part
from .row import push
from .tables import LIVE, ROWS, Tables


@kernel
def _forget(tables: Tables) -> None:
    """No velocities, no impulses."""
    for k in range(tables.counters[LIVE]):
        i = tables.live[k]
        m = tables.mobility[i]
        m.x = 0.0
        m.y = 0.0
        m.w = 0.0


@kernel
def _residual(row: Any, f: Any, a: Any, b: Any) -> None:
    """What a row lacks at the present velocities, as a velocity: nothing where a visit would change nothing."""
    ux = a.vx - b.vx
    uy = a.vy - b.vy
    v = ux * row.nx + uy * row.ny + (a.w * row.arm_a - b.w * row.arm_b)
    turn = a.w - b.w
    v1 = v - (turn * row.e1 + row.t1)
    v2 = v - (turn * row.e2 + row.t2)
    f.r1 = 0.0
    f.r2 = 0.0
    if f.first:
        f.r1 = f.e11 * (row.f1 - row.l1) + f.e12 * (row.f2 - row.l2) + v1
    if f.second:
        f.r2 = f.e12 * (row.f1 - row.l1) + f.e11 * (row.f2 - row.l2) + v2
    slip = uy * row.nx - ux * row.ny + (a.w * row.lean_a - b.w * row.lean_b)
    f.rt = f.et * (row.ft - row.lt) + slip - row.tt


@kernel
def _up(tables: Tables) -> None:
    """Residuals, and the pass in the order of the rows."""
    _forget(tables)
    for i in range(tables.counters[ROWS]):
        f = tables.factors[i]
        if not (f.first or f.second or f.grip):
            continue
        row = tables.rows[i]
        _residual(row, f, tables.bodies[row.a], tables.bodies[row.b])
        ma = tables.mobility[row.a]
        mb = tables.mobility[row.b]
        ux = ma.x - mb.x
        uy = ma.y - mb.y
        v = ux * row.nx + uy * row.ny + (ma.w * row.arm_a - mb.w * row.arm_b)
        turn = ma.w - mb.w
        r1 = f.r1 - (v - turn * row.e1)
        rt = f.rt - (uy * row.nx - ux * row.ny + (ma.w * row.lean_a - mb.w * row.lean_b))
        z1 = f.d11 * r1 + f.d1t * rt
        zt = f.d1t * r1 + f.dtt * rt
        f.z2 = 0.0
        if f.second:
            r2 = f.r2 - (v - turn * row.e2)
            z2 = f.d12 * r1 + f.d22 * r2 + f.d2t * rt
            z1 += f.d12 * r2
            zt += f.d2t * r2
            f.z2 = z2
            ma.x += f.ax2 * z2
            ma.y += f.ay2 * z2
            ma.w += f.aw2 * z2
            mb.x -= f.bx2 * z2
            mb.y -= f.by2 * z2
            mb.w -= f.bw2 * z2
        f.z1 = z1
        f.zt = zt
        ma.x += f.ax1 * z1 + f.axt * zt
        ma.y += f.ay1 * z1 + f.ayt * zt
        ma.w += f.aw1 * z1 + f.awt * zt
        mb.x -= f.bx1 * z1 + f.bxt * zt
        mb.y -= f.by1 * z1 + f.byt * zt
        mb.w -= f.bw1 * z1 + f.bwt * zt


@kernel
def _down(tables: Tables) -> float:
    """The pass back; the residual times the direction, which is what the next step's length is judged by."""
    _forget(tables)
    total = 0.0
    n = tables.counters[ROWS]
    for k in range(n):
        f = tables.factors[n - 1 - k]
        if not (f.first or f.second or f.grip):
            continue
        row = tables.rows[n - 1 - k]
        ma = tables.mobility[row.a]
        mb = tables.mobility[row.b]
        g1 = f.ax1 * ma.x + f.ay1 * ma.y + f.aw1 * ma.w - (f.bx1 * mb.x + f.by1 * mb.y + f.bw1 * mb.w)
        gt = f.axt * ma.x + f.ayt * ma.y + f.awt * ma.w - (f.bxt * mb.x + f.byt * mb.y + f.bwt * mb.w)
        if f.second:
            g2 = f.ax2 * ma.x + f.ay2 * ma.y + f.aw2 * ma.w - (f.bx2 * mb.x + f.by2 * mb.y + f.bw2 * mb.w)
            f.z1 -= f.d12 * g2
            f.z2 -= f.d12 * g1 + f.d22 * g2 + f.d2t * gt
            f.zt -= f.d2t * g2
        f.z1 -= f.d11 * g1 + f.d1t * gt
        f.zt -= f.d1t * g1 + f.dtt * gt
        total += f.r1 * f.z1 + f.r2 * f.z2 + f.rt * f.zt
        _give(row, f, ma, mb)
    return total


@kernel
def descend(tables: Tables, before: float, enough: float) -> float:
    """One step of the search, after `take_part`: what to say `before` in the next; 0 where it must begin anew.

    Nothing is done where no more than `enough` is left.
    """
    _up(tables)
    product = _down(tables)
    if not product > enough:
        return 0.0
    beta = product / before if before > 0.0 else 0.0
    curvature = 0.0
    for k in range(tables.counters[LIVE]):
        i = tables.live[k]
        body = tables.bodies[i]
        m = tables.mobility[i]
        m.ux = m.x + (beta * m.ux if beta > 0.0 else 0.0)
        m.uy = m.y + (beta * m.uy if beta > 0.0 else 0.0)
        m.uw = m.w + (beta * m.uw if beta > 0.0 else 0.0)
        curvature += body.inverse_mass * (m.ux * m.ux + m.uy * m.uy) + body.inverse_moment * m.uw * m.uw
    ahead = 0.0  # of the whole direction: a clamp before has left some of the old one
    for i in range(tables.counters[ROWS]):
        f = tables.factors[i]
        if f.first or f.second or f.grip:
            f.p1 = f.z1 + beta * f.p1
            f.p2 = f.z2 + beta * f.p2
            f.pt = f.zt + beta * f.pt
            ahead += f.r1 * f.p1 + f.r2 * f.p2 + f.rt * f.pt
            curvature += (
                f.e11 * f.p1 * f.p1 + f.e11 * f.p2 * f.p2 + 2.0 * f.e12 * f.p1 * f.p2 + f.et * f.pt * f.pt
            )
    if not (ahead > 0.0 and curvature > 0.0):
        return 0.0
    if _clamp(tables, ahead / curvature):
        _go(tables, 1.0)
        return product
    _go(tables, _best(tables))
    return 0.0


@kernel
def _clamp(tables: Tables, length: float) -> bool:
    """The step so far in the direction of the search, no end pulling, no friction beyond its bound; whether none was.

    What may be done is convex, so that any part of the step may be.
    """
    whole = True
    for i in range(tables.counters[ROWS]):
        f = tables.factors[i]
        if not (f.first or f.second or f.grip):
            continue
        row = tables.rows[i]
        l1 = row.l1 + length * f.p1
        l2 = row.l2 + length * f.p2
        lt = row.lt + length * f.pt
        if row.ends == 0:
            f.z1, f.zt = clamp_joint(row, l1, lt)
            whole = whole and f.z1 == l1 and f.zt == lt
            f.z1 -= row.l1
            f.z2 = 0.0
            f.zt -= row.lt
            continue
        if l1 < 0.0 or l2 < 0.0:
            whole = False
            l1 = max(0.0, l1)
            l2 = max(0.0, l2)
        most = row.friction * (l1 + l2)
        if abs(lt) > most:
            whole = False
            lt = min(most, max(-most, lt))
        f.z1 = l1 - row.l1
        f.z2 = l2 - row.l2
        f.zt = lt - row.lt
    return whole


@kernel
def _best(tables: Tables) -> float:
    """How much of a step that was cut short leaves the least to solve; 0: all of it would add."""
    _forget(tables)
    gain = 0.0
    curvature = 0.0
    for i in range(tables.counters[ROWS]):
        f = tables.factors[i]
        if f.first or f.second or f.grip:
            row = tables.rows[i]
            gain += f.r1 * f.z1 + f.r2 * f.z2 + f.rt * f.zt
            curvature += (
                f.e11 * f.z1 * f.z1 + f.e11 * f.z2 * f.z2 + 2.0 * f.e12 * f.z1 * f.z2 + f.et * f.zt * f.zt
            )
            _give(row, f, tables.mobility[row.a], tables.mobility[row.b])
    for k in range(tables.counters[LIVE]):
        i = tables.live[k]
        body = tables.bodies[i]
        m = tables.mobility[i]
        curvature += body.inverse_mass * (m.x * m.x + m.y * m.y) + body.inverse_moment * m.w * m.w
    if not (gain > 0.0 and curvature > 0.0):
        return 0.0
    return min(1.0, gain / curvature)


@kernel(forceinline=True)
def _give(row: Any, f: Any, a: Any, b: Any) -> None:
    """Add the row's direction to the impulses of its bodies."""
    normal = f.z1 + f.z2
    turn = f.z1 * row.e1 + f.z2 * row.e2
    x = normal * row.nx - f.zt * row.ny
    y = normal * row.ny + f.zt * row.nx
    a.x += x
    a.y += y
    a.w += normal * row.arm_a - turn + f.zt * row.lean_a
    b.x -= x
    b.y -= y
    b.w -= normal * row.arm_b - turn + f.zt * row.lean_b


@kernel
def _go(tables: Tables, part: float) -> None:
    """Take so much of the step."""
    if part == 0.0:
        return
    for i in range(tables.counters[ROWS]):
        f = tables.factors[i]
        if f.first or f.second or f.grip:
            row = tables.rows[i]
            d1 = part * f.z1
            d2 = part * f.z2
            dt = part * f.zt
            row.l1 += d1
            row.l2 += d2
            row.lt += dt
            push(row, tables.bodies[row.a], tables.bodies[row.b], d1, d2, dt)


@kernel
def conjugate_gradients(tables: Tables, steps: int, known: bool) -> None:
    """So many steps for all rows that bear; `known`: those that did in the search before."""
    if tables.counters[ROWS] == 0:
        return
    before = 0.0
    for _ in range(steps):
        if before == 0.0 and not known:
            take_part(tables)
        known = False
        before = descend(tables, before, 0.0)


@kernel
def conjugate_gradients_of_joints(tables: Tables, steps: int, enough: float) -> None:
    """As many steps for all rows that bear, joints among them, until no more than `enough` is left to solve.

    A step that is cut short ends it: other rows bear from there on. enough: mass times the square of a speed.
    """
    take_part(tables)
    before = 0.0
    for _ in range(steps):
        before = descend(tables, before, enough)
        if before == 0.0:
            return
