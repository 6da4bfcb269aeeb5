# SPDX-License-Identifier: GPL-3.0-or-later
"""yade_scripts/examples/table1.py by itself."""
import re

from conftest import REPOSITORY, yade


def test_tutorial_prints_the_state_jump():
    # The script looks for the plugin in <repository>/build/python, then along PYTHONPATH.
    done = yade(REPOSITORY / "yade_scripts" / "examples" / "table1.py")
    found = re.search(r"state jump: ([-0-9.]+) um; .* ([0-9.]+) um", done.stdout)
    assert found, done.stdout + done.stderr
    assert abs(float(found[2]) - 23.80952) < 1e-3
    assert abs(float(found[1]) / 23.80952 - 1) < 5e-3
    force = re.search(r"axial force .*: ([-0-9.]+) N", done.stdout)
    assert abs(float(force[1]) + 30) < 0.15
