# SPDX-License-Identifier: GPL-3.0-or-later
"""Readers of supports, loads and temperatures, step by step."""
from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from statejump.core.errors import NotAllowed
from statejump.kinds.truss.importing.abaqus.keywords import Block
from statejump.kinds.truss.importing.abaqus.model import Model, Scope
from statejump.kinds.truss.importing.abaqus.table import BAR, BEAM, DYNAMIC, MASS
from statejump.kinds.truss.importing.coordinates import Frame, about_axis, by_axis
from statejump.kinds.truss.importing.model import Equation, Moment, quoted

HELD = {"ENCASTRE": (1, 6), "PINNED": (1, 3), "XSYMM": (1, 1), "YSYMM": (2, 2), "ZSYMM": (3, 3)}
STATIC = ("STATIC", "COUPLED TEMPERATURE-DISPLACEMENT", "UNCOUPLED TEMPERATURE-DISPLACEMENT", "VISCO")


@dataclass
class Step:
    """Blocks of a step of the deck. Blocks before the first step belong to the model."""

    line: int = 0
    perturbation: bool = False
    blocks: list[tuple[Block, Scope]] = field(default_factory=list)

    def static(self) -> Block | None:
        """Return the block that makes the step a static one."""
        return next((block for block, _ in self.blocks if block.name in STATIC), None)


@dataclass
class State:
    """Supports and loads at the end of a step.

    :param held: held directions of each node
    :param turned: held directions of rotation of each node, 4 to 6
    :param force: force by node and direction, with its line
    :param pressure: pressure on beams by element and side, with its line
    :param gravity: vector by set of elements, with its line
    """

    held: dict[str, set[int]] = field(default_factory=dict)
    turned: dict[str, set[int]] = field(default_factory=dict)
    force: dict[tuple[str, int], tuple[float, int]] = field(default_factory=dict)
    gravity: dict[str, tuple[np.ndarray, int]] = field(default_factory=dict)
    pressure: dict[tuple[str, str], tuple[float, int]] = field(default_factory=dict)
    temperature: dict[str, float] = field(default_factory=dict)


def transform(model: Model, block: Block, scope: Scope) -> None:
    """Read a ``*TRANSFORM`` card: directions in which supports and loads act on the nodes of a set."""
    kind = block.parameters.get("TYPE", "R").upper()[:1]
    values = model.numbers(*block.data[0]) if block.data else []
    if len(values) < 6:
        raise model.deck.fail(block.line, "deck_incomplete", "*TRANSFORM", needed="two points")
    first, second = np.array(values[:3]), np.array(values[3:6])
    frame: Frame | None = None
    if kind == "R":
        frame = by_axis("R", np.zeros(3), first, second)
    elif kind == "C":
        frame = about_axis(first, second)
    else:
        model.deck.refuse("*TRANSFORM, TYPE", "unsupported_type", block.line, "TRANSFORM.TYPE", only="R and C")
        return
    if frame is None:
        raise model.deck.fail(block.line, "deck_bad_geometry", "*TRANSFORM", problem="its points give no directions")
    for node in model.nodes_of(block.line, model.needed(block, "NSET"), scope):
        model.frames[node] = frame
    model.deck.take("*TRANSFORM", "directions of supports and forces")


def initial(model: Model, block: Block, scope: Scope) -> None:
    """Read the stress-free temperatures of links."""
    kind = block.parameters.get("TYPE", "").upper()
    if kind in ("DISPLACEMENT", "VELOCITY", "ROTATING VELOCITY", "ACCELERATION"):
        model.deck.leave(f"*INITIAL CONDITIONS, TYPE={kind}", DYNAMIC, block.line)
        return
    if kind != "TEMPERATURE":
        card = f"*INITIAL CONDITIONS, TYPE={quoted(kind)[1:-1]}"
        model.deck.refuse(card, "unsupported_type", block.line, "INITIAL CONDITIONS", only="TEMPERATURE")
        return
    _temperatures(model, model.deck.initial, block, scope)


