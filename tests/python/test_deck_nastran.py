# SPDX-License-Identifier: GPL-3.0-or-later
"""Decks of Nastran: fields of cards as in the manuals, and a closed form for every card."""
from __future__ import annotations

from math import pi
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from failures import Failure, failing, failure
import statejump as sj
from statejump.kinds.truss.importing import Options, Units, case_document, read
from statejump.kinds.truss.importing.profiles import NASTRAN, nastran

E, A = 7e10, 1e-4
CONTROL = "SOL 101\nCEND\nSPC = 1\nLOAD = 5\nBEGIN BULK\n"
# A rod of 7e6 N/m along x, free only along x at its end; 7000 N elongate it by 1 mm.
ROD = """GRID,1,,0.,0.,0.
GRID,2,,1.,0.,0.
CROD,1,1,1,2
PROD,1,1,1.-4
MAT1,1,7.+10,,.3,2700.,2.3-5,20.
SPC1,1,123,1
SPC1,1,23,2
FORCE,5,2,,7000.,1.,0.,0.
"""


def made(folder: Path, bulk: str, control: str = CONTROL, change: float | None = 0.0, **options: Any) -> dict[str, Any]:
    """Return the document of a deck."""
    (folder / "deck.bdf").write_text(control + bulk + "ENDDATA\n")
    units = options.pop("units", Units())
    return case_document(read(folder / "deck.bdf", options=Options(**options)), "deck", units=units,
                         temperature_change_K=change)


def moved(document: dict[str, Any], node: str = "N2", axis: int = 0) -> float:
    """Return the displacement of a node at the largest temperature change."""
    run = sj.load(document).reduced()
    at = int(np.argmax(np.abs(run.history["temperature_change_K"].values)))
    names = [item["name"] for item in document["node"]]
    return float(run.history["displacement_m"].values[at, names.index(node), axis])


def refusal(folder: Path, bulk: str, control: str = CONTROL, **options: Any) -> sj.StatejumpError:
    """Return the error of a deck."""
    with pytest.raises(sj.StatejumpError) as refused:
        made(folder, bulk, control, **options)
    return refused.value


def test_the_rod_is_as_long_as_by_hand(tmp_path: Path) -> None:
    assert moved(made(tmp_path, ROD)) == pytest.approx(1e-3, rel=1e-12)


@pytest.mark.parametrize("head", ["", "NASTRAN FILES=NPTP\nID D1,NASTRAN\n", "$ * a comment\n"])
def test_a_deck_may_end_with_inp(head: str, tmp_path: Path) -> None:
    (tmp_path / "deck.inp").write_text(head + CONTROL + ROD + "ENDDATA\n")
    found = case_document(read(tmp_path / "deck.inp"), "deck", temperature_change_K=0.0)
    assert {**found, "case": 0} == {**made(tmp_path, ROD), "case": 0}


def test_blanks_between_components_change_nothing(tmp_path: Path) -> None:
    assert "SPC1,1,23,2" in ROD
    assert made(tmp_path, ROD.replace("SPC1,1,23,2", "SPC1    1        2  3   2")) == made(tmp_path, ROD)


def test_parameters_and_the_card_of_mystran_change_nothing(tmp_path: Path) -> None:
    assert made(tmp_path, ROD + "PARAM,SOLLIB,BANDED\nPARAM   PRTDOF  1\nDEBUG   192     2\n") == made(tmp_path, ROD)


@pytest.mark.parametrize("name, old, new", [
    ("small", "GRID,2,,1.,0.,0.", "GRID           2              1.      0.      0."),
    ("large", "GRID,2,,1.,0.,0.", "GRID*                  2                              1.              0.\n*                     0."),
    ("free large", "GRID,2,,1.,0.,0.", "GRID*,2,,1.,0.\n*,0."),
    ("lower case", "CROD,1,1,1,2", "crod,1,1,1,2"),
    ("tabs", "CROD,1,1,1,2", "CROD\t1\t1\t1\t2"),
    ("bare exponent", "PROD,1,1,1.-4", "PROD,1,1,100.-6"),
    ("comma behind column 10", "CROD,1,1,1,2", "DEQATN  11      F(B,C)=B*C\nDEQATN        12G(B,C)=B-C\nCROD,1,1,1,2"),
    ("comment", "CROD,1,1,1,2", "CROD,1,1,1,2 $ the only one"),
    ("marks", "MAT1,1,7.+10,,.3,2700.,2.3-5,20.", "MAT1,1,7.+10,,.3,2700.,2.3-5,20.,,+M1\n+M1,1.+8,1.+8"),
    ("marks out of order", "MAT1,1,7.+10,,.3,2700.,2.3-5,20.\nSPC1,1,123,1\n",
     "MAT1,1,7.+10,,.3,2700.,2.3-5,20.,,+M1\nSPC1,1,123,1\n+M1,1.+8,1.+8\n"),
    ("marks whose first letter is free", "MAT1,1,7.+10,,.3,2700.,2.3-5,20.",
     f"{'MAT1    1       7.+10           .3      2700.   2.3-5   20.':72}ELIMITS\n+LIMITS 1.+8    1.+8"),
    ("long free line", "MAT1,1,7.+10,,.3,2700.,2.3-5,20.", "MAT1,1,7.+10,,.3,2700.,2.3-5,20.,,1.+8,1.+8"),
    ("a number in field 10", "MAT1,1,7.+10,,.3,2700.,2.3-5,20.", "MAT1,1,7.+10,,.3,2700.,2.3-5,20.,,1.+8"),
    ("cards in any order", "GRID,1,,0.,0.,0.\nGRID,2,,1.,0.,0.\nCROD,1,1,1,2\n",
     "CROD,1,1,1,2\nGRID,2,,1.,0.,0.\nGRID,1,,0.,0.,0.\n"),
    ("Windows", "\n", "\r\n"),
    ("Latin-1", "CROD,1,1,1,2", "$ St\xfctze\nCROD,1,1,1,2"),
])
def test_fields_are_read_as_the_manuals_say(name: str, old: str, new: str, tmp_path: Path) -> None:
    assert old in ROD
    text = ROD.replace(old, new)
    (tmp_path / "deck.bdf").write_bytes((CONTROL + text + "ENDDATA\n").encode("latin-1"))
    document = case_document(read(tmp_path / "deck.bdf"), "deck", temperature_change_K=0.0)
    assert moved(document) == pytest.approx(1e-3, rel=1e-12)


