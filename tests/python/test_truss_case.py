# SPDX-License-Identifier: GPL-3.0-or-later
"""Case files of kind truss: interpretation, messages for mistakes, generators and drawings."""
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
from failures import Failure, failing, failure
import statejump as sj
from statejump.core.errors import Range, StatejumpError
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
    """A planar truss with one item of every type. A and D are fixed; C has a slider, B and J share a joint."""
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
    """Two bars in space with a joint between them and a torsion spring about y."""
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


def refused(data: dict[str, Any]) -> StatejumpError:
    with pytest.raises(StatejumpError) as error:
        parse_case(data, Path("truss.toml"))
    assert error.value.file == "truss.toml"
    return error.value


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


MISTAKES: dict[str, tuple[Callable[[dict[str, Any]], None], str]] = {
    # values
    "out of range": (
        set_key("link", "AB", young_modulus_Pa=-1), failure("out_of_range", item="link 'AB'", key="young_modulus_Pa", value=-1, allowed=Range(0, 10000000000000.0, "Pa", above=True))),
    "out of range, with a fraction": (
        set_key("link", "AB", young_modulus_Pa=0.0), failure("out_of_range", item="link 'AB'", key="young_modulus_Pa", value=0.0, allowed=Range(0, 10000000000000.0, "Pa", above=True))),
    "not finite": (
        set_key("link", "AB", young_modulus_Pa=inf),
        failure("number_not_finite", item="link 'AB'", key="young_modulus_Pa", value=inf, allowed=Range(0, 10000000000000.0, "Pa", above=True))),
    "not a number": (
        set_key("link", "AB", young_modulus_Pa="7"),
        failure("wrong_type", item="link 'AB'", key="young_modulus_Pa", value="7", type="a number", allowed=Range(0, 10000000000000.0, "Pa", above=True))),
    "true is no number": (
        set_key("link", "AB", young_modulus_Pa=True),
        failure("wrong_type", item="link 'AB'", key="young_modulus_Pa", value=True, type="a number", allowed=Range(0, 10000000000000.0, "Pa", above=True))),
    "position that is not finite": (
        set_key("node", "B", position_m=[float("nan"), 0.0]),
        failure("number_not_finite", item="node 'B'", key="position_m", value=[float("nan"), 0.0], allowed=Range(-1000000.0, 1000000.0, "m"))),
    "position that is no list": (
        set_key("node", "B", position_m=1.0), failure("not_number_list", item="node 'B'", key="position_m", value=1.0, unit="m")),
    "three numbers in the plane": (
        set_key("node", "B", position_m=[1.0, 0.0, 0.0]),
        failure("wrong_dimension", item="node 'B'", key="position_m", value=[1.0, 0.0, 0.0], dimension=2, unit="m")),
    "force of three numbers": (
        set_key("node", "B", force_N=[1.0, 0.0, 0.0]),
        failure("wrong_dimension", item="node 'B'", key="force_N", value=[1.0, 0.0, 0.0], dimension=2, unit="N")),
    "z in the plane": (
        set_key("node", "A", fixed=["z"]), failure("planar_directions", item="node 'A'", key="fixed", value=["z"])),
    "no direction": (
        set_key("node", "A", fixed=["w"]), failure("unknown_name", item="node 'A'", key="fixed", value=["w"], allowed=("x", "y", "z"))),
    "directions that are no list": (
        set_key("node", "A", fixed="x"), failure("not_string_list", item="node 'A'", key="fixed", value="x")),
    "guide without direction": (
        set_key("node", "B", guide_normal=[0, 0]),
        failure("zero_vector", item="node 'B'", key="guide_normal", value=[0.0, 0.0])),
    "cable that is no truth": (
        set_key("spring", "K", cable=1), failure("not_boolean", item="spring 'K'", key="cable", value=1)),
    "contact": (
        set_key("revolute", "R", contact="herz"),
        failure("misspelt_name", item="revolute 'R'", key="contact", value="herz", allowed=("hertz", "rigid"), meant="hertz")),
    "dimension": (
        section("truss", dimension=4), failure("out_of_range", key="truss.dimension", value=4, allowed=Range(2, 3, "-"))),
    "locate_events": (
        section("reduced", locate_events=1), failure("not_boolean", key="reduced.locate_events", value=1)),
    # keys and sections
    "unknown key": (
        set_key("link", "AB", young_modulus=1.0), failure("misspelt_key", item="link 'AB'", key="young_modulus", meant="young_modulus_Pa")),
    "unlike any key": (
        set_key("spring", "K", qqq=1.0),
        failure("no_such_key", item="spring 'K'", key="qqq", known="name, nodes, stiffness_N_per_m, preload_N, free_length_m, cable")),
    "missing key": (
        set_key("link", "AB", young_modulus_Pa=None), failure("missing_key", item="link 'AB'", key="young_modulus_Pa", allowed=Range(0, 10000000000000.0, "Pa", above=True))),
    "missing nodes": (
        set_key("link", "AB", nodes=None), failure("missing_key", item="link 'AB'", key="nodes")),
    "missing position": (
        set_key("node", "B", position_m=None), failure("missing_key", item="node 'B'", key="position_m", allowed=Range(-1000000.0, 1000000.0, "m"))),
    "missing name": (
        set_key("link", "CJ", name=None), failure("missing_key", item="link 2", key="name")),
    "empty name": (
        set_key("link", "CJ", name=""), failure("empty_string", item="link 2", key="name", value="")),
    "no nodes": (without("node"), failure("missing_key", section="section [[node]]")),
    "one table": (
        lambda data: data.update(link=data["link"][0]), failure("not_table_list", key="link", table="link")),
    "no table": (replaced("link", 3), failure("not_table_list", key="link", value=3, table="link")),
    "unknown section": (replaced("sliders", []), failure("misspelt_key", section="section [sliders]", meant="[slider]")),
    "unknown key of a section": (section("dem", thread=1), failure("misspelt_key", key="dem.thread", meant="dem.threads")),
    "mass and density": (
        set_key("link", "AB", density_kg_per_m3=1.0),
        failure("conflicting_key", other="density_kg_per_m3", item="link 'AB'", key="mass_kg", value=1.0)),
    "preload and free length": (
        set_key("spring", "K", free_length_m=1.0), failure("conflicting_key", other="free_length_m", item="spring 'K'", key="preload_N", value=5.0)),
    # names
    "node twice": (
        add("node", {"name": "A", "position_m": [3.0, 0.0]}),
        failure("duplicate_name", item="node 6", key="name", value="A", part="node")),
    "link twice": (
        add("link", {"name": "AB", "nodes": ["A", "C"], **BAR}), failure("duplicate_name", item="link 4", key="name", value="AB", part="link")),
    "link to a missing node": (
        set_key("link", "AB", nodes=["A", "BB"]),
        failure("misspelt_reference", item="link 'AB'", key="nodes", value=["A", "BB"], name="BB", what_it_is="node", meant="B")),
    "unlike any node": (
        set_key("link", "AB", nodes=["A", "Q"]),
        failure("undefined_reference", item="link 'AB'", key="nodes", value=["A", "Q"], name="Q", what_it_is="node", known="'A', 'B', 'J', 'C', 'D'")),
    "one node": (
        set_key("link", "AB", nodes=["A"]), failure("wrong_number_of_nodes", item="link 'AB'", key="nodes", value=["A"], wanted="2 nodes")),
    "three nodes of a slider": (
        set_key("slider", "S", nodes=["A", "B", "C"]),
        failure("wrong_number_of_nodes", item="slider 'S'", key="nodes", value=["A", "B", "C"], wanted="1 node, on ground, or 2 nodes")),
    "one node twice": (
        set_key("link", "AB", nodes=["A", "A"]),
        failure("equal_nodes", item="link 'AB'", key="nodes", value=["A", "A"])),
    "missing program": (
        set_key("link", "CJ", program="shadow"),
        failure("misspelt_reference", item="link 'CJ'", key="program", value="shadow", name="shadow", what_it_is="program", meant="shade")),
    "no programs at all": (
        without("program"),
        failure("reference_without_section", item="link 'CJ'", key="program", value="shade", name="shade", what_it_is="program")),
    "missing node of the reflector": (
        section("reflector", nodes=["BB"]),
        failure("misspelt_reference", key="reflector.nodes", name="BB", what_it_is="node", meant="B")),
    "reflector without nodes": (
        section("reflector", nodes=[]), failure("no_nodes", key="reflector.nodes", value=[])),
    "axis of the reflector": (
        section("reflector", axis=[0, 0]),
        failure("reflector_axis", key="reflector.axis", value=[0.0, 0.0], dimension=2)),
    # geometry
    "link without length": (
        set_key("node", "D", position_m=[0.0, 0.0]),
        failure("coincident_nodes", item="link 'AD'", key="nodes", place_m=[0.0, 0.0], ends="'A' and 'D'", part="link")),
    "spring without length": (
        set_key("spring", "K", nodes=["B", "J"]),
        failure("coincident_nodes", item="spring 'K'", key="nodes", place_m=[1.0, 0.0], ends="'B' and 'J'", part="spring")),
    "dangling node": (
        add("node", {"name": "X", "position_m": [3.0, 0.0]}),
        failure("node_unused", node="X")),
    "no support": (
        together(*(set_key("node", name, fixed=None) for name in ("A", "C", "D")), without("slider")),
        failure("no_support")),
    "part without support": (
        together(add("node", {"name": "X", "position_m": [3.0, 0.0]}, {"name": "Y", "position_m": [4.0, 0.0]}),
                 add("link", {"name": "XY", "nodes": ["X", "Y"], **BAR})),
        failure("disconnected_truss", parts=2, one_of_each="'A', 'X'", loose_node="X")),
    # temperature
    "link without length in the cold": (
        together(set_key("link", "CJ", thermal_expansion_per_K=1e-3),
                 set_key("program", "shade", temperature_change_max_K=2000.0)),
        failure("link_without_length_of_program", item="link 'CJ'", key="thermal_expansion_per_K", value=0.001, program="shade", fraction=0.5, at_K=-1000.0)),
    "program of another length": (
        set_key("program", "shade", cycles=3),
        failure("program_duration_differs", item="program 'shade'", key="period_s", value=1.0, cycles=3, wanted_s=2.0, lasts=3.0)),
    "table that lasts otherwise than it is said": (
        set_key("program", "shade", shape="table", temperature_change_max_K=None, table_time_s=[0.0, 1.0],
                table_temperature_change_K=[0.0, 0.0], period_s=2.0),
        failure("period_beside_table", item="program 'shade'", key="period_s", value=2.0, lasts=1.0, key_to_leave_out="period_s")),
    "table without times": (
        set_key("program", "shade", shape="table", temperature_change_max_K=None),
        failure("table_times_missing", item="program 'shade'", key="table_time_s")),
    "table of one time": (
        set_key("program", "shade", shape="table", temperature_change_max_K=None, table_time_s=[0.0],
                table_temperature_change_K=[0.0]),
        failure("table_times", item="program 'shade'", key="table_time_s", value=[0.0])),
    "program without amplitude": (
        set_key("program", "shade", temperature_change_max_K=None),
        failure("missing_key", item="program 'shade'", key="temperature_change_max_K", allowed=Range(-10000, 10000, "K"))),
    "clearance closed by heat": (
        set_key("revolute", "R", journal_thermal_expansion_per_K=5e-4),
        failure("clearance_closes", item="revolute 'R'", key="radial_clearance_m", value=0.0001, outer="bearing", inner="journal", at_K=100.0)),
    "journal without radius": (
        together(set_key("revolute", "R", journal_thermal_expansion_per_K=1e-3),
                 section("thermal", temperature_change_max_K=-2000.0)),
        failure("no_radius_left", item="revolute 'R'", key="journal_thermal_expansion_per_K", value=0.001, part="journal", at_K=-2000.0)),
    "radii that come out equal": (
        set_key("revolute", "R", radial_clearance_m=1e-19),
        failure("clearance_below_precision", item="revolute 'R'", key="radial_clearance_m", value=1e-19, radius_key="journal_radius_m", radius_m=0.005)),
    # joints
    "slider along its support": (
        set_key("slider", "S", axis=[0, 1]),
        failure("held_along_axis", item="slider 'S'", key="axis", value=[0.0, 1.0], node="C")),
    "slider free across": (
        set_key("slider", "S", nodes=["B"]),
        failure("free_across_axis", item="slider 'S'", key="axis", value=[1.0, 0.0], node="B", type="a slider")),
    "slider without axis": (
        set_key("slider", "S", axis=[0, 0]),
        failure("zero_vector", item="slider 'S'", key="axis", value=[0.0, 0.0])),
    "bearing of a link that ends elsewhere": (
        set_key("revolute", "R", bearing_link="AD"),
        failure("link_not_at_node", item="revolute 'R'", key="bearing_link", value="AD", node_key="bearing_node", node_wanted="B", ends="'A' and 'D'")),
    "missing link of a joint": (
        set_key("revolute", "R", bearing_link="ABC"),
        failure("misspelt_reference", item="revolute 'R'", key="bearing_link", value="ABC", name="ABC", what_it_is="link", meant="AB")),
    "missing node of a joint": (
        set_key("revolute", "R", journal_node="JJ"),
        failure("misspelt_reference", item="revolute 'R'", key="journal_node", value="JJ", name="JJ", what_it_is="node", meant="J")),
    "bearing that nothing turns": (
        set_key("revolute", "R", bearing_link=None),
        failure("rotating_part_unsupported", item="revolute 'R'", key="bearing_link", part="bearing", node_wanted="B")),
    "journal in itself": (
        set_key("revolute", "R", journal_node="B", journal_link="AB"),
        failure("equal_nodes_of_joint", item="revolute 'R'", key="journal_node", value="B", outer="bearing_node")),
    "journal and bearing of one link": (
        together(add("link", {"name": "BJ", "nodes": ["B", "J"], **BAR}),
                 set_key("revolute", "R", bearing_link="BJ", journal_link="BJ")),
        failure("equal_links_of_joint", item="revolute 'R'", key="journal_link", value="BJ", outer="bearing_link")),
    "journal outside of its bearing": (
        set_key("node", "J", position_m=[1.0, 0.001]),
        failure("node_off_clearance", item="revolute 'R'", key="journal_node", value="J", apart_m=0.001, other="B", outer="bearing", clearance_m=0.0001)),
    "axis in the plane": (
        set_key("revolute", "R", axis=[0, 0, 1]),
        failure("planar_axis", item="revolute 'R'", key="axis", value=[0.0, 0.0, 1.0])),
    "torsion spring between links apart": (
        set_key("torsion_spring", "T", links=["AD", "CJ"]),
        failure("links_not_adjacent", item="torsion_spring 'T'", key="links", value=["AD", "CJ"])),
    "torsion spring on three links": (
        set_key("torsion_spring", "T", links=["AD", "CJ", "AB"]),
        failure("wrong_number_of_links", item="torsion_spring 'T'", key="links", value=["AD", "CJ", "AB"])),
    "torsion spring on one link twice": (
        set_key("torsion_spring", "T", links=["AB", "AB"]),
        failure("equal_links", item="torsion_spring 'T'", key="links", value=["AB", "AB"])),
    "torsion spring on a missing link": (
        set_key("torsion_spring", "T", links=["AB", "CK"]),
        failure("misspelt_reference", item="torsion_spring 'T'", key="links", value=["AB", "CK"], name="CK", what_it_is="link", meant="CJ")),
}
SPATIAL_MISTAKES: dict[str, tuple[Callable[[dict[str, Any]], None], str]] = {
    "two numbers in space": (
        set_key("node", "B", position_m=[1.0, 0.0]),
        failure("wrong_dimension", item="node 'B'", key="position_m", value=[1.0, 0.0], dimension=3, unit="m")),
    "joint without axis": (
        set_key("revolute", "R", axis=None),
        failure("axis_missing", item="revolute 'R'", key="axis")),
    "link along the axis": (
        set_key("torsion_spring", "T", axis=[1, 0, 1]),
        failure("axis_along_link", item="torsion_spring 'T'", key="axis", value=[0.7071067811865475, 0.0, 0.7071067811865475], link="AB")),
    "slider held in one direction only": (
        lambda data: data.update(slider=[{"name": "S", "nodes": ["B"], "axis": [1, 0, 0], "friction_coefficient": 0.1,
                                          "normal_force_N": 1}]),
        failure("free_across_axis", item="slider 'S'", key="axis", value=[1.0, 0.0, 0.0], node="B", type="a slider")),
}


