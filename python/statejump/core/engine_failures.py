# SPDX-License-Identifier: GPL-3.0-or-later
"""Failures of the engine, converted to errors of the package. They keep the engine's fields and sentence."""
from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from typing import Any, cast

from statejump import _engine
from statejump.core.errors import FailedRun


class EngineFailed(FailedRun):
    """The engine returned no result: ``[WHERE: ][WHAT: ]SENTENCE[; REMEDY]``. SENTENCE states cause and remedy.

    :param failure: the exception of the engine
    :param what: description of the run that failed; "" for none
    :param remedy: remedy to add to the sentence
    """

    def __init__(
        self, failure: _engine.EngineFailure, what: str = "", *, remedy: str | None = None, **more: Any
    ) -> None:
        super().__init__(
            what, code=str(failure.kind), joint=failure.joint, nodes=failure.nodes, time_s=failure.time_s,
            temperature_change_K=failure.temperature_change_K, cause=failure.cause or failure.message,
            remedy=remedy or failure.remedy, **cast("dict[str, Any]", failure.numbers), **more,
        )
        self.reason = str(failure.kind)
        self.argument = failure.key
        self.sentence = str(failure.message) + (f"; {remedy}" if remedy else "")
        self.numbers: Mapping[str, float] = dict(failure.numbers)

    def __str__(self) -> str:
        return ": ".join(part for part in (self._where(), self.item, self.what, self.sentence) if part)

    def general(self) -> str:
        said = ": ".join(part for part in (self._where(), self.item, self.what, self.cause) if part)
        return f"{said}; {self.remedy}" if self.remedy else said


@contextmanager
def engine(what: str = "", **more: Any) -> Iterator[None]:
    """Convert failures of the engine within this context to :class:`EngineFailed`, whose parameters it accepts."""
    try:
        yield
    except _engine.EngineFailure as failure:
        raise EngineFailed(failure, what, **more) from None
