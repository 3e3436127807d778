"""Pin joint, Geneva, gearbox: the table's targets at small cost, and where levels and engines must agree."""

import argparse

import numpy as np
import pytest

from rigidarea import cases
from rigidarea.cases import gearbox, geneva, pin_joint
from rigidarea.flexible.body import elastic_body
from rigidarea.flexible.integrate import Simulation
from rigidarea.flexible.statics import hub_fixed


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
    start = geneva.first_touch(6) - geneva.SPEED * geneva.DUE
    rows = [geneva.measure(geneva.through_hook(2.6), start, 6)]
    for mode in ("rigid", "compliant"):
        sim, _ = geneva.simulation(mode)
        rows.append(geneva.measure(sim.run(2.6, geneva.STEP), start, 6))
    for r in rows:
        assert r["rms_percent"] < 0.3  # the paper: 1.13
        assert 0.0 <= r["contact_delay_ms"] <= 1.0  # the paper: 8.5
        assert r["dwell_drift_deg"] < 0.1
    assert rows[1]["rms_percent"] == pytest.approx(rows[0]["rms_percent"], rel=0.02)
    assert rows[1]["force_max_n"] == pytest.approx(rows[0]["force_max_n"], rel=0.05)


def test_gearbox_levels_and_hook():
    """Hook, rigid and compliant stepper give one ripple; the mean ratio is that of the teeth to four digits."""
    rows = [gearbox.measure(gearbox.through_hook(0.35))]
    for mode in ("rigid", "compliant"):
        rows.append(gearbox.measure(gearbox.simulation(mode, 1.2, refine=6).run(0.35, gearbox.STEP)))
    for r in rows:
        assert r["mean_ratio"] == pytest.approx(gearbox.IDEAL, abs=5e-5)
        assert r["steps_halved"] == 0
    assert rows[1]["ratio_rmse_percent"] == pytest.approx(rows[0]["ratio_rmse_percent"], rel=0.05)
    assert rows[2]["ratio_rmse_percent"] == pytest.approx(rows[1]["ratio_rmse_percent"], rel=0.02)


def test_light_load_contact_ratio():
    assert gearbox.analytic_contact_ratio() == pytest.approx(1.6841, abs=1e-4)
    light = gearbox.light_load(points=60)
    assert light["contact_ratio"] == pytest.approx(gearbox.analytic_contact_ratio(), abs=1 / 60 + 5e-3)
    assert light["kinematic_error_um"] < 0.02  # involutes: constant ratio, but for the depth of the load


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


def test_teeth_inside_teeth_are_refused():
    """A wheel half a pitch out of mesh: the error comes before the first step."""
    sim = gearbox.simulation("rigid", 1.2)
    bodies = sim.bodies
    bodies[1].angle += np.pi / gearbox.TEETH[1]
    with pytest.raises(ValueError, match="overlap at t = 0"):
        Simulation(bodies, k=gearbox.K, depth_limit=0.25 * gearbox.MODULE)


def test_tooth_compliance_converges():
    """Compliance of a pinion tooth pushed at its tip land: meshes of 1, 1/2, 1/4 mm, order from their differences."""
    pinion, _ = gearbox.outlines()
    values = []
    for size in (1e-3, 5e-4, 2.5e-4):
        body, _ = elastic_body(pinion.rings, size, gearbox.STEEL, "compliant", hub=1)
        b = hub_fixed(body.boundary, body.hub)
        tip = np.flatnonzero(
            (np.hypot(*b.points.T) > 0.02499) & (np.abs(np.arctan2(*b.points.T[::-1])) < 0.1)
        )
        load = np.zeros(len(b.flexibility))
        load[2 * tip + 1] = 1.0 / len(tip)
        values.append(load @ b.flexibility @ load)
    first, second = values[1] / values[0] - 1, values[2] / values[1] - 1
    assert 0 < second < first  # T3 converges from the stiff side
    assert second < 0.07
    assert 0.7 < np.log2(first / second) < 2.2  # root fillets and load corners keep it below 2
