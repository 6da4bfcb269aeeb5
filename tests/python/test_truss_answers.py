# SPDX-License-Identifier: GPL-3.0-or-later
"""``truss answers``: closed forms for the chain, verdicts, fits of a surface, and files of the command."""
from __future__ import annotations

import csv
import json
from dataclasses import replace
from pathlib import Path
from typing import Any, Callable

import numpy as np
import pytest

from conftest import Outcome
from failures import Failure, failing, failure, note
from test_truss_iwan import bolted

import statejump as sj
from statejump.core.errors import Interrupted, StatejumpError
from statejump.kinds.loading import parse_case
from statejump.kinds.truss import solve
from statejump.kinds.truss.answers import reflector
from statejump.kinds.truss.answers.contributions import contributions
from statejump.kinds.truss.answers.jumps import node_jumps, quick_path
from statejump.kinds.truss.answers.outputs import chosen_output
from statejump.kinds.truss.answers.sensitivity import sensitivities
from statejump.kinds.truss.answers.verdict import Verdict, judged, others, verdict
from statejump.kinds.truss.generate import GENERATORS
from statejump.kinds.truss.joints import JOINTS
from statejump.kinds.truss.resolved import ResolvedTruss
from statejump.kinds.truss.solve import TrussPath


def made(kind: str, n: int, **keys: Any) -> ResolvedTruss:
    return parse_case(GENERATORS[kind](n, name="t", **keys)).resolve()


@pytest.fixture(scope="module")
def chain() -> TrussPath:
    """Chain whose frictions and bars all differ."""
    truss = made("chain", 5)
    varied = 1 + 0.1 * np.arange(5)
    truss = truss.with_joints(
        slider=replace(truss.sliders, normal_force_N=truss.sliders.normal_force_N * varied[::-1]))
    return quick_path(replace(
        truss, links=replace(truss.links, cross_section_area_m2=truss.links.cross_section_area_m2 * varied)))


@pytest.fixture(scope="module")
def mast() -> TrussPath:
    return quick_path(made("mast", 2))


def test_contributions_of_the_chain(chain: TrussPath) -> None:
    links, sliders = chain.truss.links, chain.truss.sliders
    friction = sliders.friction_coefficient * sliders.normal_force_N
    compliance = links.stress_free_length_m / (links.young_modulus_Pa * links.cross_section_area_m2)
    # Slider j pushes on bars 1 to j: jump = Σ_i l_i/(EA)_i Σ_{j >= i} f_j, all joints slipping to the end.
    exact = friction * np.cumsum(compliance)
    output = chosen_output(chain, "node")
    assert output.name == "node:N5"
    found = contributions(chain, output)
    # The truss is linear: rounding of positions of 2.5 m over a jump of half a millimetre.
    assert found.contribution == pytest.approx(exact, rel=1e-9)
    assert found.jump == pytest.approx(exact.sum(), rel=1e-9)
    assert found.sum_error < 1e-9 and found.reproduced == pytest.approx(found.jump, rel=1e-9)
    assert [found.names[joint] for joint in found.order] == [f"S{j + 1}" for j in np.argsort(-exact)]


def test_sensitivities_of_the_chain(chain: TrussPath) -> None:
    output = chosen_output(chain, "node")
    jump = output.jump(chain)
    found = {row.parameter: row for row in sensitivities(chain, output)}
    assert {row.verdict for row in found.values()} == {"smooth"}
    # The jump is proportional to friction, and to 1/E: its central difference has an error of step².
    for name, exact, error in (("slider.*.friction_coefficient", 1.0, 1e-9), ("link.*.young_modulus_Pa", -1.0, 1.1e-4)):
        assert found[name].per_relative_change / jump == pytest.approx(exact, abs=error), name
    each = [row for row in sensitivities(chain, output, each=True) if row.parameter.endswith(".friction_coefficient")]
    shares = contributions(chain, output)
    assert [row.per_relative_change for row in each] == pytest.approx(shares.contribution, rel=1e-9)


