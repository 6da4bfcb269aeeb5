# SPDX-License-Identifier: GPL-3.0-or-later
"""Jump of both dynamic models compared with the quasi-static path, for slower and slower cycles: ``statejump slow``."""
from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, fields
from pathlib import Path

from statejump import _engine, laws
from statejump.core.figures import DEM, REDUCED, panels, save, style
from statejump.core.results_folder import Results
from statejump.core.progress import OnProgress, counted
from statejump.core.run import Run
from statejump.core.tables import markdown, write_rows, write_markdown
from statejump.kinds.umbrella import reduced as model
from statejump.kinds.umbrella.case import UmbrellaCase
from studies.paper.common import made_by, refused
from studies.paper.slow_statics import ANGLES, lag, lag_at_parting, quasi_static
from statejump.schema.paths import with_values
from studies.paper import ensembles

STEPS_PER_SECOND = 100_000
SAMPLES = 100  # only the ends of the histories are used
REDUCED_PERIODS_s = (1, 2, 4, 8, 16, 32, 64, 128)
DEM_PERIODS_s = (1, 2, 4, 8, 16, 32)
DEM_PERIODS_OF_VARIANTS_s = (1, 2, 4, 8, 16)
RAISED = 10  # factor on pin damping and spring in the variants

EXPLANATION = """\
`difference` is the jump less that of the quasi-static path with elastic links, Hertz's contact and
Mindlin's friction (`elastic_loop`); `order` is log2 of the difference at half the period over that at
the period, of no meaning while a swing is left in the difference (below).

- **1/T.** The program ends at a finite rate, so the links still turn when it ends. The pins' couples
  c_p dθ/dt tilt the joint force F by c_p (dθ2/dt + dθ4/dt)/(F |AC|), and with it the place in the play
  where friction is at its limit: that is a lag in proportion to c_p and to 1/T. `predicted` solves the
  equilibrium of the sliding joint with these couples, at the quasi-static rates of the end. The lag
  of the axial dashpots is smaller by the links' stiffness.
- **Faster than 1/T at first.** The slide begins as a swing of both links under F; it dies out in the
  time I/c_p of the links, so what is left of it falls exponentially with T. As soon as it is below the
  lag, the 1/T shows; with ten times the pin damping that is so from the first period.
- **Without friction** the quasi-static jump is zero and the lag is the whole jump. The bias keeps the
  contact force far from vanishing, so it falls as 1/T as well.
- **Where the contact force vanishes while the joint slides** (free spring at the ideal position) the
  lag is c_p/F and the joint cannot follow in the last moments before it parts. With F = F' |dT/dt| τ, τ
  before the parting, it lags by a Gaussian integral that falls only as 1/sqrt(T):
  g (r2 + r4)/2 sqrt(π c_p |dT/dt|/(c F')), with r = dθ/dΔT, g = dθ/dφ. There is no friction and no
  quasi-static jump in it: a single slow run is not to be trusted, extrapolate.
"""


Lags = tuple[float | None, float | None]  # of theta2 and theta4 [rad]


@dataclass(frozen=True)
class Block:
    """One variant of the case and the limit of its jumps."""

    name: str
    title: str
    case: UmbrellaCase
    dem_periods_s: tuple[float, ...]
    quasi_static_rad: tuple[float, float]  # jumps of theta2 and theta4
    rigid_rad: tuple[float, float]  # the same with rigid links
    predicted_order: float
    predict: Callable[[float], Lags]  # difference at a period


@dataclass(frozen=True)
class Row:
    """One run against the quasi-static path."""

    block: str
    model: str
    period_s: float
    theta2_jump_rad: float
    theta4_jump_rad: float
    theta2_difference_rad: float
    theta4_difference_rad: float
    theta2_predicted_rad: float | None
    theta4_predicted_rad: float | None
    theta2_order: float | None = None
    theta4_order: float | None = None


