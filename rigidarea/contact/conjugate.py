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
from ..compile.raw_memory import record
from .joint import clamp_joint
from .row import push
from .tables import LIVE, ROWS, Tables

#: What one row takes part with: unknowns are end 1, end 2, friction.
FACTOR = record(
    [
        ("first", "i4"),  # 1: it bears
        ("second", "i4"),
        ("grip", "i4"),
        ("e11", "f8"),  # compliance of the ends and of friction (1/mass)
        ("e12", "f8"),
        ("et", "f8"),
        *(
            (f"a{x}{i}", "f8") for i in "12t" for x in "xyw"
        ),  # what an impulse does to A, as mobile as it is left
        *((f"b{x}{i}", "f8") for i in "12t" for x in "xyw"),  # and to B
        ("d11", "f8"),  # inverse of the row's own block
        ("d12", "f8"),
        ("d1t", "f8"),
        ("d22", "f8"),
        ("d2t", "f8"),
        ("dtt", "f8"),
        ("r1", "f8"),  # what is left to solve (velocity)
        ("r2", "f8"),
        ("rt", "f8"),
        ("z1", "f8"),  # the direction, and that of the search (impulse)
        ("z2", "f8"),
        ("zt", "f8"),
        ("p1", "f8"),
        ("p2", "f8"),
        ("pt", "f8"),
    ]
)

#: A body while the rows are taken in order.
MOBILITY = record(
    [
        *((f"m{x}", "f8") for x in ("xx", "xy", "yy", "xw", "yw", "ww")),  # inverse mass that is left to it
        ("x", "f8"),  # velocity that rows before have given it; on the way back, the impulse
        ("y", "f8"),
        ("w", "f8"),
        ("ux", "f8"),  # impulse of the search's direction
        ("uy", "f8"),
        ("uw", "f8"),
        ("vx", "f8"),  # its velocity before contacts are relaxed
        ("vy", "f8"),
        ("vw", "f8"),
        ("moved", "i8"),  # 1: by what relaxing has taken from it
    ]
)

#: What gives way by less than this part of the row's own is held from both sides (a disc between a floor and a blade
#: that comes down): no impulse does what both ask, and the search leaves it to the sweeps.
LEAST_GIVE = 1e-6
#: Friction nearer to its bound than this part of it slides: a step that was cut short there leaves it there but for
#: rounding, which is not to decide.
AT_ITS_BOUND = 1e-9


@kernel
def _free(tables: Tables) -> None:
    """Every body as mobile as it is alone."""
    for k in range(tables.counters[LIVE]):
        i = tables.live[k]
        body = tables.bodies[i]
        m = tables.mobility[i]
        m.mxx = body.inverse_mass
        m.mxy = 0.0
        m.myy = body.inverse_mass
        m.mxw = 0.0
        m.myw = 0.0
        m.mww = body.inverse_moment


@kernel(forceinline=True)
def _left(m: Any, x: float, y: float, w: float) -> tuple[float, float, float]:
    """Velocity that the impulse (x, y, w) gives to a body as mobile as it is left."""
    return (
        m.mxx * x + m.mxy * y + m.mxw * w,
        m.mxy * x + m.myy * y + m.myw * w,
        m.mxw * x + m.myw * y + m.mww * w,
    )


@kernel(forceinline=True)
def _take(
    m: Any, f: Any,
    x1: float, y1: float, w1: float, x2: float, y2: float, w2: float, xt: float, yt: float, wt: float,
) -> None:  # fmt: skip
    """Take from a body the mobility that a row with the given responses holds: M -= G D G^T."""
    ax1 = f.d11 * x1 + f.d1t * xt
    ay1 = f.d11 * y1 + f.d1t * yt
    aw1 = f.d11 * w1 + f.d1t * wt
    axt = f.d1t * x1 + f.dtt * xt
    ayt = f.d1t * y1 + f.dtt * yt
    awt = f.d1t * w1 + f.dtt * wt
    if f.second:
        ax1 += f.d12 * x2
        ay1 += f.d12 * y2
        aw1 += f.d12 * w2
        axt += f.d2t * x2
        ayt += f.d2t * y2
        awt += f.d2t * w2
        ax2 = f.d12 * x1 + f.d22 * x2 + f.d2t * xt
        ay2 = f.d12 * y1 + f.d22 * y2 + f.d2t * yt
        aw2 = f.d12 * w1 + f.d22 * w2 + f.d2t * wt
        m.mxx -= ax2 * x2
        m.mxy -= ax2 * y2
        m.myy -= ay2 * y2
        m.mxw -= ax2 * w2
        m.myw -= ay2 * w2
        m.mww -= aw2 * w2
    m.mxx -= ax1 * x1 + axt * xt
    m.mxy -= ax1 * y1 + axt * yt
    m.myy -= ay1 * y1 + ayt * yt
    m.mxw -= ax1 * w1 + axt * wt
    m.myw -= ay1 * w1 + ayt * wt
    m.mww -= aw1 * w1 + awt * wt