def test_friction_forces_give_the_jump_back(mast: TrussPath) -> None:
    output = chosen_output(mast, "node")
    shares = contributions(mast, output)
    # An equilibrium is found to 1e-12 of its forces; the mast is some 1e4 times softer than its bars.
    assert shares.reproduced == pytest.approx(shares.jump, rel=1e-6)
    # Third order in the turning of links by 1e-3 and of contacts by 0.1.
    assert shares.sum_error < 0.01


@pytest.mark.parametrize("name", ["ball_tripod", "latch_boom", "latch_lever", "telescope", "bolted"])
def test_friction_of_every_type_of_joint_gives_the_jump_back(name: str) -> None:
    """A truss without friction, under the forces that replace it, reaches the end of the path: forces, moments, signs.
    """
    case = sj.load(bolted()) if name == "bolted" else sj.load(f"trusses/{name}")
    path = quick_path(case.definition.resolve())
    shares = contributions(path, chosen_output(path, "node"))
    assert shares.names == tuple(name for joint in JOINTS for name in path.truss.joints[joint.section].names)
    assert abs(shares.jump) > 1e-9
    # Equilibria are found to 1e-12 of their forces, displacements to the rounding of lengths of a metre.
    assert shares.reproduced == pytest.approx(shares.jump, rel=1e-8) and shares.sum_error < 1e-8


def test_not_differentiable_is_said() -> None:
    # Friction at which the joint of a rib just slips back: more, and it stays.
    case = GENERATORS["umbrella"](3, name="t")
    truss = parse_case(case).resolve()
    truss = truss.with_joints(revolute=replace(truss.revolutes, friction_coefficient=np.full(3, 0.1885)))
    path = quick_path(truss)
    words = {row.parameter: row.verdict for row in sensitivities(path, chosen_output(path, "node"), step=0.1)}
    assert words["revolute.*.friction_coefficient"] == "not differentiable"


def test_kink_whose_slopes_cancel_is_said() -> None:
    # One block with friction f, ε = α ΔT. Hot, the bar of l (1 + ε) is shorter by f of its stiffness. It slips
    # back if f is below EA ε/(2 + ε): jump f l/EA. With more it stays: jump ε l - (1 + ε) f l/EA.
    truss = made("chain", 1)
    links = truss.links
    strain = float(links.thermal_expansion_per_K[0]) * 100.0
    most = float((links.young_modulus_Pa * links.cross_section_area_m2)[0]) * strain / (2 + strain)
    truss = truss.with_joints(slider=replace(
        truss.sliders, normal_force_N=most / truss.sliders.friction_coefficient))
    path = quick_path(truss)
    found = {row.parameter: row for row in sensitivities(path, chosen_output(path, "node"))}
    row = found["slider.*.friction_coefficient"]
    jump = node_jumps(path)[-1, 1, 0]
    assert jump == pytest.approx(strain / (2 + strain) * links.stress_free_length_m[0], rel=1e-6)
    # The slopes are 1 and -(1 + ε): the exact derivative is one of them, the difference their mean.
    assert row.per_relative_change / jump == pytest.approx(1, rel=1e-6) or (
        row.per_relative_change / jump == pytest.approx(-(1 + strain), rel=1e-6))
    assert abs(row.half_step) < strain * jump
    assert row.verdict == "not differentiable"


def moved_by(path: TrussPath, each: list[float], node: int = 0) -> TrussPath:
    """A copy of the path in which only one node moves, by the given distances [m] along x over each cycle."""
    moved = np.zeros((len(each) + 1, len(path.truss.nodes.names), 3))
    moved[1:, node, 0] = np.cumsum(each)
    still = {key: np.zeros((len(each) + 1, 1)) for key in path.cycle_ends if key.endswith("_dissipation_J")}
    ends = {**path.cycle_ends, **still, "displacement_m": moved}
    return replace(path, cycle_ends=ends, states=ends)


def growing(path: TrussPath, each: list[float], error: Callable[[int], float]) -> tuple[Verdict, list[int]]:
    """Verdict on paths whose later cycles have an error that depends on the increments; the numbers of increments
    tried."""
    asked = []

    def solve(increments: int) -> TrussPath:
        asked.append(increments)
        return moved_by(path, [each[0], *(jump + error(increments) for jump in each[1:])])

    first = solve(50)
    return judged(first, 50, solve, chosen_output(first, "node"))[0], asked[1:]


