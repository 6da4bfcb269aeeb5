# SPDX-License-Identifier: GPL-3.0-or-later
"""Rigid bodies and hinges of decks with beams, with closed forms."""
from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from failures import failure

import statejump as sj
from statejump.kinds.truss.importing import Options, case_document, read

HEAD = "SOL 101\nCEND\nSPC = 1\nLOAD = 5\nBEGIN BULK\n"
# Sections of E I = 700 N m2 about both axes. They are nearly rigid in tension.
SECTION = "PBAR,1,1,1.,1.-8,1.-8,1.-8\nMAT1,1,7.+10,,.3\n"
FORCE = 1e-2
EI = 700.0


def grids(*places: float) -> str:
    """Return nodes on the x axis, with numbers from 1."""
    return "".join(f"GRID,{number},,{place},0.,0.\n" for number, place in enumerate(places, start=1))


def bars(*ends: tuple[int, int]) -> str:
    """Return beams along x."""
    return "".join(f"CBAR,{number},1,{first},{second},0.,1.,0.\n" for number, (first, second) in enumerate(ends, start=1))


def document(folder: Path, text: str, **options: Any) -> dict[str, Any]:
    """Return the document of a deck."""
    (folder / "deck.bdf").write_text(f"{HEAD}{text}{SECTION}ENDDATA\n")
    return case_document(read(folder / "deck.bdf", options=Options(**options)), "deck", temperature_change_K=0.0)


def moved(made: dict[str, Any], node: str) -> np.ndarray:
    """Return the displacement of a node times E I over the force."""
    at = [item["name"] for item in made["node"]].index(node)
    found = sj.load(made).reduced().history["displacement_m"].values[-1, at]
    return np.asarray(found) * EI / FORCE


def force(node: int, *direction: float) -> str:
    """Return a force on a node."""
    return f"FORCE,5,{node},,{FORCE},{','.join(map(str, direction))}\n"


def test_a_rigid_body_carries_beams_at_two_positions(tmp_path: Path) -> None:
    """A cantilever 0 to 2, a rigid arm 2 to 3, a beam 3 to 4: u = (4³ - 2³ + 1³)/3 F/(E I)."""
    made = document(tmp_path, grids(0, 2, 3, 4) + bars((1, 2), (3, 4)) + "RBE2,9,2,123456,3\nSPC1,1,123456,1\n" +
                    force(4, 0., 1., 0.))
    assert made["rigid"] == [{"name": "R1", "master": "N2", "nodes": ["N3"]}]
    assert moved(made, "N4")[1] == pytest.approx(57 / 3, rel=1e-5)


def test_bodies_that_share_nodes_are_one_body(tmp_path: Path) -> None:
    """The arms 2-3 and 3-5 make one body. Node 5 is beside the beams at y = 0.5, where it is supported."""
    made = document(tmp_path, grids(0, 2, 3, 4) + "GRID,5,,3.,.5,0.\n" + bars((1, 2), (3, 4)) +
                    "RBE2,9,2,123456,3\nRBAR,10,3,5,123456\nSPC1,1,123456,1\nSPC1,1,2,5\n" + force(4, 0., 1., 0.))
    assert made["rigid"] == [{"name": "R1", "master": "N5", "nodes": ["N2", "N3"]}]
    # Support force R on the arm, at x = 3: deflections there of F and R cancel.
    flexibility, coupling = 26 / 3, 26 / 3 + 4.0  # cantilever of 2 with an arm of 1; its slope under R
    support = coupling / flexibility
    assert moved(made, "N4")[1] == pytest.approx(57 / 3 - support * coupling, rel=1e-4)


