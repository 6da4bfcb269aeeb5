# SPDX-License-Identifier: GPL-3.0-or-later
"""Describes failures of a run with names of the case, because the plugin knows only body numbers."""
from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from math import floor, inf, isfinite, log10
from typing import Any


def pair(one: Any, other: Any) -> frozenset[int]:
    """Return the key of two bodies, independent of their order."""
    return frozenset((int(one), int(other)))


class SceneFailure(RuntimeError):
    """A failure that the script itself detects; its message contains neither time nor temperature.

    :param code: code of the failure
    :param joint: name of the joint in result files
    :param remedy: remedy, "" if unknown
    :param time_s: time of the state
    """

    def __init__(self, sentence: str, joint: str = "", remedy: str = "", *, time_s: float, code: str) -> None:
        super().__init__(sentence)
        self.code = code
        self.joint, self.remedy, self.time_s = joint, remedy, time_s


@dataclass
class Names:
    """Names of parts of the case, by the body numbers (one or two) that the plugin reports."""

    joints: dict[frozenset[int], tuple[str, str]] = field(default_factory=dict)  # joint, words for the sentence
    links: dict[frozenset[int], str] = field(default_factory=dict)
    beams: dict[frozenset[int], str] = field(default_factory=dict)
    # by the tips of their links, as for joints
    torsion_springs: dict[frozenset[int], tuple[str, str]] = field(default_factory=dict)
    prismatic_joints: dict[frozenset[int], tuple[str, str]] = field(default_factory=dict)  # as joints
    bodies: dict[int, str] = field(default_factory=dict)

    def add_link(self, link: Any, words: str) -> None:
        """Add a link or spring; several of them may be between the same bodies."""
        bodies = pair(link.id1, link.id2)
        self.links[bodies] = f"{self.links[bodies]} or {words}" if bodies in self.links else words

    def add_beam(self, beam: Any, words: str) -> None:
        """Add a beam; several of them may be between the same bodies."""
        bodies = pair(beam.id1, beam.id2)
        self.beams[bodies] = f"{self.beams[bodies]} or {words}" if bodies in self.beams else words

    def add_prismatic_joint(self, made: Any, words: str, joint: str) -> None:
        """Add a prismatic joint; several of them may be between the same bodies."""
        bodies = pair(made.id1, made.id2)
        before = self.prismatic_joints.get(bodies)
        self.prismatic_joints[bodies] = ("", f"{before[1]} or {words}") if before else (joint, words)

    def joint_of(self, body: int) -> str:
        """Return the joint of a body, "" if there is none or more than one."""
        found = {joint for bodies, (joint, _) in self.joints.items() if body in bodies}
        return found.pop() if len(found) == 1 else ""

    def add_torsion_spring(self, spring: Any, words: str, joint: str = "") -> None:
        """Add a torsion spring; several of them may be between the same links.

        :param joint: name of the joint that the spring represents, if any
        """
        tips = pair(spring.link1.id2, spring.link2.id2)
        before = self.torsion_springs.get(tips)
        self.torsion_springs[tips] = ("", f"{before[1]} or {words}") if before else (joint, words)


def rounded_down(value: float) -> float:
    """Return a positive value rounded down to two digits."""
    unit = 10.0 ** (floor(log10(value)) - 1)
    return float(f"{floor(value / unit) * unit:.2g}")


def described(
    error: Exception, taken: Mapping[str, Any] | None, names: Names, now_s: float,
    temperature_change: Callable[[float], float], stable_time_step: Callable[[], float],
    step_remedy: Callable[[float], str],
) -> dict[str, Any]:
    """Return the fields of a failure: cause, time, temperature; if known, joint, its position as text, and remedy.

    :param error: the error that ended the run
    :param taken: the failure from ``statejump_yade.take_failure``; None: the error is not from the plugin
    :param now_s: time [s] for failures without a time
    :param temperature_change: temperature change [K] of the case's (first) program at a time [s]
    :param stable_time_step: stable step [s] of the whole scene in its current state
    :param step_remedy: returns, for a stable step [s], the key of the case file that sets such a step
    """
    joint, words, remedy, time_s, part = "", "", "", now_s, ""
    if taken is None:
        cause = " ".join(str(error).split())
    else:
        time_s = taken["time"]
        if taken["part"] == "scene":
            cause = taken["before"] + taken["after"]
        elif taken["part"] == "body":
            body, = taken["bodies"]
            part = names.bodies.get(body, f"body {body}")
            cause = taken["before"] + part + taken["after"]
            joint = names.joint_of(body)
        elif taken["part"] == "contact":
            cause = taken["before"] + taken["after"]
            joint, words = names.joints.get(pair(*taken["bodies"]), ("", "bodies {} and {}".format(*taken["bodies"])))
            part = words
        else:
            bodies = pair(*taken["bodies"])
            single = {"link": names.links, "beam": names.beams}.get(taken["part"])
            unknown = f"the {taken['part'].replace('_', ' ')} of bodies {' and '.join(map(str, taken['bodies']))}"
            known = names.prismatic_joints if taken["part"] == "prismatic_joint" else names.torsion_springs
            joint, part = known.get(bodies, ("", unknown)) if single is None else ("", single.get(bodies, unknown))
            cause = taken["before"] + part + taken["after"]
        if taken["stable_time_step"] is not None:
            # The stable step of one contact or link exceeds that of all contacts and links of one body together.
            whole = stable_time_step()
            remedy = step_remedy(min(taken["stable_time_step"], whole if isfinite(whole) and whole > 0 else inf))
    if isinstance(error, SceneFailure):
        joint, remedy, time_s, part = error.joint, error.remedy, error.time_s, ""
    time_s = float(f"{time_s:.9g}")
    fields = {"time_s": time_s, "temperature_change_K": float(f"{temperature_change(time_s):.9g}"), "joint": joint,
              "place": words, "cause": cause, "remedy": remedy, "part": part}
    if isinstance(error, SceneFailure):
        fields["reason"] = error.code
    elif taken is not None:
        fields |= {"reason": taken["code"], "quantity": taken["quantity"]}
    return {key: value for key, value in fields.items() if value != ""}
