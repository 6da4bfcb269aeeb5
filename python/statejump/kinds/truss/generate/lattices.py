# SPDX-License-Identifier: GPL-3.0-or-later
"""Generators of planar lattices with many clearance joints: hoop ring and scissor mast."""
from __future__ import annotations

from math import cos, hypot, pi, sin
from typing import Any

from statejump.kinds.truss.generate.document import Document, document, finished, node, tidy

# Aluminium tubes, 40 mm in diameter, wall 0.8 mm: the Euler load of half a metre is 50 kN.
TUBE: dict[str, Any] = {
    "young_modulus_Pa": 70e9, "cross_section_area_m2": 1e-4, "thermal_expansion_per_K": 23.4e-6,
    "density_kg_per_m3": 2700.0,
}
BAY_M = 0.5
SPOKE_STRAIN = 1e-3  # strain of the spokes by their preload


def ring(
    n: int, *, name: str = "", sunlit: bool = True, friction_coefficient: float = 0.1,
    journal_radius_m: float = 0.01, radial_clearance_m: float = 2e-5, contact: str = "hertz", sticking: str = "rigid",
    hoop_force_N: float = 0.0, temperature_change_K: float = 100.0, shape: str = "triangle", cycles: int = 1,
    period_s: float = 1.0,
) -> Document:
    """Deployable ring of bays, a closed double hoop with a clearance joint in every bay, on spokes.

    One bay, with the journal at J[k] in the bearing at O[k]::

        O[k] J[k] ------- O[k+1] J[k+1] ---      outer hoop: link k from J[k] to O[k+1]
          |            .    |
          |         .       |                    radial I[k] O[k], diagonal I[k] O[k+1]
          |      .          |
        I[k] ------------ I[k+1] ----------      inner hoop
           .                .
              .          .                       spokes: links to the hub, in tension

    The closed planar lattice has 4 n links on 2 n nodes and three self-stresses. It is rigid while the joints, one per
    outer hoop link, are in contact. The spokes compress each hoop with half of the hoop force and thereby load every
    joint. Stress-free lengths are chosen such that the reference configuration is the equilibrium with all joints in
    contact. The hub is fixed and node I0 is held across its spoke; uniform expansion causes no force with these three
    supports. In sunlight the temperature change is multiplied by (1 + cos(angle)) / 2, which bends the hoops and
    unloads the joints on one side. The default hoop force, E A alpha dT depth / radius and at least 1 kN, leaves two
    thirds of the compression in every joint.

    The spokes have a strain of 1e-3 and prevent buckling of the ring. A slender ring on an elastic bed of stiffness k
    per bay buckles at a compression of 2 sqrt(k / bay E I), with E I the bending stiffness of both hoops. The spokes
    make this load four times the hoop force.

    :param n: number of bays, at least 3
    :param name: name of the case
    :param sunlit: temperature varies around the ring as (1 + cos(angle)) / 2
    :param friction_coefficient: of the clearance joints
    :param journal_radius_m: radius of the journals [m]
    :param radial_clearance_m: radial clearance of the joints [m]
    :param contact: contact of the reduced model, hertz or rigid
    :param sticking: how joints of the reduced model stick, rigid or elastic (as in the DEM)
    :param hoop_force_N: compression of both hoops together by the spokes [N]; 0: as above
    :param temperature_change_K: largest temperature change [K]
    :param shape: temperature program
    :param cycles: number of cycles
    :param period_s: duration of a cycle [s]
    """
    made = document(
        name or f"ring_{n}", f"Ring of {n} bays with a clearance joint each", "statejump truss ring", 2,
        temperature_change_K, shape, cycles, period_s, sticking,
    )
    outer = BAY_M / (2 * sin(pi / n))
    depth = min(BAY_M / 2, outer / 2)
    inner = outer - depth
    strain = TUBE["thermal_expansion_per_K"] * abs(temperature_change_K)
    rigidity = TUBE["young_modulus_Pa"] * TUBE["cross_section_area_m2"]
    hoop = hoop_force_N or max(1000.0, rigidity * strain * depth / outer)
    preload = 2 * sin(pi / n) * hoop
    bending_stiffness = 2 * rigidity * (depth / 2) ** 2
    stiffness = max(preload / (SPOKE_STRAIN * inner), 4 * hoop**2 * BAY_M / bending_stiffness)
    inner_bay = 2 * inner * sin(pi / n)
    radial = preload / 2  # tension that balances the outer hoop

    def lit(bay: float) -> dict[str, Any]:
        return {"temperature_fraction": tidy([(1 + cos(2 * pi * bay / n)) / 2])[0]} if sunlit else {}

    made["node"].append(node("hub", (0, 0), "xy"))
    for k in range(n):
        after, angle = (k + 1) % n, 2 * pi * k / n
        place = (outer * cos(angle), outer * sin(angle))
        made["node"] += [
            node(f"I{k}", (inner * cos(angle), inner * sin(angle)), "y" if k == 0 else ""),
            node(f"O{k}", place), node(f"J{k}", place),
        ]
        for kind, ends, bay, length, tension in (
            ("inner", [f"I{k}", f"I{after}"], k + 0.5, inner_bay, -hoop / 2),
            ("outer", [f"J{k}", f"O{after}"], k + 0.5, BAY_M + radial_clearance_m, -hoop / 2),
            ("radial", [f"I{k}", f"O{k}"], k, depth, radial),
            ("diagonal", [f"I{k}", f"O{after}"], k + 0.5, 0.0, 0.0),
        ):
            free = {"stress_free_length_m": length / (1 + tension / rigidity)} if tension else {}
            made["link"].append({"name": f"{kind}{k}", "nodes": ends, **TUBE, **free, **lit(bay)})
        made["link"].append({
            "name": f"spoke{k}", "nodes": ["hub", f"I{k}"], **TUBE,
            "cross_section_area_m2": stiffness * inner / TUBE["young_modulus_Pa"],
            "stress_free_length_m": inner / (1 + preload / (stiffness * inner)), **lit(k),
        })
        made["revolute"].append({
            "name": f"joint{k}", "bearing_node": f"O{k}", "journal_node": f"J{k}",
            "bearing_link": f"outer{(k - 1) % n}", "journal_link": f"outer{k}", "journal_radius_m": journal_radius_m,
            "radial_clearance_m": radial_clearance_m, "friction_coefficient": friction_coefficient,
            "contact": contact, **lit(k),
        })
    return finished(made)


