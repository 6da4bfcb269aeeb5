# SPDX-License-Identifier: GPL-3.0-or-later
"""The Python part of a type of joint: one object per type, in a file of its own.

Case, checks, arrays, solver, result, drawing, texts, sensitivities, DEM and motion use the registry
(:data:`statejump.kinds.truss.joints.JOINTS`) and know no single type. A type omits methods that it does not support. If
a model has no such joint, the type returns the reason as a sentence.
"""
from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
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
# Friction may double a contact's force for a moment, and Hertz's stiffness is proportional to its cube root.
IMPACT = 2 ** (1 / 3)
USER = "no default: the truss decides"
ALUMINIUM = "choice, the paper is silent: aluminium"


@dataclass(frozen=True)
class ItemColumn:
    """A column of every joint or element of a type, under the name of the engine's output."""

    name: str  # with its unit
    note: str = ""
    vector: bool = False


@dataclass(frozen=True)
class Symbol:
    """Symbols of a drawing, planar or spatial, at positions (k, 3). Sizes are in units of the drawing's symbol size."""

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
    temperature_change_K: np.ndarray  # (samples, joints); of types without temperature (samples, 0)


@dataclass(frozen=True)
class Contacts:
    """Contacts over the samples of a run; forces act on the first part."""

    gap_m: np.ndarray  # (samples, joints)
    point_m: np.ndarray  # (samples, joints, 3)
    normal_force_N: np.ndarray  # (samples, joints, 3)
    tangential_force_N: np.ndarray  # (samples, joints, 3)


@dataclass(frozen=True)
class Drawn:
    """Parts of the page's drawing for the joints of a type."""

    parts: list[dict[str, Any]]
    contacts: list[tuple[str, str, str]]  # contact, its part, the part that it touches
    clearances_m: np.ndarray


@dataclass(frozen=True)
class ContactPart:
    """Nodes that get a contact part in the DEM. A node has one; equal parts are one."""

    nodes: np.ndarray  # (k,) GROUND: this joint gives no node a part
    roles: list[tuple[Any, ...]]  # (k,) shape and material of the part
    shared: bool = True  # whether several joints may share one part


@dataclass(frozen=True)
class Torsion:
    """Moments between two links, or a link and the ground, with the law of the DEM's torsion springs."""

    names: Sequence[str]
    links: np.ndarray  # (k, 2) int; (link, GROUND)
    axis: np.ndarray  # (k, 3) unit
    stiffness_N_m_per_rad: np.ndarray  # (k,) the largest one


class PartType(Generic[ItemType, ArraysType]):
    """Common part of the types of joints and elements. ``section`` is its list in a case file and its name in
    messages."""

    section: ClassVar[str]
    Item: ClassVar[type[Item]]
    Arrays: ClassVar[type[Any]]  # dataclass: names, and a field of the name of each key that models use
    columns: ClassVar[tuple[ItemColumn, ...]] = ()  # of a joint first its position: a slide, an offset, a rotation
    varied: ClassVar[tuple[str, ...]] = ()  # numbers of its arrays that may affect a jump
    not_in_dem: ClassVar[str] = ""  # text after its name if the DEM refuses it; empty: the DEM supports it

    @property
    def items(self) -> str:
        """Name of its list of items in results, and of the table of elements in the engine."""
        return f"{self.section}s"

    def where(self, name: str) -> dict[str, Any]:
        """Return the name of one of its items in messages."""
        return {"item": f"{self.section} {name!r}"}

    def listed(self, case: Case) -> list[ItemType]:
        """Return its items in a case."""
        found: list[ItemType] = getattr(case, self.section)
        return found

    def check_vectors(self, item: ItemType, dimension: int) -> None:
        """Raise NotAllowed for a vector whose length differs from the truss' dimension."""

    def check_references(self, item: ItemType, nodes: Mapping[str, Any], links: Mapping[str, Any]) -> None:
        """Raise an error for a name that does not exist or does not match."""
        raise NotImplementedError

    def may_be_wrong_vectors(self, items: ItemColumns[ItemType], dimension: int) -> np.ndarray:
        """Return the items (n,) that :meth:`check_vectors` has to check; must include all invalid ones."""
        return np.full(len(items), False)

    def may_be_wrong_references(self, items: ItemColumns[ItemType], around: Around) -> np.ndarray:
        """Return the items (n,) that :meth:`check_references` has to check; must include all invalid ones."""
        raise NotImplementedError

    def resolve(self, items: Sequence[ItemType], known: References) -> ArraysType:
        """Return the items as arrays: their keys, except those of :meth:`derived`."""
        made: ArraysType = arrays_of(self.Arrays, self.Item, items, known, **self.derived(items, known))
        return made

    def derived(self, items: Sequence[ItemType], known: References) -> dict[str, Any]:
        """Return the arrays whose values differ from those of a key."""
        return {}

    def torsion(self, arrays: ArraysType) -> Torsion:
        """Return the moments by which it rotates links against each other."""
        return Torsion((), np.zeros((0, 2), dtype=int), np.zeros((0, 3)), np.zeros(0))

    def symbols(self, truss: ResolvedTruss, arrays: ArraysType) -> list[Symbol]:
        """Return its symbols, the first of them for the legend; empty for a type that is drawn as lines."""
        return []

    def legend(self, arrays: ArraysType) -> str:
        """Return the text of the legend for its symbol, with the numbers that a drawing cannot show."""
        raise NotImplementedError


