"""Bad input and bad states: what was expected, what came, and nothing changed."""

import math
import pickle

import numpy as np
import pymunk
import pytest

import rigidarea as ra

NAN, INF = math.nan, math.inf
SQUARE = [(0, 0), (1, 0), (1, 1), (0, 1)]


@pytest.fixture(params=["compiled", "python"])
def hook(request):
    return request.param


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
    "hook": ["fast", None],
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


@pytest.mark.parametrize("phase", ["pre_solve", "separate"])
def test_another_global_handler_is_never_overwritten(phase):
    space = scene()
    calls = []
    space.on_collision(**{phase: lambda arbiter, space, data: calls.append(1)})
    with pytest.raises(ValueError, match=f"(?s){phase}.*on_collision"):
        ra.attach(space, 5e4)
    assert ra.attached(space) is None
    for _ in range(20):
        space.step(1e-3)
    if phase == "separate":
        space.remove(*space.bodies, *[s for s in space.shapes if s.body is not space.static_body])
        space.step(1e-3)
    assert calls  # theirs goes on
    space.on_collision(**{phase: pymunk.empty_callback})  # the way on that the message names
    assert ra.attach(space, 5e4).stiffness == 5e4


@pytest.mark.parametrize("phase", ["begin", "post_solve"])
def test_other_global_handlers_live_beside_it(hook, phase):
    space = scene()
    calls = []
    space.on_collision(**{phase: lambda arbiter, space, data: calls.append(1)})
    contact = ra.attach(space, 5e4, hook=hook)
    for _ in range(20):
        space.step(1e-3)
    assert calls and len(contact.regions) == 3
    contact.detach()
    n = len(calls)
    for body in space.bodies:
        body.position += 0, 5
    space.step(1e-3)
    for body in space.bodies:
        body.position -= 0, 5.01
    space.step(1e-3)
    assert len(calls) > n  # detach leaves them


@pytest.mark.parametrize("phase", ["pre_solve", "separate"])
def test_a_global_handler_set_after_attach_is_told_at_the_next_frame(hook, phase):
    space = scene()
    contact = ra.attach(space, 5e4, hook=hook)
    contact.step(1 / 60)
    before = state(space)
    space.on_collision(**{phase: lambda arbiter, space, data: None})
    with pytest.raises(RuntimeError, match=f"(?s){phase}.*on_collision"):
        contact.step(1 / 60)
    assert (state(space) == before).all()


def test_stiffness_that_cannot_be_chosen():
    space = scene(gravity=(0, 0))
    with pytest.raises(ValueError, match=r"stiffness.*gravity"):
        ra.attach(space)
    assert ra.attached(space) is None
    assert ra.attach(space, 1e4).step(1 / 60) >= 1  # the way on


def without_gravity(hook="auto"):
    """A contact that was attached before there was anything to choose from."""
    space = pymunk.Space()
    contact = ra.attach(space, hook=hook)
    full = scene(gravity=(0, 0))
    things = [*full.bodies, *full.shapes]
    full.remove(*things)
    for thing in things:
        if isinstance(thing, pymunk.Shape) and thing.body is full.static_body:
            thing = pymunk.Segment(space.static_body, thing.a, thing.b, 0)
        space.add(thing)
    return space, contact


def test_stiffness_that_cannot_be_chosen_later():
    space, contact = without_gravity()
    before = state(space)
    with pytest.raises(ValueError, match=r"stiffness.*gravity"):
        contact.step(1 / 60)
    assert (state(space) == before).all()
    contact.stiffness = 1e4
    assert contact.step(1 / 60) >= 1


def test_stiffness_that_cannot_be_chosen_is_told_by_space_step_too(hook):
    """It is found out inside a callback, whose exceptions cffi would swallow: it is raised after the step, once."""
    space, contact = without_gravity(hook)
    with pytest.raises(ValueError, match=r"stiffness.*gravity"):
        space.step(1e-3)
    contact.stiffness = 5e4
    space.step(1e-3)
    assert len(contact.regions) >= 1


# --- using a contact ---


@pytest.mark.parametrize("dt", [0, -1 / 60, NAN, INF])
def test_steps_of_no_length(dt):
    space = scene()
    contact = ra.attach(space, 5e4)
    before = state(space)
    for method in (contact.step, contact.steps):
        with pytest.raises(ValueError, match=f"dt.*{dt}"):
            method(dt)
    assert (state(space) == before).all()


