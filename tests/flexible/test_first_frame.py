"""A game's first frame with flexible parts is like its others."""

import pymunk
import pytest

import rigidarea as ra
from rigidarea import shapes
from rigidarea.flexible import Assembly, Material
from rigidarea.flexible import assembly as module

numba = pytest.importorskip("numba")


def test_a_frame_compiles_nothing(monkeypatch):
    """What a frame calls has been called with the same types in attach()."""
    space = pymunk.Space()
    assembly = Assembly(k=1e7)
    block = shapes.box(0.4, 0.2)
    for x, speed in ((0.45, -0.5), (0.0, 1.0)):
        body = block.body(density=115.0)
        body.position, body.velocity = (x, 0.0), (speed, 0.1)
        shape = block.add_to(body)
        space.add(body, shape)
        assembly.part(shape, Material(5e7, 0.45, 1150.0, 0.1), level="rigid")
    space.add(pymunk.PivotJoint(space.static_body, body, (0.0, 0.0)))
    called = []

    def spied(name, function):
        def spy(*given):
            called.append((name, tuple(str(numba.typeof(g)) for g in given)))
            return function(*given)

        return spy

    for name in ("gather", "advance", "give_back"):
        monkeypatch.setattr(module, name, spied(name, getattr(module, name)))
    ra.attach(space, flexible=assembly)
    ready = set(called)
    called.clear()
    for _ in range(5):
        space.step(1 / 60)
    assert {name for name, _ in called} == {"gather", "advance", "give_back"}
    assert set(called) <= ready
