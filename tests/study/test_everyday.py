"""Game scenes: made the same from the same seed, free of overlap, seen by every engine; what `bench everyday` says."""

import argparse
import json

import numpy as np
import pytest
import shapely

from rigidarea.study import add_commands, everyday
from rigidarea.study.everyday_scenes import EVERYDAY
from rigidarea.study.peers import get_peer
from rigidarea.study.peers.area_peer import area_space
from rigidarea.study.scene import Trace, X, Y

SMALL = [name for name, scene in EVERYDAY.items() if scene.seeds > 1]


@pytest.mark.parametrize("name", list(EVERYDAY))
def test_seeded(name):
    """One seed, one scene; another seed, another; everything starts in the room."""
    made = EVERYDAY[name].make
    scene = made(1)
    assert scene.bodies == made(1).bodies
    assert scene.bodies != made(2).bodies
    assert scene.name == name
    states = np.array([[(*body.position, body.angle, 0, 0, 0) for body in scene.bodies]])
    trace = Trace(tuple(body.name for body in scene.bodies), np.zeros(1), states)
    assert scene.measure(trace) == 0.0
    moving = [body.kind == "dynamic" for body in scene.bodies]
    gone = states.copy()
    gone[0, moving.index(True), X] = 1e6
    assert scene.measure(Trace(trace.names, trace.times, gone)) == pytest.approx(1 / sum(moving))


@pytest.mark.parametrize("name", SMALL)
def test_nothing_overlaps_at_the_start(name):
    """What overlaps at the start is what the scene would show. Hinged planks are told not to collide."""
    scene = EVERYDAY[name].make(1)
    space, bodies, _ = area_space(scene, {"stiffness": 1.0})
    hinged = {frozenset((hinge.a, hinge.b)) for hinge in scene.hinges}
    names = dict(zip(bodies, (body.name for body in scene.bodies)))
    placed = []
    for shape in space.shapes:
        transform = shape.body.local_to_world
        if hasattr(shape, "radius") and hasattr(shape, "a"):
            line = shapely.LineString([transform(shape.a), transform(shape.b)])
            placed.append((names[shape.body], line.buffer(shape.radius)))
        elif hasattr(shape, "get_vertices"):
            polygon = shapely.Polygon([transform(p) for p in shape.get_vertices()])
            placed.append((names[shape.body], polygon.buffer(shape.radius)))
        else:
            placed.append((names[shape.body], shapely.Point(transform(shape.offset)).buffer(shape.radius)))
    tree = shapely.STRtree([polygon for _, polygon in placed])
    pairs = tree.query([polygon for _, polygon in placed], predicate="intersects").T
    for i, j in pairs:
        (one, a), (other, b) = placed[i], placed[j]
        if one != other and frozenset((one, other)) not in hinged:
            # what is put down touches; a thousandth of a side squared is a film of 1e-3 px at most
            assert a.intersection(b).area < 1e-3 * scene.size**2, (one, other)


@pytest.mark.parametrize("name", ["rope_bridge", "platformer", "rounded"])
def test_engines_are_told_the_same(name):
    """Hinges, rounded corners, segments and bodies that do not turn, in the units of either engine, at fine steps."""
    scene = EVERYDAY[name].make(1)
    moving = [i for i, body in enumerate(scene.bodies) if body.kind == "dynamic"]
    ends = []
    for peer, settings in (
        ("pymunk", {"steps": 16, "iterations": 40, "slop": 1e-3}),
        ("box2d", {"steps": 16, "substeps": 4, "stiff": True, "length": 10}),
        ("rigidarea", {"steps": 64}),
    ):
        if get_peer(peer).refuses(scene):
            continue
        run = get_peer(peer).build(scene, settings)
        run.advance(30)
        state = run.state()
        for hinge in scene.hinges:
            if hinge.b:
                one, other = (
                    next(i for i, body in enumerate(scene.bodies) if body.name == name)
                    for name in (hinge.a, hinge.b)
                )
                # planks are 40 px long from hinge to hinge: their middles stay that far apart but for the bend
                assert 36 < np.hypot(*(state[one, [X, Y]] - state[other, [X, Y]])) < 41, peer
        ends.append(state[moving][:, [X, Y]].mean(axis=0))
    # bodies fall 112 px in that half second; a wrong unit, mass or floor would show as tens of px
    for end in ends[1:]:
        assert end == pytest.approx(ends[0], abs=4.0)


