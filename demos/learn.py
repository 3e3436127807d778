"""Learn to put a peg into a slot, or to push a box to a goal: CMA-ES on a policy of a few weights, in a minute.

    python demos/learn.py --seeds 3 --out learn.png

All episodes of a generation (every candidate from the same starts) are worlds of one vector environment. Needs
`pip install 'rigidarea[learn]'`.
"""

from __future__ import annotations

import argparse
import time

import cma
import gymnasium
import numpy as np
from numpy.typing import NDArray

import rigidarea.gym  # noqa: F401 - registers the environments

CANDIDATES, EPISODES, TESTS, STEPS = 24, 8, 100, 120
CURVES = ("#0072b2", "#e69f00", "#009e73", "#cc79a7", "#56b4e9")  # Okabe and Ito's: told apart by all


def act(weights: NDArray[np.float64], observed: NDArray[np.float32]) -> NDArray[np.float64]:
    """Linear in what is seen, squashed: weights (k, actions * (observations + 1)), seen (k, episodes, observations)."""
    seen = np.concatenate([observed, np.ones((*observed.shape[:2], 1))], axis=2)
    return np.tanh(seen @ weights.reshape(len(weights), -1, seen.shape[2]).transpose(0, 2, 1))


def play(
    envs: gymnasium.vector.VectorEnv, weights: NDArray[np.float64], seed: int
) -> tuple[NDArray, NDArray]:
    """Each candidate's mean return, and share of its episodes that succeed: from starts seed, seed + 1, ..."""
    k, n = len(weights), envs.num_envs
    observed, _ = envs.reset(seed=[seed + i % (n // k) for i in range(n)])
    total, success, over = np.zeros(n), np.zeros(n, bool), np.zeros(n, bool)
    for _ in range(STEPS):
        actions = act(weights, observed.reshape(k, n // k, -1)).reshape(n, -1)
        observed, reward, ended, cut, info = envs.step(actions)
        total += reward * ~over
        success |= info["is_success"] & ~over
        over |= ended | cut
        if over.all():
            break
    return total.reshape(k, -1).mean(axis=1), success.reshape(k, -1).mean(axis=1)


def learn(name: str, seed: int, seconds: float, generations: int = 10**6) -> list[tuple[float, float, float]]:
    """Learn for so long; after each generation: seconds of learning, mean return, share of TESTS episodes that succeed.

    Those begin where nobody learned from; they are no part of learning, and not of its time.
    """
    make = {"max_steps": STEPS, "vectorization_mode": "vector_entry_point"}
    envs = gymnasium.make_vec(name, num_envs=CANDIDATES * EPISODES, **make)
    tests = gymnasium.make_vec(name, num_envs=TESTS, **make)
    weights = envs.single_action_space.shape[0] * (envs.single_observation_space.shape[0] + 1)
    search = cma.CMAEvolutionStrategy(
        np.zeros(weights), 1.0, {"popsize": CANDIDATES, "seed": seed + 1, "verbose": -9, "maxiter": np.inf}
    )
    curve, gone = [], 0.0
    for generation in range(generations + 1):
        returns, success = play(tests, search.mean[None], 0)  # learning begins with 1000
        curve.append((gone, float(returns[0]), float(success[0])))
        if gone > seconds:
            break
        start = time.perf_counter()
        candidates = search.ask()
        returns, _ = play(envs, np.array(candidates), 1000 * (1 + 1000 * seed + generation))
        search.tell(candidates, (-returns).tolist())
        gone += time.perf_counter() - start
    return curve


def draw(curves: dict[str, list], out: str, name: str) -> None:
    """Share of successes over time, a line a seed."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(7, 3.5), layout="constrained")
    axes = figure.subplots()
    for (label, curve), colour, dash in zip(curves.items(), CURVES, ("-", "--", "-.", ":", (0, (5, 1)))):
        seconds, _, success = np.array(curve).T
        axes.plot(seconds, 100 * success, color=colour, linestyle=dash, marker="o", ms=3, label=label)
    axes.set(
        xlabel="learning time (s)",
        ylabel=f"successes in {TESTS} new episodes (%)",
        ylim=(-3, 103),
        title=name,
    )
    axes.legend(frameon=False, loc="lower right")
    figure.savefig(out, dpi=120)


def main(arguments: list[str] | None = None) -> dict[str, list]:
    """The command; returns the curves by seed."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("--env", default="rigidarea/PegInSlot-v0")
    parser.add_argument("--seeds", type=int, default=1)
    parser.add_argument("--seconds", type=float, default=60.0)
    parser.add_argument("--generations", type=int, default=10**6)
    parser.add_argument("--out", help="a picture of the curves")
    given = parser.parse_args(arguments)
    curves = {}
    for seed in range(given.seeds):
        curves[f"seed {seed}"] = curve = learn(given.env, seed, given.seconds, given.generations)
        for gone, value, success in curve:
            print(
                f"seed {seed}: {gone:5.1f} s, return {value:6.2f}, {100 * success:3.0f} % succeed", flush=True
            )
    if given.out:
        draw(curves, given.out, given.env)
    return curves


if __name__ == "__main__":
    main()
