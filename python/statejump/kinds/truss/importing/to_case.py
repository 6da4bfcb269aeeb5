# SPDX-License-Identifier: GPL-3.0-or-later
"""Conversion of a deck to a case document: units, number of dimensions, temperatures, inserted joints."""
from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from statejump.core.errors import MissingKey, StatejumpError
from statejump.kinds.truss.constraints import AXES, TURNS
from statejump.kinds.truss.generate.document import Document, finished
from statejump.kinds.truss.importing.beams import beam_keys, bend_by_weight, rotations
from statejump.kinds.truss.importing.bodies import named_nodes
from statejump.kinds.truss.importing.joints import matching, put_in
from statejump.kinds.truss.importing.model import Bar, Deck, Equation, Mean, Spring
from statejump.kinds.truss.importing.supports import supports
from statejump.kinds.truss.means import ALL
from statejump.kinds.truss.sections import MOST_DENSITY_KG_PER_M3, MOST_EXPANSION_PER_K

# Fraction of the truss size below which a difference of coordinates is zero, because decks have eight digits.
FLAT = 1e-9
# Fraction of the largest coefficient of an equation below which a coefficient is rounding of directions.
ROUNDING = 1e-12
# Length of a spring to the ground, as a multiple of the truss size. If the node moves across the spring by 1/1000 of
# the size, the transverse force is a millionth of the spring force. Positions keep 13 digits.
FAR, FARTHEST_M = 1e3, 9e5
# Mass of a bar without density under gravity [kg]: cases need a mass, and this mass is negligible.
WEIGHTLESS_KG = 1e-15
WEIGHTLESS_KG_PER_M3 = 1e-12  # of a beam
# Options that give all links a number that is missing in the deck.
OPTIONS = {"young_modulus_Pa": "--young-modulus", "cross_section_area_m2": "--area",
           "thermal_expansion_per_K": "--thermal-expansion"}
# Beyond its table a coefficient is constant. Tables of cases extend this far [K].
BEYOND_K = 1e3
# Half the width of a jump, as a fraction of the range of the table. Beyond the jump, the strain error is the square of
# this fraction. Narrower jumps need more solver steps.
JUMP = 1e-3


Member = tuple[Bar, dict[str, Any]]  # with its link or beam


@dataclass(frozen=True)
class Units:
    """The units of a deck.

    :param length_m: unit of length of the deck [m]
    :param force_N: unit of force of the deck [N]
    :param mass_kg: unit of mass of the deck [kg]; None: force · s² / length
    """

    length_m: float = 1.0
    force_N: float = 1.0
    mass_kg: float | None = None

    @property
    def mass(self) -> float:
        """Unit of mass [kg]."""
        return self.force_N / self.length_m if self.mass_kg is None else self.mass_kg

    @property
    def stress(self) -> float:
        """Unit of stress [Pa]."""
        return self.force_N / self.length_m**2


POUND_FORCE_N = 4.4482216152605  # exact
INCH_M = 0.0254  # exact
# Common systems first: the first of several equally plausible ones is chosen.
SYSTEMS = {
    "SI": Units(), "mm-N": Units(1e-3), "in-lbf": Units(INCH_M, POUND_FORCE_N), "mm-kg-s": Units(1e-3, 1e-3),
    "mm-kN-t": Units(1e-3, 1e3, 1e3),
}


