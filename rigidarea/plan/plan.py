"""`plan(space, tolerance)`: the cheapest settings that are within a tolerance on a copy of a space, and why.

What is tried is in `choose`, how in `probe`; which bodies bend is in `elastic`.
"""

from __future__ import annotations

import math
import time as clock
from collections.abc import Mapping
from typing import Any, Literal, TypedDict, Unpack

import numpy as np
import pymunk

from ..chipmunk import AreaContact, SimulationError, attach, attached
from ..contact.constants import MOST_SUBSTEPS
from ..geometry.gate import fraction, one_of, positive, truth, whole
from ..geometry.outline import Outline, outline_on
from . import elastic
from .choose import Found, Search, budget_of
from .part import part
from .probe import Probe, Setting
from .promise import name_of, unpromised
from .table import Line, lines_of, text_of
from .watch import Watch

LEVELS = ("rigid", "pymunk")
ELASTIC = ("compliant", "modal")
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
    `finer`: bodies whose islands take more substeps than `steps`, and how many. `error` is what a run of a copy was off
    a finer one, `cost_s_per_s` is predicted (processor time over simulated time). `reachable`: whether a setting was
    found within the tolerance; where none was, the plan is the one with the least error. `tried`: what was tried, by
    cost. `looked`: the simulated time that was tried out, `planning_s` what that cost (processor time). `unpromised`:
    what bears on the error and was not tried, a sentence each.
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
        self.finer: dict[pymunk.Body, int] = {}
        self._asked: set[pymunk.Body] = set()
        self._sampled: dict[pymunk.Shape, float] = {}
        self._assembled: tuple[Any, Any] = (), None  # what of `elastic` it was made from, and the assembly
        self.again()

    # --- choosing ---

    def again(self, keep: bool = False) -> Plan:
        """Look at the space as it is now and choose anew; overrides stay. Changes nothing in the space.

        keep: level and outlines stay, and nothing gets coarser: what can be changed between frames without a jump.
        """
        truth(keep, "keep")
        started = clock.thread_time()
        given = dict(self.overrides.get(None, {}))
        least = Setting(self.level, self.steps, self.sweeps, self.penetration) if keep else None
        if keep:
            given["level"] = self.level
        current = attached(self.space)
        self.stiffness: float | None = given.get("stiffness", current.stiffness if current else None)
        if not keep:
            self.elastic = elastic.choose(
                self.space, self.materials, self.tolerance, self.stiffness, self.overrides
            )
        asked = {shape: told["sampling"] for shape, told in self.overrides.items() if "sampling" in told}
        frames = max(1, round(self.seconds / self.frame))
        budget = budget_of(len(self.space.bodies), frames, given.get("steps"))
        bodies = part(self.space, budget)
        probe = Probe(self.space, self.frame, frames, self.stiffness, asked, self.tolerance, bodies)
        bends = any(choice.level in ELASTIC for choice in self.elastic)
        free = "level" not in given and self.stiffness is None and not bends and not probe.stands_in
        native = free or given.get("level") == "pymunk"
        found = Search(probe, given, least, budget).found(native)
        self._probe, self._found = probe, found
        self.level, self.steps, self.sweeps, self.penetration = found.chosen.setting
        self.error, self.tried = found.chosen.error, found.tried
        self.reachable = self.error <= self.tolerance
        before = self.finer if keep else {}
        self.finer = self._finer({probe.bodies[i]: n for i, n in found.finer.items()}, before)
        if not keep:
            self.sampling: dict[pymunk.Shape, float] = {**self._sagittas(found), **asked}
        self.cost_s_per_s = found.chosen.cost_s / self.frame
        looked, tried = (probe.frames, len(bodies)) if found.tried else (0, 0)
        self.looked, self.planning_s = looked * self.frame, clock.thread_time() - started
        self.unpromised = unpromised(
            self.space, self.elastic, looked / frames, self.looked, probe.begin or 0.0, tried
        )
        sooner = float(found.sooner.max(initial=0.0))
        if self.reachable and sooner > self.tolerance:
            name = name_of(self.space, bodies[int(found.sooner.argmax())])
            told = f"so little at each moment: {name} is off by {sooner:.1e} of its way until then"
            self.unpromised.append(told)
        return self

    def _finer(self, found: dict[pymunk.Body, int], before: dict[pymunk.Body, int]) -> dict[pymunk.Body, int]:
        """Bodies whose islands take more than the space: as found, as before at least, as the user says."""
        wanted = {body: max(found.get(body, 0), before.get(body, 0)) for body in found | before}
        told = {body: s["steps"] for body, s in self.overrides.items() if body is not None and "steps" in s}
        return {body: n for body, n in (wanted | told).items() if n > self.steps and body.space is self.space}

    def _sagittas(self, found: Found) -> dict[pymunk.Shape, float]:
        """The sagitta (length) of each outline that knows its curve."""
        if found.sagitta is None or self.level == "pymunk":
            return {}
        return {
            shape: found.sagitta * float(outline.smallest_extent)
            for shape in self.space.shapes
            if isinstance(outline := vars(shape).get("outline"), Outline) and outline._resample is not None
        }

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
        for name, value in settings.items():
            _check(self.space, target, name, value, self.materials)
        kept: dict[str, Any] = {**self.overrides.get(target, {}), **settings}
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
            if self._probe.smallest:
                space.collision_slop = self.penetration * self._probe.smallest
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
        return Watch(self, adapt)

    # --- reading ---

    @property
    def lines(self) -> list[Line]:
        """The table: the space first, then the next cheaper and finer choice, the worst bodies, and what else is
        chosen."""
        return lines_of(self)

    def __str__(self) -> str:
        return text_of(self)

    @property
    def idle_speed(self) -> float:
        """Speed (length/time) below which a body that sleeps half a second is off by no more than the tolerance."""
        return self.tolerance * self._probe.smallest / max(self.seconds, 0.5)

    @property
    def may_sleep(self) -> list[pymunk.Body]:
        """Bodies that stood still in what was tried out: `space.sleep_time_threshold` is yours to set."""
        probe, track = self._probe, self._found.fine.track
        if not len(track):
            return []
        speed = np.hypot(track[-1, :, 3], track[-1, :, 4]) + probe.reach * np.abs(track[-1, :, 5])
        way = np.hypot(*np.moveaxis(track[:, :, :2] - track[0, :, :2], 2, 0)).max(axis=0)
        still = (speed <= self.idle_speed) & (way <= self.tolerance * probe.extent)
        return [probe.bodies[i] for i in np.flatnonzero(still & probe.free)]


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


