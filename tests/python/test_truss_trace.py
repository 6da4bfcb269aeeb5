# SPDX-License-Identifier: GPL-3.0-or-later
"""Trace of the truss solver: a row for every Newton iteration, and no influence on the path."""
from __future__ import annotations

from itertools import groupby
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

from conftest import results_in
from failures import failure
import statejump as sj
from statejump.core.errors import FailedRun, NotAllowed, StatejumpError
from statejump.kinds.truss import generate, solve
from statejump.kinds.truss.trace import COLUMNS

ENDS = {"converged", "event_ahead", "singular", "not_converged", "stopped"}


def traced(case: sj.Case) -> tuple[pd.DataFrame, Any]:
    rows: list[tuple[Any, ...]] = []
    run = case.reduced(trace=rows.append)
    return pd.DataFrame(rows, columns=COLUMNS), run


@pytest.mark.parametrize("name", ["chain", "umbrella"])
def test_a_trace_does_not_change_the_path(name: str) -> None:
    document = getattr(generate, name)(3)
    rows, traced_run = traced(sj.load(document))
    plain = sj.load(document).reduced()
    assert len(rows) > 100
    pd.testing.assert_frame_equal(traced_run.frame(), plain.frame(), check_exact=True)


def test_rows_are_those_of_the_solves_of_the_path() -> None:
    case = sj.load(generate.chain(3))
    rows, _ = traced(case)
    path = solve.solve(case)
    assert rows["solve"].is_monotonic_increasing
    # The path counts one solve for each step; a step may need several.
    assert path.solves <= rows["solve"].max() <= path.solves + rows["step"].max()
    assert 0 < rows["factorizations"].sum() <= path.factorizations
    for _, solved in rows.groupby("solve"):
        assert list(solved["iteration"]) == list(range(1, len(solved) + 1))
        assert list(solved["decision"].isin(ENDS)) == [False] * (len(solved) - 1) + [True]
    done = rows[rows["step_end"] == "done"]
    assert len(done) == done["step"].nunique() and (done["time_s"].diff().dropna() > 0).all()


def test_a_converged_row_meets_the_tolerances() -> None:
    rows, _ = traced(sj.load(generate.chain(3)))
    converged = rows[rows["decision"] == "converged"]
    largest_N = 3 * 122.85  # the support carries the friction of all blocks
    assert (converged["node_residual_N"] <= 1e-12 * largest_N).all()
    assert (converged["joint_residual_N"] <= 1e-12 * largest_N).all()
    assert converged["step_length_m"].isna().all()
    stepped = rows[rows["decision"] == "step"]
    assert (stepped["step_length_m"] >= 0).all() and stepped["step_length_m"].max() < 1e-3


def test_changes_of_status_name_their_joint() -> None:
    case = sj.load(generate.chain(3))
    rows, run = traced(case)
    changes = rows[rows["status_changes"] > 0]
    assert set(changes["changed_joint"]) == {event.joint for event in run.events} == {"S1", "S2", "S3"}
    assert (rows[rows["status_changes"] == 0]["changed_joint"] == "").all()


def test_rows_name_branch_and_increment() -> None:
    rows, _ = traced(sj.load(generate.chain(1)))
    assert (rows[rows["branch"] == 0]["time_s"] == 0).all()
    branches = [branch for branch, _ in groupby(rows["branch"])]
    assert branches == [0, 1, 2]
    assert sorted(set(rows["increment"])) == list(range(51))


def test_the_first_equilibrium_is_traced_with_its_stand_ins() -> None:
    rows, _ = traced(sj.load(generate.umbrella(1)))
    start = rows[rows["step"] == 0]
    assert set(start["joints"]) >= {"pins", "frictionless"}
    assert start["opening"].max() == 1.0


def test_halved_steps_are_half_as_long() -> None:
    collected: list[tuple[Any, ...]] = []
    with pytest.raises(FailedRun):  # slip runs away
        sj.load("cases/trusses/two_bar_snap.toml").reduced(trace=collected.append)
    rows = pd.DataFrame(collected, columns=COLUMNS)
    halved = rows.index[(rows["decision"] == "halved_step") & (rows["decision"].shift() == "step")]
    assert len(halved) > 10
    np.testing.assert_array_equal(rows["step_length_m"][halved], 0.5 * rows["step_length_m"][halved - 1].to_numpy())


def test_a_failed_path_leaves_its_trace(tmp_path: Path) -> None:
    case = sj.load("cases/trusses/two_bar_snap.toml")
    file = tmp_path / "trace.csv"
    with pytest.raises(FailedRun):
        case.reduced(trace=file)
    rows = pd.read_csv(file)
    assert tuple(rows.columns) == COLUMNS
    assert rows["step_end"].iloc[-1] == "failed"


def test_command(statejump, tmp_path: Path) -> None:
    (tmp_path / "chain.toml").write_text(sj.truss.chain(2).to_toml())
    outcome = statejump("reduced", "chain.toml", "--trace", tmp_path / "trace.csv")
    assert outcome.status == 0, outcome.errors
    assert outcome.output.splitlines()[-1] == f"trace: {tmp_path / 'trace.csv'}"
    rows, _ = traced(sj.truss.chain(2))
    written = pd.read_csv(tmp_path / "trace.csv", keep_default_na=False, na_values={"step_length_m": [""]},
                          float_precision="round_trip")
    pd.testing.assert_frame_equal(written, rows, check_exact=True, check_dtype=False)


@pytest.mark.parametrize("option", ["--dynamic", "--quasi-static"])
def test_other_models_have_no_trace(statejump, cases: Path, tmp_path: Path, option: str) -> None:
    outcome = statejump("reduced", cases / "trusses" / "chain_10.toml", option, "--trace", "trace.csv")
    assert outcome.status == 2 and option in outcome.errors
    assert results_in(tmp_path) == []


def test_refused_before_anything_is_solved(statejump, cases: Path, tmp_path: Path) -> None:
    outcome = statejump("reduced", cases / "table1.toml", "--trace", "trace.csv")
    assert (outcome.status, outcome.failure) == (2, failure(
        "command_not_for_kind", key="case.kind", value="spring_slider", command="reduced --trace", kinds="'truss'"))
    with pytest.raises(NotAllowed):
        sj.truss.chain(1).reduced(trace=tmp_path / "trace.png")
    with pytest.raises(StatejumpError):
        sj.truss.chain(1).reduced(dynamic=True, trace=tmp_path / "trace.csv")
    with pytest.raises(StatejumpError):
        sj.truss.chain(1).reduced(trace=tmp_path / "none" / "trace.csv")


def test_an_error_of_the_callers_function_ends_the_path() -> None:
    def fails(row: tuple[Any, ...]) -> None:
        raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        sj.truss.chain(1).reduced(trace=fails)