def case_document(
    deck: Deck, name: str, *, units: Units = Units(),
    temperature_change_K: float | None = None, density_kg_per_m3: float | None = None,
    joints: Sequence[Mapping[str, str]] = (), sections: Mapping[str, Mapping[str, Any]] | None = None,
    reflector: tuple[Sequence[str], Sequence[float]] | None = None, links: Mapping[str, float] | None = None,
    fixed: Sequence[tuple[str, str]] = (), check_ignored: bool = True,
) -> Document:
    """Return the case document of a deck, and record in the deck how each card was used.

    :param units: units of the deck
    :param temperature_change_K: temperature change of all links, for a deck without temperatures
    :param density_kg_per_m3: density of the links for which the deck gives none
    :param joints: arguments of ``--joint``, see :mod:`~statejump.kinds.truss.importing.joints`
    :param sections: further sections of the case; ``thermal`` replaces the temperatures of the deck
    :param reflector: nodes of a reflecting surface, as names or patterns, and the axis of the surface
    :param links: values of link keys for which the deck gives none
    :param fixed: names or patterns of nodes, and the directions in which they are held in addition
    :param check_ignored: whether to raise an error for an item of ``Options.ignored`` that matches nothing in the deck
    :raises StatejumpError: a link lacks a number, or a node does not exist
    """
    if deck.spread_weight and any(deck.gravity):
        bend_by_weight(deck)
    used = named_nodes(deck)
    _check_unused(deck, used)
    dimension = _dimension(deck, used)
    more = dict(sections or {})
    changes = [0.0] * len(deck.bars) if "thermal" in more else _changes(deck, temperature_change_K)
    peak = max(changes, key=abs, default=temperature_change_K or 0.0)
    deck.modal = deck.modal or not (peak or more or fixed or _held_or_loaded(deck))
    if not peak and any(any(bar.bending.gradient) for bar in deck.bars if bar.bending):
        peak = 1.0  # fractions give the links 0 K
    if any(deck.gravity) and density_kg_per_m3 is None and not deck.mass and not any(bar.density for bar in deck.bars):
        deck.leave("gravity", "nothing has a mass", 0)
        deck.gravity = [0.0, 0.0, 0.0]
    gravity = [in_units(part, units.length_m) for part in deck.gravity[:dimension]]
    truss: dict[str, Any] = {"dimension": dimension, **({"gravity_m_per_s2": gravity} if any(gravity) else {})}
    members = [(bar, (_beam if bar.bending else _link)(deck, bar, change, peak, units, density_kg_per_m3, links or {}))
               for bar, change in zip(deck.bars, changes)]
    bent = deck.bent()
    made: Document = {
        "case": {"name": name, "kind": "truss", "title": "", "source": f"imported from {deck.path.name}"},
        "truss": truss,
        "node": [_node(deck, node, dimension, units, node in bent) for node in deck.nodes if node in used],
        "link": [item for bar, item in members if not bar.bending],
        "beam": [item for bar, item in members if bar.bending],
        "slider": [], "revolute": [], "spring": [], "expansion": [],
        "thermal": {"shape": "triangle", "temperature_change_max_K": float(peak)}, **more,
    }
    if not peak and not more:  # nothing follows the start: each branch is one increment
        made["reduced"] = {"increments_per_branch": 1}
    _springs(deck, made, units, dimension)
    _expansions(deck, made, members)
    made["constraint"] = [_constraint(f"C{number}", one, units) for number, one in enumerate(deck.equations, start=1)]
    made["mean"] = [_mean(f"M{number}", one) for number, one in enumerate(deck.means, start=1)]
    _bodies(deck, made, units)
    _leave_impossible(deck, members, heated=any(changes) or "thermal" in more, weighed=any(gravity) or deck.modal)
    deck.settle()
    if check_ignored:
        deck.check_waived()
    if "thermal" in more and (deck.temperature or any(bar.temperature_change is not None for bar in deck.bars)):
        deck.leave("temperatures", "those of the members' histories are taken", 0)
    _hold(made, fixed, dimension)
    _free(deck, made)
    deck.choices += put_in(made, joints, dimension)
    if reflector is not None:
        of_deck = [node_name(node) for node in deck.nodes if node in used]
        made["reflector"] = {"axis": [float(part) for part in reflector[1][:dimension]], "nodes": list(dict.fromkeys(
            name for pattern in reflector[0] for name in matching("--reflector", pattern.strip(), of_deck)))}
    return finished(made)


