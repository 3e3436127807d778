"""The chart, the benchmarks and their commands: rows with the promised keys, resumed, drawn."""

import argparse
import json
import subprocess
import sys

import numpy as np
import pytest

from rigidarea import backend
from rigidarea.study import add_commands, bench, chart, draw
from rigidarea.study.crowds import CROWDS
from rigidarea.study.peers import get_peer, peers, record
from rigidarea.study.scene import get_scene, scenes


@pytest.fixture(scope="module")
def charted(tmp_path_factory):
    """A chart of two scenes and two peers."""
    out = tmp_path_factory.mktemp("chart")
    names = ["rest", "bowl_slide"]
    report = chart.chart(
        out, quick=True, scene_names=names, peer_names=["rigidarea", "pymunk"], repeats=1, workers=0
    )
    return out, report


def test_chart_rows(charted):
    """The keys of its JSON, one row a setting, and a summary row a scene and foreign peer."""
    _, report = charted
    wanted = {"scene", "peer", "settings", "error", "error_name", "cost_s_per_s"}
    assert wanted <= set(report["results"][0])
    assert len(report["results"]) == len(chart.jobs(["rest", "bowl_slide"], ["rigidarea", "pymunk"], True))
    assert [(row["scene"], row["peer"]) for row in report["summary"]] == [
        ("rest", "pymunk"),
        ("bowl_slide", "pymunk"),
    ]
    assert {"cost_ratio_at_matched_error", "error_ratio_at_matched_cost"} <= set(report["summary"][0])
    assert {"command", "settings", "versions", "machine", "results"} <= set(report)
    assert all(row["cost_s_per_s"] > 0 for row in report["results"])


def test_chart_resumes_with_the_same_numbers(charted):
    """A second call measures nothing anew; errors computed afresh are the same to the last bit."""
    out, report = charted
    names = ["rest", "bowl_slide"]
    again = chart.chart(
        out, quick=True, scene_names=names, peer_names=["rigidarea", "pymunk"], repeats=1, workers=0
    )
    assert again["results"] == report["results"]
    row = report["results"][-1]
    assert chart.evaluate(row["scene"], row["peer"], row["settings"])["error"] == row["error"]


def test_chart_is_drawn(charted, tmp_path):
    """One page of panels and a summary, as PNG of 1000 pixels width and SVG."""
    from PIL import Image

    _, report = charted
    paths = draw.chart_pages(report, tmp_path) + draw.chart_summary(report, tmp_path)
    assert {path.name for path in paths} == {
        "chart-1.png",
        "chart-1.svg",
        "chart-summary.png",
        "chart-summary.svg",
    }
    for path in paths:
        if path.suffix == ".png":
            assert Image.open(path).width == 1000


def test_only_fronts_are_timed():
    """A setting no more exact at clearly more than another's time is not timed; noise and failures are told apart."""
    tasks = [{"scene": "s", "peer": p, "settings": {"n": n}} for p in ("a", "b") for n in range(5)]
    errors = [1e-2, 1e-2, 1e-2, None, 1e-6, 1e-7, 1e-9, 1e-2, 2.0, 1e-3]
    times = [1.0, 1.1, 2.0, 0.1, 5.0, 1.0, 2.0, 0.5, 0.1, 0.8]
    results = [{"error": e, "rough_s_per_s": t} for e, t in zip(errors, times)]
    # a: as good as the best within the noise, too slow, failed, the most exact;
    # b: both below the resolution, so the slower goes; worse but cheaper; worse than standing still
    assert chart.on_front(tasks, results) == [True, True, False, False, True, True, False, True, False, True]


def made_up(points):
    """Rows of scenes from (scene, peer, settings, cost, error)."""
    return [
        {"scene": s, "peer": p, "settings": settings, "cost_s_per_s": cost, "error": error}
        for s, p, settings, cost, error in points
    ]


USUAL = {"steps": 1, "iterations": 10, "slop": 1e-3}


def test_default_beside_front_and_default():
    """Our default is matched with the cheapest of the peer's that is as good, and with the peer's own default."""
    rows = made_up(
        [
            ("rest", "rigidarea-default", {}, 2.0, 1e-3),
            ("rest", "rigidarea", {"steps": 1}, 0.5, 1e-3),
            ("rest", "pymunk", USUAL, 1.0, 1e-2),
            ("rest", "pymunk", {**USUAL, "steps": 4}, 4.0, 1e-4),
            ("rest", "pymunk", {**USUAL, "steps": 16}, 16.0, 1e-6),
            ("stack", "rigidarea-default", {}, 1.0, 1e-7),
            ("stack", "pymunk", USUAL, 1.0, 1e-6),
            ("arch", "rigidarea-default", {}, 1.0, 8.0),
            ("arch", "pymunk", USUAL, 2.0, None),
            ("gears", "rigidarea", {"steps": 1}, 1.0, 1e-3),
            ("gears", "pymunk", {**USUAL, "sampling": 1e-3}, 2.0, 1e-3),
        ]
    )
    rest, stack, fallen, none = chart.summarise(rows)
    assert rest["cost_ratio_at_matched_error"] == 0.5 / 4  # the front, with all of our settings
    assert rest["default_cost_ratio"] == 2.0 / 4
    assert (rest["defaults_cost_ratio"], rest["defaults_error_ratio"]) == (2.0, pytest.approx(0.1))
    assert (stack["default_cost_ratio"], stack["defaults_error_ratio"]) == (
        1.0,
        1.0,
    )  # both below the resolution
    assert fallen["default_error"] == fallen["peer_default_error"] == np.inf
    assert fallen["default_cost_ratio"] == np.inf and np.isnan(fallen["defaults_error_ratio"])
    assert "default_error" not in none  # ours was not run
    counted = chart.summarise_defaults([rest, stack, fallen, none])[0]
    assert counted == {
        **{"peer": "pymunk", "scenes": 4, "front_even": 3, "scenes_default": 3, "default_even": 2},
        **{"default_failed": 1, "peer_default_failed": 1, "no_dearer": 2, "no_worse": 3, "both": 2},
    }