@kernel
def _bears(row: Any, f: Any) -> bool:
    """Which unknowns of a row take part, and their compliance."""
    most = row.friction * (row.l1 + row.l2)
    given = row.gamma == 0.0  # an impact that the steps follow: its force is given
    f.first = not given and row.l1 > 0.0
    f.second = not given and row.ends == 2 and row.l2 > 0.0
    if row.ends == 0:
        limit = (1.0 - AT_ITS_BOUND) * row.most
        free = row.l1 * row.l1 + row.lt * row.lt < limit * limit
        f.first = not given and free and row.low < row.l1 < row.high
        f.grip = row.grips and free and row.low_t < row.lt < row.high_t
    elif row.ends == 2 and not (f.first and f.second):  # which end of a face opens, the sweeps find
        f.first = 0
        f.second = 0
    if row.ends > 0:
        f.grip = abs(row.lt) < (1.0 - AT_ITS_BOUND) * most
    f.p1 = 0.0
    f.p2 = 0.0
    f.pt = 0.0
    give = 0.0 if given else row.alpha / row.gamma
    f.e11 = give * row.own
    f.e12 = give * row.other
    f.et = row.alpha_t / row.gamma_t
    return bool(f.first or f.second or f.grip)


@kernel
def _invert(
    f: Any, s11: float, s12: float, s1t: float, s22: float, s2t: float, stt: float, least: float
) -> None:
    """Inverse of a row's block; 1 in the place of an unknown that takes no part, or that others hold already.

    least: what an unknown gives way at least, the ones before it held (1/mass).
    """
    if s11 <= least or (f.second and s22 - s12 * s12 / s11 <= least):
        f.first = 0
        f.second = 0
    if not f.first:
        s11, s12, s1t = 1.0, 0.0, 0.0
    if not f.second:
        s22, s12, s2t = 1.0, 0.0, 0.0
    c11 = s22 * stt - s2t * s2t
    c12 = s1t * s2t - s12 * stt
    c1t = s12 * s2t - s1t * s22
    held = s11 * s22 - s12 * s12
    if not f.grip or (s11 * c11 + s12 * c12 + s1t * c1t) <= least * held:
        f.grip = 0
        stt, s1t, s2t = 1.0, 0.0, 0.0
        c11 = s22
        c12 = -s12
        c1t = 0.0
    det = 1.0 / (s11 * c11 + s12 * c12 + s1t * c1t)
    f.d11 = c11 * det if f.first else 0.0
    f.d12 = c12 * det if f.first and f.second else 0.0
    f.d1t = c1t * det if f.first and f.grip else 0.0
    f.d22 = (s11 * stt - s1t * s1t) * det if f.second else 0.0
    f.d2t = (s12 * s1t - s11 * s2t) * det if f.second and f.grip else 0.0
    f.dtt = held * det if f.grip else 0.0


@kernel
def take_part(tables: Tables) -> None:
    """Which rows bear, and what each finds its bodies like, and leaves them."""
    _free(tables)
    for i in range(tables.counters[ROWS]):
        row = tables.rows[i]
        f = tables.factors[i]
        if not _bears(row, f):
            continue
        ma = tables.mobility[row.a]
        mb = tables.mobility[row.b]
        nx = row.nx
        ny = row.ny
        wa = row.arm_a - row.e1
        wb = row.arm_b - row.e1
        f.ax1, f.ay1, f.aw1 = _left(ma, nx, ny, wa)
        f.axt, f.ayt, f.awt = _left(ma, -ny, nx, row.lean_a)
        f.bx1, f.by1, f.bw1 = _left(mb, nx, ny, wb)
        f.bxt, f.byt, f.bwt = _left(mb, -ny, nx, row.lean_b)
        xt = f.axt + f.bxt
        yt = f.ayt + f.byt
        s11 = nx * (f.ax1 + f.bx1) + ny * (f.ay1 + f.by1) + wa * f.aw1 + wb * f.bw1
        s1t = nx * xt + ny * yt + wa * f.awt + wb * f.bwt
        stt = nx * yt - ny * xt + row.lean_a * f.awt + row.lean_b * f.bwt
        s12 = 0.0
        s22 = 0.0
        s2t = 0.0
        if f.second:
            va = row.arm_a - row.e2
            vb = row.arm_b - row.e2
            f.ax2, f.ay2, f.aw2 = _left(ma, nx, ny, va)
            f.bx2, f.by2, f.bw2 = _left(mb, nx, ny, vb)
            x2 = f.ax2 + f.bx2
            y2 = f.ay2 + f.by2
            s12 = nx * x2 + ny * y2 + wa * f.aw2 + wb * f.bw2
            s22 = nx * x2 + ny * y2 + va * f.aw2 + vb * f.bw2
            s2t = nx * xt + ny * yt + va * f.awt + vb * f.bwt
        _invert(f, s11 + f.e11, s12 + f.e12, s1t, s22 + f.e11, s2t, stt + f.et, LEAST_GIVE * row.weight)
        _take(ma, f, f.ax1, f.ay1, f.aw1, f.ax2, f.ay2, f.aw2, f.axt, f.ayt, f.awt)
        _take(mb, f, f.bx1, f.by1, f.bw1, f.bx2, f.by2, f.bw2, f.bxt, f.byt, f.bwt)


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
