# SPDX-License-Identifier: GPL-3.0-or-later
"""Campaigns: samples, messages, both models, resuming after a kill, identical bytes for any number of workers."""
from __future__ import annotations

import csv
import gc
import json
import math
import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest

from conftest import BUILT, REPOSITORY, Outcome
from failures import Failure, failing, failure, note

import statejump as sj
from statejump.campaign import distribute, execute, journal, summary, tables, work
from statejump.campaign.campaign_file import load_campaign
from statejump.campaign.plan import MONTECARLO, SWEEP, Plan
from statejump.campaign.sampling import Distribution, Values, montecarlo_values, sweep_values
from statejump.campaign.yade_batch import write_table
from statejump.core.notes import Note
from statejump.core.errors import StatejumpError

# Like the launcher, without a main guard, so that processes that import it would run it again.
LAUNCHER = f"""
import sys
sys.path.insert(0, {str(BUILT)!r})
from statejump.cli.main import main
main()
"""

HEADER = """[campaign]
name = "trial"
case = "{case}"
model = "{model}"
samples = {samples}
seed = 7
"""
FRICTION = """[[vary]]
key = "joint.friction_coefficient"
distribution = "normal"
relative = 0.2
"""
CLEARANCE = """[[vary]]
key = "joint.clearance_plus_m"
also = ["joint.clearance_minus_m"]
distribution = "uniform"
low = 0.5e-3
high = 1.5e-3
"""


@pytest.fixture
def write(tmp_path: Path, cases: Path) -> Callable[..., Path]:
    """Write a campaign file."""

    def text(
        *vary: str, case: Path | str = cases / "table1.toml", model: str = "reduced", samples: int = 50
    ) -> Path:
        path = tmp_path / "trial.toml"
        path.write_text(HEADER.format(case=case, model=model, samples=samples) + "".join(vary or (FRICTION, CLEARANCE)))
        return path

    return text


@pytest.fixture
def start(tmp_path: Path) -> Callable[..., subprocess.Popen]:
    """Start the command in a process group of its own."""
    script = tmp_path / "launcher"
    script.write_text(LAUNCHER)

    def begin(*arguments: object, **environment: str) -> subprocess.Popen:
        return subprocess.Popen(
            [sys.executable, str(script), *map(str, arguments)], cwd=tmp_path, text=True,
            env={**os.environ, **environment}, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
            stdin=subprocess.DEVNULL, start_new_session=True,
        )

    return begin


@pytest.fixture
def command(start: Callable[..., subprocess.Popen]) -> Callable[..., Outcome]:
    """Run the command to its end."""

    def run(*arguments: object, **environment: str) -> Outcome:
        with start(*arguments, **environment) as process:
            output, errors = process.communicate(timeout=120)
        return Outcome(process.returncode, output, errors)

    return run


def finish(campaign: Plan, folder: Path, workers: int = 1, scheduler: str | None = None) -> tuple[bytes, bytes]:
    """Run the missing samples; return both tables."""
    folder.mkdir(exist_ok=True)
    with journal.Journal(folder, campaign, restart=False) as kept:
        execute.run_missing(campaign, kept, scheduler, workers, lambda fraction: None)
        table = tables.make_table(campaign, kept.batches)
    tables.write_csv(table, folder / "samples.csv")
    tables.write_hdf5(campaign, table, folder / "samples.h5")
    return (folder / "samples.csv").read_bytes(), (folder / "samples.h5").read_bytes()


def rows_of(folder: Path) -> list[dict[str, str]]:
    with (folder / "samples.csv").open(newline="") as stream:
        return list(csv.DictReader(stream))


pytestmark = pytest.mark.filterwarnings("ignore:make_current is deprecated")  # distributed's own


# Sampling.

def test_moments_of_every_distribution() -> None:
    key, count = ("joint.friction_coefficient",), 20_000
    vary = [
        Distribution(key, "normal", 0.3, 0.05),
        Distribution(key, "lognormal", 0.3, 0.1),
        Distribution(key, "uniform", low=0.1, high=0.4),
        Distribution(key, "truncated_normal", 0.3, 0.1, 0.2, 0.4),
        Distribution(key, "truncated_normal", 0.0, 1.0, 8.0, math.inf),  # far out in the tail
    ]
    drawn = np.array([montecarlo_values(vary, 1, index) for index in range(count)])
    mean, deviation = drawn.mean(axis=0), drawn.std(axis=0)
    density = math.exp(-0.5) / math.sqrt(2 * math.pi)
    inside = math.erf(1 / math.sqrt(2))
    cut = 0.1 * math.sqrt(1 - 2 * density / inside)  # limits one standard deviation away
    expected = [(0.3, 0.05), (0.3, 0.1), (0.25, 0.3 / math.sqrt(12)), (0.3, cut)]
    for place, (wanted_mean, wanted_deviation) in enumerate(expected):
        assert abs(mean[place] - wanted_mean) < 4 * wanted_deviation / math.sqrt(count)
        assert deviation[place] == pytest.approx(wanted_deviation, rel=0.03)
    assert np.median(np.log(drawn[:, 1])) == pytest.approx(math.log(0.3 / math.sqrt(1 + 1 / 9)), abs=0.01)
    for place, (low, high) in {2: (0.1, 0.4), 3: (0.2, 0.4), 4: (8.0, 9.5)}.items():
        assert low <= drawn[:, place].min() and drawn[:, place].max() <= high
    assert mean[4] == pytest.approx(8.1213, abs=0.005)  # density over tail probability at 8
    correlation = np.corrcoef(drawn, rowvar=False) - np.eye(len(vary))
    assert np.abs(correlation).max() < 4 / math.sqrt(count)


