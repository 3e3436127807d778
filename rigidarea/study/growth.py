"""`bench growth`: what a frame costs by what is there: levels, terrains, sleepers, what comes and goes, what flies.

All engines run the same scene in turns of a few frames, each frame timed by itself in processor time, as a program
steps its space: `space.step(1 / 60)`. In pixels; bodies of 30.
"""

from __future__ import annotations

import itertools
import math
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
import pymunk

import rigidarea

from ..report import envelope
from .peers import get_peer
from .peers.chipmunk import make_body, plain_shape, surface
from .records import Progress, Row
from .scene import Body, Circle, Polygon, Scene, Segment, box, box_moment
from .timing import one_core

SIDE = 30.0
"""Of a box, and a disc's diameter (px)."""
GRAVITY = 900.0
FRAME = 1 / 60
BLOCK = 10
"""Frames of one engine before it is the next one's turn."""
BOX2D = {"steps": 1, "substeps": 4, "stiff": False, "length": 1}
BURST = 5
"""Bodies that come, and go, in each frame of `come`."""


@dataclass(frozen=True)
class Growing:
    """A family of scenes over a size: `make(size)` its bodies; `settle`: frames that are not timed; `frames` that are.

    changes: bodies come and go; asleep: everybody sleeps before the first frame that is timed.
    """

    title: str
    make: Callable[[int], list[Body]]
    sizes: tuple[int, ...]
    settle: int = 120
    frames: int = 120
    elasticity: float = 0.0
    changes: bool = False
    asleep: bool = False


def _box(name: str, x: float, y: float, **more: Any) -> Body:
    return Body(name, (box(SIDE, SIDE),), (x, y), mass=1.0, moment=box_moment(1.0, SIDE, SIDE), **more)


def _disc(name: str, x: float, y: float, radius: float = SIDE / 2, **more: Any) -> Body:
    return Body(name, (Circle(radius),), (x, y), mass=1.0, moment=0.5 * radius**2, **more)


