"""The gallery: every scene builds, runs under both engines, is drawn, and shows the number it is about."""

import json
import math
import os
import runpy
import subprocess
import sys
import tomllib
from pathlib import Path

import numpy as np
import pymunk
import pytest

from commands import command
from rigidarea import Outline
from rigidarea.gallery import NAMES, Run, Scene, decompose, load
from rigidarea.report import envelope, plain, write_json

pygame = pytest.importorskip("pygame")

from rigidarea.__main__ import main  # noqa: E402
from rigidarea.draw import canvas, demo, film, picture, window  # noqa: E402
from rigidarea.draw.picture import SIZE, Picture  # noqa: E402

SCRIPTS = Path(__file__).parent.parent / "demos"


def moving(scene: Scene, kind: int = pymunk.Body.DYNAMIC) -> pymunk.Body:
    """The scene's only body of this kind."""
    (body,) = (body for body in scene.space.bodies if body.body_type == kind)
    return body


def run_through(name: str, frames: int | None = None) -> Run:
    run = Run(load(name))
    for _ in range(frames or run.scene.frames):
        run.advance()
    return run


# --- every scene ---


@pytest.mark.parametrize("engine", ["area", "pymunk"])
@pytest.mark.parametrize("name", NAMES)
def test_runs_and_is_drawn(name, engine):
    run = Run(load(name), engine)
    picture = Picture(run)
    for _ in range(2 if engine == "pymunk" else 6):  # Chipmunk needs 100 ms a frame for the gears
        run.advance()
    pixels = pygame.surfarray.array3d(picture.draw())
    assert pixels.shape == (*SIZE, 3)
    scene = pixels[:, 60:550].reshape(-1, 3)
    paper = np.all(np.abs(scene.astype(int) - canvas.PAPER) < 4, axis=1)
    assert 0.01 < 1 - paper.mean() < 0.9  # bodies, and paper around them
    row = run.row()
    assert row["frames"] == run.done and row["frame_ms_median"] > 0 and row["bodies"] > 0
    assert all(math.isfinite(c) for body in run.space.bodies for c in (*body.position, body.angle))
    json.dumps(plain(row), allow_nan=False)


# --- the number that each scene is about ---


@pytest.mark.xfail(reason="energy rises by 2.0e-3 of the scale while stiffnesses are chosen", strict=True)
def test_pyramid_stands():
    run = run_through("pyramid", 60)
    # no box slid off: less than a fifth of a box while it settles (its two supports overlap it by two fifths)
    assert run.row()["headline"] < 200
    assert run.energy_drift() < 1e-5


def test_stiff_tower_stands_and_soft_tower_buckles():
    stiff = run_through("tower", 180)
    assert stiff.row()["headline"] < 50  # mm; the box is 1,000
    scene = load("tower")
    del scene.attach["penetration"]
    scene.attach["stiffness"] = 9.81 / 1e-3  # of all alike, 1 kg on 1 m: bears (0.65/1e-3)^(1/3) = 8.7 boxes
    soft = Run(scene)
    for _ in range(180):
        soft.advance()
    assert soft.row()["headline"] > 1000


def test_cradle_hands_the_speed_on():
    run = run_through("cradle", 130)
    # equal masses pass (1 + e)/2 of the speed on; e is within 0.002, so four impacts within 0.004
    assert abs(run.row()["headline"] - 1) < 0.004
    assert run.energy_drift() < 0.008  # twice that, in energy


@pytest.mark.xfail(reason="111.25 ms where 111.91 is exact", strict=True)
def test_journal_period():
    row = run_through("journal", 180).row()
    # e within 0.002 changes the rebound's half of the period by as much
    assert abs(row["headline"] - row["headline_exact"]) < 0.002 * row["headline_exact"] / 2
    assert row["energy_drift_relative"] < 0.004  # 1 - e² of e within 0.002


def test_gears_mean_ratio_to_four_digits():
    row = run_through("gears").row()
    assert row["headline_exact"] == 23 / 57
    assert abs(row["headline"] - 23 / 57) < 0.5e-4


