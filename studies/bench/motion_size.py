#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Measures the cost of truss dynamics over the number of slipping joints; writes results/motion/size.md and .csv.

    PYTHONPATH=build/python /usr/bin/python3 studies/bench/motion_size.py [--case CASE] [--largest JOINTS]

Chains of blocks, and umbrellas with cables and friction between 0.1 and 0.2, run with equal time steps and with steps
controlled by a tolerance. The largest ones take minutes of CPU.
"""
from __future__ import annotations

from math import log
from time import process_time
from typing import Any

import statejump as sj
from run import parse_cases, publish, start
from statejump.core.errors import StatejumpError
from statejump.kinds.truss import motion
from statejump.kinds.truss.solve import heat_of_joints_J
from truss import document

SAMPLES = 20  # of a cycle
STEPS = 2000  # of a cycle, where they are equal
SIZES = (10, 100, 1000, 10_000)
EQUAL = {"motion.steps_per_cycle": STEPS}
# A block of a chain of 100 moves by up to a decimetre; joints of the umbrella have a clearance of 0.1 mm.
CASES: dict[str, tuple[str, dict[str, Any]]] = {
    "chain": ("chain", EQUAL),
    "umbrella": ("umbrella", EQUAL),
    "chain, coarse": ("chain", {"motion.steps_per_cycle": STEPS // 10}),
    "chain, tolerance": ("chain", {"motion.displacement_tolerance_m": 1e-4}),
    "umbrella, tolerance": ("umbrella", {"motion.displacement_tolerance_m": 1e-6}),
}
COLUMNS = ("case", "joints", "unknowns", "slipped", "steps", "rejected_steps", "events", "factorizations",
           "contact_problems", "cpu_time_s", "us_per_joint_and_step")


def row(name: str, joints: int) -> dict[str, Any]:
    """Run one case."""
    kind, settings = CASES[name]
    case = sj.truss.chain(joints) if kind == "chain" else sj.load(document(kind, joints))
    definition = case.changed({"output.samples_per_cycle": SAMPLES, **settings}).definition
    definition.resolve()
    begun = process_time()
    found = motion.simulate(definition)
    cpu = process_time() - begun
    return {
        "case": name, "joints": joints, "unknowns": found.unknowns,
        "slipped": int((heat_of_joints_J(found.states)[-1] > 0).sum()), "steps": found.steps,
        "rejected_steps": found.rejected_steps, "events": len(found.event_heat_J),
        "factorizations": found.factorizations, "contact_problems": found.iterations, "cpu_time_s": round(cpu, 4),
        "us_per_joint_and_step": round(1e6 * cpu / joints / found.steps, 3),
    }


def power(rows: list[dict[str, Any]]) -> str:
    """Return the exponent p in cost of a step ~ (number of joints)^p, fitted from 100 joints on."""
    first = next((one for one in rows if one["joints"] == 100), None)
    last = rows[-1]
    if first is None or last["joints"] <= 100:
        return ""
    costs = [one["cpu_time_s"] / one["steps"] for one in (first, last)]
    return f"{log(costs[1] / costs[0]) / log(last['joints'] / 100):.2f}"


def told(name: str) -> str:
    """Return the words of a case."""
    kind, settings = CASES[name]
    ((key, value),) = settings.items()
    return f"{kind}, {value:,} steps" if key == "motion.steps_per_cycle" else f"{kind}, {value:.0e} m"


def report(rows: list[dict[str, Any]]) -> str:
    """Return the table as Markdown."""
    lines = []
    for name in dict.fromkeys(one["case"] for one in rows):
        of_case = [one for one in rows if one["case"] == name]
        for k, one in enumerate(of_case):
            last = power(of_case) if k == len(of_case) - 1 else ""
            lines.append(
                f"| {told(name) if k == 0 else ''} | {one['joints']:,} | {one['unknowns']:,} | {one['slipped']:,} | "
                f"{one['steps']:,} | {one['events']:,} | {one['factorizations']:,} | {one['cpu_time_s']:.3g} s | "
                f"{one['us_per_joint_and_step']:.3g} µs | {last} |")
    table = "\n".join(lines)
    problems = sum(one["contact_problems"] for one in rows)
    return f"""# Trusses in motion: cost over the number of slipping joints

One cycle of two trusses, with equal steps or with `motion.displacement_tolerance_m`: `sj.truss.chain(n)`, whose
blocks slip one after the other, and umbrellas of n ribs with cables of 1 N and friction coefficients between 0.1 and
0.2.

- slipped: joints with heat of friction
- events: changes of a joint between open, stick and slip
- factorizations: of the whole truss
- CPU: time of the steps on one shared core
- power: exponent of the number of joints in the cost of a step, from 100 joints to the largest number

Steps whose statuses were not found, and which were solved as frictional contact problems: {problems}.

| | joints | unknowns | slipped | steps | events | factorizations | CPU | per joint and step | power |
|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|
{table}

Explanation: [Cost of motion](../../docs/validation/motion_cost.md).

## Again

```
PYTHONPATH=build/python /usr/bin/python3 studies/bench/motion_size.py [--case CASE] [--largest JOINTS]
```
"""


def main() -> None:
    """Measure and write."""
    most = {"type": int, "default": SIZES[-1], "help": f"most joints (default {SIZES[-1]})"}
    arguments = parse_cases(__doc__.splitlines()[0], CASES, largest=most)
    rows = []
    for name in arguments.case:
        for joints in (size for size in SIZES if size <= arguments.largest):
            rows.append(row(name, joints))
            print(rows[-1], flush=True)
    publish(arguments.output, "size", COLUMNS, rows, report(rows))


if __name__ == "__main__":
    start(main, StatejumpError)
