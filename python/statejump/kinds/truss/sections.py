# SPDX-License-Identifier: GPL-3.0-or-later
"""Sections and keys of cases of kind ``truss``: bars, frictional joints and springs, planar or spatial.

One file describes the truss for all models. Items have names and refer to each other by name; :class:`.case.TrussCase`
turns names into indices and keys into arrays.
"""
from __future__ import annotations

from typing import Any, ClassVar

from statejump.core import thermal as core_thermal
from statejump.core import yade_process
from statejump.core.case import Case
from statejump.core.expansion import Expansion
from statejump.core.start import Start
from statejump.core.temperature_files import Histories
from statejump.core.thermal import CaseThermal, MemberProgram, Numbers, Thermal, returns_s
from statejump.kinds.truss.constraints import AXES, Constraint
from statejump.kinds.truss.elements import ElementLists
from statejump.kinds.truss.joints import JointLists
from statejump.kinds.truss.joints.protocol import ALUMINIUM, USER
from statejump.kinds.truss.means import Mean
from statejump.kinds.truss.mechanism import Drive
from statejump.kinds.truss.resolved import FIXITY, STICKING
from statejump.schema.fields import (
    CHOICE, Section, attached, choice, definition, fields_of, numbers, optional_section, parameter, section,
    section_class, switch, tables, text, texts, whole,
)
from statejump.schema.items import Item

LARGEST_LENGTH_M = 1e6
MOST_EXPANSION_PER_K = 1e-3
MOST_DENSITY_KG_PER_M3 = 1e5


@definition
class Truss(Section):
    """Settings of the truss as a whole."""

    dimension: int = whole(..., 2, 3, "2: x and y; 3: x, y and z")
    gravity_m_per_s2: list[float] | None = numbers(None, "m/s2", -1e6, 1e6, "on all masses; none")
    free: bool = switch(False, "whether supports may be missing: natural frequencies only")


@definition
class Node(Item):
    """A point that moves, at which bars, joints and springs end. Positions are those at ΔT = 0."""

    position_m: list[float] = numbers(..., "m", -LARGEST_LENGTH_M, LARGEST_LENGTH_M, USER)
    fixed: list[str] = texts([], "directions without motion", AXES)
    guide_normal: list[float] | None = numbers(None, "-", -1e9, 1e9, "no motion along it; of any length")
    force_N: list[float] | None = numbers(None, "N", -1e12, 1e12, "dead load; none")
    fixed_rotations: list[str] = texts([], "axes about which it does not rotate; where beams end", AXES)
    moment_N_m: list[float] | None = numbers(
        None, "N m", -1e12, 1e12, "constant while it rotates about that axis; in a plane 1 number; where beams end")
    mass_kg: float = parameter(0.0, "kg", 0, 1e6, "of a body at it, as a piston, beside those of links; DEM and motion")


@definition
class Link(Item):
    """A straight bar between two nodes that carries axial force only."""

    nodes: list[str] = texts(..., "its two nodes")
    young_modulus_Pa: float = parameter(..., "Pa", 0, 1e13, USER, above=True)
    cross_section_area_m2: float = parameter(..., "m2", 0, 1e2, USER, above=True)
    thermal_expansion_per_K: float | None = parameter(None, "1/K", -MOST_EXPANSION_PER_K, MOST_EXPANSION_PER_K,
                                                      "this or expansion")
    expansion: str | None = text(None, "name of an [[expansion]]: a coefficient that follows the temperature")
    stress_free_length_m: float | None = parameter(
        None, "m", 0, LARGEST_LENGTH_M, "at ΔT = 0; the distance of its nodes", above=True
    )
    density_kg_per_m3: float | None = parameter(None, "kg/m3", 0, MOST_DENSITY_KG_PER_M3,
                                                "this or mass_kg; DEM and motion", above=True)
    mass_kg: float | None = parameter(None, "kg", 0, 1e6, "this or density_kg_per_m3; DEM and motion", above=True)
    centre_of_mass_m: list[float] | None = numbers(
        None, "m", -LARGEST_LENGTH_M, LARGEST_LENGTH_M,
        "of its mass_kg, from the first node along it and to its left; a rod's", length=2,
    )
    moment_of_inertia_kg_m2: float | None = parameter(None, "kg m2", 0, 1e12, "about its centre of mass; a rod's")
    poisson_ratio: float = parameter(0.3, "-", -0.99, 0.49, ALUMINIUM)
    ends: str = choice("pinned_pinned", tuple(FIXITY), "axial force only; for the warning of buckling")
    second_moment_of_area_m4: float | None = parameter(
        None, "m4", 0, 1e3, "smallest; of a square section; for the warning of buckling", above=True
    )
    yield_strength_Pa: float | None = parameter(None, "Pa", 0, 1e12, "stress is not checked", above=True)
    temperature_fraction: float = parameter(1.0, "-", -10, 10, "of its program's ΔT; fully sunlit")
    program: str | None = text(None, "name of a [[program]]; the common [thermal]")


