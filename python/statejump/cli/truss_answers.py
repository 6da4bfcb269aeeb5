# SPDX-License-Identifier: GPL-3.0-or-later
"""``statejump truss answers``: jumps, verdict, ranking of joints, surface, energy, sensitivities."""
from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any, Optional

import click
import numpy as np

from statejump.core import units
from statejump.kinds.truss.case import TrussCase
from statejump.core.errors import Interrupted, StatejumpError
from statejump.core.output import results_folder, write_atomically
from statejump.kinds.truss import result as kind_truss
from statejump.results.contents import Answers, Scalar
from statejump.results.record import Record, case_text
from statejump.cli.terminal import CASE, QUIET, RESULTS, load_kind, make_console, progress
from statejump.kinds.truss.answers import answers, reflector
from statejump.kinds.truss.answers.answers import Contributions, Output, Verdict
from statejump.kinds.truss.resolved import ResolvedTruss
from statejump.kinds.truss.answers.sensitivity import STEP, Sensitivity, sensitivities
from statejump.kinds.truss.solve import TrussPath

NO_JUMP = 1e-9  # of the largest jump of a node: what is smaller is rounding
RESOLVED = 0.01  # of the jump: what twice the increments may change
MOST_ROWS = 15  # of a table in answers.md
MOST_SAMPLES = 1000  # of the path in the result file; every cycle has at least its ends

Row = dict[str, Any]


def cycle_rows(checked: Verdict) -> list[Row]:
    """Return what happens over each cycle."""
    return [
        {"cycle": cycle, "largest_jump_m": float(jump), "dissipation_J": float(heat)}
        for cycle, (jump, heat) in enumerate(zip(checked.cycle_jump_m, checked.dissipation_J), start=1)
    ]


def node_rows(found: TrussPath) -> list[Row]:
    """Return the jump of every node after each cycle."""
    return [
        {"node": name, "cycle": cycle, **{f"jump_{axis}_m": float(value) for axis, value in zip("xyz", jump)},
         "jump_m": float(np.linalg.norm(jump))}
        for cycle, jumps in enumerate(answers.node_jumps(found), start=1)
        for name, jump in zip(found.truss.nodes.names, jumps)
    ]


def joint_rows(found: TrussPath) -> list[Row]:
    """Return slide or eccentricity, its jump and the heat of every joint after each cycle."""
    ends, truss = found.cycle_ends, found.truss
    rows = []
    for cycle in range(1, len(ends["time_s"])):
        for kind, names, place, heat in (
            ("slider", truss.sliders.names, ends["slide_m"][..., None] * truss.sliders.axis, ends["slider_dissipation_J"]),
            ("revolute", truss.revolutes.names, ends["eccentricity_m"], ends["revolute_dissipation_J"]),
        ):
            for index, name in enumerate(names):
                jump = place[cycle, index] - place[0, index]
                rows.append({
                    "joint": name, "kind": kind, "cycle": cycle,
                    **{f"jump_{axis}_m": float(value) for axis, value in zip("xyz", jump)},
                    "jump_m": float(np.linalg.norm(jump)),
                    "dissipation_of_cycle_J": float(heat[cycle, index] - heat[cycle - 1, index]),
                    "dissipation_J": float(heat[cycle, index]),
                })
    return rows


def surface_rows(found: TrussPath, surface: reflector.Surface) -> list[Row]:
    """Return the best fit at the start, at the hottest point and after every cycle."""
    states, ends = found.states, found.cycle_ends
    hottest = int(np.argmax(states["temperature_change_K"]))
    asked = [("start", 0.0, ends["displacement_m"][0]),
             ("hottest", float(states["temperature_change_K"][hottest]), states["displacement_m"][hottest])]
    asked += [(f"after cycle {cycle}", float(ends["temperature_change_K"][cycle]), ends["displacement_m"][cycle])
              for cycle in range(1, len(ends["time_s"]))]
    start = surface.fit(ends["displacement_m"][0])
    rows = []
    for when, change, moved in asked:
        fit = surface.fit(moved)
        shift = None if fit.focal_length_m is None or start.focal_length_m is None else (
            fit.focal_length_m - start.focal_length_m)
        rows.append({
            "state": when, "temperature_change_K": change, "rms_error_m": fit.rms_error_m,
            "rms_of_change_m": float(np.sqrt(np.mean((fit.residual_m - start.residual_m) ** 2))),
            "tilt_change_rad": float(np.linalg.norm(fit.tilt_rad - start.tilt_rad)),
            "focal_length_m": fit.focal_length_m, "focal_shift_m": shift,
            "depth_change_m": fit.depth_m - start.depth_m,
        })
    return rows


