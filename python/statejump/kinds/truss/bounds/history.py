# SPDX-License-Identifier: GPL-3.0-or-later
"""Temperature histories that reach the bound of an output, as cases; their simulation confirms the bound."""
from __future__ import annotations

import re
from collections.abc import Callable
from copy import deepcopy
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
from scipy.optimize import linprog

from statejump.core.errors import StatejumpError
from statejump.core.start import FRICTIONLESS
from statejump.kinds.loading import load_case
from statejump.kinds.truss.bounds.outputs import Output
from statejump.kinds.truss.bounds.ranges import Heated, Temperatures
from statejump.kinds.truss.bounds.sliding import Sliding
from statejump.kinds.truss.case import TrussCase
from statejump.kinds.truss.solve import solve

MOST_K = 1e4  # of a case file
LEAST = (1e-9, 1e-2, 0.2)  # contributions of joints, over the largest one, that histories do not neglect
NEARLY = 1e-4  # of the bound that a history may miss
BEYOND = 1.02  # factor on temperatures that need only be large enough
ONTO = 1e-9  # relative residual of temperatures that give all slides

# Temperatures (legs, members) at the corners of a history: members, slides by their ΔT, gains of the output.
Way = Callable[[Sliding, Temperatures, np.ndarray, np.ndarray], np.ndarray | None]


@dataclass(frozen=True)
class Attained:
    """A history that leads to the highest and then to the lowest rest state of an output.

    :param spread: difference of the two states, simulated, in the unit of the output
    :param largest_K: largest |ΔT| of a member
    """

    case: TrussCase
    spread: float
    largest_K: float


def attained(case: TrussCase, of: Sliding, output: Output, direction: np.ndarray) -> Attained | None:
    """Return the simulated history that comes closest to the bound of an output; None: no temperatures of single
    members up to MOST_K move the joints as needed.

    :param direction: in which a vector output is largest
    """
    gain = of.gains_of(output.along(direction).rows(of))[0][0]
    members = Temperatures.of_box(of, (-1.0, 1.0))
    heating = of.slides @ of.solve(of.heating_N_per_K @ members.of_elements)
    spread = 2 * float(np.abs(gain) @ of.limit_N)
    found: list[Attained] = []
    ways: list[Way] = [all_slides, *(partial(large_enough, least) for least in LEAST)]
    for way in ways:
        legs = way(of, members, heating, gain)
        if legs is None or np.abs(legs).max() > MOST_K:
            continue
        try:
            found.append(simulated_history(as_case(case, of, members, legs, output), output, float(np.abs(legs).max())))
        except StatejumpError:  # temperatures beyond the range of a case, or a truss that snaps on the way
            continue
        if found[-1].spread >= (1 - NEARLY) * spread:
            break
    return max(found, key=lambda one: one.spread) if found else None


def simulated_history(case: TrussCase, output: Output, largest_K: float) -> Attained:
    """Return a history with the difference of its states at the middle and at the end."""
    path = solve(case)
    at = [int(np.abs(path.states["time_s"] - time).argmin()) for time in (case.period_s / 2, case.period_s)]
    return Attained(case, output.change(*path.states["displacement_m"][at]), largest_K)


def all_slides(of: Sliding, members: Temperatures, heating: np.ndarray, gain: np.ndarray) -> np.ndarray | None:
    """Return temperatures (legs, members) at the corners of a history in which all joints slip once to the highest
    state and once to the lowest one; None: the members do not move the joints independently.

    A joint begins to slip at its old slip p plus d δ, d being the direction and δ the slide to full slip. It slides to
    s + (d − sign λ) δ, and returns to s with the friction λ at ΔT = 0.
    """
    inverse = np.linalg.pinv(heating, rcond=1e-12)
    limit, delta = of.limit_N, of.full_slip_m
    slip = of.slide_m if of.truss.start_friction == FRICTIONLESS else np.zeros(len(limit))
    legs = [np.zeros(heating.shape[1])]
    for sign in (1.0, -1.0):
        friction = -sign * np.where(gain == 0, 1.0, np.sign(gain)) * limit
        rests = of.slide_m - of.compliance @ friction - np.sign(friction) * delta
        way = np.where(rests >= slip, 1.0, -1.0)
        for slides in (slip + way * delta, rests + way * delta):
            change = slides - of.slide_m + of.compliance @ (way * limit)
            temperature = inverse @ change
            if np.linalg.norm(heating @ temperature - change) > ONTO * np.linalg.norm(change):
                return None
            legs.append(_exact(of, members, temperature, way * limit))
        legs.append(np.zeros(heating.shape[1]))
        slip = rests
    return np.array(legs)


