# SPDX-License-Identifier: GPL-3.0-or-later
"""Frictional contact problems: FCLIB files, the command, and errors for invalid files."""
from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from failures import failing, failure
import statejump as sj
from statejump.core.errors import StatejumpError

h5py = pytest.importorskip("h5py")


def pressed(dimension: int = 3, contacts: int = 4) -> sj.fclib.Problem:
    """One body on more contacts than it needs, pushed sideways."""
    random = np.random.default_rng(7)
    h = random.normal(size=(dimension * contacts, 3 * (dimension - 1)))
    return sj.fclib.Problem(h @ h.T, h @ random.normal(size=h.shape[1]), np.full(contacts, 0.4), dimension, "pressed")


def as_stored(matrix: np.ndarray, form: int) -> dict[str, Any]:
    """Store a matrix as FCLIB does: by columns (-1), by rows (-2), or as triplets (0)."""
    from scipy import sparse

    if form == 0:
        entries = sparse.coo_matrix(matrix)
        parts = {"nz": entries.nnz, "p": entries.col, "i": entries.row, "x": entries.data}
    else:
        made = (sparse.csc_matrix if form == -1 else sparse.csr_matrix)(matrix)
        parts = {"nz": form, "p": made.indptr, "i": made.indices, "x": made.data}
    return {"m": matrix.shape[0], "n": matrix.shape[1], "nzmax": len(parts["x"]), **parts}


def write_raw(path: Path, problem: sj.fclib.Problem, form: int = -2,
              change: Callable[[Any], None] = lambda file: None) -> Path:
    """Write the file with h5py only, and change it."""
    with h5py.File(path, "w") as file:
        group = file.create_group("fclib_local")
        group["spacedim"] = np.array([problem.dimension], dtype=np.int32)
        for name, values in as_stored(problem.delassus, form).items():
            whole = np.float64 if name == "x" else np.int32
            group[f"W/{name}"] = np.atleast_1d(np.asarray(values, dtype=whole))
        group["vectors/q"], group["vectors/mu"] = problem.q, problem.mu
        change(file)
    return path


@pytest.mark.parametrize("form", [-1, -2, 0])
def test_every_form_of_a_matrix_is_read(tmp_path: Path, form: int) -> None:
    problem = pressed()
    unsymmetric = problem.delassus + np.triu(np.ones_like(problem.delassus))  # rows are not columns
    given = sj.fclib.Problem(unsymmetric, problem.q, problem.mu)
    found = sj.fclib.read(write_raw(tmp_path / "raw.hdf5", given, form))
    assert np.array_equal(found.delassus.toarray(), unsymmetric)
    assert np.array_equal(found.q, problem.q) and np.array_equal(found.mu, problem.mu)


@pytest.mark.parametrize("dimension", [2, 3])
def test_what_is_written_is_read_again(tmp_path: Path, dimension: int) -> None:
    problem = pressed(dimension)
    solution = sj.fclib.solve(problem, strict=True)
    sj.fclib.write(tmp_path / "solved.hdf5", problem, solution)
    found = sj.fclib.read(tmp_path / "solved.hdf5")
    assert found.title == "pressed" and found.dimension == dimension
    assert np.array_equal(found.delassus.toarray(), problem.delassus)
    (stored,) = found.stored
    assert stored.name == "solution"
    assert sj.fclib.merit(found, stored.reactions).largest <= 1e-10
    # The same numbers in the same order: dense and sparse products agree to 1e-12.
    assert np.allclose(found.velocities(stored.reactions), solution.velocities, rtol=0, atol=1e-12)


def test_equations_are_eliminated(tmp_path: Path) -> None:
    problem = pressed()
    coupling = np.random.default_rng(1).normal(size=(problem.q.size, 2))
    matrix, right = np.diag([-2.0, -3.0]), np.array([0.5, -1.0])

    def add(file: Any) -> None:
        for name, values in (("V", coupling), ("R", matrix)):
            for key, part in as_stored(values, -1).items():
                file[f"fclib_local/{name}/{key}"] = np.atleast_1d(np.asarray(part, float if key == "x" else np.int32))
        file["fclib_local/vectors/s"] = right

    found = sj.fclib.read(write_raw(tmp_path / "mixed.hdf5", problem, change=add))
    r = np.arange(problem.q.size, dtype=float)
    multipliers = np.linalg.solve(matrix, -(coupling.T @ r + right))
    expected = problem.delassus @ r + coupling @ multipliers + problem.q
    assert np.allclose(found.velocities(r), expected, rtol=1e-12)


