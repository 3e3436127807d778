"""Outlines and spaces as SVG and HTML: what a notebook shows of them.

Arcs are SVG's own arcs. y is drawn upwards, unless the space's gravity pulls towards greater y.
"""

from __future__ import annotations

import html
from collections.abc import Iterable, Sequence

import numpy as np

from .arcs import Points

#: Of a picture (pixels): its longer side.
SIZE = 360
FILL, EDGE, STATIC = "#9cc9e8", "#2d323a", "#b0b5bc"


def path_data(rings: Sequence[Points], arcs: Sequence[Points]) -> str:
    """The `d` of a path: every ring closed, its arcs as arcs. arcs: as `Outline.arcs`."""
    words = []
    for i, ring in enumerate(rings):
        radii = arcs[i][:, 2] if arcs else np.zeros(len(ring))
        words.append(f"M{ring[0, 0]:.9g},{ring[0, 1]:.9g}")
        for (x, y), radius in zip(np.roll(ring, -1, axis=0).tolist(), radii.tolist()):
            if radius:  # no arc sweeps more than half a turn; counter-clockwise is SVG's 1 where y is as the outline's
                words.append(f"A{abs(radius):.9g},{abs(radius):.9g} 0 0 {int(radius > 0)} {x:.9g},{y:.9g}")
            else:
                words.append(f"L{x:.9g},{y:.9g}")
        words.append("Z")
    return "".join(words)


def svg(paths: Iterable[tuple[str, str, str]], bounds: Sequence[float], down: bool = False) -> str:
    """A drawing of paths, (d, transform, colour) each, whatever is within bounds (xmin, ymin, xmax, ymax)."""
    xmin, ymin, xmax, ymax = bounds
    longest = max(xmax - xmin, ymax - ymin) or 1.0
    room = 0.03 * longest
    width, height = xmax - xmin + 2 * room, ymax - ymin + 2 * room
    scale = SIZE / max(width, height)
    top = ymin - room if down else -ymax - room
    drawn = "".join(
        f'<path d="{d}" transform="{transform}" fill="{colour}" fill-rule="evenodd"/>'
        for d, transform, colour in paths
    )
    flip = "" if down else ' transform="scale(1,-1)"'
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width * scale:.5g}" height="{height * scale:.5g}" '
        f'viewBox="{xmin - room:.9g} {top:.9g} {width:.9g} {height:.9g}">'
        f'<g{flip} stroke="{EDGE}" stroke-width="1" vector-effect="non-scaling-stroke">'
        f"<style>path{{vector-effect:non-scaling-stroke}}</style>{drawn}</g></svg>"
    )


def figure(picture: str, words: str) -> str:
    """A picture with a line of text under it, as HTML."""
    return f"<figure>{picture}<figcaption>{html.escape(words)}</figcaption></figure>"
