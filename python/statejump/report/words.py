# SPDX-License-Identifier: GPL-3.0-or-later
"""Words for what result files name by keys: columns, events, states, and a case in sentences."""
from __future__ import annotations

from typing import Any, Callable, Iterable

from statejump.core.units import text

MODELS = {"reduced": "Reduced model", "dem": "DEM (YADE)"}
STATES = {"separated": "gap", "stick": "stick", "slip": "slip", "at_stop": "at the stop"}
NAMES = {
    "joint_b": "Joint B", "link_ab": "Link AB", "link_bc": "Link BC", "floor": "Floor", "stop_plus": "Stop +",
    "stop_minus": "Stop −", "bar": "Bar", "at_stop_plus": "stop +", "at_stop_minus": "stop −",
    "theta2_jump_rad": "Jump of θ2", "theta4_jump_rad": "Jump of θ4", "theta2_jump": "Jump of θ2",
    "theta4_jump": "Jump of θ4", "young_modulus": "Young's modulus", "poisson_ratio": "Poisson's ratio",
}
COLUMNS = {
    "time_s": "Time",
    "temperature_change_K": "Temperature change",
    "displacement_m": "Displacement of the slider",
    "axial_force_N": "Axial force, compression positive",
    "normal_force_N": "Normal force",
    "theta2_rad": "Angle θ2 of AB",
    "theta4_rad": "Angle θ4 of BC",
}
EVENTS = {
    "first_contact": "first contact", "contact": "contact", "separation": "separation", "first_slip": "first slip",
    "slip": "slip", "stick": "stick", "stop_reached": "stop reached", "stop_unloaded": "stop unloaded",
    "stop_left": "stop left", "reversal": "temperature turns, sticks", "force_sign_change": "axial force changes sign",
    "cycle_end": "end of a cycle",
}
STAGES = {
    "S1": "stick, never slid yet", "S2": "slip in the sense of the first slide",
    "S3": "stick, the link unloads", "S4": "stick, the link loads the other way",
    "S5": "slip against the first slide",
    "at_stop_plus": "at the stop, + side", "at_stop_minus": "at the stop, − side",
}
SHAPES = {
    "triangle": "changes by {peak} and back in straight lines", "half_sine": "changes by {peak} and back as half a sine",
    "sine": "swings by ± {peak} as a sine", "table": "follows a table, up to {peak} from its start",
}


def plain(name: str) -> str:
    """Return a key as words, with a capital; units at its end are left off."""
    if name in NAMES:
        return NAMES[name]
    for ending in ("_m", "_rad", "_K", "_N", "_J", "_s"):
        name = name.removesuffix(ending)
    words = name.replace("_", " ").strip()
    return words[:1].upper() + words[1:]


def parameter(path: str) -> str:
    """Return a key of a case file, or a name alone, as words: ``link.young_modulus_Pa``."""
    section, _, key = path.rpartition(".")
    for ending in ("_N_m_per_rad", "_per_K", "_m2", "_Pa", "_kg", "_kg_per_m3", "_N_per_m"):
        key = key.removesuffix(ending)
    named = plain(key).replace("temperature change", "ΔT")
    return f"{named} of {plain(section).lower() if section not in NAMES else NAMES[section]}" if section else named


def inside(words: str) -> str:
    """Return words as they stand inside a sentence."""
    kept = words[:2].isupper() or words.startswith(("Young", "Poisson"))
    return words if kept else words[:1].lower() + words[1:]


def column(name: str) -> str:
    """Return what a column holds, without its unit."""
    return COLUMNS.get(name, plain(name))


def _temperature(case: dict[str, Any]) -> str:
    thermal = case.get("thermal", {})
    changes = thermal.get("table_temperature_change_K") or [thermal.get("temperature_change_max_K") or 0.0]
    peak = max(changes, key=abs)
    cycles = thermal.get("cycles", 1)
    times = "once" if cycles == 1 else f"{cycles} times"
    period = case.get("thermal", {}).get("period_s") or case.get("dem", {}).get("period_s")
    lasts = f"; a cycle lasts {text(period, 's')}" if period else ""
    way = SHAPES.get(thermal.get("shape"), "changes by up to {peak}").format(peak=text(peak, "K"))
    return f"The temperature {way}, {times}{lasts}."


def _spring_slider(case: dict[str, Any]) -> list[str]:
    link, joint = case["link"], case["joint"]
    limit = joint["friction_coefficient"] * joint["normal_force_N"]
    minus, plus = joint["clearance_minus_m"], joint["clearance_plus_m"]
    both = f"{text(minus, 'm')} and {text(plus, 'm')} away"
    stops = f"{text(plus, 'm')} away on either side" if minus == plus else both
    sentences = [
        f"A bar, {text(link['stress_free_length_m'], 'm')} long and {text(link['cross_section_area_m2'], 'm2')} in "
        f"section, is held at one end and pushes a block at the other.",
        f"The block is pressed on its floor with {text(joint['normal_force_N'], 'N')}; friction with "
        f"μ = {joint['friction_coefficient']:g} holds it up to {text(limit, 'N')}. Two stops are {stops}.",
    ]
    if joint.get("preload_stiffness_N_per_m"):
        sentences.append(f"A spring of {text(joint['preload_stiffness_N_per_m'], 'N/m')} ties the block to the ground.")
    return sentences


