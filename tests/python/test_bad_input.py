# SPDX-License-Identifier: GPL-3.0-or-later
"""Invalid input: one sentence, exit status 2, no traceback, no files."""
from __future__ import annotations

import os
import signal
import subprocess
import time
from pathlib import Path

import numpy as np
import pytest

from conftest import COMMAND, results_in
from failures import failure
from statejump import _paths, kinds, read
from statejump.core.samples import names_line, rows_of
from statejump.core.errors import Range

E_LINE, NU = "young_modulus_Pa = 70e9\nstress", "friction_coefficient = 0.3"

# replacement in the file, and the expected error
MISTAKES = {
    "unknown key": ((NU, "frictoin_coefficient = 0.3"),
                    failure("misspelt_key", key="joint.frictoin_coefficient", meant="joint.friction_coefficient")),
    "unknown section": (("[dem]", "[demm]"), failure("misspelt_key", section="section [demm]", meant="[dem]")),
    "missing key": ((NU + "\n", ""),
                    failure("missing_key", key="joint.friction_coefficient", allowed=Range(0, 10, "-"))),
    "wrong type": ((NU, 'friction_coefficient = "0.3"'),
                   failure("wrong_type", key="joint.friction_coefficient", value="0.3", type="a number", allowed=Range(0, 10, "-"))),
    "boolean": ((NU, "friction_coefficient = true"),
                failure("wrong_type", key="joint.friction_coefficient", value=True, type="a number", allowed=Range(0, 10, "-"))),
    "wrong sign": ((NU, "friction_coefficient = -0.3"),
                   failure("out_of_range", key="joint.friction_coefficient", value=-0.3, allowed=Range(0, 10, "-"))),
    "NaN": ((NU, "friction_coefficient = nan"),
            failure("number_not_finite", key="joint.friction_coefficient", value=float("nan"), allowed=Range(0, 10, "-"))),
    "infinite": (("clearance_plus_m = 1e-3", "clearance_plus_m = inf"),
                 failure("number_not_finite", key="joint.clearance_plus_m", value=float("inf"), allowed=Range(0, 100, "m", above=True))),
    "zero modulus": ((E_LINE, "young_modulus_Pa = 0\nstress"),
                     failure("out_of_range", key="link.young_modulus_Pa", value=0, allowed=Range(0, 10000000000000.0, "Pa", above=True))),
    "no clearance": (("clearance_plus_m = 1e-3", "clearance_plus_m = 0"),
                     failure("out_of_range", key="joint.clearance_plus_m", value=0, allowed=Range(0, 100, "m", above=True))),
    "fraction of a cycle": (("cycles = 1", "cycles = 1.5"),
                            failure("wrong_type", key="thermal.cycles", value=1.5, type="a whole number", allowed=Range(1, 100000, "-"))),
    "unknown program": (('"half_sine"', '"square"'),
                        failure("unknown_name", key="thermal.shape", value="square", allowed=("triangle", "half_sine", "sine", "table"))),
    "step above the stable one": (("time_step_fraction = 0.1", "time_step_s = 1e-3 #"),
                                  failure("above_stable_time_step", key="dem.time_step_s", value=0.001)),
    "expansion closes the clearance": (("[thermal]", "pad_thermal_expansion_per_K = 5e-4\n[thermal]"),
                                       failure("clearance_closes", key="joint.clearance_minus_m", value=0.001)),
    "table without values": (('"half_sine"', '"table"'),
                             failure("conflicting_key", key="thermal.temperature_change_max_K", other="thermal.shape = 'table'")),
    "not TOML": (("[joint]", "[joint"), failure("not_toml_at_line")),
}


@pytest.mark.parametrize("mistake", MISTAKES)
@pytest.mark.parametrize("command", ["reduced", "dem", "compare"])
def test_mistake_in_the_case_file(statejump, edited, tmp_path: Path, mistake: str, command: str) -> None:
    replacement, wrong = MISTAKES[mistake]
    path = edited(replacement)
    outcome = statejump(command, path.name)
    assert outcome.status == 2
    assert outcome.failure == wrong.at(file="bad.toml")
    assert outcome.errors.count("\n") == 1
    assert "Traceback" not in outcome.errors + outcome.output
    assert sorted(entry.name for entry in tmp_path.iterdir()) == ["bad.toml"]


def test_missing_file(statejump) -> None:
    outcome = statejump("compare", "nowhere.toml")
    assert (outcome.status, outcome.failure) == (2, failure("case_file_not_found", file="nowhere.toml", of="case"))


