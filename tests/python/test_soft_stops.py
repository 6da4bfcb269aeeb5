# SPDX-License-Identifier: GPL-3.0-or-later
"""Stops of a stiffness of their own and play in series with friction: in the closed form, on trusses, in motion, and
from a measured loop into a case. The reference moves a block step by step, by halving."""
from __future__ import annotations

import tomllib
from typing import Any

import numpy as np
import pytest

import statejump as sj
from statejump.core.errors import StatejumpError
from statejump.identification.hysteresis import remembered
from statejump.identification.models import MODELS
from statejump.kinds.truss import solve

RIGIDITY, LENGTH, EXPANSION = 1.26e6, 1.0, 2.3e-5  # E A [N], [m], [1/K]
FRICTION, STOP = 30.0, 4e5  # [N], [N/m]
MINUS, PLUS = 3e-4, 5e-4
TRUSS: dict[str, Any] = {
    "case": {"name": "bolt", "kind": "truss", "title": "bolt", "source": "a test"},
    "truss": {"dimension": 2},
    "node": [{"name": "A", "position_m": [0.0, 0.0], "fixed": ["x", "y"]},
             {"name": "B", "position_m": [LENGTH, 0.0], "fixed": ["y"]}],
    "link": [{"name": "bar", "nodes": ["A", "B"], "young_modulus_Pa": 70e9, "cross_section_area_m2": RIGIDITY / 70e9,
              "thermal_expansion_per_K": EXPANSION, "density_kg_per_m3": 2700.0}],
    "slider": [{"name": "S", "nodes": ["B"], "axis": [1.0, 0.0], "friction_coefficient": 0.3,
                "normal_force_N": FRICTION / 0.3}],
    "thermal": {"shape": "table", "table_time_s": [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0],
                "table_temperature_change_K": [0.0, 60.0, -20.0, 45.0, -70.0, 30.0, 0.0], "cycles": 1},
    "output": {"samples_per_cycle": 600},
}


def truss(reduced: dict[str, Any] | None = None, **slider: Any) -> sj.Case:
    """Return the bar on a slider, with other keys of the slider."""
    return sj.load(TRUSS | {"slider": [TRUSS["slider"][0] | slider], "reduced": reduced or {}})


