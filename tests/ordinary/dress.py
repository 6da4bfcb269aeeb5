# SPDX-License-Identifier: GPL-3.0-or-later
"""Assigns materials, sections, loads and joints to a sketched shape, in ranges of engineering practice."""
from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from sketch import Foot, Sketch

Random = np.random.Generator


@dataclass(frozen=True)
class Material:
    """Young's modulus [Pa], expansion [1/K] and density [kg/m3]."""

    young_Pa: float
    expansion_per_K: float
    density: float


MATERIALS = {
    "cfrp": Material(130e9, -0.5e-6, 1600.0),
    "aluminium": Material(70e9, 23.4e-6, 2700.0),
    "titanium": Material(114e9, 8.6e-6, 4430.0),
    "steel": Material(205e9, 12.0e-6, 7850.0),
    "invar": Material(141e9, 1.2e-6, 8100.0),
}
GRAVITY = 9.81


def materials(made: Sketch, rng: Random) -> None:
    """Assign materials and tubes to bars. Some structures have two materials, some are heated from one side."""
    common, other = rng.choice(list(MATERIALS), 2, p=[0.3, 0.3, 0.1, 0.2, 0.1])
    roles = sorted({bar.role for bar in made.bars.values()})
    mixed = set(rng.choice(roles, rng.integers(1, len(roles) + 1), replace=False)) if rng.random() < 0.4 else set()
    slender = float(rng.uniform(20, 60))
    lengths = [made.length(name) for name in made.bars]
    area = np.pi * 0.06 * (float(np.median(lengths)) / slender) ** 2  # tube, wall 6 % of its diameter
    lit = str(rng.choice(["all", "side", "role", "each"], p=[0.4, 0.3, 0.2, 0.1]))
    axis = int(rng.integers(made.dimension))
    shaded = float(rng.uniform(0.0, 0.9))
    lit_roles = dict(zip(roles, rng.uniform(0.2, 1.0, len(roles))))
    places = np.array([value[axis] for value in made.points.values()])
    for bar in made.bars.values():
        chosen = MATERIALS[str(other if bar.role in mixed else common)]
        section = area * (0.6 if bar.role in ("diagonal", "web", "counter", "brace") else 1.0)
        middle = np.mean([made.points[node][axis] for node in bar.ends])
        along = float((middle - places.min()) / max(np.ptp(places), 1e-9))
        fraction = {"all": 1.0, "side": shaded + (1 - shaded) * along, "role": lit_roles[bar.role],
                    "each": float(rng.uniform(0.3, 1))}[lit]
        preload = bar.keys.pop("preload", 0.0)
        bar.keys |= {
            "young_modulus_Pa": chosen.young_Pa, "cross_section_area_m2": float(section),
            "thermal_expansion_per_K": chosen.expansion_per_K, "density_kg_per_m3": chosen.density,
        }
        if lit != "all":
            bar.keys["temperature_fraction"] = fraction
        if preload:
            one, two = (made.points[node] for node in bar.ends)
            strain = preload / (chosen.young_Pa * section)
            bar.keys["stress_free_length_m"] = float(np.linalg.norm(two - one) / (1 + strain))


def thermal_force_N(made: Sketch, largest_K: float) -> float:
    """Return the force of a typical bar of fixed length during its temperature change [N]."""
    forces = [abs(bar.keys["thermal_expansion_per_K"]) * bar.keys["young_modulus_Pa"]
              * bar.keys["cross_section_area_m2"] * largest_K for bar in made.bars.values()]
    return float(np.median(forces))


def weight_N(made: Sketch) -> float:
    """Return the weight of all bars."""
    return GRAVITY * sum(made.length(name) * bar.keys["cross_section_area_m2"] * bar.keys["density_kg_per_m3"]
                         for name, bar in made.bars.items())


def loads(made: Sketch, rng: Random, case: dict[str, Any]) -> str:
    """Load the structure; return how."""
    kind = str(rng.choice(["none", "small", "gravity", "tip", "preload"], p=[0.3, 0.2, 0.2, 0.15, 0.15]))
    down = np.array(made.down)
    if kind == "gravity":
        case["gravity_m_per_s2"] = [float(value) for value in GRAVITY * down * (1 if rng.random() < 0.7 else 0.1)]
    elif kind == "small":
        for node in made.tips:
            made.forces[node] = np.round(rng.normal(0, 1, made.dimension) * float(rng.choice([0.1, 1, 5])), 3)
    elif kind == "tip":
        made.forces[made.tips[-1]] = np.round(down * weight_N(made) * float(rng.uniform(0.1, 1)), 3)
    elif kind == "preload":
        _preload(made, rng)
    return kind


