# SPDX-License-Identifier: GPL-3.0-or-later
"""Notes on a quasi-static path as sentences, which become warnings of the successful run."""
from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from statejump.core.units import plain
from statejump.kinds.truss.resolved import Links, ResolvedTruss

MOST_NAMED = 8  # largest number of names in a sentence, followed by the number of further names


def sentences(truss: ResolvedTruss, notes: Sequence[Mapping[str, Any]]) -> tuple[str, ...]:
    """Return the notes of a path as sentences, in their order."""
    return tuple(_sentence(truss, note) for note in notes)


def _sentence(truss: ResolvedTruss, note: Mapping[str, Any]) -> str:
    at = f"at a temperature change of {note['temperature_change_K']:.9g} K (t = {note['time_s']:.9g} s)"
    if note["kind"] == "large_start":
        size_m = float(np.ptp(truss.nodes.position_m, axis=0).max())
        return (f"the loads move the structure by {note['value']:.3g} m at the start, {note['value'] / size_m:.1%} of "
                "its size: the path belongs to that configuration, not to the drawn one")
    if note["kind"] == "redundant_constraint":
        return f"{_named(note['joints'])}: follows from supports and the constraints before it; it changes nothing"
    if note["kind"] == "slack":
        return (f"{_named(note['joints'])}: no contact {at}; the element carries no force and keeps its position in "
                "the play until the clearance closes")
    if note["kind"] == "snap":
        return (f"{_named(note['joints'])}: slip runs away within the play {at}; dashpots in the joints carry the "
                f"structure on to a stable position, {note['value']:.3g} m away")
    if note["kind"] == "not_located":
        return (f"many elements are slack {at}: from there the times at which their joints make and lose contact are "
                "resolved to one increment; more reduced.increments_per_branch resolve them better")
    verb = "constrains" if len(note["joints"]) == 1 else "constrain"
    return (f"{_named(note['joints'])}: {verb} a displacement more than once {at}; the reactions are one solution "
            "of many, the displacements are unique")


def _named(joints: Sequence[tuple[str, str]]) -> str:
    return listed([f"{kind} {name!r}" for kind, name in joints])


def listed(names: Sequence[str]) -> str:
    """Return the first names and the number of the others."""
    first = ", ".join(names[:MOST_NAMED])
    return first if len(names) <= MOST_NAMED else f"{first} and {len(names) - MOST_NAMED} more"


def warnings(links: Links, time_s: np.ndarray, temperature_change_K: np.ndarray, axial_force_N: np.ndarray
             ) -> tuple[str, ...]:
    """Return one sentence about buckling and one about yielding, each for the worst link.

    :param axial_force_N: axial forces (times, links), positive in compression
    """
    if not axial_force_N.size:
        return ()
    places = np.arange(len(links.names))

    def sentence(at: np.ndarray, load: np.ndarray, parts: Sequence[str]) -> list[str]:
        """Return the sentence about links whose load exceeds a limit at these samples. ``parts`` are the load of the
        worst link, the exceeded limit, and the behaviour of the models."""
        beyond = np.flatnonzero(load > 1)
        if not len(beyond):
            return []
        worst = int(np.argmax(load))
        more = len(beyond) - 1
        others = "" if not more else f", and so {'does 1 other link' if more == 1 else f'do {more} other links'}"
        when = (f"at a temperature change of {plain(float(temperature_change_K[at[worst]]), 'K', 4)} "
                f"(t = {plain(float(time_s[at[worst]]), 's', 4)})")
        return [f"link {links.names[worst]!r} {parts[0]} {when} {parts[1]}{others}: {parts[2]}"]

    pressed = np.argmax(axial_force_N, axis=0)
    compression, euler = axial_force_N[pressed, places], links.euler_load_N
    worst = int(np.argmax(compression / euler))
    found = sentence(pressed, compression / euler, (
        f"is compressed by {plain(float(compression[worst]), 'N', 4)}",
        f"beyond its Euler load of {plain(float(euler[worst]), 'N', 4)} ({links.ends[worst].replace('_', '-')}, I = "
        f"{links.second_moment_of_area_m4[worst]:.4g} m4)", "the models keep links straight"))
    loaded = np.argmax(np.abs(axial_force_N), axis=0)
    stress = np.abs(axial_force_N[loaded, places]) / links.cross_section_area_m2
    worst = int(np.argmax(stress / links.yield_strength_Pa))
    return (*found, *sentence(loaded, stress / links.yield_strength_Pa, (
        f"is stressed by {plain(float(stress[worst]), 'Pa', 4)}",
        f"beyond its yield strength of {plain(float(links.yield_strength_Pa[worst]), 'Pa', 4)}",
        "the models keep links elastic")))
