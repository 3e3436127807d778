"""Bad input and bad states: what was expected, what came, and nothing changed."""

import math
import pickle

import numpy as np
import pymunk
import pytest

import rigidarea as ra

NAN, INF = math.nan, math.inf
SQUARE = [(0, 0), (1, 0), (1, 1), (0, 1)]


def scene(gravity=(0, -10)):
    space = pymunk.Space()
    space.gravity = gravity
    line = pymunk.Segment(space.static_body, (-9, 0), (9, 0), 0)
    line.friction = 0.5
    space.add(line)
    for i in range(3):
        body = pymunk.Body(1, 1 / 6)
        body.position = 0, 0.4999 + 0.9999 * i  # in touch
        shape = pymunk.Poly.create_box(body, (1, 1))
        shape.friction = 0.5
        space.add(body, shape)
    return space


def state(space):
    return np.array([(*b.position, b.angle, *b.velocity, b.angular_velocity) for b in space.bodies])


# --- outlines ---

BAD_OUTLINES = {
    "nan": ([(0, 0), (1, 0), (1, NAN)], (), "finite.*nan.*point 2"),
    "infinite": ([(0, 0), (INF, 0), (1, 1)], (), "finite.*inf.*point 1"),
    "two points": ([(0, 0), (1, 0)], (), "3.*2"),
    "three, one repeated": ([(0, 0), (1, 0), (1, 0), (0, 0)], (), "3.*2"),
    "none": ([], (), "shape"),
    "zero area": ([(0, 0), (1, 1), (2, 2), (3, 3)], (), "area"),
    "self-crossing": ([(0, 0), (1, 1), (1, 0), (0, 1)], (), r"cross.*0\.5, 0\.5"),
    "three columns": ([(0, 0, 0), (1, 0, 0), (1, 1, 0)], (), r"\(n, 2\).*\(3, 3\)"),
    "one row": ([0, 1, 2, 3], (), r"\(n, 2\).*\(4,\)"),
    "text": ("outline", (), "points"),
    "ragged": ([(0, 0), (1, 0), (1,)], (), "points"),
    "hole outside": (SQUARE, [[(2, 2), (3, 2), (3, 3)]], r"holes\[0\].*inside"),
    "hole across": (SQUARE, [[(0.5, 0.5), (2, 0.5), (0.5, 0.8)]], r"holes\[0\].*inside"),
    "holes overlap": (
        SQUARE,
        [[(0.1, 0.1), (0.6, 0.1), (0.3, 0.6)], [(0.2, 0.2), (0.8, 0.2), (0.8, 0.8)]],
        r"holes\[0\] and holes\[1\].*apart",
    ),
    "hole with nan": (SQUARE, [[(0.1, 0.1), (NAN, 0.1), (0.3, 0.6)]], r"holes\[0\].*finite"),
}


@pytest.mark.parametrize("kind", BAD_OUTLINES)
def test_bad_outlines(kind):
    points, holes, message = BAD_OUTLINES[kind]
    with pytest.raises(ValueError, match=message):
        ra.Outline(points, holes)


def test_clockwise_rings_and_repeated_points_are_mended():
    good = ra.Outline(SQUARE, [[(0.2, 0.2), (0.2, 0.8), (0.8, 0.8), (0.8, 0.2)]])
    twice = [p for p in SQUARE[::-1] for _ in range(2)]
    mended = ra.Outline([*twice, twice[0]], [[(0.2, 0.2), (0.8, 0.2), (0.8, 0.8), (0.2, 0.8), (0.2, 0.2)]])
    assert mended.area == pytest.approx(good.area, rel=1e-15) == pytest.approx(0.64, rel=1e-15)
    assert [len(ring) for ring in mended.rings] == [4, 4]
    assert mended.centroid == pytest.approx((0.5, 0.5), abs=1e-15)


# --- attach ---

