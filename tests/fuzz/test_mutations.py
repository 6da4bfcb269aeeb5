# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests that mutations depend only on their generator, and not on earlier inputs."""
from __future__ import annotations

import random
import re

import mutations

DOCUMENT = {"title": "x", "link": [{"ends": [1, 2], "length_m": 1.5}, {"ends": []}], "thermal": {"period_s": 2.0}}


def drawn() -> list[str]:
    made = (mutations.spoiled_document(DOCUMENT, random.Random(number)) for number in range(3000))
    return [re.sub(" at 0x[0-9a-f]+", "", repr(document)) for document in made]


def test_a_document_is_spoiled_alike_whatever_was_spoiled_before() -> None:
    assert drawn() == drawn()
