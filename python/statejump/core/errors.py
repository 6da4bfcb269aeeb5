# SPDX-License-Identifier: GPL-3.0-or-later
"""What ends a command or a call early: a code and fields, from which the sentence is rendered.

``str(error)`` is one sentence, ``[FILE: ][ITEM: ]WHAT[: CAUSE][; REMEDY]``. :meth:`StatejumpError.fields` returns
the same facts by name. :mod:`statejump.core.error_codes` declares the codes and their sentences. Programs and tests
compare the code and the fields; nothing reads a sentence back.
"""
from __future__ import annotations

import re
from collections.abc import Sequence
from copy import copy
from dataclasses import dataclass
from math import isfinite
from os import PathLike, fspath
from typing import Any, ClassVar, Protocol, runtime_checkable

from statejump.core.error_codes import CODES

# Order of the fields in JSON.
FIELDS = (
    "kind", "code", "message", "file", "case", "item", "key", "value", "allowed", "time_s", "temperature_change_K",
    "joint", "nodes", "details", "cause", "remedy", "exit_status",
)


# Of a fault of the program itself; EX_SOFTWARE of sysexits.h. 1 says that a tolerance is missed.
INTERNAL_STATUS = 70
_CONTROL = re.compile("[\x00-\x08\x0b-\x1f\x7f-\x9f]")


def printable(text: str) -> str:
    """Return a text that a terminal takes as nothing but text: control characters but new lines as ``\\x1b``."""
    return _CONTROL.sub(lambda found: f"\\x{ord(found[0]):02x}", text)


def size(count: float) -> str:
    """Return a number of bytes for a sentence."""
    for unit in ("bytes", "kB", "MB", "GB"):
        if count < 1000:
            break
        count /= 1000
    else:
        unit = "TB"
    return f"{count:.3g} {unit}"


class _Absent:
    """No value was given; None is a value."""

    def __repr__(self) -> str:
        return "absent"

    def __reduce__(self) -> str:
        return "ABSENT"


ABSENT = _Absent()


class _Some:
    """Stands in a sentence for a number that is left open."""

    def __repr__(self) -> str:
        return "…"

    def __format__(self, how: str) -> str:
        return "…"


SOME: Any = _Some()


@dataclass(frozen=True)
class Range:
    """Numbers that a key allows: ``low`` to ``high`` [unit], without ``low`` itself if ``above``."""

    low: float
    high: float
    unit: str = "-"
    above: bool = False

    def __str__(self) -> str:
        if not isfinite(self.high):
            return "must be a number" + (f" above {self.low:g}" if isfinite(self.low) else "")
        if self.above:
            return f"must be above {self.low:g} and at most {self.high:g} [{self.unit}]"
        return f"must be between {self.low:g} and {self.high:g} [{self.unit}]"

    def __contains__(self, value: float) -> bool:
        return self.low <= value <= self.high and not (self.above and value == self.low)

    def to_json(self) -> dict[str, Any]:
        """Return the range as JSON takes it; an end without bound is left out."""
        ends = {"above" if self.above else "low": self.low, "high": self.high}
        return {key: end for key, end in ends.items() if isfinite(end)} | {"unit": self.unit}


@runtime_checkable
class _OfNumpy(Protocol):
    """A number or array of numpy, asked without numpy, which the start of the command does not load."""

    def tolist(self) -> Any: ...


def _without_type(value: Any) -> Any:
    """Return a number or array of numpy as what it holds: numpy 2 says the type of a number with it."""
    return value.tolist() if isinstance(value, _OfNumpy) and not isinstance(value, type) else value


def shown(value: Any) -> str:
    """Return a value as one would write it in a case file."""
    value = _without_type(value)
    if isinstance(value, bool):
        return str(value).lower()
    return repr(value)


