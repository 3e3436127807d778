"""Environments of many worlds at once (`gymnasium.vector.VectorEnv`), and a second task: push a box to a goal.

    import gymnasium, rigidarea.gym
    envs = gymnasium.make_vec("rigidarea/PegInSlot-v0", 1024, vectorization_mode="vector_entry_point")

Needs `pip install 'rigidarea[gym]'`. Lengths in cm, forces in N, time in s. Environment i of seed
s does what a single one of seed s + i does, to the bit, however many there are.
"""

from __future__ import annotations

import math
from typing import Any, ClassVar

import gymnasium
import numpy as np
import pymunk
from gymnasium import spaces
from gymnasium.utils import seeding
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space
from numpy.typing import NDArray

from . import gym
from .chipmunk import attach
from .geometry.gate import whole
from .worlds import Worlds

FRAME = gym.FRAME
"""One action (s)."""
ROOM = 10.0
"""The box and the hand of `PushToGoal` stay within this far from the middle (cm)."""
BOX = (3.0, 2.0)
"""Width and length of the box that is pushed (cm)."""
HAND = 0.75
"""Radius of the hand (cm)."""
NEAR = 0.5
"""The box is at the goal when its middle is so near (cm)."""


class PegTask:
    """`PegInSlot` for many pegs: what it asks of worlds and says of their states (k, bodies, 6)."""

    actions, observations, success = 3, 7, gym.SUCCESS

    def __init__(self, max_steps: int = 300, **settings: Any) -> None:
        self._one = gym.PegInSlot(max_steps=max_steps, **settings)
        self.max_steps = self._one.max_steps

    def space(self) -> pymunk.Space:
        """An attached space, as it is copied."""
        return self._one.build(0.0, 6.0, 0.0)

    def start(self, draw: np.random.Generator) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """States (bodies, 6) to begin with, and the goal's numbers."""
        x, y, angle = gym.start(draw)
        return np.array([[x, y, angle, 0.0, 0.0, 0.0]]), np.zeros(0)

    def act(self, worlds: Worlds, actions: NDArray[np.float64]) -> NDArray[np.float64] | None:
        """What actions (n, actions) of -1 to 1 do: parameters of the worlds, or forces (n, bodies, 3)."""
        worlds.gravity[:] = 100 * gym.FORCE / gym.MASS * actions[:, :2]
        worlds.joint(0)[:, 0] = -gym.TURN * actions[:, 2]
        return None

    def observe(self, states: NDArray[np.float64], goals: NDArray[np.float64]) -> NDArray[np.float32]:
        """(k, observations)."""
        return gym.observation(states[:, 0])

    def far(self, states: NDArray[np.float64], goals: NDArray[np.float64]) -> NDArray[np.float64]:
        """(k,): how far from done (cm); what it shrinks by is the reward."""
        return gym.distance(states[:, 0])

    def done(self, states: NDArray[np.float64], goals: NDArray[np.float64]) -> tuple[Any, Any]:
        """(k,) each: whether it is done, and whether it is lost."""
        inside = gym.depth_in(states[:, 0], self._one.clearance) >= gym.SUCCESS
        return inside, np.hypot(states[:, 0, 0], states[:, 0, 1]) > gym.REACH


class PushTask:
    """A round hand pushes a box over a table to a goal; seen from above, within four walls."""

    actions, observations = 2, 13

    def __init__(self, max_steps: int = 300) -> None:
        self.max_steps = whole(max_steps, "max_steps", 1)

    def space(self) -> pymunk.Space:
        """An attached space: the hand and the box."""
        space = pymunk.Space()
        space.damping = math.exp(-gym.DRAG)
        corners = [(-ROOM, -ROOM), (ROOM, -ROOM), (ROOM, ROOM), (-ROOM, ROOM)]
        for a, b in zip(corners, [*corners[1:], corners[0]]):
            wall = pymunk.Segment(space.static_body, a, b, 0.2)
            wall.friction = 0.5
            space.add(wall)
        hand = pymunk.Body(gym.MASS, math.inf)
        box = pymunk.Body(gym.MASS, pymunk.moment_for_box(gym.MASS, BOX))
        box.position = 4.0, 0.0
        shapes = [pymunk.Circle(hand, HAND), pymunk.Poly.create_box(box, BOX)]
        for shape in shapes:
            shape.friction = 0.5
        space.add(hand, box, *shapes)
        attach(space, stiffness=100 * gym.FORCE / (gym.SINKING * min(BOX) ** 2))
        return space

    def start(self, draw: np.random.Generator) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """The box and the goal anywhere within half the room, the hand clear of the box."""
        box, goal = draw.uniform(-ROOM / 2, ROOM / 2, (2, 2))
        angle, where = draw.uniform(-math.pi, math.pi, 2)
        hand = box + 3.0 * np.array([math.cos(where), math.sin(where)])
        return np.array([[*hand, 0.0, 0.0, 0.0, 0.0], [*box, angle, 0.0, 0.0, 0.0]]), goal

    def act(self, worlds: Worlds, actions: NDArray[np.float64]) -> NDArray[np.float64] | None:
        """The hand's force."""
        forces = np.zeros((worlds.n, worlds.bodies, 3))
        forces[:, 0, :2] = 100 * gym.FORCE * actions
        return forces

    def observe(self, states: NDArray[np.float64], goals: NDArray[np.float64]) -> NDArray[np.float32]:
        """(k, 13): hand, box relative to it, goal relative to the box (over ROOM), sine and cosine of the box's angle,
        velocities of both (over ROOM a second), the box's angular velocity (over a turn a second)."""
        hand, box = states[:, 0], states[:, 1]
        angle = box[:, 2:3]
        parts = [hand[:, :2] / ROOM, (box - hand)[:, :2] / ROOM, (goals - box[:, :2]) / ROOM]
        parts += [np.sin(angle), np.cos(angle), hand[:, 3:5] / ROOM]
        parts += [box[:, 3:5] / ROOM, box[:, 5:] / math.tau]
        return np.concatenate(parts, axis=1).astype(np.float32)

    def far(self, states: NDArray[np.float64], goals: NDArray[np.float64]) -> NDArray[np.float64]:
        """Of the box from the goal, and a tenth of the hand from the box (cm)."""
        box = states[:, 1, :2]
        hand = np.hypot(*(states[:, 0, :2] - box).T)
        return np.hypot(*(box - goals).T) + 0.1 * hand

    def done(self, states: NDArray[np.float64], goals: NDArray[np.float64]) -> tuple[Any, Any]:
        """Whether the box is at the goal; it is never lost."""
        near = np.hypot(*(states[:, 1, :2] - goals).T) <= NEAR
        return near, np.zeros(len(near), bool)


