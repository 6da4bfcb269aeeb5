# SPDX-License-Identifier: GPL-3.0-or-later
"""Means (RBE3, *DISTRIBUTING) and equations of rotations (MPC, *EQUATION) of decks, with closed forms."""
from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from failures import failure
from test_truss_mean import FORCE, LEG, MOMENT, PLACES, REFERENCE, STIFFNESS, WEIGHTS, distributed

import statejump as sj
from statejump.kinds.truss.importing import SYSTEMS, Options, case_document, read

HEAD = "SOL 101\nCEND\nSPC = 1\nLOAD = 5\nMPC = 7\nBEGIN BULK\n"
# Beams of E I = 700 N m2 about both axes, nearly rigid in tension.
SECTION = "PBAR,1,1,1.,1.-8,1.-8,1.-8\nMAT1,1,7.+10,,.3\n"
E_I, P = 700.0, 1e-2


def document(folder: Path, text: str, units: str = "SI", **options: Any) -> dict[str, Any]:
    """Return the document of a deck of Nastran or CalculiX."""
    path = folder / ("deck.inp" if text.startswith("*") else "deck.bdf")
    path.write_text(text if text.startswith("*") else f"{HEAD}{text}ENDDATA\n")
    return case_document(read(path, options=Options(**options)), "deck", units=SYSTEMS[units], temperature_change_K=0.0)


def refusal(folder: Path, text: str, **options: Any) -> sj.StatejumpError:
    with pytest.raises(sj.StatejumpError) as refused:
        document(folder, text, **options)
    return refused.value


def state(made: dict[str, Any], key: str, node: str) -> np.ndarray:
    at = [item["name"] for item in made["node"]].index(node)
    return np.asarray(sj.load(made).reduced().history[key].values[-1, at])


def legs() -> str:
    """Nodes 1 to 4 on three rods each, of 7e6 N/m along x, y and z; the reference 5."""
    text, number = "", 0
    for at, place in enumerate(PLACES, start=1):
        text += f"GRID,{at},,{','.join(map(str, place))}\n"
        for axis in np.eye(3):
            number += 1
            text += f"GRID,{100 + number},,{','.join(map(str, place + axis))}\nCROD,{number},1,{at},{100 + number}\n"
    text += "".join(f"SPC1,1,123,{100 + at}\n" for at in range(1, number + 1))
    return f"{text}GRID,5,,{','.join(map(str, REFERENCE))}\nPROD,1,1,1.-4\nMAT1,1,7.+10,,.3\n"


def load(force: np.ndarray, moment: np.ndarray) -> str:
    text = f"FORCE,5,5,,1.,{','.join(f'{part:.9f}' for part in force)}\n"
    return text + (f"MOMENT,5,5,,1.,{','.join(f'{part:.9f}' for part in moment)}\n" if moment.any() else "")


RBE3 = "RBE3,9,,5,123456,1.,123,1,2.,\n,123,2,3.,123,3,.5,123\n,4\n"


def test_rbe3_distributes_force_and_moment(tmp_path: Path) -> None:
    made = document(tmp_path, legs() + RBE3 + load(FORCE, MOMENT))
    assert made["mean"] == [{"name": "M1", "reference": "N5", "nodes": ["N1", "N2", "N3", "N4"], "weights": WEIGHTS.tolist()}]
    run = sj.load(made).reduced()
    names = [node["name"] for node in made["node"]]
    moved = run.history["displacement_m"].values[-1][[names.index(f"N{at}") for at in (1, 2, 3, 4)]]
    assert moved * STIFFNESS == pytest.approx(distributed(FORCE, MOMENT), abs=1e-10)


def test_an_rbe3_without_moment_needs_no_rotation(tmp_path: Path) -> None:
    made = document(tmp_path, legs() + RBE3 + load(FORCE, np.zeros(3)))
    assert made["mean"][0]["directions"] == ["x", "y", "z"]
    assert state(made, "displacement_m", "N3") * STIFFNESS == pytest.approx(distributed(FORCE, np.zeros(3))[2], abs=1e-10)


def test_an_rbe3_at_the_end_of_a_beam(tmp_path: Path) -> None:
    """A rigid beam stub to a force: the mean carries its moment. A deck in mm and N gives the same displacements."""
    stub = "GRID,6,,{0}\nCBAR,90,2,5,6,.3,.2,.1\nPBAR,2,1,1.,1.,1.,1.\nFORCE,5,6,,1.,{1}\n"
    tip = REFERENCE + [0, 0, 1.0]
    text = legs() + RBE3 + stub.format(",".join(map(str, tip)), ",".join(f"{part:.9f}" for part in FORCE))
    wanted = distributed(FORCE, np.cross(tip - REFERENCE, FORCE))
    made = document(tmp_path, text)
    assert "directions" not in made["mean"][0]
    for at in range(4):
        assert state(made, "displacement_m", f"N{at + 1}") * STIFFNESS == pytest.approx(wanted[at], abs=1e-9)


