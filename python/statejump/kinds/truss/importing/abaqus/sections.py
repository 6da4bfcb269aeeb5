# SPDX-License-Identifier: GPL-3.0-or-later
"""Materials, sections, stiffnesses of springs and masses."""
from __future__ import annotations

import numpy as np

from statejump.kinds.truss.importing import profiles
from statejump.kinds.truss.importing.abaqus.keywords import Block
from statejump.kinds.truss.importing.abaqus.model import Material, Model, Scope, Section
from statejump.kinds.truss.importing.abaqus.table import BAR, BEAM, MASS, SPRING
from statejump.kinds.truss.importing.bending import Section as BeamSection
from statejump.kinds.truss.importing.model import quoted
from statejump.kinds.truss.importing.supports import ALONG, add_spring

ISOTROPIC = ("", "ISO", "ISOTROPIC")


def material(model: Model, block: Block, scope: Scope) -> None:
    """The material of the keywords that follow."""
    model.material = model.materials.setdefault(model.needed(block, "NAME").upper(), Material())
    model.deck.take("*MATERIAL", "properties of links")


def _of_material(model: Model, block: Block, counts: int) -> tuple[Material, list[float]] | None:
    """Return the material that a block describes, and its numbers; None if these depend on temperature or direction.

    :param counts: number of values in a data line before the temperature
    """
    if model.material is None:
        raise model.deck.fail(block.line, "deck_incomplete", f"*{block.name}", needed="a *MATERIAL before it")
    if not block.data:
        raise model.deck.fail(block.line, "deck_incomplete", f"*{block.name}", needed="data")
    rows = [(model.numbers(line, words) + [0.0] * counts)[:counts] for line, words in block.data]
    if any(row != rows[0] for row in rows):
        model.deck.refuse(f"*{block.name}", "temperature_dependent", block.data[1][0], block.name)
        return None
    model.deck.take(f"*{block.name}", "properties of links")
    return model.material, rows[0]


def elastic(model: Model, block: Block, scope: Scope) -> None:
    """Young's modulus and Poisson's ratio."""
    if block.parameters.get("TYPE", "").upper() not in ISOTROPIC:
        model.deck.refuse("*ELASTIC, TYPE", "anisotropic", block.line, "ELASTIC.TYPE")
        return
    if found := _of_material(model, block, 2):
        modulus, ratio = found[1]
        found[0].young_modulus = modulus
        found[0].shear_modulus = modulus / (2 * (1 + ratio)) if ratio > -1 else None
        if not -0.99 <= ratio <= 0.49:  # only the DEM's joints use it
            model.deck.leave("*ELASTIC", f"Poisson's ratio {ratio:g}: outside of -0.99 to 0.49", block.line)
        elif len(block.data[0][1]) > 1:
            found[0].poisson_ratio = ratio


def expansion(model: Model, block: Block, scope: Scope) -> None:
    """Read a thermal expansion. The parameter ZERO is used only if the coefficient depends on temperature. Bars are
    stress-free at their initial temperature."""
    kind = block.parameters.get("TYPE", "").upper()
    counts = {"ORTHO": 3, "ANISO": 6}.get(kind, 1)
    if kind not in (*ISOTROPIC, "ORTHO", "ANISO"):
        model.deck.refuse("*EXPANSION, TYPE", "unknown_type", block.line, "EXPANSION.TYPE")
        return
    if counts == 1 and model.material is not None and len({words[0] for _, words in block.data}) > 1:
        _expansion_table(model, model.material, block)
    elif found := _of_material(model, block, counts):
        if any(value != found[1][0] for value in found[1][:3]) or any(found[1][3:]):
            model.deck.refuse("*EXPANSION, TYPE", "anisotropic", block.line,
                              "EXPANSION.TYPE")
            return
        found[0].expansion = found[1][0]


def _expansion_table(model: Model, of: Material, block: Block) -> None:
    rows = [model.numbers(line, words[:2]) for line, words in block.data]
    if any(len(row) < 2 for row in rows) or any(b[1] <= a[1] for a, b in zip(rows, rows[1:])):
        raise model.deck.fail(block.line, "deck_bad_value", "*EXPANSION",
                              problem="not pairs of a coefficient and a rising temperature")
    of.expansion_table = tuple((temperature, value) for value, temperature in rows)
    of.expansion_zero = model.number(block.line, block.parameters.get("ZERO") or "0")
    model.deck.take("*EXPANSION", "thermal expansion that follows the temperature")


