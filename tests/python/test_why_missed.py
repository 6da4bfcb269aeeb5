# SPDX-License-Identifier: GPL-3.0-or-later
"""A comparison that misses a tolerance reports possible reasons and the settings to change; changing them helps."""
from __future__ import annotations

from math import inf, pi, sqrt
from typing import Any

import pytest

from failures import note
import statejump as sj
from statejump import _engine
from statejump.core.units import text
from statejump.core.why_missed import heated_too_fast, kink, rounded_up
from statejump.kinds.spring_slider.compare import natural_period_s
from statejump.kinds.truss.joints.slider import SLIDER
from statejump.kinds.truss.solve import solve
from statejump.kinds.truss.why_missed import slowest_natural_period_s

LINK = {"young_modulus_Pa": 70e9, "cross_section_area_m2": 1e-5, "thermal_expansion_per_K": 2e-5, "mass_kg": 3.0}


def planar(**more: Any) -> dict[str, Any]:
    return {"case": {"name": "beam", "kind": "truss"}, "truss": {"dimension": 2},
            "thermal": {"shape": "triangle", "temperature_change_max_K": 1.0}, **more}


def test_slowest_natural_period_of_bars_in_a_row() -> None:
    """Two masses m on two bars of stiffness k have the lowest ω² = k/m (3 - √5)/2."""
    data = planar(
        node=[{"name": name, "position_m": [x, 0.0], "fixed": fixed}
              for name, x, fixed in (("A", 0.0, ["x", "y"]), ("B", 1.0, ["y"]), ("C", 2.0, ["y"]))],
        link=[{"name": "AB", "nodes": ["A", "B"], **LINK},
              {"name": "BC", "nodes": ["B", "C"], **LINK, "mass_kg": 4.0}])
    # A bar on a fixed node gives a third of its mass to the other one, else half to each: 1 + 2 and 2 kg.
    k, (first, second) = 7e5, (3.0, 2.0)
    middle = k * (2 / first + 1 / second) / 2
    least = middle - sqrt(middle**2 - k**2 / (first * second))
    found = slowest_natural_period_s(solve(sj.load(data).definition))
    assert found == pytest.approx(2 * pi / sqrt(least), rel=1e-9)


def test_a_torsion_spring_holds_what_links_do_not() -> None:
    """A link of length l on a pin with a torsion spring K has ω² = K/(m/3 l²)."""
    data = planar(
        node=[{"name": "A", "position_m": [0.0, 0.0], "fixed": ["x", "y"]}, {"name": "B", "position_m": [0.0, 2.0]}],
        link=[{"name": "AB", "nodes": ["A", "B"], **LINK}],
        torsion_spring=[{"name": "T", "links": ["AB"], "stiffness_N_m_per_rad": 50.0}])
    assert slowest_natural_period_s(solve(sj.load(data).definition)) == pytest.approx(2 * pi * sqrt(4.0 / 50.0), rel=1e-9)


@pytest.mark.parametrize(("shape", "size"), [("triangle", 4.0), ("half_sine", pi), ("sine", pi)])
def test_corners_of_temperatures(shape: str, size: float) -> None:
    program = _engine.ThermalProgram(shape=shape, temperature_change_max_K=-30.0, period_s=7.0)
    # Half a sine begins with π ranges a cycle; a sine, whose range is twice its peak, too.
    assert kink(program) == pytest.approx(size, rel=2e-3)


@pytest.mark.parametrize(("value", "wanted"), [(0.011, 0.02), (0.02, 0.02), (1.0, 1.0), (9.3, 10.0), (640.0, 700.0)])
def test_rounding_up(value: float, wanted: float) -> None:
    assert rounded_up(value) == wanted


def test_what_is_said_helps() -> None:
    """Table 1 within three natural periods of the block, hardly damped."""
    case = sj.load("table1").definition
    period = natural_period_s(case)
    fast = sj.load("table1").changed({"thermal.period_s": 3 * period, "dem.link_damping_ratio": 0.01,
                                      "dem.contact_damping_ratio": 0.01})
    missed = sj.compare(fast.reduced(), fast.dem())
    assert not missed.passed
    said = next(reason for reason in missed.reasons if reason == note("heated_too_fast"))
    assert said.details["natural_period_s"] == pytest.approx(2 * pi * sqrt(4.05e-3 / 1.26e6), rel=1e-3)
    longer = said.details["enough_s"]
    assert f"thermal.period_s = {longer:g} " in said
    slow = fast.changed({"thermal.period_s": longer})
    again = sj.compare(slow.reduced(), slow.dem())
    assert "displacement_rms_over_largest" in missed.missed and "displacement_rms_over_largest" not in again.missed


@pytest.mark.parametrize(("allowed_m", "wanted"), [
    (1e-15, inf),
    # 4 · 1 mm / 1 s · 10 ms / 2π is 6.37 µm, that over a tenth of 67 pm 9.5e5.
    (6.7e-11, 1e6), (1e-8, 7000.0),
])
def test_advice_stays_within_what_the_case_allows(allowed_m: float, wanted: float) -> None:
    thermal = sj.load(planar(node=[{"name": "A", "position_m": [0.0, 0.0], "fixed": ["x", "y"]}])).definition.thermal
    program = _engine.ThermalProgram(shape="triangle", temperature_change_max_K=1.0, period_s=1.0)
    (said,) = heated_too_fast(1e-2, thermal, program, 1e-3, allowed_m)
    assert said == note("heated_too_fast", enough_s=wanted) and (f"thermal.period_s = {wanted:g} " in said) == (wanted < inf)


def test_pads_that_bend_across_are_named() -> None:
    """A load F across the axis of a slider between two nodes displaces it by F over the pad's Hertz stiffness."""
    load, normal, radius = 40.0, 300.0, 0.02
    data = planar(
        node=[{"name": "A", "position_m": [0.0, 0.0], "fixed": ["x", "y"]},
              {"name": "B", "position_m": [1.0, 0.0], "force_N": [0.0, load]},
              {"name": "C", "position_m": [1.0, 0.0], "fixed": ["x", "y"]}],
        link=[{"name": "AB", "nodes": ["A", "B"], **LINK}],
        slider=[{"name": "S", "nodes": ["B", "C"], "axis": [1.0, 0.0], "friction_coefficient": 0.1,
                 "normal_force_N": normal, "pad_radius_m": radius}])
    path = solve(sj.load(data).definition)
    effective = 70e9 / (2 * (1 - 0.3**2))
    stiffness = (6 * normal * effective**2 * radius) ** (1 / 3)  # dF/dδ of F = 4/3 E* sqrt(R) δ^1.5
    give = load / stiffness
    (said,) = SLIDER.gives_in_dem(path, path.truss.sliders, 0.99 * give)
    assert said == note("pads_bend", joint="S", bent=text(give, "m", 2))
    assert not SLIDER.gives_in_dem(path, path.truss.sliders, 1.01 * give)
