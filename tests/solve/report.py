"""What the one solve must show: asked, measured. `python tests/solve/report.py [--only WORD] [--steps N]`.

The same functions as the tests', the shorter runs. `SOLVE_ENGINE=pymunk` shows pymunk's own solver where it can.
"""

from __future__ import annotations

import argparse
import time

import standing_scenes
import test_piles
import test_rebounds
import test_stands
from report_measures import (
    Measured,
    apex_error,
    below,
    buckling,
    forces_on_two,
    grip,
    holds,
    near,
    parting,
    pit,
    pushed,
    pyramid_shift,
    random,
    ratio,
    rest,
    restitution_error,
    spin_drift,
    tilt,
)
from solve_world import ENGINE
from test_buckling import measured as lean_of_a_tower
from test_fast import (
    test_a_bullet_meets_a_free_plate,
    test_a_card_of_two_millimetres_at_50_metres_a_second,
    test_a_disc_at_200_metres_a_second_meets_a_thin_wall,
    test_a_one_way_platform,
    test_boxes_at_ten_thousand_pixels_a_second_at_segments,
    test_what_the_user_excludes_is_not_felt,
)
from test_forces import (
    test_a_force_on_a_body_inside_a_cup,
    test_a_velocity_function_that_does_not_call_pymunks,
    test_a_velocity_set_before_every_frame,
    test_functions_and_callbacks_are_called_once_a_frame,
    test_what_a_contact_reports_is_the_frames,
)
from test_joints import (
    test_a_breakable_joint_breaks_at_its_load,
    test_a_joints_impulse_is_the_frames,
    test_contacts_and_joints_are_solved_together,
)
from test_overlapped import test_two_boxes_on_the_floor_do_not_fly
from test_sinking import (
    sinking_of_ten,
    test_a_plank_sinks_by_the_penetration_of_its_smallest_extent,
    test_force_is_stiffness_times_area_at_rest,
    test_stiffness_changes_without_moving_energy,
    test_the_load_carried_counts,
)
from test_sleep import test_waking_is_no_jolt, test_what_wakes_a_pile
from test_symmetry import (
    test_a_copy_in_mid_contact_goes_on_as_the_original,
    test_scale_changes_nothing,
    test_the_mirrored_scene_gives_mirrored_bits,
    test_the_order_of_insertion_changes_nothing,
)

Row = tuple[str, str, Measured]


