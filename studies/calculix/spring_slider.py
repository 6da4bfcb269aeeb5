# SPDX-License-Identifier: GPL-3.0-or-later
"""Computes a ``spring_slider`` case in CalculiX. A bar of one brick element pushes a block; the block is pressed on a
floor with frictional contact and may touch two stops with frictionless contact.

Contacts are rigid in the reduced model but stiff here: STICK times as stiff as the bar in tangential direction, PUSH
times in normal direction. Events are intersections of straight pieces of displacement over temperature, so they do not
depend on increments. The remaining error is the contact penetration, of relative size 1/PUSH.
"""
from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from statejump.core.comparison import Quantity
from statejump.core.errors import FailedRun, NotAllowed
from statejump.core.thermal import rows
from statejump.kinds.spring_slider import reduced
from statejump.kinds.spring_slider.case import SpringSliderCase
from studies.calculix import ccx
from studies.calculix.ccx import number

STICK, PUSH = 1e4, 1e3
INCREMENTS = 50  # of a branch of the program
MOST_BRANCHES = 40
TOLERANCE = 1e-3  # relative; the paper's models differ by 2.5 %, contacts of this stiffness by less than 1e-4
HOLDS = ("S1", "S3", "S4", "at_stop_plus", "at_stop_minus")
BAR, PAD, FLOOR, PLUS, MINUS = 1, 11, 21, 31, 41  # first node of each brick
TIP = 5


def answer(case: SpringSliderCase) -> ccx.Answer:
    """Run the case in CalculiX beside the reduced model.

    :raises NotAllowed: the deck does not support the case
    :raises StatejumpError: CalculiX is missing or failed
    """
    joint = case.joint
    if case.expansion is not None:
        raise NotAllowed("expansion", code="fe_one_coefficient")
    if joint.stop_stiffness_N_per_m is not None:
        raise NotAllowed("joint.stop_stiffness_N_per_m", joint.stop_stiffness_N_per_m, code="fe_rigid_stops")
    for key in ("preload_stiffness_N_per_m", "preload_force_N", "pad_thermal_expansion_per_K",
                "slot_thermal_expansion_per_K", "play_m"):
        if getattr(joint, key):
            raise NotAllowed(f"joint.{key}", getattr(joint, key), code="fe_zero_only")
    if not joint.friction_coefficient:
        raise NotAllowed("joint.friction_coefficient", 0.0, code="fe_needs_friction")
    corners = _corners(case)
    lines = deck(case, corners)
    found = ccx.displacements(lines, "TIP")
    if len(found) != 1 + INCREMENTS * (len(corners) - 1):
        raise FailedRun(code="calculix_increments")
    x = np.array([step[TIP][0] for step in found])
    branches = [(np.linspace(first, last, INCREMENTS + 1), x[place * INCREMENTS:(place + 1) * INCREMENTS + 1])
                for place, (first, last) in enumerate(zip(corners, corners[1:]))]
    ours = _events(case, corners)
    theirs = [kink for change, moved in branches for kink in kinks(change, moved, _slope(case))]
    return ccx.Answer("\n".join(lines) + "\n", tuple(_rows(case, ours, theirs, float(x[-1] - x[0]))),
                      ("contacts that are rigid in the reduced model give way here by "
                       f"1/{PUSH:g} (stops) and 1/{STICK:g} (friction) of what the bar does",))


def _slope(case: SpringSliderCase) -> float:
    return case.thermal_expansion_per_K * case.link.stress_free_length_m


def _corners(case: SpringSliderCase) -> list[float]:
    """Return the temperature changes at which the program reverses, from 0."""
    program, thermal = case.thermal_program(), case.thermal
    if thermal.shape == "table":
        cycle = rows(thermal, case.period_s)[1].tolist()
    else:
        peak = thermal.temperature_change_max_K or 0.0
        cycle = [0.0, peak, -peak, 0.0] if thermal.shape == "sine" else [0.0, peak, 0.0]
    corners = [0.0]
    for value in program.cycles * cycle[1:]:
        turns = len(corners) > 1 and (value - corners[-1]) * (corners[-1] - corners[-2]) <= 0
        if len(corners) > 1 and not turns:
            corners[-1] = value
        elif value != corners[-1]:
            corners.append(value)
    if len(corners) < 2:
        raise NotAllowed("thermal", code="fe_no_branch")
    if len(corners) > MOST_BRANCHES + 1:
        raise NotAllowed("thermal.cycles", thermal.cycles, code="fe_branches", most=MOST_BRANCHES)
    return corners


