"""pygame without a screen: a dummy window, a clock that never waits, keys and mouse by a script.

A program's own loop runs unchanged: it sees pygame's own event queue and surfaces. What changes is where time comes
from (a frame lasts what `Clock.tick` was asked for, whatever the processor needed) and what the user does (nothing, or
what the script says).
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Sequence
from typing import Any, NamedTuple

#: What a frame lasts where the program does not say (milliseconds).
FRAME_MS = 1000.0 / 60.0


class Input(NamedTuple):
    """One thing that a user does, at the start of a frame."""

    frame: int
    kind: str
    """"key" (a pygame name without K_: "LEFT", "r"), "button" (1 left, 3 right), "mouse" (a position)."""
    what: Any
    down: bool = True


def tap(frame: int, key: str, held: int = 3) -> list[Input]:
    """A key pressed at `frame` and released `held` frames later."""
    return [Input(frame, "key", key), Input(frame + held, "key", key, False)]


def drag(frame: int, button: int, path: Sequence[tuple[float, float]]) -> list[Input]:
    """A button pressed at the first point of a path, released at the last, one point a frame."""
    moves = [Input(frame + i, "mouse", point) for i, point in enumerate(path)]
    return [
        moves[0],
        Input(frame, "button", button),
        *moves[1:],
        Input(frame + len(path), "button", button, False),
    ]


class Keys:
    """What `pygame.key.get_pressed` returns: True at the codes of the keys that are down."""

    def __init__(self, down: set[int]) -> None:
        self._down = down

    def __getitem__(self, code: int) -> bool:
        return code in self._down


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
    """Takes pygame's place where it meets a screen, a clock or a hand, until the process ends.

    counted(kind) is called for every "flip" and every "tick"; frame() tells which frame it is.
    """

    def __init__(
        self, script: Sequence[Input], counted: Callable[[str], None], frame: Callable[[], int]
    ) -> None:
        self.counted, self.frame = counted, frame
        self.now = 0.0
        """Time since the start (milliseconds)."""
        self._todo: Iterator[Input] = iter(sorted(script, key=lambda given: given.frame))
        self._next = next(self._todo, None)
        self._down: set[int] = set()
        self._buttons: set[int] = set()
        self._mouse = (0, 0)
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
            setattr(event, name, self._after_input(getattr(event, name)))
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
            pygame.key: {"get_pressed": lambda: Keys(self._down), "get_mods": self._modifiers},
            pygame.mouse: {
                "get_pos": lambda: self._mouse,
                "get_pressed": lambda num_buttons=3: tuple(
                    button in self._buttons for button in range(1, num_buttons + 1)
                ),
            },
        }
        for module, names in stand_ins.items():
            for name, value in names.items():
                setattr(module, name, value)

    def _then_count(self, flip: Callable[..., Any]) -> Callable[..., Any]:
        def flipped(*arguments: Any) -> None:
            flip(*arguments)
            self.counted("flip")

        return flipped

    def _after_input(self, read: Callable[..., Any]) -> Callable[..., Any]:
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

    def _modifiers(self) -> int:
        import pygame

        named = {"SHIFT": pygame.KMOD_LSHIFT, "CTRL": pygame.KMOD_LCTRL, "ALT": pygame.KMOD_LALT}
        return sum(
            mask
            for name, mask in named.items()
            if self._down & {getattr(pygame, f"K_L{name}"), getattr(pygame, f"K_R{name}")}
        )

    def _post_due(self) -> None:
        """Put on pygame's queue what the script and the timers have for this moment."""
        import pygame

        while self._next is not None and self._next.frame <= self.frame():
            given, self._next = self._next, next(self._todo, None)
            if given.kind == "key":
                code = getattr(pygame, f"K_{given.what}")
                (self._down.add if given.down else self._down.discard)(code)
                kind = pygame.KEYDOWN if given.down else pygame.KEYUP
                pygame.event.post(pygame.event.Event(kind, key=code, mod=self._modifiers(), unicode=""))
            elif given.kind == "button":
                (self._buttons.add if given.down else self._buttons.discard)(given.what)
                kind = pygame.MOUSEBUTTONDOWN if given.down else pygame.MOUSEBUTTONUP
                pygame.event.post(pygame.event.Event(kind, pos=self._mouse, button=given.what))
            else:
                before, self._mouse = self._mouse, (round(given.what[0]), round(given.what[1]))
                moved = (self._mouse[0] - before[0], self._mouse[1] - before[1])
                held = tuple(int(button in self._buttons) for button in (1, 2, 3))
                pygame.event.post(
                    pygame.event.Event(pygame.MOUSEMOTION, pos=self._mouse, rel=moved, buttons=held)
                )
        for kind, (at, period) in list(self._timers.items()):
            while at <= self.now:
                pygame.event.post(pygame.event.Event(kind))
                at += period
            self._timers[kind] = (at, period)
