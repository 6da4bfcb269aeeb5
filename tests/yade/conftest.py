# SPDX-License-Identifier: GPL-3.0-or-later
"""Starts YADE on the scripts beside this file; each script prints one line, ``RESULT`` and JSON."""
from __future__ import annotations

import json
import os
import subprocess
from concurrent.futures import Future, ThreadPoolExecutor
from math import sqrt
from pathlib import Path
from typing import Any, Callable

import pytest

HERE = Path(__file__).resolve().parent
REPOSITORY = HERE.parents[1]
PLUGIN_DIR = os.environ.get("STATEJUMP_PYTHON_DIR") or str(REPOSITORY / "build" / "python")
TIMEOUT_S = float(os.environ.get("STATEJUMP_YADE_TIMEOUT_S", "120"))
EPS = 2.0**-52
# Of the metal of the scripts, Table 2 of the paper, on itself [Pa].
E_STAR = 70e9 / (2 * (1 - 0.3**2))
G_STAR = 70e9 / (4 * (2 - 0.3) * (1 + 0.3))


def yade(
    script: Path, *arguments: str, threads: int = 1, environment: dict[str, str] | None = None
) -> subprocess.CompletedProcess[str]:
    """Run ``yade -n -x script`` with the plugin of this build; return the output."""
    paths = [PLUGIN_DIR, str(HERE / "scripts"), *(str(REPOSITORY / "yade_scripts" / part) for part in ("examples", "runner"))]
    return subprocess.run(
        ["yade", "-n", "-x", f"-j{threads}", str(script), *arguments],
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        timeout=TIMEOUT_S,
        env={
            **os.environ,
            "PYTHONPATH": os.pathsep.join(paths),
            "PYTHONDONTWRITEBYTECODE": "1",
            # Waiting threads sleep: on a busy machine spinning ones cost ten times the run.
            "OMP_WAIT_POLICY": "PASSIVE",
            **(environment or {}),
        },
        check=False,
    )


def result_of(done: subprocess.CompletedProcess[str]) -> dict[str, Any]:
    """Return the JSON of the line that starts with RESULT."""
    for line in done.stdout.splitlines():
        # YADE's own messages may end without a newline.
        if "RESULT {" in line:
            return json.loads(line[line.index("RESULT {") + len("RESULT ") :])
    raise AssertionError(f"no RESULT, exit status {done.returncode}:\n{done.stdout}\n{done.stderr}")


def check_hertz(row: dict[str, Any], radii: tuple[float, float], radius: float, accuracy: float) -> None:
    """Check one row of the scripts' result ``pressed``: radii, Hertz force, its direction, normal and tangential
    stiffness."""
    assert row["radii"] == pytest.approx(radii, rel=4 * EPS)
    expected = 4 / 3 * E_STAR * sqrt(radius) * row["depth"] ** 1.5
    for component, along in zip(row["force"], row["direction"]):
        assert component == pytest.approx(-expected * along, rel=accuracy, abs=expected * 1e-13)
    assert row["reaction"] == [-f for f in row["force"]]
    a = sqrt(radius * row["depth"])
    assert row["kn"] == pytest.approx(2 * E_STAR * a, rel=accuracy)
    assert row["ks"] == pytest.approx(8 * G_STAR * a, rel=accuracy)


@pytest.fixture(scope="session")
def run_script() -> Callable[..., dict[str, Any]]:
    """Return a function that runs a script of ./scripts; calls with equal arguments run it only once."""
    known: dict[Any, dict[str, Any]] = {}

    def run(name: str, *arguments: str, threads: int = 1) -> dict[str, Any]:
        key = (name, arguments, threads)
        if key not in known:
            done = yade(HERE / "scripts" / name, *arguments, threads=threads)
            known[key] = result_of(done)
        return known[key]

    return run


@pytest.fixture(scope="session")
def start() -> Callable[..., Future]:
    """Return a function that runs a call of yade() in the background."""
    pool = ThreadPoolExecutor(max_workers=2)
    yield lambda *arguments, **keywords: pool.submit(yade, *arguments, **keywords)
    pool.shutdown(cancel_futures=True)
