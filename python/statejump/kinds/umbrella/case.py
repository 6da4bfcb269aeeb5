# SPDX-License-Identifier: GPL-3.0-or-later
"""Cases of kind ``umbrella``: one rib of the umbrella antenna, the paper's section 4.

Links AB and BC are pinned to the frame at A = (0, 0) and C = (length_m, 0). At B the journal of BC
plays in the bearing of AB. Angles are anticlockwise from AC: theta2 of AB from A to B, theta4 of BC
from C to B; the flare angle is theta4 - theta2.
"""
from __future__ import annotations

from math import atan, atan2, pi, sqrt
from typing import ClassVar

from pydantic import Field

from statejump import _engine, laws
from statejump.schema.fields import CHOICE, Case, Section, Thermal, check_radii, choice, no_length_left, parameter

PAPER = "Chen et al. (2021), Tables 2 and 3"
NONE = "none in the paper's case"


class Frame(Section):
    """What carries the pins; it does not expand."""

    length_m: float = parameter(..., "m", 0, 1e3, PAPER + ": |AC|", above=True)


class UmbrellaLink(Section):
    """A bar pinned to the frame at one end; it also gives its half of the joint its material."""

    mass_kg: float = parameter(..., "kg", 0, 1e6, PAPER, above=True)
    young_modulus_Pa: float = parameter(..., "Pa", 0, 1e13, PAPER, above=True)
    stress_free_length_m: float = parameter(..., "m", 0, 1e3, PAPER, above=True)
    cross_section_area_m2: float = parameter(..., "m2", 0, 1e2, CHOICE + ": as Table 1", above=True)
    thermal_expansion_per_K: float = parameter(..., "1/K", -1e-3, 1e-3, PAPER)
    poisson_ratio: float = parameter(0.3, "-", -0.99, 0.49, PAPER)


class UmbrellaJoint(Section):
    """The clearance joint at B and its contact laws; names are those of the engine's catalogue."""

    journal_radius_m: float = parameter(..., "m", 0, 1e2, PAPER + ", read as radius", above=True)
    radial_clearance_m: float = parameter(..., "m", 0, 1e2, PAPER, above=True)
    journal_thermal_expansion_per_K: float = parameter(0.0, "1/K", -1e-3, 1e-3, "eq. 12: constant")
    bearing_thermal_expansion_per_K: float = parameter(0.0, "1/K", -1e-3, 1e-3, "eq. 12: constant")
    normal_law: str = choice(
        "hertz_internal", laws.names("normal"), CHOICE + "; it prints hertz_paper"
    )
    dissipation_law: str = choice("none", laws.names("dissipation"), "eq. 6: none")
    friction_law: str = choice(
        "mindlin", laws.names("friction"), CHOICE + "; its ambrosio holds no static load"
    )
    tangential_velocity: str = choice(
        "material", laws.names("tangential_velocity"), CHOICE + "; eqs 14-16 are paper"
    )
    friction_coefficient: float = parameter(..., "-", 0, 10, PAPER)
    restitution: float = parameter(1.0, "-", 0, 1, CHOICE + "; dissipation laws only", above=True)
    smallest_impact_speed_m_per_s: float = parameter(
        1e-6, "m/s", 0, 1e3, CHOICE + "; floor of the speed that scales dissipation", above=True
    )
    friction_v0_m_per_s: float = parameter(0.0, "m/s", 0, 1e3, CHOICE + "; ambrosio only")
    friction_v1_m_per_s: float = parameter(
        1e-3, "m/s", 0, 1e3, CHOICE + "; ambrosio only", above=True
    )
    contact_length_m: float = parameter(0.01, "m", 0, 1e2, CHOICE + "; line contacts only", above=True)


class TorsionSpring(Section):
    """Spring (17) on the flare angle between the links."""

    stiffness_N_m_per_rad: float = parameter(0.0, "N m/rad", 0, 1e12, NONE)
    bias_rad: float = parameter(0.0, "rad", -pi, pi, "eq. 17: free at the ideal position")


