# SPDX-License-Identifier: GPL-3.0-or-later
"""Decks of CalculiX and Abaqus: keywords, sets, steps, and a closed form for every keyword."""
from __future__ import annotations

import time
from math import pi
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from failures import failure
import statejump as sj
from statejump.kinds.truss.importing import Options, case_document, read

# A rod of 7e6 N/m along x, free only along x at its end; 7000 N elongate it by 1 mm.
MODEL = """*NODE, NSET=NALL
1, 0., 0., 0.
2, 1., 0., 0.
*ELEMENT, TYPE=T3D2, ELSET=BARS
1, 1, 2
*MATERIAL, NAME=AL
*ELASTIC
7.e10, 0.3
*EXPANSION
2.3e-5
*DENSITY
2700.
*SOLID SECTION, ELSET=BARS, MATERIAL=AL
1.e-4
*BOUNDARY
1, 1, 3
2, 2, 3
"""
LOAD = "*STEP\n*STATIC\n*CLOAD\n2, 1, 7000.\n*END STEP\n"


def made(folder: Path, text: str, change: float | None = 0.0, **options: Any) -> dict[str, Any]:
    """Return the document of a deck."""
    (folder / "deck.inp").write_text(text)
    return case_document(read(folder / "deck.inp", options=Options(**options)), "deck", temperature_change_K=change)


def moved(document: dict[str, Any], node: str = "N2", axis: int = 0) -> float:
    """Return the displacement of a node at the largest temperature change."""
    run = sj.load(document).reduced()
    at = int(np.argmax(np.abs(run.history["temperature_change_K"].values)))
    names = [item["name"] for item in document["node"]]
    return float(run.history["displacement_m"].values[at, names.index(node), axis])


def refusal(folder: Path, text: str, **options: Any) -> sj.StatejumpError:
    """Return the error of a deck."""
    with pytest.raises(sj.StatejumpError) as refused:
        made(folder, text, **options)
    return refused.value


def test_springs_need_no_links(tmp_path: Path) -> None:
    text = MODEL[:MODEL.index("*ELEMENT")] + "*ELEMENT, TYPE=SPRINGA, ELSET=S\n1, 1, 2\n*SPRING, ELSET=S\n\n7.e6\n"
    document = made(tmp_path, text + MODEL[MODEL.index("*BOUNDARY"):] + LOAD)
    assert "link" not in document and moved(document) == pytest.approx(1e-3, rel=1e-9)


def test_a_bar_without_a_section_says_so(tmp_path: Path) -> None:
    text = MODEL[:MODEL.index("*SOLID")] + MODEL[MODEL.index("*BOUNDARY"):] + LOAD
    assert refusal(tmp_path, text) == failure("bar_without_property", cause="no section names it", property="Young's modulus")


NODES = MODEL[:MODEL.index("*ELEMENT")]
SAME = {  # replacements in the deck that do not change its meaning
    "elements before nodes": (MODEL, MODEL.replace(NODES, "") + NODES),
    "abbreviated parameters": ("*STEP", "*AMPLITUDE, NAME=RAMP, DEF=TABULAR\n0., 0., 1., 1.\n*STEP, NLGEO=NO, PERT"),
    "quoted names with commas": ("ELSET=BARS", 'ELSET="bars, left"'),
    "blanks left out": ("*SOLID SECTION", "*SOLIDSECTION"),
    "lower case": ("*ELASTIC", "*elastic"),
    "parameters over lines": ("*SOLID SECTION, ELSET=BARS,", "*SOLID SECTION,\nELSET=BARS,"),
    "exponents of Fortran": ("7.e10", "7.d10"),
    "named supports": ("1, 1, 3", "1, PINNED"),
    "an initial motion": ("*BOUNDARY", "*INITIAL CONDITIONS, TYPE=VELOCITY\n2, 1, 3.\n*BOUNDARY"),
    "an initial temperature that stays": ("*BOUNDARY", "*INITIAL CONDITIONS, TYPE=TEMPERATURE\nNALL, 20.\n*BOUNDARY"),
    "the same coefficient twice": ("2.3e-5\n", "2.3e-5, 0.\n2.3e-5, 100.\n"),
    "a coefficient of three equal directions": ("*EXPANSION\n2.3e-5", "*EXPANSION, TYPE=ORTHO, ZERO=20.\n2.3e-5, 2.3e-5, 2.3e-5"),
    "output": ("*END STEP", "*NODE PRINT, NSET=NALL\nU\n*EL FILE\nS\n*END STEP"),
}


