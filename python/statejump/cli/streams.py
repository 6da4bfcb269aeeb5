# SPDX-License-Identifier: GPL-3.0-or-later
"""The one door through which the command tells: standard output and standard error, which cannot make a run fail.

A pipe that is closed, a full disk, a locale without the letters that a text has: the run goes on and its files are
complete. Whatever else than a closed pipe has lost standard output is told at the end.
"""
from __future__ import annotations

import errno
import io
import os
import sys
from typing import TextIO, cast

from statejump.core.errors import NotWritten


class Stream(io.TextIOBase):
    """Text for people; what nobody can take is dropped.

    :param stream: where it goes; None: nowhere
    """

    def __init__(self, stream: TextIO | None) -> None:
        self._stream = stream
        self.lost: OSError | None = None
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")

    @property
    def encoding(self) -> str:  # type: ignore[override]
        """Of the letters that the stream takes."""
        return "utf-8" if self._stream is None else self._stream.encoding

    def isatty(self) -> bool:
        return self._stream is not None and self._stream.isatty()

    def fileno(self) -> int:
        if self._stream is None:
            raise io.UnsupportedOperation("fileno")
        return self._stream.fileno()

    def writable(self) -> bool:
        return True

    def write(self, text: str) -> int:
        if self._stream is not None:
            try:
                self._stream.write(text)
            except OSError as error:
                self._lose(error)
        return len(text)

    def flush(self) -> None:
        if self._stream is not None:
            try:
                self._stream.flush()
            except OSError as error:
                self._lose(error)

    def _lose(self, error: OSError) -> None:
        """Send what is still to come, and what the stream holds back, to nowhere."""
        self.lost = self.lost or error
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, self.fileno())
        os.close(nowhere)


def open_standard_files() -> None:
    """Open what was closed of standard input, output and error: a file of results would get its number, and what
    libraries print there."""
    for number in (0, 1, 2):
        try:
            os.fstat(number)
        except OSError:
            os.open(os.devnull, os.O_RDWR)  # the lowest number that is free


def install() -> None:
    """Let everything that is told go through this door."""
    open_standard_files()
    sys.stdout, sys.stderr = cast(TextIO, Stream(sys.stdout)), cast(TextIO, Stream(sys.stderr))


def finish() -> NotWritten | None:
    """Bring out what was told; return what is to be said of it where standard output was lost."""
    failure = None
    for stream in (sys.stdout, sys.stderr):
        stream.flush()
    if isinstance(sys.stdout, Stream) and sys.stdout.lost is not None and sys.stdout.lost.errno != errno.EPIPE:
        failure = NotWritten(code="standard_output_not_written", cause=sys.stdout.lost.strerror)
    return failure
