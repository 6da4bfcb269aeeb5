# SPDX-License-Identifier: GPL-3.0-or-later
"""Control of the state jump of a rib whose joint is loaded from the start: the quasi-static path."""
from __future__ import annotations

from dataclasses import dataclass
from collections.abc import Callable
from math import pi
from typing import Any

import numpy as np

from statejump import _engine, laws
from statejump.control.study import Line, Row, Study, Sweep, bisect, grid, highest, number, ranges_that_pass
from statejump.core.errors import StatejumpError
from statejump.core.progress import OnProgress
from statejump.kinds.umbrella import reduced as model
from statejump.kinds.umbrella.case import UmbrellaCase
from statejump.kinds.umbrella.quasi_static import has_elastic_loop
from statejump.schema.paths import with_values
from studies.paper import ensembles
from studies.rib_control.parameters import AREA, BIAS, CLEARANCE, FRICTION, SPRING, changes


@dataclass(frozen=True)
class LoadedJump:
    """Quasi-static jump of one design; None: the contact opens, or no equilibrium exists."""

    rigid_rad: float | None
    elastic_rad: float | None
    slips_rigid: bool
    slips_elastic: bool
    note: str
    has_elastic: bool  # whether the model with elastic links supports the contact laws
    elastic: Any  # its path, if it has one

    @property
    def size_rad(self) -> float | None:
        """Jump [rad] from the model with elastic links or, if it is not available, with rigid links."""
        return self.elastic_rad if self.has_elastic else self.rigid_rad

    @property
    def slips(self) -> bool:
        """Whether the joint slips anywhere, by the same model as ``size_rad``."""
        return self.slips_elastic if self.has_elastic else self.slips_rigid


def _slips(loop: Any) -> bool:
    return any(event["motion"] == "slip" for event in loop.events)


def loaded_jump(case: UmbrellaCase) -> LoadedJump:
    """Return the jump of θ2 on the quasi-static path, with rigid links and, if the contact laws permit, with elastic
    links.

    The friction law of the case determines the tangential compliance.
    """
    notes: list[str] = []

    def path(compute: Callable[[], Any]) -> tuple[Any, float | None, bool]:
        try:
            loop = compute()
        except _engine.EngineFailure as problem:
            unloaded = problem.kind == "unloaded_joint"
            notes.append("too weak to load the joint at the start" if unloaded else str(problem))
            return None, None, False
        if loop.separated:
            notes.append("contact lost: the position in the play is undetermined")
            return loop, None, _slips(loop)
        # Rounding of an angle counts as no jump.
        jump = abs(loop.theta2_jump_rad)
        return loop, (0.0 if jump < 1e-14 else jump), _slips(loop)

    program, angle = case.thermal_program(), case.start.contact_angle_rad
    _, rigid, slips_rigid = path(lambda: _engine.joint_loop(model.linkage(case), program, angle, 100))
    elastic, jump, slips, covered = None, None, False, has_elastic_loop(case)
    if covered:
        compliance = "mindlin" if laws.law("friction", case.joint.friction_law).has_memory else "rigid"
        elastic, jump, slips = path(
            lambda: _engine.elastic_loop(model.linkage(case), program, angle, 400, compliance)
        )
    return LoadedJump(rigid, jump, slips_rigid, slips, "; ".join(dict.fromkeys(notes)), covered, elastic)


def smallest_friction_that_rolls(case: UmbrellaCase) -> float | None:
    """Return the smallest μ for which the loaded joint slips in no model; None: it slips even with the largest allowed
    μ.

    A path without slip does not change with larger μ, so there is a single threshold. It is found to 1e-9 of its value.
    """

    def rolls(friction: float) -> bool:
        jump = loaded_jump(with_values(case, {FRICTION: friction}))
        return jump.size_rad is not None and not jump.slips_rigid and not jump.slips_elastic

    most = highest(case, FRICTION)
    return bisect(rolls, abs(np.tan(case.start.contact_angle_rad)), most, 1e-9)[1] if rolls(most) else None


def axial_forces_N(elastic: Any) -> tuple[np.ndarray, np.ndarray]:
    """Return the axial forces of AB and BC along a path [N], tension positive.

    The joint force is parallel to AC: F acts on the bearing at the tip of AB, −F on the journal.
    """
    path = elastic.columns()
    force = np.hypot(path["normal_force_N"], path["tangential_force_N"]) * np.sign(path["eccentricity_x_m"])
    return force * np.cos(path["theta2_rad"]), -force * np.cos(path["theta4_rad"])


def link_loads(case: UmbrellaCase, elastic: Any) -> dict[str, float]:
    """Return largest compression [N], its ratio to the Euler load (pinned ends, square section), and largest strain."""
    result = {"compression_N": 0.0, "over_euler_load": 0.0, "strain": 0.0}
    for link, axial in zip((case.link_ab, case.link_bc), axial_forces_N(elastic)):
        rigidity = link.young_modulus_Pa * link.cross_section_area_m2
        euler = rigidity * link.cross_section_area_m2 / 12 * (pi / link.stress_free_length_m) ** 2
        most = float(max(-np.min(axial), 0.0))
        result["compression_N"] = max(result["compression_N"], most)
        result["over_euler_load"] = max(result["over_euler_load"], most / euler)
        result["strain"] = max(result["strain"], float(np.max(np.abs(axial))) / rigidity)
    return result