def test_sample_depends_on_seed_and_number_alone(write: Callable[..., Path]) -> None:
    few, many = (load_campaign(write(samples=count), MONTECARLO) for count in (5, 50))
    assert [few.values(i) for i in range(5)] == [many.values(i) for i in range(5)]
    assert len({tuple(many.values(i)) for i in range(50)}) == 50
    assert few.key == many.key  # a campaign may be extended
    data = many.data(3)["joint"]
    assert data["clearance_minus_m"] == data["clearance_plus_m"] == many.values(3)[1]


def test_grid_of_a_sweep(tmp_path: Path, cases: Path) -> None:
    grid = [Values(("a",), (1, 2)), Values(("b",), (3, 4, 5))]
    assert [sweep_values(grid, i) for i in range(6)] == [[1, 3], [1, 4], [1, 5], [2, 3], [2, 4], [2, 5]]
    path = tmp_path / "sweep.toml"
    path.write_text(
        f'[campaign]\nname = "s"\ncase = "{cases / "table1.toml"}"\n'
        '[[vary]]\nkey = "thermal.cycles"\nvalues = [1, 2]\n'
        '[[vary]]\nkey = "joint.friction_coefficient"\nstart = 0.01\nstop = 1\ncount = 3\nspacing = "log"\n'
    )
    campaign = load_campaign(path, SWEEP)
    assert campaign.samples == 6
    assert [campaign.values(i) for i in (0, 4)] == [[1, 0.01], [2, pytest.approx(0.1)]]
    finish(campaign, tmp_path / "s")
    rows = rows_of(tmp_path / "s")
    # f l0 / (E A), for any number of cycles
    for row in rows:
        exact = float(row["joint.friction_coefficient"]) * 100 * 0.5 / (70e9 * 9e-6)
        assert float(row["state_jump_m"]) == pytest.approx(exact, rel=1e-4)


# Sentences.