@pytest.mark.parametrize("components, along_y, along_z", [
    ("123", 4 / 3, 4 / 3),
    ("12345", 4 / 3, 1 / 3),  # rotates freely about z: a force along y bends two cantilevers, along z a clamped beam
    ("12346", 1 / 3, 4 / 3),
    ("1234", 4 / 3, 4 / 3),
])
@pytest.mark.parametrize("card", ["RBE2,9,2,{0},3\n", "RBAR1,9,2,3,{0}\n", "RBAR,9,2,3,123456,,,{0}\n"])
def test_free_rotations_at_one_position_are_hinges(components: str, along_y: float, along_z: float, card: str,
                                                   tmp_path: Path) -> None:
    """Two beams of 2 m, clamped at their far ends: u = F 2³/(2 · 3 E I) if hinged, F 4³/(192 E I) if not."""
    text = grids(0, 2, 2, 4) + bars((1, 2), (3, 4)) + card.format(components) + "SPC1,1,123456,1\nSPC1,1,23456,4\n"
    assert moved(document(tmp_path, text + force(2, 0., 1., 0.)), "N2")[1] == pytest.approx(along_y, rel=1e-5)
    assert moved(document(tmp_path, text + force(3, 0., 0., 1.)), "N3")[2] == pytest.approx(along_z, rel=1e-5)


@pytest.mark.parametrize("components", ["12345", "123"])
def test_a_hinge_ends_a_rigid_arm(components: str, tmp_path: Path) -> None:
    """A cantilever of 2 m with an arm of 1 m has 26/3 E I/F, the beam behind the hinge 8/3: they act in parallel."""
    made = document(tmp_path, grids(0, 2, 3, 5) + bars((1, 2), (3, 4)) + f"RBE2,9,2,{components},3\n"
                    "SPC1,1,123456,1\nSPC1,1,23456,4\n" + force(3, 0., 1., 0.))
    assert moved(made, "N3")[1] == pytest.approx(1 / (3 / 26 + 3 / 8), rel=1e-5)


def test_two_bodies_may_hold_one_node(tmp_path: Path) -> None:
    """Arms of 1 m at two cantilevers of 1 m hold a node by its displacements: each has 7/3 E I/F."""
    made = document(tmp_path, grids(0, 1, 2, 3, 4) + bars((1, 2), (4, 5)) + "RBE2,9,2,123,3\nRBE2,10,4,123,3\n"
                    "SPC1,1,123456,1\nSPC1,1,23456,5\n" + force(3, 0., 1., 0.))
    assert len(made["rigid"]) == 2 and len(made["constraint"]) == 3
    assert moved(made, "N3")[1] == pytest.approx(7 / 6, rel=1e-5)


def test_some_displacements_follow_an_arm(tmp_path: Path) -> None:
    """Node 3 at the end of an arm of 1 m follows along y only. A rod of 1000 N/m along z carries its force along z."""
    text = grids(0, 2, 3) + "GRID,4,,3.,0.,1.\n" + bars((1, 2)) + "CROD,2,2,3,4\nPROD,2,2,1.-6\nMAT1,2,1.+9,,.3\n" \
        "RBE2,9,2,12,3\nSPC1,1,123456,1\nSPC1,1,123,4\n"
    made = document(tmp_path, text + force(3, 0., 1., 0.))
    assert made["rigid"] == [{"name": "R1", "master": "N2", "nodes": ["N3"], "directions": ["x", "y"], "rotations": []}]
    assert moved(made, "N3")[1] == pytest.approx(26 / 3, rel=1e-4)
    assert moved(document(tmp_path, text + force(3, 0., 0., 1.)), "N2")[2] == pytest.approx(0, abs=1e-6)


def test_masses_and_moments_stay_on_the_body(tmp_path: Path) -> None:
    """A mass on an arm keeps its position, for modes. A moment acts on the body wherever it is given."""
    made = document(tmp_path, grids(0, 2, 3) + bars((1, 2)) + "RBE2,9,2,123456,3\nCONM2,8,3,,5.\nSPC1,1,123456,1\n"
                    "MOMENT,5,3,,.01,0.,0.,1.\n")
    assert next(node for node in made["node"] if node["name"] == "N3")["mass_kg"] == 5
    assert "density_kg_per_m3" not in made["beam"][0]  # statics without gravity
    assert moved(made, "N3")[1] == pytest.approx(2.0**2 / 2 + 2.0, rel=1e-5)  # M L²/2 + M L · arm