def run(model: Model, steps: list[Step]) -> None:
    """Apply the supports of the model, and all steps up to the chosen step."""
    chosen = _chosen(model, steps)
    state = State()
    amplitudes = {block.parameters.get("NAME", "").upper(): block
                  for step in steps for block, _ in step.blocks if block.name == "AMPLITUDE"}
    for number, step in enumerate(steps[:chosen + 1]):
        _apply(model, step, state, amplitudes, number == chosen)
    _finish(model, state)


def _chosen(model: Model, steps: list[Step]) -> int:
    """Return the index of the chosen step: the step of --step, else the first static step, else the first step."""
    wanted, count = model.deck.options.step or 0, len(steps) - 1
    if wanted > max(count, 1):
        raise NotAllowed("--step", wanted, code="undefined_step", steps=count, plural="s" if count != 1 else "")
    if count == 0:
        return 0
    place: int = wanted or next((at for at, step in enumerate(steps) if at and step.static()), 1)
    model.deck.step = place if steps[place].static() else 0
    for at, step in enumerate(steps):
        if at and at != place:
            what = "before it: what stays of it is taken" if at < place else "it is left out"
            model.deck.leave(f"step {at}", f"step {place} is taken, {what}; --step chooses another", step.line)
    return place


def _apply(model: Model, step: Step, state: State, amplitudes: dict[str, Block], last: bool) -> None:
    """Apply a step. OP=NEW removes the state of earlier steps. A force replaces the force of an earlier step; forces of
    one step add up."""
    if last and step.perturbation and (state.force or state.gravity or state.pressure or state.temperature):
        model.deck.refuse("*STEP, PERTURBATION", "perturbation_step", step.line,
                          "STEP.PERTURBATION")
    renewed: set[str] = set()
    forces: dict[tuple[str, int], tuple[float, int]] = {}
    static = step.static()
    period = 1.0
    if static is not None and static.data:
        values = model.numbers(*static.data[0])
        period = values[1] if len(values) > 1 and values[1] else 1.0
    for block, scope in step.blocks:
        if block.name not in ("BOUNDARY", "CLOAD", "DLOAD", "TEMPERATURE"):
            continue
        if block.parameters.get("OP", "").upper() == "NEW" and block.name not in renewed:
            renewed.add(block.name)
            _clear(state, block.name)
        if block.name == "BOUNDARY":
            _boundary(model, block, scope, state)
        elif (factor := _factor(model, block, amplitudes, period if static else None)) is None:
            continue
        elif block.name == "CLOAD":
            _cload(model, block, scope, forces, factor)
        elif block.name == "DLOAD":
            _dload(model, block, scope, state, factor)
        else:
            _temperatures(model, state.temperature, block, scope)
    state.force.update(forces)


def _clear(state: State, name: str) -> None:
    """Remove supports or loads that earlier steps set by a keyword."""
    if name == "BOUNDARY":
        state.held.clear()
        state.turned.clear()
    elif name == "CLOAD":
        state.force.clear()
    elif name == "DLOAD":
        state.gravity.clear()
        state.pressure.clear()
    else:
        state.temperature.clear()


def _factor(model: Model, block: Block, amplitudes: dict[str, Block], period: float | None) -> float | None:
    """Return the value of AMPLITUDE= at the end of a step, which multiplies loads; None if the amplitude is refused."""
    name = block.parameters.get("AMPLITUDE")
    if name is None:
        return 1.0
    found = amplitudes.get(name.upper())
    if found is None:
        raise model.deck.fail(block.line, "deck_undefined", what_it_is="amplitude", name=quoted(name))
    given = found.parameters
    pairs = [value for line, words in found.data for value in model.numbers(line, words)]
    times, values = pairs[::2], pairs[1::2]
    relative = given.get("VALUE", "RELATIVE").upper() == "RELATIVE" and \
        given.get("DEFINITION", "TABULAR").upper() == "TABULAR" and block.name != "TEMPERATURE"
    constant = len(set(values)) == 1 and len(values) == len(times)  # constant in time, so any type of step may have it
    if not relative or not constant and (period is None or given.get("TIME")):
        model.deck.refuse(f"*{block.name}, AMPLITUDE", "amplitude_at_end_unknown", block.line,
                          f"{block.name}.AMPLITUDE")
        return None
    if len(times) != len(values) or not times or any(b <= a for a, b in zip(times, times[1:])):
        raise model.deck.fail(found.line, "deck_bad_value", "*AMPLITUDE",
                              problem="not pairs of rising times and values")
    model.deck.take("*AMPLITUDE", "factor of loads")
    return float(np.interp(period or 0.0, times, values))