class StatejumpError(Exception):
    """Bad input, or a run that could not be finished.

    :param what: what is wrong, without what the other fields say; by default what the code declares
    :param code: code, a key of ``CODES``; by default that of the class
    :param file: the file that is meant
    :param place: how the sentence calls the file, if not by its path alone (``results folder out/x``)
    :param case: name of the case that ran
    :param item: which table of a list is meant, as ``node 'tip'``
    :param key: key of a file, name of an argument
    :param value: what was given for it
    :param allowed: what may be given: a range, or names
    :param joint: name of the joint
    :param nodes: names of nodes
    :param time_s: when [s]
    :param temperature_change_K: at which temperature change [K]
    :param cause: why; by default what the code declares, else what ``allowed`` says
    :param remedy: what would help; by default what the code declares
    :param details: further fields, which the sentences of the code name
    """

    kind: ClassVar[str] = "bad_input"
    default_code: ClassVar[str] = "bad_input"
    exit_status: ClassVar[int] = 2

    def __init__(
        self,
        what: str = "",
        *,
        code: str | None = None,
        file: object = None,
        place: str | None = None,
        case: str | None = None,
        item: str | None = None,
        key: str | None = None,
        value: Any = ABSENT,
        allowed: Range | Sequence[str] | None = None,
        joint: str | None = None,
        nodes: Sequence[str] = (),
        time_s: float | None = None,
        temperature_change_K: float | None = None,
        cause: str | None = None,
        remedy: str | None = None,
        **details: Any,
    ) -> None:
        super().__init__()
        self.code, self.details = code or self.default_code, details
        declared = CODES[self.code]
        self.what = what or declared.what.format_map(details)
        cause, remedy = cause or declared.cause.format_map(details), remedy or declared.remedy.format_map(details)
        self.file = None if file is None else str(file)
        self.place, self.case, self.item, self.key, self.value = place, case, item, key, value
        self.allowed, self.joint, self.nodes = allowed, joint, tuple(nodes)
        self.time_s, self.temperature_change_K = time_s, temperature_change_K
        self.cause = cause or (str(allowed) if isinstance(allowed, Range) else None)
        self.remedy = remedy or None

    def __reduce__(self) -> tuple[Any, ...]:
        # Exceptions travel between the processes of a campaign.
        return (_remade, (type(self), self.__dict__.copy()))

    def phrase(self) -> str:
        """Return what is wrong, without file and item."""
        return self.what

    def located(self, *, file: object = None, case: str | None = None) -> StatejumpError:
        """Say in which file or case it is, where that is not known yet; return the error itself."""
        if self.file is None and file is not None:
            self.file = str(file)
        if self.case is None and case is not None:
            self.case = case
        return self

    def _where(self) -> str | None:
        if self.place is not None:
            return self.place
        if self.file is not None:
            return self.file
        return None if self.case is None else f"case {self.case}"

    def __str__(self) -> str:
        phrase, item = self.phrase(), self.item
        if item and item.endswith("]"):  # an item without a name is called by its place: vary[1].key
            phrase, item = f"{item}.{phrase}", None
        sentence = ": ".join(part for part in (self._where(), item, phrase, self.cause) if part)
        if not self.remedy:
            return sentence
        return f"{sentence}{'; ' if self.cause else ': '}{self.remedy}"

    def general(self) -> str:
        """Return the sentence without what differs from one sample of a campaign to the next: the number that was
        given, when it happened. Failures of one kind have the same."""
        alike = copy(self)
        if isinstance(self.value, float):
            alike.value = SOME
        for name in ("time_s", "temperature_change_K"):
            if getattr(self, name) is not None:
                setattr(alike, name, SOME)
        return str(alike)

    def fields(self) -> dict[str, Any]:
        """Return the failure by the names of ``FIELDS``; what is not known is left out."""
        allowed = self.allowed.to_json() if isinstance(self.allowed, Range) else self.allowed and list(self.allowed)
        known = {
            "kind": self.kind, "code": self.code, "message": str(self), "file": self.file, "case": self.case,
            "item": self.item, "key": self.key, "value": None if self.value is ABSENT else _plain(self.value),
            "allowed": allowed or None, "time_s": self.time_s,
            "temperature_change_K": self.temperature_change_K, "joint": self.joint or None,
            "nodes": list(self.nodes) or None,
            "details": {name: _plain(detail) for name, detail in self.details.items()} or None,
            "cause": self.cause or None, "remedy": self.remedy or None, "exit_status": self.exit_status,
        }
        return {name: known[name] for name in FIELDS if known[name] is not None}


def _remade(kind: type[StatejumpError], state: dict[str, Any]) -> StatejumpError:
    error = kind.__new__(kind)
    Exception.__init__(error)
    error.__dict__.update(state)
    return error


def _plain(value: Any) -> Any:
    """Return a value if JSON can hold it, else as text."""
    import json  # not to start the command

    value = _without_type(value)
    if isinstance(value, PathLike):
        return str(fspath(value))
    try:
        json.dumps(value, allow_nan=False)
    except (TypeError, ValueError):
        return repr(value)
    return value


