# SPDX-License-Identifier: GPL-3.0-or-later
"""Bad input: one sentence, exit status 2, no traceback, nothing left behind."""
from __future__ import annotations

import os
import signal
import subprocess
import time
from pathlib import Path

import numpy as np
import pytest

from conftest import COMMAND, results_in
from statejump import _paths, kinds, read
from statejump.core.samples import names_line, rows_of

E_LINE, NU = "young_modulus_Pa = 70e9\nstress", "friction_coefficient = 0.3"

# what is replaced in the file, and the sentence after "error: bad.toml: "
MISTAKES = {
    "unknown key": ((NU, "frictoin_coefficient = 0.3"),
                    "joint.frictoin_coefficient is unknown: did you mean joint.friction_coefficient?"),
    "unknown section": (("[dem]", "[demm]"), "section [demm] is unknown: did you mean [dem]?"),
    "missing key": ((NU + "\n", ""),
                    "joint.friction_coefficient is missing: must be between 0 and 10 [-]"),
    "wrong type": ((NU, 'friction_coefficient = "0.3"'),
                   "joint.friction_coefficient = '0.3' is not allowed: must be a number, between 0 and 10 [-]"),
    "boolean": ((NU, "friction_coefficient = true"),
                "joint.friction_coefficient = true is not allowed: must be a number, between 0 and 10 [-]"),
    "wrong sign": ((NU, "friction_coefficient = -0.3"),
                   "joint.friction_coefficient = -0.3 is not allowed: must be between 0 and 10 [-]"),
    "NaN": ((NU, "friction_coefficient = nan"),
            "joint.friction_coefficient = nan is not allowed: must be finite, between 0 and 10 [-]"),
    "infinite": (("clearance_plus_m = 1e-3", "clearance_plus_m = inf"),
                 "joint.clearance_plus_m = inf is not allowed: must be finite, above 0 and at most 100 [m]"),
    "zero modulus": ((E_LINE, "young_modulus_Pa = 0\nstress"),
                     "link.young_modulus_Pa = 0 is not allowed: must be above 0 and at most 1e+13 [Pa]"),
    "no clearance": (("clearance_plus_m = 1e-3", "clearance_plus_m = 0"),
                     "joint.clearance_plus_m = 0 is not allowed: must be above 0 and at most 100 [m]"),
    "fraction of a cycle": (("cycles = 1", "cycles = 1.5"),
                            "thermal.cycles = 1.5 is not allowed: must be a whole number, between 1 and 100000 [-]"),
    "unknown program": (('"half_sine"', '"square"'),
                        "thermal.shape = 'square' is not allowed: must be 'triangle' or 'half_sine' or 'sine' or 'table'"),
    "step above the stable one": (("time_step_fraction = 0.1", "time_step_s = 1e-3 #"),
                                  "dem.time_step_s = 0.001 is not allowed: must be above 0 and at most the stable time step"),
    "expansion closes the clearance": (("[thermal]", "pad_thermal_expansion_per_K = 5e-4\n[thermal]"),
                                       "joint.clearance_minus_m = 0.001 is not allowed: the expansion of pad and slot closes it"),
    "table without values": (('"half_sine"', '"table"'),
                             "thermal.temperature_change_max_K is not allowed with thermal.shape = 'table'"),
    "not TOML": (("[joint]", "[joint"), "not TOML, line "),
}


@pytest.mark.parametrize("mistake", MISTAKES)
@pytest.mark.parametrize("command", ["reduced", "dem", "compare"])
def test_mistake_in_the_case_file(statejump, edited, tmp_path: Path, mistake: str, command: str) -> None:
    replacement, sentence = MISTAKES[mistake]
    path = edited(replacement)
    outcome = statejump(command, path.name)
    assert outcome.status == 2
    assert outcome.errors.startswith(f"error: bad.toml: {sentence}"), outcome.errors
    assert outcome.errors.count("\n") == 1
    assert "Traceback" not in outcome.errors + outcome.output
    assert sorted(entry.name for entry in tmp_path.iterdir()) == ["bad.toml"]


def test_missing_file(statejump) -> None:
    outcome = statejump("compare", "nowhere.toml")
    assert (outcome.status, outcome.errors) == (2, "error: nowhere.toml: no such case file\n")


def test_cases_that_come_with_the_program_are_found_from_everywhere(statejump, tmp_path: Path) -> None:
    assert statejump("reduced", "cases/table1.toml", "--quiet").status == 0
    # A file of one's own comes first.
    (tmp_path / "cases").mkdir()
    (tmp_path / "cases" / "table1.toml").write_text("wrong")
    assert statejump("reduced", "cases/table1.toml").errors.startswith("error: cases/table1.toml: not TOML")
    assert statejump("reduced", "cases/table2.toml").errors == "error: cases/table2.toml: no such case file\n"