def _set(name: str, value: Any) -> Callable[[Any], None]:
    def change(file: Any) -> None:
        del file[name]
        file[name] = value
    return change


def _spoil(name: str, index: int, value: float) -> Callable[[Any], None]:
    def change(file: Any) -> None:
        file[name][index] = value
    return change


def _drop(name: str) -> Callable[[Any], None]:
    def change(file: Any) -> None:
        del file[name]
    return change


WRONG: dict[str, tuple[Callable[[Any], None], str]] = {
    "no problem": (_drop("fclib_local"), failure("fclib_missing", group="fclib_local", other=None)),
    "global": (lambda file: file.move("fclib_local", "fclib_global"),
               failure("fclib_missing", group="fclib_local", other="fclib_global")),
    "no W": (_drop("fclib_local/W"), failure("fclib_group_missing", group="/fclib_local/W")),
    "no vectors": (_drop("fclib_local/vectors"), failure("fclib_group_missing", group="/fclib_local/vectors")),
    "no q": (_drop("fclib_local/vectors/q"), failure("fclib_data_missing", data_set="/fclib_local/vectors/q")),
    "group for a list": (_set("fclib_local/vectors", np.zeros(3)), failure("fclib_not_group", group="/fclib_local/vectors")),
    "dimension": (_spoil("fclib_local/spacedim", 0, 4), failure("fclib_dimension", group="/fclib_local", dimension=4)),
    "dimension as text": (_set("fclib_local/spacedim", "three"),
                          failure("fclib_not_number_list", data_set="/fclib_local/spacedim", whole_="whole ")),
    "short q": (_set("fclib_local/vectors/q", np.zeros(5)), failure("fclib_vector_length", entries=5, group="/fclib_local/vectors", contacts=4, dimension=3, needed=12)),
    "q is not finite": (_spoil("fclib_local/vectors/q", 3, np.nan),
                        failure("fclib_not_finite", data_set="/fclib_local/vectors/q")),
    "W is not finite": (_spoil("fclib_local/W/x", 3, np.inf),
                        failure("fclib_not_finite", data_set="/fclib_local/W/x")),
    "negative friction": (_spoil("fclib_local/vectors/mu", 2, -0.1),
                          failure("out_of_range", cause="allowed is finite and >= 0")),
    "rows": (_spoil("fclib_local/W/m", 0, 9), failure("fclib_matrix_shape", columns=12, rows=9, group="/fclib_local/W", wanted_columns=12, wanted_rows=12)),
    "form": (_spoil("fclib_local/W/nz", 0, -7), failure("fclib_storage", group="/fclib_local/W", nz=-7)),
    "index": (_spoil("fclib_local/W/i", 3, 12), failure("fclib_index", index=12, data_set="i", group="/fclib_local/W", largest=11)),
    "negative index": (_spoil("fclib_local/W/i", 3, -1), failure("fclib_index", index=-1, data_set="i", group="/fclib_local/W", largest=11)),
    "starts": (_spoil("fclib_local/W/p", 3, 10_000), failure("fclib_pointers", group="/fclib_local/W", numbers=13)),
    "short x": (_set("fclib_local/W/x", np.zeros(3)), failure("fclib_pointers", group="/fclib_local/W", numbers=13)),
    "more entries than there are": (_spoil("fclib_local/W/nz", 0, 10_000),
                                    failure("fclib_too_few_entries", group="/fclib_local/W", nz=10000)),
    "table for a list": (_set("fclib_local/vectors/q", np.zeros((3, 4))),
                         failure("fclib_not_number_list", data_set="/fclib_local/vectors/q")),
    "solution of another size": (lambda file: file.__setitem__("solution/r", np.zeros(3)),
                                 failure("fclib_reactions_length", entries=3, group="solution", needed=12)),
}


@pytest.mark.parametrize("wrong", WRONG)
def test_files_that_are_not_right(tmp_path: Path, wrong: str) -> None:
    change, sentence = WRONG[wrong]
    path = write_raw(tmp_path / "bad.hdf5", pressed(), change=change)
    with pytest.raises(StatejumpError) as caught:
        sj.fclib.read(path)
    assert caught.value == sentence.at(file=str(path)), caught.value
    assert caught.value.exit_status == 2


