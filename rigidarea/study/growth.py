"""`bench growth`: what a frame costs by what is there: levels, terrains, sleepers, what comes and goes, what flies.

All engines run the same scene in turns of a few frames, each frame timed by itself in processor time, as a program
steps its space: `space.step(1 / 60)`. In pixels; bodies of 30.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import pymunk

import rigidarea

from ..chipmunk.phases import PHASES
from ..report import Progress, envelope
from .everyday import BLOCK
from .everyday_bodies import GRAVITY_PX as GRAVITY
from .everyday_bodies import SIDE_PX as SIDE
from .growing_scenes import GROWING, Growing
from .peers import drive, get_peer
from .peers.pymunk_peer import make_space, plain_shapes
from .records import Row
from .scene import Body, Scene, check_known, set_up
from .timing import exponent, one_core, spent

FRAME = 1 / 60
BURST = 5
"""Bodies that come, and go, in each frame of `come`."""
BOX2D = {"steps": 1, "substeps": 4, "stiff": False, "length": 1}


class _Course:
    """A scene in an engine: `advance` is its step, `renewed` what is put in place of one of `moving`."""

    moving: list[Any]
    advance: Callable[[], None]
    renewed: Callable[..., tuple[Any, Any]]

    def __init__(self, growing: Growing, scene: Scene) -> None:
        self.growing, self.scene, self.gone, self.start_s = growing, scene, 0, math.nan

    def frame(self) -> None:
        for _ in range(BURST if self.growing.changes else 0):
            k = 7 * self.gone % len(self.moving)
            self.moving[k] = self.renewed(*self.moving[k])
            self.gone += 1
        self.advance()


class _Space(_Course):
    """A scene in a pymunk space, attached or not."""

    def __init__(self, growing: Growing, scene: Scene, ours: bool) -> None:
        super().__init__(growing, scene)
        self.space, bodies = make_space(scene, plain_shapes)
        self.moving = [(b, next(iter(b.shapes))) for b in bodies if b.body_type == pymunk.Body.DYNAMIC]
        if growing.asleep:
            self.space.sleep_time_threshold = 0.2
            while any(not body.is_sleeping for body, _ in self.moving):
                self.advance()
        self.start_s = spent(self._begin, ours)

    def _begin(self, ours: bool) -> None:
        if ours:
            rigidarea.attach(self.space)
        self.advance()

    def advance(self) -> None:
        self.space.step(FRAME)

    def renewed(self, body: pymunk.Body, shape: pymunk.Shape) -> tuple[pymunk.Body, pymunk.Shape]:
        new = pymunk.Body(1.0, 0.5 * (SIDE / 2) ** 2)
        new.position = body.position
        disc = pymunk.Circle(new, SIDE / 2)
        disc.friction = shape.friction
        self.space.remove(body, shape)
        self.space.add(new, disc)
        return new, disc


class _World(_Course):
    """The same in Box2D."""

    def __init__(self, growing: Growing, scene: Scene, ours: bool) -> None:
        super().__init__(growing, scene)
        run: Any = get_peer("box2d").build(scene, BOX2D)
        pairs = zip(run.bodies, scene.bodies)
        self.moving = [(made, body) for made, body in pairs if body.kind == "dynamic"]
        self.run = run
        if growing.asleep:
            run.world.sleeping_enabled = True
            while any(made.awake for made, _ in self.moving):
                run.advance(10)

    def advance(self) -> None:
        self.run.advance(1)

    def renewed(self, made: Any, body: Body) -> tuple[Any, Body]:
        made.destroy()
        return self.run.add(self.scene, body, 1e-3), body


def _scene(growing: Growing, name: str, size: int, course: int = 0) -> Scene:
    made = growing.make(size, seed=growing.seeds[course]) if growing.seeds else growing.make(size)
    return set_up(name, made, 1.0, gravity=(0.0, -GRAVITY), friction=0.5, size=SIDE, pressure=GRAVITY / SIDE)


def measured(name: str, size: int, engines: Sequence[str]) -> Row:
    """One scene at one size, all its courses: times of a frame (µs), of all engines in turns."""
    growing = GROWING[name]
    kinds: dict[str, Any] = {"native_1": _Space, "frame": _Space, "box2d": _World}
    times: dict[str, list[float]] = {engine: [] for engine in engines}
    for course in range(max(1, len(growing.seeds))):
        scene = _scene(growing, name, size, course)
        runs = {engine: kinds[engine](growing, scene, engine == "frame") for engine in engines}
        with one_core():
            for first in range(-growing.settle, growing.frames, BLOCK):
                for engine, run in runs.items():
                    found = [1e6 * spent(run.frame) for _ in range(BLOCK)]
                    times[engine] += found if first >= 0 else []
    shapes = sum(len(body.shapes) for body in scene.bodies)
    row: Row = {"scene": name, "size": size, "shapes": shapes}
    for engine in kinds:
        found = sorted(times.get(engine, []))
        mean = "frame_us_mean" if engine == "frame" else f"{engine}_us"
        worst = f"{mean.removesuffix('_mean')}_worst_tenth"
        row[mean] = float(np.mean(found)) if found else None
        row[worst] = float(np.mean(found[-max(1, len(found) // 10) :])) if found else None
    for ratio, key in (("ratio_mean", "us_mean"), ("ratio_worst_tenth", "us_worst_tenth")):
        ours, theirs = row[f"frame_{key}"], row[f"native_1_{key.removesuffix('_mean')}"]
        row[ratio] = ours / theirs if ours and theirs else None
    if "frame" in runs:
        row["start_ms"] = 1e3 * runs["frame"].start_s
        row["start_us_per_shape"] = 1e6 * runs["frame"].start_s / shapes
    return row


def small_spaces() -> Row:
    """`attach` and the first frame of the second and later of 30 spaces, empty and with 20 bodies (ms)."""
    bodies = 20
    row: Row = {"scene": "small spaces", "size": bodies, "shapes": bodies + 1}
    for n, key in ((0, "start_empty_ms"), (bodies, "start_ms")):
        times = []
        for _ in range(30):
            space = pymunk.Space()
            space.gravity = 0, -GRAVITY
            made = [pymunk.Body(1, 1) for _ in range(n)]
            for i, body in enumerate(made):
                body.position = 1.5 * SIDE * i, 0
                space.add(body, pymunk.Poly.create_box(body, (SIDE, SIDE)))
            space.add(pymunk.Segment(space.static_body, (-SIDE, -20), (2 * SIDE * bodies, -20), 5))
            times.append(1e3 * spent(lambda space=space: (rigidarea.attach(space), space.step(FRAME))))
        row[key] = float(np.median(times[1:]))
    row["start_us_per_shape"] = 1e3 * row["start_ms"] / (bodies + 1)
    return row


PHASED = {"settled": ("tiles", 0), "rolling": ("rolling discs 3", 200), "collapsing": ("pit boxes 5", 100)}
"""Scenes whose frames are taken apart (`phases`)."""


def phases() -> list[Row]:
    """Where the time of a frame goes (µs, processor time, means): what Chipmunk itself does, and our own phases.

    Rows: scene, frame_us, chipmunk_us (all that is not ours, pymunk's Python too), then each of
    `rigidarea.chipmunk.phases.PHASES`. Reading the clock takes 0.3 µs a phase and substep of it.
    """
    rows = []
    for title, (name, size) in PHASED.items():
        growing = GROWING[name]
        run = _Space(growing, _scene(growing, name, size), True)
        contact = rigidarea.attached(run.space)
        assert contact is not None
        times = np.zeros(len(PHASES) + 1)
        with one_core():
            for _ in range(growing.settle):
                run.frame()
            contact._state["phases_at"] = times.ctypes.data
            whole = spent(drive, run.frame, growing.frames)
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
    check_known(names, known, "scene")
    engines = [engine for engine in ("native_1", "frame", "box2d") if not peer_names or engine in peer_names]
    if "box2d" in engines and get_peer("box2d").refuses(_scene(GROWING["lift"], "lift", 0)):
        engines.remove("box2d")
    families = [name for name in names or GROWING if name in GROWING]
    chosen = [(name, size) for name in families for size in sizes or GROWING[name].sizes]
    progress = Progress("growth", len(chosen) + 1)
    if "frame" in engines:
        measured("falling", 1000, ["frame"])  # what a process loads once is no frame's
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
            own = [row for row in rows if row["scene"] == name and row["size"] > 0 and row.get(key)]
            if len(own) > 1:
                slope = exponent([row["size"] for row in own], [row[key] for row in own])
                found.append({"scene": name, "engine": key, "exponent": slope})
    return found
