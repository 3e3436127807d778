"""The page's tables: renewed between their markers, everything else kept; numbers and why."""

import json
import math
from pathlib import Path

import pytest

from harness import page
from rigidarea.report import solver
from rigidarea.study import atlas, chart
from rigidarea.study.scene import get_scene, scenes


def report():
    """Two made-up scenes: one in which we lose, one in which nothing of the peer's is out of reach."""
    points = {
        ("rest", "rigidarea"): [(1.0, 1e-2), (10.0, 1e-3)],
        ("rest", "rigidarea-default"): [(2.0, 1e-2)],
        ("rest", "pymunk"): [(0.1, 1e-2), (1.0, 1e-5)],
        ("gears", "rigidarea"): [(1.0, 1e-3)],
        ("gears", "pymunk"): [(10.0, 1e-2)],
    }
    rows = [
        {"scene": s, "peer": p, "settings": {} if "default" in p else {"n": i}, "error": e, "cost_s_per_s": c}
        for (s, p), found in points.items()
        for i, (c, e) in enumerate(found)
    ]
    described = [chart.describe(get_scene(name)) for name in ("rest", "gears")]
    summary = chart.summarise(rows)
    counted = chart.summarise_defaults(summary)
    told = {"results": rows, "summary": summary, "summary_defaults": counted, "scenes": described}
    return {"settings": {"quick": False}, **told}


def test_dominated_lists_only_losses(monkeypatch):
    """With our least error, theirs, the ratio where both reach, and the cause."""
    monkeypatch.setitem(page.CAUSES, "rest", "because")
    table = page.dominated(report()).splitlines()
    assert len(table) == 3  # two lines of head
    assert table[2] == "| box at rest | 1e-3 | 1e-5 | 10 | because |"


def test_ratios_and_known_well():
    """Every scene has a line; a peer's best setting is told."""
    assert "| involute gears, 20 : 30 | `gears` | 0.01 | 0.1 | 0.1 | – |" in page.ratios(report())
    assert "| pymunk | `rest` | one box, persistent contact | 1e-5 | 1 | n 1 |" in page.known_well(report())


def test_defaults():
    """A line a scene that our default was run on, and the count."""
    lines = page.defaults(report()).splitlines()
    # twice our front's cost; pymunk does as well at a twentieth
    assert lines[2] == "| box at rest | 0.01 | 2 | – | – | 20 |"
    assert page.counts(report()).startswith(
        "- pymunk: our whole front is no dearer than its front on 1 of 2 scenes; our default"
    )


def test_everyday():
    """A line a scene: times, the ratio, what is left of the motion."""
    row = {
        **{"title": "a pit", "bodies": 3, "steps_per_frame": 2, "frame_ms_median": 0.2, "native_1_ms": 0.1},
        **{"native_4_ms": 0.4, "box2d_ms": None, "ratio": 2.0, "speed_left": 0.5, "native_4_speed_left": 1.0},
        **{
            "box2d_speed_left": None,
            "contacts": 3.0,
            "native_contacts": 4.0,
            "inside": False,
            "judged": True,
        },
    }
    table = page.everyday({"results": [row]}).splitlines()
    assert table[2] == "| a pit | 3 | 2 | 0.2 | 0.1 | 0.4 | – | 2 | 0.5 | 1 | – | 3 | 4 | no |"


def test_causes_are_of_scenes():
    """No cause for a scene that is not there."""
    assert set(page.CAUSES) <= set(scenes())


@pytest.mark.parametrize(
    "value,text",
    [
        (None, "∞"),
        (math.inf, "∞"),
        (0.0, "0"),
        (0.123, "0.12"),
        (1.5e-5, "2e-5"),
        (156.7, "160"),
        (12345.0, "1e4"),
    ],
)
def test_numbers(value, text):
    """Two digits; powers where they are shorter."""
    assert page.number(value) == text


DOCS = Path(__file__).parents[2] / "docs"


@pytest.mark.parametrize("path", page.pages(DOCS), ids=lambda path: path.stem)
def test_a_page_shows_its_results(path):
    """A page older than its results fails: `make docs` renews it."""
    text = path.read_text()
    assert page.renewed(text, DOCS / "results") == text


def shown() -> dict[str, list[str]]:
    """Of each file of results what pages show of it, as it stands there."""
    found: dict[str, list[str]] = {}
    for path in page.pages(DOCS):
        for mark in page.MARK.finditer(path.read_text()):
            file = mark["what"].split()[0] if mark["name"] == "figure" else page.TABLES[mark["name"]][0]
            found.setdefault(file, []).append(mark["shown"].strip())
    return found


@pytest.mark.parametrize("file", sorted(shown()))
def test_what_is_shown_has_results(file):
    """What has not been measured yet is an empty table."""
    assert (DOCS / "results" / f"{file}.json").exists() or not any(shown()[file])


def test_every_result_is_shown():
    assert {file.stem for file in (DOCS / "results").glob("*.json")} <= set(shown())


