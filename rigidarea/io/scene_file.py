"""Scenes as text: bodies, outlines, joints and materials in a JSON or TOML file.

```toml
rigidarea = 1                      # the format
gravity = [0, -9.81]

[contact]                          # what `rigidarea.attach` is given; left out: its defaults
penetration = 1e-4

[materials.steel]
density = 7800                     # mass/length^2
friction = 0.5
elasticity = 0.1

[outlines.bracket]
points = [[0, 0], [4, 0], [4, 1], [1, 1], [1, 4], [0, 4]]
holes = [[[0.3, 0.3], [0.7, 0.3], [0.7, 0.7], [0.3, 0.7]]]

[[bodies]]
name = "part"
position = [0, 5]
shapes = [{ outline = "bracket", material = "steel" }]

[[bodies]]
name = "floor"
type = "static"
shapes = [{ segment = [[-20, 0], [20, 0]], radius = 0.1, friction = 0.8 }]

[[joints]]
type = "pivot"
a = "part"
b = "floor"
anchor_a = [0, 0]
anchor_b = [0, 5]
```

A shape is one of `outline` (a name, or points and holes in place), `circle` (a radius, with `offset`), `box` (width,
height), `poly` (points; their convex hull), `segment` (two ends); the last three take a `radius`. A point of an outline
may be `[x, y, bulge]`: from it to the next runs an arc that turns by 4 atan(bulge). A body's mass comes
from its shapes' densities unless it has `mass` and `moment`. Nothing in a file names another file, and nothing is run.
"""

from __future__ import annotations

import os
from typing import Any

from .limits import LIMITS, Limits, allowed, file_of, read, text
from .scene_reader import Reader, Scene
from .texts import parse_json, parse_toml


def load_scene(source: str | os.PathLike[str], limits: Limits = LIMITS) -> Scene:
    """The scene of the file at the path `source`: .toml is TOML, everything else JSON.

    Raises ValueError, with the place in the file, what was expected and what came, for anything else, and for more
    than `limits` allow; OSError for a file that cannot be read.
    """
    data = read(source, limits)
    kind = "toml" if file_of(source).suffix.lower() == ".toml" else "json"
    return scene_from_text(text(data, str(source)), kind, limits)


def scene_from_text(content: str, kind: str = "json", limits: Limits = LIMITS) -> Scene:
    """The scene of a text of the kind "json" or "toml".

    Raises ValueError, with the place in it, what was expected and what came, for anything else, and for more than
    `limits` allow.
    """
    if not isinstance(content, str):
        raise ValueError(f"content must be a str, got {type(content).__name__}")
    allowed(limits)
    if kind == "json":
        return Reader(limits).scene(parse_json(content, "scene", limits.depth, limits))
    if kind != "toml":
        raise ValueError(f"kind must be 'json' or 'toml', got {kind!r:.80}")
    found = parse_toml(content, "scene", limits)
    _check_depth(found, limits)
    return Reader(limits).scene(found)


def _check_depth(found: Any, limits: Limits) -> None:
    """Dotted keys make tables too. Without recursion: what is too deep is what would break it."""
    todo = [(found, 1)]
    while todo:
        part, depth = todo.pop()
        if depth > limits.depth:
            raise ValueError(f"scene: expected at most {limits.depth} lists and tables within each other")
        inner = part.values() if isinstance(part, dict) else part if isinstance(part, list) else ()
        todo += [(item, depth + 1) for item in inner if isinstance(item, dict | list)]
