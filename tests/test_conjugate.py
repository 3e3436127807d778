"""The search that takes all rows together, against dense algebra: exact on trees, never uphill, no bound passed."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from rigidarea.contact import active, conjugate, dtypes, preconditioner, tables


def system(pairs: list[tuple[int, int]], n: int, seed: int, friction: float = 1e9) -> SimpleNamespace:
    """Rows between the bodies of `pairs` (body 0 is fixed), anyhow: faces, compliances, masses, velocities."""
    rng = np.random.default_rng(seed)
    bodies = np.zeros(n, dtypes.BODY)
    bodies["inverse_mass"][1:] = 10 ** rng.uniform(-2, 1, n - 1)
    bodies["inverse_moment"][1:] = 10 ** rng.uniform(-2, 1, n - 1)
    for name in ("vx", "vy", "w"):
        bodies[name][1:] = rng.normal(size=n - 1)
    rows = np.zeros(len(pairs), dtypes.ROW)
    for r, (a, b) in zip(rows, pairs):
        angle = rng.uniform(0, 6.3)
        r["a"], r["b"], r["ends"] = a, b, 2
        r["nx"], r["ny"] = np.cos(angle), np.sin(angle)
        for name in ("arm_a", "arm_b", "lean_a", "lean_b", "t1", "t2", "tt"):
            r[name] = rng.normal()
        r["e1"], r["e2"] = -rng.uniform(0.2, 1), rng.uniform(0.2, 1)
        r["alpha"], r["alpha_t"] = 10 ** rng.uniform(-3, -1, 2)
        r["gamma"], r["gamma_t"] = rng.uniform(0.3, 0.5), 0.3
        r["own"], r["other"] = rng.uniform(4.0, 8.0), rng.uniform(-6.0, -2.0) / 2
        r["friction"], r["weight"] = friction, 1e-6
        r["l1"], r["l2"], r["lt"] = 1e6, 1e6, 0.0  # far from every bound
        r["f1"], r["f2"], r["ft"] = (r["l1"], r["l2"], r["lt"]) + rng.normal(size=3)
    counters = np.zeros(tables.COUNTERS, np.int64)
    counters[tables.BODIES] = counters[tables.LIVE] = n
    counters[tables.ROWS] = len(pairs)
    mine = dict(
        bodies=bodies,
        rows=rows,
        factors=np.zeros(len(pairs), preconditioner.FACTOR),
        mobility=np.zeros(n, preconditioner.MOBILITY),
        live=np.arange(n, dtype=np.int32),
        counters=counters,
    )
    return SimpleNamespace(**mine, n=n, pairs=pairs)


def tables_of(s: SimpleNamespace) -> Any:
    """The kernels' tables, every island to be searched; what the search does not look at is empty."""
    from rigidarea.chipmunk.arrays import Store

    found = Store().tables._replace(
        bodies=s.bodies,
        rows=s.rows,
        factors=s.factors,
        mobility=s.mobility,
        islands=np.zeros(s.n, active.ISLAND),
        queue=np.zeros(len(s.rows), active.QUEUED),
        members=np.zeros(s.n, np.int32),
        live=s.live,
        counters=s.counters,
    )
    law = tables.Law(0.0, 2e-4, 10.0, tables.LAW_AREA, 1.0, tables.CHORD, 1.0, -1.0, 0.05)
    active.form_islands(found, law, 1 / 120, 0)
    conjugate.select_searched(found, False)
    return found


def dense(s: SimpleNamespace) -> tuple[np.ndarray, np.ndarray]:
    """(A, r): what changes of all impulses take from the velocities that are lacking, and those now."""
    m = np.concatenate([[b["inverse_mass"], b["inverse_mass"], b["inverse_moment"]] for b in s.bodies])
    v = np.concatenate([[b["vx"], b["vy"], b["w"]] for b in s.bodies])
    k = 3 * len(s.rows)
    jacobian, compliance, right = np.zeros((k, 3 * s.n)), np.zeros((k, k)), np.zeros(k)
    for i, r in enumerate(s.rows):
        nx, ny = r["nx"], r["ny"]
        for j, (own, other, at) in enumerate(
            [
                ((nx, ny, r["arm_a"] - r["e1"]), (nx, ny, r["arm_b"] - r["e1"]), 3 * i),
                ((nx, ny, r["arm_a"] - r["e2"]), (nx, ny, r["arm_b"] - r["e2"]), 3 * i + 1),
                ((-ny, nx, r["lean_a"]), (-ny, nx, r["lean_b"]), 3 * i + 2),
            ]
        ):
            jacobian[at, 3 * r["a"] : 3 * r["a"] + 3] += own
            jacobian[at, 3 * r["b"] : 3 * r["b"] + 3] -= other
            right[at] = -(r["t1"], r["t2"], r["tt"])[j]
        block = np.zeros((3, 3))
        block[:2, :2] = r["alpha"] / r["gamma"] * np.array([[r["own"], r["other"]], [r["other"], r["own"]]])
        block[2, 2] = r["alpha_t"] / r["gamma_t"]
        compliance[3 * i : 3 * i + 3, 3 * i : 3 * i + 3] = block
        right[3 * i : 3 * i + 3] += block @ (r["f1"] - r["l1"], r["f2"] - r["l2"], r["ft"] - r["lt"])
    return (jacobian * m) @ jacobian.T + compliance, right + jacobian @ v


def lacking(s: SimpleNamespace, start: tuple[np.ndarray, np.ndarray]) -> float:
    """Energy norm of what is still to be solved, over that at the start."""
    matrix, right = start
    now = dense(s)[1]
    return float(np.sqrt(now @ np.linalg.solve(matrix, now) / (right @ np.linalg.solve(matrix, right))))


