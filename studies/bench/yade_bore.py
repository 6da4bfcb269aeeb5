# SPDX-License-Identifier: GPL-3.0-or-later
"""Measures a contact step's cost in a meshed bore and in an analytic bearing, in YADE's loop and in the JointStepper.

    yade -n -x -j1 studies/bench/yade_bore.py                   # prints a table, writes results/bench/bore.md
    FACETS=1000,10000 REPORT=bore.md yade -n -x -j1 studies/bench/yade_bore.py

The scene has 100 journals in 100 bearings, which share one wall mesh. There are three loads: the journal rests while
the temperature rises slowly, or it slides around the bore because its force rotates slowly (30 degrees per second) or
fast (once in 20 ms). Prints CPU times per contact and step, medians of five. The variants run in turn in one process.
"""
import os
import sys
import time
from math import atan, cos, pi, sin, sqrt
from pathlib import Path
from statistics import median

here = Path(sys.argv[0]).resolve().parent
sys.path += [str(here.parents[1] / "build" / "python")]
from statejump_yade import *

R1, R2, load, dt, joints = 5e-3, 5.1e-3, 10.0, 1e-6, 100
steps, warm_up, repetitions = 2000, 500, 5
# Rotations of the force per second, and the friction coefficient: large enough to hold the journal, or small enough to
# let it slide.
loads = {"at rest": (0.0, 0.3), "sliding slowly": (30 / 360, 1e-3), "sliding fast": (50.0, 0.1)}


def scene(outer, friction):
    O.reset()
    metals = [ThermalFrictMat(young=70e9, poisson=0.3, frictionAngle=atan(friction),
                              thermalExpansion=a) for a in (23.75e-6, 22e-6)]
    for metal in metals:
        O.materials.append(metal)
    K = 4 / 3 * 70e9 / (2 * (1 - 0.3**2)) * sqrt(R1 * R2 / (R2 - R1))
    offset = R2 - R1 + (load / K) ** (2 / 3)
    ids = []
    for i in range(joints):
        origin = Vector3(0.03 * (i % 10), 0.03 * (i // 10), 0)
        for shape, metal, place, blocked in (
            (outer, metals[1], origin, "xyzXYZ"),
            (Journal(radius=R1), metals[0], origin + Vector3(offset, 0, 0), "zXYZ"),
        ):
            body = Body()
            body.shape, body.material, body.bound = shape, metal, Aabb()
            body.state.pos, body.state.mass, body.state.blockedDOFs = place, 0.01, blocked
            number = O.bodies.append(body)
        ids.append(number)
        O.forces.setPermF(number, Vector3(load, 0.15 * load, 0))
    program = ThermalProgram(shape="triangle", temperatureChangeMax=10, period=1.0)
    O.engines = [
        ForceResetter(),
        ThermalExpansionEngine(program=program),
        InsertionSortCollider([Bo1_Journal_Aabb(), Bo1_Bearing_Aabb(), Bo1_MeshBore_Aabb()], verletDist=5e-4),
        InteractionLoop(
            [Ig2_Journal_Bearing_JointGeom(), Ig2_Journal_MeshBore_BoreGeom()],
            [Ip2_ThermalFrictMat_ThermalFrictMat_JointPhys(normalDampingRatio=0.1)],
            [Law2_JointGeom_JointPhys_JointLaw(), Law2_BoreGeom_BorePhys_JointLaw()],
        ),
        NewtonIntegrator(damping=0.2),
    ]
    O.dt = dt
    return ids


def cost(outer, turns, friction, stepper=False):
    """CPU time per contact and step [ns]."""
    ids = scene(outer, friction)
    if stepper:
        O.engines = [O.engines[0], JointStepper(substeps=1000), *O.engines[1:]]

    def push():
        a = 2 * pi * O.time * turns
        for number in ids:
            O.forces.setPermF(number, Vector3(load * cos(a), load * sin(a), 0))

    def run(count):
        spent = 0.0
        for _ in range(count // 100):
            if turns:
                push()
            start = time.process_time()
            O.run(100, True)
            spent += time.process_time() - start
        return spent

    run(warm_up)
    spent = run(steps)
    touching = O.interactions.countReal()
    if touching < (0.9 if turns else 1) * joints:
        raise SystemExit(f"{touching} of {joints} journals touch")
    return 1e9 * spent / steps / joints


sizes = [int(n) for n in os.environ.get("FACETS", "1000,10000,100000,1000000").split(",")]
lines = [
    "# Cost of a contact in a bore of triangles beside the analytic bearing",
    "",
    "`yade -n -x -j1 studies/bench/yade_bore.py` runs 100 journals with R1 = 5 mm and c = 0.1 mm. Numbers are",
    "medians of five of the CPU time of a whole YADE step, per contact. At rest, the temperature rises slowly.",
    "Sliding, the force rotates and the contacts move around their bores: slowly at 30 degrees per second, or",
    "fast, once in 20 ms. Fast contacts move at 1.6 m/s, 1.6 um in a step. They need the smooth wall in every",
    "step, and a search of the whole wall once in about a hundred steps. Required: at most 5 times the cost of",
    "a bearing at 100 000 facets. The times are those of one machine; compare the ratios.",
    "",
    "The last two columns have the cost of the bore by the JointStepper, and its ratio to that by YADE's loop.",
    "Here the JointStepper copies to and from its arrays every 100 steps. Both make the same steps, bit for bit.",
    "",
    "| facets | load | bearing | bore | **ratio** | `JointStepper` | **over YADE's loop** |",
    "|--:|---|--:|--:|--:|--:|--:|",
]
for size in sizes:
    around = round(sqrt(size * 2.5))
    wall = MeshBore(**bore_triangles(R2, 10e-3, around, max(1, round(size / 2 / around))))
    for load_name, choice in loads.items():
        found = [(cost(Bearing(radius=R2), *choice), cost(wall, *choice), cost(wall, *choice, stepper=True))
                 for _ in range(repetitions)]
        bearing, bore, stepper = (median(one[i] for one in found) for i in (0, 1, 2))
        ratio, gain = median(b / a for a, b, _ in found), median(c / b for _, b, c in found)
        lines.append(
            f"| {len(wall.triangles)} | {load_name} | {bearing:.0f} ns | {bore:.0f} ns | **{ratio:.2f}** "
            f"| {stepper:.0f} ns | **{gain:.2f}** |"
        )
        print(lines[-1], flush=True)
report = Path(os.environ.get("REPORT", here.parents[1] / "results" / "bench" / "bore.md"))
report.write_text("\n".join(lines) + "\n")
