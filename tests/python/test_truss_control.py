# SPDX-License-Identifier: GPL-3.0-or-later
"""Control of the jump of a truss node: closed forms, design candidates, curves with extrema, invalid input."""
from __future__ import annotations

import csv
import json
from math import nan
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from failures import Failure, failure, note
import statejump as sj
from statejump.cli.control import control_command
from statejump.control.study import DesignChoices, Sweep
from statejump.core.errors import Interrupted, StatejumpError
from statejump.kinds.loading import load_case, parse_case
from statejump.kinds.spring_slider import control as control_spring_slider
from statejump.kinds.truss.control import search as searching
from statejump.kinds.truss.control.candidates import Candidate
from statejump.kinds.truss.control.search import Search

STIFFNESS = 1.26e6  # of the bar of Table 1, EA/l [N/m]


def bar_on_a_slider(cases: Path) -> sj.Case:
    """The paper's Table 1 as a truss: the bar, and its joint as a slider without stops."""
    table1 = load_case(cases / "table1.toml")
    made = sj.truss.chain(1)
    return parse_case({**made.origin.document, "slider": [
        {"name": "S1", "nodes": ["N1"], "axis": [1.0, 0.0], "normal_force_N": table1.joint.normal_force_N,
         "friction_coefficient": table1.joint.friction_coefficient}]})


@pytest.mark.parametrize("wanted_m", [1.19e-5, 1e-6, 5e-8])
def test_spring_of_a_bar_on_a_slider_is_that_of_the_spring_slider_and_of_the_closed_form(cases: Path, wanted_m) -> None:
    found = sj.truss.control(bar_on_a_slider(cases), node="N1", jump_below=wanted_m, add_spring=[("N0", "N1")])
    stiffness = found.recommendation["candidates"][0]["value"]
    other = control_spring_slider.smallest_preload(load_case(cases / "table1.toml"), wanted_m)
    # Friction 30 N leaves 30/(k + k_p). A place of 0.5 m is rounded by 1e-16 m, 2e-9 of the smallest jump here; the value
    # itself is narrowed to 1e-9, and k beside k_p makes no more of it than 1 + k/k_p.
    error = (1.1e-16 / wanted_m + searching.NARROW) * 10 * (1 + STIFFNESS / stiffness)
    assert stiffness == pytest.approx(30 / wanted_m - STIFFNESS, rel=error)
    assert stiffness == pytest.approx(other.stiffness_N_per_m, rel=error)
    assert found.recommendation["candidates"][0]["jump_with_it_m"] <= wanted_m


def test_elasticity_at_the_value_found_is_that_of_the_closed_form(cases: Path) -> None:
    found = sj.truss.control(bar_on_a_slider(cases), jump_below=1e-5, add_spring=[("N0", "N1")],
                             scale=["slider.S1.friction_coefficient", "slider.*.normal_force_N"])
    spring, *scaled = found.recommendation["candidates"]
    # d ln J/d ln k_p = -k_p/(k + k_p); a central difference of 1 % has an error of its square.
    assert spring["verdict"] == "smooth"
    assert spring["elasticity"] == pytest.approx(-spring["value"] / (STIFFNESS + spring["value"]), abs=1e-4)
    for one in scaled:
        assert one["value"] == pytest.approx(1e-5 * STIFFNESS / 30, rel=1e-7) and one["verdict"] == "smooth"
        assert one["elasticity"] == pytest.approx(1.0, abs=1e-6) and one["joints_go_as_in_the_case"]
    assert found.sentences[0] == note("smallest_change", verdict="smooth", elasticity=spring["elasticity"])


