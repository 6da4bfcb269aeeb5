# SPDX-License-Identifier: GPL-3.0-or-later
"""The one door through which files are written: a file appears whole or not at all, and is on disk when it does.

A file is written aside under a name of its own, synced, and renamed. What a kill leaves aside is locked by nobody,
and goes when a file of that name is next written. A whole set of files that belong together: :mod:`.results_folder`.
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
    """Return a part of a name that no other run has."""
    return secrets.token_hex(6)


def not_written(path: Path, error: OSError) -> NotWritten:
    """Return why a file cannot be written, of what the system says."""
    return NotWritten(code="cannot_be_written", file=path, cause=error.strerror or str(error))


def synced(path: Path) -> None:
    """Return when a file, or what a folder lists, is on disk. :raises OSError: it cannot be"""
    descriptor = os.open(path, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)


def check_target(path: Path) -> None:
    """Raise NotWritten where no file can take the place: a folder, a device or a pipe is there."""
    try:
        if not stat.S_ISREG(os.stat(path).st_mode):
            raise NotWritten(code="target_no_file", file=path)
    except FileNotFoundError:
        pass
    except OSError as error:
        raise not_written(path, error) from None


def check_suffix(option: str, path: Path, *allowed: str) -> None:
    """Raise NotAllowed for a file name that promises another format than is written; one without suffix does not.

    :param option: the option that names the file
    :param allowed: suffixes, as ``.html``
    """
    if path.suffix and path.suffix.lower() not in allowed:
        raise NotAllowed(option, str(path), code="target_suffix", suffixes=" or ".join(allowed))


def _sweep(path: Path) -> None:
    """Remove what killed runs left beside a file: nobody holds it."""
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
            if os.fstat(descriptor).st_nlink:  # not swept by another run before it was locked
                return descriptor, aside
        except BaseException:
            with suppress(OSError):
                aside.unlink()
            os.close(descriptor)
            raise
        os.close(descriptor)


@contextmanager
def write_atomically(path: Path) -> Iterator[IO[str]]:
    """Open a text file that appears under its name when it is complete and on disk.

    :raises NotWritten: it cannot be written; what was there before stays
    """
    with _replacing(path) as descriptor:
        with open(descriptor, "w", encoding="utf-8", newline="", closefd=False) as stream:
            yield stream


def write_bytes(path: Path, content: bytes) -> Path:
    """Write a file that appears under its name when it is complete and on disk; return the path.

    :raises NotWritten: it cannot be written; what was there before stays
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
    aside_folder = path.parent.name.endswith(PARTIAL)  # all of it is synced when it is published
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
