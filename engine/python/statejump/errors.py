# SPDX-License-Identifier: GPL-3.0-or-later
"""What ends a command early: one sentence, no traceback, an exit status."""
from __future__ import annotations


class StatejumpError(Exception):
    """Bad input, or a run that could not be finished."""

    exit_status = 2


class TolerancesMissed(StatejumpError):
    """The comparison ran and a tolerance of the case file is missed."""

    exit_status = 1


class Interrupted(StatejumpError):
    """The user stopped a run; the sentence says what was kept."""

    exit_status = 130
