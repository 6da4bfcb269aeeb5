# SPDX-License-Identifier: GPL-3.0-or-later
"""Case files: one definition of every parameter, validated once, here.

Every field carries default (or none: required), unit, allowed range and source. A case is bad as a
whole if one value is: :func:`load_case` raises :class:`~statejump.errors.StatejumpError` with one
sentence that names the file, the key, the value and the range. Only this module knows pydantic.
"""
from __future__ import annotations

import difflib
import math
import re
import tomllib
from pathlib import Path
from typing import Any, Literal, Optional

from pydantic import BaseModel, Extra, Field, ValidationError, validator
from pydantic.fields import ModelField

from .errors import StatejumpError

PAPER = "Chen et al. (2021), Table 1"
CHOICE = "choice, the paper is silent"


def parameter(
    default: Any,
    unit: str,
    low: float,
    high: float,
    source: str,
    *,
    above: bool = False,
) -> Any:
    """Return the pydantic field of a number.

    :param default: default value; ``...`` for a required key
    :param unit: unit, ``-`` for none
    :param low: lower end of the allowed range
    :param high: upper end, itself allowed
    :param source: where the default comes from
    :param above: whether ``low`` itself is excluded
    """
    return Field(default, unit=unit, low=low, high=high, above=above, description=source)


def allowed_range(extra: dict[str, Any]) -> str:
    """Return the sentence part that states the allowed range of a parameter."""
    if extra["above"]:
        return f"must be above {extra['low']:g} and at most {extra['high']:g} [{extra['unit']}]"
    return f"must be between {extra['low']:g} and {extra['high']:g} [{extra['unit']}]"


def check_number(value: Any, extra: dict[str, Any], integer: bool) -> float | int:
    """Return the value if it is a number in range, else raise ValueError with the reason."""
    kind = "a whole number" if integer else "a number"
    if isinstance(value, bool) or not isinstance(value, int if integer else (int, float)):
        raise ValueError(f"must be {kind}, " + allowed_range(extra).removeprefix("must be "))
    if isinstance(value, float) and not math.isfinite(value):
        raise ValueError("must be finite, " + allowed_range(extra).removeprefix("must be "))
    too_low = value <= extra["low"] if extra["above"] else value < extra["low"]
    if too_low or value > extra["high"]:
        raise ValueError(allowed_range(extra))
    return value


def check_radii(bearing_radius: float, journal_radius: float) -> None:
    """Raise ValueError unless a journal fits into its bearing; for cases with a revolute joint."""
    if not bearing_radius > journal_radius:
        raise ValueError(f"must be above journal_radius_m = {journal_radius!r} [m]")


class Section(BaseModel):
    """A table of the case file: unknown keys are refused, numbers are strict and in range."""

    class Config:
        extra = Extra.forbid
        allow_mutation = False

    @validator("*", pre=True)
    def _strict(cls, value: Any, field: ModelField) -> Any:
        extra = field.field_info.extra
        if "low" not in extra:
            if not isinstance(value, (str, dict)):
                raise ValueError("must be a text in quotes")
            return value
        if extra.get("listed"):
            if not isinstance(value, list):
                raise ValueError(f"must be a list of numbers [{extra['unit']}]")
            return [float(check_number(item, extra, integer=False)) for item in value]
        return check_number(value, extra, integer=field.type_ is int)


class CaseHeader(Section):
    """What the case is."""

    name: str = Field(..., description="name of the results folder")
    kind: Literal["spring_slider"] = Field(..., description="which experiment")
    title: str = Field("", description="one line for figures")
    source: str = Field("", description="where the numbers come from")

    @validator("name")
    def _name(cls, value: str) -> str:
        if not re.fullmatch(r"[A-Za-z0-9][A-Za-z0-9_-]*", value):
            raise ValueError("must consist of letters, digits, '_' and '-'")
        return value


class Link(Section):
    """The bar that expands."""

    young_modulus_Pa: float = parameter(..., "Pa", 0, 1e13, PAPER, above=True)
    stress_free_length_m: float = parameter(..., "m", 0, 1e3, PAPER, above=True)
    cross_section_area_m2: float = parameter(..., "m2", 0, 1e2, PAPER, above=True)
    thermal_expansion_per_K: float = parameter(..., "1/K", -1e-3, 1e-3, PAPER)
    density_kg_per_m3: float = parameter(2700.0, "kg/m3", 0, 1e5, CHOICE + ": aluminium", above=True)
    poisson_ratio: float = parameter(0.3, "-", -0.99, 0.49, PAPER)


