# SPDX-License-Identifier: GPL-3.0-or-later
"""A heated bar closes a gap: ANSYS VM27."""
from __future__ import annotations

from manual import CLOSED_FORM, Entry, Row, hottest, link, node, show, truss

INCH, PSI, FAHRENHEIT = 0.0254, 6894.757293168, 5 / 9
LENGTH_M, GAP_M, YOUNG_PA, ALPHA = 3 * INCH, 0.002 * INCH, 10.5e6 * PSI, 12.5e-6 / FAHRENHEIT
CHANGE_K = 100 * FAHRENHEIT


def entry() -> Entry:
    area = INCH**2
    case = truss("vm27", [node("A", 0.0, 0.0, fixed="xy"), node("B", LENGTH_M, 0.0, fixed="y")], CHANGE_K,
                 link=[link("bar", "A", "B", YOUNG_PA, area, ALPHA)],
                 slider=[{"name": "gap", "nodes": ["B"], "axis": [1.0, 0.0], "friction_coefficient": 0.0,
                          "normal_force_N": 0.0, "clearance_plus_m": GAP_M}])
    stress = float(hottest(case.reduced(), "links/axial_force_N")[0]) / area / PSI
    free = LENGTH_M * (1 + ALPHA * CHANGE_K)
    linear = YOUNG_PA * (ALPHA * CHANGE_K - GAP_M / LENGTH_M) / PSI
    ours = YOUNG_PA * (free - LENGTH_M - GAP_M) / free / PSI
    return Entry(
        name="vm27", part="Statics and thermal bars", title="Thermal expansion to close a gap (ANSYS VM27)",
        kind=CLOSED_FORM, source="C. O. Harris, Introduction to Stress Analysis, 1959, p. 58, problem 8, of which "
        "ANSYS VM27 and VM64 are copies; the script evaluates E (α ΔT - gap/length)", uncertainty="exact in linear "
        "theory",
        statement="An aluminium bar of 3 in stands 0.002 in from a rigid wall. It is heated by 100 °F. Find the stress "
        "along its axis.", case=case, tolerance=2e-4, reason="solver entries",
        model="The stress is E times the strain over the expanded length l (1 + α ΔT) instead of l.",
        rows=[Row("axial stress", "psi", linear, stress, theory=ours)],
        verdict="The difference is exactly that of the length which the strain refers to.")


if __name__ == "__main__":
    show(entry())
