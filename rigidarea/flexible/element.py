"""Linear triangles (T3), their strains smoothed over edges: stiffness, lumped mass, stress.

O. C. Zienkiewicz, R. L. Taylor, The Finite Element Method, vol. 1, 5th ed., chapter 4. Degrees of freedom are
interleaved: 2 i and 2 i + 1 are the x and y displacement of node i.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from rigidarea.flexible.mesh import Array, Mesh
from rigidarea.geometry.gate import finite, positive


@dataclass(frozen=True)
class Material:
    """Linear elastic, isotropic.

    young: E, pressure. poisson: ν, -1 < ν < 1/2. density: ρ, mass/volume. thickness: t, length.
    plane: "stress" or "strain". Raises ValueError outside these ranges.
    """

    young: float
    poisson: float
    density: float
    thickness: float = 1.0
    plane: str = "stress"

    def __post_init__(self) -> None:
        if not -1.0 < finite(self.poisson, "poisson") < 0.5:
            raise ValueError(f"poisson, Poisson's ratio, must lie in (-1, 0.5), got {self.poisson}")
        for name in ("young", "density", "thickness"):
            positive(getattr(self, name), name)
        if not isinstance(self.plane, str) or self.plane not in ("stress", "strain"):
            raise ValueError(f"plane must be 'stress' or 'strain', got {self.plane!r}")

    def elasticity(self) -> Array:
        """The 3×3 matrix D of σ = D ε, ε = (ε_xx, ε_yy, γ_xy)."""
        e, v = self.young, self.poisson
        if self.plane == "strain":  # the plane-stress form with E/(1-ν²), ν/(1-ν)
            e, v = e / (1 - v * v), v / (1 - v)
        return e / (1 - v * v) * np.array([[1.0, v, 0.0], [v, 1.0, 0.0], [0.0, 0.0, 0.5 * (1 - v)]])


def strain_displacement(mesh: Mesh) -> tuple[Array, Array]:
    """B (m, 3, 6) with ε = B u_e, and the triangles' areas (m,)."""
    p = mesh.points[mesh.triangles]
    area = mesh.areas()
    b = np.zeros((len(p), 3, 6))
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        dy = (p[:, j, 1] - p[:, k, 1]) / (2 * area)
        dx = (p[:, k, 0] - p[:, j, 0]) / (2 * area)
        b[:, 0, 2 * i] = b[:, 2, 2 * i + 1] = dy
        b[:, 1, 2 * i + 1] = b[:, 2, 2 * i] = dx
    return b, area


def _dofs(mesh: Mesh) -> NDArray[np.int64]:
    return (2 * mesh.triangles[:, :, None] + np.arange(2)).reshape(-1, 6)


def smoothing(mesh: Mesh) -> tuple[sp.csr_array, Array, NDArray[np.intp]]:
    """Strains averaged over edges: operator (3 e, 2 n), areas (e,) of the edges' domains, edges (m, 3) of triangles.

    The domain of an edge is a third of each triangle beside it, its strain their mean weighted by area.
    """
    b, area = strain_displacement(mesh)
    m, tri = len(mesh.triangles), mesh.triangles
    ends = np.sort(np.vstack([tri[:, [i, (i + 1) % 3]] for i in range(3)]), axis=1)
    unique, edge = np.unique(ends, axis=0, return_inverse=True)
    edge, owner = edge.reshape(-1), np.tile(np.arange(m), 3)
    domain = np.bincount(edge, area[owner] / 3, len(unique))
    values = (area[owner] / 3 / domain[edge])[:, None, None] * b[owner]
    rows = np.broadcast_to(3 * edge[:, None, None] + np.arange(3)[:, None], values.shape)
    columns = np.broadcast_to(_dofs(mesh)[owner][:, None, :], values.shape)
    shape = (3 * len(unique), 2 * len(mesh.points))
    operator = sp.coo_array((values.ravel(), (rows.ravel(), columns.ravel())), shape=shape).tocsr()
    return operator, np.asarray(domain, float), np.ascontiguousarray(edge.reshape(3, m).T)


