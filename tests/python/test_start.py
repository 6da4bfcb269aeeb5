# SPDX-License-Identifier: GPL-3.0-or-later
"""``start.friction``: one structure has the same start and jump as ``spring_slider``, as ``truss`` and in the DEM."""
from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from failures import failing
import statejump as sj
from statejump.core.errors import NotAllowed, StatejumpError
from statejump.kinds.loading import parse_case
from statejump.kinds.spring_slider.control import smallest_preload

TABLE1 = "cases/table1.toml"
FRICTION_N, PRELOAD_N = 30.0, 20.0
STIFFNESS_N_per_m = 70e9 * 9e-6 / 0.5 + 1e5
STARTS = ("stuck", "frictionless")
START_m = {"stuck": 0.0, "frictionless": -PRELOAD_N / STIFFNESS_N_per_m}
CARRIED_N = {"stuck": PRELOAD_N, "frictionless": 0.0}
JUMP_m = {"stuck": (FRICTION_N - PRELOAD_N) / STIFFNESS_N_per_m, "frictionless": FRICTION_N / STIFFNESS_N_per_m}
# Newton's bounds on both ends of a truss path: closures to 1e-13 of the largest displacement, 1.2 mm, forces to 1e-12
# of the largest, 220 N, over the stiffness.
SOLVER_m = 2 * (1.2e-16 + 1.6e-16)


def as_spring_slider(start: str, **changes: Any) -> sj.Case:
    """Return the bar of Table 1 with a preload spring."""
    return sj.load(TABLE1).changed({
        "joint.preload_stiffness_N_per_m": 1e5, "joint.preload_force_N": PRELOAD_N, "start.friction": start,
        "thermal.period_s": 0.25, "thermal.temperature_change_max_K": 60.0, **changes})


def as_truss(start: str, preload_N: float = PRELOAD_N, **changes: Any) -> sj.Case:
    """Return the same bar as a truss; the preload spring is parallel to the bar."""
    document = {
        "case": {"name": "bar", "kind": "truss", "title": "Bar on a slider", "source": "test"},
        "truss": {"dimension": 2},
        "node": [{"name": "A", "position_m": [0.0, 0.0], "fixed": ["x", "y"]},
                 {"name": "B", "position_m": [0.5, 0.0], "fixed": ["y"]}],
        "link": [{"name": "AB", "nodes": ["A", "B"], "young_modulus_Pa": 70e9, "cross_section_area_m2": 9e-6,
                  "thermal_expansion_per_K": 23.4e-6, "density_kg_per_m3": 2700.0}],
        "slider": [{"name": "S", "nodes": ["B"], "axis": [1.0, 0.0], "friction_coefficient": 0.3,
                    "normal_force_N": 100.0}],
        "spring": [{"name": "P", "nodes": ["A", "B"], "stiffness_N_per_m": 1e5, "preload_N": preload_N}],
        "start": {"friction": start},
        "thermal": {"shape": "half_sine", "temperature_change_max_K": 60.0, "cycles": 1, "period_s": 0.25},
    }
    case = parse_case(document)
    return case.changed(changes) if changes else case


def displacement_m(run: Any) -> np.ndarray:
    """Return the displacement of the block."""
    return np.asarray(run["displacement_m"][:, 1, 0] if run["displacement_m"].ndim > 1 else run["displacement_m"])


@pytest.mark.parametrize("start", STARTS)
def test_closed_form(start: str) -> None:
    run = as_spring_slider(start).reduced()
    # Quotients of exact numbers, and the difference of two places.
    assert displacement_m(run)[0] == pytest.approx(START_m[start], rel=1e-15, abs=0)
    assert run.summary["state_jump_m"] == pytest.approx(JUMP_m[start], rel=1e-14)
    assert run.summary["start_friction_N"] == CARRIED_N[start]
    assert run.summary["start_friction_over_limit"] == pytest.approx(CARRIED_N[start] / FRICTION_N, rel=1e-15)


@pytest.mark.parametrize("start", STARTS)
def test_truss(start: str) -> None:
    run = as_truss(start).reduced()
    x = displacement_m(run)
    assert x[0] == pytest.approx(START_m[start], abs=SOLVER_m)
    assert x[-1] - x[0] == pytest.approx(JUMP_m[start], abs=SOLVER_m)
    assert run.summary["start_friction_N"] == pytest.approx(CARRIED_N[start], abs=1e-12 * PRELOAD_N)


