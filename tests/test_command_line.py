"""The command line's words: what is missing or cannot be is said in a line, before the work and not after."""

import json
import os
import signal
import subprocess
import sys
import time

import pytest

from commands import ROOT, command
from rigidarea import cases
from rigidarea.__main__ import main, written
from rigidarea.compile.chosen import _is_the_command
from rigidarea.report import check_writable
from rigidarea.study import atlas, chart

GAME = "import pymunk\nspace = pymunk.Space()\nfor _ in range({frames}):\n    space.step(1 / 60)\n"


@pytest.mark.parametrize("asked", ["plan", "run"])
def test_a_module_that_a_program_lacks_is_its_own_error(asked, tmp_path):
    """Not one of our extras."""
    (tmp_path / "bad.py").write_text("import nonsense_mod\n")
    done = command(tmp_path, asked, "bad.py")
    assert done.returncode == 1 and "pip install" not in done.stderr
    assert 'bad.py", line 1' in done.stderr and done.stderr.strip().endswith("No module named 'nonsense_mod'")


def test_nor_is_one_of_our_extras_that_it_asks_for(tmp_path):
    """Whoever wrote the program is told where it asks, as Python tells it."""
    (tmp_path / "bad.py").write_text("raise ModuleNotFoundError('no scipy here', name='scipy')\n")
    done = command(tmp_path, "plan", "bad.py")
    assert done.returncode == 1 and "pip install" not in done.stderr
    assert 'bad.py", line 1' in done.stderr and done.stderr.strip().endswith("no scipy here")


@pytest.mark.parametrize("name", ["a.gif", "a.mp4", "a"])
def test_a_film_has_the_suffix_that_was_asked_for(name, tmp_path):
    imageio = pytest.importorskip("imageio.v2")
    pytest.importorskip("imageio_ffmpeg")
    pytest.importorskip("pygame")
    (tmp_path / "game.py").write_text(GAME.format(frames=12))
    done = command(tmp_path, "run", "--film", name, "--json", "told.json", "game.py")
    assert done.returncode == 0, done.stderr
    (film,) = tmp_path.glob("a*")
    assert film.name == (name if "." in name else "a.mp4") and len(imageio.mimread(film)) > 0
    assert json.loads((tmp_path / "told.json").read_text())["results"]["film"] == film.name


@pytest.mark.parametrize(
    ("film", "message"),
    [("a.avi", "must end in .mp4 or .gif"), ("game.py/a.mp4", "game.py"), ("there.mp4", "there.mp4")],
)
def test_a_film_that_cannot_be_is_refused_before_the_program_runs(film, message, tmp_path):
    pytest.importorskip("imageio")
    pytest.importorskip("pygame")
    (tmp_path / "game.py").write_text("print('it ran')\n")
    (tmp_path / "there.mp4").mkdir()
    done = command(tmp_path, "run", "--film", film, "game.py")
    assert done.returncode == 2 and "it ran" not in done.stdout
    (said,) = [line for line in done.stderr.splitlines() if not line.startswith("rigidarea run: game.py, ")]
    assert said.startswith("rigidarea run: ") and message in said


def test_json_that_cannot_be_written_is_refused_before_the_work(tmp_path, monkeypatch, capsys):
    (tmp_path / "file").write_text("")
    monkeypatch.setattr(cases, "run", lambda arguments: pytest.fail("it worked"))
    for path in (tmp_path / "file" / "x.json", tmp_path):
        with pytest.raises(SystemExit) as end:
            main(["case", "patch", "--json", str(path)])
        assert end.value.code == 2 and str(tmp_path) in capsys.readouterr().err


def test_seeing_whether_a_file_can_be_written_changes_nothing(tmp_path):
    (tmp_path / "kept").write_text("text")
    for name in ("kept", "new", "folder/new"):
        check_writable(tmp_path / name)
    assert [p.name for p in tmp_path.rglob("*") if p.is_file()] == ["kept"]
    assert (tmp_path / "kept").read_text() == "text"
    if hasattr(os, "mkfifo"):
        os.mkfifo(tmp_path / "pipe")
        check_writable(tmp_path / "pipe")  # and waits for nobody


@pytest.mark.parametrize("words", [["chart"], ["atlas"], ["compare"], ["bench", "step"], ["case", "patch"]])
def test_without_matplotlib_it_is_said_first(words, tmp_path, monkeypatch, capsys):
    for module, work in ((chart, "chart"), (atlas, "atlas"), (cases, "_run")):
        monkeypatch.setattr(module, work, lambda *given, **named: pytest.fail("it worked"))
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    with pytest.raises(SystemExit) as end:
        main([*words, "--out", str(tmp_path)])
    assert end.value.code == 2
    assert capsys.readouterr().err.endswith("matplotlib is not installed: pip install 'rigidarea[studies]'\n")


