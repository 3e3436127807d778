"""A space as a scene file: what `scene` reads, written from what is there now."""

from __future__ import annotations

import json
import math
import os
from typing import Any

import numpy as np
import pymunk

from ..chipmunk import attached
from ..geometry.arcs import sweeps
from ..geometry.outline import Outline, outline_on
from .limits import file_of
from .scene_joints import COMMON, JOINTS, POINT, TYPES
from .scene_reader import CONTACT, FORMAT, SPACE
from .scene_reader import TYPES as BODY_TYPES
from .values import FLATTEST

_NAMES = {value: name for name, value in BODY_TYPES.items()}


def save_scene(space: pymunk.Space, file: str | os.PathLike[str]) -> None:
    """Write the space to a file, .toml as TOML (needs tomli-w), everything else as JSON; see `scene_as_text`."""
    path = file_of(file)
    content = scene_as_text(space, "toml" if path.suffix.lower() == ".toml" else "json")
    part = path.with_name(path.name + ".part")
    part.write_text(content, encoding="utf-8")
    part.replace(path)  # an interrupt leaves the old file, never half a new one


def scene_as_text(space: pymunk.Space, kind: str = "json") -> str:
    """The space as text, "json" or "toml": bodies where they are now, shapes, joints, and how it is attached.

    Outlines that several shapes share are written once. What is code is not written: callbacks, velocity functions;
    neither is what contacts remember (a copy or a pickle keeps that). Raises ValueError for a kind of shape or joint
    that a scene file does not have.
    """
    if not isinstance(space, pymunk.Space):
        raise ValueError(f"space must be a pymunk.Space, got {type(space).__name__}")
    if not isinstance(kind, str) or kind not in ("json", "toml"):
        raise ValueError(f"kind must be 'json' or 'toml', got {kind!r:.80}")
    told = _scene(space)
    if kind == "toml":
        import tomli_w

        return tomli_w.dumps(told)
    return json.dumps(told, indent=1, ensure_ascii=False, allow_nan=False) + "\n"


def _scene(space: pymunk.Space) -> dict[str, Any]:
    told: dict[str, Any] = {"rigidarea": FORMAT, "gravity": list(space.gravity)}
    for name in SPACE[1:]:
        told[name] = _number(getattr(space, name))
    contact = attached(space)
    if contact is not None:
        settings = contact.__getstate__()["_settings"]
        told["contact"] = {name: settings[name] for name in CONTACT if settings.get(name) is not None}
    outlines: dict[Outline, str] = {}
    names: dict[pymunk.Body, str] = {}
    bodies = []
    still = [space.static_body] if space.static_body.shapes else []
    for body in (*still, *space.bodies):
        names[body] = "world" if body is space.static_body else f"body{len(names)}"
        bodies.append(_body(body, names[body], outlines))
    joints = [_joint(joint, names, space) for joint in space.constraints]
    if outlines:
        told["outlines"] = {name: _outline(outline) for outline, name in outlines.items()}
    told["bodies"] = bodies
    if joints:
        told["joints"] = joints
    return told


def _number(value: float) -> Any:
    """JSON knows no infinity: a word instead."""
    return "inf" if value == math.inf else value


def _body(body: pymunk.Body, name: str, outlines: dict[Outline, str]) -> dict[str, Any]:
    told: dict[str, Any] = {
        "name": name,
        "type": _NAMES[body.body_type],
        "position": list(body.position),
        "angle": body.angle,
    }
    if body.body_type != pymunk.Body.STATIC:
        told["velocity"] = list(body.velocity)
        told["angular_velocity"] = body.angular_velocity
    if body.body_type == pymunk.Body.DYNAMIC:
        told["mass"], told["moment"] = body.mass, _number(body.moment)
        told["center_of_gravity"] = list(body.center_of_gravity)
    shapes = sorted(body.shapes, key=lambda shape: shape._hashid)
    told["shapes"] = [_shape(shape, outlines) for shape in shapes]
    return told


def _shape(shape: pymunk.Shape, outlines: dict[Outline, str]) -> dict[str, Any]:
    told: dict[str, Any] = {}
    outline = outline_on(shape)
    if outline is not None:
        told["outline"] = outlines.setdefault(outline, f"outline{len(outlines)}")
    elif isinstance(shape, pymunk.Circle):
        told["circle"], told["offset"] = shape.radius, list(shape.offset)
    elif isinstance(shape, pymunk.Segment):
        told["segment"], told["radius"] = [list(shape.a), list(shape.b)], shape.radius
    elif isinstance(shape, pymunk.Poly):
        corners = [list(point) for point in shape.get_vertices()]
        first = corners.index(min(corners))  # Chipmunk starts a hull where it likes
        told["poly"], told["radius"] = corners[first:] + corners[:first], shape.radius
    else:
        raise ValueError(f"expected pymunk's shapes, got {type(shape).__name__}")
    told["friction"], told["elasticity"] = shape.friction, shape.elasticity
    if shape.sensor:
        told["sensor"] = True
    if shape.collision_type:
        told["collision_type"] = shape.collision_type
    if tuple(shape.surface_velocity) != (0, 0):
        told["surface_velocity"] = list(shape.surface_velocity)
    if shape.filter != pymunk.ShapeFilter():
        told["filter"] = dict(shape.filter._asdict())
    return told


def _outline(outline: Outline) -> dict[str, Any]:
    """Points as [x, y]; where an arc begins, [x, y, bulge]."""
    outer, *holes = (ring.tolist() for ring in outline.rings)
    for ring, points, arcs in zip((outer, *holes), outline.rings, outline.arcs):
        bulges = np.tan(sweeps(points, arcs) / 4)
        for point, bulge in zip(ring, bulges.tolist()):
            if abs(bulge) >= FLATTEST:
                point.append(bulge)
    return {"points": outer, **({"holes": holes} if holes else {})}


def _joint(joint: pymunk.Constraint, names: dict[pymunk.Body, str], space: pymunk.Space) -> dict[str, Any]:
    kind = TYPES.get(type(joint))
    if kind is None:
        raise ValueError(f"expected pymunk's joints, got {type(joint).__name__}")
    told: dict[str, Any] = {"type": kind}
    for end, body in (("a", joint.a), ("b", joint.b)):
        if body in names:
            told[end] = names[body]
        elif body is not space.static_body:
            raise ValueError(f"expected a joint between bodies of the space, got {joint!r} with another one")
    for name, sort in JOINTS[kind][1].items():
        value = getattr(joint, name)
        told[name] = list(value) if sort == POINT else value
    if isinstance(joint, pymunk.PinJoint):
        told["distance"] = joint.distance
    for name in COMMON[:3]:
        told[name] = _number(getattr(joint, name))
    told["collide_bodies"] = bool(joint.collide_bodies)
    return told