@pytest.mark.parametrize("name", SAME)
def test_what_says_the_same_is_the_same(name: str, tmp_path: Path) -> None:
    old, new = SAME[name]
    text = MODEL + LOAD
    assert old in text
    assert moved(made(tmp_path, text.replace(old, new))) == pytest.approx(1e-3, rel=1e-12)


def test_an_abbreviation_has_three_letters_and_one_meaning(tmp_path: Path) -> None:
    for short in ("NL", "IN", "STE"):
        refused = refusal(tmp_path, MODEL + LOAD.replace("*STEP", f"*STEP, {short}"))
        assert refused == failure("deck_not_supported", card=f"*STEP, {short}", reason="unknown_parameter")
    full = refusal(tmp_path, MODEL + LOAD.replace("*CLOAD", "*CLOAD, DAT=1"))
    assert full == failure("deck_not_supported", card="*CLOAD, DATASET")
    two = refusal(tmp_path, MODEL + LOAD.replace("*STEP", "*AMPLITUDE, NAME=A, SHI=1.\n0., 0., 1., 1.\n*STEP"))
    assert two == failure("deck_not_supported", card="*AMPLITUDE, SHI", reason="unknown_parameter")


def test_a_deck_may_end_with_dat(tmp_path: Path) -> None:
    (tmp_path / "deck.dat").write_text("** written by a mesher\n\n" + MODEL + LOAD)
    found = case_document(read(tmp_path / "deck.dat"), "deck", temperature_change_K=0.0)
    assert {**found, "case": 0} == {**made(tmp_path, MODEL + LOAD), "case": 0}


def test_parameters_have_their_numbers(tmp_path: Path) -> None:
    text = MODEL.replace("7.e10", "<E>").replace("*NODE", "*PARAMETER\nE = 7.e10  # of aluminium\nload=7000.\n*NODE", 1)
    same = made(tmp_path, text + LOAD.replace("7000.", "< load >"))
    assert same == made(tmp_path, MODEL + LOAD)
    assert refusal(tmp_path, text.replace("7.e10  #", "7 * 10  #") + LOAD) == (
        failure("deck_bad_number", line=2, card="*PARAMETER", text="'7 * 10'"))
    assert failure("deck_bad_number", text="'<mass>'") == refusal(tmp_path, text.replace("2700.", "<mass>") + LOAD)


def test_included_files_stay_in_the_folder(tmp_path: Path) -> None:
    (tmp_path / "nodes.msh").write_text(NODES)
    text = (MODEL + LOAD).replace(NODES, "*INCLUDE, INPUT=nodes.msh\n")
    assert moved(made(tmp_path, text)) == pytest.approx(1e-3, rel=1e-12)
    assert failure("include_outside", included="'../nodes.msh'") == refusal(tmp_path, text.replace("nodes.msh", "../nodes.msh"))
    (tmp_path / "nodes.msh").write_text("*INCLUDE, INPUT=nodes.msh\n")
    assert failure("includes_too_deep", deepest=10) == refusal(tmp_path, text)


