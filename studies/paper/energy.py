# SPDX-License-Identifier: GPL-3.0-or-later
"""Energy residue over the steps of both models: ``statejump energy``."""
from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import asdict, dataclass, fields, replace
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from statejump import laws
from statejump.core.errors import FailedRun
from statejump.core.figures import DEM, REDUCED, panels, save, style
from statejump.core.results_folder import Results
from statejump.core.physics import axial_stiffness_N_per_m
from statejump.core.progress import OnProgress, counted
from statejump.core.run import Columns, Run, energy_residue_J
from statejump.core.tables import markdown, write_rows, write_markdown
from statejump.kinds.umbrella import reduced as model
from statejump.kinds.umbrella.case import UmbrellaCase
from statejump.kinds.umbrella.compare import DISSIPATED, STORED, largest_temperature
from studies.paper.common import made_by, refused
from statejump.schema.paths import with_values
from studies.paper import ensembles

REDUCED_STEPS_PER_SECOND = tuple(12_500 * 2**i for i in range(8))
DEM_STEPS_PER_SECOND = tuple(50_000 * 2**i for i in range(5))
ADAPTIVE_TOLERANCES = (1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11, 1e-12)
LONGEST_PERIOD_s = 1.0
SAMPLES = 250  # divides every number of steps
SUPPLIED = "thermal_work_J"
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
    tolerance: float | None
    residue_J: float
    residue_over_thermal_work: float
    order: float | None = None
    fit: float | None = None


@dataclass(frozen=True)
class Variant:
    """A case whose account is studied."""

    name: str
    title: str
    case: UmbrellaCase


def variants(case: UmbrellaCase) -> list[Variant]:
    """Return the case, and a variant of it without friction and damping whose links vibrate."""
    if case.thermal.shape == "table":
        raise refused(case, "thermal.shape", "table", "'statejump energy' shortens the period")
    if case.thermal.temperature_change_max_K == 0:
        raise refused(case, "thermal.temperature_change_max_K", 0, "there is no thermal work to account for")
    common = {
        "thermal.period_s": min(case.period_s, LONGEST_PERIOD_s),
        "thermal.cycles": 1,
        "output.samples_per_cycle": SAMPLES,
        "reduced.method": "rk4",
    }
    own = with_values(case, common)
    free = with_values(
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
    """Return the case with the given number of time steps per second in both models."""
    steps = SAMPLES * max(1, round(case.period_s * steps_per_second / SAMPLES))
    return with_values(case, {"reduced.steps_per_cycle": steps, "dem.steps_per_cycle": steps})


def residue_J(columns: Columns | Run, sample: int = -1) -> float:
    """Return the energy residue [J] from the start to a sample, by default the last one."""
    end = sample + 1 or None
    return energy_residue_J({name: columns[name][:end] for name in (SUPPLIED, *STORED, *DISSIPATED)}, (SUPPLIED,),
                            STORED, DISSIPATED)


def instants(case: UmbrellaCase, finest: Run) -> dict[str, int]:
    """Return the samples at which the energy account is evaluated, from the run with the finest steps."""
    hottest = largest_temperature(finest)
    found = {INSTANTS[1]: max(hottest - 1, 1), INSTANTS[2]: len(finest) - 1}
    first = finest.events.first("first_contact")
    if first is None:
        return found
    # One sample earlier than needed, because with other steps the first contact is slightly earlier.
    before = int(first.time_s / case.period_s * SAMPLES) - 1
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
    """Return the power of the dashpots of both links [W], c (2 dl/dt)^2, just after a reversal of a triangular
    temperature program."""
    if case.thermal.shape != "triangle":
        return 0.0
    rate = abs(float(case.thermal_program().temperature_rate(0.0)))
    total = 0.0
    for link in (case.link_ab, case.link_bc):
        stiffness = axial_stiffness_N_per_m(
            link.young_modulus_Pa, link.cross_section_area_m2, link.stress_free_length_m
        )
        dashpot = 2 * case.damping.axial_damping_ratio * math.sqrt(stiffness * link.mass_kg / 3)
        total += dashpot * (2 * link.thermal_expansion_per_K * link.stress_free_length_m * rate) ** 2
    return total


def with_orders(rows: Sequence[Row], floor: float) -> list[Row]:
    """Add the orders of convergence to the rows of one model at one instant, sorted from coarse to fine time steps."""
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
            if octaves > 0.2:  # an adaptive run may have the same number of steps for two tolerances
                order = math.log2(abs(result[-1].residue_J / row.residue_J)) / octaves
        result.append(replace(row, order=order, fit=fit))
    return result


@dataclass(frozen=True)
class Sampled:
    """A run of one model, with its time steps per second or its tolerance."""

    model: str
    steps_per_second: float
    tolerance: float | None
    run: Run


@dataclass(frozen=True)
class Result:
    """The rows of a variant, and their scales."""

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
    on_progress: OnProgress,
    reduced_steps: Sequence[int] = REDUCED_STEPS_PER_SECOND,
    dem_steps: Sequence[int] = DEM_STEPS_PER_SECOND,
) -> list[Result]:
    """Run all variants in both models."""
    found: dict[str, list[Sampled]] = {}
    finest: dict[str, Run] = {}
    total = len(chosen) * (len(reduced_steps) + len(dem_steps) + len(ADAPTIVE_TOLERANCES))
    finished = counted(on_progress, total)
    for variant in chosen:
        runs = found[variant.name] = []
        for rate in reduced_steps:
            finest[variant.name] = model.run(with_steps(variant.case, rate))
            runs.append(Sampled("reduced", float(rate), None, finest[variant.name]))
            finished()
        for tolerance in ADAPTIVE_TOLERANCES:
            finished()
            if laws.law("friction", variant.case.joint.friction_law).has_memory:
                continue  # not smooth enough for error control
            adaptive = model.run(
                with_values(
                    variant.case,
                    {"reduced.method": "adaptive", "reduced.relative_tolerance": tolerance},
                )
            )
            runs.append(Sampled("adaptive", adaptive.summary["steps"] / variant.case.period_s, tolerance, adaptive))
    pairs = sorted(((variant, rate) for variant in chosen for rate in dem_steps), key=lambda pair: -pair[1])
    done = ensembles.execute_all([with_steps(variant.case, rate) for variant, rate in pairs], finished)
    for (variant, rate), run in sorted(zip(pairs, done), key=lambda entry: entry[0][1]):
        found[variant.name].append(Sampled("DEM", float(rate), None, run))
    return [_result(variant, finest[variant.name], found[variant.name]) for variant in chosen]


