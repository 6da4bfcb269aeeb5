# SPDX-License-Identifier: GPL-3.0-or-later
"""Joints that ``--joint`` inserts into a truss of a deck by name, in one of three forms:

- ``node`` and ``axis`` = x, y or z: the node slides on its support along that axis
- ``link`` and ``axis`` = link: a slider along the link, between its first node, or ``node``, and its end;
  ``clearance_plus_m`` is its play in tension
- ``link`` and ``node``: a revolute between the end of the link, the journal, and the others at the node

``node`` and ``link`` of sliders may be patterns (``L1*``). ``from`` names a file with the section of such a joint, as
``statejump identify`` writes it. Keys of ``--joint`` override the keys of the file.
"""
from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from fnmatch import fnmatchcase
from pathlib import Path
from typing import Any

import numpy as np

from statejump.core.errors import MissingKey, NotAllowed, StatejumpError, UnknownKey
from statejump.kinds.truss.generate.document import Document
from statejump.schema.rules import suggestion
from statejump.schema.toml import read_toml

SLIDER = ("axis", "friction_coefficient", "normal_force_N", "clearance_minus_m", "clearance_plus_m",
          "stop_stiffness_N_per_m", "play_m", "pad_radius_m")
REVOLUTE = ("link", "bearing_link", "axis", "journal_radius_m", "radial_clearance_m", "friction_coefficient",
            "journal_thermal_expansion_per_K", "bearing_thermal_expansion_per_K", "contact")
AXES = {"x": [1.0, 0.0, 0.0], "y": [0.0, 1.0, 0.0], "z": [0.0, 0.0, 1.0]}
LINK, FROM = "link", "from"


def put_in(made: Document, joints: Sequence[Mapping[str, str]], dimension: int) -> list[str]:
    """Insert joints into the document of a case. Return one sentence for each choice that the import made.

    :raises StatejumpError: a node, link, key or file does not exist
    """
    chosen: list[str] = []
    for number, given in enumerate(joints, start=1):
        try:
            chosen += _put_in(made, given, dimension)
        except StatejumpError as refused:
            if refused.file is None:
                refused.item = f"--joint {number}"
            raise
    return chosen


def _put_in(made: Document, given: Mapping[str, str], dimension: int) -> list[str]:
    in_link = given.get("axis") == LINK
    revolute = LINK in given and not in_link
    section, known = ("revolute", REVOLUTE) if revolute else ("slider", SLIDER)
    places = ("node", LINK, FROM) if revolute or in_link else ("node", FROM)
    for key in given:
        if key not in known and key not in places:
            raise UnknownKey(key, **suggestion(key, (*places, *known)))
    values: dict[str, Any] = {} if FROM not in given else _section(Path(given[FROM]), section, known)
    for key, text in given.items():
        if key == "axis":
            if not in_link:
                values[key] = _axis(text, dimension, revolute)
        elif key in ("bearing_link", "contact"):
            values[key] = text
        elif key not in places:
            try:
                values[key] = float(text)
            except ValueError:
                raise NotAllowed(key, text, code="not_number") from None
    nodes, links = ({item["name"]: item for item in made[part]} for part in ("node", "link"))
    if in_link:
        if LINK not in given:
            raise MissingKey(LINK, code="slider_link_missing")
        for name in matching(LINK, given[LINK], links):
            _slider_in_link(made, links[name], nodes, given.get("node"), values)
    elif revolute:
        node = nodes[_one("node", given.get("node", ""), nodes)]
        return _revolute(made, node, {LINK: given[LINK], **values}, dimension)
    else:
        for name in matching("node", given.get("node", ""), nodes):
            _slider(made, nodes[name], values, dimension)
    return []


def _section(path: Path, section: str, known: Sequence[str]) -> dict[str, Any]:
    """Return the keys of the joint in a file."""
    _, data = read_toml(path, "joint")
    found = data.get(section)
    if not (isinstance(found, list) and len(found) == 1 and isinstance(found[0], Mapping)):
        raise StatejumpError(code="no_section", file=path, wanted=section)
    for key in found[0]:
        if key not in known:
            raise UnknownKey(key, file=path, **suggestion(key, known))
    return dict(found[0])


