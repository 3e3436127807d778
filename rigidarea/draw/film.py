"""Pictures on disk: a still as PNG, a film as MP4, or as GIF where no encoder is installed."""

from __future__ import annotations

import importlib.util
from pathlib import Path
from types import TracebackType
from typing import Any

import pygame

from ..report import check_writable

FPS = 30
"""Pictures a second."""


def save_png(surface: pygame.Surface, path: Path) -> Path:
    """Write the surface as PNG, its folder made."""
    path.parent.mkdir(parents=True, exist_ok=True)
    pygame.image.save(surface, str(path))
    return path


class Film:
    """Collects pictures into `path`: .mp4, or .gif; without a suffix .mp4, or .gif where no encoder is installed.

    Raises, before there is a picture, ValueError for another suffix, OSError where the file cannot be written, and
    ModuleNotFoundError without imageio, or for .mp4 without imageio-ffmpeg.
    """

    def __init__(self, path: Path) -> None:
        suffix = path.suffix.lower()
        if suffix not in ("", ".mp4", ".gif"):
            raise ValueError(f"a film must end in .mp4 or .gif, or have no suffix, got {str(path)!r}")
        import imageio.v2 as imageio

        encodes = importlib.util.find_spec("imageio_ffmpeg") is not None
        if suffix == ".mp4" and not encodes:
            raise ModuleNotFoundError("a film as .mp4 needs imageio-ffmpeg", name="imageio_ffmpeg")
        self.mp4 = suffix == ".mp4" or (encodes and not suffix)
        self.path = path if suffix else path.with_suffix(".mp4" if self.mp4 else ".gif")
        check_writable(self.path)
        self._count = 0
        self._writer: Any
        if self.mp4:
            self._writer = imageio.get_writer(
                self.path,
                fps=FPS,
                codec="libx264",
                macro_block_size=8,
                ffmpeg_params=["-crf", "23", "-preset", "veryfast"],
                ffmpeg_log_level="error",
            )
        else:
            self._writer = imageio.get_writer(self.path, mode="I", duration=3000 / FPS, loop=0)

    def add(self, surface: pygame.Surface) -> None:
        """Append one picture (of a GIF every third, at half size)."""
        self._count += 1
        if not self.mp4:
            if self._count % 3 != 1:
                return
            surface = pygame.transform.smoothscale_by(surface, 0.5)
        self._writer.append_data(pygame.surfarray.array3d(surface).swapaxes(0, 1))

    def __enter__(self) -> Film:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._writer.close()
