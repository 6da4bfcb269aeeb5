# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes picture and tables of docs/validation/partial_slip_structures.md: state jumps from microslip to gross slip.

    PYTHONPATH=build/python /usr/bin/python3 studies/docs/make_partial_slip_structures.py [--dem]

With --dem, bar, rib and ring also run in YADE, for about twenty minutes. Otherwise the DEM points of the bar and the
tables of rib and ring are omitted.
"""
from __future__ import annotations

import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
from scipy.optimize import brentq

matplotlib.use("agg")
import matplotlib.pyplot as plt  # noqa: E402

import statejump as sj  # noqa: E402
from statejump.kinds.loading import parse_case  # noqa: E402
from statejump.kinds.truss import generate, solve  # noqa: E402
from statejump.kinds.truss.generate.document import TABLE1_LENGTH_M  # noqa: E402

PICTURE = Path(__file__).resolve().parents[2] / "docs" / "partial_slip" / "structures.png"
FRICTION_N = 300.0  # friction limit of the bar, whose contact slides as a whole above about 20 K
INCREMENTS = 200
RING_CYCLES = 30
STYLES = {
    "rigid": {"color": "0.6", "linestyle": "-", "linewidth": 4},
    "elastic": {"color": "#D55E00", "linestyle": "--", "linewidth": 1.8},
    "partial_slip": {"color": "#0072B2", "linestyle": "-", "linewidth": 1.8},
}
MISSED = {"jump_of_node_J": "jump", "jump_of_node_J0": "jump", "energy_residual_over_friction_work": "energy",
          "jump_largest_difference_over_largest_jump_or_loop": "largest jump"}
LABELS = {"rigid": "Coulomb", "elastic": "spring under Coulomb's limit", "partial_slip": "partial slip"}


def path(document: dict[str, Any], sticking: str, increments: int = INCREMENTS, **options: Any) -> solve.TrussPath:
    """Return the quasi-static path of a generated truss with the given model of sticking."""
    truss = parse_case(document | {"reduced": {"sticking": sticking}}).resolve()
    return solve.path(truss, increments_per_branch=increments, cycle_ends_only=True, **options)


def moves_m(found: solve.TrussPath) -> np.ndarray:
    """Return the displacement [m] over each cycle, of the node with the largest displacement in that cycle."""
    moved = np.diff(found.cycle_ends["displacement_m"], axis=0)
    most: np.ndarray = np.linalg.norm(moved, axis=2).max(axis=1)
    return most


def bar(change_K: float, **more: Any) -> dict[str, Any]:
    """Return the case document of the bar on a slider of the paper's Table 1, without stops."""
    return generate.chain(1, friction_force_N=FRICTION_N, temperature_change_K=change_K, **more)


def constants() -> tuple[float, float, float]:
    """Return the stiffnesses of the bar and of its contact [N/m], and the free expansion [m/K]."""
    arrays = solve.engine_items(parse_case(bar(1.0) | {"reduced": {"sticking": "elastic"}}).resolve())
    links, slider = arrays["elements"]["links"], arrays["joints"]["slider"]
    length = links["stress_free_length_m"][0]
    return (float(links["axial_stiffness_N"][0] / length), float(slider["tangential_stiffness_N_per_m"][0]),
            float(length * links["thermal_expansion_per_K"][0]))


def closed_form_m(change_K: float) -> float:
    """Return the jump of the bar [m] from Cattaneo's loading and Masing's unloading. Both are in equilibrium with the
    bar, whose stiffness E A/l follows its length."""
    stiffness, contact, expansion = constants()
    gross, strain = 1.5 * FRICTION_N / contact, expansion / TABLE1_LENGTH_M * change_K

    def loading(slide: float) -> float:
        return FRICTION_N * (1 - max(0.0, 1 - slide / gross) ** 1.5)

    def root(balance: Callable[[float], float], low: float, high: float) -> float:
        return float(brentq(balance, low, high, xtol=1e-22, rtol=1e-14))

    hot, free = stiffness / (1 + strain), expansion * change_K
    top = root(lambda slide: loading(slide) - hot * (free - slide), 0, free)
    return root(lambda slide: loading(top) - 2 * loading((top - slide) / 2) + stiffness * slide, -top, top)