def _axis(text: str, dimension: int, revolute: bool) -> list[float]:
    allowed = "xyz" if revolute else "xyz"[:dimension]
    if text not in AXES or text not in allowed:
        raise NotAllowed("axis", text, code="unknown_name", known=", ".join(allowed) + ("" if revolute else " or link"))
    return AXES[text][:dimension]


def _one(key: str, name: str, known: Iterable[str]) -> str:
    if name not in known:
        raise UnknownKey(key, value=name, **suggestion(name, list(known)[:50]))
    return name


def matching(key: str, pattern: str, known: Iterable[str]) -> list[str]:
    """Return the names that match a pattern. A text that matches no name must itself be a name."""
    found = [name for name in known if fnmatchcase(name, pattern)]
    return found or [_one(key, pattern, known)]


def _slider(made: Document, node: dict[str, Any], values: dict[str, Any], dimension: int) -> None:
    if "axis" not in values:
        raise MissingKey("axis", code="slider_axis_missing", directions=", ".join("xyz"[:dimension]))
    place = values["axis"].index(1.0)
    # The slider replaces the support along the axis; the supports across it remain.
    node["fixed"] = [axis for axis in node.get("fixed", ()) if axis != "xyz"[place]]
    made["slider"].append({"name": f"S_{node['name']}", "nodes": [node["name"]], **values})


def _slider_in_link(made: Document, link: dict[str, Any], nodes: Mapping[str, Any], at: str | None,
                    values: dict[str, Any]) -> None:
    """Separate one end of a link from its node, and connect this end and the node by a slider along the link."""
    ends = link["nodes"]
    name = ends[0] if at is None else _one("node", at, ends)
    other = ends[1] if name == ends[0] else ends[0]
    way = np.subtract(nodes[other]["position_m"], nodes[name]["position_m"])
    own = {"name": f"{name}_{link['name']}", "position_m": list(nodes[name]["position_m"])}
    made["node"].append(own)
    link["nodes"] = [own["name"] if end == name else end for end in ends]
    # The axis points into the link, the direction of the slide under tension.
    made["slider"].append({"name": f"S_{link['name']}", "nodes": [own["name"], name],
                           "axis": [round(float(part), 12) for part in way / np.linalg.norm(way)], **values})


def _revolute(made: Document, node: dict[str, Any], values: dict[str, Any], dimension: int) -> list[str]:
    here = [link for link in made.get("link", ()) if node["name"] in link["nodes"]]
    names = {link["name"]: link for link in here}
    moved = names[_one(LINK, values.pop(LINK), names)]
    journal = {"name": f"{node['name']}_{moved['name']}", "position_m": list(node["position_m"])}
    others = [link["name"] for link in here if link is not moved]
    wanted = values.pop("bearing_link", None)
    bearing = wanted or (others[0] if others and not node.get("fixed") else None)
    moved["nodes"] = [journal["name"] if end == node["name"] else end for end in moved["nodes"]]
    made["node"].append(journal)
    axis = values.pop("axis", None)
    name = f"R_{journal['name']}"
    made["revolute"].append({
        "name": name, "bearing_node": node["name"], "journal_node": journal["name"],
        **({"bearing_link": bearing} if bearing else {}), "journal_link": moved["name"],
        **({"axis": axis} if dimension == 3 and axis else {}), **values,
    })
    return [] if wanted else [_bearing(name, bearing, others)]


def _bearing(name: str, bearing: str | None, others: Sequence[str]) -> str:
    """Return a note on which link carries the bearing of a revolute, and which other links could carry it."""
    if bearing is None:
        return f"revolute {name!r}: no bearing_link, the bearing does not turn" + (
            f"; {', '.join(map(repr, others))} could carry it" if others else "")
    more = [other for other in others if other != bearing]
    return f"revolute {name!r}: bearing_link = {bearing!r}" + (
        f"; {', '.join(map(repr, more))} could be it as well, bearing_link=NAME in --joint chooses" if more else "")
