# SPDX-License-Identifier: GPL-3.0-or-later
"""``statejump slow``: the jump of both dynamics against the quasi-static path, ever slower cycles."""
from __future__ import annotations

import csv
import math
from dataclasses import asdict, dataclass, fields
from pathlib import Path
from typing import Any, Callable, Optional, Sequence

import click
import numpy as np

from statejump import _engine
from statejump.kinds.umbrella.case import UmbrellaCase
from statejump.core.errors import StatejumpError
from statejump.core.history import History
from statejump.core.output import results_folder, write_atomically
from statejump.kinds.spring_slider.figure import DEM, REDUCED, STYLE, plt, save
from statejump.cli.terminal import QUIET, RESULTS, counted, load_kind, make_console, undivided
from statejump.kinds.umbrella import dem, reduced as model

STEPS_PER_SECOND = 100_000
SAMPLES = 100  # only the ends of the histories are used
REDUCED_PERIODS_s = (1, 2, 4, 8, 16, 32, 64, 128)
DEM_PERIODS_s = (1, 2, 4, 8, 16, 32)
DEM_PERIODS_OF_VARIANTS_s = (1, 2, 4, 8, 16)
LOOP_SAMPLES = 2000  # per branch of the quasi-static path
RAISED = 10  # factor of the variants on pin damping and spring
ANGLES = ("theta2", "theta4")

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


@dataclass(frozen=True)
class Block:
    """One variant of the case, and what it tends to."""

    name: str
    title: str
    case: UmbrellaCase
    dem_periods_s: tuple[float, ...]
    quasi_static_rad: tuple[float, float]  # jumps of theta2 and theta4
    rigid_rad: tuple[float, float]  # the same with rigid links
    predicted_order: float
    predict: Callable[[float], tuple[Optional[float], Optional[float]]]  # difference at a period


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
    theta2_predicted_rad: Optional[float]
    theta4_predicted_rad: Optional[float]
    theta2_order: Optional[float] = None
    theta4_order: Optional[float] = None


def at_period(case: UmbrellaCase, period_s: float) -> UmbrellaCase:
    """Return the case with another period, the same steps per second in both models."""
    steps = SAMPLES * math.ceil(period_s * STEPS_PER_SECOND / SAMPLES)
    return model.changed(
        case,
        {
            "thermal.period_s": float(period_s),
            "output.samples_per_cycle": SAMPLES,
            "reduced.method": "rk4",
            "reduced.steps_per_cycle": steps,
            "dem.steps_per_cycle": steps,
        },
    )


def jumps(history: History) -> tuple[float, float]:
    """Jump of theta2 and of theta4 [rad]."""
    first, second = (float(history[f"{a}_rad"][-1] - history[f"{a}_rad"][0]) for a in ANGLES)
    return first, second


def quasi_static(case: UmbrellaCase) -> _engine.ElasticLoop:
    """Path that slow dynamics tends to. :raises StatejumpError: statics leaves it open"""
    try:
        loop = _engine.elastic_loop(
            model.linkage(case), model.thermal_program(case), case.start.contact_angle_rad, LOOP_SAMPLES,
            "mindlin",
        )
    except (ValueError, RuntimeError) as error:
        raise StatejumpError(f"case {case.name}: there is no quasi-static path: {error}") from None
    if loop.separated:
        where = loop.events[-1]["temperature_change_K"]
        raise StatejumpError(
            f"case {case.name}: the quasi-static path ends at a temperature change of {where:.6g} K, where "
            "the contact force vanishes: load the joint with a larger torsion_spring.bias_rad"
        )
    return loop


def _end_rate(case: UmbrellaCase) -> float:
    """Rate [K/s] with which the program ends."""
    program = model.thermal_program(case)
    return float(program.temperature_rate(program.duration_s * (1 - 1e-9)))


def _cross(a: np.ndarray, b: np.ndarray) -> float:
    return float(a[0] * b[1] - a[1] * b[0])


