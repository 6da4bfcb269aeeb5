# SPDX-License-Identifier: GPL-3.0-or-later
"""Exact derivatives of jumps: closed forms, differences of paths, events with memory."""
from __future__ import annotations

import numpy as np
import pytest

from failures import failing

import statejump as sj
from statejump.kinds.truss.answers.gradient import Gradient, RecordedPath
from statejump.kinds.truss.answers.outputs import chosen_output
from statejump.kinds.truss.answers.parameters import changed, parameters
from statejump.kinds.truss.resolved import ResolvedTruss


def elasticities(truss: ResolvedTruss, increments: int = 50) -> tuple[dict[str, float], Gradient]:
    """Elasticities of the jump of the node that moves most to all parameters."""
    recorded = RecordedPath(truss, increments)
    found = Gradient(recorded, chosen_output(recorded.found, "node"))
    return {f"{section}.{key}": found.by_parameter(section, key).total / found.jump
            for section, key, values in parameters(truss) if (np.isfinite(values) & (values != 0)).any()}, found


def by_differences(truss: ResolvedTruss, name: str, found: Gradient) -> float:
    """The same elasticity from two central differences of paths, extrapolated: error of the fourth order in 1e-3."""
    section, key = name.split(".")
    items = len(found.names(section))

    def jump(factor: float) -> float:
        return found.output.jump(RecordedPath(changed(truss, section, key, np.full(items, factor))).found)

    whole, half = ((jump(1 + step) - jump(1 - step)) / (2 * step) for step in (1e-3, 5e-4))
    return (4 * half - whole) / (3 * found.jump)


def test_the_chain_has_its_closed_form() -> None:
    # Bar i is bent by the friction of all sliders behind it: jump = Σ_i f l/(EA)_i (n - i + 1).
    case = sj.truss.chain(6)
    found, gradient = elasticities(case.resolve())
    assert found == pytest.approx({"slider.friction_coefficient": 1.0, "slider.normal_force_N": 1.0,
                                   "link.young_modulus_Pa": -1.0, "link.cross_section_area_m2": -1.0}, abs=1e-9)
    shares = gradient.by_parameter("slider", "friction_coefficient").items / gradient.jump
    assert shares == pytest.approx(np.arange(1, 7) / 21, abs=1e-9)
    # The memories of all sliders are written at the end of the last branch, where they stop: one solution, and one at
    # the end of the path.
    assert gradient.solutions == 2 and gradient.events == 0 and gradient.kinks == 0


@pytest.mark.parametrize("case, names, most", [
    ("umbrella_rib", ["revolute.friction_coefficient", "revolute.radial_clearance_m"], 1e-8),
    ("mast_6", ["torsion_spring.stiffness_N_m_per_rad"], 1e-8),
    ("latch_boom", ["latch_hinge.preload_moment_N_m", "link.young_modulus_Pa"], 1e-8),
])
def test_derivatives_are_those_of_paths(case: str, names: list[str], most: float) -> None:
    truss = sj.load(f"trusses/{case}").definition.resolve()
    found, gradient = elasticities(truss)
    for name in names:
        # Events are located to 1e-9 of a branch, and differences divide by 5e-4.
        assert found[name] == pytest.approx(by_differences(truss, name, gradient), abs=2e-8 * max(1, abs(found[name])))


def test_slides_of_rolling_contacts_have_the_second_order() -> None:
    truss = sj.load("trusses/ring_12").definition.resolve()
    coarse, fine, finest = (elasticities(truss, increments)[0]["revolute.friction_coefficient"]
                            for increments in (15, 30, 60))
    assert abs(fine - finest) < abs(coarse - fine)
    assert finest == pytest.approx(1.636602, abs=2e-6)  # by differences: 1.6366023


def test_the_time_of_an_event_counts() -> None:
    # Two bars l against a wall, sliders f1 and f2 at their ends. Heated, both slide; the second arrives at its stop c at
    # α ΔT = (c/l + (f1 + 2 f2)/EA)/2, and its stop ends the slide of the first at u = c/2 - l f1/(2 EA), where it stays.
    chain = sj.truss.chain(2)
    links = chain.resolve().links
    stiffness = float((links.young_modulus_Pa * links.cross_section_area_m2)[0])
    strain = float(links.thermal_expansion_per_K[0]) * chain.thermal.temperature_change_max_K
    length = float(links.stress_free_length_m[0])
    first, second = 0.3 * stiffness * strain, 0.05 * stiffness * strain
    clearance = length * (strain - (first + 2 * second) / stiffness)  # reached at half of the largest temperature
    case = chain.changed({"slider.*.friction_coefficient": 1.0, "slider.S1.normal_force_N": first,
                          "slider.S2.normal_force_N": second, "slider.S2.clearance_plus_m": clearance})
    jump = clearance / 2 - length * first / (2 * stiffness)
    found = case.gradient("node:N1")
    assert found.events == 1 and not found.one_sided and found.jump == pytest.approx(jump, rel=strain)
    # Strains count over heated lengths: differences of the order of a strain. At a fixed time the slide would not
    # depend on the clearance at all, and on f2 as on f1.
    elasticity = {row["parameter"]: row["elasticity"] for row in found.rows}
    for item, exact in (("S1.normal_force_N", -length * first / (2 * stiffness) / jump),
                        ("S2.clearance_plus_m", clearance / 2 / jump), ("S2.normal_force_N", 0.0)):
        assert elasticity[f"slider.{item}"] == pytest.approx(exact, abs=3 * strain), item


def test_keys_of_a_case() -> None:
    case = sj.load("trusses/chain_10").definition
    found = case.gradient("node:N10", keys=["thermal.temperature_change_max_K", "thermal.period_s",
                                            "node.N10.position_m", "link.*.thermal_expansion_per_K"])
    # Friction alone determines the jump, and sliders do not know time.
    assert abs(found["thermal.temperature_change_max_K"]) < 1e-12 * found.jump
    assert abs(found["thermal.period_s"]) < 1e-12 * found.jump
    assert abs(found["link.*.thermal_expansion_per_K"]) * 1e-5 < 1e-9 * found.jump
    along, across = found["node.N10.position_m"]
    # A longer last bar bends more: its share is 1/55 of the jump over its length.
    length = case.resolve().links.stress_free_length_m[-1]
    assert along == pytest.approx(found.jump / 55 / length, rel=1e-6) and abs(across) < 1e-9 * found.jump
    assert found.frame()["parameter"].tolist()[0] == "thermal.temperature_change_max_K"


def test_gradient_of_single_items() -> None:
    found = sj.truss.chain(3).gradient()
    assert found.output == "node:N3" and not found.one_sided
    first = next(row for row in found.rows if row["parameter"].startswith("slider."))
    assert first["derivative"] * first["value"] / found.jump == pytest.approx(first["elasticity"])


def test_a_key_without_number_is_refused() -> None:
    with failing("key_without_number", key="link.L1.nodes"):
        sj.truss.chain(2).gradient(keys=["link.L1.nodes"])
