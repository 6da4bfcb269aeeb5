# SPDX-License-Identifier: GPL-3.0-or-later
"""Finished runs of a rare event, on disk so that an interrupted command can continue, and runs ahead on workers.

Lines are those of :mod:`statejump.campaign.journal`: a checksum and a JSON text. A run depends only on its centre, the
seed and its number, so a repeated command finds the runs of the interrupted one.
"""
from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import IO, Any

from statejump.campaign.journal import _entry_of, _line
from statejump.campaign.plan import Plan, Recipe
from statejump.campaign.work import Batch, Sample
from statejump.core.errors import NotWritten, StatejumpError, Unreadable

NAME = "rare.journal"
Ahead = Callable[[Sequence[int]], None]


class Kept:
    """Finished runs by centre and number.

    :param folder: folder of the journal; None: memory only
    :param restart: whether to drop the runs of an earlier command
    :raises StatejumpError: the journal belongs to another campaign, or is damaged
    """

    def __init__(self, plan: Plan, folder: Path | None = None, restart: bool = False) -> None:
        self.samples: dict[tuple[tuple[float, ...], int], Sample] = {}
        self.path = None if folder is None else folder / NAME
        self._stream: IO[bytes] | None = None
        if self.path is None:
            return
        header = {"format": "statejump rare journal", "version": 1, "campaign": plan.key,
                  "columns": list(plan.outcomes)}
        try:
            self._stream = open(self.path, "a+b")
            if restart:
                self._stream.truncate(0)
            self._stream.seek(0)
            lines = self._stream.read().splitlines(keepends=True)
        except OSError as failure:
            raise NotWritten(code="write_failed", file=self.path, cause=failure.strerror) from None
        self._read(lines, header)

    def _read(self, lines: Sequence[bytes], header: dict[str, Any]) -> None:
        assert self._stream is not None
        length = 0
        for number, line in enumerate(lines, start=1):
            try:
                entry = _entry_of(line)
            except ValueError:
                if number < len(lines):
                    raise Unreadable(code="journal_damaged", file=self.path, line=number) from None
                self._stream.truncate(length)  # torn: the run is repeated
                break
            length += len(line)
            if number == 1 and entry != header:
                raise StatejumpError(code="journal_of_other_campaign", file=self.path)
            if number > 1:
                index, values, error, kind = entry["run"]
                found = Sample(index, None if values is None else tuple(map(float, values)), error, kind)
                self.samples[tuple(entry["centre"]), index] = found
        if length == 0:
            self._append(header)

    def _append(self, entry: Any) -> None:
        if self._stream is None:
            return
        try:
            self._stream.write(_line(entry))
            self._stream.flush()
        except OSError as failure:
            raise NotWritten(code="write_failed", file=self.path, cause=failure.strerror) from None

    def add(self, centre: tuple[float, ...], sample: Sample) -> None:
        """Keep a finished run."""
        self.samples[centre, sample.index] = sample
        values = None if sample.values is None else list(sample.values)
        self._append({"centre": centre, "run": [sample.index, values, sample.error, sample.error_kind]})

    def close(self) -> None:
        """Close the journal."""
        if self._stream is not None:
            self._stream.close()


@contextmanager
def ahead(kept: Kept, recipe: Recipe, centre: tuple[float, ...], workers: int | None,
          scheduler: str | None) -> Iterator[Ahead]:
    """Yield a function that runs samples with given numbers on a Dask cluster and keeps them.

    :param workers: processes on this machine; None, without a scheduler: the function does nothing
    """
    if workers is None and scheduler is None:
        yield lambda indices: None
        return
    from statejump.campaign.distribute import workers_for  # Dask, 0.6 s

    with workers_for(recipe, scheduler, workers or 1) as cluster:
        def run(indices: Sequence[int]) -> None:
            missing = [index for index in indices if (centre, index) not in kept.samples]
            for _, batch in cluster.run(missing) if missing else ():
                for sample in _samples(batch):
                    kept.add(centre, sample)

        yield run


def _samples(batch: Batch) -> Iterator[Sample]:
    for index, values in zip(batch.indices, batch.values):
        failed = index in batch.errors
        yield Sample(index, None if failed else tuple(map(float, values)), batch.errors.get(index, ""),
                     batch.error_kinds.get(index, ""))
