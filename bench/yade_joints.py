# SPDX-License-Identifier: GPL-3.0-or-later
"""One measurement of run.py: n contacts in YADE for a number of steps. Prints one line of JSON.

    STATEJUMP_BENCH_VARIANT=joint STATEJUMP_BENCH_SIZE=100 yade -n -x -j1 bench/yade_joints.py

Variants, all with 2 n bodies, n contacts, the same collider and integrator:

- ``joint``: revolute joints (journal in a fixed bearing) under thermal expansion, in every step
  another temperature
- ``joint_stepper``: the same by the JointStepper, every ``SUBSTEPS`` steps one by YADE's loop
- ``joint_isothermal``: the same without the ThermalExpansionEngine
- ``sphere``: pairs of spheres, one fixed, with YADE's own Law2_ScGeom_MindlinPhys_Mindlin
- ``table1``: yade_scripts/examples/table1.py as it stands, from its first line to its last (one contact)

The free body is pressed on the fixed one with a constant force inclined to the normal, below the
friction limit, so that both laws carry a normal and a tangential force. Rotations are blocked, or
a sphere would roll off. It starts at the depth at which the contact carries the load.

Environment: STATEJUMP_BENCH_VARIANT, _SIZE (n), _STEPS, _SUBSTEPS, _WARM_UP (steps), _TIMING (1: share of each
engine by O.timingEnabled, which slows the run itself down), _ENERGY (1: O.trackEnergy).
"""
import contextlib
import io
import json
import os
import runpy
import sys
import time
from math import atan, ceil, sqrt
from pathlib import Path


def setting(name, default):
    return type(default)(os.environ.get(f"STATEJUMP_BENCH_{name}", default))


variant = setting("VARIANT", "joint")
size = setting("SIZE", 1)
steps = setting("STEPS", 1000)
warm_up = setting("WARM_UP", 300)
timing = bool(setting("TIMING", 0))
bystanders = setting("BYSTANDERS", 0)  # 0 to 3 for each pair of spheres

# Table 2 of Chen et al. (2021): radius and clearance of the joint, material.
young, poisson, friction = 70e9, 0.3, 0.3  # Pa, -, -
expansion_journal, expansion_bearing = 23.75e-6, 22e-6  # 1/K; different, so the clearance changes
radius, clearance, mass = 5e-3, 1e-4, 0.01  # m, m, kg
load, inclination = 10.0, 0.5 * friction  # normal force [N], tangential over normal force [-]
spacing, verlet_distance = 0.03, 0.5e-3  # m
time_step = 1e-6  # s

effective_modulus = young / (2 * (1 - poisson**2))


def depth(effective_radius):
    """Return the depth at which a Hertz contact carries the load [m]."""
    return (load / (4 / 3 * effective_modulus * sqrt(effective_radius))) ** (2 / 3)


def positions():
    """Yield the centres of the fixed bodies: a cubic grid."""
    edge = ceil(size ** (1 / 3))
    for i in range(size):
        x, rest = i % edge, i // edge
        yield Vector3(x, rest % edge, rest // edge) * spacing


def body(shape, material, position, is_fixed):
    result = Body()
    result.shape, result.material, result.bound = shape, material, Aabb()
    result.state.pos = result.state.refPos = position
    result.state.mass = mass
    result.state.inertia = Vector3.Ones * 0.4 * mass * radius**2
    result.state.blockedDOFs = "xyzXYZ" if is_fixed else "zXYZ"
    return O.bodies.append(result)


def engines(bounds, geometry, physics, law, thermal=()):
    return [
        ForceResetter(),
        *thermal,
        InsertionSortCollider(bounds, verletDist=verlet_distance),
        InteractionLoop([geometry], [physics], [law]),
        NewtonIntegrator(damping=0.2),
    ]


def joints(is_thermal):
    import statejump_yade as sj

    materials = [
        sj.ThermalFrictMat(
            young=young, poisson=poisson, frictionAngle=atan(friction), thermalExpansion=expansion
        )
        for expansion in (expansion_journal, expansion_bearing)
    ]
    for material in materials:
        O.materials.append(material)
    bearing_radius = radius + clearance
    offset = clearance + depth(radius * bearing_radius / clearance)
    for centre in positions():
        body(sj.Bearing(radius=bearing_radius), materials[1], centre, True)
        free = body(sj.Journal(radius=radius), materials[0], centre + Vector3(offset, 0, 0), False)
        O.forces.setPermF(free, Vector3(1, inclination, 0) * load)
    thermal = []
    if is_thermal:
        # Slow enough to stay close to equilibrium, rising during the whole measurement.
        program = sj.ThermalProgram(
            shape="triangle", temperatureChangeMax=10, period=4 * (steps + warm_up) * time_step + 1
        )
        thermal = [sj.ThermalExpansionEngine(program=program)]
    O.engines = engines(
        [sj.Bo1_Journal_Aabb(), sj.Bo1_Bearing_Aabb()],
        sj.Ig2_Journal_Bearing_JointGeom(),
        sj.Ip2_ThermalFrictMat_ThermalFrictMat_JointPhys(),
        sj.Law2_JointGeom_JointPhys_HertzMindlin(),
        thermal,
    )


def spheres():
    material = FrictMat(young=young, poisson=poisson, frictionAngle=atan(friction))
    O.materials.append(material)
    offset = 2 * radius - depth(radius / 2)
    for centre in positions():
        body(Sphere(radius=radius), material, centre, True)
        free = body(Sphere(radius=radius), material, centre + Vector3(offset, 0, 0), False)
        O.forces.setPermF(free, Vector3(-1, inclination, 0) * load)
        # Fixed bodies that the free one could touch next, as a slider its stops: boxes overlap.
        near = 2 * radius + 0.4 * verlet_distance
        for direction in (Vector3(0, -1, 0), Vector3(0, 1, 0), Vector3(1, 0, 0))[:bystanders]:
            body(Sphere(radius=radius), material, centre + Vector3(offset, 0, 0) + near * direction, True)
    O.engines = engines(
        [Bo1_Sphere_Aabb()],
        Ig2_Sphere_Sphere_ScGeom(),
        Ip2_FrictMat_FrictMat_MindlinPhys(),
        Law2_ScGeom_MindlinPhys_Mindlin(),
    )


def check(when):
    """Every pair touches, carries both forces without slip, and nothing else touches."""
    contacts = [contact for contact in O.interactions if contact.isReal]
    carrying = sum(
        contact.phys.normalForce.norm() > 0.5 * load
        and 0.1 * inclination * load
        < contact.phys.shearForce.norm()
        < 0.99 * friction * contact.phys.normalForce.norm()
        for contact in contacts
    )
    if len(contacts) != size or carrying != size or O.interactions.countReal() != size:
        raise SystemExit(
            f"{variant}, {size}: {len(contacts)} contacts {when}, {carrying} of them carry their "
            f"load; {size} expected"
        )


def measure():
    O.trackEnergy = bool(setting("ENERGY", 0))
    O.dt = time_step
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
    if timing:
        result["engines_ns_per_step"] = {
            type(engine).__name__: (engine.execTime - old[0]) / count
            for engine, old in zip(O.engines, before)
        }
    return result


def table1():
    import statejump_yade  # noqa: F401  the one of PYTHONPATH, whatever the script looks for

    script = Path(sys.argv[0]).resolve().parents[1] / "yade_scripts" / "examples" / "table1.py"
    output = io.StringIO()
    start_wall, start = time.perf_counter(), time.process_time()
    with contextlib.redirect_stdout(output):
        # The script reads its own path and uses YADE's names.
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