def test_components_of_the_displacement_system(tmp_path: Path) -> None:
    """REFC 3 in a system turned by 90 degrees about x is -y; the force acts along it, at the centre."""
    centre = WEIGHTS @ PLACES / WEIGHTS.sum()
    text = legs().replace(f"GRID,5,,{','.join(map(str, REFERENCE))}", f"GRID,5,,{','.join(f'{part:.9f}' for part in centre)},7")
    text += "CORD2R,7,,0.,0.,0.,0.,-1.,0.,\n,1.,0.,0.\n" + RBE3.replace("123456", "3") + "FORCE,5,5,,1.,0.,.01,0.\n"
    made = document(tmp_path, text)
    assert made["mean"][0]["directions"] == ["y"]
    assert state(made, "displacement_m", "N2")[1] * STIFFNESS == pytest.approx(0.01 * 2 / 6.5, rel=1e-6)


FRAME = "GRID,1,,0.,0.,0.\nGRID,2,,1.,0.,0.\nGRID,3,,0.,3.,0.\nGRID,4,,2.,3.,0.\nCBAR,1,1,1,2,0.,1.,0.\nCBAR,2,1,3,4,0.,1.,0.\n" \
    f"SPC1,1,123456,1,3\n{SECTION}FORCE,5,2,,{P},0.,1.,0.\n"


@pytest.mark.parametrize("units, length", [("SI", 1.0), ("mm-N", 1e3)])
def test_equations_of_rotations(units: str, length: float, tmp_path: Path) -> None:
    """MPC θ_2 - 2 θ_4 = 0: with M on the long tip 2 M' turns it, P/2 - M = M, E I θ_2 = P/2 - M, E I θ_4 = 2 · 2 M."""
    text = FRAME + "MPC,7,2,6,1.,4,6,-2.\n"
    if length != 1:
        text = FRAME.replace("1.,0.,0.\nGRID,3", "1000.,0.,0.\nGRID,3").replace("0.,3.,0.", "0.,3000.,0.").replace(
            "2.,3.,0.", "2000.,3000.,0.").replace("PBAR,1,1,1.,1.-8,1.-8,1.-8", "PBAR,1,1,1.+6,1.+4,1.+4,1.+4").replace(
            "7.+10", "7.+4") + "MPC,7,2,6,1.,4,6,-2.\n"
    made = document(tmp_path, text, units)
    (tie,) = made["constraint"]
    assert (tie["nodes"], tie["directions"]) == (["N2", "N4"], ["Rz", "Rz"])
    # Virtual work: the tie carries M on node 2 and 2 M on node 4; θ_2 = (P/2 - M)/EI = 2 θ_4 = 2 · 2 M · 2/EI.
    turned = P / 2 * (1 - 1 / 9)
    assert state(made, "rotation_rad", "N2")[2] * E_I == pytest.approx(turned, rel=1e-5)
    assert state(made, "rotation_rad", "N4")[2] * E_I == pytest.approx(turned / 2, rel=1e-5)


@pytest.mark.parametrize("units, length", [("SI", 1.0), ("mm-N", 1e3)])
def test_equations_of_a_displacement_and_a_rotation(units: str, length: float, tmp_path: Path) -> None:
    """u_4 = 2 m θ_2 where the tip of 1 m turns: the coefficient has the unit of length of the deck."""
    text = FRAME
    if length != 1:
        text = FRAME.replace("1.,0.,0.\nGRID,3", "1000.,0.,0.\nGRID,3").replace("0.,3.,0.", "0.,3000.,0.").replace(
            "2.,3.,0.", "2000.,3000.,0.").replace("PBAR,1,1,1.,1.-8,1.-8,1.-8", "PBAR,1,1,1.+6,1.+4,1.+4,1.+4").replace(
            "7.+10", "7.+4")
    made = document(tmp_path, text + f"MPC,7,4,2,1.,2,6,{-2 * length}\n", units)
    # The moment M = 2 · 3 E I u_4/8 acts back on node 2: E I θ_2 = P/2 - M, u_4 = 2 θ_2.
    turned = P / 2 / (1 + 12 / 8)
    assert made["constraint"][0]["coefficients"] == pytest.approx([1.0, -2.0])
    assert state(made, "displacement_m", "N4")[1] * E_I == pytest.approx(2 * turned, rel=1e-5)


