# SPDX-License-Identifier: GPL-3.0-or-later
"""Errors that end a command or a call: a code and fields, from which the sentence is rendered.

``str(error)`` is one sentence, ``[FILE: ][ITEM: ]WHAT[: CAUSE][; REMEDY]``. :meth:`StatejumpError.fields` returns the
same facts by name. :mod:`statejump.core.error_codes` declares the codes and their sentences. Programs and tests compare
the code and the fields; nothing parses a sentence.
"""
from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
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


# Exit status of a fault of the program itself; EX_SOFTWARE of sysexits.h. 1 means that a tolerance is missed.
INTERNAL_STATUS = 70
_CONTROL = re.compile("[\x00-\x08\x0b-\x1f\x7f-\x9f]")


def printable(text: str) -> str:
    """Return a text whose control characters, except line feeds, are written as escapes such as ``\\x1b``."""
    return _CONTROL.sub(lambda found: f"\\x{ord(found[0]):02x}", text)


def size(count: float) -> str:
    """Format a number of bytes for a sentence."""
    for unit in ("bytes", "kB", "MB", "GB"):
        if count < 1000:
            break
        count /= 1000
    else:
        unit = "TB"
    return f"{count:.3g} {unit}"


class _Absent:
    """Marks an argument without a value, because None is a value."""

    def __repr__(self) -> str:
        return "absent"

    def __reduce__(self) -> str:
        return "ABSENT"


ABSENT = _Absent()


class _Some:
    """Placeholder in a message for an unspecified number."""

    def __repr__(self) -> str:
        return "…"

    def __format__(self, how: str) -> str:
        return "…"


SOME: Any = _Some()


@dataclass(frozen=True)
class Range:
    """Allowed range of a value: from ``low`` to ``high`` [unit]; if ``above`` is true, ``low`` itself is excluded."""

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
        """Return the range for JSON; an infinite end is omitted."""
        ends = {"above" if self.above else "low": self.low, "high": self.high}
        return {key: end for key, end in ends.items() if isfinite(end)} | {"unit": self.unit}


@runtime_checkable
class _OfNumpy(Protocol):
    """A number or array of numpy, recognised without importing numpy, which the start of the command does not load."""

    def tolist(self) -> Any: ...


def _without_type(value: Any) -> Any:
    """Convert a number or array of numpy to plain Python values, because numpy 2 prints its types."""
    return value.tolist() if isinstance(value, _OfNumpy) and not isinstance(value, type) else value


def shown(value: Any) -> str:
    """Return a value as text, as in a case file."""
    value = _without_type(value)
    if isinstance(value, bool):
        return str(value).lower()
    return repr(value)


class StatejumpError(Exception):
    """Invalid input, or a run that could not be finished.

    :param what: the problem, without the content of the other fields; default: the text of the code
    :param code: a key of ``CODES``; default: the code of the class
    :param file: the file
    :param place: name of the file in the sentence, if it is not its path alone (``results folder out/x``)
    :param case: name of the case of the run
    :param item: item of a list, for example ``node 'tip'``
    :param key: key of a file, or name of an argument
    :param value: value of the key
    :param allowed: allowed values: a range, or names
    :param joint: name of the joint
    :param nodes: names of nodes
    :param time_s: time [s]
    :param temperature_change_K: temperature change [K]
    :param cause: the reason; default: the cause of the code, else derived from ``allowed``
    :param remedy: the remedy; default: the remedy of the code
    :param details: further fields, which the sentence of the code contains
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
        # Makes the exception picklable, because the processes of a campaign exchange exceptions.
        return (_remade, (type(self), self.__dict__.copy()))

    def phrase(self) -> str:
        """Return the problem, without file and item."""
        return self.what

    def located(self, *, file: object = None, case: str | None = None) -> StatejumpError:
        """Set the file or the case of the error if it is not set yet; return the error itself."""
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
        if item and item.endswith("]"):  # an item without a name has its index: vary[1].key
            phrase, item = f"{item}.{phrase}", None
        sentence = ": ".join(part for part in (self._where(), item, phrase, self.cause) if part)
        if not self.remedy:
            return sentence
        return f"{sentence}{'; ' if self.cause else ': '}{self.remedy}"

    def general(self) -> str:
        """Return the sentence with placeholders for a given number and for the time, which differ between samples of a
        campaign. Failures of one kind thus have the same sentence."""
        alike = copy(self)
        if isinstance(self.value, float):
            alike.value = SOME
        for name in ("time_s", "temperature_change_K"):
            if getattr(self, name) is not None:
                setattr(alike, name, SOME)
        return str(alike)

    def fields(self) -> dict[str, Any]:
        """Return the facts of the failure by the names of ``FIELDS``; unknown facts are omitted."""
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


@contextmanager
def located(*, file: object = None, case: str | None = None) -> Iterator[None]:
    """Set the file or the case of every error that leaves this context, if the error has none."""
    try:
        yield
    except StatejumpError as failure:
        raise failure.located(file=file, case=case) from None


def _remade(kind: type[StatejumpError], state: dict[str, Any]) -> StatejumpError:
    error = kind.__new__(kind)
    Exception.__init__(error)
    error.__dict__.update(state)
    return error


def _plain(value: Any) -> Any:
    """Return a value if JSON supports it, else its text."""
    import json  # loaded here, because the start of the command does not need it

    value = _without_type(value)
    if isinstance(value, PathLike):
        return str(fspath(value))
    try:
        json.dumps(value, allow_nan=False)
    except (TypeError, ValueError):
        return repr(value)
    return value


class NotAllowed(StatejumpError):
    """A key has an invalid value: ``KEY = VALUE is not allowed[ BESIDE]: CAUSE``.

    :param key: the key
    :param value: value of the key; ABSENT: the key itself is not allowed, or its value does not matter
    :param cause: the reason; default: derived from ``allowed``
    :param beside: the other key that forbids the value, for example ``with start.mode = 'loaded'``
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
        if self.beside and "cause" not in found:  # the contradicting key is the cause
            found["cause"] = self.beside
        return {name: found[name] for name in FIELDS if name in found}


