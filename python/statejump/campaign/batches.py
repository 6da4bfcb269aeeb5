# SPDX-License-Identifier: GPL-3.0-or-later
"""Size of the batches of samples."""
from __future__ import annotations

BATCH_S = 0.5  # duration of a task [s], long compared with Dask's overhead of a millisecond
MOST_IN_BATCH = 20_000


class Batches:
    """Distributes the missing samples in batches of about BATCH_S seconds, and adapts their size.

    :param missing: numbers of the samples
    :param model: ``reduced`` or ``dem``; DEM samples are run one by one
    :param queued: tasks per worker
    """

    def __init__(self, missing: list[int], model: str, queued: int) -> None:
        self.missing, self.given, self.size, self.queued = missing, 0, 1, queued
        self.one_by_one = model == "dem"

    @property
    def left(self) -> int:
        """Samples that are not handed out."""
        return len(self.missing) - self.given

    def next(self, workers: int) -> list[int]:
        """Return the next batch; empty at the end."""
        # The last batches are smaller, so that all workers finish at about the same time.
        size = 1 if self.one_by_one else max(1, min(self.size, -(-self.left // (self.queued * workers))))
        batch = self.missing[self.given : self.given + size]
        self.given += len(batch)
        return batch

    def learn(self, count: int, seconds: float) -> None:
        """Update the batch size from a timed batch, at most to four times its size: the first sample of a worker is
        slower than the others."""
        fitting = int(BATCH_S / max(seconds / count, 1e-9))
        self.size = max(1, min(fitting, 4 * count, MOST_IN_BATCH))
