# SPDX-License-Identifier: GPL-3.0-or-later
"""Generators of trusses: functions that return the TOML document of a case as a dict: chain, Iwan model, umbrella.

Every generator takes the number of bays, ribs or blocks first, then keys with defaults; the functions of
:mod:`statejump.truss` and the commands of ``statejump truss`` are made of these signatures and their ``:param`` lines.
"""
from __future__ import annotations

from math import cos, pi, sin, sqrt
from typing import Any

from statejump.core.errors import NotAllowed
from statejump.kinds.truss.generate.document import (
    TABLE1_BAR, TABLE1_LENGTH_M, Document, document, finished, node, tidy,
)

PAPER = "Chen, Li, Tang, Wang, Mech. Sci. 12, 59-67, 2021"
FRICTION_COEFFICIENT = 0.3  # Table 1


def _free_expansion_force_N(temperature_change_K: float) -> float:
    """Return the force E A alpha dT [N] that keeps the heated bar of Table 1 at its length."""
    rigidity = TABLE1_BAR["young_modulus_Pa"] * TABLE1_BAR["cross_section_area_m2"]
    return rigidity * TABLE1_BAR["thermal_expansion_per_K"] * abs(temperature_change_K)


def chain(
    n: int, *, name: str = "", friction_force_N: float = 0.0, temperature_change_K: float = 100.0,
    shape: str = "triangle", cycles: int = 1, period_s: float = 1.0,
) -> Document:
    """Chain of blocks with friction on the ground, connected by bars of Table 1.

    Node N0 is fixed; link i connects block i - 1 to block i and carries the friction of all blocks beyond it. With f =
    E A alpha dT / (4 n), all blocks slide outwards after a quarter of the heating, when link 1 carries n f. They slide
    back after half of the cooling, when this force has changed from -n f to n f.

    :param n: number of blocks
    :param name: name of the case
    :param friction_force_N: friction limit of every block [N]; 0: E A alpha dT / (4 n)
    :param temperature_change_K: largest temperature change [K]
    :param shape: temperature program
    :param cycles: number of cycles
    :param period_s: duration of a cycle [s]
    """
    friction = friction_force_N or _free_expansion_force_N(temperature_change_K) / (4 * n)
    made = document(
        name or f"chain_{n}", f"Chain of {n} blocks with friction", f"bars as {PAPER}, Table 1", 2,
        temperature_change_K, shape, cycles, period_s,
    )
    made["node"].append(node("N0", (0, 0), "xy"))
    for i in range(1, n + 1):
        made["node"].append(node(f"N{i}", (TABLE1_LENGTH_M * i, 0), "y"))
        made["link"].append({"name": f"L{i}", "nodes": [f"N{i - 1}", f"N{i}"], **TABLE1_BAR})
        made["slider"].append({
            "name": f"S{i}", "nodes": [f"N{i}"], "axis": [1.0, 0.0], "friction_coefficient": FRICTION_COEFFICIENT,
            "normal_force_N": friction / FRICTION_COEFFICIENT,
        })
    return finished(made)


def iwan(
    n: int, *, name: str = "", slipped_at: float = 0.4, temperature_change_K: float = 100.0,
    shape: str = "triangle", cycles: int = 1, period_s: float = 1.0,
) -> Document:
    """Spring-sliders in parallel behind one heated bar: an Iwan (Prandtl-Ishlinskii) model.

    The drive, a bar of Table 1, pushes platform P along x. n bars that do not expand connect P to blocks with friction.
    All bars have the stiffness k = k_drive / n; longer bars have a larger section. Block i slips when the platform has
    moved by d i / n since the last reversal. The last block slips when the drive's free expansion reaches d (1 + (n +
    1) / (2 n)), which is ``slipped_at`` times its maximum. Below 0.5, all blocks also slip back during cooling.

    :param n: number of blocks
    :param name: name of the case
    :param slipped_at: fraction of the heating at which the last block slips
    :param temperature_change_K: largest temperature change [K]
    :param shape: temperature program
    :param cycles: number of cycles
    :param period_s: duration of a cycle [s]
    """
    made = document(
        name or f"iwan_{n}", f"Iwan model of {n} blocks", f"drive as {PAPER}, Table 1", 2, temperature_change_K,
        shape, cycles, period_s,
    )
    length, area = TABLE1_LENGTH_M, TABLE1_BAR["cross_section_area_m2"]
    largest = slipped_at * _free_expansion_force_N(temperature_change_K) / (1 + (n + 1) / (2 * n))  # k_drive d
    made["node"] += [node("G", (0, 0), "xy"), node("P", (length, 0), "y")]
    made["link"].append({"name": "drive", "nodes": ["G", "P"], **TABLE1_BAR})
    for i in range(1, n + 1):
        longer = 1 + (i - 1) / n  # no two blocks at one position
        made["node"].append(node(f"B{i}", (length * (1 + longer), 0), "y"))
        made["link"].append({
            "name": f"L{i}", "nodes": ["P", f"B{i}"], **TABLE1_BAR, "cross_section_area_m2": area / n * longer,
            "thermal_expansion_per_K": 0.0,
        })
        made["slider"].append({
            "name": f"S{i}", "nodes": [f"B{i}"], "axis": [1.0, 0.0], "friction_coefficient": FRICTION_COEFFICIENT,
            "normal_force_N": largest * i / n**2 / FRICTION_COEFFICIENT,
        })
    return finished(made)


