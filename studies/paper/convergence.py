# SPDX-License-Identifier: GPL-3.0-or-later
"""Convergence of the DEM to the reduced model for slower cycles and shorter time steps."""
from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from statejump.core import physics
from statejump.core.errors import Interrupted
from statejump.core.progress import OnProgress, one_of
from statejump.core.run import Run
from statejump.core.tables import markdown, write_rows, write_markdown
from statejump.core.units import plain
from statejump.kinds.spring_slider import KIND, compare, dem, reduced, stable_step
from statejump.kinds.spring_slider.case import SpringSliderCase
from studies.paper.common import made_by

PERIOD_FACTORS = (1 / 256, 1 / 64, 1 / 16, 1 / 4, 1, 4)
# Time steps are compared on a fast cycle, because its motion is not quasi-static and depends on them. It has few
# samples, because the number of steps is a multiple of theirs.
STEP_PERIOD_FACTOR = 1 / 16
STEP_SAMPLES = 50
STEP_FRACTIONS = (0.8, 0.4, 0.2, 0.1, 0.05, 0.025)


@dataclass(frozen=True)
class Row:
    """One DEM run against the exact path."""

    period_s: float
    time_step_s: float
    time_step_over_stable: float
    state_jump_m: float
    state_jump_error_relative: float
    first_slip_error_K: float
    stop_reached_error_K: float
    stop_left_error_K: float
    displacement_rms_over_largest: float
    energy_residual_over_friction_work: float
    displacement_rms_from_finest_step_m: float = math.nan


@dataclass(frozen=True)
class Convergence:
    """Runs of a case with slower cycles, then with shorter steps."""

    case: SpringSliderCase
    slower: tuple[Row, ...]  # the period grows
    finer: tuple[Row, ...]  # the time step falls
    decades: int = 0  # further than usual

    @property
    def rows(self) -> tuple[Row, ...]:
        """All runs."""
        return (*self.slower, *self.finer)

    def write(self, folder: Path) -> list[Path]:
        """Write ``convergence.csv`` and ``convergence.md``."""
        entries = [asdict(row) for row in self.rows]
        shown = [["" if math.isnan(value) else f"{value:.4g}" for value in entry.values()] for entry in entries]
        command = "convergence" + (f" --decades {self.decades}" if self.decades else "")
        lines = [
            f"# DEM against reduced model: {self.case.title}", "",
            f"Made by `{made_by(command, self.case)}`.", "",
            *markdown(list(entries[0]), shown), "", *explanation(self),
        ]
        return [write_rows(folder / "convergence.csv", entries), write_markdown(folder / "convergence.md", lines)]


def _variant(case: SpringSliderCase, factor: float, **settings: Any) -> SpringSliderCase:
    """Return the case with ``factor`` times its cycle duration, and with a time step as a fraction of the stable step.
    """
    changes = {f"dem.{key}": value for key, value in settings.items()} | {"dem.time_step_s": None}
    times = case.thermal.table_time_s
    if times is None:
        changes["thermal.period_s"] = case.period_s * factor
    else:  # the duration of a table is its last time
        period = None if case.ending is None else case.period_s * factor
        changes |= {"thermal.period_s": period, "thermal.table_time_s": [time * factor for time in times]}
    changed = case.changed(changes)
    assert isinstance(changed, SpringSliderCase)
    return changed


def _further(values: Sequence[float], decades: int) -> list[float]:
    """Return further values in the same direction, one per decade."""
    direction = 1 if values[-1] > values[0] else -1
    return [*values, *(values[-1] * 10.0**(direction * decade) for decade in range(1, decades + 1))]


def variants(case: SpringSliderCase, decades: int = 0) -> tuple[list[SpringSliderCase], list[SpringSliderCase]]:
    """Return the cases to run: each period with the time step of the case, and each time step on a fast cycle."""
    return (
        [_variant(case, factor) for factor in _further(PERIOD_FACTORS, decades)],
        [_variant(case, STEP_PERIOD_FACTOR, samples_per_cycle=STEP_SAMPLES, time_step_fraction=fraction)
         for fraction in _further(STEP_FRACTIONS, decades)],
    )


