# SPDX-License-Identifier: GPL-3.0-or-later
"""Expansion of the tubes of the Britannia Bridge on rollers."""
from __future__ import annotations

from manual import ORDER, Entry, Row, hottest, link, node, show, truss

FOOT, INCH = 0.3048, 0.0254
HALF_M, CHANGE_K, ALPHA, ROLLING = 1511 * FOOT / 2, 20.0, 1.15e-5, 0.01
WEIGHT_N = 4680 * 1016 * 9.81 / 2  # of half of a tube


def entry() -> Entry:
    # Half of the tube: fixed at the central tower, rollers at the land tower and at the abutment.
    tower = 0.7 * HALF_M
    case = truss("tubular_bridge", [
        node("tower", 0.0, 0.0, fixed="xy"), node("land tower", tower, 0.0, fixed="y"),
        node("abutment", HALF_M, 0.0, fixed="y")],
        CHANGE_K, link=[link("long span", "tower", "land tower", 190e9, 1.0, ALPHA),
                        link("short span", "land tower", "abutment", 190e9, 1.0, ALPHA)],
        slider=[{"name": f"rollers {name}", "nodes": [name], "axis": [1.0, 0.0], "friction_coefficient": ROLLING,
                 "normal_force_N": WEIGHT_N * part} for name, part in (("land tower", 0.5), ("abutment", 0.15))])
    moved = float(hottest(case.reduced(), "displacement_m")[2, 0]) / INCH
    return Entry(
        name="tubular_bridge", part="Whole structures", title="Expansion of the Britannia Bridge (order of magnitude)",
        kind=ORDER,
        source="F. M. Holmes, Engineers and their Triumphs: the tubes occasionally move two and a half inches with the "
        "sun, fixed at the central tower and on rollers elsewhere; length 1511 ft, 4680 tons each: Encyclopaedia "
        "Britannica, 9th ed., vol. 4, p. 335", uncertainty="neither the temperature of the iron (20 K taken) nor the "
        "friction of the rollers (0.01) is stated",
        statement="A wrought-iron tube is fixed in its middle and rests on rollers. Find the motion of its end on a "
        "sunny day.",
        case=case, tolerance=1.0, reason="a factor of two",
        rows=[Row("motion of the abutment end", "in", 2.5, moved, low=1.25, high=5.0)],
        verdict="The order of magnitude agrees.")


if __name__ == "__main__":
    show(entry())
