"""What stands in the arrays: a record a body, a shape, a pair, a near pair, a region, a row of the solve.

Angles in radians, lengths, times, masses in the units of the space. An impulse is that of one substep.
What the fields' small numbers mean (FIXED, LIES, REST, PLACED, ...) stands in `tables`.
"""

from __future__ import annotations

from ..compile.raw_memory import record

BODY = record(
    [
        ("address", "u8"),  # of Chipmunk's body; 0: none
        ("stamp", "i8"),  # frame in which it was last met
        ("listed", "i8"),  # which list of those that are live has it, of what does not move
        ("kind", "i1"),  # FIXED, DRIFTS or LED
        ("awake", "i1"),  # 1: it is in `Tables.awake`
        ("mobile", "i1"),  # 1: contacts may move it (when it is awake)
        ("changed", "i1"),  # 1: in this frame it has come to be awake, or mobile
        ("calm", "i1"),  # 1: it hardly moved when the frame began; -1: it hangs in a joint; -2: both
        ("was_calm", "i1"),  # 1: calm, a frame before
        # which of REST_TURNS substeps it is for its island (`active`), and was when the frame began
        ("rest_turn", "i1"),
        ("old_turn", "i1"),
        ("undone", "i1"),  # 1: its last frame has failed
        ("same", "i1"),  # 1: at rest, and as the last frame has left it
        ("pushed", "i1"),  # COMING, LYING: how contacts have pushed it in the substep before; 0: not at all
        ("free", "i1"),  # 1: what gives way to a blow: no joint or kinematic body presses it
        ("joined", "i1"),  # 1: a joint keeps it from colliding with somebody
        ("entered", "i1"),  # 1: it is in the space
        ("unmeasured", "i1"),  # 1: its shapes have changed since `extent` and `reach` were found
        ("wants", "i4"),  # substeps that it wants in this frame
        ("steps", "i4"),  # that its island takes; 0: it does not move
        ("asked", "i4"),  # that the user wants for its island, at least; 0: none
        ("island", "i4"),  # row of a body of the same island (`islands`, `active`)
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
        ("gained", "f8"),  # by what the last frame has changed its velocity (length/time)
        # for how long it has kept its place, and what pushes it has not changed (`at_rest`); that, a frame before
        ("rests", "f8"),
        ("has_rested", "f8"),
        ("rest_x", "f8"),  # that place
        ("rest_y", "f8"),
        ("rest_a", "f8"),
        ("went", "f8"),  # how far it is from there (length)
        # what sweeps still changed in its island when that was solved as far as it takes to rest (length/time)
        ("unsolved", "f8"),
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
        ("forced_x", "f8"),  # acceleration by forces and gravity, or all that a function of the user's gives
        ("forced_y", "f8"),
        ("forced_w", "f8"),
        ("was_x", "f8"),  # that of the frame before
        ("was_y", "f8"),
        ("was_w", "f8"),
        ("trend_x", "f8"),  # and by how much it was more than in the one before that
        ("trend_y", "f8"),
        ("trend_w", "f8"),
        ("lead_x", "f8"),  # what forces that go on as they change have given ahead (length/time; 1/time)
        ("lead_y", "f8"),
        ("lead_w", "f8"),
        # how long it has moved by itself: since the user last set its place or velocity (time)
        ("since", "f8"),
        ("left_vx", "f8"),  # velocity with which the last frame has left it (length/time)
        ("left_vy", "f8"),
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
        (
            "disturbed",
            "i8",
        ),  # last frame before which the user has changed what it does to whom it touches; -1: none
        ("replaced", "i8"),  # frame before which the user has put it elsewhere, if nothing moves it; -1: none
        # by how much the user has moved it before this frame, if contacts do not; by how much they ask a function of
        # the user's to, in the next (length)
        ("put_x", "f8"),
        ("put_y", "f8"),
        ("put_a", "f8"),
        ("turned", "f8"),  # `w` a substep ago, where joints have looked at it
        # (not 512 bytes: one field of all bodies would lie in the same few lines of the cache)
        ("swayed", "f8"),  # `tension` a substep ago, then the part of its sway that is lost
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
        ("covered", "i1"),  # 1: all of it that overlaps lies within neighbours (`exposed`)
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
        ("owed", "f8"),  # by how much the two have been put back for it when the last frame ended (time)
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
        # so much later than the first a bounce's second end touches (time); negative: earlier; 0: there is but one
        ("later", "f8"),
        ("reach", "f8"),  # and where along the tangent the first is, from the point of application (length)
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


ROW = record(
    [
        ("region", "i4"),  # of a joint: its number
        ("a", "i4"),  # rows of the bodies
        ("b", "i4"),
        ("ends", "i4"),  # 1 or 2; 0: of a joint
        ("nx", "f8"),
        ("ny", "f8"),
        ("arm_a", "f8"),
        ("arm_b", "f8"),
        ("lean_a", "f8"),
        ("lean_b", "f8"),
        ("alpha", "f8"),
        ("gamma", "f8"),
        ("f1", "f8"),  # h F0 of the ends
        ("t1", "f8"),  # vt
        ("det", "f8"),  # of a joint: one over its determinant
        ("friction", "f8"),
        ("most", "f8"),  # of lt, whatever the ends bear (`rest_settled`); of a joint's impulse
        ("alpha_t", "f8"),
        ("gamma_t", "f8"),
        ("ft", "f8"),
        ("tt", "f8"),
        ("mt", "f8"),  # 1 / (alpha_t + gamma_t W_t)
        ("slip1", "f8"),  # what an impulse at either end takes from the slip
        ("l1", "f8"),
        ("lt", "f8"),
        ("weight", "f8"),  # 1/m_eff
        ("began", "f8"),  # normal impulse with which it began
        (
            "held",
            "f8",
        ),  # no less than its spring holds, and could give back: what is linear in depth half; what a joint does as it
        # mends an error, against what it bore before (energy)
        ("m1", "f8"),  # of one end: what an impulse there adds to its speed, its friction gripping, inverse
        # of two ends:
        ("e1", "f8"),
        ("e2", "f8"),
        ("own", "f8"),  # their compliance [[own, other], [other, own]] / C
        ("other", "f8"),
        ("f2", "f8"),
        ("t2", "f8"),
        ("w11", "f8"),  # mobility of the ends (1/mass)
        ("w12", "f8"),
        ("w22", "f8"),
        ("slip2", "f8"),
        ("l2", "f8"),
        # of a joint (`joint`), which has w11, w12, w22 of both its unknowns:
        ("low", "f8"),  # bounds of l1 and lt
        ("high", "f8"),
        ("low_t", "f8"),
        ("high_t", "f8"),
        ("grips", "i4"),  # 1: lt is an unknown
        ("swapped", "i4"),  # 1: its second end is called its first
        ("bend1", "f8"),  # what `bend` has added to t1 and tt
        ("bend_t", "f8"),
        # not of the sweeps:
        ("was1", "f8"),  # the impulses of the solve before (`relax`, `given_energy`)
        ("was2", "f8"),
        ("was_t", "f8"),
        ("theta", "f8"),  # how far its opening is of the step's making: 0 to 1
        ("slid", "f8"),  # slip of what relaxing has moved them by, over the substep (length/time)
        (
            "jammed",
            "i4",
        ),  # 1: put so deep, and held there by a joint: what takes them apart is no force on them
        ("shift", "f8"),  # time by which an impact's change of velocity is moved into the past
    ]
)