def _boundary(model: Model, block: Block, scope: Scope, state: State) -> None:
    for line, words in block.data:
        nodes = model.nodes_of(line, words[0], scope)
        named = words[1].upper() if len(words) > 1 else ""
        if named in HELD:
            first, last = HELD[named]
        else:
            first = model.whole(line, words[1]) if len(words) > 1 else 0
            last = model.whole(line, words[2]) if len(words) > 2 and words[2] else first
        if first == 0:
            raise model.deck.fail(line, "deck_incomplete", "*BOUNDARY", needed="a direction")
        if len(words) > 3 and words[3] and model.number(line, words[3]) != 0 and (
                first <= 3 or first <= 6 and model.bends()):
            model.deck.refuse("*BOUNDARY", "prescribed_displacement", line, "BOUNDARY.VALUE")
            continue
        if model.bends():
            turns = range(max(first, 4), min(last, 6) + 1)
            for node in nodes:
                state.turned.setdefault(node, set()).update(turns)
            if turns:
                model.deck.take("*BOUNDARY", "directions without rotation, where beams end", len(nodes))
        elif last > 3:
            model.deck.leave("*BOUNDARY", "directions above 3: ends of bars turn freely, temperatures are no supports",
                             line)
        directions = range(first, min(last, 3) + 1)
        for node in nodes if directions else ():
            state.held.setdefault(node, set()).update(directions)
        if directions:
            model.deck.take("*BOUNDARY", "directions without motion", len(nodes))


def _cload(model: Model, block: Block, scope: Scope, forces: dict[tuple[str, int], tuple[float, int]],
           factor: float) -> None:
    for line, words in block.data:
        if len(words) < 3:
            raise model.deck.fail(line, "deck_incomplete", "*CLOAD", needed="node, direction and force")
        direction = model.whole(line, words[1])
        value = factor * model.number(line, words[2])
        if not 1 <= direction <= 6:
            if value:
                model.deck.refuse("*CLOAD", "unsupported_direction", line, "CLOAD.OTHER")
            continue
        for node in model.nodes_of(line, words[0], scope):
            before = forces.get((node, direction), (0.0, line))
            forces[node, direction] = (before[0] + value, before[1])
        model.deck.take("*CLOAD", "dead load")


def _dload(model: Model, block: Block, scope: Scope, state: State, factor: float) -> None:
    for line, words in block.data:
        kind = words[1].upper() if len(words) > 1 else ""
        if kind in ("P1", "P2") and model.bends() and len(words) > 2:
            value = model.number(line, words[2]) * factor
            for one in model.elements_of(line, words[0], scope):
                found = model.sections.get(one.name)
                if one.family != BEAM or found is None or not found.widths[0]:
                    model.deck.refuse(f"*DLOAD, {kind}", "pressure_on_section", line, f"DLOAD.{kind}")
                    break
                state.pressure[one.name, kind] = (value, line)
            model.deck.take("*DLOAD", "pressure on beams: forces and moments of their ends")
            continue
        if kind != "GRAV":
            model.deck.refuse(f"*DLOAD, {quoted(kind)[1:-1]}", "distributed_load", line,
                              f"DLOAD.{kind}")
            continue
        values = (model.numbers(line, words[2:6]) + [0.0] * 4)[:4]
        direction = np.array(values[1:4])
        size = np.linalg.norm(direction)
        if size == 0:
            raise model.deck.fail(line, "deck_incomplete", "*DLOAD", needed="the direction of gravity")
        state.gravity[scope.prefix + words[0].upper() if words[0] else "EALL"] = (
            direction / size * values[0] * factor, line)
        model.deck.take("*DLOAD", "gravity")