def mast(
    n: int, *, name: str = "", radial_clearance_m: float = 1e-4, friction_coefficient: float = 0.1,
    journal_radius_m: float = 0.01, contact: str = "hertz", sticking: str = "rigid", tip_load_N: float = 0.0,
    cable_preload_N: float = 0.0, cable_stiffness_N_per_m: float = 1e4, second_moment_m4: float = 2e-8,
    shaded_fraction: float = 0.5, temperature_change_K: float = 100.0, shape: str = "triangle", cycles: int = 1,
    period_s: float = 1.0,
) -> Document:
    """Scissor mast of square bays, one above the other, with clearance joints between them.

    One bay::

        L[k+1] ------- R[k+1]     (cable, optional)
            .         .
               .   .
                M[k]              both bars pass through the middle pin
               .   .
            .         .
        L[k] --------- R[k]

    A scissor bar consists of two half links that share the middle pin. The torsion spring 3 E I / L between them gives
    the deflection of a beam of length L under a force at its middle. With both feet fixed the mast is statically
    determinate: 3 n + 2 nodes, 4 n half links, 2 n torsion springs, 4 supports. Between two bays, the lower bar carries
    the bearing and the upper bar on the same side the journal. The downward tip load, shared by the two tip nodes,
    loads every joint. Joint forces grow towards the foot in proportion to n, so the default load is 6 N / n: the joint
    at the foot then carries about 6 N for any n. Bars that lean to the left are shaded.

    :param n: number of bays
    :param name: name of the case
    :param radial_clearance_m: radial clearance of the joints between bays [m]; 0: ideal pins
    :param friction_coefficient: of the clearance joints
    :param journal_radius_m: radius of the journals [m]
    :param contact: contact of the reduced model, hertz or rigid
    :param sticking: how joints of the reduced model stick, rigid or elastic (as in the DEM)
    :param tip_load_N: load at the tip, downwards [N]; 0: 6 N / n
    :param cable_preload_N: tension of a cable across every level [N]; 0: no cables
    :param cable_stiffness_N_per_m: stiffness of these cables [N/m]
    :param second_moment_m4: second moment of area of the bars [m4]
    :param shaded_fraction: temperature fraction of the bars that lean to the left
    :param temperature_change_K: largest temperature change [K]
    :param shape: temperature program
    :param cycles: number of cycles
    :param period_s: duration of a cycle [s]
    """
    made = document(
        name or f"mast_{n}", f"Scissor mast of {n} bays", "statejump truss mast", 2, temperature_change_K, shape,
        cycles, period_s, sticking,
    )
    bending = 3 * TUBE["young_modulus_Pa"] * second_moment_m4 / hypot(BAY_M, BAY_M)
    load = (tip_load_N or 6.0 / n) / 2
    for k in range(n + 1):
        for side, x in (("L", 0.0), ("R", BAY_M)):
            place = (x, BAY_M * k)
            if k == 0:
                made["node"].append(node(f"{side}0", place, "xy"))
            elif k == n:
                made["node"].append(node(f"{side}{k}", place, force_N=[0.0, -load]))
            else:
                made["node"].append(node(f"{side}{k}", place))
                if radial_clearance_m:
                    made["node"].append(node(f"{side}{k}j", place))
                    made["revolute"].append({
                        "name": f"joint{side}{k}", "bearing_node": f"{side}{k}", "journal_node": f"{side}{k}j",
                        "bearing_link": f"{side}{k - 1}u", "journal_link": f"{side}{k}d",
                        "journal_radius_m": journal_radius_m, "radial_clearance_m": radial_clearance_m,
                        "friction_coefficient": friction_coefficient, "contact": contact,
                    })
        if cable_preload_N and k > 0:
            made["spring"].append({
                "name": f"cable{k}", "nodes": [f"L{k}", f"R{k}"], "stiffness_N_per_m": cable_stiffness_N_per_m,
                "preload_N": cable_preload_N, "cable": True,
            })
        if k == n:
            break
        made["node"].append(node(f"M{k}", (BAY_M / 2, BAY_M * (k + 0.5))))
        for side, other, fraction in (("L", "R", 1.0), ("R", "L", shaded_fraction)):
            # The lower half of a bar starts on this side, the upper half on the other; an upper half is named after its
            # end.
            foot = f"{side}{k}j" if 0 < k and radial_clearance_m else f"{side}{k}"
            bar: dict[str, Any] = {**TUBE, "temperature_fraction": fraction}
            made["link"] += [
                {"name": f"{side}{k}d", "nodes": [foot, f"M{k}"], **bar},
                {"name": f"{other}{k}u", "nodes": [f"M{k}", f"{other}{k + 1}"], **bar},
            ]
            made["torsion_spring"].append({
                "name": f"bending{side}{k}", "links": [f"{side}{k}d", f"{other}{k}u"],
                "stiffness_N_m_per_rad": bending,
            })
    return finished(made)
