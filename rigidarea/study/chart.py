"""Accuracy against speed: every scene, every peer, every setting; fronts and what they say.

Errors are deterministic and may be computed anywhere, in parallel; the run that gives the error is timed as well.
Settings that another of the same peer beats in error at clearly less than that time cannot be on a front and keep that
time as their cost. All others are timed here, on one core, warm and interleaved. Both are kept as they come
(`chart-errors.jsonl`, `chart-costs.jsonl` in the output folder), so that the same command goes on where it was stopped.

`--quick` (1,200 settings) takes two and a half minutes of processor time; the full chart has 9,800, half of its work in
parallel.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import cache, partial
from pathlib import Path
from typing import Any

from ..report import Progress, envelope
from . import front
from .peers import get_peer, peers, record
from .records import Row, append_rows, read_rows
from .scene import Scene, get_scene, scenes
from .sweep import Task, key, run_tasks
from .timing import Stopwatch, median_times, scene_time

RESOLUTION = 1e-4
"""Errors below it count as equally good, in every scene: a tenth of a pixel on a body drawn 1,000 pixels large, and a
hundredth of what friction, restitution and mass of real bodies are known to.
"""
USELESS = 1.0
"""Errors above it are of runs that do not show the scene's motion at all: a default with such an error fails."""
EVEN = 1.1
"""A cost ratio up to which two engines cost the same, as far as can be measured."""
NOISE = 1.4
"""Ratio of two times measured once that says which is longer."""
TOLD = (
    *("scene", "peer", "matched_error", "cost_ratio_at_matched_error", "cost_ratio_mean", "cost_ratio_worst"),
    *("default_error", "default_cost_ratio", "peer_default_error", "defaults_cost_ratio"),
    "defaults_error_ratio",
)
"""Keys of a summary row that the command prints as a table; the files have all."""
REPEATS, QUICK_REPEATS = 5, 2
PATIENCE_S, QUICK_PATIENCE_S = 0.5, 0.2
"""Time (s) after which a run is not repeated: its noise is small beside it."""


def evaluate(scene: str, peer: str, settings: dict[str, Any]) -> Row:
    """Run one setting and measure its error (null if the run failed): the task of the sweep."""
    described = get_scene(scene)
    warm(scene, peer)
    run = Stopwatch(get_peer(peer).build(described, settings))
    error = described.measure(record(run, described))
    return {
        "error": error if math.isfinite(error) else None,
        "steps_per_frame": run.steps,
        "rough_s_per_s": run.seconds / described.duration,
    }


@cache
def warm(scene: str, peer: str) -> None:
    """Build and step once a process: what is compiled or loaded on first use is not part of a cost."""
    described = get_scene(scene)
    engine = get_peer(peer)
    engine.build(described, engine.settings(described, quick=True)[0]).advance(1)


def jobs(names: Sequence[str], peer_names: Sequence[str], quick: bool) -> list[Task]:
    """Every (scene, peer, settings) that the peers accept, in a fixed order."""
    return [
        {"scene": name, "peer": peer, "settings": dict(settings)}
        for name in names
        for peer in peer_names
        if not get_peer(peer).refuses(get_scene(name))
        for settings in get_peer(peer).settings(get_scene(name), quick)
    ]


def refusals(names: Sequence[str], peer_names: Sequence[str]) -> list[Row]:
    """Which peer cannot do which scene, and why."""
    return [
        {"scene": name, "peer": peer, "why": why}
        for name in names
        for peer in peer_names
        if (why := get_peer(peer).refuses(get_scene(name)))
    ]


def on_front(tasks: Sequence[Task], results: Sequence[Row]) -> list[bool]:
    """Which settings could be on their peer's front: none with as small an error took NOISE times less, and the error
    is at most USELESS. Errors below RESOLUTION count as equal.
    """
    groups: dict[tuple[str, str], list[tuple[float, float]]] = {}
    found = []
    for task, result in zip(tasks, results, strict=True):
        error = math.inf if result["error"] is None else max(result["error"], RESOLUTION)
        found.append((error, result["rough_s_per_s"]))
        groups.setdefault((task["scene"], task["peer"]), []).append(found[-1])
    return [
        error <= USELESS
        and not any(e <= error and NOISE * c < cost for e, c in groups[task["scene"], task["peer"]])
        for task, (error, cost) in zip(tasks, found, strict=True)
    ]


