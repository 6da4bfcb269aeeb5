# SPDX-License-Identifier: GPL-3.0-or-later
"""Units of decks: printed quantities to check them, hints at wrong units, and options that set them."""
from __future__ import annotations

from pathlib import Path
from typing import Callable

import pytest
from conftest import Outcome
from failures import failure

import statejump as sj

# A rod of steel, 1 m long, in millimetres and newtons: 2e5 MPa, 100 mm2, 7.85e-9 t/mm3, 1 t at its end.
DECK = """BEGIN BULK
GRID,1,,0.,0.,0.
GRID,2,,1000.,0.,0.
CROD,1,1,1,2
PROD,1,1,{area}
MAT1,1,{modulus},,.3,{density},1.2-5,20.
CONM2,2,2,,{mass}
SPC1,1,123,1
SPC1,1,23,2
FORCE,5,2,,{force},1.,0.,0.
TEMPD,7,120.
ENDDATA
"""
MILLIMETRES = {"area": "100.", "modulus": "2.+5", "density": "7.85-9", "mass": "1.", "force": "1000."}
KILONEWTONS = {**MILLIMETRES, "modulus": "200.", "force": "1."}
KILOGRAMS = {"area": "100.", "modulus": "2.+8", "density": "7.85-6", "mass": "1000.", "force": "1.+6"}


@pytest.mark.parametrize("numbers, options", [
    (MILLIMETRES, ["--units", "mm-N"]), (MILLIMETRES, ["--length-unit", "0.001"]), (KILONEWTONS, ["--units", "mm-kN-t"]),
    (KILOGRAMS, ["--units", "mm-kg-s"]),
], ids=["mm-N", "length", "mm-kN-t", "mm-kg-s"])
def test_a_deck_is_the_same_in_all_units(numbers: dict[str, str], options: list[str], tmp_path: Path,
                                         statejump: Callable[..., Outcome]) -> None:
    (tmp_path / "rod.bdf").write_text(DECK.format(**numbers))
    told = statejump("truss", "import", "rod.bdf", "-o", "rod.toml", *options)
    assert told.status == 0 and "hint" not in told.output, told.errors + told.output
    case = sj.load(tmp_path / "rod.toml")
    link, node = case.link[0], case.node[1]
    assert (link.young_modulus_Pa, link.cross_section_area_m2) == pytest.approx((2e11, 1e-4), rel=1e-12)
    assert (link.density_kg_per_m3, node.mass_kg, node.force_N[0]) == pytest.approx((7850, 1000, 1000), rel=1e-12)
    words = " ".join(told.output.split())
    for part in ("bounding box [m]", "1 x 0", "total mass [kg]", "1000.78", "2e+11", "0.0001", "1.2e-05", "100"):
        assert part in words


def test_inches_and_pounds(tmp_path: Path, statejump: Callable[..., Outcome]) -> None:
    (tmp_path / "rod.bdf").write_text(DECK.format(
        area=".155", modulus="2.9+7", density=".2836", mass="100.", force="10.").replace("1000.,0.", "39.37,0.").replace(
        "ENDDATA", "PARAM,WTMASS,.00259\nENDDATA"))
    told = statejump("truss", "import", "rod.bdf", "-o", "rod.toml", "--units", "in-lbf")
    assert told.status == 0 and "hint" not in told.output
    case = sj.load(tmp_path / "rod.toml")
    assert case.link[0].young_modulus_Pa == pytest.approx(2e11, rel=1e-3)  # 29 Msi is 199.9 GPa
    assert case.link[0].density_kg_per_m3 == pytest.approx(7850, rel=1e-3)
    assert case.node[1].mass_kg == pytest.approx(45.36, rel=1e-3)  # 100 lb
    assert case.node[1].force_N[0] == pytest.approx(44.482216152605, rel=1e-12)


@pytest.mark.parametrize("numbers, sentence", [
    (MILLIMETRES, "2e+05 Pa "),
    ({**MILLIMETRES, "modulus": "2.+11", "area": "1.-4", "density": "7850."}, ""),
    ({**MILLIMETRES, "area": "50."}, "area: 50 m2 "),
])
def test_implausible_numbers_are_hinted_at(numbers: dict[str, str], sentence: str, tmp_path: Path,
                                           statejump: Callable[..., Outcome]) -> None:
    (tmp_path / "rod.bdf").write_text(DECK.format(**numbers).replace("1000.,0.", "900.,0."))
    told = statejump("truss", "import", "rod.bdf", "-o", "rod.toml")
    assert told.status == 0, told.errors
    words = " ".join(told.output.split())
    assert sentence in words if sentence else "hint" not in words


def test_numbers_out_of_range_name_the_option(tmp_path: Path, statejump: Callable[..., Outcome]) -> None:
    (tmp_path / "rod.bdf").write_text(DECK.format(**{**MILLIMETRES, "area": "500."}))
    told = statejump("truss", "import", "rod.bdf", "-o", "rod.toml")
    assert (told.status, told.failure) == (2, failure("out_of_range"))
    assert told.failure.remedy.startswith("--units mm-N")
    told = statejump("truss", "import", "rod.bdf", "-o", "rod.toml", "--units", "mm-N", "--length-unit", "0.001")
    assert (told.status, told.failure) == (2, failure("units_given_twice", key="--length-unit", value=0.001, system="mm-N"))
