"""Transmission error of the gearbox at the teeth's real stiffness, beside quadratic triangles: mesh and step."""

import functools
import time

import numpy as np
import pytest
import skfem
from scipy.spatial import cKDTree
from skfem.models.elasticity import linear_elasticity

from rigidarea.cases import gearbox as gb
from rigidarea.flexible import Body, Simulation
from rigidarea.flexible.boundary import build
from rigidarea.flexible.mesh import keep_area, resample, triangulate
from rigidarea.flexible.modes import Flexibility, hub_rows, rigid_modes

K = 2e11
DURATION = 0.45  # s: the last 0.05 s are 11 teeth, after the swings that the ramp leaves


@functools.cache
def quadratic(wheel: bool, size: float) -> tuple[float, float, np.ndarray, np.ndarray]:
    """A compliant gear of quadratic triangles (scikit-fem): mass, inertia, centre, flexibility of rim and hub.

    All teeth are alike: one is loaded, node by node, and its response turned to the others. Nodes of the rim are ends
    and middles of the mesh's edges.
    """
    rings, teeth = gb.outlines()[wheel].rings, gb.TEETH[wheel]
    mat = gb.STEEL
    mesh = triangulate([resample(r, size) for r in rings])
    oracle = skfem.MeshTri(mesh.points.T.copy(), mesh.triangles.T.copy())
    basis = skfem.Basis(oracle, skfem.ElementVector(skfem.ElementTriP2()))
    mu, lam = mat.young / 2 / (1 + mat.poisson), mat.young * mat.poisson / (1 - mat.poisson**2)
    k = skfem.asm(linear_elasticity(lam, mu), basis) * mat.thickness
    scalar = skfem.Basis(oracle, skfem.ElementTriP2())
    m = skfem.asm(skfem.BilinearForm(lambda u, v, w: u * v), scalar).diagonal()
    m *= mesh.areas().sum() * mat.density * mat.thickness / m.sum()  # lumped as the diagonal is
    points = np.vstack([oracle.p.T, oracle.p[:, oracle.facets].mean(1).T])
    mass = np.concatenate([m[scalar.nodal_dofs[0]], m[scalar.facet_dofs[0]]])
    order = np.column_stack([np.hstack([basis.nodal_dofs, basis.facet_dofs])[i] for i in range(2)]).ravel()
    k = k.tocsr()[order][:, order].tocsc()
    find = cKDTree(points)

    def ring(i: int) -> np.ndarray:
        """Nodes round a ring, ends and middles of its edges."""
        p = mesh.points[mesh.rings[i]]
        both = np.stack([p, 0.5 * (p + np.roll(p, -1, 0))], 1).reshape(-1, 2)
        off, at = find.query(both)
        assert off.max() < 1e-12
        return at

    nodes, bore = ring(0), ring(1)
    rigid, centre, inertia = rigid_modes(points, mass)
    i = int(np.argmin(points[:, 0]))
    away = points - points[i]
    j = int(np.argmax((away**2).sum(1)))
    held = np.array([2 * i, 2 * i + 1, 2 * j + int(abs(away[j, 0]) > abs(away[j, 1]))])
    response = Flexibility(k, mass, rigid, held)
    f = len(nodes)
    one = f // teeth
    assert one * teeth == f
    pick = (2 * nodes[:, None] + np.arange(2)).ravel()
    hub = hub_rows(points, bore)
    loads = np.zeros((len(order), 2 * one))
    loads[pick[: 2 * one], np.arange(2 * one)] = 1.0
    c = np.zeros((2 * f + 3, 2 * f + 3))
    first = np.hstack([response(loads[:, n : n + 32])[pick] for n in range(0, 2 * one, 32)])
    for t in range(teeth):
        a = 2 * np.pi * t / teeth
        turn = np.array([[np.cos(a), -np.sin(a)], [np.sin(a), np.cos(a)]])
        moved = np.roll(first.reshape(f, 2, one, 2), t * one, 0)
        block = np.einsum("ab,nbmc,dc->namd", turn, moved, turn)
        c[: 2 * f, 2 * t * one : 2 * (t + 1) * one] = block.reshape(2 * f, -1)
    away_hub = response(hub)
    c[: 2 * f, 2 * f :] = away_hub[pick]
    c[2 * f :, : 2 * f] = away_hub[pick].T
    c[2 * f :, 2 * f :] = hub.T @ away_hub
    c = 0.5 * (c + c.T)
    return float(mass.sum()), inertia, centre, c


