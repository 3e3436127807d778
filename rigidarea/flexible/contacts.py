"""All contacts of a system at one configuration: loads on the frames, tangent, records."""

from __future__ import annotations

import numpy as np

from rigidarea.flexible import nodal, segment
from rigidarea.flexible.condense import hub_row
from rigidarea.flexible.place import clear_loads, to_nodes
from rigidarea.flexible.system import REGIONS_KEPT, Buffers
from rigidarea.kernel.jit import kernel


@kernel(forceinline=True)
def poses(x, buf):  # type: ignore[no-untyped-def]
    """Poses (x, y, cos θ, sin θ) of frames x (b, 3) into ``buf.pose``."""
    for b in range(len(x)):
        buf.pose[b, 0], buf.pose[b, 1] = x[b, 0], x[b, 1]
        buf.pose[b, 2], buf.pose[b, 3] = np.cos(x[b, 2]), np.sin(x[b, 2])


@kernel(forceinline=True)
def _moved(buf: Buffers, i: int, size: float) -> float:
    """How far no point of body i, of radius ``size``, has moved since the last search."""
    dx, dy = buf.pose[i, 0] - buf.searched[i, 0], buf.pose[i, 1] - buf.searched[i, 1]
    c, s = buf.pose[i, 2] - buf.searched[i, 2], buf.pose[i, 3] - buf.searched[i, 3]
    return np.sqrt(dx * dx + dy * dy) + size * np.sqrt(c * c + s * s)


