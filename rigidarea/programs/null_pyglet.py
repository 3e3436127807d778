"""pyglet without a screen: its clock, its application loop and its events; everything that draws does nothing.

pyglet needs OpenGL even off screen. A program's physics needs none of that: scheduled functions are called at their
own pace on a time that never waits, `on_draw` runs with calls that go nowhere.
"""

from __future__ import annotations

import sys
import types
from collections.abc import Callable, Iterator
from typing import Any

from .screen import FRAME_MS


class _Nothing(type):
    def __getattr__(cls, name: str) -> Any:
        if name.startswith("__"):
            raise AttributeError(name)
        return Nothing


class Nothing(metaclass=_Nothing):
    """Takes any call, attribute and sum, and does nothing."""

    def __init__(self, *arguments: Any, **named: Any) -> None:
        pass

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__"):
            raise AttributeError(name)
        return Nothing()

    def __call__(self, *arguments: Any, **named: Any) -> Any:
        return Nothing()

    def __iter__(self) -> Iterator[Any]:
        return iter(())

    def __or__(self, other: Any) -> Any:
        return Nothing()

    __ror__ = __add__ = __radd__ = __sub__ = __rsub__ = __mul__ = __rmul__ = __truediv__ = __or__


class Window:
    """A window of the size asked for, with pyglet's event decorator."""

    def __init__(self, width: int = 640, height: int = 480, **named: Any) -> None:
        self.width, self.height = width, height
        self.handlers: dict[str, Callable[..., Any]] = {}
        windows.append(self)

    def event(self, handler: Callable[..., Any]) -> Callable[..., Any]:
        """Register a handler by its name."""
        self.handlers[handler.__name__] = handler
        return handler

    def dispatch_event(self, name: str, *arguments: Any) -> None:
        """Call the handler of that name, registered or a method, if there is one."""
        handler = self.handlers.get(name) or getattr(type(self), name, None)
        if handler is None:
            return
        handler(*(() if name in self.handlers else (self,)), *arguments)

    def get_size(self) -> tuple[int, int]:
        """Width and height (pixels)."""
        return self.width, self.height

    def __getattr__(self, name: str) -> Any:
        if name.startswith("on_") or name.startswith("__"):
            raise AttributeError(name)
        return Nothing()


windows: list[Window] = []


class Keys:
    """Key codes: a number for every name."""

    def __getattr__(self, name: str) -> int:
        if name.startswith("__"):
            raise AttributeError(name)
        return sum(ord(letter) << (7 * i) for i, letter in enumerate(name.upper()[:8]))


class _Leave(Exception):
    """The program called `pyglet.app.exit`."""


class Loop:
    """pyglet's clock and application loop."""

    def __init__(self, counted: Callable[[str], None]) -> None:
        self._counted = counted
        self._now = 0.0
        self._jobs: list[list[Any]] = []  # due (seconds), interval or None, function, arguments

    def schedule_interval(self, function: Callable[..., Any], interval: float, *more: Any) -> None:
        """Call function(dt, ...) every `interval` seconds."""
        self._jobs.append([self._now + interval, interval, function, more])

    def schedule(self, function: Callable[..., Any], *more: Any) -> None:
        """Call function(dt, ...) every frame."""
        self.schedule_interval(function, FRAME_MS / 1000, *more)

    def schedule_once(self, function: Callable[..., Any], delay: float, *more: Any) -> None:
        """Call function(dt, ...) once, after `delay` seconds."""
        self._jobs.append([self._now + delay, None, function, more])

    def unschedule(self, function: Callable[..., Any]) -> None:
        """Never call it again."""
        self._jobs = [job for job in self._jobs if job[2] != function]

    def run(self, *arguments: Any) -> None:
        """Frame after frame, until somebody ends it."""
        try:
            while True:
                self.turn()
        except _Leave:
            pass

    def turn(self) -> None:
        """One frame."""
        self._now += FRAME_MS / 1000
        self._call_due()
        for window in windows:
            window.dispatch_event("on_draw")
        self._counted("flip")

    def leave(self) -> None:
        """End the loop."""
        raise _Leave

    def _call_due(self) -> None:
        # half a frame of grace: an interval of one frame is due once a frame, whatever rounding says
        while due := [job for job in self._jobs if job[0] <= self._now + FRAME_MS / 2000]:
            job = min(due, key=lambda job: job[0])
            if job[1] is None:
                self._jobs.remove(job)
            else:
                job[0] += job[1]
            job[2](job[1] or 0.0, *job[3])


class _Module(types.ModuleType):
    """A module in which every name is there: modules as listed, classes that do nothing otherwise."""

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__"):
            raise AttributeError(name)
        return Nothing


def install(loop: Loop) -> None:
    """Put the stand-in in pyglet's place, whether pyglet is installed or not."""
    parts = ("window", "clock", "app", "gl", "graphics", "shapes", "sprite", "text", "image", "resource")
    root: Any = _Module("pyglet")
    root.__path__ = []
    root.version = "2.0"
    sys.modules["pyglet"] = root
    for name in (*parts, "graphics.shader", "window.key", "window.mouse"):
        module: Any = _Module(f"pyglet.{name}")
        module.__path__ = []
        sys.modules[f"pyglet.{name}"] = module
        parent, _, last = f"pyglet.{name}".rpartition(".")
        setattr(sys.modules[parent], last, module)
    root.window.Window = Window
    root.window.key = sys.modules["pyglet.window.key"] = Keys()  # type: ignore[assignment]
    root.clock.schedule_interval = loop.schedule_interval
    root.clock.schedule_once = loop.schedule_once
    root.clock.schedule = loop.schedule
    root.clock.unschedule = loop.unschedule
    root.app.run, root.app.exit = loop.run, loop.leave
