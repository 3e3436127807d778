"""Scene files: what they say is what is there, round trips, hostile ones refused in bounded time."""

import copy
import json
import math
import random
import time
import tomllib

import pymunk
import pytest

import rigidarea as ra
from rigidarea import bring
from rigidarea.bring import Limits
from rigidarea.io import scene_file as scene_module
from rigidarea.io.scene_joints import JOINTS

SCENE = {
    "rigidarea": 1,
    "gravity": [0, -10],
    "damping": 0.9,
    "iterations": 20,
    "contact": {"stiffness": 1e5, "law": "energy"},
    "materials": {"oak": {"density": 2.0, "friction": 0.5, "elasticity": 0.25}},
    "outlines": {"u": {"points": [[0, 0], [3, 0], [3, 2], [2, 2], [2, 1], [1, 1], [1, 2], [0, 2]]}},
    "bodies": [
        {
            "name": "part",
            "position": [0, 5],
            "angle": 0.5,
            "velocity": [1, 2],
            "angular_velocity": 3,
            "shapes": [{"outline": "u", "material": "oak", "friction": 0.75}],
        },
        {"name": "ball", "mass": 2, "moment": "inf", "shapes": [{"circle": 0.5, "offset": [0.25, 0]}]},
        {
            "name": "floor",
            "type": "static",
            "shapes": [{"segment": [[-9, 0], [9, 0]], "radius": 0.1, "friction": 1}],
        },
        {"type": "kinematic", "velocity": [1, 0], "shapes": [{"box": [2, 1], "radius": 0.1, "sensor": True}]},
    ],
    "joints": [
        {
            "type": "pivot",
            "name": "hinge",
            "a": "part",
            "b": "ball",
            "max_force": 100,
            "collide_bodies": False,
        },
        {"type": "spring", "a": "part", "rest_length": 1, "stiffness": 5, "damping": 0.5},
    ],
}


def read(changed=None, limits=bring.LIMITS):
    return bring.scene_from_text(json.dumps(changed or SCENE), limits=limits)


def test_what_the_file_says_is_there():
    scene = read()
    space = scene.space
    assert space.gravity == (0, -10) and space.damping == 0.9 and space.iterations == 20
    part, ball = scene.bodies["part"], scene.bodies["ball"]
    assert (
        part.position == (0, 5)
        and part.angle == 0.5
        and part.velocity == (1, 2)
        and part.angular_velocity == 3
    )
    u = ra.Outline(SCENE["outlines"]["u"]["points"])
    assert part.mass == pytest.approx(2 * 5) and u.area == 5
    assert part.moment == pytest.approx(u.body(density=2).moment)
    assert part.center_of_gravity == pytest.approx(u.centroid)
    (shape,) = part.shapes
    assert (shape.friction, shape.elasticity) == (0.75, 0.25)
    assert ball.moment == math.inf and next(iter(ball.shapes)).offset == (0.25, 0)
    assert {body.body_type for body in space.bodies} == {0, 1, 2}
    hinge = scene.joints["hinge"]
    assert isinstance(hinge, pymunk.PivotJoint) and hinge.max_force == 100 and not hinge.collide_bodies
    spring = next(j for j in space.constraints if isinstance(j, pymunk.DampedSpring))
    assert spring.b is space.static_body and spring.stiffness == 5
    contact = scene.attach()
    assert contact.stiffness == 1e5
    contact.step(1 / 60)
    assert scene.attach is not None and ra.attached(space) is contact


def test_densities_of_several_shapes_add_up():
    table = {
        "rigidarea": 1,
        "materials": {"m": {"density": 3.0}},
        "bodies": [
            {"shapes": [
                {"box": [2, 2], "material": "m"},
                {"outline": {"points": [[1, -1], [3, -1], [3, 1], [1, 1]]}, "density": 6.0},
            ]}
        ],
    }  # fmt: skip
    (body,) = read(table).space.bodies
    assert body.mass == pytest.approx(12 + 24) and body.center_of_gravity == pytest.approx((48 / 36, 0))
    about = 12 * (8 / 12 + (48 / 36) ** 2) + 24 * (8 / 12 + (2 - 48 / 36) ** 2)
    assert body.moment == pytest.approx(about)