def _events(case: SpringSliderCase, corners: Sequence[float]) -> list[tuple[str, float]]:
    """Return in order the temperature changes at which the block begins to slide or stops; reversals are left out."""
    found = []
    for event in reduced.solve(case).events:
        before, after = event.stage_before in HOLDS, event.stage_after in HOLDS
        if before != after and not any(abs(event.temperature_change_K - corner) < 1e-9 for corner in corners):
            found.append(("rest" if after else "slide", event.temperature_change_K))
    return found


def kinks(change: np.ndarray, moved: np.ndarray, slope: float) -> list[tuple[str, float]]:
    """Return the temperature changes at which a piecewise linear path begins or ceases to slide.

    :param change: temperature changes, in order of time
    :param moved: displacement at each change
    :param slope: displacement per change while sliding
    """
    slides = np.abs(np.diff(moved) / np.diff(change)) > 0.5 * abs(slope)
    found = []
    place = 0
    for at in np.flatnonzero(slides[1:] != slides[:-1]):
        # The increment that contains the kink is on neither line, so the lines are those of the increments around it.
        first, second = max(at - 1, place), min(at + 2, len(slides) - 1)
        lines = [np.polyfit(change[one:one + 2], moved[one:one + 2], 1) for one in (first, second)]
        found.append(("slide" if slides[at + 1] else "rest",
                      float((lines[1][1] - lines[0][1]) / (lines[0][0] - lines[1][0]))))
        place = at + 1
    return found


def _rows(case: SpringSliderCase, ours: Sequence[tuple[str, float]], theirs: Sequence[tuple[str, float]],
          jump_m: float) -> Iterator[Quantity]:
    if [kind for kind, _ in ours] != [kind for kind, _ in theirs]:
        raise FailedRun(code="calculix_events", theirs=len(theirs), ours=len(ours))
    for place, ((kind, own), (_, other)) in enumerate(zip(ours, theirs), start=1):
        yield row(f"{kind}_{place}_temperature_change", "K", own, other, TOLERANCE)
    exact = reduced.solve(case).state_jump_m
    yield row("state_jump" if case.has_jump else "displacement_at_program_end", "m", exact, jump_m, TOLERANCE)


def row(name: str, unit: str, own: float, other: float, tolerance: float) -> Quantity:
    """Return a row with the difference relative to the reduced model."""
    difference = abs(other - own) / abs(own) if own else abs(other)
    return Quantity(name, unit, {"reduced": own, "fe": other}, difference, tolerance, bool(difference <= tolerance))


