# SPDX-License-Identifier: GPL-3.0-or-later
"""Energy account of a run: supplied, stored and dissipated energy, and the residue between them."""
from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from statejump.core.run import Run
from statejump.report.labels import Labels

# Side of the account by the ending of the name of a column.
ROLES = {"_work_J": "supplied", "_energy_J": "stored", "_dissipation_J": "dissipated"}


@dataclass(frozen=True)
class Entry:
    """One line of the account."""

    label: str
    role: str
    change_J: float  # over the whole run


@dataclass(frozen=True)
class Account:
    """The account of a run, as lines and over time."""

    entries: list[Entry]
    residue_J: float  # supplied - stored - dissipated, at the end
    largest_residue_J: float  # at any sample
    turnover_J: float  # largest of the three sums at any sample, the reference of the residue
    columns: dict[str, np.ndarray]  # sums over time, [J]


def account(run: Run, labels: Labels) -> Account:
    """Return the energy account of a run: changes of its energy columns since the first sample."""
    zero = np.zeros(len(run.time_s))
    sums = {role: zero.copy() for role in ROLES.values()}
    friction = zero.copy()
    entries = []
    for name, column in run.energy.items():
        role = next((role for ending, role in ROLES.items() if name.endswith(ending)), None)
        if role is None or column.values.ndim != 1:
            continue
        change = column.values - column.values[0]
        sums[role] += change
        if name.startswith("friction"):
            friction += change
        entries.append(Entry(labels.plain(name), role, float(change[-1])))
    order = list(ROLES.values())
    entries.sort(key=lambda entry: order.index(entry.role))
    residue = sums["supplied"] - sums["stored"] - sums["dissipated"]
    return Account(
        entries, float(residue[-1]), float(np.max(np.abs(residue))),
        max(float(np.max(np.abs(values))) for values in sums.values()),
        {
            "supplied_J": sums["supplied"], "stored_J": sums["stored"], "friction_J": friction,
            "damping_J": sums["dissipated"] - friction,
        },
    )
