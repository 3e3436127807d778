"""`plan(space, tolerance)`: the cheapest settings whose predicted error is within a tolerance, and why.

A plan reads a space and changes nothing; `Plan.apply` makes it so. What it weighs is in `predict`, from the closed
forms in `estimates`; what it costs in `costs`.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, Literal, TypedDict, Unpack

import numpy as np
import pymunk

from ..contact import AreaContact, SimulationError, attach, attached
from ..gate import positive, truth, whole
from . import costs, elastic
from . import estimates as est
from .curves import FACETS
from .facts import AHEAD, Facts, facts
from .parts import Part, parts_of
from .predict import Cause, Setting, causes, total
from .promise import unpromised
from .survey import survey
from .table import Line, lines_of, text_of

if TYPE_CHECKING:
    from .watch import Watch

LEVELS = ("rigid", "pymunk")
ELASTIC = ("compliant", "modal")
STEPS = (1, 2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64, 96, 128)
"""Substeps a frame that a plan chooses among."""
SWEEPS = (5, 10, 20, 40, 80)
PENETRATIONS = tuple(10.0 ** (-e / 2.0) for e in range(4, 19))
"""From 1e-2 to 1e-9 of a body's smallest extent, half a decade apart: below, an overlap has lost half its digits."""
MARGIN = 0.8
"""Of the tolerance: what is predicted must be within this part of it, for the estimates are not exact."""
SLOP = 0.1
"""Of the tolerance: the share that Chipmunk's slop may have of it."""
SECONDS = 10.0
"""Time that is planned for, unless it is said."""


class Overrides(TypedDict, total=False):
    """What may be said otherwise; None takes a word back."""

    level: Literal["rigid", "compliant", "modal", "pymunk"] | None
    steps: int | None
    sweeps: int | None
    penetration: float | None
    stiffness: float | None
    sampling: float | None


SETTINGS = tuple(Overrides.__annotations__)


