"""The vector environments: gymnasium's checks and wrappers, the same bits for one and many, a task that can be done."""

import numpy as np
import pytest

gymnasium = pytest.importorskip("gymnasium")

import rigidarea.gym  # noqa: E402
from rigidarea.vector import BOX, HAND, NEAR, PegInSlotVector, PushToGoal, PushToGoalVector  # noqa: E402

BOTH = ["PegInSlot", "PushToGoal"]


def make(name: str, n: int, **more):
    return gymnasium.make_vec(
        f"rigidarea/{name}-v0", num_envs=n, vectorization_mode="vector_entry_point", **more
    )


def test_gymnasiums_own_checks_of_the_second_task():
    pytest.importorskip("pygame")
    from gymnasium.utils.env_checker import check_env

    env = gymnasium.make("rigidarea/PushToGoal-v0", render_mode="rgb_array")
    check_env(env.unwrapped)
    env.close()


@pytest.mark.parametrize("name", BOTH)
def test_one_or_many_the_same_seed_is_the_same_bits(name):
    """Environment i of seed s is the single one of seed s + i: rewards, ends and the episodes after them too."""
    n, seed, steps = 7, 11, 50
    envs = make(name, n, max_steps=30)
    singles = [gymnasium.make(f"rigidarea/{name}-v0", max_steps=30) for _ in range(n)]
    many, _ = envs.reset(seed=seed)
    for i, env in enumerate(singles):
        np.testing.assert_array_equal(env.reset(seed=seed + i)[0], many[i])
    draw = np.random.default_rng(0)
    over = np.zeros(n, bool)
    for _ in range(steps):
        actions = draw.uniform(-1, 1, envs.action_space.shape).astype(np.float32)
        many, rewards, ended, cut, _ = envs.step(actions)
        for i, env in enumerate(singles):
            if over[i]:
                np.testing.assert_array_equal(env.reset()[0], many[i])
                assert rewards[i] == 0 and not (ended[i] or cut[i])
                continue
            one, reward, end, stop, _ = env.step(actions[i])
            np.testing.assert_array_equal(one, many[i])
            assert (reward, end, stop) == (rewards[i], ended[i], cut[i])
        over = ended | cut
    assert cut.any() or steps > 30


@pytest.mark.parametrize("name", BOTH)
def test_the_same_seed_is_the_same_bits_in_one_or_a_thousand_whatever_the_threads(name):
    """All that is returned, through ends of episodes and new beginnings."""
    seed, steps = 5, 30

    def run(n: int, threads: int, first: int = 0) -> np.ndarray:
        envs = make(name, n, max_steps=20, threads=threads)
        draw = np.random.default_rng(2)
        returned = [np.c_[envs.reset(seed=seed + first)[0], np.zeros((n, 3))]]
        for _ in range(steps):
            actions = draw.uniform(-1, 1, (1024, *envs.single_action_space.shape))
            observed, reward, ended, cut, _ = envs.step(actions[first : first + n])
            returned.append(np.c_[observed, reward, ended, cut])
        return np.array(returned)

    many = run(1024, 2)
    np.testing.assert_array_equal(run(1024, 1), many)
    np.testing.assert_array_equal(run(16, 5), many[:, :16])
    for i in (0, 1, 511, 1023):
        np.testing.assert_array_equal(run(1, 1, i), many[:, [i]])
    assert many[:, :, -1].any() and not np.array_equal(many[:, 0], many[:, 1])


@pytest.mark.parametrize("name", BOTH)
def test_wrappers_of_vectors_pass(name):
    from gymnasium.wrappers.vector import ClipAction, NormalizeObservation, RecordEpisodeStatistics

    envs = RecordEpisodeStatistics(NormalizeObservation(ClipAction(make(name, 5, max_steps=10))))
    observed, _ = envs.reset(seed=1)
    assert observed.shape == envs.observation_space.shape
    seen = 0
    for _ in range(25):
        observed, rewards, _, _, info = envs.step(3 * envs.action_space.sample())
        assert observed.dtype == np.float32 and rewards.shape == (5,)
        seen += int(info["_episode"].sum()) if "episode" in info else 0
    assert seen >= 10
    envs.close()


def test_a_mask_resets_some():
    envs = make("PushToGoal", 4)
    first, _ = envs.reset(seed=2)
    for _ in range(5):
        moved = envs.step(np.ones((4, 2), np.float32))[0]
    mask = np.array([True, False, False, True])
    again, _ = envs.reset(seed=2, options={"reset_mask": mask})
    np.testing.assert_array_equal(again[mask], first[mask])
    np.testing.assert_array_equal(again[~mask], moved[~mask])


def test_a_box_is_pushed_to_the_goal_and_nothing_goes_through_it():
    """From behind the middle of a face, in eight directions: gently, so that no frame passes the goal."""
    n, far = 8, 4.0
    envs = PushToGoalVector(n)
    envs.reset(seed=4)
    turns = np.arange(n) * np.pi / 4
    way = np.stack([np.cos(turns), np.sin(turns)], axis=1)
    states = np.zeros((n, 2, 6))
    states[:, 0, :2] = -(BOX[0] / 2 + HAND + 0.5) * way
    states[:, 1, 2] = turns
    envs._begin(np.arange(n))
    envs.worlds.put(states)
    envs._states, envs._goals = states, far * way
    envs._far = envs.task.far(states, envs._goals)
    done, total, first = np.zeros(n, bool), np.zeros(n), envs._far.copy()
    while not done.all():
        assert envs._steps.max() < 90
        _, rewards, ended, _, info = envs.step(0.2 * way * ~done[:, None])
        total[~done] += rewards[~done]
        apart = np.hypot(*(envs._states[:, 0, :2] - envs._states[:, 1, :2]).T)
        assert (apart[~done] > HAND + BOX[0] / 2 - 0.02).all()
        last = np.where(ended, envs._far, np.nan)
        new = info["is_success"] & ~done
        np.testing.assert_allclose(total[new], (first - last + 10)[new])
        done |= ended
        if new.any():
            assert (np.hypot(*(envs._states[new, 1, :2] - envs._goals[new]).T) <= NEAR).all()
        envs._over[:] = False  # they would begin anew


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda envs: envs.step(np.zeros((2, 3))), "actions must be finite"),
        (lambda envs: envs.step(np.full((3, 3), np.nan)), "actions must be finite"),
        (lambda envs: envs.reset(seed=[1, 2]), "seed must be a number or 3 of them"),
        (lambda envs: envs.reset(options={"reset_mask": [1, 0, 1]}), "reset_mask must be 3 booleans"),
    ],
)
def test_bad_arguments_are_refused(call, message):
    envs = PegInSlotVector(3)
    envs.reset(seed=0)
    with pytest.raises(ValueError, match=message):
        call(envs)


def test_before_a_reset_there_is_no_step():
    with pytest.raises(gymnasium.error.ResetNeeded):
        PegInSlotVector(2).step(np.zeros((2, 3)))
    with pytest.raises(ValueError, match="render_mode must be None or 'rgb_array'"):
        PushToGoal(render_mode="human")
    assert rigidarea.gym.PegInSlot().render() is None
