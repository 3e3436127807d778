"""`rigidarea plan`: a scene, a program, and the validation on one scene."""

import json

import pytest

from rigidarea.__main__ import main
from rigidarea.plan import validate

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
    assert text.startswith("plan for 0.01 over 5 s: predicted") and "pile" in text


def test_a_program(tmp_path, capsys):
    script = tmp_path / "game.py"
    script.write_text(PROGRAM)
    assert main(["plan", str(script), "--tolerance", "0.001", "--json", "-"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert told["command"] == "plan" and told["results"]["reachable"]
    assert told["results"]["lines"][0]["what"] == "space"


def test_what_makes_no_sense(tmp_path, capsys):
    empty = tmp_path / "empty.py"
    empty.write_text("")
    for words, message in (
        (["plan"], "expected one scene or program"),
        (["plan", "nothing"], "unknown scene 'nothing'"),
        (["plan", str(tmp_path / "none.py")], "which is none"),
        (["plan", str(empty)], "nothing to plan"),
        (["plan", "stack", "--tolerance", "-1"], "tolerance"),
    ):
        with pytest.raises(SystemExit) as end:
            main(words)
        assert end.value.code == 2
        assert message in capsys.readouterr().err


def test_a_scene_is_built_as_a_space_and_nothing_else():
    """A plan gets a space: the scene's name is not in it, and curves know how to be sampled."""
    from rigidarea.study.scene import get_scene

    space, bodies = validate.space_of(get_scene("bowl_slide"))
    assert len(bodies) == 2 and space.gravity == (0, -9.81)
    (bowl,) = (shape for shape in space.shapes if hasattr(shape, "outline"))
    assert len(bowl.outline.sample(1e-6).rings[0]) > 3 * len(bowl.outline.rings[0])


def test_variations_are_seeded_and_differ():
    from rigidarea.study.scene import get_scene

    scene = get_scene("bounce")
    one, again, other = validate.vary(scene, 1), validate.vary(scene, 1), validate.vary(scene, 2)
    assert one.bodies == again.bodies and one.bodies != other.bodies
    for seed in range(20):
        varied = validate.vary(scene, seed)
        (ball,) = (body for body in varied.bodies if body.kind == "dynamic")
        assert 0.3 * 0.999 <= ball.mass <= 3.0 * 1.001 and 0.0 <= varied.elasticity <= 1.0


@pytest.mark.slow
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
