"""A film of a hosted program: of its own window's pictures, or, where it shows nothing, of what moves in its spaces."""

from __future__ import annotations

from pathlib import Path
from types import TracebackType

import numpy as np
import pygame
import pymunk

from ..draw.canvas import INK, PALETTE, PAPER, STATIC, Camera, placed, sketch, tint
from ..draw.film import FPS, Film
from ..geometry.outline import Outline
from .host import Host

SIZE = (800, 600)


class Filming:
    """Adds every second frame of a host to a film (30 pictures a second, frames of 1/60 s)."""

    def __init__(self, host: Host, path: Path) -> None:
        self._host = host
        self._film = Film(path)
        self._picture: Drawing | None = None
        self._size: tuple[int, int] | None = None
        host.after_frame = self._look

    @property
    def path(self) -> Path:
        """The file, with the suffix that it got."""
        return self._film.path

    def __enter__(self) -> Filming:
        self._film.__enter__()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._film.__exit__(kind, error, trace)

    def _look(self) -> None:
        if self._host.frame % (60 // FPS):
            return
        shown = pygame.display.get_surface() if pygame.display.get_init() else None
        if shown is None:
            if not self._host.spaces:
                return
            self._picture = self._picture or Drawing(self._host.spaces[0])
            shown = self._picture.draw()
        even = (shown.get_width() // 8 * 8, shown.get_height() // 8 * 8)  # what encoders take
        self._size = self._size or even
        picture = pygame.Surface(self._size)  # a window may change its size; a film may not
        picture.blit(shown, (0, 0))
        self._film.add(picture)


class Drawing:
    """A space as its outlines, seen by a camera that holds everything that it has at the first picture."""

    def __init__(self, space: pymunk.Space) -> None:
        self.space = space
        self.surface = pygame.Surface(SIZE)
        boxes = [shape.cache_bb() for shape in space.shapes]
        if not boxes:
            boxes = [pymunk.BB(-1, -1, 1, 1)]
        x0, x1 = min(box.left for box in boxes), max(box.right for box in boxes)
        y0, y1 = min(box.bottom for box in boxes), max(box.top for box in boxes)
        dynamic = [shape for shape in space.shapes if shape.body is not space.static_body]
        if dynamic:
            # long floors would make everything else small: no wider than eight times what moves
            mx0, mx1 = min(s.bb.left for s in dynamic), max(s.bb.right for s in dynamic)
            my0, my1 = min(s.bb.bottom for s in dynamic), max(s.bb.top for s in dynamic)
            reach = 8 * max(mx1 - mx0, my1 - my0)
            middle_x, middle_y = (mx0 + mx1) / 2, (my0 + my1) / 2
            x0, x1 = max(x0, middle_x - reach), min(x1, middle_x + reach)
            y0, y1 = max(y0, middle_y - reach), min(y1, middle_y + reach)
        margin = 0.05 * max(x1 - x0, y1 - y0)
        view = (x0 - margin, y0 - margin, x1 + margin, y1 + margin)
        self.camera = Camera.fit(view, pygame.Rect(0, 0, *SIZE))
        self.down = space.gravity.y > 0  # y points down, as in pygame
        self._outlines: dict[pymunk.Shape, Outline] = {}

    def draw(self) -> pygame.Surface:
        """The picture of now."""
        self.surface.fill(PAPER)
        for number, shape in enumerate(self.space.shapes):
            if shape.body is None:
                continue
            if shape not in self._outlines:
                self._outlines[shape] = Outline.from_pymunk(shape)
            color = STATIC if shape.body.body_type == pymunk.Body.STATIC else PALETTE[number % len(PALETTE)]
            drawn = sketch(self._outlines[shape], 0.1 / self.camera.scale)
            if isinstance(shape, pymunk.Segment) and shape.radius == 0:
                a, b = self.camera.pixels(placed(drawn.rings[0][:2], shape.body))
                pygame.draw.line(self.surface, tint(STATIC, 1.4), a, b, 2)
                continue
            fill = self.camera.pixels(placed(drawn.fill, shape.body))
            pygame.draw.polygon(self.surface, tint(color, 0.62), fill)
            for ring in drawn.rings:
                outline = self.camera.pixels(placed(ring, shape.body))
                pygame.draw.aalines(self.surface, tint(color, 1.45), True, outline)
        if self.space.constraints:
            for joint in self.space.constraints:
                self._joint(joint)
        return pygame.transform.flip(self.surface, False, True) if self.down else self.surface

    def _joint(self, joint: pymunk.Constraint) -> None:
        anchors = [getattr(joint, name, (0.0, 0.0)) for name in ("anchor_a", "anchor_b")]
        bodies = (joint.a, joint.b)
        if any(body is None for body in bodies):
            return
        ends = np.array([body.local_to_world(at) for body, at in zip(bodies, anchors)])
        a, b = self.camera.pixels(ends)
        pygame.draw.line(self.surface, tint(INK, 0.5), a, b, 1)
        pygame.draw.circle(self.surface, INK, b, 2)
