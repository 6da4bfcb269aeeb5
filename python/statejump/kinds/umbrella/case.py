# SPDX-License-Identifier: GPL-3.0-or-later
"""Cases of kind ``umbrella``: one rib of the umbrella antenna (section 4 of the paper).

Links AB and BC are pinned to the frame at A = (0, 0) and C = (length_m, 0). At B the journal of BC has clearance in the
bearing of AB. Angles are anticlockwise from AC: theta2 of AB from A to B, theta4 of BC from C to B; the flare angle is
theta4 - theta2.
"""
from __future__ import annotations

from math import atan, atan2, pi
from typing import Any, ClassVar

import numpy as np

from statejump import _engine, laws
from statejump.core import plausibility, yade_process
from statejump.core.case import Case, check_radii, no_length_left
from statejump.core.errors import NotAllowed
from statejump.core.physics import apex_m
from statejump.core.start import FRICTIONLESS, start_friction
from statejump.schema.fields import CHOICE, Section, choice, definition, parameter, section, whole

PAPER = "Chen et al. (2021), Tables 2 and 3"
NONE = "none in the paper's case"


@definition
class Frame(Section):
    """The frame of the pins; it does not expand."""

    length_m: float = parameter(..., "m", 0, 1e3, PAPER + ": |AC|", above=True)


@definition
class UmbrellaLink(Section):
    """A bar pinned to the frame at one end; its half of the joint is of its material."""

    mass_kg: float = parameter(..., "kg", 0, 1e6, PAPER, above=True)
    young_modulus_Pa: float = parameter(..., "Pa", 0, 1e13, PAPER, above=True)
    stress_free_length_m: float = parameter(..., "m", 0, 1e3, PAPER, above=True)
    cross_section_area_m2: float = parameter(..., "m2", 0, 1e2, CHOICE + ": as Table 1", above=True)
    thermal_expansion_per_K: float = parameter(..., "1/K", -1e-3, 1e-3, PAPER)
    poisson_ratio: float = parameter(0.3, "-", -0.99, 0.49, PAPER)


@definition
class UmbrellaJoint(Section):
    """The clearance joint at B and its contact laws; names are those of the engine's catalogue."""

    journal_radius_m: float = parameter(..., "m", 0, 1e2, PAPER + ", read as radius", above=True)
    radial_clearance_m: float = parameter(..., "m", 0, 1e2, PAPER, above=True)
    journal_thermal_expansion_per_K: float = parameter(0.0, "1/K", -1e-3, 1e-3, "eq. 12: constant")
    bearing_thermal_expansion_per_K: float = parameter(0.0, "1/K", -1e-3, 1e-3, "eq. 12: constant")
    normal_law: str = choice(
        "hertz_internal", lambda: laws.names("normal"), CHOICE + "; it prints hertz_paper"
    )
    dissipation_law: str = choice("none", lambda: laws.names("dissipation"), "eq. 6: none")
    friction_law: str = choice(
        "mindlin", lambda: laws.names("friction"), CHOICE + "; its ambrosio holds no static load"
    )
    tangential_velocity: str = choice(
        "material", lambda: laws.names("tangential_velocity"), CHOICE + "; eqs 14-16 are paper"
    )
    friction_coefficient: float = parameter(..., "-", 0, 10, PAPER)
    restitution: float = parameter(1.0, "-", 0, 1, CHOICE + "; dissipation laws only, 0 with exact_restitution")
    smallest_impact_speed_m_per_s: float = parameter(
        1e-6, "m/s", 0, 1e3, CHOICE + "; floor of the speed that scales dissipation", above=True
    )
    friction_v0_m_per_s: float = parameter(0.0, "m/s", 0, 1e3, CHOICE + "; ambrosio only")
    friction_v1_m_per_s: float = parameter(
        1e-3, "m/s", 0, 1e3, CHOICE + "; ambrosio only", above=True
    )
    contact_length_m: float = parameter(0.01, "m", 0, 1e2, CHOICE + "; line contacts only", above=True)


@definition
class TorsionSpring(Section):
    """Spring (17) on the flare angle between the links."""

    stiffness_N_m_per_rad: float = parameter(0.0, "N m/rad", 0, 1e12, NONE)
    bias_rad: float = parameter(0.0, "rad", -pi, pi, "eq. 17: free at the ideal position")


@definition
class Damping(Section):
    """Damping outside of the contact."""

    axial_damping_ratio: float = parameter(0.0, "-", 0, 10, NONE)
    pin_damping_N_m_s_per_rad: float = parameter(0.0, "N m s/rad", 0, 1e9, NONE)


