"""The paper's own Alg. 3, for the cases that verify it; see ``nodal`` for what the product does."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def literal(arc: Array, other: Array, q: float) -> tuple[Array, Array, Array, Array]:
    """Eq. 8–11 for one body: the nodes of ``arc`` inside the other body, its two end points the crossings.

    arc (n + 2, 2): crossing, nodes inside, crossing, in the order of the body's perimeter; other (m, 2): the other
    body's arc between the same crossings. A node whose normal misses that arc (one on a side wall; the paper leaves
    this case open) gets distance 0, so no force. Returns normals (n, 2) towards the other perimeter, distances (n,),
    tributary lengths (n,), and the weights A_trib d^q (n,) of Eq. 13.
    """
    tangent = arc[2:] - arc[:-2]
    normal = np.column_stack([-tangent[:, 1], tangent[:, 0]]) / np.hypot(*tangent.T)[:, None]  # Eq. 8
    step = np.hypot(*np.diff(arc, axis=0).T)
    tributary = 0.5 * (step[1:] + step[:-1])  # Eq. 11
    p = arc[1:-1]
    r, s = other[:-1], np.diff(other, axis=0)
    cross = normal[:, None, 0] * s[None, :, 1] - normal[:, None, 1] * s[None, :, 0]
    rel = r[None] - p[:, None]
    with np.errstate(divide="ignore", invalid="ignore"):
        along = (rel[..., 0] * s[None, :, 1] - rel[..., 1] * s[None, :, 0]) / cross
        on = (rel[..., 0] * normal[:, None, 1] - rel[..., 1] * normal[:, None, 0]) / cross
    along = np.where((on >= -1e-12) & (on <= 1 + 1e-12), along, np.inf)
    pick = np.abs(along).argmin(1)
    distance = along[np.arange(len(p)), pick]  # Eq. 9; its sign turns the normal to the other perimeter
    distance = np.where(np.isfinite(distance), distance, 0.0)
    normal = normal * np.where(distance < 0, -1.0, 1.0)[:, None]
    distance = np.abs(distance)
    return normal, distance, tributary, tributary * distance**q


def literal_alpha(normal: Array, weight: Array, nodes: Array, centroid: Array, force: Array) -> float:
    """α of Eq. 22: least squares over force and moment about the centroid, ``force`` (2,) the global force."""
    f = weight[:, None] * normal
    arm = nodes - centroid
    b = np.array([f[:, 0].sum(), f[:, 1].sum(), (arm[:, 0] * f[:, 1] - arm[:, 1] * f[:, 0]).sum()])
    return float(b[:2] @ force / (b @ b))
