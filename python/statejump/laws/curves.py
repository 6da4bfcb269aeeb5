# SPDX-License-Identifier: GPL-3.0-or-later
"""Curves of the contact laws: forces in a joint, one impact, and a figure that shows both."""
from __future__ import annotations

from dataclasses import dataclass
from itertools import cycle
from math import inf
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D

from statejump import _engine
from statejump.core.figures import panels, save
from statejump.core.figures import style as project_style
from statejump.laws.traits import law, names

IMPACT_LAW = "hertz_internal"
RESTITUTION = 0.8
IMPACT_SPEED_m_per_s = 0.1
# Okabe-Ito colours with a line style each, so that curves also differ without colour.
STYLES = (
    {"color": "#000000", "linestyle": "-", "linewidth": 1.3},
    {"color": "#E69F00", "linestyle": "-", "linewidth": 3.2},
    {"color": "#0072B2", "linestyle": (0, (6, 2)), "linewidth": 1.8},
    {"color": "#D55E00", "linestyle": (0, (1.5, 1.5)), "linewidth": 2.2},
    {"color": "#009E73", "linestyle": "-", "linewidth": 4.2, "alpha": 0.6, "zorder": 1.9},
    {"color": "#CC79A7", "linestyle": (0, (3, 2)), "linewidth": 1.8},
    {"color": "#56B4E9", "linestyle": (0, (9, 3)), "linewidth": 1.8},
)


@dataclass(frozen=True)
class Joint:
    """A clearance revolute as the input of the normal laws, and the effective mass for impacts."""

    title: str
    journal_radius_m: float
    bearing_radius_m: float
    contact_length_m: float
    effective_young_modulus_Pa: float
    reduced_mass_kg: float


def paper_joint() -> Joint:
    """Return the joint of the paper's Tables 2 and 3, with the settings of cases/umbrella.toml."""
    modulus = _engine.effective_young_modulus_Pa(70e9, 0.3, 70e9, 0.3)
    return Joint("joint of Tables 2 and 3", 5e-3, 5.1e-3, 0.01, modulus, reduced_mass_kg(0.5, 1.0))


def reduced_mass_kg(mass_ab_kg: float, mass_bc_kg: float) -> float:
    """Return the reduced mass of two links that meet at their tips, each with a third of its mass at its tip."""
    return 1 / (3 / mass_ab_kg + 3 / mass_bc_kg)


def normal_force(name: str, joint: Joint, depth_m: np.ndarray) -> dict[str, np.ndarray]:
    """Return force, stiffness, contact width and energy of a normal law. :raises ValueError: a depth is out of range"""
    return _engine.normal_force(
        name, depth_m, joint.journal_radius_m, joint.bearing_radius_m, joint.contact_length_m,
        joint.effective_young_modulus_Pa,
    )


def range_end_m(name: str, joint: Joint) -> tuple[float, bool]:
    """Return the depth [m] at which the curve of a normal law ends, and whether the law rejects larger depths. If it
    does not, the curve ends where the contact is as wide as the journal."""
    end = _engine.largest_depth_m(name, joint.journal_radius_m, joint.bearing_radius_m)
    if end < inf:
        return end, True
    if law("normal", name).point_contact:  # a = sqrt(R delta)
        at_one = normal_force(name, joint, np.array([1.0]))["contact_width_m"][0]
        return (joint.journal_radius_m / at_one) ** 2, False
    depth = np.geomspace(1e-9, 1.0, 1000) * joint.journal_radius_m
    wide = normal_force(name, joint, depth)["contact_width_m"] >= joint.journal_radius_m
    return float(depth[np.argmax(wide)] if wide.any() else depth[-1]), False


@dataclass(frozen=True)
class Impact:
    """A free impact of the joint's reduced mass, from the first to the last instant of contact."""

    depth_m: np.ndarray
    force_N: np.ndarray
    restitution: float  # speed after over speed before


