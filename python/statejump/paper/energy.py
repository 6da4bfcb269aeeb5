# SPDX-License-Identifier: GPL-3.0-or-later
"""``statejump energy``: what the energy account leaves over, against the steps of both models."""
from __future__ import annotations

import csv
import math
from dataclasses import asdict, dataclass, fields
from pathlib import Path
from typing import Callable, Optional, Sequence

import click
import numpy as np

from statejump import laws
from statejump.kinds.umbrella.case import UmbrellaCase
from statejump.core.errors import StatejumpError
from statejump.core.history import History
from statejump.core.output import results_folder, write_atomically
from statejump.kinds.spring_slider.figure import DEM, REDUCED, STYLE, plt, save
from statejump.cli.terminal import QUIET, RESULTS, counted, load_kind, make_console, undivided
from statejump.kinds.umbrella import dem, reduced as model
from statejump.kinds.umbrella.compare import energy_residual

REDUCED_STEPS_PER_SECOND = tuple(12_500 * 2**i for i in range(8))
DEM_STEPS_PER_SECOND = tuple(50_000 * 2**i for i in range(5))
ADAPTIVE_TOLERANCES = (1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11, 1e-12)
LONGEST_PERIOD_s = 1.0
SAMPLES = 250  # divides every number of steps
INSTANTS = ("before contact", "heating", "end")
EXPECTED = {  # observed order of the residue
    ("as_case", "reduced"): "5 ringing, 2.5 to 3 edges of contact, 1 to 2 friction with memory",
    ("as_case", "DEM"): "2; 1 from a corner of the program or a slip on",
    ("conservative", "reduced"): "5 ringing, 2.5 to 3 edges of contact",
    ("conservative", "DEM"): "2",
    ("conservative", "adaptive"): "5",
}

EXPLANATION = """\
Residue: thermal work less change of stored energy less dissipation, from the start to an instant,
over the largest thermal work of the run. `before contact` ends before the play is used up (with links
that follow their expansion nothing has happened until then), `heating` at the last sample before the
largest temperature, `end` at the end. `order` is log2 of the ratio of two residues, `fit` the slope of
all that are above rounding. The residues change sign, so single orders scatter; the fit is what counts.

- RK4 loses energy of the ringing links at order 5. Hertz's force has no second derivative at the edge
  of contact: a step over it leaves h^2.5 to h^3, seen once the ringing is resolved. Friction with
  memory takes the slide of a step at the stiffness of its end: order 1 to 2.
- Leapfrog keeps the energy of the ringing to order 2, contacts included.
- Damped DEM: order 1. At a corner of the program the rate of the links' thermal length jumps by 2 dl/dt
  and with it the dashpots' force; across a jump an account step by step is of first order, its error a
  fraction of sum c (2 dl/dt)^2 dt, `corner` below.
- Without friction and damping the motion after contact is chaotic: runs of different steps end in
  different states. The account of each run must close all the same; before contact they follow
  one path.
- Rounding: E A times the rounding of a length times the thermal stroke, in the figure as a line.
"""


@dataclass(frozen=True)
class Row:
    """One run's residue at one instant."""

    variant: str
    model: str
    instant: str
    steps_per_second: float
    tolerance: Optional[float]
    residue_J: float
    residue_over_thermal_work: float
    order: Optional[float] = None
    fit: Optional[float] = None


@dataclass(frozen=True)
class Variant:
    """A case whose account is studied."""

    name: str
    title: str
    case: UmbrellaCase


def variants(case: UmbrellaCase) -> list[Variant]:
    """The case itself, and free of friction and damping with ringing links."""
    if case.thermal.shape == "table":
        raise StatejumpError(
            f"case {case.name}: thermal.shape = 'table' is not allowed: 'statejump energy' shortens the period"
        )
    if case.thermal.temperature_change_max_K == 0:
        raise StatejumpError(
            f"case {case.name}: thermal.temperature_change_max_K = 0 is not allowed: there is no thermal work to "
            "account for"
        )
    common = {
        "thermal.period_s": min(case.period_s, LONGEST_PERIOD_s),
        "thermal.cycles": 1,
        "output.samples_per_cycle": SAMPLES,
        "reduced.method": "rk4",
    }
    own = model.changed(case, common)
    free = model.changed(
        own,
        {
            "joint.friction_law": "none",
            "joint.dissipation_law": "none",
            "damping.axial_damping_ratio": 0.0,
            "damping.pin_damping_N_m_s_per_rad": 0.0,
            "start.contact_angle_rad": 0.0,
            **({"start.mode": "rest"} if case.start.mode == "matched" else {}),
        },
    )
    result = [Variant("as_case", f"{case.name}, as it is", own)]
    if free != own:
        result.append(Variant("conservative", "without friction and damping, links that ring", free))
    return result


