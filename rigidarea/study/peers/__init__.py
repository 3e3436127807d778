"""The engines that the studies hold side by side; `PEERS` of each module here.

How they are set, so that each does what it can:

- *Stepping.* pymunk's solver and rigidarea's explicit steps run from the same loop in C, one foreign call of Chipmunk's
  own step function a step (`base.drive`), Box2D from it through its binding; `rigidarea`, `rigidarea-default`
  and the flexible submodule's levels take all their frames in one call, as a user may. What a step of an empty world
  costs is in the output of `bench frames` (`call_overhead_us`).
- *Building* is not timed, nor is the first run. Repeats are interleaved over all settings of a scene; see `timing`.
- *pymunk*: steps a frame, iterations and the collision slop (a fraction of the body size; its default is meant for
  pixels) are swept; the bias is pymunk's.
- *Box2D*: steps a frame, substeps a step, contact softness (30 Hz, or the stiffest it allows, a quarter of the
  substep rate) and the length of a body in its units (1 or 10 m: its tolerances are fixed in metres) are swept. The
  restitution threshold is 0.01 m/s instead of 1, rotations are set by exact cosines (its own are approximated).
- *Concave and curved outlines* get the same points for all, sampled so that the area is kept. Terrain becomes chains
  that know their neighbours (pymunk's segments, Box2D's chains), moving outlines convex pieces that tile them
  exactly (`decompose`), of at most eight vertices for Box2D. The sampling is swept. Circles are exact for the peers.
- *Sleeping* is off everywhere; friction and elasticity are those of the pair, however an engine mixes them.
- Single precision and one solver in Box2D, double in the others. `tests/study/test_peers.py` checks every peer's
  set-up on scenes that it is known to do well.
- Engines of rigid bodies are spared scenes whose answer is that of elastic ones.
"""

from __future__ import annotations

import importlib
import pkgutil
from functools import cache

from ..scene import check_known
from .base import Peer, Run, Settings, drive, record


@cache
def peers() -> dict[str, Peer]:
    """Every peer by name, in alphabetical order of its module."""
    modules = sorted(info.name for info in pkgutil.iter_modules(__path__))
    found = (getattr(importlib.import_module(f"{__name__}.{name}"), "PEERS", ()) for name in modules)
    return {peer.name: peer for its in found for peer in its}


def get_peer(name: str) -> Peer:
    """The peer called `name`; `ValueError` lists the known ones."""
    check_known([name], peers(), "peer")
    return peers()[name]


__all__ = ["Peer", "Run", "Settings", "drive", "get_peer", "peers", "record"]