def _held_or_loaded(deck: Deck) -> bool:
    """Return whether a deck has supports or loads."""
    loads = [*map(np.array, deck.force.values()), *deck.moment.values(), np.array(deck.gravity)]
    gradients = any(any(bar.bending.gradient) for bar in deck.bars if bar.bending)
    return bool(any(deck.fixed.values()) or any(deck.held.values()) or any(np.any(load) for load in loads) or gradients
                or any(spring.second is None for spring in deck.springs))


def _free(deck: Deck, made: Document) -> None:
    """Permit rigid motions of a deck of modes without supports, and of a deck with neither loads nor supports."""
    supported = any("fixed" in node or "guide_normal" in node for node in made["node"])
    if deck.modal and (deck.free or not supported):
        made["truss"]["free"] = True
        deck.take("free structure", "truss.free: 'statejump modes' computes its natural frequencies")


def _hold(made: Document, fixed: Sequence[tuple[str, str]], dimension: int) -> None:
    """Hold nodes by name in further directions."""
    nodes = {node["name"]: node for node in made["node"]}
    for pattern, directions in fixed:
        for name in matching("--fixed", pattern, list(nodes)):
            held = {*nodes[name].get("fixed", ()), *directions}
            nodes[name]["fixed"] = [axis for axis in "xyz"[:dimension] if axis in held]


def _check_unused(deck: Deck, used: set[str]) -> None:
    """Refuse a load on a node without bars and springs; record that other items on such a node are omitted."""
    acting = [(deck.force_line[node], node, "force") for node, force in deck.force.items()
              if node in deck.force_line and any(force)]
    acting += [(deck.mass_line[node], node, "mass") for node, mass in deck.mass.items() if mass]
    for (line, card), node, what in acting:
        if node not in used:
            deck.refuse(card, "no_bar_at_node", line, f"{card.lstrip('*')}.UNUSED", what=what, node=node)
    for node in [node for node in deck.nodes if node not in used]:
        deck.leave(f"node {node}" if len(deck.nodes) < 50 else "node", "no bar ends there", 0)


def _dimension(deck: Deck, used: set[str]) -> int:
    heights = [deck.nodes[node][2] for node in used]
    size = max((abs(value) for node in used for value in deck.nodes[node]), default=0.0)
    if any(bar.bending for bar in deck.bars):  # beams rotate out of the plane, where nothing holds them
        return 3
    moments = [*deck.moment.values(), *deck.weight_moment.values()]
    if (deck.hinges or any(np.any(moment[:2]) for moment in moments)
            or max(heights) - min(heights) > FLAT * size or any(force[2] for force in deck.force.values())
            or deck.gravity[2] or any(spring.direction and abs(spring.direction[2]) > FLAT for spring in deck.springs)
            or any(abs(way[2]) > FLAT for one in deck.equations for _, way, _ in one.terms)
            or any(np.abs(way[:2]).max() > FLAT for one in deck.equations for _, way, _ in one.turns)):
        return 3
    deck.leave("z of nodes", "all nodes are in one plane: the truss is planar", 0)
    return 2


def _springs(deck: Deck, made: Document, units: Units, dimension: int) -> None:
    """Add springs to the document. A spring to the ground ends at a far node, so that its direction stays constant."""
    places = np.array([node["position_m"] for node in made["node"]])
    size = float(np.ptp(places, axis=0).max()) or 1.0
    for spring in deck.springs:
        name = _called("K", spring.name)
        ends = [node_name(spring.first)]
        if spring.second is not None:
            ends.append(node_name(spring.second))
        else:
            ends.append(f"G_{name}")
            made["node"].append(_ground(deck, spring, ends[1], units, min(FAR * size, FARTHEST_M), dimension))
        made["spring"].append({"name": name, "nodes": ends, "stiffness_N_per_m": in_units(
            spring.stiffness, units.force_N / units.length_m)})


