# SPDX-License-Identifier: GPL-3.0-or-later
"""Soft stops (stops with a stiffness), and play in series with friction: in the closed form, in trusses, in motion, and
as a case made from a measured loop. The reference solution moves a block step by step, by bisection."""
from __future__ import annotations

import tomllib
from typing import Any

import numpy as np
import pytest

from failures import failing, note
import statejump as sj
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
    """Return the bar on a slider as a truss, with changed keys of the slider."""
    return sj.load(TRUSS | {"slider": [TRUSS["slider"][0] | slider], "reduced": reduced or {}})


def states(case: sj.Case) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return times, slides and forces of the slider at the solver's own states; samples between them are interpolated.
    """
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
    """Return the force on the block that friction has to hold, positive towards the plus stop."""
    strain = EXPANSION * change_K
    bar = RIGIDITY / (LENGTH * (1 + strain)) * (LENGTH * strain - there)
    stop = joint.stop_stiffness_N_per_m * (there - np.clip(there, -MINUS, PLUS))
    return float(bar - joint.preload_force_N - joint.preload_stiffness_N_per_m * there - stop)


def moved(change_K: np.ndarray, joint: Any) -> np.ndarray:
    """Return the positions of the block: at every temperature bisection moves it until friction holds it."""
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


def moved_with_play(change_K: np.ndarray, joint: Any) -> np.ndarray:
    """Return the positions of the block: at every temperature bisection moves the middle of the play until friction
    holds."""
    def balance(held: float, change: float) -> float:
        low, high = -1.0, 1.0
        for _ in range(60):
            middle = (low + high) / 2
            low, high = (middle, high) if load_N(middle, change, joint) > held else (low, middle)
        return (low + high) / 2

    play, found = 0.0, []
    for change in change_K:
        x = balance(0.0, change)
        for sign in (1.0, -1.0):
            end = play + sign * joint.play_m / 2
            if sign * (x - end) > 0:
                slid = balance(sign * FRICTION, change)
                x = end if sign * (slid - end) <= 0 else slid
                play = x - sign * joint.play_m / 2
                break
        found.append(x)
    return np.array(found)


@pytest.mark.parametrize("preload", [{}, {"preload_stiffness_N_per_m": 2e5, "preload_force_N": 80.0},
                                     {"preload_force_N": -700.0}])
def test_closed_form_is_that_of_small_steps(preload: dict[str, float]) -> None:
    """With the last preload, the block is pressed on the stop already at the start."""
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


@pytest.mark.parametrize("joint", [
    {"play_m": 4e-4}, {"play_m": 1e-4, "preload_stiffness_N_per_m": 2e5, "preload_force_N": 80.0}, {"play_m": 4e-3},
])
def test_closed_form_with_play_is_that_of_small_steps(joint: dict[str, float]) -> None:
    case = spring_slider(stop_stiffness_N_per_m=STOP, **joint)
    run = case.reduced()
    # Halving leaves 1 m/2^60; the program turns at every hundredth sample.
    np.testing.assert_allclose(run["displacement_m"][::20], moved_with_play(run["temperature_change_K"][::20], case.joint),
                               atol=1e-15, rtol=0)
    stored = run["elastic_energy_J"] + run["preload_energy_J"]
    left = run["thermal_work_J"] - (stored - stored[0]) - run["friction_dissipation_J"]
    assert np.abs(left).max() < 1e-13 * np.abs(run["thermal_work_J"]).max() + 1e-14 * stored.max()
    assert (run["friction_force_N"] == 0).sum() > 10


@pytest.mark.parametrize("keys", [
    {"play_m": 4e-4}, {"play_m": 4e-4, "stop_stiffness_N_per_m": STOP}, {"play_m": 4e-4, "preload_force_N": 300.0},
])
def test_play_of_a_truss_is_that_of_the_closed_form(keys: dict[str, float]) -> None:
    """The play acts in series with the pad of the truss, which yields by 30 N over its stiffness k_t, 1.5e-6 m."""
    joint = dict(keys)
    load = joint.pop("preload_force_N", 0.0)
    nodes = [TRUSS["node"][0], TRUSS["node"][1] | {"force_N": [-load, 0.0]}]
    slider = TRUSS["slider"][0] | joint | {"clearance_minus_m": MINUS, "clearance_plus_m": PLUS}
    times, slide, _ = states(sj.load(TRUSS | {"node": nodes, "slider": [slider]}))
    exact = spring_slider(**keys).reduced().at(times)
    assert np.abs(slide - exact["displacement_m"]).max() < 2 * FRICTION / pad_stiffness()


def test_play_without_friction_is_refused() -> None:
    with failing("play_without_friction", key="joint.play_m", value=1e-4):
        spring_slider(play_m=1e-4, friction_coefficient=0.0)


@pytest.mark.parametrize("keys", [
    {"clearance_plus_m": 1.3e-3}, {"stop_stiffness_N_per_m": STOP}, {"play_m": 3e-3, "clearance_plus_m": 1.3e-3},
    {"play_m": 2e-4, "preload_stiffness_N_per_m": 2e5, "preload_force_N": 160.0},
    {"play_m": 2e-4, "preload_stiffness_N_per_m": 2e5, "preload_force_N": 200.0},
])
def test_dem_of_a_spring_slider_with_play_is_the_closed_form(keys: dict[str, float]) -> None:
    """The models agree within the tolerances of `compare`. Cases: soft stops inside and outside the play, and starts
    with friction below and at its limit."""
    away = {} if "stop_stiffness_N_per_m" in keys else {"clearance_minus_m": 5e-3, "clearance_plus_m": 5e-3}
    case = spring_slider(**({"play_m": 4e-4} | away | keys))
    found = sj.compare(case.reduced(), case.dem())
    assert found.passed, found


def test_rest_sets_end_where_friction_does() -> None:
    case = spring_slider(stop_stiffness_N_per_m=STOP, preload_stiffness_N_per_m=2e5, preload_force_N=80.0)
    segments = sj.statics(case).segments
    assert min(part.from_m for part in segments) < -MINUS and max(part.to_m for part in segments) > PLUS
    for part in segments:
        for place, held in ((part.from_m, FRICTION), (part.to_m, -FRICTION)):
            # Forces of 2000 N are rounded.
            assert load_N(place, part.temperature_change_K, case.joint) == pytest.approx(held, abs=1e-11)


def test_stiff_stop_is_the_rigid_one() -> None:
    """A stiff stop yields by its force over its stiffness, 1e-9 m; position of the block and jump differ by no more."""
    soft, rigid = (spring_slider(**keys).reduced() for keys in ({"stop_stiffness_N_per_m": 1e12}, {}))
    assert np.abs(soft["displacement_m"] - rigid["displacement_m"]).max() < np.abs(rigid["stop_force_N"]).max() / 1e12 * 2
    assert [event.kind for event in soft.events][:2] == [event.kind for event in rigid.events][:2]


@pytest.mark.parametrize("sticking", ["rigid", "elastic"])
def test_soft_stops_of_a_truss_are_those_of_the_closed_form(sticking: str) -> None:
    """With rigid sticking the truss equals the closed form; with elastic sticking the pad yields by 30 N over k_t, 2e-6
    m."""
    times, slide, force = states(truss({"sticking": sticking}, clearance_minus_m=MINUS, clearance_plus_m=PLUS,
                                       stop_stiffness_N_per_m=STOP))
    exact = spring_slider(stop_stiffness_N_per_m=STOP).reduced().at(times)
    allowed = 1e-12 if sticking == "rigid" else 1e-5
    np.testing.assert_allclose(slide, exact["displacement_m"], atol=allowed, rtol=0)
    stop = STOP * (slide - np.clip(slide, -MINUS, PLUS))
    assert np.abs(force - stop).max() < FRICTION * (1 + 1e-9)


@pytest.mark.parametrize("play", [1e-4, 6e-4])
def test_play_of_a_truss_is_that_of_the_identified_joint(play: float) -> None:
    """Slip and force of the slider form the loop of friction with play, in series with the pad's stiffness k_t."""
    _, slide, force = states(truss(play_m=play))
    stiffness = pad_stiffness()
    joint = {"stiffness": stiffness, "friction": FRICTION, "preload": 0.0, "play": play}
    expected = MODELS["coulomb_play"].answer(joint, slide, remembered(slide, fresh=True))
    # k_t times the rounding with which the solver knows the slide, 1e-14 of the bar's length.
    np.testing.assert_allclose(force, expected, atol=stiffness * 1e-13, rtol=0)
    assert (force == 0).sum() > 10 and np.abs(force).max() == pytest.approx(FRICTION, rel=1e-9)