def contribution_rows(shares: Contributions) -> list[Row]:
    """Return the joints by rank."""
    return [
        {"rank": rank, "joint": shares.names[joint], "kind": shares.kinds[joint],
         "contribution": float(shares.contribution[joint]), "share": float(shares.contribution[joint] / shares.jump)}
        for rank, joint in enumerate(shares.order, start=1)
    ]


def sensitivity_rows(found: list[Sensitivity], jump: float) -> list[Row]:
    """Return the sensitivities; ``elasticity``: relative change of the jump per relative change."""
    return [
        {"parameter": row.parameter, "items": row.items, "value": row.value,
         "elasticity": _known(row.per_relative_change / jump), "elasticity_half_step": _known(row.half_step / jump),
         "jump_change_per_unit": _known(row.per_unit), "verdict": row.verdict}
        for row in found
    ]


def _known(value: Optional[float]) -> Optional[float]:
    return None if value is None or math.isnan(value) else value


def _cell(value: Any) -> str:
    if value is None:
        return "–"
    return f"{value:.5g}" if isinstance(value, float) else str(value)


def _table(rows: list[Row], most: int = MOST_ROWS, file: str = "") -> str:
    if not rows:
        return "None.\n"
    heads = list(rows[0])
    lines = ["| " + " | ".join(heads) + " |",
             "|" + "|".join("---" if isinstance(rows[0][head], str) else "--:" for head in heads) + "|"]
    lines += ["| " + " | ".join(_cell(value) for value in row.values()) + " |" for row in rows[:most]]
    return "\n".join(lines) + "\n" + (f"\n{len(rows) - most} more in `{file}`.\n" if len(rows) > most else "")


def _markdown(case: TrussCase, output: Output, jump: float, checked: Verdict, tables: dict[str, list[Row]],
              shares: Optional[Contributions], notes: list[str]) -> str:
    cycles = len(checked.cycle_jump_m)
    last = [row for row in tables["node_jumps"] if row["cycle"] == cycles]
    last.sort(key=lambda row: -row["jump_m"])
    joints = [row for row in tables["joint_jumps"] if row["cycle"] == cycles]
    joints.sort(key=lambda row: -row["dissipation_J"])
    text = f"""# {case.title or case.name}

Made by `statejump truss answers`: quasi-static path of {cycles} cycle{'s' if cycles > 1 else ''}; jumps are
displacements at the end of a cycle less those at the start.

- **Output**: {output.text}; its jump is {units.plain(jump, output.unit)}.
- **Over the cycles**: {checked.text}.
- **Heat of friction**: {checked.dissipation_J.sum():.5g} J, {checked.dissipation_J[-1]:.5g} J of it in the last cycle.
"""
    text += "".join(f"- {note[0].upper() + note[1:]}.\n" for note in notes)
    text += "\n## Nodes that jump most\n\n" + _table(last, 8, "node_jumps.csv")
    if shares is not None:
        text += f"""
## Joints that hold the jump

Contribution of a joint: effect on the output of the friction force that it holds, on the truss with
frictionless joints, mean of alone and as the last of all. Their sum differs from the jump by
{shares.sum_error:.2g} of it: it is exact where the truss is linear. All friction forces together on the
frictionless truss give the jump back to {abs(shares.reproduced / shares.jump - 1):.2g} of it.

""" + _table(tables["contributions"], MOST_ROWS, "contributions.csv")
    if "surface" in tables:
        text += "\n## Reflecting surface against its best fit\n\n" + _table(tables["surface"])
    text += "\n## Joints, by heat of friction\n\n" + _table(joints, MOST_ROWS, "joint_jumps.csv")
    if "sensitivities" in tables:
        ranked = sorted(tables["sensitivities"], key=lambda row: -abs(row["elasticity"] or 0.0))
        text += """
## Sensitivity of the jump

Elasticity: relative change of the output's jump per relative change of the parameter, `*` of all items
together; central differences, the second of half the step.

""" + _table(ranked, MOST_ROWS, "sensitivities.csv")
    return text


