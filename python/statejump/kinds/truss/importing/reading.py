# SPDX-License-Identifier: GPL-3.0-or-later
"""Selects the reader of a file by its format."""
from __future__ import annotations

from pathlib import Path

from statejump.core.errors import NotAllowed, Unreadable
from statejump.kinds.truss.importing import abaqus, mesh, nastran, tables
from statejump.kinds.truss.importing.model import SUFFIXES, Deck, Options


def read(path: Path, form: str | None = None, bars: Path | None = None, options: Options | None = None) -> Deck:
    """Return the content of a deck.

    :param form: ``abaqus`` (CalculiX too), ``nastran``, ``tables`` or ``mesh``; None: by the suffix
    :param bars: the second table of ``tables``
    :param options: choices for cards of ``abaqus`` and ``nastran``
    :raises StatejumpError: one sentence with file and line
    """
    form = form or SUFFIXES.get(path.suffix.lower())
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
    if not deck.bars:
        raise Unreadable(code="no_bars", file=path,
                         remedy=", ".join(f"{card}: {why}" for card, _, _, why in deck.left_rows()[:3]) or None)
    return deck
