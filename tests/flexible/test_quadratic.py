"""The gearbox's teeth beside quadratic triangles (T6, scikit-fem), fine on the teeth that count, coarse beyond them."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import pytest
import scipy.sparse as sp
import scipy.sparse.linalg as spl
import skfem
from skfem.models.elasticity import linear_elasticity

from rigidarea.cases import gearbox as gb
from rigidarea.flexible.body import elastic_body
from rigidarea.flexible.mesh import resample, triangulate
from rigidarea.flexible.modes import hub_rows
from rigidarea.flexible.statics import hub_fixed

COARSE = 1e-3  # m, away from the teeth that count


class Quadratic(NamedTuple):
    """A gear of T6 elements: the near nodes (n, 2) of its outer ring, their degrees of freedom, and the stiffness with
    the hub held, its size and factors."""

    nodes: np.ndarray
    dof: np.ndarray
    size: int
    solved: Any

    def response(self, load):
        """Displacements of the near nodes under loads (dof, m) on them."""
        full = np.zeros((self.size, load.shape[1]))
        full[self.dof] = load
        return self.solved.solve(full)[self.dof]


def on_ring(points, total, s):
    closed = np.vstack([points, points[:1]])
    return np.column_stack([np.interp(s, total, closed[:, i]) for i in range(2)])


def halved(points):
    """Nodes of quadratic sides: ends and middles, in turn."""
    return np.stack([points, 0.5 * (points + np.roll(points, -1, 0))], 1).reshape(-1, 2)


def quadratic(outline, teeth, fine, pitches):
    """A gear whose teeth within ``pitches`` of the direction of x have sides of ``fine`` (length)."""
    window = pitches * 2 * np.pi / teeth
    points = outline.rings[0]
    points = np.roll(
        points, -int(np.abs(np.arctan2(points[:, 1], -points[:, 0])).argmin()), axis=0
    )  # from behind
    total = np.concatenate([[0.0], np.cumsum(np.hypot(*(np.roll(points, -1, 0) - points).T))])
    parts = []
    for size in (fine, COARSE):
        nodes = resample(points, size)
        s = np.array([total[np.hypot(*(points - p).T).argmin()] for p in nodes])
        parts.append(s[(np.abs(np.arctan2(*nodes.T[::-1])) < window) == (size == fine)])
    s = np.unique(np.concatenate(parts))
    ring, bore = on_ring(points, total, s), resample(outline.rings[1], 1.5e-3)
    mesh = triangulate([ring, bore], growth=0.25)
    steel = gb.STEEL
    basis = skfem.Basis(
        skfem.MeshTri(mesh.points.T.copy(), mesh.triangles.T.copy()),
        skfem.ElementVector(skfem.ElementTriP2()),
    )
    mu = steel.young / (2 * (1 + steel.poisson))
    lam = steel.young * steel.poisson / (1 - steel.poisson**2)  # plane stress
    k = steel.thickness * skfem.asm(linear_elasticity(lam, mu), basis)
    at = basis.doflocs[:, ::2].T
    assert (at == basis.doflocs[:, 1::2].T).all()  # x and y of a node are beside each other
    where = {tuple(p): i for i, p in enumerate((np.round(at, 11) + 0.0).tolist())}

    def numbers(nodes):
        return np.array([where[tuple(p)] for p in (np.round(nodes, 11) + 0.0).tolist()])

    hub = sp.csr_array(hub_rows(at, numbers(halved(bore))))
    system = sp.csc_array(sp.bmat([[k, hub], [hub.T, None]]))
    nodes = halved(ring)
    near = np.abs(np.arctan2(*nodes.T[::-1])) < window
    dof = (2 * numbers(nodes[near])[:, None] + np.arange(2)).ravel()
    print(f"T6, {1e3 * fine:g} mm on the teeth: {len(at)} nodes")
    return Quadratic(nodes[near], dof, system.shape[0], spl.splu(system))


def land(points):
    """Which points are on the tip of the tooth in the direction of x."""
    tip = gb.PITCHES[0] + gb.ADDENDUM * gb.MODULE
    return (np.hypot(*points.T) > tip - 1e-5) & (np.abs(np.arctan2(*points.T[::-1])) < 0.1)


@pytest.mark.slow
def test_a_tooth_pushed_at_its_tip():
    """Compliance of a pinion's tooth under even shear on its tip, hub held: 0.6 mm beside T6 of 0.15 mm."""
    pinion, _ = gb.outlines()
    values = {}
    for fine in (3e-4, 1.5e-4):
        gear = quadratic(pinion, gb.TEETH[0], fine, 1.5)
        nodes = gear.nodes
        at = np.flatnonzero(land(nodes))
        at = at[np.argsort(nodes[at, 1])]
        assert len(at) % 2 == 1  # whole sides
        sides = np.hypot(*(nodes[at[2::2]] - nodes[at[:-2:2]]).T)
        load = np.zeros((len(gear.dof), 1))
        for side, (a, m, b) in zip(sides, zip(at[:-2:2], at[1::2], at[2::2], strict=True), strict=True):
            load[2 * np.array([a, m, b]) + 1, 0] += side * np.array([1, 4, 1]) / 6
        load /= load.sum()
        values[fine] = float((load * gear.response(load)).sum())
    exact = values[1.5e-4]
    print("T6:", values)
    assert values[3e-4] == pytest.approx(exact, rel=5e-3)  # a quarter of what is allowed below
    found = {}
    for sides in (1, 2):
        body, _ = elastic_body(pinion.rings, 6e-4, gb.STEEL, "compliant", hub=1, sides=sides)
        b = hub_fixed(body.boundary, body.hub)
        at = np.flatnonzero(land(b.points + 0.0))
        at = at[np.argsort(b.points[at, 1])]
        long = np.hypot(*np.diff(b.points[at], axis=0).T)
        load = np.zeros(len(b.flexibility))
        load[2 * at + 1] = 0.5 * (np.append(long, 0.0) + np.append(0.0, long)) / long.sum()
        found[sides] = float(load @ b.flexibility @ load) / exact
    print("T3, 0.6 mm, over T6 of 0.15 mm, by sides:", found)
    assert found[1] == pytest.approx(1.0, abs=0.06)
    assert found[2] == pytest.approx(1.0, abs=0.02)
