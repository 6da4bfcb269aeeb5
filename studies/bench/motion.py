#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Compares truss dynamics with the DEM and the quasi-static solver; writes results/motion/models.md and models.csv.

    PYTHONPATH=build/python /usr/bin/python3 studies/bench/motion.py [--case NAME]

Each case runs in the DEM, in truss dynamics with the DEM's masses and elastic sticking or partial slip, in truss
dynamics with penalty contact, and on the quasi-static path with elastic and with rigid sticking. Runs are compared
point by point at the DEM's samples. Unsupported combinations are omitted: latches with penalty contact, balls that
stick rigidly.
"""
from __future__ import annotations

from collections.abc import Callable, Iterator
from math import ceil
from typing import Any

import numpy as np
import statejump as sj
from run import parse_cases, publish, start
from statejump.core.errors import StatejumpError
from statejump.kinds.truss import compare, stable_steps

STEPS, SAMPLES = 50_000, 2_000  # of a cycle
EXPLICIT_STEPS = 4  # times as many as are just stable
CASES: dict[str, tuple[Callable[[], Any], dict[str, Any]]] = {
    "chain_10": (lambda: sj.load("cases/trusses/chain_10.toml"), {}),
    "chain_10, ten times as fast": (lambda: sj.load("cases/trusses/chain_10.toml"), {"thermal.period_s": 0.1}),
    "umbrella_rib": (lambda: sj.load("cases/trusses/umbrella_rib.toml"), {}),
    "umbrella_rib, hundred times as fast": (
        lambda: sj.load("cases/trusses/umbrella_rib.toml"), {"thermal.period_s": 0.16}),
    "umbrella_8": (lambda: sj.load("cases/trusses/umbrella_8.toml"), {}),
    "umbrella_8, hundred times as fast": (
        lambda: sj.load("cases/trusses/umbrella_8.toml"), {"thermal.period_s": 0.16}),
    "ring_6": (lambda: sj.truss.ring(6), {}),
    "ring_6, five times as fast": (lambda: sj.truss.ring(6), {"thermal.period_s": 0.2}),
    "latch_lever": (lambda: sj.load("cases/trusses/latch_lever.toml"), {}),
    "latch_lever, twenty times as fast": (
        lambda: sj.load("cases/trusses/latch_lever.toml"), {"thermal.period_s": 0.05}),
    "latch_boom": (lambda: sj.load("cases/trusses/latch_boom.toml"), {}),
    "mast_6": (lambda: sj.load("cases/trusses/mast_6.toml"), {}),
    "mast_6, 5 s, pins damped": (
        lambda: sj.load("cases/trusses/mast_6.toml"),
        {"thermal.period_s": 5.0, "dem.pin_damping_N_m_s_per_rad": 0.1}),
    "ball_tripod": (lambda: sj.load("cases/trusses/ball_tripod.toml"), {}),
    "ring_6, partial slip": (
        lambda: sj.truss.ring(6),
        {"reduced.sticking": "partial_slip", "dem.friction_law": "mindlin_deresiewicz"}),
}
COLUMNS = ("case", "model", "jump_m", "jump_node", "jump_difference_m", "rms_over_largest",
           "peak_acceleration_m_per_s2", "friction_J", "dashpots_J", "steps", "cpu_time_s")


def peak_acceleration(run: Any) -> float:
    """Return the largest acceleration of a node [m/s²], as second difference of the samples; shorter changes are lost
    in both models."""
    moved, interval = run["displacement_m"], run.time_s[1] - run.time_s[0]
    return float(np.linalg.norm(moved[2:] - 2 * moved[1:-1] + moved[:-2], axis=2).max() / interval**2)


def row(case: Any, name: str, model: str, run: Any, dem: Any, steps: float, seconds: float) -> dict[str, Any]:
    """Return the results of one run, and its difference from the DEM at the node that jumps most in the DEM."""
    jumps = compare.jumps_m(run)
    node = int(np.argmax(np.linalg.norm(compare.jumps_m(dem), axis=1)))
    apart = np.linalg.norm(run["displacement_m"] - dem["displacement_m"], axis=2)
    moves = model == "DEM" or model.startswith("in motion")
    return {
        "case": name, "model": model, "jump_m": float(np.linalg.norm(jumps[node])), "jump_node": case.node[node].name,
        "jump_difference_m": float(np.linalg.norm(jumps - compare.jumps_m(dem), axis=1).max()),
        "rms_over_largest": float(np.sqrt((apart**2).mean(axis=0)).max()
                                  / np.linalg.norm(dem["displacement_m"], axis=2).max()),
        "peak_acceleration_m_per_s2": peak_acceleration(run) if moves else "",
        "friction_J": float(run["friction_dissipation_J"][-1]),
        "dashpots_J": float(run["damping_dissipation_J"][-1]) if moves else "", "steps": int(steps),
        "cpu_time_s": round(seconds, 3),
    }


def explicit(case: Any) -> Any:
    """Return the case with penalty contact, and with the same number of time steps between all samples."""
    least, samples = stable_steps.least_steps_per_cycle(case.definition), case.output.samples_per_cycle
    return case.changed({"motion.scheme": "regularised",
                         "motion.steps_per_cycle": ceil(EXPLICIT_STEPS * least / samples) * samples})


def models(case: Any, partial: bool) -> Iterator[tuple[str, Any, bool]]:
    """Yield, for every model except the DEM, its name, its case, and whether it has inertia."""
    yield "in motion", case, True
    if not case.latch_hinge:
        yield "in motion, regularised", explicit(case), True
    yield f"quasi-static, {'partial slip' if partial else 'elastic sticking'}", case, False
    if not partial and not case.ball_joint:
        yield "quasi-static, rigid sticking", case.changed({"reduced.sticking": "rigid"}), False


def measure(names: list[str]) -> list[dict[str, Any]]:
    """Run all models of these cases."""
    from time import process_time

    rows = []
    for name in names:
        load, changes = CASES[name]
        case = load().changed({"motion.masses": "lumped", "motion.steps_per_cycle": STEPS,
                               "output.samples_per_cycle": SAMPLES, "reduced.sticking": "elastic", **changes})
        dem = case.dem()
        rows.append(row(case, name, "DEM", dem, dem, dem.about["steps"], dem.about["cpu_time_s"]))
        for model, one, moves in models(case, "reduced.sticking" in changes):
            begun = process_time()
            found = one.reduced(dynamic=moves)
            seconds = process_time() - begun
            steps = found.summary["steps" if moves else "solves"]
            rows.append(row(case, name, model, found, dem, steps, seconds))
        for done in (one for one in rows if one["case"] == name):
            print(done, flush=True)
    return rows


def report(rows: list[dict[str, Any]]) -> str:
    """Return the table as Markdown."""
    lines = []
    for one in rows:
        own = one["model"] == "DEM"

        def shown(key: str, digits: int, one: dict[str, Any] = one) -> str:
            return "" if one[key] == "" else f"{one[key]:.{digits}g}"

        lines.append(
            f"| {one['case'] if own else ''} | {one['model']} | {1e6 * one['jump_m']:.6g} µm"
            f"{' (' + one['jump_node'] + ')' if own else ''} | "
            f"{'' if own else format(1e9 * one['jump_difference_m'], '.3g') + ' nm'} | "
            f"{'' if own else format(one['rms_over_largest'], '.1e')} | {shown('peak_acceleration_m_per_s2', 4)} | "
            f"{shown('friction_J', 6)} | {shown('dashpots_J', 4)} | {one['steps']:,} | {one['cpu_time_s']:.3g} s |")
    table = "\n".join(lines)
    return f"""# Trusses in motion beside the DEM and the quasi-static solver

