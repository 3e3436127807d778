"""Public calls with hostile values, by the tens of thousands: each works, or is refused clearly and changes nothing.

A call counts as wrong when it raises anything but ValueError, OSError (a file that is not there) or RuntimeError
(`SimulationError` is one), when a refusal does not say what was expected (Python's own "must be real number, not dict"
does not say of what), when a refused call has changed the space, when one that was accepted
leaves a state that is not finite without a word, and when it takes longer than `SLOW`.
"""

from __future__ import annotations

import math
import random
import re
import time
from collections.abc import Callable
from typing import Any

import numpy as np
import pymunk

from rigidarea import (
    Outline,
    SimulationError,
    attach,
    attached,
    covers,
    overlap,
    overlaps,
    point_query,
    segment_query,
    shapes,
)
from rigidarea.bring import scene_from_text

from .surface import surface

SAYS = re.compile(
    r"\b(must|expect(ed)?|unknown|unrecognized|required|needs?|needed|invalid (choice|float value|int value))\b"
    r"|: \w+ .* first|after the step"
)
"""What a refusal says one way or the other."""
SLOW = 5.0
"""Seconds of processor time."""

_TINY: list[Any] = [0, -0.0, -1, -1e-3, 1e-320, 1e-200, 1e-17, 0.5, 1, 1.5, 3, 17]
_HUGE: list[Any] = [1e17, 1e60, 1e200, 1.7e308, math.inf, -math.inf, math.nan, 2**31, 2**63, 2**70, -(2**70)]
_ODD: list[Any] = [
    True,
    None,
    "",
    "2",
    b"1",
    [],
    [1.0],
    (1, 2),
    {},
    1j,
    object(),
    np.float32(0.5),
    np.arange(3.0),
]
_POINTS: list[Any] = [
    [(0, 0), (1, 0), (1, 1), (0, 1)],
    [(0, 0), (1, 0), (0, 1)],
    [(0, 0), (1, 1), (1, 0), (0, 1)],
    [(0, 0), (1, 0)],
    [(0, 0), (1, 0), (1, math.nan)],
    [(0, 0), (1e200, 0), (0, 1e200)],
    [(0, 0), (1e-200, 0), (0, 1e-200)],
    [(1e9, 1e9), (1e9 + 1, 1e9), (1e9, 1e9 + 1)],
    np.zeros((0, 2)),
    np.ones((5, 3)),
]
_BULGES: list[Any] = [
    [(-1, 0, 1), (1, 0, 1)],
    [(0, 0, 0.3), (2, 0, 0), (1, 2, -0.2)],
    [(0, 0, math.inf), (1, 0, 0), (0, 1, 0)],
    [(0, 0, 1e9), (1, 0, 0), (0, 1, 0)],
    [(0, 0, 1e-12), (1, 0, 0), (0, 1, 0)],
]


