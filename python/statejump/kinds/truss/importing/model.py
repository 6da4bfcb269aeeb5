# SPDX-License-Identifier: GPL-3.0-or-later
"""The content of a deck, whatever program it was written for, and the record of used and omitted cards."""
from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from statejump.core.error_codes import CODES
from statejump.core.errors import NotAllowed, StatejumpError, Unreadable, printable
from statejump.core.tables import Shown
from statejump.kinds.truss.importing.bending import Bending
from statejump.kinds.truss.importing.lines import LARGEST_BYTES, text_of
from statejump.kinds.truss.importing.reasons import REASONS, TABLE_REASON

__all__ = ["LARGEST_BYTES", "Bar", "Deck", "Options", "Spring", "quoted", "text_of"]

MOST_SHOWN = 5  # further items in a refusal
MOST_ITEMS = 1_000_000  # largest number of nodes, bars, and members of sets of a deck
SUFFIXES = {".inp": "abaqus", ".bdf": "nastran", ".dat": "nastran", ".nas": "nastran", ".csv": "tables",
            ".vtk": "mesh", ".vtu": "mesh", ".vtp": "mesh", ".msh": "mesh", ".med": "mesh", ".mesh": "mesh"}


@dataclass
class Bar:
    """An element that becomes a link or a beam. Numbers are in the units of the deck; None if the deck does not give
    them.

    :param expansion_table: temperatures and secant coefficients of expansion, if these depend on temperature
    :param expansion_zero: reference temperature of the secant coefficients
    :param more_mass: mass per length in addition to that of the density
    :param why_no_area: reason why the deck gives no area for the bar
    :param why_no_modulus: reason why the deck gives no Young's modulus for the bar
    :param temperature: its own temperature, in place of the mean of its nodes
    :param bends: whether it is a beam of the deck
    :param bending: how it bends; None: it becomes a link
    :param lengthened: ratio of its length to the distance of its nodes, to which rigid ends connect it
    :param elongation: stress-free length minus the distance of its nodes, without rigid ends
    :param released: whether its first and its second end release the axial force
    """

    name: str
    nodes: tuple[str, str]
    kind: str
    young_modulus: float | None = None
    area: float | None = None
    expansion: float | None = None
    poisson_ratio: float | None = None
    density: float | None = None
    reference_temperature: float | None = None
    temperature: float | None = None
    temperature_change: float | None = None
    expansion_table: tuple[tuple[float, float], ...] = ()
    expansion_zero: float = 0.0
    more_mass: float = 0.0
    why_no_area: str = ""
    why_no_modulus: str = ""
    bends: bool = False
    bending: Bending | None = None
    lengthened: float = 1.0
    elongation: float = 0.0
    released: tuple[bool, bool] = (False, False)


@dataclass
class RigidBody:
    """Nodes that move as one rigid body. The first node is the master.

    :param directions: displacements of its other nodes that follow the master
    :param free: directions about which its other nodes rotate freely, unit vectors; three: about all
    """

    line: int
    card: str
    nodes: list[str]
    directions: str = "xyz"
    free: tuple[np.ndarray, ...] = ()

    @property
    def pinned(self) -> bool:
        """Whether rotations of some of its nodes are free."""
        return bool(self.free)


@dataclass
class Arm:
    """A rigid arm from a master to a node. Together they become a ``[[rigid]]`` of the case.

    :param directions: displacements of the node that follow the master
    :param rotations: whether the rotations of the node follow too
    """

    card: str
    master: str
    node: str
    directions: str = "xyz"
    rotations: bool = True


@dataclass
class Hinge:
    """A hinge between two nodes at one position, which becomes a ``[[hinge]]`` of the case.

    :param stiffness: moment over the angle, in the units of the deck
    """

    name: str
    nodes: tuple[str, str]
    axis: np.ndarray
    stiffness: float = 0.0


@dataclass
class Moment:
    """A moment that acts on a node.

    :param waiver: argument of ``--ignore`` that omits the moment; None: the name of its card
    :param weight: whether it is that of a mass times an acceleration, whose unit may not be that of forces
    """

    line: int
    card: str
    node: str
    vector: np.ndarray
    waiver: str | None = None
    weight: bool = False


@dataclass(eq=False)
class Equation:
    """A sum of displacements and rotations that is zero.

    :param terms: node, direction (unit vector) and factor of each displacement
    :param turns: the same of each rotation
    """

    line: int
    card: str
    terms: list[tuple[str, np.ndarray, float]]
    turns: list[tuple[str, np.ndarray, float]] = field(default_factory=list)

    def follow(self, joined: Mapping[str, str]) -> None:
        """Replace the names of merged nodes in its terms."""
        for terms in (self.terms, self.turns):
            terms[:] = [(joined.get(node, node), way, factor) for node, way, factor in terms]

    def nodes(self) -> list[str]:
        """Return the node of each term."""
        return [node for node, _, _ in (*self.terms, *self.turns)]


