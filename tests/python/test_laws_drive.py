# SPDX-License-Identifier: GPL-3.0-or-later
"""Laws of one contact along a displacement path, from Python and from the command line."""
from __future__ import annotations

import errno
import os
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from failures import Failure, failure
import statejump as sj
from statejump import laws
from statejump.core.table_files import read_columns

CONTACT: dict[str, Any] = dict(effective_young_modulus_Pa=38.5e9, effective_shear_modulus_Pa=7.9e9,
                               effective_radius_m=0.01, friction_coefficient=0.3)
OPTIONS = ["--effective-young-modulus", "38.5e9", "--effective-shear-modulus", "7.9e9", "--effective-radius", "0.01",
           "--friction-coefficient", "0.3"]
LOOP = {"slide_m": [0, 5e-8, -5e-8, 5e-8], "penetration_depth_m": [1e-6] * 4}


def test_spring_of_mindlin() -> None:
    stiffness = 8 * 7.9e9 * np.sqrt(0.01 * 1e-6)
    answer = laws.drive("mindlin", LOOP, **CONTACT, steps_per_row=10)
    assert answer["row"][[0, 1, -1]].tolist() == [1.0, 1.1, 4.0]
    np.testing.assert_allclose(answer["tangential_force_N"], stiffness * answer["slide_m"], rtol=0, atol=1e-12)
    np.testing.assert_allclose(answer["normal_force_N"], 4 / 3 * 38.5e9 * 0.1 * 1e-9, rtol=1e-14)
    assert not answer["slipping"].any() and not answer["friction_dissipation_J"].any()


def test_forces_and_displacements_are_inverse() -> None:
    there = laws.drive("mindlin", LOOP, **CONTACT, steps_per_row=4)
    back = sj.laws.drive("mindlin", {name: there[name] for name in ("normal_force_N", "tangential_force_N")}, **CONTACT)
    for name in ("slide_m", "penetration_depth_m"):
        np.testing.assert_allclose(back[name], there[name], rtol=0, atol=1e-20)


def test_partial_slip() -> None:
    """First loading and Masing's rule; another test has Mindlin's spring."""
    gross = 0.3 * 38.5e9 / (4 * 7.9e9) * 1e-6  # mu E*/(4 G*) depth
    path = {"slide_m": [0, 0.6 * gross, -0.2 * gross, 0.6 * gross], "penetration_depth_m": [1e-6] * 4}
    answer = laws.drive("mindlin_deresiewicz", path, **CONTACT, steps_per_row=20)
    first = [1 - (1 - share) ** 1.5 for share in (0.6, 0.4)]
    limit = 0.3 * answer["normal_force_N"][0]
    np.testing.assert_allclose(answer["tangential_force_N"][[20, 40, 60]],
                               limit * np.array([first[0], first[0] - 2 * first[1], first[0]]), rtol=0, atol=1e-12)
    assert answer["memory_points"].max() == 5 and not answer["merged_force_N"].any() and not answer["slipping"].any()


def test_in_the_plane() -> None:
    path = {"slide_x_m": [0, 3e-8], "slide_y_m": [0, 4e-8], "penetration_depth_m": [1e-6, 1e-6]}
    answer = laws.drive("mindlin", path, **CONTACT)
    assert answer["tangential_force_y_N"][-1] / answer["tangential_force_x_N"][-1] == pytest.approx(4 / 3, rel=1e-14)


@pytest.mark.parametrize("kind", ["friction", "normal", "dissipation"])
def test_every_law(kind: str) -> None:
    """The path is load, slide, open, load: no law has a force while the contact is open."""
    path = {"time_s": np.arange(5) * 1e-3, "slide_m": [0, 1e-7, 1e-7, 0, 1e-7],
            "penetration_depth_m": [1e-7, 1e-6, -1e-6, 1e-6, 1e-6]}
    for law in laws.catalogue(kind):
        answer = laws.drive(law.name, path, **CONTACT, steps_per_row=8, radial_clearance_m=1e-4, restitution=0.5)
        open_ = answer["penetration_depth_m"] <= 0
        assert open_.any()
        assert not answer["normal_force_N"][open_].any() and not answer["tangential_force_N"][open_].any()
        assert (answer["normal_force_N"][~open_] > 0).all() or kind == "dissipation"
        for heat in ("friction_dissipation_J", "damping_dissipation_J"):
            assert (np.diff(answer[heat]) >= 0).all(), law.name


