"""What a type checker says of a user's file: nothing of a good one, and of every misspelled keyword where it is."""

from __future__ import annotations

import re

import pytest

GOOD = '''
from __future__ import annotations

import pymunk
import rigidarea as ra
from rigidarea import bring, shapes


class Level:
    """A level of a game: its space, its contact, and who stands where."""

    def __init__(self, gravity: float = -900.0) -> None:
        self.space = pymunk.Space()
        self.space.gravity = 0, gravity
        hook = ra.Outline([(0, 0), (60, 0), (60, 50), (45, 50), (45, 15), (15, 15), (15, 50), (0, 50)])
        self.hook = hook.body(density=1e-3)
        self.hook.position = 0, 100
        shape = hook.add_to(self.hook, friction=0.7, elasticity=0.2, collision_type=3)
        floor = pymunk.Segment(self.space.static_body, (-300, 0), (300, 0), 5)
        gear = shapes.involute_gear(module=4, teeth=19)
        wheel = gear.body(mass=2.0)
        wheel.position = -150, 60
        self.space.add(self.hook, shape, floor, wheel, gear.add_to(wheel, sensor=False))
        self.contact: ra.AreaContact = ra.attach(self.space, penetration=1e-3, law="area")
        self.space.on_collision(3, None, begin=self.began)
        self.begun = 0

    def began(self, arbiter: pymunk.Arbiter, space: pymunk.Space, data: object) -> None:
        self.begun += arbiter.is_first_contact

    def stands(self, body: pymunk.Body) -> bool:
        regions = self.contact.regions
        return bool(((regions["body_a"] == body) | (regions["body_b"] == body)).any())

    def run(self, seconds: float) -> float:
        taken: int = self.contact.step(1 / 60, frames=int(60 * seconds), steps=2)
        area, (x, y) = gear_area(), self.hook.position
        return self.contact.energy() + taken + area + x + y


def gear_area() -> float:
    regions = ra.overlap(shapes.circle(2.0), (0, 0, 0), shapes.circle(1.0), (2.5, 0, 0))
    return float(regions["area"].sum())


def load(path: str) -> ra.AreaContact:
    return bring.load_scene(path).attach(stiffness=1e5)


print(Level().run(1.0), ra.plan(Level().space, 0.01).override(steps=4))
'''

BAD = """
import pymunk
import rigidarea as ra
from rigidarea import bring, shapes

space, body = pymunk.Space(), pymunk.Body(1, 1)
disc = ra.Outline.circle(1)
disc.add_to(body, frictoin=1)
disc.add_to(body, friction="high")
disc.add_to(body, collision_type=1.5)
ra.attach(space, penetraton=1e-3)
ra.attach(space, law="areas")
ra.attach(space, direction="cord")
ra.attach(space, integration="implicitly")
ra.attach(space, flexible=3)
ra.attach(space).step(1 / 60, step=3)
disc.body(densty=1)
shapes.involute_gear(modul=1, teeth=20)
bring.load_scene("a.toml").attach(penetraton=1e-3)
ra.plan(space, 0.01).override(None, stepz=4)
ra.Outline.from_pymunk(pymunk.Circle(body, 1), side="up")
"""


@pytest.fixture(scope="module")
def said(tmp_path_factory):
    """Lines of mypy --strict, by file."""
    api = pytest.importorskip("mypy.api")
    folder = tmp_path_factory.mktemp("typed")
    for name, text in (("good", GOOD), ("bad", BAD)):
        (folder / f"{name}.py").write_text(text)
    files = [str(folder / f"{name}.py") for name in ("good", "bad")]
    out, error, _ = api.run(["--strict", "--no-error-summary", "--cache-dir", str(folder / "cache"), *files])
    assert not error, error
    return {name: re.findall(rf"{name}\.py:(\d+): error: (.*)", out) for name in ("good", "bad")} | {
        "all": out
    }


def test_a_users_file_is_strictly_typed(said):
    assert GOOD.count("\n") >= 40
    assert said["good"] == [], said["all"]
    assert "rigidarea/" not in said["all"]  # nor does it find fault with ours on the way


def test_every_misspelled_keyword_is_refused(said):
    lines = BAD.splitlines()
    wrong = set(range(lines.index("disc.add_to(body, frictoin=1)") + 1, len(lines) + 1))
    assert {int(number) for number, _ in said["bad"]} == wrong, said["all"]


def test_the_good_file_runs():
    names = {"__name__": "level"}
    exec(compile(GOOD, "good.py", "exec"), names)
