# SPDX-License-Identifier: GPL-3.0-or-later
"""Both models of the umbrella rib, run and compared by the command."""
from __future__ import annotations

import csv
import json
from pathlib import Path

import numpy as np
import pytest

from failures import failing
from statejump.core.errors import StatejumpError
from statejump.kinds.loading import load_case
from statejump.kinds.umbrella import dem, reduced as model
from statejump.schema.paths import with_values
from studies.paper import ensembles


def quantities(folder: Path) -> dict[str, dict]:
    document = json.loads((folder / "comparison.json").read_text())
    return {entry["name"]: entry for entry in document["quantities"]}


@pytest.mark.parametrize("friction", ["mindlin", "none"])
def test_damped_case_agrees_to_the_end(statejump, edited, tmp_path: Path, friction: str) -> None:
    path = edited(('friction_law = "mindlin"', f'friction_law = "{friction}"'), case="umbrella_damped")
    outcome = statejump("compare", path)
    assert outcome.status == 0, outcome.output + outcome.errors
    found = quantities(tmp_path / "results" / "umbrella_damped")
    assert abs(found["theta2_jump"]["difference"]) < 1e-6
    assert found["theta2_largest_difference_over_range"]["dem"] < 0.01
    assert found["theta4_largest_difference_over_range"]["dem"] < 0.01
    reduced, dem = (next(name for name in found if name.startswith("first_contact_") and name.split()[-1] == model)
                    for model in ("reduced", "DEM"))
    assert abs(found[reduced]["difference"]) < 1e-6
    assert abs(found[dem]["difference"]) < 1e-3
    folder = tmp_path / "results" / "umbrella_damped"
    assert (folder / "umbrella_damped.svg").exists()
    # Whose value a number is: the closed form has a column of its own.
    with (folder / "comparison.csv").open(newline="") as stream:
        rows = {row["name"]: row for row in csv.DictReader(stream)}
    sides = {name: [side for side in ("closed_form", "reduced", "dem") if row[side]] for name, row in rows.items()}
    assert sides[reduced] == ["closed_form", "reduced"]
    assert sides[dem] == ["closed_form", "dem"]
    assert sides["theta2_jump"] == ["reduced", "dem"]
    first = float(rows[dem]["closed_form"])
    assert first == pytest.approx(1e-4 / (23.75e-6 * 0.12), rel=1e-12)  # c/(α |AC|)


def test_undamped_case_agrees_until_the_largest_temperature(statejump, cases: Path, tmp_path: Path) -> None:
    outcome = statejump("compare", cases / "umbrella.toml")
    assert outcome.status == 0, outcome.output + outcome.errors
    assert "chaotic" in outcome.output
    found = quantities(tmp_path / "results" / "umbrella")
    assert found["theta2_largest_difference_over_range_until_largest_temperature"]["dem"] < 0.01
    # The links ring: first contact is where both models say, off the closed form by up to 0.03 K.
    contact = found["first_contact_temperature_change"]
    assert abs(contact["difference"]) < 1e-3
    assert abs(contact["reduced"] - 35.087719) < 0.03


@pytest.mark.parametrize("clearance_mm, exact", [(0.05, 17.5439), (0.10, 35.0877), (0.15, 52.6316),
                                                 (0.20, 70.1754), (0.30, None)])
def test_first_contact(cases: Path, clearance_mm: float, exact: float | None) -> None:
    case = with_values(load_case(cases / "umbrella_damped.toml"),
                         {"joint.radial_clearance_m": clearance_mm * 1e-3, "dem.steps_per_cycle": 100_000})
    ours = model.integrate(case).first_contact_temperature_change_K
    other = dem.execute(case).about["first_contact_temperature_change_K"]
    if exact is None:
        assert ours is None and other is None
        return
    closed = model.linkage(case).first_contact_temperature_change()
    assert closed == pytest.approx(exact, abs=5e-5)
    assert ours == pytest.approx(closed, abs=1e-6)
    assert other == pytest.approx(closed, abs=1e-3)


def test_expanding_radii_move_first_contact(cases: Path) -> None:
    expansion = 23.75e-6
    case = with_values(load_case(cases / "umbrella_damped.toml"), {
        "joint.journal_thermal_expansion_per_K": expansion,
        "joint.bearing_thermal_expansion_per_K": 3 * expansion,
        "dem.steps_per_cycle": 100_000,
    })
    # α ΔT a = c + (R2 3α − R1 α) ΔT
    closed = 1e-4 / (expansion * (0.12 - 3 * 0.0051 + 0.005))
    assert model.linkage(case).first_contact_temperature_change() == pytest.approx(closed, rel=1e-12)
    assert model.integrate(case).first_contact_temperature_change_K == pytest.approx(closed, abs=1e-6)
    assert dem.execute(case).about["first_contact_temperature_change_K"] == pytest.approx(closed, abs=1e-3)


