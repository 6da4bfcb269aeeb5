# SPDX-License-Identifier: GPL-3.0-or-later
"""A deck as a case document: units, dimension, temperatures, joints that are put in by name."""
from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from statejump.core.errors import MissingKey, NotAllowed, StatejumpError, UnknownKey
from statejump.kinds.truss.generate.document import Document, finished
from statejump.kinds.truss.importing.model import Bar, Deck
from statejump.schema.rules import suggestion

# A coordinate that differs by less, over the size of the truss, is the same: decks have eight digits.
FLAT = 1e-9
SLIDER = ("axis", "friction_coefficient", "normal_force_N", "clearance_minus_m", "clearance_plus_m", "pad_radius_m")
REVOLUTE = ("link", "bearing_link", "axis", "journal_radius_m", "radial_clearance_m", "friction_coefficient",
            "journal_thermal_expansion_per_K", "bearing_thermal_expansion_per_K", "contact")
AXES = {"x": [1.0, 0.0, 0.0], "y": [0.0, 1.0, 0.0], "z": [0.0, 0.0, 1.0]}


def case_document(
    deck: Deck, name: str, *, length_unit_m: float = 1.0, force_unit_N: float = 1.0,
    temperature_change_K: float | None = None, density_kg_per_m3: float | None = None,
    joints: Sequence[Mapping[str, str]] = (),
) -> Document:
    """Return the case of a deck; what becomes of it is noted in the deck's account.

    :param length_unit_m: length of one unit of the deck [m]
    :param force_unit_N: force of one unit of the deck [N]; stress is force by length squared
    :param temperature_change_K: of all links, of a deck without temperatures
    :param density_kg_per_m3: of links whose density the deck does not say
    :param joints: what ``--joint`` says: ``node`` and the keys of a slider, or of a revolute with ``link``, whose end
        becomes the journal
    :raises StatejumpError: a link lacks a number, there is no such node
    """
    used = {end for bar in deck.bars for end in bar.nodes}
    for node in [node for node in deck.nodes if node not in used]:
        deck.leave(f"node {node}" if len(deck.nodes) < 50 else "node", "no link ends there", 0)
    dimension = _dimension(deck, used)
    changes = _changes(deck, temperature_change_K)
    peak = max(changes, key=abs)
    made: Document = {
        "case": {"name": name, "kind": "truss", "title": "", "source": f"imported from {deck.path.name}"},
        "truss": {"dimension": dimension},
        "node": [_node(deck, node, dimension, length_unit_m, force_unit_N) for node in deck.nodes if node in used],
        "link": [_link(deck, bar, change, peak, length_unit_m, force_unit_N, density_kg_per_m3)
                 for bar, change in zip(deck.bars, changes)],
        "slider": [], "revolute": [],
        "thermal": {"shape": "triangle", "temperature_change_max_K": float(peak)},
    }
    for number, joint in enumerate(joints, start=1):
        _joint(made, joint, number, dimension)
    return finished(made)


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


def _node(deck: Deck, name: str, dimension: int, length: float, force: float) -> dict[str, Any]:
    made: dict[str, Any] = {"name": f"N{name}" if name.isdecimal() else name,
                            "position_m": [value * length for value in deck.nodes[name][:dimension]]}
    fixed = [axis for axis in "xyz"[:dimension] if axis in deck.fixed.get(name, ())]
    if fixed:
        made["fixed"] = fixed
    load = [value * force for value in deck.force.get(name, ())][:dimension]
    if any(load):
        made["force_N"] = load
    return made


