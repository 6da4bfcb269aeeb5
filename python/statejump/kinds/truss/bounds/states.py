# SPDX-License-Identifier: GPL-3.0-or-later
"""Whether stops, plays and cables keep their state over all rest states, so that the truss is linear between them."""
from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Protocol

import numpy as np

from statejump.core.errors import StatejumpError
from statejump.kinds.truss.bounds.outputs import Linear
from statejump.kinds.truss.bounds.sliding import Sliding
from statejump.kinds.truss.joints import JOINTS

# Half ranges of linear functions of the dofs (rows, dofs), including the margin of exact geometry.
Ranges = Callable[[np.ndarray], np.ndarray]


class Placed(Linear, Protocol):
    """A truss at an equilibrium."""

    @property
    def displacement_m(self) -> np.ndarray:
        """Displacements (nodes, 3) from the reference configuration."""


def changing(of: Sliding, ranges: Ranges) -> StatejumpError | None:
    """Return the refusal of a stop, play or cable that may change its state; None: all keep it."""
    try:
        kept_states(of, ranges)
    except StatejumpError as refused:
        return refused
    return None


def kept_states(of: Sliding, ranges: Ranges) -> list[str]:
    """Return one sentence for each kind of stop, play or cable that keeps its state in all rest states.

    :param ranges: half ranges of linear functions of the dofs in all rest states
    :raises StatejumpError: one may change its state
    """
    return [*_sliders(of, ranges), *_hinges(of, ranges), *kept_cables(of, ranges)]


def _refuse(of: Placed, part: str, change: str) -> StatejumpError:
    return StatejumpError(code="bounds_of_stop", place=of.truss.name, case=of.truss.name, part=part, change=change)


def _of_section(of: Sliding, section: str) -> np.ndarray:
    return np.array([index for index, joint in enumerate(of.joints) if joint.section == section], dtype=int)


def _sliders(of: Sliding, ranges: Ranges) -> Iterator[str]:
    which, sliders = _of_section(of, "slider"), of.truss.sliders
    stopped = np.flatnonzero(sliders.have_stops)
    if not len(stopped):
        return
    which = which[stopped]
    slide, half = of.slide_m[which], ranges(of.slides[which].toarray())
    # A stop that is just reached is not certainly open.
    hits = ((slide + half >= sliders.clearance_plus_m[stopped])
            | (slide - half <= -sliders.clearance_minus_m[stopped]))
    for index in np.flatnonzero(hits)[:1]:
        raise _refuse(of, str(of.joints[which[index]]), "reach a stop")
    yield "stops of sliders stay open in all rest states"


def _hinges(of: Sliding, ranges: Ranges) -> Iterator[str]:
    for section in (joint.section for joint in JOINTS if joint.turns):
        which, hinges = _of_section(of, section), of.truss.joints[section]
        if not len(which):
            continue
        rotation = of.slide_m[which] / of.radius_m[which]
        half = ranges(of.slides[which].toarray()) / of.radius_m[which]
        edge, stiff = hinges.deadband_rad, hinges.stiffness_N_m_per_rad > 0
        inside, beyond = np.abs(rotation) + half < edge, np.abs(rotation) - half > edge
        for index in np.flatnonzero(stiff & (edge > 0) & ~inside & ~beyond)[:1]:
            raise _refuse(of, str(of.joints[which[index]]), "cross the edge of its play")
        if (stiff & (edge > 0)).any():
            yield f"plays of {section.replace('_', ' ')}s keep their state in all rest states"


def kept_cables(of: Placed, ranges: Ranges) -> Iterator[str]:
    """Yield one sentence for cables that stay slack, and one for those that stay taut.

    :raises StatejumpError: one may change its state
    """
    springs = of.truss.springs
    cables = np.flatnonzero(springs.cable)
    if not len(cables):
        return
    nodes, place = springs.nodes[cables], of.truss.nodes.position_m + of.displacement_m
    span = place[nodes[:, 1]] - place[nodes[:, 0]]
    length = np.linalg.norm(span, axis=1)
    rows = np.array([_elongation(of, pair, along) for pair, along in zip(nodes, span / length[:, None])])
    half, stretch = ranges(rows), length - springs.free_length_m[cables]
    # A rotation across the cable lengthens it by w²/2L.
    across = np.array([sum(ranges(np.array([_elongation(of, pair, axis)]))[0] ** 2 for axis in np.eye(3))
                       for pair in nodes]) / (2 * length)
    slack, taut = stretch + half + across < 0, stretch - half > 0
    for index in np.flatnonzero(~slack & ~taut)[:1]:
        raise _refuse(of, f"cable '{springs.names[cables[index]]}'", "become slack or taut")
    if slack.any():
        yield f"{int(slack.sum())} cable(s) stay slack in all rest states"
    if taut.any():
        yield f"{int(taut.sum())} cable(s) stay taut in all rest states"


def _elongation(of: Placed, pair: np.ndarray, along: np.ndarray) -> np.ndarray:
    """Return the row of the distance of two nodes along a unit vector."""
    first, second = (of.of_nodes[3 * node:3 * node + 3].T @ along for node in pair)
    return np.asarray(second - first)
