# SPDX-License-Identifier: GPL-3.0-or-later
"""Answers about trusses and campaigns over them: closed forms of the chain, fits, resumed campaigns."""
from __future__ import annotations

import csv
import json
from dataclasses import replace
from pathlib import Path
from typing import Any, Callable

import numpy as np
import pytest

from conftest import Outcome

from statejump.campaign import execute, journal, tables, work
from statejump.campaign.campaign_file import MONTECARLO, SWEEP, Campaign, load_campaign
from statejump.campaign.sampling import montecarlo_draws
from statejump.core.errors import StatejumpError
from statejump.kinds.loading import parse_case
from statejump.kinds.truss.answers import reflector
from statejump.kinds.truss.answers.contributions import contributions
from statejump.kinds.truss.answers.jumps import node_jumps, quick_path, resolution_m, verdict
from statejump.kinds.truss.answers.outputs import chosen_output
from statejump.kinds.truss.answers.sensitivity import sensitivities
from statejump.kinds.truss.generate import GENERATORS
from statejump.kinds.truss.resolved import ResolvedTruss
from statejump.kinds.truss.solve import TrussPath


def made(kind: str, n: int, **keys: Any) -> ResolvedTruss:
    return parse_case(GENERATORS[kind](n, name="t", **keys)).resolve()


@pytest.fixture(scope="module")
def chain() -> TrussPath:
    """Chain whose frictions and bars all differ."""
    truss = made("chain", 5)
    varied = 1 + 0.1 * np.arange(5)
    return quick_path(replace(
        truss,
        sliders=replace(truss.sliders, normal_force_N=truss.sliders.normal_force_N * varied[::-1]),
        links=replace(truss.links, cross_section_area_m2=truss.links.cross_section_area_m2 * varied),
    ))


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


def test_not_differentiable_is_said() -> None:
    # Friction at which the joint of a rib just slips back: more, and it stays.
    case = GENERATORS["umbrella"](3, name="t")
    truss = parse_case(case).resolve()
    truss = replace(truss, revolutes=replace(truss.revolutes, friction_coefficient=np.full(3, 0.1885)))
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
    truss = replace(truss, sliders=replace(
        truss.sliders, normal_force_N=most / truss.sliders.friction_coefficient))
    path = quick_path(truss)
    found = {row.parameter: row for row in sensitivities(path, chosen_output(path, "node"))}
    row = found["slider.*.friction_coefficient"]
    jump = node_jumps(path)[-1, 1, 0]
    assert jump == pytest.approx(strain / (2 + strain) * links.stress_free_length_m[0], rel=1e-6)
    assert abs(row.per_relative_change) < strain * jump  # 1 and -(1 + ε), the mean of both
    assert row.verdict == "not differentiable"


def test_verdicts() -> None:
    truss = made("mast", 2, cycles=3)
    path = quick_path(truss)
    found = verdict(path, resolution_m(path, quick_path(truss, 100)))
    assert found.word == "shakedown" and len(found.cycle_jump_m) == 3

    def of(each: list[float]) -> str:
        ends = dict(path.cycle_ends)
        moved = np.zeros((len(each) + 1, len(truss.nodes.names), 3))
        moved[1:, 0, 0] = np.cumsum(each)
        ends["displacement_m"] = moved
        for key in ("slider_dissipation_J", "revolute_dissipation_J"):
            ends[key] = np.zeros((len(each) + 1, 1))
        return verdict(replace(path, cycle_ends=ends, states=ends)).word

    assert of([1e-3, 1e-4, 1.003e-4, 1e-4]) == "ratcheting"
    assert of([1e-3, 0, 0]) == "shakedown"
    assert of([1e-3, 5e-4, 2.5e-4]) == "not settled"
    assert of([0, 0]) == "no jump"
    assert of([1e-3]) == "one cycle"


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
    folder = tmp_path / "results" / "umbrella_8"
    summary = json.loads((folder / "answers.json").read_text())
    assert summary["verdict"] == "shakedown" and summary["output"] == "node:B1"
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


@pytest.mark.parametrize("arguments, sentence", [
    (("--output", "node:X"), "--output = 'node:X' is not allowed: there is no node 'X'"),
    (("--output", "rms"), "the truss has no [reflector]"),
    (("--output", "size"), "--output = 'size' is not allowed"),
    (("--cycles", 0), "--cycles = 0 is not allowed"),
    (("--step", 1), "--step = 1.0 is not allowed"),
])
def test_mistakes(statejump: Callable[..., Outcome], cases: Path, tmp_path: Path, arguments: tuple, sentence: str) -> None:
    done = statejump("truss", "answers", cases / "trusses" / "chain_10.toml", *arguments)
    assert done.status == 2 and sentence in done.errors and done.errors.count("\n") == 1, done.errors
    assert not list(tmp_path.glob("results/chain_10/answers*"))


CAMPAIGN = """[campaign]
name = "trial"
case = "{case}"
samples = {samples}
seed = 3
"""
FRICTION = """[[vary]]
key = "slider.*.friction_coefficient"
distribution = "lognormal"
relative = 0.2
"""
ONE = """[[vary]]
key = "link.L3.young_modulus_Pa"
distribution = "normal"
relative = 0.1
"""


