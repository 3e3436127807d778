"""The example that learns: it gets better, and the picture of it is drawn."""

import sys
from pathlib import Path

import pytest

pytest.importorskip("cma")
pytest.importorskip("gymnasium")
pytest.importorskip("matplotlib")
sys.path.insert(0, str(Path(__file__).parent.parent / "demos"))

import learn


def test_a_few_generations_get_better_and_the_curve_is_drawn(tmp_path):
    """The first policy does nothing: none of its pegs is in. The same seed learns the same."""
    arguments = ["--generations", "15", "--seconds", "1000"]
    (curve,) = learn.main([*arguments, "--out", str(tmp_path / "curve.png")]).values()
    assert len(curve) == 16 and curve[0][2] == 0
    assert curve[-1][1] > curve[0][1] + 1  # cm nearer
    assert (tmp_path / "curve.png").stat().st_size > 5000
    (again,) = learn.main(arguments).values()
    assert [row[1:] for row in again] == [row[1:] for row in curve]


@pytest.mark.slow
def test_a_minute_is_enough():
    """Most of the pegs find their way into the slot from starts that nobody learned from."""
    (curve,) = learn.main(["--seconds", "60"]).values()
    assert max(success for _, _, success in curve) >= 0.5
