# SPDX-License-Identifier: GPL-3.0-or-later
"""The one exception that the command line turns into one sentence and an exit status."""
from __future__ import annotations


class StatejumpError(Exception):
    """Something the user can put right: one sentence, no traceback.

    :param message: one sentence without the leading ``error:``
    :param exit_status: 2 for bad input or a failed run, 130 for Ctrl-C
    """

    def __init__(self, message: str, exit_status: int = 2) -> None:
        super().__init__(message)
        self.exit_status = exit_status
