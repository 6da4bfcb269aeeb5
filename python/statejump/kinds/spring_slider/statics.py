# SPDX-License-Identifier: GPL-3.0-or-later
"""Rest sets of the block of a ``spring_slider`` case at the temperatures of the program.

The bar pushes with k_T (x_T - x), a preload spring pulls back with P + k_p x, and friction carries up to f. The block
therefore rests wherever |k_T x_T - P - (k_T + k_p) x| <= f. This is a segment of half-length f/(k_T + k_p) about the
position of zero force, within the stops. If the segment extends beyond a stop, the stop carries the rest of the force.
At the reference temperature the length of the segment is the largest possible state jump.
"""
from __future__ import annotations

from collections.abc import Sequence
from dataclasses import astuple, dataclass, fields
from pathlib import Path
from typing import TYPE_CHECKING

from statejump.core import libraries
from statejump.core.later import Later
from statejump.core.physics import axial_stiffness_N_per_m
from statejump.core.tables import Shown, write_json
from statejump.core.units import plain
from statejump.kinds.spring_slider.case import SpringSliderCase

if TYPE_CHECKING:
    import pandas
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_DRAWN, _SAVED = Later("statejump.kinds.spring_slider.figure:drawn"), Later("statejump.core.figures:save")


@dataclass(frozen=True)
class Segment:
    """Positions at which the block rests at one temperature."""

    temperature_change_K: float
    from_m: float
    to_m: float
    zero_force_m: float  # position without friction and stop force

    @property
    def length_m(self) -> float:
        """Largest distance of two rest positions [m]."""
        return self.to_m - self.from_m


@dataclass(frozen=True)
class RestSets:
    """Rest sets of the block, sorted by temperature. ``largest_jump_m`` holds at the reference temperature."""

    case: SpringSliderCase
    friction_force_N: float
    segments: tuple[Segment, ...]

    @property
    def largest_jump_m(self) -> float:
        """Largest state jump that friction allows [m]: the length of the rest set at ΔT = 0."""
        return next(part.length_m for part in self.segments if part.temperature_change_K == 0)

    def frame(self) -> pandas.DataFrame:
        """Return one row per temperature, with units in the column names."""
        rows = [(*astuple(part), part.length_m) for part in self.segments]
        return libraries.frame(rows, columns=[*(field.name for field in fields(Segment)), "length_m"])

    def plot(self, axes: Axes | None = None) -> Figure:
        """Draw the rest positions over the temperature, into given axes or into a new figure."""
        return _DRAWN(self, axes)

    def summary_lines(self) -> list[Shown | str]:
        """Return what a command prints."""
        rows = [tuple(plain(value, "K" if place == 0 else "m") for place, value in
                      enumerate((part.temperature_change_K, part.from_m, part.to_m, part.length_m)))
                for part in self.segments]
        return [
            Shown(f"{self.case.title}: where friction of {plain(self.friction_force_N, 'N')} holds the block",
                  ("ΔT", "from", "to", "length"), rows),
            f"largest state jump that friction allows: {plain(self.largest_jump_m, 'm')}",
        ]

    def write(self, folder: Path) -> list[Path]:
        """Write ``statics.json`` and the picture; return their paths."""
        document = {
            "case": self.case.name, "title": self.case.title, "friction_force_N": self.friction_force_N,
            "largest_jump_m": self.largest_jump_m,
            "segments": [{"length_m": part.length_m, **vars(part)} for part in self.segments],
        }
        return [write_json(folder / "statics.json", document, indent=1),
                *_SAVED(self.plot(), folder, f"{self.case.name}_statics")]

    def __repr__(self) -> str:
        return f"RestSets({self.case.name}, largest jump {self.largest_jump_m:.6g} m)"

    def _repr_html_(self) -> str:
        return str(self.frame().to_html(index=False))


def segment(case: SpringSliderCase, friction_force_N: float, temperature_change_K: float) -> Segment:
    """Return the rest set at one temperature, for the clearances at the reference temperature."""
    link, joint = case.link, case.joint
    strain = case.thermal_strain(temperature_change_K)
    length = link.stress_free_length_m * (1 + strain)
    bar = axial_stiffness_N_per_m(link.young_modulus_Pa, link.cross_section_area_m2, length)
    total = bar + joint.preload_stiffness_N_per_m
    stroke = link.stress_free_length_m * strain
    zero = (bar * stroke - joint.preload_force_N) / total
    half = friction_force_N / total
    ends = [case.held_m(place, total) for place in (zero - half, zero + half)]
    return Segment(float(temperature_change_K), ends[0], ends[1], zero)


def rest_sets(case: SpringSliderCase, friction_force_N: float, temperatures: int | None = None) -> RestSets:
    """Return the rest sets at both ends of the temperature range and at ΔT = 0, or at evenly spaced temperatures."""
    coldest, hottest = case.temperature_range_K
    changes: Sequence[float] = sorted({coldest, 0.0, hottest})
    if temperatures is not None:
        changes = [coldest + (hottest - coldest) * place / (temperatures - 1) for place in range(temperatures)]
    return RestSets(case, friction_force_N, tuple(segment(case, friction_force_N, change) for change in changes))


def statics(case: SpringSliderCase, friction_coefficient: float | None = None) -> RestSets:
    """Return the rest positions of the block.

    :param friction_coefficient: friction coefficient to use instead of that of the case [-]
    """
    mu = case.joint.friction_coefficient if friction_coefficient is None else friction_coefficient
    return rest_sets(case, mu * case.joint.normal_force_N)
