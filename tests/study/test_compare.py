"""The three levels on one scene: rows, exact answers, what the rigid level leaves out."""

import pytest

from rigidarea.study import compare, draw_compare


@pytest.mark.slow
def test_pin_joint_levels(tmp_path):
    """All levels meet the exact period; the rigid one departs by little, and costs least; the picture is drawn."""
    report, traces = compare.compare(["pin_joint"], tmp_path, repeats=1)
    rows = {row["level"]: row for row in report["results"]}
    assert list(rows) == list(compare.LEVELS)
    for row in rows.values():
        # the flexible levels differ from the rigid formula by what the steel gives: 1e-4 of the period
        assert row["error"] < 1e-3
        assert not row["failed"]
    assert rows["modal"]["departure"] == 0
    assert 0 < rows["compliant"]["departure"] < 0.05
    assert rows["rigid"]["cost_s_per_s"] < rows["modal"]["cost_s_per_s"]
    assert {path.suffix for path in draw_compare.levels(report, traces, tmp_path)} == {".png", ".svg"}


@pytest.mark.slow
def test_cantilever_needs_modes(tmp_path):
    """A ball on a rigid beam, or on one without inertia, keeps its speed; a beam with modes keeps some energy."""
    report, traces = compare.compare(["cantilever"], tmp_path, repeats=1)
    levels = traces["cantilever"]["levels"]
    rows = {row["level"]: row for row in report["results"]}
    assert levels["rigid"][1][-1] == pytest.approx(compare.SPEED, rel=1e-3)
    assert levels["compliant"][1][-1] == pytest.approx(compare.SPEED, rel=1e-3)
    assert levels["modal"][1][-1] < 0.6 * compare.SPEED
    assert not any(row["failed"] for row in rows.values())
    # 30 modes at 2 µs against 120 modes at 0.5 µs; the other levels miss the speed by half of it and more
    assert rows["modal"]["error"] < 0.02
    assert rows["compliant"]["error"] > 0.3 and rows["rigid"]["error"] > 0.3
    assert "convergence" not in report  # of all scenes only


def test_unknown_scene():
    """The error lists the known ones."""
    with pytest.raises(ValueError, match="pin_joint"):
        compare.compare(["x"])
