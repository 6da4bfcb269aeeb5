# SPDX-License-Identifier: GPL-3.0-or-later
"""Beams between two nodes, which they bend and rotate."""
from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from math import inf, nan
from typing import Any, ClassVar

import numpy as np

from statejump.core.errors import MissingKey, NotAllowed
from statejump.kinds.truss.arrays import References, column, given_or, having, pairs, unit, values, vectors
from statejump.kinds.truss.elements.beam_shapes import ECCENTRIC, SHAPES, Properties
from statejump.kinds.truss.elements.protocol import BetweenNodes, EndsArrays, Lines
from statejump.kinds.truss.joints.protocol import USER, ItemColumn
from statejump.kinds.truss.references import vector
from statejump.kinds.truss.resolved import ResolvedTruss
from statejump.schema.fields import choice, definition, numbers, parameter, text, texts
from statejump.schema.items import Item

VIOLET = "#5D3A9B"
GENERAL = "general"
LARGEST_LENGTH_M = 1e6
RELEASES = ("Fx", "Rx", "Ry", "Rz")  # in the order of the engine's flags
SECTION_KEYS = ("cross_section_area_m2", "second_moments_of_area_m4", "torsion_constant_m4")


@definition
class Beam(Item):
    """A straight beam that carries forces and moments between two nodes, and rotates them."""

    nodes: list[str] = texts(..., "its two nodes")
    young_modulus_Pa: float = parameter(..., "Pa", 0, 1e13, USER, above=True)
    shear_modulus_Pa: float | None = parameter(None, "Pa", 0, 1e13, "E/(2 (1 + ν))", above=True)
    poisson_ratio: float = parameter(0.3, "-", -0.99, 0.5, "choice: a metal; without shear_modulus_Pa")
    shape: str = choice(GENERAL, (GENERAL, *SHAPES), "general: by area and moments; else by dimensions_m")
    dimensions_m: list[float] | None = numbers(None, "m", 0, 1e3, "of the shape, in the order of its table")
    cross_section_area_m2: float | None = parameter(None, "m2", 0, 1e2, "of the shape", above=True)
    second_moments_of_area_m4: list[float] | None = numbers(
        None, "m4", 0, 1e3, "of the shape; about y and z of the section", length=2)
    torsion_constant_m4: float | None = parameter(None, "m4", 0, 1e3, "of the shape; in a plane not needed", above=True)
    shear_factors: list[float] | None = numbers(
        None, "-", 0, 1, "of the shape, for forces along y and z; general: none, rigid in shear", length=2)
    axis_y: list[float] | None = numbers(
        None, "-", -1e9, 1e9, "direction of y of the section, its part across the beam; in a plane to the left")
    released_first: list[str] = texts(
        [], "axial force Fx and moments Rx, Ry, Rz about axes of the section that the first end does not transmit",
        RELEASES)
    released_second: list[str] = texts([], "the same of the second end", RELEASES)
    offset_first_m: list[float] | None = numbers(
        None, "m", -1e6, 1e6, "from the first node to its end, as drawn: a rigid arm that rotates with the node; none")
    offset_second_m: list[float] | None = numbers(None, "m", -1e6, 1e6, "the same at the second node; none")
    thermal_expansion_per_K: float = parameter(..., "1/K", -1e-3, 1e-3, USER)
    stress_free_length_m: float | None = parameter(
        None, "m", 0, LARGEST_LENGTH_M, "at ΔT = 0; the distance of its ends", above=True)
    density_kg_per_m3: float | None = parameter(None, "kg/m3", 0, 1e5, "for truss.gravity_m_per_s2", above=True)
    temperature_fraction: float = parameter(1.0, "-", -10, 10, "mean over the section, of its program's ΔT")
    program: str | None = text(None, "name of a [[program]]; the common [thermal]")
    gradient_per_m: list[float] | None = numbers(
        None, "1/m", -1e6, 1e6, "along y and z of the section, of the ΔT of gradient_program; none", length=2)
    gradient_program: str | None = text(None, "name of a [[program]]; that of the mean")


