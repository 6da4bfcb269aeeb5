# SPDX-License-Identifier: GPL-3.0-or-later
"""The quasi-static solver of trusses, compared with closed forms and with the other reduced models."""
from __future__ import annotations

import importlib.util
import itertools
import tomllib
from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from failures import failure
from statejump import _engine
from statejump.kinds.spring_slider import reduced
from statejump.core.errors import StatejumpError
from statejump.kinds.loading import load_case, parse_case
from statejump.kinds.truss import generate, solve
from statejump.kinds.truss.generate.document import document, finished, node
from statejump.kinds.truss.joints.revolute import REVOLUTE
from statejump.kinds.truss.resolved import ResolvedTruss
from statejump.kinds.umbrella import reduced as umbrella

ROOT = Path(__file__).resolve().parents[2]

# Closed forms and solver round differently: 1e-16 times the condition of n bars in a row.
CLOSED_FORM = 1e-10


def resolved(document: dict[str, Any]) -> ResolvedTruss:
    return parse_case(document).resolve()


def path(document: dict[str, Any], **options: Any) -> solve.TrussPath:
    return solve.path(resolved(document), **options)


def jump_m(found: solve.TrussPath) -> np.ndarray:
    """Displacement of every node at the end minus that at the start [m]."""
    ends = found.cycle_ends["displacement_m"]
    return ends[-1] - ends[0]


def friction_N(truss: ResolvedTruss) -> np.ndarray:
    return truss.sliders.friction_coefficient * truss.sliders.normal_force_N


def sticking(document: dict[str, Any], kind: str) -> dict[str, Any]:
    return document | {"reduced": {"sticking": kind}}


@pytest.mark.parametrize("kind", ["rigid", "elastic"])
@pytest.mark.parametrize("n", [1, 10, 100, 1000])
def test_chain_jumps_as_the_closed_form(n: int, kind: str) -> None:
    """Link i carries the friction of every block beyond it: jump = sum of l_i/(E A)_i sum_{j>=i} f_j. All blocks slide
    at the end of the cycle, so their sticking has no influence."""
    found = path(sticking(generate.chain(n, cycles=2), kind), locate_events=False, increments_per_branch=1)
    truss = found.truss
    flexibility = truss.links.stress_free_length_m / (
        truss.links.young_modulus_Pa * truss.links.cross_section_area_m2
    )
    exact = np.cumsum(flexibility * np.cumsum(friction_N(truss)[::-1])[::-1])
    for cycle in (1, 2):
        moved = found.cycle_ends["displacement_m"][cycle, 1:, 0]
        assert moved == pytest.approx(exact, rel=CLOSED_FORM, abs=0)


def iwan_platform_m(truss: ResolvedTruss, changes_K: np.ndarray) -> np.ndarray:
    """Displacement of the platform of the Iwan stack [m]. Each block is a stop operator of it; the sum of their forces
    balances the heated drive. The equation is piecewise linear, solved between its corners."""
    links = truss.links
    rigidity = links.young_modulus_Pa * links.cross_section_area_m2
    length, expansion = links.stress_free_length_m[0], links.thermal_expansion_per_K[0]
    stiffness = rigidity[1:] / links.stress_free_length_m[1:]
    limit = friction_N(truss)
    at, force, found = 0.0, np.zeros(len(limit)), []
    for change in changes_K:
        drive = rigidity[0] / (length * (1 + expansion * change))

        def out_of_balance(x: float) -> float:
            blocks = np.clip(force + stiffness * (x - at), -limit, limit)
            return float(drive * (length * expansion * change - x) - blocks.sum())

        corners = np.sort(np.concatenate([at + (limit - force) / stiffness, at - (limit + force) / stiffness]))
        values = np.array([out_of_balance(corner) for corner in corners])
        after = int(np.searchsorted(-values, 0))
        if after == 0:
            moved = corners[0] + values[0] / drive
        elif after == len(corners):
            moved = corners[-1] + values[-1] / drive
        else:
            left, right = values[after - 1], values[after]
            moved = corners[after - 1] + (corners[after] - corners[after - 1]) * left / (left - right)
        force = np.clip(force + stiffness * (moved - at), -limit, limit)
        at = float(moved)
        found.append(at)
    return np.array(found)


