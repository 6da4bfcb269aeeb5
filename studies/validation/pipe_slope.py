# SPDX-License-Identifier: GPL-3.0-or-later
"""Pipeline that walks down a slope."""
from __future__ import annotations

from math import cos, sin

from manual import CLOSED_FORM, Curve, Entry, Picture, Row, show
from walking import Walk

SLOPE, WEIGHT_N_PER_M, LENGTH_M, FRICTION = 0.07, 500.0, 4000.0, 0.3


def walk(blocks: int) -> Walk:
    """Return the pipe."""
    weight = WEIGHT_N_PER_M * LENGTH_M
    return Walk("pipe_slope", blocks, LENGTH_M, 2.05e11 * 0.02, 1.2e-5, 80.0, FRICTION * weight * cos(SLOPE),
                weight * sin(SLOPE))


def entry() -> Entry:
    counts = (10, 20, 40)
    found = {count: walk(count).walk_m() for count in counts}
    rows = [Row(f"walk per cycle, {count} blocks", "mm", 1e3 * walk(count).continuous_m, 1e3 * found[count],
                theory=1e3 * walk(count).blocks_m) for count in counts]
    return Entry(
        name="pipe_slope", part="Thermal walking", title="Pipeline that walks down a slope", kind=CLOSED_FORM,
        source="M. Carr, F. Sinclair, D. Bruton, Pipeline walking, OTC 17945 (2006), seabed slope; the script derives "
        "the walk: L (tan β/μ) [α ΔT - (μ cos β - sin β) w L/(E A)]", uncertainty="exact for rigid-plastic friction",
        statement="A pipe of 4 km and 500 N/m lies on a slope of 4°; friction 0.3. It is heated by 80 K and cools "
        "again. Find its walk per cycle.", case=walk(20).case(), tolerance=2e-4, reason="solver entries",
        model="A finite number of blocks: the resting blocks are a whole number m of blocks apart, instead of n tan "
        "β/μ.", rows=rows,
        picture=Picture("blocks", "walk per cycle [mm]", [
            Curve("continuous pipe", [8, 42], [1e3 * walk(10).continuous_m] * 2),
            Curve("ours", counts, [1e3 * found[count] for count in counts], ours=False)]),
        verdict="The walk is that of the blocks' closed form; it approaches the continuous pipe by 1/n.")


if __name__ == "__main__":
    show(entry())
