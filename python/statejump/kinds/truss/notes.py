# SPDX-License-Identifier: GPL-3.0-or-later
"""Notes of a quasi-static path as sentences: warnings of a successful run."""
from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from statejump.kinds.truss.resolved import ResolvedTruss

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
    return (f"{_named(note['joints'])}: constrain a displacement more than once {at}; the reactions are one solution "
            "of many, the displacements are unique")


def _named(joints: Sequence[tuple[str, str]]) -> str:
    return listed([f"{kind} {name!r}" for kind, name in joints])


def listed(names: Sequence[str]) -> str:
    """Return the first names and the number of the others."""
    first = ", ".join(names[:MOST_NAMED])
    return first if len(names) <= MOST_NAMED else f"{first} and {len(names) - MOST_NAMED} more"
