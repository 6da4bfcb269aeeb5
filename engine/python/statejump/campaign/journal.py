# SPDX-License-Identifier: GPL-3.0-or-later
"""Finished samples on disk, batch by batch, so that a killed campaign goes on where it was.

JSON lines: first the campaign's key and columns, then one line per batch, written at once and
synced. A line that a kill has torn is dropped.
"""
from __future__ import annotations

import fcntl
import json
import math
import os
from pathlib import Path
from typing import IO, Any, Optional, Sequence

from ..errors import StatejumpError
from .campaign_file import Campaign
from .work import Sample

NAME = "samples.journal.jsonl"


class Journal:
    """The journal of one campaign, locked while it is open; a context manager."""

    def __init__(self, folder: Path, campaign: Campaign, restart: bool) -> None:
        """Open or begin it. :raises StatejumpError: it belongs to another campaign, or is in use"""
        self.path = folder / NAME
        self.samples: dict[int, Sample] = {}
        self._header = {
            "campaign": campaign.key, "model": campaign.model, "columns": list(campaign.units),
        }
        try:
            self._stream: IO[bytes] = open(self.path, "a+b")
        except OSError as failure:
            raise StatejumpError(f"{self.path}: cannot be written: {failure.strerror}") from None
        try:
            self._open(restart)
        except BaseException:
            self._stream.close()
            raise

    def _open(self, restart: bool) -> None:
        try:
            fcntl.flock(self._stream, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            raise StatejumpError(f"{self.path}: another run of this campaign is at work on it") from None
        if restart:
            self._stream.truncate(0)
        lines = self._whole_lines()
        if not lines:
            self._append(self._header)
            return
        try:
            if json.loads(lines[0]) != self._header:
                raise StatejumpError(
                    f"{self.path}: belongs to another campaign (the campaign, its case or statejump has changed "
                    "since); --restart drops what is there, another campaign.name keeps it"
                )
            for line in lines[1:]:
                for entry in json.loads(line):
                    sample = _sample(entry)
                    self.samples[sample.index] = sample
        except (ValueError, TypeError, KeyError, IndexError):
            raise StatejumpError(f"{self.path}: is damaged; --restart drops what is there") from None

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
            raise StatejumpError(f"{self.path}: cannot be written: {failure.strerror}") from None

    def add(self, samples: Sequence[Sample]) -> None:
        """Keep finished samples; on return they are on disk."""
        self._append([_entry(sample) for sample in samples])
        self.samples.update((sample.index, sample) for sample in samples)

    def __enter__(self) -> "Journal":
        return self

    def __exit__(self, *ignored: Any) -> None:
        self._stream.close()


def _entry(sample: Sample) -> list[Any]:
    """JSON has no NaN: null stands for it."""
    if sample.values is None:
        return [sample.index, None, sample.error]
    return [sample.index, [None if math.isnan(value) else value for value in sample.values]]


def _sample(entry: list[Any]) -> Sample:
    values: Optional[list[Any]] = entry[1]
    if values is None:
        return Sample(int(entry[0]), None, str(entry[2]))
    return Sample(int(entry[0]), tuple(math.nan if value is None else float(value) for value in values))
