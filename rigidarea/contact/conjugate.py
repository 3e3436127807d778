"""Many rows at once: a direction that is exact where contacts form trees, followed as conjugate gradients do.

A sweep passes a load on from body to body, and takes as many sweeps as there are bodies, squared where they bend.
Taken in order, from the bottom to the top, each row leaves its bodies less mobile than it has found them: what stands
on the ground is as heavy as the ground, for whoever comes to stand on it. With that, one pass up and one back solve a
tower, a chain, a heavy crate on light ones exactly (Featherstone's articulated inertia,
doi:10.1177/027836498300200102; an elimination whose fill is dropped, Saad, Iterative Methods for Sparse Linear
Systems, 10.3).
In a pile, where supports are shared, it is the preconditioner of conjugate gradients (Hestenes & Stiefel, J Res NBS 49
(1952), doi:10.6028/jres.049.044).

The system is that of the rows that bear: a face on both ends (with joints, where a search is more than a step or two,
also on one), a point that presses, friction that grips. An end that the step would pull on is let go, and the search
begins anew; what ought to press again is found by the sweeps before and after. Each island (`active`) is searched by
itself, all of them side by side: a step's length is the island's.
"""

from __future__ import annotations

from typing import Any

from ..compile.jit import kernel
from .active import active_island
from .constants import SETTLED, WORTH
from .joint import clamp_joint
from .preconditioner import take_part
from .row import push
from .tables import ACTIVE, MEMBERS, QUEUE, Tables


@kernel
def _forget(tables: Tables) -> None:
    """No velocities, no impulses."""
    for k in range(tables.counters[MEMBERS]):
        m = tables.mobility[tables.members[k]]
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


@kernel(forceinline=True)
def _bears(f: Any) -> bool:
    return bool(f.first or f.grip)  # no second end bears without the first (`preconditioner`)


@kernel
def _up(tables: Tables) -> None:
    """Residuals, and the pass in the order of the rows."""
    _forget(tables)
    for k in range(tables.counters[QUEUE]):
        i = tables.queue[k].row
        f = tables.factors[i]
        if not tables.islands[tables.queue[k].island].searching or not _bears(f):
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
def _down(tables: Tables) -> None:
    """The pass back; `product`: residual times direction, by which the next step's length is judged."""
    _forget(tables)
    n = tables.counters[QUEUE]
    for k in range(n):
        i = tables.queue[n - 1 - k].row
        f = tables.factors[i]
        island = tables.islands[tables.queue[n - 1 - k].island]
        if not island.searching or not _bears(f):
            continue
        row = tables.rows[i]
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
        island.product += f.r1 * f.z1 + f.r2 * f.z2 + f.rt * f.zt
        _give(row, f, ma, mb)


@kernel
def _aim(tables: Tables) -> None:
    """The direction of the search, conjugate to the one before; `part`: how far along it is best, 0: nowhere."""
    for k in range(tables.counters[MEMBERS]):
        i = tables.members[k]
        body = tables.bodies[i]
        m = tables.mobility[i]
        if m.island < 0 or not tables.islands[m.island].searching:
            continue
        island = tables.islands[m.island]
        beta = island.part
        m.ux = m.x + (beta * m.ux if beta > 0.0 else 0.0)
        m.uy = m.y + (beta * m.uy if beta > 0.0 else 0.0)
        m.uw = m.w + (beta * m.uw if beta > 0.0 else 0.0)
        island.curvature += _inertia(body, m.ux, m.uy, m.uw)
    for k in range(tables.counters[QUEUE]):
        f = tables.factors[tables.queue[k].row]
        island = tables.islands[tables.queue[k].island]
        if island.searching and _bears(f):
            beta = island.part
            f.p1 = f.z1 + beta * f.p1
            f.p2 = f.z2 + beta * f.p2
            f.pt = f.zt + beta * f.pt
            island.ahead += (
                f.r1 * f.p1 + f.r2 * f.p2 + f.rt * f.pt
            )  # a clamp before has left some of the old one
            island.curvature += _compliance(f, f.p1, f.p2, f.pt)


@kernel(forceinline=True)
def _inertia(body: Any, x: float, y: float, w: float) -> float:
    return float(body.inverse_mass * (x * x + y * y) + body.inverse_moment * w * w)


@kernel(forceinline=True)
def _compliance(f: Any, l1: float, l2: float, lt: float) -> float:
    return float(f.e11 * l1 * l1 + f.e11 * l2 * l2 + 2.0 * f.e12 * l1 * l2 + f.et * lt * lt)


@kernel(forceinline=True)
def _length(island: Any) -> float:
    """How far along a direction the least is left to solve; 0: nowhere."""
    if not (island.ahead > 0.0 and island.curvature > 0.0):
        return 0.0
    return float(island.ahead / island.curvature)


