# SPDX-License-Identifier: GPL-3.0-or-later
"""Holds the stub of the engine's module against the module, both by themselves: as a part of the package mypy would
read the whole package first, which takes five times as long and finds nothing more.

    engine_stub.py FOLDER      the folder of _engine.pyi and of the built module
"""
from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from pathlib import Path

HERE = Path(__file__).resolve().parent


def main(folder: Path) -> int:
    """Return the exit status of stubtest."""
    with tempfile.TemporaryDirectory() as alone:
        for path in folder.glob("_engine.*"):
            Path(alone, path.name).symlink_to(path.resolve())
        command = [sys.executable, "-m", "mypy.stubtest", "_engine", "--mypy-config-file", str(HERE / "stubtest.ini"),
                   "--allowlist", str(HERE / "stubtest_allowed.txt")]
        environment = {**os.environ, "PYTHONPATH": alone, "MYPYPATH": alone}
        return subprocess.run(command, cwd=alone, env=environment, check=False).returncode


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1])))
