# SPDX-License-Identifier: GPL-3.0-or-later
"""scripts/run_with_time_limit.sh: when a check runs, when it is skipped and with which message, when it fails."""
from __future__ import annotations

import os
import re
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
        assert done.stdout.startswith("it ran\n") and done.stdout.endswith("passed\n")
    else:
        assert "skipped" in done.stdout and re.findall(r"\d+", done.stdout) == ["15", f"{(used + 30) // 60}", "40"]


@pytest.mark.parametrize("status", [1, 2, 8])
def test_a_failure_is_a_failure(status: int):
    done = run(FORTY_MINUTES, 0, QUARTER, "bash", "-c", f"echo output; exit {status}")
    assert (done.returncode, done.stdout.startswith("output\n")) == (status, True)
    assert done.stdout.endswith(f"FAILED ({status})\n")


def test_what_cannot_run_here_is_skipped_with_its_reason():
    done = run(FORTY_MINUTES, 0, QUARTER, "bash", "-c", "echo first; echo no network; exit 75")
    assert (done.returncode, done.stdout.startswith("first\nno network\n")) == (0, True)
    assert done.stdout.endswith("skipped: no network\n")


def test_what_takes_too_long_is_ended():
    done = run(FORTY_MINUTES, FORTY_MINUTES - 1, 1, "sleep", "60")
    assert done.returncode == 0 and "skipped" in done.stdout and re.findall(r"\d+", done.stdout) == ["0", "40"]


@pytest.mark.parametrize(("mirror", "path", "reason"), [
    ("http://127.0.0.1:9/debian", None, "http://127.0.0.1:9/debian/dists/trixie/Release"),
    ("", "/usr/bin:/bin", "apt-get install debootstrap"),
])
@pytest.mark.skipif(os.geteuid() != 0 or not Path("/usr/sbin/debootstrap").exists(),
                    reason="needs root and debootstrap")
def test_a_debian_that_cannot_be_had_is_skipped(tmp_path: Path, mirror: str, path: str | None, reason: str):
    done = run(FORTY_MINUTES, 0, QUARTER, SCRIPTS / "check_debian.sh", "--quick", "13", tmp_path / "debian",
               MIRROR=mirror, PATH=path or os.environ["PATH"])
    assert done.returncode == 0
    last = done.stdout.splitlines()[-1]
    assert "skipped: Debian 13" in last and last.endswith(reason)
    assert not (tmp_path / "debian").exists() or not list((tmp_path / "debian").iterdir())
