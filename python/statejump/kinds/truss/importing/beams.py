# SPDX-License-Identifier: GPL-3.0-or-later
"""Beams of a deck as items of a case: principal axes, supports of rotations, tapered beams, stiffness of nodes."""
from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from statejump.kinds.truss.importing.bending import SOFT, Bending, Load, Section, nodal_loads, triad
from statejump.kinds.truss.importing.model import Bar, Deck
from statejump.kinds.truss.importing.supports import SAME, basis_of

# A tapered beam becomes this many uniform beams: the deflection of a cantilever that tapers to half its height has an
# error of 0.2 %.
PIECES = 8


def node_stiffness(of: Bar, first: np.ndarray, second: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the stiffness matrices of displacements and of rotations of one node of a beam, over E A/l and E/l."""
    bending = of.bending
    assert bending is not None
    section, _, axes = bending.principal(first, second)
    if axes is None or not of.area:
        return np.zeros((3, 3)), np.zeros((3, 3))
    y, z = axes[1:]
    about_y, about_z = section.moments
    across = 12 / (of.area * float(np.sum((second - first) ** 2)))
    along = np.outer(axes[0], axes[0])
    torsion = section.torsion * (bending.shear_modulus or 0.0) / (of.young_modulus or 1.0)
    return (along + across * (about_z * np.outer(y, y) + about_y * np.outer(z, z)),
            torsion * along + 4 * (about_y * np.outer(y, y) + about_z * np.outer(z, z)))


def rotations(deck: Deck, node: str, bent: bool) -> list[str]:
    """Return the axes about which a node does not rotate."""
    held = deck.held_rotations.get(node)
    if not held:
        return []
    if not bent:
        deck.leave("supports of rotations", "no beam ends at their nodes", 0)
        return []
    basis = basis_of(np.array(held))
    along = [axis for axis in range(3) if np.linalg.norm(np.eye(3)[axis] - basis.T @ (basis @ np.eye(3)[axis])) <= SAME]
    if len(along) < len(basis):
        deck.refuse("rotation", "oblique_rotation", 0, "ROTATION.OBLIQUE")
    return ["xyz"[axis] for axis in along]


def split_tapered(deck: Deck) -> None:
    """Divide tapered beams into uniform ones."""
    made: list[Bar] = []
    for bar in deck.bars:
        if bar.bending is None or len(bar.bending.stations) < 2:
            made.append(bar)
            continue
        ends = [bar.nodes[0], *(f"{bar.name}_at{number}" for number in range(1, PIECES)), bar.nodes[1]]
        first, second = (np.array(deck.nodes[end]) for end in bar.nodes)
        for number, name in enumerate(ends[1:-1], start=1):
            part = number / PIECES
            x, y, z = (float(value) for value in first + (second - first) * part)
            deck.add_node(0, name, (x, y, z))
            for of in (deck.temperature, deck.initial):
                if any(end in of for end in bar.nodes):
                    low, high = (of.get(end, 0.0) for end in bar.nodes)
                    of[name] = low + (high - low) * part
        mean_density = (bar.density or 0.0) * (bar.area or 0.0)  # the mass per length of a beam is that of the deck
        for number in range(PIECES):
            section = _between(bar.bending, (number + 0.5) / PIECES)
            made.append(replace(
                bar, name=f"{bar.name}_{number + 1}", nodes=(ends[number], ends[number + 1]), area=section.area,
                density=mean_density / section.area if bar.density is not None else None,
                bending=replace(bar.bending, section=section, stations=())))
        deck.take(bar.kind, f"{PIECES} uniform beams, for its section varies")
    deck.bars[:] = made


def _between(bending: Bending, at: float) -> Section:
    """Return the section at a position, linear between stations."""
    places = [place for place, _ in bending.stations]

    def mean(*values: float) -> float:
        return float(np.interp(at, places, values))

    sections = [section for _, section in bending.stations]
    return Section(
        mean(*(one.area for one in sections)),
        (mean(*(one.moments[0] for one in sections)), mean(*(one.moments[1] for one in sections))),
        mean(*(one.torsion for one in sections)),
        (mean(*(one.shear_factors[0] for one in sections)), mean(*(one.shear_factors[1] for one in sections))),
        mean(*(one.product for one in sections)), sections[0].eccentric)


def bend_by_weight(deck: Deck) -> None:
    """Add the moments with which the ends of beams move as under a weight along the beams. Their forces are half of the
    weight at each end."""
    for bar in deck.bars:
        first, second = deck.ends_of(bar)
        axes = triad(first, second, bar.bending.axis_y) if bar.bending else None
        if axes is None or not bar.density or not bar.area or bar.bending is None:
            continue
        if bar.bending.offsets.any():
            deck.refuse(f"{bar.kind} offset", "weight_beside_nodes", 0)
        if any(released & {"Ry", "Rz"} for released in bar.bending.released):
            if not all({"Ry", "Rz"} <= released for released in bar.bending.released):
                deck.refuse(f"{bar.kind} weight", "load_on_released_beam", 0)
            continue  # a beam on two hinges passes half of its weight to each node, without moments
        weight = np.array(deck.gravity) * bar.density * bar.area
        found = nodal_loads(Load(0.0, 1.0, weight, weight), float(np.linalg.norm(second - first)), axes, (0.0, 0.0))
        for node, moment in zip(bar.nodes, found[1::2]):
            deck.turn(node, moment, True)
    deck.take("gravity", "weights along beams: moments of their ends")


def beam_keys(deck: Deck, of: Bar, length: float, peak: float) -> dict[str, Any]:
    """Return the keys of the bending of a beam in the units of the deck's lengths and stresses.

    :param length: unit of length [m]
    :param peak: temperature change of the case [K]
    """
    bending = of.bending
    assert bending is not None
    section, angle, axes = bending.principal(*deck.ends_of(of))
    if angle and bending.section.shear_factors[0] != bending.section.shear_factors[1]:
        deck.refuse(of.kind, "shear_beside_axes", 0, "SHEAR")
    direction = axes[1] if axes is not None and angle else bending.axis_y
    size = float(np.linalg.norm(direction)) or 1.0
    moments, torsion = _stiff(deck, of, section, bending.shear_modulus)
    made: dict[str, Any] = {
        "second_moments_of_area_m4": [value * length**4 for value in moments],
        "torsion_constant_m4": torsion * length**4,
        "axis_y": [float(part) / size + 0.0 for part in direction],
    }
    made.update(_shear(deck, of, section, bending.shear_modulus))
    made.update(_ends(deck, of, angle, length))
    if any(bending.gradient):
        along_y, along_z = bending.gradient
        turned = [along_y * np.cos(angle) + along_z * np.sin(angle), along_z * np.cos(angle) - along_y * np.sin(angle)]
        made["gradient_per_m"] = [float(value) / length / peak + 0.0 for value in turned]
    return made


def _ends(deck: Deck, of: Bar, angle: float, length: float) -> dict[str, Any]:
    """Return the keys of released ends and of offsets."""
    assert of.bending is not None
    made: dict[str, Any] = {}
    for key, released, offset in zip(("first", "second"), of.bending.released, of.bending.offsets):
        if angle and len(released & {"Ry", "Rz"}) == 1:
            deck.refuse(of.kind, "release_beside_axes", 0, "RELEASE")
        if released:
            made[f"released_{key}"] = sorted(released)
        if offset.any():
            made[f"offset_{key}_m"] = [float(part) * length for part in offset]
    return made


def _stiff(deck: Deck, of: Bar, section: Section, shear: float | None) -> tuple[tuple[float, float], float]:
    """Return second moments and torsion constant. Cases need positive numbers: a 0 of the deck becomes a small one."""
    largest = max(*section.moments, section.torsion)
    about_y, about_z = (value or SOFT * largest for value in section.moments)
    if not all(section.moments):
        deck.leave(of.kind, f"a second moment of area of 0: {SOFT:g} of the other one is taken", 0)
    torsion = section.torsion if shear else 0.0
    if not torsion:
        deck.leave(of.kind, f"no stiffness in torsion: {SOFT:g} of that in bending is taken", 0)
    return (about_y, about_z), torsion or SOFT * largest


def _shear(deck: Deck, of: Bar, section: Section, shear: float | None) -> Mapping[str, Any]:
    factors = section.shear_factors
    if not shear or not any(factors):
        return {}
    if not all(factors):
        deck.refuse(of.kind, "mixed_shear", 0, "SHEAR")
        return {}
    return {"shear_factors": list(factors)}
