"""Scenes that judge plans and that no estimate of a plan was found on: they have no exact answer, the finest setting is
their reference. Whoever changes an estimate looks at the study's scenes and their variations, not at these."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any

from rigidarea.study.scene import Body, Hinge, Scene, Segment, Trace, block, disc, floor

LONGEST = 1.5
"""Simulated time (s) that most of them last: further on contacts that come and go part any two runs."""


def _none(_: Trace) -> float:
    return math.nan


def scene_of(name: str, title: str, bodies: Sequence[Body], duration: float = LONGEST, **more: Any) -> Scene:
    """A scene without an exact answer."""
    return Scene(
        title, tuple(bodies), duration, "departure from the finest setting", _none, "none", name, **more
    )


def billiard() -> Scene:
    """A ball breaks a triangle of six, a little off its axis."""
    balls = [
        disc(f"{row}{n}", 0.5, (row * 0.9, (n - row / 2) * 1.04)) for row in range(3) for n in range(row + 1)
    ]
    cue = disc("cue", 0.5, (-4.0, 0.11), velocity=(6.0, 0.0))
    return scene_of(
        "billiard",
        "a break at billiards",
        [cue, *balls],
        1.2,
        gravity=(0.0, 0.0),
        elasticity=0.95,
        friction=0.05,
    )


def pendulum_at_a_wall() -> Scene:
    """A bar on a hinge swings against a post, and back."""
    bar = block("bar", 0.2, 2.0, (1.0, 0.0), angle=math.pi / 2)
    post = block("post", 0.5, 2.0, (-0.45, -1.6), kind="static")
    return scene_of(
        "pendulum_at_a_wall",
        "a pendulum against a wall",
        [bar, post],
        elasticity=0.6,
        hinges=(Hinge("bar", "", (0, 0)),),
    )


def ball_on_a_seesaw() -> Scene:
    """A ball falls on the light end of a seesaw that a box weighs down."""
    plank = block("plank", 4.0, 0.1, (0.0, 0.6), angle=-0.2, mass=2.0)
    box = block("box", 0.4, 0.4, (1.5, 0.53), angle=-0.2, mass=0.5)
    ball = disc("ball", 0.2, (-1.6, 2.0), mass=1.5)
    return scene_of(
        "ball_on_a_seesaw", "a ball on a seesaw", [floor(20.0), plank, box, ball], friction=0.5, elasticity=0.2,
        hinges=(Hinge("plank", "", (0.0, 0.6)),), size=0.4,
    )  # fmt: skip


def islands() -> Scene:
    """Far from each other: a stack, a ball that bounces, a disc that rolls, a box that slides."""
    bodies = [block(f"stack{i}", 1.0, 1.0, (-20.0, 0.5 + i)) for i in range(4)]
    bodies += [disc("ball", 0.5, (-10.0, 1.5)), disc("wheel", 0.5, (0.0, 0.5), velocity=(2.0, 0.0))]
    bodies += [block("sled", 1.0, 0.5, (10.0, 0.25), velocity=(2.0, 0.0))]
    return scene_of(
        "islands", "a stack, a ball, a wheel, a sled", [floor(80.0), *bodies], friction=0.4, elasticity=0.5
    )


def beam_struck() -> Scene:
    """A ball strikes a free beam off its middle."""
    beam = block("beam", 4.0, 0.2, (0.0, 0.0), mass=2.0)
    return scene_of(
        "beam_struck", "a ball on a free beam", [beam, disc("ball", 0.3, (1.1, 0.8), velocity=(0.3, -2.0))],
        gravity=(0.0, 0.0), elasticity=0.7, size=0.5,
    )  # fmt: skip


def box_dropped_askew() -> Scene:
    """A box falls on one of its corners and comes to lie."""
    return scene_of(
        "box_dropped_askew", "a box dropped on its corner", [floor(), block("box", 1.0, 0.6, (0.0, 1.5), angle=0.5)],
        1.2, friction=0.5, elasticity=0.2,
    )  # fmt: skip


def heavy_dropped() -> Scene:
    """A heavy box falls flat on two that stand side by side."""
    low = [block(f"low{i}", 1.0, 1.0, (1.1 * i, 0.5)) for i in range(2)]
    return scene_of(
        "heavy_dropped", "a heavy box on two", [floor(), *low, block("heavy", 2.4, 0.8, (0.6, 1.9), mass=10.0)], 1.0,
        friction=0.6,
    )  # fmt: skip


def dominoes() -> Scene:
    """Six dominoes, the first one pushed."""
    bodies = [block(f"domino{i}", 0.2, 1.0, (0.6 * i, 0.5)) for i in range(6)]
    first = block("domino", 0.2, 1.0, (-0.6, 0.5), angular_velocity=-1.5, velocity=(0.75, 0.0))
    return scene_of("dominoes", "dominoes", [floor(), first, *bodies], 1.2, friction=0.4, size=0.5)


def chain_on_a_peg() -> Scene:
    """A chain of bars swings down against a peg."""
    links = [block(f"link{i}", 0.5, 0.1, (0.25 + 0.5 * i, 0.0), mass=0.2) for i in range(5)]
    hinges = [Hinge("link0", "", (0.0, 0.0))]
    hinges += [Hinge(f"link{i}", f"link{i + 1}", (0.5 * i + 0.5, 0.0)) for i in range(4)]
    peg = disc("peg", 0.15, (0.35, -0.9), kind="static")
    return scene_of(
        "chain_on_a_peg", "a chain on a peg", [peg, *links], 1.0, hinges=tuple(hinges), friction=0.3, size=0.5
    )


def over_a_step() -> Scene:
    """A wheel rolls over a sill."""
    sill = block("sill", 0.3, 0.08, (3.0, 0.04), kind="static")
    wheel = disc("wheel", 0.5, (0.0, 0.5), velocity=(3.0, 0.0), angular_velocity=-6.0)
    return scene_of("over_a_step", "a wheel over a sill", [floor(), sill, wheel], friction=0.8)


def two_slopes() -> Scene:
    """A box slides down one slope and up another."""
    lines = (Segment((-6.0, 3.0), (0.0, 0.0), 0.05), Segment((0.0, 0.0), (6.0, 2.0), 0.05))
    angle = math.atan2(-3.0, 6.0)
    normal = (-math.sin(angle), math.cos(angle))
    at = (-4.0 + 0.3 * normal[0], 2.0 + 0.3 * normal[1])
    box = block("box", 0.8, 0.5, at, angle=angle)
    ground = Body("ground", lines, kind="static")
    return scene_of("two_slopes", "a box between two slopes", [ground, box], 1.2, friction=0.1, size=0.5)


def bullet_and_stack() -> Scene:
    """A fast ball knocks a box out of a stack."""
    bodies = [block(f"box{i}", 1.0, 1.0, (0.0, 0.5 + i)) for i in range(4)]
    ball = disc("ball", 0.3, (-5.0, 1.6), mass=0.5, velocity=(15.0, 0.0))
    return scene_of(
        "bullet_and_stack", "a ball into a stack", [floor(), *bodies, ball], 0.8, friction=0.4, elasticity=0.1
    )


UNSEEN: tuple[Callable[[], Scene], ...] = (
    billiard, pendulum_at_a_wall, ball_on_a_seesaw, islands, beam_struck, box_dropped_askew, heavy_dropped, dominoes,
    chain_on_a_peg, over_a_step, two_slopes, bullet_and_stack,
)  # fmt: skip