# The rib of the umbrella antenna, as cases/umbrella_bias.toml has it.
FRAME_M, AB_M, BC_M = 0.12, 0.05, 0.1
AB_KG, BC_KG = 0.5, 1.0
RIB_BAR: dict[str, Any] = {
    "young_modulus_Pa": 70e9, "cross_section_area_m2": 9e-6, "thermal_expansion_per_K": 23.75e-6,
    "poisson_ratio": 0.3,
}


def umbrella(
    n: int, *, name: str = "", friction_coefficient: float = 0.15, journal_radius_m: float = 5e-3,
    radial_clearance_m: float = 1e-4, contact: str = "hertz", sticking: str = "rigid",
    torsion_stiffness_N_m_per_rad: float = 1.0, bias_rad: float = 0.05, cable_preload_N: float = 0.0,
    cable_stiffness_N_per_m: float = 1e3, temperature_change_K: float = 100.0, shape: str = "triangle",
    cycles: int = 1, period_s: float = 16.0,
) -> Document:
    """Ribs of the umbrella antenna around its axis AC, the x axis.

    One rib is planar: the rib of the paper with a torsion spring that loads the joint. Several ribs are spatial: each
    has its own A and C and stays in its plane through the axis. Bar AB carries the bearing (node B), bar CB the journal
    (node J). Cables with a preload connect neighbouring nodes B.

    :param n: number of ribs
    :param name: name of the case
    :param friction_coefficient: of the clearance joints
    :param journal_radius_m: radius of the journals [m]
    :param radial_clearance_m: radial clearance of the joints [m]
    :param contact: contact of the reduced model, hertz or rigid
    :param sticking: how joints of the reduced model stick, rigid or elastic (as in the DEM)
    :param torsion_stiffness_N_m_per_rad: torsion spring between AB and CB [N m/rad]
    :param bias_rad: free flare angle beyond the drawn one [rad]
    :param cable_preload_N: tension of cables between neighbouring ribs [N]; 0: no cables
    :param cable_stiffness_N_per_m: stiffness of these cables [N/m]
    :param temperature_change_K: largest temperature change [K]
    :param shape: temperature program
    :param cycles: number of cycles
    :param period_s: duration of a cycle [s]
    :raises NotAllowed: cables on a single rib
    """
    if cable_preload_N and n == 1:
        raise NotAllowed("cable_preload_N", cable_preload_N, code="rib_without_neighbour")
    made = document(
        name or f"umbrella_{n}", f"Umbrella antenna, {n} ribs" if n > 1 else "Umbrella rib as a truss",
        f"{PAPER}, Tables 2 and 3, section 4", 2 if n == 1 else 3, temperature_change_K, shape, cycles, period_s,
        sticking,
    )
    x = (FRAME_M**2 + AB_M**2 - BC_M**2) / (2 * FRAME_M)
    height = sqrt(AB_M**2 - x**2)
    for k in range(1, n + 1):
        mark = str(k) if n > 1 else ""
        angle = 2 * pi * (k - 1) / n
        c, s = cos(angle), sin(angle)
        normal = tidy((0.0, -s, c))  # normal of the rib's plane
        more: dict[str, Any] = {} if n == 1 else {"guide_normal": normal}
        axis: dict[str, Any] = {} if n == 1 else {"axis": normal}
        place = (x, height) if n == 1 else (x, height * c, height * s)
        zero, held = ((0.0,) * (len(place) - 1), "xyz"[: len(place)])
        a, b, j, at_c = (letter + mark for letter in "ABJC")
        ab, cb = f"AB{mark}", f"CB{mark}"
        made["node"] += [
            node(a, (0.0, *zero), held), node(at_c, (FRAME_M, *zero), held), node(b, place, **more),
            node(j, place, **more),
        ]
        made["link"] += [
            {"name": ab, "nodes": [a, b], **RIB_BAR, "stress_free_length_m": AB_M, "mass_kg": AB_KG},
            {"name": cb, "nodes": [at_c, j], **RIB_BAR, "stress_free_length_m": BC_M, "mass_kg": BC_KG},
        ]
        made["revolute"].append({
            "name": f"joint{mark}", "bearing_node": b, "journal_node": j, "bearing_link": ab, "journal_link": cb,
            "journal_radius_m": journal_radius_m, "radial_clearance_m": radial_clearance_m,
            "friction_coefficient": friction_coefficient, "contact": contact, **axis,
        })
        made["torsion_spring"].append({
            "name": f"spring{mark}", "links": [ab, cb], "stiffness_N_m_per_rad": torsion_stiffness_N_m_per_rad,
            "bias_rad": bias_rad, **axis,
        })
        if cable_preload_N and n > 1 and (k < n or n > 2):
            made["spring"].append({
                "name": f"cable{k}", "nodes": [f"B{k}", f"B{k % n + 1}"], "stiffness_N_per_m": cable_stiffness_N_per_m,
                "preload_N": cable_preload_N, "cable": True,
            })
    made["output"] = {"samples_per_cycle": 2000}
    made.setdefault("dem", {}).update(
        link_damping_ratio=0.1, contact_damping_ratio=0.0, pin_damping_N_m_s_per_rad=0.01)
    if n >= 3:
        made["reflector"] = {"nodes": [f"B{k}" for k in range(1, n + 1)], "axis": [1.0, 0.0, 0.0]}
    return finished(made)