@kernel
def _descend(tables: Tables, small: float) -> bool:
    """One step of the search, after `take_part`, for all islands that are searched; whether there are any still.

    An island is left alone where no more is left to solve than its mass times the square of so small a part of `small`.
    """
    counters = tables.counters
    for k in range(counters[ACTIVE]):
        active_island(tables, k).product = 0.0
    _up(tables)
    _down(tables)
    left = False
    for k in range(counters[ACTIVE]):
        island = active_island(tables, k)
        enough = small * island.small
        island.searching = island.searching and island.product > island.mass * enough * enough
        island.part = island.product / island.before if island.before > 0.0 else 0.0
        island.ahead = 0.0
        island.curvature = 0.0
        left |= island.searching
    if not left:
        return False
    _aim(tables)
    for k in range(counters[ACTIVE]):
        island = active_island(tables, k)
        island.part = _length(island) if island.searching else 0.0
        island.whole = 1
    cut = _clamp(tables)
    if cut:
        _best(tables)
    for k in range(counters[ACTIVE]):
        island = active_island(tables, k)
        going = island.part > 0.0
        island.before = island.product if going and island.whole else 0.0
        if not island.searching:
            continue
        island.gained = 1.0 if island.whole else 0.0
        if going and island.whole:
            island.part = 1.0
        elif going:
            island.part = min(1.0, _length(island))
            gain = island.part * (2.0 * island.ahead - island.part * island.curvature)
            island.gained = gain / island.product
    return True


@kernel
def _clamp(tables: Tables) -> bool:
    """The step so far in the direction of the search, no end pulling, no friction beyond its bound; whether any was.

    What may be done is convex, so that any part of the step may be.
    """
    cut = False
    for k in range(tables.counters[QUEUE]):
        i = tables.queue[k].row
        f = tables.factors[i]
        island = tables.islands[tables.queue[k].island]
        if not island.searching or not _bears(f):
            continue
        row = tables.rows[i]
        whole = True
        l1 = row.l1 + island.part * f.p1
        l2 = row.l2 + island.part * f.p2
        lt = row.lt + island.part * f.pt
        if row.ends == 0:
            f.z1, f.zt = clamp_joint(row, l1, lt)
            whole = f.z1 == l1 and f.zt == lt
            f.z1 -= row.l1
            f.z2 = 0.0
            f.zt -= row.lt
        else:
            if l1 < 0.0 or l2 < 0.0:
                whole = False
                l1 = max(0.0, l1)
                l2 = max(0.0, l2)
            most = row.friction * (l1 + l2) + row.most
            if abs(lt) > most:
                whole = False
                lt = min(most, max(-most, lt))
            f.z1 = l1 - row.l1
            f.z2 = l2 - row.l2
            f.zt = lt - row.lt
        if not whole:
            island.whole = 0
            cut = True
    return cut


@kernel
def _best(tables: Tables) -> None:
    """How much of a step that was cut short leaves the least to solve (`part`); 0: all of it would add."""
    _forget(tables)
    for k in range(tables.counters[ACTIVE]):
        island = active_island(tables, k)
        island.ahead = 0.0
        island.curvature = 0.0
    for k in range(tables.counters[QUEUE]):
        i = tables.queue[k].row
        f = tables.factors[i]
        island = tables.islands[tables.queue[k].island]
        if island.searching and not island.whole and _bears(f):
            row = tables.rows[i]
            island.ahead += f.r1 * f.z1 + f.r2 * f.z2 + f.rt * f.zt
            island.curvature += _compliance(f, f.z1, f.z2, f.zt)
            _give(row, f, tables.mobility[row.a], tables.mobility[row.b])
    for k in range(tables.counters[MEMBERS]):
        i = tables.members[k]
        m = tables.mobility[i]
        if m.island >= 0:
            tables.islands[m.island].curvature += _inertia(tables.bodies[i], m.x, m.y, m.w)


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
def _go(tables: Tables) -> None:
    """Take `part` of the step."""
    for k in range(tables.counters[QUEUE]):
        i = tables.queue[k].row
        f = tables.factors[i]
        part = tables.islands[tables.queue[k].island].part
        if part > 0.0 and _bears(f):
            row = tables.rows[i]
            d1 = part * f.z1
            d2 = part * f.z2
            dt = part * f.zt
            row.l1 += d1
            row.l2 += d2
            row.lt += dt
            push(row, tables.bodies[row.a], tables.bodies[row.b], d1, d2, dt)


@kernel
def select_searched(tables: Tables, every: bool) -> None:
    """Which islands take part in the next search: every one that is active, or those of which the last was WORTH it.

    In a heap something always lets go, and cuts each step short: there only the sweeps go on.
    """
    for k in range(tables.counters[ACTIVE]):
        island = active_island(tables, k)
        island.searching = every or island.gained >= WORTH


@kernel
def conjugate_gradients(tables: Tables, steps: int, jointed: bool) -> None:
    """So many steps for all rows that bear, of the islands that are to be searched.

    jointed: none after a step that is cut short, since other rows bear from there on, nor once what is left is as small
    as what sweeps leave.
    """
    if tables.counters[QUEUE] == 0:
        return
    for k in range(tables.counters[ACTIVE]):
        active_island(tables, k).before = 0.0
    for _ in range(steps):
        take_part(tables, jointed)
        if not _descend(tables, SETTLED if jointed else 0.0):
            return
        _go(tables)
        for k in range(tables.counters[ACTIVE]):
            island = active_island(tables, k)
            if jointed and island.before == 0.0:
                island.searching = 0
