# SPDX-License-Identifier: GPL-3.0-or-later
"""One rib of the umbrella antenna of Chen et al. (2021), section 4: two links, one joint with play.

    yade -n -x yade_scripts/examples/umbrella.py            # prints first contact and the state jump
        yade yade_scripts/examples/umbrella.py                  # with YADE's windows: press play, 3D
    PARAVIEW=out/umbrella- yade -n -x yade_scripts/examples/umbrella.py    # files for ParaView as well

Links AB and BC are pinned to a frame at A and C. At B the journal of BC has 0.1 mm of play in the bearing of AB. During
heating the links grow and the frame does not. The play closes, and the journal rolls and slips in the bearing. After
the eclipse it rests in another position.
"""
import os
import sys
from math import atan, atan2, sqrt
from pathlib import Path

# Finds the build tree of a clone that is not installed.
here = Path(sys.argv[0]).resolve().parent
sys.path[:0] = [str(here), str(here.parents[1] / "build" / "python")]
from statejump_yade import *

# Tables 2 and 3. The paper does not state section, damping and duration of the cycle.
frame, length_ab, length_bc, mass_ab, mass_bc = 0.12, 0.05, 0.10, 0.5, 1.0  # m, kg
young, poisson, area, expansion = 70e9, 0.3, 9e-6, 23.75e-6  # Pa, -, m2, 1/K
journal_radius, clearance, friction = 5e-3, 1e-4, 0.3  # m, m, -
orbit = ThermalProgram(shape="triangle", temperatureChangeMax=100, period=1.0)  # K, s

# B is where the two links meet; both centres start there.
x = (frame**2 + length_ab**2 - length_bc**2) / (2 * frame)
start = Vector3(x, sqrt(length_ab**2 - x**2), 0)
aluminium = O.materials.append(
    ThermalFrictMat(young=young, poisson=poisson, frictionAngle=atan(friction), thermalExpansion=0)
)


def tip(shape, mass):
    """Return the body at the end of a link at B. A uniform rod on a fixed pin is exactly a massless spring with a third
    of its mass at the tip. The links move in the x-y plane; ThermalLink rotates the tip."""
    body = Body()
    body.shape, body.material, body.bound = shape, O.materials[aluminium], Aabb()
    body.state.mass, body.state.pos, body.state.blockedDOFs = mass / 3, start, "zXYZ"
    return O.bodies.append(body)


def pin(position):
    """Return a point of the frame, which neither moves nor expands."""
    body = Body()
    body.state.pos, body.state.blockedDOFs = position, "xyzXYZ"
    return O.bodies.append(body)


bearing = tip(Bearing(radius=journal_radius + clearance), mass_ab)
journal = tip(Journal(radius=journal_radius), mass_bc)
common = dict(
    youngModulus=young, crossSectionArea=area, thermalExpansion=expansion, program=orbit,
    dampingRatio=0.1, pinDamping=0.01, tipTurnsWithLink=True,  # without damping it is chaotic
)
ab = ThermalLink(id1=pin((0, 0, 0)), id2=bearing, stressFreeLength=length_ab, **common)
bc = ThermalLink(id1=pin((frame, 0, 0)), id2=journal, stressFreeLength=length_bc, **common)

law = Law2_JointGeom_JointPhys_JointLaw(normalLaw="hertz_internal", frictionLaw="mindlin")
engines = [
    ForceResetter(),
    ThermalExpansionEngine(program=orbit),
    InsertionSortCollider([Bo1_Journal_Aabb(), Bo1_Bearing_Aabb()], verletDist=journal_radius),
    InteractionLoop(
        [Ig2_Journal_Bearing_JointGeom()],
        [Ip2_ThermalFrictMat_ThermalFrictMat_JointPhys()],
        [law],
    ),
    ThermalLinks(links=[ab, bc]),
    NewtonIntegrator(damping=0),
]
if os.environ.get("PARAVIEW"):
    from paraview import ParaViewRecorder

    recorder = ParaViewRecorder(os.environ["PARAVIEW"], orbit)
    engines.insert(-1, PyRunner(command="recorder.write()", iterPeriod=2000, initRun=True))


def report():
    """Print the state jump: direction of AB after the temperature cycle minus its initial direction."""
    direction = O.bodies[bearing].state.pos
    jump = atan2(direction[1], direction[0]) - atan2(start[1], start[0])
    touched = orbit.temperatureChange(law.firstContactTime)
    print(f"first contact at {touched:.4f} K; the closed form c / (alpha |AC|) is "
          f"{clearance / (expansion * frame):.4f} K; {law.contacts} contacts")
    print(f"state jump of AB: {jump * 1e3:.4f} mrad")


O.dt = 5e-6  # s; the links vibrate at 1.4 kHz, journal on bearing at about the same
steps = int(round(orbit.period / O.dt))
engines.insert(-1, PyRunner(command="report()", iterPeriod=steps, firstIterRun=steps))
O.engines = engines
windows = "yade.qt" in sys.modules
if windows:
    from yade import qt

    view = qt.View()
    view.center()
O.run(steps + 1, not windows)  # with windows: do not wait for the end of the run