def _sample_times(case: TrussCase) -> np.ndarray:
    """Times [s] of the path in the result file."""
    cycles = case.thermal.cycles
    samples = max(1, min(case.samples_per_cycle, MOST_SAMPLES // cycles))
    return np.linspace(0, case.period_s * cycles, samples * cycles + 1)


def run(case: TrussCase, text: str, folder: Path, output_name: str, *, each: bool, step: float, skip_sensitivity: bool,
        frames: int, console: Any) -> list[Path]:
    """Compute and write all answers; return the files.

    :param text: the case file as given
    """
    from statejump.kinds.truss.answers import figure as answers_plot

    truss = case.resolve()
    with progress(console, f"{case.name}, path") as tell:
        found = answers.quick_path(truss, case.reduced.increments_per_branch,
                                   progress=lambda fraction: (tell(fraction), True)[1])
    output = answers.chosen_output(found, output_name)
    finer = answers.quick_path(truss, 2 * case.reduced.increments_per_branch, cycle_ends_only=True)
    checked = answers.verdict(found, answers.resolution_m(found, finer))
    jump, largest = output.jump(found), float(np.linalg.norm(answers.node_jumps(found)[-1], axis=1).max())
    tables: dict[str, list[Row]] = {
        "cycles": cycle_rows(checked), "node_jumps": node_rows(found), "joint_jumps": joint_rows(found),
    }
    notes: list[str] = []
    surface = reflector.surface(truss)
    if surface is not None:
        tables["surface"] = surface_rows(found, surface)
        notes += [f"reflecting surface: {note}" for note in surface.notes]
    elif truss.reflector is not None:
        notes.append("reflecting surface: its nodes do not determine a fit")
    change = abs(output.jump(finer) - jump)
    if change > RESOLVED * abs(jump):
        notes.append(f"the jump is not resolved: with twice the increments it changes by {change:.2g} {output.unit}; "
                     "more reduced.increments_per_branch are needed, or there is none")
    shares = None
    size = float(np.ptp(truss.nodes.position_m, axis=0).max())
    if abs(jump) <= NO_JUMP * (largest / size if output.unit == "rad" else largest):
        notes.append("the output does not jump: no joints are ranked, no sensitivities are asked")
    else:
        try:
            with progress(console, f"{case.name}, contributions of joints") as tell:
                shares = answers.contributions(found, output, tell)
            notes += shares.notes
            tables["contributions"] = contribution_rows(shares)
        except StatejumpError as problem:
            notes.append(f"no contributions: the truss without friction: {str(problem).removeprefix(case.name + ': ')}")
        if not skip_sensitivity:
            with progress(console, f"{case.name}, sensitivities") as tell:
                rows = sensitivities(found, output, each=each, step=step, progress=tell)
            tables["sensitivities"] = sensitivity_rows(rows, jump)
            if any(row.verdict == "not differentiable" for row in rows):
                notes.append("the jump has a kink here in some parameters, its slopes on both sides differ: see the "
                             "verdicts of the sensitivities")
    numbers = {"jump": Scalar(jump, output.unit), "energy_residue_J": Scalar(found.energy_residue_J, "J")}
    if shares is not None:
        numbers["sum_of_contributions"] = Scalar(float(shares.contribution.sum()), output.unit)
        numbers["sum_error_relative"] = Scalar(shares.sum_error)
        numbers["jump_from_friction_forces"] = Scalar(shares.reproduced, output.unit)
    record = Record("truss answers", case, text, folder, {"reduced": kind_truss.reduced_run(case, found, _sample_times(case))})
    record.answers = Answers(output.name, output.text, output.unit, checked.word, checked.text, notes, numbers, tables)
    written = [record.save(), *(folder / f"{name}.csv" for name in tables)]
    summary = {
        "case": case.name, "cycles": len(checked.cycle_jump_m), "output": output.name, "output_text": output.text,
        "unit": output.unit, "verdict": checked.word, "verdict_text": checked.text,
        "largest_jump_of_cycle_m": checked.cycle_jump_m.tolist(), "dissipation_of_cycle_J": checked.dissipation_J.tolist(),
        "notes": notes, **{name: scalar.value for name, scalar in numbers.items()},
        **{name: rows for name, rows in tables.items() if name not in ("cycles", "node_jumps", "joint_jumps")},
    }
    with write_atomically(folder / "answers.json") as stream:
        stream.write(json.dumps(summary, indent=1, ensure_ascii=False) + "\n")
    written.append(folder / "answers.md")
    with write_atomically(written[-1]) as stream:
        stream.write(_markdown(case, output, jump, checked, tables, shares, notes))
    written += [folder / "answers.json"]
    written += answers_plot.jumps_figure(found, shares, case.title or case.name, folder, "jumps")
    if shares is not None:
        written += answers_plot.ranking_figure(shares, output, case.title or case.name, folder, "ranking")
    if frames:
        from statejump.kinds.truss.answers import vtk

        with progress(console, f"{case.name}, files for ParaView") as tell:
            written.append(vtk.series(found, folder, "path", frames, tell))
    console.print(f"{output.text}: jump {units.plain(jump, output.unit)}")
    console.print(checked.text)
    for note in notes:
        console.print(f"note: {note}")
    return written


@click.command("answers")
@CASE
@click.option("--output", "output_name", default="node", show_default=True, metavar="NAME",
              help="What is traced to the joints: node (the most moved one), node:NAME, rms or tilt of the reflector.")
@click.option("--cycles", type=int, metavar="N", help="Cycles instead of the case's.")
@click.option("--each", is_flag=True, help="Sensitivities to every single item, not only to all of a kind together.")
@click.option("--step", type=float, default=STEP, show_default=True, help="Of the sensitivities, relative.")
@click.option("--no-sensitivity", "skip_sensitivity", is_flag=True, help="Leave sensitivities out.")
@click.option("--frames", type=int, default=0, show_default=True, help="Write that many .vtu files for ParaView.")
@RESULTS
@QUIET
def answers_command(
    case_file: Path, output_name: str, cycles: Optional[int], each: bool, step: float, skip_sensitivity: bool,
    frames: int, results: Path, quiet: bool,
) -> None:
    """What a designer asks of CASE: jumps, whether they settle, which joints hold them, what they follow.

    \b
    Examples:
      statejump truss answers cases/trusses/ring_12.toml
      statejump truss answers cases/trusses/mast_6.toml --cycles 5 --output node:R6 --each
    """
    console = make_console(quiet)
    case, text = load_kind(case_file, TrussCase), case_text(case_file)
    if cycles is not None:
        if not 1 <= cycles <= 100_000:
            raise StatejumpError(f"--cycles = {cycles} is not allowed: must be between 1 and 100000")
        if any(program.cycles is not None for program in case.program):
            raise StatejumpError(f"--cycles is not allowed: a [[program]] of {case_file} has cycles of its own")
        case = case.copy(update={"thermal": case.thermal.copy(update={"cycles": cycles})})
    if not 1e-6 <= step <= 0.2:
        raise StatejumpError(f"--step = {step} is not allowed: must be between 1e-06 and 0.2")
    if frames < 0:
        raise StatejumpError(f"--frames = {frames} is not allowed: must be at least 0")
    folder = results_folder(results, case.name)
    try:
        written = run(case, text, folder, output_name, each=each, step=step, skip_sensitivity=skip_sensitivity, frames=frames,
                      console=console)
    except KeyboardInterrupt:
        raise Interrupted("interrupted; nothing was written") from None
    console.print(f"results: {', '.join(str(path) for path in written)}")
