"""`rigidarea plan --validate`: plans against a brute-force sweep, over the study's scenes and over seeded
variations of them.

A plan is given a space, never a scene. Of each scene all settings of a grid are run and measured; a plan is right
where its own run's error is within the tolerance (or where it has said that none will be, and none is), and its
cost is compared with that of the cheapest setting of the grid that is within it. Errors are those of the study.
Variations, and the scenes of `unseen`, have no exact answer: the finest setting is their reference, and those whose
finest two differ by more than a third of the tolerance have none; nor have those of a scene on which the finest setting
itself is further than that from the exact answer.
"""

from __future__ import annotations

import math
import statistics
import time as clock
from collections.abc import Callable, Iterator, Sequence
from functools import cache, partial
from pathlib import Path
from typing import Any

import numpy as np
import pymunk

from rigidarea.plan.plan import plan
from rigidarea.report import Progress, envelope
from rigidarea.study.peers.base import record
from rigidarea.study.records import Row, append_rows, read_rows
from rigidarea.study.scene import ANGLE, Curve, Scene, Trace, X, Y, get_scene, scenes
from rigidarea.study.sweep import key
from rigidarea.study.timing import one_core, spent

from .judged import JUDGED
from .trial import Trial, at_settings, planned, space_of
from .unseen import UNSEEN
from .variations import variations

TOLERANCES = (0.1, 0.01, 0.001)
VARIATIONS = 100
BUDGET_S = 0.3
"""Processor time (s) beyond which finer settings of a grid are not tried: they would not be the cheapest of
anything."""
TIMED = 4
"""So many of the settings that are within a tolerance, the cheapest by a first timing, are timed again beside the
plan."""
ROUNDS, PATIENCE_S = 3, 0.3
CACHE = 1 << 22
"""More than the caches that a core has to itself hold (bytes)."""
#: The grid. Sweeps other than ten only where there is a pile; sampling only where a curve is sampled.
STEPS = (1, 2, 3, 4, 6, 8, 12, 16, 24, 32, 64)
DEPTHS = (1e-2, 1e-3, 1e-4, 1e-6, 1e-8)
SWEEPS, SWEEPS_PILE = (5,), (5, 10, 20)
SAMPLINGS = (1e-3, 1e-4, 1e-5, 1e-6)
SLOPS = (1e-2, 1e-3, 1e-4)
NATIVE_STEPS = (1, 2, 4, 8, 16, 32, 64)
JUDGES = {
    kind: {make.__name__: make for make in made} for kind, made in (("unseen", UNSEEN), ("judged", JUDGED))
}
"""Scenes without an exact answer, by name: see `unseen` and `judged`."""
JUDGING = {name: make for made in JUDGES.values() for name, make in made.items()}
"""All of them."""
FINEST = {"level": "rigid", "steps": 128, "sweeps": 20, "penetration": 1e-8}
NEXT_TO_FINEST = {"level": "rigid", "steps": 64, "sweeps": 20, "penetration": 1e-8}


def grid(scene: Scene) -> Iterator[Row]:
    """The settings of the brute-force sweep, by growing number of substeps."""
    outlines = [shape for body in scene.bodies for shape in body.shapes if isinstance(shape, Curve)]
    curved = any(shape.exact is None for shape in outlines)
    pile = sum(body.kind == "dynamic" for body in scene.bodies) > 1
    sweeps = SWEEPS_PILE if pile and scene.gravity != (0.0, 0.0) else SWEEPS
    depths = DEPTHS if scene.gravity != (0.0, 0.0) else DEPTHS[2:3]
    samplings = SAMPLINGS if curved else (None,)
    if not outlines:  # Chipmunk sees no outline, only what stands in for it
        for n in NATIVE_STEPS:
            for m in sweeps:
                for slop in SLOPS:
                    yield {"level": "pymunk", "steps": n, "sweeps": m, "penetration": slop}
    for n in STEPS:
        for m in sweeps if not curved else SWEEPS:
            for p in depths:
                for sampling in samplings:
                    own = {"level": "rigid", "steps": n, "sweeps": m, "penetration": p}
                    yield own if sampling is None else {**own, "sampling": sampling}


# --- one run -----------------------------------------------------------------------------------------------------