@definition
class Start(Section):
    """State at t = 0: links at rest, links that follow their expansion, or loaded equilibrium."""

    mode: str = choice("rest", ("rest", "matched", "loaded"), "the paper starts from rest")
    eccentricity_m: float = parameter(0.0, "m", 0, 1e2, "the paper starts concentric")
    eccentricity_angle_rad: float = parameter(0.0, "rad", -2 * pi, 2 * pi, CHOICE + ": from AC")
    contact_angle_rad: float = parameter(0.0, "rad", -pi / 2, pi / 2, CHOICE + ": from AC; loaded")
    friction: str = start_friction()


@definition
class Output(Section):
    """What both models write."""

    samples_per_cycle: int = whole(2000, 10, 1_000_000, CHOICE)


@definition
class Reduced(Section):
    """How the reduced model is integrated."""

    method: str = choice("rk4", ("rk4", "adaptive"), CHOICE)
    steps_per_cycle: int = whole(100_000, 10, 1_000_000_000, "the paper's number")
    relative_tolerance: float = parameter(1e-10, "-", 1e-14, 0.01, CHOICE + "; adaptive only")


@definition
class UmbrellaDem(Section):
    """How the DEM is integrated."""

    steps_per_cycle: int = whole(100_000, 10, 1_000_000_000, "as the reduced model")
    threads: int = whole(1, 1, 1024, CHOICE)
    stepper: str = yade_process.stepper()


@definition
class Ensemble(Section):
    """Runs from slightly different starts: without damping the motion is chaotic."""

    reduced_runs: int = whole(100, 1, 1_000_000, CHOICE)
    dem_runs: int = whole(30, 1, 1_000_000, CHOICE)
    reduced_steps_per_cycle: int = whole(100_000, 10, 1_000_000_000, "the paper's number")
    dem_steps_per_cycle: int = whole(
        400_000, 10, 1_000_000_000, CHOICE + ": leapfrog keeps the links' phase less well"
    )
    start_spread_m: float = parameter(1e-9, "m", 0, 1e2, CHOICE + ": around the start", above=True)
    seed: int = whole(1, 0, 2**31 - 1, CHOICE)


@definition
class UmbrellaTolerance(Section):
    """Allowed differences between the two models in ``compare``."""

    first_contact_reduced_K: float = parameter(1e-6, "K", 0, 1e3, CHOICE, above=True)
    first_contact_dem_K: float = parameter(1e-3, "K", 0, 1e3, CHOICE, above=True)
    final_theta2_rad: float = parameter(1e-6, "rad", 0, 1, CHOICE, above=True)
    history_relative: float = parameter(0.01, "-", 0, 1, CHOICE, above=True)
    energy_balance_relative: float = parameter(0.001, "-", 0, 1, CHOICE, above=True)