def density(model: Model, block: Block, scope: Scope) -> None:
    """Mass per volume."""
    if found := _of_material(model, block, 1):
        found[0].density = found[1][0]


def section(model: Model, block: Block, scope: Scope) -> None:
    """Read area and material of the bars in a set. The definition of other elements in the set refuses these."""
    name = model.needed(block, "MATERIAL").upper()
    if name not in model.materials:
        raise model.deck.fail(block.line, "deck_undefined", what_it_is="material", name=quoted(name))
    shape = "AREA" if block.name == "SOLID SECTION" else block.parameters.get("SECTION", "").upper()
    values = model.numbers(*block.data[0]) if block.data else []
    why = f"*{block.name} {quoted(shape)[1:-1]} gives no area with its sizes"
    if "NODAL THICKNESS" in block.parameters:
        made = Section(None, model.materials[name], f"{why} of *NODAL THICKNESS", shape)
    else:
        values = _sizes(model, block, shape, values)
        made = Section(profiles.calculix(shape, values), model.materials[name], why)
        if block.name == "BEAM SECTION":
            made.bending = profiles.calculix_section(shape, values)
            if shape == "RECT" and values:
                made.widths = (values[-1] if len(values) < 2 else values[1], values[0])
    if block.name == "BEAM SECTION":
        _orient(model, block, made, shape, values)
    _assign(model, block, scope, made)


def thickness(model: Model, block: Block, scope: Scope) -> None:
    """Read two sizes at nodes; a single size applies to both."""
    for line, words in block.data:
        sizes = model.numbers(line, words[1:3])
        if not sizes:
            raise model.deck.fail(line, "deck_incomplete", "*NODAL THICKNESS", needed="a node and its sizes")
        for node in model.nodes_of(line, words[0], scope):
            model.thickness[node] = (sizes[0], sizes[-1] or sizes[0])
    model.deck.take("*NODAL THICKNESS", "cross-section area of links")


def _assign(model: Model, block: Block, scope: Scope, made: Section) -> None:
    for one in model.elements_of(block.line, model.needed(block, "ELSET"), scope):
        if one.family in (BAR, BEAM):
            model.sections[one.name] = made
    model.deck.take(f"*{block.name}", "cross-section area of links")


def _sizes(model: Model, block: Block, shape: str, values: list[float]) -> list[float]:
    """Return the given sizes of a shape; a single one of CIRC as a diameter."""
    given = len([word for word in block.data[0][1] if word]) if block.data else 0
    if shape == "CIRC" and given == 1:
        if model.deck.options.circ is None:
            model.deck.refuse(
                f"*{block.name}, SECTION=CIRC", "radius_or_diameter", block.line, "--circ radius|diameter")
            return []
        if model.deck.options.circ == "radius":
            values = [2 * values[0]]
    return values[:given]


def _orient(model: Model, block: Block, made: Section, shape: str, sizes: list[float]) -> None:
    """Read the direction n1 of a beam. Refuse a section whose centroid is beside its nodes, if beams bend."""
    if len(block.data) > 1:
        x, y, z = (model.numbers(*block.data[1]) + [0.0] * 3)[:3]
        made.axis_1 = (x, y, z)
    if not model.bends():
        return
    for name in ("OFFSET1", "OFFSET2"):
        if model.number(block.line, block.parameters.get(name) or "0"):
            model.deck.refuse(f"*BEAM SECTION, {name}", "offset", block.line, f"BEAM SECTION.{name}")
    if made.bending and made.bending.eccentric or shape == "I" and len(sizes) > 1 and 2 * sizes[0] != sizes[1]:
        model.deck.refuse(f"*BEAM SECTION, SECTION={quoted(shape)[1:-1]}", "neutral_axis", block.line,
                          "BEAM SECTION.SECTION")
    elif made.bending is None and not made.shape:
        model.deck.refuse(f"*BEAM SECTION, SECTION={quoted(shape)[1:-1]}", "unknown_bending", block.line,
                          "BEAM SECTION.SECTION")


def normal(model: Model, block: Block, scope: Scope) -> None:
    """Read the direction n2 of beams at their nodes. A case has one direction for each beam."""
    found: dict[str, np.ndarray] = {}
    for line, words in block.data:
        values = (model.numbers(line, words[2:5]) + [0.0] * 3)[:3]
        for one in model.elements_of(line, words[0], scope):
            if one.family != BEAM:
                continue
            before = found.setdefault(one.name, np.array(values))
            if np.linalg.norm(np.cross(before, values)) > ALONG * np.linalg.norm(before) * np.linalg.norm(values) and \
                    model.bends():
                model.deck.refuse("*NORMAL", "normals_differ", line, "NORMAL")
                return
    model.normals.update(found)
    model.deck.take("*NORMAL", "direction of the section of beams")


