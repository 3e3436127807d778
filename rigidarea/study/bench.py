"""Speed: frame times beside the peers, kernels beside shapely, memory."""

from __future__ import annotations

import math
import os
import time
import tracemalloc
from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor
from functools import cache, partial
from multiprocessing import get_context
from typing import Any

import numpy as np
import pymunk
from pymunk._chipmunk_cffi import lib
from shapely.affinity import affine_transform

from ..compile.chosen import LIBRARY, backend
from ..compile.jit import entry
from ..geometry.outline import Outline
from ..geometry.overlap import overlap_kernel
from ..geometry.pool import pack
from ..geometry.work import enlarged, fits, new_work, relative
from ..overlap_queries import overlap
from ..report import Progress, envelope
from ..shapes import box, capsule, circle, involute_gear, ring, rounded_polygon
from .crowds import CROWDS
from .everyday_scenes import pit_of_discs
from .peers import drive, get_peer, record
from .records import Row
from .scene import Scene, check_known
from .scenes import geneva_scene
from .timing import exponent, median_times, one_core, spent

SIZES, QUICK_SIZES = (10, 100, 1000, 10000), (10, 100, 1000)

USUAL: dict[str, tuple[dict[str, Any], ...]] = {
    "rigidarea-default": ({},),
    "rigidarea": ({"stiffness": 1e4, "steps": 4}, {"stiffness": 1e6, "steps": 16}),
    "pymunk": ({"steps": 1, "iterations": 10, "slop": 1e-2}, {"steps": 4, "iterations": 10, "slop": 1e-2}),
    "box2d": ({"steps": 1, "substeps": 4, "stiff": False, "length": 1},),
}
"""How each engine is usually run; pymunk's users take one step a frame, or a few."""

WARM, BUDGET_S = 10, 8.0
"""Frames before timing; wall time after which the frames of one run are cut short."""


def frames(names: Sequence[str] = (), sizes: Sequence[int] = SIZES, peer_names: Sequence[str] = ()) -> Row:
    """Frame times (ms) of crowds: median, 99th percentile and worst, with the error that goes with them.

    Rows: scene, bodies, peer, settings, steps_per_frame, frame_ms_median, frame_ms_p99, frame_ms_worst,
    frames, error, error_name. `growth`: exponent of the median's growth with the number of bodies.
    """
    chosen = list(names) or list(CROWDS)
    wanted = [name for name in USUAL if not peer_names or name in peer_names]
    check_known(chosen, CROWDS, "scene")
    rows: list[Row] = []
    progress = Progress("frames", len(chosen) * len(sizes) * len(wanted))
    for name in chosen:
        for size in sizes:
            scene = CROWDS[name](size)
            for peer in wanted:
                progress.step(f"{name} {size} {peer}")
                if not get_peer(peer).refuses(scene):
                    rows += [frame_row(scene, peer, settings) for settings in USUAL[peer]]
    settings = {"scenes": chosen, "sizes": list(sizes), "peers": wanted}
    return envelope("bench frames", settings, rows, growth=growth(rows), **call_overhead())


def frame_row(scene: Scene, peer: str, settings: dict[str, Any]) -> Row:
    """Time every frame of a run by itself; then measure the error of another run of as many frames."""
    run = get_peer(peer).build(scene, settings)
    moving = sum(body.kind == "dynamic" for body in scene.bodies)
    times: list[float] = []
    with one_core():
        run.advance(WARM)
        end = time.perf_counter() + BUDGET_S
        while len(times) < scene.frames - WARM and (time.perf_counter() < end or len(times) < 20):
            before = time.perf_counter()
            run.advance(1)
            times.append(1e3 * (time.perf_counter() - before))
    again = get_peer(peer).build(scene, settings)
    trace = record(again, scene, min(WARM + len(times), scene.frames))
    return {
        "scene": scene.name,
        "bodies": moving,
        "peer": peer,
        "settings": settings,
        "steps_per_frame": again.steps,
        "frame_ms_median": float(np.median(times)),
        "frame_ms_p99": float(np.percentile(times, 99)),
        "frame_ms_worst": max(times),
        "frames": len(times),
        "error": scene.measure(trace),
        "error_name": scene.error_name,
    }


def growth(rows: Sequence[Row]) -> list[Row]:
    """Slope of log(median frame time) over log(bodies), for every scene, peer and setting with two sizes or more."""
    groups: dict[tuple[str, str, str], list[Row]] = {}
    for row in rows:
        groups.setdefault((row["scene"], row["peer"], str(row["settings"])), []).append(row)
    found = []
    for (scene, peer, _), group in groups.items():
        if len(group) > 1:
            slope = exponent([row["bodies"] for row in group], [row["frame_ms_median"] for row in group])
            found.append({"scene": scene, "peer": peer, "settings": group[0]["settings"], "exponent": slope})
    return found


def call_overhead() -> Row:
    """What a step of an empty world costs in each engine (µs): the foreign call and the engine's own least work."""
    space, count = pymunk.Space(), 20000
    found = {
        "pymunk": _us(lib.cpSpaceStep, count, space._space, 1e-3),
        "pymunk_python": _us(space.step, count, 1e-3),
    }
    try:
        import pyb2d3

        found["box2d"] = _us(pyb2d3.World(gravity=(0, -10)).step, count, 1e-3, 1)
    except ImportError:
        pass
    return {"call_overhead_us": found}