class Trial:
    """One space with a few bodies, on which calls are made until it is worn out."""

    def __init__(self, seed: int) -> None:
        self.draw = random.Random(seed)
        self.space = pymunk.Space()
        self.space.gravity = 0, -10
        self.space.add(pymunk.Segment(self.space.static_body, (-20, 0), (20, 0), 0.5))
        for i in range(4):
            body = pymunk.Body(1, 1)
            body.position = 1.2 * i, 1.5
            shape = pymunk.Circle(body, 0.5) if i % 2 else pymunk.Poly.create_box(body, (1, 1))
            self.space.add(body, shape)
        self.contact = attach(self.space)
        self.outline = Outline([(0, 0), (2, 0), (2, 1), (1, 0.5), (0, 1)])

    def number(self) -> Any:
        """A number, as a rule: tiny, huge, none."""
        return self.draw.choice(self.draw.choices((_TINY, _HUGE, _ODD), (5, 4, 2))[0])

    def count(self) -> Any:
        """As `number`, without whole numbers so large that they would take years as they should."""
        value = self.number()
        return 4 if isinstance(value, int) and value > 100 else value

    def points(self) -> Any:
        """A ring, as a rule."""
        return self.draw.choice(_POINTS if self.draw.random() < 0.85 else _ODD)

    def pose(self) -> Any:
        """A pose, as a rule."""
        return self.draw.choice(
            [(0, 0, 0), (0.5, 0.2, 1), (self.number(), 0, 0), (0, 0, self.number()), self.number()]
        )

    def state(self) -> list[Any]:
        """What a refused call must leave as it was."""
        places = [(*b.position, b.angle, *b.velocity, b.angular_velocity, b.mass) for b in self.space.bodies]
        return [places, len(self.space.shapes), attached(self.space) is self.contact, self.contact.stiffness]

    def calls(self) -> list[tuple[str, Callable[[], Any]]]:
        """The public calls by name, each with values of its own."""
        n, p, c = self.number, self.points, self.count
        names = ("friction", "elasticity", "sensor", "collision_type", "surface_velocity", "mass", "nonsense")

        def attach_another() -> None:
            space = pymunk.Space()
            body = pymunk.Body(1, 1)
            space.add(body, pymunk.Circle(body, 1))
            key = self.draw.choice(
                (
                    "stiffness",
                    "penetration",
                    "law",
                    "length",
                    "direction",
                    "exponent",
                    "rest_speed",
                    "integration",
                )
            )
            try:
                contact = attach(space, **{key: n()})
            except BaseException:
                if attached(space) is not None or space._handlers:
                    raise AssertionError("a refused attach left something behind") from None
                raise
            space.step(0.01)
            contact.detach()

        def added() -> None:
            body = pymunk.Body(1, 1)
            shape = self.outline.add_to(body, **{self.draw.choice(names): n()})
            if not (math.isfinite(shape.friction) and math.isfinite(shape.elasticity)):
                raise AssertionError("a shape with a coefficient that is not finite")

        def stiffness() -> None:
            self.contact.stiffness = n()

        def penetration() -> None:
            self.contact.penetration = n()

        def again() -> None:
            self.contact.detach()
            body = next(iter(self.space.bodies))
            for use in (lambda: self.contact.step(1 / 60), lambda: self.contact.ask(body, 2)):
                try:
                    use()
                except RuntimeError:
                    continue
                raise AssertionError("a detached contact was not refused")
            self.contact = attach(self.space)

        def measured(outline: Outline) -> None:
            if (
                not all(map(math.isfinite, (outline.area, *outline.centroid, *outline.bounds)))
                or outline.area <= 0
            ):
                raise AssertionError(f"an outline whose measures are not finite: {outline!r}")

        def text() -> None:
            value = self.draw.choice(
                ["1e999", "-1", "[]", "{}", '"x"', "null", "1e-300", "9" * 50, "[" * 200, "NaN"]
            )
            key = self.draw.choice(
                ["gravity", "bodies", "outlines", "damping", "iterations", "rigidarea", "joints"]
            )
            scene_from_text(
                f'{{"rigidarea": 1, "{key}": {value}}}', self.draw.choice(["json", "toml", "xml"])
            )

        def places() -> Any:
            return self.draw.choice([[self.pose() for _ in range(3)], self.pose(), p(), n()])

        return [
            ("attach", attach_another),
            ("attach(not a space)", lambda: attach(n())),
            ("contact.step(dt)", lambda: self.contact.step(self.draw.choice([1 / 60, n()]))),
            ("contact.step(steps)", lambda: self.contact.step(1 / 60, steps=c())),
            ("contact.step(frames)", lambda: self.contact.step(1 / 60, frames=c())),
            ("contact.step(tolerance)", lambda: self.contact.step(1 / 60, tolerance=n())),
            ("contact.stiffness", stiffness),
            ("contact.regions", lambda: len(self.contact.regions)),
            ("contact.energy", lambda: self.contact.energy()),
            ("contact.penetration", penetration),
            ("contact.ask", lambda: self.contact.ask(self.draw.choice([*self.space.bodies, n()]), n())),
            ("contact.detach", again),
            ("attached", lambda: attached(n())),
            ("contact.refresh", lambda: self.contact.refresh(self.draw.choice([*self.space.shapes, n()]))),
            ("Outline", lambda: measured(Outline(p(), self.draw.choice([(), [p()], n()])))),
            (
                "Outline.circle",
                lambda: measured(Outline.circle(n(), self.draw.choice([(0, 0), (n(), n()), n()]))),
            ),
            ("Outline.from_bulges", lambda: measured(Outline.from_bulges(self.draw.choice([*_BULGES, p()])))),
            ("Outline.from_pymunk", lambda: Outline.from_pymunk(self.draw.choice([*self.space.shapes, n()]))),
            ("outline.sample", lambda: measured(Outline.circle(1).sample(self.draw.choice([n(), 1e-3])))),
            ("outline.translated", lambda: measured(self.outline.translated(n(), n()))),
            ("outline.rotated", lambda: measured(self.outline.rotated(n()))),
            ("outline.body(mass)", lambda: self.outline.body(mass=n())),
            ("outline.body(density)", lambda: self.outline.body(density=n())),
            ("outline.moment", lambda: self.outline.moment(n())),
            ("outline.add_to", added),
            ("outline.add_to(not a body)", lambda: self.outline.add_to(n())),
            ("overlap", lambda: overlap(self.outline, self.pose(), Outline.circle(0.5), self.pose())),
            ("overlaps", lambda: overlaps(self.outline, places(), Outline.circle(0.5), places())),
            ("covers", lambda: covers(self.outline, self.pose(), (n(), n()))),
            ("point_query", lambda: point_query(self.space, self.draw.choice([(n(), n()), (0, 0), n()]))),
            ("segment_query", lambda: segment_query(self.space, (n(), n()), self.draw.choice([(0, 0), n()]))),
            ("overlap(not an outline)", lambda: overlap(n(), (0, 0, 0), self.outline, (0, 0, 0))),
            ("shapes.box", lambda: measured(shapes.box(n(), n()))),
            ("shapes.circle", lambda: measured(shapes.circle(n()))),
            ("shapes.capsule", lambda: measured(shapes.capsule(n(), n()))),
            ("shapes.ring", lambda: measured(shapes.ring(n(), n()))),
            ("shapes.rounded_polygon", lambda: measured(shapes.rounded_polygon(p(), n()))),
            ("scene_from_text", text),
            *surface(self),
        ]