def _pile(n: int = 100, x: float = 0.0, y: float = 0.0) -> list[Body]:
    """n boxes in columns of ten, apart."""
    return [
        _box(f"box {i}", x + (i // 10 - n / 20) * 1.5 * SIDE, y + (i % 10 + 0.5) * SIDE) for i in range(n)
    ]


def _tile(x: float, y: float) -> Polygon:
    h = SIDE / 2
    return Polygon(((x - h, y - h), (x + h, y - h), (x + h, y + h), (x - h, y + h)))


def _level(n: int, top: float = 0.0) -> Body:
    """n tiles, 100 to a row, the upper side of the first row at `top`; none: one slab instead."""
    if n == 0:
        slab = 50 * SIDE
        corners = ((-slab, top - SIDE), (slab, top - SIDE), (slab, top), (-slab, top))
        return Body("level", (Polygon(corners),), kind="static")
    tiles = tuple(_tile((i % 100 - 49.5) * SIDE, top - (i // 100 + 0.5) * SIDE) for i in range(n))
    return Body("level", tiles, kind="static")


def tiles(n: int) -> list[Body]:
    return [_level(n), *_pile()]


def _terrain(n: int, radius: float) -> tuple[Body, Callable[[float], float]]:
    """Gentle waves that fall towards the middle, n segments of 20 px."""

    def height(x: float) -> float:
        return 12.0 * math.sin(x / 60.0) + 0.1 * abs(x)

    xs = [20.0 * (i - n / 2) for i in range(n + 1)]
    shapes = tuple(Segment((a, height(a)), (b, height(b)), radius) for a, b in itertools.pairwise(xs))
    return Body("terrain", shapes, kind="static"), height


def rolling(n: int, radius: float, boxes: bool) -> list[Body]:
    """100 discs or boxes let go on a terrain, as far apart as it is long."""
    ground, height = _terrain(n, radius)
    apart = 20.0 * n * 0.9 / 100
    made: list[Body] = [ground]
    for i in range(100):
        x = (i - 49.5) * apart
        size = min(SIDE, 0.8 * apart)
        y = height(x) + radius + 0.9 * size
        if boxes:
            shape, moment = (box(size, size),), box_moment(1.0, size, size)
            made.append(Body(f"body {i}", shape, (x, y), mass=1.0, moment=moment))
        else:
            made.append(_disc(f"body {i}", x, y, size / 2))
    return made


def pit(n: int, radius: float, boxes: bool) -> list[Body]:
    """n discs or boxes that fall into a pit of three walls."""
    wide = 1.2 * SIDE * math.sqrt(n)
    rng = np.random.default_rng(n)
    corners = [(-wide / 2, 4 * wide), (-wide / 2, 0.0), (wide / 2, 0.0), (wide / 2, 4 * wide)]
    walls = tuple(Segment(a, b, radius) for a, b in itertools.pairwise(corners))
    made = [Body("pit", walls, kind="static")]
    across = int(wide / SIDE / 1.35)
    for i in range(n):
        x = (i % across - (across - 1) / 2) * 1.3 * SIDE + rng.uniform(-2, 2)
        y = (i // across + 1) * 1.5 * SIDE
        make = _box if boxes else _disc
        made.append(make(f"body {i}", x, y, angle=float(rng.uniform(0, 6)) if boxes else 0.0))
    return made


def sleepers(n: int) -> list[Body]:
    """n boxes in columns of two on one floor."""
    floor = Segment((-n * SIDE, -5.0), (n * SIDE, -5.0), 5.0)
    made = [Body("floor", (floor,), kind="static")]
    return made + [_box(f"box {i}", (i // 2 - n / 4) * 1.5 * SIDE, (i % 2 + 0.5) * SIDE) for i in range(n)]


def come(n: int) -> list[Body]:
    """n discs side by side on one floor; in each frame some go, and others come where they were."""
    floor = Segment((-n * SIDE, -5.0), (n * SIDE, -5.0), 5.0)
    made = [Body("floor", (floor,), kind="static")]
    return made + [_disc(f"disc {i}", (i - n / 2) * 1.2 * SIDE, SIDE / 2) for i in range(n)]


def lift(n: int) -> list[Body]:
    """20 boxes on a plate that rises, n tiles elsewhere."""
    plate = Body("lift", (box(12 * SIDE, SIDE),), (0.0, 2 * SIDE), kind="kinematic", velocity=(0.0, 20.0))
    boxes = [
        _box(f"box {i}", (i % 5 - 2) * 1.5 * SIDE, 2.5 * SIDE + (i // 5 + 0.5) * SIDE) for i in range(20)
    ]
    return [_level(n, -10 * SIDE), plate, *boxes]


def flight(n: int) -> list[Body]:
    """n discs thrown, none near another."""
    across = int(math.sqrt(n)) + 1
    return [
        _disc(f"disc {i}", 3 * SIDE * (i % across), 3 * SIDE * (i // across), velocity=(100.0, 900.0))
        for i in range(n)
    ]


def _families() -> dict[str, Growing]:
    found = {
        "tiles": Growing("100 boxes on a level of tiles", tiles, (0, 1000, 10000, 40000)),
        "sleepers": Growing("boxes asleep, nobody awake", sleepers, (500, 5000, 20000), asleep=True),
        "come": Growing(
            "5 discs come and 5 go a frame", come, (300, 3000), settle=60, frames=60, changes=True
        ),
        "lift": Growing("20 boxes on a lift, tiles elsewhere", lift, (0, 1000, 10000)),
        "flight": Growing("discs in flight", flight, (200, 2000), settle=5, frames=60),
    }
    for boxes in (False, True):
        who = "boxes" if boxes else "discs"
        for radius in (0.0, 3.0):
            found[f"rolling {who} {radius:g}"] = Growing(
                f"100 {who} on terrain of radius {radius:g}",
                partial(rolling, radius=radius, boxes=boxes),
                (200, 1000),
                settle=30,
            )
        for radius in (0.0, 5.0):
            found[f"pit {who} {radius:g}"] = Growing(
                f"{who} fall into a pit, walls of radius {radius:g}",
                partial(pit, radius=radius, boxes=boxes),
                (100,),
                settle=0,
                frames=240,
            )
    return found


GROWING = _families()


class _Space:
    """A scene in a pymunk space, attached or not."""

    def __init__(self, growing: Growing, scene: Scene, ours: bool) -> None:
        self.growing, self.scene = growing, scene
        self.space = pymunk.Space()
        self.space.gravity = scene.gravity
        self.moving: list[tuple[pymunk.Body, pymunk.Shape]] = []
        for body in scene.bodies:
            self._add(body)
        if growing.asleep:
            self.space.sleep_time_threshold = 0.2
            while any(not body.is_sleeping for body, _ in self.moving):
                self.space.step(FRAME)
        self.gone = 0
        before = time.thread_time()
        if ours:
            rigidarea.attach(self.space)
        self.space.step(FRAME)
        self.start_s = time.thread_time() - before

    def _add(self, body: Body) -> None:
        made = make_body(body)
        shapes = [plain_shape(shape, made) for shape in body.shapes]  # type: ignore[arg-type]
        for shape in shapes:
            surface(shape, self.scene, body)
        self.space.add(made, *shapes)
        if body.kind == "dynamic":
            self.moving.append((made, shapes[0]))

    def frame(self) -> None:
        if self.growing.changes:
            for _ in range(BURST):
                k = 7 * self.gone % len(self.moving)
                body, shape = self.moving[k]
                new = pymunk.Body(1.0, 0.5 * (SIDE / 2) ** 2)
                new.position = body.position
                disc = pymunk.Circle(new, SIDE / 2)
                disc.friction = shape.friction
                self.space.remove(body, shape)
                self.space.add(new, disc)
                self.moving[k] = new, disc
                self.gone += 1
        self.space.step(FRAME)


class _World:
    """The same in Box2D."""

    start_s = math.nan

    def __init__(self, growing: Growing, scene: Scene, ours: bool) -> None:
        self.growing, self.scene = growing, scene
        run: Any = get_peer("box2d").build(scene, BOX2D)
        self.run = run
        moves = [body.kind == "dynamic" for body in scene.bodies]
        self.moving = [(made, body) for made, body, moving in zip(run.bodies, scene.bodies, moves) if moving]
        self.gone = 0
        if growing.asleep:
            run.world.sleeping_enabled = True
            while any(made.awake for made, _ in self.moving):
                self.run.advance(10)

    def frame(self) -> None:
        if self.growing.changes:
            import pyb2d3

            for _ in range(BURST):
                k = 7 * self.gone % len(self.moving)
                made, body = self.moving[k]
                made.destroy()
                self.moving[k] = self.run._add(pyb2d3, self.scene, body, 1e-3), body
                self.gone += 1
        self.run.advance(1)


def _scene(growing: Growing, name: str, size: int) -> Scene:
    return Scene(
        name, growing.title, tuple(growing.make(size)), 1.0, "none", lambda trace: 0.0, "bench growth",
        gravity=(0.0, -GRAVITY), friction=0.5, elasticity=growing.elasticity, size=SIDE, pressure=GRAVITY / SIDE,
    )  # fmt: skip


def measured(name: str, size: int, engines: Sequence[str]) -> Row:
    """One scene at one size: times of a frame (µs), of all engines in turns."""
    growing = GROWING[name]
    scene = _scene(growing, name, size)
    kinds: dict[str, Any] = {"native_1": _Space, "frame": _Space, "box2d": _World}
    runs = {engine: kinds[engine](growing, scene, engine == "frame") for engine in kinds if engine in engines}
    times: dict[str, list[float]] = {engine: [] for engine in runs}
    with one_core():
        for first in range(-growing.settle, growing.frames, BLOCK):
            for engine, run in runs.items():
                for _ in range(BLOCK):
                    before = time.thread_time()
                    run.frame()
                    if first >= 0:
                        times[engine].append(1e6 * (time.thread_time() - before))
    shapes = sum(len(body.shapes) for body in scene.bodies)
    row: Row = {"scene": name, "size": size, "shapes": shapes}
    for engine in kinds:
        found = sorted(times.get(engine, []))
        mean = float(np.mean(found)) if found else None
        worst = float(np.mean(found[-max(1, len(found) // 10) :])) if found else None
        if engine == "frame":
            row |= {"frame_us_mean": mean, "frame_us_worst_tenth": worst}
        else:
            row |= {f"{engine}_us": mean, f"{engine}_us_worst_tenth": worst}
    ours, theirs = row["frame_us_mean"], row["native_1_us"]
    row["ratio_mean"] = ours / theirs if ours and theirs else None
    both = row["frame_us_worst_tenth"], row["native_1_us_worst_tenth"]
    row["ratio_worst_tenth"] = both[0] / both[1] if all(both) else None
    if "frame" in runs:
        row["start_ms"] = 1e3 * runs["frame"].start_s
        row["start_us_per_shape"] = 1e6 * runs["frame"].start_s / shapes
    return row


def small_spaces(count: int = 30, bodies: int = 20) -> Row:
    """`attach` and the first frame of the second and later spaces of a process, empty and with some bodies (ms)."""
    row: Row = {"scene": "small spaces", "size": bodies, "shapes": bodies + 1}
    for n, key in ((0, "start_empty_ms"), (bodies, "start_ms")):
        times = []
        for _ in range(count):
            space = pymunk.Space()
            space.gravity = 0, -GRAVITY
            made = [pymunk.Body(1, 1) for _ in range(n)]
            for i, body in enumerate(made):
                body.position = 1.5 * SIDE * i, 0
                space.add(body, pymunk.Poly.create_box(body, (SIDE, SIDE)))
            space.add(pymunk.Segment(space.static_body, (-SIDE, -20), (2 * SIDE * bodies, -20), 5))
            before = time.thread_time()
            rigidarea.attach(space)
            space.step(FRAME)
            times.append(1e3 * (time.thread_time() - before))
        row[key] = float(np.median(times[1:]))
    row["start_us_per_shape"] = 1e3 * row["start_ms"] / (bodies + 1)
    return row


PHASED = {"settled": ("tiles", 0), "rolling": ("rolling discs 3", 200), "collapsing": ("pit boxes 5", 100)}
"""Scenes whose frames are taken apart (`phases`)."""


def phases(chosen: dict[str, tuple[str, int]] | None = None) -> list[Row]:
    """Where the time of a frame goes (µs, processor time, means): what Chipmunk itself does, and our own phases.

    Rows: scene, frame_us, chipmunk_us (all that is not ours, pymunk's Python too), then each of
    `rigidarea.contact.phases.PHASES`. Reading the clock takes 0.3 µs a phase and substep of it.
    """
    from ..contact.phases import PHASES

    rows = []
    for title, (name, size) in (chosen or PHASED).items():
        growing = GROWING[name]
        run = _Space(growing, _scene(growing, name, size), True)
        contact = rigidarea.attached(run.space)
        assert contact is not None
        times = np.zeros(len(PHASES) + 1)
        with one_core():
            for _ in range(growing.settle):
                run.frame()
            contact._state["phases_at"] = times.ctypes.data
            before = time.thread_time()
            for _ in range(growing.frames):
                run.frame()
            whole = time.thread_time() - before
            contact._state["phases_at"] = 0
        own = 1e6 * times[:-1] / growing.frames
        frame = 1e6 * whole / growing.frames
        row: Row = {"scene": title, "frame_us": frame, "chipmunk_us": frame - float(own.sum())}
        rows.append(row | {f"{phase.replace(' ', '_')}_us": float(us) for phase, us in zip(PHASES, own)})
    return rows


def growth(names: Sequence[str] = (), sizes: Sequence[int] = (), peer_names: Sequence[str] = ()) -> Row:
    """Frame times (µs, processor time) of families of scenes that grow, beside pymunk's one step and Box2D.

    names: families (default: all); sizes: instead of a family's own; peer_names: of native_1, frame (ours), box2d.
    Rows: scene, size, shapes, native_1_us, box2d_us, frame_us_mean (means of all frames that are timed), their
    `_worst_tenth` (the mean of the slowest tenth), ratio_mean and ratio_worst_tenth (ours to native_1), start_ms
    (`attach` and the first frame), start_us_per_shape. `exponents`: of each family and engine, the slope of log(mean)
    over log(size).
    """
    known = [*GROWING, "small spaces"]
    for name in names:
        if name not in known:
            raise ValueError(f"unknown scene {name!r}; expected one of {', '.join(known)}")
    engines = [engine for engine in ("native_1", "frame", "box2d") if not peer_names or engine in peer_names]
    if "box2d" in engines and get_peer("box2d").refuses(_scene(GROWING["lift"], "lift", 0)):
        engines.remove("box2d")
    chosen = [
        (name, size) for name in names or GROWING if name in GROWING for size in sizes or GROWING[name].sizes
    ]
    progress = Progress("growth", len(chosen) + 1)
    rows = [small_spaces()] if not names or "small spaces" in names else []
    for name, size in chosen:
        rows.append(measured(name, size, engines))
        progress.step(f"{name}, {size}")
    settings = {"scenes": list(names), "sizes": list(sizes), "engines": engines}
    return envelope("bench growth", settings, rows, exponents=exponents(rows))


def exponents(rows: Sequence[Row]) -> list[Row]:
    """Slope of log(mean time) over log(size) for each family and engine that has two sizes above 0 or more."""
    found = []
    for name in dict.fromkeys(row["scene"] for row in rows):
        for key in ("native_1_us", "frame_us_mean", "box2d_us"):
            logs = [
                (math.log(row["size"]), math.log(row[key]))
                for row in rows
                if row["scene"] == name and row["size"] > 0 and row.get(key)
            ]
            if len(logs) > 1:
                sizes, costs = np.array(logs).T
                slope = float(np.polyfit(sizes, costs, 1)[0])
                found.append({"scene": name, "engine": key, "exponent": slope})
    return found
