"""A box at rest on a floor stays where it is."""

from ..scene import Scene, block, floor, rest_error


def scene() -> Scene:
    """Unit box placed exactly on the floor; the rigid answer is no motion at all (sinking counts as error)."""
    return Scene(
        title="box at rest",
        bodies=(floor(), block("box", 1.0, 1.0, (0.0, 0.5))),
        friction=0.5,
        duration=3.0,
        error_name="displacement after settling / side",
        error=lambda trace: rest_error(trace, ["box"], 1.0),
        source="statics; rigid limit of A = m g/k",
        tags=frozenset({"rest", "flat"}),
    )
