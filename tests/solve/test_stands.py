"""What statics says must stand stands, and what it says must fall falls: one setting for all."""

import numpy as np
import pytest
from solve_world import ENGINE, area_only, displacement
from standing_scenes import (
    arch,
    arch_limit,
    card_house,
    ladder,
    overhang,
    overhang_stiffness,
)
from test_piles import pyramid

#: pymunk needs 16 steps of 100 sweeps for all of these; at one step the arch and the books fall.
SETTING = {"engine": ENGINE} if ENGINE == "area" else {"engine": ENGINE, "iterations": 100}
STEPS = None if ENGINE == "area" else 16


def moves(world, seconds, steps=STEPS):
    """(furthest way of a body, largest turn, largest speed at the end)."""
    start = world.state()
    for _ in range(round(seconds)):
        world.run(1.0, steps)
        way = displacement(world, start)
        if not way < 1.0:
            break
    turn = float(np.abs(world.state()[:, 2] - start[:, 2]).max())
    return way, turn, world.fastest()


long = pytest.mark.parametrize("seconds", [10, pytest.param(60, marks=pytest.mark.slow)])


@long
@pytest.mark.parametrize("share", [1.03, 1.05, 1.1])
def test_a_ladder_above_its_friction_limit_stands(share, seconds):
    """μ = share/(2 tan 60°), smooth wall. It gives by friction's elastic slip, a few sinkings, and no more."""
    way, _, speed = moves(ladder(share, **SETTING), seconds)
    assert way < 0.01 and speed < 1e-4


def test_a_ladder_below_its_friction_limit_slides():
    """At 0.95 the centre falls with some hundredths of g at first, all the way within 10 s."""
    assert moves(ladder(0.95, **SETTING), 10)[0] > 0.3


def test_the_arch_limit():
    """Of many blocks it is that of the semicircle under its own weight: t/R = 0.1075 (Milankovitch 1907)."""
    assert arch_limit(61) == pytest.approx(0.1075, abs=3e-4)
    assert arch_limit(7) < arch_limit(15) < arch_limit(31)


@long
@pytest.mark.parametrize("penetration", [1e-6, 2e-4])
def test_an_arch_above_its_limit_stands(penetration, seconds):
    """15 voussoirs at 1.1 × their limit stand on beds stiff enough: thrust runs 5 mm inside the hinges' edges.

    A bed of one k all along its joint would have to be 1e7 N/m²: followed in fine steps the arch fell at 1e5 and 1e6,
    and stood at 1e7, moved by 8e-4 of its radius. That is 2e-4 of a block's 0.12 m only if k answers to the load on
    what is left of the joint, 16 mm of it (2 P/(3 d k), as under the books); at 1e-6 in any case.
    (pymunk's creeps: it stands 10 s, not 60.)
    """
    settings = SETTING | ({"penetration": penetration} if ENGINE == "area" else {})
    way, turn, speed = moves(arch(1.1, **settings), seconds)
    assert way < 0.02 and turn < 0.03 and speed < 1e-2


def test_an_arch_below_its_limit_falls():
    assert moves(arch(0.95, **SETTING), 10)[0] > 0.3


@long
def test_a_card_house_stands(seconds):
    """Three storeys of cards 0.02 x 1, friction 0.8."""
    way, turn, speed = moves(card_house(**SETTING), seconds)
    assert way < 0.05 and turn < 0.05 and speed < 1e-3  # a slide of a card's foot is 0.3


#: One setting with which all of this stands: beds 20 times as stiff as the default's, four steps a frame.
ONE = {"engine": ENGINE, "penetration": 1e-5}


@area_only
@long
@pytest.mark.parametrize(
    "make",
    [
        lambda: ladder(1.03, **ONE),
        lambda: ladder(1.05, **ONE),
        lambda: arch(1.1, **ONE),
        lambda: card_house(**ONE),
        lambda: overhang(0.98, **ONE),
    ],
    ids=["ladder 1.03", "ladder 1.05", "arch", "card house", "books"],
)
def test_one_setting_stands_them_all(make, seconds):
    """60 s. They move by what they give when they are put down: books by 0.8 mm of 1 m, and hold."""
    way, turn, speed = moves(make(), seconds, 4)
    assert way < 1e-3 and turn < 2e-3 and speed < 1e-9


@area_only
@pytest.mark.slow
def test_one_setting_stands_a_great_pyramid_too():
    """5,050 boxes, 60 s, at that setting."""
    world = pyramid(100, **ONE)
    start = world.state()
    world.run(60.0, 4)
    assert displacement(world, start) < 0.5
    assert world.fastest() < 1e-2


@pytest.mark.slow
@pytest.mark.parametrize("rows, far", [(40, 0.2), (100, 0.5)])
def test_a_great_pyramid_stands(rows, far):
    """820 and 5,050 boxes, 60 s: sides apart by what they sink, rows × 2e-4 and what it spreads."""
    world = pyramid(rows, ENGINE)
    start = world.state()
    world.run(60.0)
    assert displacement(world, start) < far
    assert world.fastest() < 1e-2


@pytest.mark.slow
def test_the_pyramid_moves_less_than_pymunks():
    """820 boxes: shifted less sideways in 60 s at the default frame than with pymunk at 4 steps."""
    shifts = []
    for engine, steps in (("pymunk", 4), (ENGINE, None)):
        world = pyramid(40, engine)
        start = world.state()[:, 0]
        world.run(60.0, steps)
        shifts.append(float(np.abs(world.state()[:, 0] - start).max()))
    assert shifts[1] < shifts[0]


@long
def test_five_books_over_an_edge_stand_on_a_stiff_bed(seconds):
    """0.98 of the harmonic overhang, `penetration` 1e-9 (`overhang_stiffness`: 7e-6 must tip)."""
    settings = SETTING | ({"penetration": 1e-9} if ENGINE == "area" else {})
    way, turn, speed = moves(overhang(0.98, **settings), seconds)
    assert way < 1e-2 and turn < 1e-2 and speed < 1e-3


def test_five_books_beyond_the_edge_fall():
    """1.02 of the harmonic overhang."""
    assert moves(overhang(1.02, **SETTING), 10)[0] > 0.3


@area_only
def test_a_soft_bed_tips_the_books():
    """At the stiffness at which the lowest bed alone must tip they fall, within 20 s; so at 2e-4 of their height."""
    assert moves(overhang(0.98, stiffness=overhang_stiffness(0.98)), 20)[0] > 0.3
    assert moves(overhang(0.98, penetration=2e-4), 20)[0] > 0.3


@area_only
def test_a_bed_stiff_enough_holds_the_books():
    """At 30 times that, the four beds above tilting too: 10 s."""
    way, turn, _ = moves(overhang(0.98, stiffness=overhang_stiffness(0.98) * 30), 10)
    assert way < 1e-2 and turn < 1e-2
