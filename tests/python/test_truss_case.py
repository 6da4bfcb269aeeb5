# SPDX-License-Identifier: GPL-3.0-or-later
"""Case files of kind truss: what they mean, what is wrong with them, generators and drawings."""
from __future__ import annotations

import copy
import re
import sys
import tomllib
from inspect import signature
from math import inf, pi
from pathlib import Path
from typing import Any, Callable

import numpy as np
import pytest

from conftest import results_in
import statejump as sj
from statejump.core.errors import StatejumpError
from statejump.core.figures import save
from statejump.kinds.loading import load_case, parse_case
from statejump.kinds.truss.arrays import GROUND, distances
from statejump.kinds.truss.case import TrussCase
from statejump.kinds.truss.draw_symbols import COLOURS
from statejump.kinds.truss.generate import GENERATORS
from statejump.kinds.truss.generate.document import to_toml, write
from statejump.kinds.truss.resolved import ResolvedTruss

BAR = {"young_modulus_Pa": 70e9, "cross_section_area_m2": 9e-6, "thermal_expansion_per_K": 2e-5, "mass_kg": 1}
EXAMPLES = ("chain_10", "iwan_10", "mast_6", "ring_12", "umbrella_8", "umbrella_rib")


def frame() -> dict[str, Any]:
    """A planar truss with one item of every kind: A and D on ground, a slider at C, a joint B-J."""
    return copy.deepcopy({
        "case": {"name": "frame", "kind": "truss"},
        "truss": {"dimension": 2},
        "node": [
            {"name": "A", "position_m": [0.0, 0.0], "fixed": ["x", "y"]},
            {"name": "B", "position_m": [1.0, 0.0]},
            {"name": "J", "position_m": [1.0, 0.0], "force_N": [0.0, -10.0]},
            {"name": "C", "position_m": [1.0, 1.0], "fixed": ["y"]},
            {"name": "D", "position_m": [0, 1], "fixed": ["x", "y"]},
        ],
        "link": [
            {"name": "AB", "nodes": ["A", "B"], **BAR},
            {"name": "CJ", "nodes": ["C", "J"], **BAR, "temperature_fraction": 0.5, "program": "shade"},
            {"name": "AD", "nodes": ["A", "D"], **BAR, "stress_free_length_m": 1.01},
        ],
        "program": [{"name": "shade", "shape": "sine", "temperature_change_max_K": 50.0}],
        "slider": [{"name": "S", "nodes": ["C"], "axis": [2.0, 0.0], "friction_coefficient": 0.2, "normal_force_N": 10,
                    "clearance_plus_m": 1e-3}],
        "revolute": [{"name": "R", "bearing_node": "B", "journal_node": "J", "bearing_link": "AB", "journal_link": "CJ",
                      "journal_radius_m": 5e-3, "radial_clearance_m": 1e-4, "friction_coefficient": 0.15}],
        "spring": [{"name": "K", "nodes": ["B", "D"], "stiffness_N_per_m": 1e4, "preload_N": 5.0, "cable": True}],
        "torsion_spring": [{"name": "T", "links": ["AB", "CJ"], "stiffness_N_m_per_rad": 1.0}],
        "thermal": {"shape": "triangle", "temperature_change_max_K": 100.0, "cycles": 2},
        "reflector": {"nodes": ["B", "C"], "axis": [0.0, 3.0]},
    })


def spatial() -> dict[str, Any]:
    """Two spatial bars with a joint and a torsion spring about y."""
    return {
        "case": {"name": "spatial", "kind": "truss"},
        "truss": {"dimension": 3},
        "node": [
            {"name": "A", "position_m": [0.0, 0, 0], "fixed": ["x", "y", "z"]},
            {"name": "B", "position_m": [1.0, 0, 1.0], "guide_normal": [0, 5, 0]},
            {"name": "J", "position_m": [1.0, 0.5, 1.0], "guide_normal": [0, 1, 0]},
            {"name": "C", "position_m": [2.0, 0.5, 0], "fixed": ["x", "y", "z"]},
        ],
        "link": [{"name": "AB", "nodes": ["A", "B"], **BAR}, {"name": "CJ", "nodes": ["C", "J"], **BAR}],
        "revolute": [{"name": "R", "bearing_node": "B", "journal_node": "J", "bearing_link": "AB", "journal_link": "CJ",
                      "journal_radius_m": 5e-3, "radial_clearance_m": 1e-4, "friction_coefficient": 0.15,
                      "axis": [0, 2, 0]}],
        "torsion_spring": [{"name": "T", "links": ["AB", "CJ"], "stiffness_N_m_per_rad": 1.0, "axis": [0, -1, 0]}],
        "thermal": {"shape": "triangle", "temperature_change_max_K": 100.0},
    }


def parsed(data: dict[str, Any]) -> TrussCase:
    case = parse_case(data, Path("truss.toml"))
    assert isinstance(case, TrussCase)
    return case


def sentence(data: dict[str, Any]) -> str:
    with pytest.raises(StatejumpError) as error:
        parse_case(data, Path("truss.toml"))
    assert str(error.value).startswith("truss.toml: ")
    return str(error.value).removeprefix("truss.toml: ")


def item(data: dict[str, Any], section: str, name: str) -> dict[str, Any]:
    return next(table for table in data[section] if table["name"] == name)


def set_key(section: str, item_name: str, /, **values: Any) -> Callable[[dict[str, Any]], None]:
    """Change keys of an item; None removes one."""

    def change(data: dict[str, Any]) -> None:
        table = item(data, section, item_name)
        for key, value in values.items():
            if value is None:
                table.pop(key, None)
            else:
                table[key] = value

    return change


def add(section: str, *tables: dict[str, Any]) -> Callable[[dict[str, Any]], None]:
    return lambda data: data[section].extend(copy.deepcopy(tables))


def together(*changes: Callable[[dict[str, Any]], None]) -> Callable[[dict[str, Any]], None]:
    def change(data: dict[str, Any]) -> None:
        for each in changes:
            each(data)

    return change


def section(name: str, **values: Any) -> Callable[[dict[str, Any]], None]:
    return lambda data: data.setdefault(name, {}).update(values)


