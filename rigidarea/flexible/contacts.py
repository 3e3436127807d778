"""All contacts of a system at one configuration: loads on the frames, tangent, records."""

from __future__ import annotations

import numpy as np

from rigidarea.compile.jit import entry, kernel
from rigidarea.flexible.bodies import boundary_at, work_at
from rigidarea.flexible.boundary_places import clear_loads, to_nodes
from rigidarea.flexible.boundary_search import NEAR, holds, narrow, renew, rounding, seen
from rigidarea.flexible.nodal import contact as area_contact
from rigidarea.flexible.resist import resist
from rigidarea.flexible.scratch import MANY, of_pair
from rigidarea.flexible.segment import contact as segment_contact
from rigidarea.flexible.tension import draw


@kernel(forceinline=True)
def poses(x, buf):  # type: ignore[no-untyped-def]
    """Poses (x, y, cos θ, sin θ) of frames x (b, 3) into ``buf.pose``."""
    for b in range(len(x)):
        buf.pose[b, 0], buf.pose[b, 1] = x[b, 0], x[b, 1]
        buf.pose[b, 2], buf.pose[b, 3] = np.cos(x[b, 2]), np.sin(x[b, 2])


@kernel
def _assemble(buf, st, r, ia, ib):  # type: ignore[no-untyped-def]
    """Adds a region's force to the loads and, where its loads are no unknowns of their own, its stiffness.

    Contact stiffness k L along the direction through the chord's middle, k L³/12 in rotation.
    """
    nx, ny = r["nx"], r["ny"]
    fx, fy = r["force"] * nx, r["force"] * ny
    row = buf.row
    for side in range(2):
        j, sign = (ia, -1.0) if side == 0 else (ib, 1.0)
        x, y = buf.pose[j, 0], buf.pose[j, 1]
        buf.load[j, 0] += sign * fx
        buf.load[j, 1] += sign * fy
        buf.load[j, 2] += sign * ((r["x"] - x) * fy - (r["y"] - y) * fx)
        row[3 * j], row[3 * j + 1] = sign * nx, sign * ny
        row[3 * j + 2] = sign * ((r["x_chord"] - x) * ny - (r["y_chord"] - y) * nx)
    if st.spread:
        return
    stiff = st.k * r["chord"]
    for m in range(6):
        i = 3 * (ia if m % 2 == 0 else ib) + m // 2
        for n in range(6):
            j = 3 * (ia if n % 2 == 0 else ib) + n // 2
            buf.tangent[i, j] += stiff * row[i] * row[j]
    if st.sts:
        return
    turn = st.k * r["chord"] ** 3 / 12.0
    buf.tangent[3 * ia + 2, 3 * ia + 2] += turn
    buf.tangent[3 * ib + 2, 3 * ib + 2] += turn
    buf.tangent[3 * ia + 2, 3 * ib + 2] -= turn
    buf.tangent[3 * ib + 2, 3 * ia + 2] -= turn


@kernel
def _bend(bodies, sy, buf, q):  # type: ignore[no-untyped-def]
    """The most that each body's boundary may be displaced near a contact, by modes and by its last static loads."""
    for b in range(len(sy.mass)):
        w = work_at(bodies, b)
        most = 0.0
        for k in range(w.loaded[-1]):
            u = w.displacement[w.loaded[k]]
            most = max(most, u[0] * u[0] + u[1] * u[1])
        buf.bend[b] = np.sqrt(most)
        for k in range(sy.first[b], sy.first[b + 1]):
            buf.bend[b] += abs(q[k]) * sy.amplitude[k]
        buf.most[b] = max(buf.most[b], buf.bend[b])


