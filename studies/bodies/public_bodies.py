#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Public files of reduced models: their checks, and results of their assembled runs.

    PYTHONPATH=build/python /usr/bin/python3 studies/bodies/public_bodies.py PYYETI PYNASTRAN

PYYETI and PYNASTRAN are copies of the repositories twmacro/pyyeti (pyyeti/tests/nas2cam_extseout) and
SteveDoyle2/pyNastran (models/superelements). The program prints the error of rigid motions of each body, and the
frequencies of the two assembled superelements of pyYeti beside those of NX Nastran in assemble.out, and the forces of
the bushes below se_test_n11 beside those of MSC Nastran in its op2 file.
"""
from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import eigh

import statejump as sj
from statejump.bodies.body import CondensedBody
from statejump.bodies.formats import bulk
from statejump.bodies.formats.op2 import Records
from statejump.core.errors import StatejumpError

# Nodes of se_test_n11 without displacement system: the matrices have the axes of the system of their positions.
SYSTEMS = {20110031: 20110001, 20110038: 20110001}
# Bushes of n11_fem.bdf: number and node, the stiffness in the axes of their system, and the loads of the cases.
BUSHES = {20110001: 20110010, 20110002: 20110020, 20110003: 20110030}
BUSH_SYSTEM, BUSH_STIFFNESS = 200102, np.array([1e9, 1e9, 1e9, 1e6, 1e6, 10.0])
LOADED, LOAD_N, CASES = "20110034", 50.0, {105: 0, 106: 1, 107: 2}
RIGID_HZ = 1e-3  # frequency below which a mode is a rigid motion


def assembled_Hz(bodies: Sequence[CondensedBody]) -> NDArray[np.float64]:
    """Return the frequencies of bodies that share the nodes with the same names."""
    labels = [[*((name, k) for name, dofs in zip(body.node_names, body.node_freedoms) for k in range(dofs)),
               *((f"mode {number}", k) for k in range(body.modes))] for number, body in enumerate(bodies)]
    places = {label: place for place, label in enumerate(sorted({label for several in labels for label in several}))}
    stiffness, mass = np.zeros((2, len(places), len(places)))
    for several, body in zip(labels, bodies):
        at = np.ix_(*[[places[label] for label in several]] * 2)
        assert body.mass is not None
        stiffness[at] += body.stiffness
        mass[at] += body.mass
    return np.asarray(np.sqrt(np.abs(eigh(stiffness, mass, eigvals_only=True))) / (2 * np.pi))


def printed_Hz(path: Path, count: int) -> NDArray[np.float64]:
    """Return the first frequencies in an output file of Nastran."""
    rows = (line.split() for line in path.read_text(encoding="latin-1").splitlines())
    return np.array([float(words[4]) for words in rows
                     if len(words) == 7 and words[0].isdigit() and words[1].isdigit() and "E" in words[2]][:count])


def bush_forces(body: CondensedBody, cards: Sequence[Path]) -> dict[tuple[int, int], NDArray[np.float64]]:
    """Return forces and moments of each bush by case and bush, for the point forces."""
    axes = bulk.read(cards, dict.fromkeys(BUSHES.values(), BUSH_SYSTEM)).axes
    starts = {name: 6 * place for place, name in enumerate(body.node_names)}
    stiffness = body.stiffness[:body.interface_dofs, :body.interface_dofs].copy()
    rows = {}
    for bush, node in BUSHES.items():
        rows[bush] = np.zeros((6, len(stiffness)))
        rows[bush][:, starts[str(node)]:starts[str(node)] + 6] = np.kron(np.eye(2), axes[node])
        stiffness += rows[bush].T @ (BUSH_STIFFNESS[:, None] * rows[bush])
    loads = np.zeros((len(stiffness), 3))
    loads[starts[LOADED]:starts[LOADED] + 3] = LOAD_N * np.eye(3)
    # Some nodes have no stiffness of rotations.
    moved = np.linalg.lstsq(stiffness, loads, rcond=1e-13)[0]
    return {(case, bush): -BUSH_STIFFNESS * (rows[bush] @ moved[:, axis])
            for case, axis in CASES.items() for bush in BUSHES}


def printed_forces(path: Path) -> dict[tuple[int, int], NDArray[np.float64]]:
    """Return the forces of bushes in an op2 file, by case and bush."""
    records = Records(path.read_bytes(), "<").records
    found = {}
    for place, record in enumerate(records[:-5]):
        if len(record) != 584 or len(records[place + 5]) != 28 * len(BUSHES):
            continue
        case = int(np.frombuffer(record, "<i4", 5)[4])
        for at in range(0, 28 * len(BUSHES), 28):
            bush = int(np.frombuffer(records[place + 5], "<i4", 1, at)[0]) // 10
            found[case, bush] = np.frombuffer(records[place + 5], "<f4", 6, at + 4).astype(float)
    return found


def main() -> None:
    """Print the table."""
    folders = Path(sys.argv[1]) / "pyyeti/tests/nas2cam_extseout", Path(sys.argv[2]) / "models/superelements"
    yeti, nastran = folders
    static = nastran / "se_test_static/incl/se"
    sources = {
        "outboard": ([yeti / f"outboard.{suffix}" for suffix in ("op4", "pch", "asm")], {}),
        "inboard": ([yeti / f"inboard.{suffix}" for suffix in ("op4", "pch", "asm")], {}),
        "se_test_n11": ([static / f"se_test_n11.{suffix}" for suffix in ("op4", "pch")], SYSTEMS),
        "extse04c": ([nastran / "extse04c.op2", nastran / "extse04c.bdf"], {})}
    bodies = {}
    for name, (files, systems) in sources.items():
        try:
            bodies[name] = sj.body.import_body(files, systems=systems)
        except StatejumpError as refused:
            print(f"{name}: {refused}")
            continue
        body = bodies[name]
        print(f"{name}: {len(body.node_names)} nodes, {body.modes} modes, error of rigid motions "
              f"{body.measured.rigid_error:.1e}, mass {body.measured.mass_kg:.9g}")
    own = bush_forces(bodies["se_test_n11"], [static / "se_test_n11.pch", static.parent / "n11_fem.bdf"])
    given = printed_forces(nastran / "se_test_static/se_test_n11_static_10_cases.op2")
    difference_N = max(float(np.abs(own[key] - given[key]).max()) for key in own)
    print(f"se_test_n11 on its bushes: largest difference of forces and moments {difference_N:.1e}, load {LOAD_N:g} N")
    ours = assembled_Hz([bodies["outboard"], bodies["inboard"]])
    theirs = printed_Hz(yeti / "assemble.out", len(ours))
    elastic = theirs > RIGID_HZ
    difference = np.abs(ours[elastic] / theirs[elastic] - 1)
    print(f"assembled: {elastic.sum()} elastic frequencies from {theirs[elastic][0]:.6g} to {theirs[elastic][-1]:.6g} "
          f"Hz, largest difference {difference.max():.1e}")


if __name__ == "__main__":
    main()
