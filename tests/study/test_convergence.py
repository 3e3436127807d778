"""Orders of convergence of the flexible mode, small enough to run often; `compare` runs the larger ones."""

import pytest

from rigidarea.study import convergence, draw_compare


def orders(studies):
    return {study.quantity: study.order for study in studies}


def test_step_is_second_order():
    """Generalised-alpha, with modes at both ends of its damping and with a constraint."""
    found = orders(convergence.vibration_step((40, 80, 160)) + convergence.pendulum_step((100, 200, 400)))
    assert len(found) == 3
    for name, order in found.items():
        assert order == pytest.approx(2.0, abs=0.1), name


def test_residual_flexibility_closes_the_gap_of_the_modes():
    """Forty modes miss a fifth of a tooth's compliance; with residual flexibility a thousandth in vibration, none at
    rest (``test_reduction_equals_dense_algebra``)."""
    rest, alone, together = convergence.tooth_modes((10, 20, 40), 9e-4)
    assert rest.error[-1] > 0.1 and alone.error[-1] > 0.1
    assert together.error[-1] < 2e-3
    # the remainder in vibration is smaller than what modes alone leave out by (drive / next frequency)²
    assert together.order < rest.order - 0.5 < 0.0


def test_tooth_compliance_is_second_order():
    """T3 in the energy norm; fillets are round, so nothing spoils the order but that the coarsest mesh is coarse."""
    (study,) = convergence.tooth_mesh((9e-4, 6e-4, 4.5e-4, 3e-4))
    assert 1.6 < study.order < 2.4


def test_order_is_fitted():
    study = convergence.Study("s", "q", "h", (0.1, 0.2, 0.4), (0.003, 0.024, 0.192), "x", 3.0)
    assert study.row()["order"] == pytest.approx(3.0)


def test_ring_keeps_its_energy():
    """100 turns, undamped, ρ∞ = 1: the number that `compare` writes."""
    change = convergence.ring_energy(100)
    print(f"energy of the spinning ring changed by {change:.2g} over 100 turns")
    assert change < 1e-6


def test_picture(tmp_path):
    rows = [
        convergence.Study("a", "one", "h (m)", (0.1, 0.2), (0.01, 0.04), "exact", 2.0).row(),
        convergence.Study("b", "two", "modes", (10.0, 20.0), (0.5, 0.2), "exact").row(),
    ]
    assert [path.name for path in draw_compare.convergence(rows, tmp_path)] == [
        "convergence.png",
        "convergence.svg",
    ]