class NotAllowed(StatejumpError):
    """A key has a value that it may not have: ``KEY = VALUE is not allowed[ BESIDE]: CAUSE``.

    :param key: the key
    :param value: what was given; ABSENT: the key may not be there at all, or its value says nothing
    :param cause: why; by default what ``allowed`` says
    :param beside: with what it is not allowed, as ``with start.mode = 'loaded'``
    """

    default_code = "not_allowed"

    def __init__(self, key: str, value: Any = ABSENT, cause: str | None = None, *, beside: str = "",
                 **more: Any) -> None:
        super().__init__(key=key, value=value, cause=cause, **more)
        self.beside = beside or CODES[self.code].beside.format_map(self.details)

    def phrase(self) -> str:
        given = self.key if self.value is ABSENT else f"{self.key} = {shown(self.value)}"
        return f"{given} is not allowed" + (f" {self.beside}" if self.beside else "")

    def fields(self) -> dict[str, Any]:
        found = super().fields()
        if self.beside and "cause" not in found:  # what it does not go with is why
            found["cause"] = self.beside
        return {name: found[name] for name in FIELDS if name in found}


class MissingKey(StatejumpError):
    """A key or a section that must be there is not: ``KEY is missing[: NEEDS]``."""

    default_code = "missing_key"

    def __init__(self, key: str, needs: str | None = None, *, section: str = "", **more: Any) -> None:
        super().__init__(key=key, cause=needs, **more)
        self.section = section

    def phrase(self) -> str:
        return f"{self.section or self.key} is missing"


class UnknownKey(StatejumpError):
    """There is no such key or section: ``KEY is unknown: did you mean OTHER?``.

    :param key: the key
    :param section: how the sentence calls a section, as ``section [demm]``
    :param value: where the key names another key: the unknown one
    :param beside: where it is unknown, as ``in a case of kind 'truss'``
    :param cause: which are known, where none is near
    :param remedy: which was probably meant
    """

    default_code = "unknown_key"

    def __init__(self, key: str, *, section: str = "", beside: str = "", **more: Any) -> None:
        super().__init__(key=key, **more)
        self.section, self.beside = section, beside or CODES[self.code].beside.format_map(self.details)

    def phrase(self) -> str:
        given = self.section or self.key or ""
        if self.value is not ABSENT:
            given = f"{given} = {shown(self.value)}"
        return f"{given} is unknown" + (f" {self.beside}" if self.beside else "")


class Unreadable(StatejumpError):
    """A file cannot be read, or is not what it should be."""

    default_code = "unreadable"


class MissingPart(Unreadable, KeyError):
    """A part of a file that is asked for is not there; a KeyError, as of any mapping."""


class FailedRun(StatejumpError):
    """The input is right as far as it can be judged; the run could not be finished."""

    kind = "failed_run"
    default_code = "failed_run"


class NotWritten(StatejumpError):
    """A file or folder of results cannot be written."""

    kind = "output"
    default_code = "not_written"


class TolerancesMissed(StatejumpError):
    """The comparison ran and tolerances of the case are missed.

    :param quantities: names of the rows that miss theirs
    """

    exit_status = 1
    kind = "tolerance_missed"
    default_code = "tolerance_missed"

    def __init__(self, quantities: Sequence[str], **more: Any) -> None:
        super().__init__(cause=", ".join(quantities), **more)
        self.quantities = tuple(quantities)


class Interrupted(StatejumpError):
    """The user stopped a run.

    :param what: what was kept
    :param run: the run as far as it came; None: nothing of it is left
    """

    exit_status = 130
    kind = "interrupted"
    default_code = "interrupted"

    def __init__(self, what: str = "", *, run: Any = None, **more: Any) -> None:
        super().__init__(what, **more)
        self.run = run


def fields(kind: str, message: str, exit_status: int, **details: Any) -> dict[str, Any]:
    """Return a failure that is no StatejumpError in the same form, in the order of ``FIELDS``; its code is its kind."""
    known = {"kind": kind, "code": kind, "message": message, **details, "exit_status": exit_status}
    return {name: known[name] for name in FIELDS if known.get(name) is not None}


def to_json(failure: dict[str, Any]) -> str:
    """Return the fields of a failure as one line."""
    import json  # not to start the command

    line = json.dumps(failure, ensure_ascii=False, allow_nan=False)
    return _CONTROL.sub(lambda found: f"\\u{ord(found[0]):04x}", line)
