"""Hertz: the targets of the case, and that a run reports what its parts computed."""

import pytest

from rigidarea.cases import hertz


def test_calibrated_and_predicted(tmp_path):
    out = hertz.run(tmp_path, divisions=(8, 16))
    r = out["results"]
    assert r["force_n"] == pytest.approx(10.0, rel=1e-12)
    for reading in r["readings"].values():
        at = next(m for m in reading["meshes"] if m["nodes"] == 5000)
        assert at["p_max_error_percent"] < 0.1  # the paper: 0.37
        assert at["half_width_m"] == pytest.approx(
            reading["half_width_theory_m"], rel=2e-4
        )  # sagitta of the polygon
        assert 1.3 < reading["order"] < 2.6  # sqrt ends: 3/2; a smooth middle: 2
    # the paper's own number, from its own algorithm: 6.59 Pa
    printed = next(m for m in r["readings"]["printed"]["meshes"] if m["nodes"] == 5000)
    assert printed["p_max_pa_literal"] == pytest.approx(6.59, abs=0.005)
    assert abs(r["predicted_half_width_error_percent"]) < 1.0
    assert abs(r["predicted_p_max_error_percent"]) < 2.0
    coarse, fine = r["predicted"]
    # linear elements: at most 2; the pressure's root at the rim alone would give 1
    assert 1.0 < r["predicted_order"] < 2.2
    assert abs(fine["half_width_error_percent"]) < abs(coarse["half_width_error_percent"])
    assert (tmp_path / "hertz_fig4.png").exists() and (tmp_path / "hertz_fig5.png").exists()
