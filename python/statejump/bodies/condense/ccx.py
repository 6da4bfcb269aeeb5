# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs CalculiX and reads what it writes: stored matrices and printed displacements."""
from __future__ import annotations

import re
import shutil
import subprocess
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from statejump.core import libraries
from statejump.core.errors import FailedRun, StatejumpError

if TYPE_CHECKING:
    import scipy.sparse

PROGRAM = "ccx"
LONGEST_S = 7200.0
HEAD = re.compile(r"displacements \(vx,vy,vz\) for set (\S+) and time +(\S+)")


def program() -> str:
    """Return the path of CalculiX. :raises StatejumpError: it is not installed"""
    found = shutil.which(PROGRAM)
    if found is None:
        raise StatejumpError(code="calculix_missing", program=PROGRAM)
    return found


def run(folder: Path, job: str, lines: Sequence[str]) -> None:
    """Run a deck in a folder.

    :raises FailedRun: CalculiX reports an error, or does not finish
    """
    (folder / f"{job}.inp").write_text("\n".join(lines) + "\n", encoding="utf-8")
    try:
        done = subprocess.run([program(), job], cwd=folder, capture_output=True, text=True, errors="replace",
                              stdin=subprocess.DEVNULL, timeout=LONGEST_S, check=False)
    except subprocess.TimeoutExpired:
        raise FailedRun(code="calculix_timeout", limit_s=LONGEST_S) from None
    output = done.stdout.splitlines()
    failed = [place for place, line in enumerate(output) if "*ERROR" in line]
    if done.returncode or failed or "Job finished" not in done.stdout:
        cause = " ".join(" ".join(output[failed[0]:failed[0] + 2]).split()) if failed else None
        raise FailedRun(code="calculix_failed", cause=cause)


def labels(path: Path) -> list[tuple[int, int]]:
    """Return node and direction of each row of the stored matrices."""
    words = path.read_text(encoding="ascii").split()
    return [(int(node), int(direction)) for node, _, direction in (word.partition(".") for word in words)]


def matrix(path: Path, size: int) -> scipy.sparse.csc_matrix:
    """Return a stored matrix, whose file has the upper triangle."""
    sparse = libraries.sparse()

    with path.open(encoding="ascii") as stream:
        entries = np.fromfile(stream, sep=" ").reshape(-1, 3)
    rows, columns = entries[:, 0].astype(np.int64) - 1, entries[:, 1].astype(np.int64) - 1
    upper = sparse.coo_matrix((entries[:, 2], (rows, columns)), (size, size)).tocsc()
    return (upper + upper.T - sparse.diags(upper.diagonal())).tocsc()


def displacements(path: Path, set_name: str) -> list[dict[int, np.ndarray]]:
    """Return the printed displacements of a set by node, one dict for each step."""
    found: list[dict[int, np.ndarray]] = []
    wanted = False
    for line in path.read_text(encoding="ascii", errors="replace").splitlines():
        head = HEAD.search(line)
        if head:
            wanted = head[1].upper() == set_name.upper()
            if wanted:
                found.append({})
        elif wanted and line.strip():
            words = line.split()
            found[-1][int(words[0])] = np.array([float(word) for word in words[1:4]])
    return found


def number(value: float) -> str:
    """Return a number as text for a deck; CalculiX reads at most 20 characters."""
    whole = repr(float(value))
    return whole if len(whole) <= 20 else f"{value:.12E}"


def cards(keyword: str, lines: Mapping[str, float]) -> list[str]:
    """Return a keyword with a data line for each entry."""
    return [keyword, *(f"{name},{number(value)}" for name, value in lines.items())]
