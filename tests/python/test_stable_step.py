# SPDX-License-Identifier: GPL-3.0-or-later
"""Stable time steps: the kernel's limit, the two estimates based on it, and the value that a run in YADE reports."""
from __future__ import annotations

import json
import os
import re
import subprocess
import tomllib
from math import inf, sqrt

import numpy as np
import pytest

from conftest import BUILT, REPOSITORY
from statejump import _engine
from statejump.kinds.loading import parse_case
from statejump.kinds.spring_slider import stable_step
from statejump.kinds.truss import dem as truss_dem
from statejump.kinds.truss.solve import solve

EPS = 2.0**-52


def test_limit_by_hand() -> None:
    """k dt^2 + 2 c dt = 4 m."""
    step = _engine.critical_time_step_s
    assert step(0.3, 4e7) == pytest.approx(2 * sqrt(0.3 / 4e7), rel=4 * EPS)
    assert step(0.3, 0, 12.0) == pytest.approx(2 * 0.3 / 12, rel=4 * EPS)
    assert step(1, 3, 1) == pytest.approx((-2 + sqrt(52)) / 6, rel=4 * EPS)
    assert step(1, 0) == inf
    found = step(1.0, np.array([3.0, 0.0, 4.0]), np.array([1.0, 0.0, 0.0]))
    assert found.tolist() == [step(1, 3, 1), inf, 1.0]


@pytest.fixture(scope="module")
def undamped():
    """The paper's Table 1 without dashpots and with stops out of reach: only bar and floor have stiffness."""
    values = tomllib.loads((REPOSITORY / "cases" / "table1.toml").read_text())
    values["dem"].update(link_damping_ratio=0.0, contact_damping_ratio=0.0)
    values["joint"].update(clearance_minus_m=0.1, clearance_plus_m=0.1)
    return parse_case(values)


def test_spring_slider_by_hand(undamped) -> None:
    """The floor contact carries twice its 100 N: R = 50 mm, E* = 70e9/1.82, G* = 70e9/8.84 give its radius a, 2 E* a
    and 8 G* a. The bar has 1.26e6 N/m."""
    modulus, shear = 70e9 / (2 * 0.91), 70e9 / (4 * 1.7 * 1.3)
    width = (200 * 0.05 / (4 / 3 * modulus)) ** (1 / 3)
    mass = 2700 * 9e-6 * 0.5 / 3 + undamped.dem_settings.slider_mass_kg
    across, along = 2 * modulus * width, 70e9 * 9e-6 / 0.5 + 8 * shear * width
    expected = 2 * sqrt(mass / max(across, along))
    assert stable_step.stable_time_step(undamped) == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize("play_m, heated_K, stiffer", [
    (1e-3, 100.0, "along"),  # Table 1: pressed against a stop
    (1e-3, -100.0, "along"),  # the other stop, by cooling
    (2e-3, 100.0, "across"),  # no stop is met
])
def test_damped_spring_slider_by_hand(play_m: float, heated_K: float, stiffer: str) -> None:
    """Both axes of the slider have the stiffnesses of bar, floor and stop at twice their forces, each with a dashpot 2
    zeta sqrt(k m)."""
    values = tomllib.loads((REPOSITORY / "cases" / "table1.toml").read_text())
    values["joint"].update(clearance_plus_m=play_m, clearance_minus_m=play_m, preload_stiffness_N_per_m=1e5)
    values["thermal"]["temperature_change_max_K"] = heated_K
    values["dem"].update(link_damping_ratio=0.2, contact_damping_ratio=0.3, slider_mass_kg=0.01)
    modulus, shear = 70e9 / (2 * 0.91), 70e9 / (4 * 1.7 * 1.3)
    mass = 2700 * 9e-6 * 0.5 / 3 + 0.01
    bar = 70e9 * 9e-6 / (0.5 * (1 + 23.4e-6 * min(0.0, heated_K)))  # of the shortest bar

    def contact(force_N: float) -> tuple[float, float]:
        width = (2 * force_N * 0.05 / (4 / 3 * modulus)) ** (1 / 3)
        return 2 * modulus * width, 8 * shear * width

    floor, stop = contact(100), contact(bar * max(0.0, 0.5 * 23.4e-6 * abs(heated_K) - play_m))
    steps = []
    for spring, contacts in ((0.0, (floor[0], stop[1])), (bar + 1e5, (floor[1], stop[0]))):
        stiffness = spring + sum(contacts)
        damping = 2 * sqrt(mass) * (0.2 * sqrt(spring) + 0.3 * (sqrt(contacts[0]) + sqrt(contacts[1])))
        steps.append(4 * mass / (damping + sqrt(damping**2 + 4 * mass * stiffness)))
    assert stable_step.stable_time_step(parse_case(values)) == pytest.approx(min(steps), rel=1e-12)
    assert steps.index(min(steps)) == ("across", "along").index(stiffer)


