# SPDX-License-Identifier: GPL-3.0-or-later
"""Finished samples on disk, batch by batch, so that a killed campaign goes on where it was.

JSON lines: first the campaign's key and columns, then one line per batch, written at once and
synced; values are packed (base64 of little-endian doubles, row by row). A line that a kill has torn
is dropped.
"""
from __future__ import annotations

import base64
import fcntl
import json
import os
from collections.abc import Mapping
from pathlib import Path
from typing import IO, Any

import numpy as np

from statejump.campaign.plan import Plan
from statejump.campaign.work import Batch
from statejump.core.errors import NotWritten, StatejumpError, Unreadable

NAME = "samples.journal.jsonl"


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
    """The journal of one campaign, locked while it is open; a context manager."""

    def __init__(self, folder: Path, campaign: Plan, restart: bool) -> None:
        """Open or begin it. :raises StatejumpError: it belongs to another campaign, or is in use"""
        super().__init__()
        self.path = folder / NAME
        self._header = {
            "campaign": campaign.key, "model": campaign.model, "columns": list(campaign.outcomes),
        }
        try:
            self._stream: IO[bytes] = open(self.path, "a+b")
        except OSError as failure:
            raise NotWritten("cannot be written", file=self.path, cause=failure.strerror) from None
        try:
            self._open(restart)
        except BaseException:
            self._stream.close()
            raise

    def _open(self, restart: bool) -> None:
        try:
            fcntl.flock(self._stream, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            raise StatejumpError("another run of this campaign is at work on it", file=self.path) from None
        if restart:
            self._stream.truncate(0)
        lines = self._whole_lines()
        if not lines:
            self._append(self._header)
            return
        try:
            if json.loads(lines[0]) != self._header:
                raise StatejumpError(
                    "belongs to another campaign (the campaign, its case or statejump has changed since); --restart "
                    "drops what is there, another campaign.name keeps it", file=self.path,
                )
            for line in lines[1:]:
                super().add(_batch(json.loads(line), len(self._header["columns"])))
        except (ValueError, TypeError, KeyError, AttributeError):
            raise Unreadable("is damaged; --restart drops what is there", file=self.path) from None

    def _whole_lines(self) -> list[bytes]:
        self._stream.seek(0)
        content = self._stream.read()
        whole = content.rfind(b"\n") + 1
        if whole < len(content):
            self._stream.truncate(whole)  # a line torn by a kill
        return content[:whole].splitlines()

    def _append(self, entry: Any) -> None:
        try:
            self._stream.write(json.dumps(entry, separators=(",", ":")).encode() + b"\n")
            self._stream.flush()
            os.fsync(self._stream.fileno())
        except OSError as failure:
            raise NotWritten("cannot be written", file=self.path, cause=failure.strerror) from None

    def add(self, batch: Batch) -> None:
        """Keep finished samples; on return they are on disk."""
        self._append(_entry(batch))
        super().add(batch)

    def __enter__(self) -> Journal:
        return self

    def __exit__(self, *ignored: Any) -> None:
        self._stream.close()


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
