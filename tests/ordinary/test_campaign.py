# SPDX-License-Identifier: GPL-3.0-or-later
"""The campaign of structures: a crash or a time-out gives a table row, and invalid reasons are detected."""
from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import pytest

import campaign
from campaign import groups, outcome, wrong_reason

ODD = """
import json, os, signal, sys
for line in sys.stdin:
    family, seed = line.split()
    print(json.dumps({"kind": "path", "clearance": False, "joints": 1, "class_a": True, "slack": False}), flush=True)
    if seed == "1":
        os.kill(os.getpid(), signal.SIGSEGV)
    if seed == "2":
        signal.setitimer(signal.ITIMER_PROF, float(sys.argv[1]))
        while True:
            pass
    print(json.dumps({"outcome": "finished", "reason": "", "sentence": "", "seconds": 0.1}), flush=True)
"""


@pytest.fixture
def odd(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "worker.py").write_text(ODD)
    monkeypatch.setattr(campaign, "HERE", tmp_path)


@pytest.mark.usefixtures("odd")
def test_a_crash_and_a_time_out_do_not_end_the_campaign() -> None:
    found = list(campaign.solved([("warren", 0), ("warren", 1), ("warren", 2), ("warren", 3)], 1, 0.5, 0))
    assert [outcome(row) for row in found] == ["finished", "crash: SIGSEGV", "time-out: SIGPROF", "finished"]
    assert len(groups(found)["class A, no clearance joint"]) == 4
    assert "| crash | 1 |" in campaign.summary(found)


def row(kind: str, result: str, reason: str) -> dict[str, Any]:
    return {"family": "warren", "kind": kind, "outcome": result, "reason": reason}


def test_a_reason_is_wrong_where_theory_states_another() -> None:
    assert wrong_reason(row("path", "failed", "buckled"))
    assert wrong_reason(row("overloaded", "failed", "not_converged"))
    assert not wrong_reason(row("path", "failed", "too_many_steps"))
    assert not wrong_reason(row("mechanism", "failed", "held_mechanism"))
    assert not wrong_reason(row("undetermined", "failed", "buckled"))


def test_the_command_refuses_unknown_families(capsys: pytest.CaptureFixture[str], monkeypatch: Any) -> None:
    monkeypatch.setattr(sys, "argv", ["campaign.py", "--families", "igloo"])
    with pytest.raises(SystemExit):
        campaign.main()
    assert "igloo" in capsys.readouterr().err
