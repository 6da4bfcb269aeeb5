# SPDX-License-Identifier: GPL-3.0-or-later
"""Joints with clearance and Coulomb friction: a round part at one node moves in a bore at another node."""
from __future__ import annotations

from collections.abc import Container, Mapping, Sequence
from dataclasses import dataclass, replace
from math import inf
from typing import Any, ClassVar, TypeVar

import numpy as np

from statejump.core import physics
from statejump.core.errors import MissingKey, NotAllowed
from statejump.kinds.truss.arrays import GROUND, References, having, unit
from statejump.kinds.truss.joints.protocol import (
    IMPACT, ContactPart, Contacts, Drawn, JointType, Loads, Sampled, count, spread,
)
from statejump.kinds.truss.references import Around, known_name
from statejump.kinds.truss.resolved import Course, ResolvedTruss
from statejump.results import scene as drawing
from statejump.schema.item_tables import NONE, UNKNOWN, ItemColumns
from statejump.schema.items import Item

ItemType = TypeVar("ItemType", bound=Item)


@dataclass(frozen=True)
class RoundArrays:
    """Arrays of joints of both types."""

    names: Sequence[str]
    radial_clearance_m: np.ndarray  # at ΔT = 0
    friction_coefficient: np.ndarray
    temperature_fraction: np.ndarray
    program: np.ndarray  # int, index into ResolvedTruss.programs
    young_modulus_Pa: np.ndarray
    poisson_ratio: np.ndarray
    rigid: np.ndarray  # bool: contact = "rigid" of the reduced model


ArraysType = TypeVar("ArraysType", bound=RoundArrays)


