# SPDX-License-Identifier: GPL-3.0-or-later
"""Table 1 of Chen et al. (2021): a bar with a slider in a slot, through one orbit of temperature.

    yade -n -x yade_scripts/examples/table1.py

Prints the state jump: the slider's position after the temperature cycle minus its start.
"""
import sys
from math import atan
from pathlib import Path

# Finds the build tree of a clone that is not installed.
sys.path.insert(0, str(Path(sys.argv[0]).resolve().parents[2] / "build" / "python"))
from statejump_yade import *

# The bar (Table 1) and the joint. The paper gives neither density nor the shape of the pads.
young, area, length, expansion, density = 70e9, 9e-6, 0.5, 23.4e-6, 2700  # Pa, m2, m, 1/K, kg/m3
clearance, normal_force, friction = 1e-3, 100, 0.3  # m, N, -
pad_radius = 0.05  # m
orbit = ThermalProgram(shape="half_sine", temperatureChangeMax=100, period=1.0)  # K, s

# Bodies: the bar's root, the slider at its tip (a bar with one fixed end is exactly a spring with
# a third of its mass at the tip), and the three faces of the slot.
aluminium = O.materials.append(
    ThermalFrictMat(young=young, poisson=0.3, frictionAngle=atan(friction), thermalExpansion=0)
)
root = Body()
root.state.pos = (-length, 0, 0)
root.state.blockedDOFs = "xyzXYZ"
root = O.bodies.append(root)

slider = Body()
slider.shape = Slider(radius=pad_radius)
slider.material = O.materials[aluminium]
slider.bound = Aabb()
slider.state.mass = density * area * length / 3
slider.state.blockedDOFs = "zXYZ"  # a guided block: it slides and penetrates but does not rotate
# Start at the depth at which the floor carries the normal force.
slider.state.pos = (0, -hertz_depth(normal_force, pad_radius, young, 0.3), 0)
slider = O.bodies.append(slider)

floor, stop_minus, stop_plus = O.bodies.append(
    slot(Vector3.Zero, pad_radius + clearance, pad_radius + clearance, pad_radius, aluminium)
)
bar = ThermalLink(
    id1=root, id2=slider, youngModulus=young, crossSectionArea=area, stressFreeLength=length,
    thermalExpansion=expansion, dampingRatio=0.1, program=orbit,
)

O.engines = [
    ForceResetter(),
    # The JointStepper makes the steps. Without this line YADE's loop computes the same numbers more slowly.
    JointStepper(substeps=1000),
    ThermalExpansionEngine(program=orbit),
    InsertionSortCollider([Bo1_Slider_Aabb(), Bo1_SlotFace_Aabb()], verletDist=0.1 * pad_radius),
    InteractionLoop(
        [Ig2_Slider_SlotFace_JointGeom()],
        [Ip2_ThermalFrictMat_ThermalFrictMat_JointPhys(normalDampingRatio=0.1)],
        [Law2_JointGeom_JointPhys_HertzMindlin()],
    ),
    ThermalLinks(links=[bar]),
    NewtonIntegrator(damping=0),
]
O.forces.setPermF(slider, (0, -normal_force, 0))
O.trackEnergy = True

O.dt = 1e-9
O.step()  # after this step the floor is in contact, so its stiffness is known
O.dt = 0.1 * stable_time_step()
start = O.bodies[slider].state.pos[0]
O.run(int(round(orbit.period / O.dt)), True)

jump = O.bodies[slider].state.pos[0] - start
print(f"state jump: {jump * 1e6:.3f} um; the closed form f l / (E A) is "
      f"{friction * normal_force * length / (young * area) * 1e6:.3f} um")
print(f"axial force in the bar: {bar.axialForce:.3f} N, dissipated by friction: "
      f"{O.energy['jointFriction'] * 1e3:.3f} mJ")
