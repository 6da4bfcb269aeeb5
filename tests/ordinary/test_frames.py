# SPDX-License-Identifier: GPL-3.0-or-later
"""Frames finish, and their jumps do not depend on order, names, units, position and direction."""
from __future__ import annotations

from frames import frames, row

FAMILIES = ["warren", "tower", "bracket", "boom", "tripod", "umbrella"]


def test_frames_finish_with_a_jump_of_their_own() -> None:
    rows = [row(one, made, 2) for one, made in frames(12, 100, FAMILIES, 30)]
    assert [one for one in rows if one["outcome"] != "finished" or one["difference"] > 1] == []
    assert sum(one["joints"] > 0 and one["jump_m"] > 1e-9 for one in rows) >= 1
