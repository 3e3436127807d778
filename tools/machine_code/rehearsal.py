"""What users do with the package, each thing once: by it `ahead` learns with which types Python calls kernels.

Nothing is measured, and how it ends does not matter. What is called nowhere here, `ahead.make` complains of.
"""

from __future__ import annotations

import copy
import math
from typing import Any

import numpy as np
import pymunk
import shapely

import rigidarea as ra
from rigidarea.contact.broad import ask_about, put_in_tree
from rigidarea.contact.tables import end_pair
from rigidarea.io.limits import Limits
from rigidarea.io.rings import outlines_of_polygons
from rigidarea.overlap_queries import covers


def _mixed_space() -> pymunk.Space:
    """Shapes of all kinds, and a joint, falling on a floor of two segments."""
    space = pymunk.Space()
    space.gravity = 0, -9.81
    for ends, radius in ((((-50, 0), (0, 0)), 0.0), (((0, 0), (50, 0)), 0.1)):
        floor = pymunk.Segment(space.static_body, *ends, radius)
        floor.friction = floor.elasticity = 0.5
        space.add(floor)
    plate = ra.Outline([(0, 0), (4, 0), (4, 3), (0, 3)], holes=[[(1, 1), (1, 2), (2, 2), (2, 1)]])
    hook = ra.Outline([(0, 0), (6, 0), (6, 5), (5, 5), (5, 1), (1, 1), (1, 5), (0, 5)])
    before = None
    for i in range(12):
        body = pymunk.Body(1, 1)
        body.position = 3 * (i % 4) - 5, 2 + 3 * (i // 4)
        shape: pymunk.Shape
        if i % 4 == 0:
            shape = pymunk.Circle(body, 0.5)
        elif i % 4 == 1:
            shape = pymunk.Poly.create_box(body, (1, 1), 0.1 * (i % 2))
        elif i % 4 == 2:
            shape = pymunk.Segment(body, (-0.5, 0), (0.5, 0), 0.2)
        else:
            outline = plate if i % 8 == 3 else hook
            body = outline.body(mass=2.0)
            body.position = 15, 4 * i
            shape = outline.add_to(body)
        shape.friction, shape.elasticity = 0.5, 0.3
        space.add(body, shape)
        if before is not None and i % 4 == 1:
            space.add(pymunk.PivotJoint(before, body, (0.5, 0), (-0.5, 0)))
        before = body
    return space


def _contacts() -> None:
    for settings in (
        {},
        {"law": "energy", "direction": "nodal"},
        {"integration": "explicit", "stiffness": 1e4},
    ):
        space = _mixed_space()
        contact = ra.attach(space, **settings)  # type: ignore[arg-type]
        for _ in range(30):
            space.step(1 / 60)
        contact.step(1 / 60, frames=2)
        len(contact.regions)
        contact.energy()
        twin = copy.deepcopy(space)
        twin.step(1 / 60)
        tables = ra.attached(twin)._store.tables  # type: ignore[union-attr]
        put_in_tree(tables, 0, int(tables.shapes["tree"][0]))  # these three: as in a copy made within a step
        ask_about(tables, 0)
        for p in np.flatnonzero(tables.pairs["a"] >= 0):
            end_pair(tables, int(p))
        gone = list(space.bodies)[:2]
        things: set[Any] = {thing for body in gone for thing in (body, *body.shapes, *body.constraints)}
        space.remove(*things)
        space.remove(*list(space.shapes)[3:6])
        for number in (300, 10):  # tables grow, outlines that nobody has are forgotten
            space.remove(*space.bodies, *space.shapes, *space.constraints)
            for i in range(number):
                body = pymunk.Body(1, 1)
                body.position = 2 * (i % 20), 20 + 2 * (i // 20)
                space.add(body, pymunk.Poly.create_box(body, (1 + 0.001 * i + 0.0001 * number, 1)))
            space.step(1 / 60)
        contact.detach()


def _outlines() -> None:
    gear = ra.shapes.involute_gear(module=0.002, teeth=23)
    plate = ra.Outline([(0, 0), (4, 0), (4, 3), (0, 3)], holes=[[(1, 1), (1, 2), (2, 2), (2, 1)]])
    disc = ra.shapes.circle(0.5)
    for a, b in ((gear, plate), (plate, disc), (disc, disc)):
        ra.overlap(a, (0, 0, 0), b, (0.02, 0, 0.1))
        ra.overlaps(a, [(0, 0, 0)] * 3, b, np.array([(0.02, 0, 0.1), (0.5, 0, 0), (9, 9, 0)]))
    ra.overlap(ra.shapes.box(4, 4), (0, 0, 0), ra.shapes.box(1, 1), (0.2, 0.1, 0))  # one within the other
    covers(plate, (0, 0, 0), (0.5, 0.5))

    t = np.linspace(0, 2 * math.pi, 200, endpoint=False)
    ring = shapely.Polygon(np.column_stack((np.cos(t), np.sin(t))))
    outlines_of_polygons([ring], 0.01, Limits())


def rehearse() -> None:
    """All of it."""
    _outlines()
    _contacts()
    _flexible()


def _mechanism(level: str, contact: str, rings: bool) -> None:
    """Two blocks that fall onto one another, jointed; or a pinion in a ring gear, driven."""
    from rigidarea.flexible import Material, Mechanism

    m = Mechanism(1e7, gravity=(0.0, -9.81), contact=contact, reach=0.05 if contact == "sts" else 0.0)
    stuff = Material(5e7, 0.3, 1150.0, 0.1)
    mesh = None if level == "rigid" else 0.1
    below = m.body(ra.shapes.box(1, 0.4), stuff, mesh=mesh, level=level, hub=None)
    above = m.body(ra.shapes.circle(0.2), stuff, mesh=mesh, level=level, at=(0.05, 0.39), velocity=(0, -1, 0))
    ground = m.ground(ra.shapes.box(4, 1), (0.0, -0.705))
    m.contact(below, above, friction=0.3, restitution=0.5)
    m.contact(ground, below)
    if not rings:
        m.revolute(below, (-0.5, 0.0))
        m.spring(above, (0.05, 0.45), (0.0, 1.0), stiffness=10.0, damping=1.0)
    record = m.run(0.02, 1e-3, shapes=True)
    assert m.simulation is not None  # it has run
    m.simulation.contact_seconds(record.x[:2], 1)
    if level != "rigid":
        m.state(record, -1, above)


def _flexible() -> None:
    from rigidarea.flexible import Assembly, Material

    for level in ("rigid", "compliant", "modal"):
        for contact in ("area", "sts"):
            _mechanism(level, contact, rings=contact == "area")
    space = pymunk.Space()
    assembly = Assembly(k=1e7)
    block = ra.shapes.box(0.4, 0.2)
    for x, speed, level in ((0.45, -0.5, "modal"), (0.0, 1.0, "compliant")):
        body = block.body(density=115.0)
        body.position, body.velocity = (x, 0.0), (speed, 0.1)
        shape = block.add_to(body)
        space.add(body, shape)
        assembly.part(shape, Material(5e7, 0.45, 1150.0, 0.1), level=level, mesh=0.05, hub=None)
    space.add(pymunk.PivotJoint(space.static_body, body, (0.0, 0.0)))
    ra.attach(space, flexible=assembly)
    for _ in range(3):
        space.step(1 / 60)
    from rigidarea.cases import hertz, patch_case

    patch_case.press(patch_case.GAPS[0], patch_case.MESHES[0])
    hertz.run(divisions=(4, 6))  # a rate of convergence needs two
