# SPDX-License-Identifier: GPL-3.0-or-later
"""The study of ribs that bend: its models against closed forms, and its page against its runs."""
from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import statejump as sj
from studies.paper import bending_ribs as study

PAGE = Path(__file__).resolve().parents[2] / "results" / "umbrella_bending" / "README.md"


def test_a_gradient_bows_a_rib_as_its_closed_form() -> None:
    """Without friction and with a soft spring, a rib carries no moment. Its bow is κ L²/8 with κ = α ΔT'/h."""
    made = study.document("outside", friction=0.0, stiffness=1e-3)
    names = [one["name"] for one in made["node"]]
    found = sj.load(made).reduced()
    hottest = int(np.argmax(found["temperature_change_K"]))
    at = np.array([one["position_m"] for one in made["node"]]) + found.history["displacement_m"].values[hottest][:, :2]
    for rib, first, last, length, side in (("AB", "A", "B", 0.05, 1.0), ("CB", "C", "J", 0.1, -1.0)):
        along = at[names.index(last)] - at[names.index(first)]
        middle = at[names.index(f"{rib}{study.PARTS // 2}")] - at[names.index(first)]
        bow = (along[0] * middle[1] - along[1] * middle[0]) / np.linalg.norm(along)
        curvature = 2.375e-5 * study.GRADIENT * 100.0 / study.SIDE_M
        assert bow == pytest.approx(side * curvature * length**2 / 8, rel=1e-2)  # expansion of the length, spring


def test_ribs_of_great_bending_stiffness_are_straight() -> None:
    """Beams with the paper's E A and a thousand times its E I move as links do."""
    made = study.document("bends", parts=2)
    for beam in made["beam"]:
        beam |= {"shape": "general", "cross_section_area_m2": 9e-6, "second_moments_of_area_m4": [6.75e-9, 6.75e-9]}
        del beam["dimensions_m"]
    stiff, straight = (sj.load(one).reduced() for one in (made, study.document("straight")))
    for name in ("B", "J"):
        own, other = (run["displacement_m"][:, [node["name"] for node in of["node"]].index(name)]
                      for run, of in ((stiff, made), (straight, study.document("straight"))))
        assert np.abs(own[-1] - other[-1]).max() < 1e-3 * np.abs(other).max()
    assert np.abs(straight["displacement_m"][-1] - straight["displacement_m"][0]).max() > 1e-6


@pytest.mark.parametrize("model", study.MODELS)
def test_the_page_has_the_jumps_of_the_models(model: str) -> None:
    path = study.run(model)
    lines = study.table("figure", ["13"], [{model: path}])
    assert lines[-1] in PAGE.read_text(encoding="utf-8").splitlines()
