# SPDX-License-Identifier: GPL-3.0-or-later
"""Gives O.load a clear message for a file saved by another YADE, instead of the exception of Boost.Serialization."""
from __future__ import annotations

import bz2
import functools
import gzip
import re
from pathlib import Path
from typing import Any, Callable

SIGNATURE = b"serialization::archive"
OPENED_BY = {".gz": gzip.open, ".bz2": bz2.open}


def archive_version(path: Path) -> int | None:
    """Return the version of Boost's archive format in the header of the file; None: the header has no version."""
    try:
        with OPENED_BY.get(path.suffix, open)(path, "rb") as stream:
            head = stream.read(512)
    except (OSError, EOFError):
        return None
    if written := re.search(SIGNATURE + rb'" version="(\d+)"', head):
        return int(written[1])
    place = head.find(SIGNATURE)
    return int.from_bytes(head[place + len(SIGNATURE):][:2], "little") if place >= 0 else None


class ForeignFile(RuntimeError):
    """A file was saved by another version of YADE.

    :param file: the file
    :param version: version of its archive format
    """

    def __init__(self, sentence: str, file: str, version: int) -> None:
        super().__init__(sentence)
        self.file, self.version = file, version


def explained(load: Callable[..., None], own_version: int, built_for: str) -> Callable[..., None]:
    """Return YADE's O.load, extended by a message if it fails at a file saved by another YADE.

    :param own_version: version of the archives that this YADE writes
    :param built_for: name of this YADE
    :raises ForeignFile: the file was saved by another YADE; other exceptions of YADE are passed on unchanged
    """
    @functools.wraps(load, assigned=("__doc__",), updated=())
    def explained_load(self: Any, file: str, *arguments: Any, **named: Any) -> None:
        try:
            load(self, file, *arguments, **named)
        except Exception as error:
            found = archive_version(Path(file))
            if found in (None, own_version):
                raise
            raise ForeignFile(
                f"{file} was saved by another YADE than this one, {built_for} (archive version {found}, here "
                f"{own_version}); YADE reads files of its own version alone: load it in the YADE that saved it",
                file, found,
            ) from error

    return explained_load
