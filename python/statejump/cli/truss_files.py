# SPDX-License-Identifier: GPL-3.0-or-later
"""Code shared by commands that write a case file of a truss."""
from __future__ import annotations

import os
from pathlib import Path
from typing import Any

from statejump.core.errors import StatejumpError
from statejump.core.output import check_suffix, check_target
from statejump.kinds.truss.generate.document import table_path
from statejump.kinds.truss.sections import sections_in_files

# Of the option --tables.
TABLES: dict[str, Any] = {
    "is_flag": True,
    "help": "Write nodes, links, joints and springs into CSV files beside the case file, one row an item.",
}


def new_files(output: Path, tables: bool, force: bool) -> tuple[str, ...]:
    """Return the lists that are written to files beside the case.

    :param tables: whether to write such files
    :param force: whether files may be overwritten
    :raises StatejumpError: a file exists already, or cannot be written
    """
    check_suffix("--output", output, ".toml")
    beside = sections_in_files() if tables else ()
    for path in (output, *(table_path(output, section) for section in beside)):
        if os.path.exists(path) and not force:
            raise StatejumpError(code="exists_already", file=path)
    check_target(output)
    return beside
