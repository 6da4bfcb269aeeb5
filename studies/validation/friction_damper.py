# SPDX-License-Identifier: GPL-3.0-or-later
"""Measured banded friction damper with backlash: identified on one half, predicted on the other."""
from __future__ import annotations

from loops import blind, loss, read
from manual import MEASUREMENT, Curve, Entry, Picture, Row, show

import numpy as np

import statejump as sj

SPLIT_S = 7.0


def entry() -> Entry:
    data = read("friction_damper.csv")
    moved, force, first = data["displacement_m"], data["force_N"], data["time_s"] < SPLIT_S
    found = sj.identify({"displacement_m": moved[first], "force_N": force[first]},
                        model=["coulomb_play", "coulomb_soft_play"])
    prediction, last = found.predict(moved), ~first
    guess, ours = prediction.force, found.predict(moved[last])
    rows = [
        blind("energy loss of the second half", "kJ", loss(force[last], moved[last]) / 1e3, ours.loss_J / 1e3,
              ours.loss_error_J / 1e3),
        Row("rows of the second half within the predicted interval", "1", 0.95,
            float(np.mean(np.abs(guess - force)[last] <= prediction.force_error)), low=0.90, high=1.0),
        Row("force, rms difference in the second half", "kN", 0.0,
            float(np.sqrt(np.mean((guess - force)[last] ** 2))) / 1e3,
            scale=float(np.abs(force[last]).max()) / 1e3, tolerance=0.08),
        Row("play between ±30 % of the friction", "mm", 5.4, 1e3 * found.values["play"], tolerance=0.06)]
    return Entry(
        name="friction_damper", part="Joints from tests", title="Friction damper with backlash: half identified, half "
        "predicted",
        kind=MEASUREMENT, source="ARTS-Laboratory/Dataset-Friction-Damper-with-Backlash 0e09aa9d, loop of 0.5 Hz, 30 "
        "lb, 1 in (CC BY-SA 4.0); play: path between ±30 % of the friction in the same loop",
        uncertainty="friction changes along a stroke by 10 %",
        statement="A banded rotary friction damper is driven by ±25 mm. At each reversal it moves through its backlash "
        "before it resists. Stiffness, friction and play are identified from 7 s. Predict the next 7 s.",
        tolerance=0.05,
        reason="change of friction along a stroke", rows=rows,
        picture=Picture("displacement [mm]", "force [kN]", [
            Curve("predicted", 1e3 * moved[last], guess[last] / 1e3),
            Curve("measured", 1e3 * moved[last][::6], force[last][::6] / 1e3, ours=False)]),
        verdict="Friction with a lost motion that moves with the slide predicts the loss of the second half. Measured "
        "peaks at the ends of strokes are not in the law.")


if __name__ == "__main__":
    show(entry())
