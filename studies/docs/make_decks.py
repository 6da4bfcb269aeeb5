#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes docs/reference/decks.md from the tables of the importer: how it uses every card and field of a deck.

    PYTHONPATH=build/python /usr/bin/python3 studies/docs/make_decks.py

A test requires that the committed page equals the output of this program.
"""
from __future__ import annotations

from pathlib import Path

from statejump.kinds.truss.importing.abaqus.table import ELEMENTS, KEYWORDS
from statejump.kinds.truss.importing.contract import markdown
from statejump.kinds.truss.importing.nastran.table import CARDS, CONTROL, PARAMS

PAGE = Path(__file__).resolve().parents[2] / "docs" / "reference" / "decks.md"
HEAD = """# Cards of decks

After this page you know what [`statejump truss import`](../howto/import.md) does with every card of a Nastran deck and
every keyword of a CalculiX or Abaqus deck. The tables of the import generate this page.

```
statejump truss import mast.bdf -o mast.toml --ignore CARD.FIELD
```

Every card, field and parameter is in one class:

| class | what the import does |
|---|---|
| used | it becomes part of the truss |
| no influence | the import omits it and prints the reason |
| not supported | the import ends with exit status 2 and names the card and its first line; `--ignore CARD` omits it |

A card that is in no table is not supported. `--ignore CARD.FIELD` omits one field. An unsupported field is refused
unless it is empty or 0."""


def page() -> str:
    """Return the page."""
    kinds = [f"`{name}`: {family}" for name, (family, _) in sorted(ELEMENTS.items())]
    lines = [HEAD.rstrip(), "", "## Nastran: bulk data", "", *markdown(CARDS, ("card",)),
             "", "## Nastran: PARAM", "", *markdown(PARAMS, ("parameter",)),
             "", "## Nastran: case control", "",
             "Other commands select nothing that acts on a truss in statics.", "",
             *markdown(CONTROL, ("command",)),
             "", "## CalculiX and Abaqus: keywords", "", *markdown(KEYWORDS, ("keyword",)),
             "", "## CalculiX and Abaqus: types of elements", "",
             "Beams bend; with `--beams-as-bars` they become links. A type that is not listed is not supported: "
             + ", ".join(kinds) + "."]
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
