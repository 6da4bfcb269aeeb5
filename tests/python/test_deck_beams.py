# SPDX-License-Identifier: GPL-3.0-or-later
"""Beams of decks, against closed forms."""
from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from failures import failure

import statejump as sj
from statejump.kinds.truss.importing import Options, case_document, profiles, read

HEAD = "SOL 101\nCEND\nSPC = 1\nLOAD = 5\nTEMP(LOAD) = 6\nBEGIN BULK\n"
# A cantilever of 2 m along x. E = 2e11, I1 = 4e-8 bends it along axis y of the section, I2 = 1e-8 along z; a load of
# 1 N keeps rotations near 1e-4.
BEAM = """GRID,1,,0.,0.,0.
GRID,2,,2.,0.,0.
SPC1,1,123456,1
PBAR,1,1,1.-4,4.-8,1.-8,3.-8
MAT1,1,2.+11,,.3,7800.,1.2-5
"""
LENGTH, MODULUS, STRONG, WEAK, TORSION = 2.0, 2e11, 4e-8, 1e-8, 3e-8
SOFT_Y, SOFT_Z = LENGTH**3 / (3 * MODULUS * STRONG), LENGTH**3 / (3 * MODULUS * WEAK)
INP = """*NODE
1, 0., 0., 0.
2, 1., 0., 0.
3, 2., 0., 0.
*ELEMENT, TYPE=B32, ELSET=B
1, 1, 2, 3
*MATERIAL, NAME=M
*ELASTIC
2.E11, .3
*BEAM SECTION, ELSET=B, MATERIAL=M, SECTION=RECT
.02, .01
0., 1., 0.
*BOUNDARY
1, 1, 6
*STEP
*STATIC
"""


def made(folder: Path, text: str, name: str = "deck.bdf", change: float | None = 0.0, **options: Any) -> dict[str, Any]:
    """Return the document of a deck."""
    (folder / name).write_text(text)
    return case_document(read(folder / name, options=Options(**options)), "deck", temperature_change_K=change)


def nastran(folder: Path, bulk: str, **options: Any) -> dict[str, Any]:
    """Return the document of a Nastran deck."""
    head = HEAD if any(name in bulk for name in ("FORCE", "MOMENT", "PLOAD1", "GRAV")) else HEAD.replace("LOAD = 5\n", "")
    return made(folder, (head if "TEMP" in bulk else head.replace("TEMP(LOAD) = 6\n", "")) + bulk + "ENDDATA\n",
                **options)


def moved(document: dict[str, Any], node: str = "N2", key: str = "displacement_m") -> np.ndarray:
    """Return the displacement or the rotation of a node at the largest temperature change."""
    run = sj.load(document).reduced()
    at = int(np.argmax(np.abs(run.history["temperature_change_K"].values)))
    names = [item["name"] for item in document["node"]]
    return np.asarray(run.history[key].values[at, names.index(node)])


@pytest.mark.parametrize("axis, force, tip", [
    ("0.,1.,0.", (0, 1, 0), SOFT_Y), ("0.,1.,0.", (0, 0, 1), SOFT_Z), ("0.,0.,1.", (0, 1, 0), SOFT_Z),
    ("1.,0.,3.", (0, 0, 1), SOFT_Y), ("3", (0, 0, 1), SOFT_Y)])
def test_cantilever_bends_by_its_orientation(axis: str, force: tuple[int, int, int], tip: float, tmp_path: Path) -> None:
    grid = "GRID,3,,0.,0.,5.\n"
    document = nastran(tmp_path, BEAM + grid + f"CBAR,1,1,1,2,{axis}\nFORCE,5,2,,1.,{','.join(f'{one}.' for one in force)}\n")
    assert "link" not in document and document["node"][0]["fixed_rotations"] == ["x", "y", "z"]
    assert moved(document) @ np.array(force) == pytest.approx(tip, rel=1e-6)


def test_loads_that_vanish_beside_the_stiffness_converge(tmp_path: Path) -> None:
    """Two stout beams that meet at an angle: their rotations are near the rounding of 1."""
    bulk = """GRID,1,,0.,0.,0.
GRID,2,,10.,0.,0.
GRID,3,,11.,1.,1.
CBAR,1,1,1,2,1.,0.,1.
CBAR,2,1,2,3,1.,0.,1.
PBAR,1,1,1.,1.,1.,1.
MAT1,1,3.+7,,.3
SPC1,1,123456,1
"""
    tips = [moved(nastran(tmp_path, bulk + f"FORCE,5,3,,{size},1.,0.,0.\n"), "N3") / size for size in (1e4, 1e-4)]
    assert tips[1] == pytest.approx(tips[0], rel=5e-2)


