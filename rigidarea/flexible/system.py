"""What the stepper works on: a system of bodies as arrays, its settings, its state, and scratch."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Ints = NDArray[np.int64]

REGIONS = 4096  # contact regions of a system, all pairs, at one instant


class System(NamedTuple):
    """A list of bodies as arrays (b bodies, m modes in all); see ``Body``."""

    mass: Array
    inertia: Array
    fixed: Ints
    hub: Array
    pinned: Ints
    anchor: Array
    driven: Ints
    drive: Array
    damper: Array
    torque: Array
    gravity: Array
    first: Ints  # (b + 1,) where each body's modes begin
    square: Array  # (m,) ω²
    viscous: Array  # (m,) 2 ζ ω
    stretch: Array  # (m,)
    size: Array  # (b,) largest radius of each boundary
    amplitude: Array  # (m,) largest displacement of the boundary in each mode
    inverse: Array  # (b, 2) inverse mass and moment of inertia, 0 where a body does not yield to forces
    friction: Array  # (p,) coefficient of each pair
    tense: Array  # (b, 3) largest part of the stiffness that unit spin (squared) and hub force (x, y) add
    ratio: Array  # (p,) damping ratio of its contacts
    joints: NDArray[np.void]  # (j,) rows of ``joints.JOINT``


class Settings(NamedTuple):
    """Contact and scheme: k, q (or reach, for STS), sts, spread loads, search margin, and generalised-α constants.

    loose: nothing but contacts and gravity acts on the bodies, and they have no modes.
    """

    k: float
    q: float
    sts: bool
    spread: bool
    margin: float
    rho: float
    loose: bool


class State(NamedTuple):
    """x, v, acceleration, auxiliary acceleration (b, 3) and the same of the modes (m,); multipliers (b + j, 3).

    turn (b, 4): the hub's rotation by static flexibility and the same of it: it has no inertia, but the scheme's rate,
    so that frame, modes and static flexibility have one rate for what drives and damps the hub.
    """

    x: Array
    v: Array
    acc: Array
    aux: Array
    q: Array
    dq: Array
    ddq: Array
    auxq: Array
    mu: Array
    turn: Array


class Buffers(NamedTuple):
    """Scratch of the stepper: b bodies, p pairs, j joints, m modes, room for c loads."""

    pose: Array  # (b, 4)
    matrix: Array  # and a column for the right-hand side
    rhs: Array
    load: Array  # (b, 3) generalised contact forces
    tangent: Array  # (6 b, 6 b) of the contacts: frames, then hub loads (x, y, moment)
    push: (
        Array  # (6 b,) what the loads' own Newton step adds to forces on frames, and to displacements of hubs
    )
    row: Array  # (3 b,)
    force: Array  # (p, 2) on the second body of each pair
    regions: (
        Array  # (REGIONS, 10): pair, force, direction, point, chord, its middle, serial number of its loads
    )
    modal_residual: Array
    # (b, 9) ``hub.Hub``; moment of the frame's inertia; ``rows.constraint_rows``; ``hub.second_order`` (2); gradient of
    # that moment by the frame's angle
    hubs: Array
    swing: (
        Array  # (m,) gradient of the modes' residual by their frame's angle: ``floating_frame.turning_rows``
    )
    column: Ints  # (3 b,) unknown of each hub's constraint force or moment, -1 if there is none
    counts: Ints  # [0] regions, [1] evaluation stamp, [2] columns of P, [3] loads and turns, [4] whether across, too
    bend: Array  # (b,) largest displacement of the boundary under a contact, by static flexibility
    most: Array  # (b,) the largest of it so far
    # the loads' system, see ``condense``: room for t regions that turn
    touched: Ints  # (b,)
    active: Ints  # (6 b,) frames' and hubs' unknowns that move a load: rows of ``tangent``
    own: Ints  # (c,) loads on one body
    turning: Ints  # (c,) unknown of the turn of its region, -1: does not turn
    modal: Array  # (c, most modes of a body) of the modes along each load
    gauge: Array  # (c, most modes of a body) and across it, a quarter of a turn counter-clockwise
    lag: Array  # (2, c) what modes move a load along and across as their frame turns by 1
    local: Array  # (2 c, 2 c) what the loads on one body move each other, along and across
    turned: Array  # (most modes of a body, 2 c) scratch of that
    along: Array  # (c, c + t + 1 + 6 b) what loads and turns move loads along their directions; a; P
    across: Array  # the same across them
    system: Array  # (c + t, c + t + 1 + 6 b) for ``dense.factor``
    pivot: Ints  # (c + t,)
    grip: Array  # (6 b, 6 b + 1) forces on what is ``active``, by a and by unit motions of it
    single: Array  # (c + t,) solution
    answer: Array  # (2, c) change of each load, along it and across
    # friction and damping, see ``resist``
    rate: Array  # (b, 3) velocities of the frames
    momentum: Array  # (b,) moment of momentum of frame and modes of a part of a space, see ``inspace``
    clock: Array  # (2,) step length, change of a velocity by that of its position
    springs: Array  # (3, REGIONS, 4) pair, place (2), stretch: of this evaluation, the last step, the step before it
    held: Ints  # (3,) how many
    # (2, p, 7) force, direction, point, chord of the pairs that touch, for how long: in the last step, when it began
    met: Array
    joint: Array  # (j, 3) force and moment of each joint on its body b
    modes: Array  # (4, most modes of a body) see ``frame.inertia_forces``
    pace: Array  # (5,) of Newton's method, see ``pace``


def buffers(bodies: int, pairs: int, joints: int, modes: list[int], room: int) -> Buffers:
    """Scratch for so many bodies, pairs and joints, modes of each body, and ``room`` loads."""
    n, m, rows = bodies, sum(modes), 6 * bodies + 3 * joints
    turns = room // 2  # a region has two loads at least
    unknowns, most = room + turns, max(modes, default=0)
    wide = unknowns + 1 + 6 * n
    return Buffers(
        np.zeros((n, 4)), np.zeros((rows, rows + 1)), np.zeros(rows + 2), np.zeros((n, 3)), np.zeros((6 * n, 6 * n)),
        np.zeros(6 * n), np.zeros(3 * n), np.zeros((pairs, 2)), np.zeros((REGIONS, 10)), np.zeros(m), np.zeros((n, 9)),
        np.zeros(m),
        np.zeros(3 * n, np.int64), np.zeros(5, np.int64), np.zeros(n), np.zeros(n),
        np.zeros(n, np.int64), np.zeros(6 * n, np.int64), np.zeros(room, np.int64), np.zeros(room, np.int64),
        np.zeros((room, most)), np.zeros((room, most)), np.zeros((2, room)),
        np.zeros((2 * room, 2 * room)), np.zeros((most, 2 * room)), np.zeros((room, wide)),
        np.zeros((room, wide)), np.zeros((unknowns, wide)), np.zeros(unknowns, np.int64), np.zeros((6 * n, 6 * n + 1)),
        np.zeros(unknowns),
        np.zeros((2, room)), np.zeros((n, 3)), np.zeros(n), np.zeros(2),
        np.zeros((3, REGIONS, 4)), np.zeros(3, np.int64), np.zeros((2, pairs, 7)), np.zeros((joints, 3)),
        np.zeros((4, most)), np.zeros(5),
    )  # fmt: skip