def equilibrium(
    case: UmbrellaCase, guess: dict[str, Any], couples_N_m: tuple[float, float]
) -> tuple[float, float]:
    """theta2 and theta4 [rad] of the sliding joint at ΔT = 0 with a couple on each link.

    :param guess: point of the elastic loop nearby; its F_t/F_N is kept
    """
    frame = np.array([case.frame.length_m, 0.0])
    links = (case.link_ab, case.link_bc)
    length = [link.stress_free_length_m for link in links]
    stiffness = [
        link.young_modulus_Pa * link.cross_section_area_m2 / link.stress_free_length_m for link in links
    ]
    hertz = float(
        _engine.normal_force(
            case.joint.normal_law, np.array([1.0]), case.joint.journal_radius_m, case.bearing_radius_m,
            case.joint.contact_length_m, case.effective_young_modulus_Pa,
        )["force_N"][0]
    )
    play = case.joint.radial_clearance_m
    normal = np.array([guess["eccentricity_x_m"], guess["eccentricity_y_m"]])
    normal /= np.linalg.norm(normal)
    normal_force, tangential_force = guess["normal_force_N"], guess["tangential_force_N"]
    start_force = normal_force * normal - tangential_force * np.array([-normal[1], normal[0]])
    angle = math.atan2(tangential_force, normal_force)  # from the force to the normal, kept in slip
    turn = np.array([[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]])

    def residual(x: np.ndarray) -> np.ndarray:
        u2, u4 = (np.array([math.cos(theta), math.sin(theta)]) for theta in x[:2])
        force = x[2:]  # on the bearing
        size = float(np.linalg.norm(force))
        n = turn @ force / size
        depth = (size * math.cos(angle) / hertz) ** (2 / 3)
        bearing = (length[0] + force @ u2 / stiffness[0]) * u2
        journal = (length[1] - force @ u4 / stiffness[1]) * u4
        contact = bearing + (case.bearing_radius_m + depth / 2) * n
        moment = case.torsion_spring.stiffness_N_m_per_rad * (x[1] - x[0] - case.free_flare_angle_rad)
        gap = (frame + journal - bearing - (play + depth) * n) / play
        return np.array([
            *gap,
            (_cross(contact, force) + moment + couples_N_m[0]) / (size * length[0]),
            (_cross(contact - frame, force) + moment - couples_N_m[1]) / (size * length[0]),
        ])

    x = np.array([guess["theta2_rad"], guess["theta4_rad"], *start_force])
    for _ in range(12):
        steps = np.array([1e-6, 1e-6, *(1e-6 * np.linalg.norm(x[2:]) for _ in range(2))])
        jacobian = np.column_stack([
            (residual(x + step * axis) - residual(x - step * axis)) / (2 * step)
            for step, axis in zip(steps, np.eye(4))
        ])
        x = x - np.linalg.solve(jacobian, residual(x))
    return float(x[0]), float(x[1])


def lag(case: UmbrellaCase, loop: _engine.ElasticLoop) -> tuple[Optional[float], Optional[float]]:
    """Predicted difference of both jumps [rad]: the pins' couples at the end of the program.

    None if the joint does not slide there: what it then keeps is decided earlier.
    """
    last = loop.events[-1]
    path = loop.columns()
    if not path["slipping"][-1]:
        return None, None
    span = path["temperature_change_K"][-1] - path["temperature_change_K"][-2]
    pin, rate = case.damping.pin_damping_N_m_s_per_rad, _end_rate(case)
    couples = [
        -pin * rate * (path[f"{a}_rad"][-1] - path[f"{a}_rad"][-2]) / span for a in ANGLES
    ]
    moved, still = equilibrium(case, last, (couples[0], couples[1])), equilibrium(case, last, (0.0, 0.0))
    return moved[0] - still[0], moved[1] - still[1]


