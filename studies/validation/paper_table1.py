# SPDX-License-Identifier: GPL-3.0-or-later
"""State jump of the paper's bar on a slider: Chen, Li, Tang, Wang 2021, section 3.3."""
from __future__ import annotations

from manual import OTHER_CODE, Curve, Entry, Picture, Row, show

import numpy as np

import statejump as sj

FRICTION_N, LENGTH_M, YOUNG_PA, AREA_M2, ALPHA = 30.0, 0.5, 70e9, 9e-6, 23.4e-6


def entry() -> Entry:
    case = sj.load("table1")
    run = case.reduced()
    jump = 1e3 * run.summary["state_jump_m"]
    slip_K = FRICTION_N / (YOUNG_PA * AREA_M2 * ALPHA)
    first = run.events.first("first_slip")
    times = np.asarray(run["time_s"])
    # The bar expands by α T l; friction holds back f l_T/(E A).
    change = np.asarray(run["temperature_change_K"])
    return Entry(
        name="paper_table1", part="The paper's own figures", title="State jump of the bar on a slider (paper, section "
        "3.3)",
        kind=OTHER_CODE, source="C. Chen, T. Li, Y. Tang, Z. Wang, Mech. Sci. 12 (2021) 59-67, section 3.3: l f/(E A) "
        "= 0.024 mm; ANSYS with BEAM188, SOLID185 and contact elements: 0.0244 mm", uncertainty="two digits of the "
        "formula, three of ANSYS; the penalty stiffness of its contact is not stated",
        statement="A bar of 0.5 m with a block at its end, which rubs with 30 N, is heated by 100 K and cools again. "
        "The block has stops. Find the displacement that stays.", case=case, tolerance=2e-4, reason="solver entries",
        rows=[Row("state jump, formula", "mm", 1e3 * LENGTH_M * FRICTION_N / (YOUNG_PA * AREA_M2), jump),
              Row("state jump, ANSYS", "mm", 0.0244, jump, tolerance=0.03),
              Row("first slip", "K", slip_K, float(np.interp(first.time_s, times, change)) if first else 0.0,
                  tolerance=1e-3)],
        picture=Picture("temperature change [K]", "displacement [mm]", [
            Curve("ours", change, 1e3 * np.asarray(run["displacement_m"])),
            Curve("formula of the jump", [0.0], [1e3 * LENGTH_M * FRICTION_N / (YOUNG_PA * AREA_M2)], ours=False)]),
        verdict="The jump is that of the formula. ANSYS is 2.5 % higher: its penalty contact lets the block move "
        "before it slips.")


if __name__ == "__main__":
    show(entry())
