"""What a run of a program did: where its bodies were, frame by frame, and the measures in which runs are compared."""

from __future__ import annotations

import itertools
import math
import time
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np
import pymunk
import pymunk.batch
from numpy.typing import NDArray

from rigidarea.programs.host import Host

#: A body slower than this rests (length/time): pymunk's examples count in pixels, their bodies are 10 to 50 wide.
REST_SPEED = 10.0
#: Frames at a run's end over which rest is judged.
LAST = 30
#: Frames for which a body must have been there before that: who has just come is still on the way.
SETTLING = 120

FIELDS = (
    pymunk.batch.BodyFields.BODY_ID
    | pymunk.batch.BodyFields.POSITION
    | pymunk.batch.BodyFields.ANGLE
    | pymunk.batch.BodyFields.VELOCITY
    | pymunk.batch.BodyFields.ANGULAR_VELOCITY
)


class Fact(NamedTuple):
    """Something that an example's author meant, and whether it was so."""

    name: str
    holds: bool
    measured: str


class Frame(NamedTuple):
    """All bodies after one frame."""

    numbers: NDArray[np.int64]
    """(n,) which bodies: their place in `Watch.bodies`."""
    state: NDArray[np.float64]
    """(n, 6) x, y, angle, vx, vy, angular velocity."""


class Watch:
    """Looks at a host's spaces after every frame and keeps what it saw.

    probe(spaces): anything that has to be looked at while the program runs; what it returned after every frame is
    in `probed` (None while nothing was stepped).
    """

    def __init__(self, host: Host, probe: Callable[[Sequence[pymunk.Space]], Any] | None = None) -> None:
        self.host, self.probe = host, probe
        self.bodies: list[pymunk.Body] = []
        """Every body that was seen, in the order in which they were."""
        self.frames: list[Frame] = []
        self.probed: list[Any] = []
        self.joint_errors: list[float] = []
        """After every frame, how far the worst joint is from what it promises (length)."""
        self.whole_cpu: list[float] = []
        """Processor time of whole frames: the program's own work and drawing too (s)."""
        self._numbers: dict[int, int] = {}  # ids are addresses: `bodies` keeps them from being used again
        self._buffer = pymunk.batch.Buffer()
        self._since = time.process_time()
        host.after_frame = self._look

    @property
    def space(self) -> pymunk.Space:
        """The space that was stepped first. ValueError if none was."""
        if not self.host.spaces:
            raise ValueError("the program stepped no space")
        return self.host.spaces[0]

    def _look(self) -> None:
        self.whole_cpu.append(time.process_time() - self._since)
        numbers, states = [], []
        for space in self.host.spaces:
            self._buffer.clear()
            pymunk.batch.get_space_bodies(space, FIELDS, self._buffer)
            ids = list(memoryview(self._buffer.int_buf()).cast("P"))
            if any(ident not in self._numbers for ident in ids):
                for body in (space.static_body, *space.bodies):
                    if body.id not in self._numbers:
                        self._numbers[body.id] = len(self.bodies)
                        self.bodies.append(body)
            numbers += [self._numbers[ident] for ident in ids]
            states.append(np.array(memoryview(self._buffer.float_buf()).cast("d")).reshape(-1, 6))
        state = np.concatenate(states) if states else np.zeros((0, 6))
        self.frames.append(Frame(np.array(numbers, np.int64), state))
        self.joint_errors.append(max((joint_error(s) for s in self.host.spaces), default=0.0))
        if self.probe is not None:
            self.probed.append(self.probe(self.host.spaces) if self.host.spaces else None)
        self._since = time.process_time()

    def dynamic(self) -> list[int]:
        """Numbers of the bodies that are dynamic now."""
        return [i for i, body in enumerate(self.bodies) if body.body_type == pymunk.Body.DYNAMIC]

    def path(self, number: int) -> NDArray[np.float64]:
        """(k, 7) of one body: frame (from 1), x, y, angle, vx, vy, angular velocity, for every frame that has it."""
        rows = [
            (i + 1, *frame.state[where[0]])
            for i, frame in enumerate(self.frames)
            if len(where := np.flatnonzero(frame.numbers == number))
        ]
        return np.array(rows, float).reshape(-1, 7)

    def at(self, frame: int) -> dict[int, NDArray[np.float64]]:
        """State of every dynamic body after that frame (from 1, or from the end if negative), by its number."""
        seen = self.frames[frame - 1 if frame > 0 else frame]
        dynamic = set(self.dynamic())
        return {int(n): row for n, row in zip(seen.numbers, seen.state) if int(n) in dynamic}

    def measures(self) -> dict[str, Any]:
        """Numbers of the run that are compared with the other engine's, as JSON knows them.

        `resting`: of the bodies that came SETTLING frames before the LAST ones, the share that is slower than
        REST_SPEED in those, or has not moved at all: what sleeps keeps the velocity with which it has fallen asleep.
        None where nobody was there all the time: of nobody nothing can be said.
        """
        dynamic = np.array(self.dynamic(), np.int64)
        kept = [frame.state[np.isin(frame.numbers, dynamic)] for frame in self.frames]
        states = np.concatenate(kept) if kept else np.zeros((0, 6))
        finite = bool(np.isfinite(states).all())
        states = states[np.isfinite(states).all(axis=1)]
        speeds = np.hypot(states[:, 3], states[:, 4])
        resting = self._resting(dynamic)
        stepping = [seconds for seconds in self.host.frame_cpu if seconds > 0]
        return {
            "bodies": len(dynamic),
            "finite": finite,
            "box": [*states[:, :2].min(axis=0), *states[:, :2].max(axis=0)] if len(states) else None,
            "fastest": float(speeds.max()) if len(speeds) else 0.0,
            "resting": float(resting.mean()) if len(resting) else None,
            "joint_error": max(self.joint_errors[-LAST:], default=0.0),
            "step_ms": 1e3 * float(np.median(stepping)) if stepping else 0.0,
            "frame_ms": 1e3 * float(np.median(self.whole_cpu)) if self.whole_cpu else 0.0,
            "frames": self.host.frame,
            "steps": self.host.steps,
            "calls": dict(self.host.calls),
        }

    def _resting(self, dynamic: NDArray[np.int64]) -> NDArray[np.bool_]:
        """(k,) whether it rests: those dynamic bodies that had come well before, in each of the last frames."""
        last = self.frames[-LAST - 1 :]
        before = self.frames[: max(0, len(self.frames) - LAST - SETTLING + 1)][-1:]
        there = set(np.intersect1d(before[0].numbers, dynamic).tolist() if before else dynamic.tolist())
        found = []
        for earlier, frame in itertools.pairwise(last):
            was = {int(n): row for n, row in zip(earlier.numbers, earlier.state)}
            for n, row in zip(frame.numbers.tolist(), frame.state):
                if n in there:
                    still = n in was and np.array_equal(row[:3], was[n][:3])
                    found.append(still or math.hypot(row[3], row[4]) < REST_SPEED)
        return np.array(found, bool)