def _constraint(name: str, equation: Equation, units: Units) -> dict[str, Any]:
    """Return the constraint for an equation, without the small coefficients that rounding of directions causes."""
    terms: dict[tuple[str, str], float] = {}
    for axes, given, unit in ((AXES, equation.terms, 1.0), (TURNS, equation.turns, units.length_m)):
        sums: dict[tuple[str, str], float] = {}
        for node, way, factor in given:
            for axis, part in zip(axes, way):
                sums[node, axis] = sums.get((node, axis), 0.0) + factor * float(part)
        largest = max((abs(value) for value in sums.values()), default=0.0)
        terms |= {term: in_units(value, unit) for term, value in sums.items() if abs(value) > ROUNDING * largest}
    return {"name": name, "nodes": [node_name(node) for node, _ in terms], "directions": [axis for _, axis in terms],
            "coefficients": list(terms.values())}


def _mean(name: str, mean: Mean) -> dict[str, Any]:
    """Return the mean of a case."""
    weights = list(mean.weights.values())
    return {"name": name, "reference": node_name(mean.node), "nodes": [node_name(node) for node in mean.weights],
            **({"weights": weights} if len(set(weights)) > 1 else {}),
            **({"directions": mean.directions} if len(mean.directions) < len(ALL) else {})}


def _bodies(deck: Deck, made: Document, units: Units) -> None:
    """Add rigid arms, one body for each master and coupling, and hinges to the document."""
    found: dict[tuple[str, str, bool], list[str]] = {}
    for arm in deck.arms:
        found.setdefault((arm.master, arm.directions, arm.rotations), []).append(node_name(arm.node))
    dimension = made["truss"]["dimension"]
    made["rigid"] = [
        {"name": f"R{number}", "master": node_name(master), "nodes": nodes,
         **({} if directions == "xyz" else {"directions": [axis for axis in directions if axis in "xyz"[:dimension]]}),
         **({} if rotations else {"rotations": []})}
        for number, ((master, directions, rotations), nodes) in enumerate(found.items(), start=1)]
    made["hinge"] = [
        {"name": hinge.name, "nodes": [node_name(end) for end in hinge.nodes],
         "axis": [float(part) + 0.0 for part in hinge.axis],
         **({"stiffness_N_m_per_rad": in_units(hinge.stiffness, units.force_N * units.length_m)}
            if hinge.stiffness else {})} for hinge in deck.hinges]


def _expansions(deck: Deck, made: Document, members: Sequence[Member]) -> None:
    """Give links temperature-dependent coefficients: one [[expansion]] per table and stress-free temperature."""
    names: dict[tuple[tuple[tuple[float, float], ...], float, float], str] = {}
    for bar, link in members:
        if not bar.expansion_table:
            continue
        if bar.bending:
            deck.refuse(bar.kind, "thermal_table", 0, "EXPANSION")
            continue
        key = (bar.expansion_table, bar.expansion_zero, _stress_free(deck, bar))
        if key not in names:
            names[key] = f"X{len(names) + 1}"
            made["expansion"].append(item(names[key], *key))
        link["expansion"] = names[key]
        del link["thermal_expansion_per_K"]


def _leave_impossible(deck: Deck, members: Sequence[Member], *, heated: bool, weighed: bool) -> None:
    """Omit numbers that are out of range and have no influence.

    Such numbers are expansion coefficients of an unheated truss, and densities without gravity. Some decks give 1 for
    both, others a weight instead of a mass.
    """
    for bar, link in members:
        expansion, density = link.get("thermal_expansion_per_K", 0.0), link.get("density_kg_per_m3", 0.0)
        if not heated and abs(expansion) > MOST_EXPANSION_PER_K:
            deck.leave(bar.kind, f"a thermal expansion of {expansion:g} 1/K: no temperature acts on it", 0)
            link["thermal_expansion_per_K"] = 0.0
        if not weighed and density > MOST_DENSITY_KG_PER_M3:
            deck.leave(bar.kind, f"a density of {density:g} kg/m3: no gravity acts on it; the DEM and --dynamic need "
                       "one, see --density", 0)
            del link["density_kg_per_m3"]


