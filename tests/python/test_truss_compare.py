# SPDX-License-Identifier: GPL-3.0-or-later
"""Trusses in the DEM, compared with the quasi-static solver by the command."""
from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from failures import Failure, failing, failure
import statejump as sj
from statejump.core.errors import StatejumpError
from statejump.core.yade_process import execute
from statejump.kinds.loading import parse_case
from statejump.kinds.truss import KIND, dem, generate, masses
from statejump.results.read import read
from statejump.kinds.truss.generate.document import write
from statejump.kinds.truss.solve import solve
from statejump.kinds.truss.why_missed import why_missed

K = 70e9 * 9e-6 / 0.5  # stiffness of a bar of Table 1 [N/m]


def case_file(folder: Path, made: dict[str, Any]) -> Path:
    path = folder / f"{made['case']['name']}.toml"
    write(made, path, [])
    return path


def quantities(folder: Path) -> dict[str, dict]:
    return {entry["name"]: entry for entry in json.loads((folder / "comparison.json").read_text())["quantities"]}


def test_chain_jumps_as_the_closed_form_and_does_not_drift(statejump, tmp_path: Path) -> None:
    n, friction = 3, 100.0
    made = generate.chain(n, friction_force_N=friction, cycles=3, period_s=0.1)
    outcome = statejump("compare", case_file(tmp_path, made))
    assert outcome.status == 0, outcome.output + outcome.errors
    found = quantities(tmp_path / "results" / "chain_3")
    # While all slide back, bar i carries the friction of the blocks behind it.
    jump = friction / K * n * (n + 1) / 2
    # Blocks slide at the end: k_t does not matter. Inertia: m v^2 of the tip, 1e-5 J, against f x = 0.05 J.
    assert found["jump_of_node_N3"]["dem"] == pytest.approx(jump, rel=1e-3)
    assert found["jump_of_node_N3"]["reduced"] == pytest.approx(jump, rel=1e-9)
    # Preslip f/k_t, 3.5 um of 3.3 mm.
    assert found["displacement_largest_rms_over_largest"]["dem"] < 4e-3
    assert found["loop_drift_over_largest_displacement"]["dem"] < 1e-4
    assert abs(found["energy_residual_over_friction_work"]["dem"]) < 1e-6
    assert "N3" in outcome.output and "energy residue" in outcome.output
    assert (tmp_path / "results" / "chain_3" / "chain_3.svg").exists()

    file = tmp_path / "results" / "chain_3" / "comparison.h5"
    result = read(file)
    assert result.passed and set(result.models) == {"reduced", "dem"}
    for run in result.models.values():
        assert run.history["displacement_m"].values.shape == (601, 4, 3)
        assert run.contacts["state"].values.shape == (601, 3)
        # Both say friction with one sign: it holds back the blocks that move out.
        assert np.all(run.contacts["tangential_force_N"].values[90, :, 0] < -0.99 * friction)
    # Two files of the case against each other.
    reduced = statejump("reduced", tmp_path / "chain_3.toml")
    assert reduced.status == 0, reduced.errors
    again = statejump("compare", file, tmp_path / "results" / "chain_3" / "reduced.h5")
    assert again.status == 0 and "jump_of_node_N3" in again.output, again.output + again.errors
    assert statejump("export", file, "--to", tmp_path / "out", "--frames", "3").status == 0
    info = statejump("info", file)
    assert info.status == 0 and "truss" in info.output


