"""A soft stack buckles under its own weight."""

import numpy as np

from ..atlas import Axis, Map, Outcome, Variant, judge, run_scene
from ..scene import Array, G, Scene, X, block, floor

LIMIT, SECONDS, IMPERFECTION = 0.5, 30.0, 1e-4
"""Boxes of displacement that count as toppled; simulated time; sideways gravity over gravity."""


def tallest(sinking: float) -> int:
    """Most boxes that stand, δ₀ = m g/(k s²): smallest eigenvalue of the linear problem positive.

    Box j tilts by θ_j. Between neighbours the bed's moment k s³/12 (θ_j − θ_(j−1)); the weight of everything
    above, m g s (n − j − 1/2) θ_j²/2 for j = 0 … n − 1, lowers the stack.
    """
    n = 1
    while n < 1000:
        stiffness = np.zeros((n, n))
        for j in range(n):
            stiffness[j, j] = (2.0 if j < n - 1 else 1.0) / (12 * sinking) - (n - j - 0.5)
            if j:
                stiffness[j, j - 1] = stiffness[j - 1, j] = -1 / (12 * sinking)
        if np.linalg.eigvalsh(stiffness)[0] <= 0:
            return n - 1
        n += 1
    return n


def tower(count: int) -> Scene:
    """Unit boxes, gravity leaning by a ten-thousandth."""
    boxes = tuple(block(f"box{i}", 1.0, 1.0, (0.0, i + 0.5)) for i in range(count))
    return Scene(
        name="tower",
        title="",
        bodies=(floor(), *boxes),
        gravity=(IMPERFECTION * G, -G),
        friction=0.9,
        duration=SECONDS,
        error_name="",
        error=lambda trace: 0.0,
        source="",
        frame=1 / 6,
    )


def lean(variant: Variant, sinking: float, count: int) -> float:
    """How far the top box gets sideways (boxes)."""
    trace = run_scene(variant, tower(count), stiffness=1 / sinking)
    return float(np.max(np.abs(trace[f"box{count - 1}"][:, X])))


def run(variant: Variant, x: float, y: float) -> Outcome:
    """Stands for half a minute or topples."""
    return judge(lean(variant, x, round(y)), LIMIT, "toppled")


def theory() -> list[tuple[str, Array, Array]]:
    """The eigenvalue problem, and the design's (0.65/δ₀)^(1/3)."""
    sinking = np.logspace(-2.3, -3.7, 40)
    exact = np.array([tallest(float(value)) + 0.5 for value in sinking])
    return [("eigenvalue problem", sinking, exact), ("(0.65/δ₀)^(1/3)", sinking, (0.65 / sinking) ** (1 / 3))]


def atlas_map() -> Map:
    """Sinking of one box × boxes."""
    sinkings = tuple(float(f"{10**p:.3g}") for p in np.arange(-3.6, -2.3, 0.2))
    return Map(
        name="buckling",
        title="buckling: a stack on soft contacts",
        x=Axis("sinking of one box δ₀ (box sides)", sinkings, (3e-4, 1e-3, 3e-3), log=True),
        y=Axis("boxes", tuple(range(2, 17)), (3, 5, 7, 9, 12)),
        measure="sideways way of the top box in 30 s (box sides)",
        limit=LIMIT,
        variants={"rigidarea": Variant("rigidarea", {"phase": 0.5})},
        run=run,
        source="beam-column of rigid boxes on Winkler beds",
        theory=theory,
    )
