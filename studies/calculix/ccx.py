# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs CalculiX on a deck and reads its output."""
from __future__ import annotations

import re
import shutil
import subprocess
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from statejump.core.comparison import Quantity
from statejump.core.errors import FailedRun, StatejumpError
from statejump.core.scratch import scratch

PROGRAM = "ccx"
LONGEST_S = 120.0
_HEAD = re.compile(r"displacements \(vx,vy,vz\) for set (\S+) and time +(\S+)")


@dataclass(frozen=True)
class Answer:
    """Comparison of a finite-element model of a case with the reduced model.

    :param deck: the deck for CalculiX
    :param rows: comparison table: per quantity the values of the reduced model and of CalculiX
    :param notes: what the finite-element model omits
    """

    deck: str
    rows: tuple[Quantity, ...]
    notes: tuple[str, ...]


def displacements(deck: Sequence[str], set_name: str) -> list[dict[int, np.ndarray]]:
    """Run a deck and return the displacements [m] of a node set by node number, for every printed increment.

    :raises StatejumpError: CalculiX is not installed
    :raises FailedRun: the run was not completed
    """
    program = shutil.which(PROGRAM)
    if program is None:
        raise StatejumpError(code="calculix_missing", program=PROGRAM)
    with scratch() as folder:
        (folder / "deck.inp").write_text("\n".join(deck) + "\n", encoding="ascii")
        try:
            done = subprocess.run([program, "deck"], cwd=folder, capture_output=True, text=True, errors="replace",
                                  stdin=subprocess.DEVNULL, timeout=LONGEST_S, check=False)
        except subprocess.TimeoutExpired:
            raise FailedRun(code="calculix_timeout", limit_s=LONGEST_S) from None
        said = [" ".join(line.split()).partition("; please")[0] for line in done.stdout.splitlines()
                if "*ERROR" in line]
        if done.returncode or said or "Job finished" not in done.stdout:
            raise FailedRun(code="calculix_failed", cause=said[0] if said else None)
        return _read(folder / "deck.dat", set_name)


def _read(path: Path, set_name: str) -> list[dict[int, np.ndarray]]:
    found: list[dict[int, np.ndarray]] = []
    wanted = False
    for line in path.read_text(encoding="ascii", errors="replace").splitlines():
        head = _HEAD.search(line)
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
    return whole if len(whole) <= 20 else f"{value:.13E}"