MOVED = {  # text behind the model, and the displacement
    "forces of one step add up": ("*STEP\n*STATIC\n*CLOAD\n2, 1, 3000.\n*CLOAD\n2, 1, 4000.\n*END STEP\n", {}, 1e-3),
    "the first step": (LOAD + LOAD.replace("7000", "3500"), {}, 1e-3),
    "a force of a second step replaces": (LOAD + LOAD.replace("7000", "3500"), {"step": 2}, 0.5e-3),
    "what a second step does not name stays": (LOAD + LOAD.replace("2, 1,", "2, 2,"), {"step": 2}, 1e-3),
    "OP=NEW removes": (LOAD + LOAD.replace("*CLOAD", "*CLOAD, OP=NEW").replace("2, 1,", "2, 2,"), {"step": 2}, 0.0),
    "an amplitude at the end of a step": (
        "*AMPLITUDE, NAME=A\n0., 0., 2., 1.\n*STEP\n*STATIC\n.1, 1.\n*CLOAD, AMPLITUDE=A\n2, 1, 14000.\n*END STEP\n", {}, 1e-3),
    "a step of modes first": ("*STEP\n*FREQUENCY\n3\n*END STEP\n" + LOAD, {}, 1e-3),
    "gravity": ("*STEP\n*STATIC\n*DLOAD\nBARS, GRAV, 9.81, 1., 0., 0.\n*END STEP\n", {}, 0.27 / 2 * 9.81 / 7e6),
    "a spring to the ground": ("*ELEMENT, TYPE=SPRING1, ELSET=S\n9, 2\n*SPRING, ELSET=S\n1\n7.e6\n" + LOAD, {}, 0.5e-3),
    "a spring along its line": ("*NODE\n3, 3., 0., 0.\n*ELEMENT, TYPE=SPRINGA, ELSET=S\n9, 2, 3\n*SPRING, ELSET=S\n\n7.e6\n"
                                "*BOUNDARY\n3, 1, 3\n" + LOAD, {}, 0.5e-3),
    "directions of a transform": ("*TRANSFORM, NSET=END, TYPE=R\n0., 1., 0., -1., 0., 0.\n*NSET, NSET=END\n2\n" +
                                  LOAD.replace("2, 1, 7000.", "2, 2, -7000."), {}, None),
}


@pytest.mark.parametrize("name", MOVED)
def test_steps_loads_and_springs(name: str, tmp_path: Path) -> None:
    text, options, wanted = MOVED[name]
    model = MODEL
    if wanted is None:  # x of the node is along y: its supports are its directions 1 and 3
        model, wanted = MODEL.replace("2, 2, 3\n", "2, 1, 1\n2, 3, 3\n"), 1e-3
    assert moved(made(tmp_path, model + text, **options)) == pytest.approx(wanted, rel=1e-9, abs=1e-18)


SECTIONS = {  # parameters and sizes of *BEAM SECTION, options, area; checked with CalculiX 2.20 except I, L, TRAPEZOID
    "RECT": ("20., 30.", {}, 600), "RECT of one length": ("20.", {}, 400), "CIRC": ("10., 20.", {}, pi * 50),
    "CIRC as radius": ("10.", {"circ": "radius"}, pi * 100), "CIRC as diameter": ("10.", {"circ": "diameter"}, pi * 25),
    "PIPE": ("10., 2.", {}, pi * 36), "BOX": ("20., 30., 1., 2., 3., 5.", {}, 600 - 16 * 23),
    "I": ("5., 10., 4., 6., 1., 2., .5", {}, 4 + 12 + 3.5), "L": ("5., 6., 1., 2.", {}, 15),
    "TRAPEZOID": ("4., 3., 2., 1.", {}, 9),
}


@pytest.mark.parametrize("name", SECTIONS)
def test_areas_of_beam_sections(name: str, tmp_path: Path) -> None:
    sizes, options, area = SECTIONS[name]
    text = MODEL.replace("T3D2", "B31").replace("*SOLID SECTION,", f"*BEAM SECTION, SECTION={name.split()[0]},").replace(
        "1.e-4\n*B", f"{sizes}\n0., 1., 0.\n*B")
    link = made(tmp_path, text, beams_as_bars=True, **options)["link"][0]
    assert link["cross_section_area_m2"] == pytest.approx(area, rel=1e-12)


def test_one_length_of_a_circle_is_asked_for(tmp_path: Path) -> None:
    text = MODEL.replace("T3D2", "B31").replace("*SOLID SECTION,", "*BEAM SECTION, SECTION=CIRC,")
    assert refusal(tmp_path, text, beams_as_bars=True) == failure(
        "deck_not_supported", line=13, card="*BEAM SECTION, SECTION=CIRC", reason="radius_or_diameter")


def test_a_general_section_has_its_material(tmp_path: Path) -> None:
    text = MODEL.replace("T3D2", "B31").replace(
        "*SOLID SECTION, ELSET=BARS, MATERIAL=AL\n1.e-4\n",
        "*BEAM GENERAL SECTION, ELSET=BARS, SECTION=GENERAL, DENSITY=2700.\n1.e-4, 1.e-9, 0., 1.e-9, 2.e-9\n"
        "0., 1., 0.\n7.e10, 2.7e10, 2.3e-5\n")
    assert moved(made(tmp_path, text + LOAD, beams_as_bars=True)) == pytest.approx(1e-3, rel=1e-12)