def test_replicated_cards_count_up(tmp_path: Path) -> None:
    bulk = ROD.replace("GRID,2,,1.,0.,0.\n", "GRID,2,,1.,0.,0.\n=,*(1),=,*(1.),==\n=(2)\n").replace(
        "CROD,1,1,1,2\n", "CROD,1,1,1,2\n=,*(1),=,*(1),*(1)\n=(2)\n").replace("SPC1,1,23,2", "SPC1,1,23,2,THRU,5")
    document = made(tmp_path, bulk)
    assert [node["position_m"][0] for node in document["node"]] == [0, 1, 2, 3, 4]
    assert [link["nodes"] for link in document["link"]] == [[f"N{n}", f"N{n + 1}"] for n in range(1, 5)]


COSMIC = {  # a card of the rod, and the same card in the free fields of COSMIC's Nastran
    "blanks": ("GRID,2,,1.,0.,0.", "GRID,2 ,, 1.  0.  0."),
    "blanks around commas": ("SPC1,1,23,2", "SPC1 , 1  23 , 2"),
    "a comma behind the name": ("CROD,1,1,1,2", "CROD, 1 1  1 2"),
    "a numbered field": ("GRID,2,,1.,0.,0.", "GRID,2 4)1. 0. 0."),
    "a number and its value": ("GRID,2,,1.,0.,0.", "GRID,2 4) 1. 0. 0."),
    "a mark": ("MAT1,1,7.+10,,.3,2700.,2.3-5,20.", "MAT1,1,7.+10,,.3,2700.,2.3-5,20. )+M1\n+M1, 1.+8 1.+8"),
    "the mark of the line before": ("MAT1,1,7.+10,,.3,2700.,2.3-5,20.", "MAT1,1,7.+10,,.3,2700.,2.3-5,20. 10)+M1\n), 1.+8 1.+8"),
    "a mark with a blank": ("MAT1,1,7.+10,,.3,2700.,2.3-5,20.", "MAT1,1,7.+10,,.3,2700.,2.3-5,20.,,+ A\n+ A,1.+8 1.+8"),
    "slashes": ("SPC1,1,123,1", "SPC1,1,123 1///"),
    "a comma first": ("MAT1,1,7.+10,,.3,2700.,2.3-5,20.", "MAT1,1,7.+10,,.3,2700.,2.3-5,20.\n, 1.+8 1.+8"),
    "a range": ("SPC1,1,23,2", "SPC1,1,23,2 THRU 5"),
}


@pytest.mark.parametrize("name", COSMIC)
def test_blanks_separate_free_fields(name: str, tmp_path: Path) -> None:
    old, new = COSMIC[name]
    assert old in ROD
    assert made(tmp_path, ROD.replace(old, new)) == made(tmp_path, ROD)


@pytest.mark.parametrize("rule", ["=,*1,=,*1.,==\n=2\n", "=(3),*(1),=,*(1.),==\n", "=(3),%(5),=,%(4.),==\n",
                                  "=(3),*(1) = *(1.) ==\n"])
def test_steps_and_last_values_of_replicated_cards(rule: str, tmp_path: Path) -> None:
    links = "CROD,1,1,1,2\n=(3),*1 = *1 / \n"
    bulk = ROD.replace("GRID,2,,1.,0.,0.\n", "GRID,2,,1.,0.,0.\n" + rule).replace("CROD,1,1,1,2\n", links).replace(
        "SPC1,1,23,2", "SPC1,1,23,2,THRU,5")
    document = made(tmp_path, bulk)
    assert [node["position_m"][0] for node in document["node"]] == [0, 1, 2, 3, 4]
    assert [link["nodes"] for link in document["link"]] == [[f"N{n}", f"N{n + 1}"] for n in range(1, 5)]


@pytest.mark.parametrize("rest", ["=(2),==", "+C-8,,,0. .1 0. 0. .1 0.\n=(1),==", "+C-9,,,0. .1 0. 0. .1 0.\n+C-8,,,0. .1 0. 0. .1 0."])
def test_continuations_repeat_with_counted_marks(rest: str, tmp_path: Path) -> None:
    bars = f"CBAR,1,1,1,2,0. 1. 0. )+C-7\n=(2),*1 = *1 / ==\n+C-7,,,0. .1 0. 0. .1 0.\n{rest}\nPBAR,1,1,1.-4\n"
    bulk = ROD.replace("CROD,1,1,1,2\nPROD,1,1,1.-4\n", bars).replace("GRID,2,,1.,0.,0.\n", "GRID,2,,1.,0.,0.\n=(2),*1,=,*1.,==\n")
    (tmp_path / "deck.bdf").write_text(CONTROL + bulk + "SPC1,1,23,3,4\nENDDATA\n")
    deck = read(tmp_path / "deck.bdf", options=Options(beams_as_bars=True))
    assert len(deck.bars) == 3 and deck.left["CBAR", "equal offsets of both ends: nodes of a truss do not rotate"][1] == 3
    if rest == "=(2),==":
        assert failure("deck_bad_syntax", line=12) == refusal(tmp_path, bulk.replace(rest, "=(3),=="), beams_as_bars=True)


@pytest.mark.parametrize("card, wanted", [
    ("GRID,9 8)1. 4)2.\n", failure("deck_bad_syntax", problem="'4)2.' is behind its field")),
    ("GRID,9 11)1.\n", failure("deck_bad_syntax", problem="'11)1.' is behind its field")),
    ("SPC,,1,123,0.\n", failure("deck_incomplete", card="SPC", needed="field 2")),
    ("GRID,9,,A,0.,0.\n=,*1,,*1.,==\n", failure("deck_bad_syntax", problem="'*1.' and 'A' cannot be added")),
])
def test_free_fields_that_are_refused(card: str, wanted: Failure, tmp_path: Path) -> None:
    assert wanted == refusal(tmp_path, ROD + card)


def test_a_long_line_has_no_mark(tmp_path: Path) -> None:
    # Field 10 of a longer line is data: the line ends with the shear factors K1 and K2.
    bulk = ROD.replace("CROD,1,1,1,2\nPROD,1,1,1.-4\n", "CBAR,1,1,1,2,0.,1.,0.\nPBAR,1,1,1.-4,1.-9,1.-9,2.-9,,,,,,,,,,,.5,.5\n")
    assert moved(made(tmp_path, bulk, beams_as_bars=True)) == pytest.approx(1e-3, rel=1e-12)


