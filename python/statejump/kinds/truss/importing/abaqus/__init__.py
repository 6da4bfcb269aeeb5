# SPDX-License-Identifier: GPL-3.0-or-later
"""Reader of decks of CalculiX and Abaqus. A table declares how each keyword is used; the readers follow the table."""
from __future__ import annotations

from collections import Counter
from pathlib import Path

import numpy as np

from statejump.kinds.truss.importing import profiles
from statejump.kinds.truss.importing.abaqus import assembly, bodies, generation, loads, mesh, sections
from statejump.kinds.truss.importing.abaqus.keywords import Block, blocks
from statejump.kinds.truss.importing.abaqus.model import Element, Model, Reading, Scope, Section
from statejump.kinds.truss.importing.abaqus.table import BAR, BEAM, KEYWORDS
from statejump.kinds.truss.importing.beams import PIECES, split_tapered
from statejump.kinds.truss.importing.bending import Bending, Load, nodal_loads, triad
from statejump.kinds.truss.importing.bending import Section as BeamSection
from statejump.kinds.truss.importing.bodies import settle_bodies
from statejump.kinds.truss.importing.contract import IDLE, REFUSED, Card, Field
from statejump.kinds.truss.importing.model import Bar, Deck, Options

# Order in which keywords are read, because a deck may have them in any order. Keywords of one stage are read in the
# deck's order.
STAGES: tuple[dict[str, Reading], ...] = (
    {"SYSTEM": mesh.system, "NODE": mesh.node},
    {"NGEN": generation.ngen, "NSET": mesh.node_set, "NFILL": generation.nfill, "NCOPY": generation.ncopy},
    {"ELEMENT": mesh.element},
    {"ELSET": mesh.element_set, "ELGEN": generation.elgen, "ELCOPY": generation.elcopy},
    {"TRANSFORM": loads.transform},
    {"MATERIAL": sections.material, "ELASTIC": sections.elastic, "EXPANSION": sections.expansion,
     "DENSITY": sections.density},
    {"SOLID SECTION": sections.section, "BEAM SECTION": sections.section, "BEAM GENERAL SECTION": sections.general,
     "NODAL THICKNESS": sections.thickness, "NORMAL": sections.normal,
     "TRANSVERSE SHEAR STIFFNESS": sections.shear_stiffness,
     "MASS": sections.mass, "INITIAL CONDITIONS": loads.initial},
    # Read after the steps, because the result depends on supports.
    {"SPRING": sections.spring, "EQUATION": loads.equation, "SURFACE": bodies.surface},
    {"RIGID BODY": bodies.rigid_body, "KINEMATIC COUPLING": bodies.kinematic_coupling, "COUPLING": bodies.coupling,
     "KINEMATIC": bodies.kinematic, "DISTRIBUTING": bodies.distributing,
     "DISTRIBUTING COUPLING": bodies.distributing_coupling},
)
SUPPORTED = 7  # the first stage behind the steps
# Keywords that are read with the steps, or that delimit parts.
TOGETHER = ("BOUNDARY", "CLOAD", "DLOAD", "TEMPERATURE", "AMPLITUDE", "STEP", "STATIC", "END STEP", "PART", "END PART",
            "ASSEMBLY", "END ASSEMBLY", "INSTANCE", "END INSTANCE", "PARAMETER")
SHORTEST = 3  # letters of an abbreviated parameter
# Tolerance of the middle node of a bar with three nodes: decks have eight digits, meshers position it to six digits.
MIDDLE = 1e-6
# CalculiX ignores blanks in keywords and parameters.
BY_LETTERS = {name.replace("_", ""): (name.replace("_", " "), card) for name, card in KEYWORDS.items()}


