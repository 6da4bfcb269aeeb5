# SPDX-License-Identifier: GPL-3.0-or-later
"""Texts of an ``umbrella`` case, and the output of commands about its runs."""
from __future__ import annotations

from collections.abc import Mapping

from statejump.core.charts import TEMPERATURE, TIME, Axis, Chart
from statejump.core.run import Run
from statejump.core.tables import Shown
from statejump.core.units import text
from statejump.kinds.umbrella.case import UmbrellaCase
from statejump.kinds.umbrella.result import ANGLES, AT_END

LABELS = {
    "joint_b": "Joint B", "link_ab": "Link AB", "link_bc": "Link BC", "theta2_rad": "Angle θ2 of AB",
    "theta4_rad": "Angle θ4 of BC", "theta2_jump_rad": "Jump of θ2", "theta4_jump_rad": "Jump of θ4",
    "theta2_jump": "Jump of θ2", "theta4_jump": "Jump of θ4",
    f"theta2{AT_END}": "Change of θ2 at the end of the program",
    f"theta4{AT_END}": "Change of θ4 at the end of the program",
}


def describe(case: UmbrellaCase) -> list[str]:
    """Describe the case in sentences, without the temperature program, which code common to all kinds describes."""
    ab, bc, joint = case.link_ab, case.link_bc, case.joint
    sentences = [
        f"One rib of an umbrella antenna: link AB, {text(ab.stress_free_length_m, 'm')}, {ab.mass_kg:g}\u202fkg, "
        f"and link BC, {text(bc.stress_free_length_m, 'm')}, {bc.mass_kg:g}\u202fkg, turn on two ideal pins A "
        f"and C, {text(case.frame.length_m, 'm')} apart on a frame that does not expand.",
        f"At B the journal of BC, radius {text(joint.journal_radius_m, 'm')}, has a radial clearance of "
        f"{text(joint.radial_clearance_m, 'm')} in the bearing of AB; friction coefficient "
        f"{joint.friction_coefficient:g}.",
    ]
    spring = case.torsion_spring.stiffness_N_m_per_rad
    if spring:
        sentences.append(f"A torsion spring of {text(spring, 'N m/rad')} acts on the angle between the links.")
    return sentences


def summary_lines(case: UmbrellaCase, runs: Mapping[str, Run]) -> list[Shown | str]:
    """Return the lines that a command prints for one model alone: first contact, jump, remarks of the reduced model."""
    if len(runs) > 1:
        return []
    found: list[Shown | str] = []
    for run in runs.values():
        first, said = run.events.first("first_contact"), run.summary
        found.append(
            "first contact: none, the play is never used up" if first is None
            else f"first contact: ΔT = {first.temperature_change_K:.6f} K at {first.time_s:.6f} s"
        )
        if case.ending is not None:
            there = (said[f"{angle}{AT_END}"] for angle in ANGLES)
            found.append("change at the program's end, {:.6g} K: θ2 {:.6e} rad, θ4 {:.6e} rad".format(
                case.ending.temperature_change_K, *there))
        if case.has_jump:
            returned = " and the return" if case.ending is not None else ""
            found.append(f"state jump: θ2 {said['theta2_jump_rad']:.6e} rad, θ4 {said['theta4_jump_rad']:.6e} rad "
                         f"after {case.thermal.cycles} cycle(s){returned}")
        if "energy_residue_J" in said:
            found.append(f"{said['steps']:,.0f} steps, {said['contacts']:.0f} contacts, energy residue "
                         f"{said['energy_residue_J']:.3g} J")
    return found


def charts(case: UmbrellaCase) -> list[Chart]:
    """Return the charts: deflections of both links over temperature, trajectory of the journal, contact force."""
    return [
        Chart(TEMPERATURE, Axis("theta2_rad", "Deflection of AB, θ2 − θ2(0)", from_start=True),
              "Deflection-temperature loop", marks=True),
        Chart(TEMPERATURE, Axis("theta4_rad", "Deflection of BC, θ4 − θ4(0)", from_start=True),
              "Deflection-temperature loop of BC", marks=True),
        Chart(
            Axis("eccentricity_x_m", "Journal − bearing centre, along AC"), Axis("eccentricity_y_m", "across AC"),
            "Journal in its clearance", equal=True, rings_m=(case.joint.radial_clearance_m,),
        ),
        Chart(TIME, Axis("normal_force_N", "Normal force at the samples"), "Contact force over time"),
    ]
