# SPDX-License-Identifier: GPL-3.0-or-later
"""Iwan joints in cases, drawings and commands. Identification writes a section that a case accepts, and identifies the
case's loop."""
from __future__ import annotations

import re
import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from conftest import Outcome
from failures import Failure, failing, failure

import statejump as sj
from statejump.core.errors import StatejumpError
from statejump.kinds.loading import parse_case
from statejump.kinds.truss import generate, solve
from statejump.kinds.truss.contact_problems import contact_problems
from statejump.kinds.truss.generate.document import document, finished, node, to_toml

JOINT = {"tangent_stiffness_N_per_m": 2e7, "slip_force_N": 120.0, "exponent": -0.4, "stiffness_ratio": 0.7}


def bolted(change_K: float = 100.0, cycles: int = 2, **joint: Any) -> dict[str, Any]:
    """A bar that heating pushes against a bolted joint."""
    made = document("bolted", "Bar on a bolted joint", "closed form", 2, change_K, "triangle", cycles, 1.0)
    made["node"] += [node("A", (0, 0), "xy"), node("B", (0.5, 0), "y")]
    made["link"] += [{"name": "AB", "nodes": ["A", "B"], "young_modulus_Pa": 70e9, "cross_section_area_m2": 9e-6,
                      "thermal_expansion_per_K": 23.4e-6, "density_kg_per_m3": 2700.0}]
    made["iwan_joint"] = [{"name": "bolt", "nodes": ["B"], "axis": [1.0, 0.0], **JOINT, **joint}]
    return finished(made)


def loop(**joint: Any) -> tuple[np.ndarray, np.ndarray]:
    """Slide [m] and force [N] over the second cycle."""
    states = solve.path(parse_case(bolted(**joint)).resolve(), increments_per_branch=200).states
    late = states["time_s"] >= 1.0
    return states["iwan_slide_m"][late, 0], states["iwan_force_N"][late, 0]


def test_jump_and_heat_are_of_the_loop() -> None:
    found = solve.path(parse_case(bolted()).resolve())
    states = found.states
    # The bar, cold again, is stretched by the force that the joint keeps.
    rigidity_N_per_m = 70e9 * 9e-6 / 0.5
    assert states["iwan_force_N"][-1, 0] == pytest.approx(-rigidity_N_per_m * states["iwan_slide_m"][-1, 0], rel=1e-9)
    slide, force = loop()
    area = np.trapezoid(force, slide) if hasattr(np, "trapezoid") else np.trapz(force, slide)
    heat = np.diff(found.cycle_ends["iwan_joint_dissipation_J"][:, 0])[-1]
    # The loop of the second cycle closes; states at 200 points of a branch, corners of the polygon between them.
    assert heat == pytest.approx(area, rel=1e-4)
    assert abs(found.energy_residue_J) < 1e-4 * found.states["iwan_joint_dissipation_J"][-1, 0]


def test_kinks_of_the_law_do_not_divide_increments() -> None:
    # 51 elements slip one after the other in every branch.
    ends: list[str] = []
    sj.load(bolted()).reduced(trace=lambda row: ends.append(row[-1]))
    branches, increments = 4, 50
    assert ends.count("imprecise") == 0
    # Each branch has one step per increment, a short one after its corner, and steps that become longer after it.
    assert ends.count("done") <= branches * (increments + 12)


@pytest.mark.parametrize("located", [True, False])
def test_joints_in_a_row_do_not_depend_on_increments(located: bool) -> None:
    made = generate.chain(5)
    made["iwan_joint"] = [{"name": one["name"], "nodes": one["nodes"], "axis": one["axis"], **JOINT,
                           "slip_force_N": (0.5 + place) * 60.0} for place, one in enumerate(made.pop("slider"))]
    few, many = (solve.path(parse_case(made).resolve(), increments_per_branch=increments, locate_events=located)
                 for increments in (50, 171))
    jumps = [found.cycle_ends["displacement_m"][-1] for found in (few, many)]
    # Elements are exact whatever the step: what is left is rounding of displacements of 1 mm.
    assert jumps[0] == pytest.approx(jumps[1], rel=0, abs=1e-9 * np.abs(jumps[1]).max())


