# SPDX-License-Identifier: GPL-3.0-or-later
"""Two brackets with a friction joint over a thermal cycle: condensed bodies beside CalculiX with both meshes.

    PYTHONPATH=build/python python3 -m studies.calculix.brackets

Two L-shaped brackets stand on their feet, the ends of their arms face to face. A slider with friction joins the arms
along x. Springs join them across x and about all axes; a spring joins the tops. The slide left at the end is the
friction F times the compliance C of the slider, whatever the temperatures were. The program condenses the bracket and
prints the slide at the corners of the cycle, F C, and the comparison with CalculiX, which has all nodes of both meshes.
"""
from __future__ import annotations

import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

import statejump as sj
from statejump.bodies.body import CondensedBody
from studies import calculix
from studies.calculix.bracket_decks import bracket

Numbers = NDArray[np.float64]
FRICTION_N, LARGEST_K = 5.0, 0.06
ACROSS_N_PER_M, ABOUT_N_M_PER_RAD, TOPS_N_PER_M = 1e9, 1e5, 1e6
STICKING_N_PER_M = 1e9
TURN = np.diag([-1.0, -1.0, 1.0])  # of the second bracket
ORIGIN_M = np.array([0.4, 0.04, 0.0])


def body(fine: bool = True, kind: str = "rigid") -> CondensedBody:
    """Return the bracket, condensed to its arm end A, its top B and its foot C."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "bracket.inp")
        path.write_text(bracket(fine=fine), encoding="ascii")
        return sj.body.condense(path, [f"{name}={kind}" for name in "ABC"], ["uniform", "z"])


def bush(stiffnesses: Sequence[float], freedoms: Sequence[int]) -> CondensedBody:
    """Return springs along and about x, y and z between two nodes at one place, as a body."""
    count = len(stiffnesses)
    stiffness = np.zeros((sum(freedoms),) * 2)
    for first, second, sign in ((0, 0, 1), (0, 1, -1), (1, 0, -1), (1, 1, 1)):
        at = (np.arange(count) + first * freedoms[0], np.arange(count) + second * freedoms[0])
        stiffness[at] += sign * np.asarray(stiffnesses)
    return sj.body.from_arrays(["1", "2"], np.zeros((2, 3)), stiffness, node_freedoms=freedoms)


def case(content: CondensedBody, scale: float = 1.0) -> Any:
    """Return the case; node M is the guide of the slider.

    :param scale: factor of the temperatures and of the friction
    """
    at = content.node_positions_m
    places = {"1": at, "2": ORIGIN_M + at @ TURN}
    held = {"fixed": ["x", "y", "z"], "fixed_rotations": ["x", "y", "z"]}
    nodes = [{"name": f"{name}{side}", "position_m": place.tolist(), **(held if name == "C" else {})}
             for side, several in places.items() for name, place in zip("ABC", several)]
    end = at[0].tolist()
    turned = {"position_m": ORIGIN_M.tolist(), "axis_x": TURN[0].tolist(), "axis_y": TURN[1].tolist()}
    bodies = [
        {"name": "left", "nodes": ["A1", "B1", "C1"], "content": content, "patterns": ["uniform"]},
        {"name": "right", "nodes": ["A2", "B2", "C2"], "content": content, "patterns": ["z"],
         "temperature_fractions": [1 / 0.12], **turned},
        {"name": "guide", "nodes": ["A1", "M"], "position_m": end,
         "content": bush([STICKING_N_PER_M, ACROSS_N_PER_M, ACROSS_N_PER_M], [6, 3])},
        {"name": "about", "nodes": ["A1", "A2"], "position_m": end,
         "content": bush([0.0] * 3 + [ABOUT_N_M_PER_RAD] * 3, [6, 6])}]
    return sj.load({
        "case": {"name": "two_brackets", "kind": "truss"}, "truss": {"dimension": 3},
        "node": [*nodes, {"name": "M", "position_m": end}], "body": bodies,
        "slider": [{"name": "S", "nodes": ["A2", "M"], "axis": [1.0, 0.0, 0.0], "friction_coefficient": 1.0,
                    "normal_force_N": scale * FRICTION_N}],
        "spring": [{"name": "tops", "nodes": ["B1", "B2"], "stiffness_N_per_m": TOPS_N_PER_M}],
        "thermal": {"shape": "table", "cycles": 1, "table_time_s": [0.0, 1.0, 2.0, 3.0, 4.0],
                    "table_temperature_change_K": (scale * LARGEST_K * np.array([0.0, 1, 0, -1, 0])).tolist()}})


def slides_m(made: Any) -> Numbers:
    """Return the slide of the arms at the corners of the cycle (4,) [m]."""
    run = made.reduced()
    moved = run.history["displacement_m"].values[:, :, 0]
    names = [node.name for node in made.node]
    slide = moved[:, names.index("A2")] - moved[:, names.index("A1")]
    times = run.history["time_s"].values
    return np.array([slide[int(np.argmin(np.abs(times - corner)))] for corner in (1, 2, 3, 4)])


def compliance_m_per_N(content: CondensedBody) -> float:
    """Return the compliance of the slide, from the reduced stiffnesses alone."""
    kept, turn = content.stiffness[:12, :12], np.kron(np.eye(4), TURN)
    stiffness = np.zeros((24, 24))
    stiffness[:12, :12], stiffness[12:, 12:] = kept, turn @ kept @ turn.T
    springs = [(0, 12, 0.0), *((k, 12 + k, ACROSS_N_PER_M) for k in (1, 2)),
               *((k, 12 + k, ABOUT_N_M_PER_RAD) for k in (3, 4, 5)), (6, 18, TOPS_N_PER_M)]
    for first, second, value in springs:
        stiffness[[first, second], [first, second]] += value
        stiffness[[first, second], [second, first]] -= value
    along = np.zeros(24)
    along[[0, 12]] = -1.0, 1.0
    return float(along @ np.linalg.solve(stiffness, along))


def main() -> None:
    """Print slides, F C and the comparison with CalculiX."""
    content = body(fine="--coarse" not in sys.argv)
    expected = FRICTION_N * compliance_m_per_N(content)
    print(f"F C = {expected:.9e} m")
    for scale in (1.0, 1e-3):
        found = slides_m(case(content, scale)) / scale
        print(f"temperatures and friction times {scale:g}: slide [m] {', '.join(f'{one:.9e}' for one in found)}; "
              f"the last to F C: {found[-1] / expected - 1:.1e}")
    for row in calculix.answer(case(content)).rows:
        print(f"{row.name}: reduced {row.values['reduced']:.9e} m, CalculiX {row.values['fe']:.9e} m, "
              f"difference {row.difference:.1e}")


if __name__ == "__main__":
    main()
