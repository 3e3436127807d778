"""pymunk's own tests as a test of ours: the runner, and what it must find."""

import os

import pytest

from harness import command
from harness.suite import MODES, REASONS, modules, run_suite

#: Tests that may fail with area contact (issue: at least 205 of 211 pass); every other failure is new.
LEAST = {"pymunk": 209, "area": 205, "area frames": 205}


def test_a_part_natively_and_attached(tmp_path):
    part = ["pymunk.tests.test_constraint"]
    native, own = (run_suite(mode, tmp_path, part) for mode in ("pymunk", "area"))
    assert len(native) == len(own) > 30
    assert all(row["passed"] for row in native)
    # joints alone, no contact: attached is as native
    assert [row["test"] for row in own if not row["passed"]] == []
    assert os.listdir(tmp_path) == []


def test_a_test_that_kills_its_process_is_one_failure(tmp_path, monkeypatch):
    (tmp_path / "deadly.py").write_text(
        "import os, unittest, pymunk\n"
        "class T(unittest.TestCase):\n"
        "    def test_a(self): pass\n"
        "    def test_b(self): os._exit(7)\n"
        "    def test_c(self): self.assertEqual(1, 2)\n"
        "    def test_d(self):\n"
        "        from rigidarea import attached\n"
        "        self.assertIsNotNone(attached(pymunk.Space()))\n"
    )
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    rows = run_suite("area", tmp_path, ["deadly"])
    assert [(row["test"], row["passed"]) for row in rows] == [
        ("T.test_a", True),
        ("T.test_b", False),
        ("T.test_c", False),
        ("T.test_d", True),
    ]
    assert rows[1]["message"] == "the process ended with 7" and "1 != 2" in rows[2]["message"]


def test_failures_are_listed_with_their_reasons(monkeypatch):
    monkeypatch.setitem(REASONS, "T.test_b", "because")
    good = {"passed": True, "skipped": False, "message": ""}
    bad = {"passed": False, "skipped": False, "message": "x | y"}
    results = {
        mode: [{"test": "T.test_a", **good}, {"test": "T.test_b", **(good if mode == "pymunk" else bad)}]
        for mode in MODES
    }
    rows = command.failures(results)
    assert rows == [
        {"test": "T.test_b", "reason": "because", "pymunk": "", "area": "x | y", "area_frames": "x | y"}
    ]
    page = command.tests_page(
        {
            "settings": {"pymunk": "7"},
            "results": rows,
            "summary": {mode: {"tests": 2, "passed": 1} for mode in MODES},
        }
    )
    assert "| T.test_b |  | x \\| y | x \\| y | because |" in page


def test_bad_mode_is_refused(tmp_path):
    with pytest.raises(ValueError, match="mode must be one of pymunk, area, area frames, got 'box2d'"):
        run_suite("box2d", tmp_path)
    assert len(modules()) > 10


@pytest.mark.slow
@pytest.mark.parametrize("mode", MODES)
def test_the_whole_suite(mode, tmp_path):
    rows = run_suite(mode, tmp_path)
    assert len(rows) == 211  # of the pinned pymunk
    failed = [row["test"] for row in rows if not row["passed"]]
    assert len(rows) - len(failed) >= LEAST[mode], failed
