# SPDX-License-Identifier: GPL-3.0-or-later
"""The registry of element types other than links, one file per type. :mod:`.protocol` documents element types."""
from __future__ import annotations

from typing import Any, ClassVar

from statejump.kinds.truss.elements.beam import BEAM, Beam
from statejump.kinds.truss.elements.body import BODY, Body
from statejump.kinds.truss.elements.protocol import ElementType
from statejump.kinds.truss.elements.spring import SPRING, Spring
from statejump.kinds.truss.elements.torsion_spring import TORSION_SPRING, TorsionSpring
from statejump.schema.fields import Section, definition, tables

# In the order of results. To add a type, add it to this tuple and to the lists.
ELEMENTS: tuple[ElementType[Any, Any], ...] = (SPRING, TORSION_SPRING, BEAM, BODY)


@definition
class ElementLists(Section):
    """The lists of elements that a case has."""

    NAMED: ClassVar[bool] = True  # as the case that has them

    spring: list[Spring] = tables(Spring, "sections [[spring]]")
    torsion_spring: list[TorsionSpring] = tables(TorsionSpring, "sections [[torsion_spring]]")
    beam: list[Beam] = tables(Beam, "sections [[beam]]")
    body: list[Body] = tables(Body, "sections [[body]]")
