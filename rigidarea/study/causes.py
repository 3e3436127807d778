"""Why rigidarea's front is dominated on a scene: what was found when its front was looked at."""

_STEP = "at coarse errors a step decides, and ours costs more: exact outlines, and a step moved in two halves"
_IMPACT = "impulses are exact at one step a frame, for us too, but our step costs more (outlines instead of circles)"
_REST = "sinking counts: a flat contact is as stiff as the step allows, so resting to 1e-4 takes 4 to 16 steps a frame"
_DISC = "the disc is a polygon: stiff contacts roll over its facets, small errors want many chords; a circle has none"

CAUSES: dict[str, str] = {
    "bar_on_u": _REST,
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
    "journal_bounce": "impacts are placed to a step: 64 a frame for 2e-3, as for pymunk, whose step costs less",
    "journal_swing": _STEP,
    "ladder": _STEP,
    "loop": _DISC,
    "mass_chain": _IMPACT,
    "oblique_bounce": _IMPACT,
    "oblique_discs": _IMPACT,
    "off_centre_hit": _IMPACT,
    "overhang": "books over an edge: a flat contact softened to what the step can follow tilts; the pile falls below "
    "16 steps a frame",
    "rest": _REST,
    "ring_on_peg": _DISC,
    "rocking": _STEP + "; corners want the stiffest contact",
    "rolling": _DISC,
    "sliding_stop": _STEP,
    "slip_to_roll": _DISC,
    "stack": "ten flat contacts softened to what the step can follow sink together: 64 steps a frame for 1e-4",
    "standing": "a slender block on a slope loads an edge: a softened contact tilts; it falls below 8 steps a frame",
    "superball": _IMPACT,
    "tiles": "at 1e-4 the box meets 30 seams in as many flat contacts, each softened to what the step can follow",
    "tipping": "the softened flat contact on which the block starts lets go late, and the fall multiplies that by "
    "e^(pt) = 15",
    "v_groove_spin": _DISC + "; sliding at constant forces is what impulses do to rounding",
    "wedge": _STEP,
}