def errors(scene: Scene, build: Callable[[], Trial], reference: Trace | None) -> float:
    """The error of a run, frame by frame: the scene's own, or against a reference."""
    trace = record(build(), scene)
    if reference is None:
        return scene.measure(trace)
    return departure(trace, reference, scene.size)


def departure(trace: Trace, reference: Trace, size: float) -> float:
    """How far a body is from where a reference has it, over the way that it goes there or the size of a body
    (relative).

    The largest over bodies and frames; a turn counts as half the size times its angle.
    """
    if trace.states.shape != reference.states.shape or not np.all(np.isfinite(trace.states)):
        return math.inf
    off = np.abs(trace.states - reference.states)
    apart = np.maximum(np.hypot(off[:, :, X], off[:, :, Y]), 0.5 * size * off[:, :, ANGLE]).max(axis=0)
    steps = np.diff(reference.states[:, :, : Y + 1], axis=0)
    ways = np.hypot(steps[:, :, X], steps[:, :, Y]).sum(axis=0)
    return float(np.max(apart / np.maximum(ways, size)))


def seconds_of(scene: Scene, build: Callable[[], Trial]) -> float:
    """Processor time (s) of the whole run in one call; of short ones the median of several, each from cold caches.

    (What is planned has driven more out of the caches than what is just built: a run of a tenth of a millisecond took
    twice as long then, whatever its settings.)
    """
    found = spent(build().advance, scene.frames)
    if found > 0.02:
        return found
    return statistics.median([_cold(build(), scene.frames) for _ in range(5)])