class Damping(Section):
    """Damping outside of the contact."""

    axial_damping_ratio: float = parameter(0.0, "-", 0, 10, NONE)
    pin_damping_N_m_s_per_rad: float = parameter(0.0, "N m s/rad", 0, 1e9, NONE)


class UmbrellaThermal(Thermal):
    """The temperature program of both links."""

    period_s: float = parameter(1.0, "s", 0, 1e6, CHOICE, above=True)


class Start(Section):
    """State at t = 0: links at rest, links that follow their expansion, or loaded equilibrium."""

    mode: str = choice("rest", ("rest", "matched", "loaded"), "the paper starts from rest")
    eccentricity_m: float = parameter(0.0, "m", 0, 1e2, "the paper starts concentric")
    eccentricity_angle_rad: float = parameter(0.0, "rad", -2 * pi, 2 * pi, CHOICE + ": from AC")
    contact_angle_rad: float = parameter(0.0, "rad", -pi / 2, pi / 2, CHOICE + ": from AC; loaded")


class Output(Section):
    """What both models write."""

    samples_per_cycle: int = parameter(2000, "-", 10, 1_000_000, CHOICE)


class Reduced(Section):
    """How the reduced model is integrated."""

    method: str = choice("rk4", ("rk4", "adaptive"), CHOICE)
    steps_per_cycle: int = parameter(100_000, "-", 10, 1_000_000_000, "the paper's number")
    relative_tolerance: float = parameter(1e-10, "-", 1e-14, 0.01, CHOICE + "; adaptive only")


class UmbrellaDem(Section):
    """How the DEM is integrated."""

    steps_per_cycle: int = parameter(100_000, "-", 10, 1_000_000_000, "as the reduced model")
    threads: int = parameter(1, "-", 1, 1024, CHOICE)


class Ensemble(Section):
    """Runs from slightly different starts: without damping the motion is chaotic."""

    reduced_runs: int = parameter(100, "-", 1, 1_000_000, CHOICE)
    dem_runs: int = parameter(30, "-", 1, 1_000_000, CHOICE)
    reduced_steps_per_cycle: int = parameter(100_000, "-", 10, 1_000_000_000, "the paper's number")
    dem_steps_per_cycle: int = parameter(
        400_000, "-", 10, 1_000_000_000, CHOICE + ": leapfrog keeps the links' phase less well"
    )
    start_spread_m: float = parameter(1e-9, "m", 0, 1e2, CHOICE + ": around the start", above=True)
    seed: int = parameter(1, "-", 0, 2**31 - 1, CHOICE)


class UmbrellaTolerance(Section):
    """How close the two models must be for ``compare`` to pass."""

    first_contact_reduced_K: float = parameter(1e-6, "K", 0, 1e3, CHOICE, above=True)
    first_contact_dem_K: float = parameter(1e-3, "K", 0, 1e3, CHOICE, above=True)
    final_theta2_rad: float = parameter(1e-6, "rad", 0, 1, CHOICE, above=True)
    history_relative: float = parameter(0.01, "-", 0, 1, CHOICE, above=True)
    energy_balance_relative: float = parameter(0.001, "-", 0, 1, CHOICE, above=True)


