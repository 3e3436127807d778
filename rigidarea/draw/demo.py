"""The command `demo`: scenes rendered to files, measured, and told as a table or as JSON."""

from __future__ import annotations

import argparse
import contextlib
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from ..gallery import ENGINES, NAMES, Run, load
from ..report import Progress, align, at_least_one, envelope, output_arguments, write_json


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The arguments of `rigidarea demo`."""
    add = parser.add_argument
    add(
        "name",
        nargs="?",
        default="all",
        choices=(*NAMES, "all"),
        metavar="NAME",
        help=f"one of {', '.join(NAMES)}, or all (default)",
    )
    add(
        "--engine", choices=ENGINES, default="area", help="area contact (default), or Chipmunk's own response"
    )
    add("--frames", type=at_least_one, metavar="N", help="frames of each scene (default: as the scene says)")
    add("--window", action="store_true", help="open a window instead: drag bodies, space pauses, Esc closes")
    add("--no-film", action="store_true", help="stills only")
    output_arguments(parser, Path("out") / "gallery")


def run(arguments: argparse.Namespace) -> int:
    """Run `rigidarea demo`: pictures, table, JSON."""
    names = NAMES if arguments.name == "all" else (arguments.name,)
    if arguments.window:
        from .window import show

        for name in names:
            show(Run(load(name), arguments.engine), arguments.frames)
        return 0
    rows = []
    for i, name in enumerate(names):
        ready = Run(load(name), arguments.engine)
        frames = arguments.frames or ready.scene.frames
        progress = Progress(f"[{i + 1}/{len(names)}] {name}", frames)
        rows.append(
            render(ready, arguments.out, frames=frames, film=not arguments.no_film, say=progress.step)
        )
    settings = {name: getattr(arguments, name) for name in ("name", "engine", "frames", "out")}
    write_json(envelope("demo", settings, rows), arguments.json)
    if arguments.json != "-":
        print(table(rows))
        print(f"\nPictures: {arguments.out}/")
    return 0


def render(
    run: Run,
    out: Path,
    *,
    frames: int | None = None,
    film: bool = True,
    say: Callable[[], None] | None = None,
) -> dict[str, Any]:
    """Step a run to its end, drawing as it goes; returns its row, the files' names in it.

    Writes `<name>.png` and `<name>.mp4` (or .gif) into `out`; pictures are taken so that the film plays at the
    scene's pace, 60 frames a second.
    """
    from .film import FPS, Film, save_png
    from .picture import Picture

    scene = run.scene
    name = scene.name if run.engine == "area" else f"{scene.name}-{run.engine}"
    count = frames or scene.frames
    still = max(1, min(count, round(scene.still * count)))
    picture = Picture(run)
    files = {}
    with contextlib.ExitStack() as stack:
        movie = stack.enter_context(Film(out / name)) if film else None
        for i in range(1, count + 1):
            run.advance()
            wanted = movie is not None and i % (60 // FPS) == 0
            if wanted or i == still:
                surface = picture.draw()
                if movie is not None and wanted:
                    movie.add(surface)
                if i == still:
                    files["still"] = str(save_png(surface, out / f"{name}.png"))
            if say is not None:
                say()
    if movie is not None:
        files["film"] = str(movie.path)
    return {**run.row(), **files}


def table(rows: list[dict[str, Any]]) -> str:
    """The rows as text."""
    head = "scene,bodies,steps,median ms,p99 ms,worst ms,x real time,energy drift,,,exact"
    lines: list[Sequence[str]] = [head.split(",")]
    for row in rows:
        drift, exact = row["energy_drift_relative"], row["headline_exact"]
        lines.append(
            (
                row["scene"],
                str(row["bodies"]),
                f"{row['steps_per_frame']:.0f}",
                f"{row['frame_ms_median']:.3g}",
                f"{row['frame_ms_p99']:.3g}",
                f"{row['frame_ms_worst']:.3g}",
                f"{row['real_time_factor']:.3g}",
                "driven" if drift is None else f"{drift:.1e}",
                row["headline_name"],
                f"{row['headline']:.6g}",
                "" if exact is None else f"{exact:.6g}",
            )
        )
    return "\n".join(align(lines, left=(0, 8)))
