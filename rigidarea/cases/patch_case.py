"""Patch test: a block pressed into a wider one (the paper's section 3.3, Fig. 11–13).

Left open by the paper and chosen here: block sizes (40 × 20 mm on 80 × 30 mm), k (5×10⁷ N/m²), node positions.
Displacements are prescribed (gaps of 2 and 6 mm), on a uniform, a defined non-uniform and a random mesh.

Measured on the nodal pressures: their spread on each body, the ratio of the two bodies' means, and how far the
nodal forces are from the global force and from zero moment about the centroid. The paper's own Alg. 3 stands beside
ours (its pressures differ between the bodies because crossing points carry no force and vertical sides carry
some). And the test behind the name: under the nodal forces, with the same pressure on its upper side, the stress
of the upper block must be uniform.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import scipy.sparse.linalg as spl

from rigidarea.cases import figures
from rigidarea.cases.case_report import BLACK, BLUE, RED, Array, Case, figure, save
from rigidarea.flexible import nodal
from rigidarea.flexible.boundary import Work, build, workspace
from rigidarea.flexible.boundary_regions import arcs
from rigidarea.flexible.element import Material, stiffness, stress
from rigidarea.flexible.mesh import Mesh, triangulate

SLAVE, MASTER, K = (0.040, 0.020), (0.080, 0.030), 5e7
GAPS = (0.002, 0.006)
MESHES = ("uniform", "defined", "random")
PAPER: dict[str, Any] = {"pressure_spread_pa": 1e-2, "master_equals_slave": False}


def face(width: float, mesh: str, count: int, seed: int) -> Array:
    """Node positions along a face of ``width``, ends included, left to right."""
    if mesh == "uniform":
        s = np.linspace(0, 1, count)
    elif mesh == "defined":  # twice as fine at the right end
        s = np.linspace(0, 1, count)
        s = s + 0.3 * s * (1 - s)
    else:
        gaps = np.random.default_rng(seed).uniform(0.4, 1.6, count - 1)
        s = np.concatenate([[0.0], np.cumsum(gaps) / gaps.sum()])
    return width * (s - 0.5)


def block(size: tuple[float, float], top: Array | None, bottom: Array | None, step: float) -> Array:
    """A rectangle's ring, counter-clockwise from its lower left corner; ``top`` or ``bottom`` are node positions."""
    w, h = size
    even = np.linspace(-0.5 * w, 0.5 * w, max(2, round(w / step) + 1))
    lower = even if bottom is None else bottom
    upper = even if top is None else top
    side = np.linspace(0, h, max(2, round(h / step) + 1))[1:-1]
    return np.vstack(
        [
            np.column_stack([lower, 0 * lower]),
            np.column_stack([0 * side + 0.5 * w, side]),
            np.column_stack([upper[::-1], 0 * upper + h]),
            np.column_stack([0 * side - 0.5 * w, side[::-1]]),
        ]
    )


def rings(mesh: str) -> tuple[Array, Array]:
    """The upper block (slave) and the lower (master), whose top is at y = 0; meshes of the faces do not match."""
    slave = block(SLAVE, None, face(SLAVE[0], mesh, 17, 1), 0.0025)
    master = block(MASTER, face(MASTER[0], mesh, 24, 2), None, 0.0035) - [0, MASTER[1]]
    return slave, master


def press(gap: float, mesh: str) -> tuple[dict[str, Any], tuple[Work, Work]]:
    """One row of the patch test, both decompositions of the contact force; and the loaded bodies, for the figures."""
    slave, master = rings(mesh)
    a, b = build([slave]), build([master])
    wa, wb = workspace(a), workspace(b)
    s = nodal.scratch(len(slave) + len(master))
    pose_a, pose_b, none = np.array([0.0011, -gap, 1.0, 0.0]), np.array([0.0, 0.0, 1.0, 0.0]), np.zeros(0)
    pairs = nodal.search(a, pose_a, b, pose_b, 0.0, s)
    n = nodal.contact(a, wa, pose_a, none, b, wb, pose_b, none, pairs, 1, K, 1.0, True, s)
    if n != 1:
        raise RuntimeError(f"expected one contact region, found {n}")
    r = s.regions[0].copy()
    force = r["force"] * np.array([r["nx"], r["ny"]])
    centre = np.array([r["x"], r["y"]])
    row: dict[str, Any] = {"gap_mm": 1e3 * gap, "mesh": mesh}
    spread, means, balance, moments = [], [], [], []
    for w, sign in ((wa, -1.0), (wb, 1.0)):
        p = w.pressure[w.pressure > 0]
        spread.append(float(np.ptp(p) / p.mean()))
        means.append(float(p.mean()))
        touched = w.touched[: w.touched[-1]]
        f, arm = w.point_load[touched], w.position[touched] - centre
        balance.append(np.abs(f.sum(0) - sign * force).max() / r["force"])
        moments.append(abs((arm[:, 0] * f[:, 1] - arm[:, 1] * f[:, 0]).sum()) / (r["force"] * SLAVE[0]))
    row |= {
        "pressure_spread_relative": max(spread),
        "master_slave_ratio": means[1] / means[0],
        "force_balance_relative": float(max(balance)),
        "moment_balance_relative": float(max(moments)),
        "pressure_pa_m": means[0],
    }
    # the paper's Alg. 3, q = 1
    n_a, n_b = arcs(r, s)
    poly = [np.column_stack([s.x[k, : m + 1], s.y[k, : m + 1]]) for k, m in ((0, n_a), (1, n_b))]
    literal = []
    for k, up in ((0, 1.0), (1, -1.0)):
        normal, depth, _, weight = nodal.literal(poly[k], poly[1 - k], 1.0)
        normal = np.where((normal[:, 1:2] * up) < 0, -normal, normal)
        middle = np.array([r["x"] - r["enter_x"], r["y"] - r["enter_y"]])
        u = np.array([-r["ny"], r["nx"]])
        local = np.array([u @ middle, -(u[1] * middle[0] - u[0] * middle[1])])
        alpha = nodal.literal_alpha(normal, weight, poly[k][1:-1], local, np.array([0.0, up * r["force"]]))
        # the face: corner and side nodes have other normals
        inner = (depth > 0) & (np.abs(normal[:, 1]) > 0.99)
        literal.append(float((alpha * depth[inner]).mean()))
    row["master_slave_ratio_literal"] = literal[1] / literal[0]
    row["pressure_literal_pa_m"] = literal  # slave, master
    row["stress_spread_relative"] = stress_spread(slave, wa.point_load, r["force"])
    # the figures draw all points, not the near ones
    wa.position[:], wb.position[:] = slave + pose_a[:2], master
    return row, (wa, wb)


