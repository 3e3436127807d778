"""The gearbox's teeth beside quadratic triangles (T6, scikit-fem), fine on the teeth that count, coarse beyond them.

How far the loaded wheel lags behind at the teeth's real stiffness: the oracle is the wheel's equilibrium under its
torque, hubs held by their mean, by ``statics`` (Newton on Gauss points) on T6 condensed to the faces, not by the
stepper. Ours: the compliant level's stepper, so slow that nothing swings.
"""

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
from rigidarea.flexible.boundary import build
from rigidarea.flexible.integrate import Simulation
from rigidarea.flexible.mesh import resample, triangulate
from rigidarea.flexible.modes import hub_rows
from rigidarea.flexible.statics import hub_fixed, solve

COARSE = 1e-3  # m, away from the teeth that count
K = 2e11  # N/m², near the teeth's own stiffness
TORQUE = gb.DAMPER * gb.SPEED * gb.IDEAL  # N m, on the wheel
BASE = gb.PITCHES[1] * np.cos(gb.ANGLE)
SLOW = 100  # times slower than the case, under the same torque: the teeth then pass in 0.4 s, swings decay in 0.3 ms
ANGLES = (
    0.0,
    0.2,
    0.375,
    0.5625,
    0.6125,
)  # of the pinion, in pitches: no tooth touches by the edge of its tip


class Quadratic(NamedTuple):
    """A gear of T6 elements: its curve by length, nodes (n, 2) of that ring and where they are on it (n,), which of
    them are near, their degrees of freedom, and the stiffness with the hub held, its size and factors."""

    points: np.ndarray
    total: np.ndarray
    nodes: np.ndarray
    along: np.ndarray
    near: np.ndarray
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
    along = np.stack([s, 0.5 * (s + np.append(s[1:], total[-1]))], 1).ravel()
    return Quadratic(points, total, nodes, along, near, dof, system.shape[0], spl.splu(system))


def land(points):
    """Which points are on the tip of the tooth in the direction of x."""
    tip = gb.PITCHES[0] + gb.ADDENDUM * gb.MODULE
    return (np.hypot(*points.T) > tip - 1e-5) & (np.abs(np.arctan2(*points.T[::-1])) < 0.1)


@pytest.mark.slow
def test_a_tooth_pushed_at_its_tip():
    """Compliance of a pinion's tooth under even shear on its tip, hub held: the default at 0.6 mm beside T6 of 0.15 mm.

    The load is spread over the tip's land on both sides, so that no indentation of a single node is in either.
    """
    pinion, _ = gb.outlines()
    values = {}
    for fine in (3e-4, 1.5e-4):
        gear = quadratic(pinion, gb.TEETH[0], fine, 1.5)
        nodes = gear.nodes[gear.near]
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
    for name, keys in (("default", {}), ("one side", dict(sides=1, growth=0.2))):
        body, _ = elastic_body(pinion.rings, 6e-4, gb.STEEL, "compliant", hub=1, **keys)
        b = hub_fixed(body.boundary, body.hub)
        at = np.flatnonzero(land(b.points + 0.0))
        at = at[np.argsort(b.points[at, 1])]
        long = np.hypot(*np.diff(b.points[at], axis=0).T)
        load = np.zeros(len(b.flexibility))
        load[2 * at + 1] = 0.5 * (np.append(long, 0.0) + np.append(0.0, long)) / long.sum()
        found[name] = float(load @ b.flexibility @ load) / exact
    print("T3, 0.6 mm, over T6 of 0.15 mm:", found)
    assert found["one side"] == pytest.approx(1.0, abs=0.06)
    assert found["default"] == pytest.approx(1.0, abs=0.02)


