# SPDX-License-Identifier: GPL-3.0-or-later
"""Jumps of a truss after each cycle, and whether they settle.

Displacements are those of the quasi-static path; a jump is the displacement at the end of a cycle less
that at the start.
"""
from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from statejump.core import units
from statejump.core.progress import Tell
from statejump.kinds.truss.resolved import ResolvedTruss
from statejump.kinds.truss.solve import TrussPath, whole_path

# A jump of a cycle below this share of the largest has settled: events are located to 1e-9 of a branch.
SETTLED = 1e-6
STEADY = 0.01  # two jumps that differ by less are the same growth


@dataclass(frozen=True)
class Verdict:
    """Whether jumps settle over the cycles."""

    word: str  # "no jump", "one cycle", "shakedown", "ratcheting", "not settled"
    text: str
    cycle_jump_m: np.ndarray  # (cycles,) largest motion of a node over each cycle
    dissipation_J: np.ndarray  # (cycles,)


def quick_path(truss: ResolvedTruss, increments_per_branch: int = 50, tell: Tell = lambda share: None,
               **more: Any) -> TrussPath:
    """Return the path with only those events located on which the state depends: the same cycle ends."""
    return whole_path(truss, tell, increments_per_branch=increments_per_branch, locate_events=False, **more)


def node_jumps(found: TrussPath) -> np.ndarray:
    """Return the jump [m] (cycles, nodes, 3) of every node after each cycle, against the start."""
    ends = found.cycle_ends["displacement_m"]
    return ends[1:] - ends[0]


def most_moved(found: TrussPath) -> int:
    """Return the node with the largest jump at the end."""
    return int(np.argmax(np.linalg.norm(node_jumps(found)[-1], axis=1)))


def _cycle_jumps(found: TrussPath) -> np.ndarray:
    return np.linalg.norm(np.diff(found.cycle_ends["displacement_m"], axis=0), axis=2).max(axis=1)


def resolution_m(found: TrussPath, finer: TrussPath) -> float:
    """Return by how much [m] the jumps of cycles after the first depend on the increments, against a path of
    more of them. 0 for one cycle."""
    return float(np.abs(_cycle_jumps(found) - _cycle_jumps(finer))[1:].max(initial=0.0))


def verdict(found: TrussPath, resolution: float = 0.0) -> Verdict:
    """Return whether the jumps of later cycles vanish, go on, or shrink.

    :param resolution: jumps [m] below twice this are numerical, see :func:`resolution_m`
    """
    ends = found.cycle_ends
    each = _cycle_jumps(found)
    heat = np.diff(ends["slider_dissipation_J"].sum(axis=1) + ends["revolute_dissipation_J"].sum(axis=1))
    largest = float(np.abs(found.states["displacement_m"]).max())
    floor = 1e-12 * max(largest, 1e-300)

    def made(word: str, text: str) -> Verdict:
        return Verdict(word, text, each, heat)

    if each.max() <= floor:
        return made("no jump", "no node jumps: the truss returns after every cycle")
    if len(each) == 1:
        return made("one cycle", "one cycle: whether the jump settles needs more, see --cycles")
    first, last, before = each[0], each[-1], each[-2]
    least = max(SETTLED * each.max(), floor, 2 * resolution)
    if last <= least:
        settled = int(np.flatnonzero(each > min(least, 0.5 * each.max()))[-1]) + 1
        slip = heat[-1] > SETTLED * heat.max() if heat.max() > 0 else False
        return made("shakedown", f"the jump settles after cycle {settled}; " + (
            f"joints still slip there and back, {units.plain(heat[-1], 'J', 4)} per cycle" if slip
            else "then no joint slips"))
    if len(each) > 2 and abs(last - before) <= STEADY * last:
        return made("ratcheting", f"the jump grows by {units.plain(last, 'm', 4)} per cycle (cycle {len(each)}; first "
                    f"cycle {units.plain(first, 'm', 4)})")
    return made("not settled", f"the jump of cycle {len(each)} is {100 * last / first:.3g} % of the first cycle's: "
                "neither settled nor steady, more cycles are needed")