@pytest.mark.xfail(reason="0.60 degrees off after an index, the play is 0.027", strict=True)
def test_geneva_indexes_by_60_degrees_within_its_clearance():
    from rigidarea.demos import geneva as drive
    from rigidarea.shapes import geneva

    parts = geneva(drive.SLOTS, drive.CENTRES, drive.PIN, drive.CLEARANCE)
    scene = load("geneva")
    wheel, driver = moving(scene), moving(scene, pymunk.Body.KINEMATIC)
    run = Run(scene)
    late = []
    for _ in range(scene.frames):
        run.advance()
        if abs(math.remainder(driver.angle, 2 * math.pi)) < parts.entry_angle:
            late.append(wheel.angle - parts.wheel_angle(driver.angle))
    # locked, the wheel has the play with which its arc (half angle δ at the driver) shifts on the disc
    rim = math.hypot(*parts.wheel.rings[0].T[:, np.argmax((parts.wheel.rings[0] ** 2).sum(axis=1))])
    arc = parts.locking_radius + drive.CLEARANCE
    delta = math.acos((arc**2 + drive.CENTRES**2 - rim**2) / (2 * arc * drive.CENTRES))
    play = drive.CLEARANCE / (drive.CENTRES * math.sin(delta))
    assert run.row()["headline"] < math.degrees(2 * play)  # from one end of the play to the other
    # engaged, it trails by half the clearance (Eq. 39) and by how far the pin sinks into the wall:
    # F = k (4/3) δ sqrt(2 R δ) for a disc of radius R on a straight wall; F from brake and inertia, peak 1.35 ω²
    near = parts.center_distance - parts.crank_radius
    force = (drive.BRAKE + wheel.moment * 1.35 * drive.SPEED**2) / near
    sunk = (0.75 * force / (drive.STIFFNESS * math.sqrt(drive.PIN))) ** (2 / 3)
    sampling = drive.CLEARANCE / 10  # `geneva`'s default tolerance
    assert 0 < max(late) < (drive.CLEARANCE / 2 + sunk + sampling) / near
    assert min(late) > -drive.CLEARANCE / near  # it never runs ahead by more than the play


def test_platformer_obeys_the_game():
    run = Run(load("platformer"))
    (player,) = (b for b in run.space.bodies if b.moment == math.inf and b.body_type == pymunk.Body.DYNAMIC)
    inside = 0
    while run.done < run.scene.frames:
        run.advance()
        (hero,) = player.shapes
        for platform in (s for s in run.space.shapes if s.collision_type == 2):
            box, bar = hero.bb, platform.bb
            deep = min(box.top - bar.bottom, bar.top - box.bottom) > 0.1 and box.left < bar.right
            if deep and box.right > bar.left:
                inside += 1
                touching = {(row["shape_a"], row["shape_b"]) for row in run.contact.regions}
                assert not {(hero, platform), (platform, hero)} & touching
    assert inside > 20  # frames in which the player was on its way through a platform
    assert run.row()["headline"] == 5
    assert player.position.y < 0.6  # and dropped to the ground again


def test_bowl_keeps_every_piece():
    run = run_through("bowl")
    row = run.row()
    assert row["headline"] == row["headline_exact"] == 40
    assert row["energy_drift_relative"] < 1e-3  # the conservative law: what is left is the step's


# --- what the gallery is made of ---


def test_decomposition_tiles_the_outline():
    space = pymunk.Space()
    outline = Outline([(0, 0), (4, 0), (4, 4), (0, 4)], holes=[[(1, 1), (3, 1), (3, 3), (1, 3)]])
    body = outline.body(density=1)
    space.add(body, outline.add_to(body, friction=0.3, elasticity=0.4, collision_type=7))
    assert decompose(space) == len(space.shapes) >= 4
    assert sum(shape.area for shape in space.shapes) == pytest.approx(12, rel=1e-12)
    assert {(s.friction, s.elasticity, s.collision_type) for s in space.shapes} == {(0.3, 0.4, 7)}


def test_energy_is_the_same_for_both_engines_before_contact():
    assert Run(load("cradle")).energy() == pytest.approx(Run(load("cradle"), "pymunk").energy(), rel=1e-12)


