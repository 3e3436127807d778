"""Why rigidarea's front is dominated on a scene: what was found when its front was looked at."""

_STEP = "at coarse errors a step decides, and ours costs more: exact outlines, and a step moved in two halves"
_IMPACT = "impulses are exact in one or two steps a frame, for us too, but our step costs more: outlines, not circles"
_REST = (
    "at one step a frame an impulse holds to 1e-4; ours creeps by a few times that, and takes 4 to 8 for it"
)
_DISC = "the disc is a polygon: stiff contacts roll over its facets, small errors want many chords; a circle has none"

CAUSES: dict[str, str] = {
    "bounce": _STEP,
    "bowl_roll": _DISC,
    "bowl_slide": _DISC,
    "conveyor": _STEP,
    "cradle": _IMPACT,
    "dome": _DISC,
    "falling_rod": _STEP,
    "geneva": _STEP,
    "incline_hold": _REST,
    "incline_slide": _STEP,
    "incline_up": _STEP,
    "journal_bounce": "at errors of a tenth pymunk's coarse segments are cheap; at 2.5e-3 our impacts place no better",
    "journal_swing": _STEP,
    "ladder": _STEP,
    "loop": _DISC,
    "mass_chain": _IMPACT,
    "oblique_bounce": _IMPACT,
    "oblique_discs": _IMPACT,
    "off_centre_hit": _IMPACT,
    "overhang": "books over an edge: a flat contact softened to what the step can follow tilts; the pile falls below "
    "16 steps a frame",
    "rest": "a step costs a tenth more than pymunk's",
    "ring_on_peg": _DISC,
    "rocking": _STEP + "; corners want the stiffest contact",
    "rolling": _DISC,
    "sliding_stop": _STEP,
    "slip_to_roll": _DISC,
    "stack": "ten flat contacts softened to what the step can follow sink together: 64 steps a frame for 1e-4",
    "standing": _REST,
    "superball": _IMPACT,
    "tiles": _STEP,
    "tipping": "the softened flat contact on which the block starts lets go late, and the fall multiplies that by "
    "e^(pt) = 15",
    "v_groove_spin": _DISC + "; sliding at constant forces is what impulses do to rounding",
    "wedge": _STEP,
}
