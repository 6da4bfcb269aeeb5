# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs one case in YADE and writes its history; ``statejump dem CASE`` starts it.

    STATEJUMP_CASE_JSON=case.json STATEJUMP_OUTPUT=dem.samples yade -n -x yade_scripts/runner/run_case.py

Both variables name files beside this script by default: ``statejump dem CASE --keep-input FOLDER`` copies it there.
Without ``-x``, YADE keeps the scene after the run or after a failure and shows its prompt. ``STATEJUMP_VIEW=1`` opens
the 3-D view in place of a run.

The input is the resolved case as JSON. The script writes samples, see ``statejump.core.samples``, block by block to
``<output>.partial``, and renames this file at the end. A scene module defines ``COLUMNS`` or ``columns(case)``,
``build``, ``watched``, ``sample``, ``names``, ``step_remedy`` and ``summary``, documented in the modules beside this
script. The caller reads lines of standard output that begin with ``STATEJUMP``: ``{"progress": fraction}``, or
``{"failure": {...}}`` with the fields of a failure.
"""
import json
import os
import sys
import time
from contextlib import suppress
from importlib import import_module
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path

sys.path.insert(0, str(Path(sys.argv[0]).resolve().parent))
import statejump_yade as sj
import yade
from failures import described
from states import Recorder
from statejump.core.samples import names_line, rows_of

# Samples are processed in blocks, after this time or when they need this much memory.
SECONDS_OF_A_BLOCK, BYTES_OF_A_BLOCK = 0.1, 2**25
SECONDS_UNTIL_PACE = 2.0
# Between two checks of the samples, a run makes a hundredth of its steps or, for a small scene, this number divided by
# the number of bodies: some milliseconds in the JointStepper, which copies its arrays at each check.
STEPS_OF_A_BODY = 100_000
LONGEST_BODY_STEPS = 10_000_000  # number of bodies times steps between two checks at most: some seconds
NO_DISPLAY = 3  # exit status of a view


class CaseFailure(Exception):
    """A failure with the names of the case, as fields."""


def report(message):
    """Report to the caller on a new line, because YADE may have left a line open."""
    print(f"\nSTATEJUMP {json.dumps(message)}", flush=True)


def scene_of(name):
    """Return the module that builds the scene: a file beside this script, or the file of a user's kind."""
    if not name.endswith(".py"):
        return import_module(name)
    specification = spec_from_file_location(Path(name).stem, name)
    module = module_from_spec(specification)
    specification.loader.exec_module(module)
    return module


class Block:
    """Samples not yet written."""

    def __init__(self, case, kind, built, recorder, write):
        self._case, self._kind, self._built, self._recorder, self._write = case, kind, built, recorder, write
        self._started = self._written = time.perf_counter()
        self._told = False
        self.refused = None  # kept here, because YADE converts Python errors to tracebacks

    def record(self):
        """Write the collected samples if they are many or old enough, and report progress."""
        waited = time.perf_counter() - self._written
        if waited < SECONDS_OF_A_BLOCK and self._recorder.bytes_kept < BYTES_OF_A_BLOCK:
            return
        self.write()
        self._written = time.perf_counter()
        steps, passed = self._case["dem"]["number_of_steps"], self._written - self._started
        message = {"progress": O.iter / steps}
        if not self._told and passed > SECONDS_UNTIL_PACE:
            self._told = True
            message |= {"steps": steps, "steps_per_s": O.iter / passed}
        report(message)

    def write(self):
        """Write all samples."""
        states = self._recorder.take()
        if not len(states):
            return
        try:
            columns = self._kind.sample(self._case, self._built, states)
        except Exception as error:
            self.refused = error
            raise
        self._write(rows_of(columns))