class Joint(Section):
    """The block at the tip of the bar, in a slot with a floor and two stops."""

    normal_force_N: float = parameter(..., "N", 0, 1e9, PAPER, above=True)
    friction_coefficient: float = parameter(..., "-", 0, 10, PAPER)
    clearance_minus_m: float = parameter(..., "m", 0, 1e2, PAPER, above=True)
    clearance_plus_m: float = parameter(..., "m", 0, 1e2, PAPER, above=True)
    preload_stiffness_N_per_m: float = parameter(0.0, "N/m", 0, 1e15, "none in the paper's case")
    pad_radius_m: float = parameter(0.05, "m", 0, 1e2, CHOICE + "; DEM only", above=True)
    young_modulus_Pa: float = parameter(70e9, "Pa", 0, 1e13, CHOICE + ": as the link", above=True)
    poisson_ratio: float = parameter(0.3, "-", -0.99, 0.49, CHOICE + ": as the link")
    pad_thermal_expansion_per_K: float = parameter(0.0, "1/K", -1e-3, 1e-3, CHOICE)
    slot_thermal_expansion_per_K: float = parameter(
        0.0, "1/K", -1e-3, 1e-3, "the paper's frame does not expand"
    )


class Thermal(Section):
    """The temperature program, one cycle repeated."""

    shape: Literal["triangle", "half_sine", "sine", "table"] = Field(..., description=CHOICE)
    temperature_change_max_K: Optional[float] = parameter(None, "K", -1e4, 1e4, PAPER)
    cycles: int = parameter(1, "-", 1, 100_000, "the paper runs one")
    table_time_s: Optional[list[float]] = Field(
        None, unit="s", low=0, high=1e12, above=False, listed=True, description="measured data"
    )
    table_temperature_change_K: Optional[list[float]] = Field(
        None, unit="K", low=-1e4, high=1e4, above=False, listed=True, description="measured data"
    )


class Dem(Section):
    """How the DEM runs the case; the reduced model takes only times and samples from here."""

    period_s: float = parameter(1.0, "s", 0, 1e6, CHOICE + ": slow enough", above=True)
    time_step_s: Optional[float] = parameter(None, "s", 0, 1.0, "from the fraction", above=True)
    time_step_fraction: float = parameter(0.1, "-", 0, 1.0, "of the stable step", above=True)
    link_damping_ratio: float = parameter(0.1, "-", 0, 10, CHOICE)
    contact_damping_ratio: float = parameter(0.1, "-", 0, 10, CHOICE)
    slider_mass_kg: float = parameter(0.0, "kg", 0, 1e6, "the paper's link is its own mass")
    samples_per_cycle: int = parameter(2000, "-", 10, 1_000_000, CHOICE)
    threads: int = parameter(1, "-", 1, 1024, CHOICE)


class Tolerance(Section):
    """How close the two models must be for ``compare`` to pass."""

    state_jump_relative: float = parameter(0.005, "-", 0, 1, CHOICE, above=True)
    event_temperature_K: float = parameter(0.5, "K", 0, 1e3, CHOICE, above=True)
    displacement_rms_relative: float = parameter(0.01, "-", 0, 1, CHOICE, above=True)
    energy_balance_relative: float = parameter(0.001, "-", 0, 1, CHOICE, above=True)
    state_jump_absolute_m: float = parameter(1e-9, "m", 0, 1, CHOICE + "; no friction", above=True)
    drift_relative: float = parameter(0.001, "-", 0, 1, CHOICE + "; several cycles", above=True)


