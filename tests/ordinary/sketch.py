# SPDX-License-Identifier: GPL-3.0-or-later
"""A structure under construction: nodes, bars, supports, and possible positions of joints. It is converted to a case
document."""
from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np

Vector = np.ndarray
Document = dict[str, Any]

JOINTS = ("slider", "iwan_joint", "revolute", "ball_joint", "latch_hinge")
CLEARANCE = ("revolute", "ball_joint")  # joints whose parts play in each other


@dataclass
class Bar:
    """A bar with its current end nodes; ``drawn`` are its end nodes in the shape without joints."""

    ends: list[str]
    role: str
    drawn: tuple[str, str]
    keys: dict[str, Any] = field(default_factory=dict)


@dataclass(frozen=True)
class Foot:
    """A support that can be made to slide along an axis."""

    node: str
    axis: tuple[float, ...]
    across: str  # directions in which it stays held
    guide: tuple[float, ...] | None = None


@dataclass
class Sketch:
    """The shape that a family generates.

    :param down: direction of weight
    """

    dimension: int
    points: dict[str, Vector] = field(default_factory=dict)
    fixed: dict[str, str] = field(default_factory=dict)
    guides: dict[str, Vector] = field(default_factory=dict)
    bars: dict[str, Bar] = field(default_factory=dict)
    feet: list[Foot] = field(default_factory=list)
    tips: list[str] = field(default_factory=list)
    forces: dict[str, Vector] = field(default_factory=dict)
    items: dict[str, list[dict[str, Any]]] = field(default_factory=dict)
    down: tuple[float, ...] = (0.0, -1.0)

    def node(self, name: str, *place: float, fixed: str = "") -> str:
        """Add a node; return its name."""
        self.points[name] = np.array(place, dtype=float)
        if fixed:
            self.fixed[name] = fixed
        return name

    def bar(self, one: str, two: str, role: str = "bar", **keys: Any) -> str:
        """Add a bar; return its name."""
        name = f"{role}_{one}_{two}"
        self.bars[name] = Bar([one, two], role, (one, two), keys)
        return name

    def add(self, section: str, name: str, **keys: Any) -> None:
        """Add an item of another section."""
        self.items.setdefault(section, []).append({"name": name, **keys})

    def along(self, bar: str) -> Vector:
        """Return the unit vector from the first end of a bar to the second."""
        one, two = (self.points[node] for node in self.bars[bar].ends)
        return np.asarray((two - one) / np.linalg.norm(two - one))

    def length(self, bar: str) -> float:
        """Return the drawn length of a bar."""
        one, two = (self.points[node] for node in self.bars[bar].ends)
        return float(np.linalg.norm(two - one))

    def size(self) -> float:
        """Return the largest extent of the structure."""
        places = np.array(list(self.points.values()))
        return float(np.ptp(places, axis=0).max())

    def at(self, node: str) -> list[str]:
        """Return the bars that currently end at a node."""
        return [name for name, bar in self.bars.items() if node in bar.ends]

    def joints(self) -> int:
        """Return how many joints it has."""
        return sum(len(self.items.get(section, ())) for section in JOINTS)

    def detach(self, bar: str, side: int) -> tuple[str, str]:
        """Move an end of a bar to a new node at the same position; return the old and the new node name."""
        old = self.bars[bar].ends[side]
        new = f"{old}_of_{bar}"
        self.points[new] = self.points[old].copy()
        if old in self.guides:
            self.guides[new] = self.guides[old]
        self.bars[bar].ends[side] = new
        return old, new

    def document(self, name: str, title: str, thermal: Document, programs: list[Document]) -> Document:
        """Return the case."""
        nodes = []
        for key, place in self.points.items():
            made: dict[str, Any] = {"name": key, "position_m": [float(value) for value in place]}
            if key in self.fixed:
                made["fixed"] = list(self.fixed[key])
            if key in self.guides:
                made["guide_normal"] = [float(value) for value in self.guides[key]]
            if key in self.forces:
                made["force_N"] = [float(value) for value in self.forces[key]]
            nodes.append(made)
        links = [{"name": key, "nodes": list(bar.ends), **bar.keys} for key, bar in self.bars.items()]
        found = {
            "case": {"name": name, "kind": "truss", "title": title, "source": "tests/ordinary"},
            "truss": {"dimension": self.dimension}, "node": nodes, "link": links, **self.items, "program": programs,
            "thermal": thermal,
        }
        return {key: value for key, value in found.items() if value}
