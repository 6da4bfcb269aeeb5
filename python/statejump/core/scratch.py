# SPDX-License-Identifier: GPL-3.0-or-later
"""Temporary folders that do not outlive a killed run. A run locks its folder while it uses the folder, and each new run
removes unlocked folders."""
from __future__ import annotations

import fcntl
import os
import shutil
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

PREFIX = "statejump-run-"  # reserved prefix: unlocked folders with it are removed
YOUNG_S = 60.0  # a younger folder may not be locked yet


@contextmanager
def scratch() -> Iterator[Path]:
    """Yield a new folder below ``$TMPDIR``, removed at the end.

    :raises OSError: the folder cannot be created
    """
    _sweep(Path(tempfile.gettempdir()))
    folder = Path(tempfile.mkdtemp(prefix=PREFIX))
    descriptor = os.open(folder, os.O_RDONLY | os.O_DIRECTORY | os.O_CLOEXEC)
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX)
        yield folder
    finally:
        shutil.rmtree(folder, ignore_errors=True)
        os.close(descriptor)


def _sweep(place: Path) -> None:
    """Remove unlocked folders of this user."""
    for left in place.glob(f"{PREFIX}*"):
        with suppress(OSError):
            about = left.lstat()
            if about.st_uid != os.geteuid() or time.time() - about.st_mtime < YOUNG_S:
                continue
            descriptor = os.open(left, os.O_RDONLY | os.O_DIRECTORY | os.O_NOFOLLOW)
            try:
                fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
                shutil.rmtree(left, ignore_errors=True)
            finally:
                os.close(descriptor)
