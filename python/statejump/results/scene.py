# SPDX-License-Identifier: GPL-3.0-or-later
"""Description of a drawing for any kind of case: parts and forces, moved by the columns of a run.

A description is plain JSON data, the same for both models. A *value* is a number or a reference::

    {"data": "history/displacement_m"}                      one value per sample
    {"data": "links/axial_force_N", "item": "bar"}          of the column's item with that name
    {"data": "history/temperature_change_K", "scale": 2e-5, "offset": 0.0}    offset + scale * value

A *point* or *vector* is a list [x, y, z] of values, or one reference to data with three components. All numbers are SI
units, angles anticlockwise from x. docs/reference/result_file.md has the types of parts.
"""
from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from statejump.core.errors import StatejumpError
from statejump.core.run import CONTACT_STATES, Column, Run

Value = float | dict[str, Any]
Point = list[Value] | dict[str, Any]

# Okabe-Ito colours, different in lightness as well.
STATE_COLOURS = dict(zip(CONTACT_STATES, ("#999999", "#0072B2", "#E69F00", "#D55E00"), strict=True))

# Required keys of each type of part besides name and type; the documentation has optional ones.
PART_TYPES: dict[str, tuple[str, ...]] = {
    "link": ("ends", "width_m"),
    "spring": ("ends",),
    "journal": ("centre", "angle_rad", "radius_m"),
    "bearing": ("centre", "angle_rad", "radius_m"),
    "block": ("centre", "angle_rad", "half_width_m", "half_height_m"),
    "slot": ("centre", "angle_rad", "stop_minus_m", "stop_plus_m", "half_height_m"),
    "frame": ("points",),
    "mesh": ("centre", "angle_rad", "mesh"),
}
FORCE_KINDS = ("normal", "tangential", "axial", "external")
TEMPERATURE = {"data": "history/temperature_change_K"}


def ref(data: str, item: str = "", scale: float = 1.0, offset: float = 0.0) -> dict[str, Any]:
    """Return a reference; see the module's description."""
    found: dict[str, Any] = {"data": data}
    if item:
        found["item"] = item
    if scale != 1:
        found["scale"] = scale
    if offset != 0:
        found["offset"] = offset
    return found


def link(name: str, ends: list[Point], section: Any) -> dict[str, Any]:
    """Return the part for a link whose columns are in the group ``links``.

    :param section: object with ``cross_section_area_m2``, ``stress_free_length_m``, ``young_modulus_Pa`` and
        ``thermal_expansion_per_K`` of the link
    """
    return {
        "name": name, "type": "link", "ends": ends, "width_m": section.cross_section_area_m2**0.5,
        "stress_free_length_m": section.stress_free_length_m, "young_modulus_Pa": section.young_modulus_Pa,
        "cross_section_area_m2": section.cross_section_area_m2,
        "thermal_expansion_per_K": section.thermal_expansion_per_K,
        "values": {key: ref(f"links/{key}", name) for key in ("axial_force_N", "thermal_strain")},
    }


def contact_forces(contact: str, on: str, other: str) -> list[dict[str, Any]]:
    """Return the normal and the tangential force of a contact, as references to its columns in ``contacts``."""
    return [
        {
            "name": f"{kind} force at {contact} on {on}", "kind": kind, "on": on, "from": other, "contact": contact,
            "at": ref("contacts/point_m", contact), "vector_N": ref(f"contacts/{kind}_force_N", contact),
            "state": ref("contacts/state", contact),
        }
        for kind in ("normal", "tangential")
    ]


def description(
    parts: list[dict[str, Any]], contacts: list[tuple[str, str, str]], smallest_clearance_m: float,
    forces: Sequence[dict[str, Any]] = (),
) -> dict[str, Any]:
    """Return the complete description of a scene.

    :param contacts: of each contact name, part on which its forces act, and other part
    :param smallest_clearance_m: smallest clearance [m], which a viewer may magnify; 0: none
    :param forces: forces besides those of links and contacts
    """
    return {
        "plane": "xy",
        "temperature_change_K": TEMPERATURE,
        "smallest_clearance_m": smallest_clearance_m,
        "states": STATE_COLOURS,
        "parts": parts,
        "contacts": [
            {"name": name, "on": on, "from": other, "state": ref("contacts/state", name),
             "gap_m": ref("contacts/gap_m", name)}
            for name, on, other in contacts
        ],
        "forces": [force for names in contacts for force in contact_forces(*names)] + list(forces),
    }


def _item(column: Column, value: dict[str, Any], names: Mapping[str, list[str]]) -> np.ndarray:
    values = column.values
    if "item" not in value:
        return values
    if not column.items:
        raise KeyError(f"{value['data']} has no items")
    return values[:, names[column.items].index(value["item"])]


def resolve(value: Value, run: Run, names: Mapping[str, list[str]]) -> np.ndarray:
    """Return the values of a number or a reference over the samples: (samples) or (samples, 3).

    :raises StatejumpError: the run has no such column or item
    """
    samples = len(run.time_s)
    if not isinstance(value, dict):
        return np.full(samples, float(value))
    try:
        found = _item(run.column(value["data"]), value, names)
    except (KeyError, ValueError) as error:
        raise StatejumpError(code="scene_reference", reference=value, why=error) from None
    return value.get("offset", 0.0) + value.get("scale", 1.0) * found


def resolve_point(point: Point, run: Run, names: Mapping[str, list[str]]) -> np.ndarray:
    """Return a point or vector over the samples (samples, 3)."""
    if isinstance(point, dict):
        return resolve(point, run, names)
    return np.stack([resolve(value, run, names) for value in point], axis=1)