@pytest.mark.parametrize("name, values", [("stiffness", [0, -1, NAN, INF]), ("rest_speed", [-1, NAN, INF])])
def test_bad_values_of_a_contacts_properties(name, values):
    contact = ra.attach(scene(), 5e4, rest_speed=0.1)
    for value in values:
        with pytest.raises(ValueError, match=f"{name}.*{value}"):
            setattr(contact, name, value)
        assert contact.stiffness == 5e4 and contact.rest_speed == 0.1


@pytest.mark.parametrize("name, values", [("max_steps", [0, -5, NAN]), ("phase", [0, -1, NAN, INF])])
def test_bad_values_of_a_contacts_plan(name, values):
    contact = ra.attach(scene(), 5e4)
    for value in values:
        with pytest.raises(ValueError, match=name):
            setattr(contact, name, value)


def test_after_detach_everything_says_so():
    contact = ra.attach(scene(), 5e4)
    contact.detach()
    for use in (
        lambda: contact.step(1 / 60),
        lambda: contact.steps(1 / 60),
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


@pytest.mark.parametrize("what", ["velocity", "spin", "force"])
def test_a_state_that_is_not_finite_names_body_and_step_and_is_taken_back(hook, what):
    space = scene()
    contact = ra.attach(space, 5e4, hook=hook)
    for _ in range(5):
        contact.step(1 / 60)
    good = state(space)

    def bad_velocity(body, gravity, damping, dt):
        pymunk.Body.update_velocity(body, gravity, damping, dt)
        poison(body, what)

    list(space.bodies)[1].velocity_func = bad_velocity
    with pytest.raises(ra.SimulationError, match=r"(?s)bodies\[1\].*step [12] of \d+"):
        contact.step(1 / 60)
    after = state(space)
    assert np.isfinite(after).all()
    # the last good state: at most one step on from the frame's start
    assert np.abs(after[:, :3] - good[:, :3]).max() < 1e-3


def test_a_position_that_is_not_finite_is_taken_back_to_the_frames_start(hook):
    space = scene()
    contact = ra.attach(space, 5e4, hook=hook)
    contact.step(1 / 60)
    good = state(space)

    def nowhere(body, dt):
        body.position = NAN, NAN

    body = list(space.bodies)[2]
    body.position_func = nowhere
    with pytest.raises(ra.SimulationError, match=r"bodies\[2\].*step 1 of"):
        contact.step(1 / 60)
    assert (state(space) == good).all()
    body.position_func = pymunk.Body.update_position
    contact.step(1 / 60)  # and on it goes
    assert np.isfinite(state(space)).all()


@pytest.mark.parametrize("velocity", [(0, -INF), (NAN, 0)])
def test_a_force_that_is_not_finite_is_not_applied(hook, velocity):
    """Through space.step: the hook refuses it, names both bodies and the step, and says so after the step."""
    space = scene()
    contact = ra.attach(space, 5e4, hook=hook)
    contact.step(1 / 60)
    body, above, _ = space.bodies
    body.velocity = velocity
    body.position_func = lambda body, dt: None
    with pytest.raises(ra.SimulationError, match=r"(?s)bodies\[\d\].*not finite in step \d+"):
        space.step(1e-3)
    assert math.isfinite(above.velocity.length)


def test_a_shape_without_area_is_named(hook):
    space = scene()
    body = pymunk.Body(1, 1)
    body.position = 3, 0
    space.add(body, pymunk.Circle(body, 0))
    before = state(space)
    with pytest.raises(ValueError, match=r"radius.*0"):
        ra.attach(space, 5e4, hook=hook)
    assert ra.attached(space) is None
    space = scene()
    contact = ra.attach(space, 5e4, hook=hook)
    space.add(body := pymunk.Body(1, 1), pymunk.Circle(body, 0))
    body.position = 3, 0
    before = state(space)
    with pytest.raises(ValueError, match=r"radius.*0"):
        contact.step(1 / 60)
    assert (state(space) == before).all()


def test_a_contact_alone_cannot_be_pickled_into_use():
    """Without its space a contact is a detached one: it says so."""
    contact = ra.attach(scene(), 5e4)
    alone = pickle.loads(pickle.dumps(contact))
    with pytest.raises(RuntimeError, match="detached"):
        alone.step(1 / 60)


def test_the_compiled_hook_says_why_it_cannot_run(monkeypatch):
    from rigidarea import contact as module

    def strange():
        raise module.LayoutError("a layout never seen")

    monkeypatch.setattr(module, "layout", strange)
    space = scene()
    with pytest.raises(module.LayoutError, match="never seen"):
        ra.attach(space, 5e4, hook="compiled")
    assert ra.attached(space) is None
    assert not ra.attach(space, 5e4).compiled  # auto: the readable one instead
    space.step(1e-3)
    assert len(ra.attached(space).regions) == 3
