"""What a region that is new is: rest, an impact that steps follow, a bounce shorter than the step, or yet to come."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from ..compile.jit import kernel
from ..geometry.place import Pose, overlap_of_outlines
from .constants import FOLLOWED, MOST_ARRIVED, PUT, PUT_FOLLOWED, REST_KICKS, SMOOTH
from .exposed import exposed_patch
from .landing import find_other_end
from .motion import centre_of, earlier, since_of, soonest_touch, unseen_for
from .neighbours import TwoShapes
from .region import closing, fill, inverse_mass, is_face, others_push, put_closer, region_stiffness
from .stiffness import depth_for, stiffness_of
from .tables import FIXED, IMPACT, NEARING, PLACED, REST, STRUCK, Law

#: Going back from an overlap by so much of its depth, it is seen about as it touched; what is nothing there, nearer.
SEEN = (0.999, 0.9, 0.5)
#: A face that is shorter by more than this part as it touches comes down with one end first.
WALLS = 0.1
#: Square of the sine of the angle from which on it is askew.
ASKEW = 1e-4


@kernel
def _nearest(two: TwoShapes, region: Any, n: int, pose: Pose, other: Pose) -> int:
    """Which of the work's n loops is nearest to a region, of those that do not face away from it; -1: none."""
    least = np.inf
    best = -1
    for k in range(n):
        patch = exposed_patch(two, k, pose, other)
        far = (patch.x - region.x) ** 2 + (patch.y - region.y) ** 2
        if not patch.blind and patch.nx * region.nx + patch.ny * region.ny > 0.0 and far < least:
            least = far
            best = k
    return best


@kernel
def _seen_nearer(two: TwoShapes, region: Any, back: float, tau: float) -> tuple[int, float, Pose, Pose]:
    """A region that has touched `tau` before a time `back` ago, as it was soon after that.

    Which of the work's loops it is then (-1: none), how long ago, and where its bodies were.
    """
    for share in SEEN:
        then = back + share * tau
        pose = earlier(two.a, then)
        other = earlier(two.b, then)
        n, _ = overlap_of_outlines(two.pool, two.ia, pose, two.ib, other, two.work)
        best = _nearest(two, region, n, pose, other)
        if best >= 0:
            break
    return best, then, pose, other


@kernel
def touch(two: TwoShapes, region: Any, back: float, h: float, unseen: float) -> bool:
    """Put a new region where the two have touched first; False: it has not come there by moving.

    Found at depth d, `back` ago, with the closing speed u there and what else pushes giving it g in a time:
    it was u0 at touch, u0^2 = u^2 - 2 g d, tau = 2 d / (u + u0) earlier still. A thousandth of the depth is left, so
    that there is a region to see its direction by. Leaves in `region.back` how long ago the bodies were where its arms
    are: what is done there and then, and carried on from there, keeps all momenta. All that holds of what is to come as
    well (`back` negative).
    """
    a, b = two.a, two.b
    come = back > 0.0
    region.back = back
    for _ in range(3):
        d = region.depth
        u = closing(region, a, b, 0.5)
        gain = 2.0 * (u - closing(region, a, b, 1.0)) / h
        u -= gain * back
        root = u * u - 2.0 * gain * d
        if u <= 0.0 or root < 0.0:
            return come
        tau = 2.0 * d / (u + math.sqrt(root))
        if tau + back > min(MOST_ARRIVED * unseen, since_of(a, b)):
            return come
        come = True
        best, then, pose, other = _seen_nearer(two, region, back, tau)
        if best < 0:
            return come
        patch = exposed_patch(two, best, pose, other)
        ax, ay = centre_of(a, pose)
        bx, by = centre_of(b, other)
        fill(region, patch, ax, ay, bx, by)
        region.back = then
        back = then
        if patch.depth < 0.01 * d:
            return come
    return come


@kernel(forceinline=True)
def _slow(law: Law, gain: float, rate2: float, h: float) -> float:
    """First touch slower than this is rest (length/time): what pushes gives that much in a few steps."""
    if law.rest_speed >= 0.0:
        return law.rest_speed
    return REST_KICKS * abs(gain) * max(h, 1.0 / math.sqrt(rate2))


@kernel(forceinline=True)
def _pushed(law: Law, gain: float, h: float) -> float:
    """What pushes two that have met before together (length/time^2): in a pile both fall alike, gravity counts."""
    return max(law.gravity, abs(gain) / h)


@kernel(forceinline=True)
def size_of(body: Any) -> float:
    """The smallest extent of a body that moves (length)."""
    return body.extent if body.mobile else np.inf


@kernel
def flies_off(law: Law, pair: Any, r: Any, a: Any, b: Any, h: float) -> bool:
    """Whether two who bounce part, overlapping still: sent back they bounce anew, a substep later.

    They have bounced, or come to overlap while they part already, and bear nothing.
    """
    if r.mode != REST or pair.elasticity == 0.0 or law.followed == math.inf or r.l1 + r.l2 > 0.0:
        return False
    if r.first_speed == 0.0:
        return False
    u = closing(r, a, b, 0.0)
    rate2 = region_stiffness(law, r.stiffness, r.chord) * inverse_mass(r, a, b)
    return bool(-u > _slow(law, _pushed(law, u - closing(r, a, b, 1.0), h), rate2, h))


