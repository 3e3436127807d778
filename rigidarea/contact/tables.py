"""What outlives a step: a record a body, a shape, a pair, a region; pairs and regions in free lists.

Angles in radians, lengths, times, masses in the units of the space. An impulse is that of one substep.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from ..compile.jit import entry, kernel
from ..compile.raw_memory import record

LAW_AREA, LAW_ENERGY = 0, 1
CHORD, NODAL = 0, 1

#: How a body's position comes about: not at all, by our drifts, by a position function of the user's.
FIXED, DRIFTS, LED = 0, 1, 2

#: How a pair bears: with a k that has a potential, with one that follows its regions' shape, or as no load does.
LIES, FOLLOWS, BLOW = 1, 2, -1

BODY = record(
    [
        ("address", "u8"),  # of Chipmunk's body; 0: none
        ("stamp", "i8"),  # frame in which it was last met
        ("listed", "i8"),  # which list of those that are live has it, of what does not move
        ("kind", "i1"),  # FIXED, DRIFTS or LED
        ("awake", "i1"),  # 1: it is in `Tables.awake`
        ("mobile", "i1"),  # 1: contacts may move it (when it is awake)
        ("changed", "i1"),  # 1: in this frame it has come to be awake, or mobile
        ("calm", "i1"),  # 1: it hardly moved when the last frame began; -1: it hangs in a joint
        ("was_calm", "i1"),  # 1: calm, a frame before
        ("pushed", "i1"),  # 1: contacts have pushed it in the substep before
        ("free", "i1"),  # 1: what gives way to a blow: no joint or kinematic body presses it
        ("joined", "i1"),  # 1: a joint keeps it from colliding with somebody
        ("entered", "i1"),  # 1: it is in the space
        ("unmeasured", "i1"),  # 1: its shapes have changed since `extent` and `reach` were found
        ("wants", "i4"),  # substeps that it wants in this frame
        ("steps", "i4"),  # that its island takes; 0: it does not move
        ("taken", "i4"),  # that it took in the last frame; 0: it was not there
        ("asked", "i4"),  # that the user wants for its island, at least; 0: none
        ("island", "i4"),  # row of a body of the same island (`islands`)
        ("held", "i4"),  # for how many of its shapes, and for the space itself, it has its row
        ("joints", "i4"),  # of them, those that have no place in the order of the sweeps yet (`order_joints`)
        ("sum_of_joints", "i4"),  # and the sum of their numbers: of one that is left, its own
        ("x", "f8"),  # centre of gravity (length)
        ("y", "f8"),
        ("angle", "f8"),
        ("c", "f8"),  # cosine and sine of the angle
        ("s", "f8"),
        ("ox", "f8"),  # its origin, where its outlines' coordinates start (length)
        ("oy", "f8"),
        ("cog_x", "f8"),  # centre of gravity, body frame (length)
        ("cog_y", "f8"),
        ("vx", "f8"),  # (length/time)
        ("vy", "f8"),
        ("w", "f8"),  # (1/time)
        ("inverse_mass", "f8"),  # 0 for what no contact moves
        ("inverse_moment", "f8"),
        ("extent", "f8"),  # smallest extent of its shapes (length)
        ("reach", "f8"),  # no point of its shapes is farther from its origin (length)
        ("kick_x", "f8"),  # velocity that everything but contacts and joints adds in a substep
        ("kick_y", "f8"),
        ("kick_w", "f8"),
        ("came_vx", "f8"),  # velocity before the substep's sweeps (length/time)
        ("came_vy", "f8"),
        ("came_w", "f8"),
        ("way", "f8"),  # how far a point of it may go in the next drift (length)
        ("strayed", "f8"),  # how far the sweeps may send a point of it off its way in the next drift (length)
        ("shift_x", "f8"),  # what impacts within the substep move it by (length)
        ("shift_y", "f8"),
        ("shift_a", "f8"),
        ("load", "f8"),  # the largest that a contact of its bears (force)
        ("own_inverse_moment", "f8"),  # while joints have it turn more slowly (`geometric_stiffness`)
        ("tension", "f8"),  # sum over its joints of force times arm (force length)
        ("gain_x", "f8"),  # velocity that everything but contacts and joints adds in a frame
        ("gain_y", "f8"),
        ("gain_w", "f8"),
        ("thrust", "f8"),  # how much that changed its velocity, whoever did it: the user's functions too
        # how long it has moved by itself: since the user last set its place or velocity (time)
        ("since", "f8"),
        ("old_x", "f8"),  # state at the frame's start
        ("old_y", "f8"),
        ("old_a", "f8"),
        ("old_vx", "f8"),
        ("old_vy", "f8"),
        ("old_w", "f8"),
        ("old_since", "f8"),
        ("old_fx", "f8"),  # force and torque that the user has given it
        ("old_fy", "f8"),
        ("old_torque", "f8"),
    ]
)

#: What is asked of every near pair in every sweep comes first, here and in PAIR: in one line of the cache or two.
SHAPE = record(
    [
        ("outline", "i4"),  # number in the pool
        ("mirror", "i4"),  # the outline's other side, for a segment without thickness; -1: none
        ("body", "i4"),  # row of its body
        ("sensor", "i4"),
        ("extent", "f8"),  # its smallest extent (length)
        ("half_x", "f8"),  # half of its outline's bounding box, body axes (length)
        ("half_y", "f8"),
        ("left", "f8"),  # its box now (length)
        ("bottom", "f8"),
        ("right", "f8"),
        ("top", "f8"),
        ("friction", "f8"),
        ("elasticity", "f8"),
        ("address", "u8"),  # of Chipmunk's shape; 0: none
        ("ident", "i8"),  # Chipmunk's number for it
        (
            "heard",
            "i4",
        ),  # callbacks of the user's: 1 for its type with any other, 2 for its type with one other
        ("surface_x", "f8"),  # surface velocity (length/time)
        ("surface_y", "f8"),
        ("type", "u8"),  # collision type
        ("group", "u8"),  # its filter
        ("categories", "u4"),
        ("mask", "u4"),
        ("epoch", "i4"),  # of the user's callbacks, when `heard` was made
        ("asked", "i4"),  # where it is in `Tables.asked`, if it is
        ("leaf", "i4"),  # its node; -1: it is in no tree
        ("tree", "i4"),  # which tree that is
        ("seen", "i8"),  # frame in which what the user sets of it was last read
        ("low_x", "f8"),  # box within which it stays until it is asked about again (length)
        ("low_y", "f8"),
        ("high_x", "f8"),
        ("high_y", "f8"),
        ("proxy", "i4"),  # 1: Chipmunk sees another shape than the outline
    ],
)

PAIR = record(
    [
        ("a", "i4"),  # rows of the two shapes; -1: none
        ("b", "i4"),
        ("head", "i4"),  # first region; -1: none
        ("next", "i4"),  # in the free list
        ("near", "i4"),  # counters[SEARCH]: it is in `Tables.near`
        ("seats", "i1"),  # 1: it touches, and may do so elsewhere as well without turning
        ("lies", "i1"),  # how it has borne a load in this frame: LIES, FOLLOWS or BLOW; 0: not at all
        ("verdict", "i1"),  # 1: the user lets it collide, 0: not
        ("side_a", "i1"),  # of a two-sided outline: 0 undecided, 1 itself, -1 its mirror
        ("side_b", "i1"),
        ("kept_a", "i1"),  # side of it on which the other one has stayed when a frame ended; 0: not known
        ("kept_b", "i1"),
        ("now_a", "i1"),  # the same of this frame
        ("now_b", "i1"),
        ("swapped", "i1"),  # 1: the arbiter's A is our B
        ("points", "i1"),  # how many contact points it had
        ("axis_x", "f8"),  # what parted them last, A's frame, A to B (`apart`); (0, 0): nothing known
        ("axis_y", "f8"),
        ("gap", "f8"),  # how far apart along it, and in which substep (length)
        ("parted", "i8"),
        ("stamp", "i8"),  # frame in which Chipmunk last reported it
        ("lasting", "i8"),  # the frame in which it was taken to touch still, by a hair apart
        # frame in which it last waited for its verdict, since a callback of the user's will hear of it
        ("waiting", "i8"),
        ("waited", "f8"),  # how long, in that frame (time)
        ("arbiter", "u8"),  # Chipmunk's arbiter in that frame
        ("friction", "f8"),
        ("elasticity", "f8"),
        ("surface_x", "f8"),  # surface velocity, B's minus A's
        ("surface_y", "f8"),
        # by how much the user has turned the arbiter's normal in that frame: cosine and sine
        ("steer_c", "f8"),
        ("steer_s", "f8"),
        ("jx", "f8"),  # impulse on B in this frame
        ("jy", "f8"),
        ("rate", "f8"),  # force over depth with which it bears its load (force/length); 0: not chosen yet
        ("face", "f8"),  # the chord on which one of them would lie (length)
        ("load", "f8"),  # normal force carried, averaged over LOAD_TIME (force)
        ("least", "f8"),  # of its load: the weight of the lighter body
        ("firm", "f8"),  # what it resists with until its rate has grown to the load (force/length)
        ("carrying", "f8"),  # normal impulse in this frame
    ],
)

#: A pair that may touch: what is asked of all of them again and again, in one row.
NEIGHBOURS = record(
    [
        ("pair", "i4"),
        ("turn", "i4"),  # substeps of the turn that it belongs to; 0: of everybody's; -1: of two
        (
            "order",
            "f8",
        ),  # where it comes in a sweep: its height at the last search, then how far off the middle
        ("beside", "f8"),  # against gravity's left
        ("a", "u4"),  # rows of the two bodies
        ("b", "u4"),
        ("lined", "i4"),  # 1: a segment without thickness is one of them, whose side is kept
        ("extent", "f8"),  # the smaller one's smallest extent (length)
        (
            "room",
            "f8",
        ),  # so far they may stray in this substep, the two together, until `join` must look (length)
    ]
)

#: What a region is doing: resting; an impact that the steps follow; a bounce shorter than the step, over by its end;
#: an overlap yet to come, that the next drift would bring.
REST, IMPACT, STRUCK, NEARING = 0, 1, 2, 3

#: How a region at rest has come to be deeper than its load presses it: put there by hand; pressed in by a blow that has
#: nothing to give back.
PLACED, SPENT = 1, 2

#: One contact region, remembered while it lives. Also what it did in the last substep.
REGION = record(
    [
        ("stamp", "i8"),  # substep in which it was last there
        ("pair", "i4"),
        ("next", "i4"),  # next region of the pair, or of the free list; -1: none
        ("mode", "i4"),
        ("born", "i4"),  # 1: first seen in this substep
        ("past", "i4"),  # 1: past the middle of a body, the direction is kept
        ("placed", "i4"),  # PLACED or SPENT, while it is deeper than any load would press it; 0: neither
        ("opened", "i4"),  # 1 once the bodies have moved apart within this impact
        ("area", "f8"),  # (length^2)
        ("x", "f8"),  # point of application, world (length)
        ("y", "f8"),
        ("nx", "f8"),  # direction, A to B
        ("ny", "f8"),
        ("chord", "f8"),  # (length)
        ("middle", "f8"),  # of the chord, from the point of application along it (length)
        ("straight", "f8"),  # of the chord, as far as both boundaries are straight (length)
        (
            "curve_a",
            "f8",
        ),  # curvatures of the two sides (1/length), where not both have a straight stretch; else 0
        ("curve_b", "f8"),
        ("radial", "i4"),  # the direction is a radius: of A (1), of B (2), of both (3)
        ("depth", "f8"),  # extent along the direction (length)
        # time since first touch, of an impact shorter than the step; until the place seen, of an overlap yet to come
        ("back", "f8"),
        ("rest_depth", "f8"),  # depth at which it would carry what pushes (length)
        ("arm_a", "f8"),  # of direction and of tangent about the two centres (length)
        ("arm_b", "f8"),
        ("lean_a", "f8"),
        ("lean_b", "f8"),
        ("stiffness", "f8"),  # k (force/length^2)
        ("l1", "f8"),  # impulses of the substep: at the chord's start and end, and friction's
        ("l2", "f8"),
        ("lt", "f8"),
        ("step", "f8"),  # of them (time)
        ("spring", "f8"),  # force of friction's spring (force)
        ("tangent_stiffness", "f8"),  # its stiffness when last loaded (force/length)
        ("force", "f8"),  # normal force (force)
        ("friction", "f8"),  # tangential force on B along t (force)
        ("speed", "f8"),  # closing speed (length/time)
        ("slip", "f8"),  # tangential speed of A relative to B (length/time)
        # of an impact that steps follow (contact/impact.py)
        ("first_speed", "f8"),
        ("damping", "f8"),
        ("elastic", "f8"),
        ("excess", "f8"),
        ("work", "f8"),
        ("loss", "f8"),
        ("slowed", "f8"),
        ("lasted", "f8"),
        ("late", "f8"),
        ("withheld", "f8"),
    ],
)

#: Counters: free regions' list head, how many are free, free pairs' list head, how many; shapes and bodies in use;
#: which list `near` is, and substeps so far; pairs that are near and may collide; rows of this substep; body pairs kept
#: apart by joints; the first substep of this frame; 1: list all pairs anew. Of turns (`islands`): bodies that are live;
#: where the live pairs begin in `near`, and end; substeps of the turn, 0: everybody's; 1: near pairs are sorted by
#: turns; 1: two turns have met. Shapes with teeth or slots; rows of this substep that bounce. Pairs in `near`, those
#: behind counters[NEAR] such as may not collide; 1: to be sorted anew; shapes in `asked`, in `movers`, bodies in
#: `awake`, pairs in `told`; which list `live` is;
#: free rows' list heads of shapes (linked by `body`) and of bodies (by `island`); shapes not convex. Joints; 1:
#: other ones than in the last frame. How many pairs, regions and joints more than there is room for a frame wants at
#: least, and 1 where the scratch is too small, or there is none for
#: what a frame starts from (`store.keep_tables`); looks left (`motion.afford`);
#: the last frame that did not fail. How many rows of pairs and of regions have ever been in use: those behind them are
#: as they were made. How many shapes, bodies and numbers of shapes more than there is room for have come.
FREE_REGION, FREE_REGIONS, FREE_PAIR, FREE_PAIRS, SHAPES, BODIES = range(6)
SEARCH, SUBSTEP, NEAR, ROWS, APART, ANEW = range(6, 12)
LIVE, FIRST, LAST, TURN, TURNED, MET, TOOTHED, BOUNCES = range(12, 20)
BOXED, UNSORTED, ASKED, MOVERS, AWAKE, TOLD, ENLISTED, FREE_SHAPE, FREE_BODY, CONCAVE = range(20, 30)
JOINTS, REJOINED, GONE = range(30, 33)
MORE_PAIRS, MORE_REGIONS, MORE_JOINTS, MORE_WORK, MORE_KEPT, LOOKS_LEFT, COUNTED = range(33, 40)
USED_PAIRS, USED_REGIONS, MORE_SHAPES, MORE_BODIES, MORE_SLOTS = range(40, 45)
COUNTERS = 45


class Law(NamedTuple):
    """What the user chose for every region of a space."""

    stiffness: float  # k (force/length^2: a pressure per unit depth of the plane, Eq. 5 and 6); 0: by each pair's load
    penetration: float  # of its smallest extent that a body may sink, where the stiffness is chosen
    gravity: float  # its size (length/time^2)
    law: int  # LAW_AREA or LAW_ENERGY
    length: float  # l of the energy law (length)
    direction: int  # CHORD or NODAL
    exponent: float  # q of Eq. 12, for NODAL
    rest_speed: float  # first touch slower than this is rest (length/time); negative: by the load
    followed: float  # (w h)^2 up to which a step follows a contact; infinity: always


class Tables(NamedTuple):
    """What outlives a step."""

    bodies: np.ndarray  # (n,) BODY
    shapes: np.ndarray  # (n,) SHAPE
    pairs: np.ndarray  # (n,) PAIR
    regions: np.ndarray  # (n,) REGION
    rows: np.ndarray  # (n,) ROW
    factors: np.ndarray  # (n,) FACTOR, of the rows
    mobility: np.ndarray  # (n,) MOBILITY, of the bodies
    live: (
        np.ndarray
    )  # (n,) int32: bodies that go through the substeps now, and what does not move and they are near
    awake: np.ndarray  # (n,) int32: bodies that are awake, in the order of sums over them
    movers: np.ndarray  # (m,) int32: their shapes
    asked: np.ndarray  # (m,) int32: shapes whose box is to be asked whom it meets
    told: np.ndarray  # (k,) int32: pairs of which Chipmunk has told in this frame
    nodes: np.ndarray  # (2 m,) NODE: of the two trees of boxes
    roots: np.ndarray  # (3,) int32, see `tree`
    near: (
        np.ndarray
    )  # (k + 1,) NEIGHBOURS: pairs whose boxes meet, in the order of the sweeps; the last for sorting
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
    pair.seats = 0
    pair.rate = 0.0
    pair.firm = 0.0
    pair.carrying = 0.0
    pair.lies = 0
    pair.axis_x = 0.0
    pair.axis_y = 0.0
    pair.parted = -1
    pair.waiting = -1


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
        pair.head = -1
        pair.side_a = 0
        pair.kept_a = 0
        pair.kept_b = 0
        pair.side_b = 0
        pair.next = -1
        pair.near = -1
        pair.stamp = -1
        pair.lasting = -2
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


@entry
def end_pair(tables: Tables, p: int) -> None:
    """Forget the pair and its regions."""
    pair = tables.pairs[p]
    _leave(tables, pair.a, pair.b)
    free_regions(tables.regions, tables.counters, pair.head)
    pair.head = -1
    pair.a = -1
    pair.b = -1
    pair.next = tables.counters[FREE_PAIR]
    tables.counters[FREE_PAIR] = p
    tables.counters[FREE_PAIRS] += 1