def test_the_example_of_the_documentation():
    text = scene_module.__doc__.split("```toml\n")[1].split("```")[0]
    scene = bring.scene_from_text(text, "toml")
    assert set(scene.bodies) == {"part", "floor"}
    assert scene.bodies["part"].mass == pytest.approx(7800 * (7 - 0.16))
    contact = scene.attach()
    for _ in range(3):
        contact.step(1 / 60)


def many_joints() -> pymunk.Space:
    space = pymunk.Space()
    numbers = random.Random(1)
    for i, (make, fields) in enumerate(JOINTS.values()):
        a, b = (pymunk.Body(1, 2) for _ in range(2))
        a.position, b.position = (0, 10 * i), (4, 10 * i)
        space.add(a, b, pymunk.Circle(a, 1), pymunk.Circle(b, 1))
        values = [
            (0.5, numbers.random()) if kind == "point" else numbers.uniform(1, 2) for kind in fields.values()
        ]
        if "min" in fields:
            values[-2:] = sorted(values[-2:])
        space.add(make(a, b, *values))
    return space


@pytest.mark.parametrize("kind", ["json", "toml"])
@pytest.mark.parametrize("make", [lambda: read().space, many_joints])
def test_round_trip_moves_alike(kind, make):
    if kind == "toml":
        pytest.importorskip("tomli_w")
    first = make()
    text = bring.scene_as_text(first, kind)
    second = bring.scene_from_text(text, kind).space
    assert bring.scene_as_text(second, kind) == text  # nothing is lost, to the bit
    for space in (first, second):
        for _ in range(20):
            space.step(1 / 100)
    ends = [sorted((*b.position, b.angle) for b in space.bodies) for space in (first, second)]
    assert ends[0] == ends[1] and all(map(math.isfinite, ends[0][0]))


def test_an_attached_space_remembers_how(tmp_path):
    space = read().space
    ra.attach(space, stiffness=123.0, law="energy", integration="explicit")
    bring.save_scene(space, tmp_path / "scene.json")
    assert [path.name for path in tmp_path.iterdir()] == ["scene.json"]
    contact = bring.load_scene(tmp_path / "scene.json").attach()
    assert contact.stiffness == 123.0
    assert json.loads((tmp_path / "scene.json").read_text())["contact"]["integration"] == "explicit"


def test_static_shapes_of_the_space_itself_are_kept():
    space = pymunk.Space()
    space.add(pymunk.Segment(space.static_body, (0, 0), (1, 0), 0.5))
    body = pymunk.Body(1, 1)
    space.add(body, pymunk.PivotJoint(space.static_body, body, (0, 0), (0, 0)))
    scene = bring.scene_from_text(bring.scene_as_text(space))
    assert [s.radius for s in scene.bodies["world"].shapes] == [0.5]
    (joint,) = scene.space.constraints
    assert joint.a is scene.bodies["world"]


# --- refusals ---


def changed(path, value):
    table = copy.deepcopy(SCENE)
    at = table
    for key in path[:-1]:
        at = at[key]
    at[path[-1]] = value
    return table


