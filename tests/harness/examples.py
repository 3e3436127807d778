"""pymunk's own examples, run unedited: what a user does in each, one run of one of them, and the runs of all compared.

They come with the installed pymunk and are run from there, each run in a process of its own: headless, with seeded
`random`, for 300 frames.
"""

from __future__ import annotations

import functools
import json
import math
import os
import statistics
import subprocess
import sys
import tempfile
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import pymunk
import pymunk.examples

from rigidarea.report import plain

from . import environment, facts
from .hands import Input, PlayedHost, drag, seed_everything, tap
from .watch import Watch

FRAMES = 300
#: Games of one example, each with random numbers of its own and the hand that many pixels to the right. Where one run
#: cannot tell, because a crowd's course is chance, these are counted.
GAMES = tuple(range(8))
#: Seconds after which a run is given up.
TIME_LIMIT = 240.0


class Example(NamedTuple):
    """One example: its facts, its user, what has to be looked at while it runs."""

    facts: facts.Facts | None
    """None: it lets no time pass, so there is nothing to compare."""
    script: tuple[Input, ...] = ()
    probe: Callable[[Sequence[pymunk.Space]], Any] | None = None
    arguments: tuple[str, ...] = ()
    chance: tuple[str, ...] = ()
    """Facts of chance: they are to hold with more than half of `GAMES` of random numbers, natively and attached."""


def _line(start: tuple[float, float], end: tuple[float, float], points: int) -> list[tuple[float, float]]:
    return [
        (start[0] + (end[0] - start[0]) * i / (points - 1), start[1] + (end[1] - start[1]) * i / (points - 1))
        for i in range(points)
    ]


def _mouse(frame: int, x: float, y: float) -> Input:
    return Input(frame, "mouse", (x, y))


def _shot(frame: int, held: int) -> list[Input]:
    return [Input(frame, "button", 1), Input(frame + held, "button", 1, False)]


CORNER_DOWN = facts.rolls_into_corner((382, 326), -1, (111, 320, 407, 354))
CORNER_UP = facts.rolls_into_corner((382, 273), 1, (11, 280, 407, 246))

EXAMPLES: dict[str, Example] = {
    "arrows": Example(facts.arrows_stick, (_mouse(0, 300, 200), *_shot(10, 65), *_shot(120, 65))),
    "balls_and_lines": Example(
        facts.line_holds,
        (
            _mouse(0, 20, 20),
            *drag(5, 3, _line((100, 400), (500, 400), 10)),
            *drag(20, 1, [(300, 300)]),
            _mouse(21, 20, 20),
            _mouse(200, 300, 385),
        ),
        facts.ball_size,
    ),
    "basic_test": Example(facts.falls_freely),
    "bouncing_balls": Example(facts.bounces),
    "box2d_pyramid": Example(facts.pyramid_stands),
    "box2d_vertical_stack": Example(facts.stacks_stand_until_shot, tuple(tap(90, "SPACE"))),
    "breakout": Example(
        facts.breakout, (*tap(60, "SPACE"), *tap(100, "SPACE"), *tap(120, "LEFT", 10), *tap(200, "RIGHT", 10))
    ),
    "camera": Example(facts.sprung_body_stays, tuple(tap(50, "LEFT", 20))),
    "collisions": Example(facts.moves_nothing, tuple(_mouse(10 + i, 100 + 2 * i, 300) for i in range(150))),
    "colors": Example(facts.balls_are_deterministic, (*tap(0, "r"), *tap(150, "r")), facts.places),
    "colors_pyglet_batch": Example(facts.crowd_stays_between_walls),
    "constraints": Example(facts.constraints_hold, tuple(drag(100, 1, _line((250, 180), (300, 100), 30)))),
    "contact_and_no_flipy": Example(CORNER_DOWN),
    "contact_with_friction": Example(CORNER_UP),
    "copy_and_pickle": Example(facts.copies_agree, (*tap(100, "s"), *tap(200, "l")), facts.positions),
    "damped_rotary_spring_pointer": Example(facts.gun_points, (_mouse(30, 400, 300), _mouse(60, 400, 400))),
    "deformable": Example(
        facts.terrain_holds,
        (
            *drag(20, 1, _line((100, 450), (300, 500), 20)),
            *tap(60, "g"),
            Input(80, "key", "LSHIFT"),
            # aslant, as a hand would: straight down it makes a column of balls that natively stands on its tip, all
            # at x = 200 to the last bit, and there is no telling who rests and who rolls
            *drag(80, 1, [(200 + i, 100 + i) for i in range(5)]),
            Input(90, "key", "LSHIFT", False),
        ),
    ),
    "flipper": Example(
        facts.flipper,
        (*tap(5, "b"), *(t for f in range(60, 240, 20) for t in (*tap(f, "f"), *tap(f, "j")))),
        # The ball comes anywhere from x = 115 to 350 (with 300 and more inside the shelf), and the flippers swing by
        # themselves: the walls' ends lie in them. Natively it is thrown up with 7 of 8 seeds, at 16 times finer steps
        # with 6 of them, and not with the same.
        chance=("a ball is thrown up again by",),
    ),
    "index_video": Example(facts.logo_holds),
    "matplotlib_util_demo": Example(None),
    "newtons_cradle": Example(facts.cradle_swings, tuple(tap(10, "f")), arguments=("/i",)),
    "planet": Example(facts.planets_orbit),
    "platformer": Example(facts.platformer, (*tap(60, "RIGHT", 26), *tap(118, "UP", 20)), facts.feet),
    "playground": Example(facts.playground, (_mouse(0, 300, 300), *tap(70, "k"), *tap(75, "f"))),
    "point_query": Example(CORNER_DOWN, (_mouse(0, 300, 300),)),
    "pygame_util_demo": Example(None),
    "pyglet_util_demo": Example(None),
    "slide_and_pinjoint": Example(facts.lever_holds),
    "spiderweb": Example(facts.web_holds, tuple(drag(100, 1, _line((320, 240), (400, 300), 30)))),
    "tank": Example(facts.tank, (_mouse(0, 520, 240),)),
    "threaded_space": Example(facts.pyramid_stands),
    "using_sprites": Example(facts.lands_on_line),
    "using_sprites_pyglet": Example(facts.lands_on_line),
}

