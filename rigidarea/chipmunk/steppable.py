"""Which spaces a world (`chipmunk/alone.py`) can be made of: what would need Python, or Chipmunk, in a frame."""

from __future__ import annotations

import pymunk
from pymunk._chipmunk_cffi import ffi

from ..contact.space_record import OFFSETS
from .arrays import Store
from .world_image import kind_of


def check_steppable(space: pymunk.Space, store: Store) -> None:
    """ValueError for what a world without Chipmunk and Python has not."""
    state, off = store.state[0], {name: int(store.state[0][name]) for name in OFFSETS}
    why = []
    if state["explicit"]:
        why.append('integration="explicit"')
    if any(
        getattr(handler, f"_{phase}") not in (None, pymunk.empty_callback)
        for handler in space._handlers.values()
        for phase in ("begin", "pre_solve", "post_solve", "separate")
    ):
        why.append("collision callbacks")
    if space.sleep_time_threshold != float("inf"):
        why.append("sleeping (sleep_time_threshold)")
    ours = {
        "velocity": {off["velocity_func"], off["velocity_func_again"]},
        "position": {off["position_func"], off["position_func_again"], int(state["hold_at"])},
    }
    for kind, known in ours.items():
        words = (
            int(ffi.cast("uintptr_t *", body._body)[off[f"body_{kind}_func"] // 8]) for body in space.bodies
        )
        if any(word not in known for word in words):
            why.append(f"a {kind}_func")
    for joint in space.constraints:
        kind = kind_of(joint)
        words = ffi.cast("uintptr_t *", joint._constraint)
        if kind is None:
            why.append(f"a {type(joint).__name__} that is none of pymunk's")
        elif kind.force and int(words[kind.force // 8]) != kind.own_force:
            why.append("a spring's own force function")
        if joint.pre_solve is not None or joint.post_solve is not None:
            why.append("callbacks of joints")
    if why:
        raise ValueError(
            f"expected a space that can be stepped without Python, got one with {', '.join(dict.fromkeys(why))}"
        )
