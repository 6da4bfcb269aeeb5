#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Public files of reduced models: their checks, and results of their assembled runs.

    PYTHONPATH=build/python /usr/bin/python3 studies/validation/public_bodies.py PYYETI PYNASTRAN

PYYETI and PYNASTRAN are copies of the repositories twmacro/pyyeti (pyyeti/tests/nas2cam_extseout) and
SteveDoyle2/pyNastran (models/superelements). The program prints the error of rigid motions of each body, and the
frequencies of the two assembled superelements of pyYeti beside those of NX Nastran in assemble.out.
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
from statejump.core.errors import StatejumpError

# Nodes of se_test_n11 without displacement system: the matrices have the axes of the system of their positions.
SYSTEMS = {20110031: 20110001, 20110038: 20110001}
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
    ours = assembled_Hz([bodies["outboard"], bodies["inboard"]])
    theirs = printed_Hz(yeti / "assemble.out", len(ours))
    elastic = theirs > RIGID_HZ
    difference = np.abs(ours[elastic] / theirs[elastic] - 1)
    print(f"assembled: {elastic.sum()} elastic frequencies from {theirs[elastic][0]:.6g} to {theirs[elastic][-1]:.6g} "
          f"Hz, largest difference {difference.max():.1e}")


if __name__ == "__main__":
    main()
