# SPDX-License-Identifier: GPL-3.0-or-later
"""Clearance revolutes: a journal that plays in a bearing, with Coulomb friction."""
from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import inf
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from statejump.core import physics
from statejump.core.errors import MissingKey, NotAllowed
from statejump.kinds.truss.arrays import GROUND, References, columns, indices, names, values
from statejump.kinds.truss.joints.protocol import (
    BLACK, IMPACT, ContactPart, Contacts, Drawn, JointColumn, JointType, Sampled, Symbol,
)
from statejump.kinds.truss.joints.words import ALUMINIUM, USER, count, scaled, spread
from statejump.kinds.truss.references import axis_of_rotation, known_name
from statejump.schema.fields import CHOICE, choice, definition, numbers, parameter, text
from statejump.schema.items import Item

if TYPE_CHECKING:
    from statejump.kinds.truss.resolved import ResolvedTruss
    from statejump.kinds.truss.solve import TrussPath


@definition
class Revolute(Item):
    """A clearance revolute joint with Coulomb friction: the journal, at one node, plays in the bearing, at
    another. A link carries and turns each; without a link a part does not turn."""

    bearing_node: str = text(..., "where the bearing's centre is")
    journal_node: str = text(..., "where the journal's centre is")
    bearing_link: str | None = text(None, "whose end carries the bearing; none: it does not turn")
    journal_link: str | None = text(None, "whose end carries the journal; none: it does not turn")
    journal_radius_m: float = parameter(..., "m", 0, 1e2, USER, above=True)
    radial_clearance_m: float = parameter(..., "m", 0, 1e2, USER + "; at ΔT = 0", above=True)
    friction_coefficient: float = parameter(..., "-", 0, 10, USER)
    axis: list[float] | None = numbers(None, "-", -1e9, 1e9, "fixed in space; needed in three dimensions")
    journal_thermal_expansion_per_K: float = parameter(0.0, "1/K", -1e-3, 1e-3, CHOICE + ": constant radii")
    bearing_thermal_expansion_per_K: float = parameter(0.0, "1/K", -1e-3, 1e-3, CHOICE + ": constant radii")
    temperature_fraction: float = parameter(1.0, "-", -10, 10, "of its program's ΔT; fully sunlit")
    program: str | None = text(None, "name of a [[program]]; the common [thermal]")
    young_modulus_Pa: float = parameter(70e9, "Pa", 0, 1e13, ALUMINIUM, above=True)
    poisson_ratio: float = parameter(0.3, "-", -0.99, 0.49, ALUMINIUM)
    contact: str = choice("hertz", ("hertz", "rigid"), CHOICE + "; of the reduced model, DEM is always elastic")


@dataclass(frozen=True)
class Revolutes:
    """Clearance revolute joints."""

    names: tuple[str, ...]
    bearing_node: np.ndarray  # int
    journal_node: np.ndarray  # int
    bearing_link: np.ndarray  # int, GROUND: the bearing does not turn
    journal_link: np.ndarray  # int, GROUND: the journal does not turn
    axis: np.ndarray  # (r, 3) unit; z in planar trusses
    journal_radius_m: np.ndarray
    radial_clearance_m: np.ndarray  # at ΔT = 0
    friction_coefficient: np.ndarray
    journal_thermal_expansion_per_K: np.ndarray
    bearing_thermal_expansion_per_K: np.ndarray
    temperature_fraction: np.ndarray
    program: np.ndarray  # int, index into ResolvedTruss.programs
    young_modulus_Pa: np.ndarray
    poisson_ratio: np.ndarray
    rigid: np.ndarray  # bool: contact = "rigid" in the reduced model

    @property
    def bearing_radius_m(self) -> np.ndarray:
        """Radius of the bearing at ΔT = 0 [m]."""
        return self.journal_radius_m + self.radial_clearance_m

    def clearance_m(self, temperature_change_K: Any) -> np.ndarray:
        """Return the radial clearance [m] where the joints are at these ΔT [K] (fraction included)."""
        return self.radial_clearance_m + temperature_change_K * (
            self.bearing_thermal_expansion_per_K * self.bearing_radius_m
            - self.journal_thermal_expansion_per_K * self.journal_radius_m
        )