@kernel(forceinline=True)
def _near(bodies, sy, buf, pairs, st, s, found, p):  # type: ignore[no-untyped-def]
    """Leaves of pair p that may touch soon, in its list: (their number, or MANY; the deformation allowed for)."""
    ia, ib = pairs[p, 0], pairs[p, 1]
    pa, pb = buf.pose[ia], buf.pose[ib]
    dx, dy = pb[0] - pa[0], pb[1] - pa[1]
    bend = buf.bend[ia] + buf.bend[ib] + (st.q if st.sts else 0.0)
    bend += rounding(pa, pb, sy.size[ia] + sy.size[ib])
    if np.sqrt(dx * dx + dy * dy) > sy.size[ia] + sy.size[ib] + bend:
        found.found[p] = -1
        return 0, bend
    rel = seen(pa, pb)
    if holds(rel, bend, found, p):
        return found.found[p], bend
    size = min(sy.size[ia], sy.size[ib])
    a, b = boundary_at(bodies, ia), boundary_at(bodies, ib)
    return renew(a, b, rel, st.margin, size, bend, s.work.stack, found, p), bend


@kernel
def all_apart(bodies, sy, buf, pairs, st, s, found):  # type: ignore[no-untyped-def]
    """Whether no leaves of any pair are near, of bodies without loads or modes, at ``buf.pose``."""
    for b in range(len(sy.mass)):
        buf.bend[b] = 0.0
    for p in range(len(pairs)):
        n, _bend = _near(bodies, sy, buf, pairs, st, s, found, p)
        if n != 0:
            return False
    return True


@kernel
def evaluate(bodies, sy, buf, q, pairs, st, s, found):  # type: ignore[no-untyped-def]
    """Evaluates all pairs at buf.pose: loads, tangent, records. Returns a count or an error code of ``scratch``.

    Without any contact the loads of the evaluation before stay on the nodes, for ``step`` to take away.
    """
    buf.counts[1] += 1
    stamp = buf.counts[1]
    buf.load[:] = 0.0
    buf.tangent[:] = 0.0
    buf.force[:] = 0.0
    buf.held[0] = 0
    s.load.made[0] = 0
    _bend(bodies, sy, buf, q)
    for b in range(len(sy.mass)):
        w = work_at(bodies, b)
        clear_loads(w)
        if w.tight[0]:
            draw(boundary_at(bodies, b), w)
    total = 0
    for p in range(len(pairs)):
        ia, ib = pairs[p, 0], pairs[p, 1]
        n_pairs, bend = _near(bodies, sy, buf, pairs, st, s, found, p)
        if n_pairs < 0:
            return n_pairs
        if n_pairs == 0:
            continue
        pa, pb = buf.pose[ia], buf.pose[ib]
        a, wa, b, wb = (
            boundary_at(bodies, ia),
            work_at(bodies, ia),
            boundary_at(bodies, ib),
            work_at(bodies, ib),
        )
        sp = of_pair(s, found, p)
        if not st.sts:  # near now: within twice the last deformation, as it grows from one to the next
            yields = len(a.modes[0]) + len(b.modes[0]) + len(a.flexibility) + len(b.flexibility) > 0
            reach = 2.0 * bend + (NEAR * st.margin if yields else 0.0)
            n_pairs = narrow(a.boxes, b.boxes, seen(pa, pb), reach, found, p, n_pairs, sp.close)
            if n_pairs == 0:
                continue
        qa, qb = q[sy.first[ia] : sy.first[ia + 1]], q[sy.first[ib] : sy.first[ib + 1]]
        first = s.load.made[0]
        if st.sts:
            n = segment_contact(a, wa, pa, qa, b, wb, pb, qb, n_pairs, stamp, st.k, st.q, st.spread, sp)
        else:
            n = area_contact(a, wa, pa, qa, b, wb, pb, qb, n_pairs, stamp, st.k, st.q, st.spread, sp)
        if n < 0:
            return n
        if n > 0:
            dx, dy = s.regions[0]["x"] - pb[0], s.regions[0]["y"] - pb[1]
            found.pole[p, 0], found.pole[p, 1] = pb[2] * dx + pb[3] * dy, -pb[3] * dx + pb[2] * dy
        for i in range(first, s.load.made[0]):
            s.load.side[i] = ia if s.load.side[i] == 0 else ib
        if total + n > len(buf.regions):
            return MANY
        for i in range(n):
            r = s.regions[i]
            kept = buf.regions[total]
            kept[0], kept[1], kept[2], kept[3] = p, r["force"], r["nx"], r["ny"]
            kept[4], kept[5], kept[6] = r["x"], r["y"], r["chord"]
            kept[7], kept[8], kept[9] = r["x_chord"], r["y_chord"], r["serial"]
            buf.force[p, 0] += r["force"] * r["nx"]
            buf.force[p, 1] += r["force"] * r["ny"]
            _assemble(buf, st, r, ia, ib)
            if sy.friction[p] > 0.0 or sy.ratio[p] > 0.0:
                resist(sy, buf, st.k, r, p, ia, ib)
            total += 1
    if st.spread and total > 0:
        for b in range(len(sy.mass)):
            to_nodes(boundary_at(bodies, b), work_at(bodies, b), buf.pose[b])
    buf.counts[0] = total
    return total


