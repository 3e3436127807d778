"""A heavy crate on two light ones stays where it is."""

from ..scene import G, Scene, block, floor, rest_error

RATIO, APART, OFF = 1000.0, 0.75, 0.05
"""Masses; half the distance of the light crates' centres; how far the heavy one stands off the middle (m)."""


def loads() -> tuple[float, float]:
    """Forces (left, right) with which the light crates bear the heavy one, through their own middles.

    From the balance of moments about either. Both push, and no crate is asked to turn: forces that hold everything
    exist, without friction even, so nothing moves.
    """
    share = (APART + OFF) / (2 * APART)
    return RATIO * G * (1 - share), RATIO * G * share


def scene() -> Scene:
    """Crates of 1 m and 1 kg, on them one of 2.5 × 1 m and 1,000 kg, put down 5 cm off the middle: nothing moves."""
    assert min(loads()) > 0
    bodies = (
        floor(),
        block("left", 1.0, 1.0, (-APART, 0.5)),
        block("right", 1.0, 1.0, (APART, 0.5)),
        block("heavy", 2.5, 1.0, (OFF, 1.5), RATIO),
    )
    return Scene(
        title="crate of 1,000 on two of 1",
        bodies=bodies,
        friction=0.5,
        duration=5.0,
        error_name="displacement after 5 s / side",
        error=lambda trace: rest_error(trace, ["left", "right", "heavy"], 1.0),
        source="statics; rigid limit",
        pressure=RATIO / 2 * G,
        tags=frozenset({"rest", "flat", "stack"}),
    )