def convergence(case: SpringSliderCase, on_progress: OnProgress = lambda share: None, decades: int = 0) -> Convergence:
    """Run the DEM with slower cycles, then with shorter steps.

    :param decades: decades of slowness beyond the default, 0 to 3; every decade takes ten times as long
    :param on_progress: called with the finished fraction, 0 to 1
    :raises StatejumpError: a run failed
    """
    case.need_jump("'statejump convergence'")
    slower, finer = variants(case, decades)
    every = [*slower, *finer]
    runs: list[Run] = []
    for place, variant in enumerate(every):
        try:
            runs.append(KIND.dem(variant, one_of(on_progress, place, len(every))))
        except Interrupted:
            raise Interrupted(code="table_interrupted") from None
    found = compared(case, (slower, finer), (runs[: len(slower)], runs[len(slower) :]))
    return replace(found, decades=decades)


def compared(
    case: SpringSliderCase, cases: tuple[Sequence[SpringSliderCase], Sequence[SpringSliderCase]],
    runs: tuple[Sequence[Run], Sequence[Run]],
) -> Convergence:
    """Return the errors of the runs of :func:`variants`; the last run has the smallest time step."""
    slower = tuple(_row(variant, run) for variant, run in zip(cases[0], runs[0], strict=True))
    finest = runs[1][-1]["displacement_m"]
    finer = []
    for variant, run in zip(cases[1], runs[1], strict=True):
        rms = float(np.sqrt(np.mean((run["displacement_m"] - finest) ** 2)))
        # Events are accurate to half a sample, and these runs have few samples.
        finer.append(replace(
            _row(variant, run), first_slip_error_K=math.nan, stop_reached_error_K=math.nan, stop_left_error_K=math.nan,
            displacement_rms_from_finest_step_m=math.nan if run is runs[1][-1] else rms,
        ))
    return Convergence(case, slower, tuple(finer))


def _row(case: SpringSliderCase, run: Run) -> Row:
    """Errors of one run."""
    exact = reduced.run(case, lambda share: None)
    found = {entry.name: entry for entry in compare.compare(case, exact, run).rows}

    def difference(name: str) -> float:
        entry = found.get(name)
        return math.nan if entry is None or entry.difference is None else entry.difference

    jump = found["state_jump"]
    step = dem.time_step(case)
    return Row(
        period_s=case.period_s,
        time_step_s=step,
        time_step_over_stable=step / stable_step.stable_time_step(case),
        state_jump_m=jump.dem or 0.0,
        state_jump_error_relative=(jump.difference or 0.0) / jump.reduced if jump.reduced else math.nan,
        first_slip_error_K=difference("first_slip_temperature_change"),
        stop_reached_error_K=difference("stop_reached_temperature_change"),
        stop_left_error_K=difference("stop_left_temperature_change"),
        displacement_rms_over_largest=difference("displacement_rms_over_largest"),
        energy_residual_over_friction_work=difference("energy_residual_over_friction_work"),
    )


def explanation(found: Convergence) -> list[str]:
    """Return lines that explain the numbers: errors decrease with slower cycles and shorter steps, up to a remaining
    error."""
    return ["First the duration of the cycle, then the time step (on a fast cycle, where it matters most).", "",
            *_of_cycles(found.slower), *_of_steps(found), "", *_what_stays(found)]