MISTAKES = {
    "absent case": (("table1.toml", "tabel1.toml"), failure("case_file_not_found", file="tabel1.toml")),
    "unknown section": (("[campaign]", "[campain]"), failure("misspelt_key", key="campain", meant="[campaign]")),
    "unknown table": (("[[vary]]", "[[vari]]"), failure("misspelt_key", key="vari", meant="[[vary]]")),
    "unknown key": (("samples =", "sampels ="), failure("misspelt_key", key="campaign.sampels", meant="campaign.samples")),
    "missing key": (("seed = 7\n", ""), failure("missing_key", key="campaign.seed")),
    "no samples": (("samples = 50", "samples = 0"),
                   failure("out_of_range", key="campaign.samples", value=0)),
    "unknown model": (('"reduced"', '"redcued"'),
                      failure("misspelt_name", key="campaign.model", value="redcued", meant="reduced", known="'reduced' or 'dem'")),
    "bad name": (('"trial"', '"../trial"'), failure("no_folder_name", key="campaign.name", value="../trial")),
    "misspelt parameter": (("joint.friction_coefficient", "joint.frictoin_coefficient"),
                           failure("key_not_in_kind", item="vary[1]", key="key", value="joint.frictoin_coefficient", kind="spring_slider")),
    "not a number": (("joint.friction_coefficient", "thermal.shape"),
                     failure("key_not_numeric", item="vary[1]", key="key", value="thermal.shape")),
    "whole number": (("joint.friction_coefficient", "thermal.cycles"),
                     failure("integer_not_random", item="vary[1]", key="key", value="thermal.cycles")),
    "twice": (("joint.friction_coefficient", "joint.clearance_minus_m"),
              failure("duplicate_vary", item="vary[2]", key="key", value="joint.clearance_minus_m")),
    "unknown distribution": (('"normal"', '"nromal"'),
                             failure("misspelt_name", item="vary[1]", key="distribution", value="nromal", meant="normal")),
    "misspelt key of a table": (("relative", "realtive"), failure("misspelt_key", item="vary[1]", key="realtive", meant="relative")),
    "key of a sweep": (("relative = 0.2", "values = [1]"),
                       failure("key_of_other_campaign", item="vary[1]", key="values", command="montecarlo", other="sweep")),
    "no spread": (("relative = 0.2\n", ""), failure("deviation_missing", item="vary[1]", key="standard_deviation")),
    "negative spread": (("relative = 0.2", "relative = -0.2"),
                        failure("not_finite_above", item="vary[1]", key="relative", value=-0.2, least=0)),
    "spread that vanishes": (("relative = 0.2", "relative = 5e-324"),
                             failure("deviation_not_positive", item="vary[1]", key="relative", value=5e-324, deviation=0.0)),
    "mean out of range": (("relative = 0.2", "mean = -0.3\nstandard_deviation = 1"),
                          failure("out_of_range", item="vary[1]", key="mean", value=-0.3)),
    "mean not a number": (("relative = 0.2", 'mean = "0.3"\nrelative = 1'),
                          failure("wrong_type", item="vary[1]", key="mean", value="0.3", type="a number", range="between 0 and 10 [-]")),
    "limits exchanged": (("low = 0.5e-3", "low = 2e-3"),
                         failure("not_above_low", item="vary[2]", key="high", value=0.0015, low=0.002)),
    "limits of a normal distribution": (("relative = 0.2", "relative = 0.2\nlow = 0"),
                                        failure("distribution_without_limits", item="vary[1]", key="low", distribution="normal")),
    "infinite": (("high = 1.5e-3", "high = inf"), failure("not_finite", item="vary[2]", key="high", value=float("inf"))),
    "nothing left between the limits": (
        ('"uniform"\nlow = 0.5e-3', '"truncated_normal"\nstandard_deviation = 1e-6\nlow = 1.4e-3'),
        failure("empty_truncated_distribution", item="vary[2]", key="mean", value=0.001)),
    "not TOML": (("[campaign]", "[campaign"), failure("not_toml_at_line", line=1)),
}


@pytest.mark.parametrize("mistake", MISTAKES)
def test_mistake_in_the_campaign_file(write: Callable[..., Path], mistake: str) -> None:
    (old, new), sentence = MISTAKES[mistake]
    path = write()
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new) if old == "[[vary]]" else text.replace(old, new, 1))
    with pytest.raises(StatejumpError) as caught:
        load_campaign(path, MONTECARLO)
    assert caught.value == sentence and "\n" not in str(caught.value)
    assert mistake == "absent case" or caught.value == sentence.at(file=path)


@pytest.mark.parametrize("text, sentence", [
    ("values = []", failure("not_list_of_numbers", item="vary[1]", key="values", value=[])),
    ("values = [0.1, 11]", failure("out_of_range", item="vary[1]", key="values", value=11)),
    ("values = [0.1, 0.1]", failure("duplicate_value", item="vary[1]", key="values")),
    ("values = [0.1]\nstart = 1", failure("conflicting_key", item="vary[1]", key="start", other="values")),
    ("start = 0\nstop = 1", failure("range_missing", item="vary[1]", key="count")),
    ("start = 0\nstop = 1\ncount = 1", failure("grid_count_out_of_range", item="vary[1]", key="count", value=1, most_samples=10000000)),
    ("start = 0\nstop = 1\ncount = 3\nspacing = 'log'",
     failure("log_spacing_not_positive", item="vary[1]", key="start", value=0.0)),
    ("values = [0.1]\nspacing = 'lin'", failure("unknown_name", item="vary[1]", key="spacing", value="lin", known="'linear' or 'log'")),
    ("relative = 0.1", failure("key_of_other_campaign", item="vary[1]", key="relative", command="sweep", other="montecarlo")),
])
def test_mistake_in_a_sweep(tmp_path: Path, cases: Path, text: str, sentence: Failure) -> None:
    path = tmp_path / "sweep.toml"
    path.write_text(
        f'[campaign]\nname = "s"\ncase = "{cases / "table1.toml"}"\n'
        f'[[vary]]\nkey = "joint.friction_coefficient"\n{text}\n'
    )
    with pytest.raises(StatejumpError) as caught:
        load_campaign(path, SWEEP)
    assert caught.value == sentence


def test_command_ends_with_one_sentence(write: Callable[..., Path], command: Callable[..., Outcome]) -> None:
    path = write()
    began = time.monotonic()
    for arguments, sentence in (
        (("--scheduler", "tcp://127.0.0.1:9"), failure("scheduler_not_reached", key="--scheduler", value="tcp://127.0.0.1:9")),
        (("--scheduler", "nowhere"), failure("scheduler_address", key="--scheduler", value="nowhere")),
    ):
        outcome = command("--json", "montecarlo", path.name, *arguments)
        assert outcome.status == 2
        assert outcome.errors == sentence and outcome.errors.count("\n") == 1, outcome.errors
    assert time.monotonic() - began < 30


