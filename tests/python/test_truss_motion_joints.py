# SPDX-License-Identifier: GPL-3.0-or-later
"""Latch hinges and Iwan joints in truss dynamics: slow heating compared with the quasi-static path, vibration on a
bolted joint, an arch that snaps through its play."""
from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import statejump as sj
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from conftest import REPOSITORY
from failures import failing
from test_truss_iwan import JOINT, bolted

from statejump import _engine
from statejump.kinds.truss import masses
from statejump.kinds.truss.arrays import GROUND
from statejump.kinds.truss.compare import reduced_name
from statejump.kinds.truss.motion import joint_dashpots_sqrt_kg

MASS_KG, LOAD_N = 2.0, 90.0


@pytest.mark.parametrize("name", ["latch_lever", "latch_boom"])
def test_latch_under_slow_heating_is_the_quasi_static_path(name: str) -> None:
    case = sj.load(REPOSITORY / f"cases/trusses/{name}.toml").changed(
        {"reduced.sticking": "elastic", "reduced.increments_per_branch": 1000, "thermal.period_s": 10.0,
         "motion.theta": 1.0})
    path = case.reduced()
    heats = []
    for steps in (1000, 4000):
        run = case.changed({"motion.steps_per_cycle": steps}).reduced(dynamic=True)
        # Steps end on the path; what is left is inertia, of the square of a period of 3 ms over 10 s.
        off = np.abs(run.at(path.time_s)["displacement_m"] - path["displacement_m"])
        assert off.max() < 1e-6 * np.abs(path["displacement_m"]).max()
        heats.append(run["friction_dissipation_J"][-1])
    # Works are those of forces at the ends of steps: first order.
    heat = path["friction_dissipation_J"][-1]
    assert abs(heats[1] - heat) < 0.4 * abs(heats[0] - heat) < 0.01 * heat


def test_mass_on_an_iwan_joint_swings_as_its_own_equation() -> None:
    made: dict[str, Any] = bolted(change_K=1e-6, cycles=1, elements=20)
    # Two of its slowest periods, 2 ms.
    made["thermal"]["period_s"] = 0.02
    made["node"][1] |= {"mass_kg": MASS_KG, "force_N": [LOAD_N, 0.0]}
    made["motion"] = {"start": "drawn", "steps_per_cycle": 40_000, "masses": "consistent"}
    made["dem"] = {**made.get("dem", {}), "link_damping_ratio": 0.0}
    made["output"] = {**made.get("output", {}), "samples_per_cycle": 400}
    run = sj.load(made).reduced(dynamic=True)
    moved = run["displacement_m"][:, 1, 0]

    chi, beta, stiffness = JOINT["exponent"], JOINT["stiffness_ratio"], JOINT["tangent_stiffness_N_per_m"]
    last = JOINT["slip_force_N"] * (1 + beta) / (stiffness * (beta + (chi + 1) / (chi + 2)))
    ends = last * (1.2 ** np.arange(21) - 1) / (1.2**20 - 1)
    share = np.diff((ends / last) ** (chi + 1))
    # The sliders of an interval as one: the force of all, when all of them slip, is kept.
    reach = (chi + 1) / (chi + 2) * last * np.diff((ends / last) ** (chi + 2)) / share
    springs = stiffness / (1 + beta) * np.append(share, beta)
    reach = np.append(reach, last)
    bar, mass = 70e9 * 9e-6 / 0.5, MASS_KG + 2700 * 9e-6 * 0.5 / 3

    def rate(_: float, state: np.ndarray) -> np.ndarray:
        """Rates of position, velocity and deflection of the elements' springs; a slipping spring deflects no further.
        """
        x, v, bends = state[0], state[1], state[2:]
        bending = np.where((np.abs(bends) >= reach) & (bends * v > 0), 0.0, v)
        return np.concatenate([[v, (LOAD_N - bar * x - springs @ bends) / mass], bending])

    found = solve_ivp(rate, (0, 0.02), np.zeros(2 + len(springs)), t_eval=run.time_s, max_step=2e-6, rtol=1e-8, atol=1e-12)
    # A mass that turns within a step: friction of first order, 40 000 steps of 400 a swing.
    assert np.abs(moved - found.y[0]).max() < 5e-3 * np.abs(moved).max()
    heat = run["friction_dissipation_J"]
    assert heat[-1] > 0.3 * LOAD_N * np.abs(moved).max()  # or nothing slips
    # Springs bend by the velocity at the end of a step, bodies move by its mean: first order in the step as well.
    assert abs(run.summary["energy_residue_J"]) < 5e-3 * heat[-1]


