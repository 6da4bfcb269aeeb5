# SPDX-License-Identifier: GPL-3.0-or-later
"""Ball joints of spatial trusses: results of cases, commands and drawings, and comparison of DEM and solver."""
from __future__ import annotations

import re
import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from conftest import Outcome
from failures import Failure, failing, failure, note

import statejump as statejump_package
from statejump import _paths
from statejump.core.errors import StatejumpError
from statejump.kinds.loading import parse_case
from statejump.kinds.truss import generate, solve
from statejump.kinds.truss.contact_problems import contact_problems
from statejump.kinds.truss.generate.document import to_toml
from statejump.results.read import read
from studies.calculix.truss import pinned

TRIPOD = _paths.SHARE / "cases" / "trusses" / "ball_tripod.toml"


def tripod(**joint: Any) -> dict[str, Any]:
    """The shipped case as a dict with changed keys of its joint; a key with the value None is removed."""
    made = tomllib.loads(TRIPOD.read_text())
    joints = made["ball_joint"][0] | joint
    made["ball_joint"] = [{key: value for key, value in joints.items() if value is not None}]
    return made


@pytest.mark.parametrize("keys, sentence", [
    ({"socket_node": "S"}, failure("link_not_at_node", item="ball_joint 'apex'", key="socket_link", value="AT", ends="'A' and 'T'", node_key="socket_node", node_wanted="S", joint="apex")),
    ({"ball_node": "T", "ball_link": "BT"}, failure("equal_nodes_of_joint", item="ball_joint 'apex'", key="ball_node", value="T", outer="socket_node", joint="apex")),
    ({"socket_link": None}, failure("rotating_part_unsupported", item="ball_joint 'apex'", key="socket_link", part="socket", node_wanted="T", joint="apex", nodes=['T'])),
    ({"ball_node": "Z"}, failure("undefined_reference", item="ball_joint 'apex'", key="ball_node", value="Z", known="'A', 'B', 'C', 'T', 'S', ...", what_it_is="node", name="Z", joint="apex", nodes=['Z'])),
    ({"ball_link": "DT"}, failure("misspelt_reference", item="ball_joint 'apex'", key="ball_link", value="DT", meant="DS", what_it_is="link", name="DT", joint="apex")),
    ({"radial_clearance_m": 0.0}, failure("out_of_range", item="ball_joint 'apex'", key="radial_clearance_m", value=0.0)),
    ({"ball_thermal_expansion_per_K": 9e-4}, failure("clearance_closes", item="ball_joint 'apex'", key="radial_clearance_m", value=0.0001, inner="ball", outer="socket", at_K=100.0, joint="apex")),
    ({"friction_coefficient": -0.1}, failure("out_of_range", item="ball_joint 'apex'", key="friction_coefficient", value=-0.1)),
])
def test_what_is_refused(keys: dict[str, Any], sentence: Failure) -> None:
    with pytest.raises(StatejumpError) as refused:
        parse_case(tripod(**keys))
    assert refused.value == sentence


def test_friction_needs_a_contact_that_gives_way() -> None:
    made = tripod()
    made["reduced"]["sticking"] = "rigid"
    with failing("ball_joint_rigid", item="ball_joint 'apex'", key="reduced.sticking", value="rigid", joint="apex") as refused:
        parse_case(made)
    assert refused.value == failure("ball_joint_rigid", item="ball_joint 'apex'", key="reduced.sticking", value="rigid", joint="apex")
    made["ball_joint"][0]["friction_coefficient"] = 0.0
    for sticking in ("rigid", "partial_slip"):
        made["reduced"]["sticking"] = sticking
        # Without friction the path is reversible.
        moved = solve.solve(parse_case(made)).states["displacement_m"]
        assert np.abs(moved[-1] - moved[0]).max() < 1e-12 * np.abs(moved).max()


def test_in_a_plane_it_is_refused() -> None:
    made = generate.umbrella(1)
    joint = made.pop("revolute")[0]
    made["ball_joint"] = [{
        "name": joint["name"], "friction_coefficient": 0.1, "radial_clearance_m": 1e-4, "ball_radius_m": 5e-3,
        "socket_node": joint["bearing_node"], "ball_node": joint["journal_node"]}]
    with failing("ball_joint_planar", item="ball_joint 'joint'", key="truss.dimension", value=2, joint="joint"):
        parse_case(made)


def test_parts_may_not_be_drawn_apart() -> None:
    made = tripod()
    made["node"][4]["position_m"][2] += 2e-4
    with failing("node_off_clearance", item="ball_joint 'apex'", key="ball_node", value="S", apart_m=0.00019999999999997797, outer="socket", other="T", clearance_m=0.0001, joint="apex"):
        parse_case(made)


