# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks that every source file begins with its licence line. Exit status 1: some files do not; they are listed."""
from __future__ import annotations

import subprocess
import sys
from pathlib import Path

LINE = "SPDX-License-Identifier: GPL-3.0-or-later"
ENDINGS = {".py", ".pyi", ".cpp", ".hpp", ".ts", ".mjs", ".sh"}
FIRST_LINES = 3  # an interpreter line may precede it


def main() -> int:
    """Print the files without the line."""
    command = ["git", "ls-files", "-co", "--exclude-standard"]
    listed = subprocess.run(command, capture_output=True, text=True, check=True)
    missing = []
    for name in listed.stdout.splitlines():
        path = Path(name)
        if path.suffix in ENDINGS and path.is_file():
            head = path.read_text(encoding="utf-8").splitlines()[:FIRST_LINES]
            if not any(LINE in line for line in head):
                missing.append(name)
    for name in missing:
        print(f"{name}: no line {LINE!r} at its head")
    return 1 if missing else 0


if __name__ == "__main__":
    sys.exit(main())
