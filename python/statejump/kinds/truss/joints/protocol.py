# SPDX-License-Identifier: GPL-3.0-or-later
"""The Python part of a joint type: one object per type, in its own file.

Case, checks, arrays, solver, result, drawing, texts, sensitivities, DEM and motion use only the registry
(:data:`statejump.kinds.truss.joints.JOINTS`). A type defines only the methods that it supports. If a model does not
support a type, a method of the type returns the reason.
"""
from __future__ import annotations

from collections.abc import Container, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar, Generic, Protocol, TypeVar, cast

import numpy as np

from statejump.core.case import Case
from statejump.core.units import text
from statejump.kinds.truss.arrays import GROUND, References, arrays_of
from statejump.kinds.truss.references import Around, axis_of_rotation, known_links, wrong_axes, wrong_ends
from statejump.kinds.truss.resolved import Course, ResolvedTruss
from statejump.schema.item_tables import ItemColumns
from statejump.schema.items import Item

ItemType = TypeVar("ItemType", bound=Item)
ArraysType = TypeVar("ArraysType")

Strokes = tuple[tuple[tuple[float, float], ...], ...]  # in units of a symbol's size, the node at (0, 0)
BLACK = "#000000"
# Friction may double a contact force momentarily; the Hertz stiffness grows with its cube root.
IMPACT = 2 ** (1 / 3)
USER = "no default: the truss decides"
ALUMINIUM = "choice, the paper is silent: aluminium"


@dataclass(frozen=True)
class ItemColumn:
    """A column with one value per joint or element of a type. Its name is that in the engine's output."""

    name: str  # with its unit
    note: str = ""
    vector: bool = False


@dataclass(frozen=True)
class Symbol:
    """Symbols in a drawing, planar or spatial, at positions (k, 3). Sizes are relative to the drawing's symbol size."""

    places: np.ndarray
    marker: str | Strokes
    size: float
    size_in_space: float  # 0: not drawn there
    marker_in_space: str | Strokes | None = None  # None: the same
    colour: str = BLACK
    face: str = "white"
    order: float = 4.0  # higher symbols cover lower ones
    up: np.ndarray | None = None  # (k, 3) direction of the marker's top in the plane; None: up
    line_in_space: np.ndarray | None = None  # (k, 3) unit: direction of a line through the position


@dataclass(frozen=True)
class Sampled:
    """Samples of a run, from which a type computes its contacts."""

    truss: ResolvedTruss
    position_m: np.ndarray  # (samples, nodes, 3)
    columns: Mapping[str, np.ndarray]  # of the joints of the type
    temperature_change_K: np.ndarray  # (samples, joints); (samples, 0) for types without temperature


@dataclass(frozen=True)
class Contacts:
    """Contacts over the samples of a run. Forces are those on the first part of a contact."""

    gap_m: np.ndarray  # (samples, joints)
    point_m: np.ndarray  # (samples, joints, 3)
    normal_force_N: np.ndarray  # (samples, joints, 3)
    tangential_force_N: np.ndarray  # (samples, joints, 3)


@dataclass(frozen=True)
class Drawn:
    """Parts of the page's drawing for the joints of a type."""

    parts: list[dict[str, Any]]
    contacts: list[tuple[str, str, str]]  # name of the contact, its part, the part it touches
    clearances_m: np.ndarray


@dataclass(frozen=True)
class ContactPart:
    """Nodes that carry a contact part in the DEM. A node carries one part; joints share equal parts."""

    nodes: np.ndarray  # (k,) GROUND: the joint needs no part at a node
    roles: list[tuple[Any, ...]]  # (k,) shape and material of the part
    shared: bool = True  # whether several joints may share one part


@dataclass(frozen=True)
class Torsion:
    """Torsional stiffnesses between two links, or a link and the ground, in the form of the DEM's torsion springs."""

    names: Sequence[str]
    links: np.ndarray  # (k, 2) int; (link, GROUND)
    axis: np.ndarray  # (k, 3) unit
    stiffness_N_m_per_rad: np.ndarray  # (k,) the largest one