def test_increments_matter_to_second_order_only() -> None:
    """Without step halving for the energies, twice the increments reduce the error of the jump to a quarter. The jump
    is 1/300 of the loop."""
    truss = parse_case(tripod()).resolve()
    jumps = [solve.path(truss, increments_per_branch=increments, energy_tolerance=1).cycle_ends["displacement_m"]
             for increments in (25, 50, 1600)]
    errors = [np.abs((one[-1] - one[0]) - (jumps[-1][-1] - jumps[-1][0])).max() for one in jumps[:-1]]
    assert errors[1] == pytest.approx(0.25 * errors[0], rel=0.3)
    assert errors[1] < 2e-3 * np.abs(jumps[-1][-1] - jumps[-1][0]).max()


def test_commands(statejump: Callable[..., Outcome], tmp_path: Path) -> None:
    case = tmp_path / "ball.toml"
    case.write_text(to_toml(tripod() | {"case": tripod()["case"] | {"name": "ball"}}))
    for words in (("reduced",), ("truss", "draw"), ("truss", "answers", "--no-sensitivity", "--frames", "3")):
        done = statejump(*words[:2] if words[0] == "truss" else words, case, *words[2:])
        assert done.status == 0, (words, done.errors)
    result = read(tmp_path / "results" / "ball" / "reduced.h5")
    run = result.models["reduced"]
    assert run.history["ball_friction_force_N"].unit == "N" and run.history["ball_eccentricity_m"].items == "ball_joints"
    assert [event.kind for event in run.events] == ["first_slip", "stick", "slip"]
    # Forces on the ball: pushed back from the socket's wall, and rubbed within the cone along it.
    normal, rubs = (run.contacts[f"{kind}_force_N"].values[:, 0] for kind in ("normal", "tangential"))
    offset = run.history["ball_eccentricity_m"].values[:, 0]
    assert np.all((normal * offset).sum(axis=1) < 0)
    assert np.abs((rubs * offset).sum(axis=1)).max() < 1e-9 * np.linalg.norm(rubs, axis=1).max()
    assert np.all(np.linalg.norm(rubs, axis=1) <= 0.1 * np.linalg.norm(normal, axis=1) * (1 + 1e-9))
    moving = statejump("reduced", "--dynamic", case)
    assert moving.status == 0, moving.errors
    told = parse_case(tripod())
    (sentence,) = [one for one in told.behaviour.describe(told) if "ball joint" in one]
    assert re.findall(r"\d+(?:\.\d+)?", sentence) == ["1", "100", "5", "0.1"]


def test_alone_it_is_no_contact_problem() -> None:
    with failing("no_contact"):
        contact_problems(parse_case(tripod()), 3)


def test_locked_it_is_a_pin() -> None:
    truss = parse_case(tripod()).resolve()
    locked = pinned(truss)
    assert len(locked.nodes.names) == len(truss.nodes.names) - 1 and not locked.joints["ball_joint"].names


def test_dem_rolls_and_slips_out_of_any_plane_as_the_path(statejump: Callable[..., Outcome], tmp_path: Path) -> None:
    done = statejump("compare", "--results", tmp_path, TRIPOD)
    assert done.status == 0, done.output + done.errors
    found = read(tmp_path / "ball_tripod" / "comparison.h5")
    rows = {row.name: row.values["dem"] for row in found.rows or ()}
    # Nodes move by 1.5 mm/s at most, and across their links springs of 2e4 N/m hold 12 g: 1.3e3 /s. Wherever the speed
    # turns they follow their equilibrium within 1.2e-6 m of 1.5 mm.
    assert rows["displacement_largest_rms_over_largest"] < 8e-4
    # Of the jump the error of the increments is 2e-3 at most, as the test above has it, of the loop 300 times less.
    assert rows["jump_largest_difference_over_largest_jump_or_loop"] < 1e-5
    assert abs(rows["energy_residual_over_friction_work"]) < 1e-6
    path, dem = found.models.values()
    events = [[(event.kind, event.joint) for event in run.events] for run in (path, dem)]
    assert events[0] == events[1] and len(events[0]) == 3
    # The DEM is sampled 100 times a second.
    times = [[event.time_s for event in run.events] for run in (path, dem)]
    assert times[0] == pytest.approx(times[1], abs=1.5 / 100)
    rubs, other = (run.history["ball_friction_force_N"].values[:, 0] for run in (path, dem))
    # From the second sample on: the DEM begins without motion.
    assert np.linalg.norm(other - rubs, axis=1)[2:].max() < 0.02 * np.linalg.norm(rubs, axis=1).max()
    # No plane holds the way of the ball: with the best one it would be flat to rounding.
    way = path.history["ball_eccentricity_m"].values[:, 0]
    sizes = np.linalg.svd(way - way.mean(axis=0), compute_uv=False)
    assert sizes[2] > 0.02 * sizes[0]


