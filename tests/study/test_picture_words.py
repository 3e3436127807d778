"""The pictures of the pages say what their axes, marks and lines are."""

import json
from pathlib import Path

import pytest

from rigidarea.study import draw, draw_bench

pytest.importorskip("matplotlib")
RESULTS = Path(__file__).parents[2] / "docs" / "results"


def words(module, make, name, monkeypatch) -> set[str]:
    """All texts of the picture that the kept results make."""
    from matplotlib.text import Text

    figures = []
    monkeypatch.setattr(module, "save", lambda figure, out, name: figures.append(figure) or [])
    make(json.loads((RESULTS / f"{name}.json").read_text()), Path())
    found = {text.get_text() for text in figures[0].findobj(Text)}
    draw.pyplot().close(figures[0])
    return found


@pytest.mark.parametrize(
    ("module", "make", "name", "said"),
    [
        (draw_bench, draw_bench.growth, "growth", "how many: pieces of level"),
        (draw_bench, draw_bench.growth, "growth", "radius 0: lines without thickness"),
        (draw_bench, draw_bench.everyday_times, "everyday", "* shown, not counted in the summary"),
        (draw, draw.chart_summary, "chart", "beyond the edge"),
        (draw, draw.chart_defaults, "chart", "beyond the edge"),
    ],
)
def test_it_says(module, make, name, said, monkeypatch):
    assert any(said in text for text in words(module, make, name, monkeypatch))