def test_rows_of_a_race():
    """The keys of its JSON, medians of the seeds, every engine's own figures beside them."""
    report = everyday.everyday(["tower"], seeds=2)
    row = report["results"][0]
    wanted = {
        *("scene", "bodies", "steps_per_frame", "frame_ms_median", "native_1_ms", "native_4_ms", "box2d_ms"),
        *("speed_left", "native_4_speed_left", "contacts", "native_contacts", "inside", "ratio"),
        *everyday.TOLD,
    }
    assert wanted <= set(row)
    assert row["bodies"] == 12
    assert row["frame_ms_median"] > 0
    assert row["inside"] is True
    runs = report["runs"]
    assert [(run["seed"], run["engine"]) for run in runs] == [
        (seed, engine) for seed in (1, 2) for engine in everyday.PEERS if row["box2d_ms"] or engine != "box2d"
    ]
    ours = [run["frame_ms_median"] for run in runs if run["engine"] == "rigidarea"]
    assert row["frame_ms_median"] == pytest.approx(np.mean(ours))
    assert report["summary"]["scenes"] == ["tower"]
    with pytest.raises(ValueError, match="unknown scene 'x'"):
        everyday.everyday(["x"])
    with pytest.raises(ValueError, match="at least 1"):
        everyday.everyday(["tower"], seconds=0.5)
    with pytest.raises(ValueError, match="unknown engine 'x'"):
        everyday.everyday(["tower"], peer_names=["x"])


def test_contacts_are_counted_alike():
    """Boxes at rest on one another: eleven pairs and the floor, whoever counts."""
    scene = EVERYDAY["tower"].make(1)
    for peer, settings in (everyday.PEERS["rigidarea"], everyday.PEERS["native_4"]):
        run = get_peer(peer).build(scene, settings)
        run.advance(30)
        assert run.contacts() == 12


def test_who_left_and_who_is_fast():
    """The summary names what fell short, and judges only what is to be judged."""
    base = {
        **{
            "ratio": 1.0,
            "inside": True,
            "rests": True,
            "judged": True,
            "contacts": 10.0,
            "native_contacts": 10,
        },
        **{"speed_left": 1.0, "native_4_speed_left": 2.0},
    }
    rows = [
        {**base, "scene": "good"},
        {**base, "scene": "dear", "ratio": 4.0},
        {**base, "scene": "shown", "ratio": 99.0, "judged": False, "inside": False},
        {**base, "scene": "fast", "ratio": 2.0, "speed_left": 3.0, "contacts": 7.0},
    ]
    found = everyday.summary(rows)
    assert found["scenes"] == ["good", "dear", "fast"]
    assert (found["ratio_median"], found["ratio_worst"]) == (2.0, 4.0)
    assert found["left_the_room"] == ["shown"]
    assert found["faster_than_native_4"] == found["contacts_off"] == ["fast"]


def test_sleep():
    """A small pyramid falls asleep in pymunk's own solver, and then costs less."""
    report = everyday.sleep(rows=3, most_s=10.0, peer_names=["native_4", "box2d"])
    for row in report["results"]:
        assert row["asleep"] == row["bodies"] == 6
        assert row["asleep_after_s"] >= everyday.SLEEP_S
        assert row["frame_ms_asleep"] < row["frame_ms_awake"]


def test_command(tmp_path, capsys):
    """`bench everyday`: settings of ours, JSON alone on standard output, files."""
    parser = argparse.ArgumentParser()
    add_commands(parser.add_subparsers(required=True))
    words = ["bench", "everyday", "tower", "--seeds", "1", "--peer", "rigidarea", "--peer", "native_1"]
    arguments = parser.parse_args(
        [*words, "--set", "steps=2", "--seconds", "2", "--out", str(tmp_path), "--json", "-"]
    )
    assert arguments.run(arguments) == 0
    report = json.loads(capsys.readouterr().out)
    assert report["command"] == "bench everyday"
    assert report["results"][0]["steps_per_frame"] == 2
    assert (tmp_path / "bench-everyday.csv").exists()
    assert (tmp_path / "bench-everyday.png").exists()
    wrong = parser.parse_args([*words, "--set", "steps=many"])
    with pytest.raises(ValueError, match="steps=many"):
        wrong.run(wrong)
