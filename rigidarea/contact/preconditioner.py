"""What rows leave their bodies of mobility, taken in order: the factors of the preconditioner of `conjugate`.

From the bottom to the top each row that bears finds its bodies as mobile as the rows before have left them, and takes
what it holds (Featherstone's articulated inertia, doi:10.1177/027836498300200102; an elimination whose fill is dropped,
Saad, Iterative Methods for Sparse Linear Systems, 10.3).
"""

from __future__ import annotations

from typing import Any

from ..compile.jit import kernel
from ..compile.raw_memory import record
from .tables import MEMBERS, QUEUE, Tables

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
        ("moved", "i4"),  # 1: by what relaxing has taken from it
        ("island", "i4"),  # number of its island of rows (`active`); -1: none
        ("solved", "i4"),  # 1: that is solved
    ]
)

#: What gives way by less than this part of the row's own is held from both sides (a disc between a floor and a blade
#: that comes down): no impulse does what both ask, and the search leaves it to the sweeps.
LEAST_GIVE = 1e-6
#: Friction nearer to its bound than this part of it slides: a step that was cut short there leaves it there but for
#: rounding, which is not to decide.
AT_ITS_BOUND = 1e-9


@kernel(forceinline=True)
def begins_anew(island: Any) -> bool:
    """Whether an island's rows that bear are to be found before its search goes on."""
    return bool(island.searching and island.before == 0.0)


@kernel
def _free(tables: Tables) -> None:
    """Every body of an island that begins anew as mobile as it is alone."""
    for k in range(tables.counters[MEMBERS]):
        i = tables.members[k]
        body = tables.bodies[i]
        m = tables.mobility[i]
        if m.island >= 0 and not begins_anew(tables.islands[m.island]):
            continue
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
def _swap_ends(row: Any) -> None:
    """Call the row's second end its first."""
    row.swapped = 1 - row.swapped
    row.e1, row.e2 = row.e2, row.e1
    row.f1, row.f2 = row.f2, row.f1
    row.t1, row.t2 = row.t2, row.t1
    row.l1, row.l2 = row.l2, row.l1
    row.w11, row.w22 = row.w22, row.w11
    row.slip1, row.slip2 = row.slip2, row.slip1
    row.was1, row.was2 = row.was2, row.was1


@kernel
def _bears(row: Any, f: Any, jointed: bool) -> bool:
    """Which unknowns of a row take part, and their compliance; jointed: a face on one end too."""
    most = row.friction * (row.l1 + row.l2) + row.most
    given = row.gamma == 0.0  # an impact that the steps follow: its force is given
    f.first = not given and row.l1 > 0.0
    f.second = not given and row.ends == 2 and row.l2 > 0.0
    if row.ends == 0:
        limit = (1.0 - AT_ITS_BOUND) * row.most
        free = row.l1 * row.l1 + row.lt * row.lt < limit * limit
        f.first = not given and free and row.low < row.l1 < row.high
        f.grip = row.grips and free and row.low_t < row.lt < row.high_t
    elif row.ends == 2 and f.second != f.first:
        f.first = jointed  # without joints, the sweeps find which end of a face opens
        if jointed and f.second:
            _swap_ends(row)
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
    return bool(f.first or f.grip)


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
def take_part(tables: Tables, jointed: bool) -> None:
    """Which rows of islands that begin anew bear, and what each finds its bodies like, and leaves them.

    jointed: faces that bear on one end among them.
    """
    _free(tables)
    for k in range(tables.counters[QUEUE]):
        if not begins_anew(tables.islands[tables.queue[k].island]):
            continue
        i = tables.queue[k].row
        row = tables.rows[i]
        f = tables.factors[i]
        if not _bears(row, f, jointed):
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