def _link(deck: Deck, bar: Bar, change: float, peak: float, length: float, force: float,
          density: float | None) -> dict[str, Any]:
    stress = force / length**2
    for key, value in (("Young's modulus", bar.young_modulus), ("cross-section area", bar.area)):
        if not value:
            raise StatejumpError(f"{bar.kind} {bar.name!r} has no {key}", file=deck.path)
    assert bar.young_modulus is not None and bar.area is not None
    made: dict[str, Any] = {
        "name": f"L{bar.name}" if bar.name.isdecimal() else bar.name,
        "nodes": [f"N{end}" if end.isdecimal() else end for end in bar.nodes],
        "young_modulus_Pa": bar.young_modulus * stress, "cross_section_area_m2": bar.area * length**2,
        "thermal_expansion_per_K": bar.expansion or 0.0,
    }
    if bar.expansion is None:
        deck.leave(bar.kind, "no thermal expansion: 0 is taken", 0)
    if bar.density:
        made["density_kg_per_m3"] = bar.density * force / length**4  # mass is force by length, times seconds squared
    elif density is not None:
        made["density_kg_per_m3"] = density
    else:
        deck.leave(bar.kind, "no density: the DEM and --dynamic need one, see --density", 0)
    if bar.poisson_ratio is not None:
        made["poisson_ratio"] = bar.poisson_ratio
    if peak and change != peak:
        made["temperature_fraction"] = change / peak
    return made


def _joint(made: Document, given: Mapping[str, str], number: int, dimension: int) -> None:
    """Put a slider on a node, or a revolute between the end of a link and the others at its node."""
    where: dict[str, Any] = {"item": f"--joint {number}"}
    nodes = {node["name"]: node for node in made["node"]}
    name = given.get("node", "")
    if name not in nodes:
        raise UnknownKey("node", value=name, **suggestion(name, list(nodes)[:50]), **where)
    known = REVOLUTE if "link" in given else SLIDER
    for key in given:
        if key != "node" and key not in known:
            raise UnknownKey(key, **suggestion(key, known), **where)
    values: dict[str, Any] = {}
    for key, text in given.items():
        if key == "axis":
            if text not in "xyz"[:dimension] and "link" not in given or text not in AXES:
                raise NotAllowed("axis", text, "must be " + ", ".join("xyz"[:dimension]), **where)
            values[key] = AXES[text][:dimension]
        elif key not in ("node", "link", "bearing_link", "contact"):
            try:
                values[key] = float(text)
            except ValueError:
                raise NotAllowed(key, text, "must be a number", **where) from None
        else:
            values[key] = text
    (_revolute if "link" in given else _slider)(made, nodes[values.pop("node")], values, where, dimension)


def _slider(made: Document, node: dict[str, Any], values: dict[str, Any], where: dict[str, Any],
            dimension: int) -> None:
    if "axis" not in values:
        raise MissingKey("axis", "along which it slides: " + ", ".join("xyz"[:dimension]), **where)
    place = values["axis"].index(1.0)
    # The support gives way along the axis; across it the node stays held.
    node["fixed"] = [axis for axis in node.get("fixed", ()) if axis != "xyz"[place]]
    made["slider"].append({"name": f"S_{node['name']}", "nodes": [node["name"]], **values})


def _revolute(made: Document, node: dict[str, Any], values: dict[str, Any], where: dict[str, Any],
              dimension: int) -> None:
    here = [link for link in made["link"] if node["name"] in link["nodes"]]
    moved = next((link for link in here if link["name"] == values["link"]), None)
    if moved is None:
        raise UnknownKey("link", value=values["link"], **suggestion(values["link"], [link["name"] for link in here]),
                         **where)
    journal = {"name": f"{node['name']}_{moved['name']}", "position_m": list(node["position_m"])}
    others = [link["name"] for link in here if link is not moved]
    bearing = values.pop("bearing_link", None) or (others[0] if others and not node.get("fixed") else None)
    moved["nodes"] = [journal["name"] if end == node["name"] else end for end in moved["nodes"]]
    made["node"].append(journal)
    del values["link"]
    axis = values.pop("axis", None)
    made["revolute"].append({
        "name": f"R_{journal['name']}", "bearing_node": node["name"], "journal_node": journal["name"],
        **({"bearing_link": bearing} if bearing else {}), "journal_link": moved["name"],
        **({"axis": axis} if dimension == 3 and axis else {}), **values,
    })
