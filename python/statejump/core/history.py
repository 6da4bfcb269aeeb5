# SPDX-License-Identifier: GPL-3.0-or-later
"""What both models produce: columns over time, written as CSV with units in the headers."""
from __future__ import annotations

import csv
from dataclasses import dataclass
from pathlib import Path
from typing import Iterable, Mapping

import numpy as np

from statejump.core.errors import StatejumpError
from statejump.core.output import write_atomically

# Same names for both models; a model writes the columns that it has, in this order.
SPRING_SLIDER_COLUMNS = (
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

UMBRELLA_COLUMNS = (
    "time_s",
    "temperature_change_K",
    "theta2_rad",  # of AB, from A to B, anticlockwise from AC
    "theta4_rad",  # of BC, from C to B
    "length_ab_m",
    "length_bc_m",
    "centroid_ab_x_m",  # the paper's X_G1, and so on
    "centroid_ab_y_m",
    "centroid_bc_x_m",
    "centroid_bc_y_m",
    "bearing_x_m",
    "bearing_y_m",
    "journal_x_m",
    "journal_y_m",
    "eccentricity_x_m",  # journal minus bearing centre
    "eccentricity_y_m",
    "penetration_depth_m",  # negative: gap
    "normal_force_N",
    "tangential_force_N",  # friction on the journal, along the normal turned by +90 degrees
    "slipping",
    "kinetic_energy_J",
    "axial_energy_J",
    "contact_energy_J",
    "torsion_energy_J",
    "axial_dissipation_J",
    "pin_dissipation_J",
    "friction_dissipation_J",
    "impact_dissipation_J",
    "thermal_work_J",
)

TRUSS_COLUMNS = (
    "time_s",
    "temperature_change_K",
    "elastic_energy_J",  # of links, springs, torsion springs and contacts
    "kinetic_energy_J",
    "friction_dissipation_J",
    "damping_dissipation_J",  # of links, pins and contacts
    "thermal_work_J",
    "external_work_J",  # of the dead loads
)


def common_order(names: Iterable[str]) -> list[str]:
    """Return the names in their common order; ValueError if one is unknown. Columns of an item,
    ``name[item]`` or ``name[item].x``, follow in the order given."""
    given = list(names)
    items = [name for name in given if "[" in name]
    if items:
        plain = [name for name in given if "[" not in name]
        return _ordered(plain, TRUSS_COLUMNS) + items
    return _ordered(given, UMBRELLA_COLUMNS if "theta2_rad" in given else SPRING_SLIDER_COLUMNS)


def _ordered(given: Iterable[str], order: tuple[str, ...]) -> list[str]:
    names = set(given)
    for name in sorted(names.difference(order)):
        raise ValueError(f"unknown column {name}")
    return [name for name in order if name in names]


def write_columns(columns: Mapping[str, np.ndarray], path: Path) -> None:
    """Write columns of equal length as CSV; full precision, so nothing is lost."""
    rows = zip(*(values.tolist() for values in columns.values()))
    with write_atomically(path) as stream:
        writer = csv.writer(stream)
        writer.writerow(columns)
        writer.writerows([value if isinstance(value, str) else repr(value) for value in row] for row in rows)


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
        """Write the columns in the common order, see :func:`write_columns`."""
        write_columns({name: self.columns[name] for name in common_order(self.columns)}, path)

    @staticmethod
    def read_csv(path: Path) -> "History":
        """Read a file that a model wrote."""
        with path.open(newline="", encoding="utf-8") as stream:
            rows = list(csv.reader(stream))
        if len(rows) < 2:
            raise StatejumpError(f"{path}: holds no samples")
        names, body = rows[0], rows[1:]
        try:
            common_order(names)
        except ValueError as problem:
            raise StatejumpError(f"{path}: {problem}") from None
        columns = {}
        for i, name in enumerate(names):
            cells = [row[i] for row in body]
            columns[name] = np.array(cells) if name == "stage" else np.array([float(cell) for cell in cells])
        return History(columns)