def test_best_of_several_places_is_that_of_the_softest_spring() -> None:
    chain = sj.truss.chain(3)
    slider = chain.slider[0]
    friction_N = slider.friction_coefficient * slider.normal_force_N
    link = chain.link[0]
    k = link.young_modulus_Pa * link.cross_section_area_m2 / 0.5
    places = [("N0", "N1"), ("N0", "N2"), ("N0", "N3"), ("N2", "N3")]

    def jump_m(place: tuple[str, str], stiffness: float) -> float:
        """Jump of the last node, calculated by hand: at the end of cooling all blocks slip inwards; K u = f."""
        matrix = k * np.array([[2.0, -1, 0], [-1, 2, -1], [0, -1, 1]])
        one, two = (int(name[1:]) - 1 for name in place)
        ends = np.zeros(3)
        ends[two] = 1
        if one >= 0:
            ends[one] = -1
        return float(np.linalg.solve(matrix + stiffness * np.outer(ends, ends), np.full(3, friction_N))[2])

    wanted = 0.45 * jump_m(places[0], 0.0)
    found = sj.truss.control(chain, node="N3", jump_below=wanted, add_spring=places)
    values = [one["value"] for one in found.recommendation["candidates"]]
    # No spring inside the chain or at its first block is enough: what is beyond it jumps all the same.
    assert values[0] is None and values[3] is None
    for place, value in zip(places[1:3], values[1:3]):
        assert jump_m(place, value) == pytest.approx(wanted, rel=1e-6)
    assert found.recommendation["best_spring"] == "add_spring N0 N3" and values[2] < values[1]
    assert found.sentences[0] == note("no_value_found")
    assert found.sentences[-1] == note("best_of_several", asked=4, reaching=2, parameter="add_spring N0 N3")


def test_jump_that_turns_is_said_and_both_ranges_are_found() -> None:
    # f/k up to the friction with which the block does not slip back, EA ε/(2 + ε); then it stays: ε l - (1 + ε) f/k.
    case = sj.truss.chain(1)
    friction_N = case.slider[0].friction_coefficient * case.slider[0].normal_force_N
    strain, length = 100 * case.link[0].thermal_expansion_per_K, 0.5
    found = sj.truss.control(case, jump_below=1e-4, scale=["slider.S1.friction_coefficient"])
    (_, turned), (back, _) = found.sweeps[0].meets
    assert turned == pytest.approx(1e-4 * STIFFNESS / friction_N, rel=1e-6)
    assert back == pytest.approx((strain * length - 1e-4) * STIFFNESS / (friction_N * (1 + strain)), rel=1e-6)
    assert found.sweeps[0].recommended == turned  # 0.34 times: nearer to 1 than 3.65 times
    assert not found.recommendation["candidates"][0]["monotone"]
    assert note("jump_not_monotone", parameter="scale slider.S1.friction_coefficient") in found.remarks


def made_search(jump: Any, values: tuple[float, ...]) -> Search:
    """A search along a prescribed curve of the jump, without a truss."""
    one = Candidate("scale x", "x, times", "-", 1.0, values, lambda value: value, "", "", lambda truss: truss)
    search = Search(one, Sweep("scale x", "x", "-", 1.0, 1.0, []), 0, 50)
    search.jump = lambda value: searching.Jump(jump(value), None)  # type: ignore[method-assign, arg-type]
    return search


def test_leap_across_the_bound_and_a_truss_without_path_are_met() -> None:
    def with_hole(value: float) -> float:
        if 2.0 < value < 3.0:
            raise StatejumpError("no equilibrium")
        return 3.0 if value < 3.0 else 0.5

    for curve, edge in ((lambda value: 3.0 if value < 1.7 else 0.5, 1.7), (with_hole, 3.0)):
        search = made_search(curve, (1.0, 4.0))
        search.scan(lambda share: None)
        search.narrow(1.0)
        assert search.value == pytest.approx(edge, rel=1e-8) and curve(search.value) == 0.5
    assert search.ways == {"bisection"}


def test_turns_of_a_curve_are_where_it_turns() -> None:
    search = made_search(lambda value: {1.0: 1.0, 2.0: 3.0, 3.0: 3.0, 4.0: 2.0, 5.0: nan, 6.0: 4.0}[value],
                         (1.0, 2.0, 3.0, 4.0, 5.0, 6.0))
    search.scan(lambda share: None)
    assert search.turns == [2.0, 4.0]


