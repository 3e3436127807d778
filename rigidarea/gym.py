"""A gymnasium environment in which contact is the task: a peg goes into a slot that is hardly wider than it.

    import gymnasium, rigidarea.gym
    env = gymnasium.make("rigidarea/PegInSlot-v0", render_mode="rgb_array")

Needs `pip install 'rigidarea[gym]'`. Lengths in cm, forces in N, time in s, seen from above: there is no gravity.
"""

from __future__ import annotations

import math
from typing import Any

import gymnasium
import numpy as np
import pymunk
from gymnasium import spaces
from numpy.typing import NDArray

from .chipmunk import attach
from .geometry.gate import not_negative, whole
from .geometry.outline import Outline

PEG = (2.0, 6.0)
"""Width and length of the peg (cm); it points down its own -y."""
DEPTH = 4.0
"""Of the slot (cm)."""
REACH = 12.0
"""The peg's middle may go this far from the slot's mouth (cm)."""
FORCE = 0.5
"""What an action of 1 pushes with (N)."""
TURN, TORQUE = 2.0, 2.0
"""The angular velocity that an action of 1 asks for (1/s), and the torque with which it is held to it (N cm)."""
MASS = 0.1
"""Of the peg (kg: N s²/m; forces are taken per cm by the factor 100)."""
DRAG = 4.0
"""The table's: velocity is lost with this rate (1/s)."""
SINKING = 1e-3
"""How deep the largest force may press a face of the peg's width into a wall, over that width."""
FRAME = 1 / 30
"""One action (s)."""
SUCCESS = 0.95
"""Share of the slot's depth that counts as in."""


class PegInSlot(gymnasium.Env[NDArray[np.float32], NDArray[np.float32]]):
    """Push and turn a peg into a slot.

    Action: (3,) in -1 to 1, force along x and y in the world, angular velocity wanted. Observation: (7,) float32, x
    and y of the peg's middle relative to the slot's mouth (over REACH), sine and cosine of its angle, velocity (over
    REACH a second), angular velocity (over a turn a second). Reward: how much nearer the peg's tip came to the slot's
    bottom (cm), and 10 when it is in. The episode ends then, or when the peg leaves its reach; it is cut off after
    `max_steps`.

    clearance: slot's width less the peg's (cm, > 0). friction: of the pair (>= 0).
    Raises ValueError for these out of range, and for an unknown render mode.
    """

    metadata = {"render_modes": ["rgb_array"], "render_fps": round(1 / FRAME)}  # noqa: RUF012 - gymnasium's own form

    def __init__(
        self,
        render_mode: str | None = None,
        *,
        clearance: float = 0.05,
        friction: float = 0.2,
        max_steps: int = 300,
    ) -> None:
        if not (render_mode is None or (isinstance(render_mode, str) and render_mode == "rgb_array")):
            raise ValueError(f"render_mode must be None or 'rgb_array', got {render_mode!r}")
        if not (isinstance(clearance, int | float | np.integer | np.floating) and 0 < clearance < PEG[0]):
            raise ValueError(f"clearance must be between 0 and {PEG[0]:g}, got {clearance!r}")
        self.render_mode = render_mode
        self.clearance, self.friction = float(clearance), not_negative(friction, "friction")
        self.max_steps = whole(max_steps, "max_steps", 1)
        self.action_space = spaces.Box(-1.0, 1.0, (3,), np.float32)
        # the episode ends at the reach, but speed has no bound of its own
        self.observation_space = spaces.Box(-np.inf, np.inf, (7,), np.float32)
        self._outlines()
        self._done_steps = 0

    def _outlines(self) -> None:
        half, wide = (PEG[0] + self.clearance) / 2, 2 * REACH
        block = [(-wide, 0), (-wide, -DEPTH - 3), (wide, -DEPTH - 3), (wide, 0)]
        self.slot = Outline([*block, (half, 0), (half, -DEPTH), (-half, -DEPTH), (-half, 0)])
        w, h = PEG[0] / 2, PEG[1] / 2
        chamfer = 0.1 * w  # without one the corners catch
        tip = [(-w, chamfer - h), (chamfer - w, -h), (w - chamfer, -h), (w, chamfer - h)]
        self.peg = Outline([*tip, (w, h), (-w, h)])

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[NDArray[np.float32], dict[str, Any]]:
        """A peg somewhere above the block, turned by up to 30 degrees; the same for the same seed."""
        super().reset(seed=seed)
        self.build(*start(self.np_random))
        self._done_steps = 0
        self._far = self._distance()
        return self._observation(), self._info()

    def build(self, x: float, y: float, angle: float) -> pymunk.Space:
        """The space with the peg there (cm; angle in radians), attached."""
        space = pymunk.Space()
        space.damping = math.exp(-DRAG)
        space.add(self.slot.add_to(space.static_body, friction=math.sqrt(self.friction)))
        self._body = self.peg.body(mass=MASS)
        self._body.angle = angle
        self._body.position = x, y
        self._wrist = pymunk.SimpleMotor(space.static_body, self._body, 0.0)
        self._wrist.max_force = 100 * TORQUE
        space.add(self._body, self.peg.add_to(self._body, friction=math.sqrt(self.friction)), self._wrist)
        self._space = space
        # F = k A: 100 for kg cm/s² a newton
        self._contact = attach(space, stiffness=100 * FORCE / (SINKING * PEG[0] ** 2))
        return space

    def step(
        self, action: NDArray[np.float32]
    ) -> tuple[NDArray[np.float32], float, bool, bool, dict[str, Any]]:
        """One action for FRAME seconds. ValueError for another shape, and for values that are not finite."""
        try:
            given = np.asarray(action, dtype=np.float64)
        except (TypeError, ValueError, OverflowError):
            raise ValueError(f"action must be 3 finite numbers, got {action!r:.80}") from None
        if given.shape != (3,) or not np.isfinite(given).all():
            raise ValueError(f"action must be 3 finite numbers, got {action!r:.80}")
        push = np.clip(given, -1.0, 1.0)
        # the peg is the only body that moves, so gravity is the hand; a force would act in the first substep alone
        self._space.gravity = tuple((100 * FORCE / MASS * push[:2]).tolist())
        self._wrist.rate = -TURN * float(push[2])
        self._contact.step(FRAME)
        self._done_steps += 1
        before, self._far = self._far, self._distance()
        info = self._info()
        reward = before - self._far + 10.0 * info["is_success"]
        lost = self._body.position.length > REACH
        cut = self._done_steps >= self.max_steps
        return self._observation(), float(reward), bool(info["is_success"] or lost), cut, info

    def render(self) -> NDArray[np.uint8] | None:  # type: ignore[override]
        """The picture of now, (300, 400, 3) uint8, if the render mode is rgb_array."""
        if self.render_mode is None:
            return None
        import pygame

        surface = pygame.Surface((400, 300))
        surface.fill((252, 252, 250))
        scale = 400 / (2 * REACH)

        def place(x: float, y: float) -> tuple[float, float]:
            return 200 + scale * x, 190 - scale * y

        pygame.draw.polygon(surface, (176, 181, 188), [place(x, y) for x, y in self.slot.rings[0].tolist()])
        corners = [self._body.local_to_world(tuple(point)) for point in self.peg.rings[0].tolist()]
        pygame.draw.polygon(surface, (230, 159, 0), [place(*corner) for corner in corners])
        pixels: NDArray[np.uint8] = pygame.surfarray.array3d(surface).swapaxes(0, 1).copy()
        return pixels

    def _state(self) -> NDArray[np.float64]:
        body = self._body
        return np.array([[*body.position, body.angle, *body.velocity, body.angular_velocity]])

    def _distance(self) -> float:
        return float(distance(self._state())[0])

    def _info(self) -> dict[str, Any]:
        depth = float(depth_in(self._state(), self.clearance)[0])
        return {"depth": depth, "is_success": depth >= SUCCESS, "regions": len(self._contact.regions)}

    def _observation(self) -> NDArray[np.float32]:
        return observation(self._state())[0]