def joint_error(space: pymunk.Space) -> float:
    """How far the worst of the space's joints is from what it promises (length).

    Pins, slides, pivots and grooves; those that may give way (a largest force, no correction) are left out.
    """
    worst = 0.0
    for joint in space.constraints:
        if not (math.isinf(joint.max_force) and joint.max_bias > 0) or joint.a is None or joint.b is None:
            continue
        if isinstance(joint, pymunk.PinJoint | pymunk.SlideJoint | pymunk.PivotJoint):
            a = joint.a.local_to_world(joint.anchor_a)
            length = a.get_distance(joint.b.local_to_world(joint.anchor_b))
            if isinstance(joint, pymunk.PinJoint):
                error = abs(length - joint.distance)
            elif isinstance(joint, pymunk.SlideJoint):
                error = max(joint.min - length, length - joint.max, 0.0)
            else:
                error = length
        elif isinstance(joint, pymunk.GrooveJoint):
            ends = joint.a.local_to_world(joint.groove_a), joint.a.local_to_world(joint.groove_b)
            point = joint.b.local_to_world(joint.anchor_b)
            along = ends[1] - ends[0]
            share = min(max((point - ends[0]).dot(along) / along.dot(along), 0.0), 1.0)
            error = point.get_distance(ends[0] + share * along)
        else:
            continue
        worst = max(worst, error)
    return worst
