"""What can end a command: each has its exit status, see :mod:`statejump.cli`."""
from __future__ import annotations


class InputError(Exception):
    """Bad input or a run that could not be finished: one sentence, exit status 2."""


class TolerancesMissed(Exception):
    """The comparison ran and a tolerance of the case file is missed: exit status 1."""


class Interrupted(Exception):
    """The user stopped a run; the sentence says what was kept. Exit status 130."""
