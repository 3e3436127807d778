"""Reduction against dense algebra, beam theory, and a broken cache."""

import numpy as np
import pytest

from rigidarea.flexible.element import Material, lumped_mass, stiffness
from rigidarea.flexible.mesh import triangulate
from rigidarea.flexible.modes import hub_rows, reduce, rigid_modes

STEEL = Material(207e9, 0.29, 7800.0, 0.01)


def circle(radius, n, clockwise=False):
    t = 2 * np.pi * np.arange(n) / n * (-1 if clockwise else 1)
    return np.column_stack([radius * np.cos(t), radius * np.sin(t)])


def bar(length, height, n):
    """A bar meshed with squares of side height / n, as rings."""
    m = round(length / height * n)
    x, y = np.linspace(0, length, m + 1), np.linspace(0, height, n + 1)
    return np.vstack([
        np.column_stack([x, 0 * x])[:-1], np.column_stack([0 * y + length, y])[:-1],
        np.column_stack([x[::-1], 0 * x + height])[:-1], np.column_stack([0 * y, y[::-1]])[:-1],
    ])  # fmt: skip


@pytest.fixture(scope="module")
def ring():
    return triangulate([circle(0.03, 40), circle(0.012, 20, True)], growth=0.3)


@pytest.mark.parametrize("modes", [0, 12])
def test_reduction_equals_dense_algebra(ring, modes):
    body = reduce(ring, STEEL, hub=1, modes=modes)
    mass = np.repeat(lumped_mass(ring, STEEL), 2)
    k = stiffness(ring, STEEL).toarray()
    scaled = k / np.sqrt(np.outer(mass, mass))
    square, v = np.linalg.eigh(scaled)
    phi = v[:, 3:] / np.sqrt(mass)[:, None]
    pick = np.zeros((len(mass), 83))
    nodes = ring.rings[0]
    for j, i in enumerate(nodes):
        pick[2 * i, 2 * j] = pick[2 * i + 1, 2 * j + 1] = 1.0
    pick[:, 80:] = hub_rows(ring.points, ring.rings[1])
    left_out = pick.T @ phi[:, modes:]
    exact = (left_out / square[3 + modes :]) @ left_out.T
    # double eigenvalues straddling the cut would make the split ambiguous
    assert modes == 0 or square[3 + modes] > 1.001 * square[2 + modes]
    assert np.abs(body.flexibility - exact).max() < 1e-8 * np.abs(exact).max()
    assert body.frequency == pytest.approx(np.sqrt(square[3 : 3 + modes]), rel=1e-8)
    assert body.mass == pytest.approx(mass[::2].sum())
    assert np.abs(body.coupling + body.coupling.T).max() < 1e-10 if modes else True


def test_hub_is_a_mean(ring):
    w = hub_rows(ring.points, ring.rings[1])
    rigid, _, inertia = rigid_modes(ring.points, lumped_mass(ring, STEEL))
    unit = (
        rigid
        * np.array([1, 1, np.sqrt(inertia / lumped_mass(ring, STEEL).sum())])
        * np.sqrt(lumped_mass(ring, STEEL).sum())
    )
    assert w.T @ unit == pytest.approx(np.eye(3), abs=1e-4)  # ring and bore share a centre to 1e-6 m


def test_cantilever_converges():
    """Tip deflection and the first three frequencies of a slender cantilever, orders of convergence fitted.

    Reference by Richardson extrapolation of the three meshes; Timoshenko and Euler–Bernoulli bound the values.
    """
    length, height = 0.1, 0.01
    mat = Material(207e9, 0.29, 7800.0, 1.0)
    i = height**3 / 12
    euler = length**3 / (3 * mat.young * i)
    shear = 1.2 * length * 2 * (1 + mat.poisson) / (mat.young * height)
    tips, freqs = [], []
    sizes = (4, 8, 16)
    for n in sizes:
        outline = bar(length, height, n)
        mesh = triangulate([outline], growth=0.0)
        # the clamped end as a ring of its own: split the index arrays
        left = np.flatnonzero(mesh.points[: mesh.n_boundary, 0] < 1e-12)
        tip = np.flatnonzero(mesh.points[: mesh.n_boundary, 0] > length - 1e-12)
        split = type(mesh)(mesh.points, mesh.triangles, (mesh.rings[0], left))
        body = reduce(split, mat, clamped=1, modes=3)
        c = body.flexibility + (body.modes / body.frequency**2) @ body.modes.T
        load = np.zeros(len(c))
        load[2 * tip + 1] = 1.0 / len(tip)
        tips.append(load @ c @ load)
        freqs.append(body.frequency)
    exact = euler + shear
    error = np.abs(np.array(tips) / exact - 1)
    order = np.polyfit(np.log(1 / np.array(sizes)), np.log(error), 1)[0]
    assert 1.5 < order < 2.4  # CST: h² in energy
    assert error[-1] < 0.02
    beam = np.array([1.875104, 4.694091, 7.854757]) ** 2 * np.sqrt(
        mat.young * i / (mat.density * height * length**4)
    )
    assert freqs[-1][0] == pytest.approx(beam[0], rel=0.02)
    assert (np.diff(np.array(freqs), axis=0) < 0).all()  # from above (stiff CST), monotonically
    assert freqs[-1][1] == pytest.approx(beam[1], rel=0.05)  # shear and rotary inertia lower the higher ones


def test_cache(ring, tmp_path):
    first = reduce(ring, STEEL, hub=1, modes=4, cache=tmp_path)
    (file,) = tmp_path.glob("*.npz")
    again = reduce(ring, STEEL, hub=1, modes=4, cache=tmp_path)
    assert np.array_equal(first.flexibility, again.flexibility) and again.mass == first.mass
    file.write_bytes(file.read_bytes()[:1000])
    with pytest.warns(UserWarning, match="cannot be read"):
        mended = reduce(ring, STEEL, hub=1, modes=4, cache=tmp_path)
    assert np.array_equal(first.flexibility, mended.flexibility)
    reduce(ring, Material(207e9, 0.29, 7800.0, 0.02), hub=1, modes=4, cache=tmp_path)
    assert len(list(tmp_path.glob("*.npz"))) == 2


def test_bad_hub(ring):
    with pytest.raises(ValueError, match="hub ring 2 has no nodes"):
        reduce(ring, STEEL, hub=2)
