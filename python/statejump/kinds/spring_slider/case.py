# SPDX-License-Identifier: GPL-3.0-or-later
"""Cases of kind ``spring_slider``: a heated bar pushes a block with friction between stops."""
from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property
from typing import ClassVar

import numpy as np

from statejump.core import expansion, plausibility, yade_process
from statejump.core.case import Case, no_length_left
from statejump.core.errors import MissingKey, NotAllowed
from statejump.core.expansion import Expansion, followed
from statejump.core.start import Start
from statejump.core.thermal import MemberProgram, Thermal
from statejump.kinds.spring_slider import stable_step
from statejump.schema.fields import CHOICE, Section, definition, optional_section, parameter, section, whole

PAPER = "Chen et al. (2021), Table 1"


@definition
class Link(Section):
    """The bar that expands."""

    young_modulus_Pa: float = parameter(..., "Pa", 0, 1e13, PAPER, above=True)
    stress_free_length_m: float = parameter(..., "m", 0, 1e3, PAPER, above=True)
    cross_section_area_m2: float = parameter(..., "m2", 0, 1e2, PAPER, above=True)
    thermal_expansion_per_K: float | None = parameter(None, "1/K", -1e-3, 1e-3, PAPER + "; this or [expansion]")
    density_kg_per_m3: float = parameter(2700.0, "kg/m3", 0, 1e5, CHOICE + ": aluminium", above=True)
    poisson_ratio: float = parameter(0.3, "-", -0.99, 0.49, PAPER)


@definition
class Joint(Section):
    """The block at the tip of the bar, in a slot with a floor and two stops."""

    normal_force_N: float = parameter(..., "N", 0, 1e9, PAPER, above=True)
    friction_coefficient: float = parameter(..., "-", 0, 10, PAPER)
    clearance_minus_m: float = parameter(..., "m", 0, 1e2, PAPER, above=True)
    clearance_plus_m: float = parameter(..., "m", 0, 1e2, PAPER, above=True)
    stop_stiffness_N_per_m: float | None = parameter(
        None, "N/m", 0, 1e15, "of a stop itself, as the bearing of a bolt; rigid, in the DEM as stiff as the pad",
        above=True)
    play_m: float = parameter(0.0, "m", 0, 1e2, "lost motion at each reversal, which moves with the slide; none")
    preload_stiffness_N_per_m: float = parameter(0.0, "N/m", 0, 1e15, "none in the paper's case")
    preload_force_N: float = parameter(
        0.0, "N", -1e9, 1e9, "tension of that spring at displacement 0, towards the root of the bar; none in the "
        "paper's case"
    )
    pad_radius_m: float = parameter(0.05, "m", 0, 1e2, CHOICE + "; DEM only", above=True)
    young_modulus_Pa: float = parameter(70e9, "Pa", 0, 1e13, CHOICE + ": as the link", above=True)
    poisson_ratio: float = parameter(0.3, "-", -0.99, 0.49, CHOICE + ": as the link")
    pad_thermal_expansion_per_K: float = parameter(0.0, "1/K", -1e-3, 1e-3, CHOICE)
    slot_thermal_expansion_per_K: float = parameter(
        0.0, "1/K", -1e-3, 1e-3, "the paper's frame does not expand"
    )


@definition
class Dem(Section):
    """Settings of the DEM; the reduced model uses only the number of samples."""

    time_step_s: float | None = parameter(None, "s", 0, 1.0, "from the fraction", above=True)
    time_step_fraction: float = parameter(0.1, "-", 0, 1.0, "of the stable step", above=True)
    link_damping_ratio: float = parameter(0.1, "-", 0, 10, CHOICE)
    contact_damping_ratio: float = parameter(0.1, "-", 0, 10, CHOICE)
    slider_mass_kg: float = parameter(0.0, "kg", 0, 1e6, "the paper's link is its own mass")
    samples_per_cycle: int = whole(2000, 10, 1_000_000, CHOICE)
    threads: int = whole(1, 1, 1024, CHOICE)
    stepper: str = yade_process.stepper()


@definition
class Tolerance(Section):
    """Allowed differences between the two models in ``compare``."""

    state_jump_relative: float = parameter(0.005, "-", 0, 1, CHOICE, above=True)
    event_temperature_K: float = parameter(0.5, "K", 0, 1e3, CHOICE, above=True)
    displacement_rms_relative: float = parameter(0.01, "-", 0, 1, CHOICE, above=True)
    energy_balance_relative: float = parameter(0.001, "-", 0, 1, CHOICE, above=True)
    state_jump_absolute_m: float = parameter(1e-9, "m", 0, 1, CHOICE + "; no friction", above=True)
    drift_relative: float = parameter(0.001, "-", 0, 1, CHOICE + "; several cycles", above=True)


