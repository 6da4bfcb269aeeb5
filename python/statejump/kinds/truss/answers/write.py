# SPDX-License-Identifier: GPL-3.0-or-later
"""Files with the answers on a truss: result file, tables, figures, and a page of text."""
from __future__ import annotations

from pathlib import Path
from typing import Any

from statejump.core.figures import save
from statejump.core.later import Later
from statejump.core.tables import markdown, write_json, write_markdown
from statejump.core.units import plain
from statejump.kinds.truss.answers.rows import Row
from statejump.kinds.truss.answers.study import Phase, TrussAnswers
from statejump.results import record

_SERIES = Later("statejump.kinds.truss.answers.vtk:series")
MOST_ROWS = 15  # rows of a table in answers.md
MOST_NODES = 8
# Large tables, written as CSV files beside the JSON file.
NOT_IN_JSON = ("cycles", "node_jumps", "joint_jumps")


def write(found: TrussAnswers, folder: Path, frames: int, phase: Phase) -> list[Path]:
    """Write all files and return their paths; see :meth:`TrussAnswers.write`."""
    case, tables = found.case, found.tables
    written = [record.save("truss answers", case, {"reduced": found.run}, folder, answers=found.record),
               *(folder / f"{name}.csv" for name in tables),
               write_markdown(folder / "answers.md", _markdown(found)),
               write_json(folder / "answers.json", _document(found), indent=1)]
    written += save(found.plot(), folder, "jumps")
    if found.shares is not None:
        written += save(found.plot_ranking(), folder, "ranking")
    if frames:
        with phase("files for ParaView") as on_progress:
            written.append(_SERIES(found.path, folder, "path", frames, on_progress))
    return written


def _document(found: TrussAnswers) -> dict[str, Any]:
    said, checked = found.record, found.checked
    return {
        "case": found.case.name, "cycles": len(checked.cycle_jump), "output": said.output, "output_text": said.text,
        "unit": said.unit, "verdict": said.verdict, "verdict_text": said.verdict_text,
        "increments_per_branch": checked.increments, "output_motion_of_cycle": checked.cycle_jump.tolist(),
        "largest_jump_of_cycle_m": [row["largest_jump_m"] for row in found.tables["cycles"]],
        "dissipation_of_cycle_J": checked.dissipation_J.tolist(), "notes": said.notes,
        **{name: scalar.value for name, scalar in said.summary.items()},
        **{name: rows for name, rows in found.tables.items() if name not in NOT_IN_JSON},
    }


def _cell(value: Any) -> str:
    if value is None:
        return "–"
    return f"{value:.5g}" if isinstance(value, float) else str(value)


def _table(rows: list[Row], most: int = MOST_ROWS, file: str = "") -> list[str]:
    if not rows:
        return ["None."]
    heads = list(rows[0])
    right = [place for place, head in enumerate(heads) if not isinstance(rows[0][head], str)]
    lines = markdown(heads, [[_cell(value) for value in row.values()] for row in rows[:most]], right)
    return lines + (["", f"{len(rows) - most} more in `{file}`."] if len(rows) > most else [])


def _markdown(found: TrussAnswers) -> list[str]:
    checked, tables, shares = found.checked, found.tables, found.shares
    cycles = len(checked.cycle_jump)
    last = sorted((row for row in tables["node_jumps"] if row["cycle"] == cycles), key=lambda row: -row["jump_m"])
    joints = sorted((row for row in tables["joint_jumps"] if row["cycle"] == cycles),
                    key=lambda row: -row["dissipation_J"])
    lines = [
        f"# {found.case.title}",
        "",
        f"Made by `statejump truss answers`: quasi-static path of {cycles} cycle{'s' if cycles > 1 else ''}; jumps are",
        "displacements at the end of a cycle less those at the start.",
        "",
        f"- **Output**: {found.record.text}; its jump is {plain(found.jump, found.record.unit)}.",
        f"- **Over the cycles**: {checked.text}.",
        f"- **Heat of friction**: {checked.dissipation_J.sum():.5g} J, {checked.dissipation_J[-1]:.5g} J of it in the "
        "last cycle.",
        *(f"- {note[0].upper() + note[1:]}." for note in found.notes),
        "", "## Nodes that jump most", "", *_table(last, MOST_NODES, "node_jumps.csv"),
    ]
    if shares is not None:
        lines += [
            "", "## Joints that hold the jump", "",
            "Contribution of a joint: effect on the output of the friction force that it holds, on the truss with",
            "frictionless joints, mean of alone and as the last of all. Their sum differs from the jump by",
            f"{shares.sum_error:.2g} of it: it is exact where the truss is linear. All friction forces together on the",
            f"frictionless truss give the jump back to {abs(shares.reproduced / shares.jump - 1):.2g} of it.",
            "", *_table(tables["contributions"], MOST_ROWS, "contributions.csv"),
        ]
    if "surface" in tables:
        lines += ["", "## Reflecting surface against its best fit", "", *_table(tables["surface"])]
    lines += ["", "## Joints, by heat of friction", "", *_table(joints, MOST_ROWS, "joint_jumps.csv")]
    if "sensitivities" in tables:
        ranked = sorted(tables["sensitivities"], key=lambda row: -abs(row["elasticity"] or 0.0))
        lines += [
            "", "## Sensitivity of the jump", "",
            "Elasticity: relative change of the output's jump per relative change of the parameter, `*` of all items",
            "together; central differences, the second of half the step.",
            "", *_table(ranked, MOST_ROWS, "sensitivities.csv"),
        ]
    return lines
