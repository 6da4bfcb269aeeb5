# SPDX-License-Identifier: GPL-3.0-or-later
"""Files of FCLIB: the group ``fclib_local`` with its problem; ``solution`` and ``guesses`` with reactions.

The header fclib.h defines the layout. A matrix is a group of ``m``, ``n``, ``nz``, ``nzmax``, ``p``, ``i``, ``x``.
``nz`` is -1 for compressed columns and -2 for compressed rows; otherwise it is the number of triplets. In triplets
``i`` is the row and ``p`` the column, as in CSparse and in the code of FCLIB; the header of FCLIB states the opposite.
"""
from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from statejump.core import libraries
from statejump.core.errors import Unreadable, located
from statejump.core.hdf5 import foreign, made
from statejump.core.reading import is_file
from statejump.fclib.problem import Problem, Solution, Stored

if TYPE_CHECKING:
    import h5py
    import scipy.sparse

LOCAL = "fclib_local"
# Problem types of FCLIB that are not supported, with their description.
OTHERS = {"fclib_global": "global", "fclib_global_rolling": "rolling", "fclib_local_rolling": "rolling"}
COLUMNS, ROWS = -1, -2


def read(path: str | Path) -> Problem:
    """Return the problem in a file of FCLIB, with its stored solutions and guesses.

    The equations V^T r + R l + s = 0 in the file are eliminated if R is regular.

    :raises Unreadable: the file does not exist, is not HDF5, or contains no local problem; or a part is missing or
        damaged
    """
    path = Path(path)
    if not is_file(path):
        raise Unreadable(code="file_not_found", file=path)
    with located(file=path), foreign(path) as found:
        return _problem(found["/"])


def _problem(file: h5py.File) -> Problem:
    if LOCAL not in file:
        other = next((f"it holds a {what} problem ({name}), and only a local one is solved"
                      for name, what in OTHERS.items() if name in file), "it is not a file of FCLIB")
        raise Unreadable(code="fclib_missing", cause=other, group=LOCAL,
                         other=next((name for name in OTHERS if name in file), None))
    group = _group(file, LOCAL)
    dimension = _number(group, "spacedim")
    if dimension not in (2, 3):
        raise Unreadable(code="fclib_dimension", group=group.name, dimension=dimension)
    vectors = _group(group, "vectors")
    q, mu = _vector(vectors, "q"), _vector(vectors, "mu")
    if q.size != dimension * mu.size:
        raise Unreadable(code="fclib_vector_length", group=vectors.name, entries=q.size, contacts=mu.size,
                         dimension=dimension, needed=dimension * mu.size)
    delassus: Any = _matrix(group, "W", (q.size, q.size))
    if "V" in group or "R" in group:
        delassus, q = _without_equations(group, delassus, q)
    info = _group(group, "info") if "info" in group else {}
    return Problem(delassus, q, mu, dimension, _text(info, "title"), _text(info, "description"),
                   tuple(_stored(file, q.size)))