def at_period(case: UmbrellaCase, period_s: float) -> UmbrellaCase:
    """Return the case with another period and unchanged time steps per second in both models."""
    steps = SAMPLES * math.ceil(period_s * STEPS_PER_SECOND / SAMPLES)
    return with_values(
        case,
        {
            "thermal.period_s": float(period_s),
            "output.samples_per_cycle": SAMPLES,
            "reduced.method": "rk4",
            "reduced.steps_per_cycle": steps,
            "dem.steps_per_cycle": steps,
        },
    )


def jumps(run: Run) -> tuple[float, float]:
    """Return the jump of theta2 and of theta4 [rad]."""
    first, second = (run.summary[f"{a}_jump_rad"] for a in ANGLES)
    return first, second


def _parts(case: UmbrellaCase) -> bool:
    """Return whether the temperature program closes the clearance, so that an unbiased joint is loaded and opens again.
    """
    if case.link_ab.thermal_expansion_per_K != case.link_bc.thermal_expansion_per_K:
        return False
    return model.linkage(case).first_contact_temperature_change() < case.temperature_range_K[1]


def check(case: UmbrellaCase) -> None:
    """:raises NotAllowed: the study does not fit the case"""
    for key, value, needed in (("start.mode", case.start.mode, "loaded"),
                               ("thermal.shape", case.thermal.shape, "triangle")):
        if value != needed:
            raise refused(case, key, value, f"'statejump slow' needs {needed!r}")
    if not laws.law("friction", case.joint.friction_law).holds_static_load:
        holding = " or ".join(repr(law.name) for law in laws.catalogue("friction") if law.holds_static_load)
        raise refused(case, "joint.friction_law", case.joint.friction_law,
                      f"'statejump slow' needs friction that holds a static load, {holding}")
    for key in ("damping.axial_damping_ratio", "damping.pin_damping_N_m_s_per_rad"):
        if not case[key] > 0:
            raise refused(case, key, case[key],
                          "must be above 0: without damping the motion does not become quasi-static")


def _lag_of(case: UmbrellaCase, loop: _engine.ElasticLoop) -> Callable[[float], Lags]:
    return lambda period: lag(at_period(case, period), loop)


def blocks(case: UmbrellaCase) -> list[Block]:
    """Return the variants of the case that the study runs."""
    check(case)
    pin, spring = case.damping.pin_damping_N_m_s_per_rad, case.torsion_spring.stiffness_N_m_per_rad
    damped = with_values(case, {"damping.pin_damping_N_m_s_per_rad": RAISED * pin})
    smooth = with_values(case, {"joint.friction_law": "none", "start.contact_angle_rad": 0.0})
    unloaded = with_values(
        smooth,
        {
            "torsion_spring.bias_rad": 0.0,
            "torsion_spring.stiffness_N_m_per_rad": RAISED * spring,
            "damping.pin_damping_N_m_s_per_rad": RAISED * pin,
            "start.mode": "matched",
        },
    )
    result = []
    for name, title, variant, periods in (
        ("case", "the case", case, DEM_PERIODS_s),
        ("pin_damping", f"{RAISED} times the pin damping", damped, DEM_PERIODS_OF_VARIANTS_s),
        ("frictionless", "without friction", smooth, DEM_PERIODS_OF_VARIANTS_s),
    ):
        loop = quasi_static(variant)
        rigid = model.quasi_static(variant)
        result.append(Block(
            name, title, variant, periods,
            (loop.theta2_jump_rad, loop.theta4_jump_rad),
            (rigid.theta2_jump_rad, rigid.theta4_jump_rad) if rigid else (math.nan, math.nan),
            1.0,
            _lag_of(variant, loop),
        ))
    if _parts(unloaded):
        result.append(Block(
            "unloaded", f"no bias, no friction, {RAISED} times spring and pin damping", unloaded,
            DEM_PERIODS_OF_VARIANTS_s, (0.0, 0.0), (0.0, 0.0), 0.5,
            lambda period: lag_at_parting(at_period(unloaded, period)),
        ))
    return result