class PartType(Generic[ItemType, ArraysType]):
    """Base of joint types and element types. ``section`` is the name of a type's list in cases and messages."""

    section: ClassVar[str]
    Item: ClassVar[type[Item]]
    Arrays: ClassVar[type[Any]]  # dataclass of arrays: names, and one field per key that models use
    columns: ClassVar[tuple[ItemColumn, ...]] = ()  # of a joint first its position: a slide, an offset, a rotation
    varied: ClassVar[tuple[str, ...]] = ()  # numbers of its arrays that may affect a jump
    in_motion: ClassVar[bool] = True  # whether the reduced dynamics supports the type
    not_in_dem: ClassVar[str] = ""  # reason why the DEM refuses the type; empty: the DEM supports it

    @property
    def items(self) -> str:
        """Name of the list of items of this type in results, and of its table of elements in the engine."""
        return f"{self.section}s"

    def where(self, name: str) -> dict[str, Any]:
        """Return the name of one of its items in messages."""
        return {"item": f"{self.section} {name!r}"}

    def listed(self, case: Case) -> list[ItemType]:
        """Return its items in a case."""
        found: list[ItemType] = getattr(case, self.section)
        return found

    def check_vectors(self, item: ItemType, dimension: int) -> None:
        """Raise NotAllowed for a vector whose length is not the dimension of the truss."""

    def check_references(self, item: ItemType, nodes: Mapping[str, Any], links: Mapping[str, Any],
                         rotating: Container[str]) -> None:
        """Raise an error if an item refers to a missing or unsuitable node or link.

        :param rotating: names of the nodes that beams, rigid bodies or hinges rotate
        """
        raise NotImplementedError

    def may_be_wrong_vectors(self, items: ItemColumns[ItemType], dimension: int) -> np.ndarray:
        """Return the items (n,) that :meth:`check_vectors` must check. The result must include all invalid items.

        Default: all items, or none if the type has no vectors to check.
        """
        return np.full(len(items), type(self).check_vectors is not PartType.check_vectors)

    def may_be_wrong_references(self, items: ItemColumns[ItemType], around: Around) -> np.ndarray:
        """Return the items (n,) that :meth:`check_references` must check. The result must include all invalid items.

        Default: all items.
        """
        return np.full(len(items), True)

    def resolve(self, items: Sequence[ItemType], known: References) -> ArraysType:
        """Return the items as arrays: their keys, except those of :meth:`derived`."""
        made: ArraysType = arrays_of(self.Arrays, self.Item, items, known, **self.derived(items, known))
        return made

    def derived(self, items: Sequence[ItemType], known: References) -> dict[str, Any]:
        """Return those arrays of the type that are not simply the values of a key."""
        return {}

    def torsion(self, arrays: ArraysType) -> Torsion:
        """Return the torsional stiffnesses between links."""
        return Torsion((), np.zeros((0, 2), dtype=int), np.zeros((0, 3)), np.zeros(0))

    def symbols(self, truss: ResolvedTruss, arrays: ArraysType) -> list[Symbol]:
        """Return the symbols of the type, first that for the legend; empty for a type that is drawn as lines."""
        return []

    def legend(self, arrays: ArraysType) -> str:
        """Return the legend text of the symbol, with the numbers that a drawing cannot show."""
        raise NotImplementedError


class Rotating(Protocol):
    """Items with an axis of rotation."""

    axis: list[float] | None


class AboutAxis(PartType[ItemType, ArraysType]):
    """A type whose items rotate about an ``axis``. In planar trusses, cases do not give the axis."""

    def check_vectors(self, item: ItemType, dimension: int) -> None:
        axis_of_rotation(cast(Rotating, item).axis, dimension, self.where(item.name))

    def may_be_wrong_vectors(self, items: ItemColumns[ItemType], dimension: int) -> np.ndarray:
        return wrong_axes(items, dimension)


class Linked(Protocol):
    """Items that act on the angle between links."""

    links: list[str]


class BetweenLinks(AboutAxis[ItemType, ArraysType]):
    """A type that acts on the angle between two ``links``, or on the angle of one link."""

    def check_references(self, item: ItemType, nodes: Mapping[str, Any], links: Mapping[str, Any],
                         rotating: Container[str]) -> None:
        known_links(cast(Linked, item).links, links, self.where(item.name))

    def may_be_wrong_references(self, items: ItemColumns[ItemType], around: Around) -> np.ndarray:
        return wrong_ends(around.links.of(items, "links"), 1)


