# SPDX-License-Identifier: GPL-3.0-or-later
"""Length of Concorde in supersonic cruise."""
from __future__ import annotations

from manual import ORDER, Entry, Row, hottest, link, node, show, truss

LENGTH_M, FUSELAGE_C, GROUND_C, ALPHA = 62.2, 95.0, 15.0, 23e-6


def entry() -> Entry:
    # The cabin is held at one end and slides beside the fuselage.
    case = truss("concorde", [node("nose", 0.0, 0.0, fixed="xy"), node("tail", LENGTH_M, 0.0, fixed="y")],
                 FUSELAGE_C - GROUND_C,
                 link=[link("fuselage", "nose", "tail", 70e9, 0.1, ALPHA)],
                 slider=[{"name": "cabin", "nodes": ["tail"], "axis": [1.0, 0.0], "friction_coefficient": 0.3,
                          "normal_force_N": 1e4}])
    grown = 100 * float(hottest(case.reduced(), "displacement_m")[1, 0])
    return Entry(
        name="concorde", part="Whole structures", title="Length of Concorde in supersonic cruise (order of magnitude)",
        kind=ORDER,
        source="New Scientist, 20 May 2000, The Last Word: 62.2 m, 95 °C on average, expands by approximately 12.5 cm; "
        "other accounts state 18 to 30 cm", uncertainty="no account states the temperature on the ground or how the "
        "length was measured",
        statement="The aluminium fuselage of Concorde is 95 °C warm in cruise. The cabin is held at one end and slides "
        "beside it. Find how much longer the fuselage becomes, from 15 °C on.", case=case, tolerance=1.0,
        reason="a factor of two",
        rows=[Row("growth of the fuselage", "cm", 12.5, grown, low=6.25, high=25.0)],
        verdict="The order of magnitude agrees.")


if __name__ == "__main__":
    show(entry())
