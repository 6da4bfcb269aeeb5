# SPDX-License-Identifier: GPL-3.0-or-later
"""Counter-example: a row of blocks that friction could hold, and that never shakes down."""
from __future__ import annotations

from manual import CLOSED_FORM, Entry, Row, show
from walking import CYCLES, Walk

import numpy as np

import attrs


def row(change_K: float) -> Walk:
    """Return nine blocks on a slope that carries a third of their friction."""
    return Walk("shakedown_slope", 9, 6.0, 1.6e10 * 2.4e-3, 2.9e-5, change_K, 360.0, 117.0)


def entry() -> Entry:
    one = row(40.0)
    run = one.case().reduced()
    ends = np.asarray(run.at([float(k) for k in range(CYCLES + 1)])["displacement_m"])[:, :, 0].mean(axis=1)
    # Below this change every block can be held: the strain that friction holds back is larger than the thermal one.
    held = attrs.evolve(one, change_K=0.2 * (one.friction_N - one.drift_N) / one.stiffness_N / one.alpha)
    return Entry(
        name="shakedown_slope", part="Frictional shakedown", title="Blocks on a slope that never shake down "
        "(counter-example)",
        kind=CLOSED_FORM, source="walking of plates: H. Moseley 1855; as an example that static strength does not "
        "bound a ratchet: A. Klarbring, M. Ciavarella, J. R. Barber 2007; the script evaluates the walk of the blocks",
        uncertainty="exact for small strain",
        statement="The friction of nine blocks on a slope is three times the load, so they rest without heat. Under "
        "temperature cycles of 40 K they walk, by the same distance in each cycle. Under cycles that friction holds "
        "everywhere they do not.",
        case=one.case(), tolerance=2e-4, reason="solver entries",
        rows=[Row(f"walk of cycle {k + 1}", "mm", 1e3 * one.blocks_m, 1e3 * float(ends[k + 1] - ends[k]))
              for k in (1, 2)]
        + [Row("walk of the last cycle, small temperatures", "mm", 0.0, 1e3 * held.walk_m(), scale=1e3 * one.blocks_m)],
        verdict="The row ratchets for ever above a temperature change and shakes down below it.")


if __name__ == "__main__":
    show(entry())
