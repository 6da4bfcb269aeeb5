# SPDX-License-Identifier: GPL-3.0-or-later
"""Frictional contact problems along paths of trusses: their solutions reproduce the path."""
from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from conftest import Outcome
from failures import Failure, failure

from statejump import fclib
from statejump.kinds.loading import parse_case
from statejump.kinds.truss.contact_problems import ContactProblem, contact_problems
from statejump.kinds.truss.generate import GENERATORS

pytest.importorskip("h5py")


def problems(kind: str, n: int, number: int = 12, **keys: Any) -> list[ContactProblem]:
    return contact_problems(parse_case(GENERATORS[kind](n, name="t", **keys)), number)


CASES: dict[str, Callable[[], list[ContactProblem]]] = {
    "chain": lambda: problems("chain", 6), "iwan": lambda: problems("iwan", 5),
    "ring, rigid": lambda: problems("ring", 6, contact="rigid"), "ring": lambda: problems("ring", 6),
    "ring that sticks elastically": lambda: problems("ring", 6, sticking="elastic"),
    "umbrella in space": lambda: problems("umbrella", 3), "mast": lambda: problems("mast", 3),
}


@pytest.mark.parametrize("name", CASES)
def test_problems_are_solved_by_the_forces_of_the_path_and_give_them_back(tmp_path: Path, name: str) -> None:
    found = CASES[name]()
    assert len(found) == 12
    slid = 0
    for one in found:
        assert one.merit.largest <= 1e-10, one.time_s
        fclib.write(tmp_path / "step.hdf5", one.problem, one.problem.stored[0])
        problem = fclib.read(tmp_path / "step.hdf5")
        solution = fclib.solve(problem)
        assert solution.solved, one.time_s
        # Both merits are at most 1e-10 of |q|, in units in which the mean of W is 1.
        stiffness = 1 / np.diag(one.problem.delassus).mean()
        scale = np.linalg.norm(one.problem.q)
        condition = np.linalg.cond(one.problem.delassus)
        assert solution.velocities == pytest.approx(one.velocities, rel=0, abs=1e-8 * scale), one.time_s
        if condition < 1e4:  # otherwise forces are determined less accurately than motions
            path = one.problem.stored[0].reactions
            assert solution.reactions == pytest.approx(path, rel=0, abs=1e-9 * condition * scale * stiffness)
        slid += int(np.count_nonzero(np.abs(one.velocities[1::2]) > 1e-6 * scale))
    assert slid > 0  # else nothing but sticking was tested


def test_matrix_of_a_chain_is_its_compliance() -> None:
    """Compliance of a chain: forces at sliders i and j elongate the bars up to the nearer slider. Normal forces are
    given."""
    case = parse_case(GENERATORS["chain"](5, name="t"))
    truss = case.resolve()
    rigidity = truss.links.young_modulus_Pa * truss.links.cross_section_area_m2
    for one in contact_problems(case, 3):
        length = truss.links.stress_free_length_m * (
            1 + truss.links.thermal_expansion_per_K * one.temperature_change_K)
        up_to = np.cumsum(length / rigidity)
        exact = np.minimum.outer(up_to, up_to)
        assert one.problem.delassus[1::2, 1::2] == pytest.approx(exact, rel=1e-10)
        assert one.problem.stored[0].reactions[::2] == pytest.approx(
            truss.sliders.friction_coefficient * truss.sliders.normal_force_N, rel=1e-14)
        assert not one.velocities[::2].any() and one.joints == truss.sliders.names


def test_siconos_solves_them() -> None:
    """If Siconos, with which the FCLIB collection was made, is installed, it also solves these problems."""
    numerics = pytest.importorskip("siconos.numerics")
    for one in problems("ring", 4, number=4):
        problem = one.problem
        # In its units the mean of W is 1 and q of order 1, because its tolerance is absolute.
        stiffness, scale = 1 / np.diag(problem.delassus).mean(), np.abs(problem.q).max()
        theirs = numerics.FrictionContactProblem(2, np.asfortranarray(problem.delassus * stiffness),
                                                 problem.q / scale, problem.mu)
        reactions, velocities = np.zeros(problem.q.size), np.zeros(problem.q.size)
        # Its sweeps do not converge if W is not symmetric: friction that follows a normal rotates with it.
        options = numerics.SolverOptions(numerics.SICONOS_FRICTION_2D_LEMKE)
        assert numerics.fc2d_driver(theirs, reactions, velocities, options) == 0
        assert velocities * scale == pytest.approx(one.velocities, rel=0, abs=1e-9 * scale * problem.contacts)


def test_command(statejump: Callable[..., Outcome], cases: Path, tmp_path: Path) -> None:
    case = cases / "trusses" / "chain_10.toml"
    done = statejump("fclib", "write", case, "--number", 5)
    assert done.status == 0, done.errors
    assert re.findall(r"(\d+) (?:problems|contacts)", done.output) == ["5", "10"]
    files = sorted((tmp_path / "results" / "chain_10" / "fclib").glob("*.hdf5"))
    assert [file.name for file in files] == [f"step_{k}.hdf5" for k in range(1, 6)]
    solved = statejump("fclib", "solve", files[2])
    assert solved.status == 0 and "merit" in solved.output, solved.errors


@pytest.mark.parametrize("arguments, sentence", [
    (("trusses/chain_10.toml", "--number", 0), failure("out_of_range", key="--number", value=0)),
    (("table1.toml",), failure("command_not_for_kind", command="fclib write")),
])
def test_mistakes(statejump: Callable[..., Outcome], cases: Path, tmp_path: Path, arguments: tuple, sentence: Failure) -> None:
    done = statejump("fclib", "write", cases / str(arguments[0]), *arguments[1:])
    assert done.status == 2 and done.failure == sentence and done.errors.count("\n") == 1, done.errors
    assert not list(tmp_path.glob("results/*/fclib/step*"))