def costs(
    tasks: Sequence[Task], repeats: int, store: Path | None, patience_s: float = PATIENCE_S
) -> list[float]:
    """Time per simulated second of every task, scene by scene, all settings of a scene interleaved."""
    known = {key(row["task"]): row["cost_s_per_s"] for row in read_rows(store)} if store else {}
    missing = [task for task in tasks if key(task) not in known]
    progress = Progress("costs", len(missing))
    for name in dict.fromkeys(task["scene"] for task in missing):
        scene: Scene = get_scene(name)
        here = [task for task in missing if task["scene"] == name]
        timers = [partial(scene_time, scene, task["peer"], task["settings"]) for task in here]
        found = [seconds / scene.duration for seconds in median_times(timers, repeats, patience_s)]
        known.update({key(task): cost for task, cost in zip(here, found, strict=True)})
        if store:
            append_rows(store, [{"task": t, "cost_s_per_s": c} for t, c in zip(here, found, strict=True)])
        progress.step(name, len(here))
    return [known[key(task)] for task in tasks]


def is_default(task: Row) -> bool:
    """Whether a task or row has the settings with which its engine's users find it."""
    default = get_peer(task["peer"]).default(get_scene(task["scene"]))
    return default is not None and dict(default) == task["settings"]


def default_point(rows: Sequence[Row], scene: str, peer: str | None = None) -> front.Point | None:
    """(cost, error) of an engine's default settings on a scene (ours where `peer` is None); None if there is none.

    A run that failed, or whose error is above `USELESS`, has an infinite error.
    """
    for row in rows:
        mine = get_peer(row["peer"]).ours
        if row["scene"] == scene and (row["peer"] == peer or (peer is None and mine)) and is_default(row):
            error = row["error"] if row["error"] is not None and row["error"] <= USELESS else math.inf
            return front.Point(row["cost_s_per_s"], error)
    return None


def points(
    rows: Sequence[Row], scene: str, ours: bool | None = None, peer: str | None = None
) -> list[front.Point]:
    """(cost, error) of a scene's rows: all of ours, or those of one peer."""
    chosen = (
        row
        for row in rows
        if row["scene"] == scene
        and row["error"] is not None
        and (peer is None or row["peer"] == peer)
        and (ours is None or get_peer(row["peer"]).ours == ours)
    )
    return [front.Point(row["cost_s_per_s"], row["error"]) for row in chosen]


def summarise(rows: Sequence[Row]) -> list[Row]:
    """One row a scene and foreign peer: how our front (all our levels together) stands to theirs, and our default."""
    summary = []
    for name in dict.fromkeys(row["scene"] for row in rows):
        scene = get_scene(name)
        mine = points(rows, name, ours=True)
        for peer in dict.fromkeys(row["peer"] for row in rows if row["scene"] == name):
            if not get_peer(peer).ours:
                theirs = points(rows, name, peer=peer)
                found = front.compare(mine, theirs, RESOLUTION)
                ours, usual = default_point(rows, name), default_point(rows, name, peer)
                alone = {} if ours is None else compare_defaults(ours, usual, theirs)
                summary.append(
                    {"scene": name, "peer": peer, "tags": sorted(scene.tags), **found._asdict(), **alone}
                )
    return summary


def compare_defaults(ours: front.Point, usual: front.Point | None, theirs: Sequence[front.Point]) -> Row:
    """Our default beside a peer's whole front, and beside the peer's default.

    `default_cost_ratio`: its cost over the least with which the peer has no larger an error (or, where the peer has
    none so small, its least error): infinite if our default fails. `default_error`, `default_cost_s_per_s`,
    `peer_default_error`, `peer_default_cost_s_per_s`; `defaults_cost_ratio` and `defaults_error_ratio`, ours over
    theirs (errors below RESOLUTION count as equal to it).
    """
    found = {"default_error": ours.error, "default_cost_s_per_s": ours.cost, "default_cost_ratio": math.inf}
    if math.isfinite(ours.error):
        found["default_cost_ratio"] = front.compare([ours], theirs, RESOLUTION).cost_ratio_at_matched_error
    if usual is not None:
        errors = [max(point.error, RESOLUTION) for point in (ours, usual)]
        both_failed = not any(map(math.isfinite, errors))
        found |= {
            "peer_default_error": usual.error,
            "peer_default_cost_s_per_s": usual.cost,
            "defaults_cost_ratio": ours.cost / usual.cost,
            "defaults_error_ratio": math.nan if both_failed else errors[0] / errors[1],
        }
    return found