def test_a_deck_of_springs_has_no_links(tmp_path: Path) -> None:
    bulk = ROD.replace("CROD,1,1,1,2\nPROD,1,1,1.-4\n", "CELAS2,1,7.+6,2,1\n")
    document = made(tmp_path, bulk)
    assert document.get("link", []) == [] and moved(document) == pytest.approx(1e-3, rel=1e-9)


def test_included_files_are_read_with_their_lines(tmp_path: Path) -> None:
    (tmp_path / "mesh").mkdir()
    (tmp_path / "mesh" / "nodes.inc").write_text("GRID,1,,0.,0.,0.\nINCLUDE 'mesh/more.inc'\n")
    (tmp_path / "mesh" / "more.inc").write_text("GRID,2,,1.,0.,0.\n")
    rest = ROD.split("\n", 2)[2]
    assert moved(made(tmp_path, "INCLUDE 'mesh/nodes.inc'\n" + rest)) == pytest.approx(1e-3, rel=1e-12)
    (tmp_path / "mesh" / "more.inc").write_text("GRID,2,,one,0.,0.\n")
    assert refusal(tmp_path, "INCLUDE 'mesh/nodes.inc'\n" + rest) == failure("deck_bad_number", line=1, text="'one'")


@pytest.mark.parametrize("name, sentence", [
    ("'../other.inc'", failure("include_outside", included="'../other.inc'")), ("'/etc/passwd'", failure("include_outside", included="'/etc/passwd'")),
    ("'none.inc'", failure("included_file_not_found", included="'none.inc'")), ("'deck.bdf'", failure("includes_too_deep", deepest=10)),
])
def test_includes_that_are_refused(name: str, sentence: Failure, tmp_path: Path) -> None:
    (tmp_path.parent / "other.inc").write_text("GRID,9\n")
    (tmp_path / "link.inc").symlink_to("/etc/passwd")
    assert sentence == refusal(tmp_path, f"INCLUDE {name}\n" + ROD)
    assert failure("include_outside", included="'link.inc'") == refusal(tmp_path, "INCLUDE 'link.inc'\n" + ROD)


def test_a_file_of_the_executive_control_is_refused_like_a_card(tmp_path: Path) -> None:
    control = "SOL 101\nINCLUDE '/site/dmap/alters.v9'\n" + CONTROL.split("\n", 1)[1]
    assert failure("deck_not_supported", card="INCLUDE", reason="executive_include", line=2) == refusal(tmp_path, ROD, control)
    assert made(tmp_path, ROD, control, ignored=frozenset({"INCLUDE"})) == made(tmp_path, ROD)
    (tmp_path / "alters.v9").write_text("COMPILE SEMG\n")
    assert made(tmp_path, ROD, control.replace("/site/dmap/", "")) == made(tmp_path, ROD)


SPRUNG = {  # cards besides the rod, and the resulting displacement of its end
    "spring to the ground": ("CELAS2,2,7.+6,2,1\n", 0.5e-3),
    "spring by a property": ("CELAS1,2,9,2,1\nPELAS,9,2.1+7\n", 0.25e-3),
    "spring along its line": ("GRID,3,,3.,0.,0.\nSPC1,1,123,3\nCELAS2,2,7.+6,2,1,3,1\n", 0.5e-3),
    "bush to the ground": ("CBUSH,2,9,2,,,,,0\nPBUSH,9,K,7.+6\n", 0.5e-3),
    "bush along its line": ("GRID,3,,3.,0.,0.\nSPC1,1,123,3\nCBUSH,2,9,2,3\nPBUSH,9,K,7.+6\n", 0.5e-3),
    "a second load": ("FORCE1,5,2,3500.,2,1\n", 0.5e-3),
    "combined loads": ("LOAD,5,2.,1.5,6,.5,7\nFORCE,6,2,,1000.,1.,0.,0.\nFORCE,7,2,,4000.,1.,0.,0.\n", 2e-3),
    "load along the bar": ("PLOAD1,5,1,FXE,FR,0.,2000.,1.,2000.\n", None),
}


@pytest.mark.parametrize("name", SPRUNG)
def test_springs_and_loads(name: str, tmp_path: Path) -> None:
    cards, wanted = SPRUNG[name]
    bulk = ROD + cards
    if name == "load along the bar":
        bulk = bulk.replace("CROD,1,1,1,2", "CBAR,1,1,1,2,0.,1.,0.").replace("PROD", "PBAR")
        # 2000 N/m over the whole length: half of the load at each end, as in the exact solution of the bar.
        assert moved(made(tmp_path, bulk, beams_as_bars=True)) == pytest.approx(8000 / 7e6, rel=1e-12)
        return
    assert moved(made(tmp_path, bulk)) == pytest.approx(wanted, rel=1e-9)


def test_a_linear_load_along_the_bar_keeps_its_work(tmp_path: Path) -> None:
    bulk = ROD.replace("CROD,1,1,1,2", "CBAR,1,1,1,2,0.,1.,0.").replace("PROD", "PBAR").replace(
        "FORCE,5,2,,7000.,1.,0.,0.", "PLOAD1,5,1,FX,LE,.5,0.,1.,600.")
    forces = {node["name"]: node.get("force_N", [0.0])[0] for node in made(tmp_path, bulk, beams_as_bars=True)["node"]}
    # p = 1200 (x - 0.5): 150 N in all; its moment about the start is 1200 (1/3 - 1/4 - (1/24 - 1/16)) = 125 N m.
    assert forces["N2"] == pytest.approx(125, rel=1e-12) and forces["N1"] == pytest.approx(25, rel=1e-12)


