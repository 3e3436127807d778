"""Far from the origin: the same scenes, moved."""

import dataclasses

from ..atlas import Axis, Map, Outcome, Variant, engines, judge, run_scene
from ..scene import Trace, get_scene

SCENES = ("rest", "incline_hold", "bounce", "oblique_discs", "bar_on_u", "bowl_slide")
LIMIT = 0.2


def run(variant: Variant, x: float, y: float) -> Outcome:
    """Error of the scene when everything is moved by x in both directions."""
    plain = get_scene(SCENES[round(y)])
    bodies = tuple(
        dataclasses.replace(body, position=(body.position[0] + x, body.position[1] + x))
        for body in plain.bodies
    )
    moved = dataclasses.replace(plain, bodies=bodies)
    trace = run_scene(variant, moved, 1e4, sampling=1e-4)
    states = trace.states.copy()
    states[:, :, :2] -= x
    return judge(plain.measure(Trace(trace.names, trace.times, states)), LIMIT, "wrong")


def atlas_map() -> Map:
    """Distance from the origin × scene."""
    distances = tuple(float(10**p) for p in range(0, 9))
    return Map(
        title="far from the origin",
        x=Axis("distance from the origin (m)", distances, (1.0, 1e3, 1e5, 1e7), log=True),
        y=Axis(
            "scene", tuple(range(len(SCENES))), (0, 2, 5), names=tuple(get_scene(s).title for s in SCENES)
        ),
        measure="error of the scene",
        limit=LIMIT,
        variants=engines(),
        run=run,
        source="double precision leaves 1e-16 of the distance, single precision 6e-8",
    )
