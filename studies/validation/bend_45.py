# SPDX-License-Identifier: GPL-3.0-or-later
"""Bend of 45 degrees under a force across its plane: Bathe and Bolourchi."""
from __future__ import annotations

from manual import CLOSED_FORM, Curve, Entry, Picture, Row, chain, node, show, truss

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import fsolve
from scipy.spatial.transform import Rotation

import statejump as sj

RADIUS_IN, YOUNG, SHEAR, AREA, MOMENT, TORSION = 100.0, 1e7, 5e6, 1.0, 1 / 12, 0.140577015
BEAM = {"young_modulus_Pa": YOUNG, "shear_modulus_Pa": SHEAR, "cross_section_area_m2": AREA,
        "second_moments_of_area_m4": [MOMENT, MOMENT], "torsion_constant_m4": TORSION, "axis_y": [0.0, 0.0, 1.0]}
COMPLIANCE = 1 / np.array([SHEAR * TORSION, YOUNG * MOMENT, YOUNG * MOMENT])
LENGTH_IN = RADIUS_IN * np.pi / 4


def rod(load: float) -> np.ndarray:
    """Return the tip of the geometrically exact rod without shear strain, by shooting.

    Directors: tangent, towards the centre, up. Along the rod the moment changes by force x tangent, and the frame turns
    with the drawn curvature about the third director plus the moments over their rigidities.
    """
    force = np.array([0.0, 0.0, load])
    drawn = np.array([0.0, 0.0, 1 / RADIUS_IN])

    def rates(_: float, state: np.ndarray) -> np.ndarray:
        frame = Rotation.from_quat(state[3:7]).as_matrix()
        moment = state[7:]
        turned = drawn + COMPLIANCE * (frame.T @ moment)
        tangent = frame[:, 0] * (1 + frame[:, 0] @ force / (YOUNG * AREA))
        x, y, z = turned
        spin = 0.5 * np.array([[0, z, -y, x], [-z, 0, x, y], [y, -x, 0, z], [-x, -y, -z, 0]])
        return np.concatenate((tangent, spin @ state[3:7], -np.cross(tangent, force)))

    def end(moment: np.ndarray) -> np.ndarray:
        start = np.array([[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, -1.0]]).T  # third director down: right-handed
        state = np.concatenate((np.zeros(3), Rotation.from_matrix(start).as_quat(), moment))
        return np.asarray(solve_ivp(rates, (0.0, LENGTH_IN), state, "DOP853", rtol=1e-10, atol=1e-10).y[:, -1])

    guess = np.zeros(3)
    for part in np.linspace(0.25, 1.0, 4):
        force = np.array([0.0, 0.0, part * load])
        guess = fsolve(lambda moment: end(moment)[7:], guess, xtol=1e-12)
    return end(guess)[:3]


def bent(load: float, beams: int) -> sj.Case:
    """Return the bend as straight beams between nodes on the arc; inches and pounds stand for metres and newtons."""
    angle = np.pi / 4 * np.arange(beams + 1) / beams
    places = RADIUS_IN * np.stack((1 - np.cos(angle), np.sin(angle), 0 * angle), axis=1)
    nodes = [node(f"N{k}", *map(float, place), clamped=k == 0) for k, place in enumerate(places)]
    nodes[-1]["force_N"] = [0.0, 0.0, load]
    return truss("bend_45", nodes, dimension=3, beam=chain(beams, BEAM), reduced={"increments_per_branch": 1})


def tip(load: float, beams: int) -> np.ndarray:
    """Return the position of the tip."""
    run = bent(load, beams).reduced()
    return np.asarray(run["position_m"][0, -1])


def entry() -> Entry:
    rows = []
    ours: list[float] = []
    theirs: list[float] = []
    loads = (300.0, 450.0, 600.0)
    for load in loads:
        exact, coarse, fine = rod(load), tip(load, 8), tip(load, 16)
        better = fine + (fine - coarse) / 3
        ours.append(float(fine[2]))
        theirs.append(float(exact[2]))
        rows += [Row(f"tip {axis} at {load:g} lb", "in", float(exact[k]), float(fine[k]), refined=float(better[k]),
                     tolerance=2e-3) for k, axis in enumerate("xyz")]
        rows.append(Row(f"tip at {load:g} lb, extrapolated: distance from the rod", "in", 0.0,
                        float(np.linalg.norm(better - exact)), scale=LENGTH_IN))
    return Entry(
        name="bend_45", part="Beams and frames", title="Bend of 45° under a force across its plane", kind=CLOSED_FORM,
        source="problem: K. J. Bathe and S. Bolourchi, Int. J. Numer. Methods Eng. 14 (1979) 961-986; reference: the "
        "script integrates the geometrically exact rod without shear strain", uncertainty="1e-8",
        statement="A clamped eighth of a circle, radius 100 in, section 1 x 1 in, E = 10⁷ psi, G = E/2, carries a "
        "force across its plane at its tip. Find the tip at 300, 450 and 600 lb.", case=bent(600.0, 16), tolerance=2e-4,
        reason="solver entries; single meshes of 16 beams: 2e-3", rows=rows,
        picture=Picture("load [lb]", "tip z [in]",
                        [Curve("rod", loads, theirs), Curve("ours, 16 beams", loads, ours, ours=False)]),
        verdict="Straight beams on the arc converge to the exact rod as the square of their length.")


if __name__ == "__main__":
    show(entry())
