# SPDX-License-Identifier: GPL-3.0-or-later
"""Joints that hold one displacement together: their friction forces are not unique, the displacements are."""
from __future__ import annotations

import copy

import numpy as np
import pytest

import statejump as sj
import structures
import worker
from sketch import Document

SHARED = ("friction_moment_N_m", "stiffness_N_m_per_rad", "preload_moment_N_m")


def divided(document: Document) -> Document:
    """Return the structure with two latches in place of each, which share its moments."""
    made = copy.deepcopy(document)
    made["latch_hinge"] = [
        latch | {"name": latch["name"] + side} | {key: share * latch[key] for key in SHARED}
        for latch in document["latch_hinge"] for side, share in (("a", 0.3), ("b", 0.7))]
    return made


# Several latches in one hinge, or more latches than angles that they can hold. Statuses at which two such latches stick
# make the equations singular. This was taken for a fork of the path.
@pytest.mark.parametrize(("family", "seed"), [("rib", 9113), ("scissor", 9018), ("scissor", 9026)])
def test_latches_that_hold_the_same_angles_have_a_path(family: str, seed: int) -> None:
    document = structures.make(family, seed).document
    whole = worker.numbers(sj.load(document).reduced())
    parts = worker.numbers(sj.load(divided(document)).reduced())
    # Events are located to 1e-9 of a branch.
    assert np.abs(parts["ends"] - whole["ends"]).max() <= 1e-8 * whole["largest_m"]
