"""A plan to be read: its table, line by line."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
import pymunk

from ..report import align
from .probe import Setting
from .promise import name_of

WORST = 3
"""Bodies that a table shows."""


class Line(NamedTuple):
    """One line of a plan's table."""

    what: str
    choice: str
    decided_by: str = ""
    error: float = math.nan
    cost_s: float = 0.0  # a frame
    target: Any = None  # what `Plan.override` takes for it; None: the whole space


def lines_of(plan: Any) -> list[Line]:
    """The table: the space, the next cheaper and the next finer choice, the worst bodies, substeps of their own, shapes
    that are sampled anew, elastic bodies."""
    space, probe, found = plan.space, plan._probe, plan._found
    chosen, fine = found.chosen, found.fine
    mine = ", ".join(sorted(plan.overrides.get(None, {})))
    head = _told(plan, chosen.setting) + (f" (yours: {mine})" if mine else "")
    against = f"against {fine.setting.steps} substeps, penetration {fine.setting.penetration:.0e}"
    out = [Line("space", head, against if found.tried else "the defaults", plan.error, chosen.cost_s)]
    cheaper = [each for each in found.tried if each.cost_s < chosen.cost_s][-1:]
    finer = [each for each in found.tried if each.cost_s > chosen.cost_s and each.error < plan.error][:1]
    for what, others in (("  cheaper", cheaper), ("  finer", finer)):
        out += [Line(what, _told(plan, one.setting), "tried too", one.error, one.cost_s) for one in others]
    for i in np.argsort(-chosen.errors, kind="stable")[:WORST]:
        if 0.0 < chosen.errors[i] < math.inf:
            body, error = probe.bodies[i], float(chosen.errors[i])
            text = f"its place or turn is off, of which {fine.doubt[i]:.1e} is the finer run's own"
            out.append(Line(name_of(space, body), "as the space", text, error, target=body))
    found_finer = {body: n for body, n in plan.finer.items() if "steps" not in plan.overrides.get(body, {})}
    for steps in sorted(set(found_finer.values())):
        first, *more = [body for body, n in found_finer.items() if n == steps]
        names = name_of(space, first) + (f" and {len(more)} more" if more else "")
        out.append(Line(names, f"{steps} substeps", "with fewer their island is outside", target=first))
    for target, settings in plan.overrides.items():
        if isinstance(target, pymunk.Body) and "steps" in settings:
            text = f"{settings['steps']} substeps for its island (yours)"
            out.append(Line(name_of(space, target), text, target=target))
    for shape, sagitta in plan.sampling.items():
        yours = " (yours)" if "sampling" in plan.overrides.get(shape, {}) else ""
        points = sum(map(len, shape.outline.sample(sagitta).rings))  # type: ignore[attr-defined]
        text = f"sampled to {sagitta:.1e}{yours}"
        out.append(Line(name_of(space, shape), text, f"{points} corners", target=shape))
    for choice in plan.elastic:
        level = choice.level + (" (yours)" if choice.overridden else "")
        out.append(Line(name_of(space, choice.body), level, choice.reason, choice.error, target=choice.body))
    if asleep := plan.may_sleep:
        text = f"stood still, slower than {plan.idle_speed:.1e}"
        out.append(Line(f"{len(asleep)} bodies", "may sleep", text, 0.0))
    return out


def text_of(plan: Any) -> str:
    """The table as text."""
    rows = [("", "choice", "decided by", "error", "ms a frame")]
    for line in plan.lines:
        error = f"{line.error:.1e}" if math.isfinite(line.error) else ""
        cost = f"{1e3 * line.cost_s:.3g}" if line.cost_s else ""
        rows.append((line.what, line.choice, line.decided_by, error, cost))
    table = "\n".join(align(rows, left=range(5)))
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