@pytest.mark.parametrize("n", [1, 10, 100, 1000])
def test_iwan_stack_follows_its_operator_for_ten_cycles_without_drift(n: int) -> None:
    found = path(generate.iwan(n, cycles=10), locate_events=False, increments_per_branch=3)
    platform = found.states["displacement_m"][:, 1, 0]
    exact = iwan_platform_m(found.truss, found.states["temperature_change_K"][1:])
    assert platform[1:] == pytest.approx(exact, rel=0, abs=CLOSED_FORM * np.abs(exact).max())
    ends = found.cycle_ends["displacement_m"][1:, 1, 0]
    assert np.ptp(ends) <= CLOSED_FORM * abs(ends[0])


def one_bar(case_file: str) -> dict[str, Any]:
    """The spring-slider case as a truss of one link and one slider."""
    case = load_case(ROOT / "cases" / case_file)
    document = generate.chain(1, friction_force_N=case.friction_force_N, shape="half_sine",
                              cycles=case.thermal.cycles)
    document["slider"][0].update(
        clearance_minus_m=case.joint.clearance_minus_m, clearance_plus_m=case.joint.clearance_plus_m,
    )
    return document


def test_one_bar_with_stops_is_the_paper_s_table_1() -> None:
    exact = reduced.solve(load_case(ROOT / "cases" / "table1.toml"))
    found = path(one_bar("table1.toml"))
    assert jump_m(found)[1, 0] == pytest.approx(exact.state_jump_m, rel=1e-12)
    located = [(event.temperature_change_K, event.after) for event in found.events]
    # Located within 1e-9 of a branch, whose rate is at most pi times 100 K per branch.
    slip, stop, stick_or_left = located[0], located[1], located[-1]
    assert slip == (pytest.approx(2.035099, abs=2e-6), "slip_plus")
    assert stop == (pytest.approx(87.509255, abs=2e-6), "stop_plus")
    assert stick_or_left == (pytest.approx(83.431111, abs=2e-6), "slip_minus")


def theta_rad(found: solve.TrussPath, at: int) -> np.ndarray:
    position = found.truss.nodes.position_m + found.states["displacement_m"][at]
    bearing, journal = position[2] - position[0], position[3] - position[1]
    return np.array([np.arctan2(bearing[1], bearing[0]), np.arctan2(journal[1], journal[0])])


def test_umbrella_rib_is_the_elastic_loop() -> None:
    """Two solvers without common code: Newton's method for a general truss, and the rib's own closed equations."""
    case = load_case(ROOT / "cases" / "umbrella_bias.toml")
    loop = _engine.elastic_loop(umbrella.linkage(case), case.thermal_program(), samples=2000)
    found = path(generate.umbrella(1), increments_per_branch=100)
    jump = theta_rad(found, -1) - theta_rad(found, 0)
    # The rolling of a step is of third order on both sides; 100 steps a branch leave 1e-8.
    assert jump == pytest.approx([loop.theta2_jump_rad, loop.theta4_jump_rad], rel=1e-8)


def test_ribs_without_coupling_are_one_rib_each() -> None:
    single = jump_m(path(generate.umbrella(1), locate_events=False))
    many = path(generate.umbrella(8), locate_events=False)
    length = np.linalg.norm(jump_m(many), axis=1)
    expected = np.linalg.norm(single, axis=1)
    for name, moved in zip(many.truss.nodes.names, length):
        of_one = expected["ACBJ".index(name[0])]
        # The planes of the ribs are rounded to 1e-15 of a length of 0.1 m.
        assert moved == pytest.approx(of_one, rel=1e-9, abs=1e-14)
    assert many.states["revolute_dissipation_J"][-1].sum() == pytest.approx(
        8 * path(generate.umbrella(1), locate_events=False).states["revolute_dissipation_J"][-1].sum(), rel=1e-9
    )


@pytest.mark.parametrize("document", [
    generate.ring(12, contact="rigid"), generate.mast(4, contact="rigid"), generate.umbrella(4, cable_preload_N=1.0,
                                                                                          contact="rigid"),
], ids=["ring", "mast", "umbrella"])
def test_increment_does_not_matter(document: dict[str, Any]) -> None:
    """Rigid contacts are holonomic while they roll or slip. Only the located events depend on increments: 1e-9 of a
    branch."""
    few, many = (jump_m(path(document, locate_events=False, increments_per_branch=k)) for k in (4, 64))
    assert few == pytest.approx(many, rel=0, abs=1e-6 * np.abs(many).max())


