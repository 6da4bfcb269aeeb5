# SPDX-License-Identifier: GPL-3.0-or-later
"""Structures whose contacts open and close within time steps that are long compared with the motion between contacts.
"""
from __future__ import annotations

import numpy as np
import pytest

import statejump as sj
from statejump.core.errors import MissingKey, StatejumpError

import structures


def test_parts_without_number_end_by_name() -> None:
    """Contacts of this umbrella rattle during the whole heating."""
    restless = sj.load(structures.make("umbrella", 530).document).changed({"motion.steps_per_cycle": 6000})
    with pytest.raises(StatejumpError) as caught:
        restless.reduced(dynamic=True)
    assert caught.value.code == "too_many_steps" and "motion.steps_per_cycle" in caught.value.remedy


@pytest.mark.parametrize(("family", "seed"), [("pratt", 501), ("umbrella", 511)])
def test_lost_contacts_make_no_energy(family: str, seed: int) -> None:
    """The work of loads and temperature plus the elastic energy exceeds the losses plus the kinetic energy."""
    run = sj.load(structures.make(family, seed).document).reduced(dynamic=True)
    # Works have changing signs.
    given = np.abs(np.diff(run["thermal_work_J"])).sum() + np.abs(np.diff(run["external_work_J"])).sum()
    lost = run["damping_dissipation_J"][-1] + run["friction_dissipation_J"][-1] + run["kinetic_energy_J"].max()
    assert lost < given + run["elastic_energy_J"].max()


def test_node_without_mass_is_refused() -> None:
    """Only a pin holds the last node of this chain: no link ends there."""
    with pytest.raises(MissingKey) as caught:
        sj.load(structures.make("chain", 20004).document).reduced(dynamic=True)
    assert caught.value.code == "mass_of_moving_node_missing" and "'N8'" in str(caught.value)
