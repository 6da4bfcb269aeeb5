# SPDX-License-Identifier: GPL-3.0-or-later
"""Splits the differences between solver and CalculiX for the cases with beams: ``python3 -m studies.calculix.theory``.

Prints a Markdown table. Its columns are relative to the solver's value for small displacements: the large displacements
of the solver's own run; the shear modulus E/2 of an isotropic material, uniform over the section; one brick per beam,
and four, in place of two; and the remaining difference to CalculiX. The last line compares CalculiX's own elements B32R
for the portal.
"""
from __future__ import annotations

from pathlib import Path

import numpy as np

import statejump as sj
from statejump.kinds.truss.case import TrussCase
from statejump.kinds.truss.solve import whole_path
from studies.calculix import ccx, frame_path
from studies.calculix.ccx import number
from studies.calculix.truss_sliding import corners

CASES = ("portal", "boom", "hinge_line", "umbrella_rib_bending", "mast_6_bending")
NAMES = {"largest_displacement": "displacement", "largest_bending_moment": "moment", "largest_jump": "jump"}
FOLDER = Path(__file__).resolve().parents[2] / "cases" / "trusses"
PARTS = 4  # elements B32R of a beam


def loaded(name: str) -> TrussCase:
    """Return a case of the repository."""
    case = sj.load(FOLDER / f"{name}.toml").definition
    assert isinstance(case, TrussCase)
    return case


def full(case: TrussCase) -> dict[str, float]:
    """Return the quantities of the comparison of the solver's own run, with its large displacements."""
    truss = case.resolve()
    path = whole_path(truss, increments_per_branch=case.reduced_settings.increments_per_branch)
    at = [int(np.argmin(np.abs(path.states["time_s"] - time))) for time in corners(case, truss)]
    moved = path.states["displacement_m"][at]
    moments = [np.linalg.norm(path.states[f"beam_moment_{end}_N_m"][at][:, :, 1:], axis=-1).max()
               for end in ("first", "second")]
    return {"largest_displacement": float(np.linalg.norm(moved, axis=-1).max()),
            "largest_bending_moment": float(max(moments)),
            "largest_jump": float(np.linalg.norm(moved[-1] - moved[0], axis=-1).max())}


def rows(name: str) -> list[str]:
    """Return the lines of a case."""
    case = loaded(name)
    truss, own = case.resolve(), full(case)
    other = {key: {row.name: row for row in frame_path.answer(case, truss, **options).rows}
             for key, options in {"two": {}, "one": {"parts": 1}, "four": {"parts": 4},
                                  "even": {"even_shear": True}}.items()}
    lines = []
    for quantity, row in other["two"].items():
        small, fe = row.values["reduced"], row.values["fe"]
        if small < 1e-9:
            continue
        changed = (other[key][quantity].values["fe"] / fe - 1 for key in ("even", "one", "four"))
        parts = [own[quantity] / small - 1, *changed, row.difference]
        lines.append(f"| `{name}` | {NAMES[quantity]} | {small:.7g} {row.unit} | {fe:.7g} {row.unit} | "
                     + " | ".join(f"{part:.1e}" for part in parts) + " |")
    return lines


def b32r(case: TrussCase) -> float:
    """Return the largest displacement [m] of a structure of beams without joints in elements B32R, Poisson's ratio 0,
    at its largest temperature change."""
    truss = case.resolve()
    beams, at = truss.elements["beam"], truss.nodes.position_m
    nodes = [f"{node}, " + ", ".join(map(number, where)) for node, where in enumerate(at, start=1)]
    lines, heated, last = [], [], len(at)
    for index, (one, two) in enumerate(beams.nodes.tolist(), start=1):
        inner = list(range(last + 1, last + 2 * PARTS))
        nodes += [f"{node}, " + ", ".join(map(number, at[one] + (at[two] - at[one]) * place / (2 * PARTS)))
                  for place, node in enumerate(inner, start=1)]
        last += len(inner)
        row, first = [one + 1, *inner, two + 1], PARTS * (index - 1) + 1
        area, (about_y, about_z) = beams.cross_section_area_m2[index - 1], beams.second_moments_of_area_m4[index - 1]
        sides = np.sqrt(12 * about_z / area), np.sqrt(12 * about_y / area)
        change = truss.temperature_ranges_K[0, 1] * float(beams.temperature_fraction[index - 1])
        heated += [f"{node}, {number(change)}" for node in inner]
        expansion = float(beams.thermal_expansion_per_K[index - 1]) * (1.0 if change else 0.0)
        lines += [f"*ELEMENT, TYPE=B32R, ELSET=E{index}",
                  *(f"{first + part}, {row[2 * part]}, {row[2 * part + 1]}, {row[2 * part + 2]}"
                    for part in range(PARTS)),
                  f"*MATERIAL, NAME=M{index}", "*ELASTIC",
                  f"{number(beams.axial_stiffness_N[index - 1] / (sides[0] * sides[1]))}, 0.", "*EXPANSION, ZERO=0.",
                  f"{expansion:.12E}", f"*BEAM SECTION, ELSET=E{index}, MATERIAL=M{index}, SECTION=RECT",
                  f"{number(sides[0])}, {number(sides[1])}",
                  ", ".join(map(number, beams.axis_y[index - 1]))]
        # A node of a heated beam and of a cold one: the cold one has no expansion in the deck.
        heated += [f"{node + 1}, {number(change)}" for node in (one, two) if change]
    held = [f"{node + 1}, {axis + 1}" for node, axis in zip(*np.nonzero(truss.nodes.fixed))]
    held += [f"{node + 1}, {axis + 4}" for node in np.flatnonzero(truss.nodes.fixed[:, 0])
             for axis in np.flatnonzero(truss.nodes.fixed_rotations[node])]
    deck = ["*NODE, NSET=ALL", *nodes, *lines, "*INITIAL CONDITIONS, TYPE=TEMPERATURE", "ALL, 0.", "*BOUNDARY", *held,
            "*STEP", "*STATIC", "*TEMPERATURE", *heated, "*NODE PRINT, NSET=ALL", "U", "*END STEP"]
    moved = ccx.displacements(deck, "ALL")[-1]
    return max(float(np.linalg.norm(moved[node + 1])) for node in range(len(at)))


def main() -> None:
    """Print the table."""
    heads = ("case", "quantity", "solver, small displacements", "CalculiX", "large displacements", "shear", "one brick",
             "four bricks", "remaining difference")
    print(f"| {' | '.join(heads)} |\n|{'---|' * len(heads)}")
    for name in CASES:
        print("\n".join(rows(name)), flush=True)
    print(f"\nportal in elements B32R: {b32r(loaded('portal')):.7g} m")


if __name__ == "__main__":
    main()