@definition
class TrussExpansion(Item, Expansion):
    """A temperature-dependent coefficient of thermal expansion, for links that refer to its name."""


@definition
class TrussThermal(CaseThermal):
    """A temperature program, or a reference to the temperature histories of all members."""

    ONE_OF = {"shape": {"table": (*Thermal.ONE_OF["shape"]["table"], ("members_file",))}}

    members_file: str | None = text(None, "CSV or HDF5 file with a column for every link, beside the case file")
    members: Histories | None = attached("it is read from thermal.members_file")


@definition
class Program(Item, Thermal):
    """A further temperature program for links and joints that name it, with the duration of the common program."""

    cycles: int | None = whole(None, 1, 100_000, "as [thermal]")  # type: ignore[assignment]
    period_s: float | None = parameter(  # type: ignore[assignment]
        None, "s", 0, core_thermal.LONGEST_PERIOD_S, "as [thermal]; of a table its last time", above=True
    )

    def completed(self, common: TrussThermal) -> TrussThermal:
        """Return the program with missing cycles and period taken from the common program.

        :raises NotAllowed: the program is a table whose duration differs from ``period_s``
        """
        given = self.to_dict()
        del given["name"]
        table_s = core_thermal.period_of(common, None, "", common.period_s)
        lasts = core_thermal.period_of(self, self.period_s, "period_s", common.period_s, common.period_s - table_s)
        return TrussThermal(**{**given, "cycles": self.cycles or common.cycles, "period_s": lasts})


@definition
class Output(Section):
    """What both models write."""

    samples_per_cycle: int = whole(200, 10, 1_000_000, CHOICE)


def _beside(name: str) -> Any:
    return text(None, f"CSV or HDF5 file, in place of [[{name}]]")


Tables = section_class(
    "Tables", "Files beside the case file with one row an item and one column a key, in place of sections: large "
    "trusses.",
    {name: _beside(name) for name in ("node", "link", *fields_of(JointLists), *fields_of(ElementLists))})


def sections_in_files() -> tuple[str, ...]:
    """Return the lists of a truss whose items may be in files beside the case file."""
    return tuple(fields_of(Tables))


@definition
class TrussReduced(Section):
    """How the quasi-static solver follows the path."""

    increments_per_branch: int = whole(50, 1, 1_000_000, CHOICE)
    locate_events: bool = switch(True, "whether events are located between increments")
    sticking: str = choice("rigid", STICKING, "Coulomb's law; elastic: gives way by k_t, as in the DEM; partial_slip: "
                           "slides at its rim first, as in the DEM with dem.friction_law = 'mindlin_deresiewicz'")
    event_tolerance: float = parameter(1e-9, "-", 0, 0.1, CHOICE + "; of a branch", above=True)
    energy_tolerance: float = parameter(
        2.5e-11, "-", 0, 1, CHOICE + "; of the work of the temperature: increments that lose more are cut", above=True)


@definition
class TrussMotion(Section):
    """Time steps of a truss in motion: ``statejump reduced --dynamic``. Its dashpots are those of links, pins and
    contacts in [dem]."""

    scheme: str = choice("set_valued", ("set_valued", "regularised"),
                         "contacts as sets, implicit steps; regularised: the DEM's contacts, explicit steps")
    steps_per_cycle: int = whole(10_000, 10, 1_000_000_000, CHOICE)
    displacement_tolerance_m: float | None = parameter(
        None, "m", 0, LARGEST_LENGTH_M, "equal steps; else of a step, which is then as long as that allows", above=True)
    theta: float = parameter(0.5, "-", 0.5, 1, "second order, no numerical damping; 1: implicit Euler; of equal steps")
    restitution: float = parameter(0.0, "-", 0, 1, CHOICE + "; Newton's, of stops and of revolutes with rigid contact")
    masses: str = choice("consistent", ("consistent", "lumped"), "exact for bodies on links; lumped: as in the DEM")
    start: str = choice(
        "equilibrium", ("equilibrium", "drawn"), "at rest where the quasi-static path begins, or as drawn"
    )


