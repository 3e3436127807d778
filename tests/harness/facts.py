"""What the authors of pymunk's examples meant to happen, as facts about a run.

Written from reading each example, before it was run with area contact; all of them hold with pymunk's own response.
Lengths are pixels, as the examples count; frames are numbered from 1.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np
import pymunk

from .watch import Fact, Watch

Facts = Callable[[Watch], list[Fact]]


def within(name: str, value: float, low: float, high: float) -> Fact:
    """The fact that low <= value <= high."""
    return Fact(name, bool(low <= value <= high), f"{value:.4g} (expected {low:.4g} to {high:.4g})")


def true(name: str, holds: bool, measured: object) -> Fact:
    """The fact that something holds; measured: what was seen, for the table."""
    return Fact(name, bool(holds), str(measured))


def lowest(w: Watch, up: int, inside: Callable[[np.ndarray], np.ndarray]) -> float:
    """The lowest place (up: which sign of y is up) that a dynamic body reached where inside(x).

    NaN, of which no fact holds, where none did.
    """
    dynamic = w.dynamic()
    ys = [
        up * frame.state[np.isin(frame.numbers, dynamic) & inside(frame.state[:, 0])][:, 1]
        for frame in w.frames
    ]
    seen = np.concatenate(ys) if ys else np.zeros(0)
    return float(np.min(seen)) if len(seen) else math.nan


# --- balls and boxes on lines ---


def rolls_into_corner(first: tuple[float, float], up: int, slope: tuple[float, float, float, float]) -> Facts:
    """Facts of a body that comes down on a sloping line with a wall at its end.

    first: where it ends, x and y. up: which sign of y is up. slope: the line's ends, x0, y0, x1, y1 (pixels).
    """

    def facts(w: Watch) -> list[Fact]:
        path = w.path(w.dynamic()[0])
        x0, y0, x1, y1 = slope
        on = (path[:, 1] > x0) & (path[:, 1] < x1 - 30)
        line = y0 + (path[:, 1] - x0) * (y1 - y0) / (x1 - x0)
        under = np.max(up * (line - path[:, 2])[on]) if on.any() else math.nan
        return [
            within("the first body ends in the corner: x", path[-1, 1], first[0] - 5, first[0] + 5),
            within("and y", path[-1, 2], first[1] - 5, first[1] + 5),
            within("its middle stays above the line", float(under), -math.inf, 0),
        ]

    return facts


def bounces(w: Watch) -> list[Fact]:
    """bouncing_balls: the first ball rebounds by its elasticity, and none gets under the line."""
    path = w.path(w.dynamic()[0])
    start, bottom = path[0, 2], int(np.argmax(path[:80, 2]))  # y points down
    after = path[bottom : bottom + 60, 2]
    rebound = (path[bottom, 2] - after.min()) / (path[bottom, 2] - start)
    return [
        within("rebound over fall (elasticity 0.95, a sloping line)", rebound, 0.6, 1.02),
        within("no ball under the line", lowest(w, -1, lambda x: (x > 115) & (x < 400)), -360, math.inf),
    ]


def falls_freely(w: Watch) -> list[Fact]:
    """basic_test: the body falls along the parabola, and is removed below 0."""
    path = w.path(w.dynamic()[0])
    t = (path[:, 0] - path[0, 0] + 1) / 50
    error = np.max(np.abs(path[:, 2] - (400 - 450 * t**2)))
    # one step of 1/50 s: symplectic Euler is g h t / 2 off
    return [
        within("off the parabola", float(error), 0, 900 / 50 * t[-1] / 2 * 1.1),
        true("gone from the space when below 0", not w.space.bodies, len(w.space.bodies)),
    ]


def line_holds(w: Watch) -> list[Fact]:
    """balls_and_lines: the ball rests on the line that was drawn, and grows while the mouse touches it."""
    path = w.path(w.dynamic()[0])
    rest = path[path[:, 0] == 195][0]
    radii = w.probed
    return [
        within("the ball rests on the drawn line", rest[2], 200 + 10 - 2, 200 + 10 + 2.5),
        within("without moving", math.hypot(rest[4], rest[5]), 0, 10),
        within("touched by the mouse it grows", radii[-1][0], 12, 100),
        # made under the mouse, which is gone in the next frame or the one after
        within("and not while it is not", radii[194][0], 10, 10.4),
    ]


def stays_in_scene(low: tuple[float, float], high: tuple[float, float], least: int = 1) -> Facts:
    """The fact that in every frame nobody is outside, and that so many dynamic bodies at least are there at the end:
    an empty scene, or one whose bodies are nowhere (NaN), is none in which they stay."""

    def facts(w: Watch) -> list[Fact]:
        dynamic = w.dynamic()
        outside, there = 0, 0
        for frame in w.frames:
            at = frame.state[np.isin(frame.numbers, dynamic), :2]
            inside = ((at >= low) & (at <= high)).all(axis=1)
            outside, there = max(outside, int(np.sum(~inside))), int(np.sum(inside))
        return [
            within("most bodies outside at a time", outside, 0, 0),
            within("bodies in the scene at the end", there, least, math.inf),
        ]

    return facts


# --- towers ---


def pyramid_stands(w: Watch) -> list[Fact]:
    """box2d_pyramid, threaded_space: the pyramid stands, level and where it was built."""
    start, end = w.at(1), w.at(-1)
    top = max(end, key=lambda n: start[n][1])
    tilt = max(abs(math.remainder(row[2], math.pi / 2)) for row in end.values())
    shift = max(abs(end[n][0] - start[n][0]) for n in end)
    return [
        # 25 boxes of 20 on a floor whose top is at 101
        within("height of the top box", end[top][1], 591 - 12, 591 + 12),
        within("largest tilt", tilt, 0, 0.1),
        within("largest sideways shift", shift, 0, 10),
    ]


def stacks_stand_until_shot(w: Watch) -> list[Fact]:
    """box2d_vertical_stack: the stacks stand until the ball is shot at them, which moves some boxes."""
    start, before, after = w.at(1), w.at(85), w.at(-1)
    boxes = sorted(start)
    shift = max(abs(before[n][0] - start[n][0]) for n in boxes)
    moved = sum(abs(after[n][0] - start[n][0]) > 20 for n in boxes)
    top = max(before[n][1] for n in boxes)
    return [
        within("before the shot: height of the top box", top, 56 + 190 - 5, 56 + 190 + 5),
        within("before the shot: largest sideways shift", shift, 0, 5),
        within("boxes that the ball moves", moved, 10, 50),
    ]


def playground(w: Watch) -> list[Fact]:
    """playground: the tower stands, nobody gets under the line, and what was made is there."""
    before, after = w.at(60), w.at(-1)
    tower = sorted(before)[:9]
    # nine boxes of 20 on a line at 50
    return [
        within("the tower stands after a second", max(before[n][1] for n in tower), 50 + 165, 50 + 175),
        within(
            "no body under the line",
            lowest(w, 1, lambda x: (x > 115) & (x < 485)),
            50,
            math.inf,
        ),
        within("the ball and the blocks are there", len(after), 30, 74),
    ]


# --- games ---


def arrows_stick(w: Watch) -> list[Fact]:
    """arrows: both arrows that were shot stick and come to rest."""
    pivots = sum(isinstance(j, pymunk.PivotJoint) for j in w.space.constraints)
    flown = [n for n in w.dynamic() if w.path(n)[-1, 1] > 150]
    speed = max((math.hypot(*w.path(n)[-1, 4:6]) for n in flown), default=math.inf)
    return [
        within("arrows that stuck", pivots, 2, 2),
        within("speed of those shot", speed, 0, 10),
        *stays_in_scene((20, 20), (680, 580), 2)(w),
    ]


def _above(path: np.ndarray, y: float) -> np.ndarray:
    """(k, 2) places of a path, as long as they are above y."""
    gone = np.flatnonzero(path[:, 2] < y)
    return path[: gone[0] if len(gone) else None, 1:3]


def breakout(w: Watch) -> list[Fact]:
    """breakout: balls stay in the court and keep their speed, the paddle its groove, and bricks are hit."""
    balls = [n for n in w.dynamic() if w.bodies[n].mass == 1]
    speeds = np.concatenate([np.hypot(*w.path(n)[1:, 4:6].T) for n in balls])
    places = np.concatenate([_above(w.path(n), 50) for n in balls])
    paddle = next(n for n in w.dynamic() if w.bodies[n].mass == 500)
    bricks = sum(b.body_type == pymunk.Body.KINEMATIC for b in w.space.bodies)
    return [
        within("bricks left of 105", bricks, 60, 100),
        true(
            "the balls stay in the court",
            # nothing holds them below, where the walls end: the example's sensor there is in no space
            bool((places[:, 0] >= 45).all() and (places <= 555).all()),
            f"{places.min(axis=0)} to {places.max(axis=0)}",
        ),
        within("the balls' median speed", float(np.median(speeds)), 396, 404),
        within("the paddle is on its groove", float(np.max(np.abs(w.path(paddle)[:, 2] - 100))), 0, 1),
    ]


def flipper(w: Watch) -> list[Fact]:
    """flipper: the flippers swing and come back, a ball is thrown up again, and none leaves the table."""
    right, left = w.dynamic()[:2]
    swing = np.max(np.abs(w.path(right)[:, 3]))
    balls = w.dynamic()[2:]
    rise = 0.0
    for n in balls:
        path = w.path(n)
        rise = max(rise, float(np.max(np.maximum.accumulate(path[:, 2]) - path[:, 2])))
    return [
        within("the flipper swings", float(swing), 0.2, 2),
        within("and comes back", abs(w.path(left)[-1, 3]), 0, 0.3),
        within("a ball is thrown up again by", rise, 30, 600),
        within("no ball above the table", -lowest(w, 1, lambda x: x > -1e9), -math.inf, 20),
    ]


def feet(spaces: Sequence[pymunk.Space]) -> tuple[float, float, bool]:
    """The player's place, and whether an arbiter says that it stands on something, asked as the platformer asks."""
    body = next(b for b in spaces[0].bodies if b.body_type == pymunk.Body.DYNAMIC)
    up: list[float] = []
    body.each_arbiter(lambda arbiter: up.append(-arbiter.contact_point_set.normal.y))
    return body.position.x, body.position.y, max(up, default=-1.0) > 0.5