def test_a_bar_of_three_nodes_is_one_bar_or_two(tmp_path: Path) -> None:
    text = MODEL.replace("2, 1., 0., 0.", "2, 1., 0., 0.\n3, .5, 0., 0.").replace("T3D2", "T3D3").replace("1, 1, 2\n", "1, 1, 3, 2\n")
    assert [link["name"] for link in made(tmp_path, text + LOAD)["link"]] == ["L1"]
    assert moved(made(tmp_path, text + LOAD)) == pytest.approx(1e-3, rel=1e-12)
    document = made(tmp_path, text.replace("2, 2, 3", "2, 2, 3\n3, 2, 3") + LOAD.replace("2, 1,", "3, 1,"))
    assert len(document["link"]) == 2 and moved(document) == pytest.approx(0.5e-3, rel=1e-12)


PARTS = """*HEADING
*PART, NAME=BAR
*NODE
1, 0., 0., 0.
2, 1., 0., 0.
*ELEMENT, TYPE=T3D2
1, 1, 2
*NSET, NSET=TIP
2
*ELSET, ELSET=ALL, GENERATE
1, 1
*SOLID SECTION, ELSET=ALL, MATERIAL=AL
1.e-4,
*END PART
*ASSEMBLY, NAME=A
*INSTANCE, NAME=LOW, PART=BAR
*END INSTANCE
*INSTANCE, NAME=HIGH, PART=BAR
0., 1., 0.
0., 1., 0., 0., 1., 1., 90.
*END INSTANCE
*NSET, NSET=WALL, INSTANCE=LOW
1
*NSET, NSET=WALL, INSTANCE=HIGH
1
*END ASSEMBLY
*MATERIAL, NAME=AL
*ELASTIC
7.e10, 0.3
*BOUNDARY
WALL, ENCASTRE
LOW.TIP, 2, 3
HIGH.TIP, 1, 1
HIGH.2, 3, 3
*STEP
*STATIC
*CLOAD
LOW.TIP, 1, 7000.
HIGH.2, 2, 3500.
*END STEP
"""


def test_instances_of_parts_are_shifted_and_rotated(tmp_path: Path) -> None:
    document = made(tmp_path, PARTS)
    places = {node["name"]: node["position_m"] for node in document["node"]}
    assert places["HIGH_1"] == [0, 1] and places["HIGH_2"] == pytest.approx([0, 2], abs=1e-15)
    assert moved(document, "LOW_2") == pytest.approx(1e-3, rel=1e-12)
    assert moved(document, "HIGH_2", 1) == pytest.approx(0.5e-3, rel=1e-9)


def test_nodes_and_elements_are_generated(tmp_path: Path) -> None:
    text = MODEL.replace("2, 1., 0., 0.\n", "2, 1., 0., 0.\n*NODE, NSET=B\n11, 0., 1., 0.\n*NODE\n101, 0., 0., 4.\n103, 2., 0., 4.\n"
                         "*NGEN, NSET=LINE\n101, 103\n*NODE\n201, 1., 0., 0.\n203, 0., 1., 0.\n200, 0., 0., 0.\n"
                         "*NGEN, LINE=C\n201, 203, 1, 200\n*NSET, NSET=A\n1\n*NFILL\nA, B, 2, 5\n"
                         "*NCOPY, CHANGE NUMBER=1000, OLD SET=LINE, SHIFT, NEW SET=COPY\n0., 0., 1.\n"
                         "0., 0., 0., 0., 0., 1., 90.\n")
    text = text.replace("*MATERIAL", "*ELEMENT, TYPE=T3D2, ELSET=ROW\n101, 101, 102\n*ELGEN, ELSET=ROW\n101, 2\n"
                        "*ELCOPY, ELEMENT SHIFT=1000, OLD SET=ROW, SHIFT NODES=1000, NEW SET=BARS\n*MATERIAL")
    (tmp_path / "deck.inp").write_text(text + LOAD)
    deck = read(tmp_path / "deck.inp", options=Options(ignored=frozenset()))
    assert deck.nodes["102"] == (1, 0, 4) and deck.nodes["6"] == (0, 0.5, 0)
    assert deck.nodes["202"] == pytest.approx((np.sqrt(0.5), np.sqrt(0.5), 0), abs=1e-15)
    assert deck.nodes["1103"] == pytest.approx((0, 2, 5), abs=1e-15)
    assert {bar.name: bar.nodes for bar in deck.bars if bar.name != "1"} == {
        "101": ("101", "102"), "102": ("102", "103"), "1101": ("1101", "1102"), "1102": ("1102", "1103")}