@dataclass(eq=False)
class Follower:
    """A node whose motion is the best fit to the motion of other nodes.

    :param follows: directions (k, 6) of its displacements and rotations that follow, unit vectors
    :param others: of each other node its name, its weight, and the directions (m, 6) in which it counts
    :param unsupported: names of its fields that are not supported
    """

    line: int
    card: str
    node: str
    follows: np.ndarray
    others: list[tuple[str, float, np.ndarray]]
    unsupported: list[str] = field(default_factory=list)

    def turns(self) -> bool:
        """Return whether its rotation follows."""
        return bool(self.follows[:, 3:].any())

    def nodes(self) -> list[str]:
        """Return its node and the others."""
        return [self.node, *(node for node, _, _ in self.others)]

    def follow(self, joined: Mapping[str, str]) -> None:
        """Replace the names of merged nodes."""
        self.node = joined.get(self.node, self.node)
        self.others[:] = [(joined.get(node, node), weight, ways) for node, weight, ways in self.others]


@dataclass
class Mean:
    """A node that follows the mean of others, which becomes a ``[[mean]]`` of the case.

    :param weights: weight of each other node
    :param directions: keys of a ``[[mean]]``
    """

    node: str
    weights: dict[str, float]
    directions: list[str]


@dataclass
class Spring:
    """A linear spring along the line between two nodes, or between a node and the ground along a direction.

    :param second: the second node; None: the ground
    :param direction: unit vector of the spring, if it ends at the ground
    """

    name: str
    first: str
    second: str | None
    stiffness: float
    kind: str
    line: int
    direction: tuple[float, float, float] | None = None


@dataclass(frozen=True)
class Options:
    """The user's choices for the import of cards.

    :param ignored: names of cards and fields that are omitted although they have influence
    :param beams_as_bars: whether beams become pin-jointed bars
    :param step: number of the step or subcase; None: the first one
    :param circ: meaning of a single length of a CIRC section: ``radius`` or ``diameter``
    """

    ignored: frozenset[str] = frozenset()
    beams_as_bars: bool = False
    step: int | None = None
    circ: str | None = None