def platformer(w: Watch) -> list[Fact]:
    """platformer: the player stands and is told so, walks, jumps and lands."""
    x, y, grounded = (np.array(column) for column in zip(*(seen for seen in w.probed if seen)))
    return [
        # feet: a circle of 10 at -5 on a line at 50 of radius 3
        within("stands on the ground", y[48], 68 - 2, 68 + 2),
        within("and is told so (frames of 20)", int(grounded[35:55].sum()), 18, 20),
        within("walks at nearly 200 a second", (x[84] - x[70]) / (14 / 60), 160, 210),
        within("jumps", float(y[120:200].max() - y[118]), 35, 110),
        within("and lands", int(grounded[200:].sum()), 50, 100),
    ]


def tank(w: Watch) -> list[Fact]:
    """tank: the tank drives to the mouse, and no box leaves the walls."""
    start, end = w.at(1), w.at(-1)
    driver = next(n for n in end if w.bodies[n].mass == 10)
    ends = np.array([row[:2] for row in end.values()])
    return [
        within("the tank comes near the mouse", math.dist(end[driver][:2], (520, 240)), 0, 90),
        within("having driven", math.dist(end[driver][:2], start[driver][:2]), 80, 300),
        within("boxes outside the walls", int(np.sum((ends < 0) | (ends > (641, 481)))), 0, 0),
    ]