def test_verdicts(mast: TrussPath) -> None:
    truss = made("mast", 2, cycles=3)
    path = quick_path(truss)
    found, _ = judged(path, 50, lambda more: quick_path(truss, more), chosen_output(path, "node"))
    assert found.word == "shakedown" and len(found.cycle_jump) == 3

    def of(each: list[float]) -> str:
        return growing(mast, each, lambda increments: 0.0)[0].word

    assert of([1e-3, 1e-4, 1.003e-4, 1e-4]) == "ratcheting"
    assert of([1e-3, 0, 0]) == "shakedown"
    assert of([1e-3, 5e-4, 2.5e-4]) == "not settled"
    assert of([0, 0]) == "no jump"
    assert of([1e-3]) == "one cycle"


def test_growth_is_told_only_if_it_survives_smaller_increments(mast: TrussPath) -> None:
    """Growth of 0.038 nm per cycle that vanishes with more increments is not reported; lasting growth of 0.02 nm is."""
    once = [1e-6, 0.0, 0.0]

    def falling(order: float) -> Callable[[int], float]:
        return lambda increments: 38e-12 * (50 / increments) ** order

    assert growing(mast, once, falling(2))[0].word == "shakedown"
    # 0.010 nm of them at 400 increments: an order of 0.64. Two paths do not tell, and more do not either.
    slow, asked = growing(mast, once, falling(0.64))
    assert slow.word == "not resolved" and asked == [100, 200, 400, 800]
    assert "increments_per_branch" in slow.text
    real, asked = growing(mast, [1e-6, 20e-12, 20e-12], falling(2))
    # At 100 the fault is 10 of 30 pm and the paths are 28 pm apart, at 200 it is 2 of 22 and 7.
    assert real.word == "ratcheting" and asked == [100, 200]
    assert float(real.text.split("grows by ")[1].split()[0]) == pytest.approx(22.4e-3, abs=1e-4)  # nm
    # A whole jump of the increments' making.
    assert growing(mast, [0.0, 0.0], falling(2))[0].word == "no jump"


def test_rolling_along_a_loop_is_of_fourth_order() -> None:
    """Under a sine program the joints return on another path and stick. The displacement over a cycle is then the error
    of the integration rule; twice the increments reduce it to a sixteenth."""
    truss = made("mast", 3, shape="sine", friction_coefficient=0.5, temperature_change_K=-100.0, cycles=3,
                 tip_load_N=10.0, shaded_fraction=0.0)
    increments = np.array([12, 25, 50])
    paths = [quick_path(truss, int(number)) for number in increments]
    left = np.array([np.linalg.norm(node_jumps(path)[-1] - node_jumps(path)[-2], axis=1).max() for path in paths])
    assert left[-1] > 1e-13  # far above what rounding leaves of lengths of a metre: with 100 some 5e-15
    assert left[:-1] / left[1:] == pytest.approx((increments[1:] / increments[:-1])**4, rel=0.2)
    found, _ = judged(paths[1], 25, lambda more: quick_path(truss, more), chosen_output(paths[1], "node"))
    assert found.word == "no jump" and found.increments == 50


def test_verdict_is_of_the_output_that_was_chosen(mast: TrussPath) -> None:
    """One node settles, another moves on."""
    node, other = mast.truss.nodes.names[3], mast.truss.nodes.names[5]
    once, on = moved_by(mast, [1e-3, 0, 0], 3), moved_by(mast, [1e-4, 1e-4, 1e-4], 5)
    both = replace(once, cycle_ends={**once.cycle_ends, "displacement_m":
                                     once.cycle_ends["displacement_m"] + on.cycle_ends["displacement_m"]})
    words = {}
    for name in (node, other):
        output = chosen_output(both, f"node:{name}")
        found = verdict(both, both, 100, output)
        words[name] = (found.word, others(both, both, found, output))
    assert words[node] == ("shakedown", [note("others_move", output=f"node {node}", node=other, moved="100 µm", cycle=3)])
    assert words[other] == ("ratcheting", [])