def tree(n: int, seed: int) -> list[tuple[int, int]]:
    """Each body on one that is lower, or on the ground; any of the two may be A."""
    rng = np.random.default_rng(seed)
    pairs = [(int(rng.integers(0, i)), i) for i in range(1, n)]
    return [(a, b) if rng.random() < 0.5 else (b, a) for a, b in pairs]


@pytest.mark.parametrize("seed", range(5))
def test_a_tower_takes_one_step(seed):
    """Bodies one upon the other, eliminated from the ground up: exact but for what is added to keep blocks regular."""
    s = system([(i, i + 1) for i in range(20)], 21, seed)
    start = dense(s)
    conjugate.conjugate_gradients(tables_of(s), 1, False)
    assert lacking(s, start) < 1e-6


@pytest.mark.parametrize("seed", range(5))
def test_branches_upon_branches(seed):
    """Towers side by side from one floor, and forks held from below only: trees as well."""
    pairs = [(0 if i % 5 == 1 else i - 1, i) for i in range(1, 26)]
    s = system(pairs, 26, seed)
    start = dense(s)
    conjugate.conjugate_gradients(tables_of(s), 1, False)
    assert lacking(s, start) < 1e-6


@pytest.mark.parametrize("seed", range(5))
def test_where_supports_are_shared_it_converges_as_conjugate_gradients_do(seed):
    """A wall of bricks, every one on two: never uphill, and to rounding in as many steps as there are unknowns."""
    width, height = 6, 4
    pairs = [(0, 1 + i) for i in range(width)]
    for y in range(1, height):
        for i in range(width - 1):
            top = 1 + y * width + i
            pairs += [(top - width, top), (top, top - width + 1)]
    s = system(pairs, 1 + width * height, seed)
    start = dense(s)
    before = 1.0
    found = tables_of(s)
    for steps in (1, 2, 4, 8):
        fresh = system(pairs, 1 + width * height, seed)
        conjugate.conjugate_gradients(tables_of(fresh), steps, False)
        now = lacking(fresh, start)
        assert now <= before * (1 + 1e-12)
        before = now
    conjugate.conjugate_gradients(found, 3 * len(pairs), False)
    assert lacking(s, start) < 1e-8


@pytest.mark.parametrize("seed", range(20))
def test_no_end_pulls_and_no_friction_is_beyond_its_bound(seed):
    """Impulses near their bounds: a step is cut short, and takes no more than brings the rows nearer to rest."""
    rng = np.random.default_rng(seed)
    s = system(tree(15, seed) + [(3, 9), (5, 12)], 15, seed, friction=0.5)
    s.rows["l1"], s.rows["l2"] = rng.uniform(0, 1, (2, len(s.rows)))
    s.rows["lt"] = rng.uniform(-0.4, 0.4, len(s.rows)) * (s.rows["l1"] + s.rows["l2"])
    start = dense(s)
    conjugate.conjugate_gradients(tables_of(s), 4, False)
    assert (s.rows["l1"] >= 0).all() and (s.rows["l2"] >= 0).all()
    most = s.rows["friction"] * (s.rows["l1"] + s.rows["l2"])
    assert (np.abs(s.rows["lt"]) <= most * (1 + 1e-12)).all()
    assert lacking(s, start) <= 1.0 + 1e-12


def test_islands_are_searched_as_if_each_were_alone():
    """Three piles on one ground, side by side: each goes as it does by itself, however hard the others are."""
    alone = [system(tree(n, n) + [(1, n - 1)], n, n) for n in (4, 9, 15)]
    pairs, first = [], 0
    for one in alone:
        pairs += [tuple(first + i if i else 0 for i in pair) for pair in one.pairs]
        first += one.n - 1
    together = system(pairs, first + 1, 0)
    at, row = 1, 0
    for one in alone:
        together.bodies[at : at + one.n - 1] = one.bodies[1:]
        rows = one.rows.copy()
        rows["a"], rows["b"] = (
            together.rows["a"][row : row + len(rows)],
            together.rows["b"][row : row + len(rows)],
        )
        together.rows[row : row + len(rows)] = rows
        at, row = at + one.n - 1, row + len(rows)
    conjugate.conjugate_gradients(tables_of(together), 3, False)
    for one in alone:
        conjugate.conjugate_gradients(tables_of(one), 3, False)
    assert (together.rows["l1"] == np.concatenate([one.rows["l1"] for one in alone])).all()
    assert together.counters[tables.ISLANDS] >= 3  # a tree may have several stems


def test_an_island_that_is_solved_is_left_alone_until_a_row_joins_it():
    """Two towers: one is solved, the other goes on; a row between the two makes one island of them, and it goes on."""
    s = system([(0, 1), (1, 2), (0, 3), (3, 4)], 5, 3)
    found = tables_of(s)
    queue = found.queue["row"]
    assert list(queue[: s.counters[tables.QUEUE]]) == [0, 1, 2, 3]
    found.islands["moved"][:2] = 0.0, 1e9
    active.rest_settled(found, 2, 9, 0.0)
    assert list(queue[: s.counters[tables.QUEUE]]) == [2, 3]
    s.rows[3]["a"], s.rows[3]["b"] = 2, 4
    law = tables.Law(0.0, 2e-4, 10.0, tables.LAW_AREA, 1.0, tables.CHORD, 1.0, -1.0, 0.05)
    active.form_islands(found, law, 1 / 120, 3)
    assert list(queue[: s.counters[tables.QUEUE]]) == [0, 1, 2, 3] and s.counters[tables.ISLANDS] == 2