def with_steps(case: UmbrellaCase, steps_per_second: float) -> UmbrellaCase:
    """Return the case with steps in both models."""
    steps = SAMPLES * max(1, round(case.period_s * steps_per_second / SAMPLES))
    return model.changed(case, {"reduced.steps_per_cycle": steps, "dem.steps_per_cycle": steps})


def until(history: History, sample: int) -> History:
    """Return the history up to a sample."""
    return History({name: values[: sample + 1] for name, values in history.columns.items()})


def instants(case: UmbrellaCase, finest: model.ReducedRun) -> dict[str, int]:
    """Samples at which the account is drawn up, from the finest run."""
    history = finest.history
    hottest = int(np.argmax(np.abs(history["temperature_change_K"])))
    found = {INSTANTS[1]: max(hottest - 1, 1), INSTANTS[2]: len(history) - 1}
    if finest.first_contact_time_s is None:
        return found
    # One sample earlier than needed: with other steps the first contact comes a little sooner.
    before = int(finest.first_contact_time_s / case.period_s * SAMPLES) - 1
    return {INSTANTS[0]: before, **found} if before > 0 else found


def rounding_J(case: UmbrellaCase) -> float:
    """Size [J] of the account's rounding."""
    stroke = abs(case.thermal.temperature_change_max_K or 0.0)
    return max(
        link.young_modulus_Pa * link.cross_section_area_m2 * float(np.finfo(float).eps)
        * abs(link.thermal_expansion_per_K) * stroke * link.stress_free_length_m
        for link in (case.link_ab, case.link_bc)
    )


def corner_W(case: UmbrellaCase) -> float:
    """Dashpots' power [W] right after a triangle's corner, c (2 dl/dt)^2 of both links."""
    if case.thermal.shape != "triangle":
        return 0.0
    rate = abs(float(model.thermal_program(case).temperature_rate(0.0)))
    total = 0.0
    for link in (case.link_ab, case.link_bc):
        stiffness = link.young_modulus_Pa * link.cross_section_area_m2 / link.stress_free_length_m
        dashpot = 2 * case.damping.axial_damping_ratio * math.sqrt(stiffness * link.mass_kg / 3)
        total += dashpot * (2 * link.thermal_expansion_per_K * link.stress_free_length_m * rate) ** 2
    return total


def with_orders(rows: Sequence[Row], floor: float) -> list[Row]:
    """Add the orders to rows of one model at one instant, from coarse to fine."""
    above = [row for row in rows if abs(row.residue_over_thermal_work) > floor]
    fit = None
    if len(above) > 1:
        steps, residues = (
            np.log2([abs(getattr(row, name)) for row in above])
            for name in ("steps_per_second", "residue_over_thermal_work")
        )
        fit = -float(np.polyfit(steps, residues, 1)[0])
    result: list[Row] = []
    for row in rows:
        order = None
        if result and row in above and result[-1].residue_J:
            octaves = math.log2(row.steps_per_second / result[-1].steps_per_second)
            if octaves > 0.2:  # an adaptive run may take as many steps for another tolerance
                order = math.log2(abs(result[-1].residue_J / row.residue_J)) / octaves
        result.append(Row(**{**asdict(row), "order": order, "fit": fit}))
    return result


Run = tuple[str, float, Optional[float], History]  # model, steps per second, tolerance, history


@dataclass(frozen=True)
class Result:
    """The rows of a variant, and what they are measured by."""

    variant: Variant
    thermal_work_J: float  # the largest
    dissipation_J: float  # all of it, at the end
    rows: list[Row]

    @property
    def floor(self) -> float:
        """Rounding over thermal work."""
        return rounding_J(self.variant.case) / self.thermal_work_J


