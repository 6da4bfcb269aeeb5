#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes docs/reference/decks.md: what becomes of every card of a deck and of every field, from the tables of the import.

    PYTHONPATH=build/python /usr/bin/python3 docs/make_decks.py

A test requires that the committed page is what this writes.
"""
from __future__ import annotations

from pathlib import Path

from statejump.kinds.truss.importing.abaqus.table import ELEMENTS, KEYWORDS
from statejump.kinds.truss.importing.contract import markdown
from statejump.kinds.truss.importing.nastran.table import CARDS, CONTROL, PARAMS

PAGE = Path(__file__).resolve().parent / "reference" / "decks.md"
HEAD = """# Cards of decks

This page lists what [`statejump truss import`](../howto/trusses.md) does with every card of a Nastran deck and with every
keyword of a CalculiX or Abaqus deck. It is generated from the tables by which the import decides.

Every card, field and parameter is in one class:

| class | what the import does |
|---|---|
| used | it becomes part of the truss |
| no influence | it is left out; the import prints it with the reason |
| not supported | the import ends with exit status 2, names the card and its first line; `--ignore CARD` leaves it out |

A card that is in no table is not supported. `--ignore CARD.FIELD` leaves out a field alone, as the message says. A
field that is not supported is refused unless it is empty or 0.
"""


def page() -> str:
    """Return the page."""
    kinds = [f"`{name}`: {family}" for name, (family, _) in sorted(ELEMENTS.items())]
    lines = [HEAD.rstrip(), "", "## Nastran: bulk data", "", *markdown(CARDS, ("card",)),
             "", "## Nastran: PARAM", "", *markdown(PARAMS, ("parameter",)),
             "", "## Nastran: case control", "",
             "What is not listed selects nothing that acts on a truss in statics.", "",
             *markdown(CONTROL, ("command",)),
             "", "## CalculiX and Abaqus: keywords", "", *markdown(KEYWORDS, ("keyword",)),
             "", "## CalculiX and Abaqus: types of elements", "",
             "Beams need `--beams-as-bars`. A type that is not listed is not supported: " + ", ".join(kinds) + "."]
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
