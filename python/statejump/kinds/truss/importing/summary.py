# SPDX-License-Identifier: GPL-3.0-or-later
"""Quantities to check after an import: sizes and ranges in SI units, with hints if they are implausible."""
from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from statejump.core.tables import Shown

# Range for solids: polymers have more than 1e9 Pa, diamond has 1.2e12 Pa.
LEAST_MODULUS_PA, MOST_MODULUS_PA = 1e9, 1.3e12
# Limits for a bar of a deployable structure: at most 1 km long, at least 0.1 mm, at most 1 m2 or a tenth of its squared
# length in area.
LONGEST_M, SHORTEST_M, THICKEST_M2, THICKEST = 1e3, 1e-4, 1.0, 0.1
DENSEST_KG_PER_M3, LIGHTEST_KG_PER_M3 = 2.3e4, 1.0  # density of osmium; a density below that of any foam
UNITS = "--units mm-N, mm-kN-t, mm-kg-s, in-lbf or --length-unit and --force-unit name the units of the deck"


def summary(made: Mapping[str, Any]) -> Shown:
    """Return sizes and ranges of an imported truss."""
    positions = _positions(made)
    size = np.ptp(np.array(list(positions.values())), axis=0)
    links = [*made.get("link", ()), *made.get("beam", ())]
    forces = [float(np.linalg.norm(node["force_N"])) for node in made["node"] if "force_N" in node]
    mass = sum(node.get("mass_kg", 0.0) for node in made["node"]) + sum(_mass(link, positions) for link in links)
    thermal = made["thermal"]
    rows = [
        ("bounding box [m]", " x ".join(f"{part:.6g}" for part in size)),
        ("nodes", str(len(positions))),
        ("links", str(len(made.get("link", ())))),
        *((("beams", str(len(made["beam"]))),) if made.get("beam") else ()),
        ("springs", str(len(made.get("spring", ())))),
        *((("rigid bodies", str(len(made["rigid"]))),) if made.get("rigid") else ()),
        *((("hinges", str(len(made["hinge"]))),) if made.get("hinge") else ()),
        *((("constraints", str(len(made["constraint"]))),) if made.get("constraint") else ()),
        ("supported nodes", str(sum("fixed" in node or "guide_normal" in node for node in made["node"]
                                    if node["name"] in positions))),
        ("total mass [kg]", f"{mass:.6g}" if mass else "none"),
        ("Young's modulus [Pa]", _range([link["young_modulus_Pa"] for link in links])),
        ("cross-section area [m2]", _range([link["cross_section_area_m2"] for link in links])),
        ("thermal expansion [1/K]", _range(_coefficients(made))),
        ("largest force [N]", f"{max(forces):.6g}" if forces else "none"),
    ]
    if "temperature_change_max_K" in thermal:
        peak = thermal["temperature_change_max_K"]
        changes = [peak * link.get("temperature_fraction", 1.0) for link in links]
        rows.append(("temperature change [K]", _range(changes)))
    return Shown("imported, in SI units", ("quantity", "value"), rows, left=("quantity", "value"))


def hints(made: Mapping[str, Any]) -> list[str]:
    """Return hints that the units of a deck may be wrong, one sentence each."""
    positions = _positions(made)
    links = [*made.get("link", ()), *made.get("beam", ())]
    lengths = [_length(link, positions) for link in links]
    found = []
    checks: tuple[tuple[str, Sequence[float], float, float, str], ...] = (
        ("Young's modulus", [link["young_modulus_Pa"] for link in links], LEAST_MODULUS_PA, MOST_MODULUS_PA, "Pa"),
        ("length of links", [one for one in lengths if one], SHORTEST_M, LONGEST_M, "m"),
        ("cross-section area", [link["cross_section_area_m2"] for link in links], 0.0, THICKEST_M2, "m2"),
        ("density", [link["density_kg_per_m3"] for link in links if "density_kg_per_m3" in link],
         LIGHTEST_KG_PER_M3, DENSEST_KG_PER_M3, "kg/m3"),
    )
    for what, values, low, high, unit in checks:
        for value, wrong in ((min(values, default=low), min(values, default=low) < low),
                             (max(values, default=high), max(values, default=high) > high)):
            if wrong:
                found.append(f"{what}: {value:.3g} {unit} is implausible; {UNITS}")
    if any(link["cross_section_area_m2"] > THICKEST * length**2 for link, length in zip(links, lengths) if length):
        found.append(f"cross-section area: a link is as thick as it is long; {UNITS}")
    return found


def _positions(made: Mapping[str, Any]) -> dict[str, np.ndarray]:
    """Return the positions of the deck's own nodes, without the far ends of springs to the ground."""
    ground = {spring["nodes"][1] for spring in made.get("spring", ()) if spring["nodes"][1].startswith("G_")}
    return {node["name"]: np.array(node["position_m"]) for node in made["node"] if node["name"] not in ground}


def _length(link: Mapping[str, Any], positions: Mapping[str, np.ndarray]) -> float:
    first, second = (positions[end] for end in link["nodes"])
    return float(np.linalg.norm(second - first))


def _mass(link: Mapping[str, Any], positions: Mapping[str, np.ndarray]) -> float:
    if "mass_kg" in link:
        return float(link["mass_kg"])
    return float(link.get("density_kg_per_m3", 0.0) * link["cross_section_area_m2"] * _length(link, positions))


def _coefficients(made: Mapping[str, Any]) -> list[float]:
    return [link["thermal_expansion_per_K"] for link in [*made.get("link", ()), *made.get("beam", ())]
            if "thermal_expansion_per_K" in link] + [
        value for item in made.get("expansion", ()) for value in item["thermal_expansion_per_K"]]


def _range(values: Sequence[float]) -> str:
    if not values:
        return "none"
    low, high = min(values), max(values)
    return f"{low:.6g}" if low == high else f"{low:.6g} to {high:.6g}"
