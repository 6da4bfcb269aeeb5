# SPDX-License-Identifier: GPL-3.0-or-later
"""Cases of Python as case files."""
from __future__ import annotations

import os
from pathlib import Path
from typing import Any

from statejump.core.case import Case
from statejump.core.errors import NotAllowed
from statejump.core.later import Later
from statejump.core.output import check_suffix, check_target, write_atomically
from statejump.core.tables import write_columns
from statejump.core.temperature_files import Histories
from statejump.schema.toml import to_toml

_SAVED_BODIES = Later("statejump.bodies.case_files:save_bodies")
OF_MEMBERS = ("members", "table_time_s", "table_temperature_change_K")  # keys that members_file replaces


def document_of(case: Case) -> dict[str, Any]:
    """Return sections and keys as they were given, without keys that have no value."""
    return {section: _given(part) for section, part in case.origin.document.items() if part not in ({}, [], None)}


def _given(part: Any) -> Any:
    if isinstance(part, dict):
        return {key: value for key, value in part.items() if value is not None}
    return [_given(item) for item in part] if isinstance(part, list) else part


def text_of(case: Case) -> str:
    """Return a case as the text of a case file.

    :raises NotAllowed: the case has temperature histories of members, which need a file of their own
    """
    made = document_of(case)
    if made.get("thermal", {}).get("members") is not None:
        raise NotAllowed("thermal.members", code="members_file_not_in_text")
    for item in made.get("body", ()):
        if item.get("content") is not None:
            raise NotAllowed("body.content", code="body_content_not_in_text", item=f"body {item['name']!r}")
    return to_toml(made)


def save(case: Case, path: Path) -> Path:
    """Write a case as a case file, and temperature histories of members as a table beside it; return its path.

    :raises NotAllowed: the file name has a suffix other than ``.toml``
    :raises NotWritten: a file cannot be written
    """
    check_suffix("path", path, ".toml")
    path = path if path.suffix else path.with_suffix(".toml")
    check_target(path)
    made = document_of(case)
    members = made.get("thermal", {}).get("members")
    if isinstance(members, Histories):
        beside = path.with_name(f"{path.stem}_members.csv")
        columns = {f"{name}_K": values for name, values in zip(members.names, members.temperature_change_K.T)}
        write_columns({"time_s": members.time_s, **columns}, beside)
        made["thermal"] = {key: value for key, value in made["thermal"].items() if key not in OF_MEMBERS}
        made["thermal"]["members_file"] = beside.name
    for part in made.values():
        for key, value in part.items() if isinstance(part, dict) else ():
            if key.endswith("_file") and part is not made.get("thermal"):  # of a mesh, relative to the case
                part[key] = os.path.relpath(case.origin.folder / value, path.parent)
    if made.get("body"):
        made["body"] = _SAVED_BODIES(made["body"], path)
    text = to_toml(made)
    with write_atomically(path) as stream:
        stream.write(text)
    return path
