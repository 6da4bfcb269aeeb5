# SPDX-License-Identifier: GPL-3.0-or-later
"""Curves of a ``spring_slider`` case on the page of ``statejump report``."""
from __future__ import annotations

from statejump.core.charts import TEMPERATURE, TIME, Axis, Chart
from statejump.kinds.spring_slider.case import SpringSliderCase


def charts(case: SpringSliderCase) -> list[Chart]:
    """Return displacement and axial force over temperature and over time."""
    displacement, force = Axis("displacement_m"), Axis("axial_force_N")
    return [
        Chart(TEMPERATURE, displacement, "Displacement-temperature loop", marks=True),
        Chart(TEMPERATURE, force, "Force-temperature loop", marks=True),
        Chart(TIME, displacement, "Displacement over time", stages=True),
        Chart(TIME, force, "Axial force over time", stages=True),
    ]