def test_made_anew_between_marks_and_nowhere_else(tmp_path):
    """A table, a number in a sentence; what has no results stays; names and places that are not there are refused."""
    docs = tmp_path / "docs"
    docs.mkdir()
    here = docs / "here.md"
    here.write_text(
        "before\n<!-- levels -->\nold\n<!-- /levels -->\n"
        "off by <!-- figure tests a.0 .1e -->x<!-- /figure --> at most <!-- maps -->\nkept<!-- /maps -->"
    )
    rows = [
        {"scene": "tiles", "size": size, "frame_us_mean": 2.0 * size, "native_1_us": 1.0, "start_ms": 500.0}
        for size in (0, 40)
    ]
    picture = tmp_path / "x.png"
    picture.write_bytes(b"1")
    for _ in range(2):
        page.keep(docs, "growth", {"results": rows}, {"y.png": picture})
        page.keep(docs, "tests", {"a": [2.34e-12]})
    text = here.read_text()
    assert "before\n<!-- levels -->\n100 boxes cost 0 µs a frame on one floor and 80 on 40 tiles" in text
    assert "off by <!-- figure tests a.0 .1e -->2.3e-12<!-- /figure --> at most" in text and "\nkept<" in text
    assert (docs / "y.png").read_bytes() == b"1"
    with pytest.raises(KeyError):
        page.renewed("<!-- figure tests b -->1<!-- /figure -->", docs / "results")
    with pytest.raises(ValueError, match="a page shows 'nothing': expected figure or one of"):
        page.renewed("<!-- nothing -->1<!-- /nothing -->", docs / "results")


def test_results_of_another_solver_are_told(tmp_path):
    (tmp_path / "results").mkdir()
    for name, of in (("now", solver()), ("then", "0")):
        (tmp_path / "results" / f"{name}.json").write_text(json.dumps({"versions": {"solver": of}}))
    assert page.older(tmp_path) == ["then"]


def test_maps_table(tmp_path):
    """A line a map, with the share passed by each engine."""
    found = atlas.atlas(tmp_path, quick=True, map_names=["crossed"], peer_names=["pymunk"], workers=0)
    assert "pymunk 6/6" in page.maps({**found, "results": atlas.passed(found["results"])})


def test_what_is_kept_of_a_chart_makes_the_same_tables():
    """Its rows on fronts are enough."""
    whole = report()
    whole["results"] += [{**row, "cost_s_per_s": 3.0 * row["cost_s_per_s"]} for row in whole["results"]]
    kept = page.concise(whole)
    assert len(kept["results"]) < len(whole["results"])
    for made in (page.ratios, page.defaults, page.counts, page.dominated, page.known_well):
        assert made(kept) == made(whole)


def test_levels_and_growth():
    """A line a level, the scene named once; a line a family and size."""
    row = {"scene": "beam", "cost_s_per_s": 2.0, "departure": None, "error": None, "error_name": ""}
    rows = [
        {**row, "level": "rigid"},
        {**row, "level": "modal", "departure": 0.0, "error": 0.01, "error_name": "speed"},
    ]
    assert page.levels_compared({"results": rows}).splitlines()[4:] == [
        "| beam | rigid | – |  | – | 2 |",
        "|  | modal | 0.01 | speed | 0 | 2 |",
    ]
    times = {
        "native_1_us": 1.0,
        "box2d_us": None,
        "frame_us_mean": 2.5,
        "ratio_mean": 2.5,
        "ratio_worst_tenth": 3.0,
    }
    grown = [
        {"scene": "tiles", "size": 1000, "start_ms": 7.0, **times},
        {"scene": "small spaces", "start_ms": 1.0},
    ]
    assert page.growth({"results": grown}).splitlines()[2:] == [
        "| 100 boxes on a level of tiles | 1,000 | 1 | – | 2.5 | 2.5 | 3 | 7 |"
    ]


def test_the_everyday_summary_names_what_is_dear_and_what_still_moves():
    row = {"ratio": 2.0, "speed_left": 0.01, "native_4_ms": 3.0, "frame_ms_median": 2.0}
    row |= {"moving_ms": 6.0, "native_1_moving_ms": 2.0}
    rows = [
        {"scene": "a", "title": "A", **row},
        {"scene": "b", "title": "B", **row, "ratio": 4.0, "speed_left": 7.0},
    ]
    rows.append({"scene": "c", "title": "C", **row, "frame_ms_median": 4.0, "moving_ms": 10.0})
    told = {"faster_than_native_4": ["a", "b"]}
    lines = page.everyday_summary({"results": rows, "summary": told}).splitlines()
    assert lines[0].endswith(
        "in these 3 scenes: the mean frame while they move 3 (the median scene; the worst, C, 5), "
        "the median frame of all 2 (the median scene; the worst, B, 4)."
    )
    assert lines[1] == "- More than pymunk's four steps a frame: C."
    assert lines[2].endswith("in: B (7).")