def asymptote_m(change_K: float) -> float:
    """Return the jump of the bar [m] for small amplitudes, k² s²/(12 f (k + K)), where s is the slide of the spring."""
    stiffness, contact, expansion = constants()
    slide = expansion * change_K * stiffness / (contact + stiffness)
    return contact**2 * slide**2 / (12 * FRICTION_N * (contact + stiffness))


def dem_m(change_K: float) -> float:
    """Return the jump of the bar in YADE [m] over one cycle of 0.5 s, relative to the static start state."""
    made = bar(change_K, period_s=0.5)
    made |= {"reduced": {"sticking": "partial_slip"}, "dem": {"friction_law": "mindlin_deresiewicz"}}
    history = sj.load(made).dem()["displacement_m"]
    return float(history[-1, 1, 0] - history[0, 1, 0])


def beside_the_dem(name: str, runs: Sequence[tuple[dict[str, Any], dict[str, float]]]) -> None:
    """Print the results of `statejump compare` for a structure, one row per case and set of keys of its section [dem].
    """
    print(f"\n| {name}: period [s] | `[dem]` | jumps: largest difference over the largest "
          "| energy residue over friction | missed |\n|---:|---|---:|---:|---|")
    for document, keys in runs:
        made = document | {"reduced": {"sticking": "partial_slip"},
                           "dem": document.get("dem", {}) | keys | {"friction_law": "mindlin_deresiewicz"}}
        case = sj.load(made)
        result = sj.compare(case.reduced(), case.dem())
        values = {row.name: row.difference for row in result.rows}
        jumps = values["jump_largest_difference_over_largest_jump_or_loop"]
        told = ", ".join(f"`{key} = {value:g}`" for key, value in keys.items())
        print(f"| {made['thermal']['period_s']:g} | {told} | {jumps:.2e} "
              f"| {values['energy_residual_over_friction_work']:.1e} "
              f"| {', '.join(MISSED.get(one, one) for one in result.missed) or 'none'} |", flush=True)


def rib(change_K: float, **more: Any) -> dict[str, Any]:
    """Return the case document of the rib whose joint rolls without slip if contact is rigid."""
    return generate.umbrella(1, friction_coefficient=0.45, temperature_change_K=change_K, **more)


def draw(axes: Any, changes_K: np.ndarray, jumps: dict[str, np.ndarray], unit: float) -> None:
    """Draw the jumps of one structure, without values below rounding."""
    for sticking, style in STYLES.items():
        shown = np.where(jumps[sticking] * unit > 2e-8, jumps[sticking] * unit, np.nan)
        axes.loglog(changes_K, shown, label=LABELS[sticking], **style)
    axes.set_xlabel("temperature amplitude [K]")
    axes.grid(True, which="major", color="0.9")