# Failed samples.

def out_of_range(value: float) -> sj.errors.NotAllowed:
    """Return the failure of a sample with this coefficient of friction."""
    return sj.errors.NotAllowed("joint.friction_coefficient", value, allowed=sj.errors.Range(0, 10, "-"))


def test_failed_sample_is_recorded(tmp_path: Path, write: Callable[..., Path]) -> None:
    wide = FRICTION.replace('"normal"\nrelative = 0.2', '"uniform"\nlow = -0.3\nhigh = 0.3')
    campaign = load_campaign(write(wide), MONTECARLO)
    finish(campaign, tmp_path / "trial")
    rows = rows_of(tmp_path / "trial")
    assert [int(row["sample"]) for row in rows] == list(range(50))
    failed = [row for row in rows if row["error"]]
    assert failed and len(failed) < 50
    for row in rows:
        friction = row["joint.friction_coefficient"]
        if float(friction) < 0:
            assert row["error"] == str(out_of_range(float(friction)))
            assert row["state_jump_m"] == ""
        else:
            assert row["error"] == "" and float(row["state_jump_m"]) > 0
    with journal.Journal(tmp_path / "trial", campaign, restart=False) as kept:
        table = tables.make_table(campaign, kept.batches)
    found = summary.summary(campaign, table)
    assert found["failed"] == len(failed) == found["failures"][0]["samples"]
    assert found["failures"][0]["sentence"] == out_of_range(-0.1).general()
    assert found["outcomes"]["state_jump_m"]["count"] == 50 - len(failed)
    with h5py.File(tmp_path / "trial" / "samples.h5") as file:
        assert file["failed/sample"][:].tolist() == [int(row["sample"]) for row in failed]
        assert file["failed/error"].asstr()[0] == failed[0]["error"]
        assert file["outcomes/state_jump_m"].attrs["unit"] == "m"
        assert file.attrs["campaign"] == campaign.text and file.attrs["seed"] == 7
        jump = file["outcomes/state_jump_m"][:]
    assert np.count_nonzero(np.isnan(jump)) == len(failed)


def test_unforeseen_error_of_one_sample(write: Callable[..., Path], monkeypatch: pytest.MonkeyPatch) -> None:
    campaign = load_campaign(write(), MONTECARLO)

    def broken(*ignored: Any) -> None:
        raise ZeroDivisionError("a\nb")

    monkeypatch.setattr(work, "outcome", broken)
    assert work.run_sample(campaign, 0).error == note("sample_failed", error="ZeroDivisionError", text="a b")


def test_sample_that_kills_its_worker(
    tmp_path: Path, write: Callable[..., Path], fake_yade: Callable[[str], str], monkeypatch: pytest.MonkeyPatch
) -> None:
    # A new worker may take any time to start.
    monkeypatch.setattr(distribute, "NO_WORKERS_S", 0.0)
    monkeypatch.setattr(distribute, "LOOK_S", 0.05)
    monkeypatch.setenv("STATEJUMP_YADE", fake_yade("kill -9 $PPID\n"))
    campaign = load_campaign(write(model="dem", samples=1), MONTECARLO)
    finish(campaign, tmp_path / "trial")
    assert rows_of(tmp_path / "trial")[0]["error"] == Note("worker_ended")


# In Python.

def test_sweep_in_python(tmp_path: Path, cases: Path) -> None:
    """The block of the documentation; few samples need no workers."""
    case = sj.load(cases / "table1.toml")
    campaign = sj.sweep(case, {"joint.friction_coefficient": [0.1, 0.2], "thermal.cycles": np.array([1, 2])})
    frame = campaign.frame()
    assert list(frame["joint.friction_coefficient"]) == [0.1, 0.1, 0.2, 0.2]
    assert list(frame["thermal.cycles"]) == [1, 2, 1, 2] and not frame["error"].any()
    # f l0 / (E A), for any number of cycles
    exact = frame["joint.friction_coefficient"] * 100 * 0.5 / (70e9 * 9e-6)
    assert frame["state_jump_m"].tolist() == pytest.approx(exact.tolist())
    for _, row in frame.iterrows():
        run = case.changed({"joint.friction_coefficient": row["joint.friction_coefficient"],
                            "thermal.cycles": int(row["thermal.cycles"])}).reduced()
        assert run.summary["state_jump_m"] == row["state_jump_m"]
    assert campaign.summary()["outcomes"]["state_jump_m"]["count"] == 4 == len(campaign)
    assert len(campaign.plot().axes) >= 6
    assert "state_jump_m" in campaign._repr_html_() and "4 samples" in repr(campaign)
    spaced = sj.sweep(case, {"joint.friction_coefficient": {"start": 0.1, "stop": 0.4, "count": 4}})
    assert spaced.frame()["joint.friction_coefficient"].tolist() == pytest.approx([0.1, 0.2, 0.3, 0.4])


