# SPDX-License-Identifier: GPL-3.0-or-later
"""Calls of samples from OpenTURNS, which turns every exception of a function into a printed traceback."""
from __future__ import annotations

from collections.abc import Sequence
from math import isnan
from typing import Any

from statejump.campaign.rare.model import Model
from statejump.core.errors import StatejumpError

WITHIN = -1.0  # margin that OpenTURNS gets after the first exception, and of samples without a value


def refused(model: Model, code: str, **details: Any) -> StatejumpError:
    """Return the error of an event whose probability cannot be computed in this way."""
    with_remedy: dict[str, Any] = {} if code in ("rare_frequent", "rare_not_reached", "rare_failed_samples") else {
        "remedy_option": "method 'subset' (--method subset)"}
    return StatejumpError(code=code, outcome=str(model.event), **with_remedy, **details)


class Guard:
    """Keeps the first exception of a run, such as Ctrl-C, and raises it after the algorithm has ended.

    :param strict: whether a failed sample or a sample without a value ends the algorithm
    """

    def __init__(self, model: Model, strict: bool = True) -> None:
        self.model, self.strict = model, strict
        self.raised: BaseException | None = None

    def called(self, variates: Sequence[float]) -> list[float]:
        """Return the margin at a point."""
        if self.raised is not None:
            return [WITHIN]
        try:
            return [self._margin(variates)]
        except BaseException as problem:  # KeyboardInterrupt too
            self.raised = problem
            return [WITHIN]

    def _margin(self, variates: Sequence[float]) -> float:
        model = self.model
        failed = len(model.failures)
        found = model.at(variates)
        if not isnan(found):
            return found
        if self.strict and len(model.failures) > failed:
            raise refused(model, "rare_run_failed", error=model.failures[-1])
        if self.strict:
            raise refused(model, "rare_no_value")
        return WITHIN

    def run(self, algorithm: Any) -> None:
        """Run an algorithm. :raises StatejumpError: a sample or the algorithm failed"""
        try:
            algorithm.run()
        except (RuntimeError, TypeError) as problem:
            if self.raised is None:
                error = " ".join(str(problem).split()).rpartition(" : ")[2]
                raise refused(self.model, "rare_no_design_point", runs=self.model.runs, error=error) from None
        if self.raised is not None:
            raise self.raised