# --- joints, springs, fields ---


def constraints_hold(w: Watch) -> list[Fact]:
    """constraints: every joint holds, the motor turns at its rate, the gear at its ratio."""
    motor = next(j for j in w.space.constraints if isinstance(j, pymunk.SimpleMotor))
    gear = next(j for j in w.space.constraints if isinstance(j, pymunk.GearJoint))
    numbers = {body: n for n, body in enumerate(w.bodies)}
    a, b = (w.path(numbers[body]) for body in (motor.a, motor.b))
    rate = (b[-1, 3] - a[-1, 3] - b[-61, 3] + a[-61, 3]) / 1.0
    return [
        within("joints hold", max(w.joint_errors[-30:]), 0, 1),
        within("the motor turns by pi a second", abs(rate), 0.9 * math.pi, 1.1 * math.pi),
        within("gear ratio", abs(gear.b.angle * 2 - gear.a.angle - gear.phase), 0, 0.05),
        *stays_in_scene((0, 0), (1200, 600), 20)(w),
    ]


def gun_points(w: Watch) -> list[Fact]:
    """damped_rotary_spring_pointer: the gun points at the mouse."""
    gun = w.path(w.dynamic()[0])
    return [
        within(
            "the gun points at the mouse", abs(math.remainder(gun[-1, 3] - math.pi / 4, math.tau)), 0, 0.05
        )
    ]


