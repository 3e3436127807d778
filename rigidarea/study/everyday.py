"""`bench everyday`: game scenes at the defaults, beside pymunk at one and four steps a frame and Box2D v3.

All engines run the same scene in turns of a few frames, on one core, and each frame is timed by itself in processor
time: what slows the machine slows them alike, and nobody's memory is cold. Nobody sleeps.
`bench sleep`: what a frame costs once a large pile does.
"""

from __future__ import annotations

import statistics
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from ..report import Progress, envelope
from .everyday_scenes import EVERYDAY, Everyday, metre_pyramid
from .peers import Run, Settings, get_peer
from .records import Row
from .scene import VX, VY, Array, Scene, Trace, X, check_known
from .timing import one_core, spent

OURS = "rigidarea"
SLOP = 0.1 / 30
"""pymunk's default collision slop, 0.1 px, over the side of a body of 30 px (and so in metres too)."""
PEERS: dict[str, tuple[str, dict[str, Any]]] = {
    OURS: ("rigidarea-default", {}),
    "native_1": ("pymunk", {"steps": 1, "iterations": 10, "slop": SLOP}),
    "native_4": ("pymunk", {"steps": 4, "iterations": 10, "slop": SLOP}),
    "box2d": ("box2d", {"steps": 1, "substeps": 4, "stiff": False, "length": 1}),
}
"""Who runs, by the name that the rows' keys have: (peer, settings). All as their users find them."""
TOLD = (
    *("scene", "bodies", "steps_per_frame", "frame_ms_median", "native_1_ms", "native_4_ms", "box2d_ms"),
    *("ratio", "ratio_worst", "speed_left", "native_1_speed_left", "native_4_speed_left", "box2d_speed_left"),
    *("shift", "native_4_shift", "contacts", "native_contacts", "inside"),
)
"""Keys of a row that the command prints as a table; the files have all."""
LAST_S = 1.0
"""The time at the end in which a scene is asked whether it has come to rest (s)."""
MOVING_S = 4.0
"""The time at the start in which things fall, collapse and come to rest (s)."""
LOOK_EVERY = 6
"""Frames between two looks at the speeds then: reading 10,000 bodies takes longer than moving them."""
BLOCK = 10
"""Frames of one engine before it is the next one's turn: the first finds its memory gone from the cache, and the median
leaves it out.
"""
WARM = 10
"""Frames whose time does not count."""


