# SPDX-License-Identifier: GPL-3.0-or-later
"""Rigid bodies, equations, moments and springs of decks that act on a truss, with closed forms."""
from __future__ import annotations

from collections.abc import Callable
from math import log, pi
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import Outcome
from failures import Failure, failing, failure

import statejump as sj
from statejump.kinds.truss.importing import Options, case_document, checked, read

HEAD = "SOL 101\nCEND\nSPC = 1\nLOAD = 5\nMPC = 7\nBEGIN BULK\n"
BARE = HEAD.replace("LOAD = 5\n", "")
# Rods of 7e6 N/m along x that end at the nodes 2 and 3 at one position; 7000 N elongate each by 1 mm.
RODS = """GRID,1,,0.,0.,0.
GRID,2,,1.,0.,0.
GRID,3,,1.,0.,0.
GRID,4,,2.,0.,0.
GRID,5,,2.,.5,0.
CROD,1,1,1,2
CROD,2,1,3,4
PROD,1,1,1.-4
MAT1,1,7.+10,,.3,2700.
SPC1,1,123,1
SPC1,1,23,4
"""
END = "FORCE,5,4,,7000.,1.,0.,0.\n"
BARS = (("CROD,1,1,1,2", "CBAR,1,1,1,2,0.,1.,0."), ("CROD,2,1,3,4", "CBAR,2,1,3,4,0.,1.,0."), ("PROD", "PBAR"))
INP = """*NODE, NSET=NALL
1, 0., 0., 0.
2, 1., 0., 0.
3, 1., 0., 0.
4, 2., 0., 0.
5, 2., 1., 0.
*ELEMENT, TYPE=T3D2, ELSET=BARS
1, 1, 2
2, 3, 4
*MATERIAL, NAME=AL
*ELASTIC
7.E10, .3
*SOLID SECTION, ELSET=BARS, MATERIAL=AL
1.E-4
*BOUNDARY
1, 1, 3
4, 2, 3
"""
TRIANGLE = """GRID,{0}1,,0.,{0}.,0.
GRID,{0}2,,1.,{0}.,0.
GRID,{0}3,,0.,{0}.5,0.
CROD,{0}1,1,{0}1,{0}2
CROD,{0}2,1,{0}2,{0}3
CROD,{0}3,1,{0}3,{0}1
"""
MATTER = "PROD,1,1,1.-4\nMAT1,1,7.+10,,.3,2700.\n"
STEP = "*STEP\n*STATIC\n*CLOAD\n4, 1, 7000.\n{more}*END STEP\n"


def made(folder: Path, text: str, **options: Any) -> dict[str, Any]:
    """Return the document of a deck."""
    path = folder / ("deck.inp" if text.startswith("*") else "deck.bdf")
    path.write_text(text if text.startswith("*") else f"{text}ENDDATA\n")
    return case_document(read(path, options=Options(**options)), "deck", temperature_change_K=0.0)


def moved(document: dict[str, Any], node: str) -> np.ndarray:
    """Return the displacement of a node."""
    at = [item["name"] for item in document["node"]].index(node)
    return np.asarray(sj.load(document).reduced().history["displacement_m"].values[-1, at])


def refusal(folder: Path, text: str, **options: Any) -> sj.StatejumpError:
    """Return the error of a deck."""
    with pytest.raises(sj.StatejumpError) as refused:
        made(folder, text, **options)
    return refused.value


def bent(text: str) -> str:
    """Return a deck with beams in place of its rods."""
    for old, new in BARS:
        text = text.replace(old, new)
    return text


