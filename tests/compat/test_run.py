"""`rigidarea run`: the command, as a user calls it."""

import json
import time
from pathlib import Path
from types import SimpleNamespace

import pytest

from commands import ROOT, command
from rigidarea.__main__ import main
from rigidarea.programs.run_program import frames_told

PROGRAM = """
import sys
import pymunk
print("its own words", sys.argv[1:])
space = pymunk.Space()
space.gravity = 0, -900
space.add(pymunk.Segment(space.static_body, (-100, 0), (100, 0), 5))
body = pymunk.Body(1, 100)
body.position = 0, 40
space.add(body, pymunk.Poly.create_box(body, (20, 20)))
for _ in range(40):
    space.step(1 / 60)
assert abs(body.position.y - 15) < 2, body.position  # it lies on the segment, in either engine
"""


def test_json_alone_on_standard_output_and_a_film(tmp_path):
    imageio = pytest.importorskip("imageio.v2")
    pytest.importorskip("pygame")
    (tmp_path / "game.py").write_text(PROGRAM)
    done = command(tmp_path, "run", "--json", "-", "--film", "film", "game.py", "--fast", "7")
    assert done.returncode == 0, done.stderr
    told = json.loads(done.stdout)
    assert told["command"] == "run" and told["settings"]["arguments"] == ["--fast", "7"]
    assert told["results"]["frames"] == 40 and told["results"]["engine"] == "area"
    assert "its own words ['--fast', '7']" in done.stderr
    pictures = imageio.mimread(tmp_path / told["results"]["film"], memtest=False)
    assert len(pictures) == 20
    assert (abs(pictures[0].astype(int) - pictures[-1].astype(int)) > 60).any()  # something moved


def test_the_readmes_film_of_ones_own_shape(tmp_path):
    """As a new user does it: the block as it stands there, in 15 lines at the most, and the command beside it."""
    imageio = pytest.importorskip("imageio.v2")
    pytest.importorskip("pygame")
    (block,) = (
        b for b in (ROOT / "README.md").read_text().split("```python\n")[1:] if "for i in range(3)" in b
    )
    program = block.split("```")[0]
    assert len([line for line in program.splitlines() if line.strip()]) <= 15
    assert "-m rigidarea run --film hook hook.py" in (ROOT / "README.md").read_text()
    (tmp_path / "hook.py").write_text(program)
    done = command(tmp_path, "run", "--film", "hook", "--json", "told.json", "hook.py")
    assert done.returncode == 0, done.stderr
    told = json.loads((tmp_path / "told.json").read_text())["results"]
    pictures = imageio.mimread(tmp_path / told["film"], memtest=False)
    assert len(pictures) > 30
    assert (abs(pictures[0].astype(int) - pictures[-1].astype(int)) > 60).any()


def test_frames_and_the_other_engine(tmp_path):
    (tmp_path / "game.py").write_text(PROGRAM)
    done = command(tmp_path, "run", "--engine", "pymunk", "--frames", "5", "game.py")
    assert done.returncode == 0, done.stderr
    assert "its own words []" in done.stdout
    rows = dict(line.split(None, 1) for line in done.stdout.splitlines()[1:])
    assert rows["frames"] == "5" and rows["engine"] == '"pymunk"'


def test_its_own_window_ends_after_the_frames_asked_for(tmp_path):
    pytest.importorskip("pygame")
    (tmp_path / "game.py").write_text(
        "import pygame, pymunk\n"
        "pygame.init()\n"
        "screen, clock = pygame.display.set_mode((100, 80)), pygame.time.Clock()\n"
        "space = pymunk.Space()\n"
        "space.gravity = 0, 900\n"
        "body = pymunk.Body(1, 1)\n"
        "space.add(body, pymunk.Circle(body, 5))\n"
        "while True:\n"
        "    space.step(1 / 60)\n"
        "    pygame.display.flip()\n"
        "    print(type(clock).__name__, clock.tick(200) > 0)\n"
    )
    words = "run --window --frames 6 --json told.json game.py"
    done = command(tmp_path, *words.split(), SDL_VIDEODRIVER="dummy")
    assert done.returncode == 0, done.stderr
    assert json.loads((tmp_path / "told.json").read_text())["results"]["frames"] == 6
    assert "Clock True" in done.stdout  # pygame's own clock, which takes its time


def test_a_programs_own_error_is_told_as_its_own(tmp_path):
    (tmp_path / "game.py").write_text("import pymunk\nraise ValueError('my own')\n")
    done = command(tmp_path, "run", "game.py")
    assert done.returncode == 1
    assert "game.py" in done.stderr and done.stderr.strip().endswith("ValueError: my own")


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["run"], "SCRIPT"),
        (["run", "nothing.py"], "expected a Python file, got 'nothing.py'"),
        (["run", "--frames", "0", "x.py"], "whole number of at least 1, got '0'"),
        (["run", "--window", "--film", "f", "x.py"], "leave --window out"),
        (["run", "--engine", "box2d", "x.py"], "choose from"),
    ],
)
def test_bad_input_exits_2(words, message, capsys):
    with pytest.raises(SystemExit) as exit:
        main(words)
    assert exit.value.code == 2
    assert message in capsys.readouterr().err


def test_it_shows_that_it_is_alive(capsys):
    """What runs, at once; then at which frame it is, as long as that grows."""
    host = SimpleNamespace(engine="area", frame=0)
    said = ""
    with frames_told(host, Path("game.py"), seconds=0.01):
        assert capsys.readouterr().err == "rigidarea run: game.py, area\n"
        host.frame = 7
        deadline = time.monotonic() + 20
        while not said and time.monotonic() < deadline:
            time.sleep(0.02)
            said = capsys.readouterr().err
        time.sleep(0.1)
    assert said + capsys.readouterr().err == "rigidarea run: frame 7\n"
