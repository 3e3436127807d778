"""A plan to be read: its table, line by line."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, NamedTuple

import pymunk

from . import estimates as est
from .predict import Cause, causes
from .promise import name_of

if TYPE_CHECKING:
    from .plan import Plan


class Line(NamedTuple):
    """One line of a plan's table."""

    what: str
    choice: str
    decided_by: str
    error: float
    cost_s: float  # a frame
    target: Any  # what `Plan.override` takes for it; None: the whole space


def lines_of(plan: Plan) -> list[Line]:
    """The table: the space first, then what decides, parts, shapes that are sampled anew, elastic bodies."""
    mine = plan.overrides.get(None, {})
    head = f"{plan.level}, {plan.steps} x {plan.sweeps} sweeps"
    if plan.level == "pymunk":
        head += f", slop {plan.penetration:.0e}"
    elif plan.stiffness is not None:
        head += f", k {plan.stiffness:.3g}"
    else:
        head += f", penetration {plan.penetration:.0e}"
    if mine:
        head += f" (yours: {', '.join(sorted(mine))})"
    worst = (
        plan.causes[0] if plan.causes else Cause("nothing", 0.0, None, "nothing moves, or nothing touches")
    )
    out = [Line("space", head, f"{worst.name}: {worst.number}", plan.error, plan._frame_cost, None)]
    seen = plan._survey
    share = plan._frame_cost / max(1, int(seen.moves.sum()))
    for cause in plan.causes:
        out.append(
            Line(
                name_of(plan.space, cause.who),
                "as the space",
                f"{cause.name}: {cause.number}",
                cause.error,
                share,
                cause.who,
            )
        )
    for part, steps in plan._parts:
        worst = max(causes(part.facts, plan._setting(steps)), key=lambda cause: cause.error, default=worst)
        first = part.bodies[0]
        out.append(
            Line(
                f"{len(part.bodies)} {part.kind}",
                f"{steps} substeps",
                f"{worst.name}: {worst.number}",
                worst.error,
                plan._cost_of(part, plan._setting(steps)),
                first,
            )
        )
    for target, settings in plan.overrides.items():
        if isinstance(target, pymunk.Body) and "steps" in settings:
            text = f"{settings['steps']} substeps for its island (yours)"
            out.append(Line(name_of(plan.space, target), text, "", float("nan"), 0.0, target))
    for shape, sagitta in plan.sampling.items():
        yours = " (yours)" if "sampling" in plan.overrides.get(shape, {}) else ""
        turn = est.facet_turn(abs(float(seen.radius[seen.shapes.index(shape)])) or 1.0, sagitta)
        out.append(
            Line(
                name_of(plan.space, shape),
                f"sampled to {sagitta:.1e}{yours}",
                f"facets turn by {turn:.1e} rad",
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
                f"rest on something, slower than {plan.idle_speed:.1e}",
                0.0,
                0.0,
                None,
            )
        )
    return out


def text_of(plan: Plan) -> str:
    """The table as text."""
    rows = [("", "choice", "decided by", "error", "ms a frame")]
    for line in plan.lines:
        error = "" if math.isnan(line.error) else f"{line.error:.1e}"
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
    verdict = "predicted" if plan.reachable else "no setting is predicted to reach it: the least is"
    told = f"{verdict} {plan.error:.1e}" if plan.error > 0.0 else "no error is predicted"
    if plan.unpromised:
        told += " for what is modelled" + "".join(f"\nnot promised: {reason}" for reason in plan.unpromised)
    return f"plan for {plan.tolerance:g} over {plan.seconds:g} s: {told}\n{table}"
