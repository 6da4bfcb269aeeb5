# SPDX-License-Identifier: GPL-3.0-or-later
"""Frictional contact problems along the path of a truss whose degrees of freedom are condensed to its joints."""
from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from statejump.core.errors import Range, StatejumpError
from statejump.core.progress import OnProgress
from statejump.fclib import Problem, Stored, merit
from statejump.fclib.problem import Merit
from statejump.kinds.truss.case import TrussCase
from statejump.kinds.truss.solve import settings, whole_path
from statejump.schema.rules import WHOLE, Rule

NUMBER = Rule(WHOLE, allowed=Range(1, 10_000))
# The Delassus matrix W is dense, with 2 rows per joint: 128 MB per problem for 2000 joints.
MOST_JOINTS = 2000


@dataclass(frozen=True)
class ContactProblem:
    """The frictional contact problem of one step of the path.

    :param problem: u = W r + q of the possible contacts; its stored solution has the reactions of the path
    :param velocities: u on the path [m]: gap at the end of the step, slide during it
    :param joints: name of the joint of every contact
    :param merit: error of the reactions of the path
    """

    time_s: float
    temperature_change_K: float
    problem: Problem
    velocities: np.ndarray
    joints: tuple[str, ...]
    merit: Merit


def contact_problems(
    case: TrussCase, number: int, on_progress: OnProgress = lambda share: None,
) -> list[ContactProblem]:
    """Return the contact problems of ``number`` steps, evenly spaced over the path; fewer if it is shorter.

    :raises NotAllowed: ``number`` is out of its range
    :raises StatejumpError: no joint is a contact, there are too many for a dense W, or joints have partial slip
    :raises FailedRun: the solver finds no quasi-static path
    """
    NUMBER.check("number", number)
    truss = case.resolve()
    if truss.sticking == "partial_slip":
        raise StatejumpError(code="partial_slip_without_cone", case=case.name)
    joints = truss.number_of_joints()
    if not joints:
        raise StatejumpError(code="truss_without_joints", case=case.name)
    if joints > MOST_JOINTS:
        raise StatejumpError(code="too_many_joints", case=case.name, count=joints, most=MOST_JOINTS)
    wanted = (np.arange(number) + 0.5) / number * case.duration_s
    found = whole_path(truss, on_progress, cycle_ends_only=True, problem_times=wanted, **settings(case))
    problems = [_problem(case, problem) for problem in found.problems if problem["joints"]]
    if not problems:
        raise StatejumpError(code="no_contact", case=case.name)
    return problems


def _problem(case: TrussCase, found: dict) -> ContactProblem:
    held = found["proximal_stiffness_N_per_m"]
    description = (
        f"Joints of the truss {case.name} in one step of its path, t = {found['time_s']:.9g} s, temperature change "
        f"{found['temperature_change_K']:.9g} K. r in N; u in m: gap at the end, slide of the step. Contacts: "
        f"{', '.join(found['joints'])}."
        + (f" Without the contacts the truss is a mechanism: {held:.6g} N/m hold every displacement to the path's."
           if held else "")
    )
    problem = Problem(found["delassus"], found["q"], found["mu"], 2, f"{case.name}, t = {found['time_s']:.9g} s",
                      description, (Stored("solution", found["reactions"]),))
    return ContactProblem(found["time_s"], found["temperature_change_K"], problem, found["velocities"],
                          tuple(found["joints"]), merit(problem, found["reactions"]))
