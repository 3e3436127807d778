"""A region and its two bodies: arms, closing speed, inverse mass, stiffness, the smaller one's size."""

from __future__ import annotations

from typing import Any

from ..compile.jit import kernel
from ..geometry.extent import extent
from ..geometry.place import Pose
from ..geometry.work import Work
from .constants import LOOK
from .patch import Patch
from .tables import LAW_AREA, Law

#: An arm of less than this part of the lever along the direction is a radius, but for rounding.
RADIAL = 1e-9


@kernel
def fill(region: Any, patch: Patch, ax: float, ay: float, bx: float, by: float) -> None:
    """The region's place and arms: about the centres (ax, ay) and (bx, by)."""
    region.area = patch.area
    region.x = patch.x
    region.y = patch.y
    region.nx = patch.nx
    region.ny = patch.ny
    region.chord = patch.chord
    region.middle = patch.middle
    region.straight = patch.straight
    region.curve_a = patch.curve_a
    region.curve_b = patch.curve_b
    region.depth = patch.depth
    region.arm_a = (patch.x - ax) * patch.ny - (patch.y - ay) * patch.nx
    region.arm_b = (patch.x - bx) * patch.ny - (patch.y - by) * patch.nx
    region.lean_a = (patch.x - ax) * patch.nx + (patch.y - ay) * patch.ny
    region.lean_b = (patch.x - bx) * patch.nx + (patch.y - by) * patch.ny
    region.radial = 0
    if patch.radial & 1 and abs(region.arm_a) <= RADIAL * abs(region.lean_a):
        region.arm_a = 0.0
        region.radial = 1
    if patch.radial & 2 and abs(region.arm_b) <= RADIAL * abs(region.lean_b):
        region.arm_b = 0.0
        region.radial |= 2


@kernel
def to_the_surfaces(work: Work, region: Any, k: int, pose: Pose) -> None:
    """Friction's arms of an overlap yet to come (loop k, A at `pose`): of the two surfaces, which will only touch.

    Its centroid is as deep in both as they would go on into each other.
    """
    loop = work.loops[k]
    nx = pose.c * region.nx + pose.s * region.ny
    ny = pose.c * region.ny - pose.s * region.nx
    low, high = extent(work.polygon, work.bows, loop.start, loop.stop, loop.arcs > 0, nx, ny)
    middle = nx * loop.x + ny * loop.y
    region.lean_a += high - middle
    region.lean_b += low - middle


@kernel(forceinline=True)
def is_face(region: Any) -> bool:
    """Whether it bears at both ends of a straight stretch: not a corner, an arc, one of many facets, which roll."""
    return bool(region.straight >= 0.5 * region.chord)


@kernel(forceinline=True)
def others_push(a: Any, b: Any) -> bool:
    """Whether contacts have pushed one of two bodies a substep ago: others are near, and solved with the two."""
    return bool((a.pushed and a.mobile) or (b.pushed and b.mobile))


@kernel(forceinline=True)
def least_extent(a: Any, b: Any) -> float:
    """The smaller one's smallest extent, of those that can move (length)."""
    if a.inverse_mass == 0.0:
        return float(b.extent)
    if b.inverse_mass == 0.0:
        return float(a.extent)
    return float(min(a.extent, b.extent))


@kernel
def turn_to(region: Any, nx: float, ny: float) -> None:
    """Another direction about the same point of application: arms turn with it, and no face is seen along it."""
    c = region.nx * nx + region.ny * ny
    s = region.nx * ny - region.ny * nx
    arm_a, lean_a, arm_b, lean_b = region.arm_a, region.lean_a, region.arm_b, region.lean_b
    region.arm_a = arm_a * c + lean_a * s
    region.lean_a = lean_a * c - arm_a * s
    region.arm_b = arm_b * c + lean_b * s
    region.lean_b = lean_b * c - arm_b * s
    region.nx = nx
    region.ny = ny
    region.middle = 0.0
    region.straight = 0.0
    region.radial = 0


@kernel(forceinline=True)
def closing(r: Any, a: Any, b: Any, full: float) -> float:
    """Closing speed at the region (length/time), with the part `full` of the substep's kick taken off."""
    return (
        (a.vx - b.vx - full * (a.kick_x - b.kick_x)) * r.nx
        + (a.vy - b.vy - full * (a.kick_y - b.kick_y)) * r.ny
        + (a.w - full * a.kick_w) * r.arm_a
        - (b.w - full * b.kick_w) * r.arm_b
    )


@kernel
def put_closer(r: Any, a: Any, b: Any) -> float:
    """How much nearer a program has put the two before this frame, of which one moves as it is told (length).

    What has been put farther on than half of LOOK of the smaller one is no motion.
    """
    x = y = turn = 0.0
    if not a.mobile:
        x, y, turn = a.put_x, a.put_y, a.put_a * r.arm_a
    if not b.mobile:
        x, y, turn = x - b.put_x, y - b.put_y, turn - b.put_a * r.arm_b
    nearer = x * r.nx + y * r.ny + turn
    most = 0.5 * LOOK * least_extent(a, b)
    return nearer if abs(x) + abs(y) + abs(turn) <= most and nearer > 0.0 else 0.0


@kernel
def steer(pair: Any, region: Any, a: Any, b: Any) -> None:
    """Turn the direction as a user's callback has turned the arbiter's normal; a bounce is of the speed along it."""
    if pair.steer_s == 0.0 and pair.steer_c >= 0.0:
        return
    before = closing(region, a, b, 0.5)
    nx = pair.steer_c * region.nx - pair.steer_s * region.ny
    turn_to(region, nx, pair.steer_s * region.nx + pair.steer_c * region.ny)
    if region.first_speed > 0.0:
        region.first_speed = max(0.0, region.first_speed + closing(region, a, b, 0.5) - before)


@kernel(forceinline=True)
def inverse_mass(r: Any, a: Any, b: Any) -> float:
    """1/m_eff of the two bodies along the region's direction (theory 3)."""
    return (
        a.inverse_mass
        + b.inverse_mass
        + r.arm_a * r.arm_a * a.inverse_moment
        + r.arm_b * r.arm_b * b.inverse_moment
    )


@kernel(forceinline=True)
def region_stiffness(law: Law, k: float, chord: float) -> float:
    """dF/ddelta of a region (theory 3)."""
    if law.law == LAW_AREA:
        return k * chord
    return k * chord * chord / law.length


@kernel(forceinline=True)
def growth(r: Any) -> float:
    """n of area ~ depth^n, the chord being dA/ddepth: 1 for a face, 3/2 for a round one on a plane, 2 for a corner.

    Less than 1 where the chord shrinks: past the middle of a body.
    """
    return float(min(2.0, r.depth * r.chord / r.area))


@kernel(forceinline=True)
def beyond(law: Law, phase2: float) -> float:
    """How far a step is too long for a contact of (w h)^2 = phase2: 0 where it follows it, to 1."""
    part = law.followed / phase2 if phase2 > law.followed else 1.0
    return 1.0 - part * part


@kernel(forceinline=True)
def slipping(r: Any, a: Any, b: Any, full: float) -> float:
    """Tangential speed of A relative to B at the region, `full` of the substep's kick taken off (length/time)."""
    return (
        -(a.vx - b.vx - full * (a.kick_x - b.kick_x)) * r.ny
        + (a.vy - b.vy - full * (a.kick_y - b.kick_y)) * r.nx
        + (a.w - full * a.kick_w) * r.lean_a
        - (b.w - full * b.kick_w) * r.lean_b
    )
