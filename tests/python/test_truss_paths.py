# SPDX-License-Identifier: GPL-3.0-or-later
"""Structures of practice: free expansion, sheets that walk, loads beyond friction, slack elements."""
from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from failures import note
from statejump.core.errors import StatejumpError
from statejump.kinds.loading import parse_case
from statejump.kinds.truss import result, solve

EPSILON = np.finfo(float).eps
STIFFNESS = {"young_modulus_Pa": 70e9, "cross_section_area_m2": 1e-5, "thermal_expansion_per_K": 2e-5}
TRIANGLE = {"shape": "triangle", "temperature_change_max_K": 100.0, "period_s": 1.0}


def case(nodes: list[dict[str, Any]], links: list[dict[str, Any]], thermal: dict[str, Any] | None = None,
         **sections: Any) -> dict[str, Any]:
    dimension = len(nodes[0]["position_m"])
    return {"case": {"name": "ordinary", "kind": "truss"}, "truss": {"dimension": dimension}, "node": nodes,
            "link": links, "thermal": thermal or TRIANGLE, **sections}


def path(document: dict[str, Any], **options: Any) -> solve.TrussPath:
    return solve.path(parse_case(document).resolve(), **options)


def failed(document: dict[str, Any]) -> StatejumpError:
    with pytest.raises(StatejumpError) as caught:
        path(document)
    return caught.value


def bays(count: int, diagonals: int, dimension: int) -> dict[str, Any]:
    """Square bays in a row on two supports: statically determinate with one diagonal per bay, not with two. In space
    there are three rows of nodes."""
    rows = [(0.0, 0.0), (0.0, 1.0)] if dimension == 2 else [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)]
    fixed = [["x", "y"], ["x"]] if dimension == 2 else [["x", "y", "z"], ["x", "z"], ["x"]]
    nodes, links = [], []

    def join(first: tuple[int, int], second: tuple[int, int]) -> None:
        names = [f"N{bay}_{row}" for bay, row in (first, second)]
        links.append({"name": "-".join(names), "nodes": names, **STIFFNESS})

    for bay in range(count + 1):
        for row, place in enumerate(rows):
            position = [float(bay), *(place[1:] if dimension == 2 else place)]
            nodes.append({"name": f"N{bay}_{row}", "position_m": position} | ({"fixed": fixed[row]} if not bay else {}))
        for row in range(len(rows) if dimension == 3 else 1):
            other = (row + 1) % len(rows)
            join((bay, row), (bay, other))
            if bay:
                join((bay - 1, row), (bay, other))
                if diagonals == 2:
                    join((bay - 1, other), (bay, row))
        for row in range(len(rows)):
            if bay:
                join((bay - 1, row), (bay, row))
    return case(nodes, links)


PROGRAMS = [
    TRIANGLE, {"shape": "half_sine", "temperature_change_max_K": -150.0, "period_s": 5400.0, "cycles": 2},
    {"shape": "table", "table_time_s": [0.0, 1.0, 2.0, 3.0, 4.0], "table_temperature_change_K": [0.0, 0.0, 80.0, 80.0, 0.0]},
    {"shape": "table", "table_time_s": [0.0, 1.0], "table_temperature_change_K": [0.0, 0.0]},
]


@pytest.mark.parametrize("thermal", PROGRAMS)
@pytest.mark.parametrize("dimension", [2, 3])
@pytest.mark.parametrize("diagonals", [1, 2])
@pytest.mark.parametrize("count", [1, 2, 7, 40])
def test_free_truss_expands_freely(count: int, diagonals: int, dimension: int, thermal: dict[str, Any]) -> None:
    """Every node moves by alpha dT times its position, without forces and without a jump."""
    found = path(bays(count, diagonals, dimension) | {"thermal": thermal})
    states, position = found.states, found.truss.nodes.position_m
    strain = 2e-5 * states["temperature_change_K"]
    # Nodes balance to rounding of the displacements, 64 eps u, times the stiffness. A row of bays adds it up to moments,
    # which chords carry by the square of their number, and bends under them by the cube: of both chords.
    rounding_m = 64 * EPSILON * max(np.abs(strain).max() * count, EPSILON)
    assert np.abs(states["axial_force_N"]).max() <= 7e5 * rounding_m * (count + 1) ** 2
    off_m = np.abs(states["displacement_m"] - strain[:, None, None] * position).max()
    assert off_m <= 2 * rounding_m * (count + 1) ** 3
    assert found.complete and len(found.events) == 0


