# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes pictures and table of docs/validation/partial_slip.md: eleven cases, compared with closed forms and with a
model of many flat punches.

PYTHONPATH=build/python /usr/bin/python3 studies/docs/make_partial_slip.py
"""
from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import matplotlib
import numpy as np

matplotlib.use("agg")
import matplotlib.pyplot as plt  # noqa: E402

from statejump import laws  # noqa: E402

YOUNG, SHEAR, RADIUS, MU, LOAD = 38.5e9, 7.9e9, 0.01, 0.3, 10.0  # E*, G* [Pa], m, -, N
KAPPA = YOUNG / (4 * SHEAR)
PICTURES = Path(__file__).resolve().parents[2] / "docs" / "partial_slip"
STEPS = 50
PUNCHES = 20000


@dataclass(frozen=True)
class Case:
    """A branch between two points (normal force N, tangential force T) in units of LOAD, after a path to the first
    point."""

    name: str
    path: tuple[tuple[float, float], ...]


CASES = (
    Case("N constant, T rises", ((1, 0), (1, 0.24))),
    Case("N constant, T falls", ((1, 0), (1, 0.24), (1, -0.15))),
    Case("N constant, T rises again", ((1, 0), (1, 0.24), (1, -0.15), (1, 0.18))),
    Case("N rises, T rises, dT/dN < μ", ((1, 0), (2, 0.2))),
    Case("N rises, T rises, dT/dN > μ", ((1, 0), (2, 0.5))),
    Case("N falls, T rises", ((1, 0), (0.5, 0.12))),
    Case("N rises, T falls, |dT/dN| < μ", ((1, 0), (1, 0.24), (2, 0.04))),
    Case("N rises, T falls, |dT/dN| > μ", ((1, 0), (1, 0.24), (1.5, -0.2))),
    Case("N falls, T falls", ((1, 0), (1, 0.24), (0.6, 0.05))),
    Case("N rises, T rises again", ((1, 0), (1, 0.24), (1, -0.1), (1.5, 0.35))),
    Case("N falls, T rises again", ((1, 0), (1, 0.24), (1, -0.1), (0.7, 0.15))),
)


def depth_m(load: float) -> float:
    """Return the Hertz depth [m] under a load in units of LOAD; 0 for no load."""
    return (max(load, 0.0) * LOAD / (4 / 3 * YOUNG * RADIUS**0.5)) ** (2 / 3)


def first_loading_m(load: float, force: float, before: float = 0.0) -> float:
    """Return the tangential displacement [m] when ``force`` first acts under ``load``: mu kappa (delta - delta_c)."""
    return MU * KAPPA * (depth_m(load) - depth_m(load - (force - before) / MU))


def closed_form_m(place: int, path: tuple[tuple[float, float], ...]) -> float | None:
    """Return the tangential displacement [m] at the end of a case; None for a case without a closed form here."""
    def masing(change: float) -> float:
        return 2 * first_loading_m(1, change / 2)

    if place == 0 or place in (4, 5):
        return first_loading_m(*path[-1])
    if place == 1:
        return first_loading_m(1, 0.24) - masing(0.39)
    if place == 2:
        return first_loading_m(1, 0.24) - masing(0.39) + masing(0.33)
    if place in (3, 6):  # no annulus slips: dT/dN is equal for both paths
        (load, force), (last, end) = path[-2:]
        return (first_loading_m(load, force) if force else 0.0) + (end - force) / (last - load) * KAPPA * (
            depth_m(last) - depth_m(load))
    return None


def punches_N(answer: dict[str, np.ndarray]) -> float:
    """Return the tangential force [N] of many parallel flat punches at the end of a path of depth and slide."""
    depth, slide = answer["penetration_depth_m"], answer["slide_m"]
    stiffness = 8 * SHEAR * np.sqrt(RADIUS * depth.max())
    x = (np.arange(PUNCHES) + 0.5) * stiffness / PUNCHES
    free = (x / (8 * SHEAR)) ** 2 / RADIUS  # depth at which a punch touches
    bent = np.zeros(PUNCHES)
    before = np.zeros(PUNCHES)
    for i, now in enumerate(depth):
        press = now - free
        if i:
            share = np.clip(press / np.where(now > depth[i - 1], now - depth[i - 1], np.inf), 0, 1)
            bent += (slide[i] - slide[i - 1]) * np.where(before > 0, 1.0, share)
        limit = MU * KAPPA * np.maximum(press, 0)
        bent = np.clip(bent, -limit, limit)
        before = press
    return float(bent.sum() * stiffness / PUNCHES)


def main() -> None:
    PICTURES.mkdir(exist_ok=True)
    gross = first_loading_m(1, MU)
    print("| | case | path N, T | slide at the end | closed form | force: law − punches |")
    print("|---|---|---|---:|---:|---:|")
    for place, case in enumerate(CASES):
        load, force = np.array(case.path).T * LOAD
        answer = laws.drive(
            "mindlin_deresiewicz", {"normal_force_N": load, "tangential_force_N": force}, steps_per_row=STEPS,
            effective_young_modulus_Pa=YOUNG, effective_shear_modulus_Pa=SHEAR, effective_radius_m=RADIUS,
            friction_coefficient=MU)
        slide, pull = answer["slide_m"] / gross, answer["tangential_force_N"] / (MU * LOAD)
        figure, axes = plt.subplots(figsize=(2.2, 1.6), dpi=80)
        axes.axhline(0, color="0.8", linewidth=0.6)
        axes.plot(slide, pull, color="0.6", linewidth=1)
        axes.plot(slide[-STEPS - 1:], pull[-STEPS - 1:], color="#0072B2", linewidth=2)
        axes.plot(slide[-1], pull[-1], "o", color="#0072B2", markersize=4)
        axes.set_xlabel("slide / gross slip", fontsize=7)
        axes.set_ylabel("T / μN at the start", fontsize=7)
        axes.tick_params(labelsize=6)
        figure.tight_layout(pad=0.3)
        figure.savefig(PICTURES / f"case_{place + 1}.png", metadata={"Software": None})
        plt.close(figure)
        wanted = closed_form_m(place, case.path)
        off = (answer["tangential_force_N"][-1] - punches_N(answer)) / (MU * LOAD)
        path = " → ".join(f"{n:g}, {t:g}" for n, t in case.path)
        name = case.name.replace("|", r"\|")
        known = "–" if wanted is None else f"{wanted * 1e9:.6f} nm ({answer['slide_m'][-1] / wanted - 1:+.0e})"
        print(f"| {place + 1} ![](partial_slip/case_{place + 1}.png) | {name} | {path} "
              f"| {answer['slide_m'][-1] * 1e9:.6f} nm | {known} | {off:+.0e} μN |")


if __name__ == "__main__":
    main()
