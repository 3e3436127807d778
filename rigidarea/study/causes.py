"""Why rigidarea's front is dominated on a scene: what was found when its front was looked at."""

CAUSES: dict[str, str] = {}
