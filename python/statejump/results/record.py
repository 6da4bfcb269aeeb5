# SPDX-License-Identifier: GPL-3.0-or-later
"""What a command leaves behind: the result file of its run, and from it the CSV files."""
from __future__ import annotations

import json
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Optional

from statejump.kinds.registry import Case
from statejump.core.comparison import Quantity
from statejump.core.yade_process import DemRun
from statejump.core.history import History
from statejump.results import export_csv
from statejump.results.contents import Answers, ModelRun, Result
from statejump.results.kinds import kind_of
from statejump.results.layout import SUFFIX
from statejump.results.provenance import provenance
from statejump.results.write import write

# Name of the file that each command writes.
FILES = {"reduced": "reduced", "dem": "dem", "compare": "comparison", "truss answers": "answers"}


def case_text(case_file: Path) -> str:
    """Return a case file as given; to be called when the case is loaded, before it runs."""
    return case_file.read_bytes().decode("utf-8")


@dataclass
class Record:
    """The run of a command while it goes on.

    :param command: ``reduced``, ``dem``, ``compare`` or ``truss answers``
    :param case: the case
    :param case_text: its file as given; "" if there is none
    :param folder: results folder, exists
    """

    command: str
    case: Case
    case_text: str
    folder: Path
    models: dict[str, ModelRun] = field(default_factory=dict)
    warnings: list[str] = field(default_factory=list)
    dem_summary: Optional[dict[str, Any]] = None
    answers: Optional[Answers] = None

    def add_dem(self, done: DemRun) -> None:
        """Take a DEM run."""
        self.models["dem"] = kind_of(self.case).dem_run(self.case, done)
        self.dem_summary = done.summary

    def result(self, rows: Optional[list[Quantity]] = None, complete: bool = True) -> Result:
        """Return what there is so far as the contents of a file."""
        kind, header = kind_of(self.case), self.case.case
        return Result(
            command=self.command,
            complete=complete,
            name=self.case.name,
            kind=self.case.kind,
            title=self.case.title,
            source=header.source,
            case_text=self.case_text,
            case_json=json.dumps(self.case.dict(), indent=1),
            provenance=provenance(self.case, self.dem_summary),
            names=kind.names(self.case),
            scene=kind.scene(self.case),
            models=dict(self.models),
            comparison=rows,
            warnings=list(self.warnings),
            answers=self.answers,
        )

    def save(self, rows: Optional[list[Quantity]] = None) -> Path:
        """Write the result file of a finished run and the CSV files of its histories, or of its answers."""
        return self._write(self.result(rows), "")

    def keep(self, samples: History) -> Path:
        """Write what an interrupted DEM run and the models before it gave, marked as not complete."""
        self.add_dem(DemRun(samples, {}))
        return self._write(self.result(complete=False), ".interrupted")

    def _write(self, result: Result, mark: str) -> Path:
        path = self.folder / f"{FILES[self.command]}{mark}{SUFFIX}"
        write(result, path)
        if result.answers is None:
            export_csv.write_histories(result, self.folder, mark)
        else:  # the histories beside it are those of a comparison
            export_csv.write_answers(result.answers, self.folder)
        return path
