#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Convergence of the DEM, penalty contact and Moreau–Jean with the time step; writes results/motion/explicit.md and
explicit.csv.

    PYTHONPATH=build/python /usr/bin/python3 studies/bench/motion_explicit.py [--case NAME]

The reference is penalty contact with 1/40 of the stable time step.
"""
from __future__ import annotations

from collections.abc import Callable, Iterator
from math import ceil
from typing import Any

import numpy as np
import statejump as sj
from run import parse_cases, publish, start
from statejump.core.errors import StatejumpError
from statejump.kinds.truss import stable_steps

SAMPLES = 200  # of a cycle
REFERENCE = 40.0  # number of steps, over the smallest stable number
EXPLICIT = (1.0, 2.0, 4.0, 8.0)
FRACTIONS = (0.4, 0.2, 0.1, 0.05, 0.025)  # of the DEM's stable step
IMPLICIT = (5_000, 10_000, 20_000, 40_000, 80_000)
CASES: dict[str, Callable[[], Any]] = {
    "chain of 3, 0.1 s": lambda: sj.truss.chain(3).changed({"thermal.period_s": 0.1}),
    "umbrella_rib, 0.16 s": lambda: sj.load("cases/trusses/umbrella_rib.toml").changed({"thermal.period_s": 0.16}),
}
COLUMNS = ("case", "model", "steps", "rms_over_largest", "friction_J")


def runs(case: Any) -> Iterator[tuple[str, int, Any]]:
    """Yield model, steps and run, the reference first."""
    least = stable_steps.least_steps_per_cycle(case.definition)
    for times in (REFERENCE, *EXPLICIT):
        steps = ceil(times * least / SAMPLES) * SAMPLES
        yield "explicit", steps, case.changed({
            "motion.scheme": "regularised", "motion.steps_per_cycle": steps}).reduced(dynamic=True)
    for fraction in FRACTIONS:
        run = case.changed({"dem.time_step_fraction": fraction}).dem()
        yield "DEM", int(run.about["steps"]), run
    for steps in IMPLICIT:
        yield "by sets", steps, case.changed({"motion.steps_per_cycle": steps}).reduced(dynamic=True)


def measure(name: str) -> list[dict[str, Any]]:
    """Run one case in all models and steps."""
    case = CASES[name]().changed({"motion.masses": "lumped", "reduced.sticking": "elastic",
                                  "output.samples_per_cycle": SAMPLES})
    rows, reference = [], None
    for model, steps, run in runs(case):
        moved = run["displacement_m"]
        reference = moved if reference is None else reference
        apart = np.sqrt(((moved - reference) ** 2).sum(axis=2).mean(axis=0)).max()
        rows.append({
            "case": name, "model": model, "steps": steps,
            "rms_over_largest": float(apart / np.linalg.norm(reference, axis=2).max()),
            "friction_J": float(run["friction_dissipation_J"][-1])})
        print(rows[-1], flush=True)
    return rows


def report(rows: list[dict[str, Any]]) -> str:
    """Return the table as Markdown."""
    table = "\n".join(
        f"| {row['case']} | {row['model']} | {row['steps']:,} | {row['rms_over_largest']:.1e} | "
        f"{row['friction_J']:.7g} |" for row in rows)
    return f"""# Trusses in motion: convergence of all integrators

Masses as the DEM has them, elastic sticking, dashpots as the cases have them. rms: of displacement at {SAMPLES}
samples, the largest of all nodes, over the largest displacement, from the first row of the case: explicit steps
(`motion.scheme = "regularised"`) {REFERENCE:g} times as short as the stable one. The DEM's steps are
{', '.join(f'{fraction:g}' for fraction in FRACTIONS)} of the stable one.

| case | model | steps | rms | heat of friction [J] |
|---|---|--:|--:|--:|
{table}

Explanation: [Trusses in motion](../../docs/theory/motion.md#penalty-contact).

## Again

```
PYTHONPATH=build/python /usr/bin/python3 studies/bench/motion_explicit.py [--case NAME]
```
"""


def main() -> None:
    """Measure and write."""
    arguments = parse_cases(__doc__.splitlines()[0], CASES)
    rows = [row for name in arguments.case for row in measure(name)]
    publish(arguments.output, "explicit", COLUMNS, rows, report(rows))


if __name__ == "__main__":
    start(main, StatejumpError)
