"""The page's tables: renewed between their markers, everything else kept; numbers and why."""

import json
import math
import re
from pathlib import Path

import pytest

from rigidarea.study import atlas, chart, page
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
    return {"results": rows, "summary": summary, "summary_defaults": counted, "scenes": described}


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
    assert lines[4].startswith(
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


@pytest.mark.parametrize(
    "name, table, made",
    [("study.md", "everyday", page.everyday), ("../README.md", "moving", page.moving)],
)
def test_tables_are_those_of_their_results(name, table, made):
    """A page older than its results fails: `python -m rigidarea bench everyday --docs docs`."""
    docs = Path(__file__).parents[2] / "docs"
    report = json.loads((docs / "results" / f"{RESULTS[table]}.json").read_text())
    text = (docs / name).read_text()
    (shown,) = re.findall(f"<!-- {table} -->\n(.*?)<!-- /{table} -->", text, re.DOTALL)
    assert shown == made(report)


RESULTS = {"everyday": "everyday", "moving": "everyday"}


def test_renewed_between_markers(tmp_path):
    """Tables replaced, text kept, pictures copied; a page without a place for a table says so."""
    (tmp_path / "study.md").write_text("before\n<!-- a -->\nold\n<!-- /a -->\nafter\n")
    picture = tmp_path / "x.png"
    picture.write_bytes(b"1")
    docs = tmp_path
    for _ in range(2):
        page.renew(docs, {"a": "new\\1\n"}, {"y.png": picture})
    assert (docs / "study.md").read_text() == "before\n<!-- a -->\nnew\\1\n<!-- /a -->\nafter\n"
    assert (docs / "y.png").read_bytes() == b"1"
    with pytest.raises(ValueError, match="'b'"):
        page.renew(docs, {"b": ""}, {})


def test_page_has_a_place_for_every_table():
    """The page in docs/ takes what the commands write."""
    from pathlib import Path

    text = (Path(__file__).parents[2] / "docs" / "study.md").read_text()
    for name in ("ratios", "defaults", "dominated", "known_well", "maps", "everyday"):
        assert f"<!-- {name} -->" in text


def test_maps_table(tmp_path):
    """A line a map, with the share passed by each engine."""
    found = atlas.atlas(tmp_path, quick=True, map_names=["crossed"], peer_names=["pymunk"], workers=0)
    assert "pymunk 6/6" in page.maps(found)
