# SPDX-License-Identifier: GPL-3.0-or-later
"""Measured loops of the manual: reading, prediction of later rows with identified parameters, losses."""
from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from manual import Row

from statejump.identification.hysteresis import remembered

DATA = Path(__file__).resolve().parent / "data"


def read(name: str) -> dict[str, np.ndarray]:
    """Return the columns of a file of the folder ``data``."""
    rows = np.genfromtxt(DATA / name, delimiter=",", names=True)
    return {column: rows[column] for column in rows.dtype.names}


def predicted(found: Any, displacement: np.ndarray, fresh: bool = False) -> np.ndarray:
    """Return the force that an identified joint predicts along a path."""
    return np.asarray(found.fit.model.answer(found.values, displacement, remembered(displacement, fresh)))


def blind(quantity: str, unit: str, measured: float, ours: float, half: float) -> Row:
    """Return the row of a blind prediction: it passes if the measured value is within ``ours`` ± ``half``."""
    return Row(quantity, unit, measured, ours, low=measured - half, high=measured + half)


def loss(force: np.ndarray, displacement: np.ndarray) -> float:
    """Return the energy loss along a path [J]."""
    return float(np.trapz(force, displacement))
