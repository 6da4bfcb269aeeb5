# SPDX-License-Identifier: GPL-3.0-or-later
"""What both models produce: columns over time, written as CSV with units in the headers."""
from __future__ import annotations

import csv
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from .errors import StatejumpError
from .output import write_atomically

# Same names for both models; a model writes the columns that it has.
COLUMNS = (
    "time_s",
    "temperature_change_K",
    "displacement_m",
    "axial_force_N",  # compression positive
    "friction_force_N",  # of the ground on the block
    "stop_force_N",  # of the stops on the block
    "elastic_energy_J",  # of the link
    "preload_energy_J",
    "contact_energy_J",
    "kinetic_energy_J",
    "friction_dissipation_J",
    "damping_dissipation_J",
    "thermal_work_J",
    "external_work_J",  # of the normal force
    "slipping",
    "stop_contact",
    "floor_normal_force_N",
    "stage",
)


@dataclass(frozen=True)
class History:
    """Columns of equal length by name; all numeric but ``stage``."""

    columns: dict[str, np.ndarray]

    def __getitem__(self, name: str) -> np.ndarray:
        return self.columns[name]

    def __contains__(self, name: str) -> bool:
        return name in self.columns

    def __len__(self) -> int:
        return len(self.columns["time_s"])

    def write_csv(self, path: Path) -> None:
        """Write the columns in the common order; full precision, so nothing is lost."""
        names = [name for name in COLUMNS if name in self.columns]
        rows = zip(*(self.columns[name].tolist() for name in names))
        with write_atomically(path) as stream:
            writer = csv.writer(stream)
            writer.writerow(names)
            writer.writerows([value if isinstance(value, str) else repr(value) for value in row] for row in rows)

    @staticmethod
    def read_csv(path: Path) -> "History":
        """Read a file that a model wrote."""
        with path.open(newline="", encoding="utf-8") as stream:
            rows = list(csv.reader(stream))
        if len(rows) < 2:
            raise StatejumpError(f"{path}: holds no samples")
        names, body = rows[0], rows[1:]
        unknown = [name for name in names if name not in COLUMNS]
        if unknown:
            raise StatejumpError(f"{path}: unknown column {unknown[0]}")
        columns = {}
        for i, name in enumerate(names):
            cells = [row[i] for row in body]
            columns[name] = np.array(cells) if name == "stage" else np.array([float(cell) for cell in cells])
        return History(columns)