def test_holes_stay_empty():
    outline = Outline(
        [(0, 0), (40, 0), (40, 40), (0, 40)], [[(5, 5), (15, 5), (15, 35)], [(20, 5), (35, 5), (35, 35)]]
    )
    surface = pygame.Surface((40, 40))
    pygame.draw.polygon(surface, (255, 255, 255), canvas.sketch(outline, 0.0).fill)
    filled = pygame.surfarray.array3d(surface)[:, :, 0] > 0
    assert not filled[12, 10] and not filled[32, 10]
    assert filled[2, 20] and filled[17, 20] and filled[38, 38]
    # pixels on an edge count as filled: half a pixel along every edge and the bridges
    perimeter = sum(np.hypot(*(np.roll(ring, -1, 0) - ring).T).sum() for ring in outline.rings)
    assert outline.area < filled.sum() + 1 < outline.area + 0.75 * perimeter


def test_unknown_names_are_refused():
    with pytest.raises(ValueError, match=r"unknown demo 'nope'; expected one of pyramid"):
        load("nope")
    with pytest.raises(ValueError, match="engine must be one of area, pymunk, got 'box2d'"):
        Run(load("cradle"), "box2d")


def test_window_drags_and_closes(monkeypatch):
    monkeypatch.setenv("SDL_VIDEODRIVER", "dummy")
    run = Run(load("platformer"))
    crate = next(b for b in run.space.bodies if b.mass == pytest.approx(0.64))
    picture = Picture(run)
    x, y = picture.camera.pixels(np.array([crate.position]))[0] / 2
    event = pygame.event.Event
    script = [
        [event(pygame.MOUSEBUTTONDOWN, pos=(x, y), button=1)],
        *([event(pygame.MOUSEMOTION, pos=(x, y - 5 * i))] for i in range(10)),
        [event(pygame.MOUSEBUTTONUP, pos=(x, y), button=1)],
        [event(pygame.KEYDOWN, key=pygame.K_SPACE)],
        [event(pygame.KEYDOWN, key=pygame.K_ESCAPE)],
    ]
    joints, before = len(run.space.constraints), crate.position.y
    queue = iter(script)
    monkeypatch.setattr(pygame.event, "get", lambda: next(queue))
    window.show(run)
    assert run.done == 12  # paused once space was hit
    assert crate.position.y > before + 0.2
    assert len(run.space.constraints) == joints


def test_window_ends_after_its_frames(monkeypatch):
    monkeypatch.setenv("SDL_VIDEODRIVER", "dummy")
    run = Run(load("cradle"))
    window.show(run, frames=3)
    assert run.done == 3 and not pygame.display.get_init()
    seen = []
    monkeypatch.setattr(window, "show", lambda run, frames: seen.append((run.scene.name, frames)))
    assert main(["demo", "cradle", "--window", "--frames", "4"]) == 0
    assert seen == [("cradle", 4)]


# --- the scripts ---


@pytest.mark.parametrize("name", NAMES)
def test_a_script_a_scene(name, monkeypatch):
    played = []
    monkeypatch.setattr("rigidarea.draw.window.play", lambda name: played.append(name) or 0)
    with pytest.raises(SystemExit) as end:
        runpy.run_path(str(SCRIPTS / f"{name}.py"), run_name="__main__")
    assert played == [name] and end.value.code == 0


def test_the_wheel_has_one_package():
    told = tomllib.loads((SCRIPTS.parent / "pyproject.toml").read_text())
    assert told["tool"]["hatch"]["build"]["targets"]["wheel"]["packages"] == ["rigidarea"]


def test_the_game_to_copy_catches_stars():
    program = f"""
import json, random
from rigidarea.programs.host import Host
random.seed(1)
host = Host("area", 500)
host.run({str(SCRIPTS / "game.py")!r})
(space,) = host.spaces
bucket = next(b for b in space.bodies if b.body_type == b.KINEMATIC)
print(json.dumps([[*(star.position - bucket.position)] for star in space.bodies if star is not bucket]))
"""
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=300)
    assert done.returncode == 0 and not done.stderr, done.stderr
    stars = np.array(json.loads(done.stdout.splitlines()[-1]))
    inside = stars[(np.abs(stars[:, 0]) < 45) & (stars[:, 1] > -40)]
    assert len(inside) >= 1
    assert (inside[:, 1] < 30).all()  # none of them has sunk into the bottom, whose top is at 30
    assert len((SCRIPTS / "game.py").read_text().splitlines()) < 75


