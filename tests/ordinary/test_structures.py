# SPDX-License-Identifier: GPL-3.0-or-later
"""A structure depends only on family and seed; the oracle (theory) agrees with hand calculations."""
from __future__ import annotations

import json
import random
from typing import Any

import numpy as np
import pytest

import evolution
import statejump as sj
import structures
from oracle import judge
from planar import bracket
from sketch import Document, Sketch

MODULUS = {"young_modulus_Pa": 70e9, "cross_section_area_m2": 1e-4, "thermal_expansion_per_K": 23.4e-6}
HEAT: Document = {"shape": "triangle", "temperature_change_max_K": 100.0, "cycles": 1, "period_s": 1.0}


def finished(made: Sketch) -> Document:
    return made.document("one", "", HEAT, [])


def block(load_N: float, limit_N: float, bar: bool = False, **stops: float) -> Document:
    """A block on a rail, pushed by a load; a bar may hold it."""
    made = Sketch(2)
    made.node("G", 0, 0, fixed="xy")
    made.node("P", 1, 0, fixed="y")
    made.node("Q", 2, 0, fixed="y")
    made.bar("P", "Q", **MODULUS)
    if bar:
        made.bar("G", "P", **MODULUS)
    made.forces["Q"] = np.array([load_N, 0.0])
    made.add("slider", "foot", nodes=["P"], axis=[1.0, 0.0], friction_coefficient=0.5, normal_force_N=2 * limit_N,
             **stops)
    return finished(made)


def test_a_structure_follows_from_its_family_and_seed() -> None:
    chosen = structures.sample(60, 5)
    first = {one: json.dumps(structures.make(*one).document) for one in chosen}
    random.Random(1).shuffle(chosen)
    np.random.default_rng(3).random(10)
    assert all(json.dumps(structures.make(*one).document) == first[one] for one in chosen)
    assert len(set(first.values())) == len(first)


def test_a_campaign_has_every_family_joint_load_and_program() -> None:
    made = [structures.make(*one) for one in structures.sample(400, 1)]
    assert {one.family for one in made} == set(structures.FAMILIES)
    assert {"none", "small", "gravity", "tip", "preload"} <= {one.loaded for one in made}
    for section in ("slider", "iwan_joint", "revolute", "ball_joint", "latch_hinge", "torsion_spring", "program"):
        assert any(section in one.document for one in made), section
    assert {one.document["thermal"]["shape"] for one in made} == {"triangle", "half_sine", "sine", "table"}
    assert max(one.joints for one in made) <= 200


@pytest.mark.parametrize(("document", "kind", "class_a"), [
    (block(50.0, 10.0), "overloaded", False),
    (block(10.1, 10.0), "undetermined", False),
    (block(50.0, 60.0), "path", False),
    (block(50.0, 10.0, bar=True), "path", True),
])
def test_friction_holds_what_it_can(document: Document, kind: str, class_a: bool) -> None:
    found = judge(document)
    assert (found.kind, found.class_a) == (kind, class_a)
    if not class_a:
        limit = document["slider"][0]["normal_force_N"] / 2
        assert found.load_factor == pytest.approx(limit / document["node"][2]["force_N"][0], rel=1e-6)


def test_a_stop_carries_what_friction_does_not() -> None:
    stops = {"clearance_minus_m": 1e-3, "clearance_plus_m": 1e-3}
    assert judge(block(50.0, 10.0, **stops)).kind == "path"


def arch(height_m: float, load_N: float) -> Document:
    """Two bars that lean against each other."""
    made = Sketch(2)
    made.node("A", -1, 0, fixed="xy")
    made.node("B", 1, 0, fixed="xy")
    made.node("T", 0, height_m)
    made.bar("A", "T", **MODULUS)
    made.bar("B", "T", **MODULUS)
    made.forces["T"] = np.array([0.0, -load_N])
    return finished(made)


def test_stability_is_that_of_the_loaded_structure() -> None:
    assert judge(arch(0.5, 100.0)).kind == "path"
    assert judge(arch(0.0, 0.0)).kind == "mechanism"
    # A flat arch snaps through at E A h³ · 2/(3 √3) = 2.7 N.
    assert judge(arch(1e-2, 2.0)).kind == "path"
    assert judge(arch(1e-2, 3.5)).kind == "unstable"
    assert judge(arch(1e-2, 400.0)).kind == "unstable"


