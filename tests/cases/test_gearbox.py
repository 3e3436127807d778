"""Gearbox: both readings of the teeth, contact ratio, load sharing, pressure angle, stiffness, a sweep cut short."""

import argparse
import json

import numpy as np
import pytest

from rigidarea import cases
from rigidarea.cases import gear_statics, gearbox, gearbox_figures
from rigidarea.flexible.integrate import Simulation
from rigidarea.flexible.mesh import resample, triangulate


def test_contact_ratios_of_both_readings():
    assert gearbox.analytic_contact_ratio() == pytest.approx(1.9818, abs=1e-6)  # what the paper prints
    assert gearbox.analytic_contact_ratio(gearbox.STANDARD) == pytest.approx(1.6841, abs=1e-4)  # ISO 53


def test_levels_and_hook():
    """Hook, rigid and compliant stepper give one ripple; the mean ratio is that of the teeth to four digits."""
    rows = [gearbox.measure(gearbox.through_hook(0.35))]
    for mode in ("rigid", "compliant"):
        rows.append(gearbox.measure(gearbox.simulation(mode, 1.2, refine=6).run(0.35, gearbox.STEP)))
    for r in rows:
        assert r["mean_ratio"] == pytest.approx(gearbox.IDEAL, abs=5e-5)
        assert r["steps_halved"] == 0
        assert r["pressure_angle_mean_deg"] == pytest.approx(20, abs=0.1)
    assert rows[1]["ratio_rmse_percent"] == pytest.approx(rows[0]["ratio_rmse_percent"], rel=0.05)
    assert rows[2]["ratio_rmse_percent"] == pytest.approx(rows[1]["ratio_rmse_percent"], rel=0.02)


def test_ripple_is_below_the_papers_and_grows_with_coarse_perimeters():
    """Table 6, its coarsest and middle meshes; mesh nodes as perimeter are worse than flanks on the mesh's edges."""
    paper = dict(zip(gearbox.MESHES, gearbox.PAPER["table_6"]["rmse_percent"], strict=True))
    for mesh in (1.2, 0.6):
        nodes, flanks = (
            gearbox.measure(gearbox.simulation("rigid", mesh, refine=n).run(0.5, gearbox.STEP))[
                "ratio_rmse_percent"
            ]
            for n in (1, gearbox.REFINE)
        )
        assert flanks < nodes < paper[mesh]


def test_pressure_angle_tends_to_the_nominal_as_the_contact_stiffens():
    """Every definition of the angle; overlap, and with it the error, falls as 1/sqrt(k) at least."""
    soft, stiff = (
        gearbox.measure(gearbox.simulation("rigid", 0.6, k=k, refine=6).run(0.35, h))
        for k, h in ((gearbox.K, gearbox.STEP), (256 * gearbox.K, 2e-5))
    )
    for name in ("", "_resultant", "_on_path", "_all_pairs"):
        off = [abs(r[f"pressure_angle{name}_mean_deg"] - 20) for r in (soft, stiff)]
        assert off[1] < off[0] / 8  # sqrt(256) = 16, a factor of two for the transient


def test_light_load():
    """Contact ratio and load sharing against the analytic ones, both readings."""
    for addendum in (gearbox.ADDENDUM, gearbox.STANDARD):
        row, curves = gear_statics.light_load(addendum, points=60)
        # a count on 60 angles, and lenses of 9 µm at both ends of a path of 10 mm
        assert row["contact_ratio"] == pytest.approx(row["contact_ratio_analytic"], abs=1 / 60 + 5e-3)
        assert row["single_pair_fraction"] == pytest.approx(
            row["single_pair_fraction_analytic"], abs=1 / 60 + 5e-3
        )
        # polygons of 1 nm sagitta under a load of 10 nm overlap
        assert row["largest_share_error_median"] < 0.01
        assert row["kinematic_error_um"] < 0.02  # involutes: constant ratio, but for the depth of the load
        assert len(curves["share"]) == 60


