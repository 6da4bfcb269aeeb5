#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Compares ensembles of undamped trusses in truss dynamics and in the DEM; writes results/motion/ensembles.md, .csv and
.png.

    PYTHONPATH=build/python:. /usr/bin/python3 studies/bench/motion_ensembles.py [--case NAME]

Without dashpots the vibration after an impact never decays, and nearby runs diverge. Therefore only distributions of
results are compared. Each model runs many times with its own random heating periods from a narrow range. The
statistical tests are those of `statejump figures`.
"""
from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
import statejump as sj
from motion import EXPLICIT_STEPS, explicit, peak_acceleration
from run import parse_cases, publish, start
from statejump.core import figures
from statejump.core.errors import StatejumpError
from statejump.kinds.truss import compare
from studies.paper.claims.statistics import SIGNIFICANCE, TwoSampleTest, two_sample_test

RUNS = 24  # of each model
SPREAD = 0.01  # of the period, either way
SAMPLES = 1_000  # of a cycle
SEED = 20_261
UNDAMPED = {"dem.link_damping_ratio": 0.0, "dem.contact_damping_ratio": 0.0, "dem.pin_damping_N_m_s_per_rad": 0.0,
            "motion.masses": "lumped", "reduced.sticking": "elastic", "output.samples_per_cycle": SAMPLES}


@dataclass(frozen=True)
class Ensemble:
    """One ensemble: load, period [s], implicit steps per cycle, and unit of heat as (units per joule, name)."""

    load: Callable[[], Any]
    period_s: float
    steps: int
    heat: tuple[float, str]


CASES = {
    "umbrella_rib": Ensemble(lambda: sj.load("cases/trusses/umbrella_rib.toml"), 0.16, 50_000, (1e6, "µJ")),
    "umbrella_8": Ensemble(lambda: sj.load("cases/trusses/umbrella_8.toml"), 0.16, 50_000, (1e6, "µJ")),
    "chain_10": Ensemble(lambda: sj.load("cases/trusses/chain_10.toml"), 0.1, 20_000, (1.0, "J")),
    "ring_6": Ensemble(lambda: sj.truss.ring(6), 0.2, 20_000, (1e3, "mJ")),
    "mast_6": Ensemble(lambda: sj.load("cases/trusses/mast_6.toml"), 1.0, 50_000, (1e6, "µJ")),
}
DEM, REGULARISED, SETS, FINE = "DEM", "regularised", "by sets", "DEM, quarter step"
MODELS = (DEM, REGULARISED, SETS, FINE)
LINES = {FINE: ("#000000", "-"), DEM: ("#777777", "-."), REGULARISED: ("#D55E00", "--"), SETS: ("#0072B2", ":")}
FRACTIONS = {DEM: 0.1, FINE: 0.025}  # of the stable step
QUANTITIES = {"jump_m": "jump", "friction_J": "heat of friction", "peak_m_per_s2": "peak acceleration"}
COLUMNS = ("case", "model", "period_s", *QUANTITIES)


def drawn_periods(period_s: float, model: int, count: int) -> np.ndarray:
    """Return evenly distributed heating periods [s], reproducible by the seed and different for each model."""
    generator = np.random.default_rng([SEED, model])
    return period_s * (1 + SPREAD * (2 * generator.random(count) - 1))


def measure(name: str, count: int) -> list[dict[str, Any]]:
    """Run one case in all models, the requested number of times."""
    ensemble = CASES[name]
    case = ensemble.load().changed({**UNDAMPED, "motion.steps_per_cycle": ensemble.steps,
                                    "thermal.period_s": ensemble.period_s})
    # The quasi-static path determines the node and the direction of the jump.
    jumps = compare.jumps_m(case.reduced())
    node = int(np.argmax(np.linalg.norm(jumps, axis=1)))
    along = jumps[node] / np.linalg.norm(jumps[node])
    rows = []
    for model in MODELS:
        rows += [row(name, model, one, node, along) for one in drawn(case, model, count)]
        print(name, model, {key: float(np.mean([one[key] for one in rows[-count:]])) for key in QUANTITIES}, flush=True)
    return rows


def drawn(case: Any, model: str, count: int) -> Iterator[Any]:
    """Yield the case for a model, with each of its periods."""
    if model == REGULARISED:
        case = explicit(case)
    elif model != SETS:
        case = case.changed({"dem.time_step_fraction": FRACTIONS[model]})
    for period_s in drawn_periods(case.thermal.period_s, MODELS.index(model), count):
        yield case.changed({"thermal.period_s": float(period_s)})


def row(name: str, model: str, case: Any, node: int, along: np.ndarray) -> dict[str, Any]:
    """Run a case and return the compared quantities, among them the jump of a node along a direction."""
    run = case.dem() if model in FRACTIONS else case.reduced(dynamic=True)
    return {"case": name, "model": model, "period_s": case.thermal.period_s,
            "jump_m": float(compare.jumps_m(run)[node] @ along),
            "friction_J": float(run["friction_dissipation_J"][-1]), "peak_m_per_s2": peak_acceleration(run)}


def unit(name: str, key: str) -> tuple[float, str]:
    """Return the display unit of a quantity of a case: units per SI unit, and name."""
    return {"jump_m": (1e6, "µm"), "friction_J": CASES[name].heat, "peak_m_per_s2": (1.0, "m/s²")}[key]


def values(rows: list[dict[str, Any]], case: str, model: str, key: str) -> np.ndarray:
    """Return the values of a quantity in all runs of a case by one model."""
    return np.array([row[key] for row in rows if row["case"] == case and row["model"] == model])


def tests(rows: list[dict[str, Any]], case: str, model: str) -> list[TwoSampleTest]:
    """Return the statistical tests of all quantities of a case: a model against the DEM with its shortest steps."""
    return [two_sample_test(words, *(values(rows, case, one, key) for one in (model, FINE)))
            for key, words in QUANTITIES.items()]


def picture(rows: list[dict[str, Any]], names: list[str], path: Any) -> None:
    """Draw the distributions of all quantities, one row per case."""
    with figures.style():
        figure, places = figures.panels(len(names), len(QUANTITIES), (10.0, 2.6 * len(names)))
        for name, axes_of in zip(names, np.asarray(places, dtype=object).reshape(len(names), -1)):
            for axes, (key, words) in zip(axes_of, QUANTITIES.items()):
                scale, shown = unit(name, key)
                for model, (color, line) in LINES.items():
                    ordered = np.sort(values(rows, name, model, key)) * scale
                    axes.step(ordered, np.arange(1, len(ordered) + 1) / len(ordered), line, where="post", color=color,
                              label=model)
                axes.set_xlabel(f"{name}: {words} [{shown}]")
                axes.set_ylim(0, 1)
            axes_of[0].set_ylabel("Share of runs [-]")
        np.ravel(np.asarray(places, dtype=object))[0].legend()
        figure.suptitle("Undamped trusses: runs with that or less, in motion and in the DEM")
        path.parent.mkdir(parents=True, exist_ok=True)
        figure.savefig(path, dpi=110)


def report(rows: list[dict[str, Any]], names: list[str], count: int) -> str:
    """Return the table as Markdown."""
    lines = []
    for name, model in ((name, model) for name in names for model in MODELS[:-1]):
        for key, test in zip(QUANTITIES, tests(rows, name, model)):
            scale, shown = unit(name, key)
            lines.append(
                f"| {name}, {CASES[name].period_s:g} s | {model} | {test.quantity} [{shown}] | "
                f"{test.reduced_mean * scale:.5g} | "
                f"{test.reduced_sd * scale:.2g} | {test.dem_mean * scale:.5g} | {test.dem_sd * scale:.2g} | "
                f"{test.p_distribution:.2g} | {test.p_mean:.2g} | {test.p_spread:.2g} | "
                f"{'yes' if test.agree else '**no**'} |")
    table = "\n".join(lines)
    steps = ", ".join(f"{name} {CASES[name].steps:,}" for name in names)
    return f"""# Undamped trusses: ensembles in motion and in the DEM