The names of the cases state their changes. Each run has {SAMPLES:,} samples per cycle. Motion has {STEPS:,} steps per
cycle, the masses of the DEM (`motion.masses = "lumped"`), and elastic sticking as in the DEM, or partial slip.

- jump: of the node with the largest jump in the DEM
- difference: largest difference of the jump from the DEM, of all nodes
- rms: largest rms difference from the DEM over the run, of all nodes, over the largest displacement
- peak acceleration: largest second difference of the samples [m/s²]; heat in J
- steps: for a quasi-static path the number of linear systems
- regularised: penalty contact with the DEM's laws, in {EXPLICIT_STEPS} times as many steps as are just stable
- CPU: of one shared core; that of the DEM includes its samples

| case | model | jump | difference | rms | peak acceleration | friction | dashpots | steps | CPU |
|---|---|--:|--:|--:|--:|--:|--:|--:|--:|
{table}

Explanation: [Motion beside the DEM](../../docs/validation/motion.md#fifteen-cases).

## Again

```
PYTHONPATH=build/python /usr/bin/python3 studies/bench/motion.py [--case NAME]
```
"""


def main() -> None:
    """Measure and write."""
    arguments = parse_cases(__doc__.splitlines()[0], CASES)
    rows = measure(arguments.case)
    publish(arguments.output, "models", COLUMNS, rows, report(rows))


if __name__ == "__main__":
    start(main, StatejumpError)