@pytest.mark.parametrize("load", [force(5, 0., 1., 0.), f"MOMENT,5,2,,{3 * FORCE},0.,0.,1.\n"])
def test_bars_at_two_positions_of_a_body_rotate_it(load: str, tmp_path: Path) -> None:
    """A rigid lever from x = 0 to 3, held at 0, with a rod of 7e6 N/m at 1 and a force at 3: u = 3² F/k there."""
    text = "".join(f"GRID,{at},,{x},{y},0.\n" for at, x, y in ((1, 0, 0), (2, 1, 0), (3, 3, 0), (4, 1, 1), (5, 3, 1)))
    made = document(tmp_path, text + "CROD,1,2,2,4\nCROD,2,2,3,5\nPROD,2,1,1.-4\nRBE2,9,1,123456,2,3\n"
                    "SPC1,1,123,1,4\nSPC1,1,13,5\n" + load)
    assert made["truss"]["dimension"] == 2 and made["rigid"][0]["master"] == "N1"
    assert moved(made, "N3")[1] == pytest.approx(9 * EI / 7e6, rel=1e-5)


@pytest.mark.parametrize("cards, reason", [
    ("RBE2,9,2,456,3\n", "partial_coupling"),
    ("RBE2,9,2,1246,3\n", "partial_coupling"),  # some displacements and some rotations
    ("CORD2R,7,,0.,0.,0.,0.,0.,1.,\n,1.,1.,0.\nGRID,6,,3.,0.,0.,7\nCBAR,7,1,6,4,0.,1.,0.\nRBE2,9,2,13,6\n",
     "partial_coupling"),  # a direction that is no axis
])
def test_other_couplings_are_refused(cards: str, reason: str, tmp_path: Path) -> None:
    with pytest.raises(sj.StatejumpError) as refused:
        document(tmp_path, grids(0, 2, 3, 4) + bars((1, 2), (3, 4)) + cards + "SPC1,1,123456,1\n" + force(2, 0., 1., 0.))
    assert refused.value == failure("deck_not_supported", card="RBE2", reason=reason)


FREE = "SOL 103\nCEND\nSPC = 1\nLOAD = 5\nBEGIN BULK\nFORCE,5,1,,0.,1.,0.,0.\n"


def test_a_free_deck_of_modes_runs_as_modes(tmp_path: Path) -> None:
    """Masses on arms at both ends of a beam without mass, held in a plane: M = 4 kg at each end oscillates along it with
    ω² = 2 E A/(L M). The three motions in the plane are free, the arms have none of their own."""
    masses = "GRID,3,,0.,0.,1.\nGRID,4,,0.,0.,-1.\nGRID,5,,1.,0.,1.\nGRID,6,,1.,0.,-1.\nRBE2,8,1,123456,3,4\n" \
        "RBE2,9,2,123456,5,6\n" + "".join(f"CONM2,1{node},{node},,2.\n" for node in (3, 4, 5, 6))
    (tmp_path / "deck.bdf").write_text(
        f"{FREE}{grids(0, 1)}{bars((1, 2))}{masses}PBAR,1,1,1.-4,1.-8,1.-8,1.-8\nMAT1,1,7.+10,,.3\n"
        "SPC1,1,246,1,2\nSUPORT,1,135\nENDDATA\n")
    made = case_document(read(tmp_path / "deck.bdf"), "deck", temperature_change_K=0.0)
    assert made["truss"]["free"] and made["beam"][0]["density_kg_per_m3"] < 1e-9
    found = sj.modes(sj.load(made), 6).frequency_Hz
    assert list(found[:3]) == [0.0] * 3 and found[3] > 1
    wanted = np.sqrt(2 * 7e6 / 4) / (2 * np.pi)
    assert np.abs(found / wanted - 1).min() < 1e-6


@pytest.mark.parametrize("solution, supports, free", [
    ("103", "", True), ("103", "SPC1,1,1,1\n", False),
    ("101", "", True),  # nothing acts on it either
    ("101", "FORCE,5,2,,1.,1.,0.,0.\n", False), ("101", "MOMENT,5,2,,1.,1.,0.,0.\n", False)])