BAD_SETTINGS = {
    "stiffness": [0, -1, NAN, INF],
    "penetration": [0, -1e-3, NAN, INF],
    "length": [0, -1, NAN],
    "rest_speed": [-1, NAN, INF],
    "exponent": [-1, NAN, INF],
    "law": ["hertz", "", None],
    "direction": ["normal", None],
    "integration": ["euler", None],
}


@pytest.mark.parametrize("name", BAD_SETTINGS)
def test_bad_settings_of_attach(name):
    for value in BAD_SETTINGS[name]:
        space = scene()
        with pytest.raises(ValueError, match=f"(?s){name}.*{value}"):
            ra.attach(space, **{name: value})
        # nothing was changed: it is native to the bit
        assert ra.attached(space) is None
        untouched = scene()
        for _ in range(50):
            space.step(1e-3)
            untouched.step(1e-3)
        assert (state(space) == state(untouched)).all()


@pytest.mark.parametrize("value", ["20000", [1e4], 1j])
def test_settings_of_the_wrong_kind(value):
    space = scene()
    with pytest.raises((ValueError, TypeError)):
        ra.attach(space, stiffness=value)
    assert ra.attached(space) is None


@pytest.mark.parametrize("value", [None, 3, "space", pymunk.Body(1, 1)])
def test_attach_wants_a_space(value):
    with pytest.raises(ValueError, match="pymunk.Space.*" + type(value).__name__):
        ra.attach(value)


def test_attaching_twice():
    space = scene()
    contact = ra.attach(space, 5e4)
    with pytest.raises(ValueError, match="attached"):
        ra.attach(space, 5e4)
    assert ra.attached(space) is contact
    space.step(1e-3)
    assert len(contact.regions) == 3


PHASES = ["begin", "pre_solve", "post_solve", "separate"]


def together_and_apart(space):
    """The three bodies leave each other in one step, and meet again in the next."""
    for body in space.bodies:
        body.position += 0, 5 * (1 + list(space.bodies).index(body))
    space.step(1e-3)
    for body in space.bodies:
        body.position -= 0, 5 * (1 + list(space.bodies).index(body))
    space.step(1e-3)


@pytest.mark.parametrize("before", [True, False])
@pytest.mark.parametrize("phase", PHASES)
def test_global_handlers_live_beside_it(phase, before):
    """Set before or after attach, they are called as without it, and detach leaves them."""
    counts = []
    for attach in (False, True):
        space = scene()
        calls = []

        def note(arbiter, space, data, calls=calls):
            calls.append(1)

        if before:
            space.on_collision(**{phase: note})
        contact = ra.attach(space, 5e4) if attach else None
        if not before:
            space.step(1e-3)
            space.on_collision(**{phase: note})
        for _ in range(20):
            space.step(1e-3)
        together_and_apart(space)
        if contact is not None:
            assert len(contact.regions) == 3
            n = len(calls)
            contact.detach()
            together_and_apart(space)
            assert len(calls) > n
            calls = calls[:n]
        counts.append(len(calls))
    assert counts[0] == counts[1] > 0


def test_without_gravity_a_stiffness_is_found_all_the_same():
    """In touch, nothing asked: finite, nobody shot away, and nothing raised."""
    space = scene(gravity=(0, 0))
    contact = ra.attach(space)
    assert contact.stiffness is None
    for _ in range(60):
        contact.step(1 / 60)
        assert (contact.regions["stiffness"] > 0).all()
    # 1e-4 deep, three times over: parted within 1 s, no faster than by ten times that a second
    assert np.abs(state(space)[:, 3:]).max() < 3e-3


def test_without_gravity_an_impact_without_restitution_is_one():
    space = scene(gravity=(0, 0))
    contact = ra.attach(space)
    list(space.bodies)[2].velocity = 0, -1
    for _ in range(60):
        contact.step(1 / 60)
    assert np.abs(state(space)[:, 3:]).max() < 0.01  # issue's bound for e = 0


# --- using a contact ---