@pytest.fixture
def campaign(tmp_path: Path, cases: Path) -> Callable[..., Campaign]:
    def load(*vary: str, samples: int = 12, case: str = "iwan_10", command: str = MONTECARLO) -> Campaign:
        path = tmp_path / "trial.toml"
        text = CAMPAIGN.format(case=cases / "trusses" / f"{case}.toml", samples=samples)
        if command == SWEEP:
            text = "\n".join(line for line in text.splitlines() if not line.startswith(("samples", "seed"))) + "\n"
        path.write_text(text + "".join(vary))
        return load_campaign(path, command)

    return load


def test_every_item_is_drawn_on_its_own(campaign: Callable[..., Campaign]) -> None:
    trial = campaign(FRICTION, ONE)
    data = trial.data(4)
    drawn = [slider["friction_coefficient"] for slider in data["slider"]]
    assert len(set(drawn)) == 10
    assert trial.values(4)[0] == pytest.approx(np.mean(drawn), rel=1e-15)
    assert {link["name"]: link["young_modulus_Pa"] for link in data["link"]}["L3"] == trial.values(4)[1] != 70e9
    assert sum(link["young_modulus_Pa"] != 70e9 for link in data["link"]) == 1
    assert trial.case_data["slider"][0]["friction_coefficient"] == 0.3  # as in the file
    assert [value for _, value in montecarlo_draws(trial.vary, 3, 4)][:10] == drawn
    # The mean of 10 lognormal draws of 20 %, over 400 samples: 0.3 within 4 standard errors.
    means = [trial.values(index)[0] for index in range(400)]
    assert np.mean(means) == pytest.approx(0.3, abs=4 * 0.06 / np.sqrt(4000))
    assert np.std(means) == pytest.approx(0.06 / np.sqrt(10), rel=0.15)


def test_sweep_of_all_items(campaign: Callable[..., Campaign]) -> None:
    trial = campaign('[[vary]]\nkey = "slider.*.friction_coefficient"\nvalues = [0.1, 0.2]\n', command=SWEEP)
    assert {slider["friction_coefficient"] for slider in trial.data(1)["slider"]} == {0.2}
    jumps = [dict(zip(trial.units, work.run_sample(trial, index).values)) for index in (0, 1)]
    # The strongest block does not return: its share of the jump is proportional to friction.
    assert jumps[1]["largest_node_jump_m"] > jumps[0]["largest_node_jump_m"] > 0
    assert jumps[0]["slipping_joints"] == 10 and np.isnan(jumps[0]["reflector_rms_error_m"])


@pytest.mark.parametrize("text, sentence", [
    (FRICTION.replace("slider.*", "slider.S99"), "key = 'slider.S99.friction_coefficient' is unknown: the case has no"),
    (FRICTION.replace("slider.*", "revolute.*"), "is not allowed: the case has no [[revolute]]"),
    (FRICTION.replace("*.friction_coefficient", "*.friction"), "did you mean 'slider.*.friction_coefficient'?"),
    (FRICTION + FRICTION.replace("*", "S1"), "vary[2].key = 'slider.S1.friction_coefficient' is not allowed: it varies"),
    (FRICTION.replace("slider.*.friction_coefficient", "slider.*.clearance_plus_m"), "mean is missing"),
    (FRICTION + 'also = ["link.*.young_modulus_Pa"]\n', "items of 'slider.*.friction_coefficient' share their values"),
])
def test_mistakes_in_a_campaign(campaign: Callable[..., Campaign], text: str, sentence: str) -> None:
    with pytest.raises(StatejumpError) as caught:
        campaign(text)
    assert sentence in str(caught.value)


def test_no_dem_campaign(campaign: Callable[..., Campaign]) -> None:
    with pytest.raises(StatejumpError, match="campaign.model = 'dem' is not allowed"):
        campaign('model = "dem"\n' + FRICTION)


def test_half_a_campaign_resumed(tmp_path: Path, campaign: Callable[..., Campaign]) -> None:
    """Half of the samples, a torn line as a kill leaves it, the others: the same bytes as in one go."""
    trial = campaign(FRICTION, ONE)

    def finish(folder: Path) -> tuple[bytes, bytes]:
        folder.mkdir(exist_ok=True)
        with journal.Journal(folder, trial, restart=False) as kept:
            execute.run_missing(trial, kept, None, 1, lambda fraction: None)
            table = tables.make_table(trial, kept.batches)
        tables.write_csv(table, folder / "samples.csv")
        tables.write_hdf5(trial, table, folder / "samples.h5")
        return (folder / "samples.csv").read_bytes(), (folder / "samples.h5").read_bytes()

    (tmp_path / "resumed").mkdir()
    with journal.Journal(tmp_path / "resumed", trial, restart=False) as kept:
        kept.add(work.run_samples(trial, (7, 0, 3, 5, 11, 2))[1])
    with kept.path.open("ab") as stream:
        stream.write(b'{"samples":[9],"val')
    resumed = finish(tmp_path / "resumed")
    assert resumed == finish(tmp_path / "whole")
    assert b"nan" not in resumed[0].split(b"\n", 1)[0] and resumed[0].count(b"\n") == 13