# --- the command ---


def test_a_picture_says_what_a_frame_took():
    """Ours are substeps, and one is one."""
    told = [picture._taken(1, "area"), picture._taken(2, "area"), picture._taken(4, "pymunk")]
    assert told == ["1 substep a frame", "2 substeps a frame", "4 steps a frame"]


def test_demo_writes_picture_film_and_json(tmp_path, capsys):
    out, numbers = tmp_path / "pictures", tmp_path / "deep" / "numbers.json"
    assert main(["demo", "cradle", "--frames", "8", "--out", str(out), "--json", str(numbers)]) == 0
    told = json.loads(numbers.read_text())
    assert set(told) == {"command", "settings", "versions", "machine", "results"}
    (row,) = told["results"]
    assert row["scene"] == "cradle" and row["frames"] == 8 and row["headline"] is None  # too short to tell
    assert pygame.image.load(row["still"]).get_size() == SIZE
    import imageio.v2 as imageio

    assert len(imageio.mimread(row["film"], memtest=False)) == 4
    text = capsys.readouterr()
    assert "last_to_first_speed" in text.out and str(out) in text.out
    assert "cradle" in text.err


def test_film_falls_back_to_gif(tmp_path, monkeypatch):
    monkeypatch.setattr(film.importlib.util, "find_spec", lambda name: None)
    with film.Film(tmp_path / "film") as movie:
        for shade in range(6):
            surface = pygame.Surface((64, 40))
            surface.fill((40 * shade, 0, 0))
            movie.add(surface)
    import imageio.v2 as imageio

    assert movie.path.suffix == ".gif"
    pictures = imageio.mimread(movie.path)
    assert len(pictures) == 2 and pictures[0].shape[:2] == (20, 32)


def test_case_goes_to_the_cases(tmp_path, monkeypatch, capsys):
    from rigidarea import cases

    seen = []

    def run(arguments):
        seen.append((arguments.name, arguments.mesh, arguments.out))
        return {"command": "case patch", "results": [{"gap_mm": 2.0}], "paper": {"gap_mm": 2}, "wall_s": 0.5}

    monkeypatch.setattr(cases, "run", run)
    assert main(["case", "patch", "--mesh", "1.5", "--out", str(tmp_path)]) == 0
    assert seen == [("patch", 1.5, tmp_path)]
    told = capsys.readouterr().out
    assert "gap_mm" in told and str(tmp_path) in told


def test_json_alone_on_standard_output(tmp_path):
    # a process of its own: pygame greets where it is first imported
    words = ["demo", "cradle", "--frames", "1", "--no-film", "--json", "-", "--out", str(tmp_path)]
    done = command(tmp_path, *words)
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout)["command"] == "demo"
    assert os.listdir(tmp_path) == ["cradle.png"]


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ([], "COMMAND"),
        (["nope"], "invalid choice: 'nope'"),
        (["demo", "nope"], "choose from"),
        (["demo", "cradle", "--frames", "0"], "whole number of at least 1, got '0'"),
        (["demo", "cradle", "--engine", "box2d"], "choose from"),
        (["demo", "cradle", "--frames", "1", "--no-film", "--out", "/dev/null/x"], "/dev/null"),
    ],
)
def test_bad_input_exits_2(words, message, capsys):
    with pytest.raises(SystemExit) as exit:
        main(words)
    assert exit.value.code == 2
    assert message in capsys.readouterr().err


def test_table_aligns():
    row = Run(load("cradle"))
    row.advance()
    lines = demo.table([row.row()]).splitlines()
    assert len(lines) == 2 and lines[0].index("bodies") < lines[1].index("last_to_first_speed")


def test_json_knows_no_nan(tmp_path, capsys):
    told = envelope("x", {"a": np.float64(2)}, [{"b": math.nan, "c": np.arange(2), "d": math.inf}], extra=1)
    assert told["versions"]["pymunk"] == pymunk.version and told["extra"] == 1
    write_json(told, "-")
    told = json.loads(capsys.readouterr().out)
    assert told["results"] == [{"b": None, "c": [0, 1], "d": None}] and told["settings"] == {"a": 2.0}
    write_json(told, None)