def test_creak_of_a_latch_has_its_slips_and_their_heat() -> None:
    found = sj.truss.creak(sj.load("latch_lever").changed({"motion.steps_per_cycle": 4000}), "B")
    assert {slip["joint"] for slip in found.slips} == {"latch"}
    heat = found.run["friction_dissipation_J"][-1]
    assert sum(slip["heat_J"] for slip in found.slips) == pytest.approx(heat, rel=1e-2)  # samples between the steps
    assert heat > 0
    found.plot()


def test_arch_snaps_where_the_path_ends_with_the_speed_of_what_it_sets_free() -> None:
    case = sj.load("two_bar_snap")
    with failing("no_continuation", joint="apex"):
        case.reduced()
    speeds, at = [], []
    for period_s in (1.0, 4.0):
        run = case.changed({"thermal.period_s": period_s, "motion.steps_per_cycle": int(20_000 * period_s)}).reduced(
            dynamic=True)
        apex = run.names["nodes"].index("B")
        speed = np.abs(run["velocity_m_per_s"][:, apex, 1])
        speeds.append(speed.max())
        at.append(run["temperature_change_K"][int(np.argmax(speed))])
        energies = run["elastic_energy_J"] + run["kinetic_energy_J"]
        assert abs(run.summary["energy_residue_J"]) < 1e-4 * np.ptp(energies)
    assert 3.95 < at[1] < at[0]
    # What is set free does not know how fast the arch was heated.
    assert speeds[0] == pytest.approx(speeds[1], rel=0.02)
    # Cold again it hangs: bars in tension on the far sides of the play carry the load.
    half, rise, rigidity, load, play = 0.5, 5e-3, 70e9 * 9e-6, 0.1, 2e-5
    length = np.hypot(half, rise)

    def lacking(depth: float) -> float:
        stretched = np.hypot(half - play / 2, depth)
        return 2 * rigidity * (stretched / length - 1) * depth / stretched - load

    hanging = -brentq(lacking, 5.9e-3, 8e-3)
    # The pin is not quite beside its bearing: friction holds it within its cone, μ² / 2 of the play's share.
    assert run["position_m"][-1, apex, 1] == pytest.approx(hanging, rel=0.01)


def test_arch_snaps_in_the_dem_as_it_does_in_motion() -> None:
    """There is no quasi-static path, so truss dynamics determines the DEM's time step. The results differ by the
    compliance of the DEM's joint."""
    case = sj.load("two_bar_snap")
    runs = case.reduced(dynamic=True), case.dem()
    assert sj.compare(*runs).passed
    labels = [text.get_text() for axes in sj.compare(*runs).plot().axes for legend in [axes.get_legend()] if legend
              for text in legend.get_texts()]
    assert reduced_name(runs[0]) in labels and "quasi-static solver" not in labels
    snapped = [run["position_m"][-1, run.names["nodes"].index("B"), 1] for run in runs]
    assert max(snapped) < -5e-3 and snapped[0] == pytest.approx(snapped[1], rel=1e-3)


def test_an_arch_without_a_joint_snaps_in_both_models_where_its_path_ends() -> None:
    snap = sj.load("two_bar_snap").to_dict()
    pinned = {key: value for key, value in snap.items() if key != "revolute"}
    pinned["node"] = [one for one in snap["node"] if one["name"] != "J"]
    pinned["link"] = [{**one, "nodes": [one["nodes"][0], "B"]} for one in snap["link"]]
    case = sj.load(pinned)
    half, rise, rigidity, load, shrinks = 0.5, 5e-3, 70e9 * 9e-6, 0.1, 2e-6
    # 2 E A (1 - l / l_T) y / l = P: past its shortest bars l_T the arch stands nowhere.
    height = np.linspace(1e-3, rise, 1_000_000)
    length = np.hypot(half, height)
    shortest = (length / (1 - load * length / (2 * rigidity * height))).min()
    at = (1 - shortest / np.hypot(half, rise)) / shrinks
    with failing("no_continuation") as told:
        case.reduced()
    assert told.value.temperature_change_K == pytest.approx(at, rel=1e-6)
    runs = case.reduced(dynamic=True), case.dem()
    assert sj.compare(*runs).passed
    assert max(run["position_m"][-1, 2, 1] for run in runs) < -rise


def test_a_dashpot_between_two_nodes_has_both_masses_in_series() -> None:
    truss = sj.load("telescope").definition.resolve()
    mass, ratio = masses.lumped_mass_kg(truss), 0.05
    sections = [kind for kind in _engine.truss_joints() for _ in truss.joints[kind].names]
    found = joint_dashpots_sqrt_kg(truss, ratio, mass)
    for (first, second), one in zip(truss.sliders.nodes, found[np.array(sections) == "slider"]):
        inverse = 1 / mass[first] + (0 if second == GROUND else 1 / mass[second])
        assert one == pytest.approx(2 * ratio / inverse**0.5, rel=1e-14)
    assert (truss.sliders.nodes[:, 1] != GROUND).any()