AREAS = [  # shape, dimensions, area by hand
    ("ROD", [0.01], pi * 1e-4), ("TUBE", [0.02, 0.01], pi * 3e-4), ("TUBE2", [0.02, 0.01], pi * 3e-4),
    ("BAR", [2, 3], 6), ("BOX", [5, 4, 0.2, 0.3], 20 - 4.4 * 3.6), ("BOX1", [5, 4, 0.2, 0.4, 0.3, 0.5], 20 - 4.2 * 3.4),
    ("I", [10, 4, 6, 0.5, 1, 2], 4 + 12 + 3.5), ("I1", [3, 1, 8, 10], 8 + 8), ("H", [3, 2, 5, 1], 13),
    ("T", [5, 6, 1, 2], 5 + 10), ("T1", [5, 4, 1, 2], 5 + 8), ("T2", [5, 6, 1, 2], 15), ("L", [5, 6, 1, 2], 15),
    ("CHAN", [4, 10, 1, 2], 16 + 6), ("CHAN1", [3, 1, 8, 10], 16), ("CHAN2", [1, 2, 6, 5], 12 + 6),
    ("Z", [3, 1, 8, 10], 16), ("CROSS", [4, 1, 6, 2], 14), ("HEXA", [1, 6, 3], 15), ("HAT", [5, 1, 4, 2], 4 + 8 + 4),
    ("HAT1", [10, 6, 4, 1, 1], 10 + 10 + 8), ("DBOX", [10, 4, 5, 1, 2, 1, 1, 1, 1, 1], 16 + 6 + 6),
]


@pytest.mark.parametrize("shape, sizes, area", AREAS, ids=[shape for shape, _, _ in AREAS])
def test_areas_of_sections(shape: str, sizes: list[float], area: float, tmp_path: Path) -> None:
    found = nastran(shape, sizes)
    assert found is not None and found.area == pytest.approx(area, rel=1e-12)
    for card in ("PBARL", "PBEAML"):
        fields = ",".join(repr(float(size)) for size in sizes[:8])
        more = "".join(f"\n,{repr(float(size))}" if at == 0 else f",{repr(float(size))}" for at, size in enumerate(sizes[8:]))
        bulk = ROD.replace("CROD,1,1,1,2", f"{'CBAR' if card == 'PBARL' else 'CBEAM'},1,1,1,2,0.,1.,0.").replace(
            "PROD,1,1,1.-4", f"{card},1,1,,{shape}\n,{fields}{more}")
        assert made(tmp_path, bulk, beams_as_bars=True)["link"][0]["cross_section_area_m2"] == pytest.approx(area, rel=1e-12)


def test_every_shape_has_a_test() -> None:
    assert {shape for shape, _, _ in AREAS} == set(NASTRAN)


BARS = {  # cards in place of CROD and PROD, and the displacement under 7000 N
    "tube": ("CTUBE,1,1,1,2\nPTUBE,1,1,.02,.001\n", 7000 / (E * pi * 0.019 * 0.001)),
    "full tube": ("CTUBE,1,1,1,2\nPTUBE,1,1,.02\n", 7000 / (E * pi * 1e-4)),
    "own section": ("CONROD,1,1,2,1,2.-4\n", 0.5e-3),
    "taper": ("CBEAM,1,1,1,2,0.,0.,1.\nPBEAM,1,1,4.-4,1.-8,1.-8,,2.-8\n,,,,,,,,\n,YES,1.,1.-4,1.-9,1.-9,,2.-9\n",
              7000 / E * np.log(4) / 3e-4),
    "taper with a station": ("CBEAM,1,1,1,2,0.,0.,1.\nPBEAM,1,1,4.-4,1.-8,1.-8,,2.-8\n,,,,,,,,\n"
                             ",NO,.5,1.-4,1.-9,1.-9,,2.-9\n,NO,1.,1.-4,1.-9,1.-9,,2.-9\n",
                             7000 / E * (0.5 * np.log(4) / 3e-4 + 0.5 / 1e-4)),
    "taper by shape": ("CBEAM,1,1,1,2,0.,0.,1.\nPBEAML,1,1,,BAR\n,.02,.02,0.,YES,1.,.01,.01\n",
                       7000 / E * np.log(4) / 3e-4),
    "equal offsets": ("CBAR,1,1,1,2,0.,1.,0.\n,,,0.,.1,0.,0.,.1,0.\nPBAR,1,1,1.-4\n", 1e-3),
    "offsets along it": ("CBAR,1,1,1,2,0.,1.,0.\n,,,-.25,.1,0.,.5,.1,0.\nPBAR,1,1,1.-4\n", 1.75e-3),
    "offsets that shorten it": ("CBAR,1,1,1,2,0.,1.,0.\n,,,.25,0.,0.\nPBAR,1,1,1.-4\n", 0.75e-3),
    "moments released": ("CBAR,1,1,1,2,0.,1.,0.\n,456,56\nPBAR,1,1,1.-4\n", 1e-3),
    "shear forces released": ("CBAR,1,1,1,2,0.,1.,0.\n,2356,0\nPBAR,1,1,1.-4\n", 1e-3),
    "default property": ("BAROR,,7\nCBAR,1,,1,2,0.,1.,0.\nPBAR,7,1,1.-4\n", 1e-3),
}


@pytest.mark.parametrize("name", BARS)
def test_bars_by_their_sections(name: str, tmp_path: Path) -> None:
    cards, wanted = BARS[name]
    bulk = ROD.replace("CROD,1,1,1,2\nPROD,1,1,1.-4\n", cards)
    assert moved(made(tmp_path, bulk, beams_as_bars=True)) == pytest.approx(wanted, rel=1e-9)


@pytest.mark.parametrize("element", ["CROD,1,1,1,2\nPROD,1,1,1.-4\n", "CONROD,1,1,2,1,1.-4\n", "CBAR,1,1,1,2,0.,1.,0.\nPBAR,1,1,1.-4\n"])
def test_a_bar_that_is_too_long_pushes(element: str, tmp_path: Path) -> None:
    """A rod that is 2 mm too long pushes a spring as stiff as itself by 1 mm."""
    bulk = ROD.replace("CROD,1,1,1,2\nPROD,1,1,1.-4\n", element).replace("FORCE,5,2,,7000.,1.,0.,0.", "DEFORM,5,1,.0015\nDEFORM,5,,,1,5.-4")
    document = made(tmp_path, bulk + "CELAS2,9,7.+6,2,1\n", CONTROL.replace("LOAD", "DEFORM"), beams_as_bars=True)
    assert document["link"][0]["stress_free_length_m"] == 1.002
    assert moved(document) == pytest.approx(1e-3, rel=2e-3)  # of the longer rod
    assert failure("deck_undefined", card="DEFORM", name="8", line=13 + element.count("\n")) == refusal(
        tmp_path, bulk + "DEFORM,5,8,.1\n", CONTROL.replace("LOAD", "DEFORM"), beams_as_bars=True)
    document = made(tmp_path, bulk, CONTROL.replace("LOAD = 5\n", ""), beams_as_bars=True)  # the set is not selected
    assert "stress_free_length_m" not in document["link"][0]


