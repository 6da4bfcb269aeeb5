# SPDX-License-Identifier: GPL-3.0-or-later
"""Two hinged bars under a load: ANSYS VM4."""
from __future__ import annotations

from math import cos, hypot, radians, sin

from manual import CLOSED_FORM, Entry, Row, link, node, show, truss
from scipy.optimize import brentq

INCH, POUND, PSI = 0.0254, 4.4482216152605, 6894.757293168
LENGTH_M, AREA_M2, YOUNG_PA, LOAD_N = 180 * INCH, 0.5 * INCH**2, 30e6 * PSI, 5000 * POUND
HALF_M, DEPTH_M = LENGTH_M * cos(radians(30)), LENGTH_M * sin(radians(30))


def exact() -> tuple[float, float]:
    """Return deflection [in] and stress [psi] with the displaced geometry."""

    def unbalance(deflection_m: float) -> float:
        length = hypot(HALF_M, DEPTH_M + deflection_m)
        return 2 * YOUNG_PA * AREA_M2 * (length / LENGTH_M - 1) * (DEPTH_M + deflection_m) / length - LOAD_N

    deflection = float(brentq(unbalance, 0.0, 0.1, xtol=1e-15))
    return deflection / INCH, YOUNG_PA * (hypot(HALF_M, DEPTH_M + deflection) / LENGTH_M - 1) / PSI


def entry() -> Entry:
    case = truss("vm4", [
        node("A", 0.0, 0.0, fixed="xy"), node("B", HALF_M, -DEPTH_M, force_N=[0.0, -LOAD_N]),
        node("C", 2 * HALF_M, 0.0, fixed="xy")],
        link=[link("L1", "A", "B", YOUNG_PA, AREA_M2), link("L2", "B", "C", YOUNG_PA, AREA_M2)])
    run = case.reduced()
    deflection = -float(run["displacement_m"][0, 1, 1]) / INCH
    stress = -float(run["links/axial_force_N"][0, 0]) / AREA_M2 / PSI
    theory = exact()
    return Entry(
        name="vm4", part="Statics and thermal bars", title="Deflection of a hinged support (ANSYS VM4)",
        kind=CLOSED_FORM,
        source="S. Timoshenko, Strength of Materials I, 3rd ed., p. 10, problem 2; targets of VM4 in ansys/pymapdl "
        "28864918, examples/06-verif-manual/vm-004", uncertainty="exact in linear theory",
        statement="Two steel bars of 15 ft and 0.5 in² hang from two hinges at 30° below the horizontal. A load of "
        "5000 lb acts where they meet. Find its deflection and the stress.",
        case=case, tolerance=2e-4, reason="solver entries",
        model="The reference is linear. Our bars are in equilibrium in the displaced geometry; the exact solution of "
        "the displaced truss is the theory.",
        rows=[Row("deflection", "in", 0.12, deflection, theory=theory[0]),
              Row("stress", "psi", 10000, stress, theory=theory[1])],
        verdict="The difference to linear theory is that of the displaced geometry.")


if __name__ == "__main__":
    show(entry())
