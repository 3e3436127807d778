"""What one sees is what collides: `debug_draw` paints outlines with their holes and arcs, in pymunk's three back ends.

The oracle is shapely: a pixel is the outline's if the point that it stands for lies in the finely sampled polygon.
"""

from __future__ import annotations

import math
import warnings

import numpy as np
import pymunk
import pymunk.pygame_util
import pytest
import shapely

import rigidarea as ra

pygame = pytest.importorskip("pygame")

SIZE = 400
ROUNDED = [(-120, -80, 0), (120, -80, 0.4142135623730951), (150, -50, 0), (150, 60, -0.6), (-150, 60, 0.3)]


def outlines() -> dict[str, ra.Outline]:
    angle = np.linspace(0, 2 * math.pi, 11)[:-1]
    star = np.column_stack((np.cos(angle), np.sin(angle))) * np.where(np.arange(10) % 2, 60, 150)[:, None]
    ring = ra.shapes.circle(140)
    return {
        "hook": ra.Outline(
            [(-120, -100), (120, -100), (120, 100), (60, 100), (60, -40), (-60, -40), (-60, 100), (-120, 100)]
        ),
        "star": ra.Outline(star),
        "plate with two holes": ra.Outline(
            [(-150, -100), (150, -100), (150, 100), (-150, 100)],
            [[(-120, -60), (-120, 60), (-30, 60), (-30, -60)], [(40, -50), (90, 40), (120, -30)]],
        ),
        "arcs": ra.Outline.from_bulges(ROUNDED),
        "arcs with a round hole": ra.Outline.from_bulges(ROUNDED, [[(-20, -54, 1), (20, -54, 1)]]),
        "gear": ra.shapes.involute_gear(module=12, teeth=23),
        "disc with a hole": ra.Outline.from_curve(
            [ring.rings[0], ring.rings[0][::-1] / 2],
            arcs=[ring.arcs[0], ring.arcs[0] * (1, 1, -0.5)],
        ),
    }


NAMES = list(outlines())


def scene(name: str, angle: float, *, attach: bool = True) -> tuple[pymunk.Space, ra.Outline, pymunk.Body]:
    space = pymunk.Space()
    outline = outlines()[name]
    body = outline.body(mass=1)
    body.position, body.angle = (SIZE / 2 + 3.3, SIZE / 2 - 2.7), angle
    space.add(body, outline.add_to(body))
    if attach:
        ra.attach(space)
    return space, outline, body


def covered(outline: ra.Outline, body: pymunk.Body, offset: float, flip: bool) -> np.ndarray:
    """(SIZE, SIZE) bool: rows from the top; pixel i stands for the coordinate i + offset."""
    c, s = body.rotation_vector
    rings = [ring @ np.array([[c, s], [-s, c]]) + tuple(body.position) for ring in outline.sample(1e-3).rings]
    polygon = shapely.Polygon(rings[0], rings[1:])
    x, y = np.meshgrid(np.arange(SIZE) + offset, np.arange(SIZE) + offset)
    return shapely.contains_xy(polygon, x, y)[:: -1 if flip else 1]


def agree(drawn: np.ndarray, wanted: np.ndarray) -> float:
    """Pixels painted and covered over those painted or covered: stricter than a share of the whole picture."""
    return float((drawn & wanted).sum() / (drawn | wanted).sum())


def with_pygame(space: pymunk.Space, options: object = None) -> np.ndarray:
    surface = pygame.Surface((SIZE, SIZE))
    surface.fill((255, 255, 255))
    if options is None:
        from rigidarea.pygame_util import DrawOptions

        options = DrawOptions(surface)
    else:
        options = options(surface)
    space.debug_draw(options)
    return (pygame.surfarray.array3d(surface) != 255).any(axis=2).T


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("angle", [0.0, 0.7])
def test_pygame(name, angle):
    space, outline, body = scene(name, angle)
    assert agree(with_pygame(space), covered(outline, body, 0.0, False)) > 0.99


@pytest.mark.parametrize("name", NAMES)
def test_pymunks_own_options_in_an_attached_space(name):
    """A program that knows nothing of outlines shows them; without area contact the hull collides and is drawn."""
    space, outline, body = scene(name, 0.3)
    wanted = covered(outline, body, 0.0, False)
    assert agree(with_pygame(space, pymunk.pygame_util.DrawOptions), wanted) > 0.99
    ra.attached(space).detach()
    assert agree(with_pygame(space, pymunk.pygame_util.DrawOptions), wanted) < 0.99


