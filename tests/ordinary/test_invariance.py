# SPDX-License-Identifier: GPL-3.0-or-later
"""Transformed structures have the same jump."""
from __future__ import annotations

from copy import deepcopy

import numpy as np
import pytest

import structures
from invariance import apart, solved, suitable, tolerance_m
from transforms import TRANSFORMS, Changed

# Small structures of families with complete paths; the campaign invariance.py has all families.
FAMILIES = ["warren", "tower", "bracket", "boom", "tripod", "umbrella"]
SAMPLE = [(one, solved(one.document)) for one in suitable(12, 100, FAMILIES, 30)]


@pytest.mark.parametrize("name", TRANSFORMS)
def test_the_jump_stays(name: str) -> None:
    wrong = []
    for one, first in SAMPLE:
        row = apart(one.document, first, name, structures.random_of(name, one.seed))
        if not row["same"]:
            wrong.append((one.name, row))
    assert not wrong


def test_a_jump_that_differs_is_noticed() -> None:
    """The change must be detected: friction larger by 1 %."""
    one = next(one for one in suitable(50, 1, ["bracket", "pratt"], 60)
               if one.document.get("slider") and (found := solved(one.document)).jump_m
               and max(np.abs(jump).max() for jump in found.jump_m.values()) > 1e-6)
    first, made = solved(one.document), deepcopy(one.document)
    for slider in made["slider"]:
        slider["normal_force_N"] *= 1.01
    second = solved(made)
    difference = max(np.abs(second.jump_m[name] - jump).max() for name, jump in first.jump_m.items())
    assert difference > 100 * tolerance_m(one.document, first, Changed(made))
