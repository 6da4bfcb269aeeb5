# SPDX-License-Identifier: GPL-3.0-or-later
"""What is asked of a path before it is read."""
from __future__ import annotations

import stat
from pathlib import Path

from statejump.core.errors import Unreadable


def is_file(path: Path) -> bool:
    """Whether there is a file: no folder, device or pipe.

    :raises Unreadable: the system does not say: a folder that may not be searched, a name that is too long
    """
    try:
        return stat.S_ISREG(path.stat().st_mode)
    except (FileNotFoundError, NotADirectoryError):
        return False
    except OSError as error:
        raise Unreadable("cannot be read", cause=error.strerror, file=path) from None
