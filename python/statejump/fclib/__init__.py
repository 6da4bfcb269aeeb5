# SPDX-License-Identifier: GPL-3.0-or-later
"""Frictional contact problems of many contacts: solution, merit of solutions, files in the layout of FCLIB.

::

    import statejump as sj

    problem = sj.fclib.read("Capsules-i125-1213.hdf5")
    solution = sj.fclib.solve(problem)
    solution.merit.largest, solution.reactions
    sj.fclib.write("mine.hdf5", problem, solution)

Such a problem is u = W r + q with Coulomb's law at every contact; see docs/theory/complementarity.md.
"""
from __future__ import annotations

from statejump.fclib.files import read, write
from statejump.fclib.problem import METHODS, Merit, NotSolved, Problem, Solution, Stored, merit, solve

__all__ = ["METHODS", "Merit", "NotSolved", "Problem", "Solution", "Stored", "merit", "read", "solve", "write"]


def __dir__() -> list[str]:
    return sorted(__all__)
