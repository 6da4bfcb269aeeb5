# SPDX-License-Identifier: GPL-3.0-or-later
"""The section of a case file that describes an identified joint: its keys, their values and distributions."""
from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import hypot

from scipy.special import ndtri

from statejump.core.errors import NotAllowed
from statejump.identification.fit import Interval

# Items of a case that an identified joint may become, and the kind of loop that each needs.
TARGETS = {
    "spring_slider": ("[joint]", "joint", False),
    "slider": ("[[slider]]", "slider.*", False),
    "revolute": ("[[revolute]]", "revolute.*", None),
    "umbrella": ("[joint]", "joint", None),
    "torsion_spring": ("[[torsion_spring]]", "torsion_spring.*", True),
    "iwan_joint": ("[[iwan_joint]]", "iwan_joint.*", False),
}
OF_EITHER_SIGN = ("bias_rad", "preload_force_N")


@dataclass(frozen=True)
class Entry:
    """A key of the section of an identified joint.

    :param key: name of the key in its section
    :param value: value of the key; None: the loop does not determine it
    :param deviation: standard deviation of the estimate; None: the loop does not bound it
    :param why: reason why the value is missing
    """

    key: str
    value: float | None
    deviation: float | None = None
    why: str = ""


def check(target: str, angular: bool) -> None:
    """Raise NotAllowed if a loop of this type cannot determine the parameters of such an item."""
    if target not in TARGETS:
        raise NotAllowed("target", target, code="not_one_of", allowed=tuple(TARGETS), known=", ".join(TARGETS))
    if TARGETS[target][2] not in (None, angular):
        raise NotAllowed("target", target, code="target_of_rotation" if not angular else "target_of_displacement")


def deviation(interval: Interval, confidence: float) -> float | None:
    """Return the standard deviation of a normal distribution with a confidence interval; None if that is unbounded."""
    if not interval.bounded:
        return None
    return (interval.high - interval.low) / (2 * float(ndtri(0.5 + confidence / 2)))


def entries(
    target: str, values: Mapping[str, float], intervals: Mapping[str, Interval], confidence: float,
    normal_force_N: float | None, journal_radius_m: float | None, angular: bool,
) -> list[Entry]:
    """Return the keys of the section, with values and deviations.

    :param values: parameters of the joint, by name
    """
    spread = {name: deviation(interval, confidence) for name, interval in intervals.items()}

    def known(key: str, name: str, missing: str, scale: float = 1.0) -> Entry:
        if name not in values:
            return Entry(key, None, why=missing)
        wide = spread[name]
        if wide is None:
            return Entry(key, None, why="not identifiable from this loop")
        return Entry(key, values[name] * scale, wide * scale)

    def friction() -> list[Entry]:
        arm = journal_radius_m if angular else 1.0
        given = Entry("normal_force_N", normal_force_N, why="--normal-force gives it")
        if normal_force_N is None or arm is None:
            needs = "--normal-force" if arm is not None else "--normal-force and --journal-radius"
            what = "μ N" if not angular else "μ N R"
            return [given, Entry("friction_coefficient", None, why=f"the loop gives {what} alone: say {needs}")]
        return [given, known("friction_coefficient", "friction", "the loop shows no friction",
                             1 / (normal_force_N * arm))]

    def play() -> Entry:
        if angular or "clearance_plus" not in values:
            return Entry("radial_clearance_m", None, why="the loop shows no clearance")
        minus, plus = spread["clearance_minus"], spread["clearance_plus"]
        if minus is None or plus is None:
            return Entry("radial_clearance_m", None, why="not identifiable from this loop")
        return Entry("radial_clearance_m", (values["clearance_minus"] + values["clearance_plus"]) / 2,
                     hypot(minus, plus) / 2)

    if target in ("spring_slider", "slider"):
        stops = [known(f"{name}_m", name, "the loop meets no stop") for name in ("clearance_minus", "clearance_plus")]
        spring = [known("preload_stiffness_N_per_m", "preload_stiffness", "the loop shows no spring beside the slide"),
                  known("preload_force_N", "preload", "the loop shows no force of its own")]
        if "stop_stiffness" in values:
            stops.append(known("stop_stiffness_N_per_m", "stop_stiffness", ""))
        if "play" in values:
            # A play carries no force in a case. This length gives the same displacement between forward and backward
            # slip.
            stops.append(known("play_m", "play", "", 1 - values.get("play_ratio", 0.0)))
        return friction() + stops + (spring if target == "spring_slider" else [])
    if target == "iwan_joint":
        none = "the loop is not of an Iwan joint: --model iwan fits one"
        is_iwan = "iwan_exponent" in values
        return [known(key, name if is_iwan else "iwan_exponent", none) for key, name in (
            ("tangent_stiffness_N_per_m", "stiffness"), ("slip_force_N", "friction"), ("exponent", "iwan_exponent"),
            ("stiffness_ratio", "iwan_ratio"))]
    if target == "torsion_spring":
        name = "preload_stiffness" if "friction" in values or "clearance_plus" in values else "stiffness"
        stiffness = known("stiffness_N_m_per_rad", name, "the loop shows no spring beside the slide")
        wide = spread.get("preload")
        if stiffness.value is None or wide is None:
            return [stiffness, Entry("bias_rad", None, why="not identifiable from this loop")]
        # The moment K (angle - bias) equals the preload P at angle 0.
        return [stiffness, Entry("bias_rad", -values["preload"] / stiffness.value, wide / stiffness.value)]
    return [*friction()[1:], play()]


def section(target: str, found: list[Entry], source: str) -> list[str]:
    """Return the lines of the section. Parameters that the loop does not determine become comments."""
    lines = [f"# identified from {source}", TARGETS[target][0]]
    for entry in found:
        if entry.value is None:
            lines.append(f"# {entry.key} = ?  # {entry.why}")
        else:
            spread = "" if entry.deviation is None else f"  # ± {entry.deviation:.2g}"
            lines.append(f"{entry.key} = {entry.value:.6g}{spread}")
    return lines


def distributions(target: str, found: list[Entry]) -> dict[str, dict[str, float | str]]:
    """Return the varied keys of a campaign with the fields of a ``[[vary]]`` table; positive parameters are
    lognormal."""
    return {
        f"{TARGETS[target][1]}.{entry.key}": {
            "distribution": "lognormal" if entry.value > 0 and entry.key not in OF_EITHER_SIGN else "normal",
            "mean": entry.value, "standard_deviation": entry.deviation,
        }
        for entry in found if entry.value is not None and entry.deviation
    }


def vary(found: Mapping[str, Mapping[str, float | str]]) -> list[str]:
    """Return the lines of ``[[vary]]`` tables."""
    lines = []
    for key, table in found.items():
        lines += ["[[vary]]", f'key = "{key}"']
        lines += [f'{name} = "{value}"' if isinstance(value, str) else f"{name} = {value:.6g}"
                  for name, value in table.items()]
        lines.append("")
    return lines[:-1]
