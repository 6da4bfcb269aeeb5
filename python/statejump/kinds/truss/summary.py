# SPDX-License-Identifier: GPL-3.0-or-later
"""Texts of a ``truss`` case, and the output of commands about its runs."""
from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from statejump.core.run import Run
from statejump.core.start import FRICTIONLESS
from statejump.core.tables import Shown
from statejump.kinds.truss import compare
from statejump.kinds.truss.case import TrussCase
from statejump.kinds.truss.elements import ELEMENTS
from statejump.kinds.truss.joints import JOINTS
from statejump.kinds.truss.joints.protocol import count, spread
from statejump.kinds.truss.motion import TrussMotion
from statejump.kinds.truss.result import AT_END
from statejump.kinds.truss.sections import Node


def is_held(case: TrussCase, node: Node) -> bool:
    """Whether a node cannot move at all."""
    return len(set(node.fixed)) == case.truss.dimension


def is_guided(case: TrussCase, node: Node) -> bool:
    """Return whether a node can move in some directions but not in all directions."""
    return bool(node.fixed or node.guide_normal) and not is_held(case, node)


def describe(case: TrussCase) -> list[str]:
    """Describe the case in sentences, without the temperature program, which code common to all kinds describes."""
    kind = {2: "plane", 3: "spatial"}[case.truss.dimension]
    held = [node for node in case.node if is_held(case, node)]
    guided = [node for node in case.node if is_guided(case, node)]
    sentences = [
        f"A {kind} truss of {count(case.node, 'node')} and {count(case.link, 'link')}; {count(held, 'node')} "
        f"{'is' if len(held) == 1 else 'are'} held" + (f", {len(guided)} guided" if guided else "") + "."
    ]
    sentences += [*_joints(case), *_tied(case)]
    loads = [sum(part**2 for part in node.force_N) ** 0.5 for node in case.node if node.force_N]
    if any(loads):
        sentences.append(f"Dead loads of {spread(loads, 'N')} on {count(loads, 'node')}.")
    shares = [link.temperature_fraction for link in case.link]
    if set(shares) - {1.0}:
        sentences.append(f"Links are shaded: they take {spread(shares, digits=3)} of the temperature change.")
    if case.thermal.members is not None:
        members = case.thermal.members
        sentences.append(f"{len(members.names)} members have temperature histories of their own, of "
                         f"{len(members.time_s)} times; they change by {members.temperature_change_K.min():.4g} to "
                         f"{members.temperature_change_K.max():.4g} K.")
    if case.program:
        sentences.append(f"{count(case.program, 'further temperature program')} for members that name one.")
    return sentences


def _joints(case: TrussCase) -> list[str]:
    found = ((joint, joint.listed(case)) for joint in JOINTS)
    sentences = [joint.describe(items) for joint, items in found if items]
    if case.start.friction == FRICTIONLESS:
        sentences.append("Loads and preloads act before friction does: joints start without friction.")
    if case.reduced_settings.sticking == "elastic":
        sentences.append("Joints of the reduced model stick elastically, as those of the DEM.")
    if case.reduced_settings.sticking == "partial_slip":
        sentences.append("Sliders and revolutes of the reduced model slide at the rim of their contacts before they "
                         "slide as a whole.")
    return sentences


def _tied(case: TrussCase) -> list[str]:
    found: list[tuple[Sequence[Any], str]] = [
        (items, noun) for element in ELEMENTS for items, noun in element.counted(element.listed(case))]
    found += [(case.constraint, "constraint"), (case.mean, "mean")]
    tied = [count(items, noun) for items, noun in found if items]
    return [f"It has {' and '.join(filter(None, [', '.join(tied[:-1]), tied[-1]]))}."] if tied else []


def _what(case: TrussCase) -> str:
    """Return the noun for the change from the start to the end of a run: the jump or another change."""
    if case.ending is None:
        return f"state jump after {case.thermal.cycles} cycle(s)"
    if case.ending.returns:
        return f"state jump after {case.thermal.cycles} cycle(s) and the return"
    return f"displacement at the program's end, {case.ending.temperature_change_K:.6g} K, no state jump"


def summary_lines(case: TrussCase, runs: Mapping[str, Run]) -> list[Shown | str]:
    """Return the lines that summarise runs: the nodes with the largest jumps, events, energy residue."""
    first, *others = runs.values()
    axes = "xyz"[: case.truss.dimension]
    header = ["node", *(f"along {axis} [m]" for axis in axes), "length [m]", *("DEM, length [m]" for _ in others)]
    lengths = [np.linalg.norm(compare.jumps_m(run), axis=1) for run in others]
    numbers = {node.name: place for place, node in enumerate(case.node)}
    rows = [
        [name, *(f"{value:.6e}" for value in (*jump[: len(axes)], length, *(size[numbers[name]] for size in lengths)))]
        for name, *jump, length in compare.jump_table(case, first)
    ]
    found: list[Shown | str] = [
        Shown(f"{case.title}: {_what(case)}", header, rows, left=("node",)) if rows
        else f"{case.title}: no node moves by more than rounding between start and end"]
    if AT_END in first.summary and case.has_jump:
        found.append(f"largest displacement at the program's end: {first.summary[AT_END]:.6e} m")
    for model, run in runs.items():
        label = {"reduced": compare.reduced_name(run), "dem": "DEM"}[model] + ": " if others else ""
        found.append(f"{label}{len(run.events)} events, energy residue {run.summary['energy_residue_J']:.3g} J")
    if first.native is not None and not others:
        path = first.native
        done = (f"{path.steps:,} steps, {path.iterations:,} contact problems" if isinstance(path, TrussMotion)
                else f"{path.solves:,} solves")
        found.append(f"{done}, {len(path.events)} changes of joints, {path.unknowns} unknowns")
    return found