def test_nodes_in_cylindrical_coordinates_of_a_system(tmp_path: Path) -> None:
    text = MODEL.replace("*NODE, NSET=NALL\n", "*SYSTEM\n0., 0., 1., 0., 1., 1.\n*NODE, SYSTEM=C\n3, 2., 90., 0.\n*SYSTEM\n*NODE\n")
    (tmp_path / "deck.inp").write_text(text)
    assert read(tmp_path / "deck.inp").nodes["3"] == pytest.approx((-2, 0, 1), abs=1e-15)
    assert failure("deck_not_supported", card="*NODE, SYSTEM", reason="spherical_coordinates") == refusal(tmp_path, text.replace("SYSTEM=C", "SYSTEM=S"))


REFUSED = {
    "tie": ("*BOUNDARY", "*TIE, NAME=T\nA, B\n*BOUNDARY", failure("deck_not_supported", card="*TIE", reason="no_truss")),
    "solid": ("*MATERIAL", "*ELEMENT, TYPE=C3D8\n5, 1,2,1,2,1,2,1,2\n*MATERIAL", failure("deck_not_supported", card="*ELEMENT, TYPE=C3D8", reason="not_a_straight_bar")),
    "unknown": ("*BOUNDARY", "*NEW THING\n*BOUNDARY", failure("deck_not_supported", card="*NEW THING", reason="unknown_card")),
    "parameter": ("*CLOAD", "*CLOAD, FOLLOWER", failure("deck_not_supported", card="*CLOAD, FOLLOWER", reason="no_truss")),
    "unknown parameter": ("*CLOAD", "*CLOAD, NEW=1", failure("deck_not_supported", card="*CLOAD, NEW", reason="unknown_parameter")),
    "moment": ("2, 1, 7000.", "2, 7, 7000.", failure("deck_not_supported", card="*CLOAD", reason="unsupported_direction")),
    "given displacement": ("2, 2, 3", "2, 2, 3, .1", failure("deck_not_supported", card="*BOUNDARY", reason="prescribed_displacement")),
    "pressure": ("*CLOAD\n2, 1, 7000.", "*DLOAD\nBARS, P1, 1.", failure("deck_not_supported", card="*DLOAD, P1", reason="distributed_load")),
    "coefficients of temperature and direction": ("*EXPANSION\n2.3e-5", "*EXPANSION, TYPE=ORTHO\n2e-5, 2e-5, 2e-5, 0.\n3e-5, "
                                                  "3e-5, 3e-5, 100.", failure("deck_not_supported", card="*EXPANSION", reason="temperature_dependent")),
    "modulus of a temperature": ("7.e10, 0.3", "7.e10, 0.3, 0.\n6.e10, .3, 100.", failure("deck_not_supported", card="*ELASTIC", reason="temperature_dependent")),
    "directions": ("*EXPANSION\n2.3e-5", "*EXPANSION, TYPE=ORTHO\n2.3e-5, 2e-5, 2e-5", failure("deck_not_supported", card="*EXPANSION, TYPE", reason="anisotropic")),
    "modulus of directions": ("*ELASTIC\n", "*ELASTIC, TYPE=ORTHO\n", failure("deck_not_supported", card="*ELASTIC, TYPE", reason="anisotropic")),
    "gradient": ("*CLOAD\n2, 1, 7000.", "*TEMPERATURE\n2, 20., 5.", failure("deck_not_supported", card="*TEMPERATURE", reason="temperature_gradient")),
    "amplitude of dynamics": ("*STATIC\n*CLOAD", "*AMPLITUDE, NAME=A\n0., 0., 1., 1.\n*DYNAMIC\n*CLOAD, AMPLITUDE=A",
                              failure("deck_not_supported", card="*CLOAD, AMPLITUDE", reason="amplitude_at_end_unknown")),
    "gravity on a part": ("*STATIC\n*CLOAD\n2, 1, 7000.", "*STATIC\n*ELEMENT, TYPE=MASS, ELSET=M\n9, 2\n*MASS, ELSET=M\n5.\n*DLOAD\n"
                          "BARS, GRAV, 9.81, 1., 0., 0.", failure("deck_not_supported", card="*DLOAD, GRAV", reason="gravity_on_part")),
    "load elsewhere": ("2, 1, 7000.", "3, 1, 7000.\n*NODE\n3, 9., 9., 9.", failure("deck_not_supported", card="*CLOAD", reason="no_bar_at_node")),
    "spring across": ("*BOUNDARY", "*NODE\n3, 1., 1., 0.\n*ELEMENT, TYPE=SPRING2, ELSET=S\n9, 2, 3\n*SPRING, ELSET=S\n1, 1\n5.\n*BOUNDARY",
                      failure("deck_not_supported", card="*SPRING", reason="lateral_stiffness")),
}


