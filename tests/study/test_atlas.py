"""The atlas against theory: the step limit, buckling, and where the paper's method stops seeing contacts."""

import math

import numpy as np
import pytest

from rigidarea.study import atlas
from rigidarea.study.atlas import PASS, Variant, engines, evaluate, get_map, judge, maps
from rigidarea.study.maps import buckling_map, step_size_map
from rigidarea.study.peers import literal_peer as literal

AREA = Variant("rigidarea-explicit", {})


@pytest.mark.parametrize("name", list(maps()))
def test_map_is_consistent(name):
    """Quick values are few and inside the full range; every variant's peer exists; theory can be drawn."""
    chart = maps()[name]
    for axis in (chart.x, chart.y):
        assert len(axis.quick) <= len(axis.values)
        assert min(axis.values) <= min(axis.quick)
        assert max(axis.quick) <= max(axis.values)
        assert not axis.names or len(axis.names) == len(axis.values)
    for _, x, y in chart.theory():
        assert len(x) == len(y)
        assert np.all(np.isfinite(x)) and np.all(np.isfinite(y))


def test_step_limit_is_two():
    """Undamped, ω h = 2 within 3 % (the issue's bound); bisected over the growth of a small motion."""
    low, high = 1.5, 2.5
    while high - low > 0.005:
        middle = (low + high) / 2
        low, high = (middle, high) if step_size_map.growth(middle, 1.0, AREA) < 100 else (low, middle)
    assert low == pytest.approx(2.0, rel=0.03)


def test_implicit_integration_has_no_step_limit():
    """Where the plain law grows without bound, the default stays bounded."""
    for phase in (2.1, 2.4, 5.0):
        assert step_size_map.growth(phase, 1.0, Variant("rigidarea", {})) < 10


@pytest.mark.parametrize("zeta", [0.0, 0.07, 0.3, 0.8])
def test_formula_of_the_step_limit(zeta):
    """The closed form is where an eigenvalue of one step of the damped spring leaves the unit circle."""

    def radius(phase):
        d = 1 / (1 + 2 * zeta * phase)  # ω = 1, h = phase: v' = d (v - h x), x' = x + h v'
        step = np.array([[d, -d * phase], [phase * d, 1 - d * phase**2]])
        return np.max(np.abs(np.linalg.eigvals(step)))

    limit = float(step_size_map.limit(np.array([zeta]))[0])
    assert radius(0.999 * limit) <= 1 + 1e-12
    assert radius(1.001 * limit) > 1.001


@pytest.mark.parametrize("elasticity", [0.1, 0.5, 0.8])
def test_damping_raises_the_step_limit(elasticity):
    """The dashpot is implicit: as `step_size.limit` derives, and higher than undamped."""
    expected = float(step_size_map.limit(np.array([step_size_map.damping_ratio(elasticity)]))[0])
    assert expected > 2
    # 2 % either side: beyond, 3,000 steps grow by far more than a hundredfold, below they decay
    assert step_size_map.growth(0.98 * expected, elasticity, AREA) < 1
    assert step_size_map.growth(1.02 * expected, elasticity, AREA) > 100


@pytest.mark.parametrize("sinking,boxes", [(1e-2, 3), (1e-3, 8), (1e-4, 18), (1e-5, 39)])
def test_buckling_bound(sinking, boxes):
    """The eigenvalue problem gives the numbers of docs/study.md, and the round formula is within a box of them."""
    assert buckling_map.tallest(sinking) == boxes
    assert abs(math.floor((0.65 / sinking) ** (1 / 3)) - boxes) <= 1


@pytest.mark.slow
@pytest.mark.parametrize("engine", ["rigidarea", "explicit"])
@pytest.mark.parametrize("sinking,boxes", [(1e-2, 3), (1e-3, 8), (1e-4, 18), (1e-5, 39)])
def test_stacks_buckle_where_theory_says(sinking, boxes, engine):
    """The tallest stable stack stands for half a minute, one box more topples: those numbers, simulated."""
    variant = get_map("buckling").variants[engine]
    assert buckling_map.lean(variant, sinking, boxes) < buckling_map.LIMIT
    assert buckling_map.lean(variant, sinking, boxes + 1) > buckling_map.LIMIT


@pytest.mark.parametrize("name,x,y", [("corner", 30, 0.1), ("crossed", 1.5, 0.3)])
def test_paper_misses_what_we_see(name, x, y):
    """One corner inside, no node inside: with nodes at the corners alone the paper's gate stays shut, ours has none."""
    assert evaluate(name, "rigidarea", x, y)["verdict"] == PASS
    assert evaluate(name, "literal, corners", x, y)["verdict"] != PASS
    # nodes along the edges, as a mesh has them, and it is open
    assert evaluate(name, "literal", x, y)["verdict"] == PASS


def test_gate_counts_nodes():
    """Nodes inside, in a hole, outside; seen from both sides of a rotated pair."""
    square = np.array([(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)])
    hole = 0.5 * square[::-1]
    edges = np.concatenate([np.hstack((ring, np.roll(ring, -1, 0))) for ring in (square, hole)])
    node = np.array([(0.75, 0.0)])
    turn = (math.cos(0.3), math.sin(0.3))
    assert literal.any_inside(node, edges, 0.0, 0.0, 1.0, 0.0)
    assert not literal.any_inside(node - (0.75, 0.0), edges, 0.0, 0.0, 1.0, 0.0)  # in the hole
    assert not literal.any_inside(node, edges, 0.5, 0.0, 1.0, 0.0)
    assert not literal.any_inside(node, edges, 0.0, -1.3, *turn)
    assert literal.any_inside(node, edges, 0.0, -1.1, *turn)


def test_literal_works_where_its_gate_lets_it():
    """Two finely sampled discs have nodes inside each other: the paper's method does as well as ours."""
    from rigidarea.study.peers import get_peer, record
    from rigidarea.study.scene import get_scene

    scene = get_scene("oblique_discs")
    settings = {"stiffness": 1e4, "phase": 0.5}
    ours, literal = (
        scene.measure(record(get_peer(name).build(scene, settings), scene))
        for name in ("rigidarea-explicit", "literal")
    )
    assert literal == pytest.approx(ours, rel=0.2)


def test_verdicts_and_variants():
    """Limits, numbers that are none, settings changed and engines dropped."""
    assert judge(0.5, 1.0, "broke") == (PASS, 0.5)
    assert judge(2.0, 1.0, "broke") == ("broke", 2.0)
    assert judge(math.nan, 1.0, "broke") == ("not finite", math.inf)
    changed = engines(pymunk={"steps": 8}, literal=None)
    assert changed["pymunk"].settings["steps"] == 8
    assert "literal" not in changed
    with pytest.raises(ValueError, match="unknown map 'x'"):
        get_map("x")


def test_atlas_rows(tmp_path):
    """Rows carry the promised keys; a second call finds everything done."""
    report = atlas.atlas(tmp_path, quick=True, map_names=["seams"], peer_names=["pymunk"], workers=0)
    assert set(report["results"][0]) == {"map", "peer", "x", "y", "verdict", "measure"}
    before = (tmp_path / "atlas.jsonl").stat().st_mtime_ns
    again = atlas.atlas(tmp_path, quick=True, map_names=["seams"], peer_names=["pymunk"], workers=0)
    assert again["results"] == report["results"]
    assert (tmp_path / "atlas.jsonl").stat().st_mtime_ns == before