def study(
    chosen: Sequence[Variant],
    report: Callable[[float], None],
    reduced_steps: Sequence[int] = REDUCED_STEPS_PER_SECOND,
    dem_steps: Sequence[int] = DEM_STEPS_PER_SECOND,
) -> list[Result]:
    """Run all variants in both models."""
    found: dict[str, list[Run]] = {}
    finest: dict[str, model.ReducedRun] = {}
    total = len(chosen) * (len(reduced_steps) + len(dem_steps) + len(ADAPTIVE_TOLERANCES))
    finished = counted(report, total)
    for variant in chosen:
        runs = found[variant.name] = []
        for rate in reduced_steps:
            finest[variant.name] = model.run(with_steps(variant.case, rate))
            runs.append(("reduced", float(rate), None, finest[variant.name].history))
            finished()
        for tolerance in ADAPTIVE_TOLERANCES:
            finished()
            if laws.law("friction", variant.case.joint.friction_law).has_memory:
                continue  # not smooth enough for error control
            adaptive = model.run(
                model.changed(
                    variant.case,
                    {"reduced.method": "adaptive", "reduced.relative_tolerance": tolerance},
                )
            )
            runs.append(("adaptive", adaptive.steps / variant.case.period_s, tolerance, adaptive.history))
    pairs = sorted(((variant, rate) for variant in chosen for rate in dem_steps), key=lambda pair: -pair[1])
    histories = dem.execute_all([with_steps(variant.case, rate) for variant, rate in pairs], finished)
    for (variant, rate), run in sorted(zip(pairs, histories), key=lambda entry: entry[0][1]):
        found[variant.name].append(("DEM", float(rate), None, run.history))
    return [_result(variant, finest[variant.name], found[variant.name]) for variant in chosen]


def _result(variant: Variant, finest: model.ReducedRun, runs: Sequence[Run]) -> Result:
    work = float(np.max(np.abs(finest.history["thermal_work_J"])))
    if not work > 0:
        raise StatejumpError(f"case {variant.case.name}: there is no thermal work to account for")
    dissipated = sum(
        float(values[-1]) for name, values in finest.history.columns.items() if name.endswith("_dissipation_J")
    )
    result = Result(variant, work, dissipated, [])
    for name in ("reduced", "adaptive", "DEM"):
        for instant, sample in instants(variant.case, finest).items():
            rows = []
            for own, rate, tolerance, history in runs:
                if own == name:
                    residue = energy_residual(until(history, sample))
                    rows.append(Row(variant.name, name, instant, rate, tolerance, residue, residue / work))
            result.rows.extend(with_orders(rows, result.floor))
    return result


STYLES = {
    "reduced": {**REDUCED, "label": "reduced model, RK4"},
    "DEM": {**DEM, "label": "DEM (YADE), leapfrog"},
    "adaptive": dict(color="#009E73", linewidth=1.4, linestyle=(0, (6, 1, 1, 1)),
                     label="reduced model, adaptive"),
}
# Where the order stands: at which point of the curve, offset, alignment.
LABELS = {"reduced": (0, (0, 11), "center"), "DEM": (-1, (7, 0), "left"), "adaptive": (0, (-7, 0), "right")}
MARKERS = {INSTANTS[0]: "o", INSTANTS[1]: "s", INSTANTS[2]: "D"}


def figure(case: UmbrellaCase, results: Sequence[Result], folder: Path) -> list[Path]:
    """Write ``energy.png`` and ``energy.svg``: relative residue against steps per second."""
    names = [name for name in INSTANTS if any(row.instant == name for result in results for row in result.rows)]
    with plt.rc_context(STYLE):
        drawing, panels = plt.subplots(
            len(results), len(names), figsize=(3.6 * len(names) + 0.6, 3.6 * len(results) + 0.9), squeeze=False,
            sharex=True, sharey=True, constrained_layout=True,
        )
        panels[0, 0].set_xlim(9e3, 2.2e6)
        for line, result in zip(panels, results):
            for panel, instant in zip(line, names):
                # Nothing happens before contact if the links follow their expansion.
                mine = [row for row in result.rows if row.instant == instant]
                panel.set_visible(any(abs(row.residue_over_thermal_work) > result.floor for row in mine))
                if not panel.get_visible():
                    continue
                _draw(panel, result, instant)
                panel.set_title(f"{result.variant.title}:\n{instant}", fontsize=8)
        for panel in panels[-1]:
            panel.set_xlabel("Steps per second [1/s]")
        for line in panels:
            shown = [panel for panel in line if panel.get_visible()]
            shown[0].set_ylabel("|residue| / largest thermal work [-]")
            shown[0].yaxis.set_tick_params(labelleft=True)
        for panel in panels[:, -1]:
            panel.legend(loc="upper right", framealpha=1, fontsize=7, handlelength=3.2)
        drawing.suptitle(f"{case.title}: energy account against steps (numbers: order, fitted)", fontsize=11)
        return save(drawing, folder, "energy")


