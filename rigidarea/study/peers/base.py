"""The small interface behind which the engines stand.

A peer builds a scene with some settings and hands back a run. `advance` is what gets timed: it must cost
nothing of ours. Peers therefore step inside a C loop (`drive`), one foreign call a step; `call_overhead`
measures what is left.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterable, Mapping
from itertools import product, repeat, starmap
from typing import Any, Protocol

import numpy as np

from ..scene import ANGLE, Array, Circle, Curve, Scene, Trace

Settings = Mapping[str, Any]
"""Knobs of one run: plain numbers and strings, so that they can be written down and compared."""


class Run(Protocol):
    """A scene built by a peer, somewhere in its motion."""

    steps: int
    """Steps a frame (of an engine that chooses them itself: at the start)."""

    def advance(self, frames: int) -> None:
        """Simulate `frames` more frames. Timed: no Python of ours per step."""

    def state(self) -> Array:
        """States (n_body, 6) of all bodies in the scene's order and units (columns: `scene.X` … `scene.OMEGA`)."""


class Peer(Protocol):
    """An engine, or one way of using it."""

    name: str
    ours: bool
    """Whether this is rigidarea: its levels and steppings together make one front."""

    def refuses(self, scene: Scene) -> str:
        """Why this peer cannot do the scene; empty if it can."""

    def settings(self, scene: Scene, quick: bool) -> list[Settings]:
        """The settings to sweep, in order of growing cost where that is known."""

    def default(self, scene: Scene) -> Settings | None:
        """Those of `settings` with which its users find it; None for what nobody finds as it is."""

    def build(self, scene: Scene, settings: Settings) -> Run:
        """Set the scene up."""


def knob(name: str, values: Iterable[Any]) -> list[dict[str, Any]]:
    """One setting at some values."""
    return [{name: value} for value in values]


def combined(*knobs: Iterable[Settings]) -> list[Settings]:
    """Every combination of some settings, the last ones changing first."""
    return [{k: v for part in parts for k, v in part.items()} for parts in product(*knobs)]


def rigid_only(scene: Scene) -> str:
    """Why an engine of rigid bodies cannot do the scene; empty if it can."""
    return "bodies are rigid: they give back the restitution that is put in" if scene.deforms else ""


def drive(step: Callable[..., object], count: int, *arguments: object) -> None:
    """Call `step(*arguments)` `count` times without a Python-level loop (the calls run inside C)."""
    deque(starmap(step, repeat(arguments, count)), maxlen=0)


def record(run: Run, scene: Scene, frames: int | None = None) -> Trace:
    """Run a scene, or its first `frames`, frame by frame and keep every state; stops at one that is not finite."""
    states = [run.state()]
    for _ in range(scene.frames if frames is None else frames):
        run.advance(1)
        states.append(run.state())
        if not np.all(np.isfinite(states[-1])):
            break
    found = np.array(states)
    if np.all(np.isfinite(found)):
        found[:, :, ANGLE] = np.unwrap(found[:, :, ANGLE], axis=0)
    times = scene.frame * np.arange(len(found), dtype=np.float64)
    return Trace(tuple(body.name for body in scene.bodies), times, found)


def has_curves(scene: Scene) -> bool:
    """Whether anything in the scene is a circle or another curve."""
    return any(isinstance(shape, Circle | Curve) for body in scene.bodies for shape in body.shapes)


def samplings(scene: Scene, quick: bool) -> list[dict[str, float]]:
    """The knob `sampling` (chord tolerance over body size) for scenes with curves that have to be sampled."""
    values: tuple[float, ...]
    if "gears" in scene.tags:
        values = (1e-2, 1e-3)
    elif "curved" in scene.tags:
        values = (1e-3, 1e-5) if quick else (1e-2, 1e-3, 1e-4, 1e-5)
    else:
        return [{}]
    return knob("sampling", values)