def test_orientation_follows_the_system_of_the_first_node(tmp_path: Path) -> None:
    system = "CORD2R,9,,0.,0.,0.,1.,0.,0.,0.,1.,0.\n".replace("1.,0.,0.,0.,1.,0.", "1.,0.,0.\n,0.,1.,0.")
    bulk = BEAM.replace("GRID,1,,0.,0.,0.", "GRID,1,,0.,0.,0.,9") + system
    # Its z is along x of the basic system, its x along y, its y therefore along z.
    load = "FORCE,5,2,,1.,0.,1.,0.\n"
    assert moved(nastran(tmp_path, bulk + "CBAR,1,1,1,2,1.,0.,0.\n" + load))[1] == pytest.approx(SOFT_Y, rel=1e-6)
    assert moved(nastran(tmp_path, bulk + "CBAR,1,1,1,2,0.,1.,0.,BGG\n" + load))[1] == pytest.approx(SOFT_Y, rel=1e-6)
    assert moved(nastran(tmp_path, bulk + "CBAR,1,1,1,2,0.,1.,0.\n" + load))[1] == pytest.approx(SOFT_Z, rel=1e-6)


def test_pin_flags_release_moments(tmp_path: Path) -> None:
    """Two beams between clamps meet at a node. One does not transmit moments to it, so both bend as cantilevers."""
    bulk = BEAM + f"GRID,3,,{2 * LENGTH},0.,0.\nSPC1,1,123456,3\nFORCE,5,2,,1.-2,0.,1.,0.\n"
    joined = "CBAR,1,1,1,2,0.,1.,0.\nCBAR,2,1,2,3,0.,1.,0.\n"
    alone = 1e-2 * LENGTH**3 / (6 * MODULUS * STRONG)  # so small that the beams do not stretch
    assert moved(nastran(tmp_path, bulk + joined))[1] == pytest.approx(alone / 4, rel=1e-6)
    document = nastran(tmp_path, bulk + joined.replace("1,1,1,2,0.,1.,0.", "1,1,1,2,0.,1.,0.\n,,456"))
    assert document["beam"][0]["released_second"] == ["Rx", "Ry", "Rz"]
    assert moved(document)[1] == pytest.approx(alone, rel=1e-6)


def test_both_ends_released_carry_axial_force_only(tmp_path: Path) -> None:
    bulk = BEAM + "SPC1,1,23,2\nFORCE,5,2,,1.,1.,0.,0.\nCBAR,1,1,1,2,0.,1.,0.\n,456,456\n"
    assert moved(nastran(tmp_path, bulk))[0] == pytest.approx(LENGTH / (MODULUS * 1e-4), rel=1e-9)


def test_offsets_turn_with_their_nodes(tmp_path: Path) -> None:
    """The axis of the beam is beside its nodes by h, so a force along it bends it by the moment of h."""
    h = 0.2
    bar = f"CBAR,1,1,1,2,0.,1.,0.\n,,,0.,0.,{h},0.,0.,{h}\n"
    document = nastran(tmp_path, BEAM + bar + "FORCE,5,2,,1.-3,1.,0.,0.\n")
    assert document["beam"][0]["offset_second_m"] == pytest.approx([0, 0, h])
    expected = LENGTH / (MODULUS * 1e-4) + h**2 * LENGTH / (MODULUS * WEAK)
    # Its rotation of 2e-7 shortens it by the rotation over 2 h, in relation to the displacement.
    assert moved(document)[0] == pytest.approx(1e-3 * expected, rel=2e-6)


def test_moments_bend_and_twist(tmp_path: Path) -> None:
    bar = BEAM + "CBAR,1,1,1,2,0.,1.,0.\n"
    turned = moved(nastran(tmp_path, bar + "MOMENT,5,2,,1.,0.,0.,1.\n"), key="rotation_rad")
    assert turned == pytest.approx([0, 0, LENGTH / (MODULUS * STRONG)], rel=1e-6, abs=1e-12)
    turned = moved(nastran(tmp_path, bar + "MOMENT,5,2,,1.,1.,0.,0.\n"), key="rotation_rad")
    assert turned[0] == pytest.approx(LENGTH * 2.6 / (MODULUS * TORSION), rel=1e-6)