def replaced(name: str, value: Any) -> Callable[[dict[str, Any]], None]:
    return lambda data: data.__setitem__(name, value)


def without(name: str) -> Callable[[dict[str, Any]], None]:
    return lambda data: data.pop(name)


E_RANGE = "above 0 and at most 1e+13 [Pa]"
MISTAKES: dict[str, tuple[Callable[[dict[str, Any]], None], str]] = {
    # values
    "out of range": (
        set_key("link", "AB", young_modulus_Pa=-1), f"link 'AB': young_modulus_Pa = -1 is not allowed: must be {E_RANGE}"),
    "out of range, with a fraction": (
        set_key("link", "AB", young_modulus_Pa=0.0), f"link 'AB': young_modulus_Pa = 0.0 is not allowed: must be {E_RANGE}"),
    "not finite": (
        set_key("link", "AB", young_modulus_Pa=inf),
        f"link 'AB': young_modulus_Pa = inf is not allowed: must be finite, {E_RANGE}"),
    "not a number": (
        set_key("link", "AB", young_modulus_Pa="7"),
        f"link 'AB': young_modulus_Pa = '7' is not allowed: must be a number, {E_RANGE}"),
    "true is no number": (
        set_key("link", "AB", young_modulus_Pa=True),
        f"link 'AB': young_modulus_Pa = true is not allowed: must be a number, {E_RANGE}"),
    "position that is not finite": (
        set_key("node", "B", position_m=[float("nan"), 0.0]),
        "node 'B': position_m = [nan, 0.0] is not allowed: must be finite, between -1e+06 and 1e+06 [m]"),
    "position that is no list": (
        set_key("node", "B", position_m=1.0), "node 'B': position_m = 1.0 is not allowed: must be a list of numbers [m]"),
    "three numbers in the plane": (
        set_key("node", "B", position_m=[1.0, 0.0, 0.0]),
        "node 'B': position_m = [1.0, 0.0, 0.0] is not allowed: must be 2 numbers [m], as truss.dimension is 2"),
    "force of three numbers": (
        set_key("node", "B", force_N=[1.0, 0.0, 0.0]),
        "node 'B': force_N = [1.0, 0.0, 0.0] is not allowed: must be 2 numbers [N], as truss.dimension is 2"),
    "z in the plane": (
        set_key("node", "A", fixed=["z"]), "node 'A': fixed = ['z'] is not allowed: a planar truss has 'x' and 'y' only"),
    "no direction": (
        set_key("node", "A", fixed=["w"]), "node 'A': fixed = ['w'] is not allowed: must be 'x' or 'y' or 'z'"),
    "directions that are no list": (
        set_key("node", "A", fixed="x"), "node 'A': fixed = 'x' is not allowed: must be a list of texts in quotes"),
    "guide without direction": (
        set_key("node", "B", guide_normal=[0, 0]),
        "node 'B': guide_normal = [0.0, 0.0] is not allowed: must not be zero in every direction"),
    "cable that is no truth": (
        set_key("spring", "K", cable=1), "spring 'K': cable = 1 is not allowed: must be true or false"),
    "contact": (
        set_key("revolute", "R", contact="herz"),
        "revolute 'R': contact = 'herz' is not allowed: must be 'hertz' or 'rigid'; did you mean 'hertz'?"),
    "dimension": (
        section("truss", dimension=4), "truss.dimension = 4 is not allowed: must be between 2 and 3 [-]"),
    "locate_events": (
        section("reduced", locate_events=1), "reduced.locate_events = 1 is not allowed: must be true or false"),
    # keys and sections
    "unknown key": (
        set_key("link", "AB", young_modulus=1.0), "link 'AB': young_modulus is unknown: did you mean young_modulus_Pa?"),
    "unlike any key": (
        set_key("spring", "K", qqq=1.0),
        "spring 'K': qqq is unknown: known are name, nodes, stiffness_N_per_m, preload_N, free_length_m, cable"),
    "missing key": (
        set_key("link", "AB", young_modulus_Pa=None), f"link 'AB': young_modulus_Pa is missing: must be {E_RANGE}"),
    "missing nodes": (
        set_key("link", "AB", nodes=None), "link 'AB': nodes is missing: a list of texts in quotes is needed"),
    "missing position": (
        set_key("node", "B", position_m=None), "node 'B': position_m is missing: a list of numbers [m] is needed"),
    "missing name": (
        set_key("link", "CJ", name=None), "link 2: name is missing: a text in quotes is needed"),
    "empty name": (
        set_key("link", "CJ", name=""), "link 2: name = '' is not allowed: must be a text in quotes that is not empty"),
    "no nodes": (without("node"), "section [[node]] is missing"),
    "one table": (
        lambda data: data.update(link=data["link"][0]), "link is not allowed: must be one or more sections [[link]]"),
    "no table": (replaced("link", 3), "link = 3 is not allowed: must be one or more sections [[link]]"),
    "unknown section": (replaced("sliders", []), "section [sliders] is unknown: did you mean [slider]?"),
    "unknown key of a section": (section("dem", thread=1), "dem.thread is unknown: did you mean dem.threads?"),
    "mass and density": (
        set_key("link", "AB", density_kg_per_m3=1.0),
        "link 'AB': mass_kg = 1.0 is not allowed: only without density_kg_per_m3"),
    "preload and free length": (
        set_key("spring", "K", free_length_m=1.0), "spring 'K': preload_N = 5.0 is not allowed: only without free_length_m"),
    # names
    "node twice": (
        add("node", {"name": "A", "position_m": [3.0, 0.0]}),
        "node 6: name = 'A' is not allowed: another node has it"),
    "link twice": (
        add("link", {"name": "AB", "nodes": ["A", "C"], **BAR}), "link 4: name = 'AB' is not allowed: another link has it"),
    "link to a missing node": (
        set_key("link", "AB", nodes=["A", "BB"]),
        "link 'AB': nodes = ['A', 'BB'] is not allowed: there is no node 'BB'; did you mean 'B'?"),
    "unlike any node": (
        set_key("link", "AB", nodes=["A", "Q"]),
        "link 'AB': nodes = ['A', 'Q'] is not allowed: there is no node 'Q'; known are 'A', 'B', 'J', 'C', 'D'"),
    "one node": (
        set_key("link", "AB", nodes=["A"]), "link 'AB': nodes = ['A'] is not allowed: must be 2 nodes"),
    "three nodes of a slider": (
        set_key("slider", "S", nodes=["A", "B", "C"]),
        "slider 'S': nodes = ['A', 'B', 'C'] is not allowed: must be 1 node, on ground, or 2 nodes"),
    "one node twice": (
        set_key("link", "AB", nodes=["A", "A"]),
        "link 'AB': nodes = ['A', 'A'] is not allowed: must be two different nodes"),
    "missing program": (
        set_key("link", "CJ", program="shadow"),
        "link 'CJ': program = 'shadow' is not allowed: there is no program 'shadow'; did you mean 'shade'?"),
    "no programs at all": (
        without("program"),
        "link 'CJ': program = 'shade' is not allowed: there is no program 'shade'; the file has no section [[program]]"),
    "missing node of the reflector": (
        section("reflector", nodes=["BB"]),
        "reflector.nodes is not allowed as it is: there is no node 'BB'; did you mean 'B'?"),
    "reflector without nodes": (
        section("reflector", nodes=[]), "reflector.nodes = [] is not allowed: must be one or more nodes"),
    "axis of the reflector": (
        section("reflector", axis=[0, 0]),
        "reflector.axis = [0.0, 0.0] is not allowed: must be 2 numbers, not zero in every direction"),
    # geometry
    "link without length": (
        set_key("node", "D", position_m=[0.0, 0.0]),
        "link 'AD': nodes 'A' and 'D' are at one place, [0.0, 0.0] m: the link has no length"),
    "spring without length": (
        set_key("spring", "K", nodes=["B", "J"]),
        "spring 'K': nodes 'B' and 'J' are at one place, [1.0, 0.0] m: the spring has no length"),
    "dangling node": (
        add("node", {"name": "X", "position_m": [3.0, 0.0]}),
        "node 'X' is not allowed: no link, spring, joint or support uses it"),
    "no support": (
        together(*(set_key("node", name, fixed=None) for name in ("A", "C", "D")), without("slider")),
        "no node has a support (fixed or guide_normal): the truss moves as a whole"),
    "part without support": (
        together(add("node", {"name": "X", "position_m": [3.0, 0.0]}, {"name": "Y", "position_m": [4.0, 0.0]}),
                 add("link", {"name": "XY", "nodes": ["X", "Y"], **BAR})),
        "the truss is in 2 parts, with the nodes 'A', 'X' in one each: that of node 'X' has no support and no link, "
        "spring or joint to a part that has one"),
    # temperature
    "link without length in the cold": (
        together(set_key("link", "CJ", thermal_expansion_per_K=1e-3),
                 set_key("program", "shade", temperature_change_max_K=2000.0)),
        "link 'CJ': thermal_expansion_per_K = 0.001 is not allowed: the link has no length left at a temperature change "
        "of -1000 K, 0.5 times that of program 'shade'"),
    "program of another length": (
        set_key("program", "shade", cycles=3),
        "program 'shade': period_s = 1.0 is not allowed: 3 cycles of it last 3 s and must last 2 s, as thermal.cycles of "
        "thermal.period_s do"),
    "table that lasts otherwise than it is said": (
        set_key("program", "shade", shape="table", temperature_change_max_K=None, table_time_s=[0.0, 1.0],
                table_temperature_change_K=[0.0, 0.0], period_s=2.0),
        "program 'shade': period_s = 2.0 is not allowed: the table lasts 1 s, and its own times are the times; leave "
        "period_s out"),
    "table without times": (
        set_key("program", "shade", shape="table", temperature_change_max_K=None),
        "program 'shade': table_time_s is missing: a list of times [s] is needed for a table"),
    "table of one time": (
        set_key("program", "shade", shape="table", temperature_change_max_K=None, table_time_s=[0.0],
                table_temperature_change_K=[0.0]),
        "program 'shade': table_time_s = [0.0] is not allowed: must be at least two times [s] that start at 0 and rise"),
    "program without amplitude": (
        set_key("program", "shade", temperature_change_max_K=None),
        "program 'shade': temperature_change_max_K is missing: must be between -10000 and 10000 [K]"),
    "clearance closed by heat": (
        set_key("revolute", "R", journal_thermal_expansion_per_K=5e-4),
        "revolute 'R': radial_clearance_m = 0.0001 is not allowed: the expansion of journal and bearing closes it at a "
        "temperature change of 100 K, it must stay above 0 [m] within the program"),
    "journal without radius": (
        together(set_key("revolute", "R", journal_thermal_expansion_per_K=1e-3),
                 section("thermal", temperature_change_max_K=-2000.0)),
        "revolute 'R': journal_thermal_expansion_per_K = 0.001 is not allowed: the journal has no radius left at a "
        "temperature change of -2000 K"),
    "radii that come out equal": (
        set_key("revolute", "R", radial_clearance_m=1e-19),
        "revolute 'R': radial_clearance_m = 1e-19 is not allowed: too small beside journal_radius_m = 0.005 [m], the "
        "radii come out equal"),
    # joints
    "slider along its support": (
        set_key("slider", "S", axis=[0, 1]),
        "slider 'S': axis = [0.0, 1.0] is not allowed: the supports of node 'C' hold it along the axis"),
    "slider free across": (
        set_key("slider", "S", nodes=["B"]),
        "slider 'S': axis = [1.0, 0.0] is not allowed: node 'B' is free across the axis, a slider on ground needs "
        "supports there (fixed or guide_normal)"),
    "slider without axis": (
        set_key("slider", "S", axis=[0, 0]),
        "slider 'S': axis = [0.0, 0.0] is not allowed: must not be zero in every direction"),
    "bearing of a link that ends elsewhere": (
        set_key("revolute", "R", bearing_link="AD"),
        "revolute 'R': bearing_link = 'AD' is not allowed: that link ends at 'A' and 'D', it must end at "
        "bearing_node = 'B'"),
    "missing link of a joint": (
        set_key("revolute", "R", bearing_link="ABC"),
        "revolute 'R': bearing_link = 'ABC' is not allowed: there is no link 'ABC'; did you mean 'AB'?"),
    "missing node of a joint": (
        set_key("revolute", "R", journal_node="JJ"),
        "revolute 'R': journal_node = 'JJ' is not allowed: there is no node 'JJ'; did you mean 'J'?"),
    "bearing that nothing turns": (
        set_key("revolute", "R", bearing_link=None),
        "revolute 'R': bearing_link is missing: without a link the bearing does not turn, so node 'B' must have a support "
        "(fixed or guide_normal)"),
    "journal in itself": (
        set_key("revolute", "R", journal_node="B", journal_link="AB"),
        "revolute 'R': journal_node = 'B' is not allowed: must be another node than bearing_node"),
    "journal and bearing of one link": (
        together(add("link", {"name": "BJ", "nodes": ["B", "J"], **BAR}),
                 set_key("revolute", "R", bearing_link="BJ", journal_link="BJ")),
        "revolute 'R': journal_link = 'BJ' is not allowed: must be another link than bearing_link"),
    "journal outside of its bearing": (
        set_key("node", "J", position_m=[1.0, 0.001]),
        "revolute 'R': journal_node = 'J' is not allowed: it is 0.001 m from bearing_node = 'B', the clearance is "
        "radial_clearance_m = 0.0001 [m]"),
    "axis in the plane": (
        set_key("revolute", "R", axis=[0, 0, 1]),
        "revolute 'R': axis = [0.0, 0.0, 1.0] is not allowed: in a planar truss it is z"),
    "torsion spring between links apart": (
        set_key("torsion_spring", "T", links=["AD", "CJ"]),
        "torsion_spring 'T': links = ['AD', 'CJ'] is not allowed: the links share no place, neither a node nor a joint "
        "between their ends"),
    "torsion spring on three links": (
        set_key("torsion_spring", "T", links=["AD", "CJ", "AB"]),
        "torsion_spring 'T': links = ['AD', 'CJ', 'AB'] is not allowed: must be 2 links, or 1 against ground"),
    "torsion spring on one link twice": (
        set_key("torsion_spring", "T", links=["AB", "AB"]),
        "torsion_spring 'T': links = ['AB', 'AB'] is not allowed: must be two different links"),
    "torsion spring on a missing link": (
        set_key("torsion_spring", "T", links=["AB", "CK"]),
        "torsion_spring 'T': links = ['AB', 'CK'] is not allowed: there is no link 'CK'; did you mean 'CJ'?"),
}
SPATIAL_MISTAKES: dict[str, tuple[Callable[[dict[str, Any]], None], str]] = {
    "two numbers in space": (
        set_key("node", "B", position_m=[1.0, 0.0]),
        "node 'B': position_m = [1.0, 0.0] is not allowed: must be 3 numbers [m], as truss.dimension is 3"),
    "joint without axis": (
        set_key("revolute", "R", axis=None),
        "revolute 'R': axis is missing: a list of 3 numbers is needed in a spatial truss"),
    "link along the axis": (
        set_key("torsion_spring", "T", axis=[1, 0, 1]),
        "torsion_spring 'T': axis = [0.7071067811865475, 0.0, 0.7071067811865475] is not allowed: link 'AB' lies along it "
        "and has no angle about it"),
    "slider held in one direction only": (
        lambda data: data.update(slider=[{"name": "S", "nodes": ["B"], "axis": [1, 0, 0], "friction_coefficient": 0.1,
                                          "normal_force_N": 1}]),
        "slider 'S': axis = [1.0, 0.0, 0.0] is not allowed: node 'B' is free across the axis, a slider on ground needs "
        "supports there (fixed or guide_normal)"),
}


