#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Measures errors of a quasi-static path over the number of increments; writes results/bench/increments.md and .csv.

    PYTHONPATH=build/python /usr/bin/python3 studies/bench/increments.py [--output DIR]

Shipped trusses run with several numbers of increments per branch. Errors are the energy residue at every state, and the
distance of the final nodes from those of the path with the most increments.
"""
from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

import numpy as np
from run import REPOSITORY, publish, start
from statejump.core.errors import StatejumpError
from statejump.kinds.loading import load_case
from statejump.kinds.truss import solve

CASES = ("chain_10", "chain_cable", "iwan_10", "latch_boom", "latch_lever", "telescope", "umbrella_rib", "umbrella_8",
         "mast_6", "ring_12", "ball_tripod")
INCREMENTS = (25, 50, 100, 200)
FINEST = 800
COLUMNS = ("case", "increments", "balance", "displacement", "solves")


def residue(path: solve.TrussPath) -> float:
    """Return the largest energy residue at any state, over the largest work of thermal expansion."""
    states = path.states
    stored = states["elastic_energy_J"] + states["load_potential_J"]
    left = states["thermal_work_J"] - (stored - stored[0]) - solve.heat_of_joints_J(states).sum(axis=1)
    return float(np.abs(left).max() / np.abs(states["thermal_work_J"]).max())


def rows_of(name: str) -> list[dict[str, Any]]:
    """Return the errors of a case for every number of increments."""
    truss = load_case(REPOSITORY / "cases" / "trusses" / f"{name}.toml").resolve()
    end = solve.path(truss, increments_per_branch=FINEST).states["displacement_m"][-1]
    rows = []
    for increments in INCREMENTS:
        path = solve.path(truss, increments_per_branch=increments)
        off = np.abs(path.states["displacement_m"][-1] - end).max() / np.abs(end).max()
        rows.append({"case": name, "increments": increments, "balance": residue(path), "displacement": float(off),
                     "solves": path.solves})
    return rows


def report(rows: list[dict[str, Any]]) -> str:
    """Return the tables as Markdown."""
    def table(key: str) -> str:
        lines = (f"| {name} | " + " | ".join(f"{row[key]:.1e}" for row in rows if row["case"] == name) + " |"
                 for name in dict.fromkeys(row["case"] for row in rows))
        return "\n".join(lines)

    head = f"| case | {' | '.join(map(str, INCREMENTS))} |\n|---{'|--:' * len(INCREMENTS)}|"
    return f"""# Errors of a quasi-static path over its increments

The columns are numbers of increments per branch of the temperature; 50 is the default. Events are located to 1e-9 of a
branch.

## Balance of energies

Largest energy residue of all states over the largest work. The residue is the work of the temperature less stored
energy and heat of friction.

{head}
{table("balance")}

## Displacements at the end

Largest difference of a node from the path with {FINEST} increments, over the largest displacement.

{head}
{table("displacement")}

Explanation: [Quasi-static solver of trusses](../../docs/theory/quasi_static.md).

## Again

```
PYTHONPATH=build/python /usr/bin/python3 studies/bench/increments.py
```
"""


def main() -> None:
    """Measure and write."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--output", type=Path, default=REPOSITORY / "results" / "bench")
    output = parser.parse_args().output
    rows = [row for name in CASES for row in rows_of(name)]
    publish(output, "increments", COLUMNS, rows, report(rows))


if __name__ == "__main__":
    start(main, StatejumpError)