def test_blocks_that_come_to_rest_smoothly_do_not_stall_the_path() -> None:
    """With elastic contacts, blocks in the middle of a chain stop sliding gradually. About 200 events take 20 linear
    solves each."""
    found = path(sticking(generate.chain(20), "elastic"))
    assert found.complete and found.solves < 20 * 20 * len(found.events)
    assert jump_m(found)[-1, 0] == pytest.approx(jump_m(path(generate.chain(20)))[-1, 0], rel=CLOSED_FORM)


def test_joints_that_slip_one_after_another_within_an_increment_cost_no_further_steps() -> None:
    """Without event detection an increment takes a step or two, however many joints change status. The start and two
    branches, each with a short first step and ten increments, take 23 solves; 900 separate changes would take hundreds.
    """
    document = generate.umbrella(300, cable_preload_N=1.0)
    scatter = np.random.default_rng(1)
    for joint in document["revolute"]:
        joint["friction_coefficient"] = 0.1 + 0.1 * float(scatter.random())
    found = path(document, locate_events=False, increments_per_branch=10)
    assert found.solves <= 2 * 23
    assert len(found.events) > 2 * 300


@pytest.mark.parametrize("bays", [20, 40])
def test_tall_masts_pass_with_every_event_located(bays: int) -> None:
    """Both joints of a level near the top slide at once. Rounding can make one look sticking. Its next step would then
    start beyond the friction limit, and its status would alternate."""
    located, quick = (path(generate.mast(bays), locate_events=locate) for locate in (True, False))
    assert located.complete
    # Events of the quick path happen somewhere in increments of 1/50 of a branch.
    assert jump_m(located)[-1] == pytest.approx(jump_m(quick)[-1], rel=0, abs=1e-6 * np.abs(jump_m(quick)).max())
    # A joint slides when it heats, comes to rest when that ends and slides when it cools. Slides over the short step
    # that has an event in it are lost in how far rounding moves so slender a truss: rates tell who slides on.
    assert max(Counter(event.name for event in located.events).values()) == 3


def test_every_state_keeps_to_coulomb_and_the_play() -> None:
    found = path(generate.ring(12), locate_events=False)
    states, joints = found.states, found.truss.revolutes
    bound = joints.friction_coefficient * states["normal_force_N"]
    # Forces balance to 1e-12 of the largest one, about 1 kN here.
    assert np.all(np.abs(states["friction_force_N"]) <= bound + 1e-8)
    assert np.all(states["normal_force_N"] >= 0)
    depth = np.linalg.norm(states["eccentricity_m"], axis=2) - joints.radial_clearance_m
    hertz = (states["normal_force_N"] / REVOLUTE.hertz_stiffness(found.truss.revolutes)) ** (2 / 3)
    assert depth == pytest.approx(hertz, rel=0, abs=1e-14)
    assert found.largest_force_residual < 1e-11


@pytest.mark.parametrize("case", [
    "chain_10", "chain_cable", "iwan_10", "latch_boom", "latch_lever", "ring_12", "telescope", "umbrella_8", "umbrella_rib",
])
def test_energies_of_shipped_cases_balance_at_every_state(case: str) -> None:
    found = solve.solve(load_case(ROOT / "cases" / "trusses" / f"{case}.toml"))
    states = found.states
    stored = states["elastic_energy_J"] + states["load_potential_J"]
    residue = states["thermal_work_J"] - (stored - stored[0]) - solve.heat_of_joints_J(states).sum(axis=1)
    assert np.abs(residue).max() < 1e-10 * np.abs(states["thermal_work_J"]).max()


def test_what_rolls_is_of_fourth_order_in_the_increment() -> None:
    """Each step corrects the integration error of the step before it. Twice the increments leave a sixteenth of the
    error. The reference has eight times the increments of the finest path, so its error is 1/4096 of that path's. No
    step is halved for the energies."""
    ring = load_case(ROOT / "cases" / "trusses" / "ring_12.toml").resolve()
    ends = {k: solve.path(ring, increments_per_branch=k, energy_tolerance=1).states["displacement_m"][-1]
            for k in (20, 40, 320)}
    coarse, fine = (np.abs(ends[k] - ends[320]).max() for k in (20, 40))
    assert coarse > 1e4 * 1e-16 * np.abs(ends[320]).max()  # else rounding tells nothing
    assert fine < coarse / 10


