"""A soft stack buckles under its own weight.

The other engines have knobs of the same meaning: pymunk's slop is the sinking it lets be, and Box2D's contacts are
springs of a frequency f, under which a box sinks by g/(2 π f)².
"""

import math

import numpy as np

from ..atlas import Axis, Map, Outcome, Variant, engines, judge
from ..peers import get_peer
from ..scene import Array, G, Scene, X, block, floor, set_up

LIMIT, SECONDS, IMPERFECTION = 0.5, 30.0, 1e-4
"""Boxes of displacement that count as toppled; simulated time; sideways gravity over gravity."""


def tallest(sinking: float) -> int:
    """Most boxes that stand, δ₀ = m g/(k s²): smallest eigenvalue of the linear problem positive.

    Box j tilts by θ_j. Between neighbours the bed's moment k s³/12 (θ_j − θ_(j−1)); the weight of everything
    above, m g s (n − j − 1/2) θ_j²/2 for j = 0 … n − 1, lowers the stack.
    """
    for n in range(1, 1000):
        bed, weight = np.full(n, 2.0), np.arange(n, 0, -1) - 0.5
        bed[-1] = 1.0
        beside = np.full(n - 1, -1 / (12 * sinking))
        stiffness = np.diag(bed / (12 * sinking) - weight) + np.diag(beside, 1) + np.diag(beside, -1)
        if np.linalg.eigvalsh(stiffness)[0] <= 0:
            return n - 1
    return n


def tower(count: int) -> Scene:
    """Unit boxes, gravity leaning by a ten-thousandth."""
    boxes = tuple(block(f"box{i}", 1.0, 1.0, (0.0, i + 0.5)) for i in range(count))
    bodies, gravity = (floor(10.0), *boxes), (IMPERFECTION * G, -G)
    return set_up("tower", bodies, SECONDS, gravity=gravity, friction=0.9, frame=1 / 6)


def lean(variant: Variant, sinking: float, count: int) -> float:
    """How far the top box gets sideways (boxes); a stack that topples is not followed to the floor."""
    knob: dict[str, float] = {"stiffness": 1 / sinking}
    if variant.peer == "pymunk":
        knob = {"slop": sinking}
    elif variant.peer == "box2d":
        knob = {"hertz": math.sqrt(G / sinking) / (2 * math.pi)}
    scene = tower(count)
    stack = get_peer(variant.peer).build(scene, {**variant.settings, **knob})
    furthest = 0.0
    for _ in range(scene.frames):
        stack.advance(1)
        furthest = max(furthest, abs(float(stack.state()[-1, X])))
        if not furthest <= LIMIT:
            break
    return furthest


def run(variant: Variant, x: float, y: float) -> Outcome:
    """Stands for half a minute or topples."""
    return judge(lean(variant, x, round(y)), LIMIT, "toppled")


def theory() -> list[tuple[str, Array, Array]]:
    """The eigenvalue problem, and the round formula (0.65/δ₀)^(1/3)."""
    sinking = np.logspace(-2.3, -3.7, 40)
    exact = np.array([tallest(float(value)) + 0.5 for value in sinking])
    return [("eigenvalue problem", sinking, exact), ("(0.65/δ₀)^(1/3)", sinking, (0.65 / sinking) ** (1 / 3))]


def atlas_map() -> Map:
    """Sinking of one box × boxes."""
    sinkings = tuple(float(f"{10**p:.3g}") for p in np.arange(-3.6, -2.3, 0.2))
    return Map(
        title="buckling: a stack on soft contacts",
        x=Axis("sinking of one box δ₀ (box sides)", sinkings, (3e-4, 1e-3, 3e-3), log=True),
        y=Axis("boxes", tuple(range(2, 17)), (3, 5, 7, 9, 12)),
        measure="sideways way of the top box in 30 s (box sides)",
        limit=LIMIT,
        variants=engines(
            rigidarea={"peer": "rigidarea", "steps": 160},
            pymunk={"steps": 40},  # of frames of 1/6 s: its usual steps of 1/240 s
            box2d={"steps": 10},
            literal={"phase": 1.0},
        ),
        run=run,
        source="beam-column of rigid boxes on Winkler beds",
        theory=theory,
        theory_of=("rigidarea", "explicit", "literal"),
    )