def cradle_swings(w: Watch) -> list[Fact]:
    """newtons_cradle: the last ball swings out, then the first, and the rods keep their length."""
    first, last = w.path(w.dynamic()[0])[:, 1], w.path(w.dynamic()[-1])[:, 1]
    hit = int(np.argmax(np.abs(last - last[0])))  # by then the first has been let go, and has struck
    return [
        within("the last ball swings out", float(np.abs(last - last[0])[hit]), 100, 250),
        # that it was drawn aside and let go is no swing of its own: it is knocked out again when the last comes back
        within("and then the first", float(np.ptp(first[hit:])), 100, 500),
        within("the rods keep their length", max(w.joint_errors), 0, 0.5),
    ]


def planets_orbit(w: Watch) -> list[Fact]:
    """planet: most planets keep their angular momentum, and all of them together nearly do."""
    start, end = w.at(1), w.at(-1)

    def momentum(row: np.ndarray) -> float:
        return float((row[0] - 300) * row[4] - (row[1] - 300) * row[3])

    # orbits conserve it one by one; planets of 3 across meet now and then and pass some on
    kept = np.mean([abs(momentum(end[n]) / momentum(start[n]) - 1) < 0.02 for n in end])
    return [
        within("share of planets that keep their angular momentum", float(kept), 0.8, 1),
        within(
            "of all of them",
            sum(map(momentum, end.values())) / sum(map(momentum, start.values())),
            0.97,
            1.03,
        ),
    ]


def sprung_body_stays(w: Watch) -> list[Fact]:
    """camera: the body on springs stays about its place."""
    start, end = w.at(1), w.path(w.dynamic()[0])
    far = float(np.max(np.hypot(*(end[:, 1:3] - start[w.dynamic()[0]][:2]).T)))
    return [within("the sprung angle stays about its place", far, 0, 80)]


def web_holds(w: Watch) -> list[Fact]:
    """spiderweb: the web hangs about the middle and keeps its springs."""
    middle = w.path(w.dynamic()[0])
    return [
        within("the middle of the web hangs about the middle", abs(middle[-1, 1] - 320), 0, 60),
        within("and below it", 240 - middle[-1, 2], -60, 200),
        within("springs", len(w.space.constraints), 100, 1000),
    ]


def lever_holds(w: Watch) -> list[Fact]:
    """slide_and_pinjoint: the joints hold, and the beam turns no further than its limit."""
    beam = w.path(w.dynamic()[0])
    return [
        within("joints hold", max(w.joint_errors[-60:]), 0, 5),
        # a slide joint of 25 on an arm of 100
        within("the beam turns no further than its limit", float(np.max(np.abs(beam[:, 3]))), 0, 0.3),
        within("balls lie on it or roll off", len(w.at(-1)), 2, 12),
    ]


# --- copies, crowds ---


def copies_agree(w: Watch) -> list[Fact]:
    """copy_and_pickle: the stacks stand, and what is loaded is what was saved."""
    saved = w.probed[99]
    first, stored = w.at(1), w.at(100)
    sagged = max(abs(stored[n][1] - first[n][1]) for n in sorted(first)[:21])
    spaces = w.host.spaces
    back = sorted(tuple(b.position) for b in spaces[2].bodies) if len(spaces) > 2 else []
    gap = max((min(math.dist(p, q) for q in saved) for p in back), default=math.inf)
    return [
        within("the stacks stand (they start 10 deep in the floor)", sagged, 0, 12),
        # saved after frame 100, loaded at 200, and standing still since
        within("the state loaded is the one that was saved", gap, 0, 6),
        *stays_in_scene((0, 0), (300, 300), 40)(w),
    ]


