# SPDX-License-Identifier: GPL-3.0-or-later
"""Ball in a socket: force curve, sticking friction, moments, laws that need an axis."""
import statejump_yade as sj
from yade.minieigenHP import Vector3

from parts import *  # noqa: F403

ALPHA_BALL, ALPHA_SOCKET = 23.4e-6, 12e-6
Law = sj.Law2_JointGeom_JointPhys_JointLaw


def law_of(name):
    return sj.Law2_JointGeom_JointPhys_HertzMindlin() if name == "hertz_mindlin" else Law()


def force_curve(name, change):
    """Push a ball into a fixed socket in several directions."""
    reset()
    ball = body(shape=sj.Ball(radius=R1), made_of=material(expansion=ALPHA_BALL))
    socket = body(shape=sj.Socket(radius=R2), made_of=material(expansion=ALPHA_SOCKET))
    engines(constant(change), law=law_of(name))
    O.dt = 1e-9
    O.step()
    clearance = R2 * (1 + ALPHA_SOCKET * change) - R1 * (1 + ALPHA_BALL * change)
    rows = pressed(ball, socket, ball, lambda depth: clearance + depth)
    O.bodies[ball].state.pos = (0, 0, 0.5 * clearance)
    O.step()
    gone = contact(ball, socket) is None and O.forces.f(ball).norm() == 0
    return {"rows": rows, "gone": gone}


def planar(kind, name):
    """A journal or ball pressed into its seat and moving in the x-y plane: both must give the same motion."""
    reset()
    inner, outer = {"joint": (sj.Journal, sj.Bearing), "ball": (sj.Ball, sj.Socket)}[kind]
    program = sj.ThermalProgram(shape="sine", temperatureChangeMax=60, period=1e-3)
    pin = body(
        (1.005e-4, 0.1e-4, 0), inner(radius=R1), material(expansion=23e-6), mass=0.02,
        inertia=3e-7, blocked=PLANAR, spin=(0, 0, 40),
    )
    body((0, 0, 0), outer(radius=R2), material(expansion=10e-6))
    engines(program, normal_damping=0.1, tangential_damping=0.1, law=law_of(name))
    O.dt = 2.5e-7
    O.forces.setPermF(pin, (60.0, 20.0, 0))
    rows = []
    for _ in range(20):
        O.run(100, True)
        state = O.bodies[pin].state
        rows.append([*state.pos, *state.vel, *state.angVel, *energies().values()])
    return rows


def held(name, tangential):
    """Return whether a ball, pressed into its socket with 100 N, sticks under a tangential force."""
    reset()
    metal = material()
    normal = Vector3(2, 3, 6) / 7
    across = Vector3(0, 0, 1).cross(normal).normalized()
    across = (across + 2 * normal.cross(across)).normalized()
    ball = body(normal * (CLEARANCE + 2e-6), sj.Ball(radius=R1), metal, mass=0.1, blocked="XYZ")
    socket = body((0, 0, 0), sj.Socket(radius=R2), metal)
    engines(normal_damping=0.5, tangential_damping=0.5, law=law_of(name))
    O.dt = 1e-6
    O.step()
    stable = sj.stable_time_step()
    O.forces.setPermF(ball, normal * 100 + across * tangential)
    start = O.bodies[ball].state.pos
    O.run(6000, True)
    before = O.bodies[ball].state.pos
    O.run(2000, True)
    found = contact(ball, socket)
    arm = found.geom.contactPoint - O.bodies[ball].state.pos
    # Of the contact alone: the one on the ball has the permanent force in it.
    force, torque = -O.forces.f(socket), O.forces.t(ball)
    moments = (O.bodies[ball].state.pos.cross(force) + torque + O.forces.t(socket)).norm()
    return {
        "moved": (O.bodies[ball].state.pos - start).norm(),
        "still": (O.bodies[ball].state.pos - before).norm(),
        "slipping": found.phys.slipping,
        "shear": found.phys.shearForce.norm(), "normal": found.phys.normalForce.norm(),
        "torque": (torque - arm.cross(force)).norm(), "moments": moments,
        "stable": stable,
    }


def refused(**names):
    """The sentence of a law that needs an axis."""
    return refusal(sj.Ball(radius=R1), sj.Socket(radius=R2), (0, 0, -CLEARANCE - 1e-6), Law(**names))


def closed():
    """A socket that shrinks onto its ball."""
    reset()
    body((0, 0, 0), sj.Ball(radius=R1), material(expansion=1e-4))
    body((0, 0, 0), sj.Socket(radius=R2), material())
    engines(constant(300))
    O.dt = 1e-9

    def run():
        for _ in range(4):
            O.step()

    return fault_of(run)


LAWS = ("hertz_mindlin", "by_name")
finish(
    {
        "curves": {name: {str(c): force_curve(name, c) for c in (0, 80)} for name in LAWS},
        "planar": {f"{kind} {name}": planar(kind, name) for kind in ("joint", "ball") for name in LAWS},
        "held": {name: {str(t): held(name, t) for t in (29.0, 40.0)} for name in LAWS},
        "refused": {
            "paper": refused(tangentialVelocity="paper"),
            "johnson": refused(normalLaw="johnson"),
            "persson": refused(normalLaw="persson"),
            "hertz_paper": refused(normalLaw="hertz_paper"),
        },
        "closed": closed(),
    }
)
