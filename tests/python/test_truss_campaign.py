# SPDX-License-Identifier: GPL-3.0-or-later
"""Campaigns of trusses: joints or other items that vary together or one by one, and resumed campaigns."""
from __future__ import annotations

from pathlib import Path
from typing import Callable

import numpy as np
import pytest

from failures import Failure, failing, failure
from statejump.campaign import execute, journal, tables, work
from statejump.campaign.campaign_file import load_campaign
from statejump.campaign.plan import MONTECARLO, SWEEP, Plan
from statejump.campaign.sampling import montecarlo_draws
from statejump.core.errors import StatejumpError

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
def campaign(tmp_path: Path, cases: Path) -> Callable[..., Plan]:
    def load(*vary: str, samples: int = 12, case: str = "iwan_10", command: str = MONTECARLO) -> Plan:
        path = tmp_path / "trial.toml"
        text = CAMPAIGN.format(case=cases / "trusses" / f"{case}.toml", samples=samples)
        if command == SWEEP:
            text = "\n".join(line for line in text.splitlines() if not line.startswith(("samples", "seed"))) + "\n"
        path.write_text(text + "".join(vary))
        return load_campaign(path, command)

    return load


def test_every_item_is_drawn_on_its_own(campaign: Callable[..., Plan]) -> None:
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


def test_sweep_of_all_items(campaign: Callable[..., Plan]) -> None:
    trial = campaign('[[vary]]\nkey = "slider.*.friction_coefficient"\nvalues = [0.1, 0.2]\n', command=SWEEP)
    assert {slider["friction_coefficient"] for slider in trial.data(1)["slider"]} == {0.2}
    jumps = [dict(zip(trial.units, work.run_sample(trial, index).values)) for index in (0, 1)]
    # The strongest block does not return: its share of the jump is proportional to friction.
    assert jumps[1]["largest_node_jump_m"] > jumps[0]["largest_node_jump_m"] > 0
    assert jumps[0]["slipping_joints"] == 10 and "reflector_rms_error_m" not in jumps[0]


@pytest.mark.parametrize("text, sentence", [
    (FRICTION.replace("slider.*", "slider.S99"), failure("item_not_in_case", item="vary[1]", key="key", value="slider.S99.friction_coefficient", table="slider", name="S99")),
    (FRICTION.replace("slider.*", "revolute.*"), failure("section_not_in_case", item="vary[1]", key="key", value="revolute.*.friction_coefficient", table="revolute")),
    (FRICTION.replace("*.friction_coefficient", "*.friction"), failure("key_not_in_kind", item="vary[1]", key="key", value="slider.*.friction", kind="truss")),
    (FRICTION + FRICTION.replace("*", "S1"), failure("duplicate_vary", item="vary[2]", key="key", value="slider.S1.friction_coefficient")),
    (FRICTION.replace("slider.*.friction_coefficient", "slider.*.clearance_plus_m"), failure("mean_not_in_case", key="mean")),
    (FRICTION + 'also = ["link.*.young_modulus_Pa"]\n', failure("items_share_values", item="vary[1]", key="also", value="link.*.young_modulus_Pa", main="slider.*.friction_coefficient")),
])
def test_mistakes_in_a_campaign(campaign: Callable[..., Plan], text: str, sentence: Failure) -> None:
    with pytest.raises(StatejumpError) as caught:
        campaign(text)
    assert caught.value == sentence


def test_no_dem_campaign(campaign: Callable[..., Plan]) -> None:
    with failing("model_not_of_kind", key="campaign.model", value="dem", kind="truss", models="model = 'reduced'"):
        campaign('model = "dem"\n' + FRICTION)


def test_half_a_campaign_resumed(tmp_path: Path, campaign: Callable[..., Plan]) -> None:
    """A campaign's journal with half of the samples and a torn last line, as after a kill, gives the same bytes when
    resumed."""
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
