# SPDX-License-Identifier: GPL-3.0-or-later
"""Failures of a run from a case file, in the case's names: the plugin knows bodies by their numbers only."""
from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass, field
from math import floor, inf, isfinite, log10
from typing import Any

# How the plugin ends a sentence, and how it speaks of links and springs.
_END = re.compile(r" \((?:contact of bodies (\d+) and (\d+), )?time ([^ ,)]+) s(?:, temperature changes? [^)]*)?\)$")
_LINK = re.compile(r"the link between bodies (\d+) and (\d+)")
_TORSION_SPRING = re.compile(r"the torsion spring between the links of bodies (\d+) and (\d+)")
_UNSTABLE = re.compile(r"the time step \S+ s is above the stable one.*, (\S+) s$")


def pair(one: Any, other: Any) -> frozenset[int]:
    """Return the key of two bodies, in whichever order the plugin names them."""
    return frozenset((int(one), int(other)))


class SceneFailure(RuntimeError):
    """What the script itself finds wrong with a state; neither time nor temperature is in the sentence.

    :param joint: name of the joint as result files have it
    :param remedy: what would help, "" if that is not known
    """

    def __init__(self, sentence: str, joint: str = "", remedy: str = "") -> None:
        super().__init__(sentence)
        self.joint, self.remedy = joint, remedy


@dataclass
class Names:
    """What the case calls what the plugin knows by the numbers of two bodies."""

    joints: dict[frozenset[int], tuple[str, str]] = field(default_factory=dict)  # joint, words for the sentence
    links: dict[frozenset[int], str] = field(default_factory=dict)
    torsion_springs: dict[frozenset[int], str] = field(default_factory=dict)  # by the tips of their links

    def add_link(self, link: Any, words: str) -> None:
        """Add a link or spring; several of them may be between the same bodies."""
        bodies = pair(link.id1, link.id2)
        self.links[bodies] = f"{self.links[bodies]} or {words}" if bodies in self.links else words

    def add_torsion_spring(self, spring: Any, words: str) -> None:
        """Add a torsion spring."""
        self.torsion_springs[pair(spring.link1.id2, spring.link2.id2)] = words


def rounded_down(value: float) -> float:
    """Return a positive value with two digits, at most the value itself."""
    unit = 10.0 ** (floor(log10(value)) - 1)
    return float(f"{floor(value / unit) * unit:.2g}")


def described(
    error: Exception, names: Names, now_s: float, temperature_change: Callable[[float], float],
    stable_time_step: Callable[[], float], step_remedy: Callable[[float], str],
) -> dict[str, Any]:
    """Return a failure by the names of its fields: cause, time, temperature; joint, words for its place and remedy
    where they are known.

    :param now_s: time of a failure that does not say its own
    :param temperature_change: temperature change [K] of the case's (first) program at a time [s]
    :param stable_time_step: stable step [s] of the whole scene in its present state
    :param step_remedy: which key of the case file gives a step of at most so many seconds
    """
    cause, joint, remedy = " ".join(str(error).split()), "", ""
    words, time_s = "", now_s
    end = _END.search(cause)
    if end:
        cause, time_s = cause[: end.start()], float(end[3])
        if end[1]:
            joint, words = names.joints.get(pair(end[1], end[2]), ("", f"bodies {end[1]} and {end[2]}"))
    for pattern, known in ((_LINK, names.links), (_TORSION_SPRING, names.torsion_springs)):
        cause = pattern.sub(lambda found: known.get(pair(found[1], found[2]), found[0]), cause)
    unstable = _UNSTABLE.fullmatch(cause)
    if unstable:
        # One contact or link alone allows more than all that pull at one body.
        whole = stable_time_step()
        remedy = step_remedy(min(float(unstable[1]), whole if isfinite(whole) and whole > 0 else inf))
    if isinstance(error, SceneFailure):
        joint, remedy = error.joint, error.remedy
    time_s = float(f"{time_s:.9g}")
    change = float(f"{temperature_change(time_s):.9g}")
    fields = {"time_s": time_s, "temperature_change_K": change, "joint": joint, "place": words, "cause": cause,
              "remedy": remedy}
    return {key: value for key, value in fields.items() if value != ""}