def test_path_repeats_bit_for_bit_whatever_the_threads(monkeypatch: pytest.MonkeyPatch) -> None:
    histories = []
    for threads in ("1", "2"):
        monkeypatch.setenv("OMP_NUM_THREADS", threads)
        monkeypatch.setenv("OPENBLAS_NUM_THREADS", threads)
        histories.append(path(generate.ring(12), locate_events=False).states["displacement_m"].tobytes())
    assert histories[0] == histories[1]


def test_slack_cable_does_not_push() -> None:
    document = generate.umbrella(2)
    document["spring"] = [{"name": "tie", "nodes": ["B1", "B2"], "stiffness_N_per_m": 1e4,
                           "free_length_m": 0.2, "cable": True}]
    assert np.all(path(document, locate_events=False).states["tension_N"] == 0)


def refused(document: dict[str, Any]) -> StatejumpError:
    with pytest.raises(StatejumpError) as caught:
        path(document)
    return caught.value


def test_mechanism_names_its_free_modes() -> None:
    document = generate.mast(2)
    del document["torsion_spring"]
    assert refused(document) == failure("held_mechanism", modes=4)
    assert refused(document).numbers["modes"] == 4 and refused(document).nodes


def column(load_N: float, temperature_change_K: float = 0.0) -> dict[str, Any]:
    """Two collinear bars, 1 m each, whose middle node a transverse spring of 1000 N/m holds: they buckle at N = k L / 2
    = 500 N. A load compresses the bars, or they are heated between fixed ends."""
    made = document("column", "", "closed form", 2, temperature_change_K or 1.0, "triangle", 1, 1.0)
    heated = bool(temperature_change_K)
    load = {} if heated else {"force_N": [-load_N, 0.0]}
    made["node"] += [
        node("A", (0, 0), "xy"), node("B", (1, 0)), node("C", (2, 0), "xy" if heated else "y", **load),
        node("D", (1, -1), "xy"),
    ]
    bar = {"young_modulus_Pa": 70e9, "cross_section_area_m2": 1e-4, "density_kg_per_m3": 2700.0,
           "thermal_expansion_per_K": 1e-5 if heated else 0.0}
    made["link"] += [{"name": name, "nodes": list(name), **bar} for name in ("AB", "BC")]
    made["spring"].append({"name": "DB", "nodes": ["D", "B"], "stiffness_N_per_m": 1000.0, "preload_N": 0.0})
    return finished(made)


# The bars are shorter by N / E A = 7e-5 when they buckle, and turn the more easily.
NEAR_BUCKLING = 1e-3


def test_column_under_a_load_buckles_at_the_closed_form() -> None:
    path(column(500 * (1 - NEAR_BUCKLING)))
    assert refused(column(500 * (1 + NEAR_BUCKLING))) == failure("buckled", temperature_change_K=0.0, nodes=["B"], modes=1)


def test_heated_column_buckles_at_its_temperature() -> None:
    """The force between fixed ends is N = E A alpha dT / (1 + alpha dT)."""
    critical_K = 500 / (7e6 - 500) / 1e-5
    path(column(0.0, critical_K * (1 - NEAR_BUCKLING)))
    highest_K = critical_K * (1 + NEAR_BUCKLING)
    assert refused(column(0.0, highest_K)) == failure("buckled", temperature_change_K=highest_K)


def test_slender_ring_buckles_when_its_spokes_are_too_soft() -> None:
    """A ring on an elastic bed of stiffness k per bay buckles at 2 sqrt(k / bay E I). The generator's spokes make this
    four times the hoop force H, so a sixteenth of k removes the margin. Shear of the bays, H over 1.2 MN of a diagonal,
    lowers the buckling force by 2 % of H, or 4 % of k."""
    bays, hoop_force_N = 1000, 25e3  # high, so that buckling and not the strain of the spokes chooses k

    def ring(softer: float) -> dict[str, Any]:
        made = generate.ring(bays, hoop_force_N=hoop_force_N, temperature_change_K=1.0)
        length = 0.25 / np.sin(np.pi / bays) - 0.25
        for link in made["link"]:
            if link["name"].startswith("spoke"):
                strain = length / link["stress_free_length_m"] - 1
                link["cross_section_area_m2"] /= softer
                link["stress_free_length_m"] = length / (1 + strain * softer)
        return made

    path(ring(16 * 0.92), increments_per_branch=1, locate_events=False)
    assert refused(ring(16 * 1.02)) == failure("buckled", temperature_change_K=0.0)