def test_an_equation_of_one_rotation_is_a_support(tmp_path: Path) -> None:
    made = document(tmp_path, FRAME + "MPC,7,2,6,3.,1,6,1.\n")
    assert "constraint" not in made and made["node"][1]["fixed_rotations"] == ["z"]
    assert state(made, "displacement_m", "N2")[1] * E_I == pytest.approx(P / 12, rel=1e-5)


def test_rbe3_with_rotations_of_its_nodes(tmp_path: Path) -> None:
    """The reference 5 between the tips of two equal cantilevers follows their displacements and rotations. A symmetric
    moment about z at it: with the weights w of displacements and w L² of rotations, both tips turn alike."""
    text = "".join(f"GRID,{at},,{x},{y},0.\n" for at, x, y in ((1, 0, 0), (2, 1, 0), (3, 0, 4), (4, 1, 4), (5, 1, 2))) + \
        "CBAR,1,1,1,2,0.,1.,0.\nCBAR,2,1,3,4,0.,1.,0.\nGRID,6,,2.,2.,0.\nCBAR,3,1,5,6,0.,1.,0.\n" \
        f"SPC1,1,123456,1,3\n{SECTION}MOMENT,5,6,,{P},0.,0.,1.\nRBE3,9,,5,123456,1.,123456,2,4\n"
    made = document(tmp_path, text)
    assert "mean" not in made and len(made["constraint"]) == 6
    # r = L = 2, and the cantilevers are rigid in tension. Fit: (Σ r² + Σ L²) θ = Σ r u + L² Σ θ_i, so each tip carries
    # the moment P L²/16.
    assert state(made, "rotation_rad", "N2")[2] * E_I == pytest.approx(P / 4, rel=1e-4)
    assert state(made, "rotation_rad", "N5")[2] * E_I == pytest.approx(P / 8, rel=1e-4)


BAR_DECK = legs() + load(FORCE, np.zeros(3))


@pytest.mark.parametrize("cards, card, reason", [
    (RBE3.replace(",4\n", ",4,ALPHA,1.-5\n"), "RBE3.ALPHA", "mean_expands"),
    (RBE3.replace("2.,\n,123", "2.,\n,1235"), "RBE3", "mean_of_rotations"),
    ("RBE3,9,,5,123456,1.,123,1,2\n", "RBE3", "mean_undetermined"),
    (RBE3 + "MPC,7,1,4,1.,2,1,-1.\n", "MPC", "rotation"),
])
def test_what_a_case_cannot_contain_is_refused(cards: str, card: str, reason: str, tmp_path: Path) -> None:
    assert refusal(tmp_path, BAR_DECK + cards) == failure("deck_not_supported", card=card, reason=reason)


def test_other_fields_may_be_ignored(tmp_path: Path) -> None:
    made = document(tmp_path, BAR_DECK + RBE3.replace(",4\n", ",4,UM,1,123,,,,,\n,ALPHA,1.-5\n"),
                    ignored=frozenset({"RBE3.ALPHA"}))
    assert made["mean"] == document(tmp_path, BAR_DECK + RBE3)["mean"]


@pytest.mark.parametrize("card", ["RBE3,9,,5,123,0.,123,1\n", "RBE3,9,,5,127,1.,123,1\n", "RBE3,9,,5,123,1.,123\n", "RBE3,9,,5,123\n"])
def test_damaged_cards_are_named(card: str, tmp_path: Path) -> None:
    assert refusal(tmp_path, BAR_DECK + card) == failure("deck_bad_value" if card.count(",") > 4 else "deck_incomplete")


INP = "*NODE\n" + "".join(f"{at}, {', '.join(map(str, place))}\n" for at, place in enumerate(PLACES, start=1)) + \
    "".join(f"{10 * at + 1 + k}, {', '.join(map(str, place + axis))}\n" for at, place in enumerate(PLACES, start=1) for k, axis in enumerate(np.eye(3))) + \
    "5, {reference}\n*ELEMENT, TYPE=T3D2, ELSET=BARS\n" + \
    "".join(f"{10 * at + 1 + k}, {at}, {10 * at + 1 + k}\n" for at in (1, 2, 3, 4) for k in range(3)) + \
    "*MATERIAL, NAME=M\n*ELASTIC\n7.E10, .3\n*SOLID SECTION, ELSET=BARS, MATERIAL=M\n1.E-4\n*BOUNDARY\n" + \
    "".join(f"{10 * at + 1 + k}, 1, 3\n" for at in (1, 2, 3, 4) for k in range(3)) + \
    "{coupling}*STEP\n*STATIC\n*CLOAD\n{loads}*END STEP\n"
