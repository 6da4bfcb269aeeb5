# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes the cases with beams that CalculiX computes too: ``python3 -m studies.calculix.cases [FOLDER]``.

cases/trusses has hinge_line.toml, umbrella_rib_bending.toml and mast_6_bending.toml.
"""
from __future__ import annotations

import sys
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from statejump.kinds.truss.generate.document import Document, document, finished, node, tidy
from statejump.schema.toml import to_toml

ALUMINIUM = {"young_modulus_Pa": 70e9, "poisson_ratio": 0.33, "thermal_expansion_per_K": 23.4e-6,
             "density_kg_per_m3": 2700.0}
FOLDER = Path(__file__).resolve().parents[2] / "cases" / "trusses"


def rectangle(height_m: float, width_m: float) -> dict[str, Any]:
    """Return the keys of a rectangular section."""
    return {"shape": "rectangle", "dimensions_m": [height_m, width_m]}


def row(name: str, first: str, last: str, ends: Sequence[Sequence[float]], parts: int, **keys: Any
        ) -> tuple[list[dict[str, Any]], list[dict[str, Any]]]:
    """Return the inner nodes and the beams of a straight member."""
    inner = [f"{name}_{part}" for part in range(1, parts)]
    at = np.linspace(*np.array(ends, dtype=float), parts + 1)
    names = [first, *inner, last]
    beams = [{"name": f"{name}_{part + 1}" if parts > 1 else name, "nodes": [one, two], **keys}
             for part, (one, two) in enumerate(zip(names, names[1:]))]
    return [node(one, where) for one, where in zip(inner, at[1:-1])], beams


def _add(made: Document, *parts: tuple[list[dict[str, Any]], list[dict[str, Any]]]) -> None:
    for nodes, beams in parts:
        made["node"] += nodes
        made.setdefault("beam", []).extend(beams)


def hinge_line() -> Document:
    """Return two panels between a hub and a guide, with two hinges on one line: each side is the beam with a hinge of
    the theory page, whose residual angle is 0.0101694915 rad."""
    made = document("hinge_line", "Two panels with a hinge line", "choice: a gradient that overcomes the friction of "
                    "the hinges; linear closed form: residual angle 0.0101694915 rad", 3, 20.0, "triangle", 1, 1.0)
    made["hinge"] = []
    # The panels are 10 mm thick; y of the sections points up.
    side = {**ALUMINIUM, **rectangle(0.01, 0.02), "axis_y": [0.0, 0.0, 1.0], "temperature_fraction": 0.0}
    warm = {**side, "gradient_per_m": [100.0, 0.0]}
    for name, y in (("left", 0.0), ("right", 0.6)):
        made["node"] += [
            node(f"{name}_hub", (0, y, 0), "xyz", fixed_rotations=["x", "y", "z"]), node(f"{name}_inner", (1, y, 0)),
            node(f"{name}_outer", (1, y, 0)), node(f"{name}_tip", (2, y, 0), fixed_rotations=["y"]),
        ]
        _add(made, row(f"{name}_inboard", f"{name}_hub", f"{name}_inner", ((0, y, 0), (1, y, 0)), 2, **warm),
             row(f"{name}_outboard", f"{name}_outer", f"{name}_tip", ((1, y, 0), (2, y, 0)), 2, **warm))
        made["hinge"].append({"name": name, "nodes": [f"{name}_inner", f"{name}_outer"], "axis": [0.0, 1.0, 0.0],
                              "stiffness_N_m_per_rad": 40.0, "friction_moment_N_m": 1.0})
    for name, x in (("inner", 1), ("outer", 1), ("tip", 2)):
        _add(made, row(name, f"left_{name}", f"right_{name}", ((x, 0, 0), (x, 0.6, 0)), 1, **side))
    return made


def rib() -> Document:
    """Return a rib of the umbrella antenna as beams: a gradient bows both members; their joint has friction."""
    made = document("umbrella_rib_bending", "Umbrella rib that bends", "Chen, Li, Tang, Wang, Mech. Sci. 12, 59-67, "
                    "2021, Tables 2 and 3; choice: gradient of a fifth of the temperature, friction of 0.01 N m",
                    2, 100.0, "triangle", 1, 16.0)
    at = {"A": (0.0, 0.0), "B": (0.02875, 0.040907670429884), "J": (0.02875, 0.040907670429884), "C": (0.12, 0.0)}
    made["node"] = [node(name, where, "xy" if name in "AC" else "") for name, where in at.items()]
    # 20 K over 3 mm at 100 K.
    keys = {"young_modulus_Pa": 70e9, "poisson_ratio": 0.3, "thermal_expansion_per_K": 2.375e-5,
            **rectangle(3e-3, 3e-3), "gradient_per_m": [0.2 / 3e-3, 0.0]}
    _add(made, row("AB", "A", "B", (at["A"], at["B"]), 2, **keys), row("BC", "J", "C", (at["J"], at["C"]), 2, **keys))
    made["hinge"] = [{"name": "joint", "nodes": ["B", "J"], "stiffness_N_m_per_rad": 1.0,
                      "friction_moment_N_m": 0.01}]
    return made


def mast(bays: int = 6) -> Document:
    """Return a mast with longerons and battens as beams; friction joints end its diagonals."""
    made = document("mast_6_bending", f"Bending mast of {bays} bays",
                    "choice: a mast whose left longeron the sun heats; the diagonals slip", 2, 60.0, "triangle", 1, 1.0)
    side, tube = 0.5, {**ALUMINIUM, "shape": "tube", "dimensions_m": [0.03, 0.0015]}
    sun = {"L": {"temperature_fraction": 1.0, "gradient_per_m": [5.0, 0.0]}, "R": {"temperature_fraction": 0.0}}
    for name, x in (("L", 0.0), ("R", side)):
        foot = node(f"{name}0", (x, 0.0), "xy", fixed_rotations=["z"])
        made["node"] += [foot, *(node(f"{name}{level}", (x, side * level)) for level in range(1, bays + 1))]
    for below in range(bays):
        above, height = below + 1, side * below
        for name, x in (("L", 0.0), ("R", side)):
            _add(made, row(f"{name}{below}{above}", f"{name}{below}", f"{name}{above}",
                           ((x, height), (x, height + side)), 1, **tube, **sun[name]))
        _add(made, row(f"batten{above}", f"L{above}", f"R{above}", ((0.0, height + side), (side, height + side)), 1,
                       **tube, temperature_fraction=0.5))
        made["node"].append(node(f"D{above}", (side, height + side)))
        made["link"].append({"name": f"diagonal{above}", "nodes": [f"L{below}", f"D{above}"], "young_modulus_Pa": 70e9,
                             "cross_section_area_m2": 2e-5, "thermal_expansion_per_K": 23.4e-6,
                             "density_kg_per_m3": 2700.0, "temperature_fraction": 0.0})
        made["slider"].append({"name": f"joint{above}", "nodes": [f"D{above}", f"R{above}"],
                               "axis": tidy((0.5**0.5, 0.5**0.5)), "friction_coefficient": 0.2,
                               "normal_force_N": 200.0})
    return made


def texts() -> Iterator[tuple[str, str]]:
    """Yield names and texts of the case files."""
    for make in (hinge_line, rib, mast):
        made = finished(make())
        name = made["case"]["name"]
        head = "#:schema ../../schema/truss.schema.json\n# Made by: python3 -m studies.calculix.cases\n"
        yield f"{name}.toml", f"{head}# Units are in the names.\n{to_toml(made)}"


def main() -> None:
    """Write the case files."""
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else FOLDER
    for name, text in texts():
        (folder / name).write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
