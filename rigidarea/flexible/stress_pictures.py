"""Pictures of recovered states: von Mises stress, contact pressure along a face, deformed shape (needs matplotlib)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rigidarea.flexible.recover import Shape, State

Array = NDArray[np.float64]

MAP = "cividis"  # one hue's way from dark to light, the same to colour-blind readers


def draw_stress(
    ax: Any, states: Sequence[State], *, length: float = 1.0, stress: float = 1.0, magnification: float = 1.0,
    top: float | None = None,
) -> Any:  # fmt: skip
    """Draws von Mises stress on the deformed triangles of ``states``; returns the mappable for a colour bar.

    length, stress: factors to the units drawn (1e3: mm from m; 1e-6: MPa from Pa). top: end of the scale, in those
    units, default the largest stress drawn.
    """
    values = [stress * s.shape.von_mises(s.displacement) for s in states]
    top = max(float(v.max()) for v in values) if top is None else top
    mappable = None
    for state, value in zip(states, values, strict=True):
        x, y = length * state.placed(magnification).T
        mappable = ax.tripcolor(
            x, y, state.shape.mesh.triangles, facecolors=value, cmap=MAP, vmin=0.0, vmax=top, edgecolors="none"
        )  # fmt: skip
    ax.set_aspect("equal")
    return mappable


def draw_deformed(
    ax: Any, states: Sequence[State], magnification: float, colours: Sequence[str], *, length: float = 1.0
) -> None:
    """Draws outlines as they were (thin, grey) and deformed ``magnification`` times over."""
    for state, colour in zip(states, colours, strict=True):
        for scale, style in (
            (0.0, {"color": "#999999", "lw": 0.8}),
            (magnification, {"color": colour, "lw": 1.4}),
        ):
            at = length * state.placed(scale)
            for ring in state.shape.mesh.rings:
                closed = np.append(ring, ring[0])
                ax.plot(*at[closed].T, **style)
    ax.set_aspect("equal")


def pressure(shape: Shape, loads: Array) -> tuple[Array, Array]:
    """Contact pressure along the contact rings: positions (f, 2), mesh coordinates, and normal pressure (f,).

    loads (l, 3): as ``Shape.displacement`` takes them. A node's normal force over its share of the ring and the
    thickness.
    """
    mesh = shape.mesh
    nodes = np.concatenate(shape.loaded)
    force = np.zeros((len(nodes), 2))
    np.add.at(force, loads[:, 0].astype(int), loads[:, 1:])
    out, start = np.zeros(len(nodes)), 0
    for on in shape.loaded:
        ring = mesh.points[on]
        step = np.roll(ring, -1, 0) - np.roll(ring, 1, 0)
        span = np.hypot(*step.T)
        inwards = np.column_stack([-step[:, 1], step[:, 0]]) / span[:, None]
        edge = np.hypot(*(np.roll(ring, -1, 0) - ring).T)
        share = 0.5 * (edge + np.roll(edge, 1)) * shape.material.thickness
        part = slice(start, start + len(ring))
        out[part] = np.einsum("ij,ij->i", force[part], inwards) / share
        start += len(ring)
    return mesh.points[nodes], out


def draw_pressure(
    ax: Any, shape: Shape, loads: Array, label: str, colour: str, style: str = "o-", *, length: float = 1.0,
    stress: float = 1.0,
) -> None:  # fmt: skip
    """Draws contact pressure over the way along the ring, from the middle of the nodes that carry most of it."""
    at, p = pressure(shape, loads)
    if not len(loads) or p.max() <= 0.0:
        return
    most, start = int(np.argmax(p)), 0
    for n in map(len, shape.loaded):  # the ring of the largest
        if most < start + n:
            break
        start += n
    ring = slice(start, start + n)
    turn = n // 2 - (most - start)
    at, p = np.roll(at[ring], turn, 0), np.roll(p[ring], turn)
    way = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(at, axis=0).T))])
    carry = np.flatnonzero(p > 0.0)
    # one contact: the run of loaded nodes about the largest
    low = high = n // 2
    while low > 0 and p[low - 1] > 0.0:
        low -= 1
    while high < n - 1 and p[high + 1] > 0.0:
        high += 1
    low, high = max(low - 1, 0), min(high + 1, n - 1)
    keep = slice(low, high + 1)
    middle = (
        float(way[carry] @ p[carry] / p[carry].sum()) if len(carry) < high - low + 2 else float(way[n // 2])
    )
    ax.plot(length * (way[keep] - middle), stress * p[keep], style, color=colour, ms=4, label=label)