def test_dem_slides_at_the_rim_out_of_any_plane_as_the_path(statejump: Callable[..., Outcome], tmp_path: Path) -> None:
    # With 50 increments a branch the one that begins at a corner of the table is told as one that sticks.
    made = tripod() | {"reduced": {"sticking": "partial_slip", "increments_per_branch": 100},
                       "dem": {"friction_law": "mindlin_deresiewicz"}}
    case = tmp_path / "rim.toml"
    case.write_text(to_toml(made | {"case": made["case"] | {"name": "rim"}}))
    done = statejump("compare", "--results", tmp_path, case)
    assert done.status == 0, done.output + done.errors
    found = read(tmp_path / "rim" / "comparison.h5")
    rows = {row.name: row.values["dem"] for row in found.rows or ()}
    # As with elastic sticking, and 3e-6 of the ball's way more that the increments leave where friction turns.
    assert rows["displacement_largest_rms_over_largest"] < 8e-4
    assert rows["jump_largest_difference_over_largest_jump_or_loop"] < 3e-5
    # Some hundred thousand steps whose direction turns: what chords lose of it would add up.
    assert abs(rows["energy_residual_over_friction_work"]) < 1e-6
    path, dem = found.models.values()
    events = [[(event.kind, event.joint) for event in run.events] for run in (path, dem)]
    assert events[0] == events[1] and len(events[0]) == 3
    rubs, other = (run.history["ball_friction_force_N"].values[:, 0] for run in (path, dem))
    largest = np.linalg.norm(rubs, axis=1).max()
    # From the second sample on, before which the DEM begins to move.
    assert np.linalg.norm(other - rubs, axis=1)[2:].max() < 0.008 * largest
    # It is this law: that of the spring is farther away than both models from each other.
    spring = statejump_package.load(TRIPOD).reduced().history["ball_friction_force_N"].values[:, 0]
    assert np.linalg.norm(spring - rubs, axis=1)[2:].max() > 0.02 * largest


def test_in_motion_the_ball_is_the_dem() -> None:
    made = tripod()
    made["thermal"]["period_s"], made["program"][0]["table_time_s"] = 0.1, [0.0, 0.025, 0.05, 0.075, 0.1]
    made |= {"output": {"samples_per_cycle": 100}, "motion": {"masses": "lumped"}}
    case = statejump_package.load(made)
    dem = case.dem()
    off = []
    for steps in (5_000, 10_000, 20_000):
        run = case.changed({"motion.steps_per_cycle": steps}).reduced(dynamic=True)
        apart = np.linalg.norm(run["displacement_m"] - dem["displacement_m"], axis=2)
        off.append(apart.max() / np.linalg.norm(dem["displacement_m"], axis=2).max())
    heats = [run["friction_dissipation_J"][-1] for run in (run, dem)]
    # Implicit Euler in the contact is of first order: half of a step is off by half or less. The DEM, of first order too, is
    # off by 1.7e-5 with five times these steps, so that a third of the last is its own.
    assert off[1] < 0.5 * off[0] and off[2] < 0.5 * off[1] and off[2] < 1e-5
    assert heats[0] == pytest.approx(heats[1], rel=2e-5)


def rigid(**changes: Any) -> dict[str, Any]:
    """Return the tripod as drawn, its ball rigid."""
    made = tripod()
    made["ball_joint"] = [made["ball_joint"][0] | {"contact": "rigid"}]
    return made | {"reduced": {"sticking": "rigid"}, "motion": {"start": "drawn", "masses": "lumped"} | changes}


def test_rigid_ball_moves_within_its_cone_and_from_the_drawn_shape_only() -> None:
    case = statejump_package.load(rigid(steps_per_cycle=20_000))
    run = case.reduced(dynamic=True)
    normal, rubs = (run[f"ball_{kind}_force_N"][:, 0] for kind in ("normal", "friction"))
    size = np.linalg.norm(rubs, axis=1)
    assert (normal > 0).sum() > 10
    # On the cone to what may be across its direction, 5e-9, and the contact problem's 1e-8.
    assert np.all(size <= 0.1 * normal * (1 + 2e-8))
    # One step ends a tenth of the clearance beside the directions of its middle.
    assert run.warnings == (note("steps_damped", inexact=1, steps=20_000, time_step_s=1e-4),)
    for name in ("reduced", "dem"):
        with failing("rigid_ball_joint_at_rest"):
            getattr(case, name)()
    with failing("start_not_drawn", key="motion.start", value="equilibrium"):
        case.changed({"motion.start": "equilibrium"}).reduced(dynamic=True)