def boundary(gear, parts=4, points=4):
    """What ``statics`` asks of a gear: its curve, ``points`` on each of ``parts`` a side, where the displacement is
    that of the side's three nodes, by their quadratic shape functions; loads go to them by the same."""
    c = np.hstack([gear.response(part) for part in np.array_split(np.eye(len(gear.dof)), 40, 1)])
    sides, number = len(gear.nodes) // 2, np.cumsum(gear.near) - 1
    ends = np.append(gear.along[2::2], gear.total[-1])
    three = 2 * np.arange(sides)[:, None] + np.arange(3)
    three[-1, 2] = 0
    near = gear.near[three].all(1)
    # the parts' nodes: of near sides, and one that does not move for all others
    t = np.arange(parts) / parts
    shape = np.stack([(1 - t) * (1 - 2 * t), 4 * t * (1 - t), t * (2 * t - 1)], 1)
    place = np.full(sides * parts, near.sum() * parts)
    on = np.repeat(near, parts)
    place[on] = np.arange(on.sum())
    rows = np.repeat(place[on], 3)
    columns = number[np.repeat(three[near], parts, axis=0)].ravel()
    values = np.tile(shape, (near.sum(), 1)).ravel()
    q = sp.coo_array((values, (rows, columns)), shape=(near.sum() * parts, gear.near.sum()))
    q = sp.kron(q, sp.eye_array(2)).tocsr()
    f = on.sum() + 1
    flexibility = np.zeros((2 * f + 3, 2 * f + 3))
    flexibility[: 2 * f - 2, : 2 * f - 2] = q @ (q @ (0.5 * (c + c.T))).T
    corners = gear.along[::2]
    fine = (corners[:, None] + (ends - corners)[:, None] * t).ravel()
    after = np.append(fine[1:], gear.total[-1])
    s = fine[:, None] + (after - fine)[:, None] * np.arange(points) / points
    share = np.tile(np.arange(points) / points, len(fine))
    low, high = np.repeat(place, points), np.repeat(np.roll(place, -1), points)
    return build([on_ring(gear.points, gear.total, s.ravel())], (low, high, share), None, flexibility)


def at_rest(pinion, wheel, angles):
    """Turn of the wheel beyond the ideal one, as a length on the line of action, in equilibrium at pinion angles."""
    found = []
    x = 4e-6
    for phi in angles:
        start = np.pi + np.pi / gb.TEETH[1] - phi * gb.IDEAL

        def off(x, phi=phi, start=start):
            pose = (gb.CENTRES, 0.0, start + x / BASE)
            moment = solve(pinion, (0.0, 0.0, phi), wheel, pose, K, tolerance=1e-5, limit=200).moment
            return (-moment - TORQUE) / BASE

        x0, x1 = x, 1.02 * x
        f0, f1 = off(x0), off(x1)
        while abs(f1) > 1e-4 * TORQUE / BASE:
            x0, f0, x1 = x1, f1, x1 - f1 * (x1 - x0) / (f1 - f0)
            f1 = off(x1)
        x = x1
        found.append(x)
    return np.array(found)


def slowly(**keys):
    """The same from the compliant level's stepper, over the third pitch."""
    (a, _), (b, _) = gb.bodies("compliant", 0.6, refine=20, damper=SLOW * gb.DAMPER, **keys)
    a.drive = (0.0, gb.SPEED / SLOW, 0.02)
    start = b.angle
    r = Simulation([a, b], k=K, margin=5e-5, rho=gb.RHO).run(3 * SLOW * gb.MESHING, 4e-4)
    error = (r.hub[:, 1] - start + r.hub[:, 0] * gb.IDEAL) * BASE
    third = r.t > 1.9 * SLOW * gb.MESHING
    pitch = 2 * np.pi / gb.TEETH[0]
    phase = np.mod(r.hub[third, 0], pitch)
    order = np.argsort(phase)
    return np.interp(pitch * np.array(ANGLES), phase[order], error[third][order], period=pitch)


@pytest.mark.slow
def test_how_far_a_loaded_wheel_lags_behind():
    """Within 1 % of the oracle at every angle, at 0.6 mm; the oracle's own meshes differ by a fifth of that.

    Where a tooth touches by the edge of its tip (0.7 to 0.75 of a pitch) the oracle does not converge: under a load on
    a corner finite elements yield the more the finer they are. So nothing is said of the peak there.
    """
    found = {}
    angles = 2 * np.pi / gb.TEETH[0] * np.array(ANGLES)
    for fine, parts in ((4e-4, 4), (2e-4, 2)):
        # the wheel stands turned round by half a pitch: one of its gaps is where the pinion's tooth is
        gears = [
            boundary(quadratic(o, z, fine, 1.6), parts) for o, z in zip(gb.outlines(), gb.TEETH, strict=True)
        ]
        found[fine] = at_rest(*gears, angles)
    exact = found[2e-4]
    print("T6, um:", {f: np.round(1e6 * v, 4) for f, v in found.items()})
    assert found[4e-4] == pytest.approx(exact, rel=2e-3)
    for sides in (1, 2):
        ours = slowly(sides=sides)
        print(f"0.6 mm, sides {sides}, um:", np.round(1e6 * ours, 4), "over T6:", np.round(ours / exact, 4))
        assert ours == pytest.approx(exact, rel=0.01)
