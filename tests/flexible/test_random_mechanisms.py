"""Mechanisms of random proportions: the compliant level runs wherever the modal one does, and agrees where it must."""

from __future__ import annotations

from functools import cache
from typing import NamedTuple

import numpy as np
import pytest

from rigidarea.flexible import Body, Material, Simulation, elastic_body
from rigidarea.flexible.boundary import build
from rigidarea.shapes import eccentric, flat_follower, geneva, internal_gear, involute_gear

THICK = 0.01  # m
MODES = 10


class Mechanism(NamedTuple):
    """Bodies; k = ratio · E; the larger curvature radius and the reduced mass of the contact; step and duration."""

    bodies: list[Body]
    young: float
    radius: float
    mass: float
    step: float
    duration: float


def material(rng, low, high):
    return Material(float(np.exp(rng.uniform(np.log(low), np.log(high)))), 0.3, 2000.0, THICK)


def gears(rng, level, internal=False):
    m, z = rng.uniform(1e-3, 4e-3), int(rng.integers(18, 26))
    mat = material(rng, 1e9, 2e11)
    tooth = {"addendum": rng.uniform(0.9, 1.05), "tolerance": 1e-4 * m}
    size, backlash = 0.6 * m, rng.uniform(0, 0.02) * m
    pinion = involute_gear(m, z, bore=0.25 * z * m, rack_tip_radius=0.2, backlash=backlash, **tooth)
    turning = rng.uniform(5.0, 50.0)
    keys = {"modes": MODES, "refine": 3}
    a, _ = elastic_body(
        pinion.rings, size, mat, level, hub=1, anchor=(0.0, 0.0), drive=(0.0, turning, 0.002), **keys
    )
    if internal:
        other = int(rng.integers(z + 20, 64))
        ring = internal_gear(m, other, **tooth)
        at = (0.5 * m * (z - other), 0.0)
        b, _ = elastic_body(
            ring.rings, size, mat, level, contact_rings=(1,), hub=0, anchor=at, position=at, **keys
        )
    else:
        other = int(rng.integers(z, 45))
        wheel = involute_gear(m, other, bore=0.25 * other * m, rack_tip_radius=0.2, **tooth)
        at = (0.5 * m * (z + other), 0.0)
        b, _ = elastic_body(
            wheel.rings, size, mat, level, hub=1, anchor=at, position=at, angle=np.pi + np.pi / other, **keys
        )
    b.damper = 2.0 * b.inertia / 0.01  # a load that holds the flanks together
    mass = b.inertia / (0.5 * m * other) ** 2
    return Mechanism([a, b], mat.young, 0.15 * m * z, mass, 2e-5, 0.012)


def internal_gears(rng, level):
    return gears(rng, level, internal=True)


def genevas(rng, level):
    slots = int(rng.integers(4, 9))
    centres = rng.uniform(0.05, 0.1)
    pin = 0.1 * centres if slots < 7 else 0.06 * centres
    mat = material(rng, 1e9, 2e11)
    drive = geneva(slots, centres, pin, 1e-4, bore=0.08 * centres, tolerance=1e-6)
    r, start, speed = drive.crank_radius, -drive.entry_angle - 0.004, rng.uniform(2.0, 8.0)
    at = (r * np.cos(start), r * np.sin(start))
    keys = {"modes": MODES, "refine": 4}
    a, _ = elastic_body(
        [drive.pin.rings[0] - [r, 0.0]], 0.15 * pin, mat, level, position=at, angle=start, anchor=(0.0, 0.0),
        drive=(start, speed, 0.0), velocity=(-speed * at[1], speed * at[0], speed), **keys,
    )  # fmt: skip
    a.hub = (-r, 0.0)
    b, _ = elastic_body(
        drive.wheel.rings, 0.3 * pin, mat, level, hub=1, anchor=(centres, 0.0), position=(centres, 0.0),
        angle=drive.wheel_angle(-drive.entry_angle), **keys,
    )  # fmt: skip
    b.damper = b.inertia / 0.05
    return Mechanism([a, b], mat.young, 0.5 * pin, b.inertia / centres**2, 5e-5, 0.04)


def cams(rng, level):
    radius = rng.uniform(0.02, 0.05)
    off, mat = 0.25 * radius, material(rng, 1e9, 2e11)
    cam = eccentric(radius, off, 0.25 * radius, tolerance=1e-6)
    height = 0.4 * radius
    lever = flat_follower(4.0 * radius, height, 0.12 * radius, tolerance=1e-6)
    keys = {"modes": MODES}
    speed = rng.uniform(10.0, 30.0)
    a, _ = elastic_body(
        cam.rings, 0.08 * radius, mat, level, hub=1, refine=6, anchor=(0.0, 0.0), drive=(0.0, speed, 0.01), **keys
    )  # fmt: skip
    pivot = (-2.0 * radius, radius + 0.5 * height + 1e-5 * radius)
    b, _ = elastic_body(lever.rings, 0.12 * radius, mat, level, hub=1, anchor=pivot, position=pivot, **keys)
    # pressed down by more than the follower's inertia takes to go up
    b.torque = -4.0 * b.inertia * speed**2
    return Mechanism([a, b], mat.young, radius, b.inertia / (2 * radius) ** 2, 2e-5, 0.04)


