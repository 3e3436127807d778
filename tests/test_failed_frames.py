"""A frame that fails leaves everything as it has found it: bodies, and what contacts remember of the frame before."""

import functools
import random

import pymunk
import pytest

import rigidarea as ra
from harness import interrupts
from harness.interrupts import COURSES, FRAMES, _bits
from rigidarea.chipmunk import area_contact
from rigidarea.chipmunk.arrays import Store
from tests.test_ownership import places, steps

DT = 1 / 60
U = [(0, 0), (3, 0), (3, 2), (2, 2), (2, 1), (1, 1), (1, 2), (0, 2)]


def heap(seed: int, concave: bool) -> tuple[pymunk.Space, list[pymunk.Body]]:
    """Boxes and discs in a heap on a floor, in it pieces of a U; and two boxes beside each other, far from it."""
    draw = random.Random(seed)
    space = pymunk.Space()
    space.gravity = 0, -10
    for at in ((-60, 0), (60, 0)), ((-4, 0), (-4, 20)), ((4, 0), (4, 20)):
        wall = pymunk.Segment(space.static_body, *at, 0.1)
        wall.friction = 0.5
        space.add(wall)
    bodies = []
    for i in range(22):
        body = pymunk.Body(1, 0.2)
        body.position = (40 + i % 2 * 1.01, 0.6) if i < 2 else (draw.uniform(-3, 3), 0.7 + 0.6 * i)
        if i >= 2 and i % 5 == 0 and concave:
            shape: pymunk.Shape = ra.Outline(U).add_to(body)
        elif i % 3 == 2:
            shape = pymunk.Circle(body, 0.4)
        else:
            shape = pymunk.Poly.create_box(body, (1, 1))
        shape.friction, shape.elasticity = 0.5, draw.choice([0, 0.3])
        space.add(body, shape)
        bodies.append(body)
    space.add(pymunk.PivotJoint(bodies[2], bodies[3], (0, 1.2)))
    return space, bodies


def fast(a: pymunk.Body, b: pymunk.Body) -> None:
    a.velocity, b.velocity = (1e200, 1e199), (-1e200, 0)


def light(a: pymunk.Body, b: pymunk.Body) -> None:
    a.moment, b.mass = 1e-300, 1e-300
    a.velocity, b.velocity = (1e160, 0), (-1e160, 0)


def rough(a: pymunk.Body, b: pymunk.Body) -> None:
    for shape in (*a.shapes, *b.shapes):
        shape.friction = shape.elasticity = 1e160
    a.velocity = 3, 0


@pytest.mark.parametrize("concave", [False, True])
@pytest.mark.parametrize("spoil", [fast, light, rough])
@pytest.mark.parametrize("seed", range(3))
def test_the_rest_goes_on_with_the_same_bits(seed, spoil, concave):
    """Two bodies' numbers overflow where they touch; without them, it is as if that frame had not been."""
    space, _ = heap(seed, concave)
    ra.attach(space)
    steps(space, 60)
    untouched = space.copy()
    for one in (space, untouched):
        a, b = list(one.bodies)[:2]
        spoil(a, b)
        if one is space:
            before, impulses = places(one), [joint.impulse for joint in one.constraints]
            with pytest.raises(ra.SimulationError):
                one.step(DT)
            assert places(one) == before
            assert [joint.impulse for joint in one.constraints] == impulses
        one.remove(a, b, *a.shapes, *b.shapes)
    assert steps(space, 30) == steps(untouched, 30)


@pytest.mark.parametrize("seed", range(20))
def test_frames_that_fail_while_callbacks_are_asked(seed, monkeypatch):
    """Python is interrupted when machine code asks it for something: what touches by a hair goes on touching."""
    expected = undisturbed_callbacks()
    course, draw = COURSES["callbacks"](False), random.Random(seed)
    serve, left = area_contact.serve, draw.randrange(1, 300)

    def serve_or_fail(own, request):
        nonlocal left
        left -= 1
        if left == 0:
            left = draw.randrange(1, 300)
            raise KeyboardInterrupt
        serve(own, request)

    monkeypatch.setattr(area_contact, "serve", serve_or_fail)
    bits, done, failed = [], 0, 0
    while done < FRAMES:
        try:
            course.step(1)
            done += 1
            bits.append(_bits(course.space))
        except KeyboardInterrupt:
            failed += 1
    assert failed > 0
    assert bits == expected


@functools.cache
def undisturbed_callbacks() -> list[bytes]:
    course, bits = COURSES["callbacks"](False), []
    for _ in range(FRAMES):
        course.step(1)
        bits.append(_bits(course.space))
    return bits


def test_an_interrupt_while_a_frame_asks_for_room_leaves_it_as_it_was(monkeypatch):
    """With a joint among those that come to touch: it acts on nobody in the frame that could not begin."""
    known, _ = interrupts.undisturbed("steps", False)
    grow, left, raised = Store.grow_regions, [0], 0

    def interrupted(store, n):
        left[0] -= 1
        if left[0] == 0:
            raise KeyboardInterrupt
        grow(store, n)

    for calls in range(2, 6):  # the first makes the tables
        left[0] = calls
        with monkeypatch.context() as patch:
            patch.setattr(Store, "grow_regions", interrupted)
            course, done = interrupts.COURSES["steps"](False), 0
            while done < interrupts.FRAMES:
                try:
                    course.step(1)
                    done += 1
                except KeyboardInterrupt:
                    raised += 1
                assert interrupts._bits(course.space) == known[done]
    assert raised > 0