def _result(variant: Variant, finest: Run, runs: Sequence[Sampled]) -> Result:
    work = float(np.max(np.abs(finest[SUPPLIED])))
    if not work > 0:
        raise FailedRun("there is no thermal work to account for", case=variant.case.name)
    result = Result(variant, work, sum(float(finest[name][-1]) for name in DISSIPATED), [])
    for name in ("reduced", "adaptive", "DEM"):
        for instant, sample in instants(variant.case, finest).items():
            rows = []
            for one in runs:
                if one.model == name:
                    residue = residue_J(one.run, sample)
                    rows.append(Row(variant.name, name, instant, one.steps_per_second, one.tolerance, residue,
                                    residue / work))
            result.rows.extend(with_orders(rows, result.floor))
    return result


STYLES: dict[str, dict[str, Any]] = {
    "reduced": {**REDUCED, "label": "reduced model, RK4"},
    "DEM": {**DEM, "label": "DEM (YADE), leapfrog"},
    "adaptive": dict(color="#009E73", linewidth=1.4, linestyle=(0, (6, 1, 1, 1)),
                     label="reduced model, adaptive"),
}
# Position of the order in the figure: point of the curve, offset, alignment.
LABELS = {"reduced": (0, (0, 11), "center"), "DEM": (-1, (7, 0), "left"), "adaptive": (0, (-7, 0), "right")}
MARKERS = {INSTANTS[0]: "o", INSTANTS[1]: "s", INSTANTS[2]: "D"}


def figure(case: UmbrellaCase, results: Sequence[Result], folder: Path) -> list[Path]:
    """Write ``energy.png`` and ``energy.svg``: relative residue against steps per second."""
    names = [name for name in INSTANTS if any(row.instant == name for result in results for row in result.rows)]
    with style():
        drawing, grid = panels(
            len(results), len(names), (3.6 * len(names) + 0.6, 3.6 * len(results) + 0.9), squeeze=False,
            sharex=True, sharey=True,
        )
        grid[0, 0].set_xlim(9e3, 2.2e6)
        for line, result in zip(grid, results):
            for panel, instant in zip(line, names):
                # Before contact there is no residue if the links follow their expansion.
                mine = [row for row in result.rows if row.instant == instant]
                panel.set_visible(any(abs(row.residue_over_thermal_work) > result.floor for row in mine))
                if not panel.get_visible():
                    continue
                _draw(panel, result, instant)
                panel.set_title(f"{result.variant.title}:\n{instant}", fontsize=8)
        for panel in grid[-1]:
            panel.set_xlabel("Steps per second [1/s]")
        for line in grid:
            shown = [panel for panel in line if panel.get_visible()]
            shown[0].set_ylabel("|residue| / largest thermal work [-]")
            shown[0].yaxis.set_tick_params(labelleft=True)
        for panel in grid[:, -1]:
            panel.legend(loc="upper right", framealpha=1, fontsize=7, handlelength=3.2)
        drawing.suptitle(f"{case.title}: energy account against steps (numbers: order, fitted)", fontsize=11)
        return save(drawing, folder, "energy")