@pytest.mark.parametrize("name", NAMES)
def test_matplotlib(name):
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    from matplotlib.figure import Figure

    from rigidarea.matplotlib_util import DrawOptions

    space, outline, body = scene(name, 0.7)
    figure = Figure(figsize=(4, 4), dpi=SIZE / 4)
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    canvas = FigureCanvasAgg(figure)
    axes = figure.add_axes((0, 0, 1, 1), xlim=(0, SIZE), ylim=(0, SIZE), frame_on=False)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DeprecationWarning)
        options = DrawOptions(axes)
    space.debug_draw(options)
    canvas.draw()
    # what is smoothed counts from half on: a pixel's colour is its share of (44, 62, 80) or (52, 152, 219) on white
    drawn = np.asarray(canvas.buffer_rgba())[:, :, 0] < 255 - (255 - 52) / 2
    assert agree(drawn, covered(outline, body, 0.5, True)) > 0.99


@pytest.fixture(scope="module")
def window():
    pyglet = pytest.importorskip("pyglet")
    pyglet.options["headless"] = True
    try:
        from pyglet.window import Window

        made = Window(SIZE, SIZE)
    except Exception as error:  # whatever a driver says
        pytest.skip(f"no OpenGL here: {error!r}")
    yield made
    made.close()


@pytest.mark.parametrize("name", NAMES)
def test_pyglet(window, name):
    import pyglet

    from rigidarea.pyglet_util import DrawOptions

    space, outline, body = scene(name, 0.7)
    window.switch_to()
    window.clear()
    space.debug_draw(DrawOptions())
    image = pyglet.image.get_buffer_manager().get_color_buffer().get_image_data()
    pixels = np.frombuffer(image.get_data("RGB", SIZE * 3), np.uint8).reshape(SIZE, SIZE, 3)
    assert agree((pixels != 0).any(axis=2), covered(outline, body, 0.5, False)) > 0.99


def test_any_other_options_get_convex_polygons():
    """Chipmunk promises convex polygons to whoever draws: together they are the outline."""

    class Other(pymunk.SpaceDebugDrawOptions):
        def __init__(self) -> None:
            super().__init__()
            self.pieces: list[shapely.Polygon] = []

        def draw_polygon(self, verts, radius, outline_color, fill_color):
            self.pieces.append(shapely.Polygon(verts))

        def draw_segment(self, a, b, color):
            pass

    space, outline, _ = scene("plate with two holes", 0.7)
    options = Other()
    space.debug_draw(options)
    assert type(options) is Other
    assert all(piece.area == pytest.approx(piece.convex_hull.area) for piece in options.pieces)
    assert sum(piece.area for piece in options.pieces) == pytest.approx(outline.area)
    assert shapely.union_all(options.pieces).area == pytest.approx(outline.area, rel=1e-9)


def test_transform_and_colour():
    from rigidarea.pygame_util import DrawOptions

    space, outline, body = scene("hook", 0.2)
    (shape,) = space.shapes
    shape.color = (200, 10, 10, 255)
    surface = pygame.Surface((SIZE, SIZE))
    options = DrawOptions(surface)
    options.transform = pymunk.Transform(a=0.5, d=0.5, tx=40, ty=-10)
    space.debug_draw(options)
    assert surface.get_at((round(40 + 0.5 * body.position.x), round(-10 + 0.5 * (body.position.y - 70))))[
        0
    ] in (
        200,
        44,
    )
    painted = int((pygame.surfarray.array3d(surface) != 0).any(axis=2).sum())
    assert painted == pytest.approx(outline.area / 4, rel=0.02)


def test_regions_and_forces_are_drawn_over_it():
    from rigidarea.pygame_util import DrawOptions

    space = pymunk.Space()
    space.gravity = 0, 900  # y down, as pygame has it
    floor = pymunk.Segment(space.static_body, (0, 350), (400, 350), 0)
    hook = outlines()["hook"]
    body = hook.body(mass=1)
    body.position = 200, 249.0
    space.add(floor, body, hook.add_to(body))
    contact = ra.attach(space, penetration=0.05)
    for _ in range(120):
        space.step(1 / 60)
    surface = pygame.Surface((SIZE, SIZE))
    space.debug_draw(DrawOptions(surface, contact=contact))
    picture = pygame.surfarray.array3d(surface)
    area = contact.regions["area"].sum()
    painted = int((picture == DrawOptions.region_color[:3]).all(axis=2).sum())
    assert area > 200 and painted == pytest.approx(area, rel=0.2)
    assert (picture == DrawOptions.force_color[:3]).all(axis=2).any()
