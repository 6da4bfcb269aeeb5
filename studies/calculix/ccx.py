# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs CalculiX on a deck and reads its output."""
from __future__ import annotations

import re
import shutil
import subprocess
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from statejump.core.comparison import Quantity
from statejump.core.errors import FailedRun, StatejumpError
from statejump.core.scratch import scratch

PROGRAM = "ccx"
LONGEST_S, LONGEST_OF_MESHES_S = 120.0, 3600.0
_HEAD = re.compile(r"(displacements|stresses) \([^)]*\) for set (\S+) and time +\S+")


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
    """Run a deck and return the displacements [m] of a node set by node number, for every printed increment; see
    :func:`printed`."""
    return [{number: value for (number, *_), value in step.items()}
            for step in tables(printed(deck), "displacements", set_name)]


def printed(deck: Sequence[str], longest_s: float = LONGEST_S) -> str:
    """Run a deck and return what it prints.

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
                                  stdin=subprocess.DEVNULL, timeout=longest_s, check=False)
        except subprocess.TimeoutExpired:
            raise FailedRun(code="calculix_timeout", limit_s=longest_s) from None
        said = [" ".join(line.split()).partition("; please")[0] for line in done.stdout.splitlines()
                if "*ERROR" in line]
        if done.returncode or said or "Job finished" not in done.stdout:
            raise FailedRun(code="calculix_failed", cause=said[0] if said else None)
        return (folder / "deck.dat").read_text(encoding="ascii", errors="replace")


def tables(text: str, what: str, set_name: str) -> list[dict[tuple[int, ...], np.ndarray]]:
    """Return the printed numbers of a set, for every printed increment.

    :param what: displacements, by node number; or stresses, by element and point of integration
    """
    found: list[dict[tuple[int, ...], np.ndarray]] = []
    wanted = False
    places = 2 if what == "stresses" else 1
    for line in text.splitlines():
        head = _HEAD.search(line)
        if head:
            wanted = head[1] == what and head[2].upper() == set_name.upper()
            if wanted:
                found.append({})
        elif wanted and line.strip():
            words = line.split()[:places + (6 if what == "stresses" else 3)]
            found[-1][tuple(map(int, words[:places]))] = np.array([float(word) for word in words[places:]])
    return found


def number(value: float) -> str:
    """Return a number as text for a deck; CalculiX reads at most 20 characters."""
    whole = repr(float(value))
    return whole if len(whole) <= 20 else f"{value:.13E}"