@pytest.mark.parametrize("name, cards", [
    ("rigid bar", "RBAR,9,2,3,123456\n"), ("rigid bar of one list", "RBAR1,9,2,3,123456\n"),
    ("hinge", "RBAR,9,2,3,123456,,,123\n"), ("hinge of the other end", "RBAR,9,2,3,,123456,1235\n"),
    ("halves", "RBAR,9,2,3,123,456,456,123\n"), ("body", "RBE2,9,2,123456,3\n"), ("pinned body", "RBE2,9,2,123,3,0.\n"),
    ("chain", "GRID,6,,1.,0.,0.\nRBAR,9,2,6,123456\nRBE2,10,6,123456,3\n"),
    ("components of a body", "RBE2,9,2,12,3\nRBE2,10,2,3,3\n"),
    ("equations", "".join(f"MPC,7,2,{at},1.5,3,{at},-1.5\n" for at in (1, 2, 3))),
    ("equations of three nodes", "GRID,6,,1.,0.,0.\n" + "".join(
        f"MPC,7,{one},{at},1.,{other},{at},-1.\n" for at in (1, 2, 3) for one, other in ((2, 3), (3, 6)))),
    ("what is held on both sides needs none", "MPC,7,2,1,-2.,3,1,2.\nSPC1,1,23,2,THRU,3\n"),
])
def test_nodes_at_one_place_become_one(name: str, cards: str, tmp_path: Path) -> None:
    """A rigid connection merges nodes 2 and 3, so both rods elongate by 1 mm."""
    document = made(tmp_path, HEAD + RODS + END + cards)
    assert {item["name"] for item in document["node"]} == {"N1", "N2", "N4"}
    assert moved(document, "N4")[0] == pytest.approx(2e-3, rel=1e-12)


def test_springs_masses_and_supports_move_with_their_node(tmp_path: Path) -> None:
    """The merged node has a spring of 1e6 N/m along y with 1000 N. Node 3 is held along x, so one rod elongates."""
    cards = "SPC1,1,1,3\nCELAS2,8,1.+6,3,2\nFORCE,5,3,,1000.,0.,1.,0.\nCONM2,2,3,,4.\nCONM2,1,2,,3.\n"
    document = made(tmp_path, HEAD + RODS + END + cards + "RBAR,9,2,3,123456\n")
    joint = next(item for item in document["node"] if item["name"] == "N2")
    assert joint["mass_kg"] == 7
    # Rods of 1 m that rotate by 1e-3 become 5e-7 m shorter along x and pull back with 7 N.
    assert moved(document, "N4")[0] == pytest.approx(1e-3, rel=1e-3)
    assert moved(document, "N2")[1] == pytest.approx(1e-3, rel=0.01)


@pytest.mark.parametrize("name, cards", [
    ("arm along the force", "GRID,6,,3.,0.,0.\nRBAR,9,4,6,123456\nFORCE,5,6,,7000.,1.,0.,0.\n"),
    ("arm on rods, which feel no moment", "RBE2,9,4,123456,5\nFORCE,5,5,,7000.,1.,0.,0.\n"),
    ("arm on an arm", "GRID,6,,3.,0.,0.\nRBAR,9,4,5,123456\nRBAR,10,5,6,123456\nFORCE,5,6,,7000.,1.,0.,0.\n"),
    ("node without bars", "MPC,7,4,1,1.,5,1,-1.\nFORCE,5,5,,7000.,1.,0.,0.\n"),
    ("lever", "MPC,7,4,1,2.,5,1,-1.\nFORCE,5,5,,3500.,1.,0.,0.\n"),  # node 5 moves twice as far
    ("chain of equations", "GRID,6\nMPC,7,5,1,1.,6,1,-1.\nMPC,7,4,1,1.,5,1,-1.\nFORCE,5,6,,7000.,1.,0.,0.\n"),
])
def test_loads_of_nodes_without_bars_act_where_bars_end(name: str, cards: str, tmp_path: Path) -> None:
    rest = RODS.replace("CROD,2,1,3,4", "CROD,2,1,2,4").replace("GRID,3,,1.,0.,0.\n", "")
    document = made(tmp_path, HEAD + rest + cards)
    assert moved(document, "N4")[0] == pytest.approx(2e-3, rel=1e-12)


def test_an_equation_of_one_displacement_is_a_support(tmp_path: Path) -> None:
    document = made(tmp_path, HEAD + RODS + END + "RBAR,9,2,3,123456\nMPC,7,2,1,3.,1,1,1.\n")
    assert moved(document, "N4")[0] == pytest.approx(1e-3, rel=1e-9)


