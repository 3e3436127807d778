"""A pymunk program run as it is, area contact attached to every space that it steps.

The program's file is not touched. pymunk's own `Space` is told, in this process and until it ends, to attach itself
before its first step, and to say when it has been stepped. A host serves one program; the program's patched modules
are not put back.
"""

from __future__ import annotations

import gc
import runpy
import sys
import time
import weakref
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import pymunk

from ..chipmunk import AreaContact, attach, attached
from . import null_pyglet
from .screen import Screen

ENGINES = ("area", "pymunk")
PHASES = ("begin", "pre_solve", "post_solve", "separate")


class EndOfRun(BaseException):
    """All frames are done. Not an Exception: a program's own `except Exception` must not keep it going."""


class Host:
    """Runs one program: engine, frames, headless or not, what is watched.

    engine: "area" attaches area contact to every space before its first step, "pymunk" leaves it alone.
    frames: how many frames to run (None: until the program ends). A frame is what is shown: one
        `pygame.display.flip`, `Clock.tick` or turn of pyglet's loop (whichever comes oftener), and where nothing is
        ever shown one `space.step`.
    headless: no window, a clock that never waits, no user; else the program meets the real ones.

    `after_frame`, if somebody sets it, is called after every frame; it may look at everything.

    Raises ValueError for an unknown engine or a negative number of frames.
    """

    def __init__(self, engine: str = "area", frames: int | None = None, *, headless: bool = True) -> None:
        if engine not in ENGINES:
            raise ValueError(f"engine must be one of {', '.join(ENGINES)}, got {engine!r}")
        if frames is not None and frames < 1:
            raise ValueError(f"frames must be at least 1, got {frames}")
        self.engine, self.frames, self.headless = engine, frames, headless
        self.after_frame: Callable[[], None] | None = None
        self.spaces: list[pymunk.Space] = []
        """Every space that was stepped, in the order of their first steps."""
        self.calls = dict.fromkeys(PHASES, 0)
        """How often the program's own collision callbacks were called."""
        self.steps = 0
        self.frame_cpu: list[float] = []
        """Processor time that `Space.step` took, frame by frame (s)."""
        self._counts = {"flip": 0, "tick": 0, "step": 0}
        self._cpu = 0.0
        self._known: weakref.WeakSet[pymunk.Space] = weakref.WeakSet()
        self._inside = False

    @property
    def frame(self) -> int:
        """How many frames are done."""
        return len(self.frame_cpu)

    @property
    def contacts(self) -> list[AreaContact]:
        """The area contacts of the spaces."""
        return [contact for space in self.spaces if (contact := attached(space)) is not None]

    def run(self, target: str | Path, arguments: Sequence[str] = ()) -> None:
        """Run a file (a path), or a module ("package.module"), as __main__ with these arguments.

        Returns when its frames are done or when it ends by itself (SystemExit with code 0 or None included); what it
        raises goes through. FileNotFoundError for a file that is not there.
        """
        path = Path(target)
        is_file = path.suffix == ".py" or path.exists()
        if is_file and not path.is_file():
            raise FileNotFoundError(f"there is no file {str(target)!r}")
        self._install()
        before = sys.argv, sys.path[:]
        gc.collect()  # our garbage is not to bring on its first collection: some count on a late one
        sys.argv = [str(target), *arguments]
        try:
            if is_file:
                sys.path.insert(0, str(path.resolve().parent))
                runpy.run_path(str(path), run_name="__main__")
            else:
                runpy.run_module(str(target), run_name="__main__", alter_sys=True)
        except EndOfRun:
            pass
        except SystemExit as end:
            if end.code not in (None, 0):
                raise
        finally:
            sys.argv, sys.path[:] = before

    # --- what it puts in ---

    def _install(self) -> None:
        Space: Any = pymunk.Space
        Contact: Any = AreaContact
        step, on_collision, contact_step = Space.step, Space.on_collision, Contact.step

        def counted_step(space: pymunk.Space, dt: float) -> None:
            if self._inside:  # area contact's own
                step(space, dt)
                return
            self._first(space)
            self._timed(lambda: step(space, dt))

        def counted_contact_step(contact: AreaContact, *arguments: Any, **named: Any) -> int:
            taken: list[int] = []
            self._first(contact.space)
            self._timed(lambda: taken.append(contact_step(contact, *arguments, **named)))
            return taken[0]

        def counted_on_collision(space: pymunk.Space, *arguments: Any, **named: Any) -> None:
            given = list(arguments)
            for i, phase in enumerate(PHASES, start=2):
                if i < len(given):
                    given[i] = self._counting(phase, given[i])
                elif phase in named:
                    named[phase] = self._counting(phase, named[phase])
            on_collision(space, *given, **named)

        Space.step = counted_step
        Space.on_collision = counted_on_collision
        Contact.step = counted_contact_step
        if self.headless:
            self._install_stand_ins()
        elif self.frames is not None or self.after_frame is not None:
            self._count_flips()

    def _install_stand_ins(self) -> None:
        """In the place of a screen and its clock."""
        Screen(self._count).install()
        null_pyglet.install(null_pyglet.Loop(self._count))

    def _count_flips(self) -> None:
        """In a real window: count what it shows."""
        try:
            import pygame
        except ModuleNotFoundError:
            return
        for name in ("flip", "update"):
            show = getattr(pygame.display, name)

            def shown(*arguments: Any, _show: Callable[..., Any] = show) -> None:
                _show(*arguments)
                self._count("flip")

            setattr(pygame.display, name, shown)

    def _first(self, space: pymunk.Space) -> None:
        if space in self._known:
            return
        self._known.add(space)
        self.spaces.append(space)
        if self.engine == "area" and attached(space) is None:
            attach(space)

    def _timed(self, step: Callable[[], None]) -> None:
        self._inside = True
        start = time.process_time()
        try:
            step()
        finally:
            self._cpu += time.process_time() - start
            self._inside = False
        self.steps += 1
        self._count("step")

    def _counting(self, phase: str, callback: Any) -> Any:
        """The program's callback, counted; area contact's own and pymunk's empty one are left as they are."""
        home = getattr(callback, "__module__", None) or type(callback).__module__
        not_theirs = home.split(".")[0] in ("rigidarea", "pymunk") and not home.startswith("pymunk.examples")
        if not_theirs or not callable(callback):
            return callback
        return _Counted(callback, self.calls, phase)

    def _count(self, kind: str) -> None:
        if kind == "step" and (self._counts["flip"] or self._counts["tick"] or _has_window()):
            return  # what is shown counts
        self._counts[kind] += 1
        shown = self._counts["step"] + max(self._counts["flip"], self._counts["tick"])
        if shown <= self.frame:
            return
        self.frame_cpu.append(self._cpu)
        self._cpu = 0.0
        if self.after_frame is not None:
            self.after_frame()
        if self.frames is not None and self.frame >= self.frames:
            raise EndOfRun


def _has_window() -> bool:
    pygame = sys.modules.get("pygame")
    shown = pygame is not None and pygame.display.get_init() and pygame.display.get_surface() is not None
    return shown or bool(null_pyglet.windows)


class _Counted:
    """A callback that counts its calls, and is copied and pickled like the callback itself."""

    def __init__(self, callback: Callable[..., Any], calls: dict[str, int], phase: str) -> None:
        self.callback, self.calls, self.phase = callback, calls, phase

    def __call__(self, arbiter: pymunk.Arbiter, space: pymunk.Space, data: Any) -> Any:
        self.calls[self.phase] += 1
        return self.callback(arbiter, space, data)

    def __deepcopy__(self, memory: Any) -> _Counted:
        return self

    def __reduce__(self) -> Any:
        return _itself, (self.callback,)


def _itself(callback: Any) -> Any:
    return callback
