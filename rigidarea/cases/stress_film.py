"""Stress in motion: a still and a film of each case, from the reduced states of a short run of its own."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from rigidarea.cases.case_report import BLUE, RED, Array, figure, save
from rigidarea.flexible.recover import State, recover
from rigidarea.flexible.stress_pictures import draw_deformed, draw_pressure, draw_stress

MM, MPA = 1e3, 1e-6


class Scene(NamedTuple):
    """What is drawn: states of the bodies at each instant, their contact loads, and how.

    length, stress: factors from the case's units to ``units``. window: middle and half width and height, in the units
    drawn.
    """

    name: str
    times: Sequence[str]
    states: list[list[State]]
    loads: list[list[Array]]
    bodies: tuple[str, str]
    window: tuple[float, float, float, float]
    length: float = MM
    stress: float = MPA
    units: tuple[str, str] = ("mm", "MPa")


def _record(
    name: str, sim: Any, until: float, h: float, duration: float, every: int, bodies: tuple[str, str],
    window: tuple[float, float, float, float],
) -> Scene:  # fmt: skip
    sim.run(until, h)
    start = sim.time
    r = sim.run(duration, h, every, shapes=True)
    rows = range(len(r.t))
    states = [[recover(sim, r, n, b) for b in range(2)] for n in rows]
    loads = [[r.shapes.loads[n][r.shapes.loads[n][:, 0] == b, 1:] for b in range(2)] for n in rows]
    times = [f"t = {1e3 * start:.3f} + {1e3 * (t - start):.3f} ms" for t in r.t]
    return Scene(name, times, states, loads, bodies, window)


def pin_joint(mode: str, mesh_mm: float, contact: str, cache: Path | None) -> Scene:
    """The first impact of the pin on its journal."""
    from rigidarea.cases import pin_joint as case

    sim = case.simulation(mesh_mm, mode, contact, refine=4, cache=cache)
    fall = float(np.sqrt(2 * (case.JOURNAL - case.PIN) / case.GRAVITY))
    return _record(
        "pin_joint", sim, 0.9995 * fall, case.STEP, 1.4e-3, 3, ("pin", "journal"), (0.0, -35.0, 14.0, 9.0)
    )


def geneva(mode: str, mesh_mm: float, contact: str, cache: Path | None) -> Scene:
    """The pin takes the wheel along."""
    from rigidarea.cases import geneva_case as case

    sim, _ = case.simulation(mode, mesh_mm, contact, cache=cache)
    return _record("geneva", sim, 0.03, case.STEP, 0.6, 40, ("pin", "wheel"), (34.0, 0.0, 33.0, 33.0))


def gearbox(mode: str, mesh_mm: float, contact: str, cache: Path | None) -> Scene:
    """Two periods of the teeth, after the ramp."""
    from rigidarea.cases import gearbox as case

    sim = case.simulation(mode, mesh_mm, contact, cache=cache)
    return _record(
        "gearbox", sim, 0.25, case.STEP, 2 * case.MESHING, 1, ("pinion", "wheel"), (23.0, 0.0, 12.0, 9.0)
    )


def hertz(cache: Path | None, division: int = 8, frames: int = 24) -> Scene:
    """Two discs pressed together, up to the case's approach."""
    from rigidarea.cases import hertz as case

    top = case.predicted(division, cache=cache)["approach_m"]
    found = [case.pressed(division, top * (n + 1) / frames, cache) for n in range(frames)]
    return Scene(
        "hertz", [f"approach {1e3 * top * (n + 1) / frames:.1f} mm" for n in range(frames)],
        [list(f[0]) for f in found], [list(f[1]) for f in found], ("lower disc", "upper disc"),
        (0.0, 8.0 - 0.5 * top, 3.0, 3.0), 1.0, 1.0, ("m", "Pa"),
    )  # fmt: skip


def make(
    name: str, mode: str | None, mesh_mm: float | None, contact: str, out: Path, cache: Path | None
) -> Path:
    """Draws the still (``NAME_stress.png``) and the film of a case into ``out``; returns the film's path.

    mode: compliant (also for None) or modal. mesh_mm: None for the case's own.
    """
    if name == "hertz":
        scene = hertz(cache)
    else:
        made = {"pin-joint": (pin_joint, 1.0), "geneva": (geneva, 1.0), "gearbox": (gearbox, 0.6)}
        moving, mesh = made[name]
        scene = moving(mode or "compliant", mesh_mm or mesh, contact, cache)
    still(scene, out)
    return film(scene, out)