@kernel
def bounces_again(law: Law, pair: Any, r: Any, a: Any, b: Any, h: float) -> bool:
    """Whether what a bounce has left overlapping closes so fast that it bounces anew, here and now.

    What has bounced is at rest when it closes too slowly for that (`first_speed` is 0 from then on). What turns with
    its support is pushed by that too: points r from the two centres come nearer by w_b^2 r_b - w_a^2 r_a, along n.
    """
    if r.first_speed == 0.0 or pair.elasticity == 0.0 or law.followed == math.inf:
        return False
    u = closing(r, a, b, 0.5)
    rate2 = region_stiffness(law, r.stiffness, r.chord) * inverse_mass(r, a, b)
    if u <= 0.0 or rate2 * h * h <= law.followed:
        return False
    gain = _pushed(law, 2.0 * (u - closing(r, a, b, 1.0)), h)
    gain = max(gain, b.w * b.w * r.lean_b - a.w * a.w * r.lean_a)
    r.first_speed = u if pair.elasticity * u > _slow(law, gain, rate2, h) else 0.0
    r.back = 0.0
    return bool(r.first_speed > 0.0)


@kernel
def end_comes_down(law: Law, pair: Any, r: Any, a: Any, b: Any, h: float) -> bool:
    """Whether one end of a face at rest has come down in the last substep, fast enough to bounce.

    What stands on a corner topples: its region is not new, but at the thicker end all of the thickness is of that
    substep's motion. Each end leaves at e times its own speed (`aim_bounce`), so that the one it stands on stays.
    Not of what turns so far in a substep that it may have come from anywhere.
    """
    if pair.elasticity == 0.0 or law.followed == math.inf or not is_face(r):
        return False
    u = closing(r, a, b, 0.5)
    half = math.copysign(0.5 * r.straight, r.middle)
    turn = a.w - b.w
    down = u - turn * (r.middle - half)
    lean = min(1.0, 6.0 * abs(r.middle) / r.straight)
    if turn * turn * h * h > SMOOTH or r.area / r.chord * (1.0 + lean) > MOST_ARRIVED * h * down:
        return False
    rate2 = region_stiffness(law, r.stiffness, r.chord) * inverse_mass(r, a, b)
    slow = _slow(law, _pushed(law, 2.0 * (u - closing(r, a, b, 1.0)), h), rate2, h)
    if rate2 * h * h <= law.followed or pair.elasticity * down <= slow:
        return False
    r.first_speed = down
    r.back = 0.0
    return True


@kernel(forceinline=True)
def arrives(r: Any, a: Any, b: Any, h: float) -> bool:
    """Whether what has been let come just to touch is there, and closes as fast as before: now it is to be stopped."""
    return bool(closing(r, a, b, 1.0) * h > 2.0 * max(r.depth, r.rest_depth))


@kernel
def jumped_in(law: Law, r: Any, before: float, a: Any, b: Any, h: float) -> bool:
    """Whether an overlap has become deeper than its bodies' motion can have made it, by far: any point of its chord's.

    By how far: where the step does not follow the contact, by what a solve may have left, which takes its load.
    """
    speed = abs(closing(r, a, b, 0.0)) + abs(closing(r, a, b, 1.0)) + abs(a.w - b.w) * r.chord
    inside = r.depth - before - MOST_ARRIVED * h * speed
    if drives(law, a) or drives(law, b):
        inside -= put_closer(r, a, b)
    least = min(size_of(a), size_of(b))
    if inside <= PUT_FOLLOWED * least:
        return False
    phase2 = region_stiffness(law, r.stiffness, r.chord) * inverse_mass(r, a, b) * h * h
    return bool(phase2 <= max(law.followed, FOLLOWED) or inside > PUT * least)


@kernel(forceinline=True)
def drives(law: Law, body: Any) -> bool:
    """Whether a body moves as it is told, whatever is in its way: a kinematic one, a static one that is placed anew."""
    return bool(
        (body.kind != FIXED and not body.mobile) or (body.kind == FIXED and body.replaced == law.frame)
    )


@kernel(forceinline=True)
def crushed(law: Law, r: Any, a: Any, b: Any) -> bool:
    """Whether a kinematic body has pressed another so deep that no bed is stiff enough: it has put it there."""
    return bool(
        (drives(law, a) or drives(law, b))
        and law.stiffness == 0.0
        and r.depth - put_closer(r, a, b) > PUT * min(size_of(a), size_of(b))
    )