def run(case, output):
    """Build the scene, run it, write the history and its summary."""
    kind = scene_of(case["scene"])
    steps = case["dem"]["number_of_steps"]
    # The caller chooses a multiple of the number of samples, so that the last sample is the end.
    every, rest = divmod(steps, case["number_of_samples"])
    if every == 0 or rest != 0:
        raise ValueError(f"dem.number_of_steps = {steps} is not a multiple of the samples")
    partial = output.with_name(output.name + ".partial")
    with partial.open("wb") as stream:
        columns = getattr(kind, "columns", None)  # a function, for a kind whose columns depend on the case
        stream.write(names_line(columns(case) if columns else kind.COLUMNS))

        def write(rows):
            stream.write(rows)
            stream.flush()

        recorder = Recorder(every)
        between = PyRunner(command="block.record()", label="between")
        built = kind.build(case, [recorder.engine, between])
        recorder.watch(kind.watched(built))
        between.iterPeriod = min(every * max(1, min(
            max(steps // 100, STEPS_OF_A_BODY // len(O.bodies)) // every, BYTES_OF_A_BLOCK // recorder.bytes_of_a_sample
        )), max(1, LONGEST_BODY_STEPS // len(O.bodies)))
        step_joints(case, between.iterPeriod)
        globals()["block"] = block = Block(case, kind, built, recorder, write)
        started, started_cpu = time.perf_counter(), time.process_time()
        try:
            O.run(steps + 1, True)  # one more step, because the state at the end is recorded in it
            block.write()
            elapsed, elapsed_cpu = time.perf_counter() - started, time.process_time() - started_cpu
            if O.iter != steps + 1:  # an error in the first steps can end the run without a message
                O.step()  # this call raises it
                raise RuntimeError(f"YADE stopped after {O.iter} of {steps + 1} steps")
        except Exception as error:
            taken = sj.take_failure()
            if not block.refused:
                with suppress(Exception):  # the failure may persist
                    block.write()  # writing an earlier sample may raise the failure too
            raise CaseFailure(described(
                block.refused or error, None if block.refused else taken, kind.names(case, built), O.time,
                built.program.temperatureChange, sj.stable_time_step, lambda stable: kind.step_remedy(case, stable),
            )) from error
    os.replace(partial, output)
    summary = {
        "steps": O.iter,
        "time_step_s": O.dt,
        "wall_time_s": elapsed,
        "cpu_time_s": elapsed_cpu,
        "yade_version": yade.config.version,
        "stable_time_step_s": sj.stable_time_step(),
        **kind.summary(case, built),
    }
    side = output.with_name(output.name + ".json")
    side.with_name(side.name + ".partial").write_text(json.dumps(summary, indent=2) + "\n")
    os.replace(side.with_name(side.name + ".partial"), side)


def step_joints(case, substeps):
    """Let the JointStepper make the steps, if the case selects it.

    :param substeps: number of steps of the JointStepper in one step of YADE's loop
    """
    if case["dem"].get("stepper") == "joint":
        O.engines = [O.engines[0], sj.JointStepper(substeps=substeps), *O.engines[1:]]


def view(case):
    """Build the scene and open YADE's 3-D view; its play button starts the steps."""
    if not yade.runtime.hasDisplay:
        os._exit(NO_DISPLAY)
    from yade import qt  # which opens the display

    scene_of(case["scene"]).build(case, [])
    step_joints(case, max(1, case["dem"]["number_of_steps"] // case["number_of_samples"]))
    # YADE's main script keeps its namespace, which keeps both windows alive.
    globals()["controller"], globals()["scene_view"] = qt.Controller(), qt.View()


def end(failure):
    """Report a failure; then end YADE. Without the option -x, show the traceback and keep the scene."""
    report({"failure": failure})
    if yade.runtime.opts.exitAfter:
        os._exit(2)


def main():
    """Run the case named in the environment, or the case file beside this script."""
    here = Path(sys.argv[0]).resolve().parent
    case = json.loads(Path(os.environ.get("STATEJUMP_CASE_JSON", here / "case.json")).read_text())
    if os.environ.get("STATEJUMP_VIEW"):
        view(case)
        return
    run(case, Path(os.environ.get("STATEJUMP_OUTPUT", here / "dem.samples")))
    report({"progress": 1.0})


try:
    main()
except CaseFailure as failure:
    end(failure.args[0])
    raise
except Exception as error:  # any exception, because the caller needs the cause
    end({"cause": " ".join(str(error).split())})
    raise
