# SPDX-License-Identifier: GPL-3.0-or-later
"""Pipeline that walks towards a riser that pulls at its end."""
from __future__ import annotations

from manual import CLOSED_FORM, Entry, Row, show
from walking import Walk

LENGTH_M, FRICTION_N_PER_M, TENSION_N = 2000.0, 150.0, 63e3


def walk(blocks: int) -> Walk:
    """Return the pipe."""
    return Walk("pipe_tension", blocks, LENGTH_M, 2.05e11 * 0.015, 1.17e-5, 60.0, FRICTION_N_PER_M * LENGTH_M, 0.0,
                TENSION_N)


def entry() -> Entry:
    counts = (15, 25)
    rows = [Row(f"walk per cycle, {count} blocks", "mm", 1e3 * walk(count).blocks_m, 1e3 * walk(count).walk_m(),
                tolerance=1e-3)
            for count in counts]
    rows.append(Row("walk per cycle of the continuous pipe beside 25 blocks", "mm", 1e3 * walk(25).continuous_m,
                    1e3 * walk(25).walk_m(), theory=1e3 * walk(25).blocks_m, tolerance=1e-3))
    return Entry(
        name="pipe_tension", part="Thermal walking", title="Pipeline that walks under end tension", kind=CLOSED_FORM,
        source="M. Carr, F. Sinclair, D. Bruton, Pipeline walking, OTC 17945 (2006), riser tension; the script derives "
        "the walk: (S/f) [α ΔT - (f L - S)/(E A)]", uncertainty="exact for rigid-plastic friction",
        statement="A pipe of 2 km lies on a level seabed with a friction of 150 N/m. A riser pulls at its end with 63 "
        "kN. It is heated by 60 K and cools again. Find its walk per cycle.", case=walk(15).case(), tolerance=1e-3,
        reason="force changes along a bar are those of half a block",
        model="A finite number of blocks.", rows=rows, verdict="The pipe walks towards the riser as derived.")


if __name__ == "__main__":
    show(entry())
