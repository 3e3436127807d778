"""A plan to be read: its table, line by line."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
import pymunk

from .probe import Setting
from .promise import name_of

WORST = 3
"""Bodies that a table shows."""


class Line(NamedTuple):
    """One line of a plan's table."""

    what: str
    choice: str
    decided_by: str
    error: float
    cost_s: float  # a frame
    target: Any  # what `Plan.override` takes for it; None: the whole space


def lines_of(plan: Any) -> list[Line]:
    """The table: the space, the next cheaper and the next finer choice, the worst bodies, substeps of their own, shapes
    that are sampled anew, elastic bodies."""
    mine = plan.overrides.get(None, {})
    probe, found = plan._probe, plan._found
    head = _told(plan, found.chosen.setting)
    if mine:
        head += f" (yours: {', '.join(sorted(mine))})"
    fine = found.fine
    against = f"against {fine.setting.steps} substeps, penetration {fine.setting.penetration:.0e}"
    if not found.tried:
        against = "the defaults"
    out = [Line("space", head, against, plan.error, plan._frame_cost, None)]
    cheaper = [each for each in found.tried if each.cost_s < found.chosen.cost_s]
    finer = [each for each in found.tried if each.cost_s > found.chosen.cost_s and each.error < plan.error]
    for what, each in (("cheaper", cheaper[-1:]), ("finer", finer[:1])):
        for one in each:
            text = "tried too"
            out.append(Line(f"  {what}", _told(plan, one.setting), text, one.error, one.cost_s, None))
    errors = found.chosen.errors
    for i in np.argsort(-errors, kind="stable")[:WORST]:
        if 0.0 < errors[i] < math.inf:
            where = name_of(plan.space, probe.bodies[i])
            text = f"its place or turn is off, of which {fine.doubt[i]:.1e} is the finer run's own"
            out.append(Line(where, "as the space", text, float(errors[i]), 0.0, probe.bodies[i]))
    for steps in sorted(set(plan.finer.values())):
        bodies = [body for body, n in plan.finer.items() if n == steps]
        names = f"{name_of(plan.space, bodies[0])}" + (f" and {len(bodies) - 1} more" if bodies[1:] else "")
        text = "with fewer their island is outside"
        out.append(Line(names, f"{steps} substeps", text, float("nan"), 0.0, bodies[0]))
    for target, settings in plan.overrides.items():
        if isinstance(target, pymunk.Body) and "steps" in settings:
            text = f"{settings['steps']} substeps for its island (yours)"
            out.append(Line(name_of(plan.space, target), text, "", float("nan"), 0.0, target))
    for shape, sagitta in plan.sampling.items():
        yours = " (yours)" if "sampling" in plan.overrides.get(shape, {}) else ""
        points = sum(map(len, shape.outline.sample(sagitta).rings))  # type: ignore[attr-defined]
        out.append(
            Line(
                name_of(plan.space, shape),
                f"sampled to {sagitta:.1e}{yours}",
                f"{points} corners",
                float("nan"),
                0.0,
                shape,
            )
        )
    for choice in plan.elastic:
        yours = " (yours)" if choice.overridden else ""
        out.append(
            Line(
                name_of(plan.space, choice.body),
                f"{choice.level}{yours}",
                choice.reason,
                choice.error,
                0.0,
                choice.body,
            )
        )
    asleep = plan.may_sleep
    if asleep:
        out.append(
            Line(
                f"{len(asleep)} bodies",
                "may sleep",
                f"stood still on something, slower than {plan.idle_speed:.1e}",
                0.0,
                0.0,
                None,
            )
        )
    return out


def text_of(plan: Any) -> str:
    """The table as text."""
    rows = [("", "choice", "decided by", "error", "ms a frame")]
    for line in plan.lines:
        error = "" if not math.isfinite(line.error) else f"{line.error:.1e}"
        rows.append(
            (
                line.what,
                line.choice,
                line.decided_by,
                error,
                f"{1e3 * line.cost_s:.3g}" if line.cost_s else "",
            )
        )
    widths = [max(len(row[i]) for row in rows) for i in range(5)]
    table = "\n".join(
        "  ".join(text.ljust(width) for text, width in zip(row, widths)).rstrip() for row in rows
    )
    if plan.reachable:
        told = f"off by {plan.error:.1e} where it was tried out" if plan.error > 0.0 else "nothing moves"
    else:
        told = f"no setting that was tried is within it: the least is {plan.error:.1e}"
    if not plan.tried:
        told = "nothing was tried out"
    told += "".join(f"\nnot promised: {reason}" for reason in plan.unpromised)
    tried = f"tried out: {plan.looked:.3g} s in {len(plan.tried)} settings, {1e3 * plan.planning_s:.0f} ms"
    return f"plan for {plan.tolerance:g} over {plan.seconds:g} s: {told}\n{tried}\n{table}"


def _told(plan: Any, setting: Setting) -> str:
    """A setting in words."""
    text = f"{setting.level}, {setting.steps} x {setting.sweeps} sweeps"
    if setting.level == "pymunk":
        return f"{text}, slop {setting.penetration:.0e}"
    if plan.stiffness is not None:
        return f"{text}, k {plan.stiffness:.3g}"
    return f"{text}, penetration {setting.penetration:.0e}"
