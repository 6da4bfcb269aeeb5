# SPDX-License-Identifier: GPL-3.0-or-later
"""Quasi-static paths of a rib, from Python and from the command line."""
from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from conftest import results_in
from failures import failure
import statejump as sj
from statejump.core.errors import FailedRun


def test_paths_of_a_loaded_rib() -> None:
    """Both paths slip during heating and during cooling. Elastic links change the jump by the relative strain, about
    1e-4."""
    found = sj.load("umbrella_bias").quasi_static()
    for links in ("rigid", "elastic"):
        assert found.events(links)["motion"].tolist()[:4] == ["roll", "slip", "roll", "slip"]
        frame = found.frame(links)
        jump = frame["theta2_rad"].iloc[-1] - frame["theta2_rad"].iloc[0]
        assert found.summary[f"theta2_jump_{links}_rad"] == pytest.approx(jump, rel=1e-9)
    assert found.summary["theta2_jump_elastic_rad"] == pytest.approx(found.summary["theta2_jump_rigid_rad"], rel=1e-3)
    assert "normal_force_N" in found.frame("elastic") and found.warnings == []


def test_no_path_without_a_load() -> None:
    with pytest.raises(FailedRun):
        sj.load("umbrella").quasi_static()


def test_command(statejump: Callable[..., Any], tmp_path: Path, cases: Path) -> None:
    done = statejump("reduced", "--quasi-static", cases / "umbrella_bias.toml")
    assert done.status == 0 and "theta2_jump_elastic_rad" in done.output, done.errors
    assert set(results_in(tmp_path / "results" / "umbrella_bias_quasi_static")) == {
        f"quasi_static_{links}{what}.csv" for links in ("rigid", "elastic") for what in ("", "_events")}
    refused = statejump("reduced", "--quasi-static", cases / "table1.toml")
    assert refused.status == 2 and refused.failure == failure(
        "command_not_for_kind", key="case.kind", value="spring_slider", command="reduced --quasi-static")
    refused = statejump("--json", "reduced", "--quasi-static", "--dynamic", cases / "umbrella_bias.toml")
    assert refused.status == 2 and refused.errors == failure("usage"), refused.errors
