"""A user's hands on a hosted program: keys and mouse by a script, in pygame's and in pyglet's place."""

from __future__ import annotations

import random
from collections.abc import Callable, Iterator, Sequence
from typing import Any, NamedTuple

import numpy as np

from rigidarea.programs import null_pyglet
from rigidarea.programs.host import Host
from rigidarea.programs.screen import Screen


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


class PlayedScreen(Screen):
    """A screen on which the script's input arrives, each in its frame; frame() tells which it is."""

    def __init__(
        self, script: Sequence[Input], counted: Callable[[str], None], frame: Callable[[], int]
    ) -> None:
        super().__init__(counted)
        self.frame = frame
        self._todo: Iterator[Input] = iter(sorted(script, key=lambda given: given.frame))
        self._next = next(self._todo, None)
        self._down: set[int] = set()
        self._buttons: set[int] = set()
        self._mouse = (0, 0)

    def install(self) -> None:
        """What is held is asked of the script too. Does nothing without pygame."""
        super().install()
        try:
            import pygame
        except ModuleNotFoundError:
            return
        place: Any = pygame
        place.key.get_pressed, place.key.get_mods = lambda: Keys(self._down), self._modifiers
        place.mouse.get_pos = lambda: self._mouse
        place.mouse.get_pressed = lambda num_buttons=3: tuple(
            button in self._buttons for button in range(1, num_buttons + 1)
        )

    def _modifiers(self) -> int:
        import pygame

        named = {"SHIFT": pygame.KMOD_LSHIFT, "CTRL": pygame.KMOD_LCTRL, "ALT": pygame.KMOD_LALT}
        return sum(
            mask
            for name, mask in named.items()
            if self._down & {getattr(pygame, f"K_L{name}"), getattr(pygame, f"K_R{name}")}
        )

    def _post_due(self) -> None:
        """Put on pygame's queue what the script has for this moment, then what the timers have."""
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
        super()._post_due()


class PlayedLoop(null_pyglet.Loop):
    """pyglet's loop, whose windows get the script's input, each in its frame."""

    def __init__(self, script: Sequence[Input], counted: Callable[[str], None]) -> None:
        super().__init__(counted)
        self._script = sorted(script, key=lambda given: given.frame)
        self._frame = 0
        self._mouse = (0, 0)
        self._buttons = 0

    def turn(self) -> None:
        """Input, then the frame."""
        while self._script and self._script[0].frame <= self._frame:
            self._dispatch(self._script.pop(0))
        self._frame += 1
        super().turn()

    def _dispatch(self, given: Input) -> None:
        name: str
        arguments: tuple[Any, ...]
        if given.kind == "key":
            name = "on_key_press" if given.down else "on_key_release"
            arguments = (getattr(null_pyglet.Keys(), given.what), 0)
        elif given.kind == "button":
            name = "on_mouse_press" if given.down else "on_mouse_release"
            self._buttons = given.what if given.down else 0
            arguments = (*self._mouse, given.what, 0)
        else:
            x, y = given.what
            moved = (x - self._mouse[0], y - self._mouse[1])
            self._mouse = (x, y)
            name = "on_mouse_drag" if self._buttons else "on_mouse_motion"
            arguments = (x, y, *moved, *((self._buttons, 0) if self._buttons else ()))
        for window in null_pyglet.windows:
            window.dispatch_event(name, *arguments)


class PlayedHost(Host):
    """A headless host with a user who does what the script says."""

    def __init__(self, engine: str, frames: int | None, script: Sequence[Input] = ()) -> None:
        super().__init__(engine, frames)
        self.script = script

    def _install_stand_ins(self) -> None:
        PlayedScreen(self.script, self._count, lambda: self.frame).install()
        null_pyglet.install(PlayedLoop(self.script, self._count))


def seed_everything(seed: int) -> None:
    """Seed `random` and NumPy's global generator."""
    random.seed(seed)
    np.random.seed(seed)  # noqa: NPY002 - the program's own choice of generator is what has to be met