@definition
class TrussDem(Section):
    """How the DEM is integrated."""

    time_step_fraction: float = parameter(0.1, "-", 0, 1.0, "of the stable step", above=True)
    link_damping_ratio: float = parameter(0.1, "-", 0, 10, CHOICE)
    contact_damping_ratio: float = parameter(0.1, "-", 0, 10, CHOICE)
    friction_law: str = choice("mindlin", ("mindlin", "mindlin_deresiewicz"), "a spring; it slides at its rim first")
    pin_damping_N_m_s_per_rad: float = parameter(0.0, "N m s/rad", 0, 1e9, CHOICE)
    threads: int = whole(1, 1, 1024, CHOICE)
    stepper: str = yade_process.stepper()


@definition
class Reflector(Section):
    """The nodes of a reflecting surface: its error is that against the best-fit paraboloid."""

    nodes: list[str] = texts([], "nodes of the surface")
    points: list[str] = texts([], "points of condensed bodies on it: BODY/POINT, or BODY for all its points")
    axis: list[float] = numbers(..., "-", -1e9, 1e9, "of the paraboloid; of any length")
    focal_length_m: float | None = parameter(None, "m", 0, LARGEST_LENGTH_M, "best fit", above=True)


@definition
class TrussTolerance(Section):
    """Allowed differences between the two models in ``compare``."""

    displacement_relative: float = parameter(0.01, "-", 0, 1, CHOICE, above=True)
    jump_relative: float = parameter(0.01, "-", 0, 1, CHOICE, above=True)
    force_relative: float = parameter(0.01, "-", 0, 1, CHOICE, above=True)
    energy_balance_relative: float = parameter(0.001, "-", 0, 1, CHOICE, above=True)


@definition
class TrussParts(Case):
    """The sections of a truss to which joints and elements refer."""

    truss: Truss = section(Truss, required=True)
    node: list[Node] = tables(Node, "sections [[node]]", required=True)
    link: list[Link] = tables(Link, "sections [[link]]")
    program: list[Program] = tables(Program, "sections [[program]]")
    expansion: list[TrussExpansion] = tables(TrussExpansion, "sections [[expansion]]")


@definition
class TrussSections(ElementLists, JointLists, TrussParts):
    """The sections of a truss with frictional and clearance joints under one or several temperature programs."""

    KIND: ClassVar[str] = "truss"

    constraint: list[Constraint] = tables(Constraint, "sections [[constraint]]")
    mean: list[Mean] = tables(Mean, "sections [[mean]]")
    drive: list[Drive] = tables(Drive, "sections [[drive]]")
    thermal: TrussThermal = section(TrussThermal, required=True)
    start: Start = section(Start)
    output: Output = section(Output)
    reduced_settings: TrussReduced = section(TrussReduced, name="reduced")
    motion: TrussMotion = section(TrussMotion)
    dem_settings: TrussDem = section(TrussDem, name="dem")
    reflector: Reflector | None = optional_section(Reflector)
    tolerance: TrussTolerance = section(TrussTolerance)
    tables: Section | None = optional_section(Tables)

    @property
    def samples_per_cycle(self) -> int:
        """Samples per cycle of both models."""
        return self.output.samples_per_cycle

    @property
    def member_histories(self) -> Histories | None:
        """Temperature histories of members, if the case refers to a file of them."""
        return self.thermal.members

    @property
    def programs(self) -> list[TrussThermal | MemberProgram]:
        """The temperature programs with cycles and period: the common program, named programs, those of members."""
        members = self.thermal.members
        of_members = [] if members is None else members.programs(self.thermal.cycles, self.period_s)
        return [self.thermal, *(program.completed(self.thermal) for program in self.program), *of_members]

    def _given_programs(self) -> list[Thermal | MemberProgram]:
        members, cycles = self.thermal.members, self.thermal.cycles
        of_members = [] if members is None else [members.furthest_at_end(cycles)]
        return [self.thermal, *self.program, *of_members]

    def returns_s(self) -> Numbers:
        """Return the times [s] at which the temperatures of all items have their initial values again."""
        return returns_s(self.programs, self.period_s)
