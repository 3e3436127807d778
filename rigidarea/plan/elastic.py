"""Which bodies with a material bend enough to matter, and whether statics will do: rigid, compliant or modal; and those
that do put together as parts of an assembly."""

from __future__ import annotations

import math
from collections.abc import Mapping
from functools import lru_cache
from typing import TYPE_CHECKING, Any, NamedTuple

import pymunk
import shapely

from ..geometry.outline import Outline
from . import estimates as est

if TYPE_CHECKING:
    from ..flexible import Assembly


class Choice(NamedTuple):
    """The level of one body, and the numbers that decided."""

    body: pymunk.Body
    level: str  # "rigid", "compliant", "modal"
    modes: int  # of the modal level
    error: float  # that the level leaves, relative
    reason: str
    overridden: bool
    mesh: float  # spacing of the boundary nodes of a level that bends (length)
    load: float  # what presses or strikes it, as far as that is known (force)
    bed: float  # contact stiffness at which it sinks by the tolerance under its load (force/length²)


class Shape(NamedTuple):
    """What of an outline bears on how it bends."""

    teeth: int  # pockets between the outline and its hull
    length: float  # what bends: a tooth's pitch, or the longer extent (length)
    height: float
    reach: float  # radius of the hull (length)
    bore: float  # radius of a hole, 0 without (length)
    area: float


@lru_cache(maxsize=256)
def shape_of(outline: Outline) -> Shape:
    """What of an outline bears on how it bends: its teeth, slenderness, bore."""
    polygon, hull = outline.polygon, shapely.convex_hull(outline.polygon)
    pockets = shapely.get_parts(shapely.difference(hull, shapely.Polygon(polygon.exterior)))
    teeth = sum(pocket.area > 1e-6 * hull.area for pocket in pockets)
    reach = math.sqrt(hull.area / math.pi)
    bore = max((math.sqrt(shapely.Polygon(hole).area / math.pi) for hole in polygon.interiors), default=0.0)
    if teeth > 2:  # a tooth stands out of the rim by about its own thickness, half a pitch
        length = height = 2.0 * math.pi * reach / teeth
    else:
        teeth, (one, other, third, *_) = 0, shapely.get_coordinates(shapely.oriented_envelope(polygon))
        height, length = sorted((math.dist(one, other), math.dist(other, third)))
    return Shape(teeth, length, height, reach, bore, float(outline.area))


#: Elements across what bends, a tooth or a bar: the tooth is then 4 % too stiff (docs/flexible.md).
ACROSS = 5.0


def load_on(space: pymunk.Space, body: pymunk.Body, lever: float) -> float:
    """What presses a body (force): its brake's or motor's torque over its lever, else its weight."""
    torques = [joint.max_force for joint in body.constraints if isinstance(joint, pymunk.SimpleMotor)]
    torque = max((torque for torque in torques if math.isfinite(torque)), default=0.0)
    if torque > 0.0:
        return float(torque) / lever
    return float(body.mass * space.gravity.length) if body.body_type == pymunk.Body.DYNAMIC else 0.0


def blow_on(space: pymunk.Space, body: pymunk.Body) -> tuple[float, float]:
    """(the speed, the mass) of the heaviest blow that a body is about to take: 0, infinite where there is none.

    Of each other body with shapes: how fast the two come on along the axis that parts their boxes, and by how much more
    once one has fallen through the gap; their reduced mass. The blow is the largest v √m.
    """
    heaviest, worst = 0.0, (0.0, math.inf)
    mine = _box(body)
    for other in (*space.bodies, space.static_body):
        theirs = _box(other)
        free = [b.body_type == pymunk.Body.DYNAMIC for b in (body, other)]
        jointed = any(other in (joint.a, joint.b) for joint in body.constraints)
        if other is body or mine is None or theirs is None or jointed or not any(free):
            continue
        # apart in x and y, negative where the boxes overlap: they part along the larger
        gap = [max(mine[i] - theirs[i + 2], theirs[i] - mine[i + 2]) for i in range(2)]
        along = 0 if gap[0] > gap[1] else 1
        if gap[1 - along] > 0.0:
            continue  # they pass each other, as they stand now
        side = 1.0 if mine[along] + mine[along + 2] < theirs[along] + theirs[along + 2] else -1.0
        v = side * (body.velocity[along] - other.velocity[along])
        pull = side * space.gravity[along] * (free[0] - free[1])
        square = v * abs(v) + 2.0 * pull * max(0.0, gap[along])
        mass = 1.0 / sum(1.0 / b.mass for b, moves in zip((body, other), free) if moves)
        if square * mass > heaviest:
            heaviest, worst = square * mass, (math.sqrt(square), mass)
    return worst