def test_preload_beyond_friction_slides_until_friction_holds() -> None:
    # -P with P = 3 f: the block stops where 2 f are left to the springs, and comes back to there.
    start = -2 * FRICTION_N / STIFFNESS_N_per_m
    closed = as_spring_slider("stuck", **{"joint.preload_force_N": 3 * FRICTION_N}).reduced()
    solved = as_truss("stuck", 3 * FRICTION_N).reduced()
    for run, rounding in ((closed, 1e-18), (solved, SOLVER_m)):
        x = displacement_m(run)
        assert x[0] == pytest.approx(start, abs=rounding)
        assert x[-1] - x[0] == pytest.approx(0, abs=rounding)
        assert run.summary["start_friction_over_limit"] == pytest.approx(1, rel=1e-12)


@pytest.mark.parametrize("start", STARTS)
def test_control_finds_the_spring_for_the_start(start: str) -> None:
    wanted = 5e-6
    spring = smallest_preload(as_spring_slider(start).definition, wanted)
    assert spring is not None and spring.by == "closed form"
    force = FRICTION_N - CARRIED_N[start]
    assert spring.stiffness_N_per_m == pytest.approx(force / wanted - 1.26e6, rel=1e-12)


@pytest.mark.parametrize("start", STARTS)
@pytest.mark.parametrize("friction_law, sticking", [("mindlin", "elastic"), ("mindlin_deresiewicz", "partial_slip")])
def test_motion_with_contacts_that_give(start: str, friction_law: str, sticking: str) -> None:
    """Explicit steps begin with the friction of the quasi-static start."""
    case = as_truss(start, **{
        "motion.scheme": "regularised", "motion.masses": "lumped", "motion.steps_per_cycle": 20_000,
        "thermal.period_s": 0.025, "reduced.sticking": sticking, "dem.friction_law": friction_law})
    found, moved = case.reduced(), case.reduced(dynamic=True)
    assert displacement_m(moved)[0] == displacement_m(found)[0]
    # The slide that loads the contact is a closed form of the friction: some roundings.
    assert moved.summary["start_friction_N"] == pytest.approx(found.summary["start_friction_N"], rel=1e-9, abs=1e-9)


@pytest.mark.parametrize("build", (as_spring_slider, as_truss))
def test_dem(build: Any) -> None:
    """The DEM starts from the same state for any initial friction, and reports the same jump."""
    first_way_m = []
    for start in STARTS:
        case = build(start)
        run = case.dem()
        x = displacement_m(run)
        assert x[0] == pytest.approx(START_m[start], abs=1e-15)
        # The slide that loads the contact is friction over k_t, to the rounding of a depth and its root.
        assert run.summary["start_friction_N"] == pytest.approx(CARRIED_N[start], rel=1e-9, abs=1e-9)
        # The block slides at the end. Its velocity is that of half a step before, and the dashpot of the truss' spring
        # pulls: with 2 ζ sqrt(k_p m), m a third of the bar's mass.
        speed_m_per_s = 23.4e-6 * 0.5 * 60.0 * np.pi / 0.25
        dashpot_s = 0.2 * np.sqrt(1e5 * 2700 * 0.5 * 9e-6 / 3) / STIFFNESS_N_per_m
        bound_m = speed_m_per_s * (run.about["time_step_s"] + dashpot_s)
        assert x[-1] - x[0] == pytest.approx(JUMP_m[start], abs=bound_m)
        # A contact that started without its friction would lose P²/(2 k_t), 2e-4 of the heat of friction.
        found = {row.name: row for row in sj.compare(case.reduced(), run).rows}
        assert abs(found["energy_residual_over_friction_work"].difference or 0.0) < 1e-6
        first_way_m.append(x[1] - x[0])
    # Nothing but the heating moves the block. P/(k + k_p + k_t) is 7e-7 m.
    assert first_way_m[0] == pytest.approx(first_way_m[1], abs=1e-10)


def test_umbrella_without_friction_at_the_start_touches_where_it_needs_none() -> None:
    loaded = {"start.mode": "loaded", "torsion_spring.stiffness_N_m_per_rad": 50.0, "torsion_spring.bias_rad": 1e-3}
    case = sj.load("umbrella_damped").changed({**loaded, "start.friction": "frictionless"})
    assert case["start.contact_angle_rad"] == 0
    with failing("angle_without_friction", key="start.contact_angle_rad", value=0.1, raised=NotAllowed):
        case.changed({"start.contact_angle_rad": 0.1})


def test_structure_that_friction_alone_holds_has_no_start_without_it() -> None:
    document = as_truss("frictionless").to_dict()
    document["node"].append({"name": "C", "position_m": [1.0, 0.0], "fixed": ["y"], "force_N": [10.0, 0.0]})
    document["slider"].append({**document["slider"][0], "name": "T", "nodes": ["C"]})
    with pytest.raises(StatejumpError) as refused:
        parse_case(document).reduced()
    assert "start.friction" in str(refused.value.remedy)