@kernel
def _assemble(sy, buf, st, r, ia, ib, number, held):  # type: ignore[no-untyped-def]
    """Adds region ``number``'s force to the loads and its stiffness to the tangent.

    Contact stiffness k L along the direction through the chord's middle, k L³/12 in rotation. ``held``: bodies that
    are held by their hubs also feel the contact through their hubs' compliance, in the hubs' part of ``buf.row``.
    """
    nx, ny, hubs = r["nx"], r["ny"], len(sy.mass)
    fx, fy = r["force"] * nx, r["force"] * ny
    buf.force[0] += fx
    buf.force[1] += fy
    stiff, row = st.k * r["chord"] * r["give"], buf.row
    for side in range(2):
        j, sign = (ia, -1.0) if side == 0 else (ib, 1.0)
        x, y = buf.pose[j, 0], buf.pose[j, 1]
        buf.load[j, 0] += sign * fx
        buf.load[j, 1] += sign * fy
        buf.load[j, 2] += sign * ((r["x"] - x) * fy - (r["y"] - y) * fx)
        row[3 * j], row[3 * j + 1] = sign * nx, sign * ny
        row[3 * j + 2] = sign * ((r["x_chord"] - x) * ny - (r["y_chord"] - y) * nx)
    # rows of A and B in turn: frames, then hubs
    for m in range(12 if held else 6):
        i = 3 * ((ia if m % 2 == 0 else ib) + (0 if m < 6 else hubs)) + (m // 2) % 3
        f = stiff * row[i]
        for n in range(12 if held else 6):
            j = 3 * ((ia if n % 2 == 0 else ib) + (0 if n < 6 else hubs)) + (n // 2) % 3
            buf.tangent[i, j] += f * row[j]
    if st.sts:
        return
    turn = st.k * r["chord"] ** 3 / 12.0
    buf.tangent[3 * ia + 2, 3 * ia + 2] += turn
    buf.tangent[3 * ib + 2, 3 * ib + 2] += turn
    buf.tangent[3 * ia + 2, 3 * ib + 2] -= turn
    buf.tangent[3 * ib + 2, 3 * ia + 2] -= turn
    if st.spread and number < len(buf.springs):
        spring = buf.springs[number]
        spring[0], spring[2], spring[4], spring[6] = ia, r["low_a"], r["high_a"], r["share_a"]
        spring[1], spring[3], spring[5], spring[7] = ib, r["low_b"], r["high_b"], r["share_b"]
        spring[8], spring[9], spring[10], spring[11] = nx, ny, stiff, r["force"]
        for m in range(12):
            spring[12 + m] = row[3 * ((ia if m % 2 == 0 else ib) + (0 if m < 6 else hubs)) + (m // 2) % 3]


@kernel(inline="always")
def evaluate(bodies, works, sy, buf, q, pairs, st, s):  # type: ignore[no-untyped-def]
    """Evaluates all pairs at buf.pose: loads, tangent, records. Returns a count or an error code of ``scratch``."""
    buf.counts[1] += 1
    buf.load[:] = 0.0
    buf.tangent[:] = 0.0
    buf.force[:] = 0.0
    buf.apart[0] = 0.0
    buf.regions[:] = 0.0
    for b in range(len(bodies)):
        clear_loads(works[b])
    total = 0
    under = 0.0
    for p in range(len(pairs)):
        ia, ib = pairs[p, 0], pairs[p, 1]
        a, wa, b, wb = bodies[ia], works[ia], bodies[ib], works[ib]
        pa, pb = buf.pose[ia], buf.pose[ib]
        # the search, of undeformed bodies, holds while no point has moved, relative to the other body, by more than
        # the margin
        bend = buf.bend[0]
        for i in (ia, ib):
            for k in range(sy.first[i], sy.first[i + 1]):
                bend += abs(q[k]) * sy.amplitude[k]
        moved = abs(bend - buf.bend[1]) + _moved(buf, ia, sy.size[ia]) + _moved(buf, ib, sy.size[ib])
        if buf.counts[0] < 0 or moved > 0.5 * st.margin or len(pairs) > 1:
            reach = st.margin + bend + (st.q if st.sts else 0.0)
            buf.bend[1] = bend
            buf.counts[0] = nodal.search(a, pa, b, pb, reach, s)
            for i in range(4):
                buf.searched[ia, i] = pa[i]
                buf.searched[ib, i] = pb[i]
        n_pairs, stamp = buf.counts[0], buf.counts[1]
        if n_pairs < 0:
            return n_pairs
        if n_pairs == 0:
            continue
        qa, qb = q[sy.first[ia] : sy.first[ia + 1]], q[sy.first[ib] : sy.first[ib + 1]]
        if st.sts:
            n = segment.contact(a, wa, pa, qa, b, wb, pb, qb, n_pairs, stamp, st.k, st.q, st.spread, s)
        else:
            n = nodal.contact(a, wa, pa, qa, b, wb, pb, qb, n_pairs, stamp, st.k, st.q, st.spread, s)
        if n < 0:
            return n
        for i in range(n):
            r = s.regions[i]
            buf.apart[0] = max(buf.apart[0], abs(r["force"] - st.k * r["area"]))
            if total < REGIONS_KEPT:
                kept = buf.regions[total]
                kept[0], kept[1], kept[2], kept[3], kept[4] = r["force"], r["nx"], r["ny"], r["x"], r["y"]
            if st.spread and not st.sts:
                u, v = wa.displacement[r["low_a"]], wb.displacement[r["low_b"]]
                under = max(under, np.sqrt(u[0] * u[0] + u[1] * u[1]) + np.sqrt(v[0] * v[0] + v[1] * v[1]))
            buf.row[:] = 0.0
            held_a, held_b = sy.pinned[ia] + sy.driven[ia] > 0, sy.pinned[ib] + sy.driven[ib] > 0
            if st.spread and not st.sts and held_a:
                row = buf.row[3 * (len(bodies) + ia) : 3 * (len(bodies) + ia) + 3]
                hub_row(a, wa, pa, -r["nx"], -r["ny"], r["low_a"], r["high_a"], r["share_a"], row)
            if st.spread and not st.sts and held_b:
                row = buf.row[3 * (len(bodies) + ib) : 3 * (len(bodies) + ib) + 3]
                hub_row(b, wb, pb, r["nx"], r["ny"], r["low_b"], r["high_b"], r["share_b"], row)
            _assemble(sy, buf, st, r, ia, ib, total, st.spread and not st.sts and (held_a or held_b))
            total += 1
    buf.bend[0] = under
    if st.spread:
        for b in range(len(bodies)):
            to_nodes(bodies[b], works[b], buf.pose[b])
    buf.counts[2] = total
    return total


@kernel
def replay(bodies, works, sy, q, pairs, st, s, buf, x):  # type: ignore[no-untyped-def]
    """One contact evaluation for each recorded frame position x (n, b, 3)."""
    for n in range(len(x)):
        poses(x[n], buf)
        evaluate(bodies, works, sy, buf, q, pairs, st, s)
