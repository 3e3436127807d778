"""Why rigidarea's front is dominated on a scene: what was found when its front was looked at."""

_STEP = "at coarse errors one step a frame decides, and a frame of ours costs more"
_IMPACT = (
    "impulses are exact in one step a frame, for us too: a frame of ours costs more, the first one most, and "
    "the run is short"
)
_REST = "one step a frame holds with either: a frame of ours costs more"
_ARC = "; an arc that is stiffer than its substeps bear comes off its path and is struck anew: finer errors want more"

CAUSES: dict[str, str] = {
    "arch": _STEP + "; the default's penetration is too large (a smaller one holds)",
    "bar_on_u": _REST,
    "bounce": _STEP,
    "bowl_roll": _STEP + _ARC,
    "bowl_slide": _STEP + _ARC,
    "box_on_box": _STEP,
    "conveyor": _STEP,
    "cradle": _IMPACT,
    "dome": _STEP,
    "falling_rod": _STEP,
    "gears": _STEP,
    "geneva": _STEP,
    "gripping_bounce": _IMPACT,
    "heavy_on_light": _STEP,
    "incline_hold": _REST + "; friction's spring gives way as the contact does",
    "incline_slide": _STEP,
    "incline_up": _STEP,
    "journal_bounce": _STEP,
    "journal_swing": _STEP + _ARC,
    "ladder": _STEP,
    "ladder_held": _REST + "; the default's penetration is too large (a smaller one holds)",
    "loop": _STEP,
    "mass_chain": _IMPACT,
    "oblique_bounce": _IMPACT,
    "oblique_discs": _IMPACT,
    "off_centre_hit": _IMPACT,
    "overhang": _STEP,
    "parted": "parts at a side a second and keeps that speed: pymunk's and Box2D's corrections of place leave none",
    "rest": _REST,
    "ring_on_peg": _STEP + _ARC,
    "rocking": _STEP + "; corners want the stiffest contact",
    "rolling": _STEP,
    "rough_discs": _IMPACT,
    "sliding_stop": _STEP,
    "slip_to_roll": _STEP,
    "stack": _STEP,
    "standing": _REST
    + "; the default's penetration is too large: a block stands while p <= m³ w/6h, m the part of half its base "
    "that is left between weight and edge",
    "superball": _STEP,
    "tiles": _STEP + "; at some settings the box catches at a seam",
    "tipping": _STEP + "; the depth at the start is magnified by e^(pt)",
    "v_groove_spin": "sliding at constant forces is what impulses do to rounding; ours is off by what it sinks",
    "wedge": _STEP,
}
