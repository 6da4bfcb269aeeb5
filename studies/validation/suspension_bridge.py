# SPDX-License-Identifier: GPL-3.0-or-later
"""Sag of the Verrazzano-Narrows Bridge in summer and winter."""
from __future__ import annotations

from manual import ORDER, Entry, Row, show
from suspension import FOOT, Bridge

SEASONS_K = 50.0


def entry() -> Entry:
    bridge = Bridge("suspension_bridge", 4260 * FOOT, 690 * FOOT, (690 - 228) * FOOT, 1215 * FOOT)
    return Entry(
        name="suspension_bridge", part="Whole structures",
        title="Sag of the Verrazzano-Narrows Bridge in summer (order of magnitude)", kind=ORDER,
        source="roadway 12 ft lower in summer than in winter: sightseersdelight.com and pbase.com/image/158349617, "
        "after the bridge's operator; span 4260 ft, towers 690 ft, roadway 228 ft: Encyclopaedia Britannica",
        uncertainty="the seasonal change of the steel is not stated: 50 K are taken; sag and side spans (1215 ft) are "
        "estimates",
        statement="Steel cables hang over two towers and are held in anchorages; saddles roll on the towers. Find how "
        "much lower the middle hangs if the cables warm by 50 K.", case=bridge.case(SEASONS_K), tolerance=1.0,
        reason="a factor of two",
        rows=[Row("descent of the middle", "m", 12 * FOOT, bridge.descent_m(SEASONS_K), low=6 * FOOT, high=24 * FOOT)],
        verdict="The order of magnitude agrees. A stiffening girder and the real seasonal change would be needed for "
        "more.")


if __name__ == "__main__":
    show(entry())