@pytest.mark.filterwarnings("error::RuntimeWarning")  # of numpy, which would stand beside the sentence
@pytest.mark.parametrize("name", MISTAKES)
def test_mistakes_are_named(name: str) -> None:
    change, expected = MISTAKES[name]
    data = frame()
    change(data)
    assert refused(data) == expected


@pytest.mark.parametrize("name", SPATIAL_MISTAKES)
def test_spatial_mistakes_are_named(name: str) -> None:
    change, expected = SPATIAL_MISTAKES[name]
    data = spatial()
    change(data)
    assert refused(data) == expected


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
    assert truss.elements["torsion_spring"].links.tolist() == [[0, 1]]
    assert truss.reflector is not None and truss.reflector.nodes.tolist() == [1, 3]
    assert truss.reflector.axis.tolist() == [0, 1, 0]


def test_arrays_of_a_spatial_truss() -> None:
    truss = parsed(spatial()).resolve()
    assert truss.nodes.guide_normal.tolist() == [[0, 0, 0], [0, 1, 0], [0, 1, 0], [0, 0, 0]]
    assert not truss.nodes.fixed[1].any() and truss.nodes.fixed[0].all()
    # Journal and bearing may be apart along the axis.
    assert truss.revolutes.axis.tolist() == [[0, 1, 0]]
    assert truss.elements["torsion_spring"].axis.tolist() == [[0, -1, 0]]
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
    spring = truss.elements["torsion_spring"]
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
        for axis in (many.revolutes.axis[k], many.elements["torsion_spring"].axis[k], *many.nodes.guide_normal[own][2:]):
            assert axis == pytest.approx(turn @ [0, 0, 1], abs=2e-15)
    assert many.reflector is not None and [many.nodes.names[i] for i in many.reflector.nodes] == [
        f"B{k}" for k in range(1, n + 1)]