class UmbrellaCase(Case):
    """One rib of the umbrella antenna, the paper's section 4."""

    KIND: ClassVar[str] = "umbrella"

    frame: Frame
    link_ab: UmbrellaLink
    link_bc: UmbrellaLink
    joint: UmbrellaJoint
    torsion_spring: TorsionSpring = Field(default_factory=TorsionSpring)
    damping: Damping = Field(default_factory=Damping)
    thermal: UmbrellaThermal
    start: Start = Field(default_factory=Start)
    output: Output = Field(default_factory=Output)
    reduced: Reduced = Field(default_factory=Reduced)
    dem: UmbrellaDem = Field(default_factory=UmbrellaDem)
    ensemble: Ensemble = Field(default_factory=Ensemble)
    tolerance: UmbrellaTolerance = Field(default_factory=UmbrellaTolerance)

    @property
    def period_s(self) -> float:
        """Length of one cycle [s]."""
        return self.thermal.period_s

    @property
    def samples_per_cycle(self) -> int:
        """Samples per cycle of both models."""
        return self.output.samples_per_cycle

    @property
    def bearing_radius_m(self) -> float:
        """Radius R2 of the bearing at ΔT = 0 [m]."""
        return self.joint.journal_radius_m + self.joint.radial_clearance_m

    def clearance_m(self, temperature_change_K: float) -> float:
        """Return the radial clearance [m] at ΔT; both radii expand from the total ΔT."""
        joint = self.joint
        return joint.radial_clearance_m + temperature_change_K * (
            joint.bearing_thermal_expansion_per_K * self.bearing_radius_m
            - joint.journal_thermal_expansion_per_K * joint.journal_radius_m
        )

    def _link_lengths_m(self, temperature_change_K: float) -> tuple[float, float]:
        ab, bc = (
            link.stress_free_length_m * (1 + link.thermal_expansion_per_K * temperature_change_K)
            for link in (self.link_ab, self.link_bc)
        )
        return ab, bc

    @property
    def ideal_position_m(self) -> tuple[float, float]:
        """Where the unstrained links meet at ΔT = 0, above AC: x and y of B [m]."""
        ab, bc = self._link_lengths_m(0.0)
        frame = self.frame.length_m
        x = (frame + (ab - bc) * (ab + bc) / frame) / 2
        # Heron's product: no difference of squares.
        product = (ab + bc + frame) * (ab + bc - frame) * (frame + ab - bc) * (frame - ab + bc)
        return x, sqrt(max(product, 0.0)) / (2 * frame)

    @property
    def theta2_rad(self) -> float:
        """Direction of AB, from A to B, at the ideal position [rad]."""
        x, y = self.ideal_position_m
        return atan2(y, x)

    @property
    def theta4_rad(self) -> float:
        """Direction of BC, from C to B, at the ideal position [rad]."""
        x, y = self.ideal_position_m
        return atan2(y, x - self.frame.length_m)

    @property
    def flare_angle_rad(self) -> float:
        """theta4 - theta2 at the ideal position [rad], in (0, pi)."""
        return self.theta4_rad - self.theta2_rad

    @property
    def free_flare_angle_rad(self) -> float:
        """Flare angle at which the torsion spring is free [rad]."""
        return self.flare_angle_rad + self.torsion_spring.bias_rad

    @property
    def effective_young_modulus_Pa(self) -> float:
        """E* of the contact [Pa]."""
        ab, bc = self.link_ab, self.link_bc
        return _engine.effective_young_modulus_Pa(
            ab.young_modulus_Pa, ab.poisson_ratio, bc.young_modulus_Pa, bc.poisson_ratio
        )

    def problem(self) -> str | None:
        """Return what is wrong between several keys, without the file's name."""
        return (
            self._geometry_problem()
            or self._joint_problem()
            or self._start_problem()
            or self._run_problem()
        )

    def _geometry_problem(self) -> str | None:
        for section in ("link_ab", "link_bc"):
            expansion = getattr(self, section).thermal_expansion_per_K
            problem = no_length_left(f"{section}.thermal_expansion_per_K", expansion, self)
            if problem is not None:
                return problem
        frame = self.frame.length_m
        # The sum is linear in ΔT and the difference convex: the ends of the program decide.
        for change in (0.0, *self.temperature_range_K):
            ab, bc = self._link_lengths_m(change)
            if not abs(ab - bc) < frame < ab + bc:
                return (
                    f"frame.length_m = {frame!r} is not allowed: must be above {abs(ab - bc):.9g} and below "
                    f"{ab + bc:.9g} [m], or the links cannot meet at a temperature change of {change:g} K"
                )
        flare, bias = self.flare_angle_rad, self.torsion_spring.bias_rad
        if not 0 < flare + bias < pi:
            return (
                f"torsion_spring.bias_rad = {bias!r} is not allowed: must be above {-flare:.9g} and below "
                f"{pi - flare:.9g} [rad], so that the free flare angle lies between 0 and pi"
            )
        return None

    def _joint_problem(self) -> str | None:
        joint = self.joint
        try:
            check_radii(self.bearing_radius_m, joint.journal_radius_m)
        except ValueError:
            return (
                f"joint.radial_clearance_m = {joint.radial_clearance_m!r} is not allowed: too small beside "
                f"joint.journal_radius_m = {joint.journal_radius_m!r} [m], the radii come out equal"
            )
        for part in ("journal", "bearing"):
            expansion = getattr(joint, f"{part}_thermal_expansion_per_K")
            for change in self.temperature_range_K:
                if 1 + expansion * change <= 0:
                    return (
                        f"joint.{part}_thermal_expansion_per_K = {expansion!r} is not allowed: the {part} "
                        f"has no radius left at a temperature change of {change:g} K"
                    )
        for change in self.temperature_range_K:
            if not self.clearance_m(change) > 0:
                return (
                    f"joint.radial_clearance_m = {joint.radial_clearance_m!r} is not allowed: the expansion "
                    f"of journal and bearing closes it at a temperature change of {change:g} K, it must stay "
                    "above 0 [m] within the program"
                )
        if joint.friction_v1_m_per_s <= joint.friction_v0_m_per_s:
            return (
                f"joint.friction_v1_m_per_s = {joint.friction_v1_m_per_s!r} is not allowed: must be above "
                f"joint.friction_v0_m_per_s = {joint.friction_v0_m_per_s!r} [m/s]"
            )
        return None

    def _start_problem(self) -> str | None:
        start, joint = self.start, self.joint
        if start.mode != "loaded":
            if start.contact_angle_rad != 0:
                return (
                    f"start.contact_angle_rad = {start.contact_angle_rad!r} is not allowed: "
                    "only with start.mode = 'loaded'"
                )
            if start.eccentricity_m > joint.radial_clearance_m:
                return (
                    f"start.eccentricity_m = {start.eccentricity_m!r} is not allowed: must be between 0 and "
                    f"joint.radial_clearance_m = {joint.radial_clearance_m!r} [m], beyond it the joint starts "
                    "in deep penetration"
                )
        else:
            for key in ("eccentricity_m", "eccentricity_angle_rad"):
                if getattr(start, key) != 0:
                    return (
                        f"start.{key} = {getattr(start, key)!r} is not allowed with start.mode = 'loaded': "
                        "equilibrium decides"
                    )
            spring = self.torsion_spring
            for key in ("stiffness_N_m_per_rad", "bias_rad"):
                if getattr(spring, key) == 0:
                    return (
                        f"start.mode = 'loaded' is not allowed: torsion_spring.{key} is 0, and only a biased "
                        "torsion spring loads the joint"
                    )
            holds = laws.law("friction", joint.friction_law).holds_static_load
            largest = atan(joint.friction_coefficient) if holds else 0.0
            if abs(start.contact_angle_rad) > largest:
                rule = (
                    f"between {-largest:.9g} and {largest:.9g} [rad], atan of joint.friction_coefficient"
                    if largest else "0 [rad]: this friction holds no static load"
                )
                return f"start.contact_angle_rad = {start.contact_angle_rad!r} is not allowed: must be {rule}"
        if self.ensemble.start_spread_m > joint.radial_clearance_m:
            return (
                f"ensemble.start_spread_m = {self.ensemble.start_spread_m!r} is not allowed: must be above 0 and "
                f"at most joint.radial_clearance_m = {joint.radial_clearance_m!r} [m]"
            )
        return None

    def _run_problem(self) -> str | None:
        friction = self.joint.friction_law
        if self.reduced.method == "adaptive" and laws.law("friction", friction).has_memory:
            return (
                f"reduced.method = 'adaptive' is not allowed with joint.friction_law = {friction!r}: friction with "
                "memory is not smooth, use 'rk4'"
            )
        samples = self.output.samples_per_cycle
        for section, key in (
            ("reduced", "steps_per_cycle"),
            ("dem", "steps_per_cycle"),
            ("ensemble", "reduced_steps_per_cycle"),
            ("ensemble", "dem_steps_per_cycle"),
        ):
            steps = getattr(getattr(self, section), key)
            if steps % samples != 0:
                return (
                    f"{section}.{key} = {steps} is not allowed: must be a multiple of "
                    f"output.samples_per_cycle = {samples}"
                )
        return None
