"""pygame without a screen: a dummy window, and a clock that never waits.

A program's own loop runs unchanged: it sees pygame's own event queue and surfaces, on which no user types or moves a
mouse. What changes is where time comes from: a frame lasts what `Clock.tick` was asked for, whatever the processor
needed.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from typing import Any

#: What a frame lasts where the program does not say (milliseconds).
FRAME_MS = 1000.0 / 60.0


class Clock:
    """`pygame.time.Clock` on the screen's own time."""

    def __init__(self, screen: Screen) -> None:
        self._screen = screen
        self._ms = FRAME_MS

    def tick(self, framerate: float = 0) -> int:
        """Let the time of a frame pass at once; returns it (milliseconds)."""
        self._ms = 1000.0 / framerate if framerate else FRAME_MS
        before = int(self._screen.now)
        self._screen.now += self._ms
        self._screen.counted("tick")
        return int(self._screen.now) - before

    tick_busy_loop = tick

    def get_time(self) -> int:
        """Time of the last frame (milliseconds)."""
        return int(self._ms)

    get_rawtime = get_time

    def get_fps(self) -> float:
        """Frames a second."""
        return 1000.0 / self._ms


class Screen:
    """Takes pygame's place where it meets a screen or a clock, until the process ends.

    counted(kind) is called for every "flip" and every "tick".
    """

    def __init__(self, counted: Callable[[str], None]) -> None:
        self.counted = counted
        self.now = 0.0
        """Time since the start (milliseconds)."""
        self._timers: dict[int, tuple[float, float]] = {}

    def install(self) -> None:
        """Import pygame on SDL's dummy drivers and put the stand-ins in. Does nothing without pygame."""
        os.environ["SDL_VIDEODRIVER"] = os.environ["SDL_AUDIODRIVER"] = "dummy"
        os.environ.setdefault("PYGAME_HIDE_SUPPORT_PROMPT", "1")
        try:
            import pygame
        except ModuleNotFoundError:
            return  # a program that wants it says so itself
        display, event = pygame.display, pygame.event
        for module, name in ((display, "flip"), (display, "update")):
            setattr(module, name, self._then_count(getattr(module, name)))
        for name in ("get", "poll", "pump", "peek"):
            setattr(event, name, self._after_timers(getattr(event, name)))
        stand_ins: dict[Any, dict[str, Any]] = {
            pygame.time: {
                "Clock": lambda: Clock(self),
                "get_ticks": lambda: int(self.now),
                "wait": self._wait,
                "delay": self._wait,
                "set_timer": self._set_timer,
            },
            # looking for a system's fonts takes seconds, and warns where there are none
            pygame.font: {"SysFont": lambda name, size, *more, **named: pygame.font.Font(None, size)},
        }
        for module, names in stand_ins.items():
            for name, value in names.items():
                setattr(module, name, value)

    def _then_count(self, flip: Callable[..., Any]) -> Callable[..., Any]:
        def flipped(*arguments: Any) -> None:
            flip(*arguments)
            self.counted("flip")

        return flipped

    def _after_timers(self, read: Callable[..., Any]) -> Callable[..., Any]:
        def after(*arguments: Any, **named: Any) -> Any:
            self._post_due()
            return read(*arguments, **named)

        return after

    def _wait(self, milliseconds: int) -> int:
        self.now += milliseconds
        return milliseconds

    def _set_timer(self, event: Any, milliseconds: int, loops: int = 0) -> None:
        kind = event if isinstance(event, int) else event.type
        self._timers.pop(kind, None)
        if milliseconds > 0:
            self._timers[kind] = (self.now + milliseconds, milliseconds)

    def _post_due(self) -> None:
        """Put on pygame's queue what the timers have for this moment."""
        import pygame

        for kind, (at, period) in list(self._timers.items()):
            while at <= self.now:
                pygame.event.post(pygame.event.Event(kind))
                at += period
            self._timers[kind] = (at, period)
