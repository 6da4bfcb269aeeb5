# SPDX-License-Identifier: GPL-3.0-or-later
"""Changes of a case that do not change its jump, with the conversion of jumps back to the original case."""
from __future__ import annotations

from collections.abc import Callable
from copy import deepcopy
from dataclasses import dataclass
from math import cos, sin
from typing import Any

import numpy as np

from sketch import CLEARANCE, Document

Random = np.random.Generator
SECTIONS = ("node", "link", "beam", "spring", "torsion_spring", "slider", "iwan_joint", "latch_hinge", "pad",
            *CLEARANCE)
# Keys that hold names of other items.
NODES = ("nodes", "bearing_node", "journal_node", "socket_node", "ball_node")
LINKS = ("links", "bearing_link", "journal_link", "socket_link", "ball_link")
# Unit of every key as powers of length and force; keys without units do not change. Mass is force over length, because
# accelerations keep their numbers: the unit of time is then the root of the unit of length.
UNITS = {
    "position_m": (1, 0), "force_N": (0, 1), "young_modulus_Pa": (-2, 1), "cross_section_area_m2": (2, 0),
    "stress_free_length_m": (1, 0), "density_kg_per_m3": (-3, 1), "stiffness_N_per_m": (-1, 1), "preload_N": (0, 1),
    "free_length_m": (1, 0), "stiffness_N_m_per_rad": (1, 1), "normal_force_N": (0, 1), "clearance_minus_m": (1, 0),
    "clearance_plus_m": (1, 0), "tangent_stiffness_N_per_m": (-1, 1), "slip_force_N": (0, 1),
    "journal_radius_m": (1, 0), "ball_radius_m": (1, 0), "radial_clearance_m": (1, 0), "friction_moment_N_m": (1, 1),
    "friction_stiffness_N_m_per_rad": (1, 1), "preload_moment_N_m": (1, 1), "mass_kg": (0, 1),
    "dimensions_m": (1, 0), "gradient_per_m": (-1, 0), "normal_stiffness_N_per_m": (-1, 1), "clearance_m": (1, 0),
}
CONTACT_MODULUS_PA = 70e9  # default of joints with contacts
VECTORS = {"node": ("position_m", "force_N", "guide_normal"), "slider": ("axis",), "beam": ("axis_y",),
           "iwan_joint": ("axis",), "pad": ("normal",)}
AXIAL = ("revolute", "torsion_spring", "latch_hinge")  # axes about which something turns


@dataclass(frozen=True)
class Changed:
    """A changed case.

    :param back: converts jumps by node (cycles, dimension) of the changed case to those of the original case
    :param rounding_m: additional rounding of lengths in the changed case [m of the original case]
    :param exact: whether only rounding differs; otherwise the increments differ too
    """

    document: Document
    back: Callable[[dict[str, np.ndarray]], dict[str, np.ndarray]] = lambda moved: moved
    rounding_m: float = 0.0
    exact: bool = True


def permuted(document: Document, rng: Random) -> Changed:
    """Permute nodes, links, springs and joints."""
    made = deepcopy(document)
    for section in SECTIONS:
        if section in made:
            made[section] = [made[section][int(place)] for place in rng.permutation(len(made[section]))]
    return Changed(made)


def renamed(document: Document, rng: Random) -> Changed:
    """Rename nodes, links and joints in another alphabetical order."""
    made = deepcopy(document)
    names: dict[str, dict[str, str]] = {}
    for section in SECTIONS:
        items = made.get(section, [])
        order = rng.permutation(len(items))
        names[section] = {item["name"]: f"{section[:2]}_{int(place):04d}" for item, place in zip(items, order)}
    for section in SECTIONS:
        for item in made.get(section, []):
            item["name"] = names[section][item["name"]]
            for keys, of in ((NODES, "node"), (LINKS, "link")):
                for key in keys:
                    if key in item:
                        value = item[key]
                        item[key] = names[of][value] if isinstance(value, str) else [names[of][one] for one in value]
    return Changed(made, lambda moved: {old: moved[new] for old, new in names["node"].items()})