@pytest.mark.parametrize("dt", [0, -1 / 60, NAN, INF])
def test_steps_of_no_length(dt):
    space = scene()
    contact = ra.attach(space, 5e4)
    before = state(space)
    with pytest.raises(ValueError, match=f"dt.*{dt}"):
        contact.step(dt)
    assert (state(space) == before).all()


@pytest.mark.parametrize("value", [0, -1, NAN, INF])
def test_bad_values_of_a_contacts_stiffness(value):
    contact = ra.attach(scene(), 5e4)
    with pytest.raises(ValueError, match=f"stiffness.*{value}"):
        contact.stiffness = value
    assert contact.stiffness == 5e4


@pytest.mark.parametrize("value", [0, -5, NAN, 1.5, True, "2"])
@pytest.mark.parametrize("name", ["steps", "frames"])
def test_bad_counts_of_a_step(name, value):
    space = scene()
    contact = ra.attach(space, 5e4)
    before = state(space)
    with pytest.raises(ValueError, match=f"{name}.*{value}"):
        contact.step(1 / 60, **{name: value})
    assert (state(space) == before).all()


def test_after_detach_everything_says_so():
    contact = ra.attach(scene(), 5e4)
    contact.detach()
    for use in (
        lambda: contact.step(1 / 60),
        lambda: contact.regions,
        contact.energy,
        lambda: contact.space,
    ):
        with pytest.raises(RuntimeError, match="detached"):
            use()


# --- states that are not finite ---


def poison(body, what):
    if what == "position":  # pymunk's setter takes it
        body.position = NAN, 1
    elif what == "velocity":
        body.velocity = 0, INF
    elif what == "spin":
        body.angular_velocity = NAN
    elif what == "force":
        body.force = NAN, 0
    else:
        body.mass = 1e-320  # its inverse is infinite


STEPS = [
    pytest.param(lambda c: c.step(1 / 60), id="contact.step"),
    pytest.param(lambda c: c.space.step(1 / 60), id="space.step"),
]


def poisoned(what):
    """A velocity function that gives its body a state that is not finite."""

    def velocity(body, gravity, damping, dt):
        if what == "force":  # what it is integrated from
            poison(body, what)
        pymunk.Body.update_velocity(body, gravity, damping, dt)
        if what != "force":
            poison(body, what)

    return velocity


@pytest.mark.parametrize("step", STEPS)
@pytest.mark.parametrize("what", ["velocity", "spin", "force"])
def test_a_state_that_is_not_finite_is_taken_back(what, step):
    space = scene()
    contact = ra.attach(space, 5e4)
    for _ in range(5):
        contact.step(1 / 60)
    good = state(space)
    body = list(space.bodies)[1]
    body.velocity_func = poisoned(what)
    with pytest.raises(ra.SimulationError, match=r"bodies\[\d\].*not finite in frame \d+"):
        step(contact)
    assert (state(space) == good).all()
    body.velocity_func = pymunk.Body.update_velocity
    body.force = 0, 0
    step(contact)  # and on it goes
    assert np.isfinite(state(space)).all()


@pytest.mark.parametrize("what", ["velocity", "spin", "force"])
def test_a_state_that_is_not_finite_is_told_of_the_body_that_has_it(what):
    space = scene()
    contact = ra.attach(space, 5e4)
    contact.step(1 / 60)
    list(space.bodies)[1].velocity_func = poisoned(what)
    with pytest.raises(ra.SimulationError, match=r"bodies\[1\]"):
        contact.step(1 / 60)


def nowhere(body, dt):
    body.position = NAN, NAN


def test_a_position_that_is_not_finite_is_taken_back_to_the_frames_start():
    space = scene()
    contact = ra.attach(space, 5e4)
    contact.step(1 / 60)
    good = state(space)
    body = list(space.bodies)[2]
    body.position_func = nowhere
    with pytest.raises(ra.SimulationError, match=r"bodies\[\d\].*frame"):
        contact.step(1 / 60)
    assert (state(space) == good).all()
    body.position_func = pymunk.Body.update_position
    contact.step(1 / 60)  # and on it goes
    assert np.isfinite(state(space)).all()