def test_product_of_inertia_turns_the_principal_axes(tmp_path: Path) -> None:
    # The section I1 = 4e-8, I2 = 1e-8 rotated by 30° about x.
    c, s = np.cos(np.radians(30)), np.sin(np.radians(30))
    one, two, product = 4e-8 * c**2 + 1e-8 * s**2, 4e-8 * s**2 + 1e-8 * c**2, 3e-8 * s * c
    pbar = f"PBAR,1,1,1.-4,{one:.6e},{two:.6e},3.-8\n,,,,,,,,\n,,,{product:.6e}\n"
    bulk = BEAM.replace("PBAR,1,1,1.-4,4.-8,1.-8,3.-8\n", pbar) + "CBAR,1,1,1,2,0.,1.,0.\n"
    beam = nastran(tmp_path, bulk + "FORCE,5,2,,1.,0.,1.,0.\n")["beam"][0]
    assert beam["second_moments_of_area_m4"] == pytest.approx([1e-8, 4e-8], rel=1e-5)
    assert beam["axis_y"] == pytest.approx([0, c, s], abs=1e-5)


SIZES = [  # shape of PBARL, sizes, second moments about y and z and product by hand, torsion constant
    ("BAR", [2.0, 6.0], (6 * 8 / 12, 2 * 216 / 12, 0), 12.6386),
    ("TUBE", [2.0, 1.0], (np.pi / 4 * 15, np.pi / 4 * 15, 0), np.pi / 2 * 15),
    ("BOX", [4.0, 6.0, 1.0, 0.5], ((6 * 64 - 4 * 27) / 12, (4 * 216 - 3 * 64) / 12, 0), 4 * (3.5 * 5) ** 2 / (7 + 20)),
    ("I1", [3.0, 1.0, 4.0, 6.0], ((2 * 64 + 4) / 12, (4 * 216 - 3 * 64) / 12, 0), (4 + 4 + 4) / 3),
    ("H", [2.0, 2.0, 4.0, 1.0], (8 / 12 + 2 * (4 / 12 + 4 * 2.25), 2 * 64 / 12 + 2 / 12, 0), (4 + 4 + 2) / 3),
    ("Z", [2.0, 1.0, 4.0, 6.0], (4 / 12 + 2 * (27 / 12 + 3), 64 / 12 + 2 * (3 / 12 + 3 * 6.25), -15.0), (4 + 3 + 3) / 3),
    ("CROSS", [2.0, 1.0, 5.0, 1.0], (5 / 12 + 2 * (1 / 12 + 1), 125 / 12 + 2 / 12, 0), (5 + 1 + 1) / 3),
    ("HEXA", [1.0, 4.0, 2.0], (2 * 8 / 12 + 2 * (2 / 36 + 16 / 9), 2 * 8 / 12 + 2 * 8 / 48, 0), None),
]


@pytest.mark.parametrize("shape, sizes, moments, torsion", SIZES)
def test_sections_by_their_sizes(shape: str, sizes: list[float], moments: tuple[float, float, float],
                                 torsion: float | None) -> None:
    found = profiles.nastran(shape, sizes)
    assert found is not None
    assert (*found.moments, found.product) == pytest.approx(moments, rel=1e-12, abs=1e-12)
    assert torsion is None or found.torsion == pytest.approx(torsion, rel=1e-3)


def test_two_cells_of_one_wall_are_one_cell() -> None:
    """The shared wall of two equal cells carries no shear flow."""
    wall, box = 0.01, profiles.nastran("BOX", [2.0, 1.0, 0.01, 0.01])
    found = profiles.nastran("DBOX", [2.0, 1.0, 1.0, *[wall] * 7])
    assert box and found and found.torsion == pytest.approx(box.torsion, rel=1e-2)


def test_uniform_load_on_a_beam(tmp_path: Path) -> None:
    bar = BEAM + "CBAR,1,1,1,2,0.,1.,0.\n"
    tip = LENGTH**4 / (8 * MODULUS * STRONG)
    for kind in ("FY", "FYE"):
        document = nastran(tmp_path, bar + f"PLOAD1,5,1,{kind},LE,0.,1.,2.,1.\n")
        assert moved(document)[1] == pytest.approx(tip, rel=1e-6)
        assert moved(document, key="rotation_rad")[2] == pytest.approx(LENGTH**3 / (6 * MODULUS * STRONG), rel=1e-6)


