# SPDX-License-Identifier: GPL-3.0-or-later
"""Journal of finished samples on disk, written batch by batch, so that a killed campaign can continue.

Each line is a checksum (SHA-256), a blank and a JSON text. The first line describes the campaign: format, version, key
and columns. Every other line holds one batch, and is written at once and synced. Values are packed: base64 of
little-endian doubles, row by row. A torn last line is removed, and its samples are run again. A damaged earlier line is
an error. Only the owner of the folder opens a journal, see :mod:`statejump.core.results_folder`.
"""
from __future__ import annotations

import base64
import hashlib
import json
import os
from collections.abc import Mapping
from pathlib import Path
from typing import IO, Any

import numpy as np

from statejump.campaign.plan import Plan
from statejump.campaign.work import Batch
from statejump.core.errors import NotWritten, StatejumpError, Unreadable
from statejump.core.notes import Note

NAME = "samples.journal"
FORMAT = "statejump journal"
VERSION = 2


class Kept:
    """Finished samples of one campaign, in memory."""

    def __init__(self) -> None:
        self.batches: list[Batch] = []
        self.finished: set[int] = set()

    def add(self, batch: Batch) -> None:
        """Keep finished samples."""
        self.batches.append(batch)
        self.finished.update(batch.indices)


class Journal(Kept):
    """The journal of a campaign, as a context manager. ``note`` reports the removal of a torn line, if any."""

    def __init__(self, folder: Path, campaign: Plan, restart: bool) -> None:
        """Open or create the journal. :raises StatejumpError: the journal belongs to another campaign, or is damaged"""
        super().__init__()
        self.path = folder / NAME
        self.note: Note | None = None
        self._columns = len(campaign.outcomes)
        self._header = {
            "format": FORMAT, "version": VERSION, "campaign": campaign.key, "model": campaign.model,
            "columns": list(campaign.outcomes),
        }
        try:
            self._stream: IO[bytes] = open(self.path, "a+b")
        except OSError as failure:
            raise NotWritten(code="write_failed", file=self.path, cause=failure.strerror) from None
        try:
            self._open(restart)
        except BaseException:
            self._stream.close()
            raise

    def _open(self, restart: bool) -> None:
        if restart:
            self._stream.truncate(0)
        entries = self._entries()
        if not entries:
            self._append(self._header)
            return
        if entries[0] != self._header:
            raise StatejumpError(code="journal_of_other_campaign", file=self.path)
        for place, entry in enumerate(entries[1:], start=2):
            try:
                super().add(_batch(entry, self._columns))
            except (ValueError, TypeError, KeyError, AttributeError, OverflowError):
                raise self._damaged(place) from None

    def _entries(self) -> list[Any]:
        """Return the contents of all lines; remove a torn last line."""
        self._stream.seek(0)
        lines = self._stream.read().splitlines(keepends=True)
        entries, length = [], 0
        for place, line in enumerate(lines, start=1):
            try:
                entries.append(_entry_of(line))
            except ValueError:
                if place < len(lines):
                    raise self._damaged(place) from None
                self._stream.truncate(length)
                self.note = Note("journal_torn", path=self.path)
            length += len(line)
        return entries

    def _damaged(self, line: int) -> Unreadable:
        return Unreadable(code="journal_damaged", file=self.path, line=line)

    def _append(self, entry: Any) -> None:
        try:
            self._stream.write(_line(entry))
            self._stream.flush()
            os.fsync(self._stream.fileno())
        except OSError as failure:
            raise NotWritten(code="write_failed", file=self.path, cause=failure.strerror) from None

    def add(self, batch: Batch) -> None:
        """Store finished samples; they are on disk when the method returns."""
        self._append(_entry(batch))
        super().add(batch)

    def __enter__(self) -> Journal:
        return self

    def __exit__(self, *ignored: Any) -> None:
        self._stream.close()


def _line(entry: Any) -> bytes:
    text = json.dumps(entry, separators=(",", ":")).encode()
    return b"%s %s\n" % (hashlib.sha256(text).hexdigest().encode(), text)


def _entry_of(line: bytes) -> Any:
    """Return the content of a line of the journal. :raises ValueError: the line is incomplete or altered"""
    digest, _, text = line.removesuffix(b"\n").partition(b" ")
    if not line.endswith(b"\n") or digest != hashlib.sha256(text).hexdigest().encode():
        raise ValueError
    return json.loads(text)


def _entry(batch: Batch) -> dict[str, Any]:
    packed = base64.b64encode(batch.values.astype("<f8").tobytes()).decode()
    entry = {"samples": batch.indices, "values": packed, "errors": batch.errors}
    return {**entry, "error_kinds": batch.error_kinds} if batch.errors else entry


def _batch(entry: dict[str, Any], columns: int) -> Batch:
    indices = tuple(int(index) for index in entry["samples"])
    values = np.frombuffer(base64.b64decode(entry["values"], validate=True), dtype="<f8")
    errors = _by_index(entry["errors"])
    kinds = {**errors, **_by_index(entry.get("error_kinds", {}))}
    return Batch(indices, values.reshape(len(indices), columns), errors, kinds)


def _by_index(entry: Mapping[str, Any]) -> dict[int, str]:
    return {int(index): str(said) for index, said in entry.items()}
