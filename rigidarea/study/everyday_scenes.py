"""Game scenes: what fills a screen, in pixels, with nothing exact to say but that all stays inside and comes to rest.

Each is a function of a seed. Bodies are made as game code makes them: floors and walls are segments, gravity is
900 px/s² down, frames last 1/60 s, masses are 1 unless said, and the seed moves everything by a little, or turns it any
way. A scene's `error` is the share of its bodies that have left the room.
"""

from __future__ import annotations

import itertools
import math
import random
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from .everyday_bodies import (
    GRAVITY_PX,
    SIDE_PX,
    WALL_PX,
    Maker,
    a_box,
    a_disc,
    a_hexagon,
    a_rounded_box,
    anything,
    ground,
    open_box,
    walls,
)
from .scene import Body, G, Hinge, Polygon, Scene, Segment, Trace, X, Y, block, box, disc, set_up

SECONDS = 7.0
"""Simulated time; whether a scene has come to rest is asked of the last second."""


@dataclass(frozen=True)
class Everyday:
    """A game scene: what it shows, how it is made from a seed, and how it is judged.

    `rests` says that everything comes to rest, `stands` that nothing should move from its place at all; `judged` that
    the scene counts in the summary (those with discs or rounded outlines are shown and judged elsewhere).
    """

    name: str
    title: str
    make: Callable[[int], Scene]
    rests: bool = True
    stands: bool = False
    judged: bool = True
    seeds: int = 5


def _scene(
    name: str,
    bodies: Sequence[Body],
    room: tuple[float, float, float, float],
    *,
    metres: bool = False,
    friction: float = 0.6,
    seconds: float = SECONDS,
    **more: Any,
) -> Scene:
    """`room`: left, bottom, right, top, outside of which nothing should ever be found. more: fields of `Scene`."""
    moving = [i for i, body in enumerate(bodies) if body.kind == "dynamic"]

    def outside(trace: Trace) -> float:
        """The share of the bodies that are outside the room at the end."""
        place = trace.states[-1, moving]
        left, bottom, right, top = room
        within = (place[:, X] > left) & (place[:, X] < right) & (place[:, Y] > bottom) & (place[:, Y] < top)
        return float(1 - np.mean(within))

    gravity, size = (G, 1.0) if metres else (GRAVITY_PX, SIDE_PX)
    units: dict[str, Any] = {"gravity": (0.0, -gravity), "size": size, "pressure": gravity / size**2}
    return set_up(name, bodies, seconds, outside, friction=friction, **units, **more)


# Scenes -----------------------------------------------------------------------------------------------------