def _preload(made: Sketch, rng: Random) -> None:
    """Add springs with a preload between nodes without a bar, or in parallel with bars."""
    names = list(made.points)
    for number in range(int(rng.integers(1, 4))):
        one, two = rng.choice(names, 2, replace=False)
        if np.linalg.norm(made.points[one] - made.points[two]) < 1e-6:
            continue
        made.add("spring", f"spring{number}", nodes=[str(one), str(two)],
                 stiffness_N_per_m=float(rng.choice([1e3, 1e4, 1e5])),
                 preload_N=float(np.round(rng.uniform(5, 200), 1)), cable=bool(rng.random() < 0.5))


@dataclass
class Joiner:
    """Places joints in a structure.

    :param force_N: thermal force of a typical bar of fixed length [N]
    """

    made: Sketch
    rng: Random
    force_N: float
    number: int = 0
    carriers: set[tuple[str, str]] = field(default_factory=set)

    def name(self, kind: str) -> str:
        """Return a new name."""
        self.number += 1
        return f"{kind}{self.number}"

    def friction(self) -> dict[str, float]:
        """Return a friction coefficient and normal force; the limit ranges from little to more than the joint can
        carry."""
        share = float(10 ** self.rng.uniform(-2, 0.3))
        coefficient = float(np.round(self.rng.uniform(0.05, 0.5), 3))
        return {"friction_coefficient": coefficient,
                "normal_force_N": float(np.format_float_positional(max(share * self.force_N / coefficient, 1.0),
                                                                   precision=4, fractional=False))}

    def stops(self) -> dict[str, float]:
        """Return clearances of stops, mostly none."""
        if self.rng.random() < 0.75:
            return {}
        return {f"clearance_{side}_m": float(10 ** self.rng.uniform(-5, -2.5)) for side in ("minus", "plus")}

    def iwan(self) -> dict[str, float]:
        """Return the parameters of a bolted joint."""
        slip = float(10 ** self.rng.uniform(-1.5, 0.3)) * self.force_N + 1.0
        return {"tangent_stiffness_N_per_m": slip / float(10 ** self.rng.uniform(-6, -4)), "slip_force_N": slip,
                "exponent": float(np.round(self.rng.uniform(-0.8, -0.1), 2)),
                "stiffness_ratio": float(np.round(self.rng.uniform(0, 2), 2))}

    def along(self, kind: str) -> dict[str, Any]:
        """Return the keys of a slider or an Iwan joint."""
        return {**self.friction(), **self.stops()} if kind == "slider" else self.iwan()

    def foot(self, foot: Foot, kind: str) -> None:
        """Let a support slide against friction."""
        self.made.fixed[foot.node] = foot.across
        self.made.add(kind, self.name("foot"), nodes=[foot.node], axis=list(foot.axis), **self.along(kind))

    def telescope(self, bar: str, kind: str) -> None:
        """Let a bar slide in the fitting at its end."""
        side = int(self.rng.integers(2))
        if not self._may_detach(bar, side):
            return
        axis = [float(value) for value in self.made.along(bar)]
        old, new = self.made.detach(bar, side)
        self.made.add(kind, self.name("fit"), nodes=[new, old], axis=axis, **self.along(kind))

    def _may_detach(self, bar: str, side: int) -> bool:
        """Return whether a bar's end may move to a new node. Another bar must remain at the old node, which may not
        belong to a joint. Bars coupled by a spring or latch keep a common node."""
        node = self.made.bars[bar].ends[side]
        stays = len(self.made.at(node)) > 1 or node in self.made.fixed
        return (stays and "_of_" not in node and (bar, node) not in self.carriers
                and all(node in self.made.bars[other].ends for other in self._turned_by(bar, node)))

    def _turned_by(self, bar: str, node: str) -> list[str]:
        """Return the bars that springs or latches couple to a given bar, at a node of the original shape."""
        pairs = [item["links"] for section in ("torsion_spring", "latch_hinge")
                 for item in self.made.items.get(section, ()) if bar in item["links"]]
        others = [other for pair in pairs for other in pair if other != bar]
        return [other for other in others if node in self.made.bars[other].drawn]

    def pin(self, bar: str, side: int) -> None:
        """Put a pin with clearance at an end of a bar."""
        made, rng = self.made, self.rng
        if not self._may_detach(bar, side):
            return
        node = made.bars[bar].ends[side]
        others = sorted(one for one in made.at(node) if one != bar)
        carrier = str(rng.choice(others)) if others else None
        if carrier is None and node not in made.fixed:
            return
        own = made.along(bar)
        flat = made.dimension == 2 or (carrier is not None and rng.random() < 0.3)
        across = np.cross(own, made.along(carrier)) if made.dimension == 3 and carrier else np.zeros(3)
        flat = flat and (made.dimension == 2 or bool(np.linalg.norm(across) > 0.1))
        old, new = made.detach(bar, side)
        hollow, inner, kind = ("bearing", "journal", "revolute") if flat else ("socket", "ball", "ball_joint")
        radius = float(rng.choice([3e-3, 5e-3, 1e-2]))
        keys: dict[str, Any] = {
            f"{hollow}_node": old, f"{inner}_node": new, f"{inner}_link": bar, f"{inner}_radius_m": radius,
            "radial_clearance_m": float(rng.choice([5e-6, 1e-5, 2e-5, 5e-5, 1e-4])),
            "friction_coefficient": float(np.round(rng.uniform(0, 0.3), 2)),
        }
        if carrier is not None:
            keys[f"{hollow}_link"] = carrier
            self.carriers.add((carrier, old))
        if flat and made.dimension == 3:
            keys["axis"] = [float(value) for value in across]
        made.add(kind, self.name("pin"), **keys)

    def latch(self) -> None:
        """Put a latch hinge between two bars that meet at a node."""
        made, rng = self.made, self.rng
        node = str(rng.choice(list(made.points)))
        bars = made.at(node)
        if len(bars) < 2:
            return
        one, two = (str(name) for name in rng.choice(bars, 2, replace=False))
        keys: dict[str, Any] = {}
        if made.dimension == 3:
            axis = np.cross(made.along(one), made.along(two))
            if np.linalg.norm(axis) < 0.1:
                return
            keys["axis"] = [float(value) for value in axis]
        arm = 0.02 * self.force_N * made.length(one) * 1e-3
        made.add("latch_hinge", self.name("latch"), links=[one, two],
                 deadband_rad=float(10 ** rng.uniform(-4.5, -2)), stiffness_N_m_per_rad=float(10 ** rng.uniform(1, 4)),
                 friction_moment_N_m=float(10 ** rng.uniform(-2, 1) * (arm + 0.01)),
                 preload_moment_N_m=float(rng.choice([0.0, 0.0, 0.1, 1.0])), **keys)


