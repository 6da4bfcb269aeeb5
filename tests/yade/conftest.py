# SPDX-License-Identifier: GPL-3.0-or-later
"""Starts YADE on the scripts beside this file; each prints one line, ``RESULT`` and JSON."""
from __future__ import annotations

import json
import os
import subprocess
from concurrent.futures import Future, ThreadPoolExecutor
from pathlib import Path
from typing import Any, Callable

import pytest

HERE = Path(__file__).resolve().parent
REPOSITORY = HERE.parents[1]
PLUGIN_DIR = os.environ.get("STATEJUMP_PYTHON_DIR") or str(REPOSITORY / "build" / "python")
TIMEOUT_S = float(os.environ.get("STATEJUMP_YADE_TIMEOUT_S", "120"))
EPS = 2.0**-52


def yade(
    script: Path, *arguments: str, threads: int = 1, environment: dict[str, str] | None = None
) -> subprocess.CompletedProcess[str]:
    """Run ``yade -n -x script`` with the plugin of this build and return what it printed."""
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


@pytest.fixture(scope="session")
def run_script() -> Callable[..., dict[str, Any]]:
    """Return a function that runs a script of ./scripts; every different call runs once."""
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
