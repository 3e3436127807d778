"""A program run as it is: engine, frames, input, callbacks. Each run is a process of its own, as a host wants it."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from harness.hands import Input, drag, tap
from rigidarea.programs.host import Host

ROOT = Path(__file__).parents[2]
ENVIRONMENT = {**os.environ, "PYTHONPATH": os.pathsep.join((str(ROOT), str(ROOT / "tests")))}

GAME = """
import sys
import pygame, pymunk
pygame.init()
screen = pygame.display.set_mode((320, 240))
clock = pygame.time.Clock()
space = pymunk.Space()
space.gravity = 0, 900
floor = pymunk.Segment(space.static_body, (0, 200), (320, 200), 5)
body = pymunk.Body(1, 100)
body.position = 160, 184.5
ball = pymunk.Circle(body, 10)
ball.collision_type = 1
space.add(floor, body, ball)
touched = []
space.on_collision(1, None, pre_solve=lambda arbiter, space, data: touched.append(1))
seen = []
while True:
    for event in pygame.event.get():
        if event.type == pygame.KEYDOWN and event.key == pygame.K_SPACE:
            seen.append("space")
        if event.type == pygame.MOUSEBUTTONDOWN:
            seen.append(event.pos)
    if pygame.key.get_pressed()[pygame.K_LEFT]:
        seen.append("left")
    if pygame.mouse.get_pressed()[0]:
        seen.append(pygame.mouse.get_pos())
    seen.append(pygame.time.get_ticks())
    space.step(1 / 60)
    pygame.display.flip()
    clock.tick(50)
"""

HOSTED = """
import json, sys
from rigidarea import attached
from harness.hands import PlayedHost, drag, tap
host = PlayedHost(sys.argv[1], 20, [*tap(3, "SPACE"), *tap(5, "LEFT", 2), *drag(8, 1, [(10, 20), (30, 40)])])
import runpy
keep = {}
real = runpy.run_path
runpy.run_path = lambda *a, **k: real(*a, **{**k, "init_globals": {"keep": keep}})
host.run(sys.argv[2], ["--level", "2"])
print(json.dumps({
    "frames": host.frame, "steps": host.steps, "attached": [attached(s) is not None for s in host.spaces],
    "calls": host.calls, "y": list(host.spaces[0].bodies)[0].position.y, **keep,
}))
"""


def hosted(tmp_path: Path, engine: str, program: str) -> dict:
    game = tmp_path / "game.py"
    game.write_text(program)
    done = subprocess.run(
        [sys.executable, "-c", HOSTED, engine, str(game)],
        capture_output=True,
        text=True,
        env=ENVIRONMENT,
        timeout=300,
        cwd=tmp_path,
    )
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout.splitlines()[-1])


@pytest.mark.parametrize("engine", ["area", "pymunk"])
def test_a_game_that_never_ends_runs_its_frames(engine, tmp_path):
    pytest.importorskip("pygame")
    told = hosted(
        tmp_path, engine, GAME.replace("seen = []", "keep['seen'] = seen = []; keep['argv'] = sys.argv")
    )
    assert told["frames"] == told["steps"] == 20
    assert told["attached"] == [engine == "area"]
    assert told["calls"]["pre_solve"] > 10 and told["calls"]["begin"] == 0
    assert told["y"] == pytest.approx(185, abs=1)  # the ball's place on the floor: 200 - 5 - 10
    assert told["argv"][1:] == ["--level", "2"]
    # frames of 20 ms, as the game's clock asks; the script's input in its frames
    assert [entry for entry in told["seen"] if isinstance(entry, int)] == [20 * i for i in range(20)]
    words = told["seen"]
    assert words.index("space") > words.index(60 - 20) and words.count("left") == 2
    assert words.count([10, 20]) == 2 and [30, 40] in words  # pressed there, held there, then moved


def test_a_program_without_a_window_counts_its_steps(tmp_path):
    program = """
import pymunk
space = pymunk.Space()
space.gravity = 0, -900
body = pymunk.Body(1, 1)
space.add(body, pymunk.Circle(body, 5))
for _ in range(1000):
    space.step(0.01)
raise RuntimeError("it ran on")
"""
    told = hosted(tmp_path, "area", program)
    assert told["frames"] == told["steps"] == 20 and told["attached"] == [True]


def test_a_programs_own_attach_is_kept(tmp_path):
    program = """
import pymunk, rigidarea as ra
space = pymunk.Space()
space.gravity = 0, -900
body = pymunk.Body(1, 1)
space.add(body, pymunk.Circle(body, 5))
contact = ra.attach(space, stiffness=123.0)
while True:
    contact.step(1 / 60)
    assert ra.attached(space) is contact and contact.stiffness == 123.0
"""
    told = hosted(tmp_path, "area", program)
    assert told["frames"] == told["steps"] == 20


def test_bad_settings_are_refused(tmp_path):
    with pytest.raises(ValueError, match="engine must be one of area, pymunk, got 'box2d'"):
        Host("box2d")
    with pytest.raises(ValueError, match="frames must be at least 1, got 0"):
        Host("area", 0)
    with pytest.raises(FileNotFoundError, match=r"there is no file 'none\.py'"):
        Host("area").run("none.py")


def test_scripts_say_what_is_held():
    assert tap(4, "r") == [Input(4, "key", "r", True), Input(7, "key", "r", False)]
    assert [i.kind for i in drag(0, 3, [(0, 0), (1, 1)])] == ["mouse", "button", "mouse", "button"]
