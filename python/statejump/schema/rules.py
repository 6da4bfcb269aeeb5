# SPDX-License-Identifier: GPL-3.0-or-later
"""Rules for the values of keys, and their checks."""
from __future__ import annotations

import difflib
import math
import re
import sys
from collections.abc import Callable, Sequence
from typing import Any

import attrs

from statejump.core.errors import ABSENT, NotAllowed, Range, printable

FOLDER_NAME = "[A-Za-z0-9][A-Za-z0-9_-]*"
_NOT_IN_FOLDER_NAME = re.compile("[^A-Za-z0-9_-]+")
# Types of values.
NUMBER, WHOLE, SWITCH, TEXT, NUMBERS, TEXTS = "number", "whole", "switch", "text", "numbers", "texts"
ATTACHED = "attached"  # value that no file can contain


@attrs.frozen
class Rule:
    """Rule that the value of a key must satisfy.

    :param form: type: NUMBER, WHOLE, SWITCH, TEXT, NUMBERS, TEXTS or ATTACHED
    :param source: source of the default, and purpose of the key
    :param allowed: allowed range of a number, or of every number of a list
    :param known: function that returns the allowed names of a text, or of every text of a list; the catalogue of laws
        grows
    :param pattern: regular expression that the whole text must match, or a function that returns one on demand
    :param optional: whether None is allowed and means a missing value
    :param length: number of entries of a list
    """

    form: str
    source: str = ""
    allowed: Range | None = None
    known: Callable[[], Sequence[str]] | None = None
    pattern: str | Callable[[], str] | None = None
    optional: bool = False
    length: int | None = None

    @property
    def unit(self) -> str | None:
        """Unit of a number; ``-`` for none; None: no number."""
        return None if self.allowed is None else self.allowed.unit

    @property
    def names(self) -> tuple[str, ...]:
        """Names that a text must be one of; empty: any text."""
        return () if self.known is None else tuple(self.known())

    @property
    def expression(self) -> str | None:
        """Regular expression that the whole text must match; None if any text is allowed."""
        return self.pattern() if callable(self.pattern) else self.pattern

    def needs(self) -> str:
        """Return the part of an error message that states which values the key allows."""
        if self.form == TEXTS:
            return "a list of texts in quotes is needed"
        if self.form == NUMBERS:
            return f"a list of numbers [{self.unit}] is needed"
        if self.allowed is not None:
            return str(self.allowed)
        if self.known is not None:
            return "must be " + " or ".join(repr(name) for name in self.names)
        return "true or false is needed" if self.form == SWITCH else "a text in quotes is needed"

    def check(self, key: str, value: Any) -> None:
        """Raise NotAllowed unless the rule accepts the value."""
        if value is None and self.optional:
            return
        _CHECKS[self.form](self, key, value)


def is_finite_number(value: Any) -> bool:
    """Return whether a value of a document is a finite number. An integer may have any number of digits."""
    return isinstance(value, (int, float)) and not isinstance(value, bool) and abs(value) <= sys.float_info.max


def _number(rule: Rule, key: str, value: Any) -> None:
    assert rule.allowed is not None
    whole = rule.form == WHOLE
    if isinstance(value, bool) or not isinstance(value, int if whole else (int, float)):
        kind = "a whole number" if whole else "a number"
        raise NotAllowed(key, value, code="wrong_type", allowed=rule.allowed, type=kind, range=_range(rule))
    if isinstance(value, float) and not math.isfinite(value):
        raise NotAllowed(key, value, code="number_not_finite", allowed=rule.allowed, range=_range(rule))
    if value not in rule.allowed:
        raise NotAllowed(key, value, code="out_of_range", allowed=rule.allowed)


def _range(rule: Rule) -> str:
    return str(rule.allowed).removeprefix("must be ")


def _switch(rule: Rule, key: str, value: Any) -> None:
    if not isinstance(value, bool):
        raise NotAllowed(key, value, code="not_boolean")


def _text(rule: Rule, key: str, value: Any) -> None:
    if not isinstance(value, str):
        raise NotAllowed(key, value, code="not_string")
    if not value.isprintable() and printable(value) != value:
        raise NotAllowed(key, value, code="control_characters")
    if rule.known is not None:
        check_name(key, value, rule.names)
    if rule.expression is not None and not re.fullmatch(rule.expression, value):
        raise NotAllowed(key, value, code="no_folder_name")


def _numbers(rule: Rule, key: str, value: Any) -> None:
    if not isinstance(value, (list, tuple)):
        raise NotAllowed(key, value, code="not_number_list", unit=rule.unit)
    if rule.length is not None and len(value) != rule.length:
        raise NotAllowed(key, value, code="wrong_list_length", length=rule.length, unit=rule.unit)
    for item in value:
        try:
            _number(rule, key, item)
        except NotAllowed as refused:
            raise NotAllowed(key, value, code=refused.code, allowed=rule.allowed, **refused.details) from None


def _texts(rule: Rule, key: str, value: Any) -> None:
    if not isinstance(value, (list, tuple)) or not all(isinstance(item, str) for item in value):
        raise NotAllowed(key, value, code="not_string_list")
    if rule.known is not None:
        for item in value:
            try:
                check_name(key, item, rule.names)
            except NotAllowed as refused:
                raise NotAllowed(key, value, code="unknown_name", allowed=rule.names,
                                 known=refused.details["known"]) from None


class Attached:
    """Value of a key that a file cannot contain: arrays that were read from another file. It is immutable and hashable,
    so copies of a case share it."""

    def to_json(self) -> dict[str, Any]:
        """Return its identification for JSON; the arrays themselves are not included."""
        raise NotImplementedError


def _attached(rule: Rule, key: str, value: Any) -> None:
    if not isinstance(value, Attached):
        raise NotAllowed(key, value, rule.source, code="not_from_file")


_CHECKS = {NUMBER: _number, WHOLE: _number, SWITCH: _switch, TEXT: _text, NUMBERS: _numbers, TEXTS: _texts,
           ATTACHED: _attached}


def check_name(key: str, value: Any, names: Sequence[str], **more: Any) -> str:
    """Return the value if it is one of the allowed names. Otherwise raise NotAllowed with the most similar name."""
    if value in names:
        return str(value)
    more |= {"allowed": tuple(names), "known": " or ".join(repr(name) for name in names)}
    near = difflib.get_close_matches(value, names, n=1, cutoff=0.5) if isinstance(value, str) else []
    if near:
        raise NotAllowed(key, value, code="misspelt_name", meant=near[0], **more)
    raise NotAllowed(key, ABSENT if value is None else value, code="unknown_name", **more)


def folder_name(text: str) -> str:
    """Convert a text to a folder name: '_' replaces all characters except letters, digits, '_' and '-'."""
    return _NOT_IN_FOLDER_NAME.sub("_", text).strip("_-") or "case"


def suggestion(word: str, known: Sequence[str], before: str = "", after: str = "") -> dict[str, str]:
    """Return code and details of an UnknownKey error: the known word most similar to a word, or all known words."""
    match = difflib.get_close_matches(str(word), known, n=1, cutoff=0.5)  # a dict may have keys that are no texts
    if match:
        return {"code": "misspelt_key", "meant": f"{before}{match[0]}{after}"}
    return {"code": "no_such_key", "known": ", ".join(known)}
