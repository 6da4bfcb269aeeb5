# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs inside YADE and answers requests, one line of JSON each, until the input ends.

A request names a module file and a task. The task runs in a forked process, so that a module can crash and requests do
not affect each other. If the process ends without an answer, its exit status is the answer.
"""
from __future__ import annotations

import importlib.util
import json
import os
import sys
import time
from pathlib import Path
from typing import Any

from yade import utils, wrapper


def module_in(folder: Path) -> Any:
    """Load the probe of a folder."""
    description = importlib.util.spec_from_file_location("_native", folder / "_native.so")
    module = importlib.util.module_from_spec(description)
    description.loader.exec_module(module)
    return module


def checks(folder: Path) -> dict[str, Any]:
    """Return the compiled declarations and the findings of the guard."""
    native = module_in(folder)
    description = native.description()
    check, sentence = native.interface_checks(wrapper)
    return {"description": description, "check": check, "sentence": sentence}


def scene(folder: Path) -> dict[str, Any]:
    """Run all checks of YADE's interface in a scene with everything that they might disturb."""
    O.bodies.append([utils.sphere((0, 0, 0), 1), utils.sphere((0, 0, 1.9), 1)])
    O.engines = [
        ForceResetter(),
        InsertionSortCollider([Bo1_Sphere_Aabb()]),
        InteractionLoop(
            [Ig2_Sphere_Sphere_ScGeom()],
            [Ip2_FrictMat_FrictMat_FrictPhys()],
            [Law2_ScGeom_FrictPhys_CundallStrack()],
        ),
        NewtonIntegrator(gravity=(0, 0, -9.81)),
    ]
    O.dt = 1e-5
    O.trackEnergy = True
    O.run(10, True)

    def on_disk() -> bytes:
        path = folder / "scene.xml"
        O.save(str(path), quiet=True)
        return path.read_bytes()

    before = on_disk()
    native = module_in(folder)
    start = time.perf_counter()
    check, sentence = native.all_checks(wrapper)
    seconds = time.perf_counter() - start
    return {"check": check, "sentence": sentence, "same": before == on_disk(), "seconds": seconds}


def package(folder: Path) -> dict[str, Any]:
    """Import the plugin's Python package, with the compiled test module as its native module."""
    sys.path.insert(0, str(folder))
    try:
        import statejump_yade  # noqa: F401
    except ImportError as error:
        return {"sentence": str(error), "cause": error.__cause__ is not None}
    return {"sentence": "", "cause": False}


TASKS = {"checks": checks, "scene": scene, "package": package}


def answer(request: dict[str, str]) -> dict[str, Any]:
    """Process a request in a forked process."""
    reading, writing = os.pipe()
    child = os.fork()
    if child == 0:
        try:
            result = TASKS[request["task"]](Path(request["folder"]))
        except Exception as error:  # noqa: BLE001 any error, because the caller must receive it
            result = {"error": f"{type(error).__name__}: {error}"}
        with os.fdopen(writing, "w") as stream:
            json.dump(result, stream)
        os._exit(0)
    os.close(writing)
    with os.fdopen(reading) as stream:
        text = stream.read()
    _, status = os.waitpid(child, 0)
    return json.loads(text) if text else {"crash": os.waitstatus_to_exitcode(status)}


with open(os.environ["STATEJUMP_REQUESTS"]) as requests, open(os.environ["STATEJUMP_ANSWERS"], "w") as answers:
    for line in requests:
        answers.write(json.dumps(answer(json.loads(line))) + "\n")
        answers.flush()
os._exit(0)