@pytest.mark.parametrize("dimension", [2, 3])
def test_fit_finds_what_the_surface_did(dimension: int) -> None:
    focal, rng = 2.0, np.random.default_rng(1)
    across = rng.uniform(-1, 1, (20, dimension - 1))
    points = np.zeros((20, 3))
    points[:, : dimension - 1] = across
    points[:, dimension - 1] = np.sum(across**2, axis=1) / (4 * focal)
    base = made("chain" if dimension == 2 else "umbrella", 3)
    axis = np.eye(3)[dimension - 1]
    truss = replace(base, nodes=replace(base.nodes, position_m=points),
                    reflector=reflector_of(np.arange(20), axis))
    surface = reflector.surface(truss)
    assert surface is not None and not surface.notes
    drawn = surface.fit(np.zeros((20, 3)))
    # Residuals are exact for a paraboloid; the fit of lengths of 1 m ends at the rounding of its derivatives.
    assert drawn.rms_error_m < 1e-12 and drawn.focal_length_m == pytest.approx(focal, rel=1e-8)
    # A rigid motion has no error and shows as tilt.
    tilt = 1e-4
    moved = np.zeros((20, 3))
    moved[:, dimension - 1] = 1e-3 + tilt * points[:, 0]
    moved[:, 0] = -tilt * points[:, dimension - 1]
    fit = surface.fit(moved)
    assert fit.rms_error_m < 1e-8  # tilt² of a motion along straight lines
    assert np.linalg.norm(fit.tilt_rad - drawn.tilt_rad) == pytest.approx(tilt, rel=1e-3)
    # Scattered errors along the axis: all but what as many parameters take away, times the cosine.
    noise = 1e-5 * rng.standard_normal(20)
    moved[:, dimension - 1] += noise
    assert 0.3 * np.std(noise) < surface.fit(moved).rms_error_m < np.std(noise)


def reflector_of(nodes: np.ndarray, axis: np.ndarray) -> Any:
    from statejump.kinds.truss.resolved import ReflectorSurface

    return ReflectorSurface(nodes=nodes, axis=axis, focal_length_m=None)


def test_ring_of_nodes_does_not_determine_a_focal_length() -> None:
    truss = made("umbrella", 8)
    surface = reflector.surface(truss)
    assert surface is not None and surface.free == ("depth", "tilt0", "tilt1")
    assert any("focal length" in note for note in surface.notes)
    assert surface.fit(np.zeros((32, 3))).focal_length_m is None
    few = replace(truss, reflector=replace(truss.reflector, nodes=truss.reflector.nodes[:3]))
    assert reflector.surface(few) is None


def test_command(statejump: Callable[..., Outcome], cases: Path, tmp_path: Path) -> None:
    case = cases / "trusses" / "umbrella_8.toml"
    done = statejump("truss", "answers", case, "--cycles", 2, "--frames", 3, "--output", "node:B1")
    assert done.status == 0, done.errors
    folder = tmp_path / "results" / "umbrella_8" / "answers_node_B1"
    # Answers about another output stay.
    assert list((tmp_path / "results" / "umbrella_8").iterdir()) == [folder]
    summary = json.loads((folder / "answers.json").read_text())
    assert summary["verdict"] == "shakedown" and summary["output"] == "node:B1"
    assert len(summary["output_motion_of_cycle"]) == 2
    assert summary["sum_error_relative"] < 1e-4
    with (folder / "node_jumps.csv").open() as stream:
        rows = list(csv.DictReader(stream))
    assert len(rows) == 2 * 32
    jump = next(row for row in rows if row["node"] == "B1" and row["cycle"] == "2")
    assert float(jump["jump_m"]) == pytest.approx(summary["jump"], rel=1e-12)
    with (folder / "contributions.csv").open() as stream:
        assert sum(float(row["contribution"]) for row in csv.DictReader(stream)) == pytest.approx(
            summary["sum_of_contributions"], rel=1e-12)
    for name in ("jumps.png", "jumps.svg", "ranking.png", "answers.md", "surface.csv", "joint_jumps.csv"):
        assert (folder / name).stat().st_size > 100, name
    frames = json.loads((folder / "path.vtu.series").read_text())["files"]
    assert [frame["time"] for frame in frames] == [0.0, 16.0, 32.0]
    from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader

    reader = vtkXMLUnstructuredGridReader()
    reader.SetFileName(str(folder / frames[-1]["name"]))
    reader.Update()
    grid = reader.GetOutput()
    assert grid.GetNumberOfPoints() == 32 and grid.GetNumberOfCells() == 16 + 8 + 8
    place = [grid.GetPointData().GetAbstractArray("name").GetValue(i) for i in range(32)].index("B1")
    moved = np.array(grid.GetPointData().GetArray("since_start_m").GetTuple3(place))
    assert np.linalg.norm(moved) == pytest.approx(summary["jump"], rel=1e-9)