class JointType(PartType[ItemType, ArraysType]):
    """A joint type. ``section`` is the name of its list in a case file, of its kind in the engine, and in messages."""

    has_temperature: ClassVar[bool] = False  # its items have a program and a temperature_fraction
    has_contacts: ClassVar[bool] = False  # two surfaces touch: it has rows among the contacts of a result
    turns: ClassVar[bool] = False  # its friction is a moment
    slips_in_part: ClassVar[bool] = False  # a part of it slips at every load
    bends: ClassVar[bool] = False  # it rotates its nodes; models without rotations refuse it
    rubs_at_nodes: ClassVar[bool] = False  # its friction is a force on its nodes, without a moment on them
    bounds_code: ClassVar[str] = ""  # of the error with which bounds refuse it; empty: they know it

    @property
    def state_column(self) -> str:
        """Name of the column of DEM samples with the states of its joints, which differ from the solver's statuses."""
        return f"{self.section}_state"

    def where(self, name: str) -> dict[str, Any]:
        """Return the fields of a message that name a joint."""
        return {**super().where(name), "joint": name}

    # ---------------------------------------------------------------- case

    def expands(self, item: ItemType) -> bool:
        """Return whether a joint with a temperature expands with it."""
        return False

    def check_geometry(self, truss: ResolvedTruss, joints: ArraysType, ranges_K: np.ndarray) -> None:
        """Raise an error if positions, directions or clearances are invalid.

        :param ranges_K: smallest and largest ΔT of every program (programs, 2)
        """

    def joined(self, joints: ArraysType) -> np.ndarray:
        """Return the pairs of nodes (k, 2) that the joints couple."""
        return np.zeros((0, 2), dtype=int)

    def resting_nodes(self, joints: ArraysType) -> np.ndarray:
        """Return the nodes that rest on ground, which supports them."""
        return np.zeros(0, dtype=int)

    # ---------------------------------------------------------------- solver

    def engine_arrays(self, truss: ResolvedTruss, joints: ArraysType) -> dict[str, Any]:
        """Return those arrays for the engine for which the dataclass of the type has no field."""
        return {}

    def path_refuses(self, joints: ArraysType) -> tuple[str, str] | None:
        """Return name and error code of a joint without a quasi-static path; it needs ``motion.start = "drawn"``."""
        return None

    # ---------------------------------------------------------------- result

    def check_states(self, truss: ResolvedTruss, joints: ArraysType, states: Mapping[str, np.ndarray]) -> None:
        """Raise an error if a joint leaves the range of its law in a state."""

    def contacts(self, run: Sampled, joints: ArraysType) -> Contacts:
        """Return the contacts of its joints."""
        raise NotImplementedError

    def drawn(self, truss: ResolvedTruss, joints: ArraysType, labels: Sequence[str], taken: set[str]) -> Drawn:
        """Return the parts that draw the joints on the page.

        :param labels: names of the contacts of the type
        :param taken: names of existing parts; the method adds its own
        """
        return Drawn([], [], np.zeros(0))

    # ---------------------------------------------------------------- drawing and words

    def place_nodes(self, truss: ResolvedTruss, joints: ArraysType) -> np.ndarray:
        """Return the node (joints,) that represents each joint as a point."""
        raise NotImplementedError

    def covered_nodes(self, joints: ArraysType) -> np.ndarray:
        """Return the nodes that its symbols replace."""
        return np.zeros(0, dtype=int)

    def guided_nodes(self, joints: ArraysType) -> np.ndarray:
        """Return the nodes whose guides the symbols already show."""
        return np.zeros(0, dtype=int)

    def sides(self, joints: ArraysType) -> Iterable[tuple[int, np.ndarray]]:
        """Yield nodes of planar trusses with the upward direction (2,) of their symbol; names go below it."""
        return ()

    def describe(self, items: Sequence[ItemType]) -> str:
        """Return a sentence about the joints of a case."""
        raise NotImplementedError

    # ---------------------------------------------------------------- answers

    def parameters(self, joints: ArraysType) -> list[tuple[str, np.ndarray]]:
        """Return keys and values (joints,) of parameters that may affect a jump; 0 or infinity if a joint has none."""
        return [(key, getattr(joints, key)) for key in self.varied]

    def add_friction(self, loads: Loads, joints: ArraysType, state: Mapping[str, np.ndarray]) -> None:
        """Add the forces that represent the friction of the joints in one state of the solver."""
        raise NotImplementedError

    def without_friction(self, truss: ResolvedTruss) -> ResolvedTruss:
        """Return the truss with frictionless joints of this type, at the reference temperature."""
        raise NotImplementedError

    def unknown_friction(self, joints: ArraysType, state: Mapping[str, np.ndarray]) -> Iterable[int]:
        """Return the joints whose friction cannot be determined in a state."""
        return ()

    def carried_friction(self, joints: ArraysType, at: Mapping[str, np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
        """Return friction force and friction limit (joints,) [N], or [N m] for a rotating type, without sign, at one
        sample of a model. If a stop and friction share a force, friction carries as much as its limit allows."""
        raise NotImplementedError

    # ---------------------------------------------------------------- DEM

    def dem_refuses(self, joints: ArraysType) -> tuple[str, str] | None:
        """Return name and reason for one joint that the DEM cannot represent; None if there is none."""
        return None

    def regularised_refuses(self, joints: ArraysType) -> tuple[str, str] | None:
        """Return name and reason for a joint that ``motion.scheme = "regularised"`` does not support."""
        return (joints.names[0], "has no contact of two bodies") if joints.names else None  # type: ignore[attr-defined]

    def contact_parts(self, joints: ArraysType) -> list[ContactPart]:
        """Return which nodes get which part."""
        return []

    def contact_nodes(self, joints: ArraysType) -> np.ndarray:
        """Return the nodes (joints, k) whose bodies touch or carry touching parts. The node at the contact is first."""
        return np.zeros((0, 1), dtype=int)

    def pushed_nodes(self, joints: ArraysType) -> np.ndarray:
        """Return the nodes (joints, k), or GROUND, on which a contact acts and whose masses it thus accelerates."""
        return self.contact_nodes(joints)

    def bodies_touch(self, joints: ArraysType) -> np.ndarray:
        """Return for each joint whether its bodies touch in the DEM. If not, an engine of YADE computes its forces."""
        return np.full(len(self.contact_nodes(joints)), True)

    def reach_m(self, path: Course, joints: ArraysType) -> np.ndarray:
        """Return the largest distance [m] (joints,) of a contact's bodies from the position of the contact."""
        return np.zeros(0)

    def contact_stiffness(self, path: Course, joints: ArraysType) -> tuple[np.ndarray, np.ndarray]:
        """Return the nodes (joints, k), or GROUND, on which a contact acts, and its largest stiffness [N/m] on the
        path."""
        return np.zeros((0, 1), dtype=int), np.zeros(0)

    def gives_in_dem(self, path: Course, joints: ArraysType, told_m: float) -> list[str]:
        """Return sentences about joints that are rigid in the reduced model, but deform by more than ``told_m`` [m] in
        the DEM."""
        return []

    def largest_turn_rad(self, path: Course, joints: ArraysType) -> np.ndarray:
        """Return the largest rotation [rad] (joints,) on the path since its reference, see :meth:`torsion`.
        :meth:`torsion`."""
        return np.zeros(0)

    def scene(self, path: Course, joints: ArraysType) -> dict[str, Any]:
        """Return the data for the YADE script that the arrays of the type lack."""
        return {}


def count(items: Sequence[object], one: str) -> str:
    """Return how many there are of something."""
    return f"{len(items)} {one}{'' if len(items) == 1 else 's'}"


def spread(values: Iterable[float], unit: str = "-", digits: int = 4) -> str:
    """Return as text the common value of several items or, if they differ, their range."""
    known = [float(value) for value in values]
    low, high = min(known), max(known)
    return text(low, unit, digits) if low == high else f"{text(low, unit, digits)} to {text(high, unit, digits)}"


def scaled(values: np.ndarray, scale: float, unit: str) -> str:
    """Return as text the common value of several items, or their range, multiplied by ``scale``, in a readable unit."""
    low, high = values.min() * scale, values.max() * scale
    return f"{low:.4g} {unit}" if high - low <= 1e-9 * abs(high) else f"{low:.3g} to {high:.3g} {unit}"


@dataclass(frozen=True)
class Loads:
    """Nodal forces that the joints cause, joint by joint.

    :param force_N: forces (joints, nodes, 3), which the methods increment
    :param place_m: positions of the nodes in the state (nodes, 3)
    """

    truss: ResolvedTruss
    force_N: np.ndarray
    place_m: np.ndarray

    def push(self, joint: int, node: int, force_N: np.ndarray) -> None:
        """Add a force on a node; GROUND is ignored."""
        if node != GROUND:
            self.force_N[joint, node] += force_N

    def turn(self, joint: int, link: int, moment_N_m: np.ndarray) -> None:
        """Add a moment on a link; GROUND is ignored."""
        if link == GROUND:
            return
        one, two = self.truss.links.nodes[link]
        along = self.place_m[two] - self.place_m[one]
        pair = np.cross(moment_N_m, along) / (along @ along)
        self.force_N[joint, two] += pair
        self.force_N[joint, one] -= pair

    def rub(self, joint: int, nodes: tuple[int, int], links: tuple[int, int], friction_N: np.ndarray,
            offset_m: np.ndarray, arm_m: float) -> None:
        """Add the friction between a round part and a hollow one, with the moments of both about their nodes.

        :param nodes: node of the hollow part, then of the round part; ``links`` likewise
        :param friction_N: friction force on the round part
        :param offset_m: vector from the centre of the hollow part to that of the round one
        :param arm_m: distance from the centre of the round part to the contact point
        """
        distance = float(np.linalg.norm(offset_m))
        if distance == 0 or not friction_N.any():
            return
        for node, link, force, arm in ((nodes[0], links[0], -friction_N, arm_m + distance),
                                       (nodes[1], links[1], friction_N, arm_m)):
            self.push(joint, node, force)
            self.turn(joint, link, np.cross(offset_m / distance * arm, force))
