# SPDX-License-Identifier: GPL-3.0-or-later
"""Saves and resumes runs: `save.py write DIR LAW` saves during contact and continues; `save.py read FILE` loads and
continues. LAW: hertz_mindlin, by_name (laws by name, torsion spring, pin damping), or partial_slip (a friction law with
a load history)."""
import sys
from pathlib import Path

from mixed import scene, state
from parts import *  # noqa: F403

STEPS = 700


def steps(count):
    for _ in range(count):
        O.step()


if sys.argv[1] == "write":
    folder = Path(sys.argv[2])
    files = ["scene.yade", "scene.yade.gz", "scene.yade.bz2", "scene.xml", "scene.xml.gz"]
    scene(sys.argv[3] == "by_name", sys.argv[3] == "partial_slip")
    steps(STEPS)
    saved = state()
    for name in files:
        O.save(str(folder / name), quiet=True)
    O.saveTmp("here", quiet=True)
    steps(STEPS)
    straight = state()
    resumed = {}
    for name in files:
        O.load(str(folder / name), quiet=True)
        steps(STEPS)
        resumed[name] = state()
    O.loadTmp("here", quiet=True)
    steps(STEPS)
    resumed["saveTmp"] = state()
    finish({"saved": saved, "straight": straight, "resumed": resumed})
else:
    O.load(sys.argv[2], quiet=True)
    loaded = {
        "material": O.materials["metal"].thermalExpansion,
        "shape": O.bodies[0].shape.__class__.__name__,
        "engines": [e.__class__.__name__ for e in O.engines],
    }
    steps(STEPS)
    finish({"state": state(), "loaded": loaded})