def test_montecarlo_in_python_is_that_of_a_file(tmp_path: Path, cases: Path, write: Callable[..., Path]) -> None:
    told: list[float] = []
    campaign = sj.montecarlo(
        sj.load(cases / "table1.toml"),
        {"joint.friction_coefficient": {"distribution": "uniform", "low": -0.3, "high": 0.3}},
        samples=50, seed=7, progress=told.append,
    )
    assert told == sorted(told) and told[-1] == 1.0
    wide = FRICTION.replace('"normal"\nrelative = 0.2', '"uniform"\nlow = -0.3\nhigh = 0.3')
    plan = load_campaign(write(wide), MONTECARLO)
    assert campaign.plan.key == plan.key
    finish(plan, tmp_path / "trial")  # by a worker
    tables.write_csv(campaign.table, tmp_path / "here.csv")
    assert (tmp_path / "here.csv").read_bytes() == (tmp_path / "trial" / "samples.csv").read_bytes()
    assert campaign.failed > 0 and len(campaign.summary()["failures"]) == 1
    assert "failed: " in campaign._repr_html_()
    for name in ("distributions", "correlations"):
        assert campaign.plot(name).axes
    with pytest.raises(ValueError, match="'correlations'"):
        campaign.plot("sweep")


def test_few_samples_start_no_workers(tmp_path: Path) -> None:
    """Nor is Dask imported, nor pyplot."""
    done = subprocess.run(
        [sys.executable, "-c", "import sys, statejump as sj\n"
         "sj.sweep(sj.load('table1'), {'joint.friction_coefficient': [0.1, 0.2]}).plot()\n"
         "print([name for name in ('distributed', 'dask', 'matplotlib.pyplot') if name in sys.modules])"],
        cwd=tmp_path, env={**os.environ, "PYTHONPATH": str(BUILT)}, capture_output=True, text=True, timeout=120,
    )
    assert (done.stdout, done.stderr) == ("[]\n", "")


@pytest.mark.parametrize("values, more, sentence", [
    ({"joint.frictoin_coefficient": [1]}, {}, failure("key_not_in_kind", item="vary['joint.frictoin_coefficient']", key="key", value="joint.frictoin_coefficient", kind="spring_slider")),
    ({"joint.friction_coefficient": [11.0]}, {}, failure("out_of_range", item="vary['joint.friction_coefficient']", key="values", value=11.0)),
    ({"joint.friction_coefficient": []}, {}, failure("not_list_of_numbers", item="vary['joint.friction_coefficient']", key="values", value=[])),
    ({"joint.friction_coefficient": [None]}, {}, failure("out_of_range", item="vary['joint.friction_coefficient']", key="values")),
    ({}, {}, failure("vary_without_key")),
    ({"joint.friction_coefficient": [1]}, {"workers": 0}, failure("below_minimum", key="workers", value=0, least=1)),
    ({"joint.friction_coefficient": [1]}, {"model": "fem"}, failure("misspelt_name", key="model", value="fem", meant="dem", known="'reduced' or 'dem'")),
])
def test_mistakes_in_python(cases: Path, values: dict[str, Any], more: dict[str, Any], sentence: Failure) -> None:
    with pytest.raises(StatejumpError) as caught:
        sj.sweep(sj.load(cases / "table1.toml"), values, **more)
    assert caught.value == sentence


def test_campaign_of_a_kind_without_outcomes(tmp_path: Path, cases: Path, write: Callable[..., Path]) -> None:
    with failing("command_not_for_kind", key="case.kind", value="statics", command="sweep", kinds="'spring_slider' and 'umbrella' and 'truss'"):
        sj.sweep(sj.load(cases / "statics_ball.toml"), {"joint.friction_coefficient": [1]})
    with failing("no_campaign_of_kind", key="campaign.case", kind="statics"):
        load_campaign(write(case=cases / "statics_ball.toml"), MONTECARLO)


def test_outcomes_are_what_kinds_say_before_any_run(cases: Path) -> None:
    for name in ("table1", "umbrella_damped", "trusses/iwan_10"):
        case = sj.load(cases / f"{name}.toml").definition
        kind = case.behaviour
        assert kind.OUTCOMES
        if name != "umbrella_damped":  # a second; its outcomes are compared below
            assert tuple(kind.outcomes(case, kind.reduced(case, lambda share: None))) == kind.OUTCOMES


