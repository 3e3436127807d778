"""Flexibility between boundary nodes by paths of the factor, whole and block by block."""

import numpy as np
import pytest
import scipy.sparse as sp

from rigidarea.cases import gearbox as gb
from rigidarea.flexible import modes
from rigidarea.flexible.blocks import WIDE, sparse, whole
from rigidarea.flexible.body import elastic_body
from rigidarea.flexible.boundary import complete
from rigidarea.flexible.element import Material, lumped_mass, stiffness
from rigidarea.flexible.factor import factorise
from rigidarea.flexible.integrate import Simulation
from rigidarea.flexible.mesh import triangulate
from rigidarea.flexible.modes import elastic, hub_rows

MATERIAL = Material(2e9, 0.3, 1200.0, 0.01)


def circle(r, n, clockwise=False):
    t = np.linspace(0, 2 * np.pi, n, endpoint=False) * (-1 if clockwise else 1)
    return r * np.column_stack([np.cos(t), np.sin(t)])


@pytest.mark.parametrize("clamped", [None, 1])
@pytest.mark.parametrize("kept", [0, 6])
def test_blocks_are_what_whole_solutions_give(clamped, kept):
    """Against the response of all nodes to each load, and a dense inverse for the clamped body."""
    mesh = triangulate([circle(0.03, 90), circle(0.012, 20, True)], growth=0.3)
    n = 2 * len(mesh.points)
    pick = (2 * mesh.rings[0][:, None] + np.arange(2)).ravel()
    rows = np.zeros((n, len(pick) + 3))
    rows[pick, np.arange(len(pick))] = 1.0
    rows[:, -3:] = hub_rows(mesh.points, mesh.rings[1])
    response = elastic(mesh, MATERIAL, clamped)
    phi, omega = response.modes(6)
    phi, omega = phi[:, :kept], omega[:kept]
    exact = rows.T @ response(rows) - (rows.T @ phi / omega**2) @ (phi.T @ rows)
    pieces = response.between(sp.csc_array(rows), phi, omega)
    assert len(pieces.start) - 1 == 4  # 180 rows in 64, 64 and 52, and the hub
    assert len(pieces.path) < 3 * n  # a part of the rows each
    found = whole(pieces)
    assert np.array_equal(found, found.T)
    assert np.abs(found - exact).max() < 1e-11 * np.abs(exact).max()
    if clamped is not None and kept == 0:
        free = np.setdiff1d(np.arange(n), (2 * mesh.rings[1][:, None] + np.arange(2)).ravel())
        k = stiffness(mesh, MATERIAL).toarray()[np.ix_(free, free)]
        inverse = rows[free].T @ np.linalg.solve(k, rows[free])
        assert np.abs(found - inverse).max() < 1e-10 * np.abs(inverse).max()
    c, ready = sparse(pieces)
    assert np.array_equal(c[-3:], found[-3:]) and np.array_equal(c[:, -3:], found[:, -3:])
    assert ready[-1].all() and ready[:, -1].all() and not ready[:-1, :-1].any()
    assert not c[:WIDE, :WIDE].any()


@pytest.mark.parametrize("level", ["compliant", "modal"])
def test_a_run_makes_the_blocks_it_needs_and_is_the_same(level, monkeypatch):
    """Two gears: the same run as with the flexibility whole, a part of whose blocks was ever made."""
    outlines = gb.outlines()

    def run():
        at = ((0.0, 0.0), (gb.CENTRES, 0.0))
        bodies = [
            elastic_body(
                outlines[i].rings, 1.8e-3, gb.STEEL, level, hub=1, sides=1, modes=8, anchor=at[i], position=at[i],
                angle=(0.0, np.pi + np.pi / gb.TEETH[1])[i], **keys,
            )[0]
            for i, keys in enumerate((dict(drive=(0.0, gb.SPEED, 0.01)), dict(damper=gb.DAMPER)))
        ]  # fmt: skip
        sim = Simulation(bodies, k=2e11, margin=5e-5, rho=gb.RHO)
        return sim, sim.run(0.02, 5e-5)

    _, exact = run()
    monkeypatch.setattr(modes, "WHOLE", 10)
    sim, found = run()
    most = np.abs(exact.force).max()
    assert most > 10.0  # the teeth were pressed together
    assert found.force == pytest.approx(
        exact.force, abs=1e-7 * most
    )  # Newton's tolerance is 1e-9 of it, a step
    for b in sim.boundaries:
        made = b.ready.mean()
        assert 0.0 < made < 0.6
        complete(b)
        assert b.ready.all() and np.array_equal(b.flexibility, b.flexibility.T)
        assert b.flexibility.diagonal().min() > 0.0


def test_what_is_not_held_is_refused():
    mesh = triangulate([circle(0.03, 20)])
    k = stiffness(mesh, MATERIAL)
    assert (lumped_mass(mesh, MATERIAL) > 0).all()
    with pytest.raises(ValueError, match="pivot"):
        factorise((k - 1.1 * sp.diags_array(k.diagonal())).tocsc())
