# SPDX-License-Identifier: GPL-3.0-or-later
"""Code shared by the studies of the paper: refusal of a case, and the command on each page."""
from __future__ import annotations

import os
from pathlib import Path
from typing import Any

from statejump import _paths
from statejump.core.case import Case
from statejump.core.errors import NotAllowed


def refused(case: Case, key: str, value: Any, cause: str) -> NotAllowed:
    """Return the error with the reason why a study does not support a case."""
    return NotAllowed(key, value, cause, file=case.origin.file, case=case.name)


def made_by(command: str, case: Case) -> str:
    """Return the command that makes a page again. It names the case file relative to the current folder, or by its
    shipped name; it names none if the case was made or changed in Python."""
    origin = case.origin
    if origin.file is None or not origin.text:
        return f"statejump {command}"
    file = origin.file.resolve()
    for folder in (Path.cwd(), _paths.SHARE.resolve()):
        if file.is_relative_to(folder):
            return f"statejump {command} {file.relative_to(folder)}"
    return f"statejump {command} {os.path.relpath(file)}"