def deck(case: SpringSliderCase, corners: Sequence[float]) -> list[str]:
    """Return the deck of a case, heated from corner to corner."""
    link, joint = case.link, case.joint
    length, area = link.stress_free_length_m, link.cross_section_area_m2
    stiffness = link.young_modulus_Pa * area / length
    side = max(0.2 * length, 4 * (joint.clearance_minus_m + joint.clearance_plus_m))
    height, width = side / 2, area**0.5
    lines = ["*HEADING", f"statejump fe {case.name}", "*NODE, NSET=ALL"]
    blocks = (
        (BAR, (0, 0, 0), (length, width, width)),
        (PAD, (length - side / 2, -side / 2, 0), (length + side / 2, side / 2, height)),
        (FLOOR, (length - 1.5 * side, -side, -height), (length + 1.5 * side, side, 0)),
        (PLUS, (length + side / 2 + joint.clearance_plus_m, -side, -height / 2),
         (length + 1.5 * side, side, 1.5 * height)),
        (MINUS, (length - 1.5 * side, -side, -height / 2),
         (length - side / 2 - joint.clearance_minus_m, side, 1.5 * height)),
    )
    for first, low, high in blocks:
        lines += _nodes(first, low, high)
    for first, _, _ in blocks:
        lines += [f"*ELEMENT, TYPE=C3D8, ELSET=E{first}",
                  ", ".join(str(node) for node in (first, *range(first, first + 8)))]
    fixed = [node for first in (FLOOR, PLUS, MINUS) for node in range(first, first + 8)]
    lines += ["*NSET, NSET=TIP", str(TIP), "*NSET, NSET=BARN", "1, 2, 3, 4, 5, 6, 7, 8",
              "*NSET, NSET=ROOT", "1, 2, 3, 4",
              "*NSET, NSET=PADN", ", ".join(str(node) for node in range(PAD, PAD + 8)),
              "*NSET, NSET=TOP", ", ".join(str(node) for node in range(PAD + 4, PAD + 8)),
              "*NSET, NSET=FIXED", *(f"{node}," for node in fixed)]
    # The bar carries axial force only: Poisson's ratio 0 and held sides.
    lines += ["*MATERIAL, NAME=BAR", "*ELASTIC", f"{number(link.young_modulus_Pa)}, 0.", "*EXPANSION, ZERO=0.",
              number(case.thermal_expansion_per_K), "*MATERIAL, NAME=BLOCK", "*ELASTIC",
              f"{number(joint.young_modulus_Pa)}, {number(max(joint.poisson_ratio, 0.0))}"]
    lines += [f"*SOLID SECTION, ELSET=E{first}, MATERIAL={'BAR' if first == BAR else 'BLOCK'}"
              for first, _, _ in blocks]
    for node in (*range(TIP + 1, TIP + 4), *range(PAD, PAD + 8)):
        lines += ["*EQUATION", "2", f"{node}, 1, 1., {TIP}, 1, -1."]
    lines += ["*SURFACE, NAME=UNDER", f"{PAD}, S1", "*SURFACE, NAME=FLOOR", f"{FLOOR}, S2",
              "*SURFACE, NAME=AHEAD", f"{PAD}, S4", "*SURFACE, NAME=PLUS", f"{PLUS}, S6",
              "*SURFACE, NAME=BEHIND", f"{PAD}, S6", "*SURFACE, NAME=MINUS", f"{MINUS}, S4"]
    on_floor, on_stop = stiffness / side**2, stiffness / (side * height)
    lines += ["*SURFACE INTERACTION, NAME=RUBS", "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR",
              number(PUSH * on_floor), "*FRICTION", f"{number(joint.friction_coefficient)}, {number(STICK * on_floor)}",
              "*CONTACT PAIR, INTERACTION=RUBS, TYPE=SURFACE TO SURFACE", "UNDER, FLOOR",
              "*SURFACE INTERACTION, NAME=STOPS", "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR",
              number(PUSH * on_stop), "*CONTACT PAIR, INTERACTION=STOPS, TYPE=SURFACE TO SURFACE", "AHEAD, PLUS",
              "*CONTACT PAIR, INTERACTION=STOPS, TYPE=SURFACE TO SURFACE", "BEHIND, MINUS"]
    lines += ["*BOUNDARY", "ROOT, 1, 3", "BARN, 2, 3", "FIXED, 1, 3", "PADN, 2, 2",
              "*INITIAL CONDITIONS, TYPE=TEMPERATURE", "ALL, 0."]
    for place, change in enumerate([0.0, *corners[1:]]):
        lines += ["*STEP, INC=1000", "*STATIC, DIRECT", f"{number(1 / INCREMENTS if place else 1)}, 1.", "*CLOAD",
                  f"TOP, 3, {number(-joint.normal_force_N / 4)}", "*TEMPERATURE", f"BARN, {number(change)}",
                  "*NODE PRINT, NSET=TIP", "U", "*END STEP"]
    return lines


def _nodes(first: int, low: Sequence[float], high: Sequence[float]) -> list[str]:
    """Return the eight nodes of a brick. Nodes of the bar are ordered by its ends, nodes of other bricks from below."""
    x, y, z = zip(low, high)
    corners = ((0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1))
    if first == BAR:
        corners = ((0, 0, 0), (0, 1, 0), (0, 1, 1), (0, 0, 1), (1, 0, 0), (1, 1, 0), (1, 1, 1), (1, 0, 1))
    return [f"{first + place}, {number(x[i])}, {number(y[j])}, {number(z[k])}"
            for place, (i, j, k) in enumerate(corners)]