def test_alone_it_is_no_contact_problem() -> None:
    with failing("no_contact"):
        contact_problems(parse_case(bolted()), 3)


def test_between_two_nodes_it_holds_across_its_axis() -> None:
    made = bolted()
    made["node"].append(node("C", (0.5, 0), "xy"))
    made["node"][1] = node("B", (0.5, 0))
    made["node"][1]["force_N"] = [0.0, 5.0]
    made["iwan_joint"][0]["nodes"] = ["B", "C"]
    between, ground = (solve.path(parse_case(one).resolve()) for one in (made, bolted()))
    assert np.abs(between.states["displacement_m"][:, 1, 1]).max() < 1e-15
    assert between.states["iwan_force_N"][-1] == pytest.approx(ground.states["iwan_force_N"][-1], rel=1e-6)


def test_what_is_identified_is_a_joint_of_a_case_and_gives_its_loop_back() -> None:
    slide, force = loop()
    noise = np.random.default_rng(3).normal(0, 0.2, len(slide))
    found = sj.identify({"displacement_m": slide, "force_N": force + noise}, start="cycled", model="iwan",
                        target="iwan_joint")
    section = tomllib.loads(found.joint())["iwan_joint"][0]
    assert set(section) == set(JOINT)
    again = parse_case(bolted(**section))
    assert again.iwan_joint[0].slip_force_N == pytest.approx(JOINT["slip_force_N"], rel=0.02)
    other_slide, other_force = loop(**section)
    half = int(np.argmax(slide))
    there = np.interp(slide[: half + 1], other_slide[: np.argmax(other_slide) + 1],
                      other_force[: np.argmax(other_slide) + 1])
    assert np.abs(there - force[: half + 1]).max() < 0.02 * JOINT["slip_force_N"]
    plain = sj.identify({"displacement_m": slide, "force_N": force + noise}, start="cycled", model="coulomb",
                        target="iwan_joint")
    assert "# exponent = ?" in plain.joint()


@pytest.mark.parametrize("keys, sentence", [
    ({"exponent": -1.0}, failure("out_of_range", item="iwan_joint 'bolt'", key="exponent", value=-1.0)),
    ({"elements": 0}, failure("out_of_range", item="iwan_joint 'bolt'", key="elements", value=0)),
    ({"elements": 400}, failure("iwan_spacing", item="iwan_joint 'bolt'", key="spacing", value=1.2, elements=400, power=31.5933171730023, limit=1000000000000.0, joint="bolt")),
    ({"nodes": ["Z"]}, failure("undefined_reference", item="iwan_joint 'bolt'", key="nodes", value=["Z"], known="'A', 'B'", what_it_is="node", name="Z", joint="bolt", nodes=['Z'])),
    ({"axis": [0.0, 1.0]}, failure("held_along_axis", item="iwan_joint 'bolt'", key="axis", value=[0.0, 1.0], node="B", joint="bolt", nodes=['B'])),
])
def test_what_is_refused(keys: dict[str, Any], sentence: Failure) -> None:
    with pytest.raises(StatejumpError) as refused:
        parse_case(bolted(**keys))
    assert refused.value == sentence


def test_commands(statejump: Callable[..., Outcome], tmp_path: Path) -> None:
    case = tmp_path / "bolted.toml"
    case.write_text(to_toml(bolted()))
    for words in (("reduced",), ("truss", "draw"), ("truss", "answers")):
        done = statejump(*words, case)
        assert done.status == 0, (words, done.errors)
    joint = parse_case(bolted())
    sentence = joint.behaviour.describe(joint)[1]
    assert re.findall(r"−?\d+(?:\.\d+)?", sentence) == ["1", "20", "120", "−0.4", "0.7", "50", "0.2"]
    done = statejump("compare", case)
    assert done.status == 2 and done.errors.count("\n") == 1
    assert done.failure == failure("dem_joint", joint="bolt")
    assert statejump("reduced", "--dynamic", case).status == 0
