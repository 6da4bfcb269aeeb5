# SPDX-License-Identifier: GPL-3.0-or-later
"""Collisions of two free balls: closed forms, published impacts, refused input."""
from math import gamma, log, pi, sqrt

import statejump_yade as sj

from parts import *  # noqa: F403

Law = sj.Law2_JointGeom_JointPhys_JointLaw


def law_of(name):
    return sj.Law2_JointGeom_JointPhys_HertzMindlin() if name == "hertz_mindlin" else Law()


def ball_of(radius, density, position, metal, velocity=(0, 0, 0), spin=(0, 0, 0)):
    mass = density * 4 / 3 * pi * radius**3
    return body(
        position, sj.Ball(radius=radius), metal, mass=mass, inertia=0.4 * mass * radius**2, blocked="",
        velocity=velocity, spin=spin,
    )


def forces(name, change):
    """Forces of two balls of different size and expansion, held at several depths and directions."""
    reset()
    one = body(shape=sj.Ball(radius=R1), made_of=material(expansion=23.4e-6))
    two = body((0.02, 0, 0), sj.Ball(radius=0.6 * R1), material(expansion=12e-6))
    engines(constant(change), law=law_of(name))
    O.engines[2].verletDist = 0.05  # as far as it is put, or the collider would not see it move
    O.dt = 1e-9
    O.step()
    reach = R1 * (1 + 23.4e-6 * change) + 0.6 * R1 * (1 + 12e-6 * change)
    rows = pressed(one, two, two, lambda depth: reach - depth)
    O.bodies[two].state.pos = (0, 0, 1.001 * reach)
    O.step()
    return {"rows": rows, "gone": contact(one, two) is None and O.forces.f(one).norm() == 0}


def momenta(ids):
    """Momentum, angular momentum about the origin, kinetic energy."""
    states = [O.bodies[i].state for i in ids]
    linear = sum((s.mass * s.vel for s in states), Vector3.Zero)
    angular = sum((s.mass * s.pos.cross(s.vel) + s.inertia[0] * s.angVel for s in states), Vector3.Zero)
    energy = sum(0.5 * s.mass * s.vel.squaredNorm() + 0.5 * s.inertia[0] * s.angVel.squaredNorm() for s in states)
    return linear, angular, energy


def hertz_impact(pair_radius, pair_mass, modulus, speed):
    """Largest depth, force and duration of an impact without loss."""
    stiffness = 4 / 3 * modulus * sqrt(pair_radius)
    depth = (1.25 * pair_mass * speed**2 / stiffness) ** 0.4
    return depth, stiffness * depth**1.5, 4 * sqrt(pi) * gamma(0.4) / (5 * gamma(0.9)) * depth / speed


