"""Where methods fail: maps over two knobs, pass or fail and how, by a measured quantity, with theory's
boundary.

A map is a module of `rigidarea.study.maps` with a function `atlas_map()`. Each point is one small run, a
task of a sweep, and independent of all others.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from ..report import envelope
from .peers import get_peer, record
from .records import Row
from .scene import Array, Scene, Trace, check_known, registered
from .sweep import run_tasks

PASS = "pass"


@dataclass(frozen=True)
class Axis:
    """One knob: `label` with its unit, `values`, a coarser choice for quick runs; words in `names` if it has any."""

    label: str
    values: tuple[float, ...]
    quick: tuple[float, ...]
    log: bool = False
    names: tuple[str, ...] = ()


@dataclass(frozen=True)
class Variant:
    """An engine with settings, as a column of a map."""

    peer: str
    settings: Mapping[str, Any]

    @property
    def area(self) -> bool:
        """Whether its contacts are areas: it has a stiffness."""
        return self.peer.startswith("rigidarea") or self.peer == "literal"

    @property
    def given(self) -> bool:
        """Whether it is area contact whose stiffness is for the map to give, not for the library to choose."""
        return self.area and self.peer != "rigidarea-default"


Outcome = tuple[str, float]
"""(verdict, measure): "pass" or how it failed, and the number that says so."""


@dataclass(frozen=True)
class Map:
    """A map: `run(variant, x, y)` gives the outcome of one point; `theory` lists boundaries (label, x, y)."""

    title: str
    x: Axis
    y: Axis
    measure: str
    limit: float
    variants: Mapping[str, Variant]
    run: Callable[[Variant, float, float], Outcome]
    source: str
    theory: Callable[[], list[tuple[str, Array, Array]]] = field(default=lambda: [])
    theory_of: tuple[str, ...] = ()
    """The variants that theory speaks of; none: all."""
    name: str = ""
    """That of its module."""


def engines(**changes: Mapping[str, Any] | None) -> dict[str, Variant]:
    """The usual variants: rigidarea by frames and in explicit steps, pymunk, Box2D, the paper's method (ten nodes a
    side); `changes` replace settings, None drops the engine.
    """
    usual: dict[str, dict[str, Any]] = {
        "rigidarea": {"peer": "rigidarea-default"},
        "explicit": {"peer": "rigidarea-explicit", "phase": 0.5},
        "pymunk": {"peer": "pymunk", "steps": 4, "iterations": 10, "slop": 1e-3},
        "box2d": {"peer": "box2d", "steps": 1, "substeps": 4, "stiff": False, "length": 1},
        "literal": {"peer": "literal", "phase": 0.5, "spacing": 0.1},
    }
    found = {}
    for label, settings in usual.items():
        change = changes.get(label, {})
        if change is not None:
            merged = {**settings, **change}
            found[label] = Variant(merged.pop("peer"), merged)
    return found


def run_scene(variant: Variant, scene: Scene, k: float | None = None, **settings: Any) -> Trace:
    """The trace of a scene with a variant's settings and more; k: the stiffness, where it is for the map to give."""
    if k is not None and variant.given:
        settings["stiffness"] = k
    return record(get_peer(variant.peer).build(scene, {**variant.settings, **settings}), scene)


def judge(measure: float, limit: float, how: str) -> Outcome:
    """Pass if the measure is finite and within the limit, else `how` (or that the state left the numbers)."""
    if not math.isfinite(measure):
        return "not finite", math.inf
    return (PASS if measure <= limit else how), measure


@cache
def maps() -> dict[str, Map]:
    """Every map by name."""
    from . import maps as package

    return registered(package, "atlas_map")


def get_map(name: str) -> Map:
    """The map called `name`; `ValueError` lists the known ones."""
    check_known([name], maps(), "map")
    return maps()[name]


def evaluate(map: str, peer: str, x: float, y: float) -> Row:
    """One point of a map for one of its variants: the task of the sweep."""
    chart = get_map(map)
    with np.errstate(all="ignore"):  # runs that blow up are what is looked for
        verdict, measure = chart.run(chart.variants[peer], x, y)
    return {"verdict": verdict, "measure": measure if math.isfinite(measure) else None}


def atlas(
    out: Path,
    quick: bool = False,
    map_names: Sequence[str] = (),
    peer_names: Sequence[str] = (),
    scheduler: str | None = None,
    workers: int | None = None,
    resume: bool = True,
) -> Row:
    """Run the maps; returns the object written to `out`/atlas.json, rows map, peer, x, y, verdict, measure."""
    chosen = [get_map(name) for name in (map_names or maps())]
    tasks = []
    for chart in chosen:
        xs, ys = (axis.quick if quick else axis.values for axis in (chart.x, chart.y))
        for label, variant in chart.variants.items():
            if not peer_names or label in peer_names or variant.peer in peer_names:
                tasks += [{"map": chart.name, "peer": label, "x": x, "y": y} for y in ys for x in xs]
    store = out / "atlas.jsonl"
    if not resume:
        store.unlink(missing_ok=True)
    results = run_tasks(evaluate, tasks, store, scheduler, workers, title="atlas")
    rows = [{**task, **result} for task, result in zip(tasks, results, strict=True)]
    return envelope("atlas", {"quick": quick}, rows, maps=[describe(chart) for chart in chosen])


def passed(rows: Sequence[Row]) -> list[Row]:
    """A row a map and engine: points passed, points in all, and how the others failed."""
    groups: dict[tuple[str, str], list[str]] = {}
    for row in rows:
        groups.setdefault((row["map"], row["peer"]), []).append(row["verdict"])
    return [
        {
            "map": name,
            "peer": peer,
            "passed": verdicts.count(PASS),
            "points": len(verdicts),
            "failed": ", ".join(sorted(set(verdicts) - {PASS})),
        }
        for (name, peer), verdicts in groups.items()
    ]


def describe(chart: Map) -> Row:
    """What a reader of the output has to know of a map."""
    return {
        "map": chart.name,
        "title": chart.title,
        "x": chart.x.label,
        "y": chart.y.label,
        "measure": chart.measure,
        "limit": chart.limit,
        "source": chart.source,
        "variants": {name: {"peer": v.peer, **v.settings} for name, v in chart.variants.items()},
    }