def pad_stiffness() -> float:
    """Return Mindlin's tangential stiffness of the pad under its normal force [N/m]: 8 G* a with Hertz's radius a."""
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
    {"play_m": 2e-4, "clearance_minus_m": MINUS, "clearance_plus_m": PLUS, "stop_stiffness_N_per_m": STOP},
])
def test_slow_motion_is_the_quasi_static_path(keys: dict[str, float]) -> None:
    """The bar with its end mass has a period of 1 ms, while the program changes over seconds. The path is interpolated
    between its states; the allowed error is half of the free expansion between two states plus half of the friction."""
    case = truss({"sticking": "elastic"}, **keys)
    path, motion = case.reduced(), case.reduced(dynamic=True)
    between = EXPANSION * LENGTH * 115.0 / 50
    off = np.abs(motion["slide_m"] - path["slide_m"])
    assert off.max() < between / 2 and np.median(off) < 1e-3 * between
    off = np.abs(motion["slider_force_N"] - path["slider_force_N"])
    assert off.max() < 0.51 * FRICTION and np.median(off) < 1e-3 * FRICTION
    assert motion["friction_dissipation_J"][-1] == pytest.approx(path["friction_dissipation_J"][-1], rel=2e-3)


@pytest.mark.parametrize("keys", [
    {"play_m": 4e-4}, {"clearance_minus_m": MINUS, "clearance_plus_m": PLUS, "stop_stiffness_N_per_m": STOP},
    {"play_m": 2e-4, "clearance_plus_m": PLUS, "stop_stiffness_N_per_m": STOP},
])
def test_explicit_steps_are_the_motion(keys: dict[str, float]) -> None:
    """A loaded end of 1000 kg swings through play and stop for two periods. The implicit scheme treats friction with
    first-order accuracy: with 40000 steps in two periods the error is 4 π/40000 of swing and of heat."""
    period = 2 * np.pi * np.sqrt(1000.0 * LENGTH / RIGIDITY)
    load, steps = 1500.0, 40000
    nodes = [TRUSS["node"][0], TRUSS["node"][1] | {"force_N": [load, 0.0], "mass_kg": 1000.0}]
    still = {"shape": "table", "table_time_s": [0.0, 2 * period], "table_temperature_change_K": [0.0, 0.0], "cycles": 1}
    implicit, explicit = (sj.load(TRUSS | {
        "node": nodes, "slider": [TRUSS["slider"][0] | keys], "thermal": still, "reduced": {"sticking": "elastic"},
        "motion": {"start": "drawn", "scheme": scheme, "steps_per_cycle": steps, "masses": "lumped"},
        "output": {"samples_per_cycle": 200}, "dem": {"contact_damping_ratio": 0.0, "link_damping_ratio": 0.0},
    }).reduced(dynamic=True) for scheme in ("set_valued", "regularised"))
    swing, allowed = np.ptp(implicit["slide_m"]), 4 * np.pi / steps
    assert swing > 3 * PLUS
    assert np.abs(implicit["slide_m"] - explicit["slide_m"]).max() < allowed * swing
    heats = [run["friction_dissipation_J"][-1] for run in (implicit, explicit)]
    assert heats[0] > 0 and heats[1] == pytest.approx(heats[0], rel=allowed)
    for run in (implicit, explicit):
        left = (run["elastic_energy_J"] + run["kinetic_energy_J"] + run["friction_dissipation_J"]
                - load * run["slide_m"][:, 0])
        # A kink within a step is off by its second power, 400 times in a program.
        assert np.abs(left - left[0]).max() < 400 * allowed**2 * load * swing