def _temperatures(model: Model, found: dict[str, float], block: Block, scope: Scope) -> None:
    for line, words in block.data:
        if len(words) < 2:
            raise model.deck.fail(line, "deck_incomplete", f"*{block.name}", needed="node and temperature")
        values = model.numbers(line, words[1:])
        if any(values[1:]):
            model.deck.refuse(f"*{block.name}", "temperature_gradient", line,
                              f"{block.name}.GRADIENT")
        for node in model.nodes_of(line, words[0], scope):
            found[node] = values[0]
        model.deck.take(f"*{block.name}", "temperature of links")


def _finish(model: Model, state: State) -> None:
    """Write the supports and loads after the last applied step into the deck, in the basic coordinate system."""
    deck = model.deck
    deck.temperature.update(state.temperature)
    model.pressures.update(state.pressure)
    for node, directions in state.held.items():
        if node in model.frames:
            axes = model.frames[node].directions(deck.nodes[node])
            for at in sorted(directions):
                deck.hold(node, axes[at - 1])
        else:
            deck.fix(node, "".join("xyz"[at - 1] for at in sorted(directions)))
    for node, directions in state.turned.items():
        axes = model.frame(node).directions(deck.nodes[node])
        for at in sorted(directions):
            deck.hold_rotation(node, axes[at - 4])
    for (node, direction), (value, line) in state.force.items():
        axis = model.frame(node).directions(deck.nodes[node])[(direction - 1) % 3]
        if value and direction > 3:
            deck.moments.append(Moment(line, "*CLOAD", node, axis * value, "CLOAD.MOMENT"))
        elif value:
            deck.load(node, [float(part) * value for part in axis], line, "*CLOAD")
    if state.gravity:
        _gravity(model, state)


def _gravity(model: Model, state: State) -> None:
    """Raise an error unless the same gravity acts on all items that have mass."""
    acting: dict[str, np.ndarray] = {}
    for group, (vector, line) in state.gravity.items():
        for one in model.elements_of(line, group, Scope()):
            acting[one.name] = acting.get(one.name, np.zeros(3)) + vector
    heavy = [one.name for one in model.elements.values() if one.family == MASS or one.family in (BAR, BEAM)
             and one.name in model.sections and model.sections[one.name].material.density]
    vectors = [acting.get(name, np.zeros(3)) for name in heavy]
    if any((one != vectors[0]).any() for one in vectors):
        model.deck.refuse("*DLOAD, GRAV", "gravity_on_part",
                          next(line for _, line in state.gravity.values()), "DLOAD.GRAV")
    elif vectors:
        model.deck.gravity[:] = [float(part) for part in vectors[0]]


def equation(model: Model, block: Block, scope: Scope) -> None:
    """Read the equations of one block: number of terms, then node, direction and factor of each term."""
    rest = [(line, words) for line, words in block.data]
    while rest:
        begun, words = rest.pop(0)
        count = model.whole(begun, words[0])
        parts: list[str] = []
        while rest and len(parts) < 3 * count:
            parts += [word for word in rest.pop(0)[1] if word]
        if len(parts) != 3 * count:
            raise model.deck.fail(begun, "deck_incomplete", "*EQUATION", needed=f"{count} terms")
        _add(model, begun, [parts[at:at + 3] for at in range(0, 3 * count, 3)], scope)


def _add(model: Model, line: int, parts: list[list[str]], scope: Scope) -> None:
    made = Equation(line, "*EQUATION", [])
    for word, direction, factor in parts:
        nodes = model.nodes_of(line, word, scope)
        at, value = model.whole(line, direction), model.number(line, factor)
        if len(nodes) != 1 or not 1 <= at <= 6:
            model.deck.refuse("*EQUATION", "node_sets" if len(nodes) != 1 else "rotation", line, "EQUATION")
            return
        for node in nodes:
            if value:
                terms = made.terms if at <= 3 else made.turns
                terms.append((node, model.frame(node).directions(model.deck.nodes[node])[(at - 1) % 3], value))
    model.deck.equations.append(made)