def test_cable_goes_taut_and_slack_as_on_the_path(statejump, tmp_path: Path) -> None:
    """The cable is slack at the ends of the cycle and taut in between. It restrains the hot chain but does not change
    the jump."""
    n, friction, stiffness, free_m = 3, 100.0, 2e5, 1.501
    made = generate.chain(n, friction_force_N=friction, period_s=0.5)
    made["spring"] = [{"name": "tie", "nodes": ["N0", "N3"], "stiffness_N_per_m": stiffness, "free_length_m": free_m,
                       "cable": True}]
    outcome = statejump("compare", case_file(tmp_path, made))
    assert outcome.status == 0, outcome.output + outcome.errors
    found, result = quantities(tmp_path / "results" / "chain_3"), read(tmp_path / "results" / "chain_3" / "comparison.h5")
    jump = friction / K * n * (n + 1) / 2
    assert found["jump_of_node_N3"]["dem"] == pytest.approx(jump, rel=1e-3)
    assert abs(found["energy_residual_over_friction_work"]["dem"]) < 1e-6
    # Hot, three bars and the cable hold each other; friction of the blocks, f on the first to 3 f on all, holds back.
    growth, bars = 3 * 0.5 * 2.34e-5 * 100.0, K / n
    hot = (bars * (growth - friction / K * n * (n + 1) / 2) - stiffness * (1.5 - free_m)) / (bars + stiffness)
    samples = {}
    for model, run in result.models.items():
        tension = run.history["tension_N"].values[:, 0]
        assert tension.min() == 0 and tension[[0, -1]] == pytest.approx([0, 0], abs=0)
        # Presliding of f/k_t, microns of millimetres; heating makes bars softer by 2e-3.
        assert tension.max() == pytest.approx(stiffness * (hot + 1.5 - free_m), rel=5e-3)
        # Friction and cable do what they do at one length: taut at 1 mm on the way out, slack there on the way back.
        reach = run.history["position_m"].values[:, 3, 0]
        assert np.all((tension > 0) == (reach > free_m)) or model == "reduced"  # which is sampled between its states
        samples[model] = [(event.kind, event.time_s) for event in run.events if event.joint == "tie"]
    assert [kind for kind, _ in samples["dem"]] == ["taut", "slack"] == [kind for kind, _ in samples["reduced"]]
    for one, other in zip(samples["dem"], samples["reduced"]):
        assert one[1] == pytest.approx(other[1], abs=2 * 0.5 / 200)


def test_ring_with_joints_that_stick_elastically_jumps_as_in_the_dem(statejump, tmp_path: Path) -> None:
    """Solver and DEM agree. With rigid sticking instead, the solver's jump would differ by a fifth of the jump, because
    elastic slips are about f/k_t, some micrometres.
    """
    made = generate.ring(6, sticking="elastic")
    outcome = statejump("compare", case_file(tmp_path, made))
    assert outcome.status == 0, outcome.output + outcome.errors
    file = tmp_path / "results" / "ring_6" / "comparison.h5"
    apart = quantities(tmp_path / "results" / "ring_6")["jump_largest_difference_over_largest_jump_or_loop"]
    # What is left falls with the period: 0.0046 in 1 s, 0.0023 in 2 s.
    assert apart["dem"] < 0.01
    rigid = parse_case(generate.ring(6))
    ends = solve(rigid).cycle_ends["displacement_m"]
    history = read(file).models["dem"].history["displacement_m"].values
    missed = np.linalg.norm(ends[-1] - ends[0] - history[-1] + history[0], axis=1).max()
    assert missed > 1e-6  # so the check above is one of the sticking


def test_rib_in_space_is_the_rib_in_the_plane() -> None:
    """One of three uncoupled ribs in inclined planes has the masses, time step and loaded start of the planar rib."""
    planar = parse_case(generate.umbrella(1))
    spatial = parse_case(generate.umbrella(3))
    paths = [solve(case) for case in (planar, spatial)]
    values = [dem.resolved(case, path) for case, path in zip((planar, spatial), paths)]
    # The two links of a rib: a third of each at its tip.
    assert values[0]["node"]["mass_kg"] == pytest.approx([0, 0, 0.5 / 3, 1 / 3])
    assert values[1]["node"]["mass_kg"] == pytest.approx([0, 0, 0.5 / 3, 1 / 3] * 3)
    assert values[0]["dem"]["number_of_steps"] == values[1]["dem"]["number_of_steps"]
    flat, space = (np.array(found["node"]["start_m"]) for found in values)
    for rib in range(3):
        for node in (2, 3):
            place = space[4 * rib + node]
            # The solver closes equilibrium to 1e-12 of the forces.
            assert place[0] == pytest.approx(flat[node][0], abs=1e-12)
            assert np.hypot(place[1], place[2]) == pytest.approx(flat[node][1], abs=1e-12)