@pytest.mark.parametrize("name", REFUSED)
def test_what_matters_and_is_not_supported_is_named(name: str, tmp_path: Path) -> None:
    old, new, sentence = REFUSED[name]
    assert old in MODEL + LOAD
    assert sentence == refusal(tmp_path, (MODEL + LOAD).replace(old, new))


@pytest.mark.parametrize("peak", [120.0, 60.0, -40.0])
def test_coefficients_follow_the_temperature_from_their_zero(peak: float, tmp_path: Path) -> None:
    """Secant expansion coefficients of 2e-5, 2.5e-5 and 2.2e-5 1/K at 0, 50 and 100 °C with ZERO=10; stress-free at 20
    °C."""
    text = MODEL.replace("*EXPANSION\n2.3e-5\n", "*EXPANSION, ZERO=10.\n2.e-5, 0.\n2.5e-5, 50.\n2.2e-5, 100.\n")
    text += f"*INITIAL CONDITIONS, TYPE=TEMPERATURE\nNALL, 20.\n*STEP\n*STATIC\n*TEMPERATURE\nNALL, {peak}\n*END STEP\n"
    case = sj.load(made(tmp_path, text, None))
    assert case.link[0].expansion == "X1" and case.thermal.temperature_change_max_K == peak - 20
    secant = {120.0: 2.2e-5, 60.0: 2.44e-5, -40.0: 2e-5}[peak]
    wanted = secant * (peak - 10) - 2.2e-5 * 10
    # A jump of at most 2e-5 1/K, spread over 0.2 K, is exact to second order.
    assert case.expansion[0].strain(np.array([peak - 20]))[0] == pytest.approx(wanted, abs=1e-8)


def test_lines_of_a_solid_are_no_elements(tmp_path: Path) -> None:
    text = MODEL.replace("*MATERIAL", "*ELEMENT, TYPE=C3D20R\n5, 1,2,1,2,1,2,1,2,1,2,\n1,2,1,2,1,2,1,2,1,2\n*MATERIAL", 1)
    document = made(tmp_path, text + LOAD, ignored=frozenset({"C3D20R"}))
    assert moved(document) == pytest.approx(1e-3, rel=1e-12)


def test_reading_is_linear(tmp_path: Path) -> None:
    """Reading 2000 GENERATE lines on 40 000 nodes once took 28 s; eight times the lines may take at most 16 times as
    long."""
    count = 40_000
    nodes = "*NODE\n" + "".join(f"{number}, {number}., 0., 0.\n" for number in range(1, count + 1))
    rest = MODEL.replace(NODES, "").replace("*BOUNDARY", "{sets}*BOUNDARY")
    took = []
    for lines in (250, 2000):
        sets = "*NSET, NSET=S, GENERATE\n" + "".join(f"{20 * at + 1}, {20 * at + 20}\n" for at in range(lines))
        (tmp_path / "deck.inp").write_text(nodes + rest.format(sets=sets))
        begun = time.process_time()
        read(tmp_path / "deck.inp")
        took.append(time.process_time() - begun)
    assert took[1] < 2 * took[0] + 1  # most of the time is reading the nodes, which are equal
