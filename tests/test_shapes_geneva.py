"""The Geneva drive against its kinematics (the paper's Eq. 36-38) and shapely."""

import math

import numpy as np
import pytest
from shapely import affinity

from rigidarea.shapes import geneva

ALL = range(3, 13)


def placed(outline, x, angle):
    turned = affinity.rotate(outline.sample(1e-6).polygon, angle, origin=(0, 0), use_radians=True)
    return affinity.translate(turned, x, 0)


def positions(drive, angles):
    for angle in angles:
        yield (
            placed(drive.wheel, drive.center_distance, drive.wheel_angle(angle)),
            placed(drive.pin, 0, angle),
            placed(drive.locking_disc, 0, angle),
        )


def test_the_papers_table_3():
    drive = geneva()
    assert drive.crank_radius == pytest.approx(0.025)
    assert drive.slot_width == pytest.approx(0.00801)
    assert drive.center_distance == 0.05
    assert drive.entry_angle == pytest.approx(math.radians(60))
    assert drive.pin.centroid == pytest.approx((0.025, 0), abs=1e-12)
    assert drive.pin.area == pytest.approx(math.pi * 0.004**2, rel=1e-12)


def test_round_parts_are_arcs():
    drive = geneva(bore=0.004)
    assert [int((arc[:, 2] != 0).sum()) for arc in drive.wheel.arcs] == [4 * 6, 2]
    assert drive.wheel.arcs[0][:, 2].min() == pytest.approx(-(drive.locking_radius + 1e-5))
    for part in (drive.wheel, drive.pin, drive.locking_disc):
        assert part.arcs and part.sample(1e-7).area == pytest.approx(part.area, rel=1e-12)
    sampled = geneva(bore=0.004, tolerance=1e-6)
    assert not sampled.wheel.arcs
    assert sampled.wheel.area == pytest.approx(drive.wheel.area, rel=1e-12)


@pytest.mark.parametrize("slots", ALL)
def test_the_pin_clears_the_slot_by_half_the_clearance(slots):
    drive = geneva(slots)
    tolerance = 1e-6  # a tenth of the clearance, sampled on the pin and on the slot's bottom
    # a hair inside the ends, where the pin's widest chord leaves the straight walls
    angles = np.linspace(-1, 1, 37) * (drive.entry_angle - 1e-3)
    for wheel, pin, disc in positions(drive, angles):
        assert pin.distance(wheel) == pytest.approx(5e-6, abs=1.5 * tolerance)
        assert disc.intersection(wheel).area == 0
        # both walls: pushed sideways by more than half the clearance, the pin overlaps
        hub, play = (drive.center_distance, 0), 2.5e-5 / (drive.center_distance - drive.crank_radius)
        for side in (-1, 1):
            turned = affinity.rotate(wheel, side * play, origin=hub, use_radians=True)
            assert pin.intersection(turned).area > 0


@pytest.mark.parametrize("slots", ALL)
def test_the_locking_arc_holds_the_wheel_over_the_dwell(slots):
    drive = geneva(slots)
    angles = drive.entry_angle + np.linspace(0, 1, 25) * 2 * (math.pi - drive.entry_angle)
    for wheel, pin, disc in positions(drive, angles):
        assert disc.distance(wheel) == pytest.approx(1e-5, abs=1.5e-6)
        assert pin.intersection(wheel).area == 0
        # held both ways: well inside the dwell, a degree of wheel either way runs into the disc
        if drive.entry_angle + 0.3 < angles[12]:
            turned = [affinity.rotate(wheel, side, origin=(drive.center_distance, 0)) for side in (-1, 1)]
            held = [disc.intersection(t).area > 0 for t in turned]
            assert any(held)
    middle = next(positions(drive, [math.pi]))
    for side in (-1, 1):
        turned = affinity.rotate(middle[0], side, origin=(drive.center_distance, 0))
        assert middle[2].intersection(turned).area > 0


def test_wheel_angle_is_the_kinematics_of_the_mechanism():
    """Peak velocity ω λ/(1 − λ) at mid-index, peak |acceleration| 1.350 ω² at ± 22.90° for six slots."""
    drive = geneva(6)
    theta = np.linspace(-drive.entry_angle, drive.entry_angle, 120001)
    angle = np.array([drive.wheel_angle(t) for t in theta])
    step = theta[1] - theta[0]
    velocity = np.gradient(angle, step)
    acceleration = np.gradient(velocity, step)[2:-2]
    assert velocity.min() == pytest.approx(-0.5 / (1 - 0.5), rel=1e-6)
    assert acceleration.max() == pytest.approx(1.350, abs=5e-4)
    assert abs(math.degrees(theta[2:-2][np.argmax(acceleration)])) == pytest.approx(22.90, abs=0.01)
    assert velocity[0] == pytest.approx(0, abs=1e-4)  # enters without a jerk in velocity


@pytest.mark.parametrize("slots", ALL)
def test_a_turn_of_the_crank_is_one_index(slots):
    drive = geneva(slots)
    angles = np.linspace(-7, 20, 4001)
    wheel = np.array([drive.wheel_angle(a) for a in angles])
    assert np.abs(np.diff(wheel)).max() < 0.06  # continuous
    for a in (-1.0, 0.2, 3.0):
        assert drive.wheel_angle(a + 2 * math.pi) - drive.wheel_angle(a) == pytest.approx(
            -2 * math.pi / slots
        )


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"slots": 2}, "slots must be a whole number from 3 to 12, got 2"),
        ({"slots": 13}, "from 3 to 12, got 13"),
        ({"slots": 6.5}, "from 3 to 12, got 6.5"),
        ({"center_distance": 0}, "center_distance must be positive and finite, got 0"),
        ({"pin_diameter": -1}, "pin_diameter must be positive and finite, got -1"),
        ({"pin_diameter": 0.03}, "slots must be apart at their bottoms: .* must be below 0.0249.*got 0.03"),
        ({"clearance": math.nan}, "clearance must be finite and not negative, got nan"),
        ({"locking_radius": 0.0211}, "locking_radius must lie between 0.0065.* and 0.0209.*got 0.0211"),
        ({"locking_radius": 0.005}, "locking_radius must lie between"),
        ({"bore": 0.021}, "bore must end before the slots, below 0.0209"),
        ({"slots": 3, "pin_diameter": 0.012}, "slots must be apart"),
        ({"tolerance": 0}, "tolerance must be positive and finite, got 0"),
    ],
)
def test_bad_parameters_are_named(settings, message):
    with pytest.raises(ValueError, match=message):
        geneva(**settings)
