# SPDX-License-Identifier: GPL-3.0-or-later
"""The scripts of the README run without changes."""
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
    # The clearance is 0.1 mm; 100 N press the journal 2 µm into the wall of its bearing.
    assert last.startswith("journal at Vector3(0.000102"), done.stdout + done.stderr
    assert float(last.split("moving at ")[1].split()[0]) < 1e-9


# A bore of 5.1 mm radius with three lobes of 10 µm, in metres, as a measuring machine writes it.
MAKE_BORE = """
import numpy as np
from statejump import _engine
vertices, faces = _engine.bore_triangles(5.1e-3, 10e-3, 240, 12, lobes=[(3, 10e-6, 0.3)])
with open("bore.stl", "w") as file:
    file.write("solid bore\\n")
    for face in faces:
        file.write("facet normal 0 0 0\\nouter loop\\n")
        for vertex in np.asarray(vertices)[face]:
            file.write("vertex {:.9g} {:.9g} {:.9g}\\n".format(*vertex))
        file.write("endloop\\nendfacet\\n")
    file.write("endsolid\\n")
"""
# Checks of the results of the block.
CHECK = """
assert case["joint.friction_coefficient"] == 0.2 and sj.load("cases/table1.toml")["joint.friction_coefficient"] == 0.3
assert result.passed, result
assert abs(run.summary["state_jump_m"] - 20 * 0.5 / (70e9 * 9e-6)) < 1e-15  # f l0/(E A), f = 0.2 * 100 N
import matplotlib
assert matplotlib.get_backend().lower() == "svg", matplotlib.get_backend()
print("block_ran")
"""


def test_ten_lines_of_python(tmp_path: Path) -> None:
    """The code block in README.md reads two files, which commands of the README and a measurement would have written.
    """
    def python(code: str) -> str:
        done = subprocess.run(["/usr/bin/python3", "-c", code], cwd=tmp_path, env={**ENVIRONMENT, "MPLBACKEND": "svg"},
                              capture_output=True, text=True, timeout=300)
        assert done.returncode == 0, done.stderr
        return done.stdout

    subprocess.run([os.environ["STATEJUMP_COMMAND"], "compare", "cases/table1.toml", "--quiet"], cwd=tmp_path,
                   check=True, timeout=300)
    python(MAKE_BORE)
    assert "block_ran" in python(block("From Python") + CHECK)


def test_the_same_lines_stand_in_the_tutorial() -> None:
    page = (README.parent / "docs" / "tutorials" / "ten_lines.md").read_text(encoding="utf-8")
    assert block("From Python") in page
