# SPDX-License-Identifier: GPL-3.0-or-later
"""Case files: one definition of every parameter, validated once.

A case is bad as a whole if one value is: :func:`load_case` raises
:class:`~statejump.core.errors.StatejumpError` with one sentence that names the file, the key, the value
and the range.
"""
from __future__ import annotations

import difflib
from pathlib import Path
from typing import Any

from statejump.schema.fields import Case, CaseHeader, Section, check_name, check_radii, parsed, thermal_problem
from statejump.kinds.spring_slider.case import SpringSliderCase
from statejump.kinds.statics.case import StaticsCase
from statejump.kinds.truss.case import TrussCase
from statejump.kinds.umbrella.case import UmbrellaCase
from statejump.core.errors import StatejumpError
from statejump.schema.toml import read_toml

__all__ = [
    "Case", "SpringSliderCase", "StaticsCase", "TrussCase", "UmbrellaCase", "check_radii", "load_case", "parse_case",
]

# A kind is a module of its own and its class here.
KINDS: dict[str, type[Case]] = {
    kind.KIND: kind for kind in (SpringSliderCase, UmbrellaCase, StaticsCase, TrussCase)
}


class _HeaderOnly(Section):
    case: CaseHeader


def _kind(data: dict[str, Any], name: str) -> type[Case]:
    """Return the kind that ``case.kind`` names; everything else depends on it."""
    header = data.get("case")
    wanted = header.get("kind") if isinstance(header, dict) else None
    if not isinstance(wanted, str):
        # Without a kind only the header can be judged: [caes] and knid are named as such.
        parsed(_HeaderOnly, {key: data[key] for key in data if difflib.get_close_matches(key, ["case"])}, name)
    try:
        return KINDS[check_name(wanted, list(KINDS))]
    except ValueError as reason:
        raise StatejumpError(f"{name}: case.kind = {wanted!r} is not allowed: {reason}") from None


def parse_case(data: dict[str, Any], name: str) -> Case:
    """Return the case in a parsed TOML document.

    :param data: what tomllib returned
    :param name: name of the file, for messages
    """
    case = parsed(_kind(data, name), data, name)
    problem = thermal_problem(case.thermal) or case.problem()
    if problem is not None:
        raise StatejumpError(f"{name}: {problem}")
    return case


def load_case(path: str | Path) -> Case:
    """Return the validated case of a TOML file."""
    return parse_case(read_toml(path, "case")[1], str(path))
