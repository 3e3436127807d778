"""The rest of the public surface, for `hostile`: mechanisms' shapes, files and drawings, plans, what bends, the
environment, the command line. Each with one or two arguments that no program should give, the others good.
"""

from __future__ import annotations

import contextlib
import importlib.util
import io
import math
import tempfile
from collections.abc import Callable
from functools import cache, partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pymunk

from rigidarea import Outline, attached, bring, plan, shapes
from rigidarea.__main__ import main

from .texts import command_line, drawing, map_text, scene_text

if TYPE_CHECKING:
    from .hostile import Trial

Calls = list[tuple[str, Callable[[], Any]]]

#: Pieces of a shape or a run that may be many, but not so many that they take a day as they should.
MANY = 64


def surface(trial: Trial) -> Calls:
    """The calls by name; those of an extra that is not installed are left out."""
    calls = [*_shapes(trial), *_brought(trial), *_planned(trial), *_command(trial)]
    if importlib.util.find_spec("scipy"):
        calls += _flexible(trial)
    if importlib.util.find_spec("gymnasium"):
        calls += _environment(trial)
    return calls


def bent(trial: Trial, call: Callable[..., Any], **good: Any) -> Callable[[], Any]:
    """`call` with one or two of the good arguments replaced."""

    def made() -> Any:
        names = trial.draw.sample(sorted(good), min(len(good), trial.draw.choice((1, 1, 2))))
        return call(**{**good, **{name: trial.number() for name in names}})

    return made


def _made(trial: Trial, call: Callable[..., Any], good: dict[str, Any]) -> None:
    _measured(bent(trial, call, **good)())


def _measured(outline: Any) -> None:
    """AssertionError unless the outline's measures are finite."""
    for part in [outline] if isinstance(outline, Outline) else outline[:3]:
        if not math.isfinite(sum((part.area, *part.centroid, *part.bounds))) or part.area <= 0:
            raise AssertionError(f"an outline whose measures are not finite: {part!r}")


def _shapes(trial: Trial) -> Calls:
    good: dict[str, dict[str, Any]] = {
        "eccentric": {"radius": 2.0, "eccentricity": 0.5, "bore": 0.3, "tolerance": None},
        "flat_follower": {"length": 3.0, "height": 1.0, "bore": 0.2, "overhang": None, "tolerance": None},
        "geneva": {
            **{"slots": 6, "center_distance": 0.05, "pin_diameter": 0.008, "clearance": 1e-5},
            **{"locking_radius": None, "locking_clearance": None, "bore": 0.0, "tolerance": 1e-4},
        },
        "internal_gear": {
            **{"module": 0.002, "teeth": 40, "pressure_angle": 0.35, "addendum": 1.0, "dedendum": 1.25},
            **{"rim": 2.5, "backlash": 0.0, "tolerance": 1e-4},
        },
        "involute_gear": {
            **{"module": 0.002, "teeth": 23, "pressure_angle": 0.35, "addendum": 1.0, "dedendum": 1.25},
            **{"profile_shift": 0.0, "backlash": 0.0, "rack_tip_radius": None, "bore": 0.0},
            **{"tolerance": 1e-4, "spacing": None},
        },
    }
    return [
        (f"shapes.{name}", partial(_made, trial, getattr(shapes, name), given))
        for name, given in good.items()
    ]


@cache
def _folder() -> Any:
    """A folder that goes when this process does."""
    return tempfile.TemporaryDirectory(prefix="rigidarea-fuzz-")


def _file(name: str, content: str | bytes) -> Path:
    path = Path(_folder().name) / name
    path.write_bytes(content.encode() if isinstance(content, str) else content)
    return path