def fuzz(calls: int, seed: int = 0) -> list[dict[str, Any]]:
    """That many calls from that seed; one row for each kind of call: `call`, `calls`, `refused`, `wrong` (texts)."""
    rows: dict[str, dict[str, Any]] = {}
    trial = Trial(seed)
    for number in range(calls):
        if number % 500 == 499:
            trial = Trial(seed + number)
        name, call = trial.draw.choice(trial.calls())
        row = rows.setdefault(name, {"call": name, "calls": 0, "refused": 0, "wrong": []})
        row["calls"] += 1
        before = trial.state()
        began = time.process_time()
        wrong = ""
        try:
            call()
        except (ValueError, OSError, RuntimeError) as error:
            row["refused"] += 1
            if not isinstance(error, OSError | SimulationError) and not SAYS.search(str(error)):
                wrong = f"does not say what was expected: {error!r}"
            elif trial.state() != before:
                wrong = f"was refused and has changed the space: {error}"
        except Exception as error:
            wrong = f"{type(error).__name__}: {error}"
        else:
            places = trial.state()[0]
            if not all(math.isfinite(value) for place in places for value in place):
                wrong = "left a state that is not finite, without a word"
        if time.process_time() - began > SLOW:
            wrong = wrong or f"took {time.process_time() - began:.1f} s"
        if wrong:
            row["wrong"].append(f"call {number}: {wrong[:200]}")
            trial = Trial(seed + number)
    return [rows[name] for name in sorted(rows)]
