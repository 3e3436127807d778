"""pymunk's examples: the facts hold natively, the judge sees what is wrong, attached runs are compared."""

import copy
import math
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pymunk.examples
import pytest

from harness import command
from harness.examples import (
    EXAMPLES,
    STEPPING,
    by_chance,
    by_hand,
    compare,
    judge,
    run_example,
    typical,
    widened,
)
from harness.facts import cradle_swings, stays_in_scene
from harness.watch import Frame, Watch

pytest.importorskip("pygame")

#: Few seconds each, and between them a window, keys and mouse, none of it, a callback, pyglet.
FAST = ("basic_test", "constraints", "damped_rotary_spring_pointer", "platformer", "using_sprites_pyglet")

#: Does not behave as meant. Whoever mends one takes it out.
BROKEN: set[str] = {
    "arrows",  # both stick, but the second where it is chance whether the first is in its way
}


def test_every_example_of_the_installed_pymunk_is_listed():
    folder = Path(pymunk.examples.__file__).parent
    helpers = {"__init__", "__main__", "shapes_for_draw_demos"}
    assert {path.stem for path in folder.glob("*.py")} - helpers == set(EXAMPLES)


@pytest.mark.parametrize("name", FAST)
def test_facts_hold_natively(name):
    told = run_example(name, "pymunk")
    assert told["error"] is None and told["stderr"] == "" and told["frames"] == 300
    assert told["facts"]
    assert [fact for fact in told["facts"] if not fact["holds"]] == []


@pytest.mark.slow
@pytest.mark.parametrize("name", sorted(set(STEPPING) - set(FAST)))
def test_facts_hold_natively_slow(name):
    test_facts_hold_natively(name)


@pytest.mark.parametrize("name", ["basic_test", "constraints"])
def test_behaves_attached(name):
    row = compare(name)
    assert row["native_wrong"] == [] and row["wrong"] == []
    assert row["step_over_native"] > 0


@pytest.mark.slow
@pytest.mark.parametrize("name", STEPPING)
def test_behaves_attached_slow(name):
    row = compare(name)
    assert row["native_wrong"] == []
    if name in BROKEN and row["wrong"]:
        pytest.xfail("; ".join(row["wrong"])[:300])
    assert row["wrong"] == []


def calm() -> dict:
    return {
        "error": None,
        "stderr": "",
        "facts": [{"name": "stands", "holds": True, "measured": "1"}],
        "finite": True,
        "box": [0, 0, 300, 400],
        "fastest": 400.0,
        "resting": 0.9,
        "joint_error": 0.5,
        "calls": {"begin": 10, "pre_solve": 200, "post_solve": 0, "separate": 10},
    }


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"error": "ValueError: no"}, "ValueError: no"),
        ({"stderr": "x\nAssertionError\n"}, "on standard error: AssertionError"),
        ({"facts": [{"name": "stands", "holds": False, "measured": "0"}]}, "stands: 0"),
        ({"finite": False}, "not finite"),
        ({"box": [0, -600, 300, 400]}, "600 outside the native run's box of 500"),
        ({"fastest": 1000.0}, "fastest body 1000, natively 400"),
        ({"joint_error": 2.5}, "joints off by 2.5, natively 0.5"),
        ({"resting": None}, "nobody of those"),
        ({"resting": 0.7}, "70% at rest, natively 90%"),
        (
            {"calls": {"begin": 10, "pre_solve": 900, "post_solve": 0, "separate": 10}},
            "pre_solve called 900 times",
        ),
        (
            {"calls": {"begin": 10, "pre_solve": 0, "post_solve": 0, "separate": 10}},
            "pre_solve called 0 times",
        ),
    ],
)
def test_the_judge_sees(change, message):
    assert judge(calm(), calm()) == []
    (said,) = judge(calm(), {**copy.deepcopy(calm()), **change})
    assert message in said


def game(holds):
    return {
        "facts": [
            {"name": "thrown", "holds": holds, "measured": "3"},
            {"name": "stays", "holds": True, "measured": "1"},
        ]
    }


def test_a_fact_of_chance_holds_in_more_than_half_of_the_games():
    for run in (game(True), game(False)):
        most, half, none = (
            by_chance(run, [game(i < n) for i in range(8)], ["thrown"])["facts"] for n in (5, 4, 0)
        )
        assert most[0]["holds"] and not half[0]["holds"] and not none[0]["holds"]
        assert "5 of 8" in most[0]["measured"] and half[1] == run["facts"][1]
    died = {"error": "died", "facts": []}
    assert not by_chance(game(True), [game(True)] * 4 + [died] * 4, ["thrown"])["facts"][0]["holds"]


@pytest.mark.parametrize("x", [-1, 11, math.nan])
def test_to_stay_in_a_scene_somebody_has_to_be_there(x):
    facts = stays_in_scene((0, 0), (10, 10))
    assert all(fact.holds for fact in facts(watched([[5, 5]])))
    assert not all(fact.holds for fact in facts(watched([[x, 5]])))
    assert not all(fact.holds for fact in facts(watched([])))
    assert not all(fact.holds for fact in stays_in_scene((0, 0), (10, 10), 2)(watched([[5, 5]])))