LOADED_RESULTS = {
    "jump_elastic_rad": "elastic links, |jump| [µrad]",
    "jump_rigid_rad": "rigid links, |jump| [µrad]",
}
LINES: dict[str, Line] = {
    "jump_elastic_rad": ("elastic links", dict(color="#E69F00", linewidth=4.0, solid_capstyle="round")),
    "jump_rigid_rad": ("rigid links", dict(color="#000000", linewidth=1.2, linestyle=(0, (5, 2)))),
}
LARGEST_STRAIN = 0.01  # strain of the links above which the small-strain model is invalid


def _loaded_row(case: UmbrellaCase, parameter: str, value: float) -> Row:
    design = with_values(case, changes(case, parameter, value))
    jump = loaded_jump(design)
    note = jump.note
    if not note:
        note = "slips" if jump.slips else "rolls: no slip"
    if jump.elastic and link_loads(design, jump.elastic)["strain"] > LARGEST_STRAIN:
        return Row(value, {"jump_rigid_rad": jump.rigid_rad}, f"links strained above {LARGEST_STRAIN:g}")
    return Row(value, {"jump_elastic_rad": jump.elastic_rad, "jump_rigid_rad": jump.rigid_rad}, note)


def _loaded_size(case: UmbrellaCase, row: Row) -> float | None:
    """Return the jump [rad] from the model with elastic links or, if it is not available, with rigid links."""
    return row.results.get("jump_elastic_rad" if has_elastic_loop(case) else "jump_rigid_rad")


def _loaded_sweeps(case: UmbrellaCase) -> list[Sweep]:
    friction, clearance = case.joint.friction_coefficient, case.joint.radial_clearance_m
    stiffness, bias = case.torsion_spring.stiffness_N_m_per_rad, case.torsion_spring.bias_rad
    area = case.link_ab.cross_section_area_m2
    start = abs(np.tan(case.start.contact_angle_rad))
    most = min(highest(case, FRICTION), max(1.5 * (smallest_friction_that_rolls(case) or 1.0), 1.2 * friction))
    frictions = sorted({start, friction, *np.linspace(start, most, 60)[1:].tolist()})
    room = pi - case.flare_angle_rad if bias > 0 else case.flare_angle_rad
    # Up to half of the bias at which the links would be collinear.
    biases = [float(np.copysign(value, bias))
              for value in grid(abs(bias), abs(bias) / 50, min(10 * abs(bias), room / 2), 33)]
    plan = [
        (FRICTION, "Friction coefficient μ", "-", 1.0, friction, frictions, "linear"),
        (AREA, "Section of AB, BC with it; E acts alike", "mm²", 1e6, area,
         grid(area, area / 300, 100 * area, 33), "log"),
        (SPRING, "Torsion spring K_M", "N m/rad", 1.0, stiffness,
         grid(stiffness, stiffness / 100, 2e4 * stiffness, 57), "log"),
        (BIAS, "Bias (preload) of the spring", "rad", 1.0, bias, sorted(biases), "linear"),
        (CLEARANCE, "Radial clearance c", "mm", 1e3, clearance,
         grid(clearance, clearance / 30, 10 * clearance, 97), "log"),
    ]
    if not has_elastic_loop(case):
        plan = [entry for entry in plan if entry[0] != AREA]
    return [
        Sweep(key, label, unit, scale, own, [_loaded_row(case, key, value) for value in values], axis)
        for key, label, unit, scale, own, values, axis in plan
    ]


def study(case: UmbrellaCase, wanted: float | None, with_dem: bool, on_progress: OnProgress) -> Study:
    """Study a joint that a biased spring loads from the start."""
    now = loaded_jump(case)
    if now.size_rad is None:
        raise StatejumpError(code="no_quasi_static_jump", case=case.name, cause=now.note)
    if wanted is None and now.size_rad > 0:
        wanted = now.size_rad / 2
    links = (
        "elastic links and Hertz contact, rigid links beside it" if now.has_elastic else "rigid links"
    )
    result = Study(
        f"a biased torsion spring loads the joint: jump of theta2 on the quasi-static path, exact Coulomb "
        f"friction, {links}",
        "rad", "µrad", 1e6,
        LOADED_RESULTS if now.has_elastic else {"jump_rigid_rad": LOADED_RESULTS["jump_rigid_rad"]},
        now.size_rad, wanted, "|Jump of θ2| [µrad]", LINES, logarithmic=False,
    )
    result.sweeps = _loaded_sweeps(case)
    if not now.has_elastic:
        result.remarks.append(
            "the path with elastic links needs a Hertz normal law and tangential_velocity = 'material': link "
            "stiffness is left out"
        )
    if not laws.law("friction", case.joint.friction_law).holds_static_load:
        result.remarks.append(
            f"friction_law = {case.joint.friction_law!r} holds no static load, a joint left alone creeps; the "
            "path stands for Coulomb friction of the same coefficient"
        )
    _loaded_friction(case, result)
    if wanted is None:
        result.sentences.append("The case has no jump: there is nothing to control.")
    else:
        for sweep in result.sweeps:
            _loaded_ranges(case, sweep, wanted)
        _loaded_spring(case, result, wanted)
    if with_dem:
        _loaded_dem(case, result, on_progress)
    return result