def _rows_of(block: Block, name: str, periods: Sequence[float], found: Sequence[tuple[float, float]]) -> list[Row]:
    result: list[Row] = []
    for period, jump in zip(periods, found):
        difference = [jump[i] - block.quasi_static_rad[i] for i in range(2)]
        order: list[float | None] = [None, None]
        if result and period == 2 * result[-1].period_s:
            before = (result[-1].theta2_difference_rad, result[-1].theta4_difference_rad)
            order = [
                math.log2(abs(before[i] / difference[i])) if before[i] and difference[i] else None for i in range(2)
            ]
        theta2, theta4 = block.predict(period)
        result.append(Row(block.name, name, float(period), jump[0], jump[1], difference[0], difference[1],
                          theta2, theta4, order[0], order[1]))
    return result


def study(
    chosen: Sequence[Block], on_progress: OnProgress, reduced_periods_s: Sequence[float] = REDUCED_PERIODS_s
) -> list[Row]:
    """Run every block (a variant with its periods) in both models. The longest DEM runs start first, one per core."""
    pairs = [(block, period) for block in chosen for period in block.dem_periods_s]
    pairs.sort(key=lambda pair: -pair[1])
    total = sum(len(block.dem_periods_s) for block in chosen) + len(chosen) * len(reduced_periods_s)
    finished = counted(on_progress, total)
    rows: list[Row] = []
    for block in chosen:
        found = []
        for period in reduced_periods_s:
            found.append(jumps(model.run(at_period(block.case, period))))
            finished()
        rows += _rows_of(block, "reduced", reduced_periods_s, found)
    runs = ensembles.execute_all([at_period(block.case, period) for block, period in pairs], finished)
    of_run = {(block.name, period): jumps(run) for (block, period), run in zip(pairs, runs)}
    for block in chosen:
        periods = block.dem_periods_s
        rows += _rows_of(block, "DEM", periods, [of_run[block.name, period] for period in periods])
    return rows


def figure(case: UmbrellaCase, chosen: Sequence[Block], rows: Sequence[Row], folder: Path) -> list[Path]:
    """Write ``slow.png`` and ``slow.svg``: distance of the jumps from the quasi-static jump, over the period."""
    with style():
        drawing, grid = panels(2, 2, (9.5, 7.4), sharex=True, squeeze=False)
        places = list(grid.flat)
        for panel in places[len(chosen):]:
            panel.set_visible(False)
        for panel, block in zip(places, chosen):
            for name, line in (("reduced", {**REDUCED, "label": "reduced model", "marker": "o", "markersize": 8}),
                               ("DEM", {**DEM, "marker": "s", "markersize": 4})):
                mine = [row for row in rows if row.block == block.name and row.model == name]
                panel.plot([row.period_s for row in mine], [abs(row.theta2_difference_rad) for row in mine], **line)
            lags = {
                row.period_s: abs(row.theta2_predicted_rad)
                for row in rows if row.block == block.name and row.theta2_predicted_rad
            }
            if lags:
                law = "1/T" if block.predicted_order == 1 else "1/√T"
                panel.plot(*zip(*sorted(lags.items())), color="#0072B2", linewidth=1.6, linestyle=(0, (1, 1.5)),
                           zorder=4, label=f"predicted, {law}")
            panel.set_xscale("log", base=2)
            panel.set_yscale("log")
            ticks = sorted({row.period_s for row in rows})
            panel.set_xticks(ticks, [f"{tick:g}" for tick in ticks])
            panel.set_title(block.title, fontsize=9)
            panel.legend(loc="upper right", framealpha=1, fontsize=8, handlelength=3.2)
            panel.set_ylabel("|θ2 jump − quasi-static| [rad]")
            panel.set_xlabel("Period T [s]")
            panel.xaxis.set_tick_params(labelbottom=True)
        drawing.suptitle(f"{case.title}: slow heating against statics", fontsize=11)
        return save(drawing, folder, "slow")