def test_spring_slider_as_the_dem_reports(yade: str, undamped) -> None:
    """The estimate uses the contact stiffness of the DEM; the value that the run reports is not larger."""
    script = REPOSITORY / "tests" / "yade" / "scripts" / "stable_step.py"
    paths = [str(BUILT), str(script.parent), str(REPOSITORY / "yade_scripts" / "runner")]
    done = subprocess.run(
        [yade, "-n", "-x", str(script), json.dumps(undamped.behaviour.dem_input(undamped))], capture_output=True, text=True,
        timeout=120, env={**os.environ, "PYTHONPATH": os.pathsep.join(paths)}, stdin=subprocess.DEVNULL, check=False,
    )
    match = re.search(r"RESULT (\{.*)", done.stdout)
    assert match, done.stdout + done.stderr
    seen = json.loads(match[1])
    # The slider starts where the floor carries its 100 N: 1 um of a position of 50 mm, rounded to 7e-18 m.
    assert seen["force"] == pytest.approx(100, rel=1e-10)
    link, mass = 70e9 * 9e-6 / 0.5, stable_step.tip_mass(undamped)
    # All springs of the body together, and twice them, as its contact has two bodies.
    assert seen["stable"] == pytest.approx(sqrt(2 * mass / (link + seen["kn"] + seen["ks"])), rel=1e-10)
    twice = 2 ** (1 / 3)  # Hertz's stiffness at twice the force
    expected = 2 * sqrt(mass / max(twice * seen["kn"], link + twice * seen["ks"]))
    assert stable_step.stable_time_step(undamped) == pytest.approx(expected, rel=1e-10)


TRUSS = """
[case]
name = "two_links"
kind = "truss"
title = "Two links on a line"
source = "the tests"

[truss]
dimension = 2

[[node]]
name = "left"
position_m = [0.0, 0.0]
fixed = ["x", "y"]

[[node]]
name = "middle"
position_m = [0.5, 0.0]
fixed = ["y"]

[[node]]
name = "right"
position_m = [1.0, 0.0]
fixed = ["x", "y"]

[[link]]
name = "A"
nodes = ["left", "middle"]
young_modulus_Pa = 70e9
cross_section_area_m2 = 9e-6
density_kg_per_m3 = 2700
thermal_expansion_per_K = 0.0

[[link]]
name = "B"
nodes = ["middle", "right"]
young_modulus_Pa = 70e9
cross_section_area_m2 = 9e-6
density_kg_per_m3 = 2700
thermal_expansion_per_K = 0.0

[thermal]
shape = "triangle"
temperature_change_max_K = 10
period_s = 0.1

[dem]
link_damping_ratio = 0.0
contact_damping_ratio = 0.0
"""


def test_truss_by_hand() -> None:
    """One node between two links has a third of the mass of each link, 0.0081 kg in all, and the stiffness 2 x 1.26e6
    N/m."""
    case = parse_case(tomllib.loads(TRUSS))
    found = truss_dem.stable_time_step(case, solve(case))
    assert found == pytest.approx(2 * sqrt(2 * 2700 * 9e-6 * 0.5 / 3 / (2 * 70e9 * 9e-6 / 0.5)), rel=1e-12)


def test_damped_and_cooled_truss_by_hand() -> None:
    """Links 0.1 % shorter are stiffer by 0.1 %. Each has a dashpot 2 zeta sqrt(k m) with the node's mass m; both act on
    the node."""
    text = TRUSS.replace("thermal_expansion_per_K = 0.0", "thermal_expansion_per_K = 1e-4")
    text = text.replace("temperature_change_max_K = 10", "temperature_change_max_K = -10")
    case = parse_case(tomllib.loads(text.replace("link_damping_ratio = 0.0", "link_damping_ratio = 0.3")))
    mass, link = 2 * 2700 * 9e-6 * 0.5 / 3, 70e9 * 9e-6 / (0.5 * 0.999)
    damping = 2 * 2 * 0.3 * sqrt(link * mass)
    expected = 4 * mass / (damping + sqrt(damping**2 + 4 * mass * 2 * link))
    assert truss_dem.stable_time_step(case, solve(case)) == pytest.approx(expected, rel=1e-12)
