"""Scenes at the edge of standing, each with the limit that statics sets it: card house, ladder, arch, overhang."""

import math

import numpy as np
from solve_world import ENGINE, World

G = 10.0
LADDER, CARD = math.radians(60), math.radians(20)
"""Slope of the ladder, and of a card from the vertical."""


# --- ladder ---


def ladder_limit(slope):
    """Friction below which a uniform ladder slides: floor rough, wall smooth, μ = 1/(2 tan slope)."""
    return 1 / (2 * math.tan(slope))


def ladder(share, engine=ENGINE, slope=LADDER, length=2.0, thick=0.1, iterations=None, **settings):
    """A rhombus of 1 kg whose tips touch floor and wall, at `share` of the friction limit."""
    world = World(G, friction=share * ladder_limit(slope), engine=engine, iterations=iterations, **settings)
    world.floor()
    wall = world.block(-1.0, -1.0, 0.0, 5.0)
    wall.friction = 0.0
    h = length / 2
    points = ((-h, 0.0), (0.0, -thick / 2), (h, 0.0), (0.0, thick / 2))
    world.polygon((h * math.cos(slope), h * math.sin(slope)), points, angle=math.pi - slope)
    return world


# --- arch ---


def voussoirs(count, thickness):
    """Corners (count, 4, 2) of a semicircular arch's blocks, mean radius 1, on y = 0; chords, not arcs."""
    angles = np.linspace(math.pi, 0.0, count + 1)
    rays = np.column_stack((np.cos(angles), np.sin(angles)))
    inner, outer = rays * (1 - thickness / 2), rays * (1 + thickness / 2)
    return np.stack((inner[:-1], outer[:-1], outer[1:], inner[1:]), axis=1)


def _area_and_centre(ring):
    following = np.roll(ring, -1, axis=0)
    cross = ring[:, 0] * following[:, 1] - following[:, 0] * ring[:, 1]
    area = cross.sum() / 2
    return abs(area), ((ring + following) * cross[:, None]).sum(axis=0) / (6 * area)


def arch_stands(count, thickness, friction):
    """Whether forces exist in the joints that carry the arch's weight: none pulls, none leaves its joint or cone.

    Each joint has two point forces, at its inner and its outer end (normal n ≥ 0, tangential |t| ≤ μ n together);
    three equations a block. A linear programme: feasible or not (safe theorem; with friction as in Heyman's, μ large).
    """
    from scipy.optimize import linprog

    blocks = voussoirs(count, thickness)
    unknowns = 3 * (count + 1)  # a joint: normal at its inner end, at its outer end, shear
    equal, right = [], []
    for i, ring in enumerate(blocks):
        area, centre = _area_and_centre(ring)
        rows = np.zeros((3, unknowns))
        for joint, sign, inner, outer in ((i, 1.0, ring[0], ring[1]), (i + 1, -1.0, ring[3], ring[2])):
            along = (outer - inner) / np.linalg.norm(outer - inner)
            normal = sign * np.array(
                (along[1], -along[0])
            )  # clockwise: from the joint before into this block
            shear = sign * along
            for column, (force, at) in enumerate(
                ((normal, inner), (normal, outer), (shear, (inner + outer) / 2))
            ):
                arm = at - centre
                rows[:, 3 * joint + column] = (*force, arm[0] * force[1] - arm[1] * force[0])
        equal.extend(rows)
        right.extend((0.0, area, 0.0))
    cone = np.zeros((2 * (count + 1), unknowns))
    for joint in range(count + 1):
        cone[2 * joint, 3 * joint : 3 * joint + 3] = (-friction, -friction, 1.0)
        cone[2 * joint + 1, 3 * joint : 3 * joint + 3] = (-friction, -friction, -1.0)
    bounds = [(0, None), (0, None), (None, None)] * (count + 1)
    found = linprog(
        np.zeros(unknowns),
        A_ub=cone,
        b_ub=np.zeros(len(cone)),
        A_eq=np.array(equal),
        b_eq=right,
        bounds=bounds,
    )
    return bool(found.status == 0)


def arch_limit(count, friction=0.8):
    """Least thickness over mean radius with which an arch of `count` blocks stands."""
    low, high = 0.02, 0.4
    for _ in range(40):
        middle = (low + high) / 2
        low, high = (low, middle) if arch_stands(count, middle, friction) else (middle, high)
    return high


def arch(share, count=15, engine=ENGINE, iterations=None, **settings):
    """A semicircular arch of `count` voussoirs of t/R = `share` of the limit, springing from the floor."""
    world = World(G, friction=0.8, engine=engine, iterations=iterations, **settings)
    world.floor()
    for ring in voussoirs(count, share * arch_limit(count)):
        area, centre = _area_and_centre(ring)
        world.polygon(centre, ring - centre, mass=area)
    return world


# --- books over an edge ---


def overhang(share, count=5, engine=ENGINE, iterations=None, height=0.2, **settings):
    """Books 1 x `height`: the one under n others sticks out by share/(2 (n + 1)) past its support; edge at x = 0."""
    world = World(G, friction=0.5, engine=engine, iterations=iterations, **settings)
    world.block(-10, -1, 0, 0)
    edge = 0.0
    for i in range(count):
        edge += share / (2 * (count - i))
        world.box((edge - 0.5, height * (i + 0.5)), (1.0, height))
    return world


def overhang_stiffness(share, count=5, height=0.2):
    """k (N/m²) below which the lowest of the books' beds must tip, for books of 1 kg and 1 m.

    The load P = n m g acts d0 = (1 - share)/2 inside the edge, as at every book (m d_m = (m - 1) d_(m-1)
    + (1 - share)/2, d_m of the m uppermost). A bed that cannot pull presses along 3 d if the load is d inside, so it
    tilts by φ = 2 P/(9 k d²), and the load, H = n h/2 above the edge, comes φ H nearer to it. d² (d0 - d) = 2 P H/(9 k)
    has a solution while 2 P H/(9 k) <= 4 d0³/27. (Tilts further up only add to it.)
    """
    load, high = count * G, count * height / 2
    inside = (1 - share) / 2
    return 3 * load * high / (2 * inside**3)


# --- cards ---


def card_house(storeys=3, slope=CARD, engine=ENGINE, friction=0.8, iterations=None, **settings):
    """Tents of two cards each, `storeys` of them side by side at the bottom, flat cards between storeys.

    A card is 0.02 x 1. Tents: the upper corners touch; feet stand on the floor, or on the flat cards over the tops
    below. The most friction wanted is that of a card under no load but its own at its foot, tan(slope)/2, up to
    tan(slope) = 0.36 where all its load comes from above.
    """
    world = World(G, friction=friction, engine=engine, iterations=iterations, **settings)
    world.floor()
    length, thick, mass = 1.0, 0.02, 1.0
    half_x = (thick * math.cos(slope) + length * math.sin(slope)) / 2
    half_y = (length * math.cos(slope) + thick * math.sin(slope)) / 2
    pitch = 4 * half_x + thick  # of the tents: feet side by side
    y = 0.0
    for storey in range(storeys):
        count = storeys - storey
        for i in range(count):
            x = pitch * (i - (count - 1) / 2)
            world.box((x - half_x, y + half_y), (thick, length), mass=mass, angle=-slope)
            world.box((x + half_x, y + half_y), (thick, length), mass=mass, angle=slope)
        y += 2 * half_y
        if count > 1:  # one flat card over all tops of the storey: what stands on it cannot tip it
            world.box(
                (0.0, y + thick / 2), (pitch * (count - 1) + 2 * half_x, thick), mass=mass * (count - 1)
            )
            y += thick
    return world