def balls_are_deterministic(w: Watch) -> list[Fact]:
    """colors: respawned, the balls fall to the same places, all within the walls."""
    halves = [np.array(w.probed[frame]) for frame in (141, 291)]
    same = halves[0].shape == halves[1].shape
    gap = float(np.max(np.abs(halves[0] - halves[1]))) if same else math.inf
    return [
        within("balls", len(halves[0]), 800, 800),
        within("respawned, they fall to the same places", gap, 0, 0),
        within("balls outside the walls", int(np.sum((halves[1] < 0) | (halves[1] > 600))), 0, 0),
    ]


def crowd_stays_between_walls(w: Watch) -> list[Fact]:
    """colors_pyglet_batch: all balls are there, within the walls."""
    end = np.array([row[:2] for row in w.at(-1).values()])
    return [
        within("balls", len(end), 3000, 3000),
        within("balls outside the walls", int(np.sum((end < 0) | (end[:, :1] > 600))), 0, 0),
    ]


def terrain_holds(w: Watch) -> list[Fact]:
    """deformable: the bowl holds its 25 balls, and most of those drawn are left."""
    end = w.at(-1)
    balls = sorted(end)
    lying = [math.dist(end[n][:2], (450, 120)) < 125 for n in balls]
    return [
        within("balls that are left of 25 and those drawn", len(balls), 26, 30),
        within("of the first 25, in their bowl", sum(lying[:25]), 25, 25),
    ]


def logo_holds(w: Watch) -> list[Fact]:
    """index_video: nobody gets under the floor, and the letters hold the small balls up."""

    def through(x: np.ndarray) -> np.ndarray:
        return (x > -80) & (x < 980)

    under = 0
    for frame in w.frames:
        state = frame.state[np.isin(frame.numbers, w.dynamic()) & through(frame.state[:, 0])]
        floor = 300 - (state[:, 0] + 100) * 80 / 1100
        under = max(under, int(np.sum(state[:, 1] > floor)))
    end = w.at(-1)
    small = [row for n, row in end.items() if w.bodies[n].mass < 10]
    red = w.path(next(n for n in w.dynamic() if w.bodies[n].mass == 1000))
    return [
        within("bodies under the floor at a time", under, 0, 0),
        within("bodies", len(w.dynamic()), 100, 130),
        # 110 small balls come down on the letters, which are between y = 40 and 150
        within("small balls that the letters hold up", sum(0 < row[1] < 150 for row in small), 104, 110),
        within("the first red ball has rolled off the floor, to x", red[-1, 1], -400, -100),
    ]


def moves_nothing(w: Watch) -> list[Fact]:
    """collisions: callbacks are called while sensors touch, and there is no dynamic body."""
    begun = w.host.calls["pre_solve"]
    return [
        within("pre_solve is called while the sensors touch", begun, 50, 300),
        within("dynamic bodies", len(w.dynamic()), 0, 0),
    ]


def positions(spaces: Sequence[pymunk.Space]) -> list[tuple[float, float]]:
    """Of all bodies of the first space, in order."""
    return sorted((b.position.x, b.position.y) for b in spaces[0].bodies)


def places(spaces: Sequence[pymunk.Space]) -> list[tuple[float, float]]:
    """Of the numbered shapes of the last space, by their number."""
    found = {}
    for shape in spaces[-1].shapes:
        if hasattr(shape, "data") and shape.body is not None:
            found[shape.data] = shape.body.position.x, shape.body.position.y
    return [found[key] for key in sorted(found)]


def ball_size(spaces: Sequence[pymunk.Space]) -> list[float]:
    """Radii of the dynamic circles, in the order in which they came."""
    shapes = sorted(spaces[0].shapes, key=lambda s: s._hashid)
    return [s.radius for s in shapes if isinstance(s, pymunk.Circle) and s.body and s.body.mass == 10]


def lands_on_line(w: Watch) -> list[Fact]:
    """The first logo (a triangle, 52 high) comes down on the line and stays above it."""
    path = w.path(w.dynamic()[0])
    on = (path[:, 1] > 30) & (path[:, 1] < 395)
    height = path[:, 2] - (280 + (path[:, 1] - 11) * (246 - 280) / 396)
    return [
        within(
            "its middle stays above the line",
            float(np.min(height[on])) if on.any() else math.nan,
            5,
            math.inf,
        ),
        within("and it comes down on it", float(height[-1]), 10, 60),
    ]
