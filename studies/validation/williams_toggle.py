# SPDX-License-Identifier: GPL-3.0-or-later
"""Limit load of the toggle frame of Williams."""
from __future__ import annotations

from manual import CLOSED_FORM, Curve, Entry, Picture, Row, chain, node, section, show, truss

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq, fsolve, minimize_scalar

import statejump as sj

HALF_IN, RISE_IN, AXIAL_LB, BENDING_LB_IN2 = 12.943, 0.386, 1.885e6, 9270.0
LENGTH_IN = float(np.hypot(HALF_IN, RISE_IN))
SLOPE = float(np.arctan2(RISE_IN, HALF_IN))


def load_lb(deflection_in: float) -> float:
    """Return the load of the exact extensible elastica at a deflection of the crown, by shooting.

    A leg is clamped at the foot and guided without rotation at the crown; half of the load acts on it.
    """

    def missing(guess: np.ndarray) -> np.ndarray:
        thrust, moment, down = guess

        def rates(_: float, state: np.ndarray) -> list[float]:
            angle = state[2]
            along = -thrust * np.cos(angle) - down * np.sin(angle)  # tension
            stretch = 1 + along / AXIAL_LB
            turning = (-thrust * np.sin(angle) + down * np.cos(angle)) * stretch
            return [stretch * np.cos(angle), stretch * np.sin(angle), state[3] / BENDING_LB_IN2, turning]

        end = solve_ivp(rates, (0, LENGTH_IN), [0.0, 0.0, SLOPE, moment], "DOP853", rtol=1e-11, atol=1e-12).y[:, -1]
        return np.array([end[0] - HALF_IN, end[1] - (RISE_IN - deflection_in), end[2] - SLOPE])

    strain = deflection_in * RISE_IN / LENGTH_IN**2
    found = fsolve(missing, [AXIAL_LB * strain * 0.7, 6 * BENDING_LB_IN2 * deflection_in / LENGTH_IN**2, 10.0],
                   xtol=1e-10)
    return 2 * float(abs(found[2]))


def frame(force_lb: float, beams: int) -> sj.Case:
    """Return the left half of the frame; its crown is guided. Inches and pounds stand for metres and newtons."""
    keys = section(1e6, AXIAL_LB / 1e6, BENDING_LB_IN2 / 1e6)
    nodes = [node("N0", 0.0, 0.0, clamped=True)]
    nodes += [node(f"N{k}", HALF_IN * k / beams, RISE_IN * k / beams) for k in range(1, beams)]
    nodes.append({**node(f"N{beams}", HALF_IN, RISE_IN, fixed="x", force_N=[0.0, -force_lb / 2]),
                  "fixed_rotations": ["z"]})
    return truss("williams_toggle", nodes, beam=chain(beams, keys), reduced={"increments_per_branch": 1})


def deflection_in(force_lb: float, beams: int) -> float | None:
    """Return our deflection of the crown; None if the frame snaps through."""
    try:
        moved = -float(frame(force_lb, beams).reduced()["displacement_m"][0, -1, 1])
    except sj.StatejumpError:
        return None
    return moved if moved < RISE_IN else None


def limit_lb(beams: int) -> float:
    """Return our limit load, by bisection."""
    low, high = 30.0, 40.0
    while high - low > 1e-5:
        middle = (low + high) / 2
        low, high = (middle, high) if deflection_in(middle, beams) is not None else (low, middle)
    return low


def entry() -> Entry:
    most = minimize_scalar(lambda at: -load_lb(at), bounds=(0.15, 0.3), method="bounded", options={"xatol": 1e-8})
    limit = -float(most.fun)
    coarse, fine = limit_lb(4), limit_lb(8)
    better = fine + (fine - coarse) / 15
    loads = [0.2 * limit, 0.4 * limit, 0.6 * limit, 0.8 * limit, 0.95 * limit]
    ours = [deflection_in(load, 8) or 0.0 for load in loads]
    exact = [float(brentq(lambda at, load=load: load_lb(at) - load, 1e-4, float(most.x))) for load in loads[:4]]
    path = np.linspace(0.005, 0.3, 25)
    return Entry(
        name="williams_toggle", part="Beams and frames", title="Limit load of the toggle frame of Williams",
        kind=CLOSED_FORM,
        source="F. W. Williams, Q. J. Mech. Appl. Math. 17 (1964) 451-469; the script integrates the extensible "
        "elastica",
        uncertainty="1e-8",
        statement="Two clamped legs, half span 12.943 in and rise 0.386 in, meet rigidly at a crown that a load "
        "presses. Find the load at which the frame snaps through.", case=frame(round(0.8 * limit, 3), 8),
        tolerance=2e-4,
        reason="solver entries; ours is extrapolated from 4 and 8 beams per leg",
        rows=[Row("limit load", "lb", limit, better),
              Row("limit load, 8 beams per leg", "lb", limit, fine, refined=better),
              Row("deflection at 0.8 of the limit", "in", exact[3], ours[3], tolerance=2e-4)],
        picture=Picture("deflection of the crown [in]", "load [lb]", [
            Curve("elastica", path, [load_lb(float(at)) for at in path]),
            Curve("ours, 8 beams per leg", ours, loads, ours=False)]),
        verdict="The solver follows the frame to its limit load and refuses larger loads.")


if __name__ == "__main__":
    show(entry())
