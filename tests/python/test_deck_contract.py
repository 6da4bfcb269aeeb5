# SPDX-License-Identifier: GPL-3.0-or-later
"""Every card, field and parameter of a deck is in exactly one class, and the documentation lists it."""
from __future__ import annotations

import importlib.util
import sys
from pathlib import Path
from typing import Any

import pytest

from statejump.kinds.truss.importing import abaqus, nastran
from statejump.kinds.truss.importing.abaqus.table import KEYWORDS
from statejump.kinds.truss.importing.contract import BLANK, IDLE, REFUSED, USED, Card, idle, refused, table, used
from statejump.kinds.truss.importing.nastran.table import CARDS, CONTROL, PARAMS

SCRIPT = Path(__file__).resolve().parents[2] / "studies" / "docs" / "make_decks.py"
TABLES = {"cards": CARDS, "parameters": PARAMS, "commands": CONTROL, "keywords": KEYWORDS}


def maker() -> Any:
    found = importlib.util.spec_from_file_location("make_decks", SCRIPT)
    assert found is not None and found.loader is not None
    module = importlib.util.module_from_spec(found)
    sys.modules["make_decks"] = module
    found.loader.exec_module(module)
    return module


@pytest.mark.parametrize("name", TABLES)
def test_no_field_is_in_no_class(name: str) -> None:
    for card in TABLES[name].values():
        assert card.use in (USED, IDLE, REFUSED) and card.what
        for field in card.fields:
            assert field.use in (USED, IDLE, REFUSED)
            assert (field.use == USED) == (not field.why), (card.name, field)


def test_a_field_in_two_classes_or_in_none_is_found() -> None:
    for wrong in ({"idle": {"A": "why"}, "refused": {"A": "why"}}, {"idle": {"B": "why"}}):
        with pytest.raises(ValueError, match="field [AB] "):
            used("CARD", "node", "ID A", **wrong)
    with pytest.raises(ValueError, match="two fields"):
        used("CARD", "node", "ID ID")
    with pytest.raises(ValueError, match="two classes"):
        table(idle("CARD", "why"), refused("CARD", "why"))


def test_cards_that_are_used_have_a_reader_and_no_others() -> None:
    assert {card.name for card in CARDS.values() if card.use == USED} == {*nastran.READERS, *nastran.TOGETHER}
    read = {name for stage in abaqus.STAGES for name in stage}
    assert {card.name.replace("_", " ") for card in KEYWORDS.values() if card.use == USED} == {*read, *abaqus.TOGETHER}


def test_positions_of_fields_repeat() -> None:
    card = used("CARD", "several", f"SID {BLANK} Si Li", repeats=2)
    assert [(found.name if (found := card.field(at)) else None) for at in range(8)] == [
        "SID", BLANK, "Si", "Li", "Si", "Li", "Si", "Li"]
    assert Card("CARD", USED, "once", card.fields).field(4) is None


def test_the_page_is_current() -> None:
    found = maker()
    assert found.PAGE.read_text(encoding="utf-8") == found.page(), "run studies/docs/make_decks.py"
    for name in ("CQUAD4", "W1A", "NODAL THICKNESS", "`B32`: beam", "K2GG", "WTMASS"):
        assert name in found.page()