def _of_cycles(rows: Sequence[Row]) -> list[str]:
    fastest, slowest = rows[0], rows[-1]
    ends = [plain(row.period_s, "s", 4) for row in (fastest, slowest)]
    lines = [f"From cycles of {ends[0]} to cycles of {ends[1]}, by size:"]
    quantities = (
        ("relative error of the jump", "state_jump_error_relative"),
        ("energy residue over the work of friction", "energy_residual_over_friction_work"),
        ("RMS distance over the largest displacement", "displacement_rms_over_largest"),
    )
    for label, name in quantities:
        first, last = (abs(getattr(row, name)) for row in (fastest, slowest))
        if math.isnan(first) or math.isnan(last):
            continue
        verdict = "falls" if last < first else "does not fall"
        lines.append(f"- the {label} {verdict}, {first:.2g} to {last:.2g};")
    lines[-1] = lines[-1].removesuffix(";") + "."
    return [*lines, "", "Inertia and damping forces fall with slower cycles; what they cause falls with them.", ""]


def _of_steps(found: Convergence) -> list[str]:
    largest = float(np.max(np.abs(reduced.run(found.case, lambda share: None)["displacement_m"])))
    rows = [row for row in found.finer if row.displacement_rms_from_finest_step_m > 0]
    if len(rows) < 2 or not largest > 0:
        return ["The time step makes no difference to the displacement."]
    coarse, fine = rows[0], rows[-1]
    steps = math.log(coarse.time_step_s / fine.time_step_s)
    order = math.log(coarse.displacement_rms_from_finest_step_m / fine.displacement_rms_from_finest_step_m) / steps
    return [
        "The last column is the RMS distance of the displacement from that of the finest time step. Slip and impact",
        "begin at a step, dashpots see the velocity of half a step before: first order is expected, the distance falls",
        f"with the power {order:.2g} of the step. At {coarse.time_step_over_stable:.2g} of the stable step it is "
        f"{coarse.displacement_rms_from_finest_step_m / largest:.1g} of the largest displacement.",
    ]


def _what_stays(found: Convergence) -> list[str]:
    case, slowest = found.case, found.slower[-1]
    link, joint = case.link, case.joint
    hertz = physics.hertz_stiffness_N_per_m15(
        physics.effective_young_modulus_Pa(joint.young_modulus_Pa, joint.poisson_ratio), joint.pad_radius_m)
    depth = physics.hertz_depth_m(joint.normal_force_N, hertz)
    lines = ["What stays is elasticity and geometry that the reduced model does not have:", ""]
    rate = abs(case.thermal_expansion_per_K) * link.stress_free_length_m
    if case.friction_force_N > 0 and rate > 0:
        slide = case.friction_force_N / stable_step.contact_stiffness(case, joint.normal_force_N)[1]
        late = slowest.first_slip_error_K
        seen = f" ({plain(late, 'K', 2)} in the slowest cycle, where events are known to half a sample)"
        lines.append(
            "- the tangential stiffness k_t of the floor contact delays the first slip by f/k_t = "
            f"{plain(slide, 'm', 2)}, {plain(slide / rate, 'K', 2)} of thermal displacement"
            f"{'' if math.isnan(late) else seen};")
    push = stable_step.largest_stop_force(case)
    soft = joint.stop_stiffness_N_per_m is not None
    if push > 0 and not soft and not math.isnan(slowest.stop_reached_error_K):
        lines.append(f"- the Hertz stiffness of the stop lets the slider sink in, by up to "
                     f"{plain(physics.hertz_depth_m(push, hertz), 'm', 2)}; the RMS difference of the slowest cycle is "
                     f"{slowest.displacement_rms_over_largest:.2g} of the largest displacement;")
    jump = abs(reduced.quick(case).summary["state_jump_m"])
    tilt = f"- the slider sinks into the floor by δ = {plain(depth, 'm', 2)}, so the bar is inclined by δ/l0"
    if jump > 0:
        expected = -(joint.friction_coefficient * depth + depth**2 / (2 * jump)) / link.stress_free_length_m
        tilt += (f". That takes f δ/l0 off the normal force and δ²/(2 l0) off the projected length, together "
                 f"{expected:.2g} of the jump; the error of the slowest cycle is "
                 f"{slowest.state_jump_error_relative:.2g}")
    return [*lines, tilt + "."]