@pytest.mark.parametrize("quick", [True, False])
def test_defaults_are_among_the_settings(quick):
    """What counts as an engine's default is swept, in every scene, once."""
    for scene in scenes().values():
        for peer in peers().values():
            default = peer.default(scene)
            if default is not None:
                assert peer.settings(scene, quick).count(dict(default)) == 1, (scene.name, peer.name)


def test_defaults_are_timed_and_drawn(charted, tmp_path):
    """pymunk's default in its row, timed like a front's point though no front has it, and in the pictures."""
    _, report = charted
    usual = [row for row in report["results"] if row["default"]]
    assert [(row["scene"], row["peer"]) for row in usual] == [("rest", "pymunk"), ("bowl_slide", "pymunk")]
    assert all(row["repeats"] == report["settings"]["repeats"] for row in usual)
    assert draw.chart_defaults(report, tmp_path) == []  # ours is not among these two engines
    rows = made_up([("rest", "rigidarea-default", {}, 2.0, 1e-3), ("rest", "pymunk", USUAL, 1.0, None)])
    described = [chart.describe(get_scene("rest"))]
    drawn = draw.chart_defaults({"summary": chart.summarise(rows), "scenes": described}, tmp_path)
    assert all(path.exists() for path in drawn) and len(drawn) == 2


def test_smaller_steps_cost_more(charted):
    """pymunk with sixteen times the steps costs more than twice as much: what is timed is the stepping."""
    _, report = charted
    rows = [r for r in report["results"] if r["peer"] == "pymunk" and r["scene"] == "rest"]
    assert {row["repeats"] for row in report["results"]} <= {1, report["settings"]["repeats"]}
    cost = {row["settings"]["steps"]: row["cost_s_per_s"] for row in rows}
    assert cost[64] > 2 * cost[4]


@pytest.mark.parametrize("name", list(CROWDS))
def test_crowds(name):
    """About as many bodies as asked; an engine that does them well has a small error; a gas keeps its
    energy.
    """
    scene = CROWDS[name](30)
    bodies = sum(body.kind == "dynamic" for body in scene.bodies)
    assert bodies == pytest.approx(30, rel=0.1)
    settings = {"steps": 16, "iterations": 30, "slop": 1e-3}
    # stacks sink by a few slops, elastic impulses keep the energy but for discs caught in two contacts at
    # once
    assert scene.measure(record(get_peer("pymunk").build(scene, settings), scene)) < 0.02


def test_bench_frames():
    """The keys of its JSON; growth is fitted over the sizes."""
    report = bench.frames(["towers"], (10, 20), ["pymunk", "rigidarea"])
    wanted = {
        "scene",
        "bodies",
        "peer",
        "steps_per_frame",
        "frame_ms_median",
        "frame_ms_p99",
        "error",
        "error_name",
    }
    assert wanted <= set(report["results"][0])
    assert {row["bodies"] for row in report["results"]} == {10, 20}
    assert len(report["growth"]) == 4
    assert report["call_overhead_us"]["pymunk"] > 0
    with pytest.raises(ValueError, match="unknown scene 'x'"):
        bench.frames(["x"])


def test_growth_is_a_slope():
    """Doubling with every doubling is the exponent 1, fourfold 2."""
    rows = [
        {"scene": s, "peer": "p", "settings": {}, "bodies": n, "frame_ms_median": n**k}
        for s, k in (("a", 1), ("b", 2))
        for n in (10, 100, 1000)
    ]
    assert [row["exponent"] for row in bench.growth(rows)] == pytest.approx([1, 2])


def test_bench_kernels():
    """Areas agree with shapely to rounding; the keys of its JSON. Where there is a library it says that it compiles."""
    if backend() == "library":
        with pytest.raises(ValueError, match="RIGIDAREA_BACKEND=compiled"):
            bench.kernels(["boxes"], repeats=1)
        return
    report = bench.kernels(["boxes", "gears"], repeats=1)
    for row in report["results"]:
        assert {"pair", "points_a", "points_b", "query_us", "call_us", "shapely_us"} <= set(row)
        assert row["area_error"] < 1e-9  # cancellation: areas of 1e-5 from coordinates of 1
        assert row["query_us"] > 0


def test_commands_are_light():
    """Adding the commands imports neither numba nor matplotlib: `--help` answers at once."""
    code = (
        "import sys, argparse, rigidarea.study.cli as c; "
        "s = argparse.ArgumentParser().add_subparsers(); c.add_commands(s); "
        "print(sorted(m for m in ('matplotlib', 'pyb2d3', 'distributed') if m in sys.modules))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_json_on_standard_output(tmp_path, capsys):
    """`--json -` prints JSON and nothing else there."""
    parser = argparse.ArgumentParser()
    add_commands(parser.add_subparsers(required=True))
    arguments = parser.parse_args(
        ["chart", "--quick", "--scene", "rest", "--peer", "pymunk", "--workers", "0", "--repeats", "1"]
        + ["--out", str(tmp_path), "--json", "-"]
    )
    assert arguments.run(arguments) == 0
    report = json.loads(capsys.readouterr().out)
    assert report["command"] == "chart"
    assert np.isfinite([row["error"] for row in report["results"]]).all()
    assert (tmp_path / "chart.csv").exists()
    assert (tmp_path / "chart-1.png").exists()
