# SPDX-License-Identifier: GPL-3.0-or-later
"""Table of all samples, as CSV and HDF5. The bytes of the files do not depend on how the samples were distributed."""
from __future__ import annotations

import json
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from statejump._version import __version__
from statejump.campaign.plan import Plan
from statejump.campaign.work import Batch
from statejump.core import libraries, tables
from statejump.core.hdf5 import made
from statejump.schema.fields import attached_to_json

if TYPE_CHECKING:
    import h5py
    import pandas


@dataclass(frozen=True)
class Table:
    """Columns of a campaign, one value per sample. A failed sample has the outcomes NaN, and its reason in ``error``.

    :param parameters: column of each varied key
    :param outcomes: column of each outcome
    :param error: error message of each sample; "" if it did not fail
    :param error_kind: error messages without the numbers that differ between failures of one kind
    """

    parameters: dict[str, np.ndarray]
    outcomes: dict[str, np.ndarray]
    error: list[str]
    error_kind: list[str]

    @property
    def failed(self) -> np.ndarray:
        """Which samples failed."""
        return np.array([bool(error) for error in self.error])

    def frame(self) -> pandas.DataFrame:
        """Return a row per sample: varied keys, outcomes, error."""
        columns: dict[str, np.ndarray | list[str]] = {**self.parameters, **self.outcomes, "error": self.error}
        frame = libraries.frame(columns)
        frame.index.name = "sample"
        return frame


def make_table(campaign: Plan, batches: Iterable[Batch]) -> Table:
    """Collect all samples in the order of their numbers; omit samples that the campaign does not need."""
    parameters = np.array([campaign.values(index) for index in range(campaign.samples)], dtype=float)
    outcomes = np.full((campaign.samples, len(campaign.units)), np.nan)
    errors, kinds = [""] * campaign.samples, [""] * campaign.samples
    for batch in batches:
        indices = np.array(batch.indices)
        wanted = indices < campaign.samples
        outcomes[indices[wanted]] = batch.values[wanted]
        for index, error in batch.errors.items():
            if index < campaign.samples:
                errors[index], kinds[index] = error, batch.error_kinds.get(index, error)
    return Table(
        {parameter.keys[0]: parameters[:, place] for place, parameter in enumerate(campaign.vary)},
        {name: outcomes[:, place] for place, name in enumerate(campaign.units)},
        errors, kinds,
    )


def write_csv(table: Table, path: Path) -> None:
    """Write one line per sample in full precision. The outcomes of a failed sample are empty cells."""
    columns = [values.tolist() for values in (*table.parameters.values(), *table.outcomes.values())]
    count = len(table.parameters)
    # Cells as texts. NaN is kept for a sample that did not fail: the event did not happen.
    rows = (
        [index, *map(repr, row[:count]), *("" if error else repr(value) for value in row[count:]), error]
        for index, (error, *row) in enumerate(zip(table.error, *columns))
    )
    tables.write_csv(path, ["sample", *table.parameters, *table.outcomes, "error"], rows)


def write_hdf5(campaign: Plan, table: Table, path: Path) -> None:
    """Write the groups ``parameters`` and ``outcomes``, whose columns have units, and the data set ``failed``."""
    h5py = libraries.h5py()

    with made(path) as file:
        file.attrs["campaign"] = campaign.text
        file.attrs["command"] = campaign.command
        file.attrs["model"] = campaign.model
        file.attrs["case"] = json.dumps(campaign.case.with_defaults(), default=attached_to_json)
        file.attrs["key_sha256"] = campaign.key
        if campaign.seed is not None:
            file.attrs["seed"] = campaign.seed
        file.attrs["statejump_version"] = __version__
        file.attrs["numpy_version"] = np.__version__
        file.attrs["h5py_version"] = h5py.__version__
        _dataset(file, "sample", np.arange(len(table.error)), "-")
        for name, values in table.parameters.items():
            _dataset(file, f"parameters/{name}", values, campaign.unit_of(name))
        for name, values in table.outcomes.items():
            _dataset(file, f"outcomes/{name}", values, campaign.units[name])
        failed = np.flatnonzero(table.failed)
        texts = [table.error[index].encode() for index in failed]
        longest = max([1, *map(len, texts)])
        _dataset(file, "failed/sample", failed, "-")
        _dataset(file, "failed/error", np.array(texts, dtype=h5py.string_dtype("utf-8", longest)), "-")


def _dataset(file: h5py.File, name: str, values: np.ndarray, unit: str) -> None:
    dataset = file.create_dataset(name, data=values, track_times=False)
    dataset.attrs["unit"] = unit