def _without_equations(
    group: h5py.Group, delassus: scipy.sparse.spmatrix, q: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return W and q of the problem after elimination of l from u = W r + V l + q and V^T r + R l + s = 0."""
    s = _vector(_group(group, "vectors"), "s")
    coupling = _matrix(group, "V", (q.size, s.size)).toarray()
    matrix = _matrix(group, "R", (s.size, s.size)).toarray()
    if np.linalg.matrix_rank(matrix) < s.size:
        raise Unreadable(code="fclib_singular", group=group.name)
    inner = np.linalg.solve(matrix, np.column_stack([coupling.T, s]))
    return delassus.toarray() - coupling @ inner[:, :-1], q - coupling @ inner[:, -1]


def _stored(file: h5py.File, size: int) -> list[Stored]:
    names = ["solution"] if "solution" in file else []
    if "guesses" in file:
        guesses = _group(file, "guesses")
        names += [f"guesses/{name}" for name in sorted(guesses) if name != "number_of_guesses"]
    found = []
    for name in names:
        reactions = _vector(_group(file, name), "r")
        if reactions.size != size:
            raise Unreadable(code="fclib_reactions_length", group=name, entries=reactions.size, needed=size)
        found.append(Stored(name, reactions))
    return found


def _group(parent: h5py.Group, name: str) -> h5py.Group:
    h5py = libraries.h5py()

    found = parent.get(name)
    if not isinstance(found, h5py.Group):
        raise Unreadable(code="fclib_group_missing" if found is None else "fclib_not_group",
                         group=f"{parent.name.rstrip('/')}/{name}")
    return found


def _numbers(parent: h5py.Group, name: str, whole: bool) -> NDArray[Any]:
    h5py = libraries.h5py()

    place = f"{parent.name}/{name}"
    found = parent.get(name)
    if not isinstance(found, h5py.Dataset):
        raise Unreadable(code="fclib_data_missing" if found is None else "fclib_not_data_set", data_set=place)
    if found.shape is None or len(found.shape) > 1 or found.dtype.kind not in ("iu" if whole else "iuf"):
        raise Unreadable(code="fclib_not_number_list", data_set=place, whole_="whole " if whole else "")
    values: NDArray[Any] = np.atleast_1d(found[()]).astype(np.int64 if whole else float)
    if not np.isfinite(values).all():
        raise Unreadable(code="fclib_not_finite", data_set=place)
    return values


def _vector(parent: h5py.Group, name: str) -> NDArray[np.float64]:
    return _numbers(parent, name, whole=False)


def _number(parent: h5py.Group, name: str) -> int:
    values = _numbers(parent, name, whole=True)
    if values.size != 1:
        raise Unreadable(code="fclib_not_number", group=parent.name, data_set=name, entries=values.size)
    return int(values[0])


def _matrix(parent: h5py.Group, name: str, shape: tuple[int, int]) -> scipy.sparse.spmatrix:
    sparse = libraries.sparse()

    group = _group(parent, name)
    rows, columns, kind = (_number(group, key) for key in ("m", "n", "nz"))
    if (rows, columns) != shape:
        raise Unreadable(code="fclib_matrix_shape", group=group.name, rows=rows, columns=columns, wanted_rows=shape[0],
                         wanted_columns=shape[1])
    p, i = (_numbers(group, key, whole=True) for key in ("p", "i"))
    x = _vector(group, "x")
    if kind not in (COLUMNS, ROWS) and kind < 0:
        raise Unreadable(code="fclib_storage", group=group.name, nz=kind)
    if kind >= 0:
        if min(p.size, i.size, x.size) < kind:
            raise Unreadable(code="fclib_too_few_entries", group=group.name, nz=kind)
        p, i, x = p[:kind], i[:kind], x[:kind]
        _check_indices(group, "i", i, rows)
        _check_indices(group, "p", p, columns)
        return sparse.coo_matrix((x, (i, p)), shape).tocsc()
    lines, across = (columns, rows) if kind == COLUMNS else (rows, columns)
    if p.size != lines + 1 or p[0] != 0 or (np.diff(p) < 0).any() or min(i.size, x.size) < p[-1]:
        raise Unreadable(code="fclib_pointers", group=group.name, numbers=lines + 1)
    i, x = i[: p[-1]], x[: p[-1]]
    _check_indices(group, "i", i, across)
    form = sparse.csc_matrix if kind == COLUMNS else sparse.csr_matrix
    return form((x, i, p), shape).tocsc()


def _check_indices(group: h5py.Group, name: str, values: NDArray[Any], bound: int) -> None:
    wrong = values[(values < 0) | (values >= bound)]
    if wrong.size:
        raise Unreadable(code="fclib_index", group=group.name, data_set=name, index=wrong[0], largest=bound - 1)


def _text(parent: Any, name: str) -> str:
    found = parent.get(name)
    if not isinstance(found, libraries.h5py().Dataset) or found.shape != ():
        return ""
    value = found[()]
    return value.decode("utf-8", "replace").strip() if isinstance(value, bytes) else ""


def write(path: str | Path, problem: Problem, solution: Solution | Stored | None = None) -> None:
    """Write a problem, and optionally a solution, in the layout of FCLIB.

    :param solution: result of :func:`statejump.fclib.solve`, or known reactions

    :raises NotWritten: the file cannot be written
    """
    sparse = libraries.sparse()

    columns = sparse.csc_matrix(problem.delassus)
    with made(Path(path)) as file:
        group = file.create_group(LOCAL)
        _write_numbers(group, {"spacedim": problem.dimension})
        matrix = group.create_group("W")
        _write_numbers(matrix, {"nzmax": columns.nnz, "m": columns.shape[0], "n": columns.shape[1], "nz": COLUMNS})
        matrix["p"], matrix["i"] = columns.indptr.astype(np.int32), columns.indices.astype(np.int32)
        matrix["x"] = columns.data.astype(float)
        vectors = group.create_group("vectors")
        vectors["q"], vectors["mu"] = problem.q, problem.mu
        info = group.create_group("info")
        for name in ("title", "description"):
            info[name] = np.bytes_(getattr(problem, name) or " ")
        info["math_info"] = np.bytes_(" ")
        if solution is not None:
            stored = file.create_group("solution")
            stored["u"], stored["r"] = problem.velocities(solution.reactions), solution.reactions


def _write_numbers(group: h5py.Group, numbers: dict[str, int]) -> None:
    for name, value in numbers.items():
        group[name] = np.array([value], dtype=np.int32)
