"""`rigidarea plan`: a scene, a program, and the validation on one scene."""

import json

import pymunk
import pytest

from commands import command
from harness import trial, validate, variations
from rigidarea.__main__ import main

PROGRAM = """
import pymunk
space = pymunk.Space()
space.gravity = 0, -900
body = pymunk.Body(1, 100)
body.position = 0, 10
space.add(body, pymunk.Poly.create_box(body, (20, 20)), pymunk.Segment(space.static_body, (-500, 0), (500, 0), 0))
for _ in range(10):
    space.step(1 / 120)
raise SystemExit("not reached: a plan ends before the first step")
"""


def test_a_scene(capsys):
    assert main(["plan", "stack", "--tolerance", "0.01"]) == 0
    text = capsys.readouterr().out
    assert text.startswith("plan for 0.01 over 5 s: off by") and "tried out: " in text


def test_a_program(tmp_path):
    script = tmp_path / "game.py"
    script.write_text(PROGRAM)
    done = command(tmp_path, "plan", str(script), "--tolerance", "0.001", "--json", "-")
    assert done.returncode == 0, done.stderr
    told = json.loads(done.stdout)
    assert told["command"] == "plan" and told["results"]["reachable"]
    assert told["results"]["lines"][0]["what"] == "space"
    script.write_text("")
    done = command(tmp_path, "plan", str(script))
    assert done.returncode == 2 and "nothing to plan" in done.stderr


def test_what_makes_no_sense(tmp_path, capsys):
    for words, message in (
        (["plan"], "expected one scene or program"),
        (["plan", "nothing"], "unknown scene 'nothing'"),
        (["plan", str(tmp_path / "none.py")], "which is none"),
        (["plan", "stack", "--tolerance", "-1"], "tolerance"),
    ):
        with pytest.raises(SystemExit) as end:
            main(words)
        assert end.value.code == 2
        assert message in capsys.readouterr().err


def test_a_scene_is_built_as_a_space_and_nothing_else():
    """A plan gets a space: the scene's name is not in it, and curves know how to be sampled."""
    from rigidarea.study.scene import get_scene

    space, bodies = trial.space_of(get_scene("bowl_slide"))
    assert len(bodies) == 2 and space.gravity == (0, -9.81)
    (bowl,) = (shape for shape in space.shapes if hasattr(shape, "outline"))
    assert len(bowl.outline.sample(1e-6).rings[0]) > 3 * len(bowl.outline.rings[0])


def test_variations_are_seeded_and_differ():
    from rigidarea.study.scene import get_scene

    scene = get_scene("bounce")
    one, again, other = variations.vary(scene, 1), variations.vary(scene, 1), variations.vary(scene, 2)
    assert one.bodies == again.bodies and one.bodies != other.bodies
    for seed in range(20):
        varied = variations.vary(scene, seed)
        (ball,) = (body for body in varied.bodies if body.kind == "dynamic")
        assert 0.3 * 0.999 <= ball.mass <= 3.0 * 1.001 and 0.0 <= varied.elasticity <= 1.0


@pytest.mark.slow
def test_a_varied_outline_keeps_its_arcs():
    """The Geneva drive made larger: the same outlines, scaled, arcs and all."""
    from rigidarea.study.scene import get_scene

    scene = get_scene("geneva")
    varied = variations.vary(scene, 3)
    factor = varied.size / scene.size
    assert factor != 1.0
    for one, other in zip(trial.space_of(scene)[0].shapes, trial.space_of(varied)[0].shapes):
        if isinstance(one, pymunk.Circle):
            assert other.radius == pytest.approx(factor * one.radius)
            continue
        assert len(other.outline.arcs) == len(one.outline.arcs) > 0
        assert other.outline.area == pytest.approx(factor**2 * one.outline.area)
        assert other.outline.bounds == pytest.approx([factor * value for value in one.outline.bounds])


def test_validate_one_scene(tmp_path, capsys):
    words = ["plan", "bounce", "--validate", "--variations", "0", "--out", str(tmp_path), "--json", "-"]
    assert main(words) == 0
    told = json.loads(capsys.readouterr().out)
    assert set(told["results"]) == {
        "within_tolerance_percent", "cost_ratio_median", "cost_ratio_worst", "plan_ms_1000_bodies",
    }  # fmt: skip
    assert len(told["rows"]) == 3 and all(row["reachable"] for row in told["rows"])
    assert (tmp_path / "plan.png").stat().st_size > 10_000
    kept = (tmp_path / "plan-sweep.jsonl").read_text()
    assert main(words) == 0
    assert (tmp_path / "plan-sweep.jsonl").read_text() == kept  # nothing is swept twice


def test_the_page_runs():
    import re
    from pathlib import Path

    page = (Path(__file__).parents[2] / "docs" / "plan.md").read_text()
    (block,) = re.findall(r"^```python\n(.*?)^```", page, re.MULTILINE | re.DOTALL)
    names: dict = {}
    exec(compile(block, "docs/plan.md", "exec"), names)
    assert names["plan"].steps == 4 and "yours" in str(names["plan"])
    found = names["watch"].indicators["penetration"]
    assert 0 < found.measured <= 3 * found.predicted


def test_tables_and_picture_of_the_page(tmp_path):
    from harness import plan_picture
    from harness.page import keep

    rows = [
        {
            "scene": "one", "varied": False, "tolerance": tolerance, "verdict": verdict, "error": error,
            "predicted_error": 0.5 * tolerance, "decided_by": "corner", "level": "rigid", "steps": 2, "sweeps": 10,
            "penetration": 1e-5, "cost_ratio": ratio, "cheapest": "rigid 1 x 5", "reachable": True,
        }
        for tolerance, verdict, error, ratio in ((0.1, "within", 0.05, 1.5), (0.01, "outside", 0.02, None))
    ]  # fmt: skip
    told = {
        "rows": rows,
        "summary": {
            "scenes": validate.summary(rows),
            "variations": validate.summary([]),
            "unseen": validate.summary([]),
        },
    }
    told["summary"]["by_tolerance"] = {
        str(t): validate.summary([r for r in rows if r["tolerance"] == t]) for t in (0.1, 0.01)
    }
    assert told["summary"]["scenes"]["within_tolerance_percent"] == 50.0
    assert told["summary"]["scenes"]["cost_ratio_worst"] == 1.5
    shown = plan_picture.costs_and_errors(rows, tmp_path / "plan.png")
    docs = tmp_path / "docs"
    docs.mkdir()
    (docs / "plan.md").write_text(
        "".join(f"<!-- {n} -->\n<!-- /{n} -->\n" for n in ("plan_summary", "plan_outside"))
    )
    keep(docs, "plan", told, {"plan.png": shown})
    page = (docs / "plan.md").read_text()
    assert "| one | 1 % | 0.02 | 5e-3 | corner |" in page and "50 %" in page