def rows(n: int | None) -> list[Row]:
    """All lines, at n steps a frame (None: the default) where a line does not say its own."""
    some = (1, 2, 4, 32, None)
    table: list[Row] = [
        (
            "restitution, e 0.1 to 1, any steps",
            "< 0.002",
            below(0.002, lambda: restitution_error((0.1, 0.5, 1.0), some)),
        ),
        ("restitution, e = 0, any steps", "< 0.01", below(0.01, lambda: restitution_error((0.0,), some))),
        ("apex with gravity, any steps", "< 0.002", below(0.002, lambda: apex_error(some))),
        ("gripping impact, 1 step", "< 0.002", below(0.002, lambda: grip(1))),
        ("gripping impact", "< 0.002", below(0.002, lambda: grip(n))),
        ("two free discs, friction: momenta, 1 step", "< 1e-9", below(1e-9, lambda: spin_drift(1))),
        (
            "box on box e = 0: speed back",
            "< 0.01",
            below(0.01, lambda: test_rebounds.dropped(1.0, 1.0, n)[0]),
        ),
        ("the same, mass 100 on 1", "< 0.01", below(0.01, lambda: test_rebounds.dropped(100.0, 1.0, n)[0])),
        (
            "elastic chain 1e4, 64 steps: energy",
            "1 ± 0.01",
            near(1.0, 0.01, lambda: test_rebounds.chain(64)[1]),
        ),
        ("60 elastic discs, 10 s: energy", "1 ± 0.01", near(1.0, 0.01, lambda: test_rebounds.gas(n, 10))),
    ]
    for kind in ("boxes", "discs"):
        table.append(
            (f"two free {kind} 0.4 deep: sizes/s", "< 4", below(4.0, lambda kind=kind: parting(kind, n)))
        )
    table += [
        ("overlapped on the floor", "height", holds(test_two_boxes_on_the_floor_do_not_fly, (0.4, None, n))),
        ("b.force = 6 for 1 s: v", "6", near(6.0, 1e-9, lambda: pushed(n))),
        (
            "velocity_func of the user's own",
            "rests",
            holds(test_a_velocity_function_that_does_not_call_pymunks, (1,), (n,)),
        ),
        (
            "velocities set before every frame",
            "exact",
            holds(test_a_velocity_set_before_every_frame, (0, n), (1, n)),
        ),
        (
            "once a frame",
            "calls",
            holds(test_functions_and_callbacks_are_called_once_a_frame, (1,), (4,), (n,)),
        ),
        (
            "force inside a cup",
            "0.5",
            holds(test_a_force_on_a_body_inside_a_cup, (n,)),
        ),
        ("arbiter's impulse", "m g dt", holds(test_what_a_contact_reports_is_the_frames, (1,), (n,))),
        (
            "joint's impulse",
            "m g dt",
            holds(test_a_joints_impulse_is_the_frames, ("pin", 4), ("pivot", n), ("slide", n)),
        ),
        ("breakable joint", "at 15 N", holds(test_a_breakable_joint_breaks_at_its_load, (4,), (n,))),
        ("bridge with a crate", "holds", holds(test_contacts_and_joints_are_solved_together, (4,), (n,))),
    ]
    for kind in ("boxes", "hexagons", "discs"):
        table.append((f"pit of 200 {kind}, 4 steps", "inside", lambda kind=kind: pit(kind, 4)))
    for name in test_piles.PILES:
        table.append((f"{name}: sizes/s in the 7th s", "<= pymunk at 4", lambda name=name: rest(name, n)))
    for name in ("row", "pyramid", "wall"):
        table.append(
            (f"tilted {name}: off g (sin - mu cos)", "< 0.01", below(0.01, lambda name=name: tilt(name, n)))
        )
    table.append(("pyramid of 820, 5 s: way / side", "< 0.1", below(0.1, lambda: pyramid_shift(40, 5.0, n))))
    if ENGINE == "area":
        for count, top in ((1, 0.011), (2, 0.011), (4, 0.011), (None, 0.011)):
            label = f"10 boxes of one k, {count or 'default'} steps: m"
            table.append((label, "0.011", near(top, 0.02, lambda c=count: sinking_of_ten(c))))
        table += [
            (
                "plank 0.1 x 4 on end",
                "2e-5 m",
                holds(test_a_plank_sinks_by_the_penetration_of_its_smallest_extent, ((0.1, 4.0), 2e-4, n)),
            ),
            ("load carried", "2e-4", holds(test_the_load_carried_counts, (n,))),
            ("F = k A with the region's k", "1e-3", holds(test_force_is_stiffness_times_area_at_rest, (n,))),
            ("k changes: energy", "1e-3", holds(test_stiffness_changes_without_moving_energy, (n,))),
            ("20 boxes at 2e-4: rate over the beam's", "1 ± 0.2", near(1.0, 0.2, lambda: buckling(n))),
            (
                "40 boxes at 5e-6, 10 s: lean",
                "< 0.05",
                below(0.05, lambda: lean_of_a_tower(40, 5e-6, n, 10.0)[1]),
            ),
        ]
    for kind in ("on two", "column"):
        for value in (400.0, 1000.0, 10000.0):
            table.append(
                (f"{value:.0f} on light, {kind}", "0.1, 2e-4", lambda k=kind, v=value: ratio(k, v, n))
            )
    if ENGINE == "area":
        for value in (400.0, 10000.0):
            table.append(
                (
                    f"{value:.0f} on two: forces off statics",
                    "< 0.05",
                    below(0.05, lambda v=value: forces_on_two(v, n)),
                )
            )
    for share in (1.03, 1.05, 1.1):
        ladder = lambda share=share: test_stands.moves(standing_scenes.ladder(share), 10, n)[0]  # noqa: E731
        table.append((f"ladder at {share}, 10 s: way", "< 0.01", below(0.01, ladder)))
    firm, stiff = ({"penetration": p} if ENGINE == "area" else {} for p in (1e-6, 1e-9))
    table += [
        (
            "arch at 1.1, 10 s: way / radius",
            "< 0.02 (aim)",
            below(0.02, lambda: test_stands.moves(standing_scenes.arch(1.1), 10, n)[0]),
        ),
        (
            "the same, penetration 1e-6",
            "< 0.02",
            below(0.02, lambda: test_stands.moves(standing_scenes.arch(1.1, **firm), 10, n)[0]),
        ),
        (
            "card house, 5 s: way",
            "< 0.05",
            below(0.05, lambda: test_stands.moves(standing_scenes.card_house(), 5, n)[0]),
        ),
        (
            "5 books at 0.98, 5 s: way",
            "< 0.01",
            below(0.01, lambda: test_stands.moves(standing_scenes.overhang(0.98, **stiff), 5, n)[0]),
        ),
        (
            "disc at 200 m/s, wall of 0.1 m",
            "never",
            holds(
                test_a_disc_at_200_metres_a_second_meets_a_thin_wall,
                *((e, m) for e in (0.0, 0.5, 1.0) for m in (1, n)),
            ),
        ),
        (
            "card of 2 mm at 50 m/s",
            "never",
            holds(
                test_a_card_of_two_millimetres_at_50_metres_a_second,
                *((a, m) for a in (0.0, 0.4) for m in (1, n)),
            ),
        ),
        (
            "boxes at 1e4 px/s at segments",
            "never",
            holds(test_boxes_at_ten_thousand_pixels_a_second_at_segments, (1,), (n,)),
        ),
        ("bullet at a free plate", "never", holds(test_a_bullet_meets_a_free_plate, (1,), (n,))),
        ("one-way platform", "verdict first", holds(test_a_one_way_platform, (3.0, n), (100.0, n))),
        (
            "filters, sensors, denials at 200 m/s",
            "to the bit",
            holds(
                test_what_the_user_excludes_is_not_felt,
                *((h, n) for h in ("filter", "sensor", "begin", "pre_solve", "group")),
            ),
        ),
        ("random scenes, law energy (of 200: 40)", "1 %, 1e-9", lambda: random("energy", range(40))),
        ("random scenes, law area", "1 %, 1e-9", lambda: random("area", range(40))),
        ("mirrored bits", "same", holds(test_the_mirrored_scene_gives_mirrored_bits, (1,), (n,))),
        ("order of insertion", "same", holds(test_the_order_of_insertion_changes_nothing, (1,), (n,))),
        ("scale 1e-3, 1e3", "1e-6", holds(test_scale_changes_nothing, (1e-3, n), (1e3, n))),
        (
            "copies in mid-contact",
            "same",
            holds(test_a_copy_in_mid_contact_goes_on_as_the_original, (20, "copy", n), (90, "pickle", n)),
        ),
        ("asleep as one, woken as one", "as pymunk", holds(test_what_wakes_a_pile, (n,))),
        ("waking is no jolt", "1e-2 m/s", holds(test_waking_is_no_jolt, (n,))),
    ]
    return table


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--only", default="", help="lines that contain this")
    parser.add_argument("--steps", type=int, default=None, help="steps a frame (default: contact.step's own)")
    options = parser.parse_args()
    good = count = 0
    began = time.perf_counter()
    for label, asked, measure in rows(options.steps):
        if options.only not in label:
            continue
        start = time.perf_counter()
        try:
            text, right = measure()
        except Exception as error:  # a line that cannot be measured is a line not shown
            text, right = f"{type(error).__name__}: {error}"[:78], False
        good, count = good + right, count + 1
        took = time.perf_counter() - start
        print(f"{'ok ' if right else 'NOT'} {label:44s} {asked:15s} {text:78s} {took:5.1f} s", flush=True)
    print(f"{good} of {count} lines, {time.perf_counter() - began:.0f} s")


if __name__ == "__main__":
    main()