@definition
class SpringSliderCase(Case):
    """A heated bar with a clearance joint (section 3 of the paper)."""

    KIND: ClassVar[str] = "spring_slider"

    MOVED: ClassVar[Mapping[str, str]] = {"dem.period_s": "thermal.period_s"}

    link: Link = section(Link, required=True)
    joint: Joint = section(Joint, required=True)
    start: Start = section(Start)
    expansion: Expansion | None = optional_section(Expansion)
    dem_settings: Dem = section(Dem, name="dem")
    tolerance: Tolerance = section(Tolerance)

    @property
    def samples_per_cycle(self) -> int:
        """Samples per cycle of both models."""
        return self.dem_settings.samples_per_cycle

    @property
    def thermal_expansion_per_K(self) -> float:
        """Coefficient of thermal expansion of the bar [1/K]; if the case has a section [expansion], its largest |α|."""
        constant = self.link.thermal_expansion_per_K
        return self.expansion.largest_per_K if self.expansion is not None else 0.0 if constant is None else constant

    @cached_property
    def bar_program(self) -> Thermal | MemberProgram:
        """Temperature program of the bar; with a section [expansion] the program ε/α₀ of
        :mod:`statejump.core.expansion`.
        :mod:`statejump.core.expansion`."""
        return self.thermal if self.expansion is None else followed(self.expansion, self.thermal, self.period_s)

    @property
    def turning_changes_K(self) -> tuple[float, ...]:
        """Temperature changes [K] at which the bar may be longest or shortest: ends of the range, and zeros of α."""
        coldest, hottest = self.temperature_range_K
        zeros = () if self.expansion is None else self.expansion.zeros_K
        return (coldest, *(change for change in zeros if coldest < change < hottest), hottest)

    def thermal_strain(self, temperature_change_K: float) -> float:
        """Return the free strain of the bar [-]."""
        if self.expansion is None:
            return self.thermal_expansion_per_K * temperature_change_K
        return float(self.expansion.strain(np.array([temperature_change_K]))[0])

    @property
    def implausible(self) -> tuple[str, ...]:
        bar, strain = ["bar"], max(abs(self.thermal_strain(change)) for change in self.turning_changes_K)
        return (*plausibility.moduli("link", bar, np.array([self.link.young_modulus_Pa])),
                *plausibility.moduli("joint", ["block"], np.array([self.joint.young_modulus_Pa])),
                *plausibility.strains("link", bar, np.array([strain]), "thermal"))

    @property
    def friction_force_N(self) -> float:
        """Friction limit f = μ N [N]."""
        return self.joint.friction_coefficient * self.joint.normal_force_N

    def clearance_m(self, side: int, temperature_change_K: float) -> float:
        """Return the clearance [m] on side +1 or -1 at ΔT: stop distance minus pad radius, which expand with the full
        ΔT."""
        joint = self.joint
        start = joint.clearance_plus_m if side > 0 else joint.clearance_minus_m
        stop = joint.slot_thermal_expansion_per_K * (joint.pad_radius_m + start)
        pad = joint.pad_thermal_expansion_per_K * joint.pad_radius_m
        return start + (stop - pad) * temperature_change_K

    def held_m(self, place_m: float, stiffness_N_per_m: float) -> float:
        """Return the equilibrium position of the block [m] on a spring that holds it at ``place_m`` without stops."""
        joint = self.joint
        inside = min(max(place_m, -joint.clearance_minus_m), joint.clearance_plus_m)
        if joint.stop_stiffness_N_per_m is None:
            return inside
        return inside + (place_m - inside) * stiffness_N_per_m / (stiffness_N_per_m + joint.stop_stiffness_N_per_m)

    def _check_expansion(self) -> None:
        key, constant = "link.thermal_expansion_per_K", self.link.thermal_expansion_per_K
        if self.expansion is None:
            if constant is None:
                raise MissingKey(key, code="expansion_missing")
            no_length_left(key, constant, self)
            return
        if constant is not None:
            raise NotAllowed(key, constant, code="conflicting_key", other="[expansion]")
        expansion.check(self.expansion, "expansion.")
        try:
            assert self.bar_program is not None
        except NotAllowed as refused:
            if refused.key == "temperature_change_K":
                refused.key = "expansion.temperature_change_K"
            raise
        for change in self.turning_changes_K:
            if 1 + self.thermal_strain(change) <= 0:
                raise NotAllowed("expansion.thermal_expansion_per_K", self.expansion.thermal_expansion_per_K,
                                 code="link_without_length", at_K=change)

    def check(self) -> None:
        """Raise StatejumpError for a contradiction between several keys."""
        link, joint = self.link, self.joint
        self._check_expansion()
        for side, key in ((-1, "clearance_minus_m"), (1, "clearance_plus_m")):
            for change in self.temperature_range_K:
                if not self.clearance_m(side, change) > 0:
                    raise NotAllowed(f"joint.{key}", getattr(joint, key), code="clearance_closes", inner="pad",
                                     outer="slot", at_K=change)
        if joint.clearance_minus_m >= link.stress_free_length_m:
            raise NotAllowed("joint.clearance_minus_m", joint.clearance_minus_m, code="not_below_link_length",
                             stress_free_length_m=link.stress_free_length_m)
        rigidity = link.young_modulus_Pa * link.cross_section_area_m2
        if self.friction_force_N >= rigidity:
            raise NotAllowed("joint.friction_coefficient", joint.friction_coefficient, code="friction_above_rigidity",
                             friction_force_N=self.friction_force_N, rigidity=rigidity)
        if self.friction_force_N + abs(joint.preload_force_N) >= rigidity:
            raise NotAllowed("joint.preload_force_N", joint.preload_force_N, code="preload_above_rigidity",
                             friction_force_N=self.friction_force_N, rigidity=rigidity)
        if joint.play_m and not self.friction_force_N:
            raise NotAllowed("joint.play_m", joint.play_m, code="play_without_friction",
                             needed_keys="joint.friction_coefficient above 0")
        if joint.stop_stiffness_N_per_m is not None:
            for key in ("pad_thermal_expansion_per_K", "slot_thermal_expansion_per_K"):
                if getattr(joint, key):
                    raise NotAllowed(f"joint.{key}", getattr(joint, key), code="soft_stop_expansion")
        if self.dem_settings.time_step_s is not None:
            stable = stable_step.stable_time_step(self)
            if self.dem_settings.time_step_s > stable:
                raise NotAllowed("dem.time_step_s", self.dem_settings.time_step_s, code="above_stable_time_step",
                                 stable_s=stable)
