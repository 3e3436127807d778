"""Removals, additions and changes from within callbacks, each in a process of its own: natively, and attached.

Natively some end the process (Chipmunk's assertions): attached they may as well. Attached, everything else must end
with a finite state, raise nothing that it does not raise natively (but for what only a contact can refuse), and go on.
"""

from __future__ import annotations

import json
import math
import os
import signal
from collections.abc import Callable
from typing import Any

import pymunk

from rigidarea import Outline, attach, attached

CALLBACKS = (
    *("begin", "pre_solve", "post_solve", "separate"),
    *("velocity_func", "position_func", "joint pre_solve", "joint post_solve", "force_func", "post_step"),
)
#: Seconds after which one is given up.
TIME_LIMIT = 20


class Scene:
    """Six boxes and discs in a heap, some of them jointed, and what a callback may get hold of."""

    def __init__(self, engine: str) -> None:
        self.space = space = pymunk.Space()
        space.gravity = 0, -100
        self.floor = pymunk.Segment(space.static_body, (-100, 0), (100, 0), 1)
        space.add(self.floor)
        self.bodies, self.shapes = [], []
        for i in range(6):
            body = pymunk.Body(1, 50)
            body.position = 3.0 * (i % 2), 5 + 9.0 * i
            shape: pymunk.Shape = pymunk.Circle(body, 5) if i % 3 else pymunk.Poly.create_box(body, (9, 9))
            shape.friction, shape.elasticity, shape.collision_type = 0.5, 0.2, 1
            space.add(body, shape)
            self.bodies.append(body)
            self.shapes.append(shape)
        self.joint = pymunk.PinJoint(self.bodies[4], self.bodies[5])
        self.spring = pymunk.DampedSpring(self.bodies[0], self.bodies[5], (0, 0), (0, 0), 40, 1, 0.1)
        space.add(self.joint, self.spring)
        self.contact = attach(space) if engine == "area" else None
        self.calls = 0
        self.act: Callable[[Scene], Any] = lambda scene: None

    def called(self) -> None:
        """The action, at the fifth call and then every ninth."""
        self.calls += 1
        if self.calls % 9 == 5:
            self.act(self)

    def install(self, callback: str) -> None:
        """Have `called` called from there."""

        def collision(arbiter: pymunk.Arbiter, space: pymunk.Space, data: Any) -> None:
            self.called()

        def velocity(body: pymunk.Body, gravity: Any, damping: float, dt: float) -> None:
            pymunk.Body.update_velocity(body, gravity, damping, dt)
            self.called()

        def position(body: pymunk.Body, dt: float) -> None:
            pymunk.Body.update_position(body, dt)
            self.called()

        def force(spring: pymunk.DampedSpring, distance: float) -> float:
            self.called()
            return (spring.rest_length - distance) * spring.stiffness

        if callback in ("begin", "pre_solve", "post_solve", "separate"):
            functions: dict[str, Any] = {callback: collision}
            self.space.on_collision(1, None, **functions)
        elif callback == "velocity_func":
            self.bodies[2].velocity_func = velocity
        elif callback == "position_func":
            self.bodies[2].position_func = position
        elif callback == "joint pre_solve":
            self.joint.pre_solve = lambda joint, space: self.called()
        elif callback == "joint post_solve":
            self.joint.post_solve = lambda joint, space: self.called()
        elif callback == "force_func":
            self.spring.force_func = force

    def add_body(self) -> None:
        """One more, above the others."""
        body = pymunk.Body(1, 50)
        body.position = 0, 80 + self.calls
        self.space.add(body, pymunk.Circle(body, 4))
        self.bodies.append(body)

    def remove_body(self) -> None:
        """A body with its shapes and joints."""
        body = self.bodies[1]
        if body in self.space.bodies:
            self.space.remove(body, *body.shapes, *body.constraints)