def _draw(panel: plt.Axes, result: Result, instant: str) -> None:
    panel.set_xscale("log")
    panel.set_yscale("log")
    for name, style in STYLES.items():
        mine = [row for row in result.rows if row.model == name and row.instant == instant and row.residue_J]
        if mine:
            panel.plot([row.steps_per_second for row in mine], [abs(row.residue_over_thermal_work) for row in mine],
                       marker=MARKERS[instant], markersize=7 if name == "reduced" else 4, **style)
            if mine[0].fit is not None:
                which, place, side = LABELS[name]
                panel.annotate(
                    f"{mine[0].fit:.1f}", (mine[which].steps_per_second, abs(mine[which].residue_over_thermal_work)),
                    xytext=place, textcoords="offset points", ha=side, va="center", fontsize=8, color="#0072B2",
                )
    panel.axhline(result.floor, color="0.5", linewidth=1.0, linestyle=":", label="rounding")
    panel.margins(y=0.12)


def write(case: UmbrellaCase, results: Sequence[Result], folder: Path) -> list[Path]:
    """Write ``energy.csv`` and ``energy.md``."""
    with write_atomically(folder / "energy.csv") as stream:
        writer = csv.DictWriter(stream, fieldnames=[field.name for field in fields(Row)])
        writer.writeheader()
        writer.writerows(asdict(row) for result in results for row in result.rows)
    lines = [f"# Energy account against steps: {case.title}", "", f"Made by `statejump energy cases/{case.name}.toml`.",
             "", EXPLANATION]
    if case.period_s > LONGEST_PERIOD_s:
        lines += [f"The period is {LONGEST_PERIOD_s:g} s here instead of the case's {case.period_s:g} s.", ""]
    for result in results:
        variant = result.variant
        lines += [
            f"## {variant.title}", "",
            f"Largest thermal work {result.thermal_work_J:.4e} J, dissipation {result.dissipation_J:.4e} J, "
            f"rounding {rounding_J(variant.case):.1e} J, corner {corner_W(variant.case):.3e} W times the step.", "",
            "| model | instant | steps/s | tolerance | residue [J] | over thermal work | order | fit | expected |",
            "|" + "---|" * 9,
        ]
        for row in result.rows:
            tolerance, order, fit = (
                "" if value is None else f"{value:{form}}"
                for value, form in ((row.tolerance, ".0e"), (row.order, ".2f"), (row.fit, ".2f"))
            )
            lines.append(
                f"| {row.model} | {row.instant} | {row.steps_per_second:.0f} | {tolerance} | {row.residue_J:.3e} "
                f"| {row.residue_over_thermal_work:.3e} | {order} | {fit} "
                f"| {EXPECTED.get((row.variant, row.model), '')} |"
            )
        lines.append("")
    with write_atomically(folder / "energy.md") as stream:
        stream.write("\n".join(lines))
    return [folder / "energy.md", folder / "energy.csv"]


@click.command("energy")
@click.argument("case_file", metavar="CASE", type=click.Path(path_type=Path))
@RESULTS
@QUIET
def energy_command(case_file: Path, results: Path, quiet: bool) -> None:
    """Energy account of CASE against the steps of both models, also without friction and damping.

    \b
    Example:
      statejump energy cases/umbrella_damped.toml
    """
    console = make_console(quiet)
    case = load_kind(case_file, UmbrellaCase)
    chosen = variants(case)
    folder = results_folder(results, case.name)
    with undivided(console, "runs") as tell:
        found = study(chosen, tell)
    written = write(case, found, folder) + figure(case, found, folder)
    for result in found:
        fits = {(row.model, row.instant): row.fit for row in result.rows if row.fit is not None}
        for (name, instant), fit in fits.items():
            console.print(f"{result.variant.title}: {name}, {instant}: residue of order {fit:.2f}")
    console.print(f"results: {', '.join(str(name) for name in written)}")