def test_cases_that_come_with_the_program_are_found_from_everywhere(statejump, tmp_path: Path) -> None:
    assert statejump("reduced", "cases/table1.toml", "--quiet").status == 0
    # A file of one's own comes first.
    (tmp_path / "cases").mkdir()
    (tmp_path / "cases" / "table1.toml").write_text("wrong")
    assert statejump("reduced", "cases/table1.toml").failure == failure("not_toml_at_line", file="cases/table1.toml")
    assert statejump("reduced", "cases/table2.toml").failure == failure("case_file_not_found", file="cases/table2.toml", of="case")


def test_unwritable_results(statejump, cases: Path, tmp_path: Path) -> None:
    (tmp_path / "results").write_text("a file where a folder should be")
    outcome = statejump("compare", cases / "table1.toml")
    assert outcome.status == 2
    assert outcome.failure == failure("write_failed", file="results/table1")
    assert "--results" in outcome.failure.remedy


def test_unknown_option_and_command(statejump) -> None:
    assert statejump("compare", "--frob").status == 2
    outcome = statejump("frobnicate")
    assert outcome.status == 2 and "Traceback" not in outcome.errors


def test_yade_missing(yade, statejump, cases: Path) -> None:
    outcome = statejump("--json", "dem", cases / "table1.toml", STATEJUMP_YADE="no-such-yade")
    assert (outcome.status, outcome.errors) == (2, failure("yade_missing", command="no-such-yade"))


HALF = "echo 'STATEJUMP {\"progress\": 0.5}'\n"  # what the script in YADE says half-way
FAILURES = {
    "killed": (f"{HALF}kill -9 $$\n", failure("dem_killed", signal=9)),
    "failed": ("echo 'STATEJUMP {\"failure\": {\"cause\": \"contact lost\"}}'\nexit 2\n", failure("dem_failed", cause="contact lost")),
    "crashed": ("echo something broke\nexit 3\n",
                failure("yade_ended", status=3, cause="something broke")),
    "ended early": (f"{HALF}exit 0\n", failure("yade_ended", status=0)),
}


@pytest.mark.parametrize("name", FAILURES)
def test_failed_run(statejump, cases: Path, fake_yade, tmp_path: Path, name: str) -> None:
    body, wrong = FAILURES[name]
    outcome = statejump("--json", "compare", cases / "table1.toml", STATEJUMP_YADE=fake_yade(body))
    assert outcome.status == 2
    assert outcome.errors == wrong.at(case="table1")
    assert not (tmp_path / "results").exists()


def test_interrupt_keeps_the_samples_so_far(cases: Path, fake_yade, tmp_path: Path) -> None:
    # the columns that yade_scripts/runner/scene_spring_slider.py writes
    names = [name for name in kinds.kind("spring_slider").COLUMNS if name != "stage"]
    columns = [np.arange(3.0), *[np.zeros(3)] * (len(names) - 1)]
    (tmp_path / "cut").write_bytes((names_line(names) + rows_of(columns))[:-2])
    yade = fake_yade(f'cp {tmp_path}/cut "$STATEJUMP_OUTPUT.partial"\n{HALF}sleep 30\n')
    process = subprocess.Popen(
        [COMMAND, "--json", "dem", str(cases / "table1.toml")], cwd=tmp_path, stderr=subprocess.PIPE,
        stdout=subprocess.PIPE, text=True, env={**os.environ, "STATEJUMP_YADE": yade, "PYTHONUNBUFFERED": "1"},
    )
    assert process.stdout is not None and "50 %" in process.stdout.readline()
    started = time.monotonic()
    process.send_signal(signal.SIGINT)
    _, errors = process.communicate(timeout=20)
    assert time.monotonic() - started < 15, "YADE was not ended"
    assert process.returncode == 130
    folder = tmp_path / "results" / "table1"
    assert failure("samples_interrupted", samples=2, kept="results/table1/dem.interrupted.h5") == errors
    # the incomplete last row is not kept
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
    # With another Python version, the launcher reports the version found and the one required.
    changed = launcher.replace("WANTED = (3, ", "WANTED = (2, ")
    done = subprocess.run([_paths.PYTHON, "-c", changed], capture_output=True, text=True)
    assert done.returncode != 0 and "wrong Python" in done.stderr, first_on_path
    assert f"needed is {_paths.PYTHON}" in done.stderr
