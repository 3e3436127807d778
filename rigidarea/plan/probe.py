"""A space tried out beforehand: copies of it run at several settings, and how far bodies are from a finer run's.

A setting's error is the distance to the finest run made, plus what that run itself may be off: a run of substeps h that
is of first order at least, e(h) ~ h, differs from one of r h by (r - 1) e(h) (Richardson's estimate, with the least
order that the solve has; E. Hairer, S. P. Nørsett, G. Wanner, Solving Ordinary Differential Equations I, section II.4).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
import pymunk
from numpy.typing import NDArray
from pymunk._chipmunk_cffi import lib
from pymunk.batch import BodyFields, Buffer, get_space_bodies

from ..chipmunk import AreaContact, SimulationError, attach
from ..geometry.outline import Outline
from . import costs
from .measures import Measured, extent_of, measure, reach_of, turns_others
from .part import join

Array = NDArray[np.float64]

SAMPLES = 120
"""Places are compared so often, at the most, in the time that is looked at."""
NOTES, NOTING_S = 12, 0.005
"""What contacts do is noted so often, and after the first sample; less often where that would take longer (s)."""
LADDER = (2, 5, 12, 29, 70, 169)
"""Substeps of runs that become finer, Pell's numbers: a run's substeps do not fall together with another's, or the two
would be off alike."""
RATIO = 1.0 + math.sqrt(2.0)
"""Of one of the ladder to the next."""
FINE_SWEEPS = 20
"""Sweeps of the ladder's runs."""
ENOUGH = 0.01
"""Of the tolerance: a reference that may be off by less needs no finer one."""
LEAST_DEPTH = 1e-8
"""Penetration of the finest: below, an overlap has lost half its digits (fraction of the smallest extent)."""


STATE = BodyFields.POSITION | BodyFields.ANGLE | BodyFields.VELOCITY | BodyFields.ANGULAR_VELOCITY


class Setting(NamedTuple):
    """What a plan chooses for a whole space."""

    level: str  # "rigid" or "pymunk"
    steps: int
    sweeps: int
    penetration: float  # fraction of the smallest extent; of "pymunk" the slop


class Seen(NamedTuple):
    """What else is noted of a run: see `measures`."""

    measured: dict[str, Measured]
    groups: NDArray[np.int64]  # (bodies,) those of a number have touched or are jointed


def copied(
    space: pymunk.Space,
    bodies: Sequence[pymunk.Body],
    given: Mapping[pymunk.Shape, float],
    sagitta: float | None = None,
) -> tuple[pymunk.Space, list[pymunk.Body]]:
    """A space like it, awake, of what is static and of these bodies, without callbacks; and the bodies' twins.

    Outlines that know their curve are sampled to `sagitta` (fraction of their smallest extent), but for those `given`
    (length).
    """
    made = pymunk.Space()
    _set(made, space, ("gravity", "damping", "collision_slop", "collision_bias", "collision_persistence"))
    twins = {space.static_body: made.static_body}
    for body in [*(body for body in space.bodies if body.body_type == pymunk.Body.STATIC), *bodies]:
        twins[body] = twin = pymunk.Body(body.mass, body.moment, body.body_type)
        _set(twin, body, ("center_of_gravity", "position", "angle"))
        if body.body_type != pymunk.Body.STATIC:
            _set(twin, body, ("velocity", "angular_velocity", "force", "torque"))
        made.add(twin)
    for shape in space.shapes:
        if shape.body in twins and not shape.sensor:
            made.add(_twin(shape, twins[shape.body], sagitta, given.get(shape)))
    for joint in space.constraints:
        if joint.a in twins and joint.b in twins:
            # pymunk's own pickling, but for the bodies, the user's attributes and the callbacks
            state, moved = joint.__getstate__(), object.__new__(type(joint))
            init = [(k, twins[v] if isinstance(v, pymunk.Body) else v) for k, v in state["init"]]
            moved.__setstate__({"init": init, "general": state["general"], "custom": [], "special": []})
            made.add(moved)
    return made, [twins[body] for body in bodies]