@dataclass
class Deck:
    """A truss in the units of the deck from which it was read.

    :param temperature: temperature of nodes, on the scale of the deck
    :param held: directions in which a node does not move, in addition to the axes in ``fixed``
    :param held_rotations: directions about which a node does not rotate, unit vectors
    :param moment: moments of nodes at which beams end
    :param weight_moment: moments of masses times accelerations
    :param spread_weight: whether the weight of beams bends them between their nodes
    :param mass: lumped masses of nodes
    :param mass_scale: factor for all masses and densities
    :param gravity: acceleration vector of all masses
    :param refused: by refused card and option that waives the refusal: first line, reason, sentence, count
    :param taken: count by used card and result
    :param left: first line and count by omitted card and reason
    :param named_units: whether the file states the units of its numbers
    :param modal: whether its solution is modes or a response, in which a structure may be free
    :param free: whether cards of the deck state that rigid motions are possible
    :param choices: one sentence for each choice that no option of the user made
    """

    path: Path
    options: Options = field(default_factory=Options)
    nodes: dict[str, tuple[float, float, float]] = field(default_factory=dict)
    bars: list[Bar] = field(default_factory=list)
    fixed: dict[str, set[str]] = field(default_factory=dict)
    held: dict[str, list[tuple[float, float, float]]] = field(default_factory=dict)
    held_rotations: dict[str, list[np.ndarray]] = field(default_factory=dict)
    force: dict[str, list[float]] = field(default_factory=dict)
    moment: dict[str, np.ndarray] = field(default_factory=dict)
    weight_moment: dict[str, np.ndarray] = field(default_factory=dict)
    spread_weight: bool = False
    force_line: dict[str, tuple[int, str]] = field(default_factory=dict)  # line and card of the first force of a node
    springs: list[Spring] = field(default_factory=list)
    moments: list[Moment] = field(default_factory=list)
    rigid: list[RigidBody] = field(default_factory=list)
    arms: list[Arm] = field(default_factory=list)
    hinges: list[Hinge] = field(default_factory=list)
    equations: list[Equation] = field(default_factory=list)
    followers: list[Follower] = field(default_factory=list)
    means: list[Mean] = field(default_factory=list)
    mass: dict[str, float] = field(default_factory=dict)
    mass_line: dict[str, tuple[int, str]] = field(default_factory=dict)
    mass_scale: float = 1.0
    gravity: list[float] = field(default_factory=lambda: [0.0, 0.0, 0.0])
    temperature: dict[str, float] = field(default_factory=dict)
    initial: dict[str, float] = field(default_factory=dict)
    taken: dict[tuple[str, str], int] = field(default_factory=dict)
    left: dict[tuple[str, str], tuple[int, int]] = field(default_factory=dict)
    step: int = 0  # number of the static step; 0: none
    refused: dict[tuple[str, str], tuple[int, str, str, int]] = field(default_factory=dict)
    waived: set[str] = field(default_factory=set)
    named_units: bool = False
    modal: bool = False
    free: bool = False
    choices: list[str] = field(default_factory=list)

    def equation_directions(self) -> dict[str, list[np.ndarray]]:
        """Return the directions in which equations move their nodes."""
        found: dict[str, list[np.ndarray]] = {}
        for one in self.equations:
            for node, way, _ in one.terms:
                found.setdefault(node, []).append(way)
        return found

    def take(self, card: str, what: str, count: int = 1) -> None:
        """Record that a part of a card was converted to a part of the truss."""
        self.taken[card, what] = self.taken.get((card, what), 0) + count

    def leave(self, card: str, why: str, line: int) -> None:
        """Record that a part of a card was omitted."""
        first, count = self.left.get((card, why), (line, 0))
        self.left[card, why] = (first, count + 1)

    def refuse(self, card: str, why: str, line: int, waiver: str | None = None, **values: str) -> None:
        """Record that a part of a card has influence but is not supported. ``--ignore`` omits the part.

        :param why: key of ``REASONS``, or a sentence from the table of cards
        :param waiver: argument of ``--ignore`` that omits the part; None: the name of the card. The name of another
            option ends with ``=`` or begins with ``--``
        :param values: numbers and names for the sentence
        """
        reason, why = (why, REASONS[why].format_map(values)) if why in REASONS else (TABLE_REASON, why)
        waiver = waiver or card
        if waiver.upper() in self.options.ignored or card.upper() in self.options.ignored:
            self.waived.add(waiver.upper() if waiver.upper() in self.options.ignored else card.upper())
            self.leave(card, f"{why}; left out by --ignore", line)
            return
        first, *said, count = self.refused.get((card, waiver), (line, reason, why, 0))
        self.refused[card, waiver] = (first, said[0], said[1], count + 1)

    def settle(self) -> None:
        """Raise an error if unsupported cards were recorded. :raises StatejumpError: card, line and option"""
        if not self.refused:
            return
        found = sorted(self.refused.items(), key=lambda item: item[1][0])
        (card, waiver), (line, reason, why, _) = found[0]
        shown = [f"{quoted(also)[1:-1]} (line {at})" for (also, _), (at, *_) in found[1:MOST_SHOWN + 1]]
        others = f"; also {', '.join(shown)}" if shown else ""
        if len(found) > MOST_SHOWN + 1:
            others += f" and {len(found) - MOST_SHOWN - 1} more"
        card = quoted(card)[1:-1]
        raise StatejumpError(
            f"line {line}: {card} is not supported" if line else "", code="deck_not_supported", card=card,
            reason=reason, why=f"{why}{others}", line=line, file=self.path,
            remedy=f"{waiver} says which" if waiver.startswith("--") else f"--ignore {_argument(waiver)} leaves it out")

    def check_waived(self) -> None:
        """Raise an error for an argument of ``--ignore`` that matches nothing. :raises NotAllowed: there is one"""
        for name in sorted(self.options.ignored - self.waived):
            raise NotAllowed("--ignore", name, code="nothing_to_ignore")

    def fail(self, line: int, code: str, card: str = "", **details: Any) -> Unreadable:
        """Return the error for a deck that cannot be read.

        :param line: line number; 0 if unknown
        :param code: key of ``CODES``, which determines the names of details
        :param card: the card or keyword
        """
        where = [f"line {line}"] if line else []
        what = ": ".join([*where, *filter(None, [card]), CODES[code].what.format_map(details)])
        return Unreadable(what, code=code, file=self.path, line=line, card=card, **details)

    def room(self, line: int, count: int) -> None:
        """Raise Unreadable if the deck exceeds the largest number of items."""
        if count > MOST_ITEMS:
            raise self.fail(line, "deck_too_many_items", most=MOST_ITEMS)

    def new_name(self, name: str) -> str:
        """Return a name for a further node at the position of a node."""
        number = next(number for number in range(1, MOST_ITEMS) if f"{name}_{number}" not in self.nodes)
        return f"{name}_{number}"

    def add_node(self, line: int, name: str, position: tuple[float, float, float]) -> None:
        """Add a node. :raises Unreadable: another node has its name"""
        if name in self.nodes:
            raise self.fail(line, "deck_duplicate", what_it_is="node", name=quoted(name))
        self.room(line, len(self.nodes) + 1)
        self.nodes[name] = position

    def fix(self, name: str, directions: str) -> None:
        """Hold a node in directions of ``xyz``."""
        self.fixed.setdefault(name, set()).update(directions)

    def hold(self, name: str, direction: Sequence[float]) -> None:
        """Hold a node in a direction, a unit vector."""
        x, y, z = (float(part) for part in direction)
        for axis, size in zip("xyz", (x, y, z)):
            if abs(size) == 1:  # the usual case, a direction along an axis, without rounding
                self.fix(name, axis)
                return
        self.held.setdefault(name, []).append((x, y, z))

    def hold_rotation(self, name: str, direction: np.ndarray) -> None:
        """Hold the rotation of a node about a direction, a unit vector."""
        self.held_rotations.setdefault(name, []).append(direction)

    def turn(self, name: str, moment: np.ndarray, weight: bool = False) -> None:
        """Add a moment on a node at which a beam ends."""
        of = self.weight_moment if weight else self.moment
        of[name] = of.get(name, np.zeros(3)) + moment

    def bent(self) -> set[str]:
        """Return the nodes that rotate: beams end there that bend, or they belong to rigid arms, hinges or means."""
        found = {end for bar in self.bars if bar.bending
                 for end, turned in zip(bar.nodes, bar.bending.turned_ends) if turned}
        found |= {arm.master for arm in self.arms} | {arm.node for arm in self.arms if arm.rotations}
        found |= {one.node for one in self.followers if one.turns()}
        found |= {one.node for one in self.means if any(len(direction) > 1 for direction in one.directions)}
        return found | {end for hinge in self.hinges for end in hinge.nodes}

    def ends_of(self, bar: Bar) -> tuple[np.ndarray, np.ndarray]:
        """Return the positions of both ends of a bar or beam; those of a beam may be beside its nodes."""
        first, second = (np.array(self.nodes[end]) for end in bar.nodes)
        if bar.bending is None:
            return first, second
        return first + bar.bending.offsets[0], second + bar.bending.offsets[1]

    def load(self, name: str, force: Sequence[float], line: int = 0, card: str = "force") -> None:
        """Add a force on a node."""
        self.force_line.setdefault(name, (line, card))
        have = self.force.setdefault(name, [0.0, 0.0, 0.0])
        for place, value in enumerate(force):
            have[place] += value

    def weigh(self, name: str, mass: float, line: int, card: str) -> None:
        """Add a mass at a node."""
        self.mass_line.setdefault(name, (line, card))
        self.mass[name] = self.mass.get(name, 0.0) + mass

    def account(self) -> list[Shown]:
        """Return used and omitted cards as tables."""
        shown = [Shown("taken", ("card", "count", "became"),
                       [(card, str(count), what) for (card, what), count in sorted(self.taken.items())],
                       left=("card", "became"))]
        if self.left:
            shown.append(Shown("left out", ("card", "count", "first line", "why"), self.left_rows(),
                               left=("card", "why")))
        return shown

    def left_rows(self) -> list[tuple[str, str, str, str]]:
        """Return the table rows for omitted cards, in the order of the deck."""
        return [(card, str(count), str(line) if line else "", why)
                for (card, why), (line, count) in sorted(self.left.items(), key=lambda item: item[1])]


def carriers(deck: Deck) -> set[str]:
    """Return the nodes at which bars, springs, rigid arms, hinges or means end."""
    found = {end for bar in deck.bars for end in bar.nodes}
    found |= {node for one in deck.followers for node in one.nodes()}
    found |= {node for one in deck.means for node in (one.node, *one.weights)}
    found |= {end for item in deck.hinges for end in item.nodes} | {end for arm in deck.arms
                                                                    for end in (arm.master, arm.node)}
    return found | {end for spring in deck.springs for end in (spring.first, spring.second) if end}


def _argument(waiver: str) -> str:
    """Return the argument of --ignore, quoted for a shell."""
    shown = quoted(waiver)
    return shown if " " in shown else shown[1:-1]


def quoted(text: str) -> str:
    """Return a word of a deck, quoted for a sentence."""
    shown = repr(printable(text))
    return shown if len(shown) <= 40 else shown[:36] + "...'"
