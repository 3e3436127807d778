"""Two installations beside each other, as a checkout and its wheel: the same bits, first frames, what frames cost.

    python tests/same_bits.py OTHER_PYTHON [--scenes 60] [--rounds 6]

OTHER_PYTHON has the other installation (`out/installed/bin/python` of `make test-wheel`). Prints which scenes differ
(random ones, everyday ones, bodies that bend), wall time and memory from start to first frame, and the ratio of
processor times of everyday scenes, other over own: medians of interleaved rounds. Exit code 1 if a bit differs.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import statistics
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

HERE = Path(__file__).resolve().parent
#: Everyday scenes of a few hundred bodies at most, and their frames.
NAMES = (
    "boxes",
    "hexagons",
    "discs",
    "mixed",
    "rounded",
    "pyramid",
    "struck_wall",
    "dominoes",
    "rope_bridge",
    "bouncing",
)
FRAMES = 120

FIRST = """
import resource, time
start = time.perf_counter()
import pymunk, rigidarea as ra
space = pymunk.Space()
space.gravity = 0, -10
body = pymunk.Body(1, 1)
body.position = 0, 1
floor = pymunk.Segment(space.static_body, (-9, 0), (9, 0), 0.1)
space.add(floor, body, pymunk.Poly.create_box(body, (1, 1)))
ra.attach(space)
space.step(1 / 60)
memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
print(f"{ra.backend()}: {time.perf_counter() - start:.2f} s of wall time, {memory:.0f} MB")
"""


def bits(state: Any) -> str:
    import numpy as np

    return hashlib.sha1(np.ascontiguousarray(state).tobytes()).hexdigest()


def bending() -> dict[str, str]:
    """A box, a disc and a smaller box at each level, areas and surface to surface."""
    import rigidarea as ra
    from rigidarea.flexible import Material, Mechanism

    made = {}
    for level in ("rigid", "compliant", "modal"):
        for contact in ("area", "sts"):
            sim = Mechanism(
                1e7, gravity=(0.0, -9.81), contact=contact, reach=0.05 if contact == "sts" else 0.0
            )
            rubber, mesh = Material(5e7, 0.3, 1150.0, 0.1), None if level == "rigid" else 0.1
            parts = [
                sim.body(shape, rubber, mesh=mesh, level=level, at=at, velocity=velocity, hub=None)
                for shape, at, velocity in (
                    (ra.shapes.box(1, 0.4), (0, 0), (0, 0, 0)),
                    (ra.shapes.circle(0.2), (0.05, 0.39), (0, -1, 0)),
                    (ra.shapes.box(0.3, 0.3), (-0.3, 0.5), (0, -1, 0)),
                )
            ]
            sim.contact(parts[0], parts[1], friction=0.3, restitution=0.5)
            sim.contact(sim.ground(ra.shapes.box(4, 1), (0, -0.705)), parts[0])
            sim.contact(parts[0], parts[2])
            made[f"{level}, {contact}"] = bits(sim.run(0.05, 1e-3, shapes=True).x)
    return made


def measured(scenes: int) -> dict[str, Any]:
    """Of this interpreter: hashes of states by scene, and processor time by everyday scene (s)."""
    sys.path[:0] = [str(HERE), str(HERE / "solve")]
    from random_scenes import build, recipe

    from rigidarea.study.everyday_scenes import EVERYDAY
    from rigidarea.study.peers import get_peer

    hashes, times = {}, {}
    for seed in range(scenes):
        made = recipe(seed, ("area", "energy")[seed % 2])
        world = build(made, "area")
        for _ in range(90):
            world.step(made.steps)
        hashes[f"random {seed}"] = bits(world.state())
    for name in NAMES:
        run = get_peer("rigidarea-default").build(EVERYDAY[name].make(0), {})
        run.advance(1)
        start = time.process_time()
        run.advance(FRAMES)
        times[name] = time.process_time() - start
        hashes[name] = bits(run.state())
    if scenes:
        hashes |= bending()
    return {"hashes": hashes, "times": times}


def child(python: str, *arguments: str) -> str:
    return subprocess.run([python, *arguments], capture_output=True, text=True, check=True, cwd=HERE).stdout


def main() -> int:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("other", metavar="OTHER_PYTHON")
    parser.add_argument("--scenes", type=int, default=60, help="random scenes (60)")
    parser.add_argument("--rounds", type=int, default=6, help="of timing (6)")
    parser.add_argument("--measure", action="store_true", help=argparse.SUPPRESS)
    given = parser.parse_args()
    if given.measure:
        print(json.dumps(measured(given.scenes)))
        return 0
    both = (str(Path(given.other).absolute()), sys.executable)
    for python in both:
        child(python, "-c", FIRST)  # from the disk's cache, as the second start is
        print(child(python, "-c", FIRST), end="")

    def run(python: str, scenes: int) -> dict[str, Any]:
        return json.loads(  # type: ignore[no-any-return]
            child(python, str(HERE / "same_bits.py"), python, "--measure", "--scenes", str(scenes))
        )

    other, own = (run(python, given.scenes)["hashes"] for python in both)
    differ = [name for name in own if own[name] != other[name]]
    print(f"{len(own) - len(differ)} of {len(own)} scenes have the same bits", *differ, sep="\n")
    rounds = [[run(python, 0)["times"] for python in both] for _ in range(given.rounds)]
    for name in NAMES:
        print(f"{name:12} {statistics.median(a[name] / b[name] for a, b in rounds):.3f}")
    return 1 if differ else 0


if __name__ == "__main__":
    sys.exit(main())
