# SPDX-License-Identifier: GPL-3.0-or-later
"""Possible reasons why a truss misses a tolerance, and the slowest natural period of a truss."""
from __future__ import annotations

from collections.abc import Iterator
from math import inf, pi, sqrt
from typing import Any

import numpy as np
from scipy.sparse import coo_matrix, diags
from scipy.sparse.linalg import ArpackError, eigsh

from statejump.core import physics
from statejump.core.run import Run
from statejump.core.why_missed import SHARE_TOLD, heated_too_fast, still_moving
from statejump.kinds.truss.arrays import GROUND
from statejump.kinds.truss.case import TrussCase
from statejump.kinds.truss.dem import blocked_directions
from statejump.kinds.truss.elements import ELEMENTS
from statejump.kinds.truss.elements.protocol import ElementType
from statejump.kinds.truss.masses import lumped_mass_kg
from statejump.kinds.truss.joints import JOINTS
from statejump.kinds.truss.resolved import ResolvedTruss
from statejump.kinds.truss.scales import COMPARED, scales
from statejump.kinds.truss.solve import TrussPath, engine_program, solve

# Fraction of the stiffness of the stiffest element below which a stiffness is rounding.
LEAST_STIFFNESS = 1e-12


def why_missed(case: TrussCase, exact: Run, dem: Run, jump_scale_m: float) -> list[str]:
    """Return possible reasons for a missed tolerance, one sentence each.

    :param jump_scale_m: reference for differences of jumps [m]
    """
    if "kinetic_energy_J" in exact.energy:  # in motion, as the DEM
        return []
    path = solve(case)
    mass, period = lumped_mass_kg(path.truss), slowest_natural_period_s(path)
    moved = float(np.linalg.norm(np.ptp(exact["displacement_m"], axis=0), axis=1).max())
    tolerance = case.tolerance
    least = COMPARED * scales(path.truss, exact["displacement_m"]).motion_m
    allowed = min(tolerance.displacement_relative * max(moved, least), tolerance.jump_relative * jump_scale_m)
    found = heated_too_fast(period, case.thermal, engine_program(case.thermal), moved, allowed)
    found += still_moving(dem, float(mass.sum()), period, allowed)
    if case.reduced_settings.sticking == "rigid" and path.truss.number_of_joints():
        found.append("joints of the reduced model stick rigidly, those of the DEM give before they slip: set "
                     "reduced.sticking to 'elastic'")
    slips = {"elastic": "mindlin", "partial_slip": "mindlin_deresiewicz"}.get(case.reduced_settings.sticking)
    if slips is not None and slips != case.dem_settings.friction_law and path.truss.number_of_joints():
        found.append(f"contacts of the reduced model and of the DEM slip by different laws: set dem.friction_law to "
                     f"{slips!r}, as reduced.sticking is {case.reduced_settings.sticking!r}")
    for joint in JOINTS:
        found += joint.gives_in_dem(path, path.truss.joints[joint.section], SHARE_TOLD * allowed)
    return found


def slowest_natural_period_s(path: TrussPath) -> float:
    """Return the longest natural period [s] of a truss whose joints all stick, at the start of its path.

    Masses are lumped as in the DEM. Links, springs, torsion springs and contacts act as springs, and tension adds
    lateral stiffness. The period is infinite if a part of the truss has no stiffness.
    """
    truss = path.truss
    mass = np.repeat(lumped_mass_kg(truss), 3)
    free = np.flatnonzero((mass > 0) & ~blocked_directions(truss).ravel())
    if not len(free):
        return 0.0
    stiffness = _stiffness(path)[free][:, free]
    largest = float(abs(stiffness).max())
    # The shift keeps eigenvalues positive that rounding makes negative.
    shift = -LEAST_STIFFNESS * largest / float(mass[free].max())
    if len(free) <= 2:  # too few for Lanczos
        scaled = diags(mass[free] ** -0.5)
        least = float(np.linalg.eigvalsh((scaled @ stiffness @ scaled).toarray())[0])
    else:
        try:
            least = float(eigsh(stiffness.tocsc(), k=1, M=diags(mass[free]).tocsc(), sigma=shift,
                                return_eigenvectors=False)[0])
        except (ArpackError, RuntimeError):
            return inf
    return inf if least <= -10 * shift else 2 * pi / sqrt(least)


def _moments(element: ElementType[Any, Any], truss: ResolvedTruss) -> Iterator[tuple[np.ndarray, np.ndarray, float]]:
    torsion = element.torsion(truss.elements[element.section])
    return zip(torsion.links, torsion.axis, torsion.stiffness_N_m_per_rad)


def _stiffness(path: TrussPath) -> Any:
    """Return the stiffness matrix (3n, 3n) [N/m] of the truss at the start of its path."""
    truss, count = path.truss, len(path.truss.nodes.names)
    position = truss.nodes.position_m + path.states["displacement_m"][0]
    found = coo_matrix((3 * count, 3 * count)).tocsr()

    def along(nodes: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        way = position[nodes[:, 1]] - position[nodes[:, 0]]
        length = np.linalg.norm(way, axis=1)
        return way / length[:, None], length

    def between(nodes: np.ndarray, blocks: np.ndarray) -> Any:
        """Return stiffness matrices (k, 3, 3) of springs between pairs of nodes, or from a single node to ground."""
        sides = [(one, other, 1.0 if one == other else -1.0)
                 for one in range(nodes.shape[1]) for other in range(nodes.shape[1])]
        rows, columns, values = [], [], []
        for one, other, sign in sides:
            row, column = np.meshgrid(np.arange(3), np.arange(3), indexing="ij")
            there = (nodes[:, one] != GROUND) & (nodes[:, other] != GROUND)
            rows.append((3 * nodes[there, one, None, None] + row).ravel())
            columns.append((3 * nodes[there, other, None, None] + column).ravel())
            values.append(sign * blocks[there].ravel())
        places = np.concatenate(rows), np.concatenate(columns)
        return coo_matrix((np.concatenate(values), places), shape=found.shape).tocsr()

    links = truss.links
    axial = physics.axial_stiffness_N_per_m(links.young_modulus_Pa, links.cross_section_area_m2,
                                            links.stress_free_length_m)
    for nodes, k, tensions in zip(truss.ends(), (axial, *truss.element_stiffnesses_N_per_m()),
                                  truss.tensions_N(path.states)):
        if len(nodes):
            tension = tensions[0]
            way, length = along(nodes)
            outer = way[:, :, None] * way[:, None, :]
            found = found + between(nodes, k[:, None, None] * outer
                                    + (tension / length)[:, None, None] * (np.eye(3) - outer))
    for joint in JOINTS:
        if len(truss.joints[joint.section].names) and not joint.not_in_dem:
            nodes, k = joint.contact_stiffness(path, truss.joints[joint.section])
            found = found + between(nodes, k[:, None, None] * np.eye(3))
    for ends, axis, moment in (moment for element in ELEMENTS for moment in _moments(element, truss)):
        gradient = np.zeros(3 * count)
        for sign, link in zip((-1.0, 1.0), ends if ends[1] != GROUND else ends[::-1]):
            if link == GROUND:
                continue
            way, length = along(links.nodes[[link]])
            turn = np.cross(axis, way[0]) / length[0]
            for node, side in zip(links.nodes[link], (-1.0, 1.0)):
                gradient[3 * node:3 * node + 3] += sign * side * turn
        column = coo_matrix(gradient[:, None])
        found = found + moment * (column @ column.T).tocsr()
    return found
