"""Files and command lines that nobody should write, drawn at random: damaged, too deep, of the wrong kind."""

from __future__ import annotations

import copy
import json
import random
from typing import Any

_VALUES: list[Any] = [
    *(0, -1, 1, 0.5, 1e308, -1e308, 1e-308, 2**63, 10**400, "", "x", "NaN", None, True, [], {}, [1], [1, 2]),
    *(
        [1, 2, 3],
        [[0, 0], [1, 0], [0, 1]],
        [[0, 0], [1, 1], [1, 0], [0, 1]],
        [[]],
        {"a": 1},
        [[1e300, 0]] * 3,
    ),
]


def _scene() -> dict[str, Any]:
    return {
        "rigidarea": 1,
        "gravity": [0, -9.81],
        "contact": {"penetration": 1e-4},
        "materials": {"steel": {"density": 7.8, "friction": 0.5, "elasticity": 0.1}},
        "outlines": {"bracket": {"points": [[0, 0], [4, 0], [4, 1], [1, 1], [1, 4], [0, 4]], "holes": []}},
        "bodies": [
            {"name": "part", "position": [0, 5], "shapes": [{"outline": "bracket", "material": "steel"}]},
            {"name": "ball", "mass": 1, "moment": 1, "shapes": [{"circle": 1, "offset": [0, 1]}]},
            {"name": "floor", "type": "static", "shapes": [{"segment": [[-20, 0], [20, 0]], "radius": 0.1}]},
        ],
        "joints": [{"type": "pivot", "a": "part", "b": "floor", "anchor_a": [0, 0], "anchor_b": [0, 5]}],
    }


def _damage(draw: random.Random, tree: Any) -> None:
    """One value somewhere in nested lists and tables is another, gone, or twice there."""
    at = tree
    while True:
        if not isinstance(at, dict | list) or not at:
            return
        key = draw.choice(list(at) if isinstance(at, dict) else range(len(at)))
        if isinstance(at[key], dict | list) and at[key] and draw.random() < 0.75:
            at = at[key]
            continue
        fate = draw.random()
        if fate < 0.15:
            del at[key]
        elif fate < 0.3 and isinstance(at, dict):
            at[draw.choice(("", "nonsense", "mass", "type"))] = copy.deepcopy(draw.choice(_VALUES))
        else:
            at[key] = copy.deepcopy(draw.choice(_VALUES))
        return


def scene_text(draw: random.Random) -> str:
    """A scene as JSON, damaged once to three times; now and then cut off."""
    tree = _scene()
    for _ in range(draw.randint(1, 3)):
        _damage(draw, tree)
    text = json.dumps(tree)
    return text[: draw.randrange(len(text))] if draw.random() < 0.1 else text


def map_text(draw: random.Random) -> str:
    """GeoJSON, damaged."""
    ring = [[0, 0], [4, 0], [4, 4], [0, 4], [0, 0]]
    tree = {
        "type": "FeatureCollection",
        "features": [
            {"type": "Feature", "properties": {}, "geometry": {"type": "Polygon", "coordinates": [ring]}}
        ],
    }
    _damage(draw, tree)
    return json.dumps(tree)


def drawing(draw: random.Random) -> str:
    """An SVG of one path, some of its letters and numbers others."""
    words = "M 0 0 L 10 0 C 12 4 12 6 10 10 A 5 5 0 0 1 0 10 Q 2 5 0 0 Z".split()
    for _ in range(draw.randint(0, 3)):
        odd = ("1e308", "-1e308", "nan", "inf", "1e-308", "M", "Z", "A", "X", "", "0", "-", "1e999", "é")
        words[draw.randrange(len(words))] = draw.choice(odd)
    attributes = draw.choice(
        ("", 'transform="scale(1e200)"', 'transform="rotate(nan)"', 'fill-rule="evenodd"')
    )
    path = f'<path {attributes} d="{" ".join(words)}"/>'
    text = f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 20 20">{path}</svg>'
    return text[: draw.randrange(len(text))] if draw.random() < 0.1 else text


_WORDS = ("0", "-1", "1e999", "nan", "inf", "x", "", "1.5", "--nonsense", "/none", "é")
_LINES: list[list[str]] = [
    *(["demo", "?"], ["demo", "bowl", "--frames", "?"], ["demo", "?", "--frames", "?"]),
    *(["case", "?"], ["case", "hertz", "--mode", "?"], ["bench", "?"], ["chart", "--scene", "?"]),
    *(["atlas", "--scene", "?"], ["compare", "?"], ["run", "?"], ["run", "--frames", "?", "/none.py"]),
    *(["run", "--engine", "?", "/none.py"], ["plan", "?"], ["plan", "/none.py", "--tolerance", "?"]),
    *(["compat", "?"], ["compat", "examples", "?"], ["compat", "fuzz", "--calls", "?"]),
    *(["compat", "soak", "--steps", "?"], ["?"], [], ["--version", "?"], ["compat", "tests", "?"]),
]


def command_line(draw: random.Random) -> list[str]:
    """A command whose argument is none that it knows."""
    return [draw.choice(_WORDS) if word == "?" else word for word in draw.choice(_LINES)]