def test_decks_without_supports_and_of_modes_or_without_loads_are_free(solution: str, supports: str, free: bool, tmp_path: Path) -> None:
    (tmp_path / "deck.bdf").write_text(f"{FREE.replace('103', solution)}{grids(0, 1)}{bars((1, 2))}{SECTION}{supports}ENDDATA\n")
    assert ("free" in case_document(read(tmp_path / "deck.bdf"), "deck", temperature_change_K=0.0)["truss"]) == free


@pytest.mark.parametrize("step, free", [("*FREQUENCY\n4\n", True), ("*STATIC\n*CLOAD\n2, 1, 1.\n", False), ("*STATIC\n*CLOAD\n2, 1, 1.\n*END STEP\n*STEP\n*FREQUENCY\n4\n", False)])
def test_frequency_steps_of_calculix_may_be_free(step: str, free: bool, tmp_path: Path) -> None:
    (tmp_path / "deck.inp").write_text(
        "*NODE\n1, 0., 0., 0.\n2, 1., 0., 0.\n*ELEMENT, TYPE=B31, ELSET=B\n1, 1, 2\n*MATERIAL, NAME=M\n*ELASTIC\n2.E11, .3\n"
        "*DENSITY\n7800.\n*BEAM SECTION, ELSET=B, MATERIAL=M, SECTION=RECT\n.02, .01\n0., 1., 0.\n"
        f"*STEP\n{step}*END STEP\n")
    assert ("free" in case_document(read(tmp_path / "deck.inp"), "deck", temperature_change_K=0.0)["truss"]) == free


@pytest.mark.parametrize("bush", [
    "GRID,3,,2.,0.,0.\nCBUSH,9,7,2,3,,,,0\n", "GRID,3,,2.,0.,0.\nCBUSH,9,7,3,2\n",
    "GRID,3,,2.5,0.,0.\nCBUSH,9,7,2,3,0.,1.,0.,,.0\n",  # the elastic centre is node 2, an arm leads to node 3
    "GRID,3,,2.5,0.,0.\nCBUSH,9,7,3,2,0.,1.,0.,,1.\n",
])
@pytest.mark.parametrize("direction", [1, 2])
def test_a_bush_has_six_stiffnesses(bush: str, direction: int, tmp_path: Path) -> None:
    """A cantilever 0 to 2, a bush of K = E I/m³ and E I/2 per rad, and a beam to 3: u = 3³/3 + 1 + 2 times F/(E I).
    With an arm of 0.5 m the beam behind the bush is shorter."""
    arm = 0.5 if "2.5," in bush else 0.0
    text = "GRID,1,,0.,0.,0.\nGRID,2,,2.,0.,0.\nGRID,4,,3.,0.,0.\n" + bars((1, 2), (3, 4)) + bush + \
        "PBUSH,7,K,700.,700.,700.,350.,350.,350.\nSPC1,1,123456,1\n"
    made = document(tmp_path, text + force(4, 0., *(float(at == direction) for at in (1, 2))))
    wanted = (27 - 1 + (1 - arm)**3) / 3 + 1 + 2
    assert moved(made, "N4")[direction] == pytest.approx(wanted, rel=1e-4)


@pytest.mark.parametrize("cards", [
    "CBUSH,9,7,1,,,,,0\nPBUSH,7,K,,,,700.,700.,700.\n",
    "CELAS2,7,700.,1,4\nCELAS2,8,700.,1,5\nCELAS2,9,700.,1,6\n",
    "GRID,3,,0.,0.,0.\nSPC1,1,123456,3\n" + "".join(f"CELAS2,{at},700.,1,{at},3,{at}\n" for at in (4, 5, 6)),
])
@pytest.mark.parametrize("direction", [1, 2])
def test_springs_of_rotations_at_a_support(cards: str, direction: int, tmp_path: Path) -> None:
    """A beam on a pin with springs of E I per rad: u = L³/3 + L² times F/(E I)."""
    made = document(tmp_path, grids(0, 2) + bars((1, 2)) + cards + "SPC1,1,123,1\n" +
                    force(2, 0., *(float(at == direction) for at in (1, 2))))
    assert moved(made, "N2")[direction] == pytest.approx(8 / 3 + 4, rel=1e-4)