class TaskVectorEnv(VectorEnv[Any, Any, Any]):
    """A task in n worlds. An environment whose episode has ended begins anew at the next step (`NEXT_STEP`).

    num_envs: >= 1. threads: see `rigidarea.worlds.Worlds`. settings: the task's.
    """

    task_class: ClassVar[type]
    metadata = {"render_modes": [], "autoreset_mode": AutoresetMode.NEXT_STEP}  # noqa: RUF012 - gymnasium's own form

    def __init__(self, num_envs: int = 1, threads: int | None = None, **settings: Any) -> None:
        self.num_envs = whole(num_envs, "num_envs", 1)
        self.task = self.task_class(**settings)
        self.worlds = Worlds(self.task.space(), self.num_envs, threads)
        self.single_action_space = spaces.Box(-1.0, 1.0, (self.task.actions,), np.float32)
        self.single_observation_space = spaces.Box(-np.inf, np.inf, (self.task.observations,), np.float32)
        self.action_space = batch_space(self.single_action_space, self.num_envs)
        self.observation_space = batch_space(self.single_observation_space, self.num_envs)
        self._draws: list[np.random.Generator | None] = [None] * self.num_envs
        self._states = self.worlds.states
        self._goals: NDArray[np.float64] | None = None
        self._steps = np.zeros(self.num_envs, np.int64)
        self._over = np.ones(self.num_envs, bool)
        self._far = np.zeros(self.num_envs)

    def reset(self, *, seed: Any = None, options: dict[str, Any] | None = None) -> tuple[Any, dict[str, Any]]:
        """All begin anew, or those of `options["reset_mask"]` (n,) bool. seed: the first's, the next has one more; or a
        list of n. ValueError for anything else."""
        seeds = [None] * self.num_envs if seed is None else seed
        if isinstance(seed, int | np.integer):
            seeds = [int(seed) + i for i in range(self.num_envs)]
        if len(seeds) != self.num_envs:
            raise ValueError(f"seed must be a number or {self.num_envs} of them, got {seed!r:.80}")
        mask = np.asarray((options or {}).get("reset_mask", np.ones(self.num_envs, bool)))
        if mask.shape != (self.num_envs,) or mask.dtype != bool:
            raise ValueError(f"reset_mask must be {self.num_envs} booleans, got {mask!r:.80}")
        for i in np.flatnonzero(mask):
            if seeds[i] is not None or self._draws[i] is None:
                self._draws[i] = seeding.np_random(seeds[i])[0]
        self._begin(np.flatnonzero(mask))
        return self.task.observe(self._states, self._goals), {}

    def _begin(self, which: NDArray[np.int64]) -> None:
        """New episodes."""
        if not len(which):
            return
        begun = [self.task.start(self._draws[i]) for i in which]
        if self._goals is None:
            self._goals = np.zeros((self.num_envs, len(begun[0][1])))
        states = np.stack([state for state, _ in begun])
        self.worlds.reset(which)
        self.worlds.put(states, which)
        self._states[which], self._goals[which] = states, np.stack([goal for _, goal in begun])
        self._steps[which], self._over[which] = 0, False
        self._far[which] = self.task.far(self._states[which], self._goals[which])

    def step(self, actions: Any) -> tuple[Any, Any, Any, Any, dict[str, Any]]:
        """One action of each for FRAME seconds. ValueError for another shape, and for values that are not finite."""
        try:
            given = np.asarray(actions, np.float64)
        except (TypeError, ValueError, OverflowError):
            raise ValueError(f"actions must be finite numbers, got {actions!r:.80}") from None
        if given.shape != self.action_space.shape or not np.isfinite(given).all():
            raise ValueError(f"actions must be finite, {self.action_space.shape}, got {actions!r:.80}")
        if self._goals is None:
            raise gymnasium.error.ResetNeeded("reset() before step()")
        fresh = self._over.copy()
        self._begin(np.flatnonzero(fresh))
        go = np.flatnonzero(~fresh)
        forces = self.task.act(self.worlds, np.clip(given, -1.0, 1.0))
        self._states[go] = self.worlds.step(FRAME, None if forces is None else forces[go], which=go)
        self._steps[go] += 1
        far = self.task.far(self._states, self._goals)
        success, lost = self.task.done(self._states, self._goals)
        success, lost = success & ~fresh, lost & ~fresh
        reward = np.where(fresh, 0.0, self._far - far + 10.0 * success)
        self._far = far
        ended, cut = success | lost, (self._steps >= self.task.max_steps) & ~fresh
        self._over = ended | cut
        observed = self.task.observe(self._states, self._goals)
        info = {"is_success": success, "_is_success": np.ones(self.num_envs, bool)}
        return observed, reward, ended, cut, info