def stiffness_and_forces(truss: ResolvedTruss, temperature_change_K: float) -> tuple[np.ndarray, np.ndarray]:
    """Eigenvalues of the stiffness, and axial forces (tension positive) of the links, for a planar truss with ideal
    pins, linear about the reference configuration."""
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
    for index, pair in enumerate(truss.elements["torsion_spring"].links):
        parts = []
        for link, sign in zip(pair, (-1.0, 1.0)):
            along, length = direction(links.nodes[link])
            across = sign * np.array([-along[1], along[0]]) / length
            parts += [(links.nodes[link][0], -across), (links.nodes[link][1], across)]
        row(*parts)
        stiffness.append(truss.elements["torsion_spring"].stiffness_N_m_per_rad[index])
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
    assert refused.value == failure("rib_without_neighbour", key="cable_preload_N", value=1.0)
    assert refused.value.fields()["key"] == "cable_preload_N"


def test_makers_return_the_cases_of_the_commands() -> None:
    for kind, document in GENERATORS.items():
        make = getattr(sj.truss, kind)
        case = make(3, cycles=2, name="made")
        assert case.to_dict() == sj.load(document(3, cycles=2, name="made")).to_dict()
        assert (case.name, case.kind, case.thermal.cycles) == ("made", "truss", 2)
        assert ":param n:" in make.__doc__ and list(signature(make).parameters) == list(signature(document).parameters)
    for number, cause in ((2, failure("out_of_range", key="n", allowed=Range(3, 1000000, "-"))),
                          (3.0, failure("wrong_type", key="n", type="a whole number", allowed=Range(3, 1000000, "-")))):
        with pytest.raises(StatejumpError) as refused:
            sj.truss.ring(number)
        assert refused.value == cause.at(value=number)


