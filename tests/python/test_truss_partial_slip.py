# SPDX-License-Identifier: GPL-3.0-or-later
"""Trusses whose joints slide at the rim of their contacts first."""
from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from failures import failing, failure
import statejump as sj
from statejump import _engine
from statejump.kinds.loading import load_case, parse_case
from statejump.kinds.truss import generate, solve, summary
from statejump.kinds.umbrella import reduced as umbrella

ROOT = Path(__file__).resolve().parents[2]


def path(document: dict[str, Any], **options: Any) -> solve.TrussPath:
    return solve.path(parse_case(document).resolve(), **options)


def turned_rad(found: solve.TrussPath) -> float:
    """Rotation of the link with the bearing from start to end."""
    ends = found.truss.nodes.position_m + found.cycle_ends["displacement_m"][[0, -1]]
    angles = np.arctan2(*(ends[:, 2] - ends[:, 0])[:, 1::-1].T)
    return float(angles[1] - angles[0])


@pytest.mark.parametrize("friction, cycles", [(0.45, 1), (0.45, 3), (0.3, 1)])
def test_rib_is_the_elastic_loop(friction: float, cycles: int) -> None:
    """With friction 0.45 and rigid contact the joint would roll with zero jump; with 0.3 it slips fully. The two
    solvers share only the contact law. Both are second-order accurate and use the same secants."""
    case = load_case(ROOT / "cases" / "umbrella_bias.toml").changed({
        "joint.friction_law": "mindlin_deresiewicz", "joint.friction_coefficient": friction, "thermal.cycles": cycles})
    made = generate.umbrella(1, friction_coefficient=friction, cycles=cycles, sticking="partial_slip")
    jumps, heats = [], []
    for increments in (100, 200, 400):
        loop = _engine.elastic_loop(umbrella.linkage(case), case.thermal_program(), samples=increments,
                                    tangential_compliance="mindlin")
        found = path(made, increments_per_branch=increments)
        # Angles of 1 rad are rounded to 2e-16; what events leave is 1e-9 of a branch.
        assert turned_rad(found) == pytest.approx(loop.theta2_jump_rad, rel=0, abs=5e-15)
        jumps.append(turned_rad(found))
        heats.append(solve.heat_of_joints_J(found.states)[-1].sum())
        assert abs(found.energy_residue_J) < 10 / increments**2 * heats[-1]
    rigid = turned_rad(path(generate.umbrella(1, friction_coefficient=friction, cycles=cycles)))
    if friction == 0.45:
        assert jumps[-1] == pytest.approx(-5.0025e-8, rel=1e-3) and abs(rigid) < 1e-14
        assert not found.events
        # A quarter of the step, a sixteenth of the error: 4 at second order, within what the third order adds.
        assert (heats[1] - heats[0]) / (heats[2] - heats[1]) == pytest.approx(4.0, rel=0.05)
    else:
        assert rigid / jumps[-1] == pytest.approx(5.100e-5 / 5.067e-5, rel=1e-3)
        assert (jumps[1] - jumps[0]) / (jumps[2] - jumps[1]) == pytest.approx(4.0, rel=0.05)


@pytest.mark.parametrize("document", [generate.ring(6), generate.mast(4), generate.umbrella(3), generate.chain(20)],
                         ids=lambda made: made["case"]["name"])
def test_trusses_converge_and_keep_to_coulomb(document: dict[str, Any]) -> None:
    jumps = []
    for increments in (25, 50, 100):
        found = path(document | {"reduced": {"sticking": "partial_slip"}}, increments_per_branch=increments)
        states, truss = found.states, found.truss
        assert found.solves <= 4 * increments + 60  # an increment is a step; what opens or stops is located
        bound = truss.revolutes.friction_coefficient * states["normal_force_N"]
        assert np.all(np.abs(states["friction_force_N"]) <= bound + 1e-8)
        limit = truss.sliders.friction_coefficient * truss.sliders.normal_force_N
        assert np.all(np.abs(states["slider_force_N"]) <= limit + 1e-8)
        ends = found.cycle_ends["displacement_m"]
        jumps.append(np.linalg.norm(ends[-1] - ends[0], axis=1).max())
    first, second = abs(jumps[1] - jumps[0]), abs(jumps[2] - jumps[1])
    # Of second order, down to what located openings leave: 1e-9 of a branch.
    assert second < 0.4 * first + 1e-8 * jumps[-1]
    elastic = path(document | {"reduced": {"sticking": "elastic"}})
    ends = elastic.cycle_ends["displacement_m"]
    assert jumps[-1] == pytest.approx(np.linalg.norm(ends[-1] - ends[0], axis=1).max(), rel=0.05)