def _detached_refuses(scene: Scene) -> None:
    if scene.contact is not None and not scene.space._locked:  # after the step: it may
        scene.contact.detach()
        scene.contact = attach(scene.space)
        return
    for use in ("detach", "step"):
        if scene.contact is not None:
            try:
                scene.contact.detach() if use == "detach" else scene.contact.step(1 / 60)
            except RuntimeError:
                continue
            raise AssertionError(f"{use}() within a step was not refused")


def _ask_joints(scene: Scene) -> None:
    """A joint asks its class before it answers: another's ends the process."""
    for joint in (scene.joint, scene.spring):
        if not math.isfinite(joint.impulse):
            raise AssertionError("a joint's impulse is not finite")
    scene.joint.distance = scene.joint.distance
    scene.spring.rest_length = scene.spring.rest_length
    if scene.space.iterations < 1:
        raise AssertionError("no iterations within a step")


def _copy(scene: Scene) -> None:
    """A copy made there goes on. It has the same callbacks: they copy nothing while it does."""
    act, scene.act = scene.act, lambda scene: None
    other = scene.space.copy()
    for _ in range(3):
        other.step(1 / 60)
    if not all(math.isfinite(body.position.x + body.position.y) for body in other.bodies):
        raise AssertionError("a copy whose state is not finite")
    scene.act = act


def _attach_refuses(scene: Scene) -> None:
    if not scene.space._locked:  # after the step: it may
        return
    try:
        attach(scene.space)
    except (ValueError, RuntimeError):
        return
    scene.contact = attached(scene.space)
    raise AssertionError("attach() within a step was not refused")


def _stiffness(scene: Scene) -> None:
    if scene.contact is not None:
        scene.contact.stiffness = 5e3


def _look(scene: Scene) -> None:
    if scene.contact is not None and attached(scene.space) is scene.contact:
        len(scene.contact.regions)
        scene.contact.energy()


def _add_and_remove(scene: Scene) -> None:
    scene.add_body()
    scene.remove_body()


def _refresh(scene: Scene) -> None:
    circle = scene.shapes[1]
    assert isinstance(circle, pymunk.Circle)
    circle.unsafe_set_radius(6)
    if scene.contact is not None and circle in scene.space.shapes:
        scene.contact.refresh(circle)


def _outline(scene: Scene) -> None:
    outline = Outline([(0, 0), (8, 0), (8, 8), (6, 8), (6, 2), (0, 2)])
    body = outline.body(density=0.02)
    body.position = 40, 60 + scene.calls
    scene.space.add(body, outline.add_to(body))
    scene.bodies.append(body)


ACTIONS: dict[str, Callable[[Scene], Any]] = {
    "remove a body": Scene.remove_body,
    "remove the shape alone": lambda s: (
        s.space.remove(s.shapes[0]) if s.shapes[0] in s.space.shapes else None
    ),
    "remove the floor": lambda s: s.space.remove(s.floor) if s.floor in s.space.shapes else None,
    "remove the joint": lambda s: s.space.remove(s.joint) if s.joint in s.space.constraints else None,
    "add a body": Scene.add_body,
    "add an outline": _outline,
    "add a joint": lambda s: s.space.add(pymunk.PivotJoint(s.bodies[0], s.bodies[3], s.bodies[0].position)),
    "add and remove": _add_and_remove,
    "mass": lambda s: setattr(s.bodies[2], "mass", 5),
    "moment": lambda s: setattr(s.bodies[2], "moment", math.inf),
    "position": lambda s: setattr(s.bodies[2], "position", (0, 90)),
    "angle": lambda s: setattr(s.bodies[2], "angle", 1),
    "velocity": lambda s: setattr(s.bodies[2], "velocity", (5, 50)),
    "force": lambda s: s.bodies[2].apply_force_at_world_point((0, 500), (0, 0)),
    "impulse": lambda s: s.bodies[2].apply_impulse_at_local_point((10, 10)),
    "friction": lambda s: setattr(s.shapes[2], "friction", 0),
    "elasticity": lambda s: setattr(s.shapes[2], "elasticity", 1),
    "surface velocity": lambda s: setattr(s.shapes[2], "surface_velocity", (20, 0)),
    "sensor": lambda s: setattr(s.shapes[2], "sensor", not s.shapes[2].sensor),
    "filter": lambda s: setattr(s.shapes[2], "filter", pymunk.ShapeFilter(group=1 + s.calls % 2)),
    "collision type": lambda s: setattr(s.shapes[2], "collision_type", 2),
    "gravity": lambda s: setattr(s.space, "gravity", (50, -100)),
    "iterations": lambda s: setattr(s.space, "iterations", 1 + s.calls % 30),
    "damping": lambda s: setattr(s.space, "damping", 0.5),
    "sleep": lambda s: setattr(s.space, "sleep_time_threshold", 0.1),
    "handler": lambda s: s.space.on_collision(1, 2, begin=lambda *a: None),
    "global handler": lambda s: s.space.on_collision(pre_solve=lambda *a: None),
    "velocity function": lambda s: setattr(s.bodies[3], "velocity_func", pymunk.Body.update_velocity),
    "copy": _copy,
    "ask joints": _ask_joints,
    "detach, step": _detached_refuses,
    "attach": _attach_refuses,
    "stiffness": _stiffness,
    "look": _look,
    "refresh": _refresh,
    "raise": lambda s: [][0],
}