# --- the task, for many pegs at once: states (k, 6) are x, y, angle, vx, vy, angular velocity ---


def start(draw: np.random.Generator) -> tuple[float, float, float]:
    """x, y, angle of a peg somewhere above the block, turned by up to 30 degrees."""
    angle = float(draw.uniform(-math.pi / 6, math.pi / 6))
    return float(draw.uniform(-3, 3)), float(draw.uniform(5, 7)), angle


def tip(states: NDArray[np.float64]) -> NDArray[np.float64]:
    """(k, 2): the middles of the tips (cm)."""
    half, angle = PEG[1] / 2, states[:, 2]
    return np.stack([states[:, 0] + half * np.sin(angle), states[:, 1] - half * np.cos(angle)], axis=1)


def distance(states: NDArray[np.float64]) -> NDArray[np.float64]:
    """(k,): of the tips from the slot's bottom (cm)."""
    return np.hypot(tip(states)[:, 0], tip(states)[:, 1] + DEPTH)


def depth_in(states: NDArray[np.float64], clearance: float) -> NDArray[np.float64]:
    """(k,): how deep the tips are in the slot, over its depth."""
    x, y = tip(states).T
    return np.where(np.abs(x) < (PEG[0] + clearance) / 2, np.clip(-y / DEPTH, 0.0, 1.0), 0.0)


def observation(states: NDArray[np.float64]) -> NDArray[np.float32]:
    """(k, 7): what `PegInSlot` shows."""
    x, y, angle, vx, vy, w = states.T
    place = [x / REACH, y / REACH, np.sin(angle), np.cos(angle)]
    return np.stack([*place, vx / REACH, vy / REACH, w / math.tau], axis=1).astype(np.float32)


for _name in ("PegInSlot", "PushToGoal"):
    if f"rigidarea/{_name}-v0" not in gymnasium.registry:
        gymnasium.register(
            f"rigidarea/{_name}-v0",
            entry_point=f"rigidarea.{'gym' if _name == 'PegInSlot' else 'vector'}:{_name}",
            vector_entry_point=f"rigidarea.vector:{_name}Vector",
        )