class Plan:
    """What `plan` chose. Printed, it is a table; `apply` makes it so; `override` says otherwise.

    `level`: "rigid" (area contact) or "pymunk" (Chipmunk's own response); `steps` substeps a frame of `frame` (time);
    `sweeps` a substep; `penetration`, the fraction of a body's smallest extent that contacts may sink by, or
    `stiffness` where it was given; `sampling`, the sagitta of each curved outline that is sampled anew (length).
    `finer`: bodies whose islands take more substeps than `steps`, and how many. `error` is predicted, `cost_s_per_s`
    too (processor time over simulated time). `reachable`: whether any setting is predicted to be within the tolerance;
    where none is, the plan is the one with the least predicted error. `unpromised`: what bears on the error and no
    estimate knows, a sentence each.
    """

    def __init__(
        self,
        space: pymunk.Space,
        tolerance: float | str,
        seconds: float | None,
        frame: float,
        materials: Mapping[pymunk.Body, Any],
    ) -> None:
        self.space = space
        self.tolerance = relative(tolerance)
        self.seconds = SECONDS if seconds is None else positive(seconds, "seconds")
        self.frame = positive(frame, "frame")
        self.materials = dict(materials)
        self.overrides: dict[Any, dict[str, Any]] = {}
        self.level, self.steps, self.sweeps, self.penetration = "rigid", 2, 10, 2e-4
        self.stiffness: float | None = None
        self.sampling: dict[pymunk.Shape, float] = {}
        self.finer: dict[pymunk.Body, int] = {}
        self._parts: list[tuple[Part, int]] = []
        self._asked: set[pymunk.Body] = set()
        self._sampled: dict[pymunk.Shape, float] = {}
        self.reachable = False
        self.unpromised: list[str] = []
        self.error = self.cost_s_per_s = math.inf
        self.causes: list[Cause] = []
        self.elastic: list[elastic.Choice] = []
        self._assembled: tuple[Any, Any] = (), None  # what of `elastic` it was made from, and the assembly
        self.again()

    # --- choosing ---

    def again(self, keep: bool = False) -> Plan:
        """Look at the space as it is now and choose anew; overrides stay. Changes nothing in the space.

        keep: level and outlines stay, and nothing gets coarser: what can be changed between frames without a jump.
        """
        truth(keep, "keep")
        given = dict(self.overrides.get(None, {}))
        sampled = dict(self.sampling)
        if keep:
            given["level"] = self.level
        before, finer = (self.steps, self.sweeps, self.penetration), dict(self.finer)
        current = attached(self.space)
        self.stiffness = given.get("stiffness", current.stiffness if current is not None else None)
        if not keep:
            self.elastic = elastic.choose(
                self.space, self.materials, self.tolerance, self.stiffness, self.overrides
            )
        seen = survey(self.space, min(self.seconds, AHEAD * self.frame), self.frame)
        found = facts(seen, self.frame, self.seconds)
        self._asked_turns(found)
        self._survey, self._facts = seen, found
        touching, moving = _touching(found), _moving(found)
        best: tuple[float, float, Setting] | None = None
        least: tuple[float, float, Setting] | None = None
        for setting in self._candidates(found, given):
            error = total(found, setting)
            cost = _cost(setting, moving, touching)
            if error <= MARGIN * self.tolerance and (best is None or cost < best[1]):
                best = error, cost, setting
            if least is None or error < 0.99 * least[0] or (error <= least[0] and cost < least[1]):
                least = error, cost, setting
        assert least is not None
        self.reachable = best is not None
        self.error, cost, chosen = best or least
        if keep:
            pairs = zip(before, chosen[1:])
            steps, sweeps, depth = (max(pair) if i < 2 else min(pair) for i, pair in enumerate(pairs))
            chosen = Setting(self.level, int(steps), int(sweeps), depth)
            self.error, cost = total(found, chosen), _cost(chosen, moving, touching)
            self.reachable = self.error <= MARGIN * self.tolerance
        self._parts = []
        if chosen.level == "rigid" and "steps" not in given:
            apart = self._apart(
                given, cost if best or keep else math.inf, Setting(self.level, *before) if keep else None
            )
            if apart is not None:
                chosen, cost, self._parts = apart
                self.reachable = True
        self.level, self.steps, self.sweeps, self.penetration = chosen
        self.causes = causes(found, chosen)
        if self._parts:
            told = [
                cause for part, n in self._parts for cause in causes(part.facts, chosen._replace(steps=n))
            ]
            self.causes = sorted(told, key=lambda cause: -cause.error)
            self.error = self.causes[0].error if self.causes else 0.0
        self.unpromised = unpromised(self.space, seen, self.causes, self.elastic, self.seconds)
        self.finer = self._finer(finer if keep else {})
        if keep:
            self.sampling = sampled
        else:
            self._choose_sampling(found)
        self.cost_s_per_s = cost / self.frame
        self._frame_cost = cost
        return self

    def _candidates(self, found: Facts, given: dict[str, Any]) -> list[Setting]:
        """Settings to weigh: of each number of steps and sweeps the penetration that suits it best."""
        steps = (given["steps"],) if "steps" in given else STEPS
        piled = found.piled
        least = found.least_sweeps
        most = 2 * est.LEAST_PILE_SWEEPS  # beyond, substeps help more
        sweeps = (given["sweeps"],) if "sweeps" in given else tuple(n for n in SWEEPS if least <= n <= most)
        if not piled:
            sweeps = sweeps[:1]
        depths = (given["penetration"],) if "penetration" in given else PENETRATIONS
        out = []
        level = given.get("level")
        if level in (None, "rigid"):
            for n in steps:
                # how deep does not depend on the sweeps: found once for each number of steps
                errors = [total(found, Setting("rigid", n, sweeps[-1], p)) for p in depths]
                enough = max(1.1 * min(errors), 0.6 * self.tolerance)
                depth = next(p for p, error in zip(depths, errors) if error <= enough)
                out += [Setting("rigid", n, m, depth) for m in sweeps]
                if total(found, Setting("rigid", n, sweeps[0], depth)) <= MARGIN * self.tolerance:
                    break  # more substeps are dearer, whatever the sweeps
        bends = any(choice.level in ELASTIC for choice in self.elastic)
        native = level == "pymunk" or (level is None and not bends and _native_will_do(found, self.stiffness))
        if native:
            share = SLOP / (est.TOPPLE if found.corner else 1.0)
            slop = given.get("penetration", share * self.tolerance / found.tower)
            native_sweeps = (given["sweeps"],) if "sweeps" in given else SWEEPS if piled else SWEEPS[:1]
            out += [Setting("pymunk", n, m, slop) for n in steps for m in native_sweeps]
        return out

    def _apart(
        self, given: dict[str, Any], whole: float, least: Setting | None
    ) -> tuple[Setting, float, list[tuple[Part, int]]] | None:
        """Each part's own substeps, where that is cheaper than the `whole` costs (s a frame); None where it is not.

        Sweeps and penetration are the space's: the most, and the least, that a part wants. least: no coarser than that.
        """
        parts = parts_of(self._survey, self.space, self.frame, self.seconds)
        if not parts:
            return None
        best = []
        for part in parts:
            self._asked_turns(part.facts)
            good = [
                (self._cost_of(part, setting), setting)
                for setting in self._candidates(part.facts, {**given, "level": "rigid"})
                if total(part.facts, setting) <= MARGIN * self.tolerance
            ]
            if not good:
                return None
            best.append(min(good)[1])
        sweeps = max([setting.sweeps for setting in best] + ([least.sweeps] if least else []))
        found = None
        for depth in sorted({setting.penetration for setting in best}):
            if least is not None and depth > least.penetration:
                continue
            told = []
            for part in parts:
                each = (n for n in STEPS if self._within(part, Setting("rigid", n, sweeps, depth)))
                told.append((part, next(each, 0)))
            if not all(n for _, n in told):
                continue
            steps = [(_moving(part.facts), _touching(part.facts), n) for part, n in told]
            cost = costs.turns_frame(steps, sweeps)
            if cost < whole and (found is None or cost < found[1]):
                base = max(min(n for _, n in told), least.steps if least else 1)
                found = Setting("rigid", base, sweeps, depth), cost, told
        return found

    def _within(self, part: Part, setting: Setting) -> bool:
        return total(part.facts, setting) <= MARGIN * self.tolerance

    def _cost_of(self, part: Part, setting: Setting) -> float:
        return _cost(setting, _moving(part.facts), _touching(part.facts))

    def _finer(self, before: dict[pymunk.Body, int]) -> dict[pymunk.Body, int]:
        """Bodies whose islands take more than the space: as planned, as before at least, as the user says."""
        wanted = {body: n for part, n in self._parts for body in part.bodies}
        for body, n in before.items():
            wanted[body] = max(n, wanted.get(body, 0))
        for target, settings in self.overrides.items():
            if isinstance(target, pymunk.Body) and "steps" in settings:
                wanted[target] = settings["steps"]
        return {body: n for body, n in wanted.items() if n > self.steps and body.space is self.space}

    def _asked_turns(self, found: Facts) -> None:
        """The share that facets may have, and what has been asked for."""
        found.facet_share = FACETS * self.tolerance
        for facet in found.facets:
            given = self.overrides.get(found.seen.shapes[facet.shape], {}).get("sampling")
            if given is not None:
                found.fixed_turns[facet.shape] = float(est.facet_turn(facet.radius, given))

    def _choose_sampling(self, found: Facts) -> None:
        """The sagitta of curved outlines that know their curve, as the chosen penetration asks for."""
        self.sampling = {}
        for facet in found.facets:
            shape = found.seen.shapes[facet.shape]
            given = self.overrides.get(shape, {}).get("sampling")
            if given is not None:
                self.sampling[shape] = given
            elif facet.known:
                turn = facet.turn_for(found.facet_share, self.penetration, found.seen.g > 0.0)
                self.sampling[shape] = float(est.tolerance_for_turn(facet.radius, turn))

    # --- overriding ---

    def override(
        self, target: pymunk.Shape | pymunk.Body | None = None, **settings: Unpack[Overrides]
    ) -> Plan:
        """Say otherwise, and plan the rest around it; None takes a word back. Returns the plan.

        target None: the whole space: level ("rigid", "pymunk"), steps, sweeps, penetration, stiffness. A shape:
        sampling (sagitta, length). A body: steps, at least so many for its island; with a material: level ("rigid",
        "compliant", "modal").
        Raises ValueError for what is none of these, before anything has changed.
        """
        checked = {}
        for name, value in settings.items():
            _check(target, name, value, self.materials)
            checked[name] = value
        kept = {**self.overrides.get(target, {}), **checked}
        self.overrides[target] = {name: value for name, value in kept.items() if value is not None}
        return self.again()

    # --- doing ---

    def apply(self) -> AreaContact | None:
        """Make it so: attach (or detach) the space, set its iterations, slop, stiffness and outlines.

        Where a body bends, those with a material become parts of a `flexible.Assembly`, each at its level.

        Returns the contact, None where Chipmunk's own response will do. Substeps are the plan's, not the space's:
        step by `Plan.step`, or by `contact.step(dt, steps=plan.steps)`. What is attached already keeps its law and
        its state; other levels of what bends attach it anew, with its settings.
        Raises ValueError as `flexible.Assembly.part` does.
        """
        space = self.space
        current = attached(space)
        space.iterations = self.sweeps
        for shape, sagitta in self.sampling.items():
            if self._sampled.get(shape) == sagitta:
                continue  # as it is: to be read again would cost it its contacts
            self._sampled[shape] = sagitta
            shape.outline = shape.outline.sample(sagitta)  # type: ignore[attr-defined]
            if current is not None:
                current.refresh(shape)
        if self.level == "pymunk":
            if current is not None:
                current.detach()
            smallest = float(self._survey.extent[self._survey.moves].min(initial=math.inf))
            if math.isfinite(smallest):
                space.collision_slop = self.penetration * smallest
            return None
        before = self._assembled[1]
        flexible = self._assembly()
        held = current._settings["flexible"] if current is not None else None
        if current is not None and flexible is not held and (flexible is not None or held is before):
            settings = {**current._settings, "flexible": flexible}
            current.detach()
            current = attach(space, **settings)
        if current is None:
            current = attach(space, self.stiffness, penetration=self.penetration, flexible=flexible)
        for body in self._asked - self.finer.keys():
            if body.space is space:
                current.ask(body, None)
        for body, steps in self.finer.items():
            current.ask(body, steps)
        self._asked = set(self.finer)
        if current.stiffness != self.stiffness:
            current.stiffness = self.stiffness
        current.penetration = self.penetration
        return current

    def _assembly(self) -> Any:
        """The parts that bend, made when they are first asked for, and again where their levels are others."""
        wanted = [(choice.body, choice.level, choice.modes) for choice in self.elastic], self.stiffness
        if wanted != self._assembled[0]:
            self._assembled = wanted, elastic.assemble(self.elastic, self.materials, self.stiffness)
        return self._assembled[1]

    def step(self, dt: float | None = None, frames: int = 1) -> None:
        """Frames (of `frame`, unless dt says otherwise), in as many substeps as planned. After `apply`.

        Raises ValueError for arguments out of range, RuntimeError before `apply`, SimulationError where a body's state
        stops being finite.
        """
        dt = self.frame if dt is None else positive(dt, "dt")
        whole(frames, "frames", 1)
        contact = attached(self.space)
        if self.level == "pymunk":
            for _ in range(frames * self.steps):
                self.space.step(dt / self.steps)
        elif contact is None:
            raise RuntimeError("expected a plan that is applied: call apply() first")
        else:
            contact.step(dt, frames, steps=self.steps)
        for i, body in enumerate(self.space.bodies):  # Chipmunk's own step says nothing of it
            if not math.isfinite(sum(body.position) + body.angle + sum(body.velocity)):
                raise SimulationError(f"the state of bodies[{i}] is not finite after dt = {dt:g}")

    def watch(self, adapt: bool = False) -> Watch:
        """What stands beside the plan while it runs: see `Watch`."""
        from .watch import Watch

        return Watch(self, adapt)

    # --- reading ---

    @property
    def lines(self) -> list[Line]:
        """The table: the space first, then what decides, parts, shapes that are sampled anew, elastic bodies."""
        return lines_of(self)

    def __str__(self) -> str:
        return text_of(self)

    def _setting(self, steps: int) -> Setting:
        return Setting(self.level, steps, self.sweeps, self.penetration)

    @property
    def idle_speed(self) -> float:
        """Speed (length/time) below which a body that sleeps half a second is off by no more than the tolerance."""
        seen = self._survey
        smallest = float(seen.extent[seen.moves].min(initial=math.inf))
        return self.tolerance * smallest / max(self.seconds, 0.5) if math.isfinite(smallest) else 0.0

    @property
    def may_sleep(self) -> list[pymunk.Body]:
        """Bodies that lie flush on something and stand still: `space.sleep_time_threshold` is yours to set."""
        seen = self._survey
        lies = np.zeros(len(seen.bodies), bool)
        close = seen.gaps <= 1e-3 * np.min(seen.thickness[seen.pairs], axis=1, initial=math.inf)
        lies[seen.owner[seen.pairs[close]].ravel()] = True
        still = (seen.speed <= self.idle_speed) & (seen.spin * seen.reach <= self.idle_speed)
        rolls = np.zeros(len(seen.bodies), bool)
        rolls[seen.owner[seen.corners | (seen.radius != 0.0)]] = True
        return [seen.bodies[i] for i in np.flatnonzero(lies & still & seen.moves & ~rolls)]