def test_free_truss_with_a_slider_that_never_slips_returns() -> None:
    document = bays(3, 2, 2)
    document["slider"] = [{"name": "foot", "nodes": ["N0_0"], "axis": [1.0, 0.0], "friction_coefficient": 0.3,
                           "normal_force_N": 50.0}]
    document["node"][0]["fixed"] = ["y"]
    found = path(document)
    assert np.abs(found.cycle_ends["displacement_m"]).max() < 1e-15 and found.solves < 300


def sheet(blocks: int, friction: float, slope: float, change_K: float = 40.0) -> dict[str, Any]:
    """A row of blocks down an incline; each block carries its part of the weight."""
    weight_N, length_m = 900.0, 6.0
    each = weight_N / blocks
    nodes = [{"name": f"B{i}", "position_m": [length_m * (i + 0.5) / blocks, 0.0], "fixed": ["y"],
              "force_N": [each * np.sin(slope), 0.0]} for i in range(blocks)]
    links = [{"name": f"L{i}", "nodes": [f"B{i}", f"B{i + 1}"], "young_modulus_Pa": 1.6e10, "cross_section_area_m2": 2.4e-3,
              "thermal_expansion_per_K": 2.9e-5} for i in range(blocks - 1)]
    sliders = [{"name": f"S{i}", "nodes": [f"B{i}"], "axis": [1.0, 0.0], "friction_coefficient": friction,
                "normal_force_N": each * np.cos(slope)} for i in range(blocks)]
    thermal = {"shape": "triangle", "temperature_change_max_K": change_K, "period_s": 1.0, "cycles": 3}
    return case(nodes, links, thermal, slider=sliders)


@pytest.mark.parametrize("friction", [0.2, 0.342, 0.45, 0.6])
@pytest.mark.parametrize("blocks", [4, 5, 9, 16, 33, 60])
def test_sheet_walks_down_by_the_closed_form(blocks: int, friction: float) -> None:
    """A sheet of length L and weight w per length on a slope b walks (L tan b / mu)(a dT - (mu cos b - sin b) w L / EA)
    in a cycle. Its two neutral points are L tan b / mu apart; with discrete blocks each is up to half a block away."""
    slope = 0.15
    found = path(sheet(blocks, friction, slope))
    ends = found.cycle_ends["displacement_m"][:, :, 0]
    walked = (ends[3] - ends[2]).mean()
    span = np.tan(slope) / friction
    compressed = (friction * np.cos(slope) - np.sin(slope)) * 900.0 / (1.6e10 * 2.4e-3)
    expected = 6.0 * span * (2.9e-5 * 40.0 - compressed)
    assert walked == pytest.approx(expected, abs=6.0 * 2.9e-5 * 40.0 / blocks)


def frame_on_foot(side_N: float, clearance_m: float | None = None) -> dict[str, Any]:
    """A bar held only by the friction of its foot, at most 24 N."""
    nodes = [{"name": "P", "position_m": [0.0, 0.0], "fixed": ["y"]},
             {"name": "Q", "position_m": [1.0, 0.0], "fixed": ["y"], "force_N": [side_N, 0.0]}]
    foot = {"name": "foot", "nodes": ["P"], "axis": [1.0, 0.0], "friction_coefficient": 0.3, "normal_force_N": 80.0}
    if clearance_m is not None:
        foot |= {"clearance_plus_m": clearance_m, "clearance_minus_m": clearance_m}
    return case(nodes, [{"name": "b", "nodes": ["P", "Q"], **STIFFNESS}], slider=[foot])


def test_load_beyond_friction_names_the_joint_and_what_it_holds() -> None:
    found = failed(frame_on_foot(96.0))
    assert (found.code, found.joint) == ("overloaded", "foot") and 0 < found.details["load_fraction"] < 1
    assert found.numbers["load_fraction"] == pytest.approx(0.25, rel=1e-3)


@pytest.mark.parametrize("clearance_m", [1e-5, 2e-3])
def test_load_beyond_friction_moves_the_foot_to_its_stop(clearance_m: float) -> None:
    found = path(frame_on_foot(96.0, clearance_m))
    assert found.cycle_ends["displacement_m"][0, 0, 0] == pytest.approx(clearance_m, rel=1e-9)
    assert jump_m(found) == pytest.approx(0, abs=1e-13 * 2e-3)


def jump_m(found: solve.TrussPath) -> float:
    ends = found.cycle_ends["displacement_m"]
    return float(np.linalg.norm(ends[-1] - ends[0], axis=1).max())