@pytest.mark.parametrize("cards, card, reason", [
    ("CBUSH,9,7,2,,,,,0\nPBUSH,7,K,,,,,,700.\n", "CBUSH", "rotation_spring"),
    ("CELAS2,9,1.,2,6\n", "CELAS2", "rotation_spring"),
    ("GRID,3,,0.,1.,0.\nCELAS2,9,1.,1,6,3,6\n", "CELAS2", "rotation_spring"),
    ("CBUSH,9,7,2,1,0.,1.,0.,,.5,0,.1,0.,0.\nPBUSH,7,K,7.,7.\n", "CBUSH", "bush_offset"),
    ("CBUSH,9,7,2,1\nPBUSH,7,K,7.,7.\n", "CBUSH", "missing_coordinate_system"),
])
def test_other_springs_of_rotations_are_refused(cards: str, card: str, reason: str, tmp_path: Path) -> None:
    with pytest.raises(sj.StatejumpError) as refused:
        document(tmp_path, grids(0, 2) + bars((1, 2)) + cards + "SPC1,1,123456,1\n" + force(2, 0., 1., 0.))
    assert refused.value == failure("deck_not_supported", card=card, reason=reason)


def spinning(folder: Path, direction: tuple[float, float, float], cards: str) -> dict[str, Any]:
    """Return a beam of 2 m in two parts, whose ends are held by displacements only, with a force along z in its
    middle."""
    places = "".join(f"GRID,{at},,{','.join(f'{part * (at - 1):.9f}' for part in direction)}\n" for at in (1, 2, 3))
    return document(folder, places + "CBAR,1,1,1,2,.1,.2,.9\nCBAR,2,1,2,3,.1,.2,.9\nSPC1,1,123,1\nSPC1,1,23,3\n" + cards +
                    force(2, 0., 0., 1.))


@pytest.mark.parametrize("direction", [(1.0, 0.0, 0.0), (0.6, 0.8, 0.0), (0.48, 0.64, 0.6)])
def test_the_free_spin_of_a_beam_is_held(direction: tuple[float, float, float], tmp_path: Path) -> None:
    """u = F L³/(48 E I) across the beam: the hold carries no moment. The run notes it."""
    made = spinning(tmp_path, direction, "")
    across = 1 - direction[2]**2  # only this part of the force bends the beam; its end slides along x
    assert moved(made, "N2")[2] == pytest.approx(across * 8 / 48, rel=2e-3)
    assert [note.code for note in sj.load(made).reduced().warnings] == ["free_spin"]


def test_the_free_spin_of_a_beam_with_arms_is_held(tmp_path: Path) -> None:
    """Arms along the beam at both ends spin with it; arms aside do not."""
    arms = "GRID,{at},,{x},{y},0.\nRBE2,{at},{master},123456,{at}\n"
    for y, notes in ((0.0, ["free_spin"]), (0.5, [])):
        cards = "".join(arms.format(at=at, x=x, y=y, master=master) for at, x, master in ((7, -1.0, 1), (8, 3.0, 3)))
        made = document(tmp_path, "GRID,1,,0.,0.,0.\nGRID,2,,1.,0.,0.\nGRID,3,,2.,0.,0.\nCBAR,1,1,1,2,.1,.2,.9\n"
                        "CBAR,2,1,2,3,.1,.2,.9\n" + cards + "SPC1,1,123,7\nSPC1,1,23,8\n" + force(2, 0., 0., 1.))
        if y:
            made["node"][1]["fixed_rotations"] = ["x"]  # else the row turns about the line of its supports
        assert [note.code for note in sj.load(made).reduced().warnings] == notes


