# SPDX-License-Identifier: GPL-3.0-or-later
"""What a deck says of a truss, whatever program it is for, and the account of what was taken and what was not."""
from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

from statejump.core.errors import NotAllowed, Unreadable, printable, size
from statejump.core.reading import is_file
from statejump.core.tables import Shown

LARGEST_BYTES = 1 << 26
MOST_ITEMS = 1_000_000  # of a deck: nodes, bars, members of sets
SUFFIXES = {".inp": "abaqus", ".bdf": "nastran", ".dat": "nastran", ".nas": "nastran", ".csv": "tables",
            ".vtk": "mesh", ".vtu": "mesh", ".msh": "mesh", ".med": "mesh", ".mesh": "mesh"}


@dataclass
class Bar:
    """An element that becomes a link. Numbers are in the units of the deck; None: the deck does not say."""

    name: str
    nodes: tuple[str, str]
    kind: str
    young_modulus: float | None = None
    area: float | None = None
    expansion: float | None = None
    poisson_ratio: float | None = None
    density: float | None = None
    reference_temperature: float | None = None
    temperature_change: float | None = None


@dataclass
class Deck:
    """A truss in the units of its deck.

    :param temperature: of nodes, absolute or from zero as the deck has it
    :param taken: count by card and what became of it
    :param left: first line and count by card and why it was left out
    """

    path: Path
    nodes: dict[str, tuple[float, float, float]] = field(default_factory=dict)
    bars: list[Bar] = field(default_factory=list)
    fixed: dict[str, set[str]] = field(default_factory=dict)
    force: dict[str, list[float]] = field(default_factory=dict)
    temperature: dict[str, float] = field(default_factory=dict)
    initial: dict[str, float] = field(default_factory=dict)
    taken: dict[tuple[str, str], int] = field(default_factory=dict)
    left: dict[tuple[str, str], tuple[int, int]] = field(default_factory=dict)

    def take(self, card: str, what: str, count: int = 1) -> None:
        """Note that something of a card became part of the truss."""
        self.taken[card, what] = self.taken.get((card, what), 0) + count

    def leave(self, card: str, why: str, line: int) -> None:
        """Note that something of a card did not."""
        first, count = self.left.get((card, why), (line, 0))
        self.left[card, why] = (first, count + 1)

    def fail(self, line: int, what: str, cause: str | None = None) -> Unreadable:
        """Return why the deck cannot be read."""
        return Unreadable(f"line {line}: {what}" if line else what, cause=cause, file=self.path)

    def room(self, line: int, count: int) -> None:
        """Raise Unreadable for more items than any truss has."""
        if count > MOST_ITEMS:
            raise self.fail(line, f"there are more than {MOST_ITEMS} items")

    def add_node(self, line: int, name: str, position: tuple[float, float, float]) -> None:
        """Add a node. :raises Unreadable: another one has its name"""
        if name in self.nodes:
            raise self.fail(line, f"node {quoted(name)} is there twice")
        self.room(line, len(self.nodes) + 1)
        self.nodes[name] = position

    def fix(self, name: str, directions: str) -> None:
        """Hold a node in directions of ``xyz``."""
        self.fixed.setdefault(name, set()).update(directions)

    def load(self, name: str, force: tuple[float, float, float]) -> None:
        """Add a force on a node."""
        have = self.force.setdefault(name, [0.0, 0.0, 0.0])
        for place, value in enumerate(force):
            have[place] += value

    def account(self) -> list[Shown]:
        """Return what was taken and what was left out as tables."""
        shown = [Shown("taken", ("card", "count", "became"),
                       [(card, str(count), what) for (card, what), count in sorted(self.taken.items())],
                       left=("card", "became"))]
        if self.left:
            shown.append(Shown("left out", ("card", "count", "first line", "why"), self.left_rows(),
                               left=("card", "why")))
        return shown

    def left_rows(self) -> list[tuple[str, str, str, str]]:
        """Return the rows of what was left out, in the order of the deck."""
        return [(card, str(count), str(line) if line else "", why)
                for (card, why), (line, count) in sorted(self.left.items(), key=lambda item: item[1])]


def quoted(text: str) -> str:
    """Return a word of a deck as a sentence has it."""
    shown = repr(printable(text))
    return shown if len(shown) <= 40 else shown[:36] + "...'"


def text_of(path: Path) -> list[str]:
    """Return the lines of a deck. :raises Unreadable: there is none, it is too large or no text"""
    if not is_file(path):
        raise Unreadable("no such file", file=path)
    try:
        with path.open("rb") as stream:
            content = stream.read(LARGEST_BYTES + 1)
        if len(content) > LARGEST_BYTES:
            raise Unreadable("cannot be read", cause=f"it is larger than {size(LARGEST_BYTES)}", file=path)
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError:
        raise Unreadable("cannot be read", cause="it is not UTF-8 text", file=path) from None
    except OSError as failure:
        raise Unreadable("cannot be read", cause=failure.strerror, file=path) from None
    return text.replace("\r\n", "\n").split("\n")


def read(path: Path, form: str | None = None, bars: Path | None = None) -> Deck:
    """Return what a deck says.

    :param form: ``abaqus`` (CalculiX too), ``nastran``, ``tables`` or ``mesh``; None: by the suffix
    :param bars: of ``tables`` the second table
    :raises StatejumpError: one sentence with file and line
    """
    from statejump.kinds.truss.importing import abaqus, mesh, nastran, tables

    form = form or SUFFIXES.get(path.suffix.lower())
    if form is None:
        raise NotAllowed("FILE", path.name, f"must end with {', '.join(SUFFIXES)}", remedy="--format says what it is")
    if form == "mesh" and path.suffix.lower() not in mesh.FORMATS:
        raise NotAllowed("FILE", path.name, f"a mesh must end with {', '.join(mesh.FORMATS)}")
    if form == "tables":
        if bars is None:
            raise NotAllowed("FILE", path.name, "a table of nodes needs a table of bars", remedy="--bars names it")
        deck = tables.read(path, bars)
    else:
        deck = {"abaqus": abaqus.read, "nastran": nastran.read, "mesh": mesh.read}[form](path)
    if not deck.bars:
        raise Unreadable("holds no bars", file=path, remedy=", ".join(
            f"{card}: {why}" for card, _, _, why in deck.left_rows()[:3]) or None)
    return deck
