"""`bench step`: one area step beside one native step, on the same bodies in the same place. `bench start`: until the
first step.
"""

from __future__ import annotations

import os
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterable

import pymunk

import rigidarea as ra

from ..report import envelope
from . import growth
from .records import Row
from .timing import one_core

#: Bodies of the columns whose cost per contact is compared.
COLUMNS = (100, 1000, 10000)
ROWS = 40
STEP = 1 / 960


def pyramid(rows: int) -> pymunk.Space:
    """Unit boxes of 1 kg, each on two (rows 40: 820 boxes)."""
    return _boxes(
        (1.05 * i - 0.525 * (rows - row), 0.5 + row) for row in range(rows) for i in range(rows - row)
    )


def columns(bodies: int) -> pymunk.Space:
    """Columns of ten unit boxes: as many contacts as bodies."""
    return _boxes((1.2 * (i // 10), 0.5 + i % 10) for i in range(bodies))


def _boxes(places: Iterable[tuple[float, float]]) -> pymunk.Space:
    space = pymunk.Space()
    space.gravity = 0, -9.81
    floor = pymunk.Segment(space.static_body, (-1e5, 0), (1e5, 0), 0)
    floor.friction = 0.8
    space.add(floor)
    for place in places:
        body = pymunk.Body(1.0, 1 / 6)
        body.position = place
        box = pymunk.Poly.create_box(body, (1, 1))
        box.friction = 0.8
        space.add(body, box)
    return space


def step(repeats: int = 15) -> Row:
    """Whole `space.step` (ms) with area contact and with Chipmunk's response (10 iterations), in turn, settled.

    Rows: scene, bodies, contacts, area_ms, native_ms, ratio (median of the pairwise ratios), area_us_per_contact.
    `phases`: where a frame's time goes in scenes that are settled, roll and collapse (`growth.phases`).
    """
    scenes = [("pyramid", pyramid(ROWS), pyramid(ROWS))]
    scenes += [("columns", columns(n), columns(n)) for n in COLUMNS]
    rows = []
    for name, mine, native in scenes:
        contact = ra.attach(mine)
        for _ in range(240):
            mine.step(STEP)
            native.step(STEP)
        count = max(1, 2000 // len(mine.bodies))
        with one_core():
            times = [(_per_step(mine, count), _per_step(native, count)) for _ in range(repeats)]
        area = statistics.median(a for a, _ in times)
        contacts = len(contact.regions)
        rows.append(
            {
                "scene": name,
                "bodies": len(mine.bodies),
                "contacts": contacts,
                "area_ms": 1e3 * area,
                "native_ms": 1e3 * statistics.median(b for _, b in times),
                "ratio": statistics.median(a / b for a, b in times),
                "area_us_per_contact": 1e6 * area / contacts,
            }
        )
    settings = {"step_s": STEP, "repeats": repeats, "iterations": 10}
    return envelope("bench step", settings, rows, phases=growth.phases())


def _per_step(space: pymunk.Space, count: int) -> float:
    before = time.perf_counter()
    for _ in range(count):
        space.step(STEP)
    return (time.perf_counter() - before) / count


_START = """
import time; t0 = time.perf_counter()
import pymunk, rigidarea as ra
from rigidarea.study.start_time import columns
t1 = time.perf_counter()
space = columns({bodies})
t2 = time.perf_counter()
ra.attach(space)
t3 = time.perf_counter()
space.step(1e-3)
print(t1 - t0, t3 - t2, time.perf_counter() - t3)
"""


def start(bodies: int = 10000) -> Row:
    """Import, attach and first step (s) in fresh processes: with an empty cache of machine code, and with a warm one.

    Rows: cache, bodies, import_s, attach_s, first_step_s, to_first_step_s (their sum).
    """
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        environment = os.environ | {"XDG_CACHE_HOME": folder}
        for cache, count in (("empty", 10), ("warm", 10), ("warm", bodies)):
            command = [sys.executable, "-c", _START.format(bodies=count)]
            done = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
            times = [float(word) for word in done.stdout.split()]
            row = dict(zip(("import_s", "attach_s", "first_step_s"), times, strict=True))
            rows.append({"cache": cache, "bodies": count, **row, "to_first_step_s": sum(times)})
    return envelope("bench start", {}, rows)
