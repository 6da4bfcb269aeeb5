# SPDX-License-Identifier: GPL-3.0-or-later
"""Three parallel wires of copper and steel under a load, heated: ANSYS VM3."""
from __future__ import annotations

from manual import CLOSED_FORM, Entry, Row, hottest, link, node, show, truss

INCH, POUND, PSI, FAHRENHEIT = 0.0254, 4.4482216152605, 6894.757293168, 5 / 9
AREA_M2, LENGTH_M = 0.1 * INCH**2, 20 * INCH
COPPER, STEEL = (16e6 * PSI, 92e-7 / FAHRENHEIT), (30e6 * PSI, 70e-7 / FAHRENHEIT)
CHANGE_K, LOAD_N = 10 * FAHRENHEIT, 4000 * POUND


def exact() -> tuple[float, float]:
    """Return the stresses [psi] of copper and steel with the stiffness E A over the expanded length."""
    free = [(young * AREA_M2, LENGTH_M * (1 + alpha * CHANGE_K)) for young, alpha in (COPPER, COPPER, STEEL)]
    stiffness = sum(rigidity / length for rigidity, length in free)
    length = (LOAD_N + sum(rigidity for rigidity, _ in free)) / stiffness
    stress = [rigidity * (length / free_length - 1) / AREA_M2 / PSI for rigidity, free_length in free]
    return stress[0], stress[2]


def entry() -> Entry:
    nodes = [node(name, 0.0, 0.0, fixed="xy") for name in ("T1", "T2", "T3")]
    nodes.append(node("B", 0.0, -LENGTH_M, fixed="x", force_N=[0.0, -LOAD_N]))
    case = truss("vm3", nodes, CHANGE_K, link=[
        link("C1", "T1", "B", COPPER[0], AREA_M2, COPPER[1]), link("S", "T2", "B", STEEL[0], AREA_M2, STEEL[1]),
        link("C2", "T3", "B", COPPER[0], AREA_M2, COPPER[1])])
    stress = -hottest(case.reduced(), "links/axial_force_N") / AREA_M2 / PSI  # a force is positive in compression
    copper, steel = exact()
    return Entry(
        name="vm3", part="Statics and thermal bars", title="Thermally loaded support structure (ANSYS VM3)",
        kind=CLOSED_FORM, source="S. Timoshenko, Strength of Materials I, 3rd ed., p. 30, problem 9; ANSYS Mechanical "
        "APDL Verification Manual, VM3", uncertainty="three digits are printed: 3e-5",
        statement="Two copper wires and a steel wire, 20 in long and 0.1 in² each, carry 4000 lb together. They are "
        "heated by 10 °F. Find the stresses.",
        case=case, tolerance=2e-4, reason="solver entries; the printed digits allow 3e-5",
        model="Links have the stiffness E A over their expanded length, here 5e-4 of the load difference.",
        rows=[Row("stress of the copper wires", "psi", 10152, float(stress[0]), theory=copper),
              Row("stress of the steel wire", "psi", 19695, float(stress[1]), theory=steel)],
        verdict="The stresses agree with the printed digits.")


if __name__ == "__main__":
    show(entry())