@pytest.mark.parametrize("bays", [3, 5, 12, 50])
@pytest.mark.parametrize("change_K", [0.1, 100.0])
def test_generated_rings_start_in_contact_at_the_drawn_shape(bays: int, change_K: float) -> None:
    """Link lengths are chosen so that the loaded ring with closed clearances has the reference configuration: every
    joint carries half of the hoop force. The Hertz depth, below 6 um up to 4 kN, reduces the force by at most E A depth
    / bay, 84 N."""
    found = path(generate.ring(bays, temperature_change_K=change_K), increments_per_branch=1, locate_events=False)
    outer = 0.25 / np.sin(np.pi / bays)
    hoop_force_N = max(1000.0, 7e6 * 23.4e-6 * change_K * min(0.25, outer / 2) / outer)
    assert found.states["normal_force_N"][0] == pytest.approx(hoop_force_N / 2, abs=84)
    start = found.cycle_ends["displacement_m"][0]
    inner = [name.startswith("I") for name in found.truss.nodes.names]
    assert np.linalg.norm(start[inner], axis=1).max() < bays * 6e-6 / (2 * np.pi)


def slack_notes(found: solve.TrussPath) -> list[tuple[float, list[tuple[str, str]]]]:
    """Temperature changes [K] and joints of the notes on slack elements."""
    return [(note["temperature_change_K"], note["joints"]) for note in found.notes if note["kind"] == "slack"]


@pytest.mark.parametrize("has_spring", [True, False])
def test_joint_that_nothing_holds_at_the_start_is_slack(has_spring: bool) -> None:
    """The flare spring couples both links but does not hold them against the ground; without it each link can rotate.
    No forces act, so every link has its free length, and expansion moves the joint centres apart along the line of the
    pins."""
    made = generate.umbrella(1, bias_rad=0.0, temperature_change_K=10.0)
    if not has_spring:
        del made["torsion_spring"]
    found = path(made)
    assert slack_notes(found) == [(0.0, [("revolute", "joint")])]
    assert np.abs(found.states["axial_force_N"]).max() < 1e-6 and np.all(opened(found))
    assert jump_m(found).max() < 1e-9


def opened(found: solve.TrussPath) -> np.ndarray:
    """At which states the joint is open."""
    return found.states["revolute_status"][:, 0] == OPEN


@pytest.mark.parametrize("contact", ["rigid", "hertz"])
def test_rib_held_by_springs_starts_open_in_the_middle(contact: str) -> None:
    """Both springs are stress-free in the reference configuration. The links grow without rotation; journal and bearing
    part along the frame by eps AC, the play grows by eps c: they touch when eps (AC - c) = c."""
    made = generate.umbrella(1, bias_rad=0.0, contact=contact)
    made["torsion_spring"].append({"name": "ground", "links": ["AB"], "stiffness_N_m_per_rad": 2.0})
    frame, clearance, expansion = 0.12, 1e-4, 23.75e-6
    made["revolute"][0].update(journal_thermal_expansion_per_K=expansion, bearing_thermal_expansion_per_K=expansion)
    found = path(made)
    states, first = found.states, found.events[0]
    growth = clearance / (frame - clearance)
    assert first.before == "open" and found.events[-1].after == "open"
    # Located within 1e-9 of a branch of 100 K.
    assert first.temperature_change_K == pytest.approx(growth / expansion, abs=2e-7)
    apart = states["eccentricity_m"][:, 0]
    before = opened(found) & (states["time_s"] < first.time_s)
    exact = expansion * states["temperature_change_K"][before, None] * [frame, 0.0, 0.0]
    assert np.count_nonzero(before) > 10
    assert np.abs(apart[before]) == pytest.approx(exact, rel=0, abs=CLOSED_FORM * clearance)
    # Both bars are drawn without stress: k = E A/l times the square of what rounding makes of a length.
    assert not states["normal_force_N"][before].any() and states["elastic_energy_J"][0] < 1e7 * (1e-16 * frame) ** 2
    after = ~opened(found)
    assert np.all(states["normal_force_N"][after] >= 0) and states["normal_force_N"].max() > 0.1
    assert jump_m(found)[-1] == pytest.approx(0, abs=1e-12)


