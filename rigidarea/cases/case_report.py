"""What the cases share: the JSON object of a case, kept on disk while it grows, its clocks, the look of its figures."""

from __future__ import annotations

import sys
import time
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rigidarea.report import envelope, write_json

Array = NDArray[np.float64]

# Okabe–Ito, safe for colour-blind readers
BLACK, ORANGE, SKY, GREEN = "#000000", "#E69F00", "#56B4E9", "#009E73"
YELLOW, BLUE, RED, PURPLE = "#F0E442", "#0072B2", "#D55E00", "#CC79A7"

#: A legend that lies over what is drawn.
FRAMED: dict[str, Any] = {"frameon": True, "framealpha": 0.9, "edgecolor": "none"}


def say(text: str) -> None:
    """Progress, on standard error (standard output may be JSON)."""
    print(text, file=sys.stderr, flush=True)


class Case:
    """One run of a case. What ``keep`` is given is at once on disk, in ``out``/NAME.json (None: nowhere).

    An interrupted run so leaves valid JSON of all that was computed until then, ``complete`` false.
    """

    def __init__(
        self, name: str, settings: Mapping[str, Any], paper: Any, simulated_s: float, out: Path | None
    ) -> None:
        self.name, self.settings, self.paper, self.simulated_s = name, settings, paper, simulated_s
        self.out = out
        self.start, self.setup_s = time.perf_counter(), 0.0
        self.results: Any = {}
        """A mapping, or, put there at once, rows."""

    def set_up(self) -> None:
        """Set-up ends now."""
        self.setup_s = time.perf_counter() - self.start

    def keep(self, **parts: Any) -> None:
        """Adds results, or replaces those of the same name, and writes the file."""
        self.results |= parts
        self._write(False)

    def grow(self, into: dict[str, Any], name: str, rows: Iterable[Any]) -> None:
        """Puts rows into results, or a part of them, one after the other as they come, and writes the file."""
        into[name] = []
        for row in rows:
            into[name].append(row)
            self._write(False)

    def finish(self) -> dict[str, Any]:
        """The JSON object, complete."""
        return self._write(True)

    def _write(self, complete: bool) -> dict[str, Any]:
        told = envelope(
            f"case {self.name}",
            self.settings,
            self.results,
            paper=self.paper,
            wall_s=time.perf_counter() - self.start,
            setup_s=self.setup_s,
            simulated_s=self.simulated_s,
            complete=complete,
        )
        if self.out is not None:
            write_json(told, self.out / f"{self.name}.json")
        return told


def figure(
    width: float = 7.0, height: float = 4.2, rows: int = 1, columns: int = 1, **keys: Any
) -> tuple[Any, Any]:
    """A matplotlib figure and its axes, drawn without a display."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    plt.rcParams.update(
        {
            "axes.grid": True,
            "grid.alpha": 0.3,
            "axes.spines.top": False,
            "axes.spines.right": False,
            "font.size": 10,
            "legend.frameon": False,
        }
    )
    return plt.subplots(rows, columns, figsize=(width, height), layout="constrained", **keys)


def save(fig: Any, out: Path, name: str) -> None:
    """Writes ``name``.png into ``out`` at 150 dots an inch and closes the figure."""
    import matplotlib.pyplot as plt

    out.mkdir(parents=True, exist_ok=True)
    fig.savefig(out / f"{name}.png", dpi=150)
    plt.close(fig)
