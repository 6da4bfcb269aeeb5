# SPDX-License-Identifier: GPL-3.0-or-later
"""What changes the state jump of the paper's bar: claims of section 3.4."""
from __future__ import annotations

from typing import Any

from manual import CLOSED_FORM, Curve, Entry, Picture, Row, show

import statejump as sj

FORMULA_MM = 1e3 * 0.5 * 30.0 / (70e9 * 9e-6)


def jump(**changes: Any) -> float:
    """Return the state jump [mm] of the changed case."""
    return float(1e3 * sj.load("table1").changed(changes).reduced().summary["state_jump_m"])


def entry() -> Entry:
    scaled = {
        "twice the friction": ({"joint.friction_coefficient": 0.6}, 2.0),
        "half of the friction": ({"joint.friction_coefficient": 0.15}, 0.5),
        "no friction": ({"joint.friction_coefficient": 0.0}, 0.0),
        "twice the area": ({"link.cross_section_area_m2": 18e-6}, 0.5),
        "half of the length": ({"link.stress_free_length_m": 0.25}, 0.5),
        "half of the clearance": ({"joint.clearance_plus_m": 0.5e-3, "joint.clearance_minus_m": 0.5e-3}, 1.0),
        "half of the temperature": ({"thermal.temperature_change_max_K": 50.0}, 1.0),
    }
    found = {what: jump(**changes) for what, (changes, _) in scaled.items()}
    fractions = (0.0, 0.1, 0.2, 0.3, 0.4, 0.5)
    return Entry(
        name="paper_control", part="The paper's own figures", title="What changes the state jump (paper, section 3.4)",
        kind=CLOSED_FORM, source="C. Chen, T. Li, Y. Tang, Z. Wang, Mech. Sci. 12 (2021) 59-67, sections 3.2 and 3.4: "
        "the jump is l f/(E A), whatever the clearance and the largest temperature; without friction it is zero",
        uncertainty="exact",
        statement="The bar of the entry paper_table1 with changed friction, area, length, clearance and temperature.",
        case=sj.load("table1").changed({"joint.friction_coefficient": 0.6}), tolerance=2e-4, reason="solver entries",
        rows=[Row(what, "mm", factor * FORMULA_MM, found[what], scale=FORMULA_MM)
              for what, (_, factor) in scaled.items()],
        picture=Picture("friction coefficient", "state jump [mm]", [
            Curve("formula", fractions, [FORMULA_MM * at / 0.3 for at in fractions]),
            Curve("ours", fractions, [jump(**{"joint.friction_coefficient": at}) for at in fractions], ours=False)]),
        verdict="The claims hold for this bar.")


if __name__ == "__main__":
    show(entry())
