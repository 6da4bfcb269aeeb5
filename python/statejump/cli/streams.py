# SPDX-License-Identifier: GPL-3.0-or-later
"""Standard output and standard error of the command.

A failure to print does not end a run. If a pipe is closed, the disk is full or the locale lacks a character, output is
lost, but the run continues and its files are complete. At the end the command reports why standard output was lost,
unless a pipe was closed.
"""
from __future__ import annotations

import errno
import io
import os
import sys
from typing import TextIO, cast

from statejump.core.errors import NotWritten


class Stream(io.TextIOBase):
    """A text stream that drops output that cannot be written.

    :param stream: the destination; None: all output is dropped
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
        """Redirect further output, and the unwritten part of the buffer, to the null device."""
        self.lost = self.lost or error
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, self.fileno())
        os.close(nowhere)


def open_standard_files() -> None:
    """Open standard input, output and error if they are closed. Otherwise the next opened result file would get the
    number of a closed stream, and libraries would print into the file."""
    for number in (0, 1, 2):
        try:
            os.fstat(number)
        except OSError:
            os.open(os.devnull, os.O_RDWR)  # the lowest number that is free


def install() -> None:
    """Replace standard output and error by these streams."""
    open_standard_files()
    sys.stdout, sys.stderr = cast(TextIO, Stream(sys.stdout)), cast(TextIO, Stream(sys.stderr))


def finish() -> NotWritten | None:
    """Flush the streams. Return the error if standard output was lost; otherwise return None."""
    failure = None
    for stream in (sys.stdout, sys.stderr):
        stream.flush()
    if isinstance(sys.stdout, Stream) and sys.stdout.lost is not None and sys.stdout.lost.errno != errno.EPIPE:
        failure = NotWritten(code="standard_output_not_written", cause=sys.stdout.lost.strerror)
    return failure