def test_it_is_said_in_words() -> None:
    case = parse_case(generate.ring(3, sticking="partial_slip"))
    assert any("the rim" in sentence for sentence in summary.describe(case))


def test_rigid_contacts_have_no_part_that_slips() -> None:
    with failing("partial_slip_rigid"):
        parse_case(generate.ring(3, contact="rigid", sticking="partial_slip"))
    # Without friction there is nothing to slip.
    parse_case(generate.umbrella(1, contact="rigid", sticking="partial_slip", friction_coefficient=0.0))


def test_contact_problems_refuse_it(statejump, tmp_path: Path) -> None:
    assert statejump("truss", "ring", "3", "--sticking", "partial_slip", "-o", tmp_path / "ring.toml").status == 0
    outcome = statejump("fclib", "write", tmp_path / "ring.toml")
    assert outcome.status == 2 and outcome.failure == failure("partial_slip_without_cone"), outcome.errors
    assert "Traceback" not in outcome.errors and not any(path.is_file() for path in tmp_path.rglob("results/**/*"))


def test_ring_in_motion_meets_the_dem_with_the_same_law() -> None:
    case = sj.truss.ring(3).changed({
        "reduced.sticking": "partial_slip", "dem.friction_law": "mindlin_deresiewicz", "motion.masses": "lumped",
        "motion.steps_per_cycle": 20_000, "output.samples_per_cycle": 1_000})
    dem, moved = case.dem(), case.reduced(dynamic=True)
    spring = case.changed({"reduced.sticking": "elastic"}).reduced(dynamic=True)
    largest = np.linalg.norm(dem["displacement_m"], axis=2).max()

    def apart(run: object) -> float:
        return float(np.linalg.norm(run["displacement_m"] - dem["displacement_m"], axis=2).max() / largest)

    # By sets contacts are of first order in the step, and the laws differ by more: 4.7e-5 and 7.7e-4.
    finer = case.changed({"motion.steps_per_cycle": 50_000}).reduced(dynamic=True)
    assert apart(finer) < 0.5 * apart(moved) and apart(moved) < 0.1 * apart(spring)
    heat = dem["friction_dissipation_J"][-1]
    assert finer["friction_dissipation_J"][-1] == pytest.approx(heat, rel=1e-3)
    assert abs(finer.summary["energy_residue_J"]) < 1e-8 * heat  # forces balance to 1e-10


@pytest.mark.parametrize("name, changes", [
    ("mast_6", {}),  # swings from side to side in every joint
    ("umbrella_100", {"motion.steps_per_cycle": 2_000}),  # a hundred joints turn round in one step
    ("telescope", {"motion.steps_per_cycle": 5_000}),  # stops and sliders that hold two nodes together
    ("ball_tripod", {"motion.displacement_tolerance_m": 1e-7}),
])
def test_steps_of_trusses_with_partial_slip_are_found(name: str, changes: dict[str, Any]) -> None:
    case = sj.load(ROOT / f"cases/trusses/{name}.toml").changed({"reduced.sticking": "partial_slip", **changes})
    run = case.reduced(dynamic=True)
    spring = case.changed({"reduced.sticking": "elastic"}).reduced(dynamic=True)
    heat = spring["friction_dissipation_J"][-1]
    # Another law under the same bound of friction: heat of the same size, and energies close.
    assert run["friction_dissipation_J"][-1] == pytest.approx(heat, rel=0.2)
    assert abs(run.summary["energy_residue_J"] - spring.summary["energy_residue_J"]) < 1e-3 * heat