def test_a_position_that_is_not_finite_is_told_of_the_body_that_has_it():
    space = scene()
    contact = ra.attach(space, 5e4)
    contact.step(1 / 60)
    list(space.bodies)[2].position_func = nowhere
    with pytest.raises(ra.SimulationError, match=r"bodies\[2\]"):
        contact.step(1 / 60)


def test_the_only_body_whose_position_is_not_finite_is_taken_back():
    """A function of the user's has moved it before the frame began for us: where the last one left it."""
    space = pymunk.Space()
    space.gravity = 0, -10
    body = pymunk.Body(1, 1)
    space.add(body, pymunk.Circle(body, 1))
    contact = ra.attach(space)
    body.position_func = pymunk.Body.update_position
    for _ in range(3):
        contact.step(1 / 60)
    good = state(space)
    body.position_func = nowhere
    with pytest.raises(ra.SimulationError, match=r"bodies\[0\].*frame"):
        contact.step(1 / 60)
    assert (state(space) == good).all()


@pytest.mark.parametrize("velocity", [(0, -INF), (NAN, 0)])
def test_a_velocity_that_is_not_finite_spreads_to_nobody(velocity):
    """Set by hand before the frame: the others stay as they were, finite, and the message names a body."""
    space = scene()
    contact = ra.attach(space, 5e4)
    contact.step(1 / 60)
    body = next(iter(space.bodies))
    good = state(space)
    body.velocity = velocity
    with pytest.raises(ra.SimulationError, match=r"bodies\[\d\].*not finite in frame \d+"):
        space.step(1 / 60)
    assert (state(space)[1:] == good[1:]).all()


def dot(space):
    """A body whose circle has no area."""
    body = pymunk.Body(1, 1)
    body.position = 3, 0
    space.add(body, pymunk.Circle(body, 0))


def test_a_shape_without_area_is_named_by_attach():
    space = scene()
    dot(space)
    with pytest.raises(ValueError, match=r"radius.*0"):
        ra.attach(space, 5e4)
    assert ra.attached(space) is None
    untouched = scene()
    dot(untouched)
    for _ in range(20):
        space.step(1e-3)
        untouched.step(1e-3)
    assert (state(space) == state(untouched)).all()


def test_a_shape_without_area_is_named_by_the_next_frame():
    space = scene()
    contact = ra.attach(space, 5e4)
    dot(space)
    before = state(space)
    for _ in range(2):
        with pytest.raises(ValueError, match=r"radius.*0"):
            contact.step(1 / 60)
        assert (state(space) == before).all()
    space.remove(next(s for s in space.shapes if isinstance(s, pymunk.Circle)))
    contact.step(1 / 60)  # and on it goes
    assert (state(space) != before).any() and np.isfinite(state(space)).all()


def test_a_contact_alone_cannot_be_pickled_into_use():
    """Without its space a contact is a detached one: it says so."""
    contact = ra.attach(scene(), 5e4)
    alone = pickle.loads(pickle.dumps(contact))
    with pytest.raises(RuntimeError, match="detached"):
        alone.step(1 / 60)


def test_an_unknown_layout_is_refused(monkeypatch):
    """Where Chipmunk's memory is not as it must be, attach says so, and the space stays pymunk's."""
    from rigidarea.chipmunk import area_contact
    from rigidarea.chipmunk.structs import LayoutError

    def strange():
        raise LayoutError("a layout never seen")

    monkeypatch.setattr(area_contact, "layout", strange)
    space = scene()
    with pytest.raises(LayoutError, match="never seen"):
        ra.attach(space, 5e4)
    assert ra.attached(space) is None
    untouched = scene()
    for _ in range(20):
        space.step(1e-3)
        untouched.step(1e-3)
    assert (state(space) == state(untouched)).all()