@dataclass(frozen=True)
class Beams(EndsArrays):
    """Beams, k of them. Axes y and z of a section are across the beam, x runs from its first to its second node."""

    names: Sequence[str]
    nodes: np.ndarray  # (k, 2) int
    young_modulus_Pa: np.ndarray
    shear_modulus_Pa: np.ndarray
    cross_section_area_m2: np.ndarray
    second_moments_of_area_m4: np.ndarray  # (k, 2) about y and z
    torsion_constant_m4: np.ndarray
    shear_factors: np.ndarray  # (k, 2); inf: rigid in shear
    axis_y: np.ndarray  # (k, 3) unit, across the beam; zero: along it
    thermal_expansion_per_K: np.ndarray
    stress_free_length_m: np.ndarray
    density_kg_per_m3: np.ndarray  # NaN: not given
    temperature_fraction: np.ndarray
    program: np.ndarray  # int
    gradient_per_m: np.ndarray  # (k, 2)
    gradient_program: np.ndarray  # int
    offset_first_m: np.ndarray  # (k, 3)
    offset_second_m: np.ndarray  # (k, 3)
    released_first: np.ndarray  # (k, 4) bool, in the order of RELEASES
    released_second: np.ndarray  # (k, 4) bool

    @property
    def mass_kg(self) -> np.ndarray:
        """Mass [kg]; NaN without a density."""
        return np.asarray(self.density_kg_per_m3 * self.cross_section_area_m2 * self.stress_free_length_m)

    @property
    def axial_stiffness_N(self) -> np.ndarray:
        """E A [N]."""
        return np.asarray(self.young_modulus_Pa * self.cross_section_area_m2)

    @property
    def torsional_stiffness_N_m2(self) -> np.ndarray:
        """G J [N m²]."""
        return np.asarray(self.shear_modulus_Pa * self.torsion_constant_m4)

    @property
    def bending_stiffness_N_m2(self) -> np.ndarray:
        """E I (k, 2) about y and z [N m²]."""
        return np.asarray(self.young_modulus_Pa[:, None] * self.second_moments_of_area_m4)

    @property
    def shear_stiffness_N(self) -> np.ndarray:
        """k G A (k, 2) for forces along y and z [N]."""
        return np.asarray(self.shear_factors * (self.shear_modulus_Pa * self.cross_section_area_m2)[:, None])

    @property
    def stiffness_N_per_m(self) -> np.ndarray:  # type: ignore[override]
        """E A over the length [N/m]."""
        return np.asarray(self.axial_stiffness_N / self.stress_free_length_m)


def properties(item: Beam) -> Properties:
    """Return the properties of the section of a beam whose keys are complete. Given values replace those of the
    shape."""
    made = None if item.shape == GENERAL else SHAPES[item.shape].properties(*(item.dimensions_m or ()))
    moments = item.second_moments_of_area_m4 or (made.second_moments_of_area_m4 if made else (nan, nan))
    return Properties(
        item.cross_section_area_m2 or (made.cross_section_area_m2 if made else nan), (moments[0], moments[1]),
        item.torsion_constant_m4 or (made.torsion_constant_m4 if made else sum(moments)),
        (item.shear_factors[0], item.shear_factors[1]) if item.shear_factors else (
            made.shear_factors if made else (inf, inf)))


def rotated_nodes(items: Iterable[Beam], dimension: int) -> set[str]:
    """Return the names of the nodes that beams rotate: their ends transmit a moment, or have an offset."""
    axes = {"Rz"} if dimension == 2 else {"Rx", "Ry", "Rz"}
    found = set()
    for item in items:
        ends = set(item.released_first), set(item.released_second)
        no_torsion = (ends[0] | ends[1]) & {"Rx"}  # a torsion released at one end acts on neither
        for node, released, offset in zip(item.nodes, ends, (item.offset_first_m, item.offset_second_m)):
            if axes - released - no_torsion or any(offset or ()):
                found.add(node)
    return found


def _between(position_m: np.ndarray, nodes: np.ndarray, first_m: np.ndarray, second_m: np.ndarray) -> np.ndarray:
    """Return the vectors (k, 3) from the first to the second ends [m], which may be beside their nodes by offsets."""
    return np.asarray(position_m[nodes[:, 1]] + second_m - position_m[nodes[:, 0]] - first_m)


def _axes_y(items: Sequence[Beam], vectors_m: np.ndarray, known: References) -> np.ndarray:
    """Return unit vectors (k, 3) across the beams; zero for a given direction along its beam.

    :param vectors_m: from the first to the second ends (k, 3)
    """
    along = unit(vectors_m)
    found = np.zeros((len(items), 3))
    for index, given in enumerate(values(items, "axis_y")):
        if given is not None:
            found[index, : known.dimension] = given
        elif known.dimension == 2:
            found[index] = np.cross((0.0, 0.0, 1.0), along[index])
        else:  # a round section without gradient: any direction
            found[index] = np.eye(3)[np.argmin(np.abs(along[index]))]
    found = unit(found)
    across = found - (found * along).sum(axis=1, keepdims=True) * along
    across[np.linalg.norm(across, axis=1) < 1e-6] = 0.0
    # Twice, because the first remainder of a direction close to the beam has the rounding of the direction.
    across = unit(across)
    return unit(across - (across * along).sum(axis=1, keepdims=True) * along)


