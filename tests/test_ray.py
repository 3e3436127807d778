"""Vector environments and sweeps under Ray, as Ray's users do it: the bits of one process."""

from __future__ import annotations

import numpy as np
import pytest

ray = pytest.importorskip("ray")
pytest.importorskip("gymnasium")

from rigidarea.vector import PushToGoalVector  # noqa: E402
from test_cluster import slid  # noqa: E402


@pytest.fixture(scope="module", autouse=True)
def cluster():
    """Two processes of this machine."""
    ray.init(num_cpus=2, include_dashboard=False, log_to_driver=False)
    yield
    ray.shutdown()


def test_environments_as_actors_are_one_environment():
    """Two actors of four are one of eight, to the bit: seeds s to s + 3, and s + 4 on."""
    actors = [ray.remote(PushToGoalVector).remote(4, threads=1, max_steps=20) for _ in range(2)]
    whole = PushToGoalVector(8, threads=2, max_steps=20)
    first, _ = whole.reset(seed=5)
    parts = ray.get([actor.reset.remote(seed=5 + 4 * k) for k, actor in enumerate(actors)])
    np.testing.assert_array_equal(np.concatenate([part[0] for part in parts]), first)
    draw = np.random.default_rng(0)
    for _ in range(45):  # two episodes and a part
        actions = draw.uniform(-1, 1, (8, 2))
        parts = ray.get([a.step.remote(actions[4 * k : 4 * k + 4]) for k, a in enumerate(actors)])
        for k, expected in enumerate(whole.step(actions)[:4]):
            np.testing.assert_array_equal(np.concatenate([part[k] for part in parts]), expected)


def test_a_sweep_is_the_loop():
    far = ray.get([ray.remote(slid).remote(friction, 3) for friction in (0.1, 0.3, 0.9)])
    assert far == [slid(friction, 3) for friction in (0.1, 0.3, 0.9)]