def _cold(run: Trial, frames: int) -> float:
    """Time (s) of a run that finds nothing of its own in the caches."""
    np.ones(CACHE // 8).sum()
    return spent(run.advance, frames)


# --- the study -----------------------------------------------------------------------------------------------------


def study(
    scene: Scene, tolerances: Sequence[float], varied: bool, store: Path | None, known: dict[str, Row]
) -> list[Row]:
    """One scene: the sweep, then a plan and its run a tolerance.

    All is kept in `store`, so that the same command goes on; a plan that has changed is judged anew.
    """

    def kept(task: Row, work: Callable[[], Row]) -> Row:
        row = known.get(key(task))
        if row is None:
            row = known[key(task)] = {"task": task, **work()}
            if store is not None:
                append_rows(store, [row])
        return row

    name = {"scene": scene.name, "varied": varied}
    reference = cache(partial(_reference, scene)) if varied else _none
    doubt: float | None = 0.0
    if varied:
        doubt = kept({**name, "reference": True}, lambda: {"doubt": reference()[1]})["doubt"]
        origin = scene.name.rpartition("-")[0]  # of a variation
        far = kept({"scene": origin, "finest": True}, partial(_finest, origin))["error"] if origin else 0.0
        doubt = None if doubt is None or far is None else max(doubt, far)
    judged = [tolerance for tolerance in tolerances if doubt is not None and doubt <= tolerance / 3.0]
    rows: list[Row] = [
        {**name, "tolerance": tolerance, "verdict": "no reference"}
        for tolerance in tolerances
        if tolerance not in judged
    ]
    if not judged:
        return rows
    swept = []
    done: set[tuple[Any, ...]] = set()  # finer steps of these are the cheapest of nothing
    for settings in grid(scene):
        branch = tuple(value for name, value in settings.items() if name != "steps")
        if branch in done:
            continue
        run = partial(_swept, scene, settings, reference)
        row = kept({**name, **settings}, run)
        if row["rough_s"] > BUDGET_S or (row["error"] is not None and row["error"] <= min(tolerances)):
            done.add(branch)
        swept.append({**settings, "error": row["error"], "rough_s": row["rough_s"]})
    for tolerance in judged:
        chosen = plan(space_of(scene)[0], tolerance, scene.duration, frame=scene.frame)
        told = (chosen.level, chosen.steps, chosen.sweeps, chosen.penetration, *sorted(chosen.finer.values()))
        task = {**name, "tolerance": tolerance, "plan": told, "sampling": sorted(chosen.sampling.values())}
        task |= {"reachable": chosen.reachable, "unpromised": chosen.unpromised}
        look = partial(judge, scene, tolerance, swept, varied, reference)
        rows.append({k: v for k, v in kept(task, look).items() if k != "task"})
    return rows


def _swept(scene: Scene, settings: Row, reference: Callable[[], tuple[Trace | None, float]]) -> Row:
    """One setting of the grid: its error (None: it failed) and, roughly, its processor time (s)."""
    compared = reference()[0]
    begin = clock.thread_time()
    error = errors(scene, partial(at_settings, scene, settings), compared)
    return {"error": error if math.isfinite(error) else None, "rough_s": clock.thread_time() - begin}


def _none() -> tuple[None, float]:
    """The reference of a scene that has an exact answer."""
    return None, 0.0


def _finest(name: str) -> Row:
    """The finest setting's error on a scene of the study (None: it failed)."""
    error = errors(get_scene(name), partial(at_settings, get_scene(name), {**FINEST, "sampling": 1e-6}), None)
    return {"error": error if math.isfinite(error) else None}


def _reference(scene: Scene) -> tuple[Trace, float]:
    """The finest setting's run, and how far the next to finest is from it."""
    fine, coarse = ({**s, "sampling": 1e-6} for s in (FINEST, NEXT_TO_FINEST))
    trace = record(at_settings(scene, fine), scene)
    return trace, departure(record(at_settings(scene, coarse), scene), trace, scene.size)


def judge(
    scene: Scene,
    tolerance: float,
    swept: Sequence[Row],
    varied: bool,
    reference: Callable[[], tuple[Trace | None, float]],
) -> Row:
    """A plan for one tolerance: its own run, and the cheapest settings of the sweep that are within the tolerance."""
    chosen = partial(plan, tolerance=tolerance, seconds=scene.duration, frame=scene.frame)
    build = partial(planned, scene, chosen)
    own = build().plan
    assert own is not None
    error = errors(scene, build, reference()[0])
    good = sorted(
        (row for row in swept if row["error"] is not None and row["error"] <= tolerance), key=_likely_cost
    )
    cheapest = [
        partial(at_settings, scene, {k: v for k, v in row.items() if k not in ("error", "rough_s")})
        for row in good[:TIMED]
    ]
    times: list[list[float]] = [[] for _ in range(1 + len(cheapest))]
    with one_core():
        for _ in range(ROUNDS):
            for each, found in zip((build, *cheapest), times):
                if sum(found) < PATIENCE_S:  # the noise of a long run is small beside it
                    found.append(seconds_of(scene, each))
    costs = [statistics.median(found) for found in times]
    within, warned = error <= tolerance, not own.reachable or bool(own.unpromised)
    least = min(costs[1:], default=math.inf)
    if within:
        verdict = "within"
    elif not good:
        verdict = "none reaches it" + (", and the plan says so" if warned else "")
    else:
        verdict = "outside" + (", and the plan says so" if warned else "")
    return {
        "scene": scene.name,
        "varied": varied,
        "tolerance": tolerance,
        "verdict": verdict,
        "error": error if math.isfinite(error) else None,
        "predicted_error": own.error,
        "planning_s": own.planning_s,
        "decided_by": next((line.what for line in own.lines[1:] if line.error == own.error), ""),
        "level": own.level,
        "steps": own.steps,
        "sweeps": own.sweeps,
        "penetration": own.penetration,
        "cost_s_per_s": costs[0] / scene.duration,
        "predicted_cost_s_per_s": own.cost_s_per_s,
        "cheapest_s_per_s": least / scene.duration if good else None,
        "cheapest": _told(good, costs),
        "cost_ratio": costs[0] / min(least, costs[0]) if within else None,
        "reachable": bool(good) or within,
    }


def _likely_cost(row: Row) -> float:
    """Order in which adequate settings are tried: steps and sweeps decide, Chipmunk's steps are shorter."""
    per = 1.0 if row["level"] == "pymunk" else 1.5 + 0.05 * row["sweeps"]
    return float(row["steps"] * per - math.log10(row.get("sampling") or 1e-3) * 1e-3)


def _told(good: Sequence[Row], costs: Sequence[float]) -> str:
    if not good:
        return ""
    row = good[int(np.argmin(costs[1:]))]
    finer = f", sampling {row['sampling']:.0e}" if row.get("sampling") else ""
    return f"{row['level']} {row['steps']} x {row['sweeps']}, {row['penetration']:.0e}{finer}"


def summary(rows: Sequence[Row]) -> Row:
    """What the issue asks, of one kind of scene: how often within, how much dearer, how often it said so beforehand."""
    judged = [row for row in rows if row["verdict"] != "no reference"]
    reachable = [row for row in judged if row["reachable"]]
    within = [row for row in reachable if row["verdict"] == "within"]
    ratios = [row["cost_ratio"] for row in within]
    hopeless = [row for row in judged if not row["reachable"]]
    outside = [row for row in reachable if row["verdict"].startswith("outside")]
    return {
        "cells": len(judged),
        "without_reference": len(rows) - len(judged),
        "reachable": len(reachable),
        "within_tolerance_percent": 100.0 * len(within) / max(1, len(reachable)),
        "outside_said": sum("says so" in row["verdict"] for row in outside),
        "cost_ratio_median": statistics.median(ratios) if ratios else math.nan,
        "cost_ratio_worst": max(ratios, default=math.nan),
        "unreachable": len(hopeless),
        "unreachable_said_percent": 100.0
        * sum("says so" in row["verdict"] for row in hopeless)
        / max(1, len(hopeless)),
    }


def plan_time(bodies: int = 1000) -> Row:
    """How long planning takes (ms) for a pile of boxes, and what a second of the planned run does (ms)."""
    space = pymunk.Space()
    space.gravity = 0.0, -9.81
    ground = pymunk.Segment(space.static_body, (-100.0, 0.0), (200.0, 0.0), 0.0)
    ground.friction = 0.6
    space.add(ground)
    for i in range(bodies):
        body = pymunk.Body(1.0, 1.0 / 6.0)
        body.position = 1.2 * (i % 50), 0.5 + i // 50
        box = pymunk.Poly.create_box(body, (1.0, 1.0))
        box.friction = 0.6
        space.add(body, box)
    plan(space, 0.01)
    found = []
    for _ in range(5):
        begin = clock.thread_time()
        made = plan(space, 0.01)
        found.append(clock.thread_time() - begin)
    made.apply()
    made.step(frames=2)
    begin = clock.thread_time()
    made.step(frames=30)
    second = (clock.thread_time() - begin) / 30 / made.frame
    return {
        "bodies": bodies,
        "plan_ms": 1e3 * statistics.median(found),
        "planned_run_ms_per_s": 1e3 * second,
        "planned_s": made.seconds,
        "share_of_run_percent": 100.0 * statistics.median(found) / (second * made.seconds),
    }


def validate(
    out: Path,
    scene_names: Sequence[str] = (),
    count: int = VARIATIONS,
    tolerances: Sequence[float] = TOLERANCES,
    fresh: bool = False,
) -> Row:
    """The whole study; returns the object written to `out`/plan-validate.json. What was swept is kept in `out`."""
    store = out / "plan-sweep.jsonl"
    if fresh:
        store.unlink(missing_ok=True)
    known = {key(row["task"]): row for row in read_rows(store)}
    names = list(scene_names) or [*(name for name, scene in scenes().items() if not scene.deforms), *JUDGING]
    chosen = [(get_scene(name), False) for name in names if name not in JUDGING]
    chosen += [(scene, True) for scene in variations(count, scene_names)]
    chosen += [(JUDGING[name](), True) for name in names if name in JUDGING]
    progress = Progress("plan", len(chosen))
    rows: list[Row] = []
    for scene, varied in chosen:
        rows += study(scene, tolerances, varied, store, known)
        progress.step(scene.name)
    settings = {"scenes": names, "variations": count, "tolerances": list(tolerances)}
    return report(rows, settings)


def report(rows: Sequence[Row], settings: Row) -> Row:
    """The object of the command: what the issue asks, then every row."""
    tolerances = sorted({row["tolerance"] for row in rows}, reverse=True)
    told = {
        "scenes": summary([row for row in rows if not row["varied"]]),
        "variations": summary([row for row in rows if row["varied"] and row["scene"] not in JUDGING]),
        **{kind: summary([row for row in rows if row["scene"] in made]) for kind, made in JUDGES.items()},
        "by_tolerance": {
            str(t): summary([r for r in rows if not r["varied"] and r["tolerance"] == t]) for t in tolerances
        },
        "plan_ms_1000_bodies": plan_time(),
    }
    head = {
        k: told["scenes"][k] for k in ("within_tolerance_percent", "cost_ratio_median", "cost_ratio_worst")
    }
    return envelope(
        "plan",
        settings,
        {**head, "plan_ms_1000_bodies": told["plan_ms_1000_bodies"]["plan_ms"]},
        rows=rows,
        summary=told,
    )
