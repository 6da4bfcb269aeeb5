# SPDX-License-Identifier: GPL-3.0-or-later
"""scripts/run_with_time_limit.sh: when a check runs, when it is skipped and with which message, when it fails."""
from __future__ import annotations

import os
import subprocess
from pathlib import Path

import pytest

SCRIPTS = Path(__file__).resolve().parents[2] / "scripts"
FORTY_MINUTES, QUARTER = 2400, 900


def run(*arguments: object, **named: str) -> subprocess.CompletedProcess[str]:
    """Run the script with the name of a check in front."""
    return subprocess.run([SCRIPTS / "run_with_time_limit.sh", "the check", *map(str, arguments)], capture_output=True,
                          text=True, check=False, env={**os.environ, **named})


@pytest.mark.parametrize(("used", "runs"), [(0, True), (1500, True), (1501, False), (2400, False), (5000, False)])
def test_a_check_runs_where_what_it_takes_is_left(used: int, runs: bool):
    done = run(FORTY_MINUTES, used, QUARTER, "echo", "it ran")
    assert done.returncode == 0
    if runs:
        assert done.stdout == "it ran\nthe check passed\n"
    else:
        assert done.stdout == f"the check skipped: takes about 15 min, {(used + 30) // 60} min of 40 min are used\n"


@pytest.mark.parametrize("status", [1, 2, 8])
def test_a_failure_is_a_failure(status: int):
    done = run(FORTY_MINUTES, 0, QUARTER, "bash", "-c", f"echo output; exit {status}")
    assert (done.returncode, done.stdout) == (status, f"output\nthe check FAILED ({status})\n")


def test_what_cannot_run_here_is_skipped_with_its_reason():
    done = run(FORTY_MINUTES, 0, QUARTER, "bash", "-c", "echo first; echo no network; exit 75")
    assert (done.returncode, done.stdout) == (0, "first\nno network\nthe check skipped: no network\n")


def test_what_takes_too_long_is_ended():
    done = run(FORTY_MINUTES, FORTY_MINUTES - 1, 1, "sleep", "60")
    said = "the check skipped: not ended after 0 min, all that was left of 40 min\n"
    assert (done.returncode, done.stdout) == (0, said)


@pytest.mark.parametrize(("mirror", "path", "reason"), [
    ("http://127.0.0.1:9/debian", None, "Failed getting release file http://127.0.0.1:9/debian/dists/trixie/Release"),
    ("", "/usr/bin:/bin", "debootstrap is missing: apt-get install debootstrap"),
])
@pytest.mark.skipif(os.geteuid() != 0 or not Path("/usr/sbin/debootstrap").exists(),
                    reason="needs root and debootstrap")
def test_a_debian_that_cannot_be_had_is_skipped(tmp_path: Path, mirror: str, path: str | None, reason: str):
    done = run(FORTY_MINUTES, 0, QUARTER, SCRIPTS / "check_debian.sh", "--quick", "13", tmp_path / "debian",
               MIRROR=mirror, PATH=path or os.environ["PATH"])
    assert done.returncode == 0
    last = done.stdout.splitlines()[-1]
    assert last.startswith("the check skipped: Debian 13 cannot be had here: ") and last.endswith(reason)
    assert not (tmp_path / "debian").exists() or not list((tmp_path / "debian").iterdir())