STEPPING = tuple(name for name, example in EXAMPLES.items() if example.facts is not None)
"""The examples that let time pass."""


def by_hand(script: Sequence[Input], right: float) -> tuple[Input, ...]:
    """The same user with the hand so many pixels further to the right."""
    return tuple(i._replace(what=(i.what[0] + right, i.what[1])) if i.kind == "mouse" else i for i in script)


def record(name: str, engine: str, frames: int, file: str, seed: int = 0) -> None:
    """Run an example in this process, which is its alone, and write what happened to `file` as JSON.

    The object: `error` (None, or what it raised), `facts` (name, holds, measured), and `Watch.measures`.
    """
    example = EXAMPLES[name]
    seed_everything(seed)
    host = PlayedHost(engine, frames, by_hand(example.script, seed))
    watch = Watch(host, example.probe)
    error: str | None = None
    target = str(Path(pymunk.examples.__file__).parent / f"{name}.py")
    if (
        name != "matplotlib_util_demo"
    ):  # the only one that wants to be a file, and not a module of its package
        target = f"pymunk.examples.{name}"
    try:
        host.run(target, example.arguments)
    except (Exception, SystemExit) as raised:
        error = f"{type(raised).__name__}: {raised}"
    told: dict[str, Any] = {"error": error, "facts": [], **watch.measures()}
    if example.facts is not None:
        try:
            told["facts"] = [fact._asdict() for fact in example.facts(watch)]
        except Exception as raised:  # half a run: the facts' bodies or frames are missing
            told["facts"] = [
                {
                    "name": "the run got that far",
                    "holds": False,
                    "measured": f"{type(raised).__name__}: {raised}",
                }
            ]
    Path(file).write_text(json.dumps(plain(told)))


def run_example(name: str, engine: str, frames: int = FRAMES, seed: int = 0) -> dict[str, Any]:
    """`record` in a process and a folder of its own; adds `stderr`, and `error` where the process died.

    Raises ValueError for an unknown example.
    """
    if name not in EXAMPLES:
        raise ValueError(f"unknown example {name!r}; expected one of {', '.join(EXAMPLES)}")
    with tempfile.TemporaryDirectory(prefix="rigidarea-example-") as folder:
        file = os.path.join(folder, "told.json")
        program = (
            f"from harness.examples import record; record({name!r}, {engine!r}, {frames}, {file!r}, {seed})"
        )
        try:
            done = subprocess.run(
                [sys.executable, "-c", program],
                cwd=folder,
                env=environment(MPLBACKEND="Agg"),
                capture_output=True,
                text=True,
                timeout=TIME_LIMIT,
            )
        except subprocess.TimeoutExpired:
            return {"error": f"not finished after {TIME_LIMIT:g} s", "stderr": "", "facts": []}
        told: dict[str, Any] = {"error": f"the process ended with {done.returncode}", "facts": []}
        if os.path.exists(file):
            told = json.loads(Path(file).read_text())
        said = [line for line in done.stderr.splitlines() if not line.startswith("rigidarea: compiling")]
        return {**told, "stderr": "\n".join(said)}