class Case(Section):
    """A whole case file in SI units, immutable."""

    case: CaseHeader
    link: Link
    joint: Joint
    thermal: Thermal
    dem: Dem = Field(default_factory=Dem)
    tolerance: Tolerance = Field(default_factory=Tolerance)

    @property
    def name(self) -> str:
        """Name of the case and of its results folder."""
        return self.case.name

    @property
    def friction_force_N(self) -> float:
        """Friction limit f = μ N [N]."""
        return self.joint.friction_coefficient * self.joint.normal_force_N

    @property
    def duration_s(self) -> float:
        """Length of all cycles [s]."""
        return self.dem.period_s * self.thermal.cycles

    @property
    def table_time_s(self) -> list[float]:
        """Times of the table, stretched so that one cycle lasts ``dem.period_s``; else empty."""
        times = self.thermal.table_time_s or []
        return [self.dem.period_s * (time / times[-1]) for time in times]

    @property
    def temperature_range_K(self) -> tuple[float, float]:
        """Smallest and largest ΔT [K] of the program."""
        if self.thermal.shape == "table":
            changes = self.thermal.table_temperature_change_K or [0.0]
            return min(changes), max(changes)
        peak = self.thermal.temperature_change_max_K or 0.0
        if self.thermal.shape == "sine":
            return -abs(peak), abs(peak)
        return min(0.0, peak), max(0.0, peak)

    def clearance_m(self, side: int, temperature_change_K: float) -> float:
        """Return the clearance [m] on side +1 or −1 at ΔT: stop distance minus pad radius, each
        with its own expansion from the total ΔT."""
        joint = self.joint
        start = joint.clearance_plus_m if side > 0 else joint.clearance_minus_m
        stop = joint.slot_thermal_expansion_per_K * (joint.pad_radius_m + start)
        pad = joint.pad_thermal_expansion_per_K * joint.pad_radius_m
        return start + (stop - pad) * temperature_change_K


def _thermal_problem(thermal: Thermal) -> str | None:
    """Return what is wrong with the program as a whole, without the file's name."""
    if thermal.shape != "table":
        if thermal.temperature_change_max_K is None:
            extra = Thermal.__fields__["temperature_change_max_K"].field_info.extra
            return f"thermal.temperature_change_max_K is missing: {allowed_range(extra)}"
        for key in ("table_time_s", "table_temperature_change_K"):
            if getattr(thermal, key) is not None:
                return f"thermal.{key} is not allowed: only with thermal.shape = 'table'"
        return None
    if thermal.temperature_change_max_K is not None:
        return "thermal.temperature_change_max_K is not allowed with thermal.shape = 'table'"
    times, changes = thermal.table_time_s, thermal.table_temperature_change_K
    if times is None:
        return "thermal.table_time_s is missing: a list of times [s] is needed for a table"
    if changes is None:
        return "thermal.table_temperature_change_K is missing: one value [K] per time is needed"
    if len(times) < 2 or times[0] != 0 or any(b <= a for a, b in zip(times, times[1:])):
        return (
            f"thermal.table_time_s = {times} is not allowed: must be at least two times [s] "
            "that start at 0 and rise"
        )
    if len(changes) != len(times):
        return (
            f"thermal.table_temperature_change_K has {len(changes)} values: "
            f"must be {len(times)}, one per time"
        )
    if changes[0] != 0 or (thermal.cycles > 1 and changes[-1] != 0):
        return (
            f"thermal.table_temperature_change_K = {changes} is not allowed: must start at 0 [K]"
            " and, with several cycles, end at 0 [K]"
        )
    return None


def _problem(case: Case) -> str | None:
    """Return what is wrong between several keys, without the file's name."""
    from . import stable_step

    problem = _thermal_problem(case.thermal)
    if problem is not None:
        return problem
    coldest, hottest = case.temperature_range_K
    for change in (coldest, hottest):
        if 1 + case.link.thermal_expansion_per_K * change <= 0:
            return (
                f"link.thermal_expansion_per_K = {case.link.thermal_expansion_per_K!r} is not "
                f"allowed: the link has no length left at a temperature change of {change:g} K"
            )
    for side, key in ((-1, "clearance_minus_m"), (1, "clearance_plus_m")):
        for change in (coldest, hottest):
            if not case.clearance_m(side, change) > 0:
                return (
                    f"joint.{key} = {getattr(case.joint, key)!r} is not allowed: the expansion of "
                    f"pad and slot closes it at a temperature change of {change:g} K, it must stay "
                    "above 0 [m] within the program"
                )
    if case.joint.clearance_minus_m >= case.link.stress_free_length_m:
        return (
            f"joint.clearance_minus_m = {case.joint.clearance_minus_m!r} is not allowed: "
            f"must be below link.stress_free_length_m = {case.link.stress_free_length_m!r} [m]"
        )
    rigidity = case.link.young_modulus_Pa * case.link.cross_section_area_m2
    if case.friction_force_N >= rigidity:
        return (
            f"joint.friction_coefficient = {case.joint.friction_coefficient!r} is not allowed: "
            f"the friction force {case.friction_force_N:g} N must be below E A = {rigidity:g} N"
        )
    if case.dem.time_step_s is not None:
        stable = stable_step.stable_time_step(case)
        if case.dem.time_step_s > stable:
            return (
                f"dem.time_step_s = {case.dem.time_step_s!r} is not allowed: must be above 0 and "
                f"at most the stable time step {stable:.4g} [s]"
            )
    return None


