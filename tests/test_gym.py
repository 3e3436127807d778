"""The gymnasium environment: gymnasium's own checks, the same run for the same seed, and a task that can be done."""

import math

import numpy as np
import pytest

gymnasium = pytest.importorskip("gymnasium")

from rigidarea.gym import DEPTH, PEG, PegInSlot, tip  # noqa: E402


def test_gymnasiums_own_checks():
    pytest.importorskip("pygame")
    from gymnasium.utils.env_checker import check_env

    env = gymnasium.make("rigidarea/PegInSlot-v0", render_mode="rgb_array")
    check_env(env.unwrapped)
    env.close()


def rollout(seed: int) -> list[np.ndarray]:
    env = PegInSlot()
    first, _ = env.reset(seed=seed)
    actions = np.random.default_rng(seed)
    return [first] + [env.step(actions.uniform(-1, 1, 3))[0] for _ in range(40)]


def test_the_same_seed_is_the_same_run():
    np.testing.assert_array_equal(rollout(3), rollout(3))
    assert not np.array_equal(rollout(3)[0], rollout(4)[0])


def push(env: PegInSlot) -> np.ndarray:
    """Turn upright, come over the mouth, then press: a hand that knows the task."""
    body = env._body
    ready = abs(body.position.x) < 0.02 and abs(body.angle) < 0.01
    above = PEG[1] / 2 + 0.5  # of its middle, while it is not ready
    x = -(16 * body.position.x + 4 * body.velocity.x) / 500
    y = (16 * (above - body.position.y) - 4 * body.velocity.y) / 500
    if ready or body.position.y < PEG[1] / 2:
        y = -0.1
    return np.clip([x, y, -2 * body.angle], -1, 1)


@pytest.mark.parametrize("seed", range(3))
def test_the_peg_goes_in_and_not_through(seed):
    env = PegInSlot()
    env.reset(seed=seed)
    deepest, total = 0.0, 0.0
    start = env._distance()
    for _ in range(env.max_steps):
        _, reward, ended, cut, info = env.step(push(env))
        total += reward
        deepest = min(deepest, tip(env._state())[0, 1])
        if ended or cut:
            break
    assert ended and info["is_success"] and info["depth"] >= 0.95
    assert deepest > -DEPTH - 0.01 * PEG[0]  # ten times what the largest force may sink
    assert total == pytest.approx(start - env._distance() + 10)


def test_a_block_without_a_slot_in_the_way_holds():
    """Pressed on the block beside the slot, the peg does not go in."""
    env = PegInSlot()
    env.reset(seed=0)
    env._body.position, env._body.angle = (5.0, PEG[1] / 2 + 0.01), 0.0
    for _ in range(30):
        _, _, _, _, info = env.step(np.array([0.0, -1.0, 0.0]))
    assert info["depth"] == 0 and info["regions"] >= 1
    assert tip(env._state())[0, 1] > -0.02 * PEG[0] and abs(env._body.angle) < math.radians(1)


def test_render_shows_the_peg():
    pytest.importorskip("pygame")
    env = PegInSlot(render_mode="rgb_array")
    env.reset(seed=1)
    picture = env.render()
    assert picture.shape == (300, 400, 3) and picture.dtype == np.uint8
    orange = (np.abs(picture.astype(int) - (230, 159, 0)) < 5).all(axis=2).mean()
    scale = 400 / 24
    assert orange == pytest.approx(PEG[0] * PEG[1] * scale**2 / (300 * 400), rel=0.1)
    assert PegInSlot().render() is None


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"render_mode": "human"}, "render_mode must be None or 'rgb_array', got 'human'"),
        ({"clearance": 0}, "clearance must be between 0 and 2, got 0"),
        ({"friction": -1}, "friction must be finite and not negative, got -1"),
        ({"max_steps": 0}, "max_steps must be a whole number of at least 1, got 0"),
    ],
)
def test_bad_settings_are_refused(arguments, message):
    with pytest.raises(ValueError, match=message):
        PegInSlot(**arguments)


def test_a_clearance_may_be_numpys():
    assert PegInSlot(clearance=np.float32(0.125)).clearance == PegInSlot(clearance=0.125).clearance


@pytest.mark.parametrize("action", [[0, 0], [0, 0, math.nan], "push"])
def test_bad_actions_are_refused(action):
    env = PegInSlot()
    env.reset(seed=0)
    before = env._body.position
    with pytest.raises(ValueError):
        env.step(action)
    assert env._body.position == before
