"""Reduction against dense algebra, and a broken cache. Beam theory: see ``test_cantilever``."""

import numpy as np
import pytest

from rigidarea.flexible.element import Material, lumped_mass, stiffness
from rigidarea.flexible.mesh import Mesh, triangulate
from rigidarea.flexible.modes import hub_rows, reduce, rigid_modes

STEEL = Material(207e9, 0.29, 7800.0, 0.01)


def circle(radius, n, clockwise=False):
    t = 2 * np.pi * np.arange(n) / n * (-1 if clockwise else 1)
    return np.column_stack([radius * np.cos(t), radius * np.sin(t)])


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
    assert np.array_equal(body.flexibility, body.flexibility.T)
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


@pytest.mark.parametrize(
    "broken",
    [
        lambda b: b[:1000],
        lambda b: b"",
        lambda b: b"nothing",
        lambda b: b[: len(b) // 2] + bytes([b[len(b) // 2] ^ 1]) + b[len(b) // 2 + 1 :],
    ],
    ids=["cut", "empty", "other", "one bit"],
)
def test_a_broken_cache_file_is_built_again(ring, tmp_path, broken):
    first = reduce(ring, STEEL, hub=1, modes=4, cache=tmp_path)
    (file,) = tmp_path.glob("*.npz")
    again = reduce(ring, STEEL, hub=1, modes=4, cache=tmp_path)
    assert np.array_equal(first.flexibility, again.flexibility) and again.mass == first.mass
    file.write_bytes(broken(file.read_bytes()))
    with pytest.warns(UserWarning, match="cannot be read"):
        mended = reduce(ring, STEEL, hub=1, modes=4, cache=tmp_path)
    assert np.array_equal(first.flexibility, mended.flexibility)
    reduce(ring, STEEL, hub=1, modes=4, cache=tmp_path)  # no warning: it is whole again
    reduce(ring, Material(207e9, 0.29, 7800.0, 0.02), hub=1, modes=4, cache=tmp_path)
    assert len(list(tmp_path.glob("*.npz"))) == 2


def test_cache_of_an_older_layout(ring, tmp_path):
    reduce(ring, STEEL, hub=1, modes=4, cache=tmp_path)
    (file,) = tmp_path.glob("*.npz")
    np.savez(file, mass=1.0)
    with pytest.warns(UserWarning, match="cannot be read"):
        assert reduce(ring, STEEL, hub=1, modes=4, cache=tmp_path).mass > 0


def test_bad_hub(ring):
    with pytest.raises(ValueError, match="hub ring 2 has no nodes"):
        reduce(ring, STEEL, hub=2)
    empty = Mesh(ring.points, ring.triangles, (*ring.rings, np.zeros(0, np.int64)))
    with pytest.raises(ValueError, match="hub ring 2 has no nodes"):
        reduce(empty, STEEL, hub=2)
    with pytest.raises(ValueError, match="modes must be at most"):
        reduce(ring, STEEL, modes=10**6)