class MissingKey(StatejumpError):
    """A required key or section is missing: ``KEY is missing[: NEEDS]``."""

    default_code = "missing_key"

    def __init__(self, key: str, needs: str | None = None, *, section: str = "", **more: Any) -> None:
        super().__init__(key=key, cause=needs, **more)
        self.section = section

    def phrase(self) -> str:
        return f"{self.section or self.key} is missing"


class UnknownKey(StatejumpError):
    """A key or section is unknown: ``KEY is unknown: did you mean OTHER?``.

    :param key: the unknown key
    :param section: name of a section in the sentence, for example ``section [demm]``
    :param value: the unknown name, if ``key`` names another key
    :param beside: text that tells where the key is unknown, for example ``in a case of kind 'truss'``
    :param cause: the known keys, if none is similar
    :param remedy: the key that the user probably meant
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
    """A file cannot be read, or has other contents than expected."""

    default_code = "unreadable"


class MissingPart(Unreadable, KeyError):
    """A requested part of a result file is missing; the error is also a KeyError, as for a dict."""


class FailedRun(StatejumpError):
    """A run could not be finished, although its input passed all checks."""

    kind = "failed_run"
    default_code = "failed_run"


class NotWritten(StatejumpError):
    """A file or folder of results cannot be written."""

    kind = "output"
    default_code = "not_written"


class TolerancesMissed(StatejumpError):
    """The comparison was completed, but quantities exceed the tolerances of the case.

    :param quantities: names of the quantities that exceed their tolerances
    """

    exit_status = 1
    kind = "tolerance_missed"
    default_code = "tolerance_missed"

    def __init__(self, quantities: Sequence[str], **more: Any) -> None:
        super().__init__(cause=", ".join(quantities), **more)
        self.quantities = tuple(quantities)


class Interrupted(StatejumpError):
    """The user stopped a run.

    :param what: the results that were stored
    :param run: the samples so far; None if there are none
    """

    exit_status = 130
    kind = "interrupted"
    default_code = "interrupted"

    def __init__(self, what: str = "", *, run: Any = None, **more: Any) -> None:
        super().__init__(what, **more)
        self.run = run


def fields(kind: str, message: str, exit_status: int, **details: Any) -> dict[str, Any]:
    """Return the fields of an exception of another class, in the order of ``FIELDS``; ``kind`` serves as its code."""
    known = {"kind": kind, "code": kind, "message": message, **details, "exit_status": exit_status}
    return {name: known[name] for name in FIELDS if known.get(name) is not None}


def to_json(failure: dict[str, Any]) -> str:
    """Return the fields of a failure as one line."""
    import json  # loaded here, because the start of the command does not need it

    line = json.dumps(failure, ensure_ascii=False, allow_nan=False)
    return _CONTROL.sub(lambda found: f"\\u{ord(found[0]):04x}", line)
