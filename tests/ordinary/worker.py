# SPDX-License-Identifier: GPL-3.0-or-later
"""Solves the structures named on standard input, one per line, and answers each with two lines of JSON: verdict of
theory, and result of the solver. This is a separate process, because a solver may crash. SIGPROF ends it if the solver
exceeds the CPU time given as argument [s]."""
from __future__ import annotations

import json
import signal
import sys
import time
from dataclasses import asdict
from typing import Any

import numpy as np

import evolution
import statejump as sj
import structures
from oracle import FAR, Verdict, judge
from sketch import Document
from statejump.core.errors import FailedRun, StatejumpError

# Forces and jumps of structures that should have none, over those of a bar of fixed length: condition number of a long
# girder (1e7) times rounding (2e-16), with a margin.
NOTHING = 1e-8


def run(document: Document) -> dict[str, Any]:
    """Return outcome, reason and message of a run of the reduced model with default options."""
    try:
        case = sj.load(document)
    except StatejumpError as refused:
        return {"outcome": "refused", "reason": type(refused).__name__, "sentence": str(refused)}
    began = time.process_time()
    try:
        found = case.reduced()
    except FailedRun as failed:
        return {"outcome": "failed", "reason": getattr(failed, "reason", type(failed).__name__),
                "sentence": str(failed), "seconds": time.process_time() - began}
    except StatejumpError as refused:
        return {"outcome": "refused", "reason": type(refused).__name__, "sentence": str(refused)}
    seconds = time.process_time() - began
    return {"outcome": "finished", "reason": "", "sentence": "; ".join(found.warnings), "seconds": seconds,
            **numbers(found)}


def numbers(found: Any) -> dict[str, Any]:
    """Return the numbers of a finished run that are checked."""
    path, truss = found.native, found.native.truss
    size = float(np.ptp(truss.nodes.position_m, axis=0).max())
    moved, ends = path.states["displacement_m"], path.cycle_ends["displacement_m"]
    free_m = float((np.abs(truss.links.thermal_expansion_per_K) * truss.links.stress_free_length_m).max()
                   * np.abs(truss.temperature_ranges_K).max())
    return {
        "size_m": size, "start_share": float(np.abs(moved[0]).max()) / size,
        "jump_m": float(np.linalg.norm(ends[-1] - ends[0], axis=1).max()),
        "mean_walk_m": float((ends[-1] - ends[-2])[:, 0].mean()) if len(ends) > 1 else 0.0,
        "largest_m": float(np.abs(moved).max()), "free_m": free_m,
        "force_N": float(np.abs(path.states["axial_force_N"]).max()),
        "energy_residue_J": float(path.energy_residue_J),
        "ends": ends,
    }


def apart(document: Document, found: dict[str, Any]) -> float:
    """Return the largest difference of a run from small-displacement theory, over the largest displacement."""
    expected = evolution.ends(document)
    got = found["ends"][:, :, : document["truss"]["dimension"]].reshape(len(expected), -1)
    return float(np.abs(got - expected).max()) / max(found["largest_m"], found["free_m"])


def checked(structure: structures.Structure, verdict: Verdict, found: dict[str, Any]) -> str:
    """Return the faults of a finished run, "" for none."""
    if found["start_share"] > FAR and "start" not in found["sentence"]:
        return "far start"
    largest = max(found["largest_m"], found["free_m"])
    if structure.joints == 0 and found["jump_m"] > NOTHING * largest:
        return "jump without joints"
    # In heating and again in cooling, the resting block is one of two neighbours: twice the expansion of one bar.
    if structure.walk_m is not None and abs(abs(found["mean_walk_m"]) - structure.walk_m) > 2 * found["free_m"]:
        return "walk"
    if structure.walk_m is None and verdict.class_a and evolution.applies(structure.document):
        found["difference"] = apart(structure.document, found)
        if found["difference"] > evolution.TOLERANCE:
            small = evolution.scaled(structure.document, evolution.SMALL)
            found["difference"] = apart(small, numbers(sj.load(small).reduced()))
        if found["difference"] > evolution.TOLERANCE:
            return "displacements"
    return ""


def answer(family: str, seed: int, limit_s: float) -> None:
    """Print both lines of a structure."""
    structure = structures.make(family, seed)
    verdict = judge(structure.document)
    print(json.dumps({**asdict(verdict), "joints": structure.joints, "clearance": structure.clearance,
                      "plan": structure.plan, "loaded": structure.loaded}), flush=True)
    signal.setitimer(signal.ITIMER_PROF, limit_s)
    found = run(structure.document)
    signal.setitimer(signal.ITIMER_PROF, 0)
    if found["outcome"] == "finished":
        wrong = checked(structure, verdict, found)
        if wrong:
            found |= {"outcome": "wrong", "reason": wrong}
    found.pop("ends", None)
    print(json.dumps(found), flush=True)


if __name__ == "__main__":
    for line in sys.stdin:
        named, number = line.split()
        answer(named, int(number), float(sys.argv[1]))