def _exact(of: Sliding, members: Temperatures, temperature: np.ndarray, friction_N: np.ndarray) -> np.ndarray:
    """Return temperatures at which links have their linear forces at their exact lengths, N = E A (L/l_T − 1)."""
    links, which = of.truss.links, np.flatnonzero(members.of_elements.any(axis=1))
    ours = which < len(links.names)
    elements = members.of_elements @ temperature
    dofs = of.solve(of.heating_N_per_K @ elements - of.slides.T @ friction_N)
    moved = (of.of_nodes @ dofs)[:of.displacement_m.size].reshape(-1, 3)
    index = which[ours]
    place = of.truss.nodes.position_m + of.displacement_m
    first, second = links.nodes[index].T
    span, growth = place[second] - place[first], moved[second] - moved[first]
    length, free = np.linalg.norm(span, axis=1), links.stress_free_length_m[index]
    expansion = links.thermal_expansion_per_K[index]
    change = elements[index] * links.temperature_fraction[index]
    force = length / free - 1 + (span * growth).sum(axis=1) / (length * free) - expansion * change
    exact = (np.linalg.norm(span + growth, axis=1) / free / (1 + force) - 1) / expansion
    made = temperature.copy()
    made[ours] = exact
    return made


def large_enough(least: float, of: Sliding, members: Temperatures, heating: np.ndarray, gain: np.ndarray
                 ) -> np.ndarray | None:
    """Return temperatures so large that, as they return to zero, joints slip in the direction of the bound; None: the
    members do not move the joints in these directions.

    :param least: contribution to the bound, over the largest one, of joints that must slip
    """
    matters = np.flatnonzero(np.abs(gain) * of.limit_N > least * np.abs(gain * of.limit_N).max())
    sign = -np.sign(gain)
    friction = sign * of.limit_N
    travel = np.maximum(sign * (2 * of.compliance @ friction) + 4 * of.full_slip_m, 0.0)
    travel = np.maximum(travel, 1e-3 * travel.max())[matters]
    # min t: −sign (H T) >= travel, |T| <= t
    count = members.of_elements.shape[1]
    drive = np.column_stack((sign[matters, None] * heating[matters] / travel[:, None], np.zeros(len(matters))))
    most = np.block([[np.eye(count), -np.ones((count, 1))], [-np.eye(count), -np.ones((count, 1))]])
    found = linprog(np.append(np.zeros(count), 1.0), A_ub=np.concatenate((drive, most)),
                    b_ub=np.append(-np.ones(len(matters)), np.zeros(2 * count)), bounds=[(None, None)] * (count + 1),
                    method="highs")
    if found.status != 0:
        return None
    turn = BEYOND * found.x[:count]
    rest = np.zeros(count)
    return np.array([rest, turn, rest, -turn, rest])


def as_case(case: TrussCase, of: Heated, members: Temperatures, legs: np.ndarray, output: Output) -> TrussCase:
    """Return the case with the temperature of each member as a table."""
    data: dict[str, Any] = deepcopy(dict(case.origin.document))
    which = np.flatnonzero(members.of_elements.any(axis=1))
    programs = legs @ members.of_elements[which].T  # (legs, expanding elements), in units of the programs
    middle = (len(legs) - 1) // 2
    time = np.interp(np.arange(len(legs)), (0, middle, len(legs) - 1), (0.0, 0.5, 1.0)).tolist()
    name = re.sub(r"[^A-Za-z0-9_-]", "_", f"{case.name}_attains_{output.name.removeprefix('node:')}")
    data["case"] = {**data["case"], "name": name, "title": f"History that attains the bound of {output.name}"}
    data["thermal"] = {"shape": "table", "table_time_s": time, "table_temperature_change_K": programs[:, 0].tolist(),
                       "cycles": 1}
    if np.ptp(programs, axis=1).max() > 1e-9 * max(np.abs(programs).max(), 1e-300):
        count = of.heating_N_per_K.shape[1]
        links = len(of.truss.links.names)
        beams, bodies = len(data.get("beam", [])), len(data.get("body", []))
        place = {**{index: ("link", index) for index in range(links)},
                 **{count - bodies - beams + index: ("beam", index) for index in range(beams)},
                 **{count - bodies + index: ("body", index) for index in range(bodies)}}
        data["program"] = []
        for column, element in enumerate(which):
            section, index = place[element]
            label = f"of_{data[section][index]['name']}"
            if section == "body":
                patterns = of.truss.elements["body"].programs[index]
                data[section][index]["programs"] = [label] * len(patterns)
            else:
                data[section][index]["program"] = label
            data["program"].append({"name": label, "shape": "table", "table_time_s": time,
                                    "table_temperature_change_K": programs[:, column].tolist()})
    else:
        data.pop("program", None)
        for section in ("link", "beam", "body"):
            for item in data.get(section, []):
                item.pop("programs" if section == "body" else "program", None)
    made = load_case(data)
    assert isinstance(made, TrussCase)
    return made
