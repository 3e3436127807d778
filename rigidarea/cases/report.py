"""What the cases share: the JSON object of a case, its clocks, and the look of its figures."""

from __future__ import annotations

import platform
import sys
import time
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

# Okabe–Ito, safe for colour-blind readers
BLACK, ORANGE, SKY, GREEN, YELLOW, BLUE, RED, PURPLE = (
    "#000000",
    "#E69F00",
    "#56B4E9",
    "#009E73",
    "#F0E442",
    "#0072B2",
    "#D55E00",
    "#CC79A7",
)


class Clock:
    """Wall time since construction; ``setup`` marks the end of the set-up."""

    def __init__(self) -> None:
        self.start = time.perf_counter()
        self.setup_s = 0.0

    def setup(self) -> None:
        """Set-up ends now."""
        self.setup_s = self.wall()

    def wall(self) -> float:
        """Seconds since construction."""
        return time.perf_counter() - self.start


def say(text: str) -> None:
    """Progress, on standard error (standard output may be JSON)."""
    print(text, file=sys.stderr, flush=True)


def versions() -> dict[str, str]:
    """Versions of what computes the figures."""
    out = {"python": platform.python_version()}
    for name in ("rigidarea", "numpy", "numba", "scipy", "shapely", "pymunk", "matplotlib"):
        try:
            out[name] = version(name)
        except PackageNotFoundError:
            continue
    return out


def result(
    name: str, settings: dict[str, Any], results: Any, paper: Any, clock: Clock, simulated_s: float
) -> dict[str, Any]:
    """The JSON object of a case (design 7)."""
    return {
        "command": f"case {name}",
        "settings": settings,
        "versions": versions(),
        "machine": {"platform": platform.platform(), "processor": platform.machine()},
        "results": results,
        "paper": paper,
        "wall_s": clock.wall(),
        "setup_s": clock.setup_s,
        "simulated_s": simulated_s,
    }


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


def save(fig: Any, out: Path | None, name: str) -> None:
    """Writes ``name``.png into ``out`` (nothing if None) at 150 dots an inch and closes the figure."""
    import matplotlib.pyplot as plt

    if out is not None:
        out.mkdir(parents=True, exist_ok=True)
        fig.savefig(out / f"{name}.png", dpi=150)
    plt.close(fig)