def main() -> None:
    figure, (left, middle, right) = plt.subplots(1, 3, figsize=(13, 4.2), dpi=110, layout="constrained")

    changes = np.geomspace(0.05, 200, 73)
    jumps = {one: np.array([moves_m(path(bar(change), one))[0] for change in changes]) for one in STYLES}
    exact = np.array([closed_form_m(change) for change in changes])
    draw(left, changes, jumps, 1e6)
    left.loglog(changes[::6], exact[::6] * 1e6, "o", color="black", markersize=5, fillstyle="none",
                label="closed form")
    told("bar", changes, jumps["partial_slip"])
    small = changes[changes < 20]
    left.loglog(small, [asymptote_m(change) * 1e6 for change in small], ":", color="black", label="slope 2")
    print("| Table 1's bar, ΔT [K] | Coulomb [nm] | spring [nm] | partial slip [nm] | closed form: off by "
          "| slope 2 [nm] | DEM [nm] |\n|---:|---:|---:|---:|---:|---:|---:|")
    crosses: list[tuple[float, float]] = []
    for change in (0.5, 2.0, 8.0, 20.0, 24.0, 30.0, 100.0):
        values = [moves_m(path(bar(change), one))[0] * 1e9 for one in STYLES]
        values = [value if value > 1e-9 else 0.0 for value in values]  # rounding of a bar of 0.5 m
        dem = dem_m(change) if "--dem" in sys.argv else np.nan
        crosses.append((change, dem * 1e6))
        print(f"| {change:g} | {values[0]:.4g} | {values[1]:.4g} | {values[2]:.6g} "
              f"| {values[2] / closed_form_m(change) / 1e9 - 1:+.0e} | {asymptote_m(change) * 1e9:.4g} "
              f"| {dem * 1e9:.6g} |")
    if "--dem" in sys.argv:
        left.loglog(*zip(*crosses), "x", color="#D55E00", markersize=8, label="partial slip, DEM")
    left.set_title("bar of Table 1, μF_N = 300 N")
    left.set_ylabel("jump after one cycle [µm]")
    left.legend(fontsize=8)

    changes = np.geomspace(1, 200, 34)
    jumps = {one: np.array([moves_m(path(rib(change), one))[0] for change in changes]) for one in STYLES}
    draw(middle, changes, jumps, 1e6)
    told("rib, μ = 0.45", changes, jumps["partial_slip"])
    middle.set_title("rib that rolls by rigid theory, μ = 0.45")

    changes = np.geomspace(1, 100, 21)
    jumps = {one: np.array([moves_m(path(generate.ring(12, temperature_change_K=change), one))[0]
                            for change in changes]) for one in STYLES}
    draw(right, changes, jumps, 1e6)
    told("ring_12", changes, jumps["partial_slip"])
    right.set_title("ring of 12 bays, node that jumps most")
    figure.savefig(PICTURE, metadata={"Software": None})
    if "--dem" in sys.argv:
        ring = {period: generate.ring(12, period_s=period) for period in (1.0, 2.0, 4.0)}
        beside_the_dem("ring_12", [*((one, {}) for one in ring.values()), (ring[2.0], {"time_step_fraction": 0.05}),
                                   (ring[2.0], {"link_damping_ratio": 0.02})])
        slow = {period: rib(100.0, shape="sine", period_s=period) for period in (4.0, 16.0, 64.0, 128.0)}
        beside_the_dem("rib", [*((one, {}) for one in slow.values()), (slow[4.0], {"time_step_fraction": 0.05}),
                               (slow[4.0], {"pin_damping_N_m_s_per_rad": 1e-3}),
                               (slow[64.0], {"time_step_fraction": 0.0125})])

    print("\n| ring_12, largest move of a node in cycle | 1 [nm] | 2 [nm] | 3 [nm] | 10 [nm] | 30 [nm] "
          "| 30, twice the increments [nm] |\n|---|---:|---:|---:|---:|---:|---:|")
    for sticking in STYLES:
        coarse, fine = (moves_m(path(generate.ring(12, cycles=RING_CYCLES), sticking, increments, locate_events=False))
                        * 1e9 for increments in (50, 100))
        print(f"| {LABELS[sticking]} | " + " | ".join(f"{coarse[k - 1]:.4g}" for k in (1, 2, 3, 10, 30))
              + f" | {fine[-1]:.4g} |")


def told(name: str, changes_K: np.ndarray, jumps_m: np.ndarray) -> None:
    """Print the exponents of the growth of the jump with the amplitude, at both ends of the amplitude range."""
    slopes = np.diff(np.log(jumps_m)) / np.diff(np.log(changes_K))
    print(f"\n{name}: jump grows with the power {slopes[0]:.3f} of the amplitude at {changes_K[0]:.3g} K, "
          f"{slopes[-1]:.3f} at {changes_K[-1]:.3g} K")


if __name__ == "__main__":
    main()
