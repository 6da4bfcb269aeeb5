# SPDX-License-Identifier: GPL-3.0-or-later
"""Texts of a ``statics`` case and its rest sets: sentences, the table of the command, a notebook."""
from __future__ import annotations

from html import escape
from typing import Any

from statejump.core.html import table
from statejump.core.tables import Shown
from statejump.core.units import text
from statejump.kinds.statics.case import StaticsCase
from statejump.kinds.statics.solve import Statics

JOINTS = {
    "slot": "A block in a slot", "journal": "A journal in a round bearing", "ball": "A ball in a socket",
    "cylinder": "A cylinder in a bore with shoulders", "lobed": "A journal in a lobed bearing",
    "mesh": "A component whose positions are the surface of a mesh",
}
HEADINGS = ("force", "parts", "length [m]", "area [m2]", "angle [rad]", "largest jump [m]")
NOWHERE = "no position holds under every force: the joint moves from one to the other"


def _number(value: float) -> str:
    return f"{value:.6g}"


def _measure(value: dict[str, Any]) -> tuple[str, str]:
    """Return length and area as texts; a point has neither."""
    length, area = (_number(value[key]) if value[key] else "-" for key in ("length_m", "area_m2"))
    return length, area


def _angle(part: dict[str, Any]) -> str:
    return "-" if part["angle_rad"] is None else _number(part["angle_rad"])


def rows(statics: Statics) -> list[tuple[str, ...]]:
    """Return every set and, if it has several parts, every part, as cells of ``HEADINGS``."""
    found: list[tuple[str, ...]] = []
    for name, one in statics.named():
        parts = one["parts"]
        found.append((name, str(len(parts)), *_measure(one), _angle(parts[0]) if len(parts) == 1 else "-",
                      _number(one["diameter_m"]) if parts else "-"))
        for index, part in enumerate(parts if len(parts) > 1 else (), start=1):
            found.append((f"  part {index}", "", *_measure(part), _angle(part), _number(part["diameter_m"])))
    return found


def notes(statics: Statics) -> list[str]:
    """Return notes on the rest sets that the table does not contain."""
    found = []
    if not statics.all["parts"] and len(statics.loads) > 1:
        found.append(NOWHERE)
    error = max(one["diameter_error_m"] for _, one in statics.named())
    if error > 0:
        found.append(f"on a mesh: error of the largest jump about {error:.2g} m")
    return found


def summary_lines(statics: Statics) -> list[Shown | str]:
    """Return what the command prints."""
    title = f"{statics.case.title}: where it can rest, friction coefficient {statics.friction_coefficient:g}"
    return [Shown(title, HEADINGS, rows(statics), left=("force",)), *notes(statics)]


def describe(case: StaticsCase) -> list[str]:
    """Return the case in sentences."""
    joint, loads = case.joint, case.load_cases
    sentences = [f"{JOINTS[joint.type]}; friction with μ = {joint.friction_coefficient:g}."]
    if joint.clearance_m is not None:
        sentences.append(f"The clearance is {text(joint.clearance_m, 'm')}.")
    forces = "one force" if len(loads) == 1 else f"{len(loads)} forces, one at a time"
    return [*sentences, f"It is loaded by {forces}."]


def html(statics: Statics) -> str:
    """Return the table for a notebook."""
    said = "".join(f"<p>{escape(note)}</p>" for note in notes(statics))
    title = f"{statics.case.title}, friction coefficient {statics.friction_coefficient:g}"
    return f"<h4>{escape(title)}</h4>{table(HEADINGS, rows(statics))}{said}"