@pytest.mark.parametrize("cards, runs", [
    ("SPC1,1,4,3\n", True),  # it is held already
    ("MOMENT,5,2,,1.-3,1.,0.,0.\n", False),  # a moment acts on it
    ("GRID,4,,1.,1.,0.\nRBE2,9,2,123,4\nCONM2,8,4,,1.\n", False),  # an arm aside swings
    ("GRID,4,,1.,1.,0.\nCBAR,3,1,2,4,0.,0.,1.\n", False),  # a beam aside swings
    ("GRID,4,,1.,1.,0.\nCBAR,3,1,2,4,0.,0.,1.,,\n,,456\nSPC1,1,123,4\n", True),  # its far end is hinged
])
def test_a_spin_with_stiffness_or_load_is_not_held(cards: str, runs: bool, tmp_path: Path) -> None:
    case = sj.load(spinning(tmp_path, (1.0, 0.0, 0.0), cards))
    if runs:
        assert not [note for note in case.reduced().warnings if note.code == "free_spin"]
        return
    with pytest.raises(sj.StatejumpError) as refused:
        case.reduced()
    assert refused.value == failure("held_mechanism")


def test_the_free_spin_of_a_beam_of_calculix_is_held(tmp_path: Path) -> None:
    (tmp_path / "deck.inp").write_text(
        "*NODE\n1, 0., 0., 0.\n2, 1., 0., 0.\n*ELEMENT, TYPE=B31, ELSET=B\n1, 1, 2\n*MATERIAL, NAME=M\n*ELASTIC\n2.E11, .3\n"
        "*BEAM SECTION, ELSET=B, MATERIAL=M, SECTION=RECT\n.02, .01\n0., 1., 0.\n*BOUNDARY\n1, 1, 3\n2, 2, 3\n"
        "*STEP\n*STATIC\n*CLOAD\n2, 1, 1.\n*END STEP\n")
    made = case_document(read(tmp_path / "deck.inp"), "deck", temperature_change_K=0.0)
    assert sj.load(made).reduced().history["displacement_m"].values[-1, 1, 0] == pytest.approx(1 / (2e11 * 2e-4), rel=1e-6)


def test_a_deck_without_temperatures_has_one_increment(tmp_path: Path) -> None:
    """Nothing changes after the start. More increments only repeat the state and compare its rounding."""
    made = document(tmp_path, grids(0, 2) + bars((1, 2)) + "SPC1,1,123456,1\n" + force(2, 0., 1., 0.))
    assert made["reduced"] == {"increments_per_branch": 1}
    assert moved(made, "N2")[1] == pytest.approx(8 / 3, rel=1e-5)
    warm = case_document(read(tmp_path / "deck.bdf"), "deck", temperature_change_K=5.0)
    assert "reduced" not in warm


# Two beams of E I = 1041.67 N m2: a cantilever 0 to 2, and a beam 3 to 4.
FRAME = """*NODE, NSET=NALL
1, 0., 0., 0.
2, 2., 0., 0.
3, 3., 0., 0.
4, 4., 0., 0.
8, 2., 1., 0.
9, 0., 9., 0.
*ELEMENT, TYPE=B31, ELSET=B
1, 1, 2
2, 3, 4
*NSET, NSET=FAR
3
*MATERIAL, NAME=M
*ELASTIC
2.E9, 0.
*BEAM SECTION, ELSET=B, MATERIAL=M, SECTION=RECT
.05, .05
0., 1., 0.
*BOUNDARY
1, 1, 6
"""
STIFF = 2e9 * 0.05**4 / 12
SHEAR = 2 * STIFF / (5 / 6 * 1e9 * 0.05**2)  # of 2 m: length over the stiffness in shear


def abaqus(folder: Path, cards: str, loads: str) -> dict[str, Any]:
    """Return the document of the frame."""
    (folder / "deck.inp").write_text(f"{FRAME}{cards}*STEP\n*STATIC\n*CLOAD\n{loads}*END STEP\n")
    return case_document(read(folder / "deck.inp"), "deck", temperature_change_K=0.0)


