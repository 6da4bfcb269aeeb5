#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Slow heating: truss dynamics with a tolerance against the DEM; writes results/motion/slow_heating.md and .csv.

    PYTHONPATH=build/python /usr/bin/python3 studies/bench/motion_slow.py [--case CASE] [--runs FOLDER]

A chain of 100 blocks with dashpots is heated and cooled once, with several periods. Periods named "damped" have
critical dashpots in the links, so that the chain comes to rest between slips of its blocks. The number of steps is
proportional to the period in the DEM, but depends on the events in truss dynamics. The reference is truss dynamics with
a tolerance of 1e-12 m. DEM runs take minutes of CPU; --runs stores and reuses them.
"""
from __future__ import annotations

from pathlib import Path
from time import process_time
from typing import Any

import numpy as np
import statejump as sj
from run import parse_cases, publish, start
from statejump.core.errors import StatejumpError
from statejump.kinds.truss import motion

SAMPLES = 200  # of a cycle
BLOCKS = 100
PERIODS_S = {"10": 10.0, "100": 100.0, "1000": 1000.0, "100 damped": 100.0, "1000 damped": 1000.0}
CRITICAL = 1.0  # dem.link_damping_ratio
# Fractions of the stable step. Only short cases use the shorter step, which would take an hour for the others.
FRACTIONS = {"10": (0.9, 0.1), "100": (0.9, 0.1), "1000": (0.9,), "100 damped": (0.9,), "1000 damped": (0.9,)}
TOLERANCES_M = (1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11)
REFERENCE_M = 1e-12  # tolerance of the motion that is the reference of all errors [m]
COLUMNS = ("case", "model", "steps", "rms_over_largest", "largest_over_largest", "cpu_time_s", "us_per_step")


def case(period: str) -> Any:
    """Return the chain case with the DEM's masses and the DEM's sticking stiffness."""
    damped = {"dem.link_damping_ratio": CRITICAL} if "damped" in period else {}
    return sj.truss.chain(BLOCKS).changed({
        "thermal.period_s": PERIODS_S[period], "reduced.sticking": "elastic", "motion.masses": "lumped",
        "output.samples_per_cycle": SAMPLES, **damped})


def dem(period: str, fraction: float, runs: Path | None) -> dict[str, Any]:
    """Return displacements [m], CPU time [s] and steps of the DEM."""
    kept = None if runs is None else runs / f"{period.replace(' ', '_')}_{fraction}.npz"
    if kept is not None and kept.exists():
        with np.load(kept) as found:
            return {key: found[key] for key in found}
    run = case(period).changed({"dem.time_step_fraction": fraction}).dem()
    found = {"d": run["displacement_m"], "cpu": run.about["cpu_time_s"], "steps": run.about["steps"]}
    if kept is not None:
        kept.parent.mkdir(parents=True, exist_ok=True)
        np.savez(kept, **found)
    return found


def moved(period: str, tolerance_m: float) -> dict[str, Any]:
    """Return the same of the motion."""
    definition = case(period).changed({"motion.displacement_tolerance_m": tolerance_m}).definition
    definition.resolve()
    begun = process_time()
    found = motion.simulate(definition)
    return {"d": found.states["displacement_m"], "cpu": process_time() - begun, "steps": found.steps}


def row(period: str, model: str, run: dict[str, Any], reference: np.ndarray) -> dict[str, Any]:
    """Return the cost of one run, and its error relative to the reference run."""
    apart = np.linalg.norm(run["d"] - reference, axis=2)
    largest = np.linalg.norm(reference, axis=2).max()
    return {
        "case": period, "model": model, "steps": int(run["steps"]),
        "rms_over_largest": float(np.sqrt((apart**2).mean(axis=0)).max() / largest),
        "largest_over_largest": float(apart.max() / largest), "cpu_time_s": round(float(run["cpu"]), 4),
        "us_per_step": round(1e6 * float(run["cpu"]) / int(run["steps"]), 2),
    }


def measure(periods: list[str], runs: Path | None) -> list[dict[str, Any]]:
    """Run both models."""
    rows = []
    for period in periods:
        found = {f"DEM, {fraction} of the stable step": dem(period, fraction, runs) for fraction in FRACTIONS[period]}
        found |= {f"in motion, {tolerance:.0e} m": moved(period, tolerance)
                  for tolerance in (*TOLERANCES_M, REFERENCE_M)}
        reference = found[f"in motion, {REFERENCE_M:.0e} m"]["d"]
        for model, one in found.items():
            rows.append(row(period, model, one, reference))
            print(rows[-1], flush=True)
    return rows


def report(rows: list[dict[str, Any]]) -> str:
    """Return the table as Markdown."""
    lines = []
    for period in dict.fromkeys(one["case"] for one in rows):
        of_period = [one for one in rows if one["case"] == period]
        longest = next(one for one in of_period if one["model"].startswith("DEM"))
        for k, one in enumerate(of_period):
            is_reference = one["rms_over_largest"] == 0
            rms = "of the reference" if is_reference else f"{one['rms_over_largest']:.1e}"
            largest = "" if is_reference else f"{one['largest_over_largest']:.1e}"
            ratio = "" if one["model"].startswith("DEM") else f"{longest['cpu_time_s'] / one['cpu_time_s']:.3g}"
            words = f"{PERIODS_S[period]:g} s" + (", critical dashpots" if "damped" in period else "")
            first = words if k == 0 else ""
            lines.append(f"| {first} | {one['model']} | {one['steps']:,} | {rms} | {largest} | "
                         f"{one['cpu_time_s']:.3g} s | {one['us_per_step']:.3g} µs | {ratio} |")
    table = "\n".join(lines)
    return f"""# Slow heating: trusses in motion with a tolerance against the DEM

A chain of {BLOCKS} blocks is heated and cooled once in the period. Its links have dashpots of 0.1 of the critical
ones, or critical ones (`dem.link_damping_ratio`). It has the masses of the DEM, elastic sticking and {SAMPLES}
samples. Motion uses
`motion.displacement_tolerance_m`.

- rms: largest rms error of all nodes over the run, over the largest displacement
- largest: largest error at any time, over the largest displacement
- CPU: time of the steps on one shared core
- times cheaper: than the DEM at 0.9 of its stable step

The reference is the motion with the smallest tolerance. The DEM with its shorter step bounds the error of this
reference.

| period | model | steps | rms | largest | CPU | per step | times cheaper |
|---|---|--:|--:|--:|--:|--:|--:|
{table}

Explanation: [Cost of motion](../../docs/validation/motion_cost.md).

## Again

```
PYTHONPATH=build/python /usr/bin/python3 studies/bench/motion_slow.py [--case CASE] [--runs FOLDER]
```
"""


def main() -> None:
    """Measure and write."""
    kept = {"type": Path, "help": "folder in which runs of the DEM are kept"}
    arguments = parse_cases(__doc__.splitlines()[0], PERIODS_S, runs=kept)
    rows = measure(arguments.case, arguments.runs)
    publish(arguments.output, "slow_heating", COLUMNS, rows, report(rows))


if __name__ == "__main__":
    start(main, StatejumpError)
