# SPDX-License-Identifier: GPL-3.0-or-later
"""One measurement of run.py: runs n contacts in YADE for a number of steps and prints one line of JSON.

    STATEJUMP_BENCH_VARIANT=joint STATEJUMP_BENCH_SIZE=100 yade -n -x -j1 studies/bench/yade_joints.py

Variants, all with 2 n bodies, n contacts, the same collider and integrator:

- ``joint``: revolute joints (journal in a fixed bearing) under thermal expansion; the temperature changes in every step
- ``joint_stepper``: as ``joint``, by the JointStepper, with one step of YADE's loop every ``SUBSTEPS`` steps
- ``joint_isothermal``: as ``joint``, without the ThermalExpansionEngine
- ``sphere``: pairs of spheres, one fixed, with YADE's own Law2_ScGeom_MindlinPhys_Mindlin
- ``table1``: the whole script yade_scripts/examples/table1.py, without changes (one contact)

The free body is pressed on the fixed one with a constant force inclined to the normal, below the friction limit, so
that both laws carry a normal and a tangential force. Rotations are blocked, because a sphere would roll off. The free
body starts at the depth at which the contact carries the load.

Environment: STATEJUMP_BENCH_VARIANT, _SIZE (n), _STEPS, _SUBSTEPS, _WARM_UP (steps), _TIMING (1: time of each engine by
O.timingEnabled, which slows the run down), _ENERGY (1: O.trackEnergy), _FRICTION_LAW (name of the friction law of
joints; default: Law2_JointGeom_JointPhys_HertzMindlin).
"""
import contextlib
import io
import json
import os
import runpy
import sys
import time
from math import atan
from pathlib import Path

sys.path.insert(0, str(Path(sys.argv[0]).resolve().parent))
from pairs import (
    BEARING_RADIUS, CLEARANCE, EXPANSION_BEARING, EXPANSION_JOURNAL, FRICTION, INCLINATION, JOINT_RADIUS, LOAD, MASS,
    POISSON, RADIUS, SEARCHED, TIME_STEP, YOUNG, depth, places,
)


def setting(name, default):
    return type(default)(os.environ.get(f"STATEJUMP_BENCH_{name}", default))


variant = setting("VARIANT", "joint")
size = setting("SIZE", 1)
steps = setting("STEPS", 1000)
warm_up = setting("WARM_UP", 300)
timing = bool(setting("TIMING", 0))
friction_law = setting("FRICTION_LAW", "")
bystanders = setting("BYSTANDERS", 0)  # number per pair of spheres, 0 to 3


def body(shape, material, position, is_fixed):
    result = Body()
    result.shape, result.material, result.bound = shape, material, Aabb()
    result.state.pos = result.state.refPos = position
    result.state.mass = MASS
    result.state.inertia = Vector3.Ones * 0.4 * MASS * RADIUS**2
    result.state.blockedDOFs = "xyzXYZ" if is_fixed else "zXYZ"
    return O.bodies.append(result)


def engines(bounds, geometry, physics, law, thermal=()):
    return [
        ForceResetter(),
        *thermal,
        InsertionSortCollider(bounds, verletDist=SEARCHED),
        InteractionLoop([geometry], [physics], [law]),
        NewtonIntegrator(damping=0.2),
    ]


def joints(is_thermal):
    import statejump_yade as sj

    materials = [
        sj.ThermalFrictMat(
            young=YOUNG, poisson=POISSON, frictionAngle=atan(FRICTION), thermalExpansion=expansion
        )
        for expansion in (EXPANSION_JOURNAL, EXPANSION_BEARING)
    ]
    for material in materials:
        O.materials.append(material)
    offset = CLEARANCE + depth(JOINT_RADIUS)
    for centre in map(Vector3, places(size)):
        body(sj.Bearing(radius=BEARING_RADIUS), materials[1], centre, True)
        free = body(sj.Journal(radius=RADIUS), materials[0], centre + Vector3(offset, 0, 0), False)
        O.forces.setPermF(free, Vector3(1, INCLINATION, 0) * LOAD)
    thermal = []
    if is_thermal:
        # Slow enough to stay close to equilibrium; the temperature rises during the whole measurement.
        program = sj.ThermalProgram(
            shape="triangle", temperatureChangeMax=10, period=4 * (steps + warm_up) * TIME_STEP + 1
        )
        thermal = [sj.ThermalExpansionEngine(program=program)]
    O.engines = engines(
        [sj.Bo1_Journal_Aabb(), sj.Bo1_Bearing_Aabb()],
        sj.Ig2_Journal_Bearing_JointGeom(),
        sj.Ip2_ThermalFrictMat_ThermalFrictMat_JointPhys(),
        sj.Law2_JointGeom_JointPhys_JointLaw(frictionLaw=friction_law)
        if friction_law
        else sj.Law2_JointGeom_JointPhys_HertzMindlin(),
        thermal,
    )


