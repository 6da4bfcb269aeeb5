#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs the fenced blocks of a tutorial in order, in a temporary folder, and requires what it says they print.

    run_tutorial.py --build build docs/tutorials/NAME.md

```bash      run by bash -euo pipefail, with statejump on PATH and the repository in $REPOSITORY
```python    run by the Python of YADE
```yade      run by yade -n -x
```X file=N  written to the file N, not run
```text      every line must be part of a line that the block before it printed, in this order
```toml, ```  shown only
"""
from __future__ import annotations

import argparse
import os
import re
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

REPOSITORY = Path(__file__).resolve().parents[2]
PYTHON = "/usr/bin/python3"
RUN = {
    "bash": ["bash", "-euo", "pipefail"],
    "python": [PYTHON],
    "yade": ["yade", "-n", "-x"],
}
SUFFIX = {"bash": ".sh", "python": ".py", "yade": ".py"}


@dataclass(frozen=True)
class Block:
    """A fenced block and the line of its fence."""

    line: int
    language: str
    file: str
    body: str


def blocks(text: str) -> list[Block]:
    """Return the fenced blocks of a page."""
    found = []
    for match in re.finditer(r"^```([a-z+]*)(?: file=(\S+))?\n(.*?)^```$", text, re.MULTILINE | re.DOTALL):
        line = text.count("\n", 0, match.start()) + 1
        found.append(Block(line, match[1], match[2] or "", match[3]))
    return found


def run(block: Block, folder: Path, build: Path) -> str:
    """Run a block; return what it printed. Exits with the page's line if it fails."""
    script = folder / f".block_{block.line}{SUFFIX[block.language]}"
    script.write_text(block.body, encoding="utf-8")
    environment = dict(
        os.environ, REPOSITORY=str(REPOSITORY), PYTHONDONTWRITEBYTECODE="1", PYTHONPATH=str(build / "python"),
        PATH=f"{build / 'bin'}{os.pathsep}{os.environ['PATH']}",
    )
    done = subprocess.run(
        [*RUN[block.language], str(script)], cwd=folder, env=environment, stdin=subprocess.DEVNULL, text=True,
        stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=300,
    )
    script.unlink()
    # yade ends with status 0 whatever happens in a script.
    if done.returncode != 0 or "Traceback (most recent call last)" in done.stdout:
        sys.exit(f"line {block.line}: status {done.returncode}\n{done.stdout}")
    return done.stdout


def missing(wanted: str, printed: str) -> str | None:
    """Return the first line that is not there, in order; None: all are."""
    lines = iter(printed.splitlines())
    for line in wanted.splitlines():
        if not any(line in given for given in lines):
            return line
    return None


def main() -> None:
    """Run a page."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("page", type=Path)
    parser.add_argument("--build", type=Path, default=REPOSITORY / "build")
    given = parser.parse_args()
    printed, ran = "", 0
    with tempfile.TemporaryDirectory(prefix="statejump-tutorial-") as folder:
        for block in blocks(given.page.read_text(encoding="utf-8")):
            if block.file:
                (Path(folder) / block.file).write_text(block.body, encoding="utf-8")
            elif block.language in RUN:
                printed, ran = run(block, Path(folder), given.build.resolve()), ran + 1
                print(f"line {block.line}: {block.language}\n{printed}", flush=True)
            elif block.language == "text":
                line = missing(block.body, printed)
                if line is not None:
                    sys.exit(f"line {block.line}: the block before it did not print {line!r}, but\n{printed}")
    if ran == 0:
        sys.exit(f"{given.page}: no block to run")


if __name__ == "__main__":
    main()