@pytest.mark.parametrize("law, change, sentence", [
    ("mindlyn", {}, failure("not_one_of", key="law", value="mindlyn")),
    ("material", {}, failure("not_one_of", key="law", value="material")),
    ("mindlin", {"slide_m": None}, failure("history_column_missing", section="column slide_m", needs_="slide_m, slide_x_m with slide_y_m, or tangential_force_N")),
    ("mindlin", {"penetration_depth_m": None}, failure("history_column_missing", section="column penetration_depth_m", needs_="penetration_depth_m or normal_force_N")),
    ("mindlin", {"slide_mm": [0, 1, 2, 3]}, failure("misspelt_key", section="column slide_mm", meant="slide_m")),
    ("mindlin", {"tangential_force_N": [0.0] * 4}, failure("history_columns_exclude", key="tangential_force_N", other="slide_m", needs_="slide_m, slide_x_m with slide_y_m, or tangential_force_N")),
    ("mindlin", {"normal_force_N": [1.0] * 4}, failure("history_columns_exclude", key="normal_force_N", other="penetration_depth_m", needs_="penetration_depth_m or normal_force_N")),
    ("mindlin", {"slide_m": None, "slide_x_m": [0.0] * 4}, failure("column_partner_missing", section="column slide_y_m", partner="slide_x_m")),
    ("mindlin", {"slide_m": [0, np.nan, 0, 0]}, failure("not_finite", item="row 2", key="slide_m", value=float("nan"))),
    ("mindlin", {"slide_m": ["0", "a", "0", "0"]}, failure("column_no_numbers", key="slide_m")),
    ("mindlin", {"slide_m": [0, 1]}, failure("columns_of_other_length", cause="slide_m has 2, penetration_depth_m has 4")),
    ("mindlin", {"penetration_depth_m": None, "normal_force_N": [1, 1, -1, 1]},
     failure("tensile_force", item="row 3", key="normal_force_N", value=-1.0)),
    ("mindlin", {"slide_m": None, "tangential_force_N": [1e-3, 0, 0, 0]},
     failure("first_row_not_zero", item="row 1", key="tangential_force_N", value=0.001)),
    ("mindlin", {"slide_m": None, "tangential_force_N": [0, 0, 2, 0]},
     failure("law_failed", item="row 3", law="mindlin", why="tangential_force = 2 N, allowed is what friction carries, at most 1.54 N")),
    ("ambrosio", {}, failure("law_needs_time", section="column time_s", law="ambrosio")),
    ("flores", {}, failure("law_needs_time", section="column time_s", law="flores")),
    ("flores", {"time_s": [0, 1, 1, 2]}, failure("history_times_not_increasing", item="row 3", key="time_s", value=1.0)),
    ("flores", {"time_s": [0, 1, 2, 3], "penetration_depth_m": None, "normal_force_N": [1.0] * 4},
     failure("law_needs_penetration", key="normal_force_N", law="flores")),
    ("johnson", {}, failure("law_argument_out_of_range", key="radial_clearance_m", value=float("inf"), needed="finite for a line contact [m]")),
])
def test_bad_history(law: str, change: dict[str, Any], sentence: Failure) -> None:
    history = {name: values for name, values in {**LOOP, **change}.items() if values is not None}
    with pytest.raises(sj.StatejumpError) as refused:
        laws.drive(law, history, **CONTACT)
    assert refused.value == sentence


@pytest.mark.parametrize("change, sentence", [
    ({"effective_radius_m": -1.0}, failure("law_argument_out_of_range", key="effective_radius_m", value=-1.0, needed="(0, inf) m")),
    ({"effective_shear_modulus_Pa": 0.0}, failure("law_argument_out_of_range", key="effective_shear_modulus_Pa", value=0.0, needed="(0, inf) Pa")),
    ({"friction_coefficient": -0.1}, failure("law_argument_out_of_range", key="friction_coefficient", value=-0.1, needed="[0, inf)")),
    ({"steps_per_row": 0}, failure("not_positive_integer", key="steps_per_row", value=0)),
])
def test_bad_contact(change: dict[str, Any], sentence: Failure) -> None:
    with pytest.raises(sj.StatejumpError) as refused:
        laws.drive("mindlin", LOOP, **{**CONTACT, **change})
    assert refused.value == sentence


def test_command(statejump, tmp_path: Path) -> None:
    (tmp_path / "history.csv").write_text("slide_m,penetration_depth_m\n0,1e-6\n5e-8,1e-6\n")
    outcome = statejump("laws", "--drive", "history.csv", "--law", "mindlin", *OPTIONS, "--steps-per-row", "5", "-o",
                        "out.csv")
    assert (outcome.status, outcome.output) == (0, "written: out.csv\n"), outcome.errors
    written = read_columns(tmp_path / "out.csv")
    wanted = laws.drive("mindlin", tmp_path / "history.csv", **CONTACT, steps_per_row=5)
    assert list(written) == list(wanted)
    for name, values in wanted.items():
        assert written[name].tolist() == values.tolist(), name


def test_a_mark_of_byte_order_is_no_part_of_the_first_name(tmp_path: Path) -> None:
    text = "slide_m,penetration_depth_m\n0,1e-6\n1e-9,1e-6\n"
    for name, coding in (("plain.csv", "utf-8"), ("office.csv", "utf-8-sig")):
        (tmp_path / name).write_text(text, encoding=coding)
    plain, office = (laws.drive("mindlin", tmp_path / name, **CONTACT) for name in ("plain.csv", "office.csv"))
    assert list(plain) == list(office) and plain["slide_m"].tolist() == office["slide_m"].tolist()


@pytest.mark.parametrize("text, sentence", [
    (None, failure("read_failed", file="history.csv", cause=os.strerror(errno.ENOENT))),
    ("slide_m,penetration_depth_m\n", failure("no_samples", file="history.csv")),
    ("slide_m,penetration_depth_m\n0\n", failure("row_of_other_length", file="history.csv", line=2, cells=1, width=2)),
    ("slide_m,penetration_depth_m\n0,0\n0,0,0\n", failure("row_of_other_length", file="history.csv", line=3, cells=3, width=2)),
    ("slide_m\n0\n", failure("history_column_missing", file="history.csv", section="column penetration_depth_m", needs_="penetration_depth_m or normal_force_N")),
])
def test_bad_file(statejump, tmp_path: Path, text: str | None, sentence: Failure) -> None:
    if text is not None:
        (tmp_path / "history.csv").write_text(text)
    outcome = statejump("laws", "--drive", "history.csv", "--law", "mindlin", *OPTIONS, "-o", "out.csv")
    assert (outcome.status, outcome.failure) == (2, sentence)
    assert not (tmp_path / "out.csv").exists()