class Rotating(Protocol):
    """Items with an axis of rotation."""

    axis: list[float] | None


class AboutAxis(PartType[ItemType, ArraysType]):
    """A type whose items rotate about an ``axis``, which planar trusses do not give."""

    def check_vectors(self, item: ItemType, dimension: int) -> None:
        axis_of_rotation(cast(Rotating, item).axis, dimension, self.where(item.name))

    def may_be_wrong_vectors(self, items: ItemColumns[ItemType], dimension: int) -> np.ndarray:
        return wrong_axes(items, dimension)


class Linked(Protocol):
    """Items that act on the angle between links."""

    links: list[str]


class BetweenLinks(AboutAxis[ItemType, ArraysType]):
    """A type that acts on the angle between two ``links``, or on that of one."""

    def check_references(self, item: ItemType, nodes: Mapping[str, Any], links: Mapping[str, Any]) -> None:
        known_links(cast(Linked, item).links, links, self.where(item.name))

    def may_be_wrong_references(self, items: ItemColumns[ItemType], around: Around) -> np.ndarray:
        return wrong_ends(around.links.of(items, "links"), 1)


class JointType(PartType[ItemType, ArraysType]):
    """A type of joint. ``section`` is its list in a case file, its kind in the engine and its name in messages."""

    has_temperature: ClassVar[bool] = False  # its items have a program and a temperature_fraction
    has_contacts: ClassVar[bool] = False  # two surfaces touch: it has rows among the contacts of a result
    turns: ClassVar[bool] = False  # its friction is a moment

    @property
    def state_column(self) -> str:
        """Name of the column of its states in the samples of the DEM; the solver has other statuses."""
        return f"{self.section}_state"

    def where(self, name: str) -> dict[str, Any]:
        """Return the name of one of its joints in messages."""
        return {**super().where(name), "joint": name}

    # ---------------------------------------------------------------- case

    def expands(self, item: ItemType) -> bool:
        """Return whether joints that have a temperature expand with it."""
        return False

    def check_geometry(self, truss: ResolvedTruss, joints: ArraysType, ranges_K: np.ndarray) -> None:
        """Raise an error for invalid positions, directions and clearances.

        :param ranges_K: smallest and largest ΔT of every program (programs, 2)
        """

    def joined(self, joints: ArraysType) -> np.ndarray:
        """Return the pairs of nodes (k, 2) that the joints constrain."""
        return np.zeros((0, 2), dtype=int)

    # ---------------------------------------------------------------- solver

    def engine_arrays(self, truss: ResolvedTruss, joints: ArraysType) -> dict[str, Any]:
        """Return the engine's parameters that have no array of the same name."""
        return {}

    def path_refuses(self, joints: ArraysType) -> tuple[str, str] | None:
        """Return name and error code of a joint without a quasi-static path: it needs ``motion.start = "drawn"``."""
        return None

    # ---------------------------------------------------------------- result

    def contacts(self, run: Sampled, joints: ArraysType) -> Contacts:
        """Return the contacts of its joints."""
        raise NotImplementedError

    def drawn(self, truss: ResolvedTruss, joints: ArraysType, labels: Sequence[str], taken: set[str]) -> Drawn:
        """Return the parts of the page's drawing.

        :param labels: names of its contacts
        :param taken: existing names of parts; the new ones are added
        """
        return Drawn([], [], np.zeros(0))

    # ---------------------------------------------------------------- drawing and words

    def place_nodes(self, truss: ResolvedTruss, joints: ArraysType) -> np.ndarray:
        """Return the node (joints,) at which a point represents a joint."""
        raise NotImplementedError

    def covered_nodes(self, joints: ArraysType) -> np.ndarray:
        """Return the nodes that its symbols replace."""
        return np.zeros(0, dtype=int)

    def guided_nodes(self, joints: ArraysType) -> np.ndarray:
        """Return the nodes whose guides its symbols show."""
        return np.zeros(0, dtype=int)

    def sides(self, joints: ArraysType) -> Iterable[tuple[int, np.ndarray]]:
        """Yield nodes of planar trusses whose names are written below a symbol, and its upward direction (2,)."""
        return ()

    def describe(self, items: Sequence[ItemType]) -> str:
        """Return a sentence about the joints of a case."""
        raise NotImplementedError

    # ---------------------------------------------------------------- answers

    def parameters(self, joints: ArraysType) -> list[tuple[str, np.ndarray]]:
        """Return keys and values (joints,) of parameters that may affect a jump; 0 or infinity: the joint has none."""
        return [(key, getattr(joints, key)) for key in self.varied]

    def add_friction(self, loads: Loads, joints: ArraysType, state: Mapping[str, np.ndarray]) -> None:
        """Add the forces that represent the friction of its joints in one state of the solver."""
        raise NotImplementedError

    def without_friction(self, truss: ResolvedTruss) -> ResolvedTruss:
        """Return the truss whose joints of this type have no friction, and the temperature of the reference
        configuration."""
        raise NotImplementedError

    def unknown_friction(self, joints: ArraysType, state: Mapping[str, np.ndarray]) -> Iterable[int]:
        """Return the joints with unknown friction in a state."""
        return ()

    def carried_friction(self, joints: ArraysType, at: Mapping[str, np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
        """Return the friction of its joints and its limits (joints,) [N], or [N m] for a type that rotates, from its
        columns at one sample of any model. If stop and friction carry a force together, friction gets as much as it can
        carry."""
        raise NotImplementedError

    # ---------------------------------------------------------------- DEM

    def dem_refuses(self, joints: ArraysType) -> tuple[str, str] | None:
        """Return name and reason of a joint that the DEM does not support, although it supports others of the type."""
        return None

    def regularised_refuses(self, joints: ArraysType) -> tuple[str, str] | None:
        """Return name and reason of a joint that ``motion.scheme = "regularised"`` does not support."""
        return (joints.names[0], "has no contact of two bodies") if joints.names else None  # type: ignore[attr-defined]

    def contact_parts(self, joints: ArraysType) -> list[ContactPart]:
        """Return which nodes get which part."""
        return []

    def contact_nodes(self, joints: ArraysType) -> np.ndarray:
        """Return the nodes (joints, k) whose bodies touch or carry touching parts; the position of the contact
        first."""
        return np.zeros((0, 1), dtype=int)

    def pushed_nodes(self, joints: ArraysType) -> np.ndarray:
        """Return the nodes (joints, k), or GROUND, on which a contact acts; their masses move."""
        return self.contact_nodes(joints)

    def bodies_touch(self, joints: ArraysType) -> np.ndarray:
        """Return the joints with bodies that touch in the DEM. For the others an engine computes the forces."""
        return np.full(len(self.contact_nodes(joints)), True)

    def reach_m(self, path: Course, joints: ArraysType) -> np.ndarray:
        """Return the largest distance of a contact's bodies from its position [m] (joints,)."""
        return np.zeros(0)

    def contact_stiffness(self, path: Course, joints: ArraysType) -> tuple[np.ndarray, np.ndarray]:
        """Return the nodes (joints, k), or GROUND, on which a contact acts, and its largest stiffness [N/m] on the
        path."""
        return np.zeros((0, 1), dtype=int), np.zeros(0)

    def gives_in_dem(self, path: Course, joints: ArraysType, told_m: float) -> list[str]:
        """Return sentences about joints that are rigid in the reduced model and yield in the DEM by more than
        ``told_m`` [m]."""
        return []

    def largest_turn_rad(self, path: Course, joints: ArraysType) -> np.ndarray:
        """Return the largest rotation of :meth:`torsion` from the reference configuration on the path (joints,)."""
        return np.zeros(0)

    def scene(self, path: Course, joints: ArraysType) -> dict[str, Any]:
        """Return data for the YADE script besides the arrays."""
        return {}


def count(items: Sequence[object], one: str) -> str:
    """Return how many there are of something."""
    return f"{len(items)} {one}{'' if len(items) == 1 else 's'}"


def spread(values: Iterable[float], unit: str = "-", digits: int = 4) -> str:
    """Return the common value of many items, or the range of their values."""
    known = [float(value) for value in values]
    low, high = min(known), max(known)
    return text(low, unit, digits) if low == high else f"{text(low, unit, digits)} to {text(high, unit, digits)}"


def scaled(values: np.ndarray, scale: float, unit: str) -> str:
    """Return one value or the range of several, in a readable unit of the values times ``scale``."""
    low, high = values.min() * scale, values.max() * scale
    return f"{low:.4g} {unit}" if high - low <= 1e-9 * abs(high) else f"{low:.3g} to {high:.3g} {unit}"


@dataclass(frozen=True)
class Loads:
    """Forces of one joint after the other.

    :param force_N: (joints, nodes, 3), to which forces are added
    :param place_m: (nodes, 3), positions of nodes in the state
    """

    truss: ResolvedTruss
    force_N: np.ndarray
    place_m: np.ndarray

    def push(self, joint: int, node: int, force_N: np.ndarray) -> None:
        """Add a force on a node; on GROUND none."""
        if node != GROUND:
            self.force_N[joint, node] += force_N

    def turn(self, joint: int, link: int, moment_N_m: np.ndarray) -> None:
        """Add a moment on a link; on GROUND none."""
        if link == GROUND:
            return
        one, two = self.truss.links.nodes[link]
        along = self.place_m[two] - self.place_m[one]
        pair = np.cross(moment_N_m, along) / (along @ along)
        self.force_N[joint, two] += pair
        self.force_N[joint, one] -= pair

    def rub(self, joint: int, nodes: tuple[int, int], links: tuple[int, int], friction_N: np.ndarray,
            offset_m: np.ndarray, arm_m: float) -> None:
        """Add the friction between a round part and a hollow one, with the moments on both about their own nodes.

        :param nodes: of the hollow part and of the round one; ``links`` likewise
        :param friction_N: on the round part
        :param offset_m: of the round part's centre from the hollow one's
        :param arm_m: from the round part's centre to the contact point
        """
        distance = float(np.linalg.norm(offset_m))
        if distance == 0 or not friction_N.any():
            return
        for node, link, force, arm in ((nodes[0], links[0], -friction_N, arm_m + distance),
                                       (nodes[1], links[1], friction_N, arm_m)):
            self.push(joint, node, force)
            self.turn(joint, link, np.cross(offset_m / distance * arm, force))
