# SPDX-License-Identifier: GPL-3.0-or-later
"""A deck as a case document: units, dimension, temperatures, joints that are put in by name."""
from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from statejump.core.errors import MissingKey, StatejumpError
from statejump.kinds.truss.generate.document import Document, finished
from statejump.kinds.truss.importing.joints import matching, put_in
from statejump.kinds.truss.importing.model import Bar, Deck

# A coordinate that differs by less, over the size of the truss, is the same: decks have eight digits.
FLAT = 1e-9
# What gives all links a number that the deck does not say.
OPTIONS = {"young_modulus_Pa": "--young-modulus", "cross_section_area_m2": "--area",
           "thermal_expansion_per_K": "--thermal-expansion"}


def case_document(
    deck: Deck, name: str, *, length_unit_m: float = 1.0, force_unit_N: float = 1.0,
    temperature_change_K: float | None = None, density_kg_per_m3: float | None = None,
    joints: Sequence[Mapping[str, str]] = (), sections: Mapping[str, Mapping[str, Any]] | None = None,
    reflector: tuple[Sequence[str], Sequence[float]] | None = None, links: Mapping[str, float] | None = None,
    fixed: Sequence[tuple[str, str]] = (),
) -> Document:
    """Return the case of a deck; what becomes of it is noted in the deck's account.

    :param length_unit_m: length of one unit of the deck [m]
    :param force_unit_N: force of one unit of the deck [N]; stress is force by length squared
    :param temperature_change_K: of all links, of a deck without temperatures
    :param density_kg_per_m3: of links whose density the deck does not say
    :param joints: what ``--joint`` says, see :mod:`~statejump.kinds.truss.importing.joints`
    :param sections: sections that the deck does not have; ``thermal`` stands for its temperatures
    :param reflector: nodes of a reflecting surface, names or patterns, and its axis
    :param links: keys of links whose number the deck does not say
    :param fixed: names or patterns of nodes, and the directions in which they are held too
    :raises StatejumpError: a link lacks a number, there is no such node
    """
    used = {end for bar in deck.bars for end in bar.nodes}
    for node in [node for node in deck.nodes if node not in used]:
        deck.leave(f"node {node}" if len(deck.nodes) < 50 else "node", "no link ends there", 0)
    dimension = _dimension(deck, used)
    more = dict(sections or {})
    changes = [0.0] * len(deck.bars) if "thermal" in more else _changes(deck, temperature_change_K)
    peak = max(changes, key=abs)
    made: Document = {
        "case": {"name": name, "kind": "truss", "title": "", "source": f"imported from {deck.path.name}"},
        "truss": {"dimension": dimension},
        "node": [_node(deck, node, dimension, length_unit_m, force_unit_N) for node in deck.nodes if node in used],
        "link": [_link(deck, bar, change, peak, length_unit_m, force_unit_N, density_kg_per_m3, links or {})
                 for bar, change in zip(deck.bars, changes)],
        "slider": [], "revolute": [],
        "thermal": {"shape": "triangle", "temperature_change_max_K": float(peak)}, **more,
    }
    if "thermal" in more and (deck.temperature or any(bar.temperature_change is not None for bar in deck.bars)):
        deck.leave("temperatures", "those of the members' histories are taken", 0)
    _hold(made, fixed, dimension)
    put_in(made, joints, dimension)
    if reflector is not None:
        of_deck = [f"N{node}" if node.isdecimal() else node for node in deck.nodes if node in used]
        made["reflector"] = {"axis": [float(part) for part in reflector[1][:dimension]], "nodes": list(dict.fromkeys(
            name for pattern in reflector[0] for name in matching("--reflector", pattern.strip(), of_deck)))}
    return finished(made)


def _hold(made: Document, fixed: Sequence[tuple[str, str]], dimension: int) -> None:
    """Hold nodes by name in further directions."""
    nodes = {node["name"]: node for node in made["node"]}
    for pattern, directions in fixed:
        for name in matching("--fixed", pattern, list(nodes)):
            held = {*nodes[name].get("fixed", ()), *directions}
            nodes[name]["fixed"] = [axis for axis in "xyz"[:dimension] if axis in held]