def run_kind(callback: str, action: str, engine: str) -> dict[str, Any]:
    """120 frames in this process: `error` (the class that a frame raised, or ""), `finite`, `calls`."""
    scene = Scene(engine)
    scene.act = ACTIONS[action]
    scene.install(callback)
    error = ""
    for frame in range(120):
        if callback == "post_step" and frame % 10 == 0:
            key = f"meddle {frame}"
            scene.space.add_post_step_callback(lambda space, key: scene.called(), key)
        try:
            scene.space.step(1 / 60)
        except Exception as raised:
            error = error or type(raised).__name__
            if isinstance(raised, AssertionError):
                error = f"AssertionError: {raised}"
    places = [(*b.position, b.angle, *b.velocity, b.angular_velocity) for b in scene.space.bodies]
    if scene.contact is not None:
        scene.contact.step(1 / 60)
        scene.contact.detach()
        scene.space.step(1 / 60)
    return {"error": error, "finite": all(map(math.isfinite, sum(places, ()))), "calls": scene.calls}


def _apart(callback: str, action: str, engine: str) -> dict[str, Any]:
    """`run_kind` in a child of this process."""
    read, write = os.pipe()
    child = os.fork()
    if child == 0:
        signal.alarm(TIME_LIMIT)
        null = os.open(os.devnull, os.O_WRONLY)
        os.dup2(null, 2)  # what cffi prints of a callback that raises
        os.write(write, json.dumps(run_kind(callback, action, engine)).encode())
        os._exit(0)
    os.close(write)
    with os.fdopen(read, "rb") as pipe:
        content = pipe.read()
    _, status = os.waitpid(child, 0)
    if not content:
        code = os.waitstatus_to_exitcode(status)
        how = "took too long" if code == -signal.SIGALRM else f"ended the process ({code})"
        return {"error": how, "finite": True, "calls": -1}
    told: dict[str, Any] = json.loads(content)
    return told


def meddle() -> list[dict[str, Any]]:
    """One row a kind: `callback`, `action`, `native`, `area` (what each raised), `wrong` ("" if nothing is)."""
    run_kind("begin", "look", "area")  # machine code is loaded once, before processes part
    rows = []
    for callback in CALLBACKS:
        for action in ACTIONS:
            native, area = (_apart(callback, action, engine) for engine in ("pymunk", "area"))
            wrong = ""
            if area["error"] and not native["error"]:
                wrong = f"raised or died: {area['error']}"
            elif not area["finite"]:
                wrong = "a state that is not finite"
            elif area["calls"] == 0 < native["calls"]:
                wrong = "was never called"
            rows.append(
                {
                    "callback": callback,
                    "action": action,
                    "native": native["error"],
                    "area": area["error"],
                    "wrong": wrong,
                }
            )
    return rows
