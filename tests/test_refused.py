"""What would do nothing, or something else than it says, is refused: names that are not there, places, kinds."""

import copy
import pickle

import numpy as np
import pymunk
import pytest

import rigidarea as ra
from rigidarea import bring

SQUARE = [(0, 0), (1, 0), (1, 1), (0, 1)]


def attached_space():
    space = pymunk.Space()
    space.gravity = 0, -10
    body = pymunk.Body(1, 1)
    body.position = 0, 0.5
    space.add(body, pymunk.Circle(body, 0.5), pymunk.Segment(space.static_body, (-5, 0), (5, 0), 0))
    return space, ra.attach(space)


@pytest.mark.parametrize("name", ["rings", "arcs", "area", "mirror", "convex", "anything"])
def test_an_outline_is_immutable(name):
    outline = ra.Outline(SQUARE)
    with pytest.raises(AttributeError, match=f"immutable.*{name}"):
        setattr(outline, name, 1)
    with pytest.raises(AttributeError, match="immutable"):
        del outline.rings
    assert outline.area == 1 and outline.convex and outline.polygon.area == 1  # worked out when asked for


def test_what_shares_outlines_still_does():
    floor = ra.Outline.from_pymunk(pymunk.Segment(pymunk.Body(), (0, 0), (1, 0), 0))
    for again in (pickle.loads(pickle.dumps(floor)), copy.deepcopy(floor), floor.translated(1, 0)):
        assert again.mirror is not None and again.mirror.mirror is again


@pytest.mark.parametrize("points", [np.array(SQUARE) * (1 + 0j), [(0, 0), (1, 0), (1, 1j)]])
def test_complex_points_are_none(points):
    with pytest.raises(ValueError, match="points must be numbers"):
        ra.Outline(points)
    with pytest.raises(ValueError, match="ring must be numbers"):
        ra.Outline.from_bulges(np.column_stack((np.array(points), np.zeros(len(points)))))


def test_whole_numbers_beyond_a_double_are_refused():
    huge = 10**400
    for call in (
        lambda: ra.Outline([(0, 0), (huge, 0), (1, 1)]),
        lambda: ra.Outline(SQUARE, [[(0, 0), (huge, 0), (1, 1)]]),
        lambda: ra.Outline.from_bulges([(0, 0, 0), (1, 0, huge), (1, 1, 0)]),
        lambda: ra.overlap(ra.Outline(SQUARE), (huge, 0, 0), ra.Outline(SQUARE), (0, 0, 0)),
        lambda: ra.overlaps(ra.Outline(SQUARE), [(huge, 0, 0)], ra.Outline(SQUARE), (0, 0, 0)),
        lambda: bring.outlines_from_mask([[huge]]),
    ):
        with pytest.raises(ValueError, match="must be"):
            call()


@pytest.mark.parametrize("name", ["steps", "iterations", "tolerance"])
def test_a_contact_has_no_other_attributes(name):
    space, contact = attached_space()
    with pytest.raises(AttributeError, match=name):
        setattr(contact, name, 8)
    for again in (space.copy(), pickle.loads(pickle.dumps(space))):
        ra.attached(again).step(1 / 60)
        assert next(iter(again.bodies)).position.y == pytest.approx(0.5, abs=1e-3)


def test_a_contact_is_made_by_attach():
    with pytest.raises(ValueError, match=r"rigidarea\.attach"):
        ra.AreaContact(pymunk.Space(), {})


def test_what_has_no_area_is_named_and_a_contact_still_shows():
    space, contact = attached_space()
    (body,) = space.bodies
    flat, fixed = pymunk.Circle(body, 0), pymunk.Circle(space.static_body, 0)
    space.add(flat, fixed)
    told = r"shapes\[2\], a Circle of bodies\[0\]: radius of a pymunk shape must be positive and finite, got 0\.0"
    for step in (lambda: space.step(1 / 60), lambda: contact.step(1 / 60), lambda: contact.regions):
        with pytest.raises(ValueError, match=told):
            step()
        assert repr(contact) == "<AreaContact of 1 bodies, 4 shapes, penetration 0.0002>"
    space.remove(flat)
    with pytest.raises(ValueError, match=r"shapes\[2\], a Circle of static_body: radius"):
        space.step(1 / 60)
    space.remove(fixed)
    space.step(1 / 60)
    assert "1 regions" in repr(contact)


@pytest.mark.parametrize("value", [5, 1, True, 0, "1e-3"])
def test_a_penetration_is_a_fraction(value):
    with pytest.raises(ValueError, match=f"penetration.*{value}"):
        ra.attach(pymunk.Space(), penetration=value)
    _, contact = attached_space()
    before = contact.penetration
    with pytest.raises(ValueError, match=f"penetration.*{value}"):
        contact.penetration = value
    assert contact.penetration == before


def test_the_substeps_of_a_step_have_the_bound_of_those_of_an_island():
    space, contact = attached_space()
    for ask in (
        lambda n: contact.step(1 / 60, steps=n),
        lambda n: contact.ask(next(iter(space.bodies)), n),
    ):
        with pytest.raises(ValueError, match="steps must be a whole number from 1 to 1024, got 1025"):
            ask(1025)
        ask(1024)


@pytest.mark.parametrize("attached_already", [False, True])
def test_attach_within_a_step(attached_already):
    space, contact = attached_space()
    if not attached_already:
        contact.detach()
    told = []

    def begin(arbiter, space, data):
        with pytest.raises(RuntimeError, match="within a step"):
            ra.attach(space)
        told.append(True)

    space.on_collision(begin=begin)
    for _ in range(5):
        space.step(1 / 60)
    assert told


def test_a_plan_overrides_its_own_bodies_only():
    space, contact = attached_space()
    contact.detach()
    made = ra.plan(space, "10%", 0.5)
    with pytest.raises(ValueError, match="of the plan's space"):
        made.override(pymunk.Body(), steps=50)
    with pytest.raises(ValueError, match="from 1 to 1024, got 5000"):
        made.override(next(iter(space.bodies)), steps=5000)
    with pytest.raises(ValueError, match="penetration must be a fraction"):
        made.override(penetration=5)
    assert made.overrides == {}


def test_a_plan_samples_what_has_an_outline():
    space, contact = attached_space()
    contact.detach()
    made = ra.plan(space, "10%", 0.5)
    for shape in list(space.shapes):
        with pytest.raises(
            ValueError, match=f"expected a shape with an outline .*got <.*{type(shape).__name__}"
        ):
            made.override(shape, sampling=0.1)
    assert made.overrides == {}
    made.override(level="rigid").apply()


def test_queries_want_a_space_and_a_filter():
    for query, places in ((ra.point_query, ((0, 0),)), (ra.segment_query, ((0, 0), (1, 0)))):
        with pytest.raises(ValueError, match=r"space must be a pymunk\.Space, got None"):
            query(None, *places)
        with pytest.raises(ValueError, match=r"shape_filter must be a pymunk\.ShapeFilter, got 3"):
            query(pymunk.Space(), *places, 3)
