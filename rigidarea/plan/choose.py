"""The cheapest settings that are within a tolerance, found by trying them on a `Probe`."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
import pymunk

from ..chipmunk.attach import PENETRATION
from ..contact.constants import SUBSTEPS
from . import costs
from .probe import LEAST_DEPTH, Array, Probe, Reference, Seen, Setting, reference

SHARE, UNNOTICED_S = 0.05, 0.1
"""What trying out may cost: this share of the planned run, or the time that is not noticed as waiting (s; R. B. Miller,
Response time in man-computer conversational transactions, 1968), whichever is more."""
RUNS = 12.0
"""Runs of two substeps that the budget must do for: the time looked at is cut until it does."""
NATIVE_STEPS = (1, 2, 4, 8, 16, 32, 64)
SWEEPS, FEWER_SWEEPS = 10, 5
FINEST_SAGITTA = 1e-6
"""Of an outline sampled anew (fraction of its smallest extent)."""


COPIES, SAMPLED = 0.5, 0.1
"""What copies may take of the budget; where that of the whole space would take more, islands are sampled to this."""


def budget_of(bodies: int, frames: int, steps: int | None) -> float:
    """What trying out may cost (s): of so many bodies, planned for so many frames of so many substeps."""
    run = costs.area_frame([(bodies, bodies, steps or SUBSTEPS)], SWEEPS) * frames
    return max(SHARE * run, UNNOTICED_S)


def bodies_for(budget: float) -> tuple[float, float]:
    """How many bodies may be copied, and how many of islands that are sampled: see `part`."""
    return COPIES * budget / costs.COPY_BODY_S, SAMPLED * budget / costs.COPY_BODY_S


class Tried(NamedTuple):
    """A setting tried: what each body is off, with what the reference may be (relative); a frame's cost (s)."""

    setting: Setting
    errors: Array  # (bodies,)
    cost_s: float

    @property
    def error(self) -> float:
        """The largest."""
        return float(self.errors.max(initial=0.0))


class Found(NamedTuple):
    """What was found."""

    chosen: Tried
    finer: dict[int, int]  # substeps of bodies that take more, by number
    sagitta: float | None  # of outlines sampled anew (fraction of the smallest extent)
    tried: list[Tried]  # all, in the order of their cost
    fine: Reference
    seen: Seen  # of the chosen setting's run
    end: Array  # (bodies, 6) its last states
    way: Array  # (bodies,) how far each was from where it began, at the most (length)
    sooner: Array  # (bodies,) what each is off over its way up to then, the largest
    looked: int  # frames
    begin: float  # depth after the reference's first frame, over the smallest extent