# A second bar in line whose axial force a pin flag releases. Its end is held along y and z.
LOOSE = ROD.replace("CROD,1,1,1,2\nPROD,1,1,1.-4\n", "CBAR,1,1,1,2,0.,1.,0.\nPBAR,1,1,1.-4\nGRID,3,,3.,0.,0.,,23\n")


@pytest.mark.parametrize("flags", ["1", ",1", "456,15", "1,1"])
def test_a_bar_without_axial_force_has_masses_only(flags: str, tmp_path: Path) -> None:
    bulk = LOOSE + f"CBAR,2,1,2,3,0.,1.,0.\n,{flags}\nCROD,3,3,1,3\nPROD,3,1,1.-4\n"
    document = made(tmp_path, bulk, beams_as_bars=True)
    assert [link["name"] for link in document["link"]] == ["L1", "L3"]
    assert [node.get("mass_kg") for node in document["node"]] == [None, pytest.approx(.27), pytest.approx(.27)]
    assert moved(document) == pytest.approx(1e-3, rel=1e-12)


def test_a_mass_without_a_bar_is_refused(tmp_path: Path) -> None:
    bulk = LOOSE + "CBAR,2,1,2,3,0.,1.,0.\n,,1\n"
    assert failure("deck_not_supported", card="CBAR", reason="no_bar_at_node") == refusal(tmp_path, bulk, beams_as_bars=True)
    document = made(tmp_path, bulk + "SPC1,1,1,3\n", beams_as_bars=True)  # a held mass is a part of the ground
    assert len(document["node"]) == 2 and moved(document) == pytest.approx(1e-3, rel=1e-12)


@pytest.mark.parametrize("flags, force", [("1", 1600.0), (",1", 0.0), ("", 800.0)])
def test_a_load_along_a_released_bar_acts_on_its_other_end(flags: str, force: float, tmp_path: Path) -> None:
    bulk = LOOSE + f"CBAR,2,1,3,2,0.,1.,0.\n,{flags}\nCROD,3,3,1,3\nPROD,3,1,1.-4\nPLOAD1,5,2,FX,FR,0.,800.,1.,800.\n"
    node = made(tmp_path, bulk, beams_as_bars=True)["node"][1]
    assert node["force_N"][0] == pytest.approx(7000 + force, rel=1e-12)


def test_a_bar_with_rigid_ends_expands_and_weighs_by_its_own_length(tmp_path: Path) -> None:
    bulk = ROD.replace("CROD,1,1,1,2\nPROD,1,1,1.-4\n", "CBAR,1,1,1,2,0.,1.,0.\n,,,-1.,0.,0.\nPBAR,1,1,1.-4\n")
    document = made(tmp_path, bulk, beams_as_bars=True, change=100.0)
    assert moved(document) == pytest.approx(2 * (1e-3 + 2.3e-5 * 100), rel=2e-3)  # of the heated bar
    assert document["link"][0]["density_kg_per_m3"] == 2 * 2700


def test_a_taper_weighs_its_mean_area(tmp_path: Path) -> None:
    link = made(tmp_path, ROD.replace("CROD,1,1,1,2\nPROD,1,1,1.-4\n", BARS["taper"][0]), beams_as_bars=True)["link"][0]
    assert link["density_kg_per_m3"] * link["cross_section_area_m2"] == pytest.approx(2700 * 2.5e-4, rel=1e-12)


def test_modulus_from_shear_modulus_and_poisson(tmp_path: Path) -> None:
    link = made(tmp_path, ROD.replace("MAT1,1,7.+10,,.3", "MAT1,1,,2.5+10,.4"))["link"][0]
    assert link["young_modulus_Pa"] == pytest.approx(7e10, rel=1e-12)
    assert made(tmp_path, ROD.replace("MAT1,1,7.+10,,.3", "MAT1,1,7.+10,2.8+10,"))["link"][0]["poisson_ratio"] == \
        pytest.approx(0.25, rel=1e-12)


SYSTEMS = {
    "rectangular": ("CORD2R,5,,0.,0.,0.,0.,0.,1.\n,0.,1.,0.\n", "GRID,2,5,1.,0.,0.", (0, 1, 0)),
    "cylindrical": ("CORD2C,5,,0.,0.,1.,0.,0.,2.\n,1.,0.,1.\n", "GRID,2,5,2.,90.,3.", (0, 2, 4)),
    "spherical": ("CORD2S,5,,0.,0.,0.,0.,0.,1.\n,1.,0.,0.\n", "GRID,2,5,2.,90.,90.", (0, 2, 0)),
    "nested": ("CORD2R,6,5,1.,0.,0.,1.,0.,1.\n,2.,0.,0.\nCORD2R,5,,0.,0.,0.,0.,0.,1.\n,0.,1.,0.\n",
               "GRID,2,6,1.,0.,0.", (0, 2, 0)),
    "by nodes": ("CORD1R,5,1,8,9\nGRID,8,,0.,0.,1.\nGRID,9,,0.,1.,0.\n", "GRID,2,5,1.,0.,0.", (0, 1, 0)),
    "default": ("CORD2R,5,,0.,0.,0.,0.,0.,1.\n,0.,1.,0.\nGRDSET,,5\n", "GRID,2,,1.,0.,0.", (0, 1, 0)),
}


@pytest.mark.parametrize("name", SYSTEMS)
def test_coordinate_systems(name: str, tmp_path: Path) -> None:
    cards, grid, wanted = SYSTEMS[name]
    (tmp_path / "deck.bdf").write_text(CONTROL + cards + ROD.replace("GRID,2,,1.,0.,0.", grid) + "ENDDATA\n")
    assert read(tmp_path / "deck.bdf").nodes["2"] == pytest.approx(wanted, abs=1e-15)