def test_play_moves_beside_a_latch_hinge() -> None:
    """Two uncoupled structures in one case move as each alone. Steps without a solution at an edge of the latch's play
    become damped half steps in both, so vibrations differ by 1e-4 of the slide."""
    lever = {
        "node": [{"name": "P", "position_m": [0.0, 1.0], "fixed": ["x", "y"]}, {"name": "Q", "position_m": [0.5, 1.0]},
                 {"name": "R", "position_m": [0.5, 0.6], "fixed": ["x", "y"]}],
        "link": [TRUSS["link"][0] | {"name": "PQ", "nodes": ["P", "Q"]}, TRUSS["link"][0] | {
            "name": "RQ", "nodes": ["R", "Q"]}],
        "latch_hinge": [{"name": "latch", "links": ["PQ"], "deadband_rad": 5e-4, "stiffness_N_m_per_rad": 200.0,
                         "friction_moment_N_m": 3.0, "friction_stiffness_N_m_per_rad": 1e5}],
    }
    own = TRUSS | {"slider": [TRUSS["slider"][0] | {"play_m": 4e-4}], "reduced": {"sticking": "elastic"},
                   "motion": {"steps_per_cycle": 3000}}
    alone = sj.load(own).reduced(dynamic=True)
    both = sj.load(own | {key: [*own.get(key, []), *items] for key, items in lever.items()}).reduced(dynamic=True)
    np.testing.assert_allclose(both["slide_m"], alone["slide_m"], rtol=0, atol=1e-4 * np.ptp(alone["slide_m"]))
    assert np.ptp(both["hinge_rotation_rad"]) > 5e-4