@pytest.mark.parametrize("load_N", [0.3, 3.0, 30.0])
def test_load_across_springs_in_line_finds_its_equilibrium(load_N: float) -> None:
    """Two collinear springs have no transverse stiffness in the reference configuration. The sag d follows from 2 k (1
    - l0 / hypot(l0, d)) d = F."""
    stiffness, length = 400.0, 0.5
    nodes = [{"name": "A", "position_m": [0.0, 0.0], "fixed": ["x", "y"]},
             {"name": "M", "position_m": [length, 0.0], "force_N": [0.0, -load_N]},
             {"name": "B", "position_m": [2 * length, 0.0], "fixed": ["x", "y"]}]
    springs = [{"name": f"K{i}", "nodes": ends, "stiffness_N_per_m": stiffness, "free_length_m": length}
               for i, ends in enumerate((["A", "M"], ["M", "B"]))]
    bar = [{"name": "bar", "nodes": ["A", "B"], **STIFFNESS}]
    found = path(case(nodes, bar, spring=springs))
    sag = -found.cycle_ends["displacement_m"][0, 1, 1]
    assert 2 * stiffness * (1 - length / np.hypot(length, sag)) * sag == pytest.approx(load_N, rel=1e-9)
    # Far from the reference configuration: that is reported.
    assert [note["kind"] for note in found.notes] == ([] if sag < 0.05 else ["large_start"])


def test_hinge_that_cannot_turn_is_noted_once() -> None:
    """The angles of a triangle on rollers change only by strain: the hinge sticks whatever its friction moment."""
    nodes = [{"name": "A", "position_m": [0.0, 0.0], "fixed": ["x", "y"]},
             {"name": "B", "position_m": [1.0, 0.0], "fixed": ["y"]}, {"name": "C", "position_m": [2.0, 0.0], "fixed": ["y"]}]
    links = [{"name": "ab", "nodes": ["A", "B"], **STIFFNESS}, {"name": "bc", "nodes": ["B", "C"], **STIFFNESS}]
    latch = {"name": "latch", "links": ["ab", "bc"], "deadband_rad": 0.0, "stiffness_N_m_per_rad": 50.0, "friction_moment_N_m": 1.0}
    document = case(nodes, links, latch_hinge=[latch]) | {"reduced": {"sticking": "rigid"}}
    found = path(document)
    assert [(note["kind"], note["joints"]) for note in found.notes] == [("not_unique", [("latch_hinge", "latch")])]
    assert jump_m(found) < 1e-15


def panel(load_N: float) -> dict[str, Any]:
    """A square with both diagonals, one of which has play: it carries no force before its clearance closes."""
    corners = {"A": [0.0, 0.0], "B": [1.0, 0.0], "C": [1.0, 1.0], "D": [0.0, 1.0], "J": [1.0, 1.0]}
    fixed = {"A": ["x", "y"], "D": ["x"]}
    nodes = [{"name": name, "position_m": place} | ({"fixed": fixed[name]} if name in fixed else {})
             for name, place in corners.items()]
    nodes[2]["force_N"] = [0.0, -load_N]
    bars = ["AB", "BC", "CD", "DA", "DB", "AJ"]
    links = [{"name": bar, "nodes": [bar[0], bar[1]], **STIFFNESS} for bar in bars]
    links[0]["thermal_expansion_per_K"] = 4e-5
    pin = {"name": "pin", "journal_node": "J", "bearing_node": "C", "journal_link": "AJ", "bearing_link": "BC", "journal_radius_m": 5e-3,
           "radial_clearance_m": 2e-4, "friction_coefficient": 0.2}
    return case(nodes, links, revolute=[pin])


@pytest.mark.parametrize("load_N", [0.0, 5.0])
def test_slack_diagonal_is_noted_and_the_rest_is_as_without_it(load_N: float) -> None:
    found = path(panel(load_N))
    assert [(note["kind"], note["joints"]) for note in found.notes] == [("slack", [("revolute", "pin")])]
    without = panel(load_N)
    without["node"] = without["node"][:4]
    without["link"] = without["link"][:5]
    del without["revolute"]
    bare = path(without)
    open_states = found.states["revolute_status"][:, 0] == 5
    reached = np.argmin(open_states) if not open_states.all() else len(open_states)
    times = found.states["time_s"][:reached]
    for node in range(4):
        for axis in range(2):
            expected = np.interp(times, bare.states["time_s"], bare.states["displacement_m"][:, node, axis])
            assert found.states["displacement_m"][:reached, node, axis] == pytest.approx(expected, abs=1e-9 * 4e-3)
    play = np.linalg.norm(found.states["eccentricity_m"][:, 0], axis=1)
    assert play.max() <= 2e-4 * 1.05  # the contact gives by its Hertz depth


def test_notes_become_warnings_of_a_run() -> None:
    run = result.reduced_run(parsed := parse_case(panel(0.0)), solve.solve(parsed), result.sample_times(parsed))
    assert note("slack", joints=(("revolute", "pin"),), temperature_change_K=0.0) in run.warnings
