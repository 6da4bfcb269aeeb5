# SPDX-License-Identifier: GPL-3.0-or-later
"""Selection of fewer samples with a known error. The page states the number of samples and the error."""
from __future__ import annotations

import heapq
from typing import Iterable

import numpy as np


def kept_samples(
    time_s: np.ndarray, columns: np.ndarray, most: int, tolerance: float, always: Iterable[int] = ()
) -> np.ndarray:
    """Select samples so that linear interpolation between them follows all columns.

    Greedy splitting (Ramer 1972, Douglas and Peucker 1973) with the error of linear interpolation in time: the sample
    with the largest error is selected next, until no error exceeds the tolerance.

    :param time_s: times in ascending order (samples)
    :param columns: values (samples, columns); only finite values count
    :param most: largest number of samples
    :param tolerance: allowed error of a column, as a fraction of its range
    :param always: samples to keep in any case
    :returns: indices of the kept samples, in ascending order
    """
    count = len(time_s)
    columns = np.where(np.isfinite(columns), columns, 0.0).reshape(count, -1)
    spans = np.ptp(columns, axis=0)
    columns = columns[:, spans > 0] / spans[spans > 0]
    ends = sorted({0, count - 1, *(index for index in always if 0 <= index < count)})
    kept = set(ends)

    def worst(first: int, last: int) -> tuple[float, int, int, int]:
        if last - first < 2 or columns.shape[1] == 0:
            return 0.0, first, last, first
        inner = slice(first + 1, last)
        step = time_s[last] - time_s[first]
        fraction = (time_s[inner] - time_s[first]) / step if step > 0 else np.zeros(last - first - 1)
        line = columns[first] + fraction[:, None] * (columns[last] - columns[first])
        errors = np.max(np.abs(columns[inner] - line), axis=1)
        place = int(np.argmax(errors))
        return -float(errors[place]), first, last, first + 1 + place

    heap = [worst(first, last) for first, last in zip(ends, ends[1:])]
    heapq.heapify(heap)
    while heap and -heap[0][0] > tolerance and len(kept) < most:
        _, first, last, split = heapq.heappop(heap)
        kept.add(split)
        heapq.heappush(heap, worst(first, split))
        heapq.heappush(heap, worst(split, last))
    return np.array(sorted(kept))


def errors(time_s: np.ndarray, columns: Iterable[np.ndarray], kept: np.ndarray) -> np.ndarray:
    """Return the error of each column by linear interpolation between kept samples, as a fraction of the column's
    range. Only finite values count."""
    found = []
    for column in columns:
        values = np.where(np.isfinite(column), column, 0.0)
        span = float(np.ptp(values))
        missed = np.max(np.abs(np.interp(time_s, time_s[kept], values[kept]) - values)) if span > 0 else 0.0
        found.append(float(missed) / span if span > 0 else 0.0)
    return np.array(found)