def _umbrella(case: dict[str, Any]) -> list[str]:
    ab, bc, joint = case["link_ab"], case["link_bc"], case["joint"]
    sentences = [
        f"One rib of an umbrella antenna: link AB, {text(ab['stress_free_length_m'], 'm')}, {ab['mass_kg']:g}\u202fkg, "
        f"and link BC, {text(bc['stress_free_length_m'], 'm')}, {bc['mass_kg']:g}\u202fkg, turn on two ideal pins A "
        f"and C, {text(case['frame']['length_m'], 'm')} apart on a frame that does not expand.",
        f"At B the journal of BC, radius {text(joint['journal_radius_m'], 'm')}, has a radial clearance of "
        f"{text(joint['radial_clearance_m'], 'm')} in the bearing of AB; friction coefficient "
        f"{joint['friction_coefficient']:g}.",
    ]
    spring = case.get("torsion_spring", {}).get("stiffness_N_m_per_rad")
    if spring:
        sentences.append(f"A torsion spring of {text(spring, 'N m/rad')} acts on the angle between the links.")
    return sentences


def _count(items: list[Any], one: str, many: str = "") -> str:
    return f"{len(items)} {one if len(items) == 1 else many or one + 's'}"


def spread(values: Iterable[float], unit: str = "-", digits: int = 4) -> str:
    """Return the one value of many items, or from where to where their values go."""
    known = [float(value) for value in values]
    low, high = min(known), max(known)
    return text(low, unit, digits) if low == high else f"{text(low, unit, digits)} to {text(high, unit, digits)}"


def is_held(node: dict[str, Any], case: dict[str, Any]) -> bool:
    """Whether a node of a truss cannot move at all."""
    return len(set(node.get("fixed") or [])) == case["truss"]["dimension"]


def is_guided(node: dict[str, Any], case: dict[str, Any]) -> bool:
    """Whether a node of a truss can move in some directions only."""
    return bool(node.get("fixed") or node.get("guide_normal")) and not is_held(node, case)


def _truss(case: dict[str, Any]) -> list[str]:
    of = {key: case.get(key) or [] for key in ("node", "link", "slider", "revolute", "spring", "torsion_spring", "program")}
    kind = {2: "plane", 3: "spatial"}[case["truss"]["dimension"]]
    held = [node for node in of["node"] if is_held(node, case)]
    guided = [node for node in of["node"] if is_guided(node, case)]
    sentences = [
        f"A {kind} truss of {_count(of['node'], 'node')} and {_count(of['link'], 'link')}; {_count(held, 'node')} "
        f"{'is' if len(held) == 1 else 'are'} held" + (f", {len(guided)} guided" if guided else "") + "."
    ]
    if of["revolute"]:
        sentences.append(
            f"{_count(of['revolute'], 'revolute joint')} with clearance: radial clearance "
            f"{spread((joint['radial_clearance_m'] for joint in of['revolute']), 'm')}, journal radius "
            f"{spread((joint['journal_radius_m'] for joint in of['revolute']), 'm')}, friction coefficient "
            f"{spread(joint['friction_coefficient'] for joint in of['revolute'])}."
        )
    if of["slider"]:
        stops = sum(joint.get(key) is not None for joint in of["slider"] for key in ("clearance_minus_m", "clearance_plus_m"))
        limits = (joint["friction_coefficient"] * joint["normal_force_N"] for joint in of["slider"])
        sentences.append(f"{_count(of['slider'], 'sliding joint')} held by friction up to {spread(limits, 'N')}, "
                         f"{f'with {stops} stops' if stops else 'without stops'}.")
    if (case.get("reduced") or {}).get("sticking") == "elastic":
        sentences.append("Joints of the reduced model stick elastically, as those of the DEM.")
    cables = [spring for spring in of["spring"] if spring.get("cable")]
    springs = [spring for spring in of["spring"] if not spring.get("cable")]
    tied = [_count(found, name) for found, name in ((springs, "spring"), (cables, "cable"),
                                                   (of["torsion_spring"], "torsion spring")) if found]
    if tied:
        sentences.append(f"It has {' and '.join(filter(None, [', '.join(tied[:-1]), tied[-1]]))}.")
    loads = [sum(part**2 for part in node["force_N"]) ** 0.5 for node in of["node"] if node.get("force_N")]
    if any(loads):
        sentences.append(f"Dead loads of {spread(loads, 'N')} on {_count(loads, 'node')}.")
    shares = [link["temperature_fraction"] for link in of["link"]]
    if set(shares) != {1.0}:
        sentences.append(f"Links are shaded: they take {spread(shares, digits=3)} of the temperature change.")
    if of["program"]:
        sentences.append(f"{_count(of['program'], 'further temperature program')} for members that name one.")
    return sentences


DESCRIPTIONS: dict[str, Callable[[dict[str, Any]], list[str]]] = {
    "spring_slider": _spring_slider, "umbrella": _umbrella, "truss": _truss,
}


def describe(kind: str, case: dict[str, Any]) -> list[str]:
    """Return a case in sentences.

    :param case: sections and keys as in the case file, with all defaults
    """
    told = DESCRIPTIONS.get(kind) if case else None
    return [*(told(case) if told else []), _temperature(case)]