@pytest.mark.parametrize("load, tip", [
    ("FZ,FR,.5,1.", (LENGTH / 2) ** 2 * (3 * LENGTH - LENGTH / 2) / (6 * MODULUS * WEAK)),  # a force at its middle
    ("FZ,FR,0.,0.,1.,1.", 11 * LENGTH**4 / (120 * MODULUS * WEAK)),  # a triangle that rises to the tip
    ("MY,FR,.5,1.", -(LENGTH / 2) * (LENGTH - LENGTH / 4) / (MODULUS * WEAK)),  # a moment at its middle
])
def test_loads_on_a_part_of_a_beam(load: str, tip: float, tmp_path: Path) -> None:
    document = nastran(tmp_path, BEAM + f"CBAR,1,1,1,2,0.,1.,0.\nPLOAD1,5,1,{load}\n")
    assert moved(document)[2] == pytest.approx(tip, rel=1e-6)


def test_load_across_a_slope_counts_by_its_projection(tmp_path: Path) -> None:
    bulk = BEAM.replace("GRID,2,,2.,0.,0.", "GRID,2,,1.6,1.2,0.") + "CBAR,1,1,1,2,0.,0.,1.\n"
    found = [moved(nastran(tmp_path, bulk + f"PLOAD1,5,1,FY,{scale},0.,1.,1.,1.\n"))[1] for scale in ("FR", "FRPR")]
    assert found[1] == pytest.approx(0.8 * found[0], rel=1e-3)


def test_temperature_gradient_bends_a_cantilever(tmp_path: Path) -> None:
    # 6 m, 20 K over 0.4 m: curvature 1.2e-5 · 50 = 6e-4 1/m, tip 6e-4 · 36/2 = 10.8 mm.
    bulk = BEAM.replace("GRID,2,,2.", "GRID,2,,6.") + "CBAR,1,1,1,2,0.,1.,0.\nTEMPRB,6,1,0.,0.,50.,50.\n"
    tip = moved(nastran(tmp_path, bulk, change=None))
    assert tip[1] == pytest.approx(-10.8e-3, rel=1e-4) and tip[2] == pytest.approx(0, abs=1e-9)
    across = bulk.replace("0.,0.,50.,50.", "30.,10.,,,50.,50.")
    tip = moved(nastran(tmp_path, across, change=None))
    assert tip[2] == pytest.approx(-10.8e-3, rel=1e-3)
    assert tip[0] == pytest.approx(6 * 1.2e-5 * 20, rel=1e-2)
    with pytest.raises(sj.StatejumpError) as refused:
        nastran(tmp_path, bulk.replace("50.,50.", "50.,40."), change=None)
    assert refused.value == failure("deck_not_supported", card="TEMPRB", reason="temperature_gradient_varies")


def test_portal_sways_as_by_hand(tmp_path: Path) -> None:
    """Two clamped columns of height h and a beam of length l, all of one section: a force P at the top sways them by
    P h³ (3 k + 2)/(12 E I (6 k + 1)) with k = h/l, if axial strains are 0."""
    bulk = """GRID,1,,0.,0.,0.
GRID,2,,0.,2.,0.
GRID,3,,4.,2.,0.
GRID,4,,4.,0.,0.
GRDSET,,,,,,,345
CBAR,1,1,1,2,1.,0.,0.
CBAR,2,1,2,3,0.,1.,0.
CBAR,3,1,3,4,1.,0.,0.
SPC1,1,126,1,4
PBAR,1,1,1.,1.-6,1.-6,1.-6
MAT1,1,2.+11,,.3
FORCE,5,2,,10.,1.,0.,0.
"""
    height, span, stiffness = 2.0, 4.0, 2e11 * 1e-6
    ratio = height / span  # of the stiffness of the beam to that of a column
    sway = 10 * height**3 / (12 * stiffness) * (3 * ratio + 2) / (6 * ratio + 1)
    assert moved(nastran(tmp_path, bulk))[0] == pytest.approx(sway, rel=1e-4)