def impact(dissipation: str, joint: Joint, restitution: float = RESTITUTION,
           speed_m_per_s: float = IMPACT_SPEED_m_per_s, steps: int = 1000) -> Impact:
    """Integrate one impact of the joint with ``IMPACT_LAW`` by Runge-Kutta steps.

    :param restitution: coefficient of restitution for the dissipation law
    :param steps: number of time steps in about a third of the impact
    """
    mass = joint.reduced_mass_kg
    ratio = _engine.damping_ratio_s_per_m(dissipation, restitution, speed_m_per_s)
    stiffness = normal_force(IMPACT_LAW, joint, np.array([1.0]))["force_N"][0]  # K of K delta^1.5
    deepest = (1.25 * mass * speed_m_per_s**2 / stiffness) ** 0.4  # without dissipation
    step = deepest / speed_m_per_s / steps

    def force(depth: float, rate: float) -> float:
        return stiffness * max(depth, 0.0) ** 1.5 * max(0.0, 1 + ratio * rate)

    def rates(depth: float, rate: float) -> np.ndarray:
        return np.array([rate, -force(depth, rate) / mass])

    states = [np.array([0.0, speed_m_per_s])]
    while states[-1][0] > 0 or states[-1][1] > 0:
        y = states[-1]
        k1 = rates(*y)
        k2 = rates(*(y + step / 2 * k1))
        k3 = rates(*(y + step / 2 * k2))
        k4 = rates(*(y + step * k3))
        states.append(y + step / 6 * (k1 + 2 * k2 + 2 * k3 + k4))
    states[-1][0] = 0.0  # after another step the force would be zero and the speed final
    depth, rate = np.array(states).T
    return Impact(depth, np.array([force(*state) for state in states]), float(-rate[-1] / speed_m_per_s))


def figure(joint: Joint, folder: Path, name: str) -> list[Path]:
    """Draw every normal law, and one impact per dissipation law; write ``<name>.png`` and ``<name>.svg``."""
    with project_style():
        drawing, (left, right) = panels(1, 2, (9.5, 4.6))
        _draw_normal(left, joint)
        _draw_impacts(right, joint)
        drawing.suptitle(f"Contact laws, {joint.title}", fontsize=11)
        return save(drawing, folder, name)


def _draw_normal(panel: Axes, joint: Joint) -> None:
    clearance = joint.bearing_radius_m - joint.journal_radius_m
    ends = {name: range_end_m(name, joint) for name in names("normal")}
    first = 1e-4 * min(clearance, *(end for end, _ in ends.values()))
    for style, (name, (end, refuses)) in zip(cycle(STYLES), ends.items()):
        # Denser towards the end, where some curves bend upwards.
        depth = np.geomspace(first, end, 400)[:-1]
        depth = np.append(depth, end * (1 - np.geomspace(1e-2, 1e-9, 60)))
        depth.sort()
        force = normal_force(name, joint, depth)["force_N"]
        panel.plot(depth * 1e3, force, label=name, **style)
        panel.plot(
            end * 1e3, force[-1], "o", color=style["color"], markersize=6, zorder=5, clip_on=False,
            markerfacecolor=style["color"] if refuses else "white",
        )
    panel.axvline(clearance * 1e3, color="0.55", linewidth=1, linestyle=":")
    panel.annotate("clearance", (clearance * 1e3, 0.98), xycoords=("data", "axes fraction"), rotation=90,
                   ha="right", va="top", fontsize=8, color="0.35", xytext=(-2, 0), textcoords="offset points")
    panel.set_xscale("log")
    panel.set_yscale("log")
    panel.set_xlabel("Penetration depth [mm]")
    panel.set_ylabel("Normal force [N]")
    panel.set_title(f"Normal laws, line contacts {joint.contact_length_m * 1e3:g} mm long", fontsize=9)
    lines, labels = panel.get_legend_handles_labels()
    for refuses, text in ((True, "range ends: error beyond"), (False, "contact as wide as the journal")):
        if any(refuses == own for _, own in ends.values()):
            lines.append(Line2D([], [], linestyle="", marker="o", color="0.3", markersize=6,
                                markerfacecolor="0.3" if refuses else "white"))
            labels.append(text)
    panel.legend(lines, labels, loc="lower right", framealpha=1, fontsize=8, handlelength=3.2)


def _draw_impacts(panel: Axes, joint: Joint) -> None:
    for style, name in zip(cycle(STYLES), names("dissipation")):
        result = impact(name, joint)
        panel.plot(result.depth_m * 1e6, result.force_N, label=f"{name}: e = {result.restitution:.3f}", **style)
    panel.set_xlabel("Penetration depth [µm]")
    panel.set_ylabel("Normal force [N]")
    panel.set_xlim(left=0)
    panel.set_ylim(bottom=0)
    panel.set_title(
        f"{joint.reduced_mass_kg:.3g} kg at {IMPACT_SPEED_m_per_s:g} m/s on {IMPACT_LAW}, "
        f"e = {RESTITUTION:g} asked for", fontsize=9,
    )
    panel.legend(loc="upper left", framealpha=1, fontsize=8, handlelength=3.2, title="Restitution",
                 title_fontsize=8)