def _box(body: pymunk.Body) -> tuple[float, float, float, float] | None:
    """Left, bottom, right, top of a body's shapes; None without any."""
    boxes = [shape.cache_bb() for shape in body.shapes if not shape.sensor]
    if not boxes:
        return None
    low = min(box.left for box in boxes), min(box.bottom for box in boxes)
    return (*low, max(box.right for box in boxes), max(box.top for box in boxes))


def first_frequency(shape: Shape, material: Any) -> float:
    """First elastic frequency (rad/time): of a ring where there is a bore, of a lump or bar else.

    material: a `rigidarea.flexible.Material` (force/area, mass/volume).
    """
    young, density, across = material.young, material.density, 2.0 * shape.reach
    if not shape.teeth:
        return est.bar_frequency(young, density, shape.length, shape.height)
    lump = est.bar_frequency(young, density, across, across)
    if shape.bore == 0.0:
        return lump
    middle, rim = 0.5 * (shape.reach + shape.bore), shape.reach - shape.bore
    return min(lump, est.ring_frequency(young, density, middle, rim))


def materials_of(space: pymunk.Space) -> dict[pymunk.Body, Any]:
    """What bodies carry: `body.material`, or that of one of its shapes, where that is a `flexible.Material`."""
    given = [
        (body, thing.material)
        for body in space.bodies
        for thing in (*body.shapes, body)
        if hasattr(thing, "material")
    ]
    if not given:
        return {}
    from ..flexible import Material

    return {body: material for body, material in given if isinstance(material, Material)}


def choose(
    space: pymunk.Space,
    materials: Mapping[pymunk.Body, Any],
    tolerance: float,
    stiffness: float | None,
    overrides: Mapping[Any, Mapping[str, Any]],
) -> list[Choice]:
    """One choice for each body with a material.

    materials: by body. stiffness: k of the contacts (force/length²), None if each pair has its own. overrides: what
    somebody has said otherwise, by body. tolerance: relative.

    What loads it is its weight or its motor, or a blow that it is about to take: v √(K m), for as long as √(m/K) says,
    K its own stiffness and the contact's in series. Rigid where the body bends by less than the tolerance allows, as a
    fraction of a tooth's pitch or of its extent; compliant where what statics leaves out is less than that; else modal,
    with the modes up to three times the excitation. What excites is the blow, the mesh of the teeth at the present
    spin, or where there are none the contact's own frequency.
    """
    out = []
    outlines = {body: [Outline.from_pymunk(shape) for shape in body.shapes] for body in materials}
    shapes = {body: shape_of(max(own, key=lambda each: each.area)) for body, own in outlines.items() if own}
    loads = {body: load_on(space, body, shape.reach) for body, shape in shapes.items()}
    heaviest = max(loads.values(), default=0.0)
    for body, shape in shapes.items():
        material = materials[body]
        load = loads[body] or heaviest  # a driver bears what the driven one is braked with
        give = est.deflection(1.0, material.young, material.thickness, shape.length, shape.height)
        excitation = shape.teeth * abs(body.angular_velocity)
        if not shape.teeth and stiffness is not None and body.body_type == pymunk.Body.DYNAMIC:
            excitation = est.contact_frequency(stiffness, shape.height, body.mass)
        speed, mass = blow_on(space, body)
        struck = est.blow(speed, mass, give, stiffness, shape.height) if speed > 0.0 else None
        if struck is not None and struck.force > load:
            load, excitation = struck.force, struck.frequency
        else:
            struck = None
        first = first_frequency(shape, material)
        static = load * give / shape.length
        left = static * est.dynamic_error(excitation, first)
        if struck is not None:  # of the blow's speed, what stays in it as vibration
            left = max(left, struck.share * min(1.0, est.dynamic_error(excitation, first)))
        sinks = est.penetration(load, stiffness, 0.5 * shape.length) / shape.length if stiffness else 0.0
        told = f"bends {static:.1e} of {'its pitch' if shape.teeth else 'its length'}"
        excited = max(excitation, first) if left > tolerance else first
        modes = est.modes_below(3.0 * excited, shape.area, material.young, material.density)
        if left > tolerance:
            level, error = "modal", 0.0
            reason = f"{excitation:.3g} rad/s against {first:.3g}: resonance, {modes} modes"
        elif static > tolerance:
            level, error = "compliant", left
            reason = f"{told} > {tolerance:g}; {excitation:.3g} rad/s against {first:.3g}: statics will do"
        else:
            level, error, reason = "rigid", max(static, left), f"{told} <= {tolerance:g}"
        if struck is not None:
            reason = f"a blow at {speed:.3g}: {reason}"
        if sinks > max(tolerance, static):
            reason += f"; sinks {sinks:.1e} at this k"
            error = max(error, sinks)
        yours = overrides.get(body, {}).get("level")
        mesh = (0.5 * shape.length if shape.teeth else shape.height) / ACROSS
        # as deep as the tolerance allows on half of what bears; where nothing presses, as stiff as the body itself
        bed = 2.0 * load / (tolerance * shape.length**2) or material.young * material.thickness / shape.length
        level = yours or level
        modes = modes if level == "modal" else 0
        out.append(Choice(body, level, modes, error, reason, yours is not None, mesh, load, bed))
    return out