def _cell(value: float | None, form: str) -> str:
    return "" if value is None or not math.isfinite(value) else f"{value:{form}}"


def write(
    case: UmbrellaCase, chosen: Sequence[Block], rows: Sequence[Row], command: str, folder: Path
) -> list[Path]:
    """Write ``slow.csv`` and ``slow.md``.

    :param command: command that writes these files
    """
    table = write_rows(folder / "slow.csv", [asdict(row) for row in rows], [field.name for field in fields(Row)])
    lines = [
        f"# Slow heating against statics: {case.title}", "",
        f"Made by `{command}`; {STEPS_PER_SECOND} steps per second in both models.", "",
        EXPLANATION,
    ]
    for number, block in enumerate(chosen):
        lines += [*([""] if number else []), f"## {block.title[0].upper()}{block.title[1:]}", ""]
        for name, values in (("elastic", block.quasi_static_rad), ("rigid links", block.rigid_rad)):
            lines.append(f"- quasi-static, {name}: θ2 {values[0]:.9e} rad, θ4 {values[1]:.9e} rad")
        lines += ["", *markdown(HEADER, [_cells(row) for row in rows if row.block == block.name]), "",
                  closing(block, rows)]
    return [write_markdown(folder / "slow.md", lines), table]


HEADER = ("model", "T [s]", "θ2 jump [rad]", "difference", "predicted", "order", "θ4 jump [rad]", "difference",
          "predicted", "order")


def _cells(row: Row) -> list[str]:
    entry = asdict(row)
    cells = [row.model, f"{row.period_s:g}"]
    for angle in ANGLES:
        cells += [
            _cell(entry[f"{angle}_jump_rad"], ".9e"), _cell(entry[f"{angle}_difference_rad"], ".3e"),
            _cell(entry[f"{angle}_predicted_rad"], ".3e"), _cell(entry[f"{angle}_order"], ".2f"),
        ]
    return cells


def closing(block: Block, rows: Sequence[Row]) -> str:
    """Return a closing sentence: the largest distance between the models, and the slowest run."""
    mine = {(row.model, row.period_s): row for row in rows if row.block == block.name}
    both = [period for name, period in mine if name == "DEM"]
    apart = max(
        abs(mine["DEM", period].theta2_jump_rad - mine["reduced", period].theta2_jump_rad) for period in both
    )
    slowest = mine["reduced", max(period for name, period in mine if name == "reduced")]
    text = f"θ2 of both models differs by at most {apart:.1e} rad"
    if slowest.theta2_predicted_rad:
        text += (
            f"; the slowest run is {slowest.theta2_difference_rad / slowest.theta2_predicted_rad:.3f} times the "
            "predicted lag off the quasi-static jump"
        )
    return text + "."


@dataclass(frozen=True)
class Slow:
    """The runs of all variants, and the files that were written."""

    blocks: Sequence[Block]
    rows: Sequence[Row]
    written: list[Path]

    def summary_lines(self) -> list[str]:
        """Return the lines that a command prints."""
        return [f"{block.title}: {closing(block, self.rows)}" for block in self.blocks]


def make(case: UmbrellaCase, results: Results, on_progress: OnProgress) -> Slow:
    """Run all variants of a case in both models with slower and slower cycles; write figure and tables.

    :param results: root of the results; gets a folder named after the case
    :param on_progress: receives the finished fraction, 0 to 1
    :raises NotAllowed: the study does not support the case
    :raises FailedRun: equilibrium does not determine a unique path
    """
    chosen = blocks(case)
    with results.folder(case.name, case) as folder:
        rows = study(chosen, on_progress)
        staged = folder.staged
        written = write(case, chosen, rows, made_by("slow", case), staged) + figure(case, chosen, rows, staged)
        return Slow(chosen, rows, folder.publish(written))
