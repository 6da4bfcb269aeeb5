# SPDX-License-Identifier: GPL-3.0-or-later
"""What ends a command early: one sentence, no traceback, an exit status; the same as fields.

The sentence is the one source: ``FILE: [ITEM: ]KEY = VALUE is not allowed: CAUSE`` and its like are read
back into fields by :func:`read_sentence`. What a sentence does not say (time, temperature) is given beside
it where the error is raised.
"""
from __future__ import annotations

import ast
import json
import re
from typing import Any

# Order of the fields in JSON.
FIELDS = (
    "kind", "message", "file", "item", "key", "value", "time_s", "temperature_change_K", "joint", "nodes",
    "cause", "remedy", "exit_status",
)


class StatejumpError(Exception):
    """Bad input, or a run that could not be finished.

    :param message: one sentence
    :param details: fields that the sentence does not say, see ``FIELDS``
    """

    exit_status = 2
    kind = "bad_input"

    def __init__(self, message: str, **details: Any) -> None:
        super().__init__(message)
        self.details = details

    def fields(self) -> dict[str, Any]:
        """Return the failure as fields; those that are not known are left out."""
        return fields(self.kind, str(self), self.exit_status, **self.details)


class FailedRun(StatejumpError):
    """The input is right as far as it can be judged; the run could not be finished."""

    kind = "failed_run"


class NotWritten(StatejumpError):
    """A file or folder of results cannot be written."""

    kind = "output"


class TolerancesMissed(StatejumpError):
    """The comparison ran and a tolerance of the case file is missed."""

    exit_status = 1
    kind = "tolerance_missed"


class Interrupted(StatejumpError):
    """The user stopped a run; the sentence says what was kept."""

    exit_status = 130
    kind = "interrupted"


def fields(kind: str, message: str, exit_status: int, **details: Any) -> dict[str, Any]:
    """Return a failure as fields, in the order of ``FIELDS``."""
    known = {"kind": kind, "message": message, **read_sentence(message), **details, "exit_status": exit_status}
    return {name: known[name] for name in FIELDS if known.get(name) is not None}


def to_json(failure: dict[str, Any]) -> str:
    """Return the fields of a failure as one line."""
    return json.dumps(failure, ensure_ascii=False, allow_nan=False)


_FILE = re.compile(r"(?P<file>[^:]*\.(?:toml|h5|csv|stl|obj|ply|vtp|json)): (?P<rest>.*)", re.DOTALL)
_ITEM = re.compile(r"(?P<item>(?:[a-z_]+ (?:'[^']*'|\d+)|vary\[\d+\])): (?P<rest>.*)", re.DOTALL)
_KEY = r"(?P<key>--?[\w-]+|[\w.]+|[a-z]+ '[^']*'|\[+\w+\]+)"
_WHAT = (
    re.compile(_KEY + r" = (?P<value>.*?) is (?:not allowed|unknown)(?: in [^:]*)?: (?P<cause>.*)", re.DOTALL),
    re.compile(r"(?:section )?" + _KEY + r" is (?:missing|unknown|not allowed)(?:: | |$)(?P<cause>.*)", re.DOTALL),
)
_PART = re.compile(r"(?P<kind>node|revolute|slider) '(?P<name>[^']*)'")
_NUMBER = r"(?P<number>[-+]?\d[-+\d.e]*)"
_TEMPERATURE = re.compile(rf"\btemperature[ _]change(?: of| =)? {_NUMBER} K\b")
_TIME = re.compile(rf"\b(?:t =|time|time =) {_NUMBER} s\b")
_REMEDY = re.compile(r"(?:^|[;:] )(?P<remedy>(?:did you mean|install|choose|load it|set (?:dem|reduced)\.\w+ to|--\w+ drops|the same command) .*)")


def _value(text: str) -> Any:
    """Return a value as it was in the file; as text if JSON cannot hold it."""
    if text in ("true", "false"):
        return text == "true"
    try:
        found = ast.literal_eval(text)
        json.dumps(found, allow_nan=False)
    except (ValueError, SyntaxError, TypeError):
        return text
    return found


def read_sentence(message: str) -> dict[str, Any]:
    """Return the fields that the sentence of a failure says: file, item, key, value, cause, ..."""
    found: dict[str, Any] = {}
    rest = message
    match = _FILE.fullmatch(rest)
    if match:
        found["file"], rest = match["file"], match["rest"]
    match = re.fullmatch(r"vary\[(\d+)\]\.(.*)", rest, re.DOTALL)
    if match:
        found["item"], rest = f"vary {match[1]}", match[2]
    else:
        match = _ITEM.fullmatch(rest)
        if match:
            found["item"], rest = match["item"], match["rest"]
    for pattern in _WHAT:
        match = pattern.fullmatch(rest)
        if match:
            said = match.groupdict()
            found["key"] = said["key"].strip("[]")
            if said["cause"]:
                found["cause"] = said["cause"]
            if "value" in said:
                found["value"] = _value(said["value"])
            break
    remedy = _REMEDY.search(found.get("cause", rest))
    if remedy:
        found["remedy"] = remedy["remedy"]
        if found.get("cause") == remedy["remedy"]:
            del found["cause"]
    parts = [*_PART.finditer(message)]
    joints = [part["name"] for part in parts if part["kind"] != "node"]
    if joints:
        found["joint"] = joints[0]
    nodes = [part["name"] for part in parts if part["kind"] == "node"]
    if nodes:
        found["nodes"] = list(dict.fromkeys(nodes))
    for name, pattern in (("temperature_change_K", _TEMPERATURE), ("time_s", _TIME)):
        said_number = pattern.search(message)
        if said_number:
            found[name] = float(said_number["number"])
    return found