def two_bars(share_of_clearance: float) -> dict[str, Any]:
    """Two bars at 90 degrees, pulled along their bisector; the journal at their end has 100 um of clearance in a fixed
    bearing. The load leaves the journal at a given fraction of the clearance."""
    made = document("two_bars", "", "closed form", 2, 100.0, "triangle", 1, 1.0)
    made["node"] += [node("A", (-0.5, 0), "xy"), node("B", (0.5, 0), "xy"), node("O", (0, -0.5), "xy"),
                     node("J", (0, -0.5), force_N=[0.0, -load_N(share_of_clearance * CLEARANCE_M)])]
    made["link"] += [{"name": name + "J", "nodes": [name, "J"], "young_modulus_Pa": 70e9,
                      "cross_section_area_m2": AREA_M2, "thermal_expansion_per_K": EXPANSION,
                      "density_kg_per_m3": 2700.0} for name in "AB"]
    made["revolute"].append({"name": "play", "bearing_node": "O", "journal_node": "J", "journal_link": "AJ",
                             "journal_radius_m": 0.01, "radial_clearance_m": CLEARANCE_M,
                             "friction_coefficient": 0.2})
    return finished(made)


CLEARANCE_M, AREA_M2, EXPANSION = 1e-4, 1e-5, 2e-5
OPEN = 5  # of the engine's statuses


def load_N(sag_m: float, change_K: float = 0.0) -> float:
    """Load that displaces the common end of both bars by this distance below its reference position [N]."""
    drawn, now, height = np.hypot(0.5, 0.5), np.hypot(0.5, 0.5 + sag_m), 0.5 + sag_m
    free = drawn * (1 + EXPANSION * change_K)
    return float(2 * 70e9 * AREA_M2 * (now / free - 1) * height / now)


@pytest.mark.parametrize("share", [0.79, 0.2])
def test_journal_that_bars_hold_in_its_play_starts_open(share: float) -> None:
    found = path(two_bars(share))
    states = found.states
    assert states["revolute_status"][0] == OPEN and states["normal_force_N"][0] == 0
    # Forces balance to 1e-12, on bars of 0.7 m strained by 1e-4.
    assert states["eccentricity_m"][0, 0] == pytest.approx([0, -share * CLEARANCE_M, 0], rel=0, abs=1e-8 * CLEARANCE_M)
    # Hot bars are longer: it touches where their pull at a sag of c is the load.
    touches = found.events[0]
    assert (touches.before, touches.after) == ("open", "stick")
    load = load_N(share * CLEARANCE_M)
    assert load_N(CLEARANCE_M, touches.temperature_change_K) == pytest.approx(load, rel=1e-6)
    assert found.events[-1].after == "open" and jump_m(found)[-1] == pytest.approx(0, abs=1e-12)


def test_load_that_brings_the_journal_to_its_bearing_starts_in_contact() -> None:
    found = path(two_bars(1.1))
    start = {key: values[0] for key, values in found.states.items()}
    depth = np.linalg.norm(start["eccentricity_m"][0]) - CLEARANCE_M
    assert start["normal_force_N"] == pytest.approx(load_N(1.1 * CLEARANCE_M) - load_N(CLEARANCE_M + depth), rel=1e-9)
    assert depth > 0 and start["revolute_status"][0] != OPEN


@pytest.mark.parametrize("bias_rad, change_K, lost_K", [(0.01, -200.0, -108.08375), (-0.02, 400.0, 255.649887)])
@pytest.mark.parametrize("increments", [20, 50, 200])
def test_joint_that_loses_its_contact_is_slack_from_its_temperature_on(
        bias_rad: float, change_K: float, lost_K: float, increments: int) -> None:
    """The links close or open the flare angle beyond the free angle of the spring, so that nothing holds the journal.
    """
    found = path(generate.umbrella(1, temperature_change_K=change_K, bias_rad=bias_rad),
                 increments_per_branch=increments)
    (lost, joints), = slack_notes(found)
    # A contact is slack below 1e-8 of the links' stiffness times the clearance, 1e-5 N; the spring's force falls by 0.1 N/K.
    assert lost == pytest.approx(lost_K, abs=2e-4) and joints == [("revolute", "joint")]
    assert found.complete and np.linalg.norm(found.states["eccentricity_m"][:, 0], axis=1).max() < 1.01 * 1e-4