def test_supports_and_forces_in_their_own_systems(tmp_path: Path) -> None:
    """A force at 30 degrees pulls the end of a rod, which is guided along that direction."""
    turned = ROD.replace("GRID,2,,1.,0.,0.", "GRID,2,5,1.,0.,0.,5").replace("FORCE,5,2,", "FORCE,5,2,5")
    turned += "CORD2R,5,,0.,0.,0.,0.,0.,1.\n,.8660254037844387,.5,0.\n"
    document = made(tmp_path, turned)
    assert document["node"][1]["guide_normal"] == pytest.approx([-0.5, np.sqrt(3) / 2] if document["node"][1][
        "guide_normal"][1] > 0 else [0.5, -np.sqrt(3) / 2], rel=1e-12)
    assert moved(document) == pytest.approx(1e-3 * np.sqrt(3) / 2, rel=1e-6)


def test_two_oblique_directions_are_refused(tmp_path: Path) -> None:
    bulk = ROD.replace("GRID,2,,1.,0.,0.", "GRID,2,,1.,0.,0.,5") + "CORD2R,5,,0.,0.,0.,1.,1.,1.\n,1.,0.,0.\n" + \
        "GRID,3,,0.,0.,1.\nCROD,2,1,2,3\nSPC1,1,123,3\n"
    assert failure("deck_two_oblique_supports", node="2") == refusal(tmp_path, bulk)


def test_gravity_acts_on_masses_and_densities(tmp_path: Path) -> None:
    bulk = ROD.replace("FORCE,5,2,,7000.,1.,0.,0.", "GRAV,5,,9.81,1.,0.,0.\nCONM2,3,2,,100.\nPARAM,WTMASS,2.")
    document = made(tmp_path, bulk)
    assert document["truss"]["gravity_m_per_s2"] == [9.81, 0.0]
    assert document["node"][1]["mass_kg"] == 200 and document["link"][0]["density_kg_per_m3"] == 5400
    # Half of the rod's weight hangs at its end, as in the exact solution of the rod.
    assert moved(document) == pytest.approx((200 + 0.54 / 2) * 9.81 / 7e6, rel=1e-9)


def test_masses_of_conm1_and_of_bars(tmp_path: Path) -> None:
    bulk = ROD.replace("PROD,1,1,1.-4", "PROD,1,1,1.-4,,,.54")
    document = made(tmp_path, bulk + "CONM1,3,2,,4.,,4.\n,4.\n")
    assert document["node"][1]["mass_kg"] == 4 and document["link"][0]["density_kg_per_m3"] == pytest.approx(8100)
    assert failure("deck_not_supported", card="CONM1", reason="anisotropic_mass") == refusal(tmp_path, bulk + "CONM1,3,2,,4.,,5.\n,4.\n")


SUBCASES = "SOL 101\nCEND\nSPC = 1\nSUBCASE 1\n  LOAD = 5\nSUBCASE 2\n  TEMPERATURE(LOAD) = 20\nBEGIN BULK\n"


def test_one_subcase_is_taken(tmp_path: Path) -> None:
    bulk = ROD + "TEMPD,20,120.\n"
    assert moved(made(tmp_path, bulk, SUBCASES)) == pytest.approx(1e-3, rel=1e-12)
    assert moved(made(tmp_path, bulk, SUBCASES, None, step=2)) == pytest.approx(2.3e-3, rel=1e-12)
    deck = read(tmp_path / "deck.bdf", options=Options())
    (why,) = [why for card, why in deck.left if card == "SUBCASE 2"]
    assert "subcase 1 " in why and "--step" in why
    assert failure("undefined_subcase", key="--step", value=3, subcases="1, 2") == refusal(tmp_path, bulk, SUBCASES, step=3)


def test_initial_temperatures_hold_where_a_material_has_none(tmp_path: Path) -> None:
    control = CONTROL.replace("LOAD = 5", "TEMP(LOAD) = 20\nTEMP(INIT) = 30")
    bulk = ROD + "TEMPD,20,120.\nTEMPD,30,70.\n"
    assert moved(made(tmp_path, bulk, control, None)) == pytest.approx(2.3e-3, rel=1e-12)  # TREF = 20
    assert moved(made(tmp_path, bulk.replace(",20.\nSPC", "\nSPC"), control, None)) == pytest.approx(1.15e-3, rel=1e-12)


def test_a_card_of_two_rods_is_two_cards(tmp_path: Path) -> None:
    nodes = "GRID,3,,2.,0.,0.,,23\n"
    one = made(tmp_path, ROD + nodes + "CROD,7,1,2,3\n")
    two = made(tmp_path, ROD.replace("CROD,1,1,1,2\n", "CROD,1,1,1,2,7,1,2,3\n") + nodes)
    assert [link["name"] for link in two["link"]] == ["L1", "L7"]
    assert two == one


def test_properties_of_different_elements_have_one_number(tmp_path: Path) -> None:
    found = made(tmp_path, ROD + "PTUBE,1,1,.02,.001\nGRID,3,,2.,0.,0.,,23\nCTUBE,2,1,2,3\n")
    assert [link["cross_section_area_m2"] for link in found["link"]] == pytest.approx([A, pi * .019 * .001], rel=1e-12)


@pytest.mark.parametrize("rule", ["=,*(1),=,*(1),*(1)\n=(2)\n", "=(3),*(1),=,*(1),*(1)\n"])
def test_cards_repeat_by_a_rule(rule: str, tmp_path: Path) -> None:
    grids = "GRID,3,,2.,0.,0.,,23\nGRID,4,,3.,0.,0.,,23\nGRID,5,,4.,0.,0.,,23\n"
    document = made(tmp_path, ROD.replace("CROD,1,1,1,2\n", "CROD,1,1,1,2\n" + rule) + grids)
    assert [link["nodes"] for link in document["link"]] == [["N1", "N2"], ["N2", "N3"], ["N3", "N4"], ["N4", "N5"]]


def test_a_repeated_card_has_its_own_continuation(tmp_path: Path) -> None:
    text = ROD + "PBAR,8,1,1.-4,,,,,,+P1\n=,9,=,2.-4,,,,,,+P2\n+P1,1.,1.\n+P2,==\nGRID,3,,2.,0.,0.,,23\nCBAR,2,9,2,3,0.,1.,0.\n"
    assert made(tmp_path, text, beams_as_bars=True)["link"][1]["cross_section_area_m2"] == 2e-4