def _stress_free(deck: Deck, bar: Bar) -> float:
    """Return the stress-free temperature of a bar."""
    if bar.reference_temperature is not None:
        return bar.reference_temperature
    return sum(deck.initial.get(end, 0.0) for end in bar.nodes) / 2


def _ground(deck: Deck, spring: Spring, name: str, units: Units, length: float, dimension: int) -> dict[str, Any]:
    start = [in_units(value, units.length_m) for value in deck.nodes[spring.first]]
    return {"name": name, "fixed": list("xyz"[:dimension]),
            "position_m": [at + length * part for at, part in zip(start, spring.direction or ())][:dimension]}


def node_name(name: str) -> str:
    """Return the name in the case of a node of a deck: N and its number, or name of its instance and number."""
    return _called("N", name)


def _called(letter: str, name: str) -> str:
    return f"{letter}{name}" if name[0].isdecimal() else name.replace(".", "_")


def _changes(deck: Deck, given: float | None) -> list[float]:
    """Return the temperature change of every bar: mean of its ends minus the stress-free temperature."""
    found = []
    for bar in deck.bars:
        change = bar.temperature_change
        if change is None and bar.temperature is not None:
            change = bar.temperature - _stress_free(deck, bar)
        if change is None and deck.temperature:
            ends = [deck.temperature.get(end, deck.initial.get(end, 0.0)) for end in bar.nodes]
            change = sum(ends) / 2 - _stress_free(deck, bar)
        if change is None:
            change = given
        if change is None:
            raise MissingKey("--temperature-change", code="link_without_temperature", file=deck.path, link=bar.name)
        found.append(change)
    return found


def _node(deck: Deck, name: str, dimension: int, units: Units, bent: bool) -> dict[str, Any]:
    made: dict[str, Any] = {"name": node_name(name),
                            "position_m": [in_units(value, units.length_m) for value in deck.nodes[name][:dimension]]}
    made.update(supports(deck, name, dimension))
    load = [in_units(value, units.force_N) for value in deck.force.get(name, ())][:dimension]
    if any(load):
        made["force_N"] = load
    if held := [axis for axis in rotations(deck, name, bent) if dimension == 3 or axis == "z"]:
        made["fixed_rotations"] = held
    moment = deck.moment.get(name, np.zeros(3)) * (units.force_N * units.length_m)
    moment = moment + deck.weight_moment.get(name, np.zeros(3)) * (units.mass * deck.mass_scale * units.length_m**2)
    if np.any(moment):
        made["moment_N_m"] = [float(f"{value:.15g}") for value in (moment if dimension == 3 else moment[2:])]
    if deck.mass.get(name):
        made["mass_kg"] = in_units(deck.mass[name], units.mass * deck.mass_scale)
    return made


def _beam(deck: Deck, bar: Bar, change: float, peak: float, units: Units,
          density: float | None, given: Mapping[str, float]) -> dict[str, Any]:
    made = _member(deck, bar, "B", change, peak, units, density, given)
    assert bar.bending is not None
    if bar.bending.shear_modulus:
        made["shear_modulus_Pa"] = in_units(bar.bending.shear_modulus, units.stress)
    made.update(beam_keys(deck, bar, units.length_m, peak))
    return made


def _link(deck: Deck, bar: Bar, change: float, peak: float, units: Units,
          density: float | None, given: Mapping[str, float]) -> dict[str, Any]:
    return _member(deck, bar, "L", change, peak, units, density, given)