@definition
class UmbrellaCase(Case):
    """One rib of the umbrella antenna (section 4 of the paper)."""

    KIND: ClassVar[str] = "umbrella"

    frame: Frame = section(Frame, required=True)
    link_ab: UmbrellaLink = section(UmbrellaLink, required=True)
    link_bc: UmbrellaLink = section(UmbrellaLink, required=True)
    joint: UmbrellaJoint = section(UmbrellaJoint, required=True)
    torsion_spring: TorsionSpring = section(TorsionSpring)
    damping: Damping = section(Damping)
    start: Start = section(Start)
    output: Output = section(Output)
    reduced_settings: Reduced = section(Reduced, name="reduced")
    dem_settings: UmbrellaDem = section(UmbrellaDem, name="dem")
    ensemble: Ensemble = section(Ensemble)
    tolerance: UmbrellaTolerance = section(UmbrellaTolerance)

    @property
    def samples_per_cycle(self) -> int:
        """Samples per cycle of both models."""
        return self.output.samples_per_cycle

    @property
    def bearing_radius_m(self) -> float:
        """Radius R2 of the bearing at ΔT = 0 [m]."""
        return self.joint.journal_radius_m + self.joint.radial_clearance_m

    def clearance_m(self, temperature_change_K: float) -> float:
        """Return the radial clearance [m] at ΔT. Both radii expand with the full ΔT."""
        joint = self.joint
        return joint.radial_clearance_m + temperature_change_K * (
            joint.bearing_thermal_expansion_per_K * self.bearing_radius_m
            - joint.journal_thermal_expansion_per_K * joint.journal_radius_m
        )

    def link_lengths_m(self, temperature_change_K: Any) -> tuple[Any, Any]:
        """Return the stress-free lengths of AB and BC [m] at ΔT. ΔT is a number or an array."""
        ab, bc = (
            link.stress_free_length_m * (1 + link.thermal_expansion_per_K * temperature_change_K)
            for link in (self.link_ab, self.link_bc)
        )
        return ab, bc

    @property
    def ideal_position_m(self) -> tuple[float, float]:
        """Ideal position: x and y [m] of the point above AC at which the unloaded links AB and BC meet at ΔT = 0."""
        x, y = apex_m(*self.link_lengths_m(0.0), self.frame.length_m)
        return float(x), float(y)

    @property
    def theta2_rad(self) -> float:
        """Direction of AB, from A to B, if B is at the ideal position [rad]."""
        x, y = self.ideal_position_m
        return atan2(y, x)

    @property
    def theta4_rad(self) -> float:
        """Direction of BC, from C to B, if B is at the ideal position [rad]."""
        x, y = self.ideal_position_m
        return atan2(y, x - self.frame.length_m)

    @property
    def flare_angle_rad(self) -> float:
        """theta4 - theta2 at the ideal position [rad], in (0, pi)."""
        return self.theta4_rad - self.theta2_rad

    @property
    def free_flare_angle_rad(self) -> float:
        """Flare angle at which the torsion spring has no moment [rad]."""
        return self.flare_angle_rad + self.torsion_spring.bias_rad

    @property
    def implausible(self) -> tuple[str, ...]:
        names, links, joint = ("AB", "BC"), (self.link_ab, self.link_bc), self.joint
        modulus = np.array([link.young_modulus_Pa for link in links])
        change = max(abs(end) for end in self.temperature_range_K)
        strain = np.array([abs(link.thermal_expansion_per_K) for link in links]) * change
        return (*plausibility.clearances("joint", ["B"], np.array([joint.radial_clearance_m]),
                                         np.array([joint.journal_radius_m])),
                *plausibility.moduli("link", names, modulus), *plausibility.strains("link", names, strain, "thermal"))

    @property
    def is_reproducible(self) -> bool:
        """Whether the whole history can be compared point by point; otherwise only heating can. Damping of links and
        pins makes small differences decay; without it they grow to the size of the clearance."""
        return self.damping.axial_damping_ratio > 0 and self.damping.pin_damping_N_m_s_per_rad > 0

    @property
    def effective_young_modulus_Pa(self) -> float:
        """E* of the contact [Pa]."""
        ab, bc = self.link_ab, self.link_bc
        return _engine.effective_young_modulus_Pa(
            ab.young_modulus_Pa, ab.poisson_ratio, bc.young_modulus_Pa, bc.poisson_ratio
        )

    def check(self) -> None:
        """Raise StatejumpError for a contradiction between several keys."""
        self._check_laws()
        self._check_geometry()
        self._check_joint()
        self._check_start()
        self._check_run()

    def _check_geometry(self) -> None:
        for part in ("link_ab", "link_bc"):
            no_length_left(f"{part}.thermal_expansion_per_K", getattr(self, part).thermal_expansion_per_K, self)
        frame = self.frame.length_m
        # The sum of lengths is linear in ΔT and the difference convex, so the ends of the program are decisive.
        for change in (0.0, *self.temperature_range_K):
            ab, bc = self.link_lengths_m(change)
            if not abs(ab - bc) < frame < ab + bc:
                raise NotAllowed("frame.length_m", frame, code="links_cannot_meet", least=abs(ab - bc), most=ab + bc,
                                 at_K=change)
        flare, bias = self.flare_angle_rad, self.torsion_spring.bias_rad
        if not 0 < flare + bias < pi:
            raise NotAllowed("torsion_spring.bias_rad", bias, code="bias_out_of_range", least=-flare, most=pi - flare)

    def _check_laws(self) -> None:
        for kind, key in (("normal", "normal_law"), ("dissipation", "dissipation_law"), ("friction", "friction_law"),
                          ("tangential_velocity", "tangential_velocity")):
            name = getattr(self.joint, key)
            problem = _engine.law_problem(kind, name)
            if problem:  # a user law that exists but is unusable
                raise NotAllowed(f"joint.{key}", name, problem, code="bad_law")
        dissipation = laws.law("dissipation", self.joint.dissipation_law)
        may_be_zero = any(p.name == "restitution" and p.allows(0) for p in dissipation.parameters)
        if self.joint.restitution == 0 and not may_be_zero:
            raise NotAllowed("joint.restitution", self.joint.restitution, code="restitution_zero", law=dissipation.name)
        friction = laws.law("friction", self.joint.friction_law)
        if friction.needs_point_contact and not laws.law("normal", self.joint.normal_law).point_contact:
            points = ", ".join(law.name for law in laws.catalogue("normal") if law.point_contact)
            raise NotAllowed("joint.normal_law", self.joint.normal_law, code="law_not_with_friction", law=friction.name,
                             known=points)

    def _check_joint(self) -> None:
        joint = self.joint
        clearance = joint.radial_clearance_m
        if not check_radii(self.bearing_radius_m, joint.journal_radius_m):
            raise NotAllowed("joint.radial_clearance_m", clearance, code="clearance_below_precision",
                             radius_key="joint.journal_radius_m", radius_m=joint.journal_radius_m)
        for part in ("journal", "bearing"):
            expansion = getattr(joint, f"{part}_thermal_expansion_per_K")
            for change in self.temperature_range_K:
                if 1 + expansion * change <= 0:
                    raise NotAllowed(f"joint.{part}_thermal_expansion_per_K", expansion, code="no_radius_left",
                                     part=part, at_K=change)
        for change in self.temperature_range_K:
            if not self.clearance_m(change) > 0:
                raise NotAllowed("joint.radial_clearance_m", clearance, code="clearance_closes", inner="journal",
                                 outer="bearing", at_K=change)
        if joint.friction_v1_m_per_s <= joint.friction_v0_m_per_s:
            raise NotAllowed("joint.friction_v1_m_per_s", joint.friction_v1_m_per_s,
                             code="friction_velocities_unordered", friction_v0_m_per_s=joint.friction_v0_m_per_s)

    def _check_start(self) -> None:
        start, clearance = self.start, self.joint.radial_clearance_m
        if start.mode == "loaded":
            self._check_loaded()
        elif start.contact_angle_rad != 0:
            raise NotAllowed("start.contact_angle_rad", start.contact_angle_rad, code="requires_loaded_start")
        elif start.eccentricity_m > clearance:
            raise NotAllowed("start.eccentricity_m", start.eccentricity_m, code="exceeds_clearance",
                             clearance=clearance)
        if self.ensemble.start_spread_m > clearance:
            raise NotAllowed("ensemble.start_spread_m", self.ensemble.start_spread_m,
                             code="not_above_zero_to_clearance", clearance=clearance)

    def _check_loaded(self) -> None:
        start, joint, spring = self.start, self.joint, self.torsion_spring
        for key in ("eccentricity_m", "eccentricity_angle_rad"):
            if getattr(start, key) != 0:
                raise NotAllowed(f"start.{key}", getattr(start, key), code="set_by_equilibrium")
        for key in ("stiffness_N_m_per_rad", "bias_rad"):
            if getattr(spring, key) == 0:
                raise NotAllowed("start.mode", start.mode, code="spring_without_preload", spring_key=key)
        if start.friction == FRICTIONLESS and start.contact_angle_rad != 0:
            raise NotAllowed("start.contact_angle_rad", start.contact_angle_rad, code="angle_without_friction")
        holds = laws.law("friction", joint.friction_law).holds_static_load
        largest = atan(joint.friction_coefficient) if holds else 0.0
        if abs(start.contact_angle_rad) > largest:
            if not largest:
                raise NotAllowed("start.contact_angle_rad", start.contact_angle_rad,
                                 code="friction_without_static_load")
            raise NotAllowed("start.contact_angle_rad", start.contact_angle_rad, code="angle_outside_friction_cone",
                             least_rad=-largest, largest_rad=largest)

    def _check_run(self) -> None:
        if self.reduced_settings.method == "adaptive" and laws.law("friction", self.joint.friction_law).has_memory:
            raise NotAllowed("reduced.method", "adaptive", code="adaptive_with_memory", law=self.joint.friction_law)
        samples = self.output.samples_per_cycle
        for part, key in (
            ("reduced", "steps_per_cycle"),
            ("dem", "steps_per_cycle"),
            ("ensemble", "reduced_steps_per_cycle"),
            ("ensemble", "dem_steps_per_cycle"),
        ):
            steps = getattr(self.value_named(part), key)
            if steps % samples != 0:
                raise NotAllowed(f"{part}.{key}", steps, code="not_multiple_of_samples", samples=samples)