class PegInSlotVector(TaskVectorEnv):
    """`rigidarea.gym.PegInSlot` in n worlds: clearance, friction, max_steps are its settings."""

    task_class = PegTask


class PushToGoalVector(TaskVectorEnv):
    """`PushToGoal` in n worlds: max_steps is its setting."""

    task_class = PushTask


class PushToGoal(gymnasium.Env[NDArray[np.float32], NDArray[np.float32]]):
    """Push a box over a table to a goal with a round hand.

    Action: (2,) in -1 to 1, the hand's force (over `rigidarea.gym.FORCE`). Observation: (13,) float32, see
    `PushTask.observe`. Reward: how much nearer the box came to the goal, and a tenth of how much nearer the hand to the
    box (cm); 10 when it is there, where the episode ends; it is cut off after `max_steps`.
    """

    metadata = {"render_modes": ["rgb_array"], "render_fps": round(1 / FRAME)}  # noqa: RUF012 - gymnasium's own form

    def __init__(self, render_mode: str | None = None, *, max_steps: int = 300) -> None:
        if not (render_mode is None or (isinstance(render_mode, str) and render_mode == "rgb_array")):
            raise ValueError(f"render_mode must be None or 'rgb_array', got {render_mode!r}")
        self.render_mode = render_mode
        self._envs = PushToGoalVector(1, threads=1, max_steps=max_steps)
        self.action_space = self._envs.single_action_space
        self.observation_space = self._envs.single_observation_space

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[NDArray[np.float32], dict[str, Any]]:
        """Box, goal and hand anywhere; the same for the same seed."""
        super().reset(seed=seed)
        self._envs._draws[0] = self.np_random
        observed, _ = self._envs.reset()
        return observed[0], {"is_success": False}

    def step(
        self, action: NDArray[np.float32]
    ) -> tuple[NDArray[np.float32], float, bool, bool, dict[str, Any]]:
        """One action for FRAME seconds. ValueError for another shape, and for values that are not finite."""
        given = np.asarray(action, np.float64)
        self._envs._over[:] = False  # a single one goes on until it is reset
        observed, reward, ended, cut, info = self._envs.step(given[None])
        told = {"is_success": bool(info["is_success"][0])}
        return observed[0], float(reward[0]), bool(ended[0]), bool(cut[0]), told

    def render(self) -> NDArray[np.uint8] | None:  # type: ignore[override]
        """The picture of now, (400, 400, 3) uint8, if the render mode is rgb_array."""
        if self.render_mode is None:
            return None
        import pygame

        surface = pygame.Surface((400, 400))
        surface.fill((252, 252, 250))
        scale = 200 / (ROOM + 0.5)

        def place(x: float, y: float) -> tuple[float, float]:
            return 200 + scale * x, 200 - scale * y

        hand, box = self._envs._states[0]
        goals = self._envs._goals
        assert goals is not None  # reset() before render()
        pygame.draw.circle(surface, (0, 158, 115), place(*goals[0]), scale * NEAR, 2)
        c, s, w, h = math.cos(box[2]), math.sin(box[2]), BOX[0] / 2, BOX[1] / 2
        corners = [
            (box[0] + c * x - s * y, box[1] + s * x + c * y) for x, y in ((w, h), (-w, h), (-w, -h), (w, -h))
        ]
        pygame.draw.polygon(surface, (230, 159, 0), [place(*corner) for corner in corners])
        pygame.draw.circle(surface, (0, 114, 178), place(hand[0], hand[1]), scale * HAND)
        pixels: NDArray[np.uint8] = pygame.surfarray.array3d(surface).swapaxes(0, 1).copy()
        return pixels