@pytest.mark.parametrize("name, cards, moves", [
    ("equal", "MPC,7,2,1,1.,3,1,-1.\n", 2e-3),
    ("opposite", "MPC,7,2,1,1.,3,1,1.\n", 2e-3),
    ("half as far", "MPC,7,2,1,2.,3,1,-1.\n", 5e-3),
    ("what is held drops out", "MPC,7,1,1,1.,4,2,1.,,\n,,3,1,1.,2,1,1.\n", 2e-3),
    ("apart", "".join(f"MPC,7,2,{at},1.,4,{at},-1.\n" for at in (1, 2, 3)) + "SPC1,1,23,3\n", 1e-3),
    ("rigid rod", "RROD,9,2,4\n", 1e-3),
])
def test_equations_between_nodes_at_which_bars_end_are_constraints(name: str, cards: str, moves: float,
                                                                   tmp_path: Path) -> None:
    """The first rod ends at node 2, the second pulls node 3 with 7000 N, which elongates each rod by 1 mm."""
    document = made(tmp_path, HEAD + RODS + END + cards)
    assert document["constraint"]
    assert moved(document, "N4")[0] == pytest.approx(moves, rel=1e-9)


def test_a_mass_moves_with_the_node_of_an_equation(tmp_path: Path) -> None:
    document = made(tmp_path, HEAD + RODS + END + "MPC,7,4,1,1.,5,1,-1.\nCONM2,9,5,,1.\nMPC,7,2,1,1.,3,1,-1.\n")
    masses = {node["name"]: node.get("mass_kg") for node in document["node"]}
    assert masses["N5"] == 1
    assert moved(document, "N5") == pytest.approx(moved(document, "N4"))


def test_a_mean_shares_its_load_by_weights_and_levers(tmp_path: Path) -> None:
    """An RBE3 mean has weights 1 and 3: nodes 2 and 4 carry 1/4 and 3/4 of a force along both rods."""
    rest = RODS.replace("CROD,2,1,3,4", "CROD,2,1,2,4").replace("GRID,3,,1.,0.,0.\n", "").replace("2.,.5,0.", "9.,0.,0.")
    cards = "RBE3,9,,5,12,1.,123,2,3.,\n,123,4\nFORCE,5,5,,7000.,1.,0.,0.\n"
    document = made(tmp_path, HEAD + rest + cards)
    assert moved(document, "N2")[0] == pytest.approx(1e-3, rel=1e-9)
    assert moved(document, "N4")[0] == pytest.approx(1.75e-3, rel=1e-9)


ARM = "RBE2,9,4,123456,5\n"
REFUSED = {
    "partly": ("RBAR,9,2,3,123\n", failure("deck_not_supported", card="RBAR", reason="partial_coupling")),
    "half dependent": ("RBAR,9,2,3,123,456,456\n", failure("deck_not_supported", card="RBAR", reason="partial_coupling")),
    "partly dependent": ("RBAR,9,1,2,123456,,,1\n", failure("deck_not_supported", card="RBAR", reason="partial_coupling")),
    "a component apart": ("RBE2,9,1,1,2\n", failure("deck_not_supported", card="RBE2", reason="partial_coupling")),
    "warm": ("RBE2,9,2,123456,3,1.-5\n", failure("deck_not_supported", card="RBE2.ALPHA", reason="rigid_body_expansion")),
    "warm bar": ("RBAR,9,2,3,123456,,,,1.-5\n", failure("deck_not_supported", card="RBAR.ALPHA", reason="no_truss")),
    "supported arm": (ARM + "SPC1,1,2,5\n", failure("deck_not_supported", card="RBE2", reason="support_off_bar_ends")),
    "force aside": ("MPC,7,4,1,1.,5,1,-1.\nFORCE,5,5,,1.,1.,1.,0.\n", failure("deck_not_supported", card="FORCE", reason="force_without_stiffness")),
    "equation of an arm": (ARM + "MPC,7,2,1,1.,5,1,-1.\n", failure("deck_not_supported", card="MPC", reason="node_on_rigid_arm")),
    "warm rod": ("RROD,9,2,4,,,1.-5\n", failure("deck_not_supported", card="RROD.ALPHA", reason="no_truss")),
    "rod without length": ("RROD,9,2,3\n", failure("deck_bad_geometry", card="RROD", problem="nodes 2 and 3 are at one position")),
    "turning equation": ("MPC,7,4,1,1.,3,5,-1.\n", failure("deck_not_supported", card="MPC", reason="rotation")),
    "mean of nodes on a line": ("RBE3,9,,5,123,1.,123,2,4\nFORCE,5,5,,1.,1.,0.,0.\n", failure("deck_not_supported", card="RBE3", reason="mean_undetermined")),
    "turned mean": ("RBE3,9,,5,123,1.,123,2,4\nMOMENT,5,5,,1.,1.,0.,0.\n", failure("deck_not_supported", card="RBE3", reason="load_distribution")),
    "support of a free body": ("SUPORT,2,1\n", failure("deck_not_supported", card="SUPORT", reason="no_truss")),
}


