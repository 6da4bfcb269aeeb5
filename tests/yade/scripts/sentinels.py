# SPDX-License-Identifier: GPL-3.0-or-later
"""State of contacts, origin of failures, and names of bodies in failure messages."""
from __future__ import annotations

import statejump_yade as sj
from yade import wrapper

from parts import *  # noqa: F403

Law = sj.Law2_JointGeom_JointPhys_JointLaw


def parting(speed: float) -> dict:
    """A journal leaves its bearing's wall at constant speed; return the number of contacts that began."""
    reset()
    metal = material(0.0)
    pin = body((CLEARANCE + 1e-6, 0, 0), sj.Journal(radius=R1), metal, mass=0.02, velocity=(-speed, 0, 0))
    hole = body((0, 0, 0), sj.Bearing(radius=R2), metal)
    law = Law(dissipationLaw="flores", restitution=0.5)
    engines(law=law)
    O.dt = 1e-8
    for _ in range(5):
        O.step()
    found = O.interactions[pin, hole].phys
    return {"contacts": law.contacts, "speed": found.impactSpeed, "begun": found.begun}


def guided_only() -> list:
    """A time step that is too long, in a scene whose only engine of the plugin is GuidePlanes."""
    reset()
    metal = material()
    pin = body((CLEARANCE + 5e-6, 0, 0), sj.Journal(radius=R1), metal, mass=0.02, blocked="zXYZ")
    body((0, 0, 0), sj.Bearing(radius=R2), metal)
    engines()
    kept = [e for e in O.engines if e.__class__.__name__ not in ("ThermalExpansionEngine", "ThermalLinks")]
    O.engines = [*kept[:-1], sj.GuidePlanes(ids=[pin], normals=[(0, 1, 0)]), kept[-1]]
    O.dt = 1e-3
    found = fault_of(lambda: O.step())
    return [*found, O.stopAtIter]


def ball_in_a_mesh() -> list:
    """A law that needs an axis, for a ball in a meshed cup."""
    reset()
    metal = material()
    reach = CLEARANCE + 5e-6
    body((0.5 * reach, 0, -(0.75**0.5) * reach), sj.Ball(radius=R1), metal, mass=0.02)
    body((0, 0, 0), sj.MeshBore(**sj.socket_triangles(R2, 2.2, 120, 60)), metal)
    O.engines = [
        wrapper.ForceResetter(),
        wrapper.InsertionSortCollider([sj.Bo1_Ball_Aabb(), sj.Bo1_MeshBore_Aabb()], verletDist=1e-4),
        wrapper.InteractionLoop(
            [sj.Ig2_Ball_MeshBore_BoreGeom()], [sj.Ip2_ThermalFrictMat_ThermalFrictMat_JointPhys()],
            [sj.Law2_BoreGeom_BorePhys_JointLaw(normalLaw="johnson")],
        ),
        sj.ThermalLinks(),
        wrapper.NewtonIntegrator(damping=0),
    ]
    O.dt = 1e-8
    return fault_of(lambda: [O.step() for _ in range(5)])


finish({
    "parting": {str(speed): parting(speed) for speed in (1.0, 0.5)},
    "guided": guided_only(),
    "mesh": ball_in_a_mesh(),
})