def stress_spread(ring: Array, loads: Array, force: float) -> float:
    """Spread of σ_yy in the upper block under the contact's nodal forces and an even pressure on its upper side."""
    mesh: Mesh = triangulate([ring])
    material = Material(207e9, 0.29, 7800.0, 0.005)
    f = np.zeros((len(mesh.points), 2))
    f[: len(ring)] = loads
    top = np.flatnonzero(np.abs(mesh.points[: len(ring), 1] - SLAVE[1]) < 1e-12)
    top = top[np.argsort(mesh.points[top, 0])]
    length = np.diff(mesh.points[top, 0]) * force / SLAVE[0]
    f[top[:-1], 1] -= 0.5 * length
    f[top[1:], 1] -= 0.5 * length
    k = stiffness(mesh, material)
    # statically determinate supports
    left, right = int(np.argmin(ring.sum(1))), int(np.argmax(ring[:, 0] - ring[:, 1]))
    free = np.setdiff1d(np.arange(2 * len(mesh.points)), [2 * left, 2 * left + 1, 2 * right + 1])
    u = np.zeros(2 * len(mesh.points))
    u[free] = spl.spsolve(k[free][:, free].tocsc(), f.ravel()[free])
    sigma = stress(mesh, material, u.reshape(-1, 2))[:, 1]
    return float(np.ptp(sigma) / abs(sigma.mean()))


def run(out: Path | None = None, cache: Path | None = None) -> dict[str, Any]:
    """All gaps and meshes; figures 11 to 13 redrawn. cache: as other cases have it; nothing is reduced here."""
    settings = {"slave_m": SLAVE, "master_m": MASTER, "k": K, "q": 1.0, "gaps_m": GAPS}
    case = Case("patch", settings, PAPER, 0.0, out)
    case.set_up()
    rows, states = zip(*(press(gap, mesh) for gap in GAPS for mesh in MESHES), strict=True)
    if out is not None:
        _figures(out, rows, states)
    case.results = list(rows)
    return case.finish()


def _figures(out: Path, rows: Sequence[dict[str, Any]], states: Sequence[Any]) -> None:
    """Fig. 11 and 13 on one sheet, and Fig. 12 for all meshes."""
    fig, axes = figure(12, 7, 2, 3, sharex=True)
    for ax, row, (wa, wb) in zip(axes.ravel(), rows, states, strict=True):
        largest = max(float(np.abs(w.point_load).max()) for w in (wa, wb))
        for w, colour, name in ((wa, RED, "slave"), (wb, BLUE, "master")):
            shape = np.vstack([w.position, w.position[:1]])
            ax.plot(*(1e3 * shape).T, ".-", ms=4, lw=0.8, color=colour)
            scale = {**figures.TO_SCALE, "scale": largest / 4}
            arrows = figures.arrows(ax, w, color=colour, **scale, label=f"on the {name}")
        key = float(f"{0.5 * largest:.1g}")
        ax.quiverkey(arrows, 0.5, 0.9, key, f"{key:g} N", labelpos="E", angle=90, color=BLACK)
        ax.set(title=f"gap {row['gap_mm']:.0f} mm, {row['mesh']} mesh", ylim=(-9, 9), xlim=(-26, 26))
    for ax in axes[-1]:
        ax.set_xlabel("x (mm)")
    for ax in axes[:, 0]:
        ax.set_ylabel("y (mm)")
    fig.legend(*axes[0, 0].get_legend_handles_labels(), loc="outside lower center", ncol=2)
    save(fig, out, "patch_fig11_13")
    fig, ax = figure(9, 5)
    for (wa, wb), row, marker in zip(states[:3], rows[:3], "os^", strict=True):
        for w, colour, name in ((wa, RED, "slave"), (wb, BLUE, "master")):
            i = np.flatnonzero(w.pressure > 0)
            x, p = 1e3 * w.position[i, 0], 1e-3 * w.pressure[i]
            ax.plot(x, p, marker, color=colour, fillstyle="none", label=f"{name}, {row['mesh']}")
    literal = zip(rows[0]["pressure_literal_pa_m"], (RED, BLUE), ("slave", "master"), strict=True)
    for value, colour, name in literal:
        ax.axhline(1e-3 * value, color=colour, ls="--", lw=1, label=f"the paper's Alg. 3, {name}, uniform")
    ax.set(xlabel="x (mm)", ylabel="pressure (kN/m)", ylim=(80, 120))
    ax.set_title("gap 2 mm: one pressure on both bodies and all meshes")
    fig.legend(*ax.get_legend_handles_labels(), loc="outside lower center", ncol=4, fontsize=9)
    save(fig, out, "patch_fig12")