def _shown(value: Any) -> str:
    """Return a value as one would write it in the file."""
    if isinstance(value, bool):
        return str(value).lower()
    return repr(value)


def _suggestion(word: str, known: list[str], before: str, after: str) -> str:
    match = difflib.get_close_matches(word, known, n=1, cutoff=0.5)
    if match:
        return f"did you mean {before}{match[0]}{after}?"
    return "known are " + ", ".join(known)


def _sentence(error: dict[str, Any], data: dict[str, Any]) -> str:
    """Return one pydantic error as one sentence."""
    location = error["loc"]
    section = str(location[0])
    if len(location) == 1:
        if error["type"] == "value_error.extra":
            known = list(Case.__fields__)
            return f"section [{section}] is unknown: {_suggestion(section, known, '[', ']')}"
        if error["type"] == "value_error.missing":
            return f"section [{section}] is missing"
        return f"{section} = {_shown(data[section])} is not allowed: must be a section [{section}]"
    key = str(location[1])
    model = Case.__fields__[section].type_
    if error["type"] == "value_error.extra":
        known = list(model.__fields__)
        return f"{section}.{key} is unknown: {_suggestion(key, known, section + '.', '')}"
    info = model.__fields__[key].field_info
    if error["type"] == "value_error.missing":
        rule = allowed_range(info.extra) if "low" in info.extra else "a text in quotes is needed"
        return f"{section}.{key} is missing: {rule}"
    reason = error["msg"]
    if error["type"] == "value_error.const":
        allowed = error["ctx"]["permitted"]
        reason = "must be " + " or ".join(repr(item) for item in allowed)
    return f"{section}.{key} = {_shown(data[section][key])} is not allowed: {reason}"


_ORDER = {"value_error.extra": 0, "value_error.missing": 1}


def parse_case(data: dict[str, Any], name: str) -> Case:
    """Return the case in a parsed TOML document.

    :param data: what tomllib returned
    :param name: name of the file, for messages
    """
    try:
        case = Case.parse_obj(data)
    except ValidationError as failure:
        # An unknown key is reported first: a misspelt key is missing as well.
        first = min(failure.errors(), key=lambda error: _ORDER.get(error["type"], 2))
        raise StatejumpError(f"{name}: {_sentence(first, data)}") from None
    problem = _problem(case)
    if problem is not None:
        raise StatejumpError(f"{name}: {problem}")
    return case


def load_case(path: str | Path) -> Case:
    """Return the validated case of a TOML file."""
    try:
        text = Path(path).read_bytes().decode("utf-8")
    except FileNotFoundError:
        raise StatejumpError(f"{path}: no such case file") from None
    except UnicodeDecodeError:
        raise StatejumpError(f"{path}: not TOML: the file is not UTF-8 text") from None
    except OSError as failure:
        raise StatejumpError(f"{path}: cannot be read: {failure.strerror}") from None
    try:
        data = tomllib.loads(text)
    except tomllib.TOMLDecodeError as failure:
        match = re.fullmatch(r"(.*) \(at (?:line (\d+), column \d+|end of document)\)", str(failure))
        reason = match[1] if match else str(failure)
        line = match[2] if match and match[2] else str(len(text.splitlines()))
        raise StatejumpError(f"{path}: not TOML, line {line}: {reason}") from None
    return parse_case(data, str(path))