def test_unwritable_results(statejump, cases: Path, tmp_path: Path) -> None:
    (tmp_path / "results").write_text("a file where a folder should be")
    outcome = statejump("compare", cases / "table1.toml")
    assert outcome.status == 2
    assert outcome.errors.startswith("error: results folder results/table1: cannot be written: ")
    assert outcome.errors.rstrip().endswith("choose another with --results")


def test_unknown_option_and_command(statejump) -> None:
    assert statejump("compare", "--frob").status == 2
    outcome = statejump("frobnicate")
    assert outcome.status == 2 and "Traceback" not in outcome.errors


def test_yade_missing(yade, statejump, cases: Path) -> None:
    outcome = statejump("dem", cases / "table1.toml", STATEJUMP_YADE="no-such-yade")
    assert outcome.status == 2
    assert outcome.errors == (
        "error: YADE is missing: no command 'no-such-yade' found; install Debian's package 'yade' or "
        "set STATEJUMP_YADE to the command\n"
    )


HALF = "echo 'STATEJUMP {\"progress\": 0.5}'\n"  # what the script in YADE says half-way
FAILURES = {
    "killed": (f"{HALF}kill -9 $$\n", "the DEM run was killed by signal 9; nothing was written"),
    "failed": ("echo 'STATEJUMP {\"failure\": {\"cause\": \"the contact is lost\"}}'\nexit 2\n", "the DEM run failed: the contact is lost"),
    "crashed": ("echo something broke\nexit 3\n",
                "YADE ended with status 3 before the run was finished: something broke"),
    "ended early": (f"{HALF}exit 0\n", "YADE ended with status 0 before the run was finished"),
}


@pytest.mark.parametrize("failure", FAILURES)
def test_failed_run(statejump, cases: Path, fake_yade, tmp_path: Path, failure: str) -> None:
    body, sentence = FAILURES[failure]
    outcome = statejump("compare", cases / "table1.toml", STATEJUMP_YADE=fake_yade(body))
    assert outcome.status == 2
    assert outcome.errors == f"error: case table1: {sentence}\n"
    assert not (tmp_path / "results").exists()


def test_interrupt_keeps_the_samples_so_far(cases: Path, fake_yade, tmp_path: Path) -> None:
    # the columns that yade_scripts/runner/scene_spring_slider.py writes
    names = [name for name in kinds.kind("spring_slider").COLUMNS if name != "stage"]
    columns = [np.arange(3.0), *[np.zeros(3)] * (len(names) - 1)]
    (tmp_path / "cut").write_bytes((names_line(names) + rows_of(columns))[:-2])
    yade = fake_yade(f'cp {tmp_path}/cut "$STATEJUMP_OUTPUT.partial"\n{HALF}sleep 30\n')
    process = subprocess.Popen(
        [COMMAND, "dem", str(cases / "table1.toml")], cwd=tmp_path, stderr=subprocess.PIPE,
        stdout=subprocess.PIPE, text=True, env={**os.environ, "STATEJUMP_YADE": yade, "PYTHONUNBUFFERED": "1"},
    )
    assert process.stdout is not None and "50 %" in process.stdout.readline()
    started = time.monotonic()
    process.send_signal(signal.SIGINT)
    _, errors = process.communicate(timeout=20)
    assert time.monotonic() - started < 15, "YADE was not ended"
    assert process.returncode == 130
    folder = tmp_path / "results" / "table1"
    assert errors == "interrupted; the 2 samples so far are in results/table1/dem.interrupted.h5\n"
    # the row that was cut in the middle is not kept
    table = (folder / "dem_history.interrupted.csv").read_text().splitlines()
    assert table == [",".join(names), *(",".join([time_s] + ["0.0"] * (len(names) - 1)) for time_s in ("0.0", "1.0"))]
    kept = read(folder / "dem.interrupted.h5")
    assert not kept.complete and kept.models["dem"].time_s.tolist() == [0.0, 1.0]
    assert results_in(folder) == ["dem.interrupted.h5", "dem_history.interrupted.csv"]


def test_wrong_python_is_named() -> None:
    wrong = ["python3", "--version"]
    first_on_path = subprocess.run(wrong, capture_output=True, text=True).stdout
    launcher = Path(COMMAND).read_text()
    assert launcher.splitlines()[0].endswith(f" {_paths.PYTHON}")  # behind env, which blocks signals
    # The launcher run with another version says which was found and which is needed.
    changed = launcher.replace("WANTED = (3, ", "WANTED = (2, ")
    done = subprocess.run([_paths.PYTHON, "-c", changed], capture_output=True, text=True)
    assert done.returncode != 0 and "error: wrong Python: found" in done.stderr, first_on_path
    assert f"needed is {_paths.PYTHON}" in done.stderr