SURFACE = "*SURFACE, NAME=S, TYPE=NODE\n" + "".join(f"{at}, {weight}\n" for at, weight in enumerate(WEIGHTS, start=1)) + \
    "*COUPLING, REF NODE=5, SURFACE=S, CONSTRAINT NAME=C\n*DISTRIBUTING{more}\n{dofs}"
AT = ", ".join(map(str, REFERENCE))
CENTRE = ", ".join(f"{part:.12f}" for part in WEIGHTS @ PLACES / WEIGHTS.sum())
ELEMENT = "*ELEMENT, TYPE=DCOUP3D, ELSET=D\n99, 5\n*DISTRIBUTING COUPLING, ELSET=D\n" + \
    "".join(f"{at}, {weight}\n" for at, weight in enumerate(WEIGHTS, start=1))


def cloads(force: np.ndarray, moment: np.ndarray) -> str:
    return "".join(f"5, {at}, {value}\n" for at, value in enumerate((*force, *moment), start=1) if value)


@pytest.mark.parametrize("dofs", ["", "1, 6\n", "1, 3\n4, 6\n"])
def test_distributing_couplings_of_surfaces_of_nodes(dofs: str, tmp_path: Path) -> None:
    made = document(tmp_path, INP.format(reference=AT, coupling=SURFACE.format(more="", dofs=dofs), loads=cloads(FORCE, MOMENT)))
    assert made["mean"][0]["weights"] == WEIGHTS.tolist()
    assert state(made, "displacement_m", "N4") * STIFFNESS == pytest.approx(distributed(FORCE, MOMENT)[3], abs=1e-10)


def test_distributing_coupling_of_an_element(tmp_path: Path) -> None:
    made = document(tmp_path, INP.format(reference=CENTRE, coupling=ELEMENT, loads=cloads(FORCE, np.zeros(3))))
    assert state(made, "displacement_m", "N2") * STIFFNESS == pytest.approx(FORCE * 2 / 6.5, abs=1e-10)


@pytest.mark.parametrize("reference, coupling, card, reason", [
    (AT, ELEMENT, "*DISTRIBUTING COUPLING", "mean_reference_aside"),
    (AT, SURFACE.format(more=", WEIGHTING METHOD=LINEAR", dofs=""), "*DISTRIBUTING, WEIGHTING METHOD", "mean_weighting"),
    (AT, SURFACE.format(more=", COUPLING=STRUCTURAL", dofs=""), "*DISTRIBUTING, COUPLING", "mean_weighting"),
    (AT, SURFACE.format(more="", dofs="3, 6\n"), "*DISTRIBUTING", "partial_coupling"),
])
def test_other_distributing_couplings_are_refused(reference: str, coupling: str, card: str, reason: str, tmp_path: Path) -> None:
    text = INP.format(reference=reference, coupling=coupling, loads=cloads(FORCE, np.zeros(3)))
    assert refusal(tmp_path, text) == failure("deck_not_supported", card=card, reason=reason)


def test_equations_of_rotations_of_calculix(tmp_path: Path) -> None:
    """Two cantilevers of 1 m and 2 m whose tips turn alike, as in a test of cases."""
    text = "*NODE\n1, 0., 0., 0.\n2, 1., 0., 0.\n3, 0., 3., 0.\n4, 2., 3., 0.\n*ELEMENT, TYPE=B31, ELSET=B\n1, 1, 2\n2, 3, 4\n" \
        "*MATERIAL, NAME=M\n*ELASTIC\n7.E10, .3\n*BEAM SECTION, ELSET=B, MATERIAL=M, SECTION=RECT\n.02, .01\n0., 1., 0.\n" \
        "*BOUNDARY\n1, 1, 6\n3, 1, 6\n*EQUATION\n2\n2, 6, 1., 4, 6, -1.\n*STEP\n*STATIC\n*CLOAD\n2, 2, .01\n*END STEP\n"
    made = document(tmp_path, text)
    turned = [state(made, "rotation_rad", node)[2] for node in ("N2", "N4")]
    assert turned[0] == turned[1] == pytest.approx(0.01 / 3 / (7e10 * 0.01 * 0.02**3 / 12), rel=1e-2)  # shear turns none


def test_legs_are_those_of_the_cases() -> None:
    assert STIFFNESS == LEG["young_modulus_Pa"] * LEG["cross_section_area_m2"]
