"""What contacts lose: damping along their direction, friction across it. Forces on the frames, region by region.

Damping is a dashpot c = 2 ζ √(s m), s the stiffness of the region, k L, and of its bodies in series, m their effective
mass, that never makes a contact pull; ζ is that of the linear spring and dashpot that returns the restitution asked
for, as for rigid contacts at rest (``kernel.impact.damping_ratio``). Where the chord grows with the depth what comes
back is near it, not exact, and of modes more does: what their vibration adds to the yield counts as yield.

Friction is a spring of 2/7 of the normal stiffness that a region remembers, stretched by the slip and held below μ
times the normal force (P. A. Cundall and O. D. L. Strack, Géotechnique 29, 1979, doi:10.1680/geot.1979.29.1.47): it
holds for ever what it holds, and while it holds a dashpot of the same ζ is beside it, or what it holds would vibrate.

Both act on the bodies as wholes: deformation answers to the normal loads only.
"""

from __future__ import annotations

import numpy as np

from rigidarea.compile.jit import kernel
from rigidarea.contact.constants import TANGENT_STIFFNESS


@kernel
def keep_springs(buf, source, target):  # type: ignore[no-untyped-def]
    """Friction's springs of one generation into another: 0 this evaluation, 1 the last step, 2 the step before."""
    n = buf.held[source]
    for i in range(n):
        for k in range(4):
            buf.springs[target, i, k] = buf.springs[source, i, k]
    buf.held[target] = n


@kernel
def _stretch_before(buf, p, x, y):  # type: ignore[no-untyped-def]
    """The stretch, after the last step, of the pair's region that was nearest to a place; 0 if there was none."""
    nearest, stretch = np.inf, 0.0
    for i in range(buf.held[1]):
        old = buf.springs[1, i]
        if old[0] == p:
            d = (old[1] - x) ** 2 + (old[2] - y) ** 2
            if d < nearest:
                nearest, stretch = d, old[3]
    return stretch


@kernel
def _dashpot(sy, p, ia, ib, turn_a, turn_b, stiff):  # type: ignore[no-untyped-def]
    """2 ζ √(k m) of a pair's spring of stiffness k; its bodies' arms about it, and their effective mass m."""
    mobility = sy.inverse[ia, 0] + sy.inverse[ib, 0]
    mobility += turn_a * turn_a * sy.inverse[ia, 1] + turn_b * turn_b * sy.inverse[ib, 1]
    return 2.0 * sy.ratio[p] * np.sqrt(stiff / mobility) if mobility > 0.0 else 0.0


@kernel
def resist(sy, buf, k, r, p, ia, ib):  # type: ignore[no-untyped-def]
    """Adds a region's damping and friction to loads and tangent, and its spring to this evaluation's."""
    nx, ny, x, y = r["nx"], r["ny"], r["x_chord"], r["y_chord"]
    ax, ay = x - buf.pose[ia, 0], y - buf.pose[ia, 1]
    bx, by = x - buf.pose[ib, 0], y - buf.pose[ib, 1]
    # velocity of A relative to B at the region
    va, vb = buf.rate[ia], buf.rate[ib]
    vx = va[0] - va[2] * ay - vb[0] + vb[2] * by
    vy = va[1] + va[2] * ax - vb[1] - vb[2] * bx
    stiff = k * r["chord"]
    if sy.ratio[p] > 0.0:
        ta, tb = ax * ny - ay * nx, bx * ny - by * nx
        # beside it are both bodies' own springs too, in series: its force over all that yields to it
        yields = r["force"] / stiff + buf.bend[ia] + buf.bend[ib]
        c = _dashpot(sy, p, ia, ib, ta, tb, r["force"] / yields if yields > 0.0 else stiff)
        force = c * (vx * nx + vy * ny)
        if force < -r["force"]:
            force, c = -r["force"], 0.0
        _push(buf, p, ia, ib, nx, ny, ta, tb, force, c * buf.clock[1])
    if sy.friction[p] > 0.0:
        tx, ty = -ny, nx
        ta, tb = ax * ty - ay * tx, bx * ty - by * tx
        limit = sy.friction[p] * r["force"]
        hold = TANGENT_STIFFNESS * stiff
        c = _dashpot(sy, p, ia, ib, ta, tb, hold)
        slip = vx * tx + vy * ty
        stretch = _stretch_before(buf, p, x, y) + buf.clock[0] * slip
        if abs(hold * stretch) > limit:
            stretch, c = limit / hold if stretch > 0.0 else -limit / hold, 0.0
        force, tangent = hold * stretch + c * slip, (hold * buf.clock[0] + c) * buf.clock[1]
        if abs(force) >= limit:
            force, tangent = min(max(force, -limit), limit), 0.0
        _push(buf, p, ia, ib, tx, ty, ta, tb, force, tangent)
        kept = buf.springs[0, buf.held[0]]
        kept[0], kept[1], kept[2], kept[3] = p, x, y, stretch
        buf.held[0] += 1


@kernel
def _push(buf, p, ia, ib, nx, ny, turn_a, turn_b, force, tangent):  # type: ignore[no-untyped-def]
    """A force on B along (nx, ny), its opposite on A; ``tangent``: its change with how A moves against B."""
    buf.force[p, 0] += force * nx
    buf.force[p, 1] += force * ny
    row = buf.row
    for side in range(2):
        j, sign, turn = (ia, -1.0, turn_a) if side == 0 else (ib, 1.0, turn_b)
        row[3 * j], row[3 * j + 1], row[3 * j + 2] = sign * nx, sign * ny, sign * turn
        for i in range(3):
            buf.load[j, i] += force * row[3 * j + i]
    if tangent == 0.0:
        return
    for m in range(6):
        i = 3 * (ia if m % 2 == 0 else ib) + m // 2
        for n in range(6):
            j = 3 * (ia if n % 2 == 0 else ib) + n // 2
            buf.tangent[i, j] += tangent * row[i] * row[j]
