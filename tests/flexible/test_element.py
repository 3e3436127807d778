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
