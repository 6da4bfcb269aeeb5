# SPDX-License-Identifier: GPL-3.0-or-later
"""Loading of cases from files, names of shipped cases, and dicts. Every case is checked as a whole; the first failure
is raised."""
from __future__ import annotations

import difflib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from statejump import _paths
from statejump.bodies.case_files import with_bodies
from statejump.core.case import Case, CaseHeader, Origin
from statejump.core.errors import located
from statejump.core.item_files import with_tables
from statejump.core.temperature_files import with_files
from statejump.kinds import kind, names
from statejump.schema.fields import Section, definition, fields_of, section, section_of
from statejump.schema.paths import plain, with_keys_moved
from statejump.schema.rules import check_name
from statejump.schema.structure import structure
from statejump.schema.toml import read_toml

SHIPPED = "cases"


@definition
class _HeaderOnly(Section):
    case: CaseHeader = section(CaseHeader, required=True)


def _kind_name(data: Mapping[str, Any]) -> str:
    """Return the value of ``case.kind``, which selects all further checks."""
    header = data.get("case")
    wanted = header.get("kind") if isinstance(header, Mapping) else None
    if not isinstance(wanted, str):
        # Without a kind only the header can be checked, so that [caes] and knid are reported.
        structure(_HeaderOnly, {key: data[key] for key in data if difflib.get_close_matches(str(key), ["case"])})
    return check_name("case.kind", wanted, names())


def parse_case(
    data: Mapping[str, Any], file: Path | None = None, text: str = "", files_from: Path | None = None
) -> Case:
    """Return the case of a parsed case file.

    :param data: sections and keys, as tomllib returns them
    :param file: path of the file, for messages and for relative paths in the case
    :param text: text of the file
    :param files_from: folder of the temperature files and tables that the case names; None: such names are refused
    :raises StatejumpError: the first failure
    """
    with located(file=file):
        of_kind = kind(_kind_name(data))
        data = with_keys_moved(of_kind.Case, data, str(file or ""))
        data = with_bodies(data, files_from)
        if files_from is not None:
            data = with_files(data, files_from, section_of(fields_of(of_kind.Case)["thermal"]))
            data = with_tables(data, files_from, of_kind.Case)
        made = of_kind.case_from(data)
    return made.with_origin(Origin(data, file, text))


def found_case(path: str | Path) -> Path:
    """Return the path of a case file: the given path or, if it does not exist, a shipped case. So ``table1``,
    ``table1.toml`` and ``cases/table1.toml`` are found from every folder."""
    path = Path(path)
    try:
        if path.exists() or path.is_absolute():
            return path
    except OSError:  # a name too long, or a folder without search permission: reading the file reports the reason
        return path
    named = path if path.suffix else path.with_suffix(".toml")
    for place in (_paths.SHARE / named, _paths.SHARE / SHIPPED / named, _paths.SHARE / SHIPPED / "trusses" / named):
        if SHIPPED in place.relative_to(_paths.SHARE).parts and place.is_file():
            return place
    return path


def load_case(source: str | Path | Mapping[str, Any]) -> Case:
    """Return a case from a file, a shipped case or a dict.

    :param source: path of a case file; name of a shipped case, for example ``table1``; or sections and keys as a dict
    :raises StatejumpError: the file does not exist, or the case is invalid
    """
    if isinstance(source, Mapping):
        return parse_case(plain(source), files_from=Path())
    path = found_case(source)
    text, data = read_toml(path, "case")
    return parse_case(data, path, text, path.parent)
