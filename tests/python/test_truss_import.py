# SPDX-License-Identifier: GPL-3.0-or-later
"""Trusses imported from other programs: their solution equals that of the same truss written by hand, and omitted data
are named."""
from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from typing import Any, Callable

import numpy as np
import pytest
from conftest import Outcome
from failures import Failure, failure

import statejump as sj
from statejump.kinds.truss.importing import Options, Units, case_document, read

BAR = {"young_modulus_Pa": 7e10, "cross_section_area_m2": 1e-4, "thermal_expansion_per_K": 2.3e-5,
       "density_kg_per_m3": 2700.0, "poisson_ratio": 0.3}
# A triangle on a pin and a roller, its free corner loaded, every bar of another temperature: 105, 110, 115 K.
BY_HAND: dict[str, Any] = {
    "case": {"name": "by_hand", "kind": "truss"}, "truss": {"dimension": 2},
    "node": [{"name": "N1", "position_m": [0.0, 0.0], "fixed": ["x", "y"]},
             {"name": "N2", "position_m": [1.0, 0.0], "fixed": ["y"]},
             {"name": "N3", "position_m": [0.0, 1.0], "force_N": [1000.0, 0.0]}],
    "link": [{"name": "L1", "nodes": ["N1", "N2"], "temperature_fraction": 105 / 115, **BAR},
             {"name": "L2", "nodes": ["N1", "N3"], "temperature_fraction": 110 / 115, **BAR},
             {"name": "L3", "nodes": ["N2", "N3"], **BAR}],
    "thermal": {"shape": "triangle", "temperature_change_max_K": 115.0},
}
ABAQUS = """*HEADING
triangle
** comment
*NODE, NSET=ALLN
1, 0, 0, 0
2, 1000, 0, 0
3, 0, 1000, 0
*ELEMENT, TYPE=T3D2, ELSET=BARS
1, 1, 2
2, 1, 3
3, 2, 3
*NSET, NSET=FLAT, GENERATE
1, 3, 1
*MATERIAL, NAME=AL
*ELASTIC
7e4, 0.3
*EXPANSION
2.3e-5
*DENSITY
2.7e-9
*SOLID SECTION, ELSET=BARS,
MATERIAL=AL
100.
*INITIAL CONDITIONS, TYPE=TEMPERATURE
ALLN, 20
*BOUNDARY
1, 1, 2
2, 2
FLAT, 3
*STEP
*STATIC
*TEMPERATURE
1, 120
2, 130
3, 140
*CLOAD
3, 1, 1000
*CONTROLS, PARAMETERS=FIELD
*END STEP
"""
HEAD = "SOL 101\nCEND\nSPC = 1\nLOAD = 2\nTEMP(LOAD) = 3\nBEGIN BULK\n"
FREE = HEAD + """GRID,1,,0.,0.,0.
GRID,2,,1.,0.,0.
GRID,3,,0.,1.,0.
CROD,1,7,1,2
CROD,2,7,1,3
CONROD,3,2,3,5,1.-4
PROD,7,5,1.-4
MAT1,5,7.+10,,.3,2700.,2.3-5,20.
SPC1,1,12,1
SPC1,1,2,2
SPC1,1,3,1,THRU,3
SPC1,9,123,3
FORCE,2,3,0,1000.,1.,0.,0.
TEMP,3,1,120.,2,130.,3,140.
MPC,9,1,1,1.,2,1,-1.
PLOAD4,7,1,5.
ENDDATA
"""
SMALL = HEAD + """$ columns of eight
GRID           1              0.      0.      0.
GRID           2              1.      0.      0.
GRID           3              0.      1.      0.
CROD           1       7       1       2
CROD           2       7       1       3
CONROD         3       2       3       5   1.0-4
PROD           7       5   1.0-4
MAT1           5   7.+10             .3   2700.  2.3-5     20.
SPC1           1      12       1
SPC1           1       2       2
SPC1           1       3       1       2       3
FORCE          2       3       0   1000.      1.      0.      0.
TEMP           3       1    120.       2    130.       3    140.
ENDDATA
"""


def large(name: str, *fields: str) -> str:
    """Return a line of fields of 16 columns."""
    return f"{name:<8}" + "".join(f"{field:>16}" for field in fields) + "\n"


LARGE = SMALL.replace(
    "MAT1           5   7.+10             .3   2700.  2.3-5     20.\n",
    large("MAT1*", "5", "7.E10", "", "0.3") + large("*", "2700.", "2.30D-5", "20."))
assert LARGE != SMALL