def gear(wheel: bool, size: float, profile: float, **keys) -> Body:
    """The gear with contact points ``profile`` apart, carried by all nodes of the rim."""
    mass, inertia, centre, c = quadratic(wheel, size)
    half = round(0.5 * size / profile)  # points a half edge
    fine = keep_area(resample(gb.outlines()[wheel].rings[0], size, 2 * half)) - centre
    node, f = np.arange(len(fine)) // half, len(c) // 2 - 1
    assert node[-1] == f - 1
    boundary = build([fine], (node, (node + 1) % f, (np.arange(len(fine)) % half) / half), None, c)
    return Body(boundary, mass, inertia, young=gb.STEEL.young, **keys)


def reference(size: float, profile: float = 7.5e-5) -> Simulation:
    """The case's gearbox of quadratic triangles."""
    a = gear(False, size, profile, anchor=(0.0, 0.0), drive=(0.0, gb.SPEED, gb.RAMP))
    at = (gb.CENTRES, 0.0)
    angle = np.pi + np.pi / gb.TEETH[1]
    b = gear(True, size, profile, anchor=at, position=at, angle=angle, damper=gb.DAMPER)
    return Simulation([a, b], k=K, margin=5e-5, rho=gb.RHO, depth_limit=0.25 * gb.MODULE)


def error(sim: Simulation, h: float) -> tuple[float, float]:
    """Transmission error, peak to peak (µm), of the last 0.05 s; processor seconds a simulated second."""
    start = time.process_time()
    r = sim.run(DURATION, h)
    seconds = (time.process_time() - start) / DURATION
    return gb.measure(r)["transmission_error_settled_um"], seconds


@pytest.mark.slow
def test_transmission_error_beside_quadratic_triangles():
    """Reference: converged to 0.5 % in mesh, profile and step. Ours at 0.45 mm, 10 µs: within 1 % of it."""
    found = {}
    for name, sim, h in (
        ("reference, 0.6 mm, 10 µs", reference(6e-4), 1e-5),
        ("reference, 0.9 mm, 10 µs", reference(9e-4), 1e-5),
        ("reference, 0.6 mm, profile 50 µm, 10 µs", reference(6e-4, 5e-5), 1e-5),
        ("reference, 0.6 mm, 5 µs", reference(6e-4), 5e-6),
        ("compliant, 0.6 mm, 10 µs", gb.simulation("compliant", 0.6, k=K, refine=8), 1e-5),
        ("compliant, 0.45 mm, 10 µs", gb.simulation("compliant", 0.45, k=K, refine=6), 1e-5),
        ("compliant, 0.45 mm, 15 µs", gb.simulation("compliant", 0.45, k=K, refine=6), 1.5e-5),
        ("modal, 0.45 mm, 10 µs", gb.simulation("modal", 0.45, k=K, refine=6), 1e-5),
    ):
        found[name] = error(sim, h)[0]
        print(f"{name}: {found[name]:.4f} µm", flush=True)
    exact = found["reference, 0.6 mm, 5 µs"]
    coarse = found["reference, 0.6 mm, 10 µs"]
    for other in ("reference, 0.9 mm, 10 µs", "reference, 0.6 mm, profile 50 µm, 10 µs"):
        assert found[other] == pytest.approx(coarse, rel=0.01)
    assert coarse == pytest.approx(exact, rel=0.005)
    assert found["compliant, 0.45 mm, 10 µs"] == pytest.approx(exact, rel=0.01)
