"""From an outline to a body of ``integrate``: mesh, reduce, and carry a fine contact profile on the mesh's edges."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rigidarea.flexible.boundary import build
from rigidarea.flexible.check import check_elastic, held_nodes
from rigidarea.flexible.element import Material
from rigidarea.flexible.integrate import Body
from rigidarea.flexible.linear_limits import watch_mesh
from rigidarea.flexible.mesh import Array, Mesh, keep_area, resample, triangulate
from rigidarea.flexible.modes import reduce
from rigidarea.flexible.recover import Shape
from rigidarea.flexible.reduction_store import arrays
from rigidarea.geometry.gate import finite, listed, not_negative, numbers, positive
from rigidarea.geometry.outline import Outline

LEVELS = ("rigid", "compliant", "modal")
CONTACT_NODES = 8000  # the flexibility between so many nodes takes 2 GiB once all of it has been used
BOUNDARY_NODES = 40_000  # a mesh from so many has some hundred thousand nodes


def elastic_body(
    rings: Sequence[Array],
    size: float | Sequence[float],
    material: Material,
    level: str = "compliant",
    *,
    contact_rings: Sequence[int] = (0,),
    hub: int | None = None,
    clamped: int | Callable[[Array], NDArray[np.bool_]] | None = None,
    modes: int = 40,
    refine: int = 1,
    growth: float = 0.15,
    sides: int = 2,
    cache: Path | str | None = None,
    **keys: Any,
) -> tuple[Body, Mesh]:
    """A body from finely sampled ``rings`` ([0] outer, counter-clockwise; then holes, clockwise), and its mesh.

    size: spacing of the boundary nodes (length), one for all rings or one each. level: "rigid", "compliant" (static
    flexibility) or "modal" (``modes`` free-free modes and residual flexibility). contact_rings, hub, clamped: ring
    numbers; clamped may be a function that says, True or False, which of the boundary nodes (n, 2) are held: two at
    least. refine: contact points a mesh edge, finer than the mesh: their polygon has the rings' area (with 1 they are
    the mesh's nodes).
    growth: of the size inside the body. sides: of triangles between two of the boundary nodes: the mesh is finer than
    what contacts load, which costs set-up and nothing in a run (with 1 a tooth of five nodes' width is 4 % too stiff,
    with 2 1 %). keys: passed to ``Body``; ``position`` is where the origin of the rings'
    coordinates goes at angle 0, as given by the rings. Raises ValueError for bad settings, see ``resample``,
    ``triangulate`` and ``reduce``, and for a size that asks for more nodes than fit into memory.
    """
    if not isinstance(level, str) or level not in LEVELS:
        raise ValueError(f"level must be one of {LEVELS}, got {level!r}")
    counts = {"modes": modes, "refine": refine, "sides": sides}
    # the mesh below has more rings than the outline
    check_elastic(rings, material, contact_rings, {"hub": hub, "clamped": clamped}, counts)
    not_negative(growth, "growth")
    sizes = _sizes(size, len(rings))
    _check_size(rings, sizes, contact_rings if level != "rigid" else (), sides)
    nodes = [resample(r, h, sides) for r, h in zip(rings, sizes, strict=True)]

    def build_mesh() -> dict[str, NDArray]:
        made = triangulate(nodes, growth)
        return {"points": made.points, "triangles": made.triangles}

    found = arrays(
        cache, ("mesh", growth, [len(r) for r in nodes]), nodes, ("points", "triangles"), build_mesh
    )
    ends = np.cumsum([0] + [len(r) for r in nodes])
    mesh = Mesh(found["points"], found["triangles"], tuple(map(np.arange, ends[:-1], ends[1:])))
    if level != "rigid":
        watch_mesh(mesh)
    if callable(clamped):
        held = held_nodes(clamped, mesh.points[: int(ends[-1])], [mesh.rings[k] for k in contact_rings])
        mesh = Mesh(mesh.points, mesh.triangles, (*mesh.rings, held))
        clamped = len(mesh.rings) - 1
    kept, loaded = modes if level == "modal" else 0, tuple(contact_rings)
    body = reduce(mesh, material, loaded, hub, clamped, kept, level != "rigid", cache, sides=sides)
    profile, low, high, share, first = [], [], [], [], 0
    for k in contact_rings:
        fine = resample(rings[k], sizes[k], refine)
        fine = fine if refine == 1 else keep_area(fine)
        node = np.arange(len(fine)) // refine
        profile.append(fine - body.centre)
        low.append(first + node)
        high.append(first + (node + 1) % (len(fine) // refine))
        share.append((np.arange(len(fine)) % refine) / refine)
        first += len(fine) // refine
    carriers = (np.concatenate(low), np.concatenate(high), np.concatenate(share))
    soft = (body.soft, body.soft_stretch, body.tension)
    boundary = build(profile, carriers, body.modes, body.how_it_yields, body.swell, soft)
    angle = keys.pop("angle", 0.0)
    c, s = np.cos(angle), np.sin(angle)
    x, y = keys.pop("position", (0.0, 0.0))
    position = (x + c * body.centre[0] - s * body.centre[1], y + s * body.centre[0] + c * body.centre[1])
    middle = mesh.points[mesh.rings[hub]].mean(0) - body.centre if hub is not None else np.zeros(2)
    return Body(
        boundary, body.mass, body.inertia, position, angle, body.frequency, body.coupling, body.stretch,
        fixed=clamped is not None, hub=(float(middle[0]), float(middle[1])),
        young=material.young if level != "rigid" else 0.0, geometric=body.geometric, slowest=body.slowest,
        shape=Shape(mesh, material, loaded, hub, clamped, body, sides) if level != "rigid" else None, **keys,
    ), mesh  # fmt: skip


def outline_body(
    outline: Outline,
    material: Material,
    level: str,
    mesh: float | Sequence[float] | None,
    *,
    contact: Sequence[int] = (0,),
    hub: int | None = None,
    clamp: int | Callable[[Array], NDArray[np.bool_]] | None = None,
    modes: int = 40,
    refine: int = 4,
    growth: float = 0.15,
    sides: int = 2,
    damping: float = 0.0,
    at: tuple[float, float] = (0.0, 0.0),
    angle: float = 0.0,
    cache: Path | str | None = None,
) -> Body:
    """``elastic_body`` of an outline, its origin at ``at``; a rigid body has neither mesh, hub nor clamp.

    Raises ValueError where it has, where a body that yields has no ``mesh`` (length), and as ``elastic_body`` does.
    """
    if not isinstance(outline, Outline):
        raise ValueError(f"outline must be an Outline, got {type(outline).__name__}")
    if not isinstance(level, str) or level not in LEVELS:
        raise ValueError(f"level must be one of {LEVELS}, got {level!r}")
    check_elastic(outline.polygon_rings, material, contact, {}, {"modes": modes, "refine": refine})
    (x, y), angle = numbers(at, "at", 2), finite(angle, "angle")
    at, damping = (x, y), not_negative(damping, "damping")
    if level != "rigid":
        if mesh is None:
            raise ValueError(
                f"mesh, the spacing of the boundary nodes, is needed at level {level!r}, got None"
            )
        made, _ = elastic_body(
            outline.polygon_rings, mesh, material, level, contact_rings=contact, hub=hub, clamped=clamp, modes=modes,
            refine=refine, growth=growth, sides=sides, cache=cache, position=at, angle=angle, damping=damping,
        )  # fmt: skip
        return made
    if clamp is not None or hub is not None:
        raise ValueError(
            f"a rigid body has no mesh: expected neither clamp nor hub, got {clamp!r} and {hub!r}"
        )
    centre = np.array(outline.centroid)
    c, s = np.cos(angle), np.sin(angle)
    x, y = np.array(at) + np.array([[c, -s], [s, c]]) @ centre
    mass = material.density * material.thickness * outline.area
    inertia = outline.moment(mass, (-centre[0], -centre[1]))
    boundary = build([outline.polygon_rings[i] - centre for i in contact])
    return Body(boundary, mass, inertia, (float(x), float(y)), angle)


def _sizes(size: float | Sequence[float], rings: int) -> list[float]:
    """The mesh size of each ring."""
    if isinstance(size, int | float | np.number):
        return [positive(size, "size")] * rings
    sizes = [positive(h, f"size[{k}]") for k, h in enumerate(listed(size, "size"))]
    if len(sizes) != rings:
        raise ValueError(f"size must be one for all rings or one each, {rings}, got {len(sizes)}")
    return sizes


def _check_size(rings: Sequence[Array], sizes: Sequence[float], contact: Sequence[int], sides: int) -> None:
    """Refuses mesh sizes before it is meshed that would ask for gigabytes."""
    length = [float(np.hypot(*(np.roll(r, -1, 0) - r).T).sum()) for r in rings]
    count = [a / h for a, h in zip(length, sizes, strict=True)]
    for what, asked, most in (
        ("in contact", sum(count[k] for k in contact), CONTACT_NODES),
        ("on the boundary", sum(count) * sides, BOUNDARY_NODES),
    ):
        if asked > most:
            finest = min(sizes)
            raise ValueError(
                f"size must be at least {finest * asked / most:.4g} here, for {most} nodes {what}, got {finest:.4g}:"
                f" {asked:.4g} nodes"
            )