def hertz_stiffness(joints: Revolutes) -> np.ndarray:
    """Return K of F = K δ^1.5 [N/m^1.5] of every revolute. Both parts are of one material and touch as a sphere of
    R = R1 R2/(R2 - R1) on a plane, as bodies of the DEM do; the formulas are not those of its contact law."""
    radius = physics.conforming_radius_m(joints.journal_radius_m, joints.bearing_radius_m, joints.radial_clearance_m)
    modulus = physics.effective_young_modulus_Pa(joints.young_modulus_Pa, joints.poisson_ratio)
    return physics.hertz_stiffness_N_per_m15(modulus, radius)


def mindlin_stiffness(joints: Revolutes) -> np.ndarray:
    """Return k_t over the root of the depth [N/m^1.5] of every revolute, 8 G* sqrt(R)."""
    return 1.5 * hertz_stiffness(joints) * physics.shear_over_normal_stiffness(joints.poisson_ratio)


class RevoluteType(JointType[Revolute, Revolutes]):
    """Clearance revolutes, in all models."""

    section = "revolute"
    Item = Revolute
    columns: ClassVar[tuple[JointColumn, ...]] = (
        JointColumn("eccentricity_m", "journal minus bearing centre", vector=True),
        JointColumn("normal_force_N"),
        JointColumn("friction_force_N", "on the journal, clockwise about the axis"),
    )
    varied = ("friction_coefficient", "radial_clearance_m", "journal_radius_m")
    has_temperature = True
    has_contacts = True

    def check_vectors(self, item: Revolute, dimension: int) -> None:
        axis_of_rotation(item.axis, dimension, self.where(item.name))

    def check_references(self, item: Revolute, nodes: Mapping[str, Any], links: Mapping[str, Any]) -> None:
        where = self.where(item.name)
        for part in ("bearing", "journal"):
            node_key, link_key = f"{part}_node", f"{part}_link"
            node, link = getattr(item, node_key), getattr(item, link_key)
            known_name(node_key, node, node, nodes, "node", **where)
            if link is None:
                # Nothing at hand says how such a part turns.
                if not nodes[node].fixed and nodes[node].guide_normal is None:
                    raise MissingKey(
                        link_key, f"without a link the {part} does not turn, so node {node!r} must have a support "
                        "(fixed or guide_normal)", nodes=(node,), **where,
                    )
                continue
            known_name(link_key, link, link, links, "link", **where)
            if node not in links[link].nodes:
                ends = " and ".join(repr(end) for end in links[link].nodes)
                raise NotAllowed(link_key, link, f"that link ends at {ends}, it must end at {node_key} = {node!r}",
                                 **where)
        if item.bearing_node == item.journal_node:
            raise NotAllowed("journal_node", item.journal_node, "must be another node than bearing_node", **where)
        if item.bearing_link is not None and item.bearing_link == item.journal_link:
            raise NotAllowed("journal_link", item.journal_link, "must be another link than bearing_link", **where)

    def expands(self, item: Revolute) -> bool:
        return bool(item.journal_thermal_expansion_per_K or item.bearing_thermal_expansion_per_K)

    def resolve(self, items: Sequence[Revolute], known: References) -> Revolutes:
        return Revolutes(
            names=names(items),
            **{key: indices(items, key, known.node) for key in ("bearing_node", "journal_node")},
            **{key: indices(items, key, known.link) for key in ("bearing_link", "journal_link")},
            axis=known.axes(items),
            program=known.programs_of(items),
            rigid=np.array([contact == "rigid" for contact in values(items, "contact")], dtype=bool),
            **columns(
                items, "journal_radius_m", "radial_clearance_m", "friction_coefficient",
                "journal_thermal_expansion_per_K", "bearing_thermal_expansion_per_K", "temperature_fraction",
                "young_modulus_Pa", "poisson_ratio",
            ),
        )

    def check_geometry(self, truss: ResolvedTruss, joints: Revolutes, ranges_K: np.ndarray) -> None:
        slips = (truss.sticking == "partial_slip") & (joints.friction_coefficient > 0)
        for index in np.flatnonzero(joints.rigid & slips)[:1]:
            raise NotAllowed("contact", "rigid", 'must be "hertz" with reduced.sticking = "partial_slip": a rigid '
                             "contact has no area of which a part slips", **self.where(joints.names[index]))
        for side in (0, 1):
            changes = joints.temperature_fraction * ranges_K[joints.program, side]
            for part in ("journal", "bearing"):
                expansion = getattr(joints, f"{part}_thermal_expansion_per_K")
                for index in np.flatnonzero(1 + expansion * changes <= 0)[:1]:
                    raise NotAllowed(
                        f"{part}_thermal_expansion_per_K", float(expansion[index]),
                        f"the {part} has no radius left at a temperature change of {changes[index]:g} K",
                        temperature_change_K=float(changes[index]), **self.where(joints.names[index]),
                    )
            for index in np.flatnonzero(~(joints.clearance_m(changes) > 0))[:1]:
                raise NotAllowed(
                    "radial_clearance_m", float(joints.radial_clearance_m[index]),
                    f"the expansion of journal and bearing closes it at a temperature change of {changes[index]:g} K, "
                    "it must stay above 0 [m] within the program", temperature_change_K=float(changes[index]),
                    **self.where(joints.names[index]),
                )
        for index in np.flatnonzero(~(joints.bearing_radius_m > joints.journal_radius_m))[:1]:
            raise NotAllowed(
                "radial_clearance_m", float(joints.radial_clearance_m[index]),
                f"too small beside journal_radius_m = {joints.journal_radius_m[index]:g} [m], the radii come out equal",
                **self.where(joints.names[index]),
            )
        positions = truss.nodes.position_m
        offset = positions[joints.journal_node] - positions[joints.bearing_node]
        along = (offset * joints.axis).sum(axis=1, keepdims=True) * joints.axis
        apart = np.linalg.norm(offset - along, axis=1)
        for index in np.flatnonzero(apart > joints.radial_clearance_m)[:1]:
            raise NotAllowed(
                "journal_node", truss.nodes.names[joints.journal_node[index]],
                f"it is {apart[index]:.6g} m from bearing_node = {truss.nodes.names[joints.bearing_node[index]]!r}, "
                f"the clearance is radial_clearance_m = {joints.radial_clearance_m[index]:g} [m]",
                **self.where(joints.names[index]),
            )

    def joined(self, joints: Revolutes) -> np.ndarray:
        return np.stack((joints.bearing_node, joints.journal_node), axis=1)

    def engine_arrays(self, truss: ResolvedTruss, joints: Revolutes) -> dict[str, Any]:
        gives_way = truss.sticking != "rigid"
        return {
            "hertz_stiffness_N_per_m15": np.where(joints.rigid, inf, hertz_stiffness(joints)),
            "mindlin_stiffness_N_per_m15": np.where(joints.rigid | (not gives_way), inf, mindlin_stiffness(joints)),
            "partial_slip": (truss.sticking == "partial_slip") & (joints.friction_coefficient > 0),
        }

    def contacts(self, run: Sampled, joints: Revolutes) -> Contacts:
        offset = run.columns["eccentricity_m"]
        distance = np.linalg.norm(offset, axis=2)
        normal = np.divide(offset, distance[:, :, None], out=np.zeros_like(offset), where=distance[:, :, None] > 0)
        across = np.cross(joints.axis, normal) if len(joints.names) else normal
        return Contacts(
            gap_m=joints.clearance_m(run.temperature_change_K) - distance,
            point_m=run.position_m[:, joints.bearing_node] + joints.bearing_radius_m[:, None] * normal,
            normal_force_N=-run.columns["normal_force_N"][:, :, None] * normal,
            tangential_force_N=-run.columns["friction_force_N"][:, :, None] * across,
        )

    def drawn(self, truss: ResolvedTruss, joints: Revolutes, labels: Sequence[str], taken: set[str]) -> Drawn:
        from statejump.results import scene as drawing

        parts: list[dict[str, Any]] = []
        contacts = []
        for place, name in enumerate(labels):
            pair = []
            for part in ("journal", "bearing"):
                node, link = (int(getattr(joints, f"{part}_{what}")[place]) for what in ("node", "link"))
                label = f"{part} {truss.nodes.names[node]}"
                pair.append(label)
                if label in taken:
                    continue
                taken.add(label)
                # About an axis in space a link's view along z has no angle of its own to tell.
                turns = link != GROUND and truss.dimension == 2
                angle = drawing.ref("links/angle_rad", truss.links.names[link]) if turns else 0.0
                axis = {} if truss.dimension == 2 else {"axis": joints.axis[place].tolist()}
                parts.append({
                    "name": label, "type": part, "centre": drawing.ref("history/position_m", truss.nodes.names[node]),
                    "angle_rad": angle, "radius_m": float(getattr(joints, f"{part}_radius_m")[place]),
                    "thermal_expansion_per_K": float(getattr(joints, f"{part}_thermal_expansion_per_K")[place]), **axis,
                })
            contacts.append((name, pair[0], pair[1]))
        return Drawn(parts, contacts, joints.radial_clearance_m)

    def place_nodes(self, truss: ResolvedTruss, joints: Revolutes) -> np.ndarray:
        return joints.bearing_node

    def symbols(self, truss: ResolvedTruss, joints: Revolutes) -> list[Symbol]:
        centres = truss.nodes.position_m[joints.bearing_node]
        return [Symbol(centres, "o", 0.8, 0.7, order=5), Symbol(centres, "o", 0.42, 0.35, order=6, face=BLACK)]

    def legend(self, joints: Revolutes) -> str:
        return (f"clearance joint, c = {scaled(joints.radial_clearance_m, 1e3, 'mm')}, "
                f"μ = {scaled(joints.friction_coefficient, 1.0, '').strip()}")

    def covered_nodes(self, joints: Revolutes) -> np.ndarray:
        return np.concatenate((joints.bearing_node, joints.journal_node))

    def describe(self, items: Sequence[Revolute]) -> str:
        return (
            f"{count(items, 'revolute joint')} with clearance: radial clearance "
            f"{spread((joint.radial_clearance_m for joint in items), 'm')}, journal radius "
            f"{spread((joint.journal_radius_m for joint in items), 'm')}, friction coefficient "
            f"{spread(joint.friction_coefficient for joint in items)}."
        )

    def parameters(self, joints: Revolutes) -> list[tuple[str, np.ndarray]]:
        elastic = np.where(joints.rigid, 0.0, joints.young_modulus_Pa)
        return [*super().parameters(joints), *([("young_modulus_Pa", elastic)] if elastic.any() else [])]

    def contact_parts(self, joints: Revolutes) -> list[ContactPart]:
        return [
            ContactPart(getattr(joints, f"{part}_node"), [
                (part, *role) for role in zip(
                    getattr(joints, f"{part}_radius_m"), joints.friction_coefficient, joints.young_modulus_Pa,
                    getattr(joints, f"{part}_link"))])
            for part in ("bearing", "journal")
        ]

    def contact_nodes(self, joints: Revolutes) -> np.ndarray:
        return np.stack((joints.bearing_node, joints.journal_node), axis=1)

    def reach_m(self, path: TrussPath, joints: Revolutes) -> np.ndarray:
        return np.sqrt(2) * joints.bearing_radius_m

    def contact_stiffness(self, path: TrussPath, joints: Revolutes) -> tuple[np.ndarray, np.ndarray]:
        force = IMPACT**3 * path.states["normal_force_N"].max(axis=0)
        normal = physics.hertz_tangent_N_per_m(force, hertz_stiffness(joints))
        return self.contact_nodes(joints), normal * (1 + physics.shear_over_normal_stiffness(joints.poisson_ratio))

    def scene(self, path: TrussPath, joints: Revolutes) -> dict[str, Any]:
        return {"bearing_radius_m": joints.bearing_radius_m}


REVOLUTE = RevoluteType()
