# SPDX-License-Identifier: GPL-3.0-or-later
"""Expected errors and notes in tests, as codes and fields. Only the test of the generated page compares message texts."""
from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from math import isclose, isnan
from typing import Any

import pytest

from statejump import _engine
from statejump.core.errors import StatejumpError
from statejump.core.notes import Note

# Values of details are copied from the input, or result from a few double-precision operations with errors of 1e-16.
# The tolerance is relative, so the scale does not matter.
ROUNDING = 1e-12


class Failure:
    """Code and fields of an expected error or note. It equals every error with these values, from the package, from the
    engine or as JSON, and every such note; both may have further fields."""

    def __init__(self, code: str, **fields: Any) -> None:
        self.code, self.fields = code, fields
        self._found = ""

    def at(self, **more: Any) -> Failure:
        """Return the same expectation with further fields, such as ``file``."""
        return Failure(self.code, **self.fields, **more)

    def __eq__(self, error: object) -> bool:
        if isinstance(error, Failure):
            return (self.code, self.fields) == (error.code, error.fields)
        if isinstance(error, Note):
            self._found = f" not {error.code}: {error!r}, {error.details}"
            return error.code == self.code and all(
                name in error.details and _same(wanted, error.details[name], name) for name, wanted in self.fields.items())
        if isinstance(error, str) and not error.startswith("{"):
            return False  # a sentence without a code
        if isinstance(error, str):
            error = json.loads(error)  # one line of --json
        self._found = f" not {_shown(error)}"
        if isinstance(error, StatejumpError):
            return error.code == self.code and all(
                _same(wanted, error.details[name] if name in error.details else getattr(error, name, None), name)
                for name, wanted in self.fields.items())
        if isinstance(error, _engine.EngineFailure):
            return error.kind == self.code and all(
                _same(wanted, getattr(error, name, None), name) for name, wanted in self.fields.items())
        if isinstance(error, Mapping):
            known = {**error, **error.get("details", {})}
            return known["code"] == self.code and all(
                _same(json.loads(json.dumps(wanted)), known.get(name), name) for name, wanted in self.fields.items())
        return False

    def __hash__(self) -> int:
        return hash(self.code)

    def __repr__(self) -> str:
        return f"failure({self.code!r}, {self.fields}){self._found}"


failure = note = Failure


def _shown(error: object) -> str:
    if isinstance(error, StatejumpError):
        return f"{error.code}: {error}, {error.details}"
    return repr(error)


def _same(wanted: Any, found: Any, name: str = "") -> bool:
    if name == "file":  # the folder differs from run to run
        return f"/{found}".endswith(f"/{str(wanted).lstrip('/')}")
    if isinstance(wanted, float) and isinstance(found, (int, float)) and not isinstance(found, bool):
        return isclose(wanted, found, rel_tol=ROUNDING) or isnan(wanted) and isnan(found)
    if isinstance(wanted, (list, tuple)) and isinstance(found, (list, tuple)):
        return len(wanted) == len(found) and all(map(_same, wanted, found))
    return bool(wanted == found)


@contextmanager
def failing(code: str, raised: type[BaseException] = StatejumpError, **fields: Any) -> Iterator[pytest.ExceptionInfo[Any]]:
    """Check that an error with this code and these fields is raised in the context.

    :param raised: class of the error
    """
    with pytest.raises(raised) as caught:
        yield caught
    assert caught.value == failure(code, **fields)