def impact(radii, densities, materials, law, velocities, spins=((0, 0, 0), (0, 0, 0)), steps=2000,
           normal=Vector3(1, 0, 0), dashpots=0.0):
    """Let two balls collide that just touch; the second lies along the normal. Return the result."""
    reset()
    metals = [material(friction=mu, young=young, poisson=nu) for young, nu, mu in materials]
    places = (-radii[0] * normal, radii[1] * normal)
    ids = [
        ball_of(r, rho, place, metal, velocity, spin)
        for r, rho, place, metal, velocity, spin in zip(radii, densities, places, metals, velocities, spins)
    ]
    engines(law=Law(**law), normal_damping=dashpots, tangential_damping=dashpots)
    states = [O.bodies[i].state for i in ids]
    modulus = 1 / sum((1 - nu**2) / young for young, nu, _ in materials)
    pair_mass = 1 / sum(1 / s.mass for s in states)
    speed = (Vector3(*velocities[0]) - Vector3(*velocities[1])).dot(normal)
    depth, force, duration = hertz_impact(radii[0] * radii[1] / sum(radii), pair_mass, modulus, speed)
    O.dt = duration / steps
    before = momenta(ids)
    curve = []
    while O.time < 20 * duration:
        O.step()
        found = contact(*ids)
        if found is None and O.iter > 2:
            break
        if found is not None:
            curve.append([O.time - O.dt, found.geom.penetrationDepth, found.phys.normalForce.norm()])
    after = momenta(ids)
    scale = [max(s.mass * s.vel.norm() for s in states), max(s.mass * s.vel.norm() * r for s, r in zip(states, radii))]
    return {
        "depth": max(row[1] for row in curve), "force": max(row[2] for row in curve), "duration": O.time - 2 * O.dt,
        "hertz": [depth, force, duration], "curve": curve[:: max(1, len(curve) // 400)],
        "restitution": (states[1].vel - states[0].vel).dot(normal) / speed,
        "velocity": [list(s.vel) for s in states], "spin": [list(s.angVel) for s in states],
        "momentum": (after[0] - before[0]).norm() / scale[0], "angular": (after[1] - before[1]).norm() / scale[1],
        "lost": before[2] - after[2], "heat": O.energy["jointFriction"] + O.energy["jointDamping"],
        "kinetic": before[2], "position": [list(s.pos) for s in states],
    }


GLASS, LIMESTONE = (48e9, 0.2, 0.35), (20e9, 0.25, 0.35)
ALLOY, NYLON, COPPER = (70e9, 0.33, 0.4), (2.5e9, 0.4, 0.4), (120e9, 0.35, 0.4)


def head_on(restitution, steps=2000):
    """Unlike balls of unlike materials, along no axis."""
    normal = Vector3(2, 3, 6) / 7
    return impact(
        (8e-3, 5e-3), (2700, 7800), ((70e9, 0.33, 0.3), (208e9, 0.3, 0.3)),
        dict(dissipationLaw="exact_restitution", restitution=restitution), (normal, -0.5 * normal), steps=steps,
        normal=normal,
    )


def test_1(metal, density):
    law = dict(frictionLaw="mindlin_deresiewicz")
    return impact((0.01, 0.01), (density, density), (metal, metal), law, ((10, 0, 0), (-10, 0, 0)))


def test_7(metal, density, friction):
    law = dict(frictionLaw=friction, dissipationLaw="exact_restitution", restitution=0.5)
    return impact(
        (0.1, 0.1), (density, density), (metal, metal), law, ((0.2, 0, 0), (-0.2, 0, 0)), ((0, 0, 5), (0, 0, -5)),
        steps=400,
    )


# Dashpots in both directions as most codes give their springs for e = 0.5, after Tsuji, Tanaka, Ishida 1992.
TSUJI = sqrt(5 / 6) * -log(0.5) / sqrt(log(0.5) ** 2 + pi**2)


def test_8(metal, density, tangents, friction, harder=1, dashpots=0.0):
    """A small rotating ball hits a large, heavy one; the spin follows from the tangent of the angle of incidence."""
    law = dict(frictionLaw=friction)
    if not dashpots:
        law |= dict(dissipationLaw="exact_restitution", restitution=0.5)
    large = (harder * metal[0], *metal[1:])
    found = []
    for tangent in tangents:
        seen = impact(
            (0.1, 0.5), (density, 1000 * density), (metal, large), law, ((0.2, 0, 0), (0, 0, 0)),
            ((0, 0, 2 * tangent), (0, 0, 0)), steps=400, dashpots=dashpots,
        )
        velocity, spin = seen["velocity"][0], seen["spin"][0]
        found.append([(velocity[1] + 0.1 * spin[2]) / (0.2 * tangent), velocity[0] / 0.2])
    return found


def oblique(friction):
    """A glancing impact with spin about two axes: conserved quantities and energy account."""
    return impact(
        (8e-3, 5e-3), (2700, 7800), ((70e9, 0.33, 0.3), (208e9, 0.3, 0.3)),
        dict(frictionLaw=friction, dissipationLaw="exact_restitution", restitution=0.8),
        ((1, 0.4, -0.2), (-0.5, 0.1, 0)), ((20, -30, 100), (0, 200, -50)), steps=4000,
    )


def resumed():
    """A run saved and loaded while the balls touch continues bit for bit."""
    import tempfile
    from pathlib import Path

    found = []
    for way in ("straight", "saved"):
        reset()
        metal = material()
        ball_of(R1, 2700, (-R1, 0, 0), metal, (1, 0.4, -0.2), (20, -30, 100))
        ball_of(R1, 2700, (R1, 0.1 * R1, 0), metal, (-1, 0, 0), (0, 200, 0))
        engines(law=Law(frictionLaw="mindlin_deresiewicz", dissipationLaw="exact_restitution", restitution=0.8))
        O.dt = 2e-8
        while contact(0, 1) is None or contact(0, 1).phys.normalForce.norm() < 100:
            O.step()
        if way == "saved":
            with tempfile.TemporaryDirectory() as folder:
                name = str(Path(folder) / "scene.yade.gz")
                O.save(name, quiet=True)
                O.load(name, quiet=True)
        points = len(contact(0, 1).phys.slipMemory)
        O.run(3000, True)
        states = [O.bodies[i].state for i in (0, 1)]
        found.append([[list(v) for s in states for v in (s.pos, s.vel, s.angVel)], energies(), points,
                      contact(0, 1) is None])
    return found


def refused(distance=1.999 * R1, **names):
    """Return the error for a law or a distance that is not possible for two balls."""
    return refusal(sj.Ball(radius=R1), sj.Ball(radius=R1), (distance, 0, 0), Law(**names))


def main(tangents):
    laws = ("mindlin", "mindlin_deresiewicz")
    return {
        "forces": {name: {str(c): forces(name, c) for c in (0, 80)} for name in ("hertz_mindlin", "by_name")},
        "head_on": {str(e): head_on(e) for e in (1.0, 0.8, 0.3)},
        "steps": [head_on(1.0, steps) for steps in (250, 500, 1000)],
        "test_1": {"glass": test_1(GLASS, 2800), "limestone": test_1(LIMESTONE, 2500)},
        "test_7": {f"{name} {law}": test_7(metal, density, law) for law in laws
                   for name, metal, density in (("alloy", ALLOY, 2700), ("copper", COPPER, 8900))},
        "test_8": {law: {name: test_8(metal, density, tangents, law)
                         for name, metal, density in (("alloy", ALLOY, 2700), ("nylon", NYLON, 1000))} for law in laws},
        "test_8_dashpots": {law: {name: test_8(metal, density, tangents, law, dashpots=TSUJI)
                                  for name, metal, density in (("alloy", ALLOY, 2700), ("nylon", NYLON, 1000))}
                            for law in laws},
        "test_8_harder": test_8(ALLOY, 2700, tangents[::4], laws[1], harder=1000),
        "oblique": {law: oblique(law) for law in laws},
        "resumed": resumed(),
        "refused": {
            "paper": refused(tangentialVelocity="paper"), "johnson": refused(normalLaw="johnson"),
            "hertz_paper": refused(normalLaw="hertz_paper"), "hertz_internal": refused(),
            "inside": refused(distance=0.9 * R1),
        },
    }


if __name__ == "__main__":
    from math import radians, tan

    finish(main([tan(radians(5 * k)) for k in range(1, 18)]))
