# SPDX-License-Identifier: GPL-3.0-or-later
"""How many samples are run at a time."""
from __future__ import annotations

BATCH_S = 0.5  # wanted length of a task: long against the millisecond that a task costs
MOST_IN_BATCH = 20_000


class Batches:
    """Hands out the missing samples in batches that last about BATCH_S, and learns how many.

    :param missing: numbers of the samples
    :param model: samples of the DEM go one by one
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
        """Return the next batch; empty: there is none left."""
        # The last batches are smaller: all workers end at the same time.
        size = 1 if self.one_by_one else max(1, min(self.size, -(-self.left // (self.queued * workers))))
        batch = self.missing[self.given : self.given + size]
        self.given += len(batch)
        return batch

    def learn(self, count: int, seconds: float) -> None:
        """At most four times as many as were timed: the first sample of a worker is no measure."""
        fitting = int(BATCH_S / max(seconds / count, 1e-9))
        self.size = max(1, min(fitting, 4 * count, MOST_IN_BATCH))