def test_mesh_stiffness_against_iso_6336(tmp_path):
    """Teeth alone near the norm's theory, for whose foundation there is no one depth; discs add up. The mesh is coarse:
    1.2 mm makes teeth 20 % too stiff (``tooth_compliance``)."""
    found = gear_statics.mesh_stiffness(gearbox.STANDARD, mesh_mm=1.2, points=4, cache=tmp_path)
    assert abs(found["fe_teeth_difference_percent"]) < 35
    assert found["fe_single_pairs"] == 1
    assert found["fe_single_n_per_mm_um"] < found["fe_n_per_mm_um"] < found["fe_teeth_n_per_mm_um"]
    assert found["fe_teeth_n_per_mm_um"] < found["fe_teeth_1_module_n_per_mm_um"]


def test_tooth_compliance_converges(tmp_path):
    """T3 from the stiff side; root fillets and load corners keep the order below 2."""
    found = gear_statics.tooth_compliance(tmp_path)
    first, second = found["change_percent"]
    assert 0 < second < first
    assert second < 7
    assert 0.7 < found["order"] < 2.2


def test_tooth_compliance_hardly_changes(tmp_path):
    """2 % and less from one mesh to the next: loads on the tip's corners stay there, so that a finer mesh has a sharper
    load too, which takes part of the mesh's own change off. (Spread round the corners they were 8, 3 and 1 %.)"""
    first, second = gear_statics.tooth_compliance(tmp_path)["change_percent"]
    assert 0 < second < first < 2
    assert second < 0.5


def test_displacement_of_a_ring_pulled_apart():
    """Two opposite forces on a ring: symmetric, no hub motion, and outwards under the forces."""
    t = 2 * np.pi * np.arange(96) / 96
    circle = np.column_stack([np.cos(t), np.sin(t)])
    mesh = triangulate([resample(0.03 * circle, 2e-3), resample(0.01 * circle[::-1], 2e-3)])
    loads = np.zeros((len(mesh.rings[0]), 2))
    right, left = (int(np.argmax(s * mesh.points[mesh.rings[0], 0])) for s in (1, -1))
    loads[right, 0], loads[left, 0] = 1.0, -1.0
    u = gearbox_figures.displacement(mesh, loads)
    assert np.abs(u[mesh.rings[1]].mean(0)).max() < 1e-12 * np.abs(u).max()
    assert u[right, 0] > 0 > u[left, 0]
    assert u[right, 0] == pytest.approx(-u[left, 0], rel=0.05)  # the mesh inside is not symmetric


def test_teeth_inside_teeth_are_refused():
    """A wheel half a pitch out of mesh: the error comes before the first step."""
    sim = gearbox.simulation("rigid", 1.2)
    bodies = sim.bodies
    bodies[1].angle += np.pi / gearbox.TEETH[1]
    with pytest.raises(ValueError, match="overlap at t = 0"):
        Simulation(bodies, k=gearbox.K, depth_limit=0.25 * gearbox.MODULE)


def test_interrupted_sweep_leaves_valid_json(tmp_path, monkeypatch):
    """Ctrl-C at the third mesh: the file, and the one asked for by --json, hold two rows and say they are not all."""
    monkeypatch.setattr(gearbox, "MESHES", (1.8, 1.6, 1.4))
    swept = gearbox.mesh_sweep

    def interrupted(*settings):
        for n, row in enumerate(swept(*settings)):
            if n == 2:
                raise KeyboardInterrupt
            yield row

    monkeypatch.setattr(gearbox, "mesh_sweep", interrupted)
    parser = argparse.ArgumentParser()
    cases.add_arguments(parser)
    args = parser.parse_args(["gearbox", "--mode", "rigid", "--mesh", "1.5"])
    args.out, args.json = tmp_path, str(tmp_path / "asked.json")
    with pytest.raises(KeyboardInterrupt):
        cases.run(args)
    for name in ("gearbox.json", "asked.json"):
        told = json.loads((tmp_path / name).read_text())
        assert told["complete"] is False
        assert told["results"]["contact_ratio_analytic"] == pytest.approx(1.9818, abs=1e-6)
        assert len(told["results"]["meshes"]) == 2
        assert {"settings", "versions", "machine", "paper", "wall_s", "setup_s", "simulated_s"} <= set(told)
    assert not list(tmp_path.glob("*.part"))
