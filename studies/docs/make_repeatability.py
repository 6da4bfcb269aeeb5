# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes the table of docs/howto/surface.md: repeatability of an umbrella with eight ribs over the days of its history.

PYTHONPATH=build/python /usr/bin/python3 studies/docs/make_repeatability.py [--samples N]
"""
from __future__ import annotations

import argparse

import numpy as np

import statejump as sj

CASE, OUTPUT = "trusses/umbrella_8", "repeat:displacement_m[B1]"
DAYS = {  # peak temperature changes [K]; between peaks the change is 0
    "hot days, one like the other": (100, 100, 100, 100),
    "hot days, warm days": (100, 60, 100, 60),
    "hot days, cold days": (100, -80, 100, -80),
}
TOLERANCES = {  # as made: every joint on its own
    "revolute.*.radial_clearance_m": {"distribution": "truncated_normal", "relative": 0.1, "low": 5e-5, "high": 1.5e-4},
    "revolute.*.friction_coefficient": {"distribution": "lognormal", "relative": 0.2},
}


def days(peaks_K: tuple[int, ...]) -> sj.Case:
    """Return the umbrella with a program of days with the given peak temperatures, one second each."""
    changes = [0, *(change for peak in peaks_K for change in (peak, 0))]
    return sj.load(CASE).changed({
        "thermal.shape": "table", "thermal.temperature_change_max_K": None, "thermal.period_s": None,
        "thermal.cycles": 1, "thermal.table_temperature_change_K": changes,
        "thermal.table_time_s": [0.5 * i for i in range(len(changes))]})


def main() -> None:
    """Sample, print the table."""
    options = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    options.add_argument("--samples", type=int, default=400)
    samples = options.parse_args().samples
    aperture_m = 2 * sj.surface.reflector_of(sj.load(CASE))[0].aperture_m[1]
    print("| days | jump, median [µm] | median [µm/m] | 99 % [µm/m] (interval at 95 %) |\n|---|--:|--:|--:|")
    for name, peaks in DAYS.items():
        drawn = sj.montecarlo(days(peaks), TOLERANCES, samples=samples, outputs=[OUTPUT]).frame()
        change_m = drawn[OUTPUT].to_numpy()
        at = sj.surface.repeatability(change_m, aperture_m)
        jump_m = drawn["largest_node_jump_m"].median()
        print(f"| {name} | {1e6 * jump_m:.3g} | {1e6 * np.median(change_m) / aperture_m:.2g} | "
              f"**{at.um_per_m:.3g}** ({at.low:.3g} to {at.high:.3g}) |")


if __name__ == "__main__":
    main()
