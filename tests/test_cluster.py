"""Vector environments and sweeps on a Dask cluster, as Dask's users do it: the bits of one process."""

from __future__ import annotations

import numpy as np
import pytest

distributed = pytest.importorskip("distributed")
pytest.importorskip("gymnasium")

from rigidarea.vector import PushToGoalVector  # noqa: E402


@pytest.fixture(scope="module")
def client():
    """Two workers, processes of their own."""
    with (
        distributed.LocalCluster(
            n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None, host="127.0.0.1"
        ) as cluster,
        distributed.Client(cluster) as client,
    ):
        yield client


def test_environments_as_actors_are_one_environment(client):
    """Two actors of four, where each worker has one, are one of eight, to the bit: seeds s to s + 3, and s + 4 on."""
    actors = [
        client.submit(PushToGoalVector, 4, threads=1, max_steps=20, actor=True, workers=[worker]).result()
        for worker in client.scheduler_info()["workers"]
    ]
    assert len(actors) == 2
    whole = PushToGoalVector(8, threads=2, max_steps=20)
    first, _ = whole.reset(seed=5)
    parts = [actor.reset(seed=5 + 4 * k) for k, actor in enumerate(actors)]
    np.testing.assert_array_equal(np.concatenate([part.result()[0] for part in parts]), first)
    draw = np.random.default_rng(0)
    for _ in range(45):  # two episodes and a part
        actions = draw.uniform(-1, 1, (8, 2))
        asked = [actor.step(actions[4 * k : 4 * k + 4]) for k, actor in enumerate(actors)]
        parts = [future.result() for future in asked]
        for k, expected in enumerate(whole.step(actions)[:4]):
            np.testing.assert_array_equal(np.concatenate([part[k] for part in parts]), expected)


def slid(friction: float, seed: int) -> float:
    """How far boxes of this friction have slid down a slope of 1 in 2 (px), in eight worlds of random masses."""
    import pymunk

    import rigidarea as ra
    from rigidarea.worlds import Worlds

    space = pymunk.Space()
    space.gravity = 50, -100
    floor = pymunk.Segment(space.static_body, (-500, 0), (5000, 0), 5)
    box = pymunk.Body(1, 100)
    box.position = 0, 15
    shape = pymunk.Poly.create_box(box, (20, 20))
    floor.friction = shape.friction = friction**0.5
    space.add(floor, box, shape)
    ra.attach(space)
    worlds = Worlds(space, 8, threads=1)
    masses = np.random.default_rng(seed).uniform(1, 4, (8, 1))
    worlds.set_mass(masses, 100 * masses)
    return float(worlds.step(1 / 60, frames=120)[:, 0, 0].mean())


def test_a_sweep_is_the_same_on_the_cluster(client):
    frictions, seeds = [0.1, 0.3, 0.45, 0.6], [0, 1, 2, 3]
    far = client.gather(client.map(slid, frictions, seeds))
    assert far == [slid(mu, seed) for mu, seed in zip(frictions, seeds)]
    expected = [max(0.0, 0.5 * (50 - 100 * mu) * 2.0**2) for mu in frictions]
    np.testing.assert_allclose(far, expected, atol=2.0)  # it sinks to where it rests first