def check(found: sj.Case) -> None:
    """The path of the imported truss equals that of the truss written by hand, to the rounding of the deck."""
    ours, theirs = found.reduced(), sj.load(BY_HAND).reduced()
    for place, wanted in (("displacement_m", ours.history), ("axial_force_N", ours.links)):
        other = (theirs.history if place in theirs.history else theirs.links)[place].values
        assert np.abs(wanted[place].values - other).max() <= 1e-9 * np.abs(other).max()


@pytest.mark.parametrize("text", [FREE, SMALL, LARGE], ids=["free", "small", "large"])
def test_nastran_gives_the_numbers_of_the_truss_by_hand(
    text: str, tmp_path: Path, statejump: Callable[..., Outcome]
) -> None:
    (tmp_path / "deck.bdf").write_text(text)
    told = statejump("truss", "import", "deck.bdf", "-o", "deck.toml")
    assert told.status == 0, told.errors
    check(sj.load(tmp_path / "deck.toml"))


def test_calculix_gives_the_numbers_of_the_truss_by_hand(tmp_path: Path, statejump: Callable[..., Outcome]) -> None:
    (tmp_path / "deck.inp").write_text(ABAQUS)
    told = statejump("truss", "import", "deck.inp", "-o", "deck.toml", "--length-unit", 0.001)
    assert told.status == 0, told.errors
    check(sj.load(tmp_path / "deck.toml"))


def test_tables_give_the_numbers_of_the_truss_by_hand(tmp_path: Path, statejump: Callable[..., Outcome]) -> None:
    (tmp_path / "nodes.csv").write_text("name,x_m,y_m,fixed,force_x_N\nN1,0,0,xy,\nN2,1,0,y,\nN3,0,1,,1000\n")
    (tmp_path / "bars.csv").write_text(
        "name,first,second,young_modulus_Pa,cross_section_area_m2,thermal_expansion_per_K,density_kg_per_m3,"
        "temperature_change_K\n" + "".join(
            f"L{number},N{first},N{second},7e10,1e-4,2.3e-5,2700,{change}\n"
            for number, first, second, change in ((1, 1, 2, 105), (2, 1, 3, 110), (3, 2, 3, 115))))
    told = statejump("truss", "import", "nodes.csv", "--bars", "bars.csv", "-o", "deck.toml")
    assert told.status == 0, told.errors
    check(sj.load(tmp_path / "deck.toml"))


def test_nothing_is_dropped_in_silence(tmp_path: Path, statejump: Callable[..., Outcome]) -> None:
    (tmp_path / "deck.bdf").write_text(FREE)
    told = statejump("truss", "import", "deck.bdf", "-o", "deck.toml")
    for text in (told.output, (tmp_path / "deck.toml").read_text()):
        for word in ("MPC", "PLOAD4", "SPC1", "set 9 is not selected"):
            assert word in text
    (tmp_path / "deck.inp").write_text(ABAQUS)
    assert "*CONTROLS" in statejump("truss", "import", "deck.inp", "-o", "deck2.toml").output
    # Every card of a deck is in one of the two tables.
    deck = read(tmp_path / "deck.bdf")
    cards = {line.split(",")[0] for line in FREE.split("BEGIN BULK\n")[1].splitlines()} - {"ENDDATA"}
    assert cards == {card for card, _ in (*deck.taken, *deck.left)}
    deck = read(tmp_path / "deck.inp")
    keywords = {line.split(",")[0] for line in ABAQUS.splitlines() if line[0] == "*" and line[1] != "*"}
    assert keywords == {card.split(",")[0] for card, _ in (*deck.taken, *deck.left)}


def test_joints_are_put_in_by_name(tmp_path: Path, statejump: Callable[..., Outcome]) -> None:
    (tmp_path / "deck.bdf").write_text(FREE)
    told = statejump("truss", "import", "deck.bdf", "-o", "deck.toml",
                     "--joint", "node=N1,axis=x,friction_coefficient=0.3,normal_force_N=1e4,clearance_plus_m=1e-3",
                     "--joint", "node=N3,link=L3,journal_radius_m=5e-3,radial_clearance_m=1e-5,friction_coefficient=0.2")
    assert told.status == 0, told.errors
    case = sj.load(tmp_path / "deck.toml")
    assert [slider.nodes for slider in case.slider] == [["N1"]] and case.node[0].fixed == ["y"]
    joint = case.revolute[0]
    assert (joint.bearing_node, joint.journal_node, joint.bearing_link, joint.journal_link) == ("N3", "N3_L3", "L2", "L3")
    assert case.reduced().complete