def test_a_data_set_that_was_never_written_has_its_fill_value(tmp_path: Path) -> None:
    """HDF5 allocates no storage for an unwritten data set; Siconos writes such solutions. An excessive size is still
    refused."""
    problem = pressed()

    def made(file: Any, size: int) -> None:
        space = h5py.h5s.create_simple((size,))
        h5py.h5d.create(file.create_group("solution").id, b"r", h5py.h5t.NATIVE_DOUBLE, space)

    path = write_raw(tmp_path / "a.hdf5", problem, change=lambda file: made(file, problem.q.size))
    assert sj.fclib.read(path).stored[0].reactions.tolist() == [0.0] * problem.q.size
    large = write_raw(tmp_path / "b.hdf5", problem, change=lambda file: made(file, 10**10))
    with failing("result_claims_too_much", object="/solution/r"):
        sj.fclib.read(large)


def test_no_file_and_no_hdf5(tmp_path: Path) -> None:
    with failing("file_not_found"):
        sj.fclib.read(tmp_path / "none.hdf5")
    (tmp_path / "text.hdf5").write_text("text")
    with failing("not_hdf5"):
        sj.fclib.read(tmp_path / "text.hdf5")
    whole = write_raw(tmp_path / "whole.hdf5", pressed()).read_bytes()
    (tmp_path / "cut.hdf5").write_bytes(whole[: len(whole) // 2])
    with failing("read_failed", file="cut.hdf5"):
        sj.fclib.read(tmp_path / "cut.hdf5")


def test_arguments_out_of_range() -> None:
    problem = pressed()
    for mistake in ({"tolerance": 0.0}, {"method": "guessing"}, {"most_sweeps": -1}, {"guess": np.zeros(3)},
                    {"method": "lemke"}):
        with pytest.raises(StatejumpError):
            sj.fclib.solve(problem, **mistake)
    for made in ((np.zeros((3, 4)), np.zeros(3), [0.1]), (np.eye(3), np.zeros(3), [[0.1]]), (np.eye(4), np.zeros(3), [0.1])):
        with pytest.raises(StatejumpError):
            sj.fclib.Problem(*made)


def test_merit_is_that_of_siconos() -> None:
    """The merit equals an independent implementation of fc3d_compute_error: r - P_K(r - û), over the largest of |q|,
    |r|, |u|."""
    problem = pressed()
    r = np.random.default_rng(3).normal(size=problem.q.size)
    u = problem.velocities(r)
    total = 0.0
    for k in range(problem.contacts):
        mu, (rk, uk) = problem.mu[k], (v[3 * k: 3 * k + 3] for v in (r, u))
        x = rk - uk - np.array([mu * np.hypot(*uk[1:]), 0.0, 0.0])
        size = np.hypot(*x[1:])
        if mu * size <= -x[0]:
            x = np.zeros(3)
        elif size > mu * x[0]:
            normal = (mu * size + x[0]) / (mu * mu + 1.0)
            x = np.array([normal, *(mu * normal * x[1:] / size)])
        total += float(np.sum((rk - x) ** 2))
    norms = [np.linalg.norm(v) for v in (problem.q, r, u)]
    # Rounding of some fifty operations.
    assert sj.fclib.merit(problem, r).natural_map == pytest.approx(np.sqrt(total) / max(norms), rel=1e-13)


def test_command(statejump: Any, tmp_path: Path) -> None:
    problem = pressed()

    def claim(file: Any) -> None:
        file["solution/r"] = file["solution/u"] = np.zeros(problem.q.size)

    write_raw(tmp_path / "claimed.hdf5", problem, change=claim)
    outcome = statejump("fclib", "solve", "claimed.hdf5", "-o", "solved.hdf5")
    assert outcome.status == 0, outcome.errors
    assert "merit" in outcome.output and "found by" in outcome.output
    assert sj.fclib.merit(problem, sj.fclib.read(tmp_path / "solved.hdf5").stored[0].reactions).largest <= 1e-10

    outcome = statejump("fclib", "solve", "claimed.hdf5", "-o", "not.hdf5", "--method", "gauss_seidel",
                        "--most-sweeps", "1")
    assert outcome.status == 1
    assert outcome.failure == failure("not_solved", file="claimed.hdf5")
    assert not (tmp_path / "not.hdf5").exists()

    outcome = statejump("fclib", "solve", "missing.hdf5")
    assert outcome.status == 2
    assert outcome.failure == failure("file_not_found", file="missing.hdf5")
