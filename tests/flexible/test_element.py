"""CST against scikit-fem, and against uniform strain."""

import numpy as np
import pytest
import skfem
from skfem.models.elasticity import linear_elasticity

from rigidarea.flexible.element import Material, lumped_mass, stiffness, stress
from rigidarea.flexible.mesh import triangulate

SQUARE = np.array([[0, 0], [0.5, 0], [1, 0], [1, 0.5], [1, 1], [0.5, 1], [0, 1], [0, 0.5]], float)
HOLE = np.array([[0.4, 0.4], [0.4, 0.6], [0.6, 0.6], [0.6, 0.4]], float)


@pytest.mark.parametrize("plane", ["stress", "strain"])
def test_stiffness_equals_scikit_fem(plane):
    mesh = triangulate([SQUARE, HOLE])
    mat = Material(200.0, 0.3, 5.0, 0.25, plane)
    oracle = skfem.MeshTri(mesh.points.T.copy(), mesh.triangles.T.copy())
    basis = skfem.Basis(oracle, skfem.ElementVector(skfem.ElementTriP1()))
    mu = mat.young / (2 * (1 + mat.poisson))
    lam = (
        mat.young
        * mat.poisson
        / ((1 - mat.poisson**2) if plane == "stress" else (1 + mat.poisson) * (1 - 2 * mat.poisson))
    )
    k = skfem.asm(linear_elasticity(lam, mu), basis) * mat.thickness
    # scikit-fem may number vertices its own way
    order = np.array([np.argmin(np.hypot(*(oracle.p.T - p).T)) for p in mesh.points])
    dof = basis.nodal_dofs[:, order].T.ravel()
    ours = stiffness(mesh, mat, smooth=False).toarray()
    assert np.abs(k.toarray()[np.ix_(dof, dof)] - ours).max() < 1e-12 * np.abs(ours).max()


def test_uniform_strain_and_rigid_motion():
    mesh = triangulate([SQUARE, HOLE])
    mat = Material(200.0, 0.3, 5.0)
    x, y = mesh.points.T
    k = stiffness(mesh, mat)
    for rigid in (np.array([0 * x + 1, 0 * x]), np.array([0 * x, 0 * x + 1]), np.array([-y, x])):
        assert np.abs(k @ rigid.T.ravel()).max() < 1e-12 * abs(k).max()
    s = stress(mesh, mat, np.column_stack([1e-3 * x, -0.3e-3 * y]))  # uniaxial: σ_xx = E ε
    assert np.allclose(s, [0.2, 0, 0], atol=1e-14)
    assert lumped_mass(mesh, mat).sum() == pytest.approx(5.0 * 0.96, rel=1e-13)


@pytest.mark.parametrize("bad", [dict(poisson=0.5), dict(poisson=-1.0), dict(young=0.0), dict(plane="shell")])
def test_bad_material(bad):
    with pytest.raises(ValueError, match=next(iter(bad)) if "poisson" not in bad else "Poisson"):
        Material(**{**dict(young=1.0, poisson=0.3, density=1.0), **bad})


@pytest.mark.slow
def test_smoothed_triangles_beside_quadratic_ones():
    """First five frequencies of the gearbox's pinion at 0.6 mm against scikit-fem's quadratic triangles, which are
    converged to 0.15 %, on the same mesh and on that of ``elastic_body`` by default; the compliance of a beam five
    elements high."""
    import scipy.sparse.linalg as spl

    from rigidarea.flexible.body import elastic_body
    from rigidarea.flexible.mesh import resample
    from rigidarea.flexible.modes import elastic
    from rigidarea.shapes import involute_gear
    from rigidarea.study.convergence import bar, timoshenko_cantilever

    steel = Material(207e9, 0.29, 7800.0, 0.05)
    gear = involute_gear(2e-3, 23, bore=8e-3, tolerance=1e-7)
    mesh = triangulate([resample(r, 6e-4) for r in gear.rings])
    basis = skfem.Basis(
        skfem.MeshTri(mesh.points.T.copy(), mesh.triangles.T.copy()),
        skfem.ElementVector(skfem.ElementTriP2()),
    )
    mu, lam = steel.young / 2 / 1.29, steel.young * 0.29 / (1 - 0.29**2)
    k = skfem.asm(linear_elasticity(lam, mu), basis)
    m = skfem.asm(skfem.BilinearForm(lambda u, v, w: 7800.0 * (u[0] * v[0] + u[1] * v[1])), basis)
    square = spl.eigsh(k, k=8, M=m, sigma=-1e6, return_eigenvectors=False)
    exact = np.sqrt(np.sort(square)[3:])
    found = elastic(mesh, steel).modes(5)[1]
    rough = elastic(mesh, steel, smooth=False).modes(5)[1]
    print(100 * (found / exact - 1), 100 * (rough / exact - 1))
    assert np.abs(found / exact - 1).max() < 0.005
    _, finer = elastic_body(gear.rings, 6e-4, steel, hub=1)
    by_default = elastic(finer, steel).modes(5)[1]
    print(100 * (by_default / exact - 1))
    assert np.abs(by_default / exact - 1).max() < 0.005
    assert (rough / exact - 1).max() > 0.01
    beam = Material(207e9, 0.29, 7800.0, 1.0)
    first = elastic(bar(1.0, 0.05, 5), beam, clamped=1).modes(1)[1][0]
    assert first == pytest.approx(timoshenko_cantilever(1.0, 0.05, 207e9, 0.29, 7800.0)[0], rel=0.01)