def stiffness(mesh: Mesh, material: Material, smooth: bool = True) -> sp.csc_array:
    """Stiffness K, sparse (2 n, 2 n), force/length: the sum of t A Bᵀ D B.

    smooth: strains averaged over edges (ES-FEM-T3: G. R. Liu, T. Nguyen-Thoi, K. Y. Lam, J. Sound Vib. 320, 2009,
    doi:10.1016/j.jsv.2008.08.027), which takes most of the triangle's excess stiffness without a node more, so the
    mass stays lumped and positive; else one strain a triangle (CST).
    """
    if smooth:
        operator, area, _ = smoothing(mesh)
        elasticity = sp.kron(sp.diags_array(area * material.thickness), material.elasticity())
        return (operator.T @ elasticity.tocsr() @ operator).tocsc()
    b, area = strain_displacement(mesh)
    ke = np.einsum("eki,kl,elj,e->eij", b, material.elasticity(), b, area * material.thickness, optimize=True)
    dof = _dofs(mesh)
    rows, cols = np.repeat(dof, 6, axis=1).ravel(), np.tile(dof, (1, 6)).ravel()
    n = 2 * len(mesh.points)
    return sp.coo_array((ke.ravel(), (rows, cols)), shape=(n, n)).tocsc()


def geometric_stiffness(mesh: Mesh, material: Material, sigma: Array) -> sp.csc_array:
    """Stiffness of the stress ``sigma`` (m, 3), sparse (2 n, 2 n): the sum of t A ∇N_i · σ ∇N_j, alike for x and y.

    O. C. Zienkiewicz, R. L. Taylor, The Finite Element Method, vol. 2, 5th ed., chapter 10 (initial stress matrix).
    """
    b, area = strain_displacement(mesh)
    gradient = np.stack([b[:, 0, 0::2], b[:, 1, 1::2]], 1)  # (m, 2, 3)
    tensor = sigma[:, [0, 2, 2, 1]].reshape(-1, 2, 2)
    part = np.einsum("eai,eab,ebj,e->eij", gradient, tensor, gradient, area * material.thickness)
    n, tri = len(mesh.points), mesh.triangles
    rows, cols = np.repeat(tri, 3, axis=1).ravel(), np.tile(tri, (1, 3)).ravel()
    return sp.kron(sp.coo_array((part.ravel(), (rows, cols)), shape=(n, n)), sp.eye_array(2)).tocsc()


def lumped_mass(mesh: Mesh, material: Material) -> Array:
    """Nodal masses (n,): each triangle gives ρ t A / 3 to its nodes."""
    share = np.repeat(mesh.areas() * material.density * material.thickness / 3.0, 3)
    return np.asarray(np.bincount(mesh.triangles.ravel(), share, len(mesh.points)), float)


def stress(mesh: Mesh, material: Material, u: Array, smooth: bool = True) -> Array:
    """Stress (m, 3) = (σ_xx, σ_yy, τ_xy) of each triangle under nodal displacements ``u`` (n, 2).

    smooth: the mean of its three edges' strains, see ``stiffness``.
    """
    if smooth:
        operator, _, edges = smoothing(mesh)
        strain = (operator @ u.reshape(-1)).reshape(-1, 3)[edges].mean(1)
        return strain @ material.elasticity()
    b, _ = strain_displacement(mesh)
    return np.einsum("kl,elj,ej->ek", material.elasticity(), b, u.reshape(-1)[_dofs(mesh)])


def von_mises(material: Material, sigma: Array) -> Array:
    """Von Mises stress (m,) of in-plane stresses ``sigma`` (m, 3), with that across the plane in plane strain."""
    x, y, xy = sigma.T
    z = material.poisson * (x + y) if material.plane == "strain" else np.zeros_like(x)
    return np.sqrt(0.5 * ((x - y) ** 2 + (y - z) ** 2 + (z - x) ** 2) + 3 * xy**2)