def pit(name: str, maker: Maker, count: int = 150, width: float = 600.0) -> Callable[[int], Scene]:
    """`count` bodies dropped into a pit, a lattice of them shaken by the seed."""

    def make(seed: int) -> Scene:
        chance = random.Random(seed)
        pitch = 1.5 * SIDE_PX
        columns = int(width / pitch)
        bodies = [open_box(width, 1000.0)]
        for i in range(count):
            x = (i % columns - (columns - 1) / 2) * pitch + chance.uniform(-2, 2)
            y = (i // columns + 1) * pitch + chance.uniform(-2, 2)
            bodies.append(maker(f"body{i}", chance, (x, y)))
        return _scene(name, bodies, (-width / 2, 0.0, width / 2, 1000.0))

    return make


def pit_of_discs(count: int) -> Scene:
    """So many discs in a pit as deep, over its width, as the one of 150."""
    return pit("discs", a_disc, count, 600.0 * math.sqrt(count / 150))(0)


def pile(rows: int, side: float, gap: float, scatter: float, seed: int) -> list[Body]:
    """Squares in a pyramid, each on two, moved sideways by up to `scatter`."""
    chance = random.Random(seed)
    boxes = []
    for i in range(rows):
        for j in range(rows - i):
            x = (1 + gap) * side * (j - (rows - 1 - i) / 2) + chance.uniform(-scatter, scatter)
            boxes.append(block(f"box{i}_{j}", side, side, (x, (i + 0.5) * side)))
    return boxes


def pyramid(seed: int) -> Scene:
    """15 rows of boxes, a tenth of a side between them."""
    boxes = pile(15, SIDE_PX, 0.1, 0.01 * SIDE_PX, seed)
    return _scene("pyramid", [ground(), *boxes], (-1000.0, 0.0, 1000.0, 1000.0))


BRICK, COURSES, ACROSS = (40.0, 20.0), 12, 10


def _bricks(seed: int) -> list[Body]:
    """Courses in running bond, half bricks at the ends of every other, joints of a twentieth of a brick."""
    chance = random.Random(seed)
    (length, height), gap = BRICK, 0.02 * BRICK[0]
    bricks = []
    for course in range(COURSES):
        odd = course % 2
        edges = [i * length for i in range(ACROSS + 1)]
        if odd:
            edges = [0.0, *[(i + 0.5) * length for i in range(ACROSS)], ACROSS * length]
        for i, (left, right) in enumerate(itertools.pairwise(edges)):
            x = (left + right) / 2 - ACROSS * length / 2 + chance.uniform(-0.2, 0.2)
            width = right - left - gap
            place = (x, (course + 0.5) * height)
            bricks.append(block(f"brick{course}_{i}", width, height, place, width / (length - gap)))
    return bricks


def wall(seed: int) -> Scene:
    """A brick wall that stands."""
    return _scene("wall", [ground(), *_bricks(seed)], (-1000.0, 0.0, 1000.0, 1000.0))


def struck_wall(seed: int) -> Scene:
    """The same wall, struck by a ball of the weight of twenty bricks."""
    speed = 1500.0 + 20.0 * random.Random(seed).random()
    ball = disc("ball", 25.0, (-400.0, 140.0), 20.0, velocity=(speed, 50.0))
    bodies = [walls((-1000.0, 1000.0), (-1000.0, -WALL_PX), (1000.0, -WALL_PX), (1000.0, 1000.0))]
    return _scene("struck_wall", [*bodies, *_bricks(seed), ball], (-1000.0, 0.0, 1000.0, 1000.0))


def tower(seed: int) -> Scene:
    """Twelve boxes, each up to a thousandth of a side off the axis."""
    chance = random.Random(seed)
    scatter = 1e-3 * SIDE_PX
    boxes = [
        block(f"box{i}", SIDE_PX, SIDE_PX, (chance.uniform(-scatter, scatter), (i + 0.5) * SIDE_PX))
        for i in range(12)
    ]
    return _scene("tower", [ground(), *boxes], (-1000.0, 0.0, 1000.0, 1000.0))


def dominoes(seed: int) -> Scene:
    """Thirty dominoes, half a height apart; the first is pushed."""
    chance = random.Random(seed)
    width, height = 8.0, 60.0
    tiles = [
        block(f"domino{i}", width, height, (30.0 * (i - 14.5) + chance.uniform(-1, 1), height / 2))
        for i in range(30)
    ]
    first = tiles[0]
    pushed = block("domino0", width, height, first.position, velocity=(60.0, 0.0), angular_velocity=-2.0)
    return _scene("dominoes", [ground(), pushed, *tiles[1:]], (-1000.0, 0.0, 1000.0, 1000.0))


def rope_bridge(seed: int) -> Scene:
    """Twenty planks hinged end to end, hung between two banks on an arc, and fifteen crates that fall on them.

    The arc leaves slack, as bridges in games have it: a bridge hung straight would want infinite forces.
    """
    chance = random.Random(seed)
    count, length, thick, top, lean = 20, 40.0, 10.0, 400.0, 0.6
    radius = length / (2 * math.sin(lean / count))
    angles = [lean * (2 * i / count - 1) for i in range(count + 1)]
    points = [(radius * math.sin(a), top + radius * (math.cos(lean) - math.cos(a))) for a in angles]
    planks = []
    for i, ((x0, y0), (x1, y1)) in enumerate(itertools.pairwise(points)):
        place, angle = ((x0 + x1) / 2, (y0 + y1) / 2), math.atan2(y1 - y0, x1 - x0)
        # a little shorter than from hinge to hinge, or the bend of the bridge would wedge them
        planks.append(block(f"plank{i}", length - 6.0, thick, place, angle=angle))
    edge = points[-1][0] + 10.0
    lines = (
        Segment((-1000.0, top), (-edge, top), WALL_PX),
        Segment((edge, top), (1000.0, top), WALL_PX),
        Segment((-1000.0, -WALL_PX), (1000.0, -WALL_PX), WALL_PX),
    )
    banks = Body("banks", lines, kind="static")
    hinges = [Hinge(f"plank{i}", f"plank{i + 1}", points[i + 1]) for i in range(count - 1)]
    hinges += [Hinge("plank0", "", points[0]), Hinge(f"plank{count - 1}", "", points[-1])]
    crates = []
    for i in range(15):
        place = 40.0 * (i % 5 - 2) + chance.uniform(-4, 4), top + 40.0 * (i // 5)
        crates.append(block(f"crate{i}", 20.0, 20.0, place, 0.5, angle=chance.uniform(-0.3, 0.3)))
    room = (-1000.0, 0.0, 1000.0, 1000.0)
    return _scene("rope_bridge", [banks, *planks, *crates], room, hinges=tuple(hinges))


def bouncing(seed: int) -> Scene:
    """Forty shapes of all kinds with e = 0.9 in a closed room."""
    chance = random.Random(seed)
    bodies = [walls((-400.0, 0.0), (400.0, 0.0), (400.0, 600.0), (-400.0, 600.0), (-400.0, 0.0))]
    for i in range(40):
        place = (80.0 * (i % 8 - 3.5), 100.0 + 80.0 * (i // 8))
        made = anything(f"body{i}", chance, place)
        bodies.append(replace(made, velocity=(chance.uniform(-300, 300), chance.uniform(-300, 300))))
    return _scene("bouncing", bodies, (-400.0, 0.0, 400.0, 600.0), friction=0.4, elasticity=0.9)


def crates(seed: int) -> Scene:
    """Forty crates in a heap, eight across, and one of a hundred times their mass put on top."""
    chance = random.Random(seed)
    side = SIDE_PX
    heap = [
        block(f"crate{i}", side, side, (1.02 * side * (i % 8 - 3.5) + chance.uniform(-0.3, 0.3), (i // 8 + 0.5) * side))
        for i in range(40)
    ]  # fmt: skip
    heavy = block("heavy", side, side, (chance.uniform(-side, side), 5.5 * side + 5.0), 100.0)
    width = 14 * side
    return _scene("crates", [open_box(width, 1000.0), *heap, heavy], (-width / 2, 0.0, width / 2, 1000.0))


def platformer(seed: int) -> Scene:
    """Terrain with a slope and steps, a lift, a belt, crates, capsules that stay upright: a level of a game."""
    chance = random.Random(seed)
    terrain = walls(
        (-600.0, 800.0),
        (-600.0, 150.0),
        (-350.0, 150.0),
        (-150.0, 0.0),
        (250.0, 0.0),
        (250.0, 60.0),
        (600.0, 60.0),
        (600.0, 800.0),
    )
    ledges = Body(
        "ledges",
        (Segment((-100.0, 220.0), (120.0, 220.0), WALL_PX), Segment((200.0, 330.0), (420.0, 330.0), WALL_PX)),
        kind="static",
    )
    belt = Body("belt", (box(220.0, 20.0),), (40.0, 100.0), kind="static", surface_speed=60.0)
    lift = Body("lift", (box(120.0, 12.0),), (-480.0, 180.0), velocity=(0.0, 40.0), kind="kinematic")
    bodies = [terrain, ledges, belt, lift]
    places = [(-520.0 + 32.0 * (i % 3), 205.0 + 32.0 * (i // 3)) for i in range(6)]  # on the lift
    places += [(-40.0 + 32.0 * i, 130.0) for i in range(4)]  # on the belt
    places += [(-80.0 + 40.0 * (i % 4), 250.0 + 32.0 * (i // 4)) for i in range(8)]  # on a ledge
    places += [(300.0 + 32.0 * (i % 6), 80.0 + 31.0 * (i // 6)) for i in range(18)]  # piled on the step
    for i, (x, y) in enumerate(places):
        side = 24.0 + chance.uniform(0.0, 6.0)
        bodies.append(
            block(f"crate{i}", side, side, (x + chance.uniform(-1, 1), y), angle=chance.uniform(-0.05, 0.05))
        )
    for i, x in enumerate((-300.0, -200.0, 100.0, 520.0)):
        figure = Polygon(((-6.0, -14.0), (6.0, -14.0), (6.0, 14.0), (-6.0, 14.0)), 8.0)
        velocity = (chance.uniform(-100.0, 100.0), 300.0)
        bodies.append(Body(f"figure{i}", (figure,), (x, 450.0), velocity=velocity, moment=math.inf))
    return _scene("platformer", bodies, (-600.0, -10.0, 600.0, 1200.0), friction=0.5)


def metre_floor(half: float) -> Body:
    """A floor whose upper face is y = 0 (m)."""
    return Body("floor", (Segment((-half, -0.1), (half, -0.1), 0.1),), kind="static")


def metre_pyramid(rows: int) -> Callable[[int], Scene]:
    """Unit boxes in a pyramid, a twentieth of a side between them, in metres."""

    def make(seed: int) -> Scene:
        boxes = pile(rows, 1.0, 0.05, 1e-3, seed)
        half, name = 2.0 * rows, f"pyramid_{len(boxes)}"
        return _scene(name, [metre_floor(half), *boxes], (-half, 0.0, half, half), metres=True)

    return make


def metre_towers(bodies: int) -> Callable[[int], Scene]:
    """Towers of five unit boxes side by side, each box up to 1e-4 off, in metres."""

    def make(seed: int) -> Scene:
        chance = random.Random(seed)
        count = bodies // 5
        boxes = [
            block(f"box{i}_{j}", 1.0, 1.0, (2.0 * i - count + chance.uniform(-1e-4, 1e-4), j + 0.5))
            for i in range(count)
            for j in range(5)
        ]
        half = count + 10.0
        room = (-half, 0.0, half, 20.0)
        return _scene("towers_10000", [metre_floor(half), *boxes], room, metres=True, seconds=2.0)

    return make


LARGE: dict[str, Any] = {"stands": True, "judged": False, "seeds": 1}

EVERYDAY: dict[str, Everyday] = {
    scene.name: scene
    for scene in (
        Everyday("boxes", "pit of 150 boxes", pit("boxes", a_box)),
        Everyday("hexagons", "pit of 150 hexagons", pit("hexagons", a_hexagon)),
        Everyday("discs", "pit of 150 discs", pit("discs", a_disc), judged=False),
        Everyday("mixed", "pit of 150 mixed shapes", pit("mixed", anything), judged=False),
        Everyday("rounded", "pit of 150 rounded boxes", pit("rounded", a_rounded_box), judged=False),
        Everyday("pyramid", "pyramid of 120 boxes", pyramid, stands=True),
        Everyday("wall", "brick wall", wall, stands=True),
        Everyday("struck_wall", "brick wall struck by a heavy ball", struck_wall, judged=False),
        Everyday("tower", "tower of 12 boxes", tower, stands=True),
        Everyday("dominoes", "30 dominoes", dominoes),
        Everyday("rope_bridge", "rope bridge", rope_bridge),
        Everyday("bouncing", "bouncing shapes, e = 0.9", bouncing, rests=False, judged=False),
        Everyday("crates", "40 crates and one of 100", crates),
        Everyday("platformer", "platformer", platformer, rests=False, judged=False),
        Everyday("pyramid_820", "pyramid of 820 boxes (m)", metre_pyramid(40), **LARGE),
        Everyday("towers_10000", "10,000 boxes in towers (m)", metre_towers(10000), **LARGE),
    )
}
"""Every game scene by name."""