def watched(places):
    """A watch of one frame with bodies at these places."""
    state = np.zeros((len(places), 6))
    if places:
        state[:, :2] = places
    numbers = list(range(len(places)))
    return SimpleNamespace(frames=[Frame(np.array(numbers, np.int64), state)], dynamic=lambda: numbers)


def test_a_cradle_whose_first_ball_is_only_drawn_aside_does_not_swing():
    """The first is let go from afar and stays where it has struck; the last swings out: half of what was meant."""
    t = np.arange(60)
    first = np.where(t < 20, 100.0 + 10 * t, 300.0)
    back = np.where(t > 45, 300.0 - 10 * (t - 45), first)
    last = np.where(t > 20, 500.0 + 10 * np.minimum(t - 20, 15), 500.0)

    def facts(path):
        paths = [np.column_stack((t, x, t, t, t, t, t)) for x in (path, last)]
        return cradle_swings(
            SimpleNamespace(dynamic=lambda: [0, 1], path=lambda n: paths[n], joint_errors=[0.1])
        )

    assert [fact.holds for fact in facts(first)] == [True, False, True]
    assert [fact.holds for fact in facts(back)] == [True, True, True]


def test_what_a_judge_forgives():
    own = calm()
    own.update(box=[-100, -100, 400, 500], fastest=600.0, resting=0.81, joint_error=1.5)
    own["calls"] = {"begin": 30, "pre_solve": 390, "post_solve": 20, "separate": 0}
    assert judge(calm(), own) == []


def test_games_of_chance_are_judged_by_what_pymunk_does_with_other_numbers():
    other = {**calm(), "box": [-50, 0, 250, 1300], "fastest": 900.0}
    wide = widened(calm(), [other, {"error": "died", "stderr": "", "facts": []}])
    assert wide == {**calm(), "box": [-50, 0, 300, 1300], "fastest": 900.0}
    own = {**copy.deepcopy(calm()), "box": [0, 0, 300, 1300], "fastest": 1000.0}
    assert len(judge(calm(), own)) == 2 and judge(wide, own) == []
    assert len(judge(wide, {**own, "resting": 0.7})) == 1
    assert widened({"error": "died", "facts": []}, [other]) == {"error": "died", "facts": []}


def test_who_rests_in_a_game_of_chance_is_judged_by_the_median():
    shares = [{"resting": share} for share in (0.7, 0.9, 0.95)] + [{"error": "died"}, {"resting": None}]
    assert typical(calm(), shares) == {**calm(), "resting": 0.9}
    nobody = {**calm(), "resting": None}
    assert typical(nobody, shares) == nobody and typical(calm(), shares[3:]) == calm()


def test_another_hand_is_the_same_user_further_right():
    script = EXAMPLES["playground"].script
    moved = by_hand(script, 3)
    assert by_hand(script, 0) == script and moved[1:] == script[1:]
    assert moved[0] == script[0]._replace(what=(303, 300))


def test_who_has_just_come_is_still_on_the_way():
    """Of two bodies the one that came half a second before the end does not count as one that does not rest."""
    watch = Watch.__new__(Watch)
    calls = dict.fromkeys(("begin", "pre_solve", "post_solve", "separate"), 0)
    watch.host = SimpleNamespace(frame_cpu=[1e-3], frame=300, steps=300, calls=calls)
    watch.bodies = [pymunk.Body(1, 1) for _ in range(2)]
    watch.joint_errors, watch.whole_cpu = [], []
    asleep = [0.0, 0.0, 0.0, 0.0, 15.0, 0.0]  # it keeps the velocity with which it has fallen asleep

    def frames(came):
        return [
            Frame(
                np.array([0, 1][: 1 + (i >= came)]),
                np.array([asleep, [9.0, -5.0 * i, 0.0, 0.0, -300.0, 0.0]][: 1 + (i >= came)]),
            )
            for i in range(300)
        ]

    for came, resting in ((270, 1.0), (160, 1.0), (150, 0.5), (0, 0.5)):
        watch.frames = frames(came)
        assert watch.measures()["resting"] == resting, came


def test_the_page_says_what_is_not_as_meant():
    row = {
        "example": "tower", "steps_time": True, "bodies": 3, "facts": 2, "right": False, "wrong": ["falls | over"],
        "native_wrong": [], "step_ms": 0.5, "step_over_native": 3.0, "frame_ms": 1.0, "frame_over_native": 1.5,
    }  # fmt: skip
    good = {**row, "example": "arrow", "right": True, "wrong": [], "step_over_native": 1.0}
    rows = [row, good]
    asked = {"pymunk": "7", "frames": 300, "games": 8}
    page = command.examples_page({"settings": asked, "results": rows, "summary": command.summary(rows)})
    assert "| tower | 3 | no | 0.50 | 3.00 | 1.50 | falls \\| over |" in page
    assert "1 of the 2 that step a space" in page and "median 2.00, worst 3.00" in page
    assert math.isclose(command.summary([row, good])["step_over_native_median"], 2.0)


def test_unknown_names_are_refused(capsys):
    from rigidarea.__main__ import main

    with pytest.raises(SystemExit):
        main(["compat", "examples", "nope"])
    assert "unknown example 'nope'" in capsys.readouterr().err
