# SPDX-License-Identifier: GPL-3.0-or-later
"""Temperature patterns: a temperature of each node per unit of the pattern."""
from __future__ import annotations

import re
from pathlib import Path

import attrs
import numpy as np

from statejump.bodies.condense.deck import BodyDeck
from statejump.core.errors import NotAllowed, Unreadable
from statejump.core.table_files import check_table, read_known

AXES = {"x": 0, "y": 1, "z": 2}
STEP = re.compile(r"step:(\d+)$")


@attrs.frozen
class Pattern:
    """A pattern.

    :param nodes: temperature of each node per unit of the pattern
    :param gradient: temperature gradient through the thickness of shells, in 1 / (unit of length of the deck)
    """

    name: str
    nodes: dict[int, float]
    gradient: float = 0.0


def pattern(deck: BodyDeck, text: str, length_m: float) -> Pattern:
    """Return the pattern of ``NAME`` or ``NAME=WHAT``.

    WHAT is ``uniform`` (1 K per kelvin); ``x``, ``y`` or ``z`` (the coordinate in metres: 1 K/m per unit);
    ``thickness`` (1 K/m through shells, per unit); ``set:NSET`` (1 K at the nodes of a set); ``step:N`` (temperatures
    of a step of the deck, minus its initial temperature); a CSV table with the columns name and temperature_K.

    :raises StatejumpError: WHAT is unknown, or a node has no temperature
    """
    name, _, what = text.partition("=")
    name, what = name.strip(), (what or name).strip()
    if what == "uniform":
        return Pattern(name, dict.fromkeys(deck.positions, 1.0))
    if what in AXES:
        return Pattern(name, {node: float(place[AXES[what]]) * length_m for node, place in deck.positions.items()})
    if what == "thickness":
        if not deck.shells:
            raise NotAllowed("pattern", text, code="condense_no_shells")
        return Pattern(name, dict.fromkeys(deck.positions, 0.0), length_m)
    if what.startswith("set:"):
        hot = set(deck.nodes_of(what[4:]))
        return Pattern(name, {node: float(node in hot) for node in deck.positions})
    if found := STEP.match(what):
        number = int(found[1])
        if not 1 <= number <= len(deck.temperatures) or not deck.temperatures[number - 1]:
            raise NotAllowed("pattern", text, code="condense_no_step", steps=len(deck.temperatures))
        return Pattern(name, _complete(deck, text, deck.temperatures[number - 1], deck.reference or 0.0))
    if what.lower().endswith((".csv", ".txt", ".tsv")):
        return Pattern(name, _complete(deck, text, _table(Path(what)), 0.0))
    raise NotAllowed("pattern", text, code="condense_pattern")


def _table(path: Path) -> dict[int, float]:
    check_table(path, "pattern", "file_not_found")
    columns = read_known(path, ("name", "temperature_K"))
    missing = next((name for name in ("name", "temperature_K") if name not in columns), None)
    if missing is not None:
        raise Unreadable(code="missing_column", file=path, column=missing, needed="name, temperature_K")
    return {int(node): float(value) for node, value in zip(columns["name"], columns["temperature_K"])}


def _complete(deck: BodyDeck, text: str, given: dict[int, float], reference: float) -> dict[int, float]:
    used = {node for _, nodes in deck.elements for node in nodes}
    missing = used - set(given)
    if missing:
        raise NotAllowed("pattern", text, code="condense_node_cold", node=min(missing), count=len(missing))
    return {node: value - reference for node, value in given.items() if node in deck.positions}


def of_names(patterns: tuple[Pattern, ...]) -> tuple[str, ...]:
    """Return the names of patterns, which must differ."""
    names = tuple(one.name for one in patterns)
    double = next((name for place, name in enumerate(names) if name in names[:place]), None)
    if double is not None:
        raise NotAllowed("pattern", double, code="condense_pattern_twice")
    return names


def field(one: Pattern, nodes: list[int]) -> np.ndarray:
    """Return the temperatures of nodes."""
    return np.array([one.nodes[node] for node in nodes])
