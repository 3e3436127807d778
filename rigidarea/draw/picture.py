"""One picture of a run: bodies, contacts with their forces, a lens, a scale bar, the strip of frame times."""

from __future__ import annotations

import math
from functools import cache, lru_cache

import numpy as np
import pygame
import pymunk
import shapely

from ..gallery import Mark, Part, Run
from .canvas import (
    CONTACT,
    FAINT,
    FORCE,
    INK,
    OVER,
    PALETTE,
    PAPER,
    STATIC,
    UNDER,
    Camera,
    Color,
    placed,
    placed_polygon,
    sketch,
    tint,
)

SIZE = (1000, 640)
HEADER, STRIP = 58, 84
"""Heights above and below the scene (pixels)."""
FINE = 2
"""The scene is drawn this much larger and then averaged down: pygame's fills know no anti-aliasing."""
HISTORY = 240
"""Frames in the strip."""


class Picture:
    """Draws a run again and again on its own surface (pygame.Surface, SIZE); no display is needed."""

    def __init__(self, run: Run) -> None:
        pygame.font.init()
        self.run = run
        self.surface = pygame.Surface(SIZE)
        self._large = pygame.Surface((SIZE[0] * FINE, SIZE[1] * FINE))
        area = pygame.Rect(0, HEADER * FINE, SIZE[0] * FINE, (SIZE[1] - HEADER - STRIP) * FINE)
        self.camera = Camera.fit(run.scene.view, area)
        self.lens: Camera | None = None
        if run.scene.lens is not None:
            side = 190 * FINE
            corner = pygame.Rect(area.x + 28, area.y + 8, side, side)
            self.lens = Camera(0, 0, side / run.scene.lens.width, corner)
        moving = dict.fromkeys(part.body for part in run.parts if part.body.body_type != part.body.STATIC)
        self._colors: dict[object, Color] = {}
        for i, body in enumerate(moving):
            self._colors[body] = PALETTE[run.scene.colors.get(body, i) % len(PALETTE)]
        for body, number in run.scene.colors.items():
            self._colors.setdefault(body, PALETTE[number % len(PALETTE)])

    def draw(self) -> pygame.Surface:
        """The picture of now."""
        large = self._large
        large.fill(PAPER)
        marks = self.run.marks()
        large.set_clip(self.camera.area)
        self._scene(large, self.camera)
        self._forces(large, self.camera, marks)
        large.set_clip(None)
        if self.lens is not None:
            self._lens(large, marks)
        pygame.transform.smoothscale(large, SIZE, self.surface)
        self._header()
        self._legend()
        self._frame_times()
        return self.surface

    # --- the scene ---

    def _scene(self, target: pygame.Surface, camera: Camera) -> None:
        for part in self.run.parts:
            if part.face:
                self._face(target, camera, part)
        for part in self.run.parts:
            if not part.face:
                self._part(target, camera, part)

        self._joints(target, camera)

    def _joints(self, target: pygame.Surface, camera: Camera) -> None:
        """Pivots as small circles; where a body hangs away from its pivot, the rod."""
        for joint in self.run.space.constraints:
            if not isinstance(joint, pymunk.PivotJoint):
                continue
            pivot = joint.b.local_to_world(joint.anchor_b)
            (x, y), body = camera.pixels(np.array([pivot, joint.b.position]))
            if math.hypot(x - body[0], y - body[1]) > 12 * FINE:
                pygame.draw.line(target, tint(INK, 0.7), (x, y), body, FINE)
            pygame.draw.circle(target, PAPER, (x, y), 4 * FINE)
            pygame.draw.circle(target, INK, (x, y), 4 * FINE, FINE)

    def _face(self, target: pygame.Surface, camera: Camera, part: Part) -> None:
        """A segment of radius 0: a line, with a soft shade behind it."""
        ends = part.outline.rings[0][:2]
        a, b = camera.pixels(placed(ends, part.body))
        below = np.array((0, 10 * FINE))
        for i in range(5):
            shade = tint(STATIC, 0.5 - 0.1 * i)
            near, far = below * i / 5, below * (i + 1) / 5
            pygame.draw.polygon(target, shade, [a + near, b + near, b + far, a + far])
        pygame.draw.line(target, tint(STATIC, 1.4), a, b, FINE + 1)

    def _part(self, target: pygame.Surface, camera: Camera, part: Part) -> None:
        drawn = sketch(part.outline, 0.04 / camera.scale)
        center = camera.pixels(np.array([part.body.position]))[0]
        reach = drawn.reach * camera.scale
        if not camera.area.inflate(2 * reach, 2 * reach).collidepoint(center):
            return
        color = self._colors.get(part.body, STATIC)
        fill, edge = tint(color, 0.62), tint(color, 1.45)
        pygame.draw.polygon(target, fill, camera.pixels(placed(drawn.fill, part.body)))
        width = FINE if reach > 16 * FINE else 1
        for ring in drawn.rings:
            pygame.draw.lines(target, edge, True, camera.pixels(placed(ring, part.body)), width)
        if part.body.body_type != part.body.STATIC and reach > 9 * FINE:
            start, end = camera.pixels(placed(drawn.mark, part.body))
            pygame.draw.line(target, edge, start, end, width)
            pygame.draw.circle(target, edge, start, 1.5 * width)

    def _forces(self, target: pygame.Surface, camera: Camera, marks: list[Mark]) -> None:
        """A stroke through every contact, along its force, both ways (it acts on both bodies)."""
        scene = self.run.scene
        many = len(marks) > 200
        for mark in marks:
            force = math.hypot(mark.fx, mark.fy)
            x, y = camera.pixels(np.array([(mark.x, mark.y)]))[0]
            if not (camera.area.collidepoint(x, y) and force > 0):
                continue
            length = min(scene.force_px * FINE * math.sqrt(force / scene.force), 400.0 * FINE)
            dx, dy = length * mark.fx / force, -length * mark.fy / force
            width = FINE if many else FINE + 1
            pygame.draw.line(target, FORCE, (x - dx, y - dy), (x + dx, y + dy), width)
            if length > 9 * FINE and not many:
                for sign in (1, -1):
                    _arrow_head(
                        target, (x + sign * dx, y + sign * dy), (sign * dx / length, sign * dy / length)
                    )
            pygame.draw.circle(target, CONTACT, (x, y), FINE * (1.2 if many else 3))

    def _lens(self, target: pygame.Surface, marks: list[Mark]) -> None:
        """The scene again, magnified, the overlaps filled."""
        lens = self.run.scene.lens
        assert lens is not None and self.lens is not None
        x, y = lens.center()
        camera = self.lens = self.lens._replace(x=x, y=y)
        half = lens.width * camera.area.height / camera.area.width / 2
        seen = self.camera.pixels(np.array([(x - lens.width / 2, y + half)]))[0]
        side = lens.width * self.camera.scale
        frame = pygame.Rect(round(seen[0]), round(seen[1]), round(side), round(side * half * 2 / lens.width))
        least = 8 * FINE - frame.width
        frame = frame.inflate(max(0, least), max(0, least))
        pygame.draw.rect(target, INK, frame, FINE)
        target.set_clip(camera.area)
        target.fill(PAPER)
        self._scene(target, camera)
        for a, b in dict.fromkeys((mark.body_a, mark.body_b) for mark in marks):
            self._overlaps(target, camera, a, b)
        self._forces(target, camera, marks)
        target.set_clip(None)
        pygame.draw.rect(target, INK, camera.area.inflate(2 * FINE, 2 * FINE), FINE, 3 * FINE)

    def _overlaps(self, target: pygame.Surface, camera: Camera, a: object, b: object) -> None:
        box = _view_box(camera)
        one, other = (
            [placed_polygon(p.outline, p.body) for p in self.run.parts if p.body is body and not p.face]
            for body in (a, b)
        )
        for p in one:
            for q in other:
                common = p.intersection(box).intersection(q)
                for piece in getattr(common, "geoms", [common]):
                    if piece.geom_type == "Polygon" and not piece.is_empty:
                        pixels = camera.pixels(np.asarray(piece.exterior.coords))
                        pygame.draw.polygon(target, CONTACT, pixels)
                        pygame.draw.lines(target, CONTACT, True, pixels, FINE)

    # --- what stands beside it, drawn at final size so that letters stay sharp ---

    def _header(self) -> None:
        run, scene = self.run, self.run.scene
        law = " (energy law)" if scene.attach.get("law") == "energy" else ""
        engine = f"area contact{law}" if run.engine == "area" else "Chipmunk's own response"
        self._text(scene.title, (24, 12), 22, INK)
        how = f"As Chipmunk runs it: {scene.chipmunk}."
        self._text(scene.shows if run.engine == "area" else how, (24, 37), 14, tint(INK, 0.75))
        bodies = f"{run.bodies} bodies" if run.bodies != 1 else "1 moving body"
        pace = "" if scene.slowdown < 1.2 else f", {scene.slowdown:.3g} times slowed"
        told = f"{engine}  ·  {bodies}  ·  t = {run.time:.3f} s{pace}"
        self._text(told, (SIZE[0] - 24, 14), 14, tint(INK, 0.85), right=True)

    def _legend(self) -> None:
        """The scale bar, a round length near a tenth of the picture's width, and a force of a round number."""
        scene = self.run.scene
        right, y = SIZE[0] - 24, 45
        force = _round(scene.force)
        half = scene.force_px * math.sqrt(force / scene.force)
        pygame.draw.line(self.surface, FORCE, (right - 2 * half, y), (right, y), 2)
        pygame.draw.circle(self.surface, CONTACT, (right - half, y), 3)
        text = f"contact force {self._quantity(force, 'N')} (length: its root)"
        left = self._text(text, (right - 2 * half - 8, y - 7), 13, INK, right=True)
        self._bar(self.camera, left - 24, y, 80, right=True)
        if self.lens is not None:
            area = self.lens.area
            self._bar(self.lens, area.x // FINE + 10, area.bottom // FINE - 11, 50)

    def _bar(self, camera: Camera, x: float, y: float, most: float, right: bool = False) -> None:
        length = _round(most / (camera.scale / FINE))
        width = length * camera.scale / FINE
        text = self._quantity(length, self.run.scene.unit)
        if right:
            x = self._text(text, (x, y - 7), 13, INK, right=True) - 6 - width
        else:
            patch = pygame.Rect(x - 5, y - 9, width + 14 + _words(text, 13, INK).get_width(), 18)
            pygame.draw.rect(self.surface, PAPER, patch, border_radius=3)
            self._text(text, (x + width + 6, y - 7), 13, INK)
        pygame.draw.line(self.surface, INK, (x, y), (x + width, y), 2)
        for end in (x, x + width):
            pygame.draw.line(self.surface, INK, (end, y - 4), (end, y + 4), 2)

    def _frame_times(self) -> None:
        """The last frames' times as bars, against the time that they simulate."""
        run = self.run
        top, bottom = SIZE[1] - STRIP + 10, SIZE[1] - 12
        left, right = 24, SIZE[0] - 250
        budget = run.scene.frame * 1e3
        pygame.draw.rect(self.surface, tint(STATIC, 0.22), (0, SIZE[1] - STRIP, SIZE[0], STRIP))
        pixels = (bottom - top) / 2 / budget  # real time is half way up
        bar = (right - left) / HISTORY
        for i, ms in enumerate(run.frame_ms[-HISTORY:]):
            height = max(1.0, min(ms * pixels, bottom - top))
            color = tint(UNDER if ms <= budget else OVER, 0.75)
            pygame.draw.rect(
                self.surface, color, (left + i * bar, bottom - height, max(1.0, bar - 0.6), height)
            )
        y = bottom - budget * pixels
        for x in range(left, right, 8):
            pygame.draw.line(self.surface, INK, (x, y), (x + 3, y))
        pygame.draw.line(self.surface, FAINT, (left, bottom), (right, bottom))
        self._text(f"real time {budget:.3g} ms", (right + 8, y - 8), 13, INK)
        if run.frame_ms:
            recent = float(np.median(run.frame_ms[-HISTORY:]))
            self._text(f"{recent:.3g} ms a frame (median)", (right + 8, y - 30), 13, tint(INK, 0.85))
            taken = _taken(run.frame_steps[-1], run.engine)
            self._text(taken, (right + 8, y + 14), 13, tint(INK, 0.85))

    def _text(
        self, text: str, at: tuple[float, float], size: int, color: Color, *, right: bool = False
    ) -> float:
        """Write; returns the x of the text's other end."""
        image = _words(text, size, color)
        x = round(at[0] - (image.get_width() if right else 0))
        self.surface.blit(image, (x, round(at[1])))
        return x if right else x + image.get_width()

    @staticmethod
    def _quantity(value: float, unit: str) -> str:
        """A round number with a unit that needs few digits."""
        for factor, prefix in ((1e3, "k"), (1.0, ""), (1e-3, "m"), (1e-6, "µ")):
            if value >= factor * 0.999:
                return f"{value / factor:.3g} {prefix}{unit}"
        return f"{value:.2g} {unit}"


def _taken(count: int, engine: str) -> str:
    """What a frame took: substeps of area contact, whole steps of Chipmunk."""
    return f"{count} {'substep' if engine == 'area' else 'step'}{'' if count == 1 else 's'} a frame"


@cache
def _font(size: int) -> pygame.font.Font:
    return pygame.font.Font(None, size)


@lru_cache(maxsize=256)
def _words(text: str, size: int, color: Color) -> pygame.Surface:
    """Text, made large and averaged down: the font's own hinting spaces small letters unevenly."""
    large = _font(4 * size).render(text, True, color)
    return pygame.transform.smoothscale(large, (round(large.get_width() / 4), round(large.get_height() / 4)))


def _round(value: float) -> float:
    """The nearest of 1, 2, 5 times a power of ten, below."""
    power = 10.0 ** math.floor(math.log10(value))
    return next(step * power for step in (5, 2, 1) if step * power <= value * 1.0001)


def _view_box(camera: Camera) -> shapely.Polygon:
    x0, y0 = camera.world(camera.area.topleft)
    x1, y1 = camera.world(camera.area.bottomright)
    return shapely.box(x0, y1, x1, y0)


def _arrow_head(target: pygame.Surface, tip: tuple[float, float], along: tuple[float, float]) -> None:
    (x, y), (dx, dy) = tip, along
    back, half = 6 * FINE, 2.6 * FINE
    base = x - back * dx, y - back * dy
    end = x + 2 * dx, y + 2 * dy
    left = base[0] - half * dy, base[1] + half * dx
    right = base[0] + half * dy, base[1] - half * dx
    pygame.draw.polygon(target, FORCE, [end, left, right])
