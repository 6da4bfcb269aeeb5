# SPDX-License-Identifier: GPL-3.0-or-later
"""Notes on a quasi-static path as sentences, which become warnings of the successful run."""
from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from statejump.core.notes import Note
from statejump.core.units import plain
from statejump.kinds.truss.resolved import Links, ResolvedTruss

# Codes of the notes about joints, by the engine's kind of note.
CODES = {"redundant_constraint": "redundant_constraint", "slack": "slack", "snap": "snap", "not_located": "not_located",
         "not_unique": "several_reactions", "free_spin": "free_spin"}
MOST_NAMED = 8  # largest number of names in a sentence, followed by the number of further names


def sentences(truss: ResolvedTruss, notes: Sequence[Mapping[str, Any]]) -> tuple[str, ...]:
    """Return the notes of a path as sentences, in their order."""
    return tuple(_sentence(truss, note) for note in notes)


def _sentence(truss: ResolvedTruss, note: Mapping[str, Any]) -> Note:
    at = f"at a temperature change of {note['temperature_change_K']:.9g} K (t = {note['time_s']:.9g} s)"
    if note["kind"] == "large_start":
        size_m = float(np.ptp(truss.nodes.position_m, axis=0).max())
        return Note("large_start", value=note["value"], share=note["value"] / size_m)
    joints = [("mean", truss.means.of_constraint[name]) if name in truss.means.of_constraint else (kind, name)
              for kind, name in note["joints"]]
    # If many joints are open, none is named.
    code = "changes_passed" if note["kind"] == "not_located" and joints else CODES[note["kind"]]
    return Note(code, named=_named(joints), at=at, value=note["value"],
                joints=tuple(joints), temperature_change_K=note["temperature_change_K"], time_s=note["time_s"])


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

    def sentence(code: str, at: np.ndarray, ratio: np.ndarray, **details: Any) -> list[str]:
        """Return the note about links whose load exceeds a limit; ``details`` are those of the worst
        link."""
        beyond = np.flatnonzero(ratio > 1)
        if not len(beyond):
            return []
        worst = int(np.argmax(ratio))
        more = len(beyond) - 1
        others = "" if not more else f", and so {'does 1 other link' if more == 1 else f'do {more} other links'}"
        when = (f"at a temperature change of {plain(float(temperature_change_K[at[worst]]), 'K', 4)} "
                f"(t = {plain(float(time_s[at[worst]]), 's', 4)})")
        return [Note(code, link=links.names[worst], at=when, others=others, links=len(beyond), **details)]

    pressed = np.argmax(axial_force_N, axis=0)
    compression, euler = axial_force_N[pressed, places], links.euler_load_N
    worst = int(np.argmax(compression / euler))
    found = sentence(
        "link_buckles", pressed, compression / euler, load=plain(float(compression[worst]), "N", 4),
        limit=plain(float(euler[worst]), "N", 4), ends=links.ends[worst].replace("_", "-"),
        second_moment_of_area_m4=float(links.second_moment_of_area_m4[worst]), load_N=float(compression[worst]),
        limit_N=float(euler[worst]))
    loaded = np.argmax(np.abs(axial_force_N), axis=0)
    stress = np.abs(axial_force_N[loaded, places]) / links.cross_section_area_m2
    worst = int(np.argmax(stress / links.yield_strength_Pa))
    return (*found, *sentence(
        "link_yields", loaded, stress / links.yield_strength_Pa, load=plain(float(stress[worst]), "Pa", 4),
        limit=plain(float(links.yield_strength_Pa[worst]), "Pa", 4), load_Pa=float(stress[worst]),
        limit_Pa=float(links.yield_strength_Pa[worst])))