def test_without_what_runs_kernels_the_command_says_so_in_a_line(tmp_path):
    done = command(tmp_path, "demo", RIGIDAREA_BACKEND="none")
    assert (done.returncode, done.stdout, done.stderr.count("\n")) == (2, "", 1)
    assert done.stderr.startswith("rigidarea: RIGIDAREA_BACKEND must be one of")
    assert _is_the_command("-m", ["python", "-m", "rigidarea", "demo"])
    assert _is_the_command("/usr/bin/rigidarea", ["python", "/usr/bin/rigidarea"])
    assert not _is_the_command("game.py", ["python", "game.py", "-m", "rigidarea"])
    assert not _is_the_command("-m", ["python", "-m", "game"])


# --- Ctrl-C ---

SWEEP = """
import sys, time
from pathlib import Path
from rigidarea.study.sweep import run_tasks

if __name__ == "__main__":
    try:
        run_tasks(time_of, [{"number": i, "seconds": 0.0 if i < 4 else 60.0} for i in range(40)],
                  Path(sys.argv[1]), workers=2)
    except KeyboardInterrupt:
        print("stopped", file=sys.stderr)
"""
TASK = (
    "import time\n\ndef time_of(number, seconds):\n    time.sleep(seconds)\n    return {'number': number}\n"
)


@pytest.mark.skipif(sys.platform == "win32", reason="has no such signal")
def test_a_sweep_that_is_stopped_shows_no_traceback(tmp_path):
    """To the whole group, as a terminal sends it; what was finished is kept."""
    (tmp_path / "task_of_sweep.py").write_text(TASK)
    (tmp_path / "sweep.py").write_text("from task_of_sweep import time_of\n" + SWEEP)
    store = tmp_path / "rows.jsonl"
    child = subprocess.Popen(
        [sys.executable, str(tmp_path / "sweep.py"), str(store)],
        stderr=subprocess.PIPE,
        text=True,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        start_new_session=True,
    )
    try:
        deadline = time.monotonic() + 120
        while (not store.exists() or len(store.read_text().splitlines()) < 4) and time.monotonic() < deadline:
            time.sleep(0.1)
        os.killpg(child.pid, signal.SIGINT)
        said = child.communicate(timeout=60)[1]
    finally:
        child.kill()
    assert "Traceback" not in said and said.endswith("stopped\n")
    assert len(store.read_text().splitlines()) == 4


@pytest.mark.parametrize("finished", [False, True])
def test_what_was_finished_is_told_where_something_was(finished, tmp_path, monkeypatch, capsys):
    (tmp_path / "before.png").write_text("")
    os.utime(tmp_path / "before.png", (1e9, 1e9))

    def stopped(arguments):
        if finished:
            (tmp_path / "deep").mkdir()
            (tmp_path / "deep" / "now.png").write_text("")
        raise KeyboardInterrupt

    monkeypatch.setattr(cases, "run", stopped)
    assert main(["case", "patch", "--out", str(tmp_path)]) == 130
    kept = f"; what was finished is in {tmp_path}" if finished else ""
    assert capsys.readouterr().err == f"rigidarea case: stopped{kept}\n"
    assert not written(tmp_path / "nowhere", 0.0)


# --- words ---


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["chart", "--workers", "-1"], "argument --workers: expected a whole number of at least 0, got '-1'"),
        (["chart", "--repeats", "0"], "argument --repeats: expected a whole number of at least 1, got '0'"),
        (["run"], "required: SCRIPT.py\n"),
        (["bench", "nope"], "argument WHAT: invalid choice: 'nope'"),
        (["case", "nope"], "argument NAME: invalid choice: 'nope'"),
    ],
)
def test_messages_use_the_names_of_the_help(words, message, capsys):
    with pytest.raises(SystemExit) as end:
        main(words)
    assert end.value.code == 2 and message in capsys.readouterr().err


@pytest.mark.parametrize("name", ["bench", "chart", "atlas", "compare", "case", "run"])
def test_help_says_what_a_command_does(name, capsys):
    with pytest.raises(SystemExit):
        main([name, "--help"])
    about = capsys.readouterr().out.split("\n\n")[1]
    assert not about.startswith(("positional", "options")) and about.rstrip().endswith(".")