def _dimension(deck: Deck, used: set[str]) -> int:
    heights = [deck.nodes[node][2] for node in used]
    size = max((abs(value) for node in used for value in deck.nodes[node]), default=0.0)
    if max(heights) - min(heights) > FLAT * size or any(force[2] for force in deck.force.values()):
        return 3
    deck.leave("z of nodes", "all nodes are in one plane: the truss is planar", 0)
    return 2


def _changes(deck: Deck, given: float | None) -> list[float]:
    """Return the temperature change of every bar: at the mean of its ends, from where it is free of stress."""
    found = []
    for bar in deck.bars:
        change = bar.temperature_change
        if change is None and deck.temperature:
            ends = [deck.temperature.get(end, deck.initial.get(end, 0.0)) for end in bar.nodes]
            start = [deck.initial.get(end, 0.0) for end in bar.nodes]
            free = sum(start) / 2 if bar.reference_temperature is None else bar.reference_temperature
            change = sum(ends) / 2 - free
        if change is None:
            change = given
        if change is None:
            raise MissingKey("--temperature-change", f"link {bar.name!r} has no temperature", file=deck.path)
        found.append(change)
    return found


def _in_units(value: float, unit: float) -> float:
    """Return a number of a deck in the units of cases, with the digits that a deck can have: 50 mm2 are 5e-05 m2."""
    return value if unit == 1 else float(f"{value * unit:.15g}")


def _node(deck: Deck, name: str, dimension: int, length: float, force: float) -> dict[str, Any]:
    made: dict[str, Any] = {"name": f"N{name}" if name.isdecimal() else name,
                            "position_m": [_in_units(value, length) for value in deck.nodes[name][:dimension]]}
    fixed = [axis for axis in "xyz"[:dimension] if axis in deck.fixed.get(name, ())]
    if fixed:
        made["fixed"] = fixed
    load = [_in_units(value, force) for value in deck.force.get(name, ())][:dimension]
    if any(load):
        made["force_N"] = load
    return made


def _link(deck: Deck, bar: Bar, change: float, peak: float, length: float, force: float,
          density: float | None, given: Mapping[str, float]) -> dict[str, Any]:
    stress = force / length**2
    numbers: dict[str, float] = {}
    for key, words, value, unit in (("young_modulus_Pa", "Young's modulus", bar.young_modulus, stress),
                                    ("cross_section_area_m2", "cross-section area", bar.area, length**2)):
        if value:
            numbers[key] = _in_units(value, unit)
        elif key in given:
            numbers[key] = given[key]
        else:
            raise StatejumpError(f"{bar.kind} {bar.name!r} has no {words}", file=deck.path,
                                 remedy=f"{OPTIONS[key]} gives all of them one")
    made: dict[str, Any] = {
        "name": f"L{bar.name}" if bar.name.isdecimal() else bar.name,
        "nodes": [f"N{end}" if end.isdecimal() else end for end in bar.nodes],
        **numbers,
        "thermal_expansion_per_K": (given.get("thermal_expansion_per_K", 0.0) if bar.expansion is None
                                    else bar.expansion),
    }
    if bar.expansion is None and "thermal_expansion_per_K" not in given:
        deck.leave(bar.kind, "no thermal expansion: 0 is taken", 0)
    if bar.density:
        # Mass is force by length, times seconds squared.
        made["density_kg_per_m3"] = _in_units(bar.density, force / length**4)
    elif density is not None:
        made["density_kg_per_m3"] = density
    else:
        deck.leave(bar.kind, "no density: the DEM and --dynamic need one, see --density", 0)
    if bar.poisson_ratio is not None:
        made["poisson_ratio"] = bar.poisson_ratio
    if peak and change != peak:
        made["temperature_fraction"] = change / peak
    return made
