#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes each kind of mistake in a case file, runs the command and writes its message to docs/reference/mistakes.md.

    PYTHONPATH=build/python /usr/bin/python3 studies/docs/make_mistakes.py

A test requires that the committed page equals the output of this program.
"""
from __future__ import annotations

import contextlib
import io
import os
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

REPOSITORY = Path(__file__).resolve().parents[2]
PAGE = REPOSITORY / "docs" / "reference" / "mistakes.md"


@dataclass(frozen=True)
class Mistake:
    """One mistake: the replacement in a case file, and the command to run."""

    what: str
    case: str  # below cases/, without suffix
    old: str
    new: str
    command: str = "reduced"


ITEM = 'name = "L1"\nnodes = ["N0", "N1"]'
NU = "friction_coefficient = 0.3"
GROUPS: dict[str, tuple[Mistake, ...]] = {
    "The file": (
        Mistake("not TOML", "table1", "[joint]", "[joint"),
        Mistake("no such kind", "table1", 'kind = "spring_slider"', 'kind = "spring_slidr"'),
        Mistake("a name that is no folder", "table1", 'name = "table1"', 'name = "table 1"'),
        Mistake("a case of another kind than the command is for", "statics_slot", "", "", "control"),
    ),
    "Keys and sections": (
        Mistake("misspelt key", "table1", NU, "frictoin_coefficient = 0.3"),
        Mistake("misspelt section", "table1", "[dem]", "[demm]"),
        Mistake("missing key", "table1", NU + "\n", ""),
        Mistake("missing section", "umbrella", "[frame]\nlength_m = 0.12", ""),
        Mistake("section of another kind", "umbrella", "[frame]", "[link]\n[frame]"),
    ),
    "Values": (
        Mistake("text instead of a number", "table1", NU, 'friction_coefficient = "0.3"'),
        Mistake("true instead of a number", "table1", NU, "friction_coefficient = true"),
        Mistake("out of range", "table1", NU, "friction_coefficient = -0.3"),
        Mistake("excluded end of a range", "table1", "clearance_plus_m = 1e-3", "clearance_plus_m = 0"),
        Mistake("no number", "table1", NU, "friction_coefficient = nan"),
        Mistake("infinite", "table1", "clearance_plus_m = 1e-3", "clearance_plus_m = inf"),
        Mistake("fraction of a whole number", "table1", "cycles = 1", "cycles = 1.5"),
        Mistake("none of the names", "umbrella", 'normal_law = "hertz_internal"', 'normal_law = "hertz_internl"'),
    ),
    "Between several keys": (
        Mistake("key that the choice does not need", "table1", '"half_sine"', '"table"'),
        Mistake("key that the choice needs", "statics_lobed", "lobes = 3\n", "", "statics"),
        Mistake("time step above the stable one", "table1", "time_step_fraction = 0.1", "time_step_s = 1e-3"),
        Mistake("expansion closes the clearance", "table1", "[thermal]",
                "pad_thermal_expansion_per_K = 5e-4\n\n[thermal]"),
        Mistake("links that cannot meet", "umbrella", "length_m = 0.12", "length_m = 0.16"),
        Mistake("force of zero", "statics_lobed", "[-100, 0, 0]", "[0, 0, 0]", "statics"),
        Mistake("explicit steps of masses that the DEM has not", "trusses/chain_10", "[thermal]",
                '[motion]\nscheme = "regularised"\n\n[thermal]', "reduced --dynamic"),
    ),
    "Lists of tables": (
        Mistake("misspelt key of an item", "trusses/chain_10", ITEM, ITEM + "\nyoung_modulus = 7e10", "truss draw"),
        Mistake("misspelt key of a force", "statics_lobed", "force_N", "forse_N", "statics"),
        Mistake("one table instead of a list", "trusses/chain_10", "[[slider]]", "[program]\n[[slider]]", "truss draw"),
        Mistake("reference to nothing", "trusses/chain_10", ITEM, 'name = "L1"\nnodes = ["N0", "NN1"]', "truss draw"),
        Mistake("two items of one name", "trusses/chain_10", 'name = "N1"', 'name = "N0"', "truss draw"),
        Mistake("item out of range", "trusses/ring_12", "young_modulus_Pa = 70000000000.0", "young_modulus_Pa = 0.0",
                "truss draw"),
    ),
    "Campaigns": (
        Mistake("misspelt key of the case", "campaigns/table1_tolerances", '"joint.friction_coefficient"',
                '"joint.frictoin_coefficient"', "montecarlo"),
        Mistake("misspelt key of a [[vary]]", "campaigns/table1_tolerances", "relative = 0.2 ", "realtive = 0.2 ",
                "montecarlo"),
        Mistake("key of the other campaign", "campaigns/table1_friction", "count = 21", "count = 21\nrelative = 0.1",
                "sweep"),
        Mistake("value out of the key's range", "campaigns/table1_friction", "start = 0", "start = -1", "sweep"),
    ),
}
# What only the run finds; command 'dem'.
RUNS: tuple[Mistake, ...] = (
    Mistake("too few steps", "umbrella_damped", "steps_per_cycle = 400000", "steps_per_cycle = 2000", "dem"),
    Mistake("law of a contact beyond its range", "umbrella_damped",
            'radial_clearance_m = 1e-4\nnormal_law = "hertz_internal"',
            'radial_clearance_m = 1e-9\nnormal_law = "johnson"', "dem"),
    Mistake("stop that holds the slider above its floor", "table1", "[joint]",
            "[joint]\nslot_thermal_expansion_per_K = -1.5e-4", "dem"),
)
HEAD = """# Mistakes and their messages