def _draw(panel: Axes, result: Result, instant: str) -> None:
    panel.set_xscale("log")
    panel.set_yscale("log")
    for name, line in STYLES.items():
        mine = [row for row in result.rows if row.model == name and row.instant == instant and row.residue_J]
        if mine:
            panel.plot([row.steps_per_second for row in mine], [abs(row.residue_over_thermal_work) for row in mine],
                       marker=MARKERS[instant], markersize=7 if name == "reduced" else 4, **line)
            if mine[0].fit is not None:
                which, place, side = LABELS[name]
                panel.annotate(
                    f"{mine[0].fit:.1f}", (mine[which].steps_per_second, abs(mine[which].residue_over_thermal_work)),
                    xytext=place, textcoords="offset points", ha=side, va="center", fontsize=8, color="#0072B2",
                )
    panel.axhline(result.floor, color="0.5", linewidth=1.0, linestyle=":", label="rounding")
    panel.margins(y=0.12)


def write(case: UmbrellaCase, results: Sequence[Result], command: str, folder: Path) -> list[Path]:
    """Write ``energy.csv`` and ``energy.md``.

    :param command: command that writes these files
    """
    table = write_rows(folder / "energy.csv", [asdict(row) for result in results for row in result.rows],
                       [field.name for field in fields(Row)])
    lines = [f"# Energy account against steps: {case.title}", "", f"Made by `{command}`.", "", EXPLANATION]
    if case.period_s > LONGEST_PERIOD_s:
        lines += [f"The period is {LONGEST_PERIOD_s:g} s here instead of the case's {case.period_s:g} s.", ""]
    header = ("model", "instant", "steps/s", "tolerance", "residue [J]", "over thermal work", "order", "fit",
              "expected")
    for number, result in enumerate(results):
        variant = result.variant
        lines += [
            *([""] if number else []), f"## {variant.title}", "",
            f"Largest thermal work {result.thermal_work_J:.4e} J, dissipation {result.dissipation_J:.4e} J, "
            f"rounding {rounding_J(variant.case):.1e} J, corner {corner_W(variant.case):.3e} W times the step.", "",
            *markdown(header, map(_cells, result.rows)),
        ]
    return [write_markdown(folder / "energy.md", lines), table]


def _cells(row: Row) -> list[str]:
    tolerance, order, fit = (
        "" if value is None else f"{value:{form}}"
        for value, form in ((row.tolerance, ".0e"), (row.order, ".2f"), (row.fit, ".2f"))
    )
    return [row.model, row.instant, f"{row.steps_per_second:.0f}", tolerance, f"{row.residue_J:.3e}",
            f"{row.residue_over_thermal_work:.3e}", order, fit, EXPECTED.get((row.variant, row.model), "")]


@dataclass(frozen=True)
class Accounts:
    """The accounts of all variants, and the files that were written."""

    results: Sequence[Result]
    written: list[Path]

    def summary_lines(self) -> list[str]:
        """Return the lines that a command prints."""
        lines = []
        for result in self.results:
            fits = {(row.model, row.instant): row.fit for row in result.rows if row.fit is not None}
            lines += [
                f"{result.variant.title}: {name}, {instant}: residue of order {fit:.2f}"
                for (name, instant), fit in fits.items()
            ]
        return lines


def make(case: UmbrellaCase, results: Results, on_progress: OnProgress) -> Accounts:
    """Run all variants of a case and write figure and tables.

    :param results: root of the results; gets a folder named after the case
    :param on_progress: receives the finished fraction, 0 to 1
    :raises NotAllowed: the study does not support the case
    """
    chosen = variants(case)
    with results.folder(case.name, case) as folder:
        found = study(chosen, on_progress)
        written = write(case, found, made_by("energy", case), folder.staged) + figure(case, found, folder.staged)
        return Accounts(found, folder.publish(written))