def states(case: sj.Case) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return times, slides and forces of the slider where the solver was; samples in between are interpolated."""
    found = solve.path(case.definition.resolve()).states
    return found["time_s"], found["slide_m"][:, 0], found["slider_force_N"][:, 0]


def spring_slider(**joint: Any) -> sj.Case:
    """Return the same bar as the closed form has it."""
    link = {key: value for key, value in TRUSS["link"][0].items() if key not in ("name", "nodes")}
    return sj.load({
        "case": TRUSS["case"] | {"kind": "spring_slider"}, "link": link | {"stress_free_length_m": LENGTH},
        "joint": {"normal_force_N": FRICTION / 0.3, "friction_coefficient": 0.3, "clearance_minus_m": MINUS,
                  "clearance_plus_m": PLUS} | joint,
        "thermal": TRUSS["thermal"], "dem": {"samples_per_cycle": 600},
    })


def load_N(there: float, change_K: float, joint: Any) -> float:
    """Return what friction has to hold of the block, towards the stop on the plus side."""
    strain = EXPANSION * change_K
    bar = RIGIDITY / (LENGTH * (1 + strain)) * (LENGTH * strain - there)
    stop = joint.stop_stiffness_N_per_m * (there - np.clip(there, -MINUS, PLUS))
    return float(bar - joint.preload_force_N - joint.preload_stiffness_N_per_m * there - stop)


def moved(change_K: np.ndarray, joint: Any) -> np.ndarray:
    """Return where the block is: at every temperature it moves, by halving, until friction holds it."""
    x, found = 0.0, []
    for change in change_K:
        for sign in (1.0, -1.0):
            if sign * load_N(x, change, joint) > FRICTION:
                inside, outside = x, x + sign
                for _ in range(60):
                    middle = (inside + outside) / 2
                    moves = sign * load_N(middle, change, joint) > FRICTION
                    inside, outside = (middle, outside) if moves else (inside, middle)
                x = (inside + outside) / 2
        found.append(x)
    return np.array(found)


@pytest.mark.parametrize("preload", [{}, {"preload_stiffness_N_per_m": 2e5, "preload_force_N": 80.0},
                                     {"preload_force_N": -700.0}])
def test_closed_form_is_that_of_small_steps(preload: dict[str, float]) -> None:
    """From the start as well, where the last preload presses the block on the stop."""
    case = spring_slider(stop_stiffness_N_per_m=STOP, **preload)
    run = case.reduced()
    # Halving leaves 1 m/2^60.
    np.testing.assert_allclose(run["displacement_m"], moved(run["temperature_change_K"], case.joint), atol=1e-15, rtol=0)
    x = run["displacement_m"]
    stop = -STOP * (x - np.clip(x, -MINUS, PLUS))
    np.testing.assert_allclose(run["stop_force_N"], stop, atol=1e-9, rtol=0)
    assert np.abs(stop).max() > FRICTION
    # Work of temperature, energies and heat are computed apart: rounding of their sum.
    stored = run["elastic_energy_J"] + run["preload_energy_J"]
    left = run["thermal_work_J"] - (stored - stored[0]) - run["friction_dissipation_J"]
    assert np.abs(left).max() < 1e-13 * np.abs(run["thermal_work_J"]).max() + 1e-14 * stored.max()


def test_rest_sets_end_where_friction_does() -> None:
    case = spring_slider(stop_stiffness_N_per_m=STOP, preload_stiffness_N_per_m=2e5, preload_force_N=80.0)
    segments = sj.statics(case).segments
    assert min(part.from_m for part in segments) < -MINUS and max(part.to_m for part in segments) > PLUS
    for part in segments:
        for place, held in ((part.from_m, FRICTION), (part.to_m, -FRICTION)):
            # Forces of 2000 N are rounded.
            assert load_N(place, part.temperature_change_K, case.joint) == pytest.approx(held, abs=1e-11)


def test_stiff_stop_is_the_rigid_one() -> None:
    """The stop gives by its force over its stiffness, 1e-9 m: so much the block and the jump differ."""
    soft, rigid = (spring_slider(**keys).reduced() for keys in ({"stop_stiffness_N_per_m": 1e12}, {}))
    assert np.abs(soft["displacement_m"] - rigid["displacement_m"]).max() < np.abs(rigid["stop_force_N"]).max() / 1e12 * 2
    assert [event.kind for event in soft.events][:2] == [event.kind for event in rigid.events][:2]


@pytest.mark.parametrize("sticking", ["rigid", "elastic"])
def test_soft_stops_of_a_truss_are_those_of_the_closed_form(sticking: str) -> None:
    """Where friction sticks rigidly the truss is the closed form; where the pad gives, by 30 N over its k_t, 2e-6 m."""
    times, slide, force = states(truss({"sticking": sticking}, clearance_minus_m=MINUS, clearance_plus_m=PLUS,
                                       stop_stiffness_N_per_m=STOP))
    exact = spring_slider(stop_stiffness_N_per_m=STOP).reduced().at(times)
    allowed = 1e-12 if sticking == "rigid" else 1e-5
    np.testing.assert_allclose(slide, exact["displacement_m"], atol=allowed, rtol=0)
    stop = STOP * (slide - np.clip(slide, -MINUS, PLUS))
    assert np.abs(force - stop).max() < FRICTION * (1 + 1e-9)


@pytest.mark.parametrize("play", [1e-4, 6e-4])
def test_play_of_a_truss_is_that_of_the_identified_joint(play: float) -> None:
    """Slide and force of the slider are the loop of a friction with play behind its own k_t."""
    _, slide, force = states(truss(play_m=play))
    stiffness = pad_stiffness()
    joint = {"stiffness": stiffness, "friction": FRICTION, "preload": 0.0, "play": play}
    expected = MODELS["coulomb_play"].answer(joint, slide, remembered(slide, fresh=True))
    # k_t times the rounding with which the solver knows the slide, 1e-14 of the bar's length.
    np.testing.assert_allclose(force, expected, atol=stiffness * 1e-13, rtol=0)
    assert (force == 0).sum() > 10 and np.abs(force).max() == pytest.approx(FRICTION, rel=1e-9)


def pad_stiffness() -> float:
    """Return Mindlin's k_t of the pad under its normal force [N/m]: 8 G* a, Hertz's radius a."""
    radius, modulus, poisson = 0.05, 70e9, 0.3
    effective = modulus / (2 * (1 - poisson**2))
    contact = (3 * (FRICTION / 0.3) * radius / (4 * effective)) ** (1 / 3)
    return float(8 * modulus / (4 * (1 + poisson) * (2 - poisson)) * contact)


@pytest.mark.parametrize("keys", [
    {"clearance_minus_m": MINUS, "clearance_plus_m": PLUS, "stop_stiffness_N_per_m": STOP}, {"play_m": 4e-4},
    {"play_m": 2e-4, "clearance_plus_m": PLUS, "stop_stiffness_N_per_m": STOP},
])
def test_energies_balance(keys: dict[str, float]) -> None:
    run = truss(**keys).reduced()
    left = run["thermal_work_J"] - (run["elastic_energy_J"] - run["elastic_energy_J"][0]) - run["friction_dissipation_J"]
    # The solver keeps a path's balance to 2.5e-11 of its work.
    assert np.abs(left).max() < 1e-9 * np.abs(run["thermal_work_J"]).max()
    assert run["friction_dissipation_J"][-1] > 0


@pytest.mark.parametrize("keys", [
    {"clearance_minus_m": MINUS, "clearance_plus_m": PLUS, "stop_stiffness_N_per_m": STOP}, {"play_m": 4e-4},
])
def test_slow_motion_is_the_quasi_static_path(keys: dict[str, float]) -> None:
    """The bar and its end have a period of 1 ms, the program bends over seconds. Samples of the path are interpolated over
    what happens between two of its states: by half of the free expansion between them, and half of the friction."""
    case = truss({"sticking": "elastic"}, **keys)
    path, motion = case.reduced(), case.reduced(dynamic=True)
    between = EXPANSION * LENGTH * 115.0 / 50
    off = np.abs(motion["slide_m"] - path["slide_m"])
    assert off.max() < between / 2 and np.median(off) < 1e-3 * between
    off = np.abs(motion["slider_force_N"] - path["slider_force_N"])
    assert off.max() < 0.51 * FRICTION and np.median(off) < 1e-3 * FRICTION
    assert motion["friction_dissipation_J"][-1] == pytest.approx(path["friction_dissipation_J"][-1], rel=2e-3)


def test_motion_refuses_a_play_beside_soft_stops() -> None:
    case = truss(play_m=1e-4, clearance_plus_m=PLUS, stop_stiffness_N_per_m=STOP)
    with pytest.raises(StatejumpError, match="must be 0 in motion, beside soft stops or latch hinges"):
        case.reduced(dynamic=True)


@pytest.mark.parametrize("model", ["coulomb_soft_stops", "coulomb_play"])
def test_identified_joint_goes_into_a_case(model: str) -> None:
    """The section of the loop of a slider is that slider, within the interval of noise."""
    true = {"coulomb_soft_stops": {"clearance_minus_m": MINUS, "clearance_plus_m": PLUS, "stop_stiffness_N_per_m": STOP},
            "coulomb_play": {"play_m": 4e-4}}[model]
    own = {key.removesuffix("_N_per_m").removesuffix("_m"): value for key, value in true.items()}
    path = 1e-3 * np.sin(np.linspace(0, 4 * np.pi, 401))
    values = {"stiffness": RIGIDITY / LENGTH, "friction": FRICTION, "preload": 0.0, **own}
    force = MODELS[model].answer(values, path, remembered(path, fresh=True))
    noise = np.random.default_rng(2).normal(0, 0.3, len(path))
    found = sj.identify({"displacement_m": path, "force_N": force + noise}, start="fresh", model=model, target="slider",
                        normal_force_N=FRICTION / 0.3)
    section = tomllib.loads(found.joint())["slider"][0]
    case = truss(**section)
    for key, value in true.items():
        assert section[key] == pytest.approx(value, rel=0.05)
        assert f"slider.*.{key}" in found.distributions()
    assert not any("has no key" in note for note in found.notes)
    assert np.isfinite(case.reduced()["slide_m"]).all() if "slide_m" in case.reduced() else True