def assemble(
    choices: list[Choice], materials: Mapping[pymunk.Body, Any], stiffness: float | None
) -> Assembly | None:
    """The bodies that have a material as parts of one assembly, each at its level; None where none bends.

    stiffness: of contacts between them (force/length²); None: the stiffest bed that one of them asks for. Joints hold
    the hole that they lie in, if they lie in one. Of a body with several shapes the largest is its part, the others
    bear as rigid ones; static bodies stay what they are.
    """
    if all(choice.level == "rigid" for choice in choices):
        return None
    from ..flexible import Assembly

    moving = [choice for choice in choices if choice.body.body_type != pymunk.Body.STATIC]
    made = Assembly(stiffness or max(choice.bed for choice in moving))
    for choice in moving:
        shape = max(choice.body.shapes, key=lambda shape: Outline.from_pymunk(shape).area)
        others = [other.body for other in moving if other is not choice]
        hub, contact = _rings(choice.body, Outline.from_pymunk(shape), others)
        bends: dict[str, Any] = {} if choice.level == "rigid" else {"mesh": choice.mesh, "hub": hub}
        if choice.level == "modal":
            bends["modes"] = choice.modes
        made.part(shape, materials[choice.body], level=choice.level, contact=contact, **bends)
    return made


def _rings(
    body: pymunk.Body, outline: Outline, others: list[pymunk.Body]
) -> tuple[int | None, tuple[int, ...]]:
    """(the hole that the body's joints lie in, None without; the rings that may touch others: the outer one, and holes
    in which one of them is)."""
    anchors = [
        getattr(joint, "anchor_a" if joint.a is body else "anchor_b", None) for joint in body.constraints
    ]
    places = [tuple(anchor) for anchor in anchors if anchor is not None]
    inside = [tuple(body.world_to_local(other.position)) for other in others]
    hub, contact = None, [0]
    for i, ring in enumerate(outline.polygon_rings[1:], start=1):
        hole = shapely.Polygon(ring)
        if hub is None and any(hole.contains(shapely.Point(place)) for place in places):
            hub = i
        elif any(hole.contains(shapely.Point(place)) for place in inside):
            contact.append(i)
    return hub, tuple(contact)
