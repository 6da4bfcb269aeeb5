# SPDX-License-Identifier: GPL-3.0-or-later
"""Rise and fall of the Golden Gate Bridge with the temperature."""
from __future__ import annotations

from manual import ORDER, Entry, Row, show
from suspension import FOOT, Bridge

CHANGE_K = 50.0


def entry() -> Entry:
    bridge = Bridge("golden_gate", 4200 * FOOT, 746 * FOOT, (746 - 220) * FOOT, 1125 * FOOT)
    return Entry(
        name="golden_gate", part="Whole structures",
        title="Rise and fall of the Golden Gate Bridge (order of magnitude)", kind=ORDER,
        source="roadway rises and falls as much as 16 ft with the temperature: Outdoor Exploratorium, San Francisco, "
        "as quoted at blogs.scienceforums.net/swansont/archives/5814; span 4200 ft, towers 746 ft and roadway 220 ft "
        "above the water: the bridge's fact sheets", uncertainty="the temperatures are not stated: 50 K are taken; "
        "traffic loads may be part of the 16 ft; sag and side spans (1125 ft) are estimates",
        statement="The steel cables of a suspension bridge of 1280 m span expand over its towers and backstays, like "
        "those of the entry suspension_bridge. Find the vertical movement of the middle between the coldest and the "
        "hottest day.", case=bridge.case(CHANGE_K), tolerance=1.0,
        reason="a factor of two",
        rows=[Row("range of the middle", "m", 16 * FOOT, bridge.descent_m(CHANGE_K), low=8 * FOOT, high=32 * FOOT)],
        verdict="Ours is half of the stated movement. The source gives neither temperatures nor loads, and 16 ft by "
        "temperature alone would need 100 K: traffic and wind are probably in it. Without a reading at known "
        "temperatures the entry decides nothing.")


if __name__ == "__main__":
    show(entry())
