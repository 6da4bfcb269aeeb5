# SPDX-License-Identifier: GPL-3.0-or-later
"""Code shared by the studies of the paper: the rejection of a case, and the command named on each page."""
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
    """Return the command that makes a page again. It names the case file relative to the current folder, or a shipped
    case by its name. It names no case that was made or changed in Python."""
    origin = case.origin
    if origin.file is None or not origin.text:
        return f"statejump {command}"
    file = origin.file.resolve()
    for folder in (Path.cwd(), _paths.SHARE.resolve()):
        if file.is_relative_to(folder):
            return f"statejump {command} {file.relative_to(folder)}"
    return f"statejump {command} {os.path.relpath(file)}"