@pytest.mark.parametrize(("rise_m", "kind"), [(0.02, "undetermined"), (0.2, "path")])
def test_heat_flattens_a_shallow_arch(rise_m: float, kind: str) -> None:
    made = Sketch(2)
    made.node("A", -1, 0, fixed="xy")
    made.node("tip", 0, rise_m)
    made.node("B", 1, 0, fixed="xy")
    for foot in "AB":  # shrinks by 2.3e-3; the bars of the shallow arch are 2e-4 longer than its chord
        made.bar(foot, "tip", **{**MODULUS, "thermal_expansion_per_K": -23.4e-6})
    verdict = judge(finished(made))
    assert (verdict.kind, verdict.class_a) == (kind, kind == "path")


def test_a_bar_with_play_beside_others_is_slack() -> None:
    def panel(load_N: float, legs: int) -> Document:
        made = bracket(np.random.default_rng(1), 3)
        made.bars.clear()
        made.points = {"tip": np.array([1.0, 0.0])}
        made.fixed = {}
        for k in range(legs):
            made.node(f"W{k}", 0, 0.4 * (k - (legs - 1) / 2), fixed="xy")
            made.bar(f"W{k}", "tip", "leg", **MODULUS)
        made.forces["tip"] = np.array([load_N, 0.0])
        made.detach("leg_W0_tip", 1)
        made.add("revolute", "pin", bearing_node="tip", journal_node="tip_of_leg_W0_tip", bearing_link="leg_W1_tip",
                 journal_link="leg_W0_tip", journal_radius_m=5e-3, radial_clearance_m=1e-5, friction_coefficient=0.1)
        return finished(made)

    assert judge(panel(10.0, 3)).slack
    assert not judge(panel(10.0, 2)).slack
    # 1000 N elongate the other two legs by 7e-5 m, seven clearances.
    assert not judge(panel(1000.0, 3)).slack
    assert judge(panel(0.0, 2)).slack


def chain_jump_m(limit_N: float) -> tuple[float, float]:
    """Return jumps of a bar that slides on one pad and is held at its other end by a second bar."""
    made = Sketch(2)
    made.node("A", 0, 0, fixed="xy")
    made.node("P", 1, 0, fixed="y")
    made.node("B", 3, 0, fixed="xy")
    made.bar("A", "P", **MODULUS)
    made.bar("P", "B", **{**MODULUS, "thermal_expansion_per_K": 0.0})
    made.add("slider", "pad", nodes=["P"], axis=[1.0, 0.0], friction_coefficient=0.5, normal_force_N=2 * limit_N)
    found = evolution.ends(finished(made))
    # Stiffness 1.5 E A, thrust E A α ΔT. Friction resists the return with 2 F, so F remains.
    stiffness, thrust = 1.5 * 7e6, 7e6 * 23.4e-6 * 100.0
    slid = max(thrust - limit_N, 0.0) - max(thrust - 2 * limit_N, 0.0)
    return float(found[-1][2] - found[0][2]), slid / stiffness


@pytest.mark.parametrize("share", [0.2, 0.6, 1.5])
def test_an_evolution_ends_where_friction_leaves_it(share: float) -> None:
    found, expected = chain_jump_m(share * 7e6 * 23.4e-6 * 100.0)
    # 24 increments per quarter of a cycle: slip within an increment is exact if it does not reverse.
    assert found == pytest.approx(expected, rel=1e-9, abs=1e-15)


def test_walking_sheets_have_one_block_of_tolerance() -> None:
    one: Any = structures.make("walking", 3)
    assert one.walk_m is not None and one.walk_m > 0
    assert judge(one.document).kind == "path"


@pytest.mark.parametrize("seed", [1016, 1022, 1059])
def test_bars_that_bend_at_a_hinge_keep_it_between_them(seed: int) -> None:
    """A joint separates at most one of the bars at a scissor's hinge, because a torsion spring needs a common node."""
    made = structures.make("scissor", seed).document
    ends = {link["name"]: set(link["nodes"]) for link in made["link"]}
    joined = [set(slider["nodes"]) for slider in made.get("slider", made.get("iwan_joint", []))]
    assert joined
    for spring in made["torsion_spring"]:
        one, two = (ends[name] for name in spring["links"])
        assert one & two or any(pair & one and pair & two for pair in joined)
    sj.load(made).definition.resolve()