def lag_at_parting(case: UmbrellaCase) -> tuple[float, float]:
    """Predicted false jump [rad] of a frictionless joint whose contact force vanishes as it slides."""
    linkage = model.linkage(case)
    parting = linkage.first_contact_temperature_change()

    def slope(change: float, angle: float) -> dict[str, float]:
        """Half the difference of the points at ± the steps."""
        up = _engine.joint_point(linkage, parting + change, -1, angle)
        down = _engine.joint_point(linkage, parting - change, -1, -angle)
        return {k: (up[k] - down[k]) / 2 for k in ("theta2_rad", "theta4_rad", "spring_moment_N_m")}

    by_angle, by_change = slope(0.0, 1e-5), slope(1e-3, 0.0)
    height = case.ideal_position_m[1]
    force_rate = abs(by_change["spring_moment_N_m"]) / 1e-3 / height  # F' [N/K]
    rates = (by_change["theta2_rad"] + by_change["theta4_rad"]) / 1e-3
    pin = case.damping.pin_damping_N_m_s_per_rad
    reach = math.sqrt(math.pi * pin * abs(_end_rate(case)) / (case.joint.radial_clearance_m * force_rate))
    return tuple(by_angle[f"{a}_rad"] / 1e-5 * rates / 2 * reach for a in ANGLES)  # type: ignore[return-value]


def _parts(case: UmbrellaCase) -> bool:
    """Whether the program uses up the play, so that an unbiased joint is loaded and parts again."""
    if case.link_ab.thermal_expansion_per_K != case.link_bc.thermal_expansion_per_K:
        return False
    return model.linkage(case).first_contact_temperature_change() < case.temperature_range_K[1]


def check(case: UmbrellaCase) -> None:
    """:raises StatejumpError: the study does not fit the case"""
    wanted = (("start.mode", case.start.mode, "loaded"), ("joint.friction_law", case.joint.friction_law, "mindlin"),
              ("thermal.shape", case.thermal.shape, "triangle"))
    for key, value, needed in wanted:
        if value != needed:
            raise StatejumpError(
                f"case {case.name}: {key} = {value!r} is not allowed: 'statejump slow' needs {needed!r}"
            )
    if not model.is_reproducible(case):
        raise StatejumpError(
            f"case {case.name}: damping.axial_damping_ratio and damping.pin_damping_N_m_s_per_rad must be above "
            "0: without damping the motion does not become quasi-static"
        )