def _brought(trial: Trial) -> Calls:
    draw, n = trial.draw, trial.number

    def mask() -> Any:
        made = np.zeros((12, 12))
        made[3:9, 3:9] = draw.choice((1.0, 0.5, math.nan, math.inf, 1e300))
        return draw.choice((made, made, made, made[:1], made[0], made.tolist(), n()))

    def a_map() -> Any:
        whole = {"type": "Polygon", "coordinates": [[[0, 0], [4, 0], [4, 4], [0, 0]]]}
        return draw.choice((whole, whole, {"type": n(), "coordinates": []}, {**whole, "coordinates": n()}))

    def saved() -> None:
        for shape in trial.space.shapes:
            shape.friction = draw.choice((0.5, 1e300))
        with contextlib.chdir(_folder().name):  # "2" is a good name of a file
            bring.save_scene(trial.space, draw.choice((Path("saved.json"), n())))

    none, drawn = Path(_folder().name) / "none", {"scale": 1.0, "tolerance": 0.1, "limits": bring.LIMITS}
    return [
        (
            "bring.Limits",
            bent(trial, _small_map, bytes=10**6, depth=32, points=10**4, parts=100, pixels=10**4),
        ),
        (
            "bring.load_scene",
            lambda: bring.load_scene(draw.choice((n(), none, _file("a.json", scene_text(draw))))),
        ),
        ("bring.scene_from_text", lambda: bring.scene_from_text(scene_text(draw))),
        (
            "bring.scene_from_text(odd)",
            lambda: bring.scene_from_text(n(), draw.choice(("json", "toml", n()))),
        ),
        ("bring.scene_as_text", lambda: bring.scene_as_text(trial.space, draw.choice(("json", "toml", n())))),
        ("bring.scene_as_text(no space)", lambda: bring.scene_as_text(n())),
        ("bring.save_scene", saved),
        (
            "bring.outlines_from_svg",
            lambda: _measured(bring.outlines_from_svg(_file("a.svg", drawing(draw)), tolerance=0.1)),
        ),
        (
            "bring.elements_from_svg",
            lambda: bring.elements_from_svg(_file("c.svg", drawing(draw)), scale=n()),
        ),
        (
            "bring.outlines_from_svg(settings)",
            lambda: _measured(
                bent(
                    trial, bring.outlines_from_svg, source=_file("b.svg", drawing(draw)), flip=False, **drawn
                )()
            ),
        ),
        ("bring.outlines_from_geojson", lambda: _measured(bring.outlines_from_geojson(a_map()))),
        (
            "bring.outlines_from_geojson(file)",
            lambda: _measured(
                bent(trial, bring.outlines_from_geojson, source=_file("a.geojson", map_text(draw)), **drawn)()
            ),
        ),
        ("bring.outlines_from_mask", lambda: _measured(bring.outlines_from_mask(mask()))),
        (
            "bring.outlines_from_mask(settings)",
            lambda: _measured(
                bent(
                    trial,
                    bring.outlines_from_mask,
                    mask=np.pad(np.ones((4, 5)), 2),
                    threshold=0.5,
                    flip=True,
                    **drawn,
                )()
            ),
        ),
        (
            "bring.outlines_from_image",
            lambda: _measured(
                bring.outlines_from_image(
                    draw.choice((n(), none, _file("a.png", draw.randbytes(draw.randrange(200)))))
                )
            ),
        ),
    ]


def _small_map(**limits: Any) -> Any:
    return bring.outlines_from_geojson(
        {"type": "Polygon", "coordinates": [[[0, 0], [4, 0], [4, 4], [0, 0]]]}, limits=bring.Limits(**limits)
    )