The cases have no dashpots. Each model makes {count} runs, with heating periods drawn evenly from ±{SPREAD:.0%} of the
one in the table, independently for each model.

- DEM: {FRACTIONS[DEM]:g} of its stable step, the default; quarter step: {FRACTIONS[FINE]:g} of it, the reference
- regularised: penalty contact with the DEM's masses and laws, in {EXPLICIT_STEPS} times as many steps as are just
  stable
- by sets: Moreau–Jean with the DEM's masses and elastic sticking; steps per cycle: {steps}
- jump: of the node with the largest jump on the quasi-static path, along that jump, at the end of the cycle. The node
  still rings there
- peak acceleration: largest second difference of {SAMPLES:,} samples

The tests are those of `statejump figures`: Kolmogorov-Smirnov for the distributions, Welch for the means,
Brown-Forsythe for the spreads. Two models agree if no test is significant at {SIGNIFICANCE:g}. Of {3 * len(lines)}
tests of equal models {3 * len(lines) * SIGNIFICANCE:.2g} are expected to be significant.

| case, period | model | quantity | mean | s.d. | mean, quarter | s.d. | p, distribution | p, mean | p, spread | agree |
|---|---|---|--:|--:|--:|--:|--:|--:|--:|---|
{table}

![Distributions](ensembles.png)

Explanation: [Motion beside the DEM](../../docs/validation/motion.md#undamped-ensembles).

## Again

```
PYTHONPATH=build/python:. /usr/bin/python3 studies/bench/motion_ensembles.py [--case NAME]
```
"""


def main() -> None:
    """Measure and write."""
    arguments = parse_cases(__doc__.splitlines()[0], CASES)
    rows = [row for name in arguments.case for row in measure(name, RUNS)]
    publish(arguments.output, "ensembles", COLUMNS, rows, report(rows, arguments.case, RUNS))
    picture(rows, arguments.case, arguments.output / "ensembles.png")


if __name__ == "__main__":
    start(main, StatejumpError)
