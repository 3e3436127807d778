"""What the rest of the world does to a body in a step: contacts are met one after the other (Gauss-Seidel)."""

from __future__ import annotations

from typing import Any

from .jit import kernel
from .region import Motion, Pull


@kernel
def meet_body(body: Any, stamp: int) -> None:
    """A step's first look at a body: what its contacts did is now what they did in the step before."""
    last = body.stamp == stamp - 1
    body.old_x = body.met_x if last else 0.0
    body.old_y = body.met_y if last else 0.0
    body.old_turn = body.met_turn if last else 0.0
    body.met_x = 0.0
    body.met_y = 0.0
    body.met_turn = 0.0
    body.old_rate = body.met_rate if last else 0.0
    body.met_rate = 0.0
    body.crowded = max(0, body.crowded - 1) if last else 0
    body.stamp = stamp


@kernel(inline="always")
def expected(
    m: Motion, body: Any, gx: float, gy: float, fx: float, fy: float, turn: float
) -> Motion:  # fmt: skip
    """The body's motion with what everything but one pair will do to it in this step.

    From gravity, the force (fx, fy, turn) that the step's earlier contacts and the user have put on it, and what the
    contacts not met yet did in the step before.
    """
    return Motion(
        m.x, m.y, m.vx, m.vy, m.w, m.inverse_mass, m.inverse_moment,
        gx + (fx + body.old_x) * m.inverse_mass,
        gy + (fy + body.old_y) * m.inverse_mass,
        (turn + body.old_turn) * m.inverse_moment,
    )  # fmt: skip


@kernel
def take_out(body: Any, fx: float, fy: float, turn: float) -> None:
    """A pair that pushed the body in the step before is met: it has a new force now."""
    body.old_x -= fx
    body.old_y -= fy
    body.old_turn -= turn


@kernel
def remember_pull(pair: Any, pull: Pull, stamp: int) -> None:
    """For the next step's `take_out`."""
    pair.stamp = stamp
    pair.fx = pull.fx
    pair.fy = pull.fy
    pair.moment_a = pull.moment_a
    pair.moment_b = pull.moment_b


@kernel
def put_in(body: Any, fx: float, fy: float, turn: float) -> None:
    """What a pair that was met pushes the body with."""
    body.met_x += fx
    body.met_y += fy
    body.met_turn += turn
