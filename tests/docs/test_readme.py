# SPDX-License-Identifier: GPL-3.0-or-later
"""The scripts of the README run as they stand there."""
from __future__ import annotations

import os
import subprocess
from pathlib import Path

README = Path(__file__).resolve().parents[2] / "README.md"
ENVIRONMENT = {**os.environ, "PYTHONPATH": os.environ["STATEJUMP_PYTHON_DIR"]}


def block(heading: str) -> str:
    """Return the first Python block below a heading."""
    text = README.read_text(encoding="utf-8").split(f"\n## {heading}\n", 1)[1]
    return text.split("```python\n", 1)[1].split("```", 1)[0]


def test_smallest_yade_script(tmp_path: Path) -> None:
    script = tmp_path / "hold.py"
    script.write_text(block("The smallest YADE script"), encoding="utf-8")
    done = subprocess.run(["yade", "-n", "-x", str(script)], capture_output=True, text=True,
                          stdin=subprocess.DEVNULL, timeout=120, env=ENVIRONMENT)
    last = done.stdout.strip().splitlines()[-1]
    # The clearance is 0.1 mm; 100 N press the journal 2 um into the wall of its bearing.
    assert last.startswith("journal at Vector3(0.000102"), done.stdout + done.stderr
    assert float(last.split("moving at ")[1].split()[0]) < 1e-9