def _mapped(document: Document, matrix: np.ndarray) -> Changed:
    """Map all vectors by an orthogonal matrix that keeps the z axis or rotates about it."""
    made, d = deepcopy(document), len(matrix)
    for section, keys in VECTORS.items():
        for item in made.get(section, []):
            for key in keys:
                if key in item:
                    item[key] = (matrix @ np.array(item[key])).tolist()
    sense = float(np.sign(np.linalg.det(matrix)))
    for section in AXIAL:
        for item in made.get(section, []):
            if "axis" in item:
                item["axis"] = (sense * matrix @ np.array(item["axis"])).tolist()
            elif sense < 0:  # about z of a plane
                for key in ("bias_rad", "preload_moment_N_m"):
                    if key in item:
                        item[key] = -item[key]
    for beam in made.get("beam", []) if d == 2 and sense < 0 else []:  # axis y is to the left of the beam
        if "gradient_per_m" in beam:
            beam["gradient_per_m"] = [-beam["gradient_per_m"][0], 0.0]
    for node in made["node"]:
        flat = [axis for axis in node.get("fixed", ()) if axis != "z"]
        if len(flat) != 1:
            continue
        held = np.eye(d)["xy".index(flat[0])]
        turned = matrix @ held
        if np.abs(np.abs(turned) - held).max() == 0:
            continue
        node["fixed"] = [axis for axis in node["fixed"] if axis == "z"]
        node["guide_normal"] = turned.tolist()
    if "gravity_m_per_s2" in made["truss"]:
        made["truss"]["gravity_m_per_s2"] = (matrix @ np.array(made["truss"]["gravity_m_per_s2"])).tolist()
    return Changed(made, lambda moved: {name: one @ matrix for name, one in moved.items()})


def rotated(document: Document, rng: Random) -> Changed:
    """Rotate the structure about z; supports along only one of x and y become inclined guides."""
    angle, d = float(rng.uniform(0.2, 1.3)), document["truss"]["dimension"]
    matrix = np.eye(d)
    matrix[:2, :2] = [[cos(angle), -sin(angle)], [sin(angle), cos(angle)]]
    return _mapped(document, matrix)


def mirrored(document: Document, rng: Random) -> Changed:
    """Mirror the structure in the plane across x."""
    matrix = np.eye(document["truss"]["dimension"])
    matrix[0, 0] = -1.0
    return _mapped(document, matrix)


def shifted(document: Document, rng: Random) -> Changed:
    """Translate the structure by a fraction of its size."""
    made = deepcopy(document)
    places = np.array([node["position_m"] for node in made["node"]])
    size = float(np.ptp(places, axis=0).max())
    by = rng.uniform(-3, 3, places.shape[1]) * size
    for node, place in zip(made["node"], places):
        node["position_m"] = (place + by).tolist()
    return Changed(made, rounding_m=float(np.finfo(float).eps * (np.abs(places + by).max() + size)))


def _rescaled(document: Document, length: float, force: float) -> Changed:
    made = deepcopy(document)
    for section in ("slider", *CLEARANCE):
        for item in made.get(section, []):
            item.setdefault("young_modulus_Pa", CONTACT_MODULUS_PA)
    for item in made.get("slider", []):
        item["pad_radius_m"] = length * item.get("pad_radius_m", 0.05)
    for section in SECTIONS:
        for item in made.get(section, []):
            for key, (lengths, forces) in UNITS.items():
                if key in item:
                    by = length**lengths * force**forces
                    item[key] = [by * value for value in item[key]] if isinstance(item[key], list) else by * item[key]
    return Changed(made, lambda moved: {name: one / length for name, one in moved.items()})


def inches(document: Document, rng: Random) -> Changed:
    """Write lengths in inches; in millimetres, areas would exceed the range of a case."""
    return _rescaled(document, 1 / 0.0254, 1.0)


def kilonewtons(document: Document, rng: Random) -> Changed:
    """Write forces in kilonewtons."""
    return _rescaled(document, 1.0, 1e-3)


def slower(document: Document, rng: Random) -> Changed:
    """Let the program last longer."""
    made, by = deepcopy(document), 37.5
    for program in (made["thermal"], *made.get("program", [])):
        if "period_s" in program:
            program["period_s"] *= by
        if "table_time_s" in program:
            program["table_time_s"] = [by * time for time in program["table_time_s"]]
    return Changed(made)


def finer(document: Document, rng: Random) -> Changed:
    """Use twice as many increments."""
    made: dict[str, Any] = deepcopy(document)
    reduced = made.setdefault("reduced", {})
    reduced["increments_per_branch"] = 2 * reduced.get("increments_per_branch", 50)
    return Changed(made, exact=False)


TRANSFORMS: dict[str, Callable[[Document, Random], Changed]] = {
    one.__name__: one for one in (
        permuted, renamed, rotated, mirrored, shifted, inches, kilonewtons, slower, finer)}
