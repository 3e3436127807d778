"""A scene file's contents to a space: every table and value checked where it is read."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Unpack, cast

import numpy as np
import pymunk
import shapely

from ..chipmunk import AreaContact, Settings, attach
from ..geometry.outline import Outline, outline_on
from .limits import Limits, check, shown
from .rings import check_tangle, overlapping_boxes
from .scene_joints import COMMON, JOINTS, LENGTH, POINT
from .values import Values

FORMAT = 1

TYPES = {"dynamic": pymunk.Body.DYNAMIC, "kinematic": pymunk.Body.KINEMATIC, "static": pymunk.Body.STATIC}

SHAPES = ("outline", "circle", "box", "poly", "segment")

SPACE = ("gravity", "damping", "iterations", "collision_slop", "sleep_time_threshold", "idle_speed_threshold")

CONTACT = ("stiffness", "penetration", "law", "length", "direction", "exponent", "rest_speed", "integration")

SURFACE = ("density", "friction", "elasticity")


@dataclass
class Scene:
    """What a file holds: a space ready to be attached, its bodies and joints by name, and how to attach it."""

    space: pymunk.Space
    bodies: dict[str, pymunk.Body]
    """Those that have a name."""
    joints: dict[str, pymunk.Constraint]
    contact: Settings = field(default_factory=Settings)
    """Arguments of `rigidarea.attach`."""

    def attach(self, **more: Unpack[Settings]) -> AreaContact:
        """Attach area contact to `space` with the settings of the file; those in `more` (of `rigidarea.attach`) win."""
        settings: Settings = {**self.contact, **more}
        return attach(self.space, **settings)


class Reader(Values):
    """Turns plain data into a scene; every message names the place."""

    def __init__(self, limits: Limits) -> None:
        super().__init__(limits)
        self.outlines: dict[str, Outline] = {}
        self.rings = 0
        self.arcs = 0
        self.materials: dict[str, dict[str, float]] = {}
        self.densities: dict[pymunk.Shape, float] = {}
        self.made: list[tuple[pymunk.Body, list[pymunk.Shape]]] = []

    def scene(self, found: Any) -> Scene:
        known = ("rigidarea", "contact", "materials", "outlines", "bodies", "joints", *SPACE)
        top = self.table(found, "scene", known)
        if top.get("rigidarea") != FORMAT:
            raise ValueError(
                f"rigidarea: expected the format's number {FORMAT}, got {shown(top.get('rigidarea'))}"
            )
        space = pymunk.Space()
        if "gravity" in top:
            space.gravity = self.point(top["gravity"], "gravity")
        for name in SPACE[1:]:
            if name in top:
                value = self.number(top[name], name, low=0.0, infinite=name == "sleep_time_threshold")
                if name == "iterations" and not (1 <= value <= 1000 and value == int(value)):
                    raise ValueError(f"iterations: expected a whole number from 1 to 1000, got {value:g}")
                setattr(space, name, int(value) if name == "iterations" else value)
        contact = dict(self.table(top.get("contact", {}), "contact", CONTACT))
        for name, given in self.table(top.get("materials", {}), "materials").items():
            place = f"materials.{name[:40]}"
            surface = self.table(given, place, SURFACE)
            self.materials[name] = {
                key: self.number(v, f"{place}.{key}", low=0.0) for key, v in surface.items()
            }
        for name, given in self.table(top.get("outlines", {}), "outlines").items():
            self.outlines[name] = self.outline(given, f"outlines.{name[:40]}")
        bodies: dict[str, pymunk.Body] = {}
        given_bodies = self.rows(top.get("bodies", []), "bodies")
        check(len(given_bodies), self.limits.parts, "bodies")
        shapes = 0
        for i, given in enumerate(given_bodies):
            shapes += (
                len(given["shapes"])
                if isinstance(given, dict) and isinstance(given.get("shapes"), list)
                else 0
            )
            check(shapes, self.limits.parts, "shapes")
            self.body(given, f"bodies[{i}]", bodies)
        # Chipmunk notes every pair of overlapping boxes as shapes are added: a heap in one place would take it hours
        boxes = [shape.cache_bb() for _, its_shapes in self.made for shape in its_shapes]
        overlapping_boxes(
            [shapely.box(b.left, b.bottom, b.right, b.top) for b in boxes], self.limits.points, "shapes"
        )
        for body, its_shapes in self.made:
            space.add(body, *its_shapes)
        joints: dict[str, pymunk.Constraint] = {}
        given_joints = self.rows(top.get("joints", []), "joints")
        check(len(given_joints), self.limits.parts, "joints")
        for i, given in enumerate(given_joints):
            self.joint(given, f"joints[{i}]", space, bodies, joints)
        return Scene(space, bodies, joints, cast(Settings, contact))

    # --- parts ---

    def body(self, found: Any, place: str, bodies: dict[str, pymunk.Body]) -> None:
        motion = ("position", "angle", "velocity", "angular_velocity")
        given = self.table(
            found, place, ("name", "type", "mass", "moment", "center_of_gravity", "shapes", *motion)
        )
        kind = given.get("type", "dynamic")
        if not isinstance(kind, str) or kind not in TYPES:
            raise ValueError(f"{place}.type: expected one of {', '.join(TYPES)}, got {shown(kind)}")
        body = pymunk.Body(body_type=TYPES[kind])
        shapes = [
            self.shape(shape, f"{place}.shapes[{i}]", body)
            for i, shape in enumerate(self.rows(given.get("shapes", []), f"{place}.shapes"))
        ]
        if kind == "dynamic":
            if ("mass" in given) != ("moment" in given):
                raise ValueError(f"{place}: expected mass and moment together, or neither")
            if "mass" in given:
                for shape in shapes:
                    shape.density = 0.0
                body.mass = self.number(given["mass"], f"{place}.mass", low=0.0, above=True)
                moment = self.number(given["moment"], f"{place}.moment", low=0.0, above=True, infinite=True)
                body.moment = moment
                if "center_of_gravity" in given:
                    body.center_of_gravity = self.point(
                        given["center_of_gravity"], f"{place}.center_of_gravity"
                    )
            else:
                self._mass(body, shapes, place)
        elif "mass" in given or "moment" in given:
            raise ValueError(f"{place}: expected no mass on a {kind} body")
        # the angle first: Chipmunk turns a body about its centre of gravity, which moves its position
        body.angle = self.number(given.get("angle", 0.0), f"{place}.angle")
        body.position = self.point(given.get("position", [0, 0]), f"{place}.position")
        if kind != "static":
            body.velocity = self.point(given.get("velocity", [0, 0]), f"{place}.velocity")
            body.angular_velocity = self.number(
                given.get("angular_velocity", 0.0), f"{place}.angular_velocity"
            )
        self.made.append((body, shapes))
        self.named(given, place, "body", body, bodies)

    def named(self, given: dict[str, Any], place: str, what: str, made: Any, others: dict[str, Any]) -> None:
        """Note what was made under its name, if it has one."""
        name = given.get("name")
        if name is not None:
            if not isinstance(name, str) or not name or name in others:
                raise ValueError(f"{place}.name: expected a name that no other {what} has, got {shown(name)}")
            others[name] = made

    def _mass(self, body: pymunk.Body, shapes: list[pymunk.Shape], place: str) -> None:
        """Mass, moment and centre from the shapes' densities: exact outlines by their own, the others pymunk's."""
        total, first, parts = 0.0, pymunk.Vec2d(0, 0), []
        for shape in shapes:
            outline = outline_on(shape)
            density = self.densities.pop(shape, 0.0)
            if outline is not None:
                mass, center = density * outline.area, pymunk.Vec2d(*outline.centroid)
                about = outline.moment(mass, (-center.x, -center.y)) if mass else 0.0
            else:
                shape.density = density
                mass, center, about = shape.mass, shape.center_of_gravity, shape.moment
                shape.density = 0.0
            total, first = total + mass, first + mass * center
            parts.append((mass, center, about))
        if not total > 0:
            raise ValueError(f"{place}: expected mass and moment, or a shape with a density")
        center = first / total
        body.mass = total
        body.moment = sum(about + mass * (at - center).length ** 2 for mass, at, about in parts)
        body.center_of_gravity = center

    def shape(self, found: Any, place: str, body: pymunk.Body) -> pymunk.Shape:
        plain = ("friction", "elasticity", "density")
        other = ("material", "sensor", "collision_type", "filter", "surface_velocity", "radius", "offset")
        given = self.table(found, place, (*SHAPES, *plain, *other))
        kinds = [kind for kind in SHAPES if kind in given]
        if len(kinds) != 1:
            raise ValueError(
                f"{place}: expected exactly one of {', '.join(SHAPES)}, got {', '.join(kinds) or 'none'}"
            )
        kind = kinds[0]
        value = given[kind]
        at = f"{place}.{kind}"
        if "offset" in given and kind != "circle":
            raise ValueError(f"{place}.offset: only a circle has one")
        if "radius" in given and kind in ("circle", "outline"):
            raise ValueError(f"{place}.radius: expected none beside {kind}")
        radius = self.number(given.get("radius", 0.0), f"{place}.radius", low=0.0)
        shape: pymunk.Shape
        if kind == "outline":
            if isinstance(value, str):
                if value not in self.outlines:
                    raise ValueError(f"{at}: expected the name of an outline, got {shown(value)}")
                shape = self.outlines[value].add_to(body)
            else:
                shape = self.outline(value, at).add_to(body)
        elif kind == "circle":
            offset = self.point(given.get("offset", [0, 0]), f"{place}.offset")
            shape = pymunk.Circle(body, self.number(value, at, low=0.0, above=True), offset)
        elif kind == "box":
            width, height = self.point(value, at)
            if not (width > 0 and height > 0):
                raise ValueError(f"{at}: expected width and height > 0, got {shown(value)}")
            shape = pymunk.Poly.create_box(body, (width, height), radius)
        elif kind == "segment":
            ends = self.ring(value, at, least=2)
            if len(ends) != 2:
                raise ValueError(f"{at}: expected two ends, got {len(ends)}")
            shape = pymunk.Segment(body, ends[0], ends[1], radius)
        else:
            hull = self.outline({"points": value}, at)
            shape = pymunk.Poly(body, [tuple(point) for point in hull.rings[0].tolist()], None, radius)
        material = given.get("material")
        if material is not None and (not isinstance(material, str) or material not in self.materials):
            raise ValueError(f"{place}.material: expected the name of a material, got {shown(material)}")
        surface = dict(self.materials.get(material or "", {}))
        surface |= {key: self.number(given[key], f"{place}.{key}", low=0.0) for key in plain if key in given}
        self.densities[shape] = surface.get("density", 0.0)
        shape.friction = surface.get("friction", 0.0)
        shape.elasticity = surface.get("elasticity", 0.0)
        if "sensor" in given:
            shape.sensor = self.truth(given["sensor"], f"{place}.sensor")
        if "collision_type" in given:
            shape.collision_type = self.whole(given["collision_type"], f"{place}.collision_type")
        if "surface_velocity" in given:
            shape.surface_velocity = self.point(given["surface_velocity"], f"{place}.surface_velocity")
        if "filter" in given:
            names = ("group", "categories", "mask")
            parts = self.table(given["filter"], f"{place}.filter", names)
            shape.filter = pymunk.ShapeFilter(
                **{name: self.whole(part, f"{place}.filter.{name}") for name, part in parts.items()}
            )
        return shape

    def outline(self, found: Any, place: str) -> Outline:
        given = self.table(found, place, ("points", "holes"))
        rings = [self.bulged(given.get("points"), f"{place}.points")]
        holes = self.rows(given.get("holes", []), f"{place}.holes")
        self.rings += 1 + len(holes)
        check(self.rings, self.limits.rings, "rings")
        rings += [self.bulged(hole, f"{place}.holes[{i}]") for i, hole in enumerate(holes)]
        bent = any(ring[:, 2].any() for ring in rings)
        if bent:
            self.arcs += sum(map(len, rings))
            check(self.arcs, self.limits.arcs, "points of outlines with arcs")
            ends = [np.roll(ring, -1, axis=0) for ring in rings]
            p, q = np.concatenate(rings)[:, :2], np.concatenate(ends)[:, :2]
            # an arc reaches no further beyond its chord's box than that
            half = np.hypot(*(q - p).T)[:, None] / 2
            boxes = shapely.box(*(np.minimum(p, q) - half).T, *(np.maximum(p, q) + half).T)
            overlapping_boxes(boxes, 25 * self.limits.arcs, "edges", keep=False)
        else:
            check_tangle([ring[:, :2] for ring in rings], self.limits)
        try:
            if bent:
                return Outline.from_bulges(rings[0], rings[1:])
            return Outline(rings[0][:, :2], [ring[:, :2] for ring in rings[1:]])
        except ValueError as error:
            raise ValueError(f"{place}: {error}") from None

    def joint(
        self,
        found: Any,
        place: str,
        space: pymunk.Space,
        bodies: dict[str, pymunk.Body],
        joints: dict[str, pymunk.Constraint],
    ) -> None:
        if not isinstance(found, dict):
            raise ValueError(f"{place}: expected a table, got {shown(found)}")
        kind = found.get("type")
        if not isinstance(kind, str) or kind not in JOINTS:
            raise ValueError(f"{place}.type: expected one of {', '.join(JOINTS)}, got {shown(kind)}")
        make, fields = JOINTS[kind]
        extra = ("distance",) if kind == "pin" else ()
        given = self.table(found, place, ("type", "name", "a", "b", *fields, *extra, *COMMON))
        ends = []
        for end in ("a", "b"):
            name = given.get(end)  # none: the world
            if name is not None and (not isinstance(name, str) or name not in bodies):
                raise ValueError(f"{place}.{end}: expected the name of a body, got {shown(name)}")
            ends.append(space.static_body if name is None else bodies[name])
        if ends[0] is ends[1]:
            raise ValueError(f"{place}: expected two bodies, got one twice")
        values: list[Any] = []
        for name, sort in fields.items():
            if name not in given and sort != POINT:
                raise ValueError(f"{place}.{name}: expected a number, got none")
            if sort == POINT:
                values.append(self.point(given.get(name, [0, 0]), f"{place}.{name}"))
            else:
                values.append(
                    self.number(given[name], f"{place}.{name}", low=0.0 if sort == LENGTH else None)
                )
        if all(end.body_type != pymunk.Body.DYNAMIC for end in ends):
            raise ValueError(
                f"{place}: expected a joint of two bodies of which one is dynamic, got two that are not"
            )
        joint = make(*ends, *values)
        if "distance" in given:
            joint.distance = self.number(given["distance"], f"{place}.distance", low=0.0)  # type: ignore[attr-defined]
        for name in COMMON[:3]:
            if name in given:
                setattr(joint, name, self.number(given[name], f"{place}.{name}", low=0.0, infinite=True))
        if "collide_bodies" in given:
            joint.collide_bodies = self.truth(given["collide_bodies"], f"{place}.collide_bodies")
        space.add(joint)
        self.named(given, place, "joint", joint, joints)