@kernel
def _growth(bodies, buf, s, pairs, first):  # type: ignore[no-untyped-def]
    """By what part of itself the force of the regions grows that share loads, from number ``first`` on."""
    one = buf.regions[first]
    a, b, serial = pairs[int(one[0]), 0], pairs[int(one[0]), 1], int(one[9])
    side, sign = (a, -1.0) if work_at(bodies, b).still[0] else (b, 1.0)
    fx = fy = x = y = 0.0
    for n in range(s.made[0]):
        if s.region[n] == serial and s.side[n] == side:
            fx += sign * buf.answer[0, n] * s.world[n, 0]
            fy += sign * buf.answer[0, n] * s.world[n, 1]
    for i in range(first, buf.counts[0]):
        r = buf.regions[i]
        if int(r[9]) != serial:
            break
        x += r[1] * r[2]
        y += r[1] * r[3]
    square = x * x + y * y
    return (x * fx + y * fy) / square if square > 0.0 else 0.0


@kernel
def correct_forces(bodies, sy, buf, st, s, pairs):  # type: ignore[no-untyped-def]
    """The forces kept, after Newton's last correction, whose change of the frames is in ``buf.rhs``.

    A region's force is that of its loads on the second body, or changes by its stiffness; as the tangent has it. It
    stays on its line. Regions that share loads, on a flat or under STS, share their change.
    """
    grows = 0.0
    for i in range(buf.counts[0]):
        r = buf.regions[i]
        if st.spread and (i == 0 or r[9] != buf.regions[i - 1, 9]):
            grows = _growth(bodies, buf, s.load, pairs, i)
        p = int(r[0])
        if sy.ratio[p] > 0.0:  # its dashpot has answered to the force as it was
            continue
        change = 0.0
        if st.spread:
            change = grows * r[1]
        else:
            for side in range(2):
                j = 3 * pairs[p, side]
                turn = (r[7] - buf.pose[pairs[p, side], 0]) * r[3] - (r[8] - buf.pose[pairs[p, side], 1]) * r[
                    2
                ]
                moved = r[2] * buf.rhs[j] + r[3] * buf.rhs[j + 1] + turn * buf.rhs[j + 2]
                change += st.k * r[6] * (moved if side == 0 else -moved)
        change = max(change, -r[1])
        r[1] += change
        fx, fy = change * r[2], change * r[3]
        buf.force[p, 0] += fx
        buf.force[p, 1] += fy
        for side in range(2):
            j, sign = pairs[p, side], -1.0 if side == 0 else 1.0
            buf.load[j, 0] += sign * fx
            buf.load[j, 1] += sign * fy
            buf.load[j, 2] += sign * ((r[4] - buf.pose[j, 0]) * fy - (r[5] - buf.pose[j, 1]) * fx)


@entry
def replay(bodies, sy, q, pairs, st, s, found, buf, x):  # type: ignore[no-untyped-def]
    """One contact evaluation for each recorded frame position x (n, b, 3)."""
    for n in range(len(x)):
        poses(x[n], buf)
        evaluate(bodies, sy, buf, q, pairs, st, s, found)