def floor(width):
    return Body(build([width * np.array([[-1, -0.5], [1, -0.5], [1, 0.0], [-1, 0.0]]) + [0, 0.25 * width]]), 1.0, 1.0,
                (0.0, -0.25 * width), fixed=True)  # fmt: skip


def soft_discs(rng, level):
    radius, mat = rng.uniform(0.02, 0.1), material(rng, 1e5, 1e7)
    t = 2 * np.pi * np.arange(2000) / 2000
    speed = rng.uniform(0.05, 0.2)
    disc, _ = elastic_body(
        [radius * np.column_stack([np.cos(t), np.sin(t)])], 0.15 * radius, mat, level, modes=MODES, refine=4,
        position=(0.0, radius + 1e-4), velocity=(0.0, -speed, 0.0),
    )  # fmt: skip
    # the least that a disc and this contact in series have as their period, times a twentieth, as the stiffest
    return Mechanism([disc, floor(3 * radius)], mat.young, radius, disc.mass, 2e-5, 0.03)


def beams(rng, level):
    """A ball on the middle of a free beam."""
    length, mat = rng.uniform(0.1, 0.3), material(rng, 1e9, 2e11)
    height = length / rng.uniform(10, 18)
    corners = 0.5 * np.array([[-length, -height], [length, -height], [length, height], [-length, height]])
    beam, _ = elastic_body([corners], height / 4, mat, level, modes=MODES, refine=1)
    radius = 0.6 * height
    t = 2 * np.pi * np.arange(4000) / 4000
    ball = Body(
        build([radius * np.column_stack([np.cos(t), np.sin(t)])]), 0.3 * beam.mass, 0.15 * beam.mass * radius**2,
        (0.03 * length, 0.5 * height + radius + 1e-5), velocity=(0.0, -rng.uniform(0.1, 1.0), 0.0),
    )  # fmt: skip
    mass = 1 / (1 / ball.mass + 1 / beam.mass)
    return Mechanism([ball, beam], mat.young, radius, mass, 1e-6, 1.5e-3)


KINDS = (gears, internal_gears, genevas, cams, soft_discs, beams)


@cache
def built(make, seed, level):
    return make(np.random.default_rng(seed), level)


def run(make, seed, level, ratio):
    made = built(make, seed, level)
    margin = 0.02 * min(np.linalg.norm(b.boundary.points, axis=1).max() for b in made.bodies)
    sim = Simulation(made.bodies, k=ratio * made.young, margin=margin, rho=0.8)
    return made, sim.run(made.duration, made.step)


def check(make, seed, ratio):
    """Runs both levels: the largest difference of mean and peak force, nan where the modes are not far above."""
    made, compliant = run(make, seed, "compliant", ratio)
    modal_made, modal = run(make, seed, "modal", ratio)
    forces = [np.hypot(*r.force.T) for r in (compliant, modal)]
    assert min(f.max() for f in forces) > 0.0  # they did meet
    assert all(np.isfinite(f).all() for f in forces)
    # a lens of area A = L³/(12 R) has the chord L; √(k L/m) is the contact's frequency, the body's own behind it
    # only makes it lower
    chord = (12 * made.radius * forces[1].max() / (ratio * made.young)) ** (1 / 3)
    contact = np.sqrt(ratio * made.young * chord / made.mass)
    slowest = min(b.frequency.min() for b in modal_made.bodies if len(b.frequency))
    if slowest < 10 * contact:
        return np.nan
    mean = abs(forces[0].mean() / forces[1].mean() - 1)
    return max(mean, abs(forces[0].max() / forces[1].max() - 1))


@pytest.mark.parametrize("make", KINDS, ids=lambda f: f.__name__)
def test_stiff_and_soft_contacts(make):
    """The softest and the stiffest contact, one mechanism of each kind: none stops."""
    for ratio in (1e-3, 1e2):
        check(make, 1, ratio)


@pytest.mark.slow
def test_twelve_mechanisms():
    """k/E from 1e-3 to 1e2 on twelve mechanisms, both levels: none stops, and forces agree within 2 % where the
    slowest mode is ten times faster than the contact."""
    differences = []
    for make in KINDS:
        for seed in (2, 3):
            for ratio in (1e-3, 1e-2, 1e-1, 1.0, 10.0, 100.0):
                differences.append((check(make, seed, ratio), make.__name__, seed, ratio))
    compared = [d for d in differences if np.isfinite(d[0])]
    print(f"{len(differences)} runs a level, {len(compared)} compared, worst {max(compared)}")
    assert len(compared) >= 8
    assert max(compared)[0] < 0.02