After this page you know the message of each mistake, and the exit status of every command. This program makes each
mistake and generates the page:

```
PYTHONPATH=build/python /usr/bin/python3 studies/docs/make_mistakes.py
```

A message is one sentence on standard error with file, key, value and allowed values. For a misspelt name it suggests
the nearest known one. A command with bad input runs nothing and writes nothing. If a run cannot continue, the message
names joint, time, temperature and, if known, a remedy. The samples of the run are not stored.

| exit status | meaning |
|---|---|
| 0 | done |
| 1 | done, but a tolerance of the case file is missed, or a contact problem is not solved to its tolerance |
| 2 | bad input, a run that cannot finish, or results that cannot be written |
| 70 | a fault of the program itself, with a traceback; please report it |
| 129 | ended because its terminal was closed, without incomplete files and without a message |
| 130 | interrupted by Ctrl-C; the message states what was kept |
| 143 | ended by SIGTERM, without incomplete files and without a message |

With `--json` before the command (`statejump --json compare CASE`), a failure is one line of JSON on standard error.
Standard output does not change. In Python the fields are `StatejumpError.fields()`, and a program compares
`StatejumpError.code` with the [codes](#codes). Fields without a value are absent:

| field | content |
|---|---|
| `kind` | `usage`, `bad_input`, `output` (a file cannot be written), `failed_run`, `tolerance_missed`, \
`not_solved`, `interrupted`, `internal` (a fault of the program) |
| `code` | what went wrong; codes do not change, sentences may |
| `message`, `cause`, `remedy`, `exit_status` | the sentence and its parts |
| `file`, `case`, `item` (of a list of tables), `key` | position of the mistake |
| `value`, `allowed` | the value (as text if JSON has no such number); range with unit, or names |
| `time_s`, `temperature_change_K`, `joint`, `nodes` | state of the run |
| `details` | further values: the names in braces in the [codes](#codes) |
"""


def edited(mistake: Mistake) -> str:
    """Return the case file with the mistake."""
    text = (REPOSITORY / "cases" / f"{mistake.case}.toml").read_text(encoding="utf-8")
    if mistake.old not in text:
        raise ValueError(f"{mistake.case}.toml does not hold {mistake.old!r}")
    text = text.replace(mistake.old, mistake.new, 1) if mistake.old else text
    # A campaign names its case relatively.
    return text.replace('case = "../', f'case = "{REPOSITORY}/cases/')


def said(arguments: list[str]) -> tuple[int, str]:
    """Run the command in this process; return its exit status and its standard error."""
    from statejump.cli import main as cli

    with contextlib.redirect_stderr(io.StringIO()) as errors, contextlib.redirect_stdout(io.StringIO()):
        status = cli.run(arguments)
    return status, errors.getvalue().strip()


def _cell(text: str) -> str:
    return text.replace("|", "\\|").replace("\n", " ⏎ ")


def _code(text: str) -> str:
    return f"`{_cell(text)}`" if text else ""


def _rows(group: str, mistakes: tuple[Mistake, ...]) -> list[str]:
    """Make the mistakes of a group in the working folder; return their section of the page."""
    lines = [f"## {group}\n\n| mistake | command | in | instead of | message |\n|---|---|---|---|---|"]
    for mistake in mistakes:
        name = Path(mistake.case).name + ".toml"
        Path(name).write_text(edited(mistake), encoding="utf-8")
        status, message = said([*mistake.command.split(), name])
        if status != 2:
            raise ValueError(f"{mistake.what}: exit status {status}, {message!r}")
        lines.append(
            f"| {mistake.what} | {_code(mistake.command)} | {_code(mistake.new.strip()) or 'nothing'} | "
            f"{_code(mistake.old.strip())} | {_cell(message)} |"
        )
    return [*lines, ""]


def table() -> str:
    """Return the page with the message of every mistake."""
    here = Path.cwd()
    lines = [HEAD]
    with tempfile.TemporaryDirectory(prefix="statejump-") as folder:
        os.chdir(folder)
        try:
            for group, mistakes in GROUPS.items():
                lines += _rows(group, mistakes)
            lines += _rows("Runs in YADE", RUNS)
            lines += _as_json()
            lines += _codes()
            lines += _notes()
            lines += _reasons_of_meshes()
        finally:
            os.chdir(here)
    return "\n".join(lines)


def _as_json() -> list[str]:
    """Return three failures as JSON messages: an invalid value, a mechanism, a failed run in YADE."""
    import statejump as sj
    from statejump.core.errors import to_json

    shown = ["## As JSON\n"]
    first = GROUPS["Values"][2]
    Path("table1.toml").write_text(edited(first), encoding="utf-8")
    # A support is removed, so the truss is a mechanism.
    text = (REPOSITORY / "cases" / "trusses" / "umbrella_rib.toml").read_text(encoding="utf-8")
    Path("umbrella_rib.toml").write_text(text.replace('fixed = ["x", "y"]', 'fixed = ["x"]', 1), encoding="utf-8")
    _, message = said(["--json", "reduced", "table1.toml"])
    shown.append(f"```\nstatejump --json reduced table1.toml\n{message}\n```\n")
    try:
        sj.load("umbrella_rib.toml").reduced()
    except sj.StatejumpError as failure:
        shown.append(
            "The solver names nodes or joint, and temperature and time if it failed on the way. Here a support of "
            f"`umbrella_rib.toml` is taken away:\n\n```\n{to_json(failure.fields())}\n```\n"
        )
    Path("umbrella_damped.toml").write_text(edited(RUNS[1]), encoding="utf-8")
    _, message = said(["--json", "dem", "umbrella_damped.toml"])
    shown.append(
        "A run in YADE names joint or contact as result files do; the temperature is that of the case's (first) "
        f"program:\n\n```\nstatejump --json dem umbrella_damped.toml\n{message}\n```\n"
    )
    return shown


def _codes() -> list[str]:
    """Return every code with the sentence of its errors."""
    from statejump.core.error_codes import CODES

    lines = ["## Codes\n\nNames in braces are `details`. The sign … stands for what each error says itself: which key "
             "has which value, or which file is meant.\n\n| code | sentence |\n|---|---|"]
    for code, declared in sorted(CODES.items()):
        what = " ".join(part for part in (declared.what or "…", declared.beside) if part)
        sentence = ": ".join(part for part in (what, declared.cause) if part)
        if declared.remedy:
            sentence += ("; " if declared.cause else ": ") + declared.remedy
        if declared.further:
            sentence += f" (details: {', '.join(declared.further)})"
        lines.append(f"| `{code}` | {_cell(sentence if declared.text == '' else f'({declared.text})')} |")
    return [*lines, ""]


def _notes() -> list[str]:
    """Return the code of every note with its sentence."""
    from statejump.core.notes import NOTES

    lines = ["## Notes\n\nWarnings of runs, remarks of studies and notes of identification are texts with a `code` and "
             "`details` (`statejump.core.notes.Note`). Names in braces are `details`. Files keep the text only.\n\n"
             "| code | sentence |\n|---|---|"]
    lines += [f"| `{code}` | {_cell(sentence)} |" for code, sentence in sorted(NOTES.items())]
    return [*lines, ""]


def _reasons_of_meshes() -> list[str]:
    """Return the reasons for which a mesh is rejected, with the message of each reason."""
    from statejump import _engine

    lines = ["## Meshes of bores\n\nThe detail `reason` says why a mesh has one of the codes `bore_…`. Names in braces "
             "are further details; a part in brackets may be missing.\n\n| code | reason | sentence |\n|---|---|---|"]
    for fault, reason, cause, remedy in _engine.mesh_reasons():
        joint = " Then " if cause.endswith("?") else "; "
        sentence = f"{cause}{joint}{remedy}" if remedy else cause
        lines.append(f"| `bore_{fault}` | `{reason}` | {_cell(sentence)} |")
    return [*lines, ""]


if __name__ == "__main__":
    PAGE.write_text(table(), encoding="utf-8")
    sys.stdout.write(f"{PAGE}\n")