def test_path_ends_when_progress_says_so() -> None:
    found = path(generate.ring(6), progress=lambda share: share < 0.3)
    assert not found.complete and 1 < len(found.states["time_s"])


def wandering_mast() -> dict[str, Any]:
    """A mast with 45 latches, all of which would slip in the first step. The temperatures of its links are random."""
    spec = importlib.util.spec_from_file_location("histories", ROOT / "studies" / "bench" / "histories.py")
    assert spec is not None and spec.loader is not None
    histories = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(histories)
    mast: dict[str, Any] = histories.mast(1600)
    warm = np.random.default_rng(1)
    for link in mast["link"]:
        link["temperature_fraction"] = float(warm.uniform(-1, 1))
    for slider in mast["slider"]:
        slider["normal_force_N"] = 5.0
    mast["thermal"] = {"shape": "triangle", "temperature_change_max_K": 40.0}
    return mast


@pytest.mark.parametrize("blocks", [0, 3000])
def test_many_joints_that_wander_are_settled_on_few_factorizations(blocks: int) -> None:
    """On this mast, status changes of many latches at once cycle; single changes take a factorization each (37 per
    solve). When changes cycle, the step is halved. Blocks on separate bars, which slip at once and permanently, do not
    affect this (43 per solve when every joint that had ever changed counted as cycling)."""
    mast = wandering_mast()
    for i in range(blocks):
        place = [0.0, -10.0 - i, 0.0]
        mast["node"] += [{"name": f"G{i}", "position_m": place, "fixed": ["x", "y", "z"]},
                         {"name": f"B{i}", "position_m": [1.0, *place[1:]], "fixed": ["y", "z"]}]
        mast["link"].append({**mast["link"][0], "name": f"bar{i}", "nodes": [f"G{i}", f"B{i}"],
                             "temperature_fraction": 0.5 + 0.5 * i / blocks})
        mast["slider"].append({"name": f"block{i}", "nodes": [f"B{i}"], "axis": [1.0, 0.0, 0.0],
                               "normal_force_N": 5.0, "friction_coefficient": 0.2})
    found = path(mast, increments_per_branch=1, locate_events=False, cycle_ends_only=True,
                 progress=lambda share: share < 0.45)
    assert len(found.events) > 10 + blocks and found.factorizations < 10 * found.solves


def test_pivots_that_lead_on_are_left_alone() -> None:
    """A chain of elastic blocks has as many useless active-set changes as a mast whose changes cycle, but each brings
    the solution nearer (288 factorizations)."""
    chain = path(sticking(generate.chain(200, cycles=2), "elastic"), increments_per_branch=1, locate_events=False)
    assert chain.factorizations < 400


def test_quiet_increments_keep_the_factors() -> None:
    """No joint of this ring changes its status along the path. Steps reuse existing factorizations across increments
    (86 factorizations were needed when each Newton step made one)."""
    found = path(generate.ring(100), increments_per_branch=10, locate_events=False)
    assert len(found.events) == 0 and found.factorizations < found.solves


def spoiled(case: str, section: str, item: int, key: str, value: float) -> dict[str, Any]:
    """Return a shipped truss with one value of one item changed."""
    given: dict[str, Any] = tomllib.loads((ROOT / "cases" / "trusses" / f"{case}.toml").read_text())
    given[section][item][key] = value
    return given


def test_soft_bar_does_not_hold_up_a_path() -> None:
    """The status change of the soft bar is predicted at the end of any attempted step."""
    told = itertools.count()
    found = path(spoiled("chain_cable", "link", 1, "cross_section_area_m2", 9e-18),
                 progress=lambda share: next(told) < 100_000)
    assert found.complete


def test_no_step_is_divided_without_end() -> None:
    """Newton's method converges only for states so close together that a branch would take millions of steps with one
    set of statuses. Steps that make several changes together succeed."""
    counted = itertools.count()
    found = path(spoiled("ball_tripod", "ball_joint", 0, "friction_coefficient", 1e-320),
                 progress=lambda share: next(counted) < 100_000)
    assert found.complete