PLANS = ("none", "feet", "bolted_feet", "fittings", "bolts", "pins", "all_pins", "latches", "mixed")
SHARES = (0.08, 0.16, 0.06, 0.12, 0.1, 0.2, 0.08, 0.08, 0.12)
MOST_JOINTS = 200


def joints(made: Sketch, rng: Random, force_N: float) -> str:
    """Place joints by a plan; return it."""
    plan = str(rng.choice(PLANS, p=SHARES))
    if made.items.get("torsion_spring") and plan in ("pins", "all_pins", "mixed"):
        plan = "fittings"  # pins would separate the links of bending springs
    place = Joiner(made, rng, force_N)
    bars = [str(name) for name in rng.permutation([*made.bars])]
    some = bars[: max(1, int(len(bars) * float(rng.uniform(0.03, 0.3))))][:MOST_JOINTS // 2]
    if plan in ("feet", "mixed", "bolted_feet"):
        for foot in made.feet:
            if rng.random() < 0.7:
                place.foot(foot, "iwan_joint" if plan == "bolted_feet" else "slider")
    if plan in ("fittings", "bolts"):
        for bar in some:
            place.telescope(bar, "slider" if plan == "fittings" else "iwan_joint")
    if plan in ("pins", "all_pins"):
        for bar in (some if plan == "pins" else bars[:MOST_JOINTS // 2]):
            for side in (0, 1):
                if plan == "all_pins" or rng.random() < 0.6:
                    place.pin(bar, side)
    if plan == "latches":
        for _ in range(int(rng.integers(1, 8))):
            place.latch()
    if plan == "mixed":
        for number, bar in enumerate(some):
            (lambda bar: place.pin(bar, 0), lambda bar: place.telescope(bar, "slider"),
             lambda bar: place.telescope(bar, "iwan_joint"), lambda bar: place.latch())[number % 4](bar)
    return plan
