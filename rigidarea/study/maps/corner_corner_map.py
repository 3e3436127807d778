"""Two squares meet corner to corner: does the impact keep its energy?"""

import math

from ..atlas import Axis, Map, Outcome, Variant, engines, judge, run_scene
from ..scene import OMEGA, VX, VY, block, box_moment, set_up

LIMIT, V = 0.02, 2.0
MOMENT = box_moment(1.0, 1.0, 1.0)


def run(variant: Variant, x: float, y: float) -> Outcome:
    """Relative change of kinetic energy, e = 1, no friction."""
    diagonal, tilt = math.sqrt(0.5), math.radians(45)
    a = block("a", 1.0, 1.0, (-diagonal - 0.05, 0.0), angle=tilt, velocity=(V, 0.0))
    b = block("b", 1.0, 1.0, (diagonal, x), angle=tilt + math.radians(y))
    scene = set_up("corner_corner", (a, b), 0.6, gravity=(0.0, 0.0), elasticity=1.0, pressure=V**2)
    settings = {"stiffness": 1e4} if variant.area else {}
    last = run_scene(variant, scene, **settings).states[-1]
    energy = float(sum(s[VX] ** 2 + s[VY] ** 2 + MOMENT * s[OMEGA] ** 2 for s in last))
    return judge(abs(energy / V**2 - 1), LIMIT, "gained" if energy > V**2 else "lost")


def atlas_map() -> Map:
    """Offset × turn."""
    variants = engines(explicit={"phase": 0.1}, literal={"phase": 0.1})
    variants["explicit, energy law"] = Variant("rigidarea-explicit", {"phase": 0.1, "law": "energy"})
    return Map(
        title="corner on corner: energy of an elastic impact",
        x=Axis("offset of the corners / side", (0.0, 0.01, 0.03, 0.1, 0.2, 0.3, 0.4), (0.0, 0.03, 0.2)),
        y=Axis("turn of one square (degrees)", (-40, -20, -5, 0, 5, 20, 40), (-20, 0, 20)),
        measure="|energy after / before − 1|",
        limit=LIMIT,
        variants=variants,
        run=run,
        source="e = 1 without friction keeps the energy; F = k A between two corners does not (docs/theory.md, 3)",
    )