def _planned(trial: Trial) -> Calls:
    draw, n = trial.draw, trial.number

    def space() -> pymunk.Space:
        """A box on a floor, cheap to look at."""
        made = pymunk.Space()
        made.gravity = 0, -10
        made.add(pymunk.Segment(made.static_body, (-5, 0), (5, 0), 0.1))
        body = pymunk.Body(1, 1)
        body.position = 0, 0.6
        made.add(body, pymunk.Poly.create_box(body, (1, 1)))
        return made

    def override() -> None:
        known = plan(space(), 0.01)
        named = draw.choice(("level", "steps", "sweeps", "penetration", "stiffness", "sampling", "nonsense"))
        before = str(known)
        target = draw.choice((None, None, *known.space.shapes, *known.space.bodies, n()))
        try:
            known.override(target, **{named: n()})
        except ValueError:
            if str(known) != before:
                raise AssertionError("a refused override has changed the plan") from None
            raise

    def stepped() -> None:
        known = plan(space(), 0.01)
        if draw.random() < 0.5:
            known.apply()
        known.step(draw.choice((None, n())), draw.choice((1, trial.count())))
        body = next(iter(known.space.bodies))
        if not math.isfinite(sum(body.position)):
            raise AssertionError("a state that is not finite")

    def applied() -> None:
        made = space()
        contact = plan(made, 0.01).apply()
        if contact is not attached(made):
            raise AssertionError("apply returned another contact than the space's")

    return [
        ("plan", bent(trial, plan, space=space(), tolerance=0.01, seconds=1.0, frame=1 / 60, materials=None)),
        ("plan.override", override),
        ("plan.step", stepped),
        ("plan.apply", applied),
        ("plan.again", lambda: plan(space(), 0.01).again(n())),
        ("plan.watch", lambda: plan(space(), 0.01).watch(n())),
    ]


def _flexible(trial: Trial) -> Calls:
    from rigidarea import flexible

    draw, n = trial.draw, trial.number
    steel = flexible.Material(1e6, 0.3, 1.0)
    square = Outline([(0, 0), (2, 0), (2, 1), (0, 1)])

    def few(value: Any) -> Any:
        return MANY if isinstance(value, int) and value > MANY else value

    def mechanism() -> tuple[Any, int, int]:
        made = flexible.Mechanism(1e4, gravity=(0, -10))
        return made, made.ground(square, (0, -1)), made.body(square, steel, level="rigid", at=(0, 0.1))

    def body(level: str) -> None:
        made = flexible.Mechanism(1e4)
        good: dict[str, Any] = {
            **{
                "outline": square,
                "material": steel,
                "level": level,
                "mesh": None,
                "at": (0, 0),
                "angle": 0.0,
            },
            **{"velocity": (0, 0, 0), "hub": None, "contact": (0,), "clamp": None, "damping": 0.0},
            **{"modes": 4, "refine": 2},
        }
        if level != "rigid":
            good["mesh"] = 0.5
        bent(
            trial,
            lambda **given: made.body(
                **{**given, "modes": few(given["modes"]), "refine": few(given["refine"])}
            ),
            **good,
        )()
        made.run(0.002, 0.001)
        if made.simulation is not None:
            _finite(made.simulation.state.x)

    def joined(which: str, **good: Any) -> None:
        made, _, moves = mechanism()
        if "body" in good:
            good["body"] = moves
        bent(trial, getattr(made, which), **good)()
        record = made.run(0.002, 0.001)
        _finite(record.x)

    def part() -> None:
        space = pymunk.Space()
        one = square.body(mass=1.0)
        shape = square.add_to(one)
        space.add(one, shape)
        assembly = flexible.Assembly(1e4)
        bent(
            trial, assembly.part, shape=shape, material=steel, mesh=0.5, level="compliant", hub=None, contact=(0,),
            modes=4, refine=2, damping=0.0,
        )()  # fmt: skip

    def run() -> None:
        made, ground, moves = mechanism()
        made.contact(ground, moves)
        record = made.run(draw.choice((0.002, *_BAD)), draw.choice((0.001, *_BAD)), draw.choice((1, n())))
        _finite(record.x)

    def elastic() -> None:
        bent(
            trial, flexible.elastic_body, rings=[np.array(square.rings[0])], size=0.5, material=steel, level="modal",
            contact_rings=(0,), hub=None, clamped=None, growth=0.2, sides=1,
        )()  # fmt: skip

    point, other = (1.0, 0.5), (1.0, 3.0)
    return [
        (
            "flexible.Material",
            bent(
                trial, flexible.Material, young=1.0, poisson=0.3, density=1.0, thickness=1.0, plane="stress"
            ),
        ),
        ("flexible.Assembly", bent(trial, flexible.Assembly, k=1.0, q=1.0, step=None)),
        ("flexible.Assembly.part", part),
        (
            "flexible.Mechanism",
            lambda: _run(
                bent(
                    trial, flexible.Mechanism, k=1e4, gravity=(0, -10), rho=0.8, contact="area", reach=0.0
                )(),
                square,
                steel,
            ),
        ),
        ("flexible.Mechanism.body", lambda: body(draw.choice(("rigid", "rigid", "compliant", "modal")))),
        ("flexible.Mechanism.ground", lambda: joined("ground", outline=square, at=(0, -3), angle=0.0)),
        ("flexible.Mechanism.pivot", lambda: joined("pivot", body=0, at=point)),
        ("flexible.Mechanism.revolute", lambda: joined("revolute", body=0, at=point, to=None)),
        ("flexible.Mechanism.slider", lambda: joined("slider", body=0, axis=(1.0, 0.0), to=None)),
        ("flexible.Mechanism.weld", lambda: joined("weld", body=0, at=point, to=None)),
        (
            "flexible.Mechanism.spring",
            lambda: joined(
                "spring", body=0, at=point, other_end=other, to=None, stiffness=10.0, damping=0.1, rest=None
            ),
        ),
        ("flexible.Mechanism.drive", lambda: joined("drive", body=0, speed=1.0, ramp=0.1)),
        ("flexible.Mechanism.load", lambda: joined("load", body=0, torque=1.0, damper=0.1)),
        ("flexible.Mechanism.contact", lambda: joined("contact", a=0, b=1, friction=0.1, restitution=0.5)),
        ("flexible.Mechanism.run", run),
        ("flexible.elastic_body", elastic),
    ]