def test_an_equation_of_one_node_is_a_support_in_its_direction(tmp_path: Path) -> None:
    # The end slides along (1, 1): the bar carries the whole force along x, and half of it acts along y.
    bulk = ROD.replace("SPC1,1,23,2", "SPC1,1,3,2") + "MPC,9,2,1,1.,2,2,-1.\n"
    document = made(tmp_path, bulk, CONTROL.replace("SPC = 1", "SPC = 1\nMPC = 9"))
    assert document["node"][1]["guide_normal"] == pytest.approx([.5**.5, -.5**.5], rel=1e-12)
    document["node"][1]["force_N"] = [7.0, 0.0]
    assert moved(document, axis=1) == pytest.approx(1e-6, rel=1e-5)  # strain 1e-6, so nonlinear terms are as small
    assert moved(document, axis=0) == pytest.approx(1e-6, rel=1e-5)


def test_masses_of_rotations_have_no_influence(tmp_path: Path) -> None:
    assert made(tmp_path, ROD + "PARAM,ART_MASS,Y,0.,1.-6\n") == made(tmp_path, ROD)


def test_an_expansion_that_no_case_has_is_left_out_where_nothing_is_heated(tmp_path: Path) -> None:
    bulk = ROD.replace("2.3-5", "1.")
    assert moved(made(tmp_path, bulk)) == pytest.approx(1e-3, rel=1e-12)
    with failing("out_of_range", item="link 'L1'", key="thermal_expansion_per_K", value=1.0):
        sj.load(made(tmp_path, bulk, change=50.0))


def test_a_density_that_no_case_has_is_left_out_where_nothing_is_weighed(tmp_path: Path) -> None:
    bulk = ROD.replace("2700.", "1.+7")
    assert moved(made(tmp_path, bulk)) == pytest.approx(1e-3, rel=1e-12)
    with failing("out_of_range", item="link 'L1'", key="density_kg_per_m3", value=10000000.0):
        sj.load(made(tmp_path, bulk + "GRAV,5,,9.81,1.,0.,0.\n"))


def test_heat_transfer_of_cosmic_is_refused(tmp_path: Path) -> None:
    assert failure("deck_not_supported", card="APP HEAT", reason="heat_transfer", line=1) == refusal(tmp_path, ROD, "APP HEAT\n" + CONTROL)


def test_sets_of_supports_are_combined(tmp_path: Path) -> None:
    bulk = ROD.replace("SPC1,1,123,1", "SPC1,11,123,1").replace("SPC1,1,23,2", "SPC1,12,23,2") + "SPCADD,1,11,12\n"
    assert moved(made(tmp_path, bulk)) == pytest.approx(1e-3, rel=1e-12)


REFUSED = {  # cards besides the rod, and the reason of the refusal
    "shell": ("CQUAD4,2,1,1,2,2,1\n", failure("deck_not_supported", card="CQUAD4", reason="no_truss", line=14)),
    "unknown": ("CNEW,2,1\n", failure("deck_not_supported", card="CNEW", reason="unknown_card")),
    "rigid": ("RJOINT,9,1,2,1\n", failure("deck_not_supported", card="RJOINT", reason="no_truss")),
    "across": ("GRID,3,,1.,1.,0.\nSPC1,1,23,3\nCELAS2,2,7.+6,2,1,3,1\n", failure("deck_not_supported", card="CELAS2", reason="lateral_stiffness")),
    "at one place": ("GRID,3,,1.,0.,0.\nSPC1,1,23,3\nCELAS2,2,7.+6,2,1,3,1\n", failure("deck_not_supported", card="CELAS2", reason="coincident_nodes")),
    "rotation": ("CELAS2,2,7.+6,2,4,1,1\n", failure("deck_not_supported", card="CELAS2", reason="rotation")),
    "bush across": ("GRID,3,,3.,0.,0.\nSPC1,1,123,3\nCBUSH,2,9,2,3\nPBUSH,9,K,7.+6,1.\n", failure("deck_not_supported", card="CBUSH", reason="lateral_stiffness")),
    "given displacement": ("SPC,1,2,1,.1\n", failure("deck_not_supported", card="SPC", reason="prescribed_displacement")),
    "support of a free body": ("SUPORT,2,1\n", failure("deck_not_supported", card="SUPORT", reason="no_truss")),
    "load elsewhere": ("GRID,3,,5.,5.,5.\nFORCE,5,3,,1.,1.,0.,0.\n", failure("deck_not_supported", card="FORCE", reason="no_bar_at_node")),
    "parameter": ("PARAM,NEWONE,1\n", failure("deck_not_supported", card="PARAM.NEWONE", reason="unknown_parameter")),
    "artificial masses": ("PARAM,ART_MASS,Y,1.E-6\n", failure("deck_not_supported", card="PARAM.ART_MASS", reason="mass_at_every_node")),
    "inertia relief": ("PARAM,INREL,-2\n", failure("deck_not_supported", card="PARAM.INREL", reason="no_truss")),
    "temperature-dependent": ("MATT1,1,7\n", failure("deck_not_supported", card="MATT1", reason="no_truss")),
    "field": ("CONM1,3,2,,4.,1.,4.\n,4.\n", failure("deck_not_supported", card="CONM1.M21", reason="no_truss")),
    "two rods of one name": ("CROD,2,1,1,2,2,1,1,2\n", failure("deck_duplicate", line=14, what_it_is="element", name="2")),
    "two properties of one kind": ("PROD,1,1,2.-4\n", failure("deck_duplicate", card="PROD", what_it_is="property", name="1")),
    "shell of COSMIC": ("CQDMEM2,2,1,1,2,2,1\n", failure("deck_not_supported", card="CQDMEM2", reason="no_truss")),
    "rigid of COSMIC": ("CRIGD1,9,1,2\n", failure("deck_not_supported", card="CRIGD1", reason="no_truss")),
    "sector": ("PARAM,NSEGS,6\n", failure("deck_not_supported", card="PARAM.NSEGS", reason="no_truss")),
}


@pytest.mark.parametrize("name", REFUSED)
def test_what_matters_and_is_not_supported_is_named(name: str, tmp_path: Path) -> None:
    cards, sentence = REFUSED[name]
    assert sentence == refusal(tmp_path, ROD + cards)


