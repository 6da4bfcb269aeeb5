# SPDX-License-Identifier: GPL-3.0-or-later
"""Temperature programs of the links of a truss. A link with an [[expansion]] gets the program of its strain, ε/α₀."""
from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from statejump.core.errors import NotAllowed
from statejump.core.expansion import followed
from statejump.kinds.truss.arrays import column, values
from statejump.schema.item_tables import ItemColumns

if TYPE_CHECKING:
    from statejump.core.thermal import MemberProgram
    from statejump.kinds.truss.sections import TrussSections, TrussThermal


@dataclass(frozen=True)
class LinkTemperatures:
    """Programs of a truss, and the index of the program of each link (m); see :mod:`statejump.core.expansion`."""

    programs: tuple[TrussThermal | MemberProgram, ...]
    program_names: tuple[str, ...]
    program: np.ndarray
    temperature_fraction: np.ndarray
    expanding: np.ndarray  # bool: it has an [[expansion]]
    largest_per_K: np.ndarray  # of the [[expansion]], else 0
    shown_program: np.ndarray  # program of the temperature itself
    shown_fraction: np.ndarray


def link_temperatures(case: TrussSections, shown: np.ndarray, names: tuple[str, ...]) -> LinkTemperatures:
    """Return the programs of the links. ``checks`` has checked the references when the case was read.

    :param shown: the program of the temperature of every link
    :param names: of the programs of the case
    :raises NotAllowed: a program leaves the table of an expansion, or is not piecewise linear
    """
    programs, named = case.programs, list(names)
    expansions = {expansion.name: expansion for expansion in case.expansion}
    fraction = column(case.link, "temperature_fraction")
    if isinstance(case.link, ItemColumns) and not case.link.texts("expansion").given().any():
        none = np.broadcast_to(0.0, len(case.link))
        return LinkTemperatures(tuple(programs), names, shown, fraction, none != 0, none, shown, fraction)
    program, own_fraction, largest = shown.copy(), fraction.copy(), np.zeros(len(case.link))
    made: dict[tuple[int, float, str], int] = {}
    for index, named_expansion in enumerate(values(case.link, "expansion")):
        if named_expansion is None:
            continue
        expansion, number = expansions[named_expansion], int(shown[index])
        key = number, float(fraction[index]), named_expansion
        if key not in made:
            followed_program = programs[number]
            try:
                strain = followed(expansion, followed_program, followed_program.period_s, key[1])
            except NotAllowed as refused:
                refused.item = f"expansion {expansion.name!r}, link {case.link[index].name!r}"
                raise
            made[key] = len(programs)
            programs.append(strain)
            named.append(f"{expansion.name} of {names[number]}")
        program[index], own_fraction[index], largest[index] = made[key], 1.0, expansion.largest_per_K
    return LinkTemperatures(tuple(programs), tuple(named), program, own_fraction, program != shown, largest, shown,
                            fraction)