#: Durations and steps that no run can have; those that could, and would take a year, are nobody's fault.
_BAD: tuple[Any, ...] = (0, -1, math.nan, math.inf, -math.inf, None, "", "2", [], (1, 2), 1j, object())


def _run(made: Any, square: Outline, steel: Any) -> None:
    made.body(square, steel, level="rigid")
    _finite(made.run(0.002, 0.001).x)


def _finite(values: Any) -> None:
    if not np.isfinite(values).all():
        raise AssertionError("a state that is not finite, without a word")


def _environment(trial: Trial) -> Calls:
    import gymnasium

    from rigidarea.gym import PegInSlot

    draw, n = trial.draw, trial.number

    def episode() -> None:
        env = PegInSlot()
        try:
            env.reset(seed=draw.choice((0, 1, n())))
        except gymnasium.error.Error as error:  # gymnasium's own word about its own argument
            raise ValueError(f"expected a seed: {error}") from None
        for _ in range(3):
            actions: tuple[Any, ...] = ([0, 0, 0], [1, 1, 1], [n(), 0, 0], n())
            seen = env.step(draw.choice(actions))[0]
            _finite(seen)

    return [
        (
            "gym.PegInSlot",
            bent(trial, PegInSlot, render_mode=None, clearance=0.05, friction=0.2, max_steps=300),
        ),
        ("gym.PegInSlot.step", episode),
    ]


def _command(trial: Trial) -> Calls:
    """The command line in this process: what it refuses ends with code 2 and a line that says why."""

    def run() -> None:
        said = io.StringIO()
        words = command_line(trial.draw)
        try:
            with contextlib.redirect_stderr(said), contextlib.redirect_stdout(io.StringIO()):
                code = main(words)
        except SystemExit as end:
            code = end.code  # type: ignore[assignment]
        if code not in (0, 2):
            raise AssertionError(f"{words} ended with {code}: {said.getvalue()[-200:]}")
        if code == 2:
            raise ValueError(said.getvalue().strip().splitlines()[-1] if said.getvalue().strip() else "")

    return [("command line", run)]
