# SPDX-License-Identifier: GPL-3.0-or-later
"""Atomic output: every file is written through this module. A file appears complete and on disk, or not at all.

A file is written under a temporary name, synced, and renamed. A killed run leaves an unlocked temporary file; the next
write to the same path removes it. :mod:`.results_folder` writes sets of files that belong together.
"""
from __future__ import annotations

import fcntl
import os
import secrets
import stat
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import IO

from statejump.core.errors import NotAllowed, NotWritten

PARTIAL = ".partial"


def unique() -> str:
    """Return a string that is unique among runs, for a name."""
    return secrets.token_hex(6)


def not_written(path: Path, error: OSError) -> NotWritten:
    """Return the error for a file that cannot be written, with the system's reason."""
    return NotWritten(code="write_failed", file=path, cause=error.strerror or str(error))


def synced(path: Path) -> None:
    """Sync a file, or the entries of a folder, to disk. :raises OSError: it cannot be synced"""
    descriptor = os.open(path, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)


def check_target(path: Path) -> None:
    """Raise NotWritten if the path is a folder, a device or a pipe."""
    try:
        if not stat.S_ISREG(os.stat(path).st_mode):
            raise NotWritten(code="target_not_file", file=path)
    except FileNotFoundError:
        pass
    except OSError as error:
        raise not_written(path, error) from None


def check_suffix(option: str, path: Path, *allowed: str) -> None:
    """Raise NotAllowed if the suffix of a file name belongs to another format. A name without suffix is allowed.

    :param option: the option that names the file
    :param allowed: suffixes, for example ``.html``
    """
    if path.suffix and path.suffix.lower() not in allowed:
        raise NotAllowed(option, str(path), code="wrong_suffix", suffixes=" or ".join(allowed))


def _sweep(path: Path) -> None:
    """Remove the unlocked temporary files that killed runs left when they wrote the given file."""
    for name in os.listdir(path.parent):
        if name.startswith(f".{path.name}.") and name.endswith(PARTIAL):
            with suppress(OSError):
                descriptor = os.open(path.with_name(name), os.O_RDONLY)
                try:
                    fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
                    path.with_name(name).unlink()
                finally:
                    os.close(descriptor)


def _opened(path: Path) -> tuple[int, Path]:
    """Return a new file beside a path, locked, and its name."""
    while True:
        aside = path.with_name(f".{path.name}.{unique()}{PARTIAL}")
        descriptor = os.open(aside, os.O_CREAT | os.O_EXCL | os.O_WRONLY | os.O_CLOEXEC, 0o666)
        try:
            fcntl.flock(descriptor, fcntl.LOCK_EX)
            if os.fstat(descriptor).st_nlink:  # another run did not remove it before it was locked
                return descriptor, aside
        except BaseException:
            with suppress(OSError):
                aside.unlink()
            os.close(descriptor)
            raise
        os.close(descriptor)


@contextmanager
def write_atomically(path: Path) -> Iterator[IO[str]]:
    """Open a text file that appears under its name only when it is complete and on disk.

    :raises NotWritten: the file cannot be written; an earlier one remains
    """
    with _replacing(path) as descriptor:
        with open(descriptor, "w", encoding="utf-8", newline="", closefd=False) as stream:
            yield stream


def write_bytes(path: Path, content: bytes) -> Path:
    """Write a file that appears under its name only when it is complete and on disk; return the path.

    :raises NotWritten: the file cannot be written; an earlier one remains
    """
    with _replacing(path) as descriptor:
        with open(descriptor, "wb", buffering=0, closefd=False) as stream:
            left = memoryview(content)
            while left:
                left = left[stream.write(left):]
    return path


@contextmanager
def _replacing(path: Path) -> Iterator[int]:
    check_target(path)
    aside_folder = path.parent.name.endswith(PARTIAL)  # the whole folder is synced when it is published
    try:
        if not aside_folder:
            _sweep(path)
        descriptor, aside = _opened(path)
        try:
            yield descriptor
            if aside_folder:
                os.replace(aside, path)
            else:
                os.fsync(descriptor)
                os.replace(aside, path)
                synced(path.parent)
        finally:
            with suppress(OSError):
                aside.unlink()
            os.close(descriptor)
    except OSError as error:
        raise not_written(path, error) from None
