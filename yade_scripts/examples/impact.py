# SPDX-License-Identifier: GPL-3.0-or-later
"""Impact of two free balls: duration, largest force and rebound speed.

    yade -n -x yade_scripts/examples/impact.py
    RESTITUTION=0.8 FRICTION=0.3 SPIN=500 yade -n -x yade_scripts/examples/impact.py

The first line is test 1 of Chung and Ooi, Granul. Matter 13, 2011: glass balls of 10 mm radius that
collide at 20 m/s without loss. SPIN [rad/s] rotates the first ball, so that the contact slides, or sticks
with partial slip.
"""
import os
import sys
from math import atan, gamma, pi, sqrt
from pathlib import Path

# Finds the build tree of a clone that is not installed.
sys.path.insert(0, str(Path(sys.argv[0]).resolve().parents[2] / "build" / "python"))
from statejump_yade import *

radius, speed = 10e-3, 10.0  # m, m/s of each ball
young, poisson, density = 48e9, 0.2, 2800.0  # Pa, -, kg/m3: glass
restitution = float(os.environ.get("RESTITUTION", 1))
friction = float(os.environ.get("FRICTION", 0.35))
spin = float(os.environ.get("SPIN", 0))

glass = ThermalFrictMat(young=young, poisson=poisson, frictionAngle=atan(friction))
O.materials.append(glass)
mass = density * 4 / 3 * pi * radius**3
for side in (-1, 1):
    ball = Body()
    ball.shape, ball.material, ball.bound = Ball(radius=radius), glass, Aabb()
    ball.state.pos = (side * radius, 0, 0)  # just touching
    ball.state.mass = mass
    ball.state.inertia = Vector3.Ones * 0.4 * mass * radius**2
    ball.state.vel = (-side * speed, 0, 0)
    O.bodies.append(ball)
first, second = O.bodies
first.state.angVel = (0, 0, spin)

O.engines = [
    ForceResetter(),
    InsertionSortCollider([Bo1_Ball_Aabb()], verletDist=0.1 * radius),
    InteractionLoop(
        [Ig2_Ball_Ball_JointGeom()],
        [Ip2_ThermalFrictMat_ThermalFrictMat_JointPhys()],
        [Law2_JointGeom_JointPhys_JointLaw(
            dissipationLaw="exact_restitution", restitution=restitution, frictionLaw="mindlin_deresiewicz",
        )],
    ),
    ThermalLinks(),  # no links; this engine of the plugin also reports errors of contacts
    NewtonIntegrator(damping=0),
]

# Hertz: duration and force of an impact without loss.
closing, pair_mass, pair_radius, modulus = 2 * speed, mass / 2, radius / 2, young / (2 * (1 - poisson**2))
stiffness = 4 / 3 * modulus * sqrt(pair_radius)
depth = (5 / 4 * pair_mass * closing**2 / stiffness) ** 0.4
duration = 2 * sqrt(pi) * gamma(0.4) / (5 * gamma(0.9)) * 2 * depth / closing
O.dt = duration / 2000

peak = 0
while first.state.vel[0] - second.state.vel[0] > 0 or O.interactions.countReal() > 0:
    O.step()
    if O.interactions.countReal() > 0:
        peak = max(peak, O.interactions[0, 1].phys.normalForce.norm())
touched = O.time - O.dt

parting = second.state.vel[0] - first.state.vel[0]
print(f"touched for {touched * 1e6:.2f} us, Hertz without loss {duration * 1e6:.2f} us")
print(f"largest force {peak / 1e3:.3f} kN, Hertz without loss {stiffness * depth**1.5 / 1e3:.3f} kN")
print(f"restitution {parting / closing:.6f}, asked for {restitution:g}")
print(f"spins afterwards {first.state.angVel[2]:.3f} and {second.state.angVel[2]:.3f} rad/s, "
      f"sideways {first.state.vel[1]:.4f} and {second.state.vel[1]:.4f} m/s")