def shear_stiffness(model: Model, block: Block, scope: Scope) -> None:
    """Refuse stiffnesses in shear of beams."""
    if model.bends():
        model.deck.refuse("*TRANSVERSE SHEAR STIFFNESS", "own_shear", block.line, "TRANSVERSE SHEAR STIFFNESS")
    else:
        model.deck.leave("*TRANSVERSE SHEAR STIFFNESS", "no beam bends", block.line)


def general(model: Model, block: Block, scope: Scope) -> None:
    """Read a section that gives its area and material itself."""
    if block.parameters.get("SECTION", "GENERAL").upper() != "GENERAL":
        model.deck.refuse("*BEAM GENERAL SECTION, SECTION", "unsupported_type", block.line,
                          "BEAM GENERAL SECTION.SECTION", only="GENERAL")
        return
    numeric = [model.numbers(line, words) for line, words in block.data]
    if len(numeric) < 2 or not numeric[0]:
        raise model.deck.fail(block.line, "deck_incomplete", "*BEAM GENERAL SECTION",
                              needed="a line of areas and one of moduli")
    moduli = numeric[2] if len(numeric) > 2 else numeric[1]
    made = Material(moduli[0], expansion=moduli[2] if len(moduli) > 2 else None)
    if "DENSITY" in block.parameters:
        made.density = model.number(block.line, block.parameters["DENSITY"])
    area, about_1, product, about_2, torsion = (numeric[0] + [0.0] * 5)[:5]
    made.shear_modulus = moduli[1] if len(moduli) > 1 else None
    section = Section(area, made, "it has no area", bending=BeamSection(area, (about_1, about_2), torsion,
                                                                        product=product))
    if len(numeric) > 2 and numeric[1]:
        x, y, z = (numeric[1] + [0.0] * 3)[:3]
        section.axis_1 = (x, y, z)
    _assign(model, block, scope, section)


def spring(model: Model, block: Block, scope: Scope) -> None:
    """Read the stiffness of springs: one line of directions for SPRING1 and SPRING2, then the stiffness."""
    if not block.data:
        raise model.deck.fail(block.line, "deck_incomplete", "*SPRING", needed="a stiffness")
    found = model.elements_of(block.line, model.needed(block, "ELSET"), scope)
    along = all(one.kind == "SPRINGA" for one in found)
    directions = [] if along else [model.whole(block.data[0][0], word) for word in block.data[0][1]]
    rows = [model.numbers(line, words) for line, words in block.data[0 if along else 1:]]
    if not rows or any(row[0] != rows[0][0] for row in rows):
        raise model.deck.fail(block.line, "deck_bad_value", "*SPRING",
                              problem="its stiffness depends on temperature, or there is none")
    for one in found:
        if one.family != SPRING:
            continue
        if one.kind == "SPRINGA":
            way = np.subtract(model.deck.nodes[one.nodes[1]], model.deck.nodes[one.nodes[0]])
            ends = [(end, way) for end in one.nodes]
        else:
            if len(directions) < len(one.nodes) or not all(1 <= at <= 3 for at in directions[:len(one.nodes)]):
                model.deck.refuse("*SPRING", "rotation", block.line, "SPRING")
                return
            ends = [(end, model.frame(end).directions(model.deck.nodes[end])[at - 1])
                    for end, at in zip(one.nodes, directions)]
        add_spring(model.deck, one.line, "*SPRING", one.name, rows[0][0], ends)


def mass(model: Model, block: Block, scope: Scope) -> None:
    """Read the mass of the nodes of elements of type MASS."""
    if not block.data:
        raise model.deck.fail(block.line, "deck_incomplete", "*MASS", needed="data")
    value = model.numbers(*block.data[0])[0]
    if value < 0:
        raise model.deck.fail(block.line, "deck_bad_value", "*MASS", problem="a negative mass")
    for one in model.elements_of(block.line, model.needed(block, "ELSET"), scope):
        if one.family == MASS and value:
            model.deck.weigh(one.nodes[0], value, block.line, "*MASS")
    model.deck.take("*MASS", "mass of nodes")