def _peak(scene: Scene) -> tuple[int, float]:
    """The instant of the largest contact force, and the end of the stress scale: but for a thousandth of the
    triangles, those at corners, the largest then."""
    force = [np.hypot(*loads[0][:, 1:].sum(0)) if len(loads[0]) else 0.0 for loads in scene.loads]
    n = int(np.argmax(force))
    values = np.concatenate([s.shape.von_mises(s.displacement) for s in scene.states[n]])
    return n, float(np.quantile(values, 0.999)) * scene.stress


def still(scene: Scene, out: Path) -> None:
    """Stress, contact pressure along the face and the deformed shape at the instant of the largest force."""
    n, top = _peak(scene)
    fig, (left, middle, right) = figure(15, 5.2, 1, 3)
    unit, pressure = scene.units
    mappable = draw_stress(left, scene.states[n], length=scene.length, stress=scene.stress, top=top)
    fig.colorbar(mappable, ax=left, label=f"von Mises stress ({pressure})", extend="max", shrink=0.8)
    left.set_title(f"stress, {scene.times[n]}", fontsize=10)
    for i, (colour, style) in enumerate(((BLUE, "o-"), (RED, "s--"))):
        state = scene.states[n][i]
        draw_pressure(
            middle, state.shape, scene.loads[n][i], scene.bodies[i], colour, style, length=scene.length,
            stress=scene.stress,
        )  # fmt: skip
    middle.set(xlabel=f"way along the face ({unit})", ylabel=f"contact pressure ({pressure})")
    middle.legend()
    magnification = _magnification(scene, n)
    draw_deformed(right, scene.states[n], magnification, (BLUE, RED), length=scene.length)
    right.set_title(f"deformed, displacements × {magnification:g}; grey: as it was", fontsize=10)
    for ax in (left, right):
        _frame(ax, scene)
    save(fig, out, f"{scene.name}_stress")


def _magnification(scene: Scene, n: int) -> float:
    """1, 2 or 5 times a power of ten: largest displacements in the picture's twentieth part; 1 at least."""
    moved = max(float(np.hypot(*s.displacement.T).max()) for s in scene.states[n]) * scene.length
    wanted = 0.05 * scene.window[2] / moved if moved > 0 else 1.0
    power = 10.0 ** np.floor(np.log10(wanted))
    return max(1.0, float(max(f for f in (1, 2, 5) if f * power <= wanted) * power))


def _frame(ax: Any, scene: Scene) -> None:
    x, y, wide, high = scene.window
    unit = scene.units[0]
    ax.set(xlim=(x - wide, x + wide), ylim=(y - high, y + high), xlabel=f"x ({unit})", ylabel=f"y ({unit})")
    ax.grid(False)


def frames(scene: Scene) -> Iterator[NDArray[np.uint8]]:
    """The film's pictures (h, w, 3), one scale of stress for all."""
    import matplotlib.pyplot as plt

    _, top = _peak(scene)
    _, _, wide, high = scene.window
    for time, states in zip(scene.times, scene.states, strict=True):
        fig, ax = figure(8.0, 8.0 * high / wide * 0.8 + 0.8)
        mappable = draw_stress(ax, states, length=scene.length, stress=scene.stress, top=top)
        fig.colorbar(mappable, ax=ax, label=f"von Mises stress ({scene.units[1]})", extend="max", shrink=0.8)
        ax.set_title(time, fontsize=10)
        _frame(ax, scene)
        fig.set_dpi(100)
        fig.canvas.draw()
        yield np.asarray(fig.canvas.buffer_rgba())[:, :, :3].copy()
        plt.close(fig)


def film(scene: Scene, out: Path) -> Path:
    """Writes the film of a scene; returns its path."""
    import pygame

    from rigidarea.draw.film import Film

    with Film(out / f"{scene.name}_stress") as into:
        for picture in frames(scene):
            even = picture[: picture.shape[0] // 8 * 8, : picture.shape[1] // 8 * 8]
            into.add(pygame.surfarray.make_surface(even.swapaxes(0, 1)))
    return into.path
