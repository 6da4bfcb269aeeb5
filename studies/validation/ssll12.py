# SPDX-License-Identifier: GPL-3.0-or-later
"""Plane truss under loads, settlements and heat: AFNOR SSLL12/89."""
from __future__ import annotations

from manual import OTHER_CODE, Entry, Row, hottest, link, node, show, truss

YOUNG_PA, ALPHA, THIN_M2, THICK_M2 = 2.1e11, 1e-5, 1.41e-3, 2.82e-3
SMALL = 1e-3  # the reference is linear: loads, settlements and heat are scaled, results are scaled back
PLACES = {"N1": (0, 0), "N2": (5, 0), "N3": (15, 0), "N4": (20, -4), "N5": (25, 0), "N6": (35, 0), "N7": (0, 4),
          "N8": (10, 4), "N9": (20, 4), "N10": (30, 4)}
LOADS_N = {"N8": -150e3, "N10": -100e3}
THICK = "12 23 34 45 56 78 89 9-10 49".split()
THIN = "17 72 28 83 39 95 5-10 10-6".split()
SETTLEMENTS_M = {"N1": -0.02, "N4": -0.03, "N6": -0.015}


def bars() -> list[dict[str, object]]:
    """Return the bars of the truss."""
    made = []
    for names, area in ((THICK, THICK_M2), (THIN, THIN_M2)):
        for name in names:
            ends = name.split("-") if "-" in name else list(name)
            made.append(link(f"B{name}", f"N{ends[0]}", f"N{ends[1]}", YOUNG_PA, area, ALPHA))
    return made


def entry() -> Entry:
    change, prop = 150.0 * SMALL, 1.0
    nodes = []
    for name, (x, y) in PLACES.items():
        load = {"force_N": [0.0, LOADS_N[name] * SMALL]} if name in LOADS_N else {}
        nodes.append(node(name, float(x), float(y), fixed="x" if name == "N1" else "", **load))
    # A rigid prop carries each support; its shrinking moves the support by the settlement.
    props = []
    for name, settlement in SETTLEMENTS_M.items():
        x, y = PLACES[name]
        nodes.append(node(f"G{name}", float(x), y - prop, fixed="xy"))
        props.append(link(f"prop {name}", f"G{name}", name, 1e13, 1.0, 1e-4,
                          temperature_fraction=settlement / prop / (1e-4 * 150.0)))
    case = truss("ssll12", nodes, change, link=bars() + props)
    run = case.reduced()
    force = -float(hottest(run, "links/axial_force_N")[THICK.index("45")]) / SMALL / 1e3
    moved = float(hottest(run, "displacement_m")[4, 1]) / SMALL * 1e3
    return Entry(
        name="ssll12", part="Statics and thermal bars", title="Truss under loads, settlements and heat (AFNOR SSLL12/89)",
        kind=OTHER_CODE, source="AFNOR, Guide de validation des progiciels de calcul de structures, 1990, SSLL12/89, as printed in "
        "the Validation Manual of SCIA Engineer 26.0, with the results of SCIA Engineer",
        uncertainty="four printed digits: 3e-4",
        statement="A truss on three supports, once statically indeterminate, carries two loads. Its supports settle by 20, 30 "
        "and 15 mm, and it is heated by 150 K. Find the force of bar N4-N5 and the displacement of N5.",
        case=case, tolerance=4e-4, reason="the printed digits",
        model="None: the case has a thousandth of loads, settlements and heat. Props that shrink are the settlements.",
        rows=[Row("force of the bar N4-N5", "kN", 43.63, force), Row("displacement y of N5", "mm", -16.18, moved)],
        verdict="Loads, settlements and heat together give the printed force and displacement.")


if __name__ == "__main__":
    show(entry())