def summarise_defaults(summary: Sequence[Row]) -> list[Row]:
    """One row a foreign peer: on how many scenes our front, and our default alone, is no dearer than `EVEN` times it.

    `front_even`: our front at the smallest error that both reach. `default_even`: our default against the peer's whole
    front at our default's error. `default_failed`: ours (`peer_default_failed`: theirs) fails or is off by more than
    USELESS. `no_dearer`, `no_worse`, `both`: our default against the peer's default, in cost, error, and both at once.
    """
    rows = []
    for peer in dict.fromkeys(row["peer"] for row in summary):
        here = [row for row in summary if row["peer"] == peer]
        alone = [row for row in here if "default_error" in row]
        beside = [row for row in alone if "peer_default_error" in row]
        cheap = [row["defaults_cost_ratio"] <= EVEN for row in beside]
        # both failing is not to be better, nor to be worse
        good = [not row["defaults_error_ratio"] > 1 for row in beside]
        rows.append(
            {
                "peer": peer,
                "scenes": len(here),
                "front_even": sum(row["cost_ratio_at_matched_error"] <= EVEN for row in here),
                "scenes_default": len(alone),
                "default_even": sum(row["default_cost_ratio"] <= EVEN for row in alone),
                "default_failed": sum(not math.isfinite(row["default_error"]) for row in alone),
                "peer_default_failed": sum(not math.isfinite(row["peer_default_error"]) for row in beside),
                "no_dearer": sum(cheap),
                "no_worse": sum(good),
                "both": sum(c and g for c, g in zip(cheap, good, strict=True)),
            }
        )
    return rows


def chart(
    out: Path,
    quick: bool = False,
    scene_names: Sequence[str] = (),
    peer_names: Sequence[str] = (),
    repeats: int | None = None,
    scheduler: str | None = None,
    workers: int | None = None,
    resume: bool = True,
) -> Row:
    """Sweep, measure, draw; returns the object written to `out`/chart.json.

    scene_names, peer_names: default all. repeats: rounds of timing (default 5, quick 2). scheduler, workers:
    see `sweep.open_executor`. resume: use what an earlier, stopped run left in `out`.
    """
    names = list(scene_names) or list(scenes())
    chosen = list(peer_names) or list(peers())
    tasks = jobs(names, chosen, quick)
    rounds = repeats or (QUICK_REPEATS if quick else REPEATS)
    stores = out / "chart-errors.jsonl", out / "chart-costs.jsonl"
    if not resume:
        for store in stores:
            store.unlink(missing_ok=True)
    results = run_tasks(evaluate, tasks, stores[0], scheduler, workers, title="errors")
    usual = [is_default(task) for task in tasks]
    timed = [keep or default for keep, default in zip(on_front(tasks, results), usual, strict=True)]
    chosen_tasks = [task for task, keep in zip(tasks, timed, strict=True) if keep]
    seconds = iter(costs(chosen_tasks, rounds, stores[1], QUICK_PATIENCE_S if quick else PATIENCE_S))
    rows = []
    for task, result, keep, default in zip(tasks, results, timed, usual, strict=True):
        row = {**task, **result, "error_name": get_scene(task["scene"]).error_name, "default": default}
        rough = row.pop("rough_s_per_s")
        rows.append(
            {**row, "cost_s_per_s": next(seconds) if keep else rough, "repeats": rounds if keep else 1}
        )
    summary = summarise(rows)
    return envelope(
        "chart",
        {"quick": quick, "repeats": rounds, "scenes": names, "peers": chosen},
        rows,
        summary=summary,
        summary_defaults=summarise_defaults(summary),
        refused=refusals(names, chosen),
        scenes=[describe(get_scene(name)) for name in names],
    )


def describe(scene: Scene) -> Row:
    """What a reader of the output has to know of a scene."""
    return {
        "scene": scene.name,
        "title": scene.title,
        "bodies": len(scene.bodies),
        "duration_s": scene.duration,
        "error_name": scene.error_name,
        "source": scene.source,
        "tags": sorted(scene.tags),
    }
