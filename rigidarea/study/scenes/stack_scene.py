"""Ten boxes stacked on a floor stay where they are."""

from ..scene import Scene, block, floor, rest_error

COUNT = 10


def scene() -> Scene:
    """Unit boxes placed exactly on each other; interface i carries (N − i) m g and nothing moves."""
    boxes = tuple(block(f"box{i}", 1.0, 1.0, (0.0, i + 0.5)) for i in range(COUNT))
    return Scene(
        title="stack of ten boxes",
        bodies=(floor(), *boxes),
        friction=0.5,
        duration=5.0,
        error_name="displacement after 5 s / side",
        error=lambda trace: rest_error(trace, [box.name for box in boxes], 1.0),
        source="statics; rigid limit",
        tags=frozenset({"rest", "flat", "stack"}),
    )