@pytest.mark.parametrize("name", REFUSED)
def test_what_needs_rotations_or_equations_is_refused(name: str, tmp_path: Path) -> None:
    cards, sentence = REFUSED[name]
    assert sentence == refusal(tmp_path, HEAD + RODS + END + cards)


TURNED = {
    "moment": ("MOMENT,5,2,,1.,0.,0.,1.\n", failure("deck_not_supported", card="MOMENT", reason="bending_moment")),
    "moment of two nodes": ("MOMENT1,5,2,1.,1,5\n", failure("deck_not_supported", card="MOMENT1", reason="bending_moment")),
    "moment through a body": ("MOMENT,5,5,,1.,0.,0.,1.\nRBAR,9,4,5,123456\n", failure("deck_not_supported", card="MOMENT", reason="bending_moment")),
    "force on an arm": (ARM + "FORCE,5,5,,7.,1.,0.,0.\n", failure("deck_not_supported", card="FORCE", reason="bending_moment")),
    "weight on an arm": (ARM + "CONM2,9,5,,2.\nGRAV,5,,9.81,1.,0.,0.\n", failure("deck_not_supported", card="CONM2", reason="bending_moment")),
}


@pytest.mark.parametrize("name", TURNED)
def test_moments_that_bend_beams_are_refused(name: str, tmp_path: Path) -> None:
    cards, sentence = TURNED[name]
    assert sentence == refusal(tmp_path, HEAD + bent(RODS) + END + cards, beams_as_bars=True)


@pytest.mark.parametrize("name, text, cards", [
    ("rods", RODS, "MOMENT,5,2,,1.,0.,0.,1.\n"),
    ("torsion of beams in a line", bent(RODS), "RBAR,10,2,3,123456\nMOMENT,5,4,,1.,-1.,0.,0.\n"),
    ("torsion by four nodes", bent(RODS), "GRID,6,,0.,0.,1.\nMOMENT2,5,4,1.,4,5,1,6\n"),
    ("turning springs", bent(RODS), "CBUSH,10,3,2,,,,,0\nPBUSH,3,K,,,,1.,1.,1.\nCELAS2,9,5.,2,5\n"),
    ("turning equations", bent(RODS), "MPC,7,2,5,1.,3,6,1.\nRBE2,10,2,456,3\n"),
    ("mean that nothing loads", RODS, "RBE3,9,,5,123,1.,123,2,4\n"),
    ("body at which no bar ends", RODS, "GRID,6\nGRID,7,,1.\nRBE2,9,6,123456,7\n"),
])
def test_what_moves_no_node_is_left_out_and_noted(name: str, text: str, cards: str, tmp_path: Path) -> None:
    (tmp_path / "deck.bdf").write_text(HEAD + text + END + cards + "ENDDATA\n")
    deck = read(tmp_path / "deck.bdf", options=Options(beams_as_bars=True))
    assert deck.force == {"4": [7000.0, 0.0, 0.0]} and not deck.springs
    card = cards.split("\n")[-2].split(",")[0]
    assert any(left == card for left, _ in deck.left), deck.left


@pytest.mark.parametrize("name, cards", [
    ("across", "GRID,3,,1.,1.,0.\nSPC1,1,123,3\nCELAS2,2,7.+6,2,1,3,1\n"),
    ("at one place", "GRID,3,,1.,0.,0.\nSPC1,1,1,3\nCELAS2,2,7.+6,3,1,2,1\n"),
    ("bush at one place", "GRID,3,,1.,0.,0.\nSPC1,1,123456,3\nCBUSH,2,9,2,3,,,,0\nPBUSH,9,K,7.+6,,,1.\n"),
])
def test_a_spring_to_a_held_node_is_one_to_the_ground(name: str, cards: str, tmp_path: Path) -> None:
    """Rod and spring of 7e6 N/m carry 14 kN in parallel."""
    rod = "".join(line + "\n" for line in RODS.splitlines() if not line.startswith(("GRID,3", "GRID,4", "GRID,5", "CROD,2", "SPC1,1,23")))
    document = made(tmp_path, HEAD + rod + cards + "SPC1,1,23,2\nFORCE,5,2,,14000.,1.,0.,0.\n")
    assert moved(document, "N2")[0] == pytest.approx(1e-3, rel=1e-9)