# Laws, and expansion of the journal [1/K], which the normal and dissipation laws see.
LAWS = [
    ("hertz_paper", "lankarani_nikravesh", "ambrosio", "material", 0.0),
    ("johnson", "hunt_crossley", "ambrosio", "paper", 23.75e-6),
    ("esdu_78035", "flores", "none", "material", 0.0),
    ("persson", "none", "mindlin", "material", 23.75e-6),
    ("hertz_internal", "exact_restitution", "mindlin_deresiewicz", "material", 23.75e-6),
]


@pytest.mark.parametrize("names", LAWS, ids=lambda names: names[0])
def test_laws_by_name_are_the_same_in_both_models(cases: Path, names: tuple[str, ...]) -> None:
    keys = ("normal_law", "dissipation_law", "friction_law", "tangential_velocity")
    changes = {f"joint.{key}": name for key, name in zip(keys, names)}
    case = with_values(load_case(cases / "umbrella_damped.toml"), {
        **changes, "joint.journal_thermal_expansion_per_K": names[-1], "joint.restitution": 0.8, "thermal.period_s": 0.2, "thermal.temperature_change_max_K": 60.0,
        "joint.friction_v1_m_per_s": 1e-4, "reduced.steps_per_cycle": 200_000, "dem.steps_per_cycle": 200_000,
    })
    ours, other = model.run(case), dem.execute(case).columns
    assert np.max(ours["normal_force_N"]) > 0
    for angle in ("theta2_rad", "theta4_rad"):
        # First order in ω h = 0.01 where friction and damping see the last half step's speed.
        difference = np.max(np.abs(other[angle] - ours[angle]))
        assert difference < 0.01 * np.ptp(ours[angle]), difference / np.ptp(ours[angle])
    # Another law gives another motion: what is compared depends on the names.
    standard = model.run(with_values(case, {f"joint.{key}": "none" if key != "normal_law" else "hertz_internal"
                                              for key in keys[:3]}))
    assert np.max(np.abs(standard["theta2_rad"] - ours["theta2_rad"])) > 0.01 * np.ptp(ours["theta2_rad"])


def test_a_law_outside_its_range_stops_both_models(cases: Path) -> None:
    # A soft joint without spring: 1 MPa links and joint let the journal sink beyond Johnson's range.
    case = with_values(load_case(cases / "umbrella_damped.toml"), {
        "joint.normal_law": "johnson", "torsion_spring.stiffness_N_m_per_rad": 1000.0,
        "torsion_spring.bias_rad": 0.5, "link_ab.young_modulus_Pa": 70e7, "link_bc.young_modulus_Pa": 70e7,
        "joint.contact_length_m": 1e-4, "dem.steps_per_cycle": 100_000,
    })
    for run in (model.run, dem.execute):
        with pytest.raises(StatejumpError) as problem:
            run(case)
        found = problem.value
        assert found.code == "law_left_range" or found.details["reason"] == "law_left_range", found
        assert found.time_s is not None and found.temperature_change_K is not None and "\n" not in str(found)


def test_steps_too_long_are_refused_by_both_models(cases: Path) -> None:
    case = with_values(load_case(cases / "umbrella.toml"),
                         {"reduced.steps_per_cycle": 2000, "dem.steps_per_cycle": 4000})
    with failing("out_of_range", argument="steps"):
        model.run(case)
    with failing("dem_failed", reason="time_step_unstable"):
        dem.execute(case)


def test_ensembles_repeat_bit_for_bit(cases: Path) -> None:
    case = with_values(load_case(cases / "umbrella.toml"),
                         {"ensemble.reduced_steps_per_cycle": 20_000, "output.samples_per_cycle": 20})
    few, many = ensembles.ensemble(case, 3), ensembles.ensemble(case, 5)
    assert np.array_equal(few.theta2_rad, many.theta2_rad[:3])
    other = ensembles.ensemble(with_values(case, {"ensemble.seed": 2}), 3)
    assert not np.array_equal(few.theta2_rad, other.theta2_rad)
    radii = [np.hypot(*offset) for offset in ensembles.start_offsets(case, 50)]
    assert 0 < min(radii) and max(radii) <= case.ensemble.start_spread_m


def test_dem_repeats_bit_for_bit(cases: Path) -> None:
    case = with_values(load_case(cases / "umbrella.toml"), {"dem.steps_per_cycle": 50_000})
    first, second = (run.flat() for run in ensembles.execute_all([case, case]))
    assert "theta2_rad" in first and "thermal_work_J" in first
    for name, values in first.items():
        assert np.array_equal(values, second[name]), name
