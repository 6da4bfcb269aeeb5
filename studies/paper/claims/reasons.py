# SPDX-License-Identifier: GPL-3.0-or-later
"""Reasons of verdicts: a text whose parts have codes."""
from __future__ import annotations


class Reasons(str):
    """Reasons as text.

    :ivar codes: codes of the parts
    """

    codes: tuple[str, ...]

    def __new__(cls, text: str, codes: tuple[str, ...]) -> Reasons:
        made = super().__new__(cls, text)
        made.codes = codes
        return made

    def __getnewargs__(self) -> tuple[str, tuple[str, ...]]:
        return str(self), self.codes


def because(**parts: str) -> Reasons:
    """Return reasons from their codes and texts."""
    return Reasons("; ".join(parts.values()), tuple(parts))


def also(reasons: Reasons, **parts: str) -> Reasons:
    """Return reasons with further ones."""
    more = because(**parts)
    return Reasons("; ".join(text for text in (reasons, more) if text), reasons.codes + more.codes)