def test_several_unsupported_cards_are_named_at_once(tmp_path: Path) -> None:
    refused = refusal(tmp_path, ROD + "CQUAD4,2,1\nMATT1,1,7\nSUPORT,2,1\n")
    assert refused == failure("deck_not_supported", card="CQUAD4")
    assert refused.details["why"].endswith("MATT1 (line 15), SUPORT (line 16)")


BENT = {
    "released end": ("CBAR,1,1,1,2,0.,1.,0.\n,,3\n", {}, failure("deck_not_supported", card="CBAR.PB", reason="released_shear", line=8)),
    "offset of a beam": ("CBAR,1,1,1,2,0.,1.,0.,GOO\n,,,0.,.1,0.,0.,.1,0.\n", {}, failure("deck_not_supported", card="CBAR.W1A-W3B", reason="offset_in_element")),
    "pin flag": ("CBAR,1,1,1,2,0.,1.,0.\n,,7\n", {"beams_as_bars": True}, failure("deck_bad_number", text="'7'", line=8)),
    "load on a loose bar": ("CBAR,1,1,1,2,0.,1.,0.\n,1,1\nPLOAD1,5,1,FX,FR,0.,1.,1.,1.\n", {"beams_as_bars": True}, failure("deck_not_supported", card="PLOAD1", reason="released_bar")),
    "offset": ("CBAR,1,1,1,2,0.,1.,0.\n,,,-.5,0.,0.,.5,.1,0.\n", {"beams_as_bars": True}, failure("deck_not_supported", card="CBAR.W1A-W3B", reason="unequal_offsets")),
    "load across": ("CBAR,1,1,1,2,0.,1.,0.\nPLOAD1,5,1,FY,FR,0.,1.,1.,1.\n", {"beams_as_bars": True}, failure("deck_not_supported", card="PLOAD1", reason="lateral_load")),
    "group of sections": ("CBAR,1,1,1,2,0.,1.,0.\nPBARL,1,1,MINE,ROD\n,1.\n", {"beams_as_bars": True}, failure("bar_without_property", kind="CBAR")),
}


@pytest.mark.parametrize("name", BENT)
def test_bending_is_not_left_out_in_silence(name: str, tmp_path: Path) -> None:
    cards, options, sentence = BENT[name]
    bulk = ROD.replace("CROD,1,1,1,2\n", cards).replace("PROD,1,1,1.-4\n", "" if "PBARL" in cards else "PBAR,1,1,1.-4\n")
    assert sentence == refusal(tmp_path, bulk, **options)


def test_ignore_leaves_out_what_it_names(tmp_path: Path) -> None:
    bulk = ROD + "CQUAD4,2,1,1,2,2,1\nCONM1,3,2,,4.,1.,4.\n,4.\n"
    document = made(tmp_path, bulk, ignored=frozenset({"CQUAD4", "CONM1.M21"}))
    assert document["node"][1]["mass_kg"] == 4 and len(document["link"]) == 1
    assert failure("nothing_to_ignore", key="--ignore", value="CQUAD8") == refusal(
        tmp_path, ROD, ignored=frozenset({"CQUAD8"}))


def test_units_of_a_deck(tmp_path: Path) -> None:
    bulk = ROD.replace("GRID,2,,1.", "GRID,2,,1000.").replace("1.-4", "100.").replace("7.+10", "7.+4").replace("2700.", "2.7-9")
    document = made(tmp_path, bulk + "CONM2,3,2,,.002\n", units=Units(1e-3))
    assert document["link"][0]["density_kg_per_m3"] == pytest.approx(2700) and document["node"][1]["mass_kg"] == 2
    assert moved(document) == pytest.approx(1e-3, rel=1e-12)


def test_directions_without_stiffness_are_held_as_in_nastran(tmp_path: Path) -> None:
    free = ROD.replace("SPC1,1,23,2\n", "GRID,3,,0.,5.,3.\nCROD,2,1,1,3\nSPC1,1,123,3\n")
    document = made(tmp_path, free)
    assert document["node"][1]["fixed"] == ["y", "z"] and moved(document) == pytest.approx(1e-3, rel=1e-12)
    for bulk, control in ((free + "PARAM,AUTOSPC,NO\n", CONTROL), (free, CONTROL.replace("SPC = 1", "AUTOSPC = NO\nSPC = 1"))):
        assert "fixed" not in made(tmp_path, bulk, control)["node"][1]
    beam = free.replace("CROD,1,1,1,2", "CBAR,1,9,1,2,0.,1.,0.\nPBAR,9,1,1.-4")
    assert "fixed" not in made(tmp_path, beam, beams_as_bars=True)["node"][1]


def test_gravity_without_mass_is_left_out(tmp_path: Path) -> None:
    bulk = ROD.replace("2700.", "").replace("FORCE,5,2,,7000.,1.,0.,0.", "GRAV,5,,9.81,1.,0.,0.")
    assert "gravity_m_per_s2" not in made(tmp_path, bulk)["truss"]
    document = made(tmp_path, bulk + "CONM2,3,2,,100.\n")
    assert moved(document) == pytest.approx(981 / 7e6, rel=1e-12)


@pytest.mark.parametrize("control, sentence", [
    ("SOL 159\nCEND\nSPC = 1\nBEGIN BULK\n", failure("deck_not_supported", card="SOL 159", reason="heat_transfer", line=1)),
    ("SOL 101\nCEND\nANALYSIS = HEAT\nSPC = 1\nBEGIN BULK\n", failure("deck_not_supported", card="ANALYSIS", reason="no_truss", line=3)),
    ("SOL 101\nCEND\nK2GG = STIFF\nSPC = 1\nBEGIN BULK\n", failure("deck_not_supported", card="K2GG", reason="no_truss", line=3)),
    ("SOL 101\nCEND\nSPC = 1\nSUBCOM 3\nBEGIN BULK\n", failure("deck_not_supported", card="SUBCOM", reason="subcase_combination", line=4)),
    ("SOL 101\nCEND\nSPC = 1\n", failure("deck_bad_syntax", line=2)),
    ("SOL 101\nCEND\nSPC = 1\nBEGIN BULK\nBEGIN SUPER=1\n", failure("deck_several_models", line=5)),
])
def test_what_the_control_sections_select_is_read_or_named(control: str, sentence: Failure, tmp_path: Path) -> None:
    assert sentence == refusal(tmp_path, ROD, control)