def eccentric(items: Sequence[Beam], dimension: int) -> tuple[str, ...]:
    """Return a sentence about beams in space whose shear centre is not their centroid."""
    names = [item.name for item in items if item.shape in ECCENTRIC] if dimension == 3 else []
    if not names:
        return ()
    others = "" if len(names) == 1 else f" and {len(names) - 1} other{'s' if len(names) > 2 else ''}"
    return (f"beam {names[0]!r}{others}: the shear centre of the section is beside its centroid, the twist by shear "
            "forces is neglected",)


class BeamType(BetweenNodes[Beam, Beams]):
    """Beams, supported by the reduced models and the DEM."""

    section = "beam"
    Item = Beam
    Arrays = Beams
    columns: ClassVar[tuple[ItemColumn, ...]] = (
        ItemColumn("beam_force_first_N", "section force at the first end along x, y, z; tension positive", True),
        ItemColumn("beam_moment_first_N_m", "section moment at the first end about x, y, z", True),
        ItemColumn("beam_force_second_N", "section force at the second end along x, y, z; tension positive", True),
        ItemColumn("beam_moment_second_N_m", "section moment at the second end about x, y, z", True),
    )
    bends = True
    has_section = True
    has_temperature = True

    def check_vectors(self, item: Beam, dimension: int) -> None:
        where = self.where(item.name)
        self._check_ends(item, dimension)
        if dimension == 2:
            if item.axis_y is not None:
                raise NotAllowed("axis_y", item.axis_y, code="planar_axis_y", **where)
            if item.gradient_per_m is not None and item.gradient_per_m[1]:
                raise NotAllowed("gradient_per_m", item.gradient_per_m, code="planar_gradient", **where)
            return
        vector("axis_y", item.axis_y, "-", dimension, True, **where)
        bends_evenly = item.shape in ("rod", "tube") and not any(item.gradient_per_m or ())
        if item.axis_y is None and not bends_evenly:
            raise MissingKey("axis_y", code="axis_missing", **where)
        if item.shape == GENERAL and item.torsion_constant_m4 is None:
            raise MissingKey("torsion_constant_m4", code="beam_section_missing", **where)

    def _check_ends(self, item: Beam, dimension: int) -> None:
        where = self.where(item.name)
        for end in ("first", "second"):
            released = getattr(item, f"released_{end}")
            if dimension == 2 and set(released) - {"Fx", "Rz"}:
                raise NotAllowed(f"released_{end}", released, code="planar_releases", **where)
            vector(f"offset_{end}_m", getattr(item, f"offset_{end}_m"), "m", dimension, False, **where)
        for key, what in (("Fx", "axial force"), ("Rx", "torsion")):
            if key in item.released_first and key in item.released_second:
                raise NotAllowed("released_second", item.released_second, code="released_twice", released=what, **where)

    def check_keys(self, item: Beam) -> None:
        where = self.where(item.name)
        if item.shape == GENERAL:
            if item.dimensions_m is not None:
                raise NotAllowed("dimensions_m", item.dimensions_m, code="beam_dimensions_without_shape", **where)
            for key in SECTION_KEYS[:2]:
                if getattr(item, key) is None:
                    raise MissingKey(key, code="beam_section_missing", **where)
        else:
            shape = SHAPES[item.shape]
            wanted = ", ".join(shape.dimensions)
            if item.dimensions_m is None:
                raise MissingKey("dimensions_m", code="beam_dimensions_missing", shape=item.shape, wanted=wanted,
                                 **where)
            if len(item.dimensions_m) != len(shape.dimensions) or not all(size > 0 for size in item.dimensions_m):
                raise NotAllowed("dimensions_m", item.dimensions_m, code="beam_dimensions", shape=item.shape,
                                 wanted=wanted, number=len(shape.dimensions), **where)
            if not shape.fits(*item.dimensions_m):
                raise NotAllowed("dimensions_m", item.dimensions_m, code="beam_walls", rule=shape.rule, **where)
        for key in ("second_moments_of_area_m4", "shear_factors"):
            given = getattr(item, key)
            if given is not None and not all(value > 0 for value in given):
                raise NotAllowed(key, given, code="beam_not_positive", **where)

    def may_be_wrong_keys(self, items: Any) -> np.ndarray:
        return np.full(len(items), True)

    def expands(self, item: Beam) -> bool:
        return True

    def derived(self, items: Sequence[Beam], known: References) -> dict[str, Any]:
        nodes = pairs(items, "nodes", known.node)
        offsets = [vectors(items, f"offset_{end}_m", known.dimension) for end in ("first", "second")]
        between = _between(known.position_m, nodes, *offsets)
        sections = [properties(item) for item in items]
        young, poisson = column(items, "young_modulus_Pa"), column(items, "poisson_ratio")
        program, own = known.programs_of(items), known.program.of(items, "gradient_program")
        gradients = [(0.0, 0.0) if given is None else given for given in values(items, "gradient_per_m")]

        def of(key: str, *width: int) -> np.ndarray:
            return np.array([getattr(one, key) for one in sections], dtype=float).reshape(len(items), *width)

        return {
            "nodes": nodes,
            "shear_modulus_Pa": given_or(column(items, "shear_modulus_Pa"), young / (2 * (1 + poisson))),
            "cross_section_area_m2": of("cross_section_area_m2"),
            "second_moments_of_area_m4": of("second_moments_of_area_m4", 2),
            "torsion_constant_m4": of("torsion_constant_m4"),
            "shear_factors": of("shear_factors", 2),
            "axis_y": _axes_y(items, between, known),
            "stress_free_length_m": given_or(
                column(items, "stress_free_length_m"), np.linalg.norm(between, axis=1)),
            "offset_first_m": offsets[0],
            "offset_second_m": offsets[1],
            **{key: np.stack([having(items, key, release) for release in RELEASES], axis=1)
               for key in ("released_first", "released_second")},
            "gradient_per_m": np.array(gradients, dtype=float).reshape(len(items), 2),
            "gradient_program": np.where(own < 0, program, 1 + own),
        }

    def check_geometry(self, truss: ResolvedTruss, elements: Beams) -> None:
        between = _between(truss.nodes.position_m, elements.nodes, elements.offset_first_m, elements.offset_second_m)
        lengths = np.linalg.norm(between, axis=1)
        if (lengths == 0).any():
            super().check_geometry(truss, elements)  # coincident nodes
        for index in np.flatnonzero(lengths == 0)[:1]:
            raise NotAllowed("offset_first_m", elements.offset_first_m[index].tolist(), code="coincident_ends",
                             **self.where(elements.names[index]))
        for index in np.flatnonzero(~elements.axis_y.any(axis=1))[:1]:
            raise NotAllowed("axis_y", code="axis_along_beam", **self.where(elements.names[index]))
        ranges_K = truss.temperature_ranges_K
        for side in (0, 1):
            changes = elements.temperature_fraction * ranges_K[elements.program, side]
            for index in np.flatnonzero(1 + elements.thermal_expansion_per_K * changes <= 0)[:1]:
                raise NotAllowed("thermal_expansion_per_K", float(elements.thermal_expansion_per_K[index]),
                                 code="link_without_length_of_program", temperature_change_K=float(changes[index]),
                                 at_K=changes[index], fraction=elements.temperature_fraction[index],
                                 program=truss.program_names[elements.program[index]],
                                 **self.where(elements.names[index]))

    def weights(self, elements: Beams, gravity_m_per_s2: np.ndarray, nodes: int) -> np.ndarray:
        found = np.zeros((nodes, 6))
        for end in elements.nodes.T:  # half at each end
            np.add.at(found[:, :3], end, 0.5 * elements.mass_kg[:, None] * gravity_m_per_s2)
        return found

    def preload_N(self, elements: Beams) -> np.ndarray:
        return np.zeros(len(elements.names))

    def tension_N(self, elements: Beams, states: Mapping[str, np.ndarray]) -> np.ndarray:
        return np.asarray(states["beam_force_second_N"][..., 0])

    def scene(self, truss: ResolvedTruss, elements: Beams) -> dict[str, Any]:
        return {"axis_x": unit(_between(truss.nodes.position_m, elements.nodes, elements.offset_first_m,
                                        elements.offset_second_m))}

    def lines(self, elements: Beams) -> list[Lines]:
        return [Lines(np.full(len(elements.names), True), VIOLET, "beam", width=3.0)]


BEAM = BeamType()
