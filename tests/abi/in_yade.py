"""Runs inside YADE: loads a probe module and prints what its guard says, as one line of JSON."""
import json
import os
import sys
import time

from yade import utils, wrapper

sys.path.insert(0, os.environ["STATEJUMP_PROBE"])


def say(**what):
    print("PROBE " + json.dumps(what), flush=True)
    os._exit(0)


def scene_on_disk():
    path = os.path.join(os.environ["STATEJUMP_PROBE"], "scene.xml")
    O.save(path, quiet=True)
    with open(path, "rb") as file:
        return file.read()


if os.environ["STATEJUMP_PROBE_TASK"] == "package":
    try:
        import statejump_yade  # noqa: F401
    except ImportError as error:
        say(error=str(error), cause=error.__cause__ is not None)
    say(error="")

import _native  # noqa: E402

if os.environ["STATEJUMP_PROBE_TASK"] == "scene":
    # A scene with everything in it that the guard might disturb.
    O.bodies.append([utils.sphere((0, 0, 0), 1), utils.sphere((0, 0, 1.9), 1)])
    O.engines = [
        ForceResetter(),
        InsertionSortCollider([Bo1_Sphere_Aabb()]),
        InteractionLoop(
            [Ig2_Sphere_Sphere_ScGeom()],
            [Ip2_FrictMat_FrictMat_FrictPhys()],
            [Law2_ScGeom_FrictPhys_CundallStrack()],
        ),
        NewtonIntegrator(gravity=(0, 0, -9.81)),
    ]
    O.dt = 1e-5
    O.trackEnergy = True
    O.run(10, True)
    before = scene_on_disk()
    start = time.perf_counter()
    sentence = _native.setup(wrapper)
    seconds = time.perf_counter() - start
    say(sentence=sentence, same=before == scene_on_disk(), seconds=seconds)
say(sentence=_native.difference(wrapper))