def test_beams_become_bars_and_say_so(tmp_path: Path) -> None:
    text = ABAQUS.replace("T3D2", "B31").replace("*SOLID SECTION", "*BEAM SECTION, SECTION=RECT").replace("100.", "10,10")
    (tmp_path / "deck.inp").write_text(text)
    deck = read(tmp_path / "deck.inp", options=Options(beams_as_bars=True))
    assert [card for card, what in deck.taken if "bending" in what] == ["*ELEMENT, TYPE=B31"]
    check(sj.load(case_document(deck, "beams", units=Units(1e-3))))


def test_a_deck_without_density_is_a_case_for_the_solver(tmp_path: Path) -> None:
    (tmp_path / "deck.inp").write_text(ABAQUS.replace("*DENSITY\n2.7e-9\n", ""))
    deck = read(tmp_path / "deck.inp")
    case = sj.load(case_document(deck, "light", units=Units(1e-3)))
    assert any("no density" in why for (_, why) in deck.left)
    assert case.reduced().summary


WRONG: dict[str, tuple[str, str, str, list[str], Failure | None]] = {
    "no node": ("inp", "3, 2, 3\n*NSET", "3, 2, 9\n*NSET", [], failure("deck_undefined", line=11, card="element 3", what_it_is="node", name="9", file="deck.inp")),
    "twice": ("inp", "2, 1000, 0, 0", "1, 1000, 0, 0", [], failure("deck_duplicate", line=6, what_it_is="node", name="'1'", file="deck.inp")),
    "no number": ("inp", "7e4, 0.3", "nan, 0.3", [], failure("deck_bad_number", text="'nan'")),
    "no section": ("inp", "*SOLID SECTION", "*SHELL SECTION", [], failure("deck_not_supported", card="*SHELL SECTION", reason="no_truss", line=21)),
    "other files": ("inp", "*HEADING", "*INCLUDE, INPUT=/etc/passwd", [], failure("include_outside", line=1, included="'/etc/passwd'")),
    "coordinate system": ("bdf", "GRID,1,,0.", "GRID,1,5,0.", [], failure("deck_undefined", card="GRID", what_it_is="coordinate system", name="5")),
    "no property": ("bdf", "PROD,7", "PROD,8", [], failure("deck_undefined", card="CROD 1", what_it_is="supported property", name="'7'")),
    "two sets": ("bdf", HEAD, "BEGIN BULK\n", [], failure("deck_ambiguous_set", card="SPC1", first="1", second="9", command="SPC")),
    "continuation": ("bdf", "GRID,1,,", ",7\nGRID,1,,", [], failure("deck_bad_syntax")),
    "no bars": ("bdf", "CROD,", "PLOTEL,", [], None),
    "joint": ("bdf", "", "", ["--joint", "node=N9"], failure("misspelt_key", item="--joint 1", key="node", value="N9", meant="N3")),
    "joint's key": ("bdf", "", "", ["--joint", "node=N1,axe=x"], failure("misspelt_key", item="--joint 1", key="axe", meant="axis")),
    "joint's axis": ("bdf", "", "", ["--joint", "node=N1,axis=z"], failure("unknown_name", item="--joint 1", key="axis", value="z", known="x, y or link")),
    "joint's link": ("bdf", "", "", ["--joint", "link=L9,axis=link"], failure("misspelt_key", item="--joint 1", key="link", value="L9", meant="L3")),
    "no link": ("bdf", "", "", ["--joint", "axis=link"], failure("slider_link_missing", item="--joint 1", key="link")),
    "joint's file": ("bdf", "", "", ["--joint", "link=L1,axis=link,from=deck.bdf"], failure("not_toml_at_line", line=1, file="deck.bdf")),
    "no members": ("bdf", "", "", ["--lead-in", "5"], failure("requires_members_file", key="--lead-in", value=5.0)),
    "reflector": ("bdf", "", "", ["--reflector", "M*"], failure("no_such_key", key="--reflector", value="M*")),
    "suffix": ("txt", "", "", [], failure("deck_suffix", key="FILE", value="deck.txt")),
}


@pytest.mark.parametrize("what", WRONG)
def test_what_is_wrong_is_one_sentence(what: str, tmp_path: Path, statejump: Callable[..., Outcome]) -> None:
    suffix, old, new, more, sentence = WRONG[what]
    text = ABAQUS if suffix == "inp" else FREE
    assert old in text
    if what == "no bars":
        text = text.replace("CONROD,3", "PLOTEL,3")
        sentence = failure("no_bars", file="deck.bdf")
    (tmp_path / f"deck.{suffix}").write_text(text.replace(old, new) if old else text)
    told = statejump("truss", "import", f"deck.{suffix}", "-o", "deck.toml", *more)
    assert told.status == 2 and told.errors.count("\n") == 1 and told.failure == sentence, told.errors
    assert not (tmp_path / "deck.toml").exists()