class RoundParts(JointType[ItemType, ArraysType]):
    """A joint of a round part in a bore. Keys and arrays of a part begin with the part's name: ``journal_node``, ..."""

    noun: ClassVar[str]  # in sentences
    inner: ClassVar[str]  # name of the inner part
    outer: ClassVar[str]  # name of the outer part
    eccentricity: ClassVar[str]  # columns: inner less outer centre
    normal_force: ClassVar[str]
    friction_force: ClassVar[str]
    has_axis: ClassVar[bool] = True  # whether its arrays have the axis of rotation of both parts
    has_temperature = True
    has_contacts = True

    @property
    def parts(self) -> tuple[str, str]:
        """Names of both parts, the outer part first."""
        return self.outer, self.inner

    def _nodes(self, joints: ArraysType) -> np.ndarray:
        return np.stack([getattr(joints, f"{part}_node") for part in self.parts], axis=1)

    def radius_m(self, joints: ArraysType, part: str) -> np.ndarray:
        found: np.ndarray = getattr(joints, f"{self.inner}_radius_m")
        return found if part == self.inner else found + joints.radial_clearance_m

    def hertz_stiffness(self, joints: Any) -> np.ndarray:
        """Return K of the Hertz law F = K δ^1.5 [N/m^1.5] of every joint. Both parts have one material and touch like a
        sphere of radius R = R1 R2/(R2 - R1) on a plane, as in the DEM. The formulas do not use the DEM's contact
        law."""
        inner, outer = (self.radius_m(joints, part) for part in (self.inner, self.outer))
        radius = physics.conforming_radius_m(inner, outer, joints.radial_clearance_m)
        modulus = physics.effective_young_modulus_Pa(joints.young_modulus_Pa, joints.poisson_ratio)
        return physics.hertz_stiffness_N_per_m15(modulus, radius)

    def mindlin_stiffness(self, joints: Any) -> np.ndarray:
        """Return k_t / sqrt(depth) [N/m^1.5] of every joint, 8 G* sqrt(R)."""
        return 1.5 * self.hertz_stiffness(joints) * physics.shear_over_normal_stiffness(joints.poisson_ratio)

    def clearance_m(self, joints: Any, temperature_change_K: Any) -> np.ndarray:
        """Return the radial clearance [m] of the joints at ΔT [K], which includes their temperature fraction."""
        grown = [getattr(joints, f"{part}_thermal_expansion_per_K") * self.radius_m(joints, part)
                 for part in self.parts]
        found: np.ndarray = joints.radial_clearance_m + temperature_change_K * (grown[0] - grown[1])
        return found

    def derived(self, items: Sequence[ItemType], known: References) -> dict[str, Any]:
        return {"rigid": having(items, "contact", "rigid")}

    def engine_arrays(self, truss: ResolvedTruss, joints: ArraysType) -> dict[str, Any]:
        return {
            "hertz_stiffness_N_per_m15": np.where(joints.rigid, inf, self.hertz_stiffness(joints)),
            "mindlin_stiffness_N_per_m15": np.where(joints.rigid, inf, self.mindlin_stiffness(joints)),
            **{f"{part}_turns": (getattr(joints, f"{part}_link") == GROUND)
               & truss.nodes.rotates[getattr(joints, f"{part}_node")] for part in self.parts},
            "partial_slip": (truss.sticking == "partial_slip") & (joints.friction_coefficient > 0) & ~joints.rigid,
        }

    def regularised_refuses(self, joints: ArraysType) -> tuple[str, str] | None:
        for index in np.flatnonzero(joints.rigid)[:1]:
            return joints.names[index], "has contact = 'rigid'"
        return None

    def check_references(self, item: ItemType, nodes: Mapping[str, Any], links: Mapping[str, Any],
                         rotating: Container[str]) -> None:
        where = self.where(item.name)
        for part in self.parts:
            node_key, link_key = f"{part}_node", f"{part}_link"
            node, link = getattr(item, node_key), getattr(item, link_key)
            known_name(node_key, node, node, nodes, "node", **where)
            if link is None:
                # Nothing determines the rotation of this part.
                if node not in rotating and not nodes[node].fixed and nodes[node].guide_normal is None:
                    raise MissingKey(link_key, code="rotating_part_unsupported", nodes=(node,), part=part,
                                     node_wanted=node, **where)
                continue
            known_name(link_key, link, link, links, "link", **where)
            if node not in links[link].nodes:
                ends = " and ".join(repr(end) for end in links[link].nodes)
                raise NotAllowed(link_key, link, code="link_not_at_node", ends=ends, node_key=node_key,
                                 node_wanted=node, **where)
        inner, outer = (f"{part}_node" for part in (self.inner, self.outer))
        if getattr(item, inner) == getattr(item, outer):
            raise NotAllowed(inner, getattr(item, inner), code="equal_nodes_of_joint", outer=outer, **where)
        inner, outer = (f"{part}_link" for part in (self.inner, self.outer))
        if getattr(item, outer) is not None and getattr(item, outer) == getattr(item, inner):
            raise NotAllowed(inner, getattr(item, inner), code="equal_links_of_joint", outer=outer, **where)

    def may_be_wrong_references(self, items: ItemColumns[ItemType], around: Around) -> np.ndarray:
        nodes, links = ([places.of(items, f"{part}_{what}") for part in self.parts]
                        for places, what in ((around.nodes, "node"), (around.links, "link")))
        wrong = (nodes[0] == nodes[1]) | ((links[0] == links[1]) & (links[0] != NONE))
        for node, link in zip(nodes, links):
            wrong |= (node < 0) | (link == UNKNOWN)
            wrong |= np.where(link == NONE, ~around.turns[node], (around.link_nodes[link] != node[:, None]).all(axis=1))
        return np.asarray(wrong)

    def expands(self, item: ItemType) -> bool:
        return any(getattr(item, f"{part}_thermal_expansion_per_K") for part in self.parts)

    def check_parts(self, truss: ResolvedTruss, joints: Any, ranges_K: np.ndarray, apart_m: np.ndarray) -> None:
        """Raise NotAllowed if parts expand too far, or are too far apart in the reference configuration.

        :param apart_m: distance of the centres of both parts [m] (joints,), in the directions that close the clearance
        """
        for side in (0, 1):
            changes = joints.temperature_fraction * ranges_K[joints.program, side]
            for part in self.parts:
                expansion = getattr(joints, f"{part}_thermal_expansion_per_K")
                for index in np.flatnonzero(1 + expansion * changes <= 0)[:1]:
                    raise NotAllowed(f"{part}_thermal_expansion_per_K", float(expansion[index]), code="no_radius_left",
                                     temperature_change_K=float(changes[index]), part=part, at_K=changes[index],
                                     **self.where(joints.names[index]))
            for index in np.flatnonzero(~(self.clearance_m(joints, changes) > 0))[:1]:
                raise NotAllowed("radial_clearance_m", float(joints.radial_clearance_m[index]),
                                 code="clearance_closes", temperature_change_K=float(changes[index]),
                                 inner=self.inner, outer=self.outer, at_K=changes[index],
                                 **self.where(joints.names[index]))
        inner, outer = (self.radius_m(joints, part) for part in (self.inner, self.outer))
        for index in np.flatnonzero(~(outer > inner))[:1]:
            raise NotAllowed("radial_clearance_m", float(joints.radial_clearance_m[index]),
                             code="clearance_below_precision", radius_key=f"{self.inner}_radius_m",
                             radius_m=float(inner[index]), **self.where(joints.names[index]))
        for index in np.flatnonzero(apart_m > joints.radial_clearance_m)[:1]:
            own, other = (truss.nodes.names[getattr(joints, f"{part}_node")[index]]
                          for part in (self.inner, self.outer))
            raise NotAllowed(f"{self.inner}_node", own, code="node_off_clearance", apart_m=apart_m[index],
                             outer=self.outer, other=other, clearance_m=joints.radial_clearance_m[index],
                             **self.where(joints.names[index]))

    def offset_m(self, truss: ResolvedTruss, joints: ArraysType) -> np.ndarray:
        """Return the vector [m] (joints, 3) from the centre of the outer part to that of the inner one, in the
        reference configuration."""
        outer, inner = self._nodes(joints).T
        return truss.nodes.position_m[inner] - truss.nodes.position_m[outer]

    def joined(self, joints: ArraysType) -> np.ndarray:
        return self._nodes(joints)

    def normals(self, run: Sampled) -> np.ndarray:
        """Return the unit normals of the contacts (samples, joints, 3). They are zero for concentric parts."""
        return unit(run.columns[self.eccentricity])

    def touching(self, run: Sampled, joints: Any, tangential_force_N: np.ndarray) -> Contacts:
        """Return the contacts, for given friction forces on the inner part (samples, joints, 3)."""
        normal = self.normals(run)
        outer = self.radius_m(joints, self.outer)
        return Contacts(
            gap_m=self.clearance_m(joints, run.temperature_change_K)
            - np.linalg.norm(run.columns[self.eccentricity], axis=2),
            point_m=run.position_m[:, self.place_nodes(run.truss, joints)] + outer[:, None] * normal,
            normal_force_N=-run.columns[self.normal_force][:, :, None] * normal,
            tangential_force_N=tangential_force_N,
        )

    def drawn(self, truss: ResolvedTruss, joints: Any, labels: Sequence[str], taken: set[str]) -> Drawn:
        parts: list[dict[str, Any]] = []
        contacts = []
        for place, name in enumerate(labels):
            pair = []
            for part, kind in ((self.inner, "journal"), (self.outer, "bearing")):
                node, link = (int(getattr(joints, f"{part}_{what}")[place]) for what in ("node", "link"))
                label = f"{part} {truss.nodes.names[node]}"
                pair.append(label)
                if label in taken:
                    continue
                taken.add(label)
                # In space, the angle of a link in the view along z is not its rotation about the joint's axis.
                turns = link != GROUND and truss.dimension == 2
                angle = drawing.ref("links/angle_rad", truss.links.names[link]) if turns else 0.0
                axis = {"axis": joints.axis[place].tolist()} if truss.dimension == 3 and self.has_axis else {}
                parts.append({
                    "name": label, "type": kind, "centre": drawing.ref("history/position_m", truss.nodes.names[node]),
                    "angle_rad": angle, "radius_m": float(self.radius_m(joints, part)[place]),
                    "thermal_expansion_per_K": float(getattr(joints, f"{part}_thermal_expansion_per_K")[place]), **axis,
                })
            contacts.append((name, pair[0], pair[1]))
        return Drawn(parts, contacts, joints.radial_clearance_m)

    def place_nodes(self, truss: ResolvedTruss, joints: ArraysType) -> np.ndarray:
        return self._nodes(joints)[:, 0]

    def covered_nodes(self, joints: ArraysType) -> np.ndarray:
        return self._nodes(joints).T.ravel()

    def contact_parts(self, joints: Any) -> list[ContactPart]:
        return [
            ContactPart(getattr(joints, f"{part}_node"), [
                (part, *role) for role in zip(
                    self.radius_m(joints, part), joints.friction_coefficient, joints.young_modulus_Pa,
                    getattr(joints, f"{part}_link"))])
            for part in self.parts
        ]

    def describe(self, items: Sequence[Any]) -> str:
        clearance = spread((joint.radial_clearance_m for joint in items), "m")
        radius = spread((getattr(joint, f"{self.inner}_radius_m") for joint in items), "m")
        return (f"{count(items, self.noun)} with clearance: radial clearance {clearance}, {self.inner} radius "
                f"{radius}, friction coefficient {spread(joint.friction_coefficient for joint in items)}.")

    def friction_on_inner_N(self, joints: Any, state: Mapping[str, np.ndarray]) -> np.ndarray:
        """Return the friction force on the inner part [N] (joints, 3) in one state of the solver."""
        raise NotImplementedError

    def add_friction(self, loads: Loads, joints: Any, state: Mapping[str, np.ndarray]) -> None:
        links = np.stack([getattr(joints, f"{part}_link") for part in self.parts], axis=1)
        offset = state[self.eccentricity]
        # The contact point is in the middle of the penetration depth. At the ends of cycles ΔT = 0.
        depth = np.maximum(np.linalg.norm(offset, axis=1) - joints.radial_clearance_m, 0.0)
        arm = self.radius_m(joints, self.inner) - depth / 2
        for index, friction in enumerate(self.friction_on_inner_N(joints, state)):
            loads.rub(index, self._nodes(joints)[index], links[index], friction, offset[index], arm[index])

    def carried_friction(self, joints: Any, at: Mapping[str, np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
        friction = at[self.friction_force]
        sizes = np.linalg.norm(friction, axis=1) if friction.ndim == 2 else np.abs(friction)
        return sizes, joints.friction_coefficient * at[self.normal_force]

    def without_friction(self, truss: ResolvedTruss) -> ResolvedTruss:
        joints: Any = truss.joints[self.section]
        return truss.with_joints(**{self.section: replace(
            joints, friction_coefficient=0 * joints.friction_coefficient,
            temperature_fraction=0 * joints.temperature_fraction)})

    def contact_nodes(self, joints: ArraysType) -> np.ndarray:
        return self._nodes(joints)

    def contact_stiffness(self, path: Course, joints: Any) -> tuple[np.ndarray, np.ndarray]:
        force = IMPACT**3 * path.states[self.normal_force].max(axis=0)
        normal = physics.hertz_tangent_N_per_m(force, self.hertz_stiffness(joints))
        return self.pushed_nodes(joints), normal * (1 + physics.shear_over_normal_stiffness(joints.poisson_ratio))

    def scene(self, path: Course, joints: ArraysType) -> dict[str, Any]:
        return {f"{self.outer}_radius_m": self.radius_m(joints, self.outer)}
