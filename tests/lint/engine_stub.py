# SPDX-License-Identifier: GPL-3.0-or-later
"""Compares the type stub of the engine's module with the module, in a folder outside of the package: inside, mypy would
read the whole package, which takes five times as long without further findings. The stub has the names of _engine and
_engine_more, because _engine re-exports the latter.

    engine_stub.py FOLDER      folder of _engine.pyi and of the built modules
"""
from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from pathlib import Path

HERE = Path(__file__).resolve().parent
# stubtest compares the names that a module lists; _engine does not list those of _engine_more.
UNLISTED = """
import ast, sys
from pathlib import Path
import _engine_more
stub = ast.parse(Path("_engine.pyi").read_text(encoding="utf-8"))
known = {node.name for node in stub.body if isinstance(node, (ast.ClassDef, ast.FunctionDef))}
known |= {node.target.id for node in stub.body if isinstance(node, ast.AnnAssign)}
unlisted = [name for name in dir(_engine_more) if name[0] != "_" and name not in known]
sys.exit(f"_engine.pyi: no {', '.join(unlisted)}; add them" if unlisted else 0)
"""


def main(folder: Path) -> int:
    """Return the exit status of stubtest."""
    with tempfile.TemporaryDirectory() as alone:
        for path in folder.glob("_engine*"):
            Path(alone, path.name).symlink_to(path.resolve())
        command = [sys.executable, "-m", "mypy.stubtest", "_engine", "--mypy-config-file", str(HERE / "stubtest.ini"),
                   "--allowlist", str(HERE / "stubtest_allowed.txt")]
        environment = {**os.environ, "PYTHONPATH": alone, "MYPYPATH": alone}
        listed = subprocess.run([sys.executable, "-c", UNLISTED], cwd=alone, env=environment, check=False)
        return listed.returncode or subprocess.run(command, cwd=alone, env=environment, check=False).returncode


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1])))
