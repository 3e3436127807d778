"""Why rigidarea's front is dominated on a scene: what was found when its front was looked at."""

_STEP = "at coarse errors a step decides, and ours costs more: exact outlines, and a step moved in two halves"
_IMPACT = "impulses are exact in one or two steps a frame, for us too, but ours cost more: overlaps and looks back"
_SHORT = (
    "thirty frames: one in flight costs little more than pymunk's step, but the first, on tables that nothing has "
    "touched yet, and that of the impact, with its looks back for the place of touch, cost as much as all others"
)
_REST = (
    "at one step a frame an impulse holds to 1e-4; ours creeps by a few times that, and takes 4 to 8 for it"
)

CAUSES: dict[str, str] = {
    "bounce": _STEP,
    "bowl_roll": _STEP,
    "bowl_slide": _STEP,
    "conveyor": _STEP,
    "cradle": _IMPACT,
    "dome": _STEP,
    "falling_rod": _STEP,
    "geneva": _STEP,
    "incline_hold": _REST,
    "incline_slide": _STEP,
    "incline_up": _STEP,
    "journal_bounce": "at errors of a tenth pymunk's coarse segments are cheap; at 2.5e-3 our impacts place no better",
    "journal_swing": _STEP,
    "ladder": _STEP,
    "loop": _STEP,
    "mass_chain": _IMPACT,
    "oblique_bounce": _IMPACT,
    "oblique_discs": _SHORT,
    "off_centre_hit": _IMPACT,
    "overhang": "books over an edge: a flat contact softened to what the step can follow tilts; the pile falls below "
    "16 steps a frame",
    "rest": "a step costs a tenth more than pymunk's",
    "ring_on_peg": _STEP,
    "rocking": _STEP + "; corners want the stiffest contact",
    "rolling": _STEP,
    "sliding_stop": _STEP,
    "slip_to_roll": _STEP,
    "stack": "ten flat contacts softened to what the step can follow sink together: 64 steps a frame for 1e-4",
    "standing": _REST,
    "superball": _IMPACT,
    "tiles": _STEP,
    "tipping": "the softened flat contact on which the block starts lets go late, and the fall multiplies that by "
    "e^(pt) = 15",
    "v_groove_spin": "sliding at constant forces is what impulses do to rounding in one step a frame; ours are two "
    "substeps, each with sweeps and a search",
    "wedge": _STEP,
}
