# SPDX-License-Identifier: GPL-3.0-or-later
"""Control of the state jump of an ``umbrella`` case.

A joint loaded by a biased torsion spring has a unique quasi-static path and jump, see :mod:`.loaded`. Without this
spring the motion after contact is chaotic, and only statistics of an ensemble are meaningful, see :mod:`.ensemble`.
"""
from __future__ import annotations

from statejump.control.study import RUNS, DesignChoices, Study, check_wanted, refuse_choices, refuse_runs, with_notes
from statejump.core.errors import NotAllowed
from statejump.core.progress import OnProgress
from statejump.kinds.umbrella.case import UmbrellaCase
from studies.rib_control import ensemble, loaded


@with_notes
def control(
    case: UmbrellaCase, jump_below: float | None = None, runs: int | None = None, with_dem: bool = False,
    on_progress: OnProgress = lambda share: None, choices: DesignChoices = DesignChoices(),
) -> Study:
    """Study how to reduce the state jump of a rib.

    :param jump_below: largest allowed jump of θ2 [rad]; None: half of the jump of the case
    :param runs: size of the ensemble; None: the default. Must be None for a loaded joint
    :param choices: must be empty
    :raises StatejumpError: invalid input, or a run failed
    """
    check_wanted(jump_below, "rad")
    refuse_choices(choices, case)
    if case.start.mode == "loaded":
        refuse_runs(runs, case)
        return loaded.study(case, jump_below, with_dem, on_progress)
    if runs is not None and runs < 2:
        raise NotAllowed("--runs", runs, code="below_minimum", least=2)
    return ensemble.study(case, jump_below, runs or RUNS, with_dem, on_progress)
