# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs clang-tidy on the engine and on the headers of the kernel, by the commands of the build without GCC's
precompiled headers, which Clang does not read: so each source must include what it needs.

    clang_tidy.py RUN_CLANG_TIDY BUILD PATTERN...      PATTERN: a regular expression of the paths of sources
"""
from __future__ import annotations

import json
import re
import subprocess
import sys
import tempfile
from pathlib import Path

PRECOMPILED = re.compile(r" -Winvalid-pch| -include \S*cmake_pch\.hxx")


def main(runner: str, build: Path, patterns: list[str]) -> int:
    """Return the exit status of clang-tidy; 2 if a pattern is that of no source."""
    entries = json.loads((build / "compile_commands.json").read_text(encoding="utf-8"))
    for pattern in patterns:
        if not any(re.search(pattern, entry["file"]) for entry in entries):
            print(f"clang_tidy.py: {pattern}: the build has no such source", file=sys.stderr)
            return 2
    chosen = [{**entry, "command": PRECOMPILED.sub("", entry["command"])} for entry in entries
              if any(re.search(pattern, entry["file"]) for pattern in patterns)]
    with tempfile.TemporaryDirectory() as folder:
        Path(folder, "compile_commands.json").write_text(json.dumps(chosen), encoding="utf-8")
        return subprocess.run([runner, "-quiet", "-j", "2", "-p", folder], check=False).returncode


if __name__ == "__main__":
    sys.exit(main(sys.argv[1], Path(sys.argv[2]), sys.argv[3:]))