def read(path: Path, options: Options | None = None) -> Deck:
    """Return the content of a deck. :raises StatejumpError: one sentence with file and line"""
    deck = Deck(path, options or Options())
    model = Model(deck)
    given_blocks = list(blocks(deck, path))
    taken = [block for block in given_blocks if _check(model, block)]
    names = {block.name for block in given_blocks}
    deck.modal = "FREQUENCY" in names and not names & set(loads.STATIC)
    for block in taken:
        if block.name == "ELEMENT":
            mesh.check_type(model, block)
        elif block.name in ("STEP", "STATIC", "END STEP"):
            deck.take(f"*{block.name}", KEYWORDS[block.name.replace(" ", "_")].what)
    deck.settle()
    deck.spread_weight = True
    given = assembly.flat(model, taken)
    steps, own = _steps(given)
    for number, stage in enumerate(STAGES):
        if number == SUPPORTED:
            loads.run(model, steps)
        for block, scope in own:
            later = block.name == "NSET" and "ELSET" in block.parameters
            if later and "ELSET" in stage:
                mesh.node_set(model, block, scope)
            elif block.name in stage and not later:
                stage[block.name](model, block, scope)
    _bars(model)
    settle_bodies(deck)
    split_tapered(deck)
    deck.settle()
    return deck


def _check(model: Model, block: Block) -> bool:
    """Return whether a keyword must be read. Otherwise its table says whether it is refused or has no influence."""
    deck = model.deck
    letters = block.name.replace(" ", "")
    if letters not in BY_LETTERS:
        deck.refuse(f"*{block.name}", "unknown_card", block.line, block.name)
        return False
    block.name, known = BY_LETTERS[letters]
    if known.use == REFUSED:
        deck.refuse(f"*{block.name}", known.what, block.line, block.name)
    elif known.use == IDLE:
        deck.leave(f"*{block.name}", known.what, block.line)
    elif block.name in deck.options.ignored:
        deck.waived.add(block.name)
        deck.leave(f"*{block.name}", "left out by --ignore", block.line)
    else:
        _check_parameters(model, block, known)
        return True
    return False


def _parameter(known: Card, letters: str) -> Field | None:
    """Return the parameter of a keyword. Abaqus accepts its first letters if they belong to no other parameter."""
    by_letters = {field.name.replace("_", ""): field for field in known.fields}
    if letters in by_letters or len(letters) < SHORTEST:
        return by_letters.get(letters)
    begun = [field for name, field in by_letters.items() if name.startswith(letters)]
    return begun[0] if len(begun) == 1 else None


def _check_parameters(model: Model, block: Block, known: Card) -> None:
    for name, value in list(block.parameters.items()):
        field = _parameter(known, name.replace(" ", ""))
        if field is None:
            model.deck.refuse(f"*{block.name}, {name}", "unknown_parameter", block.line, f"{block.name}.{name}")
            continue
        written = field.name.replace("_", " ")
        if written != name:
            block.parameters[written] = block.parameters.pop(name)
        if field.use == REFUSED and value.upper() != "NO":
            model.deck.refuse(f"*{block.name}, {written}", field.why, block.line, f"{block.name}.{written}")
        elif field.use == IDLE and value.strip("0.eE+-") != "":
            model.deck.leave(f"*{block.name}, {written}", field.why, block.line)


def _steps(given: list[tuple[Block, Scope]]) -> tuple[list[loads.Step], list[tuple[Block, Scope]]]:
    """Return the steps of a deck, and all blocks. Blocks outside of steps belong to the first step."""
    steps = [loads.Step()]
    current = steps[0]
    for block, scope in given:
        if block.name == "STEP":
            current = loads.Step(block.line, "PERTURBATION" in block.parameters)
            steps.append(current)
        elif block.name == "END STEP":
            current = steps[0]
        current.blocks.append((block, scope))
    return steps, given


def _bars(model: Model) -> None:
    """Make bars from elements. An element becomes two bars if another item acts on its middle node."""
    shared = Counter(end for one in model.elements.values() for end in set(one.nodes))
    shared.update(node for one in model.deck.equations for node in one.nodes())
    shared.update(node for one in model.deck.followers for node in one.nodes())
    shared.update(moment.node for moment in model.deck.moments)
    shared.update(node for body in model.deck.rigid for node in body.nodes)
    for one in model.elements.values():
        if one.family not in (BAR, BEAM):
            continue
        ends = [(one.nodes[0], one.nodes[-1])]
        names = [one.name]
        if len(one.nodes) == 3 and _splits(model, one, shared):
            ends = [(one.nodes[0], one.nodes[1]), (one.nodes[1], one.nodes[2])]
            names = [f"{one.name}_1", f"{one.name}_2"]
        card = f"*ELEMENT, TYPE={one.kind}"
        for name, pair in zip(names, ends):
            bar = Bar(name, pair, card, bends=one.family == BEAM)
            if section := model.sections.get(one.name):
                of = section.material
                bar.area, bar.young_modulus, bar.expansion = section.area, of.young_modulus, of.expansion
                bar.poisson_ratio, bar.density, bar.why_no_area = of.poisson_ratio, of.density, section.why
                bar.expansion_table, bar.expansion_zero = of.expansion_table, of.expansion_zero
                if one.family == BEAM and model.bends():
                    _bend(model, bar, section, one.name, one.line)
                if section.shape:
                    _taper(model, bar, section)
            else:
                bar.why_no_area = bar.why_no_modulus = "no section names it"
            model.deck.bars.append(bar)
            if bar.bending:
                _press(model, bar, one, section)
        model.deck.take(card, "link" if one.family == BAR else "beam" if model.bends()
                        else "link: it carries axial force only, its bending is left out")