def _check(
    space: pymunk.Space, target: Any, name: str, value: Any, materials: Mapping[pymunk.Body, Any]
) -> None:
    if target is None:
        allowed: tuple[str, ...] = SETTINGS[:-1]
    elif isinstance(target, pymunk.Shape):
        allowed = ("sampling",)
    elif isinstance(target, pymunk.Body):
        allowed = ("steps", "level") if target in materials else ("steps",)
    else:
        raise ValueError(f"expected None, a shape, or a body to override, got {target!r}")
    # of one that left words may be taken back
    if target is not None and target.space is not space and value is not None:
        raise ValueError(f"expected a shape or a body of the plan's space to override, got {target!r:.80}")
    if name not in allowed:
        raise ValueError(f"expected one of {', '.join(allowed)} to override here, got {name!r}")
    if value is None:
        return
    if name == "level":
        one_of(value, name, LEVELS if target is None else ("rigid", *ELASTIC))
    elif name == "steps":
        whole(value, name, 1, MOST_SUBSTEPS)
    elif name == "sweeps":
        whole(value, name, 1)
    elif name == "penetration":
        fraction(value, name)
    else:
        positive(value, name)
    if name == "sampling" and outline_on(target) is None:
        raise ValueError(f"expected a shape with an outline to sample (Outline.add_to), got {target!r:.80}")


def plan(
    space: pymunk.Space,
    tolerance: float | str,
    seconds: float | None = None,
    *,
    frame: float = 1 / 60,
    materials: Mapping[pymunk.Body, Any] | None = None,
) -> Plan:
    """Choose the cheapest model and settings for a space whose error is within `tolerance`, tried out on copies.

    tolerance: relative: of places over a body's way or its smallest extent, of turns over what it turns or a radian, of
        drives over their speed; 0.01 is one per cent, and so is "1%".
    seconds: simulated time over which it must hold, 10 unless said: it is tried out as far as a twentieth of that run's
        cost goes, or a tenth of a second. frame: length of a frame (time).
    materials: what bodies are made of (`flexible.Material`), where it matters whether they bend; None: what `material`
        of the bodies says, where they have one.

    Nothing is changed before `Plan.apply`. Raises ValueError for settings out of range.
    """
    if not isinstance(space, pymunk.Space):
        raise ValueError(f"space must be a pymunk.Space, got {type(space).__name__}")
    if not isinstance(materials, Mapping | None):
        raise ValueError(f"materials must be a mapping by pymunk.Body, got {type(materials).__name__}")
    for body in materials or {}:
        if not isinstance(body, pymunk.Body):
            raise ValueError(f"materials must be given by pymunk.Body, got {type(body).__name__}")
    told = elastic.materials_of(space) if materials is None else materials
    return Plan(space, tolerance, seconds, frame, told)
