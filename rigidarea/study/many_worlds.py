"""Many worlds at once, beside pymunk's own loop over as many spaces: what `bench worlds` prints."""

from __future__ import annotations

import os
import statistics
import time
from collections.abc import Callable
from typing import Any

import numpy as np
import pymunk

from ..chipmunk import attach
from ..report import Progress, envelope
from ..worlds import Worlds
from .records import Row
from .timing import one_core

BODIES, DT = 20, 1 / 60
HEIGHTS = (2.0, 8.0, 20.0)
"""From how high the boxes fall, in sides of one: within a quarter of a second, or for one."""
ROUNDS, FRAMES, EPISODE = 5, 60, 600
"""Each round steps worlds and spaces by so many frames, one after the other: a drift of the machine hits both alike."""


def boxes(seed: int, height: float = 8.0) -> pymunk.Space:
    """20 boxes of 20, turned and scattered over a pit, to fall from as high as `height` of their sides."""
    draw = np.random.default_rng(seed)
    space = pymunk.Space()
    space.gravity = 0, -900
    for a, b in (((-200, 0), (200, 0)), ((-200, 0), (-200, 900)), ((200, 0), (200, 900))):
        space.add(pymunk.Segment(space.static_body, a, b, 5))
    for _ in range(BODIES):
        body = pymunk.Body(1, pymunk.moment_for_box(1, (20, 20)))
        body.position = draw.uniform(-180, 180), 25 + draw.uniform(0, 20 * height)
        body.angle = draw.uniform(0, 6)
        space.add(body, pymunk.Poly.create_box(body, (20, 20)))
    for shape in space.shapes:
        shape.friction = 0.5
    return space


def worlds(n: int = 1024) -> Row:
    """What `n` worlds of 20 boxes cost: to make, to step by one thread and by two, to reset, and in memory.

    Rows: what, measured, unit; must and aim where there are some (of 1,024 worlds). Frames are those of a world, over
    processor time, medians of ROUNDS rounds of FRAMES frames: from the first on, or 300 later; or of EPISODE frames
    from the first on, of 256 worlds. pymunk's loop is `for space in spaces: space.step(1 / 60)` over 64 spaces that
    begin in the same states.
    """
    progress = Progress("worlds", 7)
    rows: list[Row] = []

    def note(what: str, measured: float, unit: str, must: str = "", aim: str = "") -> None:
        rows.append({"what": what, "measured": measured, "unit": unit, "must": must, "aim": aim})

    space = boxes(1)
    contact = attach(space)
    _run(space, 1)
    Worlds(space, 2, threads=1).step(DT)  # compiled, or loaded, now
    made: list[float] = []
    with one_core():
        for _ in range(5):
            before = time.process_time()
            many = Worlds(space, n, threads=1)
            made.append(time.process_time() - before)
    note(f"{n} worlds made", statistics.median(made), "s of processor time", "<= 1", "0.2")
    progress.step("made")
    for name, count, waits, frames in (
        ("collapsing", n, 0, FRAMES),
        ("settled", n, 300, FRAMES),
        ("ten seconds from the fall on", min(n, 256), 0, EPISODE),
    ):
        ours, theirs = _beside_pymunk(count, waits, frames)
        note(f"frames a second, {name}, one thread", ours, "1/s", f">= {theirs:.0f}", f"{2 * theirs:.0f}")
        note(f"frames a second, {name}, pymunk's loop", theirs, "1/s")
        progress.step(name)
    note("two threads over one", _two_threads(n), "of wall time", ">= 1.7", "1.95")
    progress.step("threads")
    _run(space, 200)
    snapshot, one = contact.snapshot(), many.snapshot(3)
    calls: dict[str, tuple[Callable[[], Any], int, str, str]] = {
        "snapshot of a space": (contact.snapshot, 1, "<= 20", "5"),
        "restore of a space": (lambda: contact.restore(snapshot), 1, "<= 20", "5"),
        "snapshot of a world": (lambda: many.snapshot(3), 1, "", ""),
        "restore of a world": (lambda: many.restore(one, [3]), 1, "", ""),
        "reset of one world": (lambda: many.reset([3]), 1, "", ""),
        f"reset of {n} worlds, each": (many.reset, n, "", ""),
    }
    for what, (call, times, must, aim) in calls.items():
        note(what, _us(call) / times, "us", must, aim)
    progress.step("snapshots")
    for height in HEIGHTS:
        note(
            f"memory a world, from {height:g} sides", _memory(min(n, 64), height) / 1000, "KB", "<= 100", "30"
        )
    progress.step("memory")
    return envelope("bench worlds", {"worlds": n, "bodies": BODIES, "processors": os.cpu_count()}, rows)


def _run(space: pymunk.Space, frames: int) -> None:
    for _ in range(frames):
        space.step(DT)


def _scattered(many: Worlds) -> np.ndarray:
    """States of the beginning, each world's boxes thrown another way."""
    many.reset()
    states = many.states
    states[:, :, 3:5] += np.random.default_rng(7).normal(0, 50, (many.n, BODIES, 2))
    many.put(states)
    return states


def _beside_pymunk(n: int, waits: int, frames: int) -> tuple[float, float]:
    """World-frames a second of worlds, and of pymunk's own loop over spaces; `waits` frames after the beginning."""
    space, plain = boxes(1), [boxes(1) for _ in range(min(n, 64))]
    attach(space)
    many = Worlds(space, n, threads=1)
    ours, theirs = [], []
    with one_core():
        for k in range(ROUNDS):
            if k == 0 or waits == 0:
                states = _scattered(many)
                for one, state in zip(plain, states):
                    _place(one, state)
                    _run(one, waits)
                many.step(DT, frames=max(waits, 1))
            start = time.process_time()
            many.step(DT, frames=frames)
            ours.append(n * frames / (time.process_time() - start))
            start = time.process_time()
            for _ in range(frames):
                for one in plain:
                    one.step(DT)
            theirs.append(len(plain) * frames / (time.process_time() - start))
    return statistics.median(ours), statistics.median(theirs)


def _place(space: pymunk.Space, states: np.ndarray) -> None:
    for body, (x, y, angle, vx, vy, w) in zip(space.bodies, states.tolist()):
        body.position, body.angle = (x, y), angle
        body.velocity, body.angular_velocity = (vx, vy), w


def _two_threads(n: int) -> float:
    """How many times the frames of one thread two threads do in the same time, all collapsing."""
    space = boxes(1)
    attach(space)
    pair = [Worlds(space, n, threads=threads) for threads in (1, 2)]
    ratios = []
    for _ in range(ROUNDS):
        times = []
        for many in pair:
            _scattered(many)
            start = time.perf_counter()
            many.step(DT, frames=FRAMES)
            times.append(time.perf_counter() - start)
        ratios.append(times[0] / times[1])
    return statistics.median(ratios)


def _us(call: Callable[[], Any]) -> float:
    """The median time of a call (us)."""
    times = []
    with one_core():
        for _ in range(200):
            start = time.perf_counter()
            call()
            times.append(time.perf_counter() - start)
    return 1e6 * statistics.median(times)


def _memory(n: int, height: float) -> float:
    """Bytes a world takes once its boxes have come to rest."""
    space = boxes(2, height)
    attach(space)
    many = Worlds(space, n, threads=1)
    many.step(DT, frames=300)
    return float(many.nbytes)
