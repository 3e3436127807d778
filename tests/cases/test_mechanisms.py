"""Pin joint and Geneva: the table's targets at small cost, and where levels and engines must agree."""

import argparse
from types import SimpleNamespace

import numpy as np
import pytest

from rigidarea import cases
from rigidarea.cases import geneva_case, pin_joint
from rigidarea.cases.mechanism import step_sweep


def test_pin_joint_exact_and_hook():
    exact = pin_joint.exact()
    # design values, five digits
    assert exact["penetration_max_mm"] == pytest.approx(0.24131, abs=1e-5)
    assert exact["force_max_n"] == pytest.approx(75.742, abs=1e-3)
    assert exact["contact_ms"] == pytest.approx(1.30553, abs=1e-5)
    assert exact["period_ms"] == pytest.approx(111.906, abs=1e-3)
    measured = pin_joint.measure(*pin_joint.run_hook(1.2))
    for key, value in exact.items():
        assert measured[key] == pytest.approx(value, rel=1e-3), key
    assert measured["bounces"] >= 10
    assert measured["rebound_drift_percent"] < 0.5


def test_pin_joint_of_points_is_as_near():
    """What arcs are timed beside must be worth as much: errors of neither above 0.005 %."""
    exact = pin_joint.exact()
    for tolerance in (None, pin_joint.POINTS_TOLERANCE):
        measured = pin_joint.measure(*pin_joint.run_hook(0.3, tolerance))
        for key, value in exact.items():
            assert measured[key] == pytest.approx(value, rel=5e-5), (key, tolerance)


def test_pin_joint_sts_and_area_agree():
    forces = []
    for contact in ("area", "sts"):
        sim = pin_joint.simulation(1.0, "compliant", contact)
        forces.append(sim.run(0.058, pin_joint.STEP).force[:, 1])
    difference = np.sqrt(np.mean((forces[0] - forces[1])[5500:5700] ** 2))
    assert difference < 0.01 * np.abs(forces[1]).max()
    assert np.abs(forces[0]).max() == pytest.approx(
        pin_joint.exact()["force_max_n"], rel=0.01
    )  # 1 mm polygons


def test_geneva_levels_and_hook():
    start = geneva_case.first_touch(6) - geneva_case.SPEED * geneva_case.DUE
    rows = [geneva_case.measure(geneva_case.through_hook(2.6), start, 6)]
    for mode in ("rigid", "compliant"):
        sim, _ = geneva_case.simulation(mode)
        rows.append(geneva_case.measure(sim.run(2.6, geneva_case.STEP), start, 6))
    for r in rows:
        assert r["rms_percent"] < 0.3  # the paper: 1.13
        assert 0.0 <= r["contact_delay_ms"] <= 1.0  # the paper: 8.5
        assert r["dwell_drift_deg"] < 0.1
    assert rows[1]["rms_percent"] == pytest.approx(rows[0]["rms_percent"], rel=0.02)
    assert rows[1]["force_max_n"] == pytest.approx(rows[0]["force_max_n"], rel=0.05)


def test_geneva_sweep_of_steps_counts_what_large_steps_cost():
    """Halved steps and attempts before them are in the cost; coarse steps are marked, fine ones hardly halved, where
    the pin comes and goes."""
    start = geneva_case.simulation("rigid")[1]
    fine, coarse = (
        row
        for row, _ in step_sweep(
            lambda: geneva_case.simulation("compliant")[0],
            lambda r: geneva_case.measure(r, start, 6),
            (4e-4, 0.1),
            1.0,
            geneva_case.PLAY_S,
        )
    )
    assert not fine["under_resolved"]
    assert coarse["under_resolved"]  # the engagement itself lasts 0.66 s
    assert fine["steps_halved"] < 10 and coarse["steps_halved"] > 0
    # one an iteration, and a few more where the contact is lost
    assert (
        fine["newton_iterations_mean"] <= fine["evaluations_a_step"] < 1.02 * fine["newton_iterations_mean"]
    )
    assert coarse["evaluations_a_step"] > coarse["newton_iterations_mean"]
    assert coarse["run_cpu_s"] > 0


def test_step_sweep_keeps_the_reason_of_a_failure():
    class Failing:
        record = SimpleNamespace(t=np.arange(3), evaluations=12, halved=np.array([0, 0, 6]))

        def run(self, duration, h):
            raise RuntimeError("no convergence")

    ((row, record),) = step_sweep(Failing, lambda r: {"error": 1.0}, (0.1,), 1.0, 2.0)
    assert record is Failing.record
    assert row["failed"] == "no convergence"
    assert "error" not in row
    assert (row["evaluations_a_step"], row["steps_halved"], row["under_resolved"]) == (4.0, 6, False)


def test_command_line():
    parser = argparse.ArgumentParser()
    cases.add_arguments(parser)
    out = cases.run(parser.parse_args(["patch"]))
    assert set(out) >= {
        "command",
        "settings",
        "versions",
        "machine",
        "results",
        "paper",
        "wall_s",
        "setup_s",
        "simulated_s",
    }
    with pytest.raises(ValueError, match="expected no --mode"):
        cases.run(parser.parse_args(["hertz", "--mode", "modal"]))
    with pytest.raises(ValueError, match="must be positive"):
        cases.run(parser.parse_args(["gearbox", "--mesh", "-1"]))
    with pytest.raises(ValueError, match="must not exceed a feature"):
        cases.run(parser.parse_args(["gearbox", "--mesh", "9"]))