@pytest.mark.parametrize("axis, tip", [
    (2, 1 * LENGTH**3 / (3 * 2e11 * 0.01 * 0.02**3 / 12)), (3, 1 * LENGTH**3 / (3 * 2e11 * 0.02 * 0.01**3 / 12))])
def test_beam_of_three_nodes_becomes_two(axis: int, tip: float, tmp_path: Path) -> None:
    document = made(tmp_path, INP + f"*CLOAD\n3, {axis}, 1.\n*END STEP\n", "deck.inp")
    assert [beam["name"] for beam in document["beam"]] == ["B1_1", "B1_2"]
    assert abs(moved(document, "N3")[axis - 1]) == pytest.approx(tip, rel=2e-4)  # with the shear of the section


@pytest.mark.parametrize("load, tip", [
    ("B, P1, 100.", (0, 0.01 * 100 / (8 * 0.01 * 0.02**3 / 12), 0)),  # along n1, on the width along n2
    ("B, P2, 100.", (0, 0, 0.02 * 100 / (8 * 0.02 * 0.01**3 / 12))),
    ("B, GRAV, .1, 0., 0., -1.", (0, 0, -0.1 * 7800 * 2e-4 / (8 * 0.02 * 0.01**3 / 12)))])
def test_loads_along_beams_of_calculix(load: str, tip: tuple[float, float, float], tmp_path: Path) -> None:
    """The tip of a cantilever under a uniform load q moves by q l^4/(8 E I); checked with CalculiX 2.20."""
    text = INP.replace("*BEAM SECTION", "*DENSITY\n7800.\n*BEAM SECTION").replace(".3\n", "0.\n")
    document = made(tmp_path, text + f"*DLOAD\n{load}\n*END STEP\n", "deck.inp")
    wanted = np.array(tip) * LENGTH**4 / MODULUS
    assert moved(document, "N3") == pytest.approx(wanted, rel=1e-3, abs=1e-2 * np.abs(wanted).max())


def test_normal_gives_the_second_direction(tmp_path: Path) -> None:
    text = INP.replace("0., 1., 0.\n*B", "0., 0., 1.\n*NORMAL\n1, 1, 0., 0., 1.\n1, 2, 0., 0., 1.\n*B")
    beam = made(tmp_path, text + "*CLOAD\n3, 2, 1.\n*END STEP\n", "deck.inp")["beam"][0]
    assert beam["axis_y"] == pytest.approx([0, 1, 0])
    assert beam["second_moments_of_area_m4"] == pytest.approx([0.02 * 0.01**3 / 12, 0.01 * 0.02**3 / 12])


def test_general_section_and_moment(tmp_path: Path) -> None:
    text = INP.replace("*BEAM SECTION, ELSET=B, MATERIAL=M, SECTION=RECT\n.02, .01\n0., 1., 0.\n",
                       "*BEAM GENERAL SECTION, ELSET=B, SECTION=GENERAL\n1.E-4, 1.E-8, 0., 4.E-8, 3.E-8\n0., 1., 0.\n"
                       "2.E11, 7.7E10\n")
    document = made(tmp_path, text + "*CLOAD\n3, 6, 1.\n*END STEP\n", "deck.inp")
    assert moved(document, "N3", "rotation_rad")[2] == pytest.approx(LENGTH / (MODULUS * STRONG), rel=1e-6)
    assert document["beam"][0]["torsion_constant_m4"] == 3e-8


def test_tapered_beam_becomes_uniform_ones(tmp_path: Path) -> None:
    # I = I0 (1 + x/L): tip by the integral of x'^2 / (E I), with x' from the tip and I at it.
    bulk = BEAM.replace("PBAR,1,1,1.-4,4.-8,1.-8,3.-8\n",
                        "PBEAM,1,1,2.-4,8.-8,2.-8,,6.-8\n,,,,,,,,\n,NO,1.,1.-4,4.-8,1.-8,,3.-8\n,0.,0.\n")
    document = nastran(tmp_path, bulk + "CBEAM,1,1,1,2,0.,1.,0.\nFORCE,5,2,,1.,0.,1.,0.\n")
    assert len(document["beam"]) == 8
    exact = LENGTH**3 / (MODULUS * STRONG) * (np.log(2) - 0.5)
    assert moved(document)[1] == pytest.approx(exact, rel=3e-3)


