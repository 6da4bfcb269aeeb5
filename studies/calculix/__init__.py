# SPDX-License-Identifier: GPL-3.0-or-later
"""Validation of cases against CalculiX, a finite-element program that shares no code with this project."""
from __future__ import annotations

from statejump.core.case import Case
from statejump.core.errors import NotAllowed
from statejump.kinds.spring_slider.case import SpringSliderCase
from statejump.kinds.truss.case import TrussCase
from studies.calculix import spring_slider, truss
from studies.calculix.ccx import Answer


def check(case: Case) -> None:
    """Raise NotAllowed if the kind of a case has no deck."""
    if not isinstance(case, (SpringSliderCase, TrussCase)):
        raise NotAllowed("case.kind", case.kind, code="command_not_for_kind", command="fe", file=case.origin.file,
                         kinds=f"{SpringSliderCase.KIND!r} and {TrussCase.KIND!r}")


def answer(case: Case) -> Answer:
    """Run a case in CalculiX and compare it with the reduced model.

    :raises NotAllowed: a CalculiX deck does not support the kind of case or a value
    :raises StatejumpError: CalculiX is missing or failed
    """
    check(case)
    return truss.answer(case) if isinstance(case, TrussCase) else spring_slider.answer(case)