def _loaded_ranges(case: UmbrellaCase, sweep: Sweep, wanted: float) -> None:
    def passes(value: float) -> bool:
        jump = _loaded_size(case, _loaded_row(case, sweep.parameter, value))
        return jump is not None and jump <= wanted

    values = [row.value for row in sweep.rows]
    sweep.meets = ranges_that_pass(values, [passes(value) for value in values], passes)


def _loaded_friction(case: UmbrellaCase, result: Study) -> None:
    rolls = smallest_friction_that_rolls(case)
    result.recommendation["smallest_friction_coefficient_without_slip"] = rolls
    if rolls is None:
        result.sentences.append(f"The joint slips with every friction coefficient up to {highest(case, FRICTION):g}.")
        return
    left = loaded_jump(with_values(case, {FRICTION: rolls})).size_rad or 0.0
    result.recommendation["jump_without_slip_rad"] = left
    sweep = result.sweep(FRICTION)
    sweep.recommended = rolls
    sweep.insert(_loaded_row(case, FRICTION, rolls))
    result.sentences.append(
        f"From a friction coefficient of {rolls:.6g} on the joint rolls without slip"
        + (
            " and leaves no jump." if left == 0
            else f"; what is left is {number(left * 1e6)} µrad of the contact's elastic slide."
        )
    )


def _loaded_spring(case: UmbrellaCase, result: Study, wanted: float) -> None:
    """Find the smallest spring stiffness K_M. It acts only through the elasticity of links and contact."""
    sweep = result.sweep(SPRING)
    asked = f"{number(wanted * 1e6)} µrad"
    result.recommendation["stiffness_N_m_per_rad"] = None
    if result.jump <= wanted:
        result.sentences.append(
            f"The jump of the case, {number(result.jump * 1e6)} µrad, is not above {asked}: no stiffer spring "
            "is needed."
        )
        return
    result.sentences.append(
        "With rigid links the jump does not depend on K_M at all: force and friction grow together."
    )
    upwards = [ends for ends in sweep.meets if ends[0] > sweep.own]
    if not upwards:
        usable = [row for row in sweep.rows if _loaded_size(case, row) is not None]
        left, best = min(((_loaded_size(case, row) or 0.0, row) for row in usable), key=lambda pair: pair[0])
        result.sentences.append(
            f"No torsion spring from {number(usable[0].value)} to {number(usable[-1].value)} N m/rad keeps "
            f"it at or below {asked}: the best, {number(best.value)} N m/rad, leaves {number(left * 1e6)} µrad."
        )
        return
    stiffness = upwards[0][0]
    design = with_values(case, {SPRING: stiffness})
    jump = loaded_jump(design)
    sweep.recommended = stiffness
    sweep.insert(_loaded_row(case, SPRING, stiffness))
    result.recommendation.update(stiffness_N_m_per_rad=stiffness, jump_with_it_rad=jump.size_rad)
    sentence = f"The smallest K_M that keeps it at or below {asked} is {stiffness:.6g} N m/rad"
    if jump.elastic:
        load = link_loads(design, jump.elastic)
        result.recommendation.update(
            largest_link_compression_N=load["compression_N"], compression_over_euler_load=load["over_euler_load"]
        )
        sentence += (
            f"; it acts through the elasticity of links and contact alone, and it presses a link with "
            f"{number(load['compression_N'], 3)} N, {number(load['over_euler_load'], 3)} times the Euler load "
            "of a free pinned link of square section"
        )
    result.sentences.append(sentence + ".")


def _loaded_dem(case: UmbrellaCase, result: Study, on_progress: OnProgress) -> None:
    points: list[tuple[str, float]] = [(SPRING, result.sweep(SPRING).own)]
    for sweep in (result.sweep(SPRING), result.sweep(FRICTION)):
        if sweep.recommended is not None:
            points.append((sweep.parameter, sweep.recommended))
    designs = [with_values(case, {key: value}) for key, value in points]
    done = [0]

    def step() -> None:
        done[0] += 1
        on_progress(done[0] / len(points))

    for (key, value), design, run in zip(points, designs, ensembles.execute_all(designs, step)):
        jump = abs(run.summary["theta2_jump_rad"])
        exact = loaded_jump(design).size_rad
        result.dem.append({key: value, "reduced_jump_rad": exact, "dem_jump_rad": jump})
        result.remarks.append(
            f"DEM with {key} = {value:.6g}: jump {number(jump * 1e6)} µrad, reduced model "
            f"{number(None if exact is None else exact * 1e6)} µrad"
        )
        for sweep in result.sweeps if (key, value) == points[0] else [result.sweep(key)]:
            sweep.row(sweep.own if (key, value) == points[0] else value).dem_jump = jump