def test_command_writes_what_the_function_finds(cases: Path, tmp_path: Path) -> None:
    (tmp_path / "chain.toml").write_text((cases / "trusses/chain_10.toml").read_text())
    control_command.main([str(argument) for argument in (
        tmp_path / "chain.toml", "--node", "N10", "--jump-below", 1e-3, "--add-spring", "N0", "N10", "--scale",
        "link.*.cross_section_area_m2", "--results", tmp_path / "out", "--quiet")], standalone_mode=False)
    folder = next((tmp_path / "out").iterdir())
    assert {path.name for path in folder.iterdir()} >= {"control.csv", "control.json", "control.png", "control.svg"}
    summary = json.loads((folder / "control.json").read_text())
    found = sj.truss.control(sj.load(cases / "trusses/chain_10.toml"), node="N10", jump_below=1e-3,
                             add_spring=[("N0", "N10")], scale=["link.*.cross_section_area_m2"])
    assert summary["recommendation"]["candidates"] == json.loads(json.dumps(found.recommendation["candidates"]))
    rows = list(csv.DictReader((folder / "control.csv").open()))
    assert len(rows) == len(found.frame()) and {row["parameter"] for row in rows} == {
        "add_spring N0 N10", "scale link.*.cross_section_area_m2"}


def test_without_candidates_all_that_the_jump_may_follow_is_scanned() -> None:
    found = sj.truss.control(sj.truss.umbrella(1))
    assert [sweep.parameter for sweep in found.sweeps] == [
        "scale revolute.*.friction_coefficient", "scale revolute.*.radial_clearance_m",
        "scale revolute.*.journal_radius_m", "scale revolute.*.young_modulus_Pa",
        "scale link.*.young_modulus_Pa", "scale link.*.cross_section_area_m2",
        "scale torsion_spring.*.stiffness_N_m_per_rad", "scale torsion_spring.*.bias_rad"]
    assert found.wanted == found.jump / 2 > 0


def test_a_node_that_does_not_jump_has_nothing_to_control() -> None:
    found = sj.truss.control(sj.truss.chain(2), node="N0", scale=["slider.*.friction_coefficient"])
    assert found.sentences == [note("nothing_to_control")]


@pytest.mark.parametrize("given, said", [
    ({"node": "N9"}, failure("misspelt_reference", key="--node", value="N9", meant="N1", what_it_is="node", name="N9", nodes=['N9'])),
    ({"add_spring": [("N1", "N1")]}, failure("coincident_spring_nodes", key="--add-spring", value="N1 N1")),
    ({"add_spring": [("N1", "X")]}, failure("undefined_reference", key="--add-spring", value="N1 X", known="'N0', 'N1'", what_it_is="node", name="X", nodes=['X'])),
    ({"add_spring": [("N0", "N1"), ("N0", "N1")]}, failure("duplicate", key="--add-spring", value="N0 N1")),
    ({"scale": ["slider.*.friction"]}, failure("misspelt_key", key="--free", value="slider.*.friction", meant="slider.*.friction_coefficient")),
    ({"scale": ["slider.S7.friction_coefficient"]}, failure("misspelt_key", key="--free", value="slider.S7.friction_coefficient", meant="slider.S1.friction_coefficient")),
    ({"scale": ["spring.*.preload_N"]}, failure("section_not_in_case", key="--free", value="spring.*.preload_N", table="spring")),
    ({"jump_below": 0.0}, failure("not_positive", key="--jump-below", value=0.0, unit="m")),
])
def test_bad_input_is_one_sentence(given: dict[str, Any], said: Failure) -> None:
    with pytest.raises(StatejumpError) as refused:
        sj.truss.control(sj.truss.chain(1), **given)
    assert refused.value == said


def test_kinds_with_one_jump_refuse_places(cases: Path) -> None:
    case = load_case(cases / "table1.toml")
    with pytest.raises(StatejumpError) as refused:
        case.behaviour.control(case, choices=DesignChoices("A"))
    assert refused.value == failure("one_jump_only", key="--node", value="A")


def test_ctrl_c_ends_the_search() -> None:
    def interrupted(value: float) -> float:
        raise Interrupted()

    search = made_search(interrupted, (1.0, 2.0))
    with pytest.raises(Interrupted):
        search.scan(lambda share: None)