def test_bars_and_beams_in_one_deck(tmp_path: Path) -> None:
    """A rod holds the tip of a cantilever: both share the force by their stiffness."""
    bulk = BEAM + "CBAR,1,1,1,2,0.,1.,0.\nGRID,3,,2.,-1.,0.\nSPC1,1,123456,3\nCROD,2,2,2,3\nPROD,2,1,1.-8\n"
    document = nastran(tmp_path, bulk + "FORCE,5,2,,1.,0.,1.,0.\n")
    assert len(document["link"]) == 1 and "fixed_rotations" not in document["node"][2]
    assert moved(document)[1] == pytest.approx(1 / (1 / SOFT_Y + MODULUS * 1e-8), rel=1e-5)


def test_rod_between_beams_twists(tmp_path: Path) -> None:
    """A rod between the tips of two cantilevers along z resists their opposite twist."""
    bulk = BEAM + ("CBAR,1,1,1,2,0.,1.,0.\nGRID,3,,3.,0.,0.\nGRID,4,,5.,0.,0.\nSPC1,1,123456,4\nCBAR,2,1,3,4,0.,1.,0.\n"
                   "CROD,3,2,2,3\nPROD,2,1,1.-4,3.-8\nMOMENT,5,2,,1.,1.,0.,0.\n")
    shear = MODULUS / 2.6 * TORSION
    turned = moved(nastran(tmp_path, bulk), key="rotation_rad")
    stiffness = shear / LENGTH + 1 / (1 / shear + LENGTH / shear)
    assert turned[0] == pytest.approx(1 / stiffness, rel=1e-4)


def test_weight_beside_a_node_is_a_moment(tmp_path: Path) -> None:
    document = nastran(tmp_path, BEAM + "CBAR,1,1,1,2,0.,1.,0.\nCONM2,9,2,,3.,.5,0.,0.\nGRAV,5,,10.,0.,-1.,0.\n")
    assert document["node"][1]["moment_N_m"] == pytest.approx([0, 0, -15])


def test_moment_reaches_a_beam_through_a_rigid_body(tmp_path: Path) -> None:
    arm = "GRID,3,,2.,1.,0.\nRBE2,9,2,123456,3\nFORCE,5,3,,1.,1.,0.,0.\n"
    document = nastran(tmp_path, BEAM + "CBAR,1,1,1,2,0.,1.,0.\n" + arm)
    assert document["node"][1]["moment_N_m"] == pytest.approx([0, 0, -1])


def test_rotations_without_stiffness_are_held_as_in_nastran(tmp_path: Path) -> None:
    bulk = BEAM.replace(",3.-8", "") + "CBAR,1,1,1,2,0.,1.,0.\nFORCE,5,2,,1.,0.,1.,0.\n"
    document = nastran(tmp_path, bulk)
    assert document["node"][1]["fixed_rotations"] == ["x"]
    assert moved(document)[1] == pytest.approx(SOFT_Y, rel=1e-6)


@pytest.mark.parametrize("cards, card, reason", [
    ("CBAR,1,1,1,2,0.,1.,0.\n,2\n", "CBAR.PA", "released_shear"),
    ("CBAR,1,1,1,2,0.,1.,0.,GOO\n,,,0.,.1,0.,0.,.1,0.\n", "CBAR.W1A-W3B", "offset_in_element"),
    ("CBAR,1,1,1,2,0.,1.,0.\nCELAS2,9,1.,2,6\n", "CELAS2", "rotation_spring"),
])
def test_what_beams_do_not_have_is_named(cards: str, card: str, reason: str, tmp_path: Path) -> None:
    with pytest.raises(sj.StatejumpError) as refused:
        nastran(tmp_path, BEAM + cards)
    assert refused.value == failure("deck_not_supported", card=card, reason=reason)


def test_beam_along_its_direction_is_an_error(tmp_path: Path) -> None:
    with pytest.raises(sj.StatejumpError) as refused:
        nastran(tmp_path, BEAM + "CBAR,1,1,1,2,1.,0.,0.\n")
    assert refused.value == failure("deck_bad_geometry")


def test_beams_as_bars_still_become_links(tmp_path: Path) -> None:
    document = nastran(tmp_path, BEAM + "CBAR,1,1,1,2,0.,1.,0.\nFORCE,5,2,,1.,1.,0.,0.\n", beams_as_bars=True)
    assert "beam" not in document and "fixed_rotations" not in document["node"][0]