def spheres():
    material = FrictMat(young=YOUNG, poisson=POISSON, frictionAngle=atan(FRICTION))
    O.materials.append(material)
    offset = 2 * RADIUS - depth(RADIUS / 2)
    for centre in map(Vector3, places(size)):
        body(Sphere(radius=RADIUS), material, centre, True)
        free = body(Sphere(radius=RADIUS), material, centre + Vector3(offset, 0, 0), False)
        O.forces.setPermF(free, Vector3(-1, INCLINATION, 0) * LOAD)
        # Fixed bodies that the free body could touch next, like the stops of a slider; their bounding boxes overlap.
        near = 2 * RADIUS + 0.4 * SEARCHED
        for direction in (Vector3(0, -1, 0), Vector3(0, 1, 0), Vector3(1, 0, 0))[:bystanders]:
            body(Sphere(radius=RADIUS), material, centre + Vector3(offset, 0, 0) + near * direction, True)
    O.engines = engines(
        [Bo1_Sphere_Aabb()],
        Ig2_Sphere_Sphere_ScGeom(),
        Ip2_FrictMat_FrictMat_MindlinPhys(),
        Law2_ScGeom_MindlinPhys_Mindlin(),
    )


def check(when):
    """Check that every pair is in contact and carries normal and tangential force without slip, and that no other
    bodies touch."""
    contacts = [contact for contact in O.interactions if contact.isReal]
    carrying = sum(
        contact.phys.normalForce.norm() > 0.5 * LOAD
        and 0.1 * INCLINATION * LOAD
        < contact.phys.shearForce.norm()
        < 0.99 * FRICTION * contact.phys.normalForce.norm()
        for contact in contacts
    )
    if len(contacts) != size or carrying != size or O.interactions.countReal() != size:
        raise SystemExit(
            f"{variant}, {size}: {len(contacts)} contacts {when}, {carrying} of them carry their "
            f"load; {size} expected"
        )


def measure():
    O.trackEnergy = bool(setting("ENERGY", 0))
    O.dt = TIME_STEP
    O.run(max(2, warm_up), True)
    check("before")
    O.timingEnabled = timing
    before = [(engine.execTime, engine.execCount) for engine in O.engines]
    first = O.iter
    start_wall, start = time.perf_counter(), time.process_time()
    O.run(steps, True)
    elapsed, elapsed_wall = time.process_time() - start, time.perf_counter() - start_wall
    count = O.iter - first
    check("after")
    result = {
        "steps": count, "cpu_time_s": elapsed, "wall_time_s": elapsed_wall, "contacts": size
    }
    if friction_law:
        result["memory_points"] = sum(len(contact.phys.slipMemory) for contact in O.interactions) / size
    if timing:
        result["engines_ns_per_step"] = {
            type(engine).__name__: (engine.execTime - old[0]) / count
            for engine, old in zip(O.engines, before)
        }
    return result


def table1():
    import statejump_yade  # noqa: F401 from PYTHONPATH, wherever the script searches

    script = Path(sys.argv[0]).resolve().parents[2] / "yade_scripts" / "examples" / "table1.py"
    output = io.StringIO()
    start_wall, start = time.perf_counter(), time.process_time()
    with contextlib.redirect_stdout(output):
        # The script uses its own path and names of YADE.
        runpy.run_path(str(script), init_globals=dict(globals()))
    elapsed, elapsed_wall = time.process_time() - start, time.perf_counter() - start_wall
    if "state jump" not in output.getvalue():
        raise SystemExit("table1.py did not print its result")
    return {"steps": O.iter, "cpu_time_s": elapsed, "wall_time_s": elapsed_wall, "contacts": 1}


if variant == "table1":
    report = table1()
elif variant in ("joint", "joint_stepper", "joint_isothermal", "sphere"):
    spheres() if variant == "sphere" else joints(variant != "joint_isothermal")
    if variant == "joint_stepper":
        from statejump_yade import JointStepper

        O.engines = [O.engines[0], JointStepper(substeps=setting("SUBSTEPS", 10_000)), *O.engines[1:]]
    report = measure()
else:
    raise SystemExit(f"STATEJUMP_BENCH_VARIANT = {variant} is unknown")
print("BENCH " + json.dumps(report), flush=True)
