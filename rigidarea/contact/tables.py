"""What outlives a step: arrays of records (`dtypes`), and counters; pairs and regions in free lists."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from ..compile.jit import entry, kernel

LAW_AREA, LAW_ENERGY = 0, 1
CHORD, NODAL = 0, 1

#: How a body's position comes about: not at all, by our drifts, by a position function of the user's.
FIXED, DRIFTS, LED = 0, 1, 2

#: How a pair bears: with a k that has a potential, with one that follows its regions' shape, or as no load does.
LIES, FOLLOWS, BLOW = 1, 2, -1

#: What a region is doing: resting; an impact that the steps follow; a bounce shorter than the step, over by its end;
#: an overlap yet to come, that the next drift would bring.
REST, IMPACT, STRUCK, NEARING = 0, 1, 2, 3

#: How a region at rest has come to be deeper than its load presses it: put there by hand; pressed in by a blow that has
#: nothing to give back.
PLACED, SPENT = 1, 2

#: How contacts have pushed a body: until it touches; as it lay on something, or came to lie.
COMING, LYING = 1, 2

#: Counters: free regions' list head, how many are free, free pairs' list head, how many; shapes and bodies in use;
#: which list `near` is, and substeps so far; pairs that are near and may collide; rows of this substep; body pairs kept
#: apart by joints; the first substep of this frame; 1: list all pairs anew. Of turns (`islands`): bodies that are live;
#: where the live pairs begin in `near`, and end; substeps of the turn, 0: everybody's; 1: near pairs are sorted by
#: turns. Shapes with teeth or slots. Pairs in `near`, those
#: behind counters[NEAR] such as may not collide; 1: to be sorted anew; shapes in `asked`, in `movers`, bodies in
#: `awake`, pairs in `told`; which list `live` is;
#: free rows' list heads of shapes (linked by `body`) and of bodies (by `island`); shapes not convex. Joints; 1:
#: in another order than in the last frame, 2: other ones, or they keep others apart. How many pairs, regions and joints
#: more than there is room for a frame wants at
#: least, and 1 where the scratch is too small, or there is none for
#: what a frame starts from (`store.keep_tables`); looks left (`motion.afford`);
#: the last frame that did not fail. How many rows of pairs and of regions have ever been in use: those behind them are
#: as they were made. How many shapes, bodies and numbers of shapes more than there is room for have come. Islands of
#: rows (`active`), rows in `queue`, bodies in `members`. Pairs in `near` for whose regions there is room, and what the
#: user may set of whose shapes has been read. Islands of rows that are active.
FREE_REGION, FREE_REGIONS, FREE_PAIR, FREE_PAIRS, SHAPES, BODIES = range(6)
SEARCH, SUBSTEP, NEAR, ROWS, APART, ANEW = range(6, 12)
LIVE, FIRST, LAST, TURN, TURNED, TOOTHED = range(12, 18)
BOXED, UNSORTED, ASKED, MOVERS, AWAKE, TOLD, ENLISTED, FREE_SHAPE, FREE_BODY, CONCAVE = range(18, 28)
JOINTS, REJOINED, GONE = range(28, 31)
MORE_PAIRS, MORE_REGIONS, MORE_JOINTS, MORE_WORK, MORE_KEPT, LOOKS_LEFT, COUNTED = range(31, 38)
USED_PAIRS, USED_REGIONS, MORE_SHAPES, MORE_BODIES, MORE_SLOTS = range(38, 43)
ISLANDS, QUEUE, MEMBERS, KNOWN, ACTIVE = range(43, 48)
COUNTERS = 48


class Law(NamedTuple):
    """What the user chose for every region of a space, and the frame that it is."""

    stiffness: float  # k (force/length^2: a pressure per unit depth of the plane, Eq. 5 and 6); 0: by each pair's load
    penetration: float  # of its smallest extent that a body may sink, where the stiffness is chosen
    gravity: float  # its size (length/time^2)
    law: int  # LAW_AREA or LAW_ENERGY
    length: float  # l of the energy law (length)
    direction: int  # CHORD or NODAL
    exponent: float  # q of Eq. 12, for NODAL
    rest_speed: float  # first touch slower than this is rest (length/time); negative: by the load
    followed: float  # (w h)^2 up to which a step follows a contact; 0: never; infinity: always
    frame: int = -2  # Chipmunk's number of the step that has begun; -2: none


class Tables(NamedTuple):
    """What outlives a step."""

    bodies: np.ndarray  # (n,) BODY
    shapes: np.ndarray  # (n,) SHAPE
    pairs: np.ndarray  # (n,) PAIR
    regions: np.ndarray  # (n,) REGION
    rows: np.ndarray  # (n,) ROW
    factors: np.ndarray  # (n,) FACTOR, of the rows
    mobility: np.ndarray  # (n,) MOBILITY, of the bodies
    islands: np.ndarray  # (n,) ISLAND: of rows (`active`)
    queue: np.ndarray  # (n,) QUEUED: rows that are being solved, in order
    members: np.ndarray  # (n,) int32: bodies of those islands, and what nothing moves
    live: (
        np.ndarray
    )  # (n,) int32: bodies that go through the substeps now, and what does not move and they are near
    awake: np.ndarray  # (2 n,) int32: bodies that are awake, in the order of sums over them; room for sorting
    movers: np.ndarray  # (m,) int32: their shapes
    asked: np.ndarray  # (m,) int32: shapes whose box is to be asked whom it meets
    told: np.ndarray  # (k,) int32: pairs of which Chipmunk has told in this frame
    nodes: np.ndarray  # (2 m,) NODE: of the two trees of boxes
    roots: np.ndarray  # (3,) int32, see `tree`
    near: (
        np.ndarray
    )  # (2 k + 1,) NEIGHBOURS: pairs whose boxes meet, in the order of the sweeps; room for sorting
    apart: np.ndarray  # (n, 2) int32: bodies that a joint keeps from colliding
    joints: np.ndarray  # (n,) JOINT
    table: np.ndarray  # (m,) int32: hash table of pairs by their shapes; -1: empty
    counters: np.ndarray  # (COUNTERS,) int64


@kernel(forceinline=True)
def pairs_in_use(tables: Tables) -> int:
    """How many: whoever walks through all of them may stop after the last."""
    return len(tables.pairs) - int(tables.counters[FREE_PAIRS])


@kernel(forceinline=True)
def _home(tables: Tables, a: int, b: int) -> int:
    return int((min(a, b) * 73856093 ^ max(a, b) * 19349663) & (len(tables.table) - 1))


@kernel
def _place(tables: Tables, a: int, b: int) -> int:
    """Where in the hash table the pair of shape rows a and b is, or would be entered."""
    mask = len(tables.table) - 1
    i = _home(tables, a, b)
    while tables.table[i] >= 0:
        pair = tables.pairs[tables.table[i]]
        if (pair.a == a and pair.b == b) or (pair.a == b and pair.b == a):
            break
        i = (i + 1) & mask
    return i


@kernel
def find_pair(tables: Tables, a: int, b: int) -> int:
    """The pair of shape rows a and b; -1: there is none."""
    return int(tables.table[_place(tables, a, b)])


@kernel
def _leave(tables: Tables, a: int, b: int) -> None:
    """Take a pair out: those that would be found by it move up (Knuth, vol. 3, 6.4, algorithm R)."""
    mask = len(tables.table) - 1
    i = _place(tables, a, b)
    k = (i + 1) & mask
    while tables.table[k] >= 0 and tables.table[i] >= 0:
        pair = tables.pairs[tables.table[k]]
        if ((k - _home(tables, pair.a, pair.b)) & mask) >= ((k - i) & mask):
            tables.table[i] = tables.table[k]
            i = k
        k = (k + 1) & mask
    tables.table[i] = -1


@entry
def rehash(tables: Tables) -> None:
    """Make the hash table anew from the pairs in use."""
    tables.table[:] = -1
    left = pairs_in_use(tables)
    for p in range(len(tables.pairs)):
        if left == 0:
            break
        if tables.pairs[p].a >= 0:
            left -= 1
            tables.table[_place(tables, tables.pairs[p].a, tables.pairs[p].b)] = p


@entry
def append_free(following: np.ndarray, counters: np.ndarray, head: int, first: int) -> None:
    """Rows from `first` on at the end of a free list: who is taken next does not depend on how large the table is.

    head: the counter of the list's first row; the next one is how many are free.
    """
    last = counters[head]
    counters[head + 1] += len(following) - first
    for i in range(first, len(following)):
        following[i] = i + 1 if i + 1 < len(following) else -1
    if last < 0:
        counters[head] = first
        return
    while 0 <= following[last] < first:
        last = following[last]
    following[last] = first


@kernel
def never_used(tables: Tables, pairs: int, regions: int) -> None:
    """Rows that the counters say were never in use, though they have been (those before `pairs`, `regions`)."""
    for p in range(tables.counters[USED_PAIRS], pairs):
        pair = tables.pairs[p]
        pair.a = -1
        pair.b = -1
        pair.head = -1
        pair.next = p + 1 if p + 1 < len(tables.pairs) else -1
    for r in range(tables.counters[USED_REGIONS], regions):
        region = tables.regions[r]
        region.stamp = -1
        region.next = r + 1 if r + 1 < len(tables.regions) else -1


@kernel
def comes_first(tables: Tables, a: int, b: int) -> bool:
    """Whether shape a is A of a pair with b: what cannot move, then what is lower, then what is further left.

    By place, so that nothing depends on who was added first (`report` shows A first added all the same); that only
    decides between two in one place.
    """
    one = tables.shapes[a]
    other = tables.shapes[b]
    me = tables.bodies[one.body]
    it = tables.bodies[other.body]
    if me.mobile != it.mobile:
        return bool(me.mobile < it.mobile)
    if me.y != it.y:
        return bool(me.y < it.y)
    if me.x != it.x:
        return bool(me.x < it.x)
    return bool(one.ident < other.ident)


@kernel(forceinline=True)
def _renew(pair: Any) -> None:
    """A pair that nothing is known of but who it is."""
    pair.head = -1
    pair.side_a = 0
    pair.side_b = 0
    pair.kept_a = 0
    pair.kept_b = 0
    pair.lasting = -2
    pair.seats = 0
    pair.covered = 0
    pair.rate = 0.0
    pair.firm = 0.0
    pair.carrying = 0.0
    pair.lies = 0
    pair.axis_x = 0.0
    pair.axis_y = 0.0
    pair.parted = -1
    pair.waiting = -1
    pair.owed = 0.0


@entry
def new_pair(tables: Tables, a: int, b: int) -> int:
    """Take a pair from the free list, A by place (`comes_first`); -1: there is none."""
    counters = tables.counters
    p = counters[FREE_PAIR]
    if p >= 0:
        pair = tables.pairs[p]
        counters[FREE_PAIR] = pair.next
        counters[FREE_PAIRS] -= 1
        counters[USED_PAIRS] = max(counters[USED_PAIRS], p + 1)
        first = comes_first(tables, a, b)
        pair.a = a if first else b
        pair.b = b if first else a
        pair.next = -1
        pair.near = -1
        pair.stamp = -1
        pair.verdict = 1
        pair.arbiter = 0
        pair.steer_c = 1.0
        pair.steer_s = 0.0
        pair.jx = 0.0
        pair.jy = 0.0
        _renew(pair)
        tables.table[_place(tables, a, b)] = p
    return int(p)


@kernel
def free_regions(regions: np.ndarray, counters: np.ndarray, r: int) -> None:
    """Put the list that starts at region r onto the free list."""
    while r >= 0:
        after = regions[r].next
        regions[r].stamp = -1
        regions[r].next = counters[FREE_REGION]
        counters[FREE_REGION] = r
        counters[FREE_REGIONS] += 1
        r = after


@kernel
def forget_contacts(tables: Tables) -> None:
    """All pairs as if they had never touched."""
    left = pairs_in_use(tables)
    for p in range(len(tables.pairs)):
        if left == 0:
            break
        pair = tables.pairs[p]
        if pair.a >= 0:
            left -= 1
            free_regions(tables.regions, tables.counters, pair.head)
            pair.head = -1
            _renew(pair)


@kernel
def forget_pair(tables: Tables, p: int) -> None:
    """A pair goes on as a new one would (`new_pair`), but for what Chipmunk has told of it, and is yet to hear."""
    pair = tables.pairs[p]
    free_regions(tables.regions, tables.counters, pair.head)
    _renew(pair)
    if not comes_first(tables, pair.a, pair.b):
        pair.a, pair.b = pair.b, pair.a
        pair.swapped = 1 - pair.swapped
        pair.surface_x = -pair.surface_x
        pair.surface_y = -pair.surface_y
        pair.jx = -pair.jx
        pair.jy = -pair.jy


@kernel
def disturb_both(tables: Tables, pair: Any) -> None:
    """Neither of a pair rests on the other any more."""
    for i in (tables.shapes[pair.a].body, tables.shapes[pair.b].body):
        body = tables.bodies[i]
        body.rests = 0
        body.has_rested = 0
        body.wants = max(1, body.wants)


@entry
def end_pair(tables: Tables, p: int) -> None:
    """Forget the pair and its regions."""
    pair = tables.pairs[p]
    if pair.head >= 0:
        disturb_both(tables, pair)
    _leave(tables, pair.a, pair.b)
    free_regions(tables.regions, tables.counters, pair.head)
    pair.head = -1
    pair.a = -1
    pair.b = -1
    pair.next = tables.counters[FREE_PAIR]
    tables.counters[FREE_PAIR] = p
    tables.counters[FREE_PAIRS] += 1