def test_supports_of_rigid_body_modes_hold_nothing(tmp_path: Path) -> None:
    head = HEAD.replace("SOL 101", "SOL 103")
    document = made(tmp_path, head + RODS.replace("SPC1,1,123,1", "SPC1,1,23,1") + "RBAR,9,2,3,123456\nSUPORT,1,1\n")
    assert document["node"][0]["fixed"] == ["y"]


def test_masses_may_have_the_numbers_of_bars(tmp_path: Path) -> None:
    document = made(tmp_path, BARE + RODS + "RBAR,9,2,3,123456\nCONM2,1,4,,4.\n")
    assert document["node"][-1]["mass_kg"] == 4
    assert failure("deck_duplicate", what_it_is="element", name="1") == refusal(tmp_path, BARE + RODS + "CONM2,1,4,,4.\nCONM1,1,4,,4.\n")


@pytest.mark.parametrize("name, cards", [
    ("all directions", "PMASS,8,4.,9,5.\n" + "".join(f"CMASS1,1{at},8,4,{at}\n" for at in (1, 2, 3))),
    ("what is held needs none", "CMASS2,1,3.,4,1\nCMASS2,11,1.,,,4,1\nCMASS2,12,7.,4,3\n"),
    ("rotations", "CMASS2,1,4.,4,1\nCMASS2,2,9.,4,5\n"),
])
def test_masses_of_components_are_one_mass(name: str, cards: str, tmp_path: Path) -> None:
    document = made(tmp_path, BARE + RODS + "RBAR,9,2,3,123456\n" + cards)
    assert document["node"][-1]["mass_kg"] == 4


@pytest.mark.parametrize("cards, sentence", [
    ("CMASS2,1,4.,2,1\nCMASS2,2,5.,2,2\n", failure("deck_not_supported", card="CMASS2", reason="anisotropic_mass")),
    ("CMASS2,1,4.,2,1,4,1\n", failure("deck_not_supported", card="CMASS2", reason="mass_between_components")),
    ("CMASS2,1,4.,2\n", failure("deck_not_supported", card="CMASS2", reason="scalar_point")),
    ("CMASS1,1,4,2,1\n", failure("deck_undefined", card="CMASS1", what_it_is="PMASS", name="4")),
])
def test_other_masses_of_components_are_refused(cards: str, sentence: Failure, tmp_path: Path) -> None:
    assert sentence == refusal(tmp_path, BARE + RODS + "RBAR,9,2,3,123456\n" + cards)


def test_temperatures_that_another_run_computes_are_refused(tmp_path: Path) -> None:
    head = BARE.replace("BEGIN", "TEMP(LOAD) = 8\nBEGIN")
    assert failure("deck_not_supported", card="TEMPERATURE", reason="missing_set") == refusal(tmp_path, head + RODS)
    assert failure("deck_not_supported", card="PARAM.HEATSTAT", reason="no_truss") == refusal(tmp_path, BARE + RODS + "PARAM,HEATSTAT,YES\n")
    made(tmp_path, BARE + RODS + "PARAM,HEATSTAT,NO\n")


def test_a_set_of_loads_that_the_deck_does_not_have_is_refused(tmp_path: Path) -> None:
    assert failure("deck_not_supported", card="LOAD", reason="missing_set") == refusal(tmp_path, HEAD + RODS)
    assert made(tmp_path, HEAD.replace("101", "103") + RODS)["link"]  # modes need no loads


def test_nodes_of_two_temperatures_do_not_become_one(tmp_path: Path) -> None:
    head = BARE.replace("BEGIN", "TEMP(LOAD) = 8\nBEGIN")
    text = head + RODS + "RBAR,9,2,3,123456\nTEMP,8,1,20.,2,20.,3,{at}\nTEMP,8,4,20.\n"
    made(tmp_path, text.format(at="20."))
    assert failure("deck_not_supported", card="RBAR", reason="unequal_temperatures") == refusal(tmp_path, text.format(at="30."))


