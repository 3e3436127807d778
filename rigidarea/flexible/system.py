"""What the stepper works on: a system of bodies as arrays, its settings, its state, and scratch."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from rigidarea.flexible.boundary import Boundary, Work

Array = NDArray[np.float64]
Ints = NDArray[np.int64]

REGIONS_KEPT = 4  # contact regions of a pair that a record holds


class System(NamedTuple):
    """A list of bodies as arrays (b bodies, m modes in all); see ``Body``."""

    mass: Array
    inertia: Array
    fixed: Ints
    hub: Array
    pinned: Ints
    anchor: Array
    driven: Ints
    drive: Array
    damper: Array
    torque: Array
    gravity: Array
    first: Ints  # (b + 1,) where each body's modes begin
    square: Array  # (m,) ω²
    viscous: Array  # (m,) 2 ζ ω
    stretch: Array  # (m,)
    size: Array  # (b,) largest radius of each boundary
    amplitude: Array  # (m,) largest displacement of the boundary in each mode


class Elastic(NamedTuple):
    """How one body yields, and under what: views of its ``Boundary`` and ``Work``, all that a step needs of them."""

    modes: Array
    flexibility: Array
    node_load: Array
    node_flag: NDArray[np.bool_]
    loaded: Ints
    hub_load: Array
    mobility: Array


def elastic(b: Boundary, w: Work) -> Elastic:
    """The part of a body that deforms."""
    return Elastic(b.modes, b.flexibility, w.node_load, w.node_flag, w.loaded, w.hub_load, w.mobility)


class Settings(NamedTuple):
    """Contact and scheme: k, q (or reach, for STS), sts, spread loads, search margin, and generalised-α constants."""

    k: float
    q: float
    sts: bool
    spread: bool
    margin: float
    rho: float


class State(NamedTuple):
    """x, v, acceleration, auxiliary acceleration (b, 3) and the same of the modes (m,); multipliers (b, 3)."""

    x: Array
    v: Array
    acc: Array
    aux: Array
    q: Array
    dq: Array
    ddq: Array
    auxq: Array
    mu: Array


class Buffers(NamedTuple):
    """Scratch of the stepper."""

    pose: Array  # (b, 4)
    searched: Array  # (b, 4) poses of the last search
    matrix: Array
    rhs: Array
    load: Array  # (b, 3) generalised contact forces
    tangent: Array  # (6 b, 6 b) of the contacts: frames, then hub loads (x, y, moment)
    row: Array  # (6 b,)
    force: Array  # (2,)
    regions: Array  # (REGIONS_KEPT, 5)
    modal_residual: Array
    column: Ints  # (3 b,) unknown of each hub's constraint force or moment, -1 if there is none
    counts: Ints  # [0] candidate pairs, [1] evaluation stamp, [2] regions
    springs: Array  # (REGIONS_KEPT b, 24) of the regions: bodies, middles, direction, stiffness, force, row
    bend: Array  # (2,) largest displacement of the boundaries under a contact, and of any in the last search
    apart: Array  # (1,) largest difference of a region's k A from the force that it hands on (``condense``)
