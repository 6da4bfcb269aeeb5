# SPDX-License-Identifier: GPL-3.0-or-later
"""Aluminium plate that creeps down a roof: Serway, chapter 19."""
from __future__ import annotations

from math import cos, radians, sin, tan

from manual import CLOSED_FORM, Entry, Row, show
from walking import Walk

LENGTH_M, SLOPE, FRICTION, WEIGHT_N = 1.20, radians(18.5), 0.42, 50.0
ALPHA, CHANGE_K = 24e-6 - 15e-6, 32.0


def walk(blocks: int) -> Walk:
    """Return the plate; the roof's expansion is subtracted from the plate's."""
    return Walk("roof_plate", blocks, LENGTH_M, 7e7, ALPHA, CHANGE_K, FRICTION * WEIGHT_N * cos(SLOPE),
                WEIGHT_N * sin(SLOPE))


def entry() -> Entry:
    one, few = walk(50), walk(30)
    ours = one.walk_m()
    return Entry(
        name="roof_plate", part="Thermal walking", title="Plate that creeps down a roof (Serway)", kind=CLOSED_FORM,
        source="R. A. Serway and J. W. Jewett, Physics for Scientists and Engineers, 9th ed., chapter 19, problem 78: "
        "daily step (L/μ) (α₂ - α₁) (T_h - T_c) tan θ", uncertainty="exact for a rigid plate",
        statement="An aluminium plate of 1.20 m lies on a roof of 18.5°; the friction coefficient is 0.42. Every day "
        "both are between 4 and 36 °C; the expansion coefficients are 24e-6 and 15e-6 1/K. Find the distance of a day.",
        case=few.case(), tolerance=2e-4, reason="solver entries",
        model="The plate of the reference is rigid; ours is an elastic row of 50 blocks, which move m/n of its length "
        "instead of tan θ/μ. The theory is that of the blocks.",
        rows=[Row("distance of a day", "mm", 1e3 * LENGTH_M / FRICTION * ALPHA * CHANGE_K * tan(SLOPE), 1e3 * ours,
                  theory=1e3 * one.blocks_m),
              Row("distance of a day, 30 blocks", "mm", 1e3 * few.blocks_m, 1e3 * few.walk_m())],
        verdict="The blocks walk by their closed form, which tends to that of the plate as blocks become many.")


if __name__ == "__main__":
    show(entry())
