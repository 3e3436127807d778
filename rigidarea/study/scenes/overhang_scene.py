"""Books stacked over a table's edge: block n from the top may overhang the one below by L/(2n)."""

import numpy as np

from ..scene import Body, Scene, block, box, rest_error

LENGTH, HEIGHT, COUNT, MARGIN = 1.0, 0.2, 4, 0.9


def centres() -> np.ndarray:
    """Horizontal centres (n,) from the bottom book up; the table's edge is x = 0.

    Book n from the top sticks out by 0.9 · L/(2n) past its support, so every group above an edge has its
    centre of mass inside that edge.
    """
    edges = np.cumsum([MARGIN * LENGTH / (2 * n) for n in range(COUNT, 0, -1)])
    return edges - LENGTH / 2


def scene() -> Scene:
    """Four books, each overhang 0.9 of the classical limit."""
    table = Body("table", (box(10.0, 1.0),), (-5.0, -0.5), kind="static")
    books = tuple(
        block(f"book{i}", LENGTH, HEIGHT, (float(x), (i + 0.5) * HEIGHT)) for i, x in enumerate(centres())
    )
    return Scene(
        title="overhanging books",
        bodies=(table, *books),
        friction=0.5,
        duration=5.0,
        error_name="displacement after 5 s / length",
        error=lambda trace: rest_error(trace, [book.name for book in books], LENGTH),
        source="harmonic stack: overhang Σ L/(2n)",
        tags=frozenset({"rest", "flat", "stack"}),
    )