def _moving(found: Facts) -> int:
    """How many bodies move."""
    return int(found.seen.moves.sum())


def _touching(found: Facts) -> int:
    """How many pairs touch."""
    return int((found.seen.gaps <= 0.0).sum())


def _cost(setting: Setting, bodies: int, pairs: int) -> float:
    if setting.level == "pymunk":
        return costs.native_frame(bodies, setting.steps, setting.sweeps)
    return costs.area_frame(bodies, pairs, setting.steps, setting.sweeps)


def _native_will_do(found: Facts, stiffness: float | None) -> bool:
    """Whether Chipmunk sees the same outlines: none of its shapes stands in for another."""
    return stiffness is None and all(outline is None for outline in found.seen.outlines)


def relative(tolerance: float | str) -> float:
    """A relative tolerance: 0.05, "0.05" or "5%". Raises ValueError for what is none of these."""
    if not isinstance(tolerance, str):
        return positive(tolerance, "tolerance")
    text = tolerance.strip()
    try:
        number = float(text.removesuffix("%"))
    except ValueError:
        raise ValueError(
            f"tolerance must be a number, or a number of per cent like 5%, got {tolerance!r:.80}"
        ) from None
    return positive(number, "tolerance") / (100.0 if text.endswith("%") else 1.0)


def _check(target: Any, name: str, value: Any, materials: Mapping[pymunk.Body, Any]) -> None:
    if target is None:
        allowed: tuple[str, ...] = SETTINGS[:-1]
    elif isinstance(target, pymunk.Shape):
        allowed = ("sampling",)
    elif isinstance(target, pymunk.Body):
        allowed = ("steps", "level") if target in materials else ("steps",)
    else:
        raise ValueError(f"expected None, a shape, or a body to override, got {target!r}")
    if name not in allowed:
        raise ValueError(f"expected one of {', '.join(allowed)} to override here, got {name!r}")
    if value is None:
        return
    if name == "level":
        known = LEVELS if target is None else ("rigid", *ELASTIC)
        if value not in known:
            raise ValueError(f"level must be one of {', '.join(known)}, got {value!r}")
    elif name in ("steps", "sweeps"):
        if isinstance(value, bool) or not isinstance(value, int | np.integer) or value < 1:
            raise ValueError(f"{name} must be a whole number >= 1, got {value!r}")
    else:
        positive(value, name)


