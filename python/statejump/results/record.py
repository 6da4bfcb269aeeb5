# SPDX-License-Identifier: GPL-3.0-or-later
"""Output of a command: the result file of its runs, and CSV files with the same data."""
from __future__ import annotations

import json
import platform
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from statejump import _paths
from statejump._version import __version__
from statejump.core.case import Case
from statejump.core.comparison import Comparison
from statejump.core.output import check_suffix
from statejump.core.run import Run, warnings_of
from statejump.core.tables import write_json
from statejump.kinds import require
from statejump.kinds.protocol import ItemNames, SceneDescription
from statejump.results import export_csv
from statejump.results.contents import Answers, Result
from statejump.results.layout import SUFFIX
from statejump.results.write import write
from statejump.schema.fields import attached_to_json

# Name of the result file of each command.
FILES = {"reduced": "reduced", "dem": "dem", "compare": "comparison", "truss answers": "answers"}


def result_of(
    command: str, case: Case, runs: Mapping[str, Run], comparison: Comparison | None = None,
    answers: Answers | None = None,
) -> Result:
    """Return the runs of a case as the contents of a result file.

    :param command: ``reduced``, ``dem``, ``compare`` or ``truss answers``
    :param runs: runs by model
    """
    return Result(
        command=command,
        complete=all(run.complete for run in runs.values()),
        name=case.name,
        kind=case.kind,
        title=case.title,
        source=case.case.source,
        case_text=case.origin.text,
        case_json=json.dumps(case.with_defaults(), indent=1, default=attached_to_json),
        provenance=provenance(case, runs.get("dem")),
        names=require(case, ItemNames).names(case),
        scene=require(case, SceneDescription).scene(case),
        models=dict(runs),
        rows=None if comparison is None else comparison.rows,
        reasons=[] if comparison is None else list(comparison.reasons),
        warnings=warnings_of(runs.values()),
        answers=answers,
        members=case.member_histories,
    )


def save_as(
    path: Path, command: str, case: Case, runs: Mapping[str, Run], comparison: Comparison | None = None
) -> Path:
    """Write the result file of runs under a given name; return its path.

    :raises NotAllowed: the name has the suffix of another format
    """
    check_suffix("path", path, SUFFIX)
    path = path if path.suffix else path.with_suffix(SUFFIX)
    write(result_of(command, case, runs, comparison), path)
    return path


def save(
    command: str, case: Case, runs: Mapping[str, Run], folder: Path, comparison: Comparison | None = None,
    answers: Answers | None = None,
) -> Path:
    """Write the result file of runs, and CSV files of their histories or of the answers; return its path.

    Files of incomplete runs get other names, so that they do not replace files of complete runs.

    :param folder: an existing results folder
    """
    result = result_of(command, case, runs, comparison, answers)
    mark = "" if result.complete else ".interrupted"
    path = folder / f"{FILES[command]}{mark}{SUFFIX}"
    write(result, path)
    if result.answers is not None:  # the CSV histories in the folder belong to a comparison
        export_csv.write_answers(result.answers, folder)
        return path
    export_csv.write_histories(result, folder, mark)
    if "dem" in runs and result.complete:
        write_json(folder / "dem_run.json", runs["dem"].about)
    return path


def provenance(case: Case, dem: Run | None) -> dict[str, Any]:
    """Return the attributes of the group ``/provenance``.

    :param dem: the DEM run; None: there is no DEM run
    """
    found: dict[str, Any] = {
        "statejump_version": __version__,
        "git_commit": _paths.GIT_COMMIT,
        "python_version": platform.python_version(),
        "numpy_version": np.__version__,
        "h5py_version": h5py.__version__,
        "hdf5_version": h5py.version.hdf5_version,
    }
    sections = case.with_defaults()
    seed = sections.get("ensemble", {}).get("seed")
    if seed is not None:
        found["seed"] = seed
    if dem is not None:
        if "yade_version" in dem.about:
            found["yade_version"] = dem.about["yade_version"]
        threads = sections.get("dem", {}).get("threads")
        if threads is not None:
            found["threads"] = threads
    return found