def test_ribs_in_space_move_as_the_rib_in_the_plane(tmp_path: Path) -> None:
    """The period is short, so that vibration of the links is compared too."""
    runs = {}
    for n in (1, 3):
        made = generate.umbrella(n, period_s=0.3)
        made["output"] = {"samples_per_cycle": 100}
        for node in made["node"]:
            if "guide_normal" in node:  # a load that only the guide carries
                node["force_N"] = [5.0 * part for part in node["guide_normal"]]
        case = parse_case(made)
        path = solve(case)
        runs[n] = execute({"scene": KIND.scene_module(), **dem.dem_input(case)}, lambda share: None).columns
    # Friction on the journal has one sign in both models: the means agree but for the swing.
    ours = np.interp(runs[1]["time_s"], path.states["time_s"], path.states["friction_force_N"][:, 0])
    assert np.mean(runs[1]["friction_force_N[joint]"][20:50]) == pytest.approx(np.mean(ours[20:50]), rel=0.3)
    for rib in (1, 2, 3):
        angle = 2 * np.pi * (rib - 1) / 3
        for node in "BJ":
            x, y, z = (runs[3][f"displacement_m[{node}{rib}].{axis}"] for axis in "xyz")
            flat = [runs[1][f"displacement_m[{node}].{axis}"] for axis in "xy"]
            # Motion of 3e-4 m; friction forgives roundings of the start, 1e-15 m times 5e6 N/m.
            assert np.abs(x - flat[0]).max() < 1e-10
            assert np.abs(y * np.cos(angle) + z * np.sin(angle) - flat[1]).max() < 1e-10
            assert np.abs(z * np.cos(angle) - y * np.sin(angle)).max() < 1e-14
        slip = runs[3][f"revolute_state[joint{rib}]"]
        assert set(slip) == set(runs[1]["revolute_state[joint]"]) and len(set(slip)) > 1


def test_masses_of_a_bar_between_free_nodes() -> None:
    case = parse_case(generate.chain(2))
    bar = 2700 * 9e-6 * 0.5
    # A third at the tip of the bar that hangs on the ground, else halves.
    assert masses.lumped_mass_kg(case.resolve()) == pytest.approx([0, bar / 3 + bar / 2, bar / 2])


def test_tubes_that_slide_in_each_other_jump_as_the_closed_form(statejump, tmp_path: Path) -> None:
    case = Path(__file__).parents[2] / "cases" / "trusses" / "telescope.toml"
    outcome = statejump("compare", case)
    assert outcome.status == 0, outcome.output + outcome.errors
    found = quantities(tmp_path / "results" / "telescope")
    jump = found["jump_of_node_C"]
    assert jump["reduced"] == pytest.approx(100.0 * 1.2 / (70e9 * 1e-5), rel=1e-9)  # f l/(E A)
    # Both slide at the end: k_t does not matter.
    assert jump["dem"] == pytest.approx(jump["reduced"], rel=1e-5)
    assert abs(found["energy_residual_over_friction_work"]["dem"]) < 1e-6
    # The stop is rigid in the solver; in the DEM 345 N press the pad 9.66 um into it, of which C on the softer tube has
    # 1.2/2.2, of its 1.638 mm.
    peak = found["displacement_at_peak_largest_difference_over_largest"]["dem"]
    assert peak == pytest.approx(1.2 / 2.2 * 9.66e-6 / 1.638e-3, rel=0.01)
    run = read(tmp_path / "results" / "telescope" / "comparison.h5").models["dem"]
    assert set(np.unique(run.contacts["state"].values)) == {1, 2, 3}  # sticks, slips, rests at its stop


