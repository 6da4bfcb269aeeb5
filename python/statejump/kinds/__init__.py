# SPDX-License-Identifier: GPL-3.0-or-later
"""The registry of kinds of cases. A kind is a subfolder here or a user's module, and one entry of the registry.

:func:`register` adds a user's kind. The environment variable ``STATEJUMP_KINDS`` adds users' kinds for every command.
It is a list of ``module:OBJECT``, separated by commas.
"""
from __future__ import annotations

import os
from importlib import import_module
from typing import Any

from statejump.core.case import Case
from statejump.core.errors import StatejumpError
from statejump.kinds.protocol import Capability, Kind, needed, supports
from statejump.schema.rules import check_name

VARIABLE = "STATEJUMP_KINDS"
# Module and object of each kind; a module is imported at the first use of its kind.
KINDS: dict[str, str] = {
    name: f"statejump.kinds.{name}:KIND" for name in ("spring_slider", "umbrella", "statics", "truss")
}
_loaded: dict[str, Kind[Any]] = {}
_read_from: list[str] = []


def _object(place: str) -> Kind[Any]:
    module, _, name = place.partition(":")
    try:
        found: Kind[Any] = getattr(import_module(module), name)
    except (ImportError, AttributeError) as problem:
        raise StatejumpError(code="kind_not_loaded", value=place, cause=str(problem), name=place) from None
    return found


def register(place: str) -> Kind[Any]:
    """Add or replace a user's kind, and return it.

    :param place: name of the kind as ``module:OBJECT``; workers of a campaign import it too
    :raises StatejumpError: the module does not contain the object
    """
    found = _object(place)
    KINDS[found.name], _loaded[found.name] = place, found
    return found


def registered() -> list[str]:
    """Return the modules of the kinds outside the project."""
    return [place for place in KINDS.values() if not place.startswith("statejump.kinds.")]


def _from_environment() -> None:
    wanted = os.environ.get(VARIABLE, "")
    if wanted and wanted not in _read_from:
        _read_from.append(wanted)
        for place in wanted.split(","):
            try:
                register(place.strip())
            except StatejumpError as failure:
                _read_from.clear()
                failure.place = VARIABLE  # the environment causes the failure, not the file
                raise


def names() -> list[str]:
    """Return the names of all kinds."""
    _from_environment()
    return list(KINDS)


def kind(name: str) -> Kind[Any]:
    """Return a kind by its name. :raises NotAllowed: there is none"""
    _from_environment()
    check_name("case.kind", name, list(KINDS))
    if name not in _loaded:
        _loaded[name] = _object(KINDS[name])
    return _loaded[name]


def of(case: Case) -> Kind[Any]:
    """Return the kind of a case."""
    return kind(case.KIND)


def has(case: Case, protocol: type) -> bool:
    """Whether the kind of a case has a capability."""
    return supports(of(case), protocol)


def require(case: Case, protocol: type[Capability]) -> Capability:
    """Return the kind of a case, typed as the given capability.

    :raises NotAllowed: the kind lacks the capability; the message names the kinds that have it
    """
    return needed(of(case), protocol, case)


def names_of_kinds_with(protocol: type) -> list[str]:
    """Return the names of the kinds that have a capability."""
    return [name for name in names() if supports(kind(name), protocol)]


def columns_of(name: str) -> tuple[str, ...]:
    """Return the columns of a kind in the order of its CSV files; for an unknown kind, the columns of all kinds."""
    return kind(name).COLUMNS if name in names() else ("time_s", "temperature_change_K")