def test_answers_in_python(tmp_path: Path) -> None:
    case = sj.truss.chain(3, cycles=1)
    found = sj.truss.answers(case, cycles=2, sensitivity=False)
    assert found.verdict == "shakedown" and found.case.thermal.cycles == 2 and case.thermal.cycles == 1
    assert found.jump == pytest.approx(found.frame("node_jumps").query("cycle == 2")["jump_m"].max(), rel=1e-12)
    assert found.frame("contributions")["contribution"].sum() == pytest.approx(found.jump, rel=1e-9)
    assert "sensitivities" not in found.tables and found.run.model == "reduced"
    assert found.run.time_s[-1] == pytest.approx(2 * case.period_s)
    assert len(found.plot().axes) == 2 and len(found.plot_ranking().axes) == 1  # the jumps have a scale of colours
    assert list(tmp_path.iterdir()) == []
    written = found.write(tmp_path)
    assert {path.name for path in tmp_path.iterdir()} == {path.name for path in written}
    assert sj.read(tmp_path / "answers.h5").answers.verdict == "shakedown"


def test_answers_refuse_what_is_out_of_range() -> None:
    case = sj.truss.chain(2)
    for keys, sentence in (
        ({"cycles": 0}, failure("out_of_range", key="cycles", value=0)),
        ({"step": 1.0}, failure("out_of_range", key="step", value=1.0)),
        ({"output": "size"}, failure("output_unknown", key="output", value="size")),
    ):
        with pytest.raises(StatejumpError) as refused:
            sj.truss.answers(case, **keys)
        assert refused.value == sentence
    with failing("command_not_for_kind", command="truss answers"):
        sj.truss.answers(sj.load("table1"))


def test_interrupted_path_is_no_answer(monkeypatch: pytest.MonkeyPatch) -> None:
    whole = solve.path

    def stopped(truss: ResolvedTruss, **options: Any) -> TrussPath:
        return replace(whole(truss, **options), complete=False)  # what the engine returns after Ctrl-C

    monkeypatch.setattr(solve, "path", stopped)
    case = sj.truss.chain(2)
    for call in (case.reduced, lambda: sj.truss.answers(case)):
        with pytest.raises(Interrupted) as ended:
            call()
        assert ended.value.exit_status == 130


@pytest.mark.parametrize("arguments, sentence", [
    (("--output", "node:X"), failure("undefined_reference", key="--output", value="node:X", what_it_is="node", name="X")),
    (("--output", "rms"), failure("no_fit")),
    (("--output", "size"), failure("output_unknown", key="--output", value="size")),
    (("--cycles", 0), failure("out_of_range", key="--cycles", value=0)),
    (("--step", 1), failure("out_of_range", key="--step", value=1.0)),
])
def test_mistakes(statejump: Callable[..., Outcome], cases: Path, tmp_path: Path, arguments: tuple, sentence: Failure) -> None:
    done = statejump("truss", "answers", cases / "trusses" / "chain_10.toml", *arguments)
    assert done.status == 2 and done.failure == sentence and done.errors.count("\n") == 1, done.errors
    assert not [path for path in tmp_path.glob("results/chain_10/**/*") if path.is_file()]
