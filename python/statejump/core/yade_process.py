# SPDX-License-Identifier: GPL-3.0-or-later
"""DEM run of a case: starts YADE, shows progress, keeps what was computed."""
from __future__ import annotations

import json
import math
import os
import re
import shutil
import signal
import subprocess
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Callable

from statejump import _paths
from statejump.kinds.spring_slider import stable_step
from statejump.schema.fields import Case
from statejump.kinds.spring_slider.case import SpringSliderCase
from statejump.core.errors import FailedRun, Interrupted
from statejump.core.history import History
from statejump.core.output import write_atomically

# Takes the samples of an interrupted run, writes them and returns the file to name.
Keep = Callable[[History], Path]


def number_of_steps(case: SpringSliderCase) -> int:
    """Steps of the whole run: a multiple of the samples, so that the last sample is the end."""
    wanted = case.dem.time_step_s
    if wanted is None:
        wanted = case.dem.time_step_fraction * stable_step.stable_time_step(case)
    samples = case.dem.samples_per_cycle
    return math.ceil(case.dem.period_s / wanted / samples) * samples * case.thermal.cycles


def time_step(case: SpringSliderCase) -> float:
    """Time step [s]: the wanted one or a little less, so that steps fill the program exactly."""
    return case.duration_s / number_of_steps(case)


def common_values(case: Case, number_of_steps: int) -> dict[str, Any]:
    """What the YADE script needs of a case of any kind, as plain values; keys as in the case file."""
    values = case.dict()
    if case.thermal.shape == "table":
        values["thermal"]["table_time_s"] = case.table_time_s
    values["period_s"] = case.period_s
    values["number_of_samples"] = case.samples_per_cycle * case.thermal.cycles
    values["dem"].update(
        number_of_steps=number_of_steps, time_step_s=case.duration_s / number_of_steps
    )
    return values


def resolved(case: SpringSliderCase) -> dict[str, Any]:
    """Everything that the YADE script needs of a ``spring_slider`` case."""
    values = common_values(case, number_of_steps(case))
    values["dem"].update(tip_mass_kg=stable_step.tip_mass(case))
    return values


def find_yade() -> str:
    """Return the yade command: STATEJUMP_YADE if set, otherwise from PATH."""
    wanted = os.environ.get("STATEJUMP_YADE", "yade")
    found = shutil.which(wanted)
    if found is None:
        raise FailedRun(
            f"YADE is missing: no command {wanted!r} found; install Debian's package 'yade' or set "
            "STATEJUMP_YADE to the command"
        )
    return found


def run(
    case: SpringSliderCase, folder: Path, progress: Callable[[float], None], keep: Keep | None = None
) -> DemRun:
    """Run a ``spring_slider`` case in YADE; see :func:`run_resolved`."""
    return run_resolved(resolved(case), folder, progress, keep)


@dataclass(frozen=True)
class DemRun:
    """A finished run: its samples, and what else it has to say (``dem_run.json``)."""

    history: History
    summary: dict[str, Any]


def run_resolved(
    values: dict[str, Any], folder: Path, progress: Callable[[float], None], keep: Keep | None = None
) -> DemRun:
    """Run a resolved case in YADE and write ``dem_run.json``, what the run says of itself.

    :param values: resolved case, see :func:`common_values`
    :param folder: results folder, exists
    :param progress: called with the finished fraction, 0 to 1
    :param keep: gets the samples of an interrupted run; None: they are dropped
    :raises StatejumpError: YADE is missing, failed or was killed; nothing half-written is left
    :raises Interrupted: Ctrl-C
    """
    done = execute(values, progress, keep)
    with write_atomically(folder / "dem_run.json") as stream:
        stream.write(json.dumps(done.summary, indent=2) + "\n")
    return done


def execute(
    values: dict[str, Any], progress: Callable[[float], None], keep: Keep | None = None
) -> DemRun:
    """Run a resolved case in YADE without writing results; see :func:`run_resolved`."""
    name, threads = values["case"]["name"], values["dem"]["threads"]
    command = [find_yade(), "-n", "-x", f"-j{threads}", str(_paths.YADE_SCRIPTS / "run_case.py")]
    with tempfile.TemporaryDirectory(prefix="statejump-") as scratch:
        input_file, output = Path(scratch) / "case.json", Path(scratch) / "dem_history.csv"
        input_file.write_text(json.dumps(values), encoding="utf-8")
        modules = str(Path(__file__).resolve().parents[2])
        environment = dict(
            os.environ,
            STATEJUMP_CASE_JSON=str(input_file),
            STATEJUMP_OUTPUT=str(output),
            PYTHONPATH=os.pathsep.join(filter(None, [modules, os.environ.get("PYTHONPATH")])),
            OMP_NUM_THREADS=str(threads),
        )
        try:
            problem, details = _watch(command, environment, progress)
        except KeyboardInterrupt:
            raise Interrupted(_keep_partial(output, keep)) from None
        except OSError as error:
            raise FailedRun(f"YADE cannot be started: {command[0]}: {error.strerror}") from None
        if problem:
            raise FailedRun(f"case {name}: {problem}", **({"cause": problem} | details))
        try:
            history = History.read_csv(output)
            summary = json.loads(output.with_name(output.name + ".json").read_text(encoding="utf-8"))
        except (OSError, ValueError, IndexError) as error:
            raise FailedRun(f"case {name}: the DEM run left no complete result: {error}") from None
    return DemRun(history, summary)


def _watch(
    command: list[str], environment: dict[str, str], progress: Callable[[float], None]
) -> tuple[str, dict[str, Any]]:
    """Run the command, pass progress on, return what went wrong or an empty string, and its fields if it says them."""
    sentence, details, finished, last = "", {}, False, ""
    with subprocess.Popen(
        command,
        env=environment,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        errors="replace",
        start_new_session=True,  # Ctrl-C reaches us alone; we end YADE in order
    ) as process:
        try:
            for line in process.stdout or []:
                word, _, rest = line.strip().partition(" ")
                if word == "PROGRESS" and re.fullmatch(r"\d+(\.\d*)?", rest):
                    fraction = float(rest)
                    finished = fraction >= 1
                    progress(fraction)
                elif word == "DETAILS":
                    details = json.loads(rest)
                elif word == "ERROR":
                    sentence = rest
                elif line.strip():
                    last = line.strip()
        except BaseException:
            os.killpg(process.pid, signal.SIGKILL)  # YADE and whatever it has started
            raise
    if sentence:
        return f"the DEM run failed: {sentence}", details
    if process.returncode < 0:
        return f"the DEM run was killed by signal {-process.returncode}; nothing was written", {}
    if process.returncode != 0 or not finished:
        detail = f": {last}" if last else ""
        return f"YADE ended with status {process.returncode} before the run was finished{detail}", {}
    return "", {}


def _keep_partial(output: Path, keep: Keep | None) -> str:
    if keep is None:
        return "interrupted; nothing was written"
    partial = output.with_name(output.name + ".partial")
    lines = partial.read_text(encoding="utf-8").splitlines(keepends=True) if partial.exists() else []
    if lines and not lines[-1].endswith("\n"):
        lines.pop()  # a row cut in the middle
    if len(lines) < 2:
        return "interrupted before the first sample; nothing was written"
    partial.write_text("".join(lines), encoding="utf-8")
    return f"interrupted; the {len(lines) - 1} samples so far are in {keep(History.read_csv(partial))}"
