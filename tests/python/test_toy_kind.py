# SPDX-License-Identifier: GPL-3.0-or-later
"""A kind of case is added from a folder of the tests, without changes to files of the package."""
from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any, Callable

import pytest

from failures import failure
import statejump as sj
from statejump import kinds

HERE = Path(__file__).resolve().parent
PLACE = "toy_kind:KIND"
CASE = """[case]
name = "rod"
kind = "toy"
title = "A rod with a residue"

[rod]
length_m = 2.0

[thermal]
shape = "triangle"
temperature_change_max_K = 100.0
"""
# 2 m, 2e-5 /K, 100 K, a tenth stays.
JUMP_m = 2.0 * 2e-5 * 100.0 * 0.1


@pytest.fixture
def rod(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """A case file of the toy kind of case, which is registered only during the test."""
    monkeypatch.syspath_prepend(str(HERE / "toy"))
    known = dict(kinds.KINDS)
    kinds.register(PLACE)
    path = tmp_path / "rod.toml"
    path.write_text(CASE)
    yield path
    kinds.KINDS.clear()
    kinds.KINDS.update(known)


def test_both_models_and_their_comparison(rod: Path) -> None:
    case = sj.load(rod)
    run = case.reduced()
    # Rounding of three products and a sum.
    assert run.summary["tip_jump_m"] == pytest.approx(JUMP_m, rel=1e-14)
    assert list(run.frame()) == ["time_s", "temperature_change_K", "tip_m", "elastic_energy_J"]
    assert sj.compare(run, case.dem()).passed
    wrong = case.changed({"numerics.error_m": 1e-6})
    assert sj.compare(wrong.reduced(), wrong.dem()).missed == ["tip_jump"]
    assert len(run.plot().axes) == 1


def test_range_of_a_key_is_kept(rod: Path) -> None:
    with pytest.raises(sj.StatejumpError) as refused:
        sj.load(rod).changed({"rod.length_m": -1.0})
    assert refused.value.key == "rod.length_m" and refused.value.value == -1.0


def test_commands(rod: Path, statejump: Callable[..., Any], tmp_path: Path) -> None:
    done = statejump("compare", rod)
    assert done.status == 0, done.errors
    assert "tip_jump" in done.output
    written = tmp_path / "results" / "rod"
    assert {"comparison.h5", "comparison.csv", "rod.png", "reduced_history.csv"} <= {path.name for path in written.iterdir()}
    again = sj.read(written / "comparison.h5")
    assert again.models["dem"].summary["tip_jump_m"] == pytest.approx(JUMP_m, rel=1e-14)
    assert statejump("info", written / "comparison.h5").status == 0
    done = statejump("report", written)
    assert done.status == 0, done.errors
    page = (written / "report.html").read_text(encoding="utf-8")
    assert "rod of 2 m" in page


def test_commands_that_the_kind_lacks_refuse_it(rod: Path, statejump: Callable[..., Any]) -> None:
    for command in ("control", "statics", "hold", "slow", "energy", "convergence"):
        done = statejump(command, rod)
        assert done.status == 2, (command, done)
        assert (done.failure.key, done.failure.value) == ("case.kind", "toy") and "Traceback" not in done.errors, (command, done)


def test_sweep(rod: Path) -> None:
    swept = sj.sweep(sj.load(rod), {"rod.residue": [0.0, 0.1, 0.2]})
    table = swept.frame()
    assert table["tip_jump_m"].to_numpy() == pytest.approx([0.0, JUMP_m, 2 * JUMP_m], rel=1e-12, abs=1e-18)


def test_schema(rod: Path, statejump: Callable[..., Any]) -> None:
    done = statejump("schema", "toy")
    assert done.status == 0, done.errors
    assert '"length_m"' in done.output and '"x-unit": "m"' in done.output


def test_environment_makes_it_known_to_the_command(rod: Path, statejump: Callable[..., Any]) -> None:
    done = statejump("reduced", rod, STATEJUMP_KINDS=PLACE, PYTHONPATH=str(HERE / "toy"))
    assert done.status == 0, done.errors
    assert ": 4.000000e-04 m" in done.output


def test_unknown_place_is_one_sentence(statejump: Callable[..., Any]) -> None:
    done = statejump("--json", "reduced", "cases/table1.toml", STATEJUMP_KINDS="nowhere:KIND")
    assert done.status == 2 and done.failure == failure("kind_not_loaded", name="nowhere:KIND"), done.errors