@pytest.mark.parametrize(
    ("path", "value", "message"),
    [
        (["rigidarea"], 2, "rigidarea: expected the format's number 1, got 2"),
        (["colour"], 2, "scene: expected some of rigidarea, .*, got 'colour'"),
        (["gravity"], [0], r"gravity: expected \[x, y\], got \[0\]"),
        (["gravity"], [0, 10**400], r"gravity\[1\]: expected a finite number"),
        (["iterations"], 1e9, "iterations: expected a whole number from 1 to 1000"),
        (["contact", "hook"], "python", "contact: expected some of"),
        (
            ["materials", "oak", "friction"],
            -1,
            r"materials.oak.friction: expected a finite number >= 0, got -1",
        ),
        (
            ["outlines", "u", "points"],
            [[0, 0], [1, 1]],
            "outlines.u.points: expected at least 3 points, got 2",
        ),
        (["outlines", "u", "points"], [[0, 0], [2, 2], [2, 0], [0, 2]], "outlines.u: "),
        (["bodies", 0, "position"], "here", r"bodies\[0\].position: expected \[x, y\], got 'here'"),
        (["bodies", 0, "type"], "ghost", r"bodies\[0\].type: expected one of dynamic, kinematic, static"),
        (["bodies", 0, "type"], ["x"], r"bodies\[0\].type: expected one of"),
        (["bodies", 1, "name"], "part", r"bodies\[1\].name: expected a name that no other body has"),
        (["bodies", 1, "mass"], 0, r"bodies\[1\].mass: expected a finite number > 0, got 0"),
        (["bodies", 2, "mass"], 1, r"bodies\[2\]: expected no mass on a static body"),
        (
            ["bodies", 0, "shapes", 0, "outline"],
            "v",
            r"shapes\[0\].outline: expected the name of an outline, got 'v'",
        ),
        (
            ["bodies", 0, "shapes", 0, "circle"],
            1,
            "expected exactly one of outline, circle, .*, got outline, circle",
        ),
        (["bodies", 0, "shapes", 0, "material"], "tin", "expected the name of a material, got 'tin'"),
        (["bodies", 0, "shapes"], [], r"bodies\[0\]: expected mass and moment, or a shape with a density"),
        (["bodies", 1, "shapes", 0, "circle"], -1, "expected a finite number > 0, got -1"),
        (["bodies", 3, "shapes", 0, "sensor"], 1, "expected true or false, got 1"),
        (["joints", 0, "type"], "glue", r"joints\[0\].type: expected one of pin, "),
        (["joints", 0, "a"], "nobody", r"joints\[0\].a: expected the name of a body, got 'nobody'"),
        (["joints", 0, "b"], "part", r"joints\[0\]: expected two bodies, got one twice"),
        (
            ["joints", 1, "rest_length"],
            None,
            r"joints\[1\].rest_length: expected a finite number >= 0, got None",
        ),
        (["joints"], {}, "joints: expected a list"),
    ],
)
def test_bad_scenes_are_refused(path, value, message):
    with pytest.raises(ValueError, match=message):
        read(changed(path, value))


SMALL = Limits(bytes=100_000, depth=10, points=100, parts=20, pixels=100)


@pytest.mark.parametrize(
    ("text", "kind", "message"),
    [
        ("[" * 90_000, "json", "within each other"),
        ('{"a":' * 20 + "1" + "}" * 20, "json", "at most 10 lists and tables"),
        ('{"rigidarea": 1, "bodies": [' + ",".join(["{}"] * 21) + "]}", "json", "at most 20 bodies, got 21"),
        (
            json.dumps({"rigidarea": 1, "outlines": {"a": {"points": [[0, 0]] * 101}}}),
            "json",
            "at most 100 points",
        ),
        (
            json.dumps({"rigidarea": 1, "bodies": [{"type": "static", "shapes": [{"circle": 1}]}] * 15}),
            "json",
            "at most 100 pairs of shapes whose boxes overlap, got 210",
        ),
        ("x" * 200_000, "json", "at most 100000 characters"),
        ("x = " + "[" * 5000, "toml", "expected"),
        ("a" * 90_000, "toml", "expected TOML"),
        ("x = 1", "yaml", "kind must be 'json' or 'toml', got 'yaml'"),
        ('{"rigidarea": 1, "gravity": [0, Infinity]}', "json", "expected finite numbers, got Infinity"),
        ("rigidarea = 1\ngravity = [0, inf]", "toml", "gravity.1.: expected a finite number"),
        ("null", "json", "scene: expected a table, got None"),
    ],
)
def test_hostile_texts_are_refused_quickly(text, kind, message):
    start = time.perf_counter()
    with pytest.raises(ValueError, match=message):
        bring.scene_from_text(text, kind, SMALL)
    assert time.perf_counter() - start < 10  # seconds, on a busy machine; without limits it would be minutes