def _bend(model: Model, bar: Bar, section: Section, element: str, line: int) -> None:
    """Give a beam its bending."""
    first, second = (np.array(model.deck.nodes[end]) for end in bar.nodes)
    stations: tuple[tuple[float, BeamSection], ...] = ()
    if section.shape:
        sizes = [np.array(model.thickness.get(end, (0.0, 0.0))) for end in bar.nodes]
        between = [(at, sizes[0] + (sizes[1] - sizes[0]) * at) for at in np.linspace(0, 1, 1 + 2 * PIECES)]
        made = [(at, profiles.calculix_section(section.shape, [float(one) for one in of])) for at, of in between]
        stations = tuple((float(at), one) for at, one in made if one is not None)
        if len(stations) < len(made) or section.shape not in ("RECT", "CIRC"):
            return  # its area is missing, which is reported
        if all(one == stations[0][1] for _, one in stations):
            stations = stations[:1]
    bending = stations[0][1] if stations else section.bending
    if bending is None:
        return
    axis = np.array(section.axis_1)
    if element in model.normals:  # n2, to the right of which n1 and the beam follow
        axis = np.cross(model.normals[element], second - first)
    if triad(first, second, axis) is None:
        raise model.deck.fail(line, "deck_bad_geometry", f"element {bar.name}",
                              problem="direction n1 of its section is along it")
    bar.bending = Bending(bending, axis, section.material.shear_modulus, stations)


def _press(model: Model, bar: Bar, one: Element, section: Section | None) -> None:
    """Load the ends of a beam so that they move as under the pressures on it. P1 acts along n1, P2 along n2."""
    first, second = (np.array(model.deck.nodes[end]) for end in bar.nodes)
    axes = triad(first, second, bar.bending.axis_y) if bar.bending else None
    for side, kind in enumerate(("P1", "P2")):
        value, line = model.pressures.get((one.name, kind), (0.0, 0))
        if not value or axes is None or section is None:
            continue
        load = axes[1 + side] * value * section.widths[side]
        found = nodal_loads(Load(0.0, 1.0, load, load), float(np.linalg.norm(second - first)), axes, (0.0, 0.0))
        for node, force, moment in zip(bar.nodes, found[::2], found[1::2]):
            model.deck.load(node, [float(part) for part in force], line, "*DLOAD")
            model.deck.turn(node, moment)


def _taper(model: Model, bar: Bar, section: Section) -> None:
    """If the sizes of a bar differ at its nodes, give it the area and the density of an equivalent uniform bar."""
    sizes = [model.thickness.get(end, (0.0, 0.0)) for end in bar.nodes]
    if found := profiles.between(section.shape, *sizes):
        bar.area, mean = found
        if bar.density is not None:
            bar.density *= mean / bar.area


def _splits(model: Model, one: Element, shared: Counter[str]) -> bool:
    """Return whether the middle node splits an element, because it is not just a point of a straight bar."""
    deck, middle = model.deck, one.nodes[1]
    if one.family == BEAM and model.bends():
        return True
    first, between, last = (np.array(deck.nodes[end]) for end in one.nodes)
    if shared[middle] > 1 or any(deck.force.get(middle, ())) or middle in deck.mass or \
            np.linalg.norm(between - (first + last) / 2) > MIDDLE * np.linalg.norm(last - first):
        return True
    if deck.fixed.get(middle) or middle in deck.held:
        deck.leave(f"*ELEMENT, TYPE={one.kind}", "supports of middle nodes: a bar is straight", one.line)
    return False