def test_a_failure_names_joint_and_nodes() -> None:
    data = frame()
    set_key("slider", "S", nodes=["B"])(data)
    with pytest.raises(StatejumpError) as refused:
        parse_case(data)
    fields = refused.value.fields()
    assert (fields["item"], fields["key"], fields["value"]) == ("slider 'S'", "axis", [1.0, 0.0])
    assert (fields["joint"], fields["nodes"]) == ("S", ["B"])


def test_programs_of_equal_duration_are_those_to_rounding() -> None:
    """In floating point 3 x 0.1 s is not 0.3 s; different numbers of cycles may have the same duration."""
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
    assert (refused.status, refused.failure) == (2, failure("exists_already", file="a.toml"))
    assert (tmp_path / "a.toml").read_text() == "mine"
    assert statejump("truss", "chain", 3, "-o", "a.toml", "--force", "--cycles", 2).status == 0
    case = load_case(tmp_path / "a.toml")
    assert (case.name, case.thermal.cycles, len(case.link)) == ("a", 2, 3)
    lines = (tmp_path / "a.toml").read_text().splitlines()
    assert lines[1].partition(": ")[2].split() == ["statejump", "truss", "chain", "3", "--cycles", "2", "-o", "a.toml"]


@pytest.mark.parametrize("arguments, expected", [
    (("chain", 3, "-o", "no/a.toml"), failure("output_folder_missing", file="no/a.toml", folder=Path("no"))),
    (("mast", 2, "-o", "a.toml", "--tip-load", "nan"),
     failure("number_not_finite", file="a.toml", item="node 'L2'", key="force_N", value=[0.0, float("nan")], allowed=Range(-1000000000000.0, 1000000000000.0, "N"))),
    (("umbrella", 2, "-o", "a.toml", "--friction-coefficient", 11),
     failure("out_of_range", file="a.toml", item="revolute 'joint1'", key="friction_coefficient", value=11.0, allowed=Range(0, 10, "-"))),
])
def test_bad_options(arguments: tuple[Any, ...], expected: Failure, tmp_path: Path, statejump: Callable[..., Any]) -> None:
    outcome = statejump("truss", *arguments)
    assert (outcome.status, outcome.failure) == (2, expected)
    assert statejump("truss", "ring", 2, "-o", "a.toml").status == 2  # of the parser of options
    assert list(tmp_path.iterdir()) == []


def test_draw_into_axes_leaves_the_backend_alone() -> None:
    import matplotlib
    from matplotlib.figure import Figure

    before = matplotlib.get_backend(), "matplotlib.pyplot" in sys.modules
    flat, space = Figure().add_subplot(), Figure().add_subplot(projection="3d")
    assert sj.truss.draw(sj.truss.chain(3), flat) is flat.figure and len(flat.lines) > 0
    case = sj.truss.umbrella(3)
    assert sj.truss.draw(case, space) is space.figure and len(space.lines) > 0
    with failing("spatial_axes_needed"):
        sj.truss.draw(case, flat)
    assert (matplotlib.get_backend(), "matplotlib.pyplot" in sys.modules) == before


def test_draw_is_for_trusses(cases: Path, tmp_path: Path, statejump: Callable[..., Any]) -> None:
    path = cases / "table1.toml"
    outcome = statejump("truss", "draw", path)
    assert outcome.status == 2
    assert outcome.failure == (
        failure("command_not_for_kind", file=path, key="case.kind", value="spring_slider", kinds="'truss'", command="truss draw"))
    assert list(tmp_path.iterdir()) == []