@pytest.mark.filterwarnings("error::RuntimeWarning")  # of numpy, which would stand beside the sentence
@pytest.mark.parametrize("name", MISTAKES)
def test_mistakes_are_named(name: str) -> None:
    change, expected = MISTAKES[name]
    data = frame()
    change(data)
    assert sentence(data) == expected


@pytest.mark.parametrize("name", SPATIAL_MISTAKES)
def test_spatial_mistakes_are_named(name: str) -> None:
    change, expected = SPATIAL_MISTAKES[name]
    data = spatial()
    change(data)
    assert sentence(data) == expected


def test_arrays_of_a_planar_truss() -> None:
    truss = parsed(frame()).resolve()
    assert truss.dimension == 2
    assert truss.nodes.names == ("A", "B", "J", "C", "D")
    assert truss.nodes.position_m.tolist() == [[0, 0, 0], [1, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]
    assert truss.nodes.fixed.tolist() == [
        [True, True, True], [False, False, True], [False, False, True], [False, True, True], [True, True, True]]
    assert truss.nodes.force_N[2].tolist() == [0, -10, 0] and not truss.nodes.force_N[[0, 1, 3, 4]].any()
    assert truss.links.nodes.tolist() == [[0, 1], [3, 2], [0, 4]]
    assert truss.links.stress_free_length_m.tolist() == [1.0, 1.0, 1.01]
    assert truss.links.temperature_fraction.tolist() == [1.0, 0.5, 1.0]
    assert truss.links.program.tolist() == [0, 1, 0]
    assert truss.program_names == ("thermal", "shade")
    # A program that does not say so takes cycles and period of the common one.
    assert [(each.shape, each.cycles, each.period_s) for each in truss.programs] == [
        ("triangle", 2, 1.0), ("sine", 2, 1.0)]
    assert truss.temperature_ranges_K.tolist() == [[0.0, 100.0], [-50.0, 50.0]]
    assert truss.sliders.nodes.tolist() == [[3, GROUND]]
    assert truss.sliders.axis.tolist() == [[1, 0, 0]]
    assert (truss.sliders.clearance_minus_m[0], truss.sliders.clearance_plus_m[0]) == (inf, 1e-3)
    assert (truss.revolutes.bearing_node[0], truss.revolutes.journal_node[0]) == (1, 2)
    assert (truss.revolutes.bearing_link[0], truss.revolutes.journal_link[0]) == (0, 1)
    assert truss.revolutes.axis.tolist() == [[0, 0, 1]] and not truss.revolutes.rigid[0]
    # One rounding of each of two operations on numbers near 1.
    assert truss.springs.free_length_m[0] == pytest.approx(2**0.5 - 5.0 / 1e4, rel=4e-16)
    assert truss.springs.cable[0]
    assert truss.torsion_springs.links.tolist() == [[0, 1]]
    assert truss.reflector is not None and truss.reflector.nodes.tolist() == [1, 3]
    assert truss.reflector.axis.tolist() == [0, 1, 0]


def test_arrays_of_a_spatial_truss() -> None:
    truss = parsed(spatial()).resolve()
    assert truss.nodes.guide_normal.tolist() == [[0, 0, 0], [0, 1, 0], [0, 1, 0], [0, 0, 0]]
    assert not truss.nodes.fixed[1].any() and truss.nodes.fixed[0].all()
    # Journal and bearing may be apart along the axis.
    assert truss.revolutes.axis.tolist() == [[0, 1, 0]]
    assert truss.torsion_springs.axis.tolist() == [[0, -1, 0]]
    assert truss.springs.names == () and truss.springs.nodes.shape == (0, 2) and truss.reflector is None


def test_mass_of_a_density_and_preload_of_a_free_length() -> None:
    data = frame()
    set_key("link", "AD", mass_kg=None, density_kg_per_m3=2700.0)(data)
    set_key("spring", "K", preload_N=None, free_length_m=1.4, cable=None)(data)
    truss = parsed(data).resolve()
    assert truss.links.mass_kg[2] == pytest.approx(2700.0 * 9e-6 * 1.01, rel=4e-16)
    # 1.41421 - 1.4 loses two digits of 2.2e-16 relative to 0.0142.
    assert truss.springs.preload_N[0] == pytest.approx(1e4 * (2**0.5 - 1.4), rel=1e-13)
    assert truss.springs.free_length_m[0] == 1.4 and not truss.springs.cable[0]


def test_parts_joined_through_ground_only_and_two_node_sliders_are_fine() -> None:
    data = frame()
    data["node"] += [{"name": "X", "position_m": [3.0, 0.0], "fixed": ["x", "y"]},
                     {"name": "Y", "position_m": [4.0, 0.0]}, {"name": "Z", "position_m": [4.0, 0.0]}]
    data["link"].append({"name": "XY", "nodes": ["X", "Y"], **BAR})
    data["slider"].append({"name": "S2", "nodes": ["Z", "Y"], "axis": [1, 1], "friction_coefficient": 0.1,
                           "normal_force_N": 0})
    truss = parsed(data).resolve()
    assert truss.sliders.nodes.tolist() == [[3, GROUND], [7, 6]]


def test_oblique_slider_is_held_by_a_guide() -> None:
    data = frame()
    set_key("node", "C", fixed=[], guide_normal=[1.0, -1.0])(data)
    set_key("slider", "S", axis=[3.0, 3.0])(data)
    assert parsed(data).resolve().nodes.guide_normal[3] == pytest.approx([0.5**0.5, -(0.5**0.5), 0], rel=4e-16)


# generator, number, nodes, links, sliders, revolutes, springs, torsion springs
COUNTS = [
    ("chain", 1, [2, 1, 1, 0, 0, 0]), ("chain", 10, [11, 10, 10, 0, 0, 0]),
    ("iwan", 1, [3, 2, 1, 0, 0, 0]), ("iwan", 10, [12, 11, 10, 0, 0, 0]),
    ("umbrella", 1, [4, 2, 0, 1, 0, 1]), ("umbrella", 8, [32, 16, 0, 8, 0, 8]),
    ("ring", 3, [10, 15, 0, 3, 0, 0]), ("ring", 12, [37, 60, 0, 12, 0, 0]),
    ("mast", 1, [5, 4, 0, 0, 0, 2]), ("mast", 6, [30, 24, 0, 10, 0, 12]),
]


@pytest.mark.parametrize("kind, n, counts", COUNTS)
def test_generators_load_again(kind: str, n: int, counts: list[int], tmp_path: Path) -> None:
    made = GENERATORS[kind](n)
    write(made, tmp_path / "made.toml", ["# a comment"])
    assert tomllib.loads(to_toml(made)) == made
    case = load_case(tmp_path / "made.toml")
    assert isinstance(case, TrussCase)
    assert [len(getattr(case, section)) for section in
            ("node", "link", "slider", "revolute", "spring", "torsion_spring")] == counts


@pytest.mark.parametrize("n", (1, 10, 1000))
def test_every_block_of_a_chain_slides_out_and_back(n: int) -> None:
    truss = parsed(GENERATORS["chain"](n)).resolve()
    limits = truss.sliders.friction_coefficient * truss.sliders.normal_force_N
    beyond = np.cumsum(limits[::-1])[::-1]  # what link i carries when all blocks beyond it slide
    links = truss.links
    free = links.young_modulus_Pa * links.cross_section_area_m2 * links.thermal_expansion_per_K * 100.0
    assert (beyond < free).all() and (2 * beyond < free).all()
    assert 2 * beyond[0] == pytest.approx(free[0] / 2, rel=n * 2.2e-16 + 1e-15)  # n roundings of a sum


def test_blocks_of_an_iwan_model_slip_one_after_another() -> None:
    n, slipped_at = 10, 0.4
    truss = parsed(GENERATORS["iwan"](n, slipped_at=slipped_at)).resolve()
    stiffness = truss.links.young_modulus_Pa * truss.links.cross_section_area_m2 / truss.links.stress_free_length_m
    limits = truss.sliders.friction_coefficient * truss.sliders.normal_force_N
    # All bars are equally stiff; roundings of three factors.
    assert stiffness[1:] == pytest.approx(np.full(n, stiffness[0] / n), rel=1e-15)
    at = limits / stiffness[1:]
    assert at == pytest.approx(at[-1] * np.arange(1, n + 1) / n, rel=1e-14)
    # Free expansion of the drive when the last slips: platform and what the drive is compressed by.
    expansion = at[-1] + limits.sum() / stiffness[0]
    assert expansion == pytest.approx(slipped_at * 23.4e-6 * 100 * 0.5, rel=1e-14)


def test_umbrella_rib_is_the_umbrella_case(cases: Path) -> None:
    rib, case = parsed(GENERATORS["umbrella"](1)), load_case(cases / "umbrella_bias.toml")
    truss = rib.resolve()
    at = dict(zip(truss.nodes.names, truss.nodes.position_m))
    assert at["A"].tolist() == [0, 0, 0] and at["C"].tolist() == [case.frame.length_m, 0, 0]
    # The generator writes 15 decimals of a metre.
    assert at["B"][:2] == pytest.approx(case.ideal_position_m, abs=1e-15)
    assert at["J"].tolist() == at["B"].tolist()
    for index, link in enumerate((case.link_ab, case.link_bc)):
        for key, value in link.to_dict().items():
            assert getattr(truss.links, key)[index] == value, key
    names, joint = truss.links.names, truss.revolutes
    assert [names[joint.bearing_link[0]], names[joint.journal_link[0]]] == ["AB", "CB"]
    assert [truss.nodes.names[node] for node in truss.links.nodes.ravel()] == ["A", "B", "C", "J"]
    for key in ("journal_radius_m", "radial_clearance_m", "friction_coefficient", "journal_thermal_expansion_per_K",
                "bearing_thermal_expansion_per_K"):
        assert getattr(joint, key)[0] == getattr(case.joint, key), key
    for link in (case.link_ab, case.link_bc):
        assert (joint.young_modulus_Pa[0], joint.poisson_ratio[0]) == (link.young_modulus_Pa, link.poisson_ratio)
    spring = truss.torsion_springs
    assert spring.stiffness_N_m_per_rad[0] == case.torsion_spring.stiffness_N_m_per_rad
    assert spring.bias_rad[0] == case.torsion_spring.bias_rad
    # The drawn angle from the first link to the second is the flare angle of the ideal position.
    ab, cb = (at[end] - at[start] for start, end in (("A", "B"), ("C", "J")))
    assert spring.links.tolist() == [[0, 1]]
    angle = np.arctan2(cb[1], cb[0]) - np.arctan2(ab[1], ab[0])
    assert angle == pytest.approx(case.flare_angle_rad, abs=1e-13)  # 1e-15 m of 0.05 m, and pi's rounding
    for key, value in case.thermal.to_dict().items():
        assert getattr(truss.programs[0], key) == value, key
    assert rib.samples_per_cycle == case.samples_per_cycle
    assert rib.dem_settings.link_damping_ratio == case.damping.axial_damping_ratio
    assert rib.dem_settings.pin_damping_N_m_s_per_rad == case.damping.pin_damping_N_m_s_per_rad
    assert case.joint.dissipation_law == "none" and rib.dem_settings.contact_damping_ratio == 0


def test_ribs_of_an_umbrella_are_turned_copies() -> None:
    n = 8
    one, many = parsed(GENERATORS["umbrella"](1)).resolve(), parsed(GENERATORS["umbrella"](n, cable_preload_N=0.5)).resolve()
    assert many.dimension == 3 and len(many.springs.names) == n and many.springs.cable.all()
    for k in range(n):
        angle = 2 * pi * k / n
        turn = np.array([[1, 0, 0], [0, np.cos(angle), -np.sin(angle)], [0, np.sin(angle), np.cos(angle)]])
        own = slice(4 * k, 4 * k + 4)
        # 15 decimals of a metre, of a unit vector.
        assert many.nodes.position_m[own] == pytest.approx(one.nodes.position_m @ turn.T, abs=2e-15)
        for axis in (many.revolutes.axis[k], many.torsion_springs.axis[k], *many.nodes.guide_normal[own][2:]):
            assert axis == pytest.approx(turn @ [0, 0, 1], abs=2e-15)
    assert many.reflector is not None and [many.nodes.names[i] for i in many.reflector.nodes] == [
        f"B{k}" for k in range(1, n + 1)]


def stiffness_and_forces(truss: ResolvedTruss, temperature_change_K: float) -> tuple[np.ndarray, np.ndarray]:
    """Eigenvalues of the stiffness and axial forces (tension positive) of the links of a planar truss whose
    joints are ideal pins, linear about the drawn shape."""
    count = len(truss.nodes.names)
    same = np.arange(count)
    same[truss.revolutes.journal_node] = truss.revolutes.bearing_node
    rows, stiffness, stress = [], [], []

    def direction(nodes: np.ndarray) -> tuple[np.ndarray, float]:
        along = (truss.nodes.position_m[nodes[1]] - truss.nodes.position_m[nodes[0]])[:2]
        return along / np.linalg.norm(along), float(np.linalg.norm(along))

    def row(*parts: tuple[int, np.ndarray]) -> None:
        made = np.zeros((count, 2))
        for node, vector in parts:
            made[same[node]] += vector
        rows.append(made.ravel())

    links, springs = truss.links, truss.springs
    for index, nodes in enumerate(links.nodes):
        along, length = direction(nodes)
        rigidity = links.young_modulus_Pa[index] * links.cross_section_area_m2[index]
        row((nodes[0], -along), (nodes[1], along))
        stiffness.append(rigidity / length)
        heated = links.thermal_expansion_per_K[index] * links.temperature_fraction[index] * temperature_change_K
        stress.append(rigidity * (length / links.stress_free_length_m[index] - 1 - heated))
    for index, nodes in enumerate(springs.nodes):
        along, _ = direction(nodes)
        row((nodes[0], -along), (nodes[1], along))
        stiffness.append(springs.stiffness_N_per_m[index])
        stress.append(springs.preload_N[index])
    for index, pair in enumerate(truss.torsion_springs.links):
        parts = []
        for link, sign in zip(pair, (-1.0, 1.0)):
            along, length = direction(links.nodes[link])
            across = sign * np.array([-along[1], along[0]]) / length
            parts += [(links.nodes[link][0], -across), (links.nodes[link][1], across)]
        row(*parts)
        stiffness.append(truss.torsion_springs.stiffness_N_m_per_rad[index])
        stress.append(0.0)
    free = (~truss.nodes.fixed[:, :2] & (same == np.arange(count))[:, None]).ravel()
    matrix = np.array(rows)[:, free]
    whole = matrix.T @ (np.array(stiffness)[:, None] * matrix)
    load = truss.nodes.force_N[:, :2].ravel()[free] - matrix.T @ np.array(stress)
    forces = np.array(stress) + np.array(stiffness) * (matrix @ np.linalg.solve(whole, load))
    return np.linalg.eigvalsh(whole), forces[: len(links.names)]


@pytest.mark.parametrize("n", (3, 4, 12, 50))
@pytest.mark.parametrize("sunlit", (True, False))
def test_ring_is_rigid_and_presses_every_joint(n: int, sunlit: bool) -> None:
    # No length of the outer links for clearances, for there are none here.
    truss = parsed(GENERATORS["ring"](n, sunlit=sunlit, radial_clearance_m=1e-12)).resolve()
    outer = [name.startswith("outer") for name in truss.links.names]
    # Every joint is between two links of the outer hoop, its own and the one before.
    names, joints = truss.links.names, truss.revolutes
    assert [(names[a], names[b]) for a, b in zip(joints.bearing_link, joints.journal_link)] == [
        (f"outer{(k - 1) % n}", f"outer{k}") for k in range(n)]
    for change in (0.0, 100.0):
        values, forces = stiffness_and_forces(truss, change)
        # A mechanism has an eigenvalue of 0, that is of rounding, 1e-16 of the largest times their number.
        assert values[0] > 1e-9 * values[-1]
        assert (forces[outer] < 0).all()
        if change == 0:
            cold = forces[outer].copy()
        else:
            assert (forces[outer] < cold / 2).all()  # hot: at least half of the preload is left in each


@pytest.mark.parametrize("n", (1, 2, 6))
def test_mast_is_rigid_and_every_half_link_carries(n: int) -> None:
    values, forces = stiffness_and_forces(parsed(GENERATORS["mast"](n)).resolve(), 0.0)
    assert values[0] > 1e-9 * values[-1]
    assert (np.abs(forces) > 1e-6).all()


def test_single_rib_has_no_cables() -> None:
    with pytest.raises(StatejumpError) as refused:
        sj.truss.umbrella(1, cable_preload_N=1.0)
    assert str(refused.value) == "cable_preload_N = 1.0 is not allowed: a single rib has no neighbour"
    assert refused.value.fields()["key"] == "cable_preload_N"


def test_makers_return_the_cases_of_the_commands() -> None:
    for kind, document in GENERATORS.items():
        make = getattr(sj.truss, kind)
        case = make(3, cycles=2, name="made")
        assert case.to_dict() == sj.load(document(3, cycles=2, name="made")).to_dict()
        assert (case.name, case.kind, case.thermal.cycles) == ("made", "truss", 2)
        assert ":param n:" in make.__doc__ and list(signature(make).parameters) == list(signature(document).parameters)
    for number, cause in ((2, "must be between 3 and 1e+06 [-]"),
                          (3.0, "must be a whole number, between 3 and 1e+06 [-]")):
        with pytest.raises(StatejumpError) as refused:
            sj.truss.ring(number)
        assert str(refused.value) == f"n = {number} is not allowed: {cause}"


def test_a_failure_names_joint_and_nodes() -> None:
    data = frame()
    set_key("slider", "S", nodes=["B"])(data)
    with pytest.raises(StatejumpError) as refused:
        parse_case(data)
    fields = refused.value.fields()
    assert (fields["item"], fields["key"], fields["value"]) == ("slider 'S'", "axis", [1.0, 0.0])
    assert (fields["joint"], fields["nodes"]) == ("S", ["B"])


def test_programs_of_equal_duration_are_those_to_rounding() -> None:
    """3 x 0.1 s is not 0.3 s in floating point; it is another number of cycles of the same duration."""
    data = frame()
    data["thermal"].update(cycles=1, period_s=0.3)
    set_key("program", "shade", cycles=3, period_s=0.1)(data)
    assert [(each.cycles, each.period_s) for each in parsed(data).programs] == [(1, 0.3), (3, 0.1)]
    found = sj.truss.chain(2, cycles=3, period_s=0.1).definition.origin.data
    found = {**found, "program": [{"name": "shade", "shape": "sine", "temperature_change_max_K": 50.0, "cycles": 1,
                                   "period_s": 0.3}]}
    found["link"][1]["program"] = "shade"
    run = sj.load(found).reduced()
    assert run.time_s[-1] == pytest.approx(0.3, rel=1e-15)


def test_table_lasts_as_long_as_its_last_time() -> None:
    data = frame()
    table = {"shape": "table", "table_time_s": [0.0, 0.5, 2.0], "table_temperature_change_K": [0.0, 10.0, 0.0]}
    data["thermal"] = {**table, "cycles": 2}
    set_key("program", "shade", cycles=1, period_s=4.0)(data)
    case = parsed(data)
    assert (case.period_s, case.duration_s, case.programs[1].period_s) == (2.0, 4.0, 4.0)
    data["thermal"] = {"shape": "triangle", "temperature_change_max_K": 1.0, "cycles": 1, "period_s": 4.0}
    data["program"] = [{"name": "shade", "cycles": 2, **table}]
    assert parsed(data).programs[1].period_s == 2.0
    assert parsed(data).resolve().programs[1].to_dict()["table_time_s"] == [0.0, 0.5, 2.0]


@pytest.mark.parametrize("kind", ("ring", "chain"))
def test_ten_thousand_joints_load(kind: str, tmp_path: Path) -> None:
    write(GENERATORS[kind](10_000), tmp_path / "large.toml", [])
    truss = load_case(tmp_path / "large.toml").resolve()
    assert len(truss.revolutes.names) + len(truss.sliders.names) == 10_000
    assert (distances(truss.nodes.position_m, truss.links.nodes) > 0).all()


@pytest.mark.parametrize("name", EXAMPLES)
def test_examples_are_made_by_the_command_in_their_header(
    name: str, cases: Path, tmp_path: Path, statejump: Callable[..., Any]
) -> None:
    text = (cases / "trusses" / f"{name}.toml").read_text()
    command = re.fullmatch(r"# Made by: statejump (.*)", text.splitlines()[1])
    assert command is not None
    made = statejump(*command[1].split())
    assert (made.status, made.errors) == (0, "")
    # The first line, where the schema is, depends on the folder.
    assert (tmp_path / f"{name}.toml").read_text().splitlines()[1:] == text.splitlines()[1:]


@pytest.mark.parametrize("name", EXAMPLES)
def test_draw(name: str, cases: Path, tmp_path: Path, statejump: Callable[..., Any]) -> None:
    outcome = statejump("truss", "draw", cases / "trusses" / f"{name}.toml")
    assert (outcome.status, outcome.errors) == (0, "")
    folder = tmp_path / "results" / name
    assert results_in(folder) == [f"{name}_truss.png", f"{name}_truss.svg"]
    assert (folder / f"{name}_truss.png").read_bytes().startswith(b"\x89PNG")


def test_draw_every_symbol_and_many_bays(tmp_path: Path) -> None:
    data = frame()
    data["slider"][0]["clearance_minus_m"] = 1e-3
    data["torsion_spring"].append({"name": "T2", "links": ["AD"], "stiffness_N_m_per_rad": 1.0})
    loaded = spatial()
    loaded["node"][1]["force_N"] = [0, 0, -1.0]
    loaded["spring"] = [{"name": "K", "nodes": ["B", "C"], "stiffness_N_per_m": 1.0}]
    for number, each in enumerate((data, loaded, GENERATORS["ring"](100), GENERATORS["chain"](100),
                                   GENERATORS["mast"](1))):
        each["case"]["name"] = f"drawn{number}"
        written = save(sj.truss.draw(sj.load(each)), tmp_path, each["case"]["name"])
        assert [path.suffix for path in written] == [".png", ".svg"] and all(path.is_file() for path in written)


def test_nothing_of_a_slender_truss_is_under_the_legend_and_hot_is_red() -> None:
    feet = {"A": [0.0, 0.0, 0.0], "B": [0.5, 0.0, 0.0], "C": [0.2, 0.4, 0.0]}
    data = {
        "case": {"name": "tripod", "kind": "truss"}, "truss": {"dimension": 3},
        "node": [*({"name": name, "position_m": place, "fixed": ["x", "y", "z"]} for name, place in feet.items()),
                 {"name": "top", "position_m": [0.2, 0.1, 6.0]}],
        "link": [{"name": name, "nodes": [name, "top"], **BAR} for name in feet],
        "thermal": {"shape": "triangle", "temperature_change_max_K": 100.0},
    }
    drawing = sj.truss.draw(sj.load(data), names=True)
    axes, legend = drawing.axes[0], drawing.legends[0]
    drawing.canvas.draw()
    renderer = drawing.canvas.get_renderer()
    assert axes.get_tightbbox(renderer).y0 >= legend.get_window_extent(renderer).y1 - 1
    assert {text.get_text() for text in axes.texts} >= {node["name"] for node in data["node"]}
    cold, hot = COLOURS([0.0, 1.0])
    assert hot[0] > 2 * hot[1:3].max() and cold[:3] @ [0.2126, 0.7152, 0.0722] > 2 * hot[:3] @ [0.2126, 0.7152, 0.0722]


def test_generators_do_not_overwrite(tmp_path: Path, statejump: Callable[..., Any]) -> None:
    (tmp_path / "a.toml").write_text("mine")
    refused = statejump("truss", "chain", 3, "-o", "a.toml")
    assert (refused.status, refused.errors) == (2, "error: a.toml: exists already; --force overwrites it\n")
    assert (tmp_path / "a.toml").read_text() == "mine"
    assert statejump("truss", "chain", 3, "-o", "a.toml", "--force", "--cycles", 2).status == 0
    case = load_case(tmp_path / "a.toml")
    assert (case.name, case.thermal.cycles, len(case.link)) == ("a", 2, 3)
    lines = (tmp_path / "a.toml").read_text().splitlines()
    assert lines[1] == "# Made by: statejump truss chain 3 --cycles 2 -o a.toml"


@pytest.mark.parametrize("arguments, expected", [
    (("ring", 2, "-o", "a.toml"), "error: Invalid value for 'N': 2 is not in the range 3<=x<=1000000.\n"),
    (("chain", 3, "-o", "no/a.toml"), "error: no/a.toml: cannot be written: there is no folder no\n"),
    (("mast", 2, "-o", "a.toml", "--tip-load", "nan"),
     "error: a.toml: node 'L2': force_N = [0.0, nan] is not allowed: must be finite, between -1e+12 and 1e+12 [N]\n"),
    (("umbrella", 2, "-o", "a.toml", "--friction-coefficient", 11),
     "error: a.toml: revolute 'joint1': friction_coefficient = 11.0 is not allowed: must be between 0 and 10 [-]\n"),
])
def test_bad_options(arguments: tuple[Any, ...], expected: str, tmp_path: Path, statejump: Callable[..., Any]) -> None:
    outcome = statejump("truss", *arguments)
    assert (outcome.status, outcome.errors) == (2, expected)
    assert list(tmp_path.iterdir()) == []


def test_draw_into_axes_leaves_the_backend_alone() -> None:
    import matplotlib
    from matplotlib.figure import Figure

    before = matplotlib.get_backend(), "matplotlib.pyplot" in sys.modules
    flat, space = Figure().add_subplot(), Figure().add_subplot(projection="3d")
    assert sj.truss.draw(sj.truss.chain(3), flat) is flat.figure and len(flat.lines) > 0
    case = sj.truss.umbrella(3)
    assert sj.truss.draw(case, space) is space.figure and len(space.lines) > 0
    with pytest.raises(StatejumpError, match="a spatial truss needs axes with projection='3d'"):
        sj.truss.draw(case, flat)
    assert (matplotlib.get_backend(), "matplotlib.pyplot" in sys.modules) == before


def test_draw_is_for_trusses(cases: Path, tmp_path: Path, statejump: Callable[..., Any]) -> None:
    path = cases / "table1.toml"
    outcome = statejump("truss", "draw", path)
    assert outcome.status == 2
    assert outcome.errors == (
        f"error: {path}: case.kind = 'spring_slider' is not allowed: 'statejump truss draw' is for 'truss'\n")
    assert list(tmp_path.iterdir()) == []
