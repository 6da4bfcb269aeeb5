# SPDX-License-Identifier: GPL-3.0-or-later
"""Points of condensed bodies that are no interface nodes. They follow the interface nodes by the recovery rows of their
body, in its frame, and carry no force. In lists of nodes and points, points come after all nodes."""
from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from statejump.kinds.truss.resolved import ResolvedTruss
from statejump.kinds.truss.solve import engine_programs


def point_names(truss: ResolvedTruss) -> list[str]:
    """Return the names of all points, "BODY/POINT", in the order of the bodies."""
    bodies = truss.elements["body"]
    return [f"{name}/{point}" for name, content in zip(bodies.names, bodies.contents) if content.points is not None
            for point in content.points.names]


def positions_m(truss: ResolvedTruss) -> np.ndarray:
    """Return the positions (n, 3) of nodes and points in the reference configuration [m]."""
    found = [truss.nodes.position_m]
    bodies = truss.elements["body"]
    found += [body.positions_of(content.points.positions_m) for content, body in zip(bodies.contents, bodies.placed)
              if content.points is not None]
    return np.concatenate(found)


def displacements_m(truss: ResolvedTruss, states: Mapping[str, np.ndarray]) -> np.ndarray:
    """Return the displacements (states, n, 3) of nodes and points [m].

    :param states: ``displacement_m``, ``time_s`` and, where nodes rotate, ``rotation_rad``
    """
    moved = states["displacement_m"]
    bodies, found = truss.elements["body"], [moved]
    if not any(content.points is not None for content in bodies.contents):
        return moved
    programs = [program.temperature_change(states["time_s"]) for program in engine_programs(truss)]
    turned = states.get("rotation_rad", np.zeros_like(moved))
    for index, (content, nodes, body) in enumerate(zip(bodies.contents, bodies.nodes, bodies.placed)):
        if content.points is None:
            continue
        heat = np.zeros((len(moved), len(content.pattern_names)))
        for pattern, program, share in zip(bodies.patterns[index], bodies.programs[index],
                                           bodies.temperature_fractions[index]):
            heat[:, pattern] += bodies.expansion_factor[index] * share * programs[program]
        found.append(body.moved_points(content.points, moved[:, nodes], turned[:, nodes], heat))
    return np.concatenate(found, axis=1)