@pytest.mark.parametrize("cards", [
    "*KINEMATIC COUPLING, REF NODE=2\n3, 1, 6\n", "*KINEMATIC COUPLING, REF NODE=2\nFAR\n",
    "*SURFACE, NAME=S, TYPE=NODE\nFAR\n*COUPLING, REF NODE=2, SURFACE=S, CONSTRAINT NAME=C\n*KINEMATIC\n",
    "*SURFACE, NAME=S, TYPE=NODE\n3, 1.\n*COUPLING, REF NODE=2, SURFACE=S, CONSTRAINT NAME=C\n*KINEMATIC\n1, 3\n4, 6\n",
    "*RIGID BODY, REF NODE=2, TIE NSET=FAR\n",
])
def test_couplings_of_abaqus_carry_beams(cards: str, tmp_path: Path) -> None:
    """The same frame as of RBE2: u = (4³ - 2³ + 1³)/3 F/(E I)."""
    made = abaqus(tmp_path, cards, "4, 2, .01\n")
    assert moved(made, "N4")[1] * STIFF / EI == pytest.approx(57 / 3, rel=1e-4)


@pytest.mark.parametrize("cards", ["*KINEMATIC COUPLING, REF NODE=2\n3, 1, 3\n", "*RIGID BODY, REF NODE=2, NSET=FAR\n",
                                   "*RIGID BODY, REF NODE=2, PIN NSET=FAR\n"])
def test_couplings_of_displacements_are_hinges(cards: str, tmp_path: Path) -> None:
    """The far beam ends on a support: half of a force in its middle reaches the hinge at the end of the arm of 1 m."""
    made = abaqus(tmp_path, cards + "*BOUNDARY\n4, 2, 4\n", "3, 2, .01\n")
    assert made["rigid"][0]["rotations"] == []
    assert moved(made, "N3")[1] * STIFF / EI == pytest.approx(26 / 3 + SHEAR, rel=1e-5)


def test_the_node_of_rotations_passes_moments_and_supports(tmp_path: Path) -> None:
    """A moment on the node of rotations bends the cantilever: u = M L²/2 at its end."""
    body = "*RIGID BODY, REF NODE=8, ROT NODE=9, TIE NSET=T\n*NSET, NSET=T\n2, 3\n"
    made = abaqus(tmp_path, body, "9, 3, .01\n")
    assert moved(made, "N2")[1] * STIFF / EI == pytest.approx(2, rel=1e-4)
    held = abaqus(tmp_path, body + "*BOUNDARY\n9, 3, 3\n", "2, 2, .01\n")
    assert moved(held, "N2")[1] * STIFF / EI == pytest.approx(8 / 12 + SHEAR, rel=1e-5)  # guided: F L³/(12 E I)


@pytest.mark.parametrize("cards, code, fields", [
    ("*RIGID BODY, REF NODE=2, ELSET=B\n", "deck_not_supported", {"card": "*RIGID BODY, ELSET", "reason": "no_truss"}),
    ("*RIGID BODY, REF NODE=2\n", "deck_incomplete", {"card": "*RIGID BODY"}),
    ("*RIGID BODY, REF NODE=2, ROT NODE=2, NSET=FAR\n", "deck_not_supported",
     {"card": "*RIGID BODY, ROT NODE", "reason": "same_node"}),
    ("*KINEMATIC COUPLING, REF NODE=NALL\n3\n", "deck_bad_value", {"card": "*KINEMATIC COUPLING"}),
    ("*KINEMATIC COUPLING, REF NODE=2\n3, 4, 9\n", "deck_bad_value", {}),
    ("*KINEMATIC COUPLING, REF NODE=2\n3, 4, 6\n", "deck_not_supported",
     {"card": "*KINEMATIC COUPLING", "reason": "partial_coupling"}),
    ("*KINEMATIC\n1, 3\n", "deck_incomplete", {"card": "*KINEMATIC"}),
    ("*SURFACE, NAME=S\nB, S1\n*COUPLING, REF NODE=2, SURFACE=S\n*KINEMATIC\n", "deck_not_supported",
     {"card": "*COUPLING, SURFACE", "reason": "surface_of_elements"}),
])
def test_other_couplings_of_abaqus_are_refused(cards: str, code: str, fields: dict[str, str], tmp_path: Path) -> None:
    with pytest.raises(sj.StatejumpError) as refused:
        abaqus(tmp_path, cards, "4, 2, .01\n")
    assert refused.value == failure(code, **fields)
