"""`attach(space)`: a pymunk space whose contacts are area contacts, until `detach()`."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal, TypedDict

import pymunk
from pymunk._chipmunk_cffi import ffi, lib

from ..geometry.gate import fraction, not_negative, one_of, positive
from .area_contact import DIRECTIONS, LAWS, AreaContact
from .space import KEY

if TYPE_CHECKING:
    from ..flexible import Assembly

INTEGRATIONS = ("implicit", "explicit")
#: Penetration that `attach` allows, as a fraction of a body's smallest extent, where it chooses the stiffness. A
#: tower of about (0.65 / this)^(1/3) boxes stands: 14.
PENETRATION = 2e-4


class Settings(TypedDict, total=False):
    """What `attach` takes besides the space."""

    stiffness: float | None
    penetration: float
    law: Literal["area", "energy"]
    length: float | None
    direction: Literal["chord", "nodal"]
    exponent: float
    rest_speed: float | None
    integration: Literal["implicit", "explicit"]
    flexible: Assembly | None


def attach(
    space: pymunk.Space,
    stiffness: float | None = None,
    *,
    penetration: float = PENETRATION,
    law: Literal["area", "energy"] = "area",
    length: float | None = None,
    direction: Literal["chord", "nodal"] = "chord",
    exponent: float = 1.0,
    rest_speed: float | None = None,
    integration: Literal["implicit", "explicit"] = "implicit",
    flexible: Assembly | None = None,
) -> AreaContact:
    """Replace the collision response of `space` by area contact; `AreaContact.detach` undoes it.

    stiffness: k of F = k A (force/length^2), for every pair. None: each pair's own, such that no body sinks deeper
        than `penetration` (a fraction of its smallest extent) under its own weight, under n times that by sqrt(n)
        as deep, 20 times at the most.
    law: "area" (F = k A at the centroid, Eq. 5 and 7), or "energy" (F = k A L / length along the gradient of
        k A^2 / (2 length), conservative between any two outlines; length None: the largest body's size).
    direction: "chord" (exact and independent of the sampling), or "nodal" (Eq. 8-15, weights depth^exponent).
    rest_speed: first touch slower than this (length/time) rests instead of bouncing. None: by what presses.
    integration: "implicit": a frame is a few substeps, in which all contacts and joints are solved together;
        stable at any stiffness and any step. "explicit": a step is one of symplectic Euler with F = k A at the
        step's place, stable up to w h = 2 (in a stack 1), joints after it; for verification.
    flexible: bodies of the space that yield, a `rigidarea.flexible.Assembly`; None: all are rigid.

    Restitution, friction and surface velocity are pymunk's: of a pair the product of the shapes' `elasticity` and of
    their `friction`, callbacks' overrides included. `space.iterations` is the number of sweeps a substep.

    Raises ValueError for settings out of range, for shapes without area, and for a space that is attached already;
    RuntimeError within a step; LayoutError where Chipmunk's memory is not as this version of pymunk has it.
    """
    if not isinstance(space, pymunk.Space):
        raise ValueError(f"space must be a pymunk.Space, got {type(space).__name__}")
    if space._locked:
        raise RuntimeError("attach() within a step: call it after the step")
    settings = {
        "stiffness": None if stiffness is None else positive(stiffness, "stiffness"),
        "penetration": fraction(penetration, "penetration"),
        "law": one_of(law, "law", LAWS),
        "length": None if length is None else positive(length, "length"),
        "direction": one_of(direction, "direction", DIRECTIONS),
        "exponent": not_negative(exponent, "exponent"),
        "rest_speed": None if rest_speed is None else not_negative(rest_speed, "rest_speed"),
        "integration": one_of(integration, "integration", INTEGRATIONS),
        "flexible": flexible,
    }
    if flexible is not None and not all(hasattr(flexible, name) for name in ("enter", "leave", "step")):
        raise ValueError(f"flexible must be a rigidarea.flexible.Assembly, got {type(flexible).__name__}")
    if attached(space) is not None:
        raise ValueError("this space is attached already; use attached(space), or detach() it first")
    if lib.cpSpaceGetUserData(space._space) != ffi.NULL:
        raise ValueError("expected a space whose user data is free; something else has taken it")
    return AreaContact(space, settings)


def attached(space: pymunk.Space) -> AreaContact | None:
    """The area contact of a space, None if it has none. Of a copied or unpickled space too.

    Raises ValueError for what is no space.
    """
    if not isinstance(space, pymunk.Space):
        raise ValueError(f"space must be a pymunk.Space, got {type(space).__name__}")
    contact: AreaContact | None = space.__dict__.get(KEY)
    return contact