def judge(native: dict[str, Any], own: dict[str, Any]) -> list[str]:
    """What is wrong with a run with area contact, beside the native one: one line each, none if nothing is.

    The facts; no exception, nothing new on standard error; nobody farther out than the native run's box by more than
    its diagonal; nobody faster than 1.5 times the fastest of the native run plus what a fall through a tenth of its
    box gives (a start at rest has a native speed of 0); joints no farther off than twice the native error and one
    pixel; of the bodies that came two seconds before the end as many at rest, up to a tenth; callbacks as often, up to
    a factor of two (contacts of a chaotic crowd are not the same ones) or 30 calls.
    """
    wrong = []
    if own["error"]:
        wrong.append(own["error"].splitlines()[0][:160])
    known = set(native["stderr"].splitlines())
    said = [line for line in own["stderr"].splitlines() if line.strip() and line not in known]
    if said:
        wrong.append(f"on standard error: {said[-1][:160]}")
    wrong += [f"{fact['name']}: {fact['measured']}" for fact in own["facts"] if not fact["holds"]]
    if "finite" not in own or "finite" not in native:
        return wrong
    if not own["finite"]:
        wrong.append("a body's state is not finite")
    if native["box"] and own["box"]:
        x0, y0, x1, y1 = native["box"]
        size = math.hypot(x1 - x0, y1 - y0)
        ox0, oy0, ox1, oy1 = own["box"]
        far = max(x0 - ox0, y0 - oy0, ox1 - x1, oy1 - y1)
        if far > size:
            wrong.append(f"a body is {far:.0f} outside the native run's box of {size:.0f}")
        allowed = 1.5 * native["fastest"] + math.sqrt(2 * 900 * size / 10)
        if own["fastest"] > allowed:
            wrong.append(f"fastest body {own['fastest']:.0f}, natively {native['fastest']:.0f}")
    if own["joint_error"] > 2 * native["joint_error"] + 1:
        wrong.append(f"joints off by {own['joint_error']:.1f}, natively {native['joint_error']:.1f}")
    if native["resting"] is not None:
        if own["resting"] is None:
            wrong.append("nobody of those whose rest is judged is there")
        elif own["resting"] < native["resting"] - 0.1:
            wrong.append(f"{own['resting']:.0%} at rest, natively {native['resting']:.0%}")
    for phase, count in native["calls"].items():
        ours = own["calls"][phase]
        if abs(ours - count) > 30 and not count / 2 <= ours <= count * 2:
            wrong.append(f"{phase} called {ours} times, natively {count}")
    return wrong


def widened(native: dict[str, Any], others: Sequence[dict[str, Any]]) -> dict[str, Any]:
    """A native run with the box and the fastest body of it and of others, of other games."""
    runs = [run for run in (native, *others) if run.get("box")]
    if not native.get("box"):
        return native
    boxes = [run["box"] for run in runs]
    low, high = ([pick(box[i] for box in boxes) for i in at] for pick, at in ((min, (0, 1)), (max, (2, 3))))
    return {**native, "box": [*low, *high], "fastest": max(run["fastest"] for run in runs)}


def typical(run: dict[str, Any], games: Sequence[dict[str, Any]]) -> dict[str, Any]:
    """The run with the share at rest that is the median of the games; unchanged where it has none."""
    shares = [game["resting"] for game in games if game.get("resting") is not None]
    return {**run, "resting": statistics.median(shares)} if shares and run.get("resting") is not None else run


def by_chance(run: dict[str, Any], games: Sequence[dict[str, Any]], names: Sequence[str]) -> dict[str, Any]:
    """The run, its facts of these names replaced: each holds if it does in more than half of the games."""
    facts = []
    for fact in run["facts"]:
        if fact["name"] in names:
            held = sum(any(f["name"] == fact["name"] and f["holds"] for f in game["facts"]) for game in games)
            told = f"{fact['measured']}; in {held} of {len(games)} games (expected more than half)"
            fact = {**fact, "holds": 2 * held > len(games), "measured": told}
        facts.append(fact)
    return {**run, "facts": facts}


def compare(name: str, frames: int = FRAMES) -> dict[str, Any]:
    """One row of the table: an example natively and with area contact.

    Where something is wrong, GAMES are asked, natively how far bodies get and how fast, and of both how many are at
    rest: natively the ball of `flipper` is lost in five of eight, and the blocks of `playground` that rest at the end
    are from 0.73 to 0.98 of all, as the hand that drops them is a pixel further left or right.
    `native_wrong` lists facts that do not hold natively either: the fact is wrong then, not the contact.
    """
    native, own = (run_example(name, engine, frames) for engine in ("pymunk", "area"))
    steps = EXAMPLES[name].facts is not None

    def ratio(key: str) -> float | None:
        return own[key] / native[key] if steps and own.get(key) and native.get(key) else None

    @functools.cache
    def games(engine: str) -> list[dict[str, Any]]:
        return [run_example(name, engine, frames, seed) for seed in GAMES]

    if EXAMPLES[name].chance:
        native = by_chance(native, games("pymunk"), EXAMPLES[name].chance)
        own = by_chance(own, games("area"), EXAMPLES[name].chance)
    wrong = judge(native, own)
    if wrong and steps:  # a game of chance?
        native = typical(widened(native, games("pymunk")), games("pymunk"))
        own = typical(own, games("area"))
        wrong = judge(native, own)
    return {
        "example": name,
        "steps_time": steps,
        "bodies": own.get("bodies"),
        "facts": len(native["facts"]),
        "right": not wrong,
        "wrong": wrong,
        "native_wrong": [f"{f['name']}: {f['measured']}" for f in native["facts"] if not f["holds"]]
        + ([native["error"]] if native["error"] else []),
        "step_ms": own.get("step_ms"),
        "step_over_native": ratio("step_ms"),
        "frame_ms": own.get("frame_ms"),
        "frame_over_native": ratio("frame_ms"),
    }
