# SPDX-License-Identifier: GPL-3.0-or-later
"""Files appear whole or not at all: written aside, then renamed."""
from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import IO, TYPE_CHECKING

from statejump import _paths
from statejump.core.errors import NotWritten

if TYPE_CHECKING:
    from statejump.core.case import Case


@contextmanager
def replacing(path: Path) -> Iterator[Path]:
    """Yield a path beside ``path`` to write to; rename on success, remove on failure."""
    aside = path.with_name(f".{path.stem}.partial{path.suffix}")
    try:
        yield aside
        os.replace(aside, path)
    except OSError as error:
        raise NotWritten("cannot be written", file=path, cause=error.strerror or str(error)) from None
    finally:
        aside.unlink(missing_ok=True)


@contextmanager
def write_atomically(path: Path) -> Iterator[IO[str]]:
    """Open a text file that appears under its name when it is complete."""
    with replacing(path) as aside:
        with aside.open("w", encoding="utf-8", newline="") as stream:
            yield stream


def results_folder(root: Path, name: str) -> Path:
    """Make (if needed) and return ``root/name``; NotWritten if it cannot be written to."""
    folder = root / name
    try:
        folder.mkdir(parents=True, exist_ok=True)
        probe = folder / ".writable.partial"
        probe.touch()
        probe.unlink()
    except OSError as error:
        raise NotWritten("cannot be written", file=folder, place=f"results folder {folder}",
                         cause=error.strerror or str(error), remedy="choose another with --results") from None
    return folder


def made_by(command: str, case: Case) -> str:
    """Return how a file was made, for its text: the command with the case file, relative to the current folder or as
    the case that comes with the program is called.

    :param command: as ``statejump hold``
    """
    file = case.origin.file
    if file is None:
        return f"`{command}` of case {case.name}, which was made in Python"
    for folder in (Path.cwd(), _paths.SHARE):
        if file.resolve().is_relative_to(folder.resolve()):
            file = file.resolve().relative_to(folder.resolve())
            break
    return f"`{command} {file.as_posix()}`"
