"""A run in a window, in real time: drag bodies with the mouse, space pauses, Esc closes."""

from __future__ import annotations

import os

import pygame
import pymunk

from ..gallery import Run, load
from ..overlap_queries import covers
from .picture import FINE, SIZE, Picture

#: How hard the mouse may pull, in weights of the body (or, without gravity, in the scene's drawn forces).
PULL = 30.0


def play(name: str) -> int:
    """Open a demo in a window (`python demos/NAME.py`); returns the exit code. ValueError lists the known ones."""
    show(Run(load(name)))
    return 0


def show(run: Run, frames: int | None = None) -> None:
    """Open the window and step the run until it is closed, or for that many frames.

    OSError where there is no display.
    """
    try:
        pygame.display.init()
        screen = pygame.display.set_mode(SIZE)
    except pygame.error as error:
        raise OSError(
            f"no window can be opened here ({error}); without --window files are written"
        ) from error
    if pygame.display.get_driver() in ("dummy", "offscreen") and "SDL_VIDEODRIVER" not in os.environ:
        pygame.display.quit()
        raise OSError("no window can be opened here: there is no display; without --window files are written")
    pygame.display.set_caption(f"rigidarea: {run.scene.title}")
    picture, clock, hand, paused = Picture(run), pygame.time.Clock(), Hand(run), False
    while frames is None or run.done < frames:
        for event in pygame.event.get():
            if event.type == pygame.QUIT or (event.type == pygame.KEYDOWN and event.key == pygame.K_ESCAPE):
                pygame.display.quit()
                return
            if event.type == pygame.KEYDOWN and event.key == pygame.K_SPACE:
                paused = not paused
            elif event.type in (pygame.MOUSEBUTTONDOWN, pygame.MOUSEMOTION):
                at = picture.camera.world((event.pos[0] * FINE, event.pos[1] * FINE))
                hand.body.position = at
                if event.type == pygame.MOUSEBUTTONDOWN:
                    hand.grab()
            elif event.type == pygame.MOUSEBUTTONUP:
                hand.release()
        if not paused:
            run.advance()
        screen.blit(picture.draw(), (0, 0))
        pygame.display.flip()
        clock.tick(60)
    pygame.display.quit()


class Hand:
    """The mouse in the space: a kinematic body that a grabbed body hangs on."""

    def __init__(self, run: Run) -> None:
        self.run = run
        self.body = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
        self._joint: pymunk.PivotJoint | None = None

    def grab(self) -> None:
        """Take the dynamic body whose true outline is under the mouse, if there is one."""
        for part in reversed(self.run.parts):
            body = part.body
            if body.body_type != pymunk.Body.DYNAMIC:
                continue
            if covers(part.outline, (*body.position, body.angle), self.body.position):
                joint = pymunk.PivotJoint(self.body, body, (0, 0), body.world_to_local(self.body.position))
                weight = body.mass * abs(self.run.space.gravity)
                joint.max_force = PULL * (weight or self.run.scene.force)
                joint.error_bias = (1 - 0.15) ** 60
                self.run.space.add(joint)
                self._joint = joint
                return

    def release(self) -> None:
        """Let go."""
        if self._joint is not None:
            self.run.space.remove(self._joint)
            self._joint = None
