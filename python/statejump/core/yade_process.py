# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs a case in a YADE process, and reports progress, results and failures.

The script in YADE writes :mod:`~statejump.core.samples`. It reports in lines of JSON that begin with ``MARK``: the
finished fraction, or the fields of a :class:`~statejump.core.errors.StatejumpError`.
"""
from __future__ import annotations

import json
import os
import shlex
import signal
import subprocess
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from statejump import _paths
from statejump.core.case import Case
from statejump.core.errors import FailedRun, Interrupted, NotAllowed, StatejumpError
from statejump.core.output import not_written, write_bytes
from statejump.core.pace import show_pace
from statejump.core.progress import OnProgress
from statejump.core.run import Run
from statejump.core.samples import read_samples
from statejump.core.thermal import parameters
from statejump.schema.fields import choice

MARK = "STATEJUMP "
RUNNER, DATA, SAMPLES = "run_case.py", "case.json", "dem.samples"  # default names in the script, too
PR_SET_PDEATHSIG = 1  # prctl(2)
Columns = Mapping[str, np.ndarray]
MakeRun = Callable[[Case, Columns, Mapping[str, Any]], Run]
NO_DISPLAY = 3  # exit status of the script


@dataclass(frozen=True)
class Samples:
    """Results of a process: its samples by column, and its summary."""

    columns: dict[str, np.ndarray]
    about: dict[str, Any]


def common_values(case: Case, number_of_steps: int) -> dict[str, Any]:
    """Return the data that the YADE script needs for any kind of case, as plain values with keys of case files."""
    values = case.with_defaults()
    values["period_s"] = case.period_s
    values["thermal"].update(parameters(case.thermal, case.period_s))
    values["number_of_samples"] = case.samples_per_cycle * case.thermal.cycles
    values["dem"].update(number_of_steps=number_of_steps, time_step_s=case.duration_s / number_of_steps)
    return values


def stepper() -> Any:
    """Declare the key that selects the stepper of a DEM run: the plugin's JointStepper, or all engines of YADE's loop.
    On one thread, both give the same numbers, bit for bit."""
    return choice("joint", ("joint", "yade"), "the same numbers as YADE's loop, in less time")


def find_yade() -> str:
    """Return the yade command: STATEJUMP_YADE if set, otherwise from PATH."""
    from shutil import which  # cases import this module, but few of them start YADE

    if not _paths.YADE:
        raise FailedRun(code="built_without_yade")
    wanted = os.environ.get("STATEJUMP_YADE", "yade")
    found = which(wanted)
    if found is None:
        raise FailedRun(code="yade_missing", command=wanted)
    return found


def command_of(values: Mapping[str, Any], script: Path, *, view: bool = False) -> list[str]:
    """Return the command that runs a script in YADE.

    :param view: whether to open YADE's windows and its prompt
    """
    return [find_yade(), *([] if view else ["-n", "-x"]), f"-j{values['dem']['threads']}", str(script)]


def python_path() -> str:
    """Return the PYTHONPATH that lets the script in YADE find this package and the plugin."""
    modules = str(Path(__file__).resolve().parents[2])
    return os.pathsep.join(filter(None, [modules, os.environ.get("PYTHONPATH")]))


def _dying_with_us() -> Callable[[], None]:
    """Return a function that a new process calls at its start. The kernel then kills this process together with the
    thread that waits for it. Otherwise YADE would continue after its caller was killed."""
    import ctypes  # as which

    # Looked up before the fork, because afterwards the process does as little as possible.
    prctl = ctypes.PyDLL(None).prctl

    def ask() -> None:
        prctl(PR_SET_PDEATHSIG, signal.SIGKILL)

    return ask


def run(case: Case, values: Mapping[str, Any], make_run: MakeRun, on_progress: OnProgress) -> Run:
    """Run a case in YADE.

    :param values: data for the script, see :func:`common_values`
    :param make_run: makes the run from its samples
    :param on_progress: called with the finished fraction, 0 to 1
    :raises FailedRun: YADE is missing, failed or was killed
    :raises Interrupted: Ctrl-C was pressed; ``run`` of the error has the samples so far, or is None
    """
    try:
        done = execute(values, on_progress)
    except Interrupted as stopped:
        if stopped.run is not None:
            samples: Samples = stopped.run
            try:
                stopped.run = replace(make_run(case, samples.columns, samples.about), complete=False)
            except (KeyError, IndexError, ValueError):  # interrupted before there are samples
                stopped = Interrupted(code="interrupted_before_sample")
        raise stopped from None
    return make_run(case, done.columns, done.about)


def execute(values: Mapping[str, Any], on_progress: OnProgress) -> Samples:
    """Run a case in YADE, given as plain values; see :func:`run`. ``run`` of an interruption is a :class:`Samples`."""
    from statejump.core.scratch import scratch  # as which

    name = values["case"]["name"]
    command = command_of(values, _paths.YADE_SCRIPTS / "runner" / RUNNER)
    with scratch() as folder:
        input_file, output = folder / DATA, folder / SAMPLES
        input_file.write_text(json.dumps(values), encoding="utf-8")
        environment = dict(
            os.environ,
            STATEJUMP_CASE_JSON=str(input_file),
            STATEJUMP_OUTPUT=str(output),
            PYTHONPATH=python_path(),
            OMP_NUM_THREADS=str(values["dem"]["threads"]),
            HOME=os.environ.get("HOME") or str(folder),  # YADE does not start without HOME
            TMPDIR=str(folder),  # YADE's own temporary folder is removed with this one
        )
        try:
            _watch(command, environment, on_progress)
        except KeyboardInterrupt:
            raise _interrupted(output) from None
        except OSError as error:
            raise FailedRun(code="yade_not_started", cause=error.strerror, command=command[0]) from None
        except StatejumpError as failure:
            raise failure.located(case=name) from None
        try:
            about = json.loads(output.with_name(output.name + ".json").read_text(encoding="utf-8"))
            return Samples(read_samples(output), about)
        except (OSError, ValueError, IndexError, StatejumpError) as error:
            raise FailedRun(code="dem_without_result", case=name, cause=str(error)) from None


def _watch(command: list[str], environment: dict[str, str], on_progress: OnProgress) -> None:
    """Run the command and report its progress. :raises FailedRun: it failed"""
    import subprocess  # as which

    failure: dict[str, Any] | None = None
    finished, last = False, ""
    with subprocess.Popen(
        command,
        env=environment,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        errors="replace",
        preexec_fn=_dying_with_us(),
        start_new_session=True,  # Ctrl-C reaches only this process, which ends YADE
    ) as process:
        try:
            for line in process.stdout or []:
                said = line.strip()
                message = _message(said)
                if "progress" in message:
                    finished = message["progress"] >= 1
                    on_progress(message["progress"])
                    if "steps" in message:
                        show_pace(message["steps"], message["steps_per_s"], message["progress"])
                elif "failure" in message:
                    failure = message["failure"]
                elif said:
                    last = said
        except BaseException:
            os.killpg(process.pid, signal.SIGKILL)  # YADE and its children
            raise
    if failure is not None:
        raise RunFailed(**failure)
    if process.returncode < 0:
        raise FailedRun(code="dem_killed", signal=-process.returncode)
    if process.returncode != 0 or not finished:
        raise FailedRun(code="yade_ended", cause=last or None, status=process.returncode)


def _message(line: str) -> dict[str, Any]:
    """Return the message in a line of YADE's output; an empty dict if the line is YADE's own or incomplete."""
    if not line.startswith(MARK):
        return {}
    try:
        found = json.loads(line.removeprefix(MARK))
    except ValueError:
        return {}
    return found if isinstance(found, dict) else {}


class RunFailed(FailedRun):
    """A failure that the script in YADE reports: ``the DEM run failed: CAUSE (PLACE, time T s, temperature change T
    K)[; REMEDY]``.

    :param cause: the problem
    :param place: name of the joint in the sentence, for example ``slider S1``
    :param reason: code of the failure in the plugin or the scene
    :param part: name of the part that failed, as in the case
    :param quantity: the quantity of this part that caused the failure
    """

    def __init__(
        self, cause: str, *, place: str = "", reason: str = "", part: str = "", quantity: str = "", **more: Any
    ) -> None:
        super().__init__(code="dem_failed", cause=cause, reason=reason, part=part, quantity=quantity, **more)
        self.words = place

    def __str__(self) -> str:
        where = [self.words] if self.words else []
        if self.time_s is not None:
            where.append(f"time {self.time_s:.9g} s")
        if self.temperature_change_K is not None:
            where.append(f"temperature change {self.temperature_change_K:.9g} K")
        said = f"{self.what}: {self.cause}" + (f" ({', '.join(where)})" if where else "")
        sentence = f"{self._where()}: {said}" if self._where() else said
        return f"{sentence}; {self.remedy}" if self.remedy else sentence


def _interrupted(output: Path) -> Interrupted:
    partial = output.with_name(output.name + ".partial")
    try:
        return Interrupted(run=Samples(read_samples(partial, whole=False), {}))
    except (OSError, ValueError, StatejumpError):
        return Interrupted(code="interrupted_before_first_sample")


def check_folder(folder: Path) -> None:
    """Raise NotAllowed if a folder contains files other than the input of a DEM run."""
    if folder.is_dir() and any(folder.iterdir()) and not (folder / RUNNER).is_file():
        raise NotAllowed("--keep-input", str(folder), code="folder_not_empty")


def keep_input(values: Mapping[str, Any], folder: Path) -> str:
    """Write script and data of a DEM run into a folder; return the shell command that repeats the run.

    :param values: the case as plain values, see :func:`statejump.core.yade_process.run`
    :raises NotAllowed: the folder has other files
    :raises NotWritten: the folder cannot be written
    """
    check_folder(folder)
    runner = _paths.YADE_SCRIPTS / "runner"
    files = {file.relative_to(runner): file.read_bytes() for file in runner.rglob("*.py")
             if file.name != "batch_case.py"}
    files[Path(DATA)] = (json.dumps(values, indent=1) + "\n").encode()
    for name, content in files.items():
        target = folder / name
        try:
            target.parent.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise not_written(target.parent, error) from None
        write_bytes(target, content)
    return shlex.join(["env", f"PYTHONPATH={python_path()}", *command_of(values, folder / RUNNER)])


def check_display() -> None:
    """Raise FailedRun if YADE has no display for its 3-D view."""
    if not (os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")):
        raise _no_display("there is no display")


def _no_display(cause: str, **details: Any) -> FailedRun:
    return FailedRun(code="no_display", cause=cause, **details)


def view(values: Mapping[str, Any], folder: Path) -> None:
    """Open YADE on a kept input, with its 3-D view and its prompt. Return when the user ends YADE.

    :raises FailedRun: there is no display, or YADE ended with an error
    """
    check_display()
    environment = dict(os.environ, PYTHONPATH=python_path(), STATEJUMP_VIEW="1")
    status = subprocess.run(command_of(values, folder / RUNNER, view=True), env=environment, check=False).returncode
    if status == NO_DISPLAY:
        display = os.environ.get("DISPLAY", "")
        raise _no_display(f"YADE cannot connect to the display {display!r}", value=display)
    if status != 0:
        raise FailedRun(code="yade_view_ended", status=status, case=values["case"]["name"])
