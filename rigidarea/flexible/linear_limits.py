"""Where linear finite elements in a floating frame end, and what a run says when it went there."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

# over the body's size: rotations within it of about as many radians; strains err by their squares
DEFLECTION = 0.05
SPIN = 0.1  # over the first elastic frequency: stiffness then changes by about the square, 1 %


ACROSS = 0.5  # of a mesh's area, in triangles between boundary nodes alone: one across a beam is up to 30 % too stiff


class MeshWarning(UserWarning):
    """A mesh is too coarse for its body to bend as it should."""


def watch_mesh(mesh: Any) -> None:
    """Warns (MeshWarning) of a ``mesh.Mesh`` most of whose triangles reach from one side of the body to the other."""
    nodes = np.concatenate(mesh.rings)
    areas = mesh.areas()
    across = float(areas[np.isin(mesh.triangles, nodes).all(axis=1)].sum() / areas.sum())
    if across > ACROSS:
        rings = [mesh.points[ring] for ring in mesh.rings]
        length = sum(float(np.hypot(*(np.roll(p, -1, 0) - p).T).sum()) for p in rings)
        warnings.warn(
            f"{100 * across:.0f} % of a mesh has one triangle across the body, which bends by up to a third too little:"
            f" expected two at least, a mesh size of at most about {areas.sum() / length:.3g}",
            MeshWarning,
            stacklevel=4,
        )


class LinearityWarning(UserWarning):
    """A flexible body has left what linear elasticity in its frame describes."""


def watch(bodies: Sequence[Any], size: Array, deflection: Array, spin: Array) -> None:
    """Warns (LinearityWarning) of each body whose deflection or spin was too much for a linear model.

    bodies: ``integrate.Body``; size (b,): their largest radii; deflection (b,): the largest of their boundaries, by
    contact loads and modes; spin (b,): the largest angular velocity of their frames. Stress stiffening is in the modal
    level (``frame``) and in the compliant one (``tension``); a body that was made without it is told of.
    """
    for i, b in enumerate(bodies):
        if b.young == 0.0:
            continue
        told = []
        part = float(deflection[i] / size[i])
        if part > DEFLECTION:
            told.append(
                f"body {i} deflected by {part:.3g} of its size: strains are linear in the displacements, expected at"
                f" most {DEFLECTION:g}"
            )
        stiffened = (b.geometric is not None and len(b.geometric) > 0) or len(b.boundary.tension) > 0
        if b.slowest > 0.0 and not stiffened and spin[i] > SPIN * b.slowest:
            told.append(
                f"body {i} spun at {spin[i]:.4g} rad/time, {spin[i] / b.slowest:.3g} of its first elastic frequency:"
                f" what tension does to its stiffness is left out, expected at most {SPIN:g}; elastic_body has it"
            )
        for text in told:
            warnings.warn(text, LinearityWarning, stacklevel=3)