def _twin(shape: pymunk.Shape, body: pymunk.Body, sagitta: float | None, given: float | None) -> pymunk.Shape:
    """A shape like it on another body."""
    outline = vars(shape).get("outline")
    if isinstance(outline, Outline):
        if given is not None:
            outline = outline.sample(given)
        elif sagitta is not None and outline._resample is not None:
            outline = outline.sample(sagitta * outline.smallest_extent)
        twin = outline.add_to(body)
    elif isinstance(shape, pymunk.Circle):
        twin = pymunk.Circle(body, shape.radius, shape.offset)
    elif isinstance(shape, pymunk.Segment):
        twin = pymunk.Segment(body, shape.a, shape.b, shape.radius)
    else:
        assert isinstance(shape, pymunk.Poly)
        twin = pymunk.Poly(body, shape.get_vertices(), radius=shape.radius)
    _set(twin, shape, ("friction", "elasticity", "filter", "surface_velocity"))
    return twin


def _set(twin: Any, thing: Any, names: tuple[str, ...]) -> None:
    """Give the twin these attributes: pymunk's setters are slow, so only where they differ."""
    for name in names:
        value = getattr(thing, name)
        if getattr(twin, name) != value:
            setattr(twin, name, value)


class Probe:
    """Copies of a space, or of some `bodies` of it (see `part`), run at settings, each once; what they cost is counted
    by `costs` (s)."""

    def __init__(
        self,
        space: pymunk.Space,
        frame: float,
        frames: int,
        stiffness: float | None,
        given: Mapping[pymunk.Shape, float],
        tolerance: float,
        bodies: Sequence[pymunk.Body],
    ) -> None:
        self.space, self.given, self.tolerance, self.bodies = space, given, tolerance, list(bodies)
        self.frame, self.frames, self.stiffness = frame, frames, stiffness
        shapes = [[s for s in body.shapes if not s.sensor] for body in self.bodies]
        self.extent = np.array([min(map(extent_of, own), default=math.inf) for own in shapes])
        self.reach = np.array([reach_of(body, own) or 1.0 for body, own in zip(self.bodies, shapes)])
        self.free = np.array([body.body_type == pymunk.Body.DYNAMIC for body in self.bodies], bool)
        smallest = float(self.extent[self.free].min(initial=math.inf))
        self.smallest = smallest if math.isfinite(smallest) else 0.0
        self.drives = np.array([turns_others(body) for body in self.bodies], bool)
        outlines = [o for s in space.shapes if isinstance(o := vars(s).get("outline"), Outline)]
        self.points = sum(len(ring) for outline in outlines for ring in outline.rings)
        self.sampled = any(outline._resample is not None for outline in outlines)
        self.stands_in = bool(outlines)
        self.moving = sum(body.body_type == pymunk.Body.DYNAMIC for body in space.bodies)
        # of what moves that is copied
        self.share = float(self.free.sum()) / self.moving if self.moving else 1.0
        self.spent = costs.PART_BODY_S * self.moving if self.share < 1.0 else 0.0
        self.pairs = float(self.moving)  # of the space that touch, on the average
        self.groups = np.arange(len(self.bodies))  # of the first run: see `Seen`
        self.copies: dict[float | None, tuple[AreaContact, Any, list[pymunk.Body]]] = {}  # by sagitta
        self.extents: dict[pymunk.Shape, float] = {}  # of the copies' shapes
        self._asked: set[int] = set()
        self._touching: list[int] = []
        self.begin: float | None = None  # depth after the first run's first frame, over the smallest extent

    # --- cost ---

    def cost(self, setting: Setting) -> float:
        """Processor time of a frame of the whole space (s)."""
        if setting.level == "pymunk":
            return costs.native_frame(self.moving, self.pairs, setting.steps, setting.sweeps)
        return costs.area_frame([(self.moving, self.pairs, setting.steps)], setting.sweeps, self.points)

    def price(self, setting: Setting) -> float:
        """Processor time of a run of a copy (s)."""
        begin = costs.START_BODY_S * len(self.bodies) + costs.SAMPLE_S * min(SAMPLES, self.frames)
        return begin + self.share * self.cost(setting) * self.frames

    def look(self, seconds: float, first: Setting) -> None:
        """Look only so far that a run at `first` takes no more than `seconds` of processor time."""
        left, frame = seconds - costs.START_BODY_S * len(self.bodies), self.share * self.cost(first)
        all_read = left / (frame + costs.SAMPLE_S)
        some_read = (left - costs.SAMPLE_S * SAMPLES) / frame
        self.frames = max(1, min(self.frames, int(max(all_read, some_read))))

    # --- runs ---

    def track(self, setting: Setting, sagitta: float | None = None) -> Array:
        """The run at a setting: (samples, bodies, 6) place, angle, velocity, spin; empty where it failed."""
        first = self.begin is None
        states, seen = self.run(setting, sagitta, noted=first)
        self.groups = seen.groups if first else self.groups
        return states

    def run(
        self,
        setting: Setting,
        sagitta: float | None,
        asked: Mapping[int, int] | None = None,
        noted: bool = False,
    ) -> tuple[Array, Seen]:
        """A run, as `track` has it, where bodies have `asked` for substeps, by number; and what is `noted` of it."""
        self.spent += self.price(setting)
        contact: AreaContact | None = None
        if setting.level == "pymunk" or sagitta not in self.copies:
            self.spent += costs.COPY_BODY_S * len(self.bodies)
        if setting.level == "pymunk":
            space, bodies = copied(self.space, self.bodies, self.given)
            space.collision_slop = setting.penetration * self.smallest
        else:
            if sagitta not in self.copies:
                space, bodies = copied(self.space, self.bodies, self.given, sagitta)
                made = attach(space, self.stiffness, penetration=setting.penetration)
                self.copies[sagitta] = made, made.snapshot(), bodies
            contact, begin, bodies = self.copies[sagitta]
            contact.restore(begin)
            contact.penetration, space = setting.penetration, contact.space
            for i in self._asked | (asked or {}).keys():
                contact.ask(bodies[i], (asked or {}).get(i))
            self._asked = set(asked or {})
        space.iterations = setting.sweeps
        even = np.linspace(0, self.frames, min(SAMPLES, self.frames) + 1).astype(int)
        ends = np.unique([*even, *np.minimum((1, 2, 4), self.frames)])  # loads are found at first
        states = np.zeros((len(ends), len(bodies), 6))
        read = reader(space, bodies)
        states[0] = read()
        index = {body: i for i, body in enumerate(bodies)}
        seen = Seen({}, np.arange(len(bodies)))
        notes = 0
        if noted:
            note = costs.NOTE_PAIR_S * self.share * self.pairs + costs.SAMPLE_S
            notes = max(1, min(NOTES, int(NOTING_S / note)))
            self.spent += (notes + 1) * note
        every = max(1, (len(ends) - 1) // max(1, notes))
        try:
            for k, frames in enumerate(np.diff(ends).tolist()):
                if contact is None:
                    for _ in range(frames * setting.steps):  # no callbacks: nothing for pymunk to do
                        lib.cpSpaceStep(space._space, self.frame / setting.steps)
                else:
                    contact.step(self.frame, frames, steps=setting.steps)
                states[k + 1] = read()
                if notes and (k == 0 or k % every == every - 1):
                    self._note(space, contact, self.frame / setting.steps, index, seen)
        except SimulationError:
            states[:] = math.nan
        speeds = np.hypot(states[:, :, 3], states[:, :, 4]) + self.reach * np.abs(states[:, :, 5])
        seen.measured["speed"] = float(speeds.max(initial=0.0)), None
        if self._touching:
            self.pairs = sum(self._touching) / len(self._touching) / self.share
            self._touching.clear()
        return states[: len(states) if np.isfinite(states).all() else 0], seen

    def _note(
        self,
        space: pymunk.Space,
        contact: AreaContact | None,
        h: float,
        index: Mapping[pymunk.Body, int],
        seen: Seen,
    ) -> None:
        links = [(joint.a, joint.b) for joint in space.constraints]
        if contact is not None:
            rows = contact.regions
            measure(contact, rows, h, seen.measured, {}, self.extents)
            if self.begin is None:
                self.begin = seen.measured.get("penetration", (0.0, None))[0]
            self._touching.append(len(rows))
            links += [(row["body_a"], row["body_b"]) for row in rows]
        for a, b in links:
            if a in index and b in index:
                join(seen.groups, index[a], index[b])

    def apart(self, one: Array, fine: Array, so_far: bool = False) -> Array:
        """(bodies,) how far each is from where the finer run has it, the largest: a place over its way or its smallest
        extent, a turn over what it moves the farthest point, the way, or a radian. What only turns since something
        drives it is compared by its spin too, root mean square: a drive's error is in its speed, not in its angle.

        so_far: over the way up to then; and where no body of an island ever goes its smallest extent, over what the one
        that moves most goes of it: a tilt over the tilt there is. (Below the tolerance that is no motion.)
        """
        if not len(one) or not len(fine):
            return np.full(len(self.bodies), math.inf)
        off, steps = np.abs(one - fine), np.abs(np.diff(fine[:, :, :3], axis=0, prepend=fine[:1, :, :3]))
        gone = np.cumsum(np.hypot(steps[:, :, 0], steps[:, :, 1]), axis=0)
        turned = self.reach * np.cumsum(steps[:, :, 2], axis=0)
        far = np.maximum(gone, turned)
        small: Any = 1.0
        if so_far:
            scale = np.zeros(len(self.bodies))
            np.maximum.at(scale, self.groups, np.where(self.free, far[-1] / self.extent, 0.0))
            small = np.where(scale > self.tolerance, np.minimum(scale, 1.0), 1.0)[self.groups]
        until = slice(None) if so_far else -1
        places = np.hypot(off[:, :, 0], off[:, :, 1]) / np.maximum(gone[until], small * self.extent)
        turns = self.reach * off[:, :, 2] / np.maximum(far[until], small * self.reach)
        found: Array = np.maximum(places, turns).max(axis=0)
        spin = np.sqrt(np.mean(fine[:, :, 5] ** 2, axis=0))
        driven = np.isin(self.groups, self.groups[self.drives])
        round_ = driven & (gone[-1] < self.reach) & (turned[-1] > self.reach)
        ripple = np.sqrt(np.mean(off[:, :, 5] ** 2, axis=0)) / np.where(round_, spin, 1.0)
        return np.where(self.free, np.maximum(found, np.where(round_, ripple, 0.0)), 0.0)


class Reference(NamedTuple):
    """The finest run, what it may be off, and what the coarser ones are, by their own."""

    setting: Setting
    track: Array
    doubt: Array  # (bodies,)
    coarser: list[tuple[Setting, Array]]  # with what the finest may be off: (bodies,)


def reference(probe: Probe, sagitta: float | None, budget: float, least: Setting | None) -> Reference:
    """Runs ever finer, until the last is off by nothing that matters, or the next would cost more than what is left of
    the budget (s). Runs that agree may all have missed what a finer one sees, bodies that are struck in another order,
    say: so it is not enough that they do.

    least: as fine as that at least.
    """
    runs: list[tuple[Setting, Array]] = []
    doubt = np.full(len(probe.bodies), math.inf)
    for j, steps in enumerate(LADDER):
        setting = Setting("rigid", steps * (least.steps if least else 1), FINE_SWEEPS, LEAST_DEPTH)
        if len(runs) > 1 and probe.spent + probe.price(setting) > budget:
            break
        runs.append((setting, probe.track(setting, sagitta)))
        if j:
            doubt = probe.apart(runs[-2][1], runs[-1][1]) / (RATIO - 1.0)
            if j > 2 and doubt.max(initial=0.0) <= ENOUGH * probe.tolerance:
                break
    fine = runs.pop()
    return Reference(*fine, doubt, [(each, probe.apart(track, fine[1]) + doubt) for each, track in runs])


def reader(space: pymunk.Space, bodies: Sequence[pymunk.Body]) -> Callable[[], Array]:
    """What reads (bodies, 6) states of these, as long as none comes or goes: place, angle, velocity, spin."""
    buffer = Buffer()
    get_space_bodies(space, BodyFields.BODY_ID, buffer)
    place = {body: i for i, body in enumerate(np.frombuffer(buffer.int_buf(), np.uintp).tolist())}
    order = [place[body.id] for body in bodies]

    def read() -> Array:
        buffer.clear()
        get_space_bodies(space, STATE, buffer)
        return np.frombuffer(buffer.float_buf()).reshape(-1, 6)[order]

    return read
