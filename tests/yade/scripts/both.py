# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs a scene with and without the JointStepper and compares both. Imported by scripts that run under ``yade``."""
import hashlib
import json
import tempfile
from pathlib import Path

import mixed
import statejump_yade as sj

from parts import *  # noqa: F403

MAIN = __import__("__main__")


def counted():
    """Count the steps that YADE's own loop makes."""
    MAIN.ordinary_steps = 0
    O.engines = [*O.engines, wrapper.PyRunner(command="ordinary_steps += 1", iterPeriod=1, initRun=True)]


def bits(state):
    """Return a state as text that represents floats exactly; NaN equals NaN."""
    return json.dumps(state, sort_keys=True, default=list)  # vectors in a list


def digest(state):
    """Return a hash of a state."""
    return hashlib.sha256(bits(state).encode()).hexdigest()


def differences(one, other):
    """Return the keys in which two states differ."""
    return sorted(key for key in {*one, *other} if bits(one.get(key)) != bits(other.get(key)))


def plain(value, without=()):
    """Return the attributes of a YADE object, also those of objects in its lists."""
    if isinstance(value, Vector3):
        return list(value)
    if isinstance(value, list):
        return [plain(one) for one in value]
    if hasattr(value, "dict"):
        return {key: plain(one) for key, one in value.dict().items() if key not in ("label", "timingDeltas", *without)}
    return value


def in_one_go(steps):
    O.run(steps, True)


def recorded(pair=(1, 0)):
    """Add a recorder of the scene that runs at steps other than multiples of the substeps. Only the contact of the
    given pair of bodies is expected."""
    parts = {name: [part for engine in O.engines for part in getattr(engine, name, [])]
             for name in ("links", "springs", "joints")}
    bodies = [number for number in (0, 1, 3, 4) if number < len(O.bodies)]
    recorder = sj.StateRecorder(iterPeriod=7, bodies=bodies, contacts=list(pair), **parts)
    O.engines = [*O.engines[:-1], recorder, O.engines[-1]]


def rows():
    """Return what has been recorded, None where nothing is."""
    found = [engine.take().hex() for engine in O.engines if isinstance(engine, sj.StateRecorder)]
    return found[0] if found else None


def run_both(build, steps, substeps, go=in_one_go, record=None):
    """Run a scene with YADE's loop and with the JointStepper; return the steps that YADE's loop made, and what differs.
    ``record``: pair of bodies to record."""
    found = {}
    for way in ("ordinary", "stepper"):
        build()
        if record:
            recorded(record)
        if way == "stepper":
            with_stepper(substeps)
        counted()
        go(steps)
        found[way] = mixed.state() | {
            "geometry": [
                [i.id1, i.id2, i.iterMadeReal, list(i.geom.contactPoint), i.geom.refR1, i.geom.refR2, plain(i.phys)]
                for i in O.interactions if i.isReal
            ],
            "interactions": [[i.id1, i.id2, i.isReal] for i in O.interactions.all()],
            # Without contact, too, all but what YADE leaves as it was before the first one.
            "bores": [plain(i.geom, () if i.isReal else ("normal", "contactPoint"))
                      for i in O.interactions.all() if isinstance(i.geom, sj.BoreGeom)],
            "bounds": [[b.bound.lastUpdateIter, list(b.bound.min)] for b in O.bodies if b.bound],
            "rate": O.dt, "rows": rows(),
        }
    ordinary, stepper = found["ordinary"], found["stepper"]
    began = sum(functor.contacts for engine in O.engines if hasattr(engine, "lawDispatcher")
                for functor in engine.lawDispatcher.functors
                if isinstance(functor, sj.Law2_BoreGeom_BorePhys_JointLaw))
    return {
        "differences": differences(ordinary, stepper), "hashes": [digest(ordinary), digest(stepper)],
        "steps": O.iter, "made_by_yade": MAIN.ordinary_steps,
        "touching": len(ordinary["geometry"]), "energy": ordinary["energy"], "law": ordinary.get("law"),
        "began": began, "largest": max((i.geom.numberOfContacts for i in O.interactions
                                        if i.isReal and isinstance(i.geom, sj.BoreGeom)), default=0),
    }


def saved(steps):
    """Saved and loaded on the way."""
    O.run(steps // 2, True)
    with tempfile.TemporaryDirectory() as folder:
        name = str(Path(folder) / "scene.yade.gz")
        O.save(name, quiet=True)
        O.load(name, quiet=True)
    O.run(steps - O.iter, True)


def erased(number):
    """A body more, and one less, on the way."""
    def go(steps):
        O.run(steps // 3, True)
        body((9, 0, 0))
        O.run(steps // 3, True)
        O.bodies.erase(number)
        O.run(steps - O.iter, True)
    return go


def error_of(build, steps=2000, substeps=100):
    """Return what ends a run in YADE's loop and in the JointStepper: class, text, step and time of the error, its
    fault."""
    found = []
    for way in ("ordinary", "stepper"):
        build()
        if way == "stepper":
            with_stepper(substeps)

        def one_by_one():
            while O.iter < steps:
                O.step()

        kind, text = sentence_of(one_by_one)
        taken = sj.take_failure()
        found.append([kind, text, O.iter, O.time, None if taken is None else taken["time"], fault(taken)])
    return found