def _us(step: Any, count: int, *arguments: object) -> float:
    drive(step, count // 10, *arguments)
    return 1e6 * spent(drive, step, count, *arguments) / count


# Kernels
# ---------------------------------------------------------------------------------------------------------


def kernel_pairs() -> dict[str, tuple[Outline, Outline, tuple[float, float, float]]]:
    """Pairs of outlines and the pose (x, y, angle) of the second: boxes, discs and rounded shapes, gears in mesh, a
    Geneva drive.
    """
    coarse = [involute_gear(0.002, teeth, spacing=6e-4) for teeth in (23, 57)]
    fine = [involute_gear(0.002, teeth, tolerance=6e-7) for teeth in (23, 57)]
    mesh = (0.08, 0.0, math.pi + math.pi / 57 - 2.6e-3)  # flanks pressed 0.15 mm into each other
    parts = geneva_scene.drive()
    crank = 0.3
    turned: float = parts.wheel_angle(crank) + 5e-3
    rounded = rounded_polygon(box(1, 1).rings[0], 0.1)
    gear = involute_gear(0.002, 57, tolerance=7.5e-6)  # 1,254 points
    return {
        "boxes": (box(1, 1), box(1, 1), (0.3, 0.98, 0.1)),
        "box, slab": (box(1, 1), box(100, 1), (0.3, -0.99, 0.0)),
        "16-gons": (_gon(16), _gon(16), (1.9, 0.1, 0.2)),
        "64-gons": (_gon(64), _gon(64), (1.98, 0.05, 0.1)),
        "discs": (circle(0.5), circle(0.5), (0.99, 0.05, 0.0)),
        "disc, box": (circle(0.5), box(1, 1), (0.3, 0.98, 0.1)),
        "disc, capsule": (circle(0.5), capsule(1, 0.25), (0.3, 0.74, 0.1)),
        "disc, 64-gon": (circle(1.0), _gon(64), (1.98, 0.05, 0.1)),
        "disc, gear": (circle(0.02), gear, (0.0786, 0.0, math.pi / 57)),
        "disc in ring": (circle(0.45), ring(0.5, 0.6), (0.0, 0.0505, 0.0)),
        "capsules": (capsule(1, 0.25), capsule(1, 0.25), (0.3, 0.48, 0.1)),
        "rounded boxes": (rounded, rounded, (0.3, 0.98, 0.1)),
        "gears": (coarse[0], coarse[1], mesh),
        "fine gears": (fine[0], fine[1], mesh),
        "geneva": (parts.pin.rotated(crank), parts.wheel, (0.05, 0.0, turned)),
        "1000-gons": (_gon(1000), _gon(1000), (1.99, 0.0, 0.0)),
    }


def _gon(n: int) -> Outline:
    angles = 2 * math.pi * np.arange(n) / n
    return Outline(np.column_stack((np.cos(angles), np.sin(angles))))


def kernels(names: Sequence[str] = (), repeats: int = 15) -> Row:
    """One overlap query (µs) in a compiled loop, beside shapely's intersection with area and centroid.

    Processor time, the median of `repeats` rounds, each of which asks all pairs of both: a drift hits all alike.
    Rows: pair, points_a, points_b, regions, query_us, call_us (of `rigidarea.overlap`, from Python), shapely_us,
    area_error (relative, against shapely). ValueError where nothing compiles. Points are
    the ends of edges and arcs; shapely gets arcs sampled to a thousandth of half the extent (a disc: 72 points), as
    its users sample them.
    """
    if backend() == LIBRARY:
        raise ValueError(
            "bench kernels compiles a loop of its own: expected RIGIDAREA_BACKEND=compiled (numba), got library"
        )
    pairs = kernel_pairs()
    check_known(names, pairs, "pair")
    chosen = list(names or pairs)
    progress = Progress("kernels", len(chosen))
    queries, areas = [], []
    jobs: list[Callable[[], float]] = []
    for name in chosen:
        a, b, pose = pairs[name]
        query, (x, y, angle) = Query(a, b, pose), pose
        c, s = math.cos(angle), math.sin(angle)
        theirs = partial(_intersection, _sampled(a), affine_transform(_sampled(b), (c, -s, s, c, x, y)))
        asked = partial(overlap, a, (0.0, 0.0, 0.0), b, pose)
        asked()  # its scratch memory is made once
        queries.append(query)
        areas.append(theirs()[0])
        jobs += [query.time_us, partial(_us, asked, 1000), partial(_us, theirs, 100)]
        progress.step(name)
    times = iter(median_times(jobs, repeats, patience_s=math.inf))
    rows = [
        {
            "pair": name,
            "points_a": sum(map(len, pairs[name][0].rings)),
            "points_b": sum(map(len, pairs[name][1].rings)),
            "regions": query.regions,
            "query_us": next(times),
            "call_us": next(times),
            "shapely_us": next(times),
            "area_error": abs(query.area / area - 1),
        }
        for name, query, area in zip(chosen, queries, areas)
    ]
    return envelope("bench kernels", {"pairs": chosen, "repeats": repeats}, rows)


def _sampled(outline: Outline) -> Any:
    xmin, ymin, xmax, ymax = outline.bounds
    coarse = outline.sample(1e-3 * min(xmax - xmin, ymax - ymin) / 2) if outline.arcs else outline
    return coarse.polygon


def _intersection(one: Any, other: Any) -> tuple[float, float, float]:
    both = one.intersection(other)
    return both.area, *both.centroid.coords[0]


class Query:
    """One overlap, asked again and again in a compiled loop with the second outline moved by rounding errors."""

    def __init__(self, a: Any, b: Any, pose: tuple[float, float, float]) -> None:
        self.pool, self.pose = pack([a, b]), pose
        points, rings = sum(len(r) for r in (*a.rings, *b.rings)), len(a.rings) + len(b.rings)
        self.work = new_work()
        self.regions = int(_loop()(self.pool, *pose, self.work, 1)) if fits(self.work, points, rings) else -1
        while self.regions < 0 and len(self.work.cross) < 10**6:
            self.work = enlarged(self.work, points, rings)
            self.regions = int(_loop()(self.pool, *pose, self.work, 1))
        self.area = float(sum(self.work.loops["area"][: self.regions]))
        self.count = 1
        while self._seconds() < 0.005:
            self.count *= 2

    def _seconds(self) -> float:
        return spent(_loop(), self.pool, *self.pose, self.work, self.count)

    def time_us(self) -> float:
        """Mean time of a query (µs)."""
        return 1e6 * self._seconds() / self.count


@cache
def _loop() -> Any:
    """Compiled on first use: `count` queries, the loops found by the last."""

    @entry
    def loop(pool, x, y, angle, work, count):  # type: ignore[no-untyped-def]
        found = 0
        for i in range(count):
            a, b = pool.heads[0], pool.heads[1]
            c, s = math.cos(angle), math.sin(angle)
            bx = x + 1e-13 * (i % 7)
            rel = relative(0.0, 0.0, 1.0, 0.0, bx, y, c, s, a["x"], a["y"], b["x"], b["y"])
            found = overlap_kernel(pool, 0, pool, 1, rel, work)
        return found

    return loop


# Memory
# ----------------------------------------------------------------------------------------------------------


HELD: dict[str, tuple[Callable[[int], Scene], int]] = {
    **{name: (make, 10) for name, make in CROWDS.items()},
    "discs": (pit_of_discs, 300),
}
"""What memory is measured of, and after how many frames."""


def memory(names: Sequence[str] = (), size: int = 1000, peer_names: Sequence[str] = ()) -> Row:
    """Resident memory that a crowd takes once it is built and has run a few frames, or a pit of discs once it lies, per
    body.

    Each run is built in a fresh process, so that nothing is reused. Rows: scene, bodies, peer,
    bytes_per_body, python_bytes_per_body (of that, what Python's allocator holds), of ours tables_bytes_per_body (what
    contacts take, all in all) and, by name, largest_tables_bytes_per_body.
    """
    chosen = list(names) or list(HELD)
    wanted = [name for name in USUAL if not peer_names or name in peer_names]
    rows = []
    progress = Progress("memory", len(chosen) * len(wanted))
    for name in chosen:
        for peer in wanted:
            with ProcessPoolExecutor(1, mp_context=get_context("spawn")) as pool:
                rows.append(pool.submit(memory_row, name, size, peer).result())
            progress.step(f"{name} {peer}")
    return envelope("bench memory", {"scenes": chosen, "size": size, "peers": wanted}, rows)


def memory_row(name: str, size: int, peer: str) -> Row:
    """Growth of this process's resident memory while a crowd is built and run."""
    make, frames = HELD[name]
    small, scene = make(10), make(size)
    engine, settings = get_peer(peer), USUAL[peer][0]
    engine.build(small, settings).advance(2)  # what is loaded and compiled once does not count
    tracemalloc.start()
    before = resident()
    run = engine.build(scene, settings)
    run.advance(frames)
    grown = resident() - before
    python = tracemalloc.get_traced_memory()[0]
    tracemalloc.stop()
    bodies = sum(body.kind == "dynamic" for body in scene.bodies)
    row = {
        "scene": name,
        "bodies": bodies,
        "peer": peer,
        "settings": settings,
        "bytes_per_body": grown / bodies,
        "python_bytes_per_body": python / bodies,
    }
    if contact := getattr(run, "contact", None):
        sizes = {table: size / bodies for table, size in contact._store.sizes().items()}
        row["tables_bytes_per_body"] = sum(sizes.values())
        row["largest_tables_bytes_per_body"] = dict(sorted(sizes.items(), key=lambda item: -item[1])[:8])
    return row


def resident() -> int:
    """Resident memory of this process (bytes); elsewhere than on Linux its peak."""
    try:
        with open("/proc/self/statm") as file:
            return int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE")
    except OSError:
        import resource

        return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024