def _member(deck: Deck, bar: Bar, letter: str, change: float, peak: float, units: Units,
            density: float | None, given: Mapping[str, float]) -> dict[str, Any]:
    """Return what links and beams have in common."""
    numbers: dict[str, float] = {}
    for key, words, value, unit, why in (
            ("young_modulus_Pa", "Young's modulus", bar.young_modulus, units.stress, bar.why_no_modulus),
            ("cross_section_area_m2", "cross-section area", bar.area, units.length_m**2, bar.why_no_area)):
        if value:
            numbers[key] = in_units(value, unit)
        elif key in given:
            numbers[key] = given[key]
        else:
            raise StatejumpError(code="bar_without_property", file=deck.path, cause=why or None, kind=bar.kind,
                                 name=bar.name, property=words, option=OPTIONS[key])
    made: dict[str, Any] = {
        "name": _called(letter, bar.name),
        "nodes": [node_name(end) for end in bar.nodes],
        **numbers,
        "thermal_expansion_per_K": (given.get("thermal_expansion_per_K", 0.0) if bar.expansion is None
                                    else bar.expansion),
    }
    if bar.expansion is None and not bar.expansion_table and "thermal_expansion_per_K" not in given:
        deck.leave(bar.kind, "no thermal expansion: 0 is taken", 0)
    if bar.density:
        made["density_kg_per_m3"] = in_units(bar.density, units.mass / units.length_m**3 * deck.mass_scale)
    elif density is not None:
        made["density_kg_per_m3"] = density
    elif _weightless(deck) and bar.bending:
        made["density_kg_per_m3"] = WEIGHTLESS_KG_PER_M3
        deck.leave(bar.kind, f"no density: {WEIGHTLESS_KG_PER_M3:g} kg/m3 is taken, because other parts have a mass", 0)
    elif _weightless(deck):
        made["mass_kg"] = WEIGHTLESS_KG
        deck.leave(bar.kind, f"no density: a mass of {WEIGHTLESS_KG:g} kg is taken, because other parts have one", 0)
    else:
        deck.leave(bar.kind, "no density: the DEM and --dynamic need one, see --density", 0)
    for key in ("thermal_expansion_per_K", "density_kg_per_m3"):
        if key in made:
            made[key] *= bar.lengthened
    made["young_modulus_Pa"] /= bar.lengthened
    if bar.elongation:
        distance = np.linalg.norm(np.subtract(deck.nodes[bar.nodes[1]], deck.nodes[bar.nodes[0]]))
        made["stress_free_length_m"] = in_units(float(distance) + bar.elongation, units.length_m)
    if bar.poisson_ratio is not None and not (bar.bending and bar.bending.shear_modulus):
        made["poisson_ratio"] = bar.poisson_ratio
    if peak and change != peak:
        made["temperature_fraction"] = change / peak
    return made


def _weightless(deck: Deck) -> bool:
    """Return whether bars without density need a negligible mass: under gravity, and for modes of other masses."""
    return any(deck.gravity) or deck.modal and bool(any(deck.mass.values()) or any(bar.density for bar in deck.bars))


def in_units(value: float, unit: float) -> float:
    """Convert a number of a deck to the units of cases, rounded to the digits in the deck: 50 mm2 is 5e-05 m2."""
    return value if unit == 1 else float(f"{value * unit:.15g}")


def item(name: str, table: Sequence[tuple[float, float]], zero: float, start: float) -> dict[str, Any]:
    """Return the ``[[expansion]]`` for a table of coefficients.

    :param table: rising temperatures with secant coefficients
    :param zero: reference temperature of the secant coefficients
    :param start: stress-free temperature of the bar
    """
    temperatures, secants = (np.array(column) for column in zip(*table))
    width = JUMP * max(float(np.ptp(temperatures)), 1.0)
    low, high = min(temperatures[0], start) - BEYOND_K, max(temperatures[-1], start) + BEYOND_K
    rows = [(low, secants[0]), (temperatures[0] - width, secants[0])]
    for left, right, first, last in zip(temperatures, temperatures[1:], secants, secants[1:]):
        if right - left <= 2 * width:  # a jump of the deck itself
            continue
        slope = (last - first) / (right - left)
        # The derivative of the strain: α(T) + α'(T) (T - Tz).
        rows += [(at, first + slope * (2 * at - left - zero)) for at in (left + width, right - width)]
    rows += [(temperatures[-1] + width, secants[-1]), (high, secants[-1])]
    return {"name": name, "temperature_change_K": [float(at - start) for at, _ in rows],
            "thermal_expansion_per_K": [float(value) for _, value in rows]}