def plan(
    space: pymunk.Space,
    tolerance: float | str,
    seconds: float | None = None,
    *,
    frame: float = 1 / 60,
    materials: Mapping[pymunk.Body, Any] | None = None,
) -> Plan:
    """Choose the cheapest model and settings for a space whose predicted error is within `tolerance`.

    tolerance: relative, of the study's errors: a velocity's over the approach speed, a path's over its length or the
        body's size; 0.01 is one per cent, and so is "1%".
    seconds: simulated time over which it must hold, 10 unless said; errors that grow (bounces, curved paths) grow
    with it. frame: length of a frame (time).
    materials: what bodies are made of (`flexible.Material`), where it matters whether they bend.

    Nothing is changed before `Plan.apply`. Raises ValueError for settings out of range.
    """
    if not isinstance(space, pymunk.Space):
        raise ValueError(f"space must be a pymunk.Space, got {type(space).__name__}")
    if not isinstance(materials, Mapping | None):
        raise ValueError(f"materials must be a mapping by pymunk.Body, got {type(materials).__name__}")
    for body in materials or {}:
        if not isinstance(body, pymunk.Body):
            raise ValueError(f"materials must be given by pymunk.Body, got {type(body).__name__}")
    return Plan(space, tolerance, seconds, frame, materials or {})
