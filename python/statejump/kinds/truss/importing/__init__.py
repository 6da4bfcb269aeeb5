# SPDX-License-Identifier: GPL-3.0-or-later
"""Trusses of other programs: CSV tables, decks of CalculiX and Abaqus, bulk data of Nastran, meshes."""
from statejump.kinds.truss.importing.model import Deck, read
from statejump.kinds.truss.importing.to_case import case_document

__all__ = ["Deck", "case_document", "read"]
