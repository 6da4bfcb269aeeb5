# SPDX-License-Identifier: GPL-3.0-or-later
"""Owner of a results folder: a copied case with the same name must not replace the results of the original.

A results folder has a small hidden file with the case file, relative to the folder, and a checksum of the case. Results
of an edited file replace those of the same file. Another case from another file is refused.
"""
from __future__ import annotations

import hashlib
import json
import os
from pathlib import Path
from typing import TYPE_CHECKING

from statejump.core.errors import NotWritten
from statejump.core.tables import write_json
from statejump.schema.fields import attached_to_json

if TYPE_CHECKING:
    from statejump.core.case import Case

NAME = ".case.json"


def _known(folder: Path) -> dict[str, str]:
    """Return the record of the case in a folder; empty: no readable record."""
    try:
        found = json.loads((folder / NAME).read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return {}
    return found if isinstance(found, dict) else {}


def _file(folder: Path, case: Case) -> str:
    """Return the case file relative to the folder; "": the case was made in Python."""
    file = case.origin.file
    return "" if file is None else os.path.relpath(file.resolve(), folder.resolve())


def _checksum(case: Case) -> str:
    text = json.dumps(case.with_defaults(), sort_keys=True, default=attached_to_json)
    return hashlib.sha256(text.encode()).hexdigest()


def check(folder: Path, case: Case) -> None:
    """Raise NotWritten if the folder holds results of another case from another file."""
    known = _known(folder)
    if not known or (known.get("file") and known.get("file") == _file(folder, case)):
        return
    if known.get("sha256") == _checksum(case):
        return
    other = os.path.relpath(folder / str(known.get("file"))) if known.get("file") else "a case made in Python"
    raise NotWritten(code="results_of_other_case", place=f"results folder {folder}", file=folder, other=other)


def write(staged: Path, folder: Path, case: Case) -> None:
    """Write the owner's file of a folder among its staged files."""
    write_json(staged / NAME, {"file": _file(folder, case), "sha256": _checksum(case)})