@kernel
def enter(two: TwoShapes, region: Any, back: float, h: float) -> None:
    """What a new region is: an impact that the steps follow, one shorter than the step, or rest."""
    law, pair, a, b = two.law, two.pair, two.a, two.b
    inverse = inverse_mass(region, a, b)
    region.stiffness = stiffness_of(law, pair, region)
    stiffness = max(pair.rate, region_stiffness(law, region.stiffness, region.chord))
    phase2 = stiffness * inverse * h * h
    push = 2.0 * (closing(region, a, b, 0.5) - closing(region, a, b, 1.0)) / (h * inverse)
    region.rest_depth = depth_for(law, pair, region, push)
    unseen = unseen_for(pair, h)
    placed = law.followed != math.inf and back == 0.0 and jumped_in(law, region, 0.0, a, b, unseen)
    if phase2 <= law.followed and back == 0.0:
        region.mode = REST if placed else IMPACT
    else:
        touched = touch(two, region, back, h, unseen)
        region.mode = STRUCK if touched else REST
    region.placed = PLACED if placed and region.mode == REST else 0
    u = closing(region, a, b, 0.5)
    gain = 2.0 * (u - closing(region, a, b, 1.0)) / h
    u -= gain * region.back
    slow = _slow(law, gain, stiffness * inverse, h)
    if region.mode == REST and not placed and phase2 > law.followed and pair.elasticity * u > slow:
        region.mode = STRUCK  # a bounce off somebody else has put it there: it bounces here and now
    region.first_speed = max(u, 0.0)
    if u <= slow:
        # what parts so fast has met others meanwhile: sent back it bounces
        parts = pair.elasticity > 0.0 and phase2 > law.followed and region.placed == 0
        parts = parts and -u > _slow(law, _pushed(law, gain * h, h), stiffness * inverse, h)
        region.first_speed = -u if parts else 0.0
        if region.mode == IMPACT:
            region.mode = REST
    elif region.mode == STRUCK and pair.elasticity == 0.0:
        region.first_speed = 0.0
    elif region.mode == STRUCK:
        find_other_end(two, region, h)


@kernel(forceinline=True)
def _lands_on_a_face(region: Any) -> bool:
    """Whether what is to come is as thick, or nearly, from one end of a straight chord to the other."""
    if not is_face(region):
        return False
    lean = min(1.0, 6.0 * abs(region.middle) / region.straight)
    slope = 2.0 * lean * region.area / (region.chord * region.straight)
    return bool(slope * slope <= SMOOTH)


@kernel
def _as_it_touches(two: TwoShapes, region: Any, ahead: float) -> float:
    """See a face that will be there in `ahead` as it touches, where it shows another way then; in what time that is.

    Deep in each other the chord runs askew, from the wall below an edge to the wall of what has come down beside it.
    What comes down with one end first is shorter by then, and stays as it is.
    """
    a, b = two.a, two.b
    for _ in range(2):
        u = closing(region, a, b, 0.0)
        if u <= 0.0:
            break
        best, then, pose, other = _seen_nearer(two, region, -ahead, region.depth / u)
        if best < 0:
            break
        patch = exposed_patch(two, best, pose, other)
        askew = patch.nx * region.ny - patch.ny * region.nx
        if not is_face(patch) or patch.chord < (1.0 - WALLS) * region.chord or askew * askew <= ASKEW:
            break
        ax, ay = centre_of(a, pose)
        bx, by = centre_of(b, other)
        fill(region, patch, ax, ay, bx, by)
        ahead = -then
    return ahead


@kernel
def expect(two: TwoShapes, region: Any, ahead: float, h: float, first: bool) -> bool:
    """What a region that will be there in `ahead` is: NEARING, or a bounce within this drift; False: neither.

    A bounce only at the first look (`meet_ahead`).
    """
    law, pair, a, b = two.law, two.pair, two.a, two.b
    inverse = inverse_mass(region, a, b)
    region.stiffness = stiffness_of(law, pair, region)
    stiffness = max(pair.rate, region_stiffness(law, region.stiffness, region.chord))
    if stiffness * inverse * h * h <= law.followed:
        return False  # the steps follow it
    u = closing(region, a, b, 0.0)
    gain = max(0.0, u - closing(region, a, b, 1.0)) / h
    plastic = pair.elasticity == 0.0
    push = _pushed(law, gain * h, h) if plastic else gain
    together = plastic and (others_push(a, b) or _lands_on_a_face(region))
    if u > _slow(law, push, stiffness * inverse, h) and not together:
        region.mode = STRUCK
        region.rest_depth = 0.0
        region.first_speed = u
        # positions are those of the middle of the substep: the drift yet to come is the half of it
        if not (first and touch(two, region, -ahead, h, h) and region.back >= -0.5 * h):
            return False
        if not plastic:
            find_other_end(two, region, h)
        return True
    region.mode = NEARING
    if is_face(region):
        ahead = _as_it_touches(two, region, ahead)
    else:  # a part's chord may say that it is deeper than the way after first touch
        way = u * (ahead - soonest_touch(two.pool, two.tables, pair, a, b))
        region.depth = max(0.0, min(region.depth, way))
    region.first_speed = 0.0
    # in a stack both fall alike, and it will carry something all the same
    rest = max(law.gravity / (inverse * pair.rate), depth_for(law, pair, region, gain / inverse))
    region.rest_depth = min(region.depth, rest)
    region.back = ahead
    return True