@pytest.mark.parametrize("scheme", ["set_valued", "regularised"])
@pytest.mark.parametrize("keys", [{}, {"play_m": 1e-4}, {"play_m": 1e-7}])
def test_motion_begins_at_rest(scheme: str, keys: dict[str, float]) -> None:
    """Friction that holds a load at the start also holds it in motion, so nothing moves. The pad yields by 7e-7 m."""
    nodes = [TRUSS["node"][0], TRUSS["node"][1] | {"force_N": [FRICTION / 2, 0.0]}]
    still = {"shape": "table", "table_time_s": [0.0, 0.05], "table_temperature_change_K": [0.0, 0.0], "cycles": 1}
    case = sj.load(TRUSS | {"node": nodes, "slider": [TRUSS["slider"][0] | keys], "thermal": still,
                            "reduced": {"sticking": "elastic"}, "output": {"samples_per_cycle": 10},
                            "motion": {"scheme": scheme, "steps_per_cycle": 20000, "masses": "lumped"}})
    path, motion = case.reduced(), case.reduced(dynamic=True)
    # The balance of forces of 15 N holds to 1e-10 of them.
    for column, scale in (("slide_m", abs(path["slide_m"][0, 0])), ("slider_force_N", FRICTION)):
        np.testing.assert_allclose(motion[column], np.broadcast_to(path[column][0], motion[column].shape), rtol=0,
                                   atol=1e-8 * scale)


@pytest.mark.parametrize("model", ["coulomb_soft_stops", "coulomb_play"])
def test_identified_joint_goes_into_a_case(model: str) -> None:
    """The section identified from the loop of a slider is that slider, within the interval of the noise."""
    true = {"coulomb_soft_stops": {"clearance_minus_m": MINUS, "clearance_plus_m": PLUS, "stop_stiffness_N_per_m": STOP},
            "coulomb_play": {"play_m": 4e-4}}[model]
    own = {key.removesuffix("_N_per_m").removesuffix("_m"): value for key, value in true.items()}
    path = 1e-3 * np.sin(np.linspace(0, 4 * np.pi, 401))
    values = {"stiffness": RIGIDITY / LENGTH, "friction": FRICTION, "preload": 0.0, **own}
    force = MODELS[model].answer(values, path, remembered(path, fresh=True))
    noise = np.random.default_rng(2).normal(0, 0.3, len(path))
    found, other = (sj.identify({"displacement_m": path, "force_N": force + noise}, start="fresh", model=model,
                                target=target, normal_force_N=FRICTION / 0.3) for target in ("slider", "spring_slider"))
    joint = tomllib.loads(other.joint())["joint"]
    own_key = list(true)[-1]
    assert getattr(spring_slider(**joint).joint, own_key) == pytest.approx(true[own_key], rel=0.05)
    section = tomllib.loads(found.joint())["slider"][0]
    case = truss(**section)
    for key, value in true.items():
        assert section[key] == pytest.approx(value, rel=0.05)
        assert f"slider.*.{key}" in found.distributions()
    assert note("parameter_without_key") not in found.notes
    assert np.isfinite(case.reduced()["slide_m"]).all() if "slide_m" in case.reduced() else True
