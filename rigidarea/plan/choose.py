"""The cheapest settings that are within a tolerance, found by trying them on a `Probe`."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from ..chipmunk.attach import PENETRATION
from ..contact.constants import SUBSTEPS
from . import costs
from .probe import LEAST_DEPTH, Array, Probe, Reference, Seen, Setting, reference

SHARE, UNNOTICED_S = 0.05, 0.1
"""What trying out may cost: this share of the planned run, or the time that is not noticed as waiting (s; R. B. Miller,
Response time in man-computer conversational transactions, 1968), whichever is more."""
RUNS = 8.5
"""Runs of two substeps that the budget must do for: the ladder's first two are 3.5, one and two substeps at two
penetrations 3, fewer sweeps 1, what is chosen once more 1. The time looked at is cut until it does."""
FINE_SHARE = 0.5
"""Of the budget: what the ladder may take, where it needs it."""
STEPS = (1, 2, 4, 8, 16, 32, 64, 128)
SWEEPS, FEWER_SWEEPS = 10, 5
FINEST_SAGITTA = 1e-6
"""Of an outline sampled anew (fraction of its smallest extent)."""


def budget_of(bodies: int, frames: int, steps: int | None) -> float:
    """What trying out may cost (s): of so many bodies, planned for so many frames of so many substeps."""
    run = costs.area_frame([(bodies, bodies, steps or SUBSTEPS)], SWEEPS) * frames
    return max(SHARE * run, UNNOTICED_S)


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
    sooner: Array  # (bodies,) what each is off over its way up to then, the largest


class Search:
    """Settings tried on a probe.

    given: level, steps, sweeps, penetration that the user has said. least: nothing is to be coarser than that. budget:
    what trying out may cost (s).
    """

    def __init__(self, probe: Probe, given: Mapping[str, Any], least: Setting | None, budget: float) -> None:
        self.probe, self.given, self.least, self.budget = probe, given, least, budget
        self.tried: list[Tried] = []

    def found(self, native: bool) -> Found:
        """The cheapest setting whose error is within the tolerance; where none is, the one with the least.

        native: whether Chipmunk's own response may be chosen, by the plan or by the user.
        """
        probe, planned = self.probe, self.probe.frames
        if probe.moving and not probe.bodies:
            return self._untried()
        left = self.budget - probe.spent - costs.COPY_BODY_S * len(probe.bodies)
        probe.look(left / RUNS, Setting("rigid", SUBSTEPS, SWEEPS, PENETRATION))
        self.sagitta = None
        if probe.sampled and self.least is None:
            # facets that turn by no more than the tolerance: turn² = 8 sagitta/radius
            self.sagitta = float(np.clip(probe.tolerance**2 / 8.0, FINEST_SAGITTA, 1e-3))
        self.fine = reference(probe, self.sagitta, FINE_SHARE * self.budget, self.least)
        # where all is looked at: what Chipmunk's response is off grows slowly
        seen_whole = probe.share == 1.0 and probe.frames == planned
        chosen = self._cheapest(native and (seen_whole or self.given.get("level") == "pymunk"))
        rigid = chosen.setting.level == "rigid"
        if probe.frames < planned and rigid and "steps" not in self.given:
            steps = max(SUBSTEPS, chosen.setting.steps)
            chosen = chosen._replace(setting=chosen.setting._replace(steps=steps))
        if self.sagitta is not None and rigid:
            for coarser in (100.0 * self.sagitta, 10.0 * self.sagitta):
                errors = self._errors(chosen.setting, coarser)
                if errors.max(initial=0.0) <= max(self.probe.tolerance, chosen.error):
                    chosen, self.sagitta = chosen._replace(errors=errors), coarser
                    break
        states, seen = probe.run(chosen.setting, self.sagitta, noted=True)
        finer: dict[int, int] = {}
        if rigid and "steps" not in self.given and self.least is None and probe.share == 1.0:
            chosen, finer, states = self._islands(chosen, seen) or (chosen, {}, states)
        sooner = probe.apart(states, self.fine.track, so_far=True)
        self.tried.sort(key=lambda each: (each.cost_s, each.error))
        probe.copies.clear()
        probe.extents.clear()
        return Found(chosen, finer, self.sagitta, self.tried, self.fine, seen, sooner)

    def _untried(self) -> Found:
        """The defaults, no deeper than a tenth of the tolerance, where a copy of one island alone would cost too
        much."""
        depth = min(PENETRATION, 0.1 * self.probe.tolerance)
        setting = self.least or Setting("rigid", SUBSTEPS, SWEEPS, depth)
        setting = setting._replace(**{k: v for k, v in self.given.items() if k in Setting._fields})
        n = len(self.probe.bodies)
        unknown = np.full(n, np.inf)
        chosen = Tried(setting, unknown, self.probe.cost(setting))
        fine = Reference(setting, np.zeros((0, n, 6)), unknown, [])
        return Found(chosen, {}, None, [], fine, Seen({}, np.arange(n)), unknown)

    # --- trying ---

    def _errors(self, setting: Setting, sagitta: float | None) -> Array:
        """(bodies,) What each is off; infinite where that would cost more than is left."""
        if self.tried and self.probe.spent + self.probe.price(setting) > self.budget:
            return np.full(len(self.probe.bodies), np.inf)
        return self.probe.apart(self.probe.track(setting, sagitta), self.fine.track) + self.fine.doubt

    def _attempt(self, setting: Setting) -> Tried:
        tried = Tried(setting, self._errors(setting, self.sagitta), self.probe.cost(setting))
        if tried.error < np.inf or not self.tried:
            self.tried.append(tried)
        return tried

    def _cheapest(self, native: bool) -> Tried:
        """The cheapest setting within the tolerance, the softest of those; where none is, the one with the least error
        that was measured (the finest is there to measure by)."""
        probe, given, tolerance = self.probe, self.given, self.probe.tolerance
        for group in self._groups(native):
            if min(self._attempt(setting).error for setting in group) <= tolerance:
                break
        if not {"steps", "sweeps", "penetration"} & given.keys() and given.get("level") != "pymunk":
            self.tried += [Tried(run, errors, probe.cost(run)) for run, errors in self.fine.coarser]
        within = [each for each in self.tried if each.error <= tolerance]
        if not within and self.least is not None:  # a plan that was outgrown: better too fine than too coarse
            return max(self.tried, key=lambda each: each.cost_s)
        if not within:
            return min(self.tried, key=lambda each: each.error)
        # no stiffer than need be, at one cost: fewer sweeps, and what comes in later, are solved the better
        chosen = min(within, key=lambda each: (each.cost_s, -each.setting.penetration, each.error))
        setting = chosen.setting
        if "steps" not in given and setting.steps > max(2, self.least.steps if self.least else 0):
            between = self._attempt(setting._replace(steps=3 * setting.steps // 4))
            chosen = between if between.error <= tolerance else chosen
        if "sweeps" not in given and self.least is None:
            fewer = self._attempt(chosen.setting._replace(sweeps=FEWER_SWEEPS))
            chosen = fewer if fewer.error <= tolerance else chosen
        return chosen

    def _groups(self, native: bool) -> list[list[Setting]]:
        """Settings to try, the cheapest first; of each number of substeps those of two penetrations together: the
        default, and the least there is."""
        given, level = self.given, self.given.get("level")
        depths = [PENETRATION, LEAST_DEPTH]
        if "penetration" in given or self.probe.stiffness is not None:
            depths = [given.get("penetration", PENETRATION)]
        sweeps, low = given.get("sweeps", SWEEPS), 1
        if self.least is not None:
            depths = [p for p in depths if p <= self.least.penetration] or [self.least.penetration]
            sweeps, low = max(sweeps, self.least.sweeps), self.least.steps
        out = []
        if level in (None, "rigid"):
            numbers = [low * n for n in STEPS if low * n < self.fine.setting.steps] or [low]
            for n in [given["steps"]] if "steps" in given else numbers:
                out.append([Setting("rigid", n, sweeps, p) for p in depths])
        if native:
            for n in [given["steps"]] if "steps" in given else STEPS:
                out.append([Setting("pymunk", n, sweeps, depths[0])])
        return sorted(out, key=lambda group: self.probe.cost(group[0]))

    def _islands(self, chosen: Tried, seen: Seen) -> tuple[Tried, dict[int, int], Array] | None:
        """Each island's own substeps: the fewest with which its bodies were within the tolerance; what that costs, and
        the run. None where a run of that mixture is not within it, or all take the same."""
        probe, tolerance, setting = self.probe, self.probe.tolerance, chosen.setting
        if chosen.error > tolerance:
            return None
        wanted = dict.fromkeys(np.unique(seen.groups[probe.free]).tolist(), setting.steps)
        for each in self.tried:
            if each.setting._replace(steps=setting.steps, sweeps=setting.sweeps) == setting:
                for group, steps in wanted.items():
                    if each.errors[seen.groups == group].max(initial=0.0) <= tolerance:
                        wanted[group] = min(steps, each.setting.steps)
        base = min(wanted.values(), default=setting.steps)
        finer = {int(i): wanted[int(g)] for i, g in enumerate(seen.groups) if wanted.get(int(g), base) > base}
        if not finer:
            return None
        setting = setting._replace(steps=base)
        mixed = probe.run(setting, self.sagitta, finer)[0]
        errors = probe.apart(mixed, self.fine.track) + self.fine.doubt
        if not errors.max(initial=0.0) <= tolerance:
            return None
        share = {g: float((seen.groups == g).mean()) for g in wanted}
        parts = [(share[g] * len(probe.bodies), share[g] * probe.pairs, n) for g, n in wanted.items()]
        cost = costs.area_frame(parts, setting.sweeps, probe.points)
        return Tried(setting, errors, min(cost, chosen.cost_s)), finer, mixed
