"""Whoever is busy shows it, and what has ended is over."""

import io
import subprocess
import sys
import time

import pytest

from rigidarea.alive import alive

LEAVING = """
import atexit, sys
from rigidarea import __main__ as command

class Late:
    def __del__(self):
        print("taken apart", flush=True)

def run(arguments):
    global late, file
    late, file = Late(), open("kept.txt", "w")
    file.write("unflushed")
    atexit.register(print, "at exit", flush=True)
    raise SystemExit(CODE)

parsers = command.parser("plan")
sys.argv = ["rigidarea", "plan", "nothing.py"]
command.parser = lambda name: parsers
parsers._subparsers._group_actions[0].choices["plan"].set_defaults(run=run)
command.main()
"""


def long_silence(text, monkeypatch):
    """What standard error gets where a twentieth of a second is long: the text, two dots at least, and more."""
    stream = io.StringIO()
    monkeypatch.setattr(sys, "stderr", stream)
    with alive(0.05):
        sys.stderr.write(text)
        deadline = time.monotonic() + 20
        while stream.getvalue().count(".") < 2 and time.monotonic() < deadline:
            time.sleep(0.01)
        sys.stderr.writelines(["more\n"])
    assert sys.stderr is stream
    return stream.getvalue()


@pytest.mark.parametrize("text", ["", "begun\n"])
def test_dots_get_a_line_of_their_own(text, monkeypatch):
    said = long_silence(text, monkeypatch)
    assert said.replace(".", "") == f"{text}\nmore\n" and said.count(".") >= 2


def test_dots_continue_an_open_line(monkeypatch):
    said = long_silence("half a line", monkeypatch)
    assert said.replace(".", "") == "half a linemore\n" and said.startswith("half a line..")


def test_who_speaks_is_not_interrupted(monkeypatch):
    stream = io.StringIO()
    monkeypatch.setattr(sys, "stdout", io.StringIO())
    monkeypatch.setattr(sys, "stderr", stream)
    with alive(20.0):  # no machine is so busy
        for _ in range(5):
            print("word")  # to standard output, which may be JSON: no dot goes there either way
        assert sys.stdout.getvalue() == "word\n" * 5  # what the stream itself knows is known
    assert stream.getvalue() == ""


def test_silence_before_counts(monkeypatch):
    monkeypatch.setattr(sys, "stderr", io.StringIO())
    with alive(3600.0, since=3600.0):
        deadline = time.monotonic() + 20
        while not sys.stderr.getvalue() and time.monotonic() < deadline:
            time.sleep(0.01)
        assert sys.stderr.getvalue() == "."


def test_nobody_to_tell(monkeypatch):
    monkeypatch.setattr(sys, "stderr", None)
    with alive(0.01):
        time.sleep(0.05)


@pytest.mark.parametrize("code", [0, 3])
def test_python_ends_as_ever(code, tmp_path):
    """What it takes apart is, files are closed, the exit code arrives; only what comes after Python is left out."""
    done = subprocess.run(
        [sys.executable, "-c", LEAVING.replace("CODE", str(code))],
        capture_output=True,
        text=True,
        cwd=tmp_path,
        timeout=300,
    )
    assert done.returncode == code, done.stderr
    assert done.stdout == "at exit\ntaken apart\n"
    assert (tmp_path / "kept.txt").read_text() == "unflushed"
