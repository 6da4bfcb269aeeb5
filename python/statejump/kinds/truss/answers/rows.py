# SPDX-License-Identifier: GPL-3.0-or-later
"""Rows of the tables with the answers on a truss, for CSV, JSON and result files."""
from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from statejump.core.units import unit_of
from statejump.kinds.truss.answers import reflector
from statejump.kinds.truss.answers.contributions import Contributions
from statejump.kinds.truss.answers.jumps import node_jumps
from statejump.kinds.truss.answers.outputs import cycle_ends_m
from statejump.kinds.truss.answers.sensitivity import Sensitivity
from statejump.kinds.truss.body_points import displacements_m
from statejump.kinds.truss.joints import JOINTS
from statejump.kinds.truss.solve import TrussPath, heat_of_joints_J

Row = dict[str, Any]


def cycle_rows(found: TrussPath) -> list[Row]:
    """Return what happens over each cycle."""
    ends = found.cycle_ends
    largest = np.linalg.norm(np.diff(ends["displacement_m"], axis=0), axis=2).max(axis=1)
    heat = np.diff(heat_of_joints_J(ends).sum(axis=1))
    return [
        {"cycle": cycle, "largest_jump_m": float(jump), "dissipation_J": float(warmth)}
        for cycle, (jump, warmth) in enumerate(zip(largest, heat), start=1)
    ]


def node_rows(found: TrussPath) -> list[Row]:
    """Return the jump of every node after each cycle."""
    return [
        {"node": name, "cycle": cycle, **{f"jump_{axis}_m": float(value) for axis, value in zip("xyz", jump)},
         "jump_m": float(np.linalg.norm(jump))}
        for cycle, jumps in enumerate(node_jumps(found), start=1)
        for name, jump in zip(found.truss.nodes.names, jumps)
    ]


def joint_rows(found: TrussPath) -> list[Row]:
    """Return the slide or eccentricity of every joint after each cycle, its jump, and its frictional heat."""
    ends, truss = found.cycle_ends, found.truss
    rows = []
    for cycle in range(1, len(ends["time_s"])):
        for joint in JOINTS:
            column, joints = joint.columns[0], truss.joints[joint.section]
            if unit_of(column.name) != "m":  # a rotation, not a displacement
                continue
            place, heat = ends[column.name], ends[f"{joint.section}_dissipation_J"]
            for index, name in enumerate(joints.names):
                moved = place[cycle, index] - place[0, index]
                jump = moved if column.vector else moved * joints.axis[index]
                rows.append({
                    "joint": name, "kind": joint.section, "cycle": cycle,
                    **{f"jump_{axis}_m": float(value) for axis, value in zip("xyz", jump)},
                    "jump_m": float(np.linalg.norm(jump)),
                    "dissipation_of_cycle_J": float(heat[cycle, index] - heat[cycle - 1, index]),
                    "dissipation_J": float(heat[cycle, index]),
                })
    return rows


def surface_rows(found: TrussPath, surface: reflector.Surface) -> list[Row]:
    """Return the best-fit paraboloid at the start, at the hottest point and after every cycle, as rows."""
    states, ends = found.states, found.cycle_ends
    hottest = int(np.argmax(states["temperature_change_K"]))
    hot = displacements_m(found.truss, {name: values[hottest:hottest + 1] for name, values in states.items()})[0]
    after = cycle_ends_m(found)
    asked = [("start", 0.0, after[0]), ("hottest", float(states["temperature_change_K"][hottest]), hot)]
    asked += [(f"after cycle {cycle}", float(ends["temperature_change_K"][cycle]), after[cycle])
              for cycle in range(1, len(ends["time_s"]))]
    start = surface.fit(after[0])
    rows = []
    for when, change, moved in asked:
        fit = surface.fit(moved)
        shift = None if fit.focal_length_m is None or start.focal_length_m is None else (
            fit.focal_length_m - start.focal_length_m)
        rows.append({
            "state": when, "temperature_change_K": change, "rms_error_m": fit.rms_error_m,
            "rms_of_change_m": float(np.sqrt(np.mean((fit.residual_m - start.residual_m) ** 2))),
            "tilt_change_rad": float(np.linalg.norm(fit.tilt_rad - start.tilt_rad)),
            "focal_length_m": fit.focal_length_m, "focal_shift_m": shift,
            "depth_change_m": fit.depth_m - start.depth_m,
        })
    return rows


def contribution_rows(shares: Contributions) -> list[Row]:
    """Return the joints by rank."""
    return [
        {"rank": rank, "joint": shares.names[joint], "kind": shares.kinds[joint],
         "contribution": float(shares.contribution[joint]), "share": float(shares.contribution[joint] / shares.jump)}
        for rank, joint in enumerate(shares.order, start=1)
    ]


def sensitivity_rows(found: Sequence[Sensitivity], jump: float) -> list[Row]:
    """Return the sensitivities. ``elasticity``: relative change of the jump per relative change of the parameter."""
    return [
        {"parameter": row.parameter, "items": row.items, "value": row.value,
         "elasticity": _known(row.per_relative_change / jump), "elasticity_half_step": _known(row.half_step / jump),
         "jump_change_per_unit": _known(row.per_unit), "verdict": row.verdict}
        for row in found
    ]


def _known(value: float | None) -> float | None:
    return None if value is None or math.isnan(value) else value
