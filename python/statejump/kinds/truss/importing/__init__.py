# SPDX-License-Identifier: GPL-3.0-or-later
"""Import of trusses: CSV tables, decks of CalculiX and Abaqus, bulk data of Nastran, meshes."""
from statejump.kinds.truss.importing.model import Deck, Options
from statejump.kinds.truss.importing.reading import checked, read
from statejump.kinds.truss.importing.summary import hints, summary
from statejump.kinds.truss.importing.to_case import SYSTEMS, Units, case_document

__all__ = ["SYSTEMS", "Deck", "Options", "Units", "case_document", "checked", "hints", "read", "summary"]