def test_fuzz_ends_in_a_scene_or_a_value_error():
    """Every table with one value exchanged for a hostile one: a ValueError, or a scene whose numbers are finite."""
    hostile = [
        None,
        True,
        -1,
        0,
        1e308,
        -1e308,
        10**400,
        "inf",
        "nan",
        "x",
        "",
        [],
        {},
        [[]],
        [1],
        [1, 2],
        {"a": 1},
    ]
    places: list[list] = []

    def walk(found, path):
        for key, value in found.items() if isinstance(found, dict) else enumerate(found):
            places.append([*path, key])
            if isinstance(value, dict | list):
                walk(value, [*path, key])

    walk(SCENE, [])
    refused = made = 0
    for path in places:
        for value in hostile:
            try:
                space = read(changed(path, value)).space
            except ValueError:
                refused += 1
                continue
            made += 1
            for body in space.bodies:
                state = (*body.position, body.angle, *body.velocity)
                assert all(map(math.isfinite, state)), (path, value, state)
                assert body.body_type != pymunk.Body.DYNAMIC or 0 < body.mass < math.inf
    assert refused > 1000 and made > 50
    assert tomllib is not None


def test_arcs_are_saved_as_bulges():
    """A lens with a round hole comes back, to rounding: a bulge is the tangent of a quarter of the arc's turn."""
    lens = ra.Outline.from_bulges(
        [(-2, 0, 0.5), (2, 0, 0), (2, 1, 0.25), (-2, 1, 0)], [[(0.5, 0.25, 1), (-0.5, 0.25, 1)]]
    )
    space = pymunk.Space()
    body = lens.body(density=1.0)
    space.add(body, lens.add_to(body))
    disc = pymunk.Body(1, 1)
    space.add(disc, ra.Outline.circle(0.5).add_to(disc))
    text = bring.scene_as_text(space)
    again = bring.scene_from_text(text).space
    found = [next(iter(b.shapes)).outline for b in again.bodies]
    for before, after in zip((lens, ra.Outline.circle(0.5)), found):
        assert after.area == pytest.approx(before.area, rel=1e-14)
        for name in ("rings", "arcs"):
            assert len(getattr(after, name)) == len(getattr(before, name))
            for one, other in zip(getattr(before, name), getattr(after, name)):
                assert other == pytest.approx(one, abs=1e-14)
    assert found[1].area == pytest.approx(math.pi / 4, rel=1e-15)


@pytest.mark.parametrize(
    "points",
    [
        [[0, 0, 1], [1, 0, -1]],  # nothing within
        [[0, 0, 1e50], [1, 0, 0], [1, 1, 0]],
        [[0, 0, 1e-50], [1, 0, 0], [1, 1, 0]],
        [[0, 0, 1], [0, 0, 1]],
        [[0, 0, 1]],
        [[0, 0, 1, 2], [1, 0], [1, 1]],
        [[0, 0, "1"], [1, 0], [1, 1]],
        [[0, 0, -0.9], [1, 0], [1, 1]],  # crosses the others
        [[1e50, 0, 1], [1e50, 1], [0, 1]],
    ],
)
def test_hostile_arcs_are_refused_or_right(points):
    began = time.monotonic()
    try:
        scene = read(
            {"rigidarea": 1, "bodies": [{"shapes": [{"outline": {"points": points}, "density": 1}]}]}
        )
    except ValueError as error:
        assert "bodies[0]" in str(error)
    else:
        (body,) = scene.space.bodies
        assert math.isfinite(body.mass) and math.isfinite(body.moment) and body.mass > 0
    assert time.monotonic() - began < 5  # bounded: no array of 1e25 points