@pytest.mark.parametrize("name, equations, load", [
    ("one node", "".join(f"*EQUATION\n2\n2, {at}, 1., 3, {at}, -1.\n" for at in (1, 2, 3)), ""),
    ("several in a block, over lines", "*EQUATION\n2\n2, 1, 1., 3, 1, -1.\n2\n2, 2, 1.,\n3, 2, -1.\n2\n2, 3, 1., 3, 3, -1.\n", ""),
])
def test_equations_of_calculix_make_nodes_one(name: str, equations: str, load: str, tmp_path: Path) -> None:
    document = made(tmp_path, INP + "2, 2, 3\n" + equations + STEP.format(more=load))
    assert moved(document, "N4")[0] == pytest.approx(2e-3, rel=1e-12)


def test_equations_of_calculix_pass_on_loads(tmp_path: Path) -> None:
    one = INP.replace("2, 3, 4\n*MAT", "2, 2, 4\n*MAT").replace("3, 1., 0., 0.\n", "") + "2, 2, 3\n"
    document = made(tmp_path, one + "*EQUATION\n2\n5, 1, 1., 4, 1, -3.\n" + STEP.format(more="5, 1, 7000.\n"))
    assert moved(document, "N4")[0] == pytest.approx(8e-3, rel=1e-9)  # 7000 N and three times 7000 N


def test_equations_of_calculix_between_nodes_are_constraints(tmp_path: Path) -> None:
    held = "2, 2, 3\n3, 2, 3\n"
    document = made(tmp_path, INP + held + "*EQUATION\n2\n2, 1, 1., 3, 1, -2.\n" + STEP.format(more=""))
    assert document["constraint"] == [
        {"name": "C1", "nodes": ["N2", "N3"], "directions": ["x", "x"], "coefficients": [1.0, -2.0]}]
    # The first rod carries half of 7000 N and elongates by 0.5 mm; node 3 moves by half of that.
    assert moved(document, "N4")[0] == pytest.approx(1.25e-3, rel=1e-9)


@pytest.mark.parametrize("equation, sentence", [
    ("2\n2, 5, 1., 3, 1, -1.\n", failure("deck_not_supported", card="*EQUATION", reason="rotation")),
    ("2\nNALL, 1, 1., 3, 1, -1.\n", failure("deck_not_supported", card="*EQUATION", reason="node_sets")),
    ("3\n2, 1, 1., 3, 1, -1.\n", failure("deck_incomplete", card="*EQUATION", needed="3 terms")),
])
def test_other_equations_of_calculix_are_refused(equation: str, sentence: Failure, tmp_path: Path) -> None:
    assert sentence == refusal(tmp_path, INP + "*EQUATION\n" + equation + STEP.format(more=""))


@pytest.mark.parametrize("kind, loads, reason", [
    ("T3D2", "4, 6, 5.\n", None), ("B31", "4, 4, 5.\n", None), ("B31", "4, 6, 5.\n", "bending_moment"),
    ("T3D2", "4, 7, 5.\n", "unsupported_direction")])
def test_moments_of_calculix_count_where_they_bend(kind: str, loads: str, reason: str | None, tmp_path: Path) -> None:
    text = INP.replace("2, 3, 4\n*MAT", "2, 2, 4\n*MAT").replace("T3D2", kind)
    if kind == "B31":
        text = text.replace("*SOLID SECTION, ELSET=BARS, MATERIAL=AL\n1.E-4", "*BEAM SECTION, ELSET=BARS, MATERIAL=AL, SECTION=RECT\n.01, .01")
    text += STEP.format(more=loads)
    if reason:
        assert failure("deck_not_supported", card="*CLOAD", reason=reason) == refusal(tmp_path, text, beams_as_bars=True)
    else:
        assert made(tmp_path, text, beams_as_bars=True)["node"][-1]["force_N"] == [7000.0, 0.0]


def test_the_middle_of_a_beam_with_a_moment_is_a_node(tmp_path: Path) -> None:
    """The moment acts on both halves, and would bend them."""
    text = INP.replace("TYPE=T3D2", "TYPE=B32").replace("1, 1, 2\n2, 3, 4", "1, 1, 2, 4").replace(
        "*SOLID SECTION, ELSET=BARS, MATERIAL=AL\n1.E-4", "*BEAM SECTION, ELSET=BARS, MATERIAL=AL, SECTION=RECT\n.01, .01")
    assert failure("deck_not_supported", card="*CLOAD", reason="bending_moment") == refusal(
        tmp_path, text + STEP.format(more="2, 5, 1.\n"), beams_as_bars=True)