def test_joints_that_could_meet_are_kept_apart() -> None:
    case = parse_case(generate.iwan(100))
    values = dem.resolved(case, solve(case))["slider"]
    places = 0.5 + 0.5 * (1 + np.arange(100) / 100)
    groups, reach = np.array(values["group"]), np.array(values["reach_m"])
    for i in range(100):
        # On both sides YADE's boxes are larger by the collider's reserve, a tenth of the pad's radius.
        near = np.abs(places - places[i]) < reach + reach[i] + 2 * 0.1 * 0.05
        assert np.sum(groups[near] == groups[i]) == 1
    assert groups.max() < dem.CONTACT_GROUPS


def two_nodes(made: dict[str, Any]) -> None:
    made["slider"][1].update(nodes=["N2", "N1"], normal_force_N=0.0)


def two_nodes_with_partial_slip(made: dict[str, Any]) -> None:
    made["slider"][1]["nodes"] = ["N2", "N1"]
    made["dem"] = {"friction_law": "mindlin_deresiewicz"}


def no_mass(made: dict[str, Any]) -> None:
    made["node"].append({"name": "M", "position_m": [1.5, 0.0], "fixed": ["y"]})
    made["spring"] = [{"name": "k", "nodes": ["N2", "M"], "stiffness_N_per_m": 1e3}]


def no_length(made: dict[str, Any]) -> None:
    made["spring"] = [{"name": "k", "nodes": ["N0", "N2"], "stiffness_N_per_m": 1e3, "preload_N": 1e4}]


def two_parts(made: dict[str, Any]) -> None:
    made["revolute"] = [{
        "name": "R", "bearing_node": "N0", "journal_node": "N2", "journal_link": "L2", "journal_radius_m": 0.01,
        "radial_clearance_m": 1.5, "friction_coefficient": 0.1,
    }]


@pytest.mark.parametrize(("change", "sentence"), [
    (two_nodes, failure("dem_joint", joint="S2")),
    (two_nodes_with_partial_slip, failure("dem_joint", joint="S2")),
    (no_mass, failure("dem_node_without_mass", nodes=['M'])),
    (no_length, failure("dem_spring_free_length")),
    (two_parts, failure("dem_second_contact", joint="R", nodes=['N2'])),
])
def test_what_the_dem_cannot_represent_is_named(change, sentence: Failure) -> None:
    made = generate.chain(2)
    made.setdefault("spring", [])
    change(made)
    case = parse_case({key: value for key, value in made.items() if value != []})
    with pytest.raises(StatejumpError) as refusal:
        dem.check(case)
        dem.resolved(case, solve(case))
    assert refusal.value == sentence and "\n" not in str(refusal.value)


def test_a_truss_without_masses_is_at_rest_and_does_not_move(cases: Path) -> None:
    """Only dynamics needs masses: the quasi-static solver works without them, the DEM and truss dynamics refuse the
    case."""
    import statejump as sj
    from statejump.core.errors import MissingKey

    heavy = sj.load(cases / "trusses" / "chain_10.toml")
    data = heavy.to_dict()
    for link in data["link"]:
        link.pop("density_kg_per_m3", None), link.pop("mass_kg", None)
    light = sj.load(data)
    assert light.reduced().summary == heavy.reduced().summary
    name = heavy.link[0].name
    for moves in (light.dem, lambda: light.reduced(dynamic=True)):
        with failing("mass_of_moving_link_missing", item=f"link {name!r}", key="mass_kg", raised=MissingKey):
            moves()


