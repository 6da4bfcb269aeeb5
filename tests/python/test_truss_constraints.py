# SPDX-License-Identifier: GPL-3.0-or-later
"""Sections [[constraint]] of trusses: linear equations between displacements."""
from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from failures import Failure, failure

import statejump as sj

BAR = {"young_modulus_Pa": 70e9, "cross_section_area_m2": 1e-4, "mass_kg": 0.5}
STIFFNESS = 7e6  # of a bar of 1 m [N/m]
ALPHA, HOT = 2e-5, 100.0


def facing(*constraints: dict[str, Any], **more: Any) -> dict[str, Any]:
    """Two collinear bars: AB expands, DE does not. Their ends B and E move freely along x."""
    return {
        "case": {"name": "facing", "kind": "truss"}, "truss": {"dimension": 2},
        "node": [{"name": "A", "position_m": [0, 0], "fixed": ["x", "y"]},
                 {"name": "B", "position_m": [1, 0], "fixed": ["y"]},
                 {"name": "D", "position_m": [3, 0], "fixed": ["x", "y"]},
                 {"name": "E", "position_m": [2, 0], "fixed": ["y"]}],
        "link": [{"name": "AB", "nodes": ["A", "B"], "thermal_expansion_per_K": ALPHA, **BAR},
                 {"name": "DE", "nodes": ["D", "E"], "thermal_expansion_per_K": 0, **BAR}],
        "constraint": list(constraints),
        "thermal": {"shape": "triangle", "temperature_change_max_K": HOT, "period_s": 0.2}, **more,
    }


def tie(name: str = "tie", **changes: Any) -> dict[str, Any]:
    return {"name": name, "nodes": ["B", "E"], "directions": ["x", "x"], "coefficients": [2, -1], **changes}


def hottest(run: Any) -> np.ndarray:
    """Displacements along x [m] where it is hottest."""
    at = int(np.argmax(run.history["temperature_change_K"].values))
    return np.asarray(run.history["displacement_m"].values[at, :, 0])


def test_a_constraint_couples_two_bars() -> None:
    moved = hottest(sj.load(facing(tie())).reduced())
    # E moves twice as far as B. Of virtual work: F = 2 G, F = k (α ΔT l - B), G = k E. The stress-free length grows by
    # 2e-3 of itself, and with it the stiffness falls.
    grown = ALPHA * HOT
    assert moved[1] == pytest.approx(grown / (1 + 4 * (1 + grown)), rel=1e-9)
    assert moved[3] == 2 * moved[1]


def test_a_constraint_holds_in_motion_and_slow_motion_is_the_path() -> None:
    made = facing(tie(), thermal={"shape": "sine", "temperature_change_max_K": HOT, "period_s": 2.0},
                  motion={"steps_per_cycle": 4000})
    path, motion = sj.load(made).reduced(), sj.load(made).reduced(dynamic=True)
    moved = motion.history["displacement_m"].values[:, :, 0]
    assert np.array_equal(moved[:, 3], 2 * moved[:, 1])
    # Inertia over stiffness: 1 kg (π/s)² 1e-3 m and less, over 7e6 N/m.
    assert np.abs(hottest(motion) - hottest(path)).max() < 1e-5 * np.abs(hottest(path)).max()
    assert abs(motion.summary["energy_residue_J"]) < 1e-6 * motion["elastic_energy_J"].max()


def test_a_redundant_constraint_is_named_and_changes_nothing() -> None:
    one = sj.load(facing(tie())).reduced()
    both = sj.load(facing(tie(), tie("again", coefficients=[-4, 2]))).reduced()
    assert np.array_equal(hottest(one), hottest(both))
    assert not [text for text in one.warnings if "constraint" in text]
    assert [text for text in both.warnings if "constraint 'again'" in text]


def test_a_constraint_that_a_translation_violates_holds_as_a_support() -> None:
    made = facing({"name": "mean", "nodes": ["B", "A"], "directions": ["x", "x"], "coefficients": [1, 1]})
    made["node"] = [{**node, "fixed": ["y"]} for node in made["node"][:2]]
    del made["link"][1]
    moved = hottest(sj.load(made).reduced())
    # The middle of the bar stays.
    assert moved == pytest.approx([-ALPHA * HOT / 2, ALPHA * HOT / 2], rel=1e-9)


MISTAKES = {
    "no terms": (tie(nodes=[], directions=[], coefficients=[]), failure("no_nodes", key="nodes")),
    "unknown node": (tie(nodes=["B", "EE"]), failure("misspelt_reference", meant="E")),
    "directions": (tie(directions=["x"]), failure("constraint_length", key="directions", terms=2)),
    "coefficients": (tie(coefficients=[1, 2, 3]), failure("constraint_length", key="coefficients", terms=2)),
    "planar": (tie(directions=["x", "z"]), failure("planar_directions", key="directions")),
    "twice": (tie(nodes=["B", "B"]), failure("constraint_term_twice", node="B", direction="x")),
    "zero": (tie(coefficients=[1, 0]), failure("constraint_coefficient", value=0)),
    "small": (tie(coefficients=[1, 1e-10]), failure("constraint_coefficient", value=1e-10)),
}


@pytest.mark.parametrize("name", MISTAKES)
def test_mistakes_are_named(name: str) -> None:
    constraint, expected = MISTAKES[name]
    _refused(facing(constraint), expected)


def test_names_of_constraints_differ() -> None:
    _refused(facing(tie(), tie()), failure("duplicate_name", part="constraint"))


def _refused(made: dict[str, Any], expected: Failure) -> None:
    with pytest.raises(sj.StatejumpError) as error:
        sj.load(made)
    assert error.value == expected


def test_the_dem_has_no_constraints() -> None:
    with pytest.raises(sj.StatejumpError) as error:
        sj.load(facing(tie())).dem()
    assert error.value == failure("dem_constraint")