def test_an_amplitude_of_one_value_is_known_in_every_step(tmp_path: Path) -> None:
    one = INP.replace("2, 3, 4\n*MAT", "2, 2, 4\n*MAT")
    text = one + "*AMPLITUDE, NAME=A\n0., {first}, 9., 2.\n*STEP\n*FREQUENCY\n4\n*CLOAD, AMPLITUDE=A\n4, 1, 3500.\n*END STEP\n"
    assert made(tmp_path, text.format(first="2."))["node"][-1]["force_N"] == [7000.0, 0.0]
    assert failure("deck_not_supported", card="*CLOAD, AMPLITUDE", reason="amplitude_at_end_unknown") == refusal(tmp_path, text.format(first="1."))


@pytest.mark.parametrize("shape, factor", [("RECT", 1.0), ("CIRC", pi / 4)])
def test_sizes_of_nodes_make_a_taper(shape: str, factor: float, tmp_path: Path) -> None:
    """A section tapers from 10 x 20 to 20 x 10 mm: the integral of dx / ((1 + x) (2 - x)) is 2 ln 2 / 3."""
    text = INP.replace("2, 3, 4\n*MAT", "2, 2, 4\n*MAT").replace("TYPE=T3D2", "TYPE=B31").replace(
        "*SOLID SECTION, ELSET=BARS, MATERIAL=AL\n1.E-4",
        f"*DENSITY\n2700.\n*BEAM SECTION, ELSET=BARS, MATERIAL=AL, SECTION={shape}, NODAL THICKNESS\n1., 1.\n"
        "*NODAL THICKNESS\n1, .01, .02\n2, .02, .01\n4, .01")
    links = made(tmp_path, text + STEP.format(more=""), beams_as_bars=True)["link"]
    assert links[0]["cross_section_area_m2"] == pytest.approx(factor * 1.5e-4 / log(2), rel=1e-12)
    # Mean areas: of (1 + x) (2 - x) 13/6, of (2 - x) 1 3/2.
    weight = links[0]["cross_section_area_m2"] * links[0]["density_kg_per_m3"] / 2700
    assert weight == pytest.approx(factor * 13 / 6 * 1e-4, rel=1e-12)
    assert links[1]["cross_section_area_m2"] == pytest.approx(factor * 1e-4 / log(2), rel=1e-12)
    missing = text.replace("2, .02, .01\n", "")
    assert failure("bar_without_property", kind="*ELEMENT, TYPE=B31", name="1", property="cross-section area", option="--area") == refusal(tmp_path, missing + STEP.format(more=""), beams_as_bars=True)


def test_a_deck_without_supports_is_imported_and_does_not_run(tmp_path: Path, statejump: Callable[..., Outcome]) -> None:
    (tmp_path / "deck.bdf").write_text(TRIANGLE.format(1) + MATTER)
    told = statejump("truss", "import", "deck.bdf", "-o", "deck.toml", "--temperature-change", "1")
    document = case_document(read(tmp_path / "deck.bdf"), "deck", temperature_change_K=1.0)
    _, hint = checked(document, sj.load)
    assert hint == failure("no_support") and hint.remedy is not None and "--fixed" in hint.remedy
    assert told.status == 0 and f"hint: {hint}" in " ".join(told.output.split())
    ran = statejump("reduced", "deck.toml")
    assert ran.status == 2 and ran.failure == failure("no_support")
    held = statejump("truss", "import", "deck.bdf", "-o", "held.toml", "--temperature-change", "1", "--fixed", "N11=xyz")
    assert held.status == 0 and "hint" not in held.output


def test_a_part_without_support_is_named(tmp_path: Path) -> None:
    document = made(tmp_path, BARE + TRIANGLE.format(1) + TRIANGLE.format(2) + MATTER + "SPC1,1,123,11\n")
    _, hint = checked(document, sj.load)
    assert hint == failure("disconnected_truss", loose_node="N21")
    document["link"][0]["young_modulus_Pa"] = -1.0  # everything else is checked
    with failing("out_of_range", key="young_modulus_Pa", value=-1.0):
        checked(document, sj.load)