def test_sliders_in_links_take_what_identify_wrote(tmp_path: Path, statejump: Callable[..., Outcome]) -> None:
    (tmp_path / "deck.bdf").write_text(FREE)
    (tmp_path / "joint.toml").write_text("[[slider]]\nfriction_coefficient = 0.3\nnormal_force_N = 1e4\n")
    (tmp_path / "day.csv").write_text("time_s," + ",".join(f"L{n}_degC" for n in (1, 2, 3)) + "\n0,30,30,30\n60,80,90,95\n")
    told = statejump("truss", "import", "deck.bdf", "-o", "deck.toml", "--members-file", "day.csv",
                     "--reference-temperature", 293.15, "--lead-in", 10,
                     "--joint", "link=L[13],axis=link,from=joint.toml,clearance_plus_m=1e-3",
                     "--reflector", "N?,N1", "--reflector-axis", 0, 1, 0)
    assert told.status == 0, told.errors
    case = sj.load(tmp_path / "deck.toml")
    assert [slider.nodes for slider in case.slider] == [["N1_L1", "N1"], ["N2_L3", "N2"]]
    assert case.link[0].nodes == ["N1_L1", "N2"]
    assert case.slider[1].axis == pytest.approx([-(0.5**0.5), 0.5**0.5], abs=1e-11)
    assert {(one.friction_coefficient, one.clearance_plus_m) for one in case.slider} == {(0.3, 1e-3)}
    assert case.reflector.nodes == ["N1", "N2", "N3"] and case.reflector.axis == [0, 1]
    assert case.thermal.members.time_s.tolist() == [0, 10, 70]
    # Friction of 3 kN holds: the truss without joints at the same temperatures.
    held = case.reduced()
    assert np.abs(held.links["axial_force_N"].values).max() < 3e3
    plain = statejump("truss", "import", "deck.bdf", "-o", "plain.toml", "--members-file", "day.csv",
                      "--reference-temperature", 293.15, "--lead-in", 10)
    assert plain.status == 0, plain.errors
    wanted = sj.load(tmp_path / "plain.toml").reduced().links["axial_force_N"].values[-1]
    assert held.links["axial_force_N"].values[-1] == pytest.approx(wanted, rel=1e-9)


def test_a_slide_in_a_link_opens_as_the_link_is_pulled(tmp_path: Path) -> None:
    """A bar between walls cools and shortens by 2.3 mm; the slide provides 1 mm of it."""
    (tmp_path / "pull.bdf").write_text(
        "BEGIN BULK\nGRID,1,,0.,0.,0.\nGRID,2,,1.,0.,0.\nCONROD,1,1,2,5,1.-4\nMAT1,5,7.+10,,.3,2700.,2.3-5,0.\n"
        "SPC1,1,123,1,2\nTEMP,3,1,-100.,2,-100.\nENDDATA\n")
    slack = {"friction_coefficient": "0.1", "normal_force_N": "50", "clearance_plus_m": "1e-3", "clearance_minus_m": "2e-3"}
    document = case_document(read(tmp_path / "pull.bdf"), "pull", joints=[{"link": "L1", "axis": "link", **slack}])
    run = sj.load(document).reduced()
    assert run.history["slide_m"].values.max() == pytest.approx(1e-3, rel=1e-12)
    assert run.history["displacement_m"].values[:, -1, 0].max() == pytest.approx(1e-3, rel=1e-12)


def test_the_shipped_mast_is_that_of_its_generator(tmp_path: Path) -> None:
    folder = Path(__file__).resolve().parents[2] / "cases" / "imports"
    before = {path.name: path.read_bytes() for path in folder.glob("*.[bc]*")}
    (tmp_path / "make_mast.py").write_bytes((folder / "make_mast.py").read_bytes())
    subprocess.run([sys.executable, tmp_path / "make_mast.py"], check=True)
    assert {path.name: path.read_bytes() for path in tmp_path.glob("*.[bc]*")} == before and len(before) == 3


def test_the_command_imports_a_deck_of_springs(tmp_path: Path, statejump: Callable[..., Outcome]) -> None:
    (tmp_path / "springs.bdf").write_text("BEGIN BULK\nGRID,1,,0.,0.,0.,,123\nGRID,2,,1.,0.,0.,,23\nCELAS2,1,7.+6,2,1\nENDDATA\n")
    done = statejump("truss", "import", "springs.bdf", "-o", "springs.toml")
    assert done.status == 0, done.errors
    assert "links 0" in done.output and sj.load(tmp_path / "springs.toml").reduced().summary["largest_jump_m"] == 0
