# SPDX-License-Identifier: GPL-3.0-or-later
"""Temperature histories that bring a truss with clearance revolutes close to its bound, as cases that are simulated.

Temperatures turn where the linear truss without friction has moved each contact so far that, as they return to zero, it
slips in the direction that gives it the friction of the bound. The simulated case decides how much of the bound it
reaches.
"""
from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.optimize import linprog

from statejump.core.errors import StatejumpError
from statejump.kinds.truss.bounds.clearance import Clearances
from statejump.kinds.truss.bounds.contact_states import RestState, balance, rest_state
from statejump.kinds.truss.bounds.history import MOST_K, Attained, as_case, simulated_history
from statejump.kinds.truss.bounds.outputs import Output
from statejump.kinds.truss.bounds.ranges import Temperatures
from statejump.kinds.truss.case import TrussCase

LEAST = (1e-6, 2e-2, 0.2)  # contributions of joints, over the largest one, that histories do not neglect
FACTORS = (1.0, 3.0, 10.0)  # on the temperatures
NEARLY = 1e-3  # of the bound that a history may miss
ROLLED = 4.0  # turns of a contact by its friction angle in which it begins to slip
SURE = 0.5  # fraction of its limit above which friction has a direction


def attained_clearance(case: TrussCase, of: Clearances, output: Output, states: Sequence[RestState],
                       parts: np.ndarray, spread: float) -> Attained | None:
    """Return the simulated history that comes closest to the bound of an output; None: none was found.

    :param states: rest states with the largest and the smallest value
    :param parts: contribution of each joint
    """
    members = Temperatures.of_box(of, (-1.0, 1.0))
    slips = slips_by_temperature(of, members.of_elements)
    if slips is None or not members.of_elements.size:
        return None
    best: Attained | None = None
    for least in LEAST:
        turns = [_turn(of, slips, state, parts > least * parts.max()) for state in states]
        if turns[0] is None or turns[1] is None:
            continue
        rest = np.zeros(slips.shape[1])
        for factor in FACTORS:
            legs = np.array([rest, factor * turns[0], rest, factor * turns[1], rest])
            if np.abs(legs).max() > MOST_K:
                break
            try:
                found = simulated_history(as_case(case, of, members, legs, output), output, float(np.abs(legs).max()))
            except StatejumpError:  # temperatures beyond the range of a case, or a truss that snaps on the way
                continue
            if best is None or found.spread > best.spread:
                best = found
            if best.spread >= (1 - NEARLY) * spread:
                return best
    return best


def slips_by_temperature(of: Clearances, of_elements: np.ndarray) -> np.ndarray | None:
    """Return the slips of all joints by T (m + k, variables) without friction; None: no such state is found."""
    count, others = of.count, len(of.limit_N)
    free = rest_state(of, np.zeros(count), np.zeros(others))
    if free is None:
        return None
    moved, force = of.respond(of.heating_N_per_K @ of_elements)
    _, slope = balance(of, free.angle_rad, free.normal_N, np.zeros(count), np.zeros(others))
    turned = np.linalg.solve(slope, -force)
    n = np.stack((np.cos(free.angle_rad), np.sin(free.angle_rad)), axis=1)
    t = np.stack((-n[:, 1], n[:, 0]), axis=1)
    depth = of.depth_m(free.normal_N)
    across = (of.clearance_m + depth)[:, None] * turned[:count]
    along = (2 / 3 * depth / free.normal_N)[:, None] * turned[count:]
    shifts = (t[:, :, None] * across[:, None] + n[:, :, None] * along[:, None]).reshape(2 * count, -1)
    moved = moved + of.by_state[:, :2 * count] @ shifts
    return np.vstack((of.moments @ moved + across, of.slides @ moved))


def _turn(of: Clearances, slips: np.ndarray, state: RestState, matters: np.ndarray) -> np.ndarray | None:
    """Return the smallest temperatures from which joints slip in the directions of a rest state; None: none exist."""
    count = of.count
    friction = state.state[2 * count:]
    most = np.concatenate((np.tan(of.friction_angle_rad) * state.normal_N, of.limit_N))
    share = np.divide(friction, most, out=np.zeros_like(most), where=most > 0)
    # Friction f on the journal acts along +slip, λ of other joints against it.
    way = np.concatenate((np.sign(share[:count]), -np.sign(share[count:])))
    radius = np.linalg.norm(state.state[:2 * count].reshape(-1, 2), axis=1)
    travel = np.concatenate((ROLLED * radius * of.friction_angle_rad, _reach(of)))
    which = np.flatnonzero(matters & (np.abs(share) > SURE) & (travel > 0))
    if not len(which):
        return None
    variables = slips.shape[1]
    drive = np.column_stack((-way[which, None] * slips[which] / travel[which, None], np.zeros(len(which))))
    size = np.block([[np.eye(variables), -np.ones((variables, 1))], [-np.eye(variables), -np.ones((variables, 1))]])
    found = linprog(np.append(np.zeros(variables), 1.0), A_ub=np.concatenate((drive, size)),
                    b_ub=np.append(-np.ones(len(which)), np.zeros(2 * variables)),
                    bounds=[(None, None)] * (variables + 1), method="highs")
    return np.asarray(found.x[:variables]) if found.status == 0 else None


def _reach(of: Clearances) -> np.ndarray:
    """Return slides (k,) in which other joints begin to slip: twice those by their own friction limits."""
    own = np.abs((of.slides @ of.by_state[:, 3 * of.count:]).diagonal() if len(of.limit_N) else np.zeros(0))
    return np.asarray(4 * own * of.limit_N)