def blocks(case: UmbrellaCase) -> list[Block]:
    """Return the variants of the case that the study runs."""
    check(case)
    pin, spring = case.damping.pin_damping_N_m_s_per_rad, case.torsion_spring.stiffness_N_m_per_rad
    damped = model.changed(case, {"damping.pin_damping_N_m_s_per_rad": RAISED * pin})
    smooth = model.changed(case, {"joint.friction_law": "none", "start.contact_angle_rad": 0.0})
    unloaded = model.changed(
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
            lambda period, variant=variant, loop=loop: lag(at_period(variant, period), loop),
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
        order: list[Optional[float]] = [None, None]
        if result and period == 2 * result[-1].period_s:
            before = (result[-1].theta2_difference_rad, result[-1].theta4_difference_rad)
            order = [
                math.log2(abs(before[i] / difference[i])) if before[i] and difference[i] else None for i in range(2)
            ]
        result.append(Row(block.name, name, float(period), *jump, *difference, *block.predict(period), *order))
    return result


def study(
    chosen: Sequence[Block], report: Callable[[float], None], reduced_periods_s: Sequence[float] = REDUCED_PERIODS_s
) -> list[Row]:
    """Run all blocks in both models; the longest DEM runs first, as many at a time as cores."""
    pairs = [(block, period) for block in chosen for period in block.dem_periods_s]
    pairs.sort(key=lambda pair: -pair[1])
    total = sum(len(block.dem_periods_s) for block in chosen) + len(chosen) * len(reduced_periods_s)
    finished = counted(report, total)
    rows: list[Row] = []
    for block in chosen:
        found = []
        for period in reduced_periods_s:
            found.append(jumps(model.run(at_period(block.case, period)).history))
            finished()
        rows += _rows_of(block, "reduced", reduced_periods_s, found)
    runs = dem.execute_all([at_period(block.case, period) for block, period in pairs], finished)
    of_run = {(block.name, period): jumps(run.history) for (block, period), run in zip(pairs, runs)}
    for block in chosen:
        periods = block.dem_periods_s
        rows += _rows_of(block, "DEM", periods, [of_run[block.name, period] for period in periods])
    return rows


def figure(case: UmbrellaCase, chosen: Sequence[Block], rows: Sequence[Row], folder: Path) -> list[Path]:
    """Write ``slow.png`` and ``slow.svg``: distance from the quasi-static jump against the period."""
    with plt.rc_context(STYLE):
        drawing, grid = plt.subplots(
            2, 2, figsize=(9.5, 7.4), constrained_layout=True, sharex=True, squeeze=False
        )
        panels = list(grid.flat)
        for panel in panels[len(chosen):]:
            panel.set_visible(False)
        for panel, block in zip(panels, chosen):
            for name, style in (("reduced", {**REDUCED, "label": "reduced model", "marker": "o", "markersize": 8}),
                                ("DEM", {**DEM, "marker": "s", "markersize": 4})):
                mine = [row for row in rows if row.block == block.name and row.model == name]
                panel.plot([row.period_s for row in mine], [abs(row.theta2_difference_rad) for row in mine], **style)
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


def _cell(value: Optional[float], form: str) -> str:
    return "" if value is None or not math.isfinite(value) else f"{value:{form}}"


def write(case: UmbrellaCase, chosen: Sequence[Block], rows: Sequence[Row], folder: Path) -> list[Path]:
    """Write ``slow.csv`` and ``slow.md``."""
    names = [field.name for field in fields(Row)]
    with write_atomically(folder / "slow.csv") as stream:
        writer = csv.DictWriter(stream, fieldnames=names)
        writer.writeheader()
        writer.writerows(asdict(row) for row in rows)
    lines = [
        f"# Slow heating against statics: {case.title}", "",
        f"Made by `statejump slow cases/{case.name}.toml`; {STEPS_PER_SECOND} steps per second in both models.", "",
        EXPLANATION,
    ]
    for block in chosen:
        lines += [f"## {block.title[0].upper()}{block.title[1:]}", ""]
        for name, values in (("elastic", block.quasi_static_rad), ("rigid links", block.rigid_rad)):
            lines.append(f"- quasi-static, {name}: θ2 {values[0]:.9e} rad, θ4 {values[1]:.9e} rad")
        lines += ["", "| model | T [s] | θ2 jump [rad] | difference | predicted | order "
                  "| θ4 jump [rad] | difference | predicted | order |", "|" + "---|" * 10]
        for row in rows:
            if row.block == block.name:
                cells = [row.model, f"{row.period_s:g}"]
                for angle in ANGLES:
                    entry = asdict(row)
                    cells += [
                        _cell(entry[f"{angle}_jump_rad"], ".9e"), _cell(entry[f"{angle}_difference_rad"], ".3e"),
                        _cell(entry[f"{angle}_predicted_rad"], ".3e"), _cell(entry[f"{angle}_order"], ".2f"),
                    ]
                lines.append("| " + " | ".join(cells) + " |")
        lines += ["", _closing(block, rows), ""]
    with write_atomically(folder / "slow.md") as stream:
        stream.write("\n".join(lines))
    return [folder / "slow.md", folder / "slow.csv"]


def _closing(block: Block, rows: Sequence[Row]) -> str:
    """One sentence on the largest distance between the models and the slowest run."""
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


@click.command("slow")
@click.argument(
    "case_file", metavar="[CASE]", default="cases/umbrella_bias.toml", type=click.Path(path_type=Path)
)
@RESULTS
@QUIET
def slow_command(case_file: Path, results: Path, quiet: bool) -> None:
    """Jump of both models of CASE against the quasi-static path, for slower and slower cycles.

    \b
    Example:
      statejump slow cases/umbrella_bias.toml
    """
    console = make_console(quiet)
    case = load_kind(case_file, UmbrellaCase)
    chosen = blocks(case)
    folder = results_folder(results, case.name)
    with undivided(console, "runs") as tell:
        rows = study(chosen, tell)
    written = write(case, chosen, rows, folder) + figure(case, chosen, rows, folder)
    for block in chosen:
        console.print(f"{block.title}: {_closing(block, rows)}")
    console.print(f"results: {', '.join(str(name) for name in written)}")
