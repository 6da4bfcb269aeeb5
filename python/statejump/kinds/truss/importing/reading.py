# SPDX-License-Identifier: GPL-3.0-or-later
"""Selects the reader of a file by its format."""
from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path
from typing import TypeVar

from statejump.core.errors import NotAllowed, Unreadable
from statejump.core.reading import is_file
from statejump.kinds.truss.check_geometry import NoSupport
from statejump.kinds.truss.generate.document import Document
from statejump.kinds.truss.importing import abaqus, mesh, nastran, tables
from statejump.kinds.truss.importing.model import SUFFIXES, Deck, Options

Made = TypeVar("Made")
REMEDY = "hold nodes with --fixed NODE=xyz, or with the key 'fixed' in the case, before it runs"
HEAD_BYTES = 1 << 16  # of a deck, to recognise its format
CASE_CONTROL = re.compile(r"^[ \t]*(CEND|BEGIN[ \t]+BULK)\b", re.IGNORECASE | re.MULTILINE)


def form_of(path: Path) -> str | None:
    """Return the format of a file by its suffix, for a deck also by its content. Some Nastran decks end with .inp, and
    some decks of CalculiX with .dat."""
    form = SUFFIXES.get(path.suffix.lower())
    if form not in ("abaqus", "nastran") or not is_file(path):
        return form
    try:
        with path.open("rb") as stream:
            head = stream.read(HEAD_BYTES).decode("latin-1")
    except OSError:
        return form  # the reader reports it
    first = next((line for line in map(str.strip, head.splitlines()) if line and not line.startswith(("$", "**"))), "")
    if re.match(r"\*[A-Za-z]", first):
        return "abaqus"
    return "nastran" if CASE_CONTROL.search(head) else form


def read(path: Path, form: str | None = None, bars: Path | None = None, options: Options | None = None) -> Deck:
    """Return the content of a deck.

    :param form: ``abaqus`` (also CalculiX), ``nastran``, ``tables`` or ``mesh``; None: see :func:`form_of`
    :param bars: path of the second table of the format ``tables``
    :param options: choices for cards of ``abaqus`` and ``nastran``
    :raises StatejumpError: one sentence with file and line
    """
    form = form or form_of(path)
    if form is None:
        raise NotAllowed("FILE", path.name, code="deck_suffix", suffixes=", ".join(SUFFIXES))
    if form == "mesh" and path.suffix.lower() not in mesh.FORMATS:
        raise NotAllowed("FILE", path.name, code="mesh_suffix", suffixes=", ".join(mesh.FORMATS))
    if form == "tables":
        if bars is None:
            raise NotAllowed("FILE", path.name, code="bars_table_missing")
        deck = tables.read(path, bars)
        deck.named_units = True
    else:
        deck = mesh.read(path) if form == "mesh" else \
            {"abaqus": abaqus.read, "nastran": nastran.read}[form](path, options or Options())
    if not deck.bars and not deck.springs:
        raise Unreadable(code="no_bars", file=path,
                         remedy=", ".join(f"{card}: {why}" for card, _, _, why in deck.left_rows()[:3]) or None)
    return deck


def checked(document: Document, parse: Callable[[Document], Made]) -> tuple[Made, NoSupport | None]:
    """Return the case of a document, and the error with a remedy if some parts of the truss have no support.

    For all other checks, one node of each unsupported part is held.

    :param parse: function that returns the case of a document
    :raises StatejumpError: one of the other checks fails
    """
    try:
        return parse(document), None
    except NoSupport as found:
        loose, hint = set(found.loose), found
        hint.remedy = REMEDY
    axes = list("xyz"[:document["truss"]["dimension"]])
    nodes = [{**node, "fixed": axes} if node["name"] in loose else node for node in document["node"]]
    return parse({**document, "node": nodes}), hint