def test_bar_jumps_by_partial_slip_as_in_the_dem() -> None:
    """The load is far below gross slip. The jump is 77.8 nm; with Coulomb's law and elastic sticking it would be zero.
    In the DEM the bar's inertia adds 0.1 % at a period of 0.5 s."""
    made = generate.chain(1, friction_force_N=300.0, temperature_change_K=8.0, period_s=0.5)
    made["reduced"] = {"sticking": "partial_slip"}
    jumps, reasons = {}, {}
    for law in ("mindlin", "mindlin_deresiewicz"):
        document = made | {"dem": {"friction_law": law}}
        case = sj.load(document)
        run = case.dem()
        moved = run["displacement_m"]
        jumps[law] = moved[-1, 1, 0] - moved[0, 1, 0]
        reasons[law] = " ".join(why_missed(parse_case(document), case.reduced(), run, 1e-6))
    ends = solve(parse_case(made)).cycle_ends["displacement_m"]
    assert ends[-1, 1, 0] - ends[0, 1, 0] == pytest.approx(77.83e-9, rel=1e-4)
    assert jumps["mindlin_deresiewicz"] == pytest.approx(77.83e-9, rel=3e-3)
    assert abs(jumps["mindlin"]) < 0.3e-9
    assert "dem.friction_law" in reasons["mindlin"] and "'mindlin_deresiewicz'" in reasons["mindlin"]
    assert "friction_law" not in reasons["mindlin_deresiewicz"]


def hot_joint(part: str, expansion_per_K: float) -> dict[str, Any]:
    """Return a case in which 10 N press a journal down into its bearing, and either journal or bearing expands."""
    return {
        "case": {"name": "hot_joint", "kind": "truss"},
        "truss": {"dimension": 2},
        "node": [{"name": "A", "position_m": [-0.5, 0.0], "fixed": ["x", "y"]},
                 {"name": "B", "position_m": [0.0, 0.0], "fixed": ["x", "y"]},
                 {"name": "J", "position_m": [0.0, 0.0], "force_N": [0.0, -10.0]}],
        "link": [{"name": "L", "nodes": ["A", "J"], "young_modulus_Pa": 70e9, "cross_section_area_m2": 9e-6,
                  "thermal_expansion_per_K": 0.0, "mass_kg": 0.1}],
        "revolute": [{"name": "R", "bearing_node": "B", "journal_node": "J", "journal_link": "L",
                      "journal_radius_m": 5e-3, "radial_clearance_m": 1e-4, "friction_coefficient": 0.0,
                      "young_modulus_Pa": 70e9, "poisson_ratio": 0.3, f"{part}_thermal_expansion_per_K": expansion_per_K}],
        "thermal": {"shape": "triangle", "temperature_change_max_K": 100.0, "period_s": 0.2},
        "reduced": {"sticking": "elastic"},
        "output": {"samples_per_cycle": 20},
    }


@pytest.mark.parametrize(("part", "radius_m", "sign"), [("bearing", 5.1e-3, -1.0), ("journal", 5e-3, 1.0)])
def test_journal_sinks_as_its_bearing_expands_in_every_model(part: str, radius_m: float, sign: float) -> None:
    """The clearance changes by α ΔT R of the expanding part, 25 µm. The new radius alters the contact depth by 0.05 µm;
    vibrations are smaller."""
    expansion_per_K = 5e-5
    case = sj.load(hot_joint(part, expansion_per_K))
    explicit = case.changed({"motion.scheme": "regularised", "motion.masses": "lumped", "motion.steps_per_cycle": 8000})
    runs = {"quasi-static": case.reduced(), "motion": case.reduced(dynamic=True),
            "penalty contact": explicit.reduced(dynamic=True), "DEM": case.dem()}
    for name, run in runs.items():
        height = run["displacement_m"][:, 2, 1]
        assert height[0] == pytest.approx(-1e-4, abs=1e-6), name
        assert height[10] - height[0] == pytest.approx(sign * expansion_per_K * 100.0 * radius_m, abs=1e-7), name
        assert height[-1] == pytest.approx(height[0], abs=5e-8), name