@dataclass
class Course:
    """What is measured of one engine on one scene."""

    run: Run
    start: Array
    frame: float
    """Simulated time of a frame (s)."""
    frame_ms: list[float] = field(default_factory=list)
    contacts: list[int] = field(default_factory=list)
    speed_left: float = 0.0
    inside: bool = True
    shift: float = 0.0
    """Largest sideways displacement of a body, over the body size."""

    def row(self) -> Row:
        """As a row of the output has it."""
        times = self.frame_ms[min(WARM, len(self.frame_ms) - 1) :]
        moving = sorted(times[: max(1, round(MOVING_S / self.frame) - WARM)])
        return {
            "moving_ms": statistics.mean(moving),
            "moving_worst_ms": statistics.mean(moving[-max(1, len(moving) // 10) :]),
            "steps_per_frame": self.run.steps,
            "frame_ms_median": statistics.median(times),
            "frame_ms_p99": float(np.percentile(times, 99)),
            "frame_ms_worst": max(times),
            "contacts": statistics.mean(self.contacts) if self.contacts else None,
            "speed_left": self.speed_left,
            "inside": self.inside,
            "shift": self.shift,
        }


def race(scene: Scene, engines: Mapping[str, tuple[str, Settings]]) -> dict[str, Course]:
    """Run a scene on every engine, in turns of `BLOCK` frames."""
    moving = [i for i, body in enumerate(scene.bodies) if body.kind == "dynamic"]
    names = tuple(body.name for body in scene.bodies)
    courses = {}
    for name, (peer, settings) in engines.items():
        run = get_peer(peer).build(scene, settings)
        courses[name] = Course(run, run.state()[moving], scene.frame)
    second = round(1 / scene.frame)
    last = scene.frames - round(LAST_S / scene.frame)
    with one_core():
        for first in range(0, scene.frames, BLOCK):
            for course in courses.values():
                for frame in range(first + 1, min(first + BLOCK, scene.frames) + 1):
                    course.frame_ms.append(1e3 * spent(course.run.advance, 1))
                    if frame > last and frame % LOOK_EVERY == 0:
                        course.speed_left = max(course.speed_left, fastest(course.run.state()[moving]))
                    if frame % second == 0 and hasattr(course.run, "contacts"):
                        course.contacts.append(course.run.contacts())
    for course in courses.values():
        end = course.run.state()
        left = scene.measure(Trace(names, np.array([scene.duration]), end[None]))
        course.inside = left == 0.0
        course.shift = float(np.max(np.abs(end[moving, X] - course.start[:, X]))) / scene.size
    return courses


def fastest(states: Array) -> float:
    """Speed of the fastest body (length/time); infinite where a state is none."""
    speed = float(np.max(np.hypot(states[:, VX], states[:, VY])))
    return speed if np.isfinite(speed) else float("inf")


def everyday(
    names: Sequence[str] = (),
    seeds: int | None = None,
    peer_names: Sequence[str] = (),
    settings: Mapping[str, Any] | None = None,
    seconds: float | None = None,
) -> Row:
    """Frame times (ms, processor time) of game scenes at the defaults.

    names: scenes (default: all). seeds: how many of each (default: the scene's own number). peer_names: of `PEERS`
    (default: all). settings: of `rigidarea`, instead of its defaults: `steps`, `iterations`, `penetration` ...
    seconds: simulated time (default: the scene's own, 7 or 2).

    Rows: a scene each, medians over its seeds: scene, title, bodies, steps_per_frame, frame_ms_median, native_1_ms,
    native_4_ms, box2d_ms, ratio (to native_1, median over seeds), ratio_worst, speed_left (the fastest body of the
    last second, the seeds' worst; likewise native_1_speed_left ...), contacts (pairs a frame), native_contacts (of
    native_1, whose frame is the measure), native_4_contacts, inside (whether every body of every seed stayed in the
    room; native_1_inside ...), shift (sideways, over a body's side), moving_ms and moving_worst_ms (of the first
    `MOVING_S`: the mean frame, and the mean of the slowest tenth; native_1_moving_ms ...). `runs`: a row a scene, seed
    and engine. `summary`: median and worst ratio of the judged scenes, and which fell short in what.
    """
    chosen = list(names) or list(EVERYDAY)
    check_known(chosen, EVERYDAY, "scene")
    check_known(peer_names, PEERS, "engine")
    if seconds is not None and not seconds >= LAST_S:
        raise ValueError(f"seconds must be at least {LAST_S:g}, got {seconds!r}")
    engines: dict[str, tuple[str, Settings]] = {
        name: found for name, found in PEERS.items() if not peer_names or name in peer_names
    }
    if settings and OURS in engines:
        engines[OURS] = ("rigidarea", dict(settings))
    progress = Progress("everyday", sum(seeds or EVERYDAY[name].seeds for name in chosen))
    rows, runs = [], []
    for name in chosen:
        described = EVERYDAY[name]
        here = []
        for seed in range(1, (seeds or described.seeds) + 1):
            scene = described.make(seed)
            if seconds is not None:
                scene = replace(scene, duration=seconds)
            playing = {k: v for k, v in engines.items() if not get_peer(v[0]).refuses(scene)}
            here.append({name: course.row() for name, course in race(scene, playing).items()})
            runs += [
                {"scene": name, "seed": seed, "engine": engine, **row} for engine, row in here[-1].items()
            ]
            progress.step(f"{name}, seed {seed}")
        bodies = sum(body.kind == "dynamic" for body in scene.bodies)
        rows.append({"scene": name, "title": described.title, "bodies": bodies, **summed(described, here)})
    asked = {
        "scenes": chosen,
        "seeds": seeds,
        "seconds": seconds,
        "engines": {name: {"peer": peer, **more} for name, (peer, more) in engines.items()},
    }
    return envelope("bench everyday", asked, rows, runs=runs, summary=summary(rows))


def summed(described: Everyday, here: Sequence[Mapping[str, Row]]) -> Row:
    """The seeds of one scene as one row."""

    def over(engine: str, key: str, how: Any) -> Any:
        values = [found[engine][key] for found in here if engine in found]
        return how(values) if values and values[0] is not None else None

    middle = statistics.median
    ratios = [
        found[OURS]["frame_ms_median"] / found["native_1"]["frame_ms_median"]
        for found in here
        if OURS in found and "native_1" in found
    ]
    others = ("native_1", "native_4", "box2d")
    row = {
        "steps_per_frame": over(OURS, "steps_per_frame", max),
        "frame_ms_median": over(OURS, "frame_ms_median", middle),
        "frame_ms_worst": over(OURS, "frame_ms_worst", max),
        "moving_ms": over(OURS, "moving_ms", middle),
        "moving_worst_ms": over(OURS, "moving_worst_ms", middle),
        **{f"{engine}_ms": over(engine, "frame_ms_median", middle) for engine in others},
        "ratio": middle(ratios) if ratios else None,
        "ratio_worst": max(ratios, default=None),
        "speed_left": over(OURS, "speed_left", max),
        "contacts": over(OURS, "contacts", middle),
        "native_contacts": over("native_1", "contacts", middle),
        "native_4_contacts": over("native_4", "contacts", middle),
        "inside": over(OURS, "inside", all),
        "shift": over(OURS, "shift", max),
        "rests": described.rests,
        "stands": described.stands,
        "judged": described.judged,
    }
    ways = {"moving_ms": middle, "moving_worst_ms": middle, "speed_left": max, "inside": all, "shift": max}
    return row | {f"{engine}_{key}": over(engine, key, how) for engine in others for key, how in ways.items()}


def summary(rows: Sequence[Row]) -> Row:
    """Of the judged scenes: median and worst ratio, and those that did not keep what is asked of them."""
    judged = [row for row in rows if row["judged"] and row["ratio"] is not None]
    return {
        "scenes": [row["scene"] for row in judged],
        "ratio_median": statistics.median(row["ratio"] for row in judged) if judged else None,
        "ratio_worst": max((row["ratio"] for row in judged), default=None),
        "left_the_room": [row["scene"] for row in rows if row["inside"] is False],
        "faster_than_native_4": [
            row["scene"]
            for row in rows
            if row["rests"]
            and None not in (row["speed_left"], row["native_4_speed_left"])
            and row["speed_left"] > row["native_4_speed_left"]
        ],
        "contacts_off": [
            row["scene"]
            for row in rows
            if row["contacts"]
            and row["native_contacts"]
            and abs(row["contacts"] / row["native_contacts"] - 1) > 0.2
        ],
    }


# Asleep -----------------------------------------------------------------------------------------------------

SLEEP_S = 0.5
"""How long a body has to be still before it may sleep (s), in every engine (Box2D's own value)."""


def sleep(rows: int = 100, most_s: float = 20.0, peer_names: Sequence[str] = ()) -> Row:
    """A pyramid (100 rows: 5,050 boxes, in metres) that is allowed to sleep: frame times awake and asleep (ms).

    Rows: scene, bodies, engine, asleep (bodies at the end), asleep_after_s (None: not all within `most_s`),
    frame_ms_awake (median of the frames until then), frame_ms_asleep (None likewise).
    """
    scene = metre_pyramid(rows)(1)
    moving = [i for i, body in enumerate(scene.bodies) if body.kind == "dynamic"]
    wanted = {k: v for k, v in PEERS.items() if not peer_names or k in peer_names}
    wanted = {k: v for k, v in wanted.items() if not get_peer(v[0]).refuses(scene)}
    progress = Progress("sleep", len(wanted))
    found = []
    for engine, (peer, settings) in wanted.items():
        run: Any = get_peer(peer).build(scene, settings)
        if hasattr(run, "space"):
            run.space.sleep_time_threshold = SLEEP_S
        else:
            run.world.sleeping_enabled = True
        awake: list[float] = []
        asleep = 0
        with one_core():
            while asleep < len(moving) and len(awake) * scene.frame < most_s:
                awake += _frames_ms(run, 10)
                asleep = sum(_sleeps(run.bodies[i]) for i in moving)
            still = _frames_ms(run, 200) if asleep == len(moving) else []
        found.append(
            {
                "scene": scene.name,
                "bodies": len(moving),
                "engine": engine,
                "asleep": asleep,
                "asleep_after_s": len(awake) * scene.frame if still else None,
                "frame_ms_awake": statistics.median(awake),
                "frame_ms_asleep": statistics.median(still) if still else None,
            }
        )
        progress.step(engine)
    return envelope("bench sleep", {"rows": rows, "most_s": most_s, "sleep_time_threshold_s": SLEEP_S}, found)


def _sleeps(body: Any) -> bool:
    return bool(body.is_sleeping) if hasattr(body, "is_sleeping") else not body.awake


def _frames_ms(run: Run, count: int) -> list[float]:
    return [1e3 * spent(run.advance, 1) for _ in range(count)]
