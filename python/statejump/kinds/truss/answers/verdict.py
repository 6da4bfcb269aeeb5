# SPDX-License-Identifier: GPL-3.0-or-later
"""Decides whether the jump of an output settles over the cycles. The verdict must not depend on the size of increments.

Between located events, a path with rigid contacts does not depend on the increments. Other paths do: rolling on a
radius that depends on the Hertz depth, and elastic sticking, are integrated with fourth order; slipping balls and
partial slip with second order, so that twice as many increments reduce the error of a cycle to a quarter. Two paths are
therefore compared, with n and 2 n increments per branch. For any order ≥ 1, their difference is at least the error of
the finer path (three times this error for second order). A motion below this difference counts as unresolved.
"""
from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from statejump.core.notes import Note
from statejump.core.units import plain
from statejump.kinds.truss.answers.jumps import rounding_m
from statejump.kinds.truss.answers.outputs import Output
from statejump.kinds.truss.solve import TrussPath, heat_of_joints_J

# Fraction of the largest jump below which a jump of a cycle has settled: events are located to 1e-9 of a branch.
SETTLED = 1e-6
STEADY = 0.01  # relative difference below which the jumps of two cycles count as equal
RESOLVED = 0.01  # largest uncertainty of a growth that counts as zero, as a fraction of the largest jump
DOUBLINGS = 3  # number of doublings of the increments while two paths disagree

# Path of so many increments a branch.
Solve = Callable[[int], TrussPath]


@dataclass(frozen=True)
class Verdict:
    """Whether jumps settle over the cycles."""

    word: str  # "no jump", "one cycle", "shakedown", "ratcheting", "not settled", "not resolved"
    text: str
    cycle_jump: np.ndarray  # (cycles,) motion of the output over each cycle, in its unit
    uncertainty: np.ndarray  # (cycles,) difference of this motion between the two paths
    increments: int  # per branch, of the finer path
    dissipation_J: np.ndarray  # (cycles,)


def judged(found: TrussPath, increments: int, solve: Solve, output: Output) -> tuple[Verdict, TrussPath]:
    """Return the verdict on whether an output settles over the cycles, and the path with twice the increments.

    :param found: path with the given number of increments per branch
    :param solve: returns a path with more increments; called again only if two paths disagree
    """
    first = finer = solve(2 * increments)
    coarse = found
    for doubling in range(DOUBLINGS + 1):
        checked = verdict(coarse, finer, increments * 2 ** (doubling + 1), output)
        if checked.word != "not resolved" or doubling == DOUBLINGS:
            break
        coarse, finer = finer, solve(increments * 2 ** (doubling + 2))
    return checked, first


def verdict(coarse: TrussPath, finer: TrussPath, increments: int, output: Output) -> Verdict:
    """Return the verdict from two paths. The finer path has ``increments`` per branch, the coarse path half of them."""
    motion = output.over_cycles(finer)
    each = output.sizes(motion)
    left = output.sizes(motion - output.over_cycles(coarse))
    heat = np.diff(heat_of_joints_J(finer.cycle_ends).sum(axis=1))
    floor = output.rounding(finer)
    last, most = float(each[-1]), float(each.max())

    def shown(value: float) -> str:
        return plain(value, output.unit, 4)

    def made(word: str, text: str) -> Verdict:
        return Verdict(word, text, each, left, increments, heat)

    if most <= floor:
        return made("no jump", f"{output.short} does not jump: it returns after every cycle")
    if np.all(each <= left):
        return made("no jump", f"{output.short} returns after every cycle, to what {increments} increments a branch "
                    f"resolve ({shown(float(left.max()))})")
    if len(each) == 1:
        return made("one cycle", "one cycle: whether the jump settles needs more, see --cycles")
    least = max(SETTLED * most, floor)
    numerical = last <= left[-1] <= RESOLVED * most
    if last <= least or numerical:
        least = max(least, float(left[-1]) if numerical else 0.0)
        settled = int(np.flatnonzero(each > min(least, 0.5 * most))[-1]) + 1
        slips = heat[-1] > SETTLED * heat.max() if heat.max() > 0 else False
        return made("shakedown", f"the jump settles after cycle {settled}; " + (
            f"joints still slip there and back, {plain(heat[-1], 'J', 4)} per cycle" if slips
            else "then no joint slips"))
    if last <= 2 * left[-1]:
        return made("not resolved", f"cycle {len(each)} adds {shown(last)} with {increments} increments a branch, and "
                    f"with half of them a motion that differs by {shown(float(left[-1]))}: whether the jump settles is "
                    "not known, more reduced.increments_per_branch are needed")
    if len(each) > 2 and abs(last - each[-2]) <= STEADY * last:
        return made("ratcheting", f"the jump grows by {shown(last)} per cycle (cycle {len(each)}; first "
                    f"cycle {shown(float(each[0]))})")
    return made("not settled", f"the jump of cycle {len(each)} is {100 * last / each[0]:.3g} % of the first cycle's: "
                "neither settled nor steady, more cycles are needed")


def others(coarse: TrussPath, finer: TrussPath, checked: Verdict, output: Output) -> list[str]:
    """Return a note if other nodes continue to move from cycle to cycle although the output does not."""
    if checked.word not in ("no jump", "shakedown") or len(checked.cycle_jump) < 2:
        return []
    moved, before = (np.diff(path.cycle_ends["displacement_m"], axis=0) for path in (finer, coarse))
    each, left = np.linalg.norm(moved, axis=2), np.linalg.norm(moved - before, axis=2)[-1]
    least = max(SETTLED * float(each.max()), rounding_m(finer))
    going = np.where(each[-1] > np.maximum(least, 2 * left), each[-1], 0.0)
    if not going.any():
        return []
    node = int(np.argmax(going))
    moved_m = float(going[node])
    return [Note("others_move", output=output.short, node=finer.truss.nodes.names[node], moved=plain(moved_m, "m", 4),
                 moved_m=moved_m, cycle=len(each))]