def test_failures_are_counted_by_their_fields() -> None:
    """Failures that differ only in their numbers are counted as one; limits of a range are not such numbers."""
    first, second = (
        sj.errors.FailedRun("the run failed", cause="it buckles", time_s=time_s, temperature_change_K=10 * time_s)
        for time_s in (0.25, 0.5)
    )
    assert first.general() == second.general()
    (general,) = {out_of_range(value).general() for value in (-0.25, -1e-3)}
    assert general == str(out_of_range(-0.25)).replace("-0.25", "…")
    assert sj.errors.NotAllowed("a", "b", "c").general() == str(sj.errors.NotAllowed("a", "b", "c"))


def test_workers_know_kinds_of_ones_own(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A worker imports a user's kind from the same file as this process, and both compute equal samples."""
    from statejump import kinds

    monkeypatch.syspath_prepend(str(Path(__file__).resolve().parent / "toy"))
    monkeypatch.setattr(kinds, "KINDS", dict(kinds.KINDS))
    kinds.register("toy_kind:KIND")
    case = sj.load({
        "case": {"name": "rod", "kind": "toy"}, "rod": {"length_m": 2.0},
        "thermal": {"shape": "triangle", "temperature_change_max_K": 100.0},
    })
    here, there = (sj.sweep(case, {"rod.residue": [0.0, 0.1, 0.2]}, workers=count) for count in (None, 1))
    assert not there.failed and there.done.workers == 1
    assert here.frame().equals(there.frame())


# Execution.

def test_same_bytes_with_any_workers(tmp_path: Path, write: Callable[..., Path]) -> None:
    campaign = load_campaign(write(samples=3000), MONTECARLO)
    one = finish(campaign, tmp_path / "one", workers=1)
    time.sleep(1.1)  # a time stamp in the file would differ
    from distributed import LocalCluster

    from statejump.campaign.cluster import _no_main_file

    with _no_main_file(), LocalCluster(
        n_workers=2, threads_per_worker=1, dashboard_address="127.0.0.1:0", local_directory=str(tmp_path)
    ) as cluster:
        two = finish(campaign, tmp_path / "two", scheduler=cluster.scheduler_address)
    assert one == two
    extended = load_campaign(write(samples=3010), MONTECARLO)
    longer = finish(extended, tmp_path / "one")[0]
    assert longer.startswith(one[0]) and len(longer) > len(one[0])
    # The first samples, computed here and now.
    rows = rows_of(tmp_path / "two")
    for index in range(5):
        sample = work.run_sample(campaign, index)
        assert [repr(value) for value in sample.values] == [rows[index][name] for name in campaign.units]


def test_workers_that_vanish_end_the_campaign_and_keep_what_is_finished(
    tmp_path: Path, write: Callable[..., Path], monkeypatch: pytest.MonkeyPatch
) -> None:
    from distributed import LocalCluster

    from statejump.campaign.cluster import _no_main_file, kill_workers

    campaign = load_campaign(write(samples=50_000), MONTECARLO)
    monkeypatch.setattr(distribute, "LOOK_S", 0.1)
    # The cluster starts another worker, in more than half a second.
    monkeypatch.setattr(distribute, "NO_WORKERS_S", 0.2)
    (tmp_path / "trial").mkdir()
    with _no_main_file(), LocalCluster(
        n_workers=1, threads_per_worker=1, dashboard_address="127.0.0.1:0", local_directory=str(tmp_path)
    ) as cluster, journal.Journal(tmp_path / "trial", campaign, restart=False) as kept:
        def on_progress(fraction: float) -> None:
            if fraction > 0:
                kill_workers(cluster)

        with pytest.raises(StatejumpError) as lost:
            execute.run_missing(campaign, kept, cluster.scheduler_address, None, on_progress)
    assert lost.value == failure("scheduler_lost_workers", patience=0.2)
    assert 0 < len(kept.finished) < campaign.samples


def _samples_in(content: bytes) -> int:
    whole = content[: content.rfind(b"\n") + 1].splitlines()[1:]
    return sum(len(json.loads(line.partition(b" ")[2])["samples"]) for line in whole)


def _wait_for_samples(process: subprocess.Popen, path: Path, wanted: int) -> None:
    end = time.monotonic() + 60
    while time.monotonic() < end:
        assert process.poll() is None, process.communicate()
        if path.exists() and _samples_in(path.read_bytes()) >= wanted:
            return
        time.sleep(0.05)
    raise AssertionError("no samples in a minute")


def _processes_of(folder: Path) -> Iterator[int]:
    """Processes that work in a folder."""
    for entry in Path("/proc").iterdir():
        try:
            if entry.name.isdigit() and (entry / "cwd").readlink() == folder:
                if (entry / "stat").read_text().split()[2] != "Z":
                    yield int(entry.name)
        except OSError:
            continue


def test_interrupted_and_killed_and_resumed(
    tmp_path: Path, cases: Path, write: Callable[..., Path], start: Callable[..., subprocess.Popen]
) -> None:
    path = write(FRICTION, case=cases / "umbrella_damped.toml", samples=100)
    # 20 000 steps last 10 ms
    text = (cases / "umbrella_damped.toml").read_text().replace("steps_per_cycle = 100000", "steps_per_cycle = 20000")
    (tmp_path / "short.toml").write_text(text)
    path.write_text(path.read_text().replace(str(cases / "umbrella_damped.toml"), "short.toml"))
    campaign = load_campaign(path, MONTECARLO)
    kept = tmp_path / "results" / "trial" / journal.NAME

    first = start("montecarlo", path.name, "--workers", 1)
    _wait_for_samples(first, kept, 15)
    os.killpg(first.pid, signal.SIGINT)
    output, errors = first.communicate(timeout=30)
    assert first.returncode == 130, errors
    assert errors.startswith("interrupted; ") and errors.count("\n") == 1, errors
    finished = kept.read_bytes()

    second = start("montecarlo", path.name, "--workers", 1)
    _wait_for_samples(second, kept, _samples_in(finished) + 20)
    second.kill()
    second.communicate(timeout=30)
    end = time.monotonic() + 20
    while list(_processes_of(tmp_path)) and time.monotonic() < end:
        time.sleep(0.1)
    assert not list(_processes_of(tmp_path))  # workers go with the command
    assert kept.read_bytes().startswith(finished)
    with kept.open("ab") as stream:
        stream.write(b'{"samples":[99],"val')  # torn
    with journal.Journal(kept.parent, campaign, restart=False) as there:
        assert 15 < len(there.finished) < 100
    resumed = finish(campaign, kept.parent)
    assert resumed == finish(campaign, tmp_path / "uninterrupted", workers=2)


def test_changed_campaign_is_refused(tmp_path: Path, write: Callable[..., Path]) -> None:
    campaign = load_campaign(write(), MONTECARLO)
    folder = tmp_path / "trial"
    folder.mkdir()
    with journal.Journal(folder, campaign, restart=False) as kept:
        kept.add(work.run_samples(campaign, (4, 2))[1])
    other = load_campaign(write(FRICTION), MONTECARLO)
    with failing("journal_of_other_campaign"):
        journal.Journal(folder, other, restart=False)
    with journal.Journal(folder, campaign, restart=False) as kept:
        assert kept.finished == {4, 2}
        for place, index in enumerate((4, 2)):
            assert tuple(kept.batches[0].values[place]) == work.run_sample(campaign, index).values
    with journal.Journal(folder, other, restart=True) as kept:
        assert not kept.finished


def test_damaged_journal(tmp_path: Path, write: Callable[..., Path]) -> None:
    """An altered byte in any line except the last makes the campaign's journal invalid. An incomplete or altered last
    line is removed, and its samples are run again."""
    campaign = load_campaign(write(), MONTECARLO)
    path = tmp_path / journal.NAME
    with journal.Journal(tmp_path, campaign, restart=False) as kept:
        for index in range(3):
            kept.add(work.run_samples(campaign, (index,))[1])
    whole = path.read_bytes()
    last = whole.rstrip(b"\n").rfind(b"\n") + 1
    for place in range(0, len(whole), 7):
        path.write_bytes(whole[:place] + bytes([whole[place] ^ 1]) + whole[place + 1:])
        if place < last:
            line = whole.count(b"\n", 0, place) + 1
            with failing("journal_damaged"):
                journal.Journal(tmp_path, campaign, restart=False)
            assert line <= 3
        else:
            with journal.Journal(tmp_path, campaign, restart=False) as kept:
                assert kept.finished == {0, 1} and kept.note == note("journal_torn", path=path)
            assert path.read_bytes() == whole[:last]
    for end in range(last + 1, len(whole)):
        path.write_bytes(whole[:end])
        with journal.Journal(tmp_path, campaign, restart=False) as kept:
            assert kept.finished == {0, 1} and kept.note
    path.write_bytes(whole)
    with journal.Journal(tmp_path, campaign, restart=False) as kept:
        assert kept.finished == {0, 1, 2} and not kept.note


@pytest.fixture
def short(tmp_path: Path, cases: Path) -> str:
    """A case with a short DEM run; its cycle is not slow enough to be quasi-static."""
    text = (cases / "table1.toml").read_text()
    for old, new in (("period_s = 1.0", "period_s = 0.05"), ("samples_per_cycle = 2000", "samples_per_cycle = 400")):
        assert old in text
        text = text.replace(old, new)
    (tmp_path / "short.toml").write_text(text)
    return "short.toml"


def test_either_model_and_yade_batch(
    yade: str, tmp_path: Path, write: Callable[..., Path], short: str, command: Callable[..., Outcome]
) -> None:
    path = write(case=short, model="dem", samples=2)
    outcome = command("montecarlo", path.name)
    assert outcome.status == 0 and outcome.errors == "", outcome.errors
    folder = tmp_path / "results" / "trial"
    figures = [f"{name}.{kind}" for name in ("distributions", "correlations") for kind in ("png", "svg")]
    for name in ("summary.md", "run.json", *figures):
        assert (folder / name).stat().st_size > 100, name
    assert json.loads((folder / "run.json").read_text())["largest_batch"] == 1
    rows = rows_of(folder)
    reduced = load_campaign(write(case=short, samples=2), MONTECARLO)
    for index, row in enumerate(rows):
        sample = work.run_sample(reduced, index)
        exact = dict(zip(reduced.units, sample.values))
        for name, tolerance in (("state_jump_m", 0.005), ("friction_dissipation_J", 0.05)):
            assert float(row[name]) == pytest.approx(exact[name], rel=tolerance), name

    dem = load_campaign(write(case=short, model="dem", samples=2), MONTECARLO)
    write_table(dem, tmp_path / "samples.table")
    lines = (tmp_path / "samples.table").read_text().splitlines()
    assert len(lines) == 4
    assert lines[1].split() == [
        "description", "campaign", "command", "sample", "joint__friction_coefficient", "joint__clearance_plus_m"
    ]
    done = subprocess.run(
        [yade, "-n", "-x", str(REPOSITORY / "yade_scripts" / "runner" / "batch_case.py")], cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": str(BUILT), "YADE_BATCH": "samples.table:4"}, stdin=subprocess.DEVNULL,
        capture_output=True, text=True, timeout=120,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    found = json.loads((tmp_path / "samples.table.sample_1.outcomes.json").read_text())
    # The very numbers of the campaign.
    assert [repr(found[name]) for name in dem.units] == [rows[1][name] for name in dem.units]


def test_largest_force_is_that_of_the_whole_path(write: Callable[..., Path]) -> None:
    from statejump.kinds.loading import parse_case
    from statejump.kinds.spring_slider import reduced

    campaign = load_campaign(write(), MONTECARLO)
    for index in range(50):
        case = parse_case(campaign.data(index))
        path = reduced.solve(case)
        dense = path.sample(np.linspace(0, 1, 20_001))
        found = dict(zip(campaign.units, work.run_sample(campaign, index).values))
        largest = float(np.max(np.abs(dense["axial_force_N"])))
        assert largest <= found["largest_axial_force_N"] * (1 + 1e-12)
        assert found["largest_axial_force_N"] == pytest.approx(largest, rel=1e-3)
        assert found["friction_dissipation_J"] == pytest.approx(dense["friction_dissipation_J"][-1], rel=1e-12)


def test_umbrella_in_either_model(tmp_path: Path, cases: Path, write: Callable[..., Path]) -> None:
    text = (cases / "umbrella_damped.toml").read_text()
    for old, new in (("100000", "20000"), ("400000", "100000")):
        text = text.replace(f"steps_per_cycle = {old}", f"steps_per_cycle = {new}")
    (tmp_path / "rib.toml").write_text(text)
    expansion = ('[[vary]]\nkey = "link_ab.thermal_expansion_per_K"\nalso = ["link_bc.thermal_expansion_per_K"]\n'
                 'distribution = "truncated_normal"\nrelative = 0.1\nlow = 0\n')
    found = {}
    for model in ("reduced", "dem"):
        campaign = load_campaign(write(expansion, case="rib.toml", model=model, samples=1), MONTECARLO)
        sample = work.run_sample(campaign, 0)
        assert sample.error == ""
        found[model] = dict(zip(campaign.units, sample.values))
    exact = 1e-4 / (campaign.values(0)[0] * 0.12)  # c / (alpha |AC|)
    for values in found.values():
        assert values["first_contact_temperature_change_K"] == pytest.approx(exact, abs=0.01)
    for name in ("theta2_range_rad", "theta4_range_rad"):
        assert found["dem"][name] == pytest.approx(found["reduced"][name], rel=0.01)


def test_a_cluster_of_ones_own_leaves_no_thread_and_no_open_file() -> None:
    """The first cluster loads modules that stay loaded."""
    case = sj.load("table1")

    def left() -> tuple[int, int]:
        gc.collect()
        return threading.active_count(), len(os.listdir("/proc/self/fd"))

    counts = []
    for friction in (0.1, 0.2):
        sj.sweep(case, {"joint.friction_coefficient": [friction, 0.3]}, workers=2)
        counts.append(left())
    assert counts[1] == counts[0]