def search(
    probe: Probe,
    tolerance: float,
    native: bool,
    given: Mapping[str, Any],
    materials: Mapping[pymunk.Body, Any],
    least: Setting | None,
    budget: float,
) -> Found:
    """The cheapest setting whose error is within the tolerance; the one with the least where none is.

    native: whether Chipmunk's own response may be chosen. given: level, steps, sweeps, penetration that the user has
    said. least: nothing is to be coarser than that. budget: what trying out may cost (s).
    """
    planned = probe.frames
    if probe.moving and not probe.bodies:
        return _untried(probe, tolerance, given, least)
    copies = costs.COPY_BODY_S * len(probe.bodies)
    probe.look((budget - copies - probe.spent) / RUNS, Setting("rigid", SUBSTEPS, SWEEPS, PENETRATION))
    sagitta = None
    if (
        probe.sampled and least is None
    ):  # facets that turn by no more than the tolerance: turn² = 8 sagitta/radius
        sagitta = float(np.clip(tolerance**2 / 8.0, FINEST_SAGITTA, 1e-3))
    fine, rungs = reference(probe, tolerance, sagitta, 0.5 * budget, least)
    tried: list[Tried] = []

    def attempt(setting: Setting, coarser: float | None = sagitta) -> Tried:
        errors = probe.apart(probe.track(setting, coarser), fine.track) + fine.doubt
        tried.append(Tried(setting, errors, probe.cost(setting)))
        return tried[-1]

    chosen: Tried | None = None
    whole = probe.share == 1.0
    native = native and ((whole and probe.frames == planned) or given.get("level") == "pymunk")
    for group in _groups(probe, tolerance, native, given, fine, least):
        if tried and probe.spent + sum(map(probe.price, group)) > budget:
            break
        best = min((attempt(setting) for setting in group), key=lambda each: each.error)
        if best.error <= tolerance:
            chosen = best
            break
    limit = tolerance
    if not {"steps", "sweeps", "penetration"} & given.keys() and given.get("level") != "pymunk":
        tried += [Tried(setting, errors, probe.cost(setting)) for setting, errors in rungs[:-1]]
        if chosen is None:  # the finest is there to measure by: nothing is known to be nearer than the last but it
            limit = max(tolerance, tried[-1].error)
    if chosen is None:
        good = [each for each in tried if each.error <= limit]
        chosen = min(good, key=lambda each: each.cost_s) if good else min(tried, key=lambda each: each.error)
    if chosen.error <= limit and "steps" not in given and chosen.setting.steps > 2:
        between = chosen.setting._replace(steps=3 * chosen.setting.steps // 4)
        if least is None or between.steps >= least.steps:
            chosen = min((chosen, attempt(between)), key=lambda each: (each.error > limit, each.cost_s))
    if chosen.error <= limit and "sweeps" not in given and least is None:
        fewer = attempt(chosen.setting._replace(sweeps=FEWER_SWEEPS))
        chosen = fewer if fewer.error <= limit else chosen
    if probe.frames < planned and chosen.setting.level == "rigid" and "steps" not in given:
        chosen = chosen._replace(setting=chosen.setting._replace(steps=max(SUBSTEPS, chosen.setting.steps)))
    if sagitta is not None and chosen.error <= tolerance and chosen.setting.level == "rigid":
        for coarser in (100.0 * sagitta, 10.0 * sagitta):
            if probe.spent + probe.price(chosen.setting) > budget:
                break
            errors = probe.apart(probe.track(chosen.setting, coarser), fine.track) + fine.doubt
            if errors.max(initial=0.0) <= tolerance:
                chosen, sagitta = chosen._replace(errors=errors), coarser
                break
    states, seen = probe.run(chosen.setting, sagitta, materials=materials)
    finer: dict[int, int] = {}
    if (
        chosen.setting.level == "rigid"
        and "steps" not in given
        and least is None
        and whole
        and chosen.error <= tolerance
    ):
        chosen, finer, states = _apart(probe, chosen, seen, tried, tolerance, sagitta, fine, states)
    tried.sort(key=lambda each: (each.cost_s, each.error))
    probe.forget()
    end, way = np.zeros((len(probe.bodies), 6)), np.full(len(probe.bodies), np.inf)
    if len(states):
        end, way = states[-1], np.hypot(*np.moveaxis(states[:, :, :2] - states[0, :, :2], 2, 0)).max(axis=0)
    sooner = probe.apart(states, fine.track, so_far=True)
    return Found(
        chosen, finer, sagitta, tried, fine, seen, end, way, sooner, probe.frames, probe.begin or 0.0
    )


def _untried(probe: Probe, tolerance: float, given: Mapping[str, Any], least: Setting | None) -> Found:
    """The defaults, no deeper than a tenth of the tolerance, where a copy of one island alone would cost too much."""
    setting = least or Setting("rigid", SUBSTEPS, SWEEPS, min(PENETRATION, 0.1 * tolerance))
    setting = setting._replace(**{k: v for k, v in given.items() if k in Setting._fields})
    n = len(probe.bodies)
    chosen = Tried(setting, np.full(n, np.inf), probe.cost(setting))
    seen = Seen({}, np.arange(n), np.zeros(n, bool))
    end, way = np.zeros((n, 6)), np.full(n, np.inf)
    return Found(chosen, {}, None, [], Reference(setting, end, chosen.errors), seen, end, way, way, 0, 0.0)


def _groups(
    probe: Probe,
    tolerance: float,
    native: bool,
    given: Mapping[str, Any],
    fine: Reference,
    least: Setting | None,
) -> list[list[Setting]]:
    """Settings to try, the cheapest first; of each number of substeps those of several penetrations together."""
    level = given.get("level")
    depths = [PENETRATION, LEAST_DEPTH]
    if "penetration" in given or probe.stiffness is not None:
        depths = [given.get("penetration", PENETRATION)]
    sweeps = given.get("sweeps", SWEEPS)
    low = 1
    if least is not None:
        depths = [p for p in depths if p <= least.penetration] or [least.penetration]
        sweeps, low = max(sweeps, least.sweeps), least.steps
    out = []
    if level in (None, "rigid"):
        doubled = (low << i for i in range(8))
        for n in (
            [given["steps"]] if "steps" in given else [n for n in doubled if n < fine.setting.steps] or [low]
        ):
            out.append([Setting("rigid", n, sweeps, p) for p in depths])
    if native:  # (where all of the time is looked at: what it is off grows slowly)
        slop = given.get("penetration", PENETRATION)
        for n in [given["steps"]] if "steps" in given else NATIVE_STEPS:
            out.append([Setting("pymunk", n, sweeps, slop)])
    return sorted(out, key=lambda group: probe.cost(group[0]))


def _apart(
    probe: Probe,
    chosen: Tried,
    seen: Seen,
    tried: list[Tried],
    tolerance: float,
    sagitta: float | None,
    fine: Reference,
    states: Array,
) -> tuple[Tried, dict[int, int], Array]:
    """Each island's own substeps: the fewest with which its bodies were within the tolerance, where a run of that
    mixture is too; what that costs, and the run (`states`: of the chosen setting)."""
    alike = [chosen] + [
        each
        for each in tried
        if each.setting.level == "rigid" and each.setting.penetration == chosen.setting.penetration
    ]
    numbers = np.unique(seen.groups[probe.free])
    wanted = {
        int(group): min(
            each.setting.steps
            for each in alike
            if each.errors[seen.groups == group].max(initial=0.0) <= tolerance
            and each.setting.steps <= chosen.setting.steps
        )
        for group in numbers
    }
    base = min(wanted.values(), default=chosen.setting.steps)
    finer = {int(i): wanted[int(g)] for i, g in enumerate(seen.groups) if wanted.get(int(g), base) > base}
    if not finer:
        return chosen, {}, states
    setting = chosen.setting._replace(steps=base)
    mixed = probe.run(setting, sagitta, finer)[0]
    errors = probe.apart(mixed, fine.track) + fine.doubt
    if not errors.max(initial=0.0) <= tolerance:
        return chosen, {}, states
    share = {g: float((seen.groups == g).sum()) / len(probe.bodies) for g in wanted}
    parts = [(share[g] * len(probe.bodies), share[g] * probe.pairs, n) for g, n in wanted.items()]
    cost = costs.area_frame(parts, setting.sweeps, probe.points)
    return Tried(setting, errors, min(cost, chosen.cost_s)), finer, mixed
