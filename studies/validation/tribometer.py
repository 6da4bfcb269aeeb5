# SPDX-License-Identifier: GPL-3.0-or-later
"""Measured reciprocating tribometer: identified on one half, predicted on the other."""
from __future__ import annotations

from loops import blind, loss, read
from manual import MEASUREMENT, Curve, Entry, Picture, Row, show

import numpy as np

import statejump as sj

NORMAL_N, SPLIT_S = 5.0, 58.0


def entry() -> Entry:
    data = read("tribometer.csv")
    moved, force, first = data["displacement_m"], data["force_N"], data["time_s"] < SPLIT_S
    found = sj.identify({"displacement_m": moved[first], "force_N": force[first]}, model=["coulomb", "coulomb_spring"],
                        normal_force_N=NORMAL_N)
    prediction, last = found.predict(moved), ~first
    guess, ours = prediction.force, found.predict(moved[last])
    sliding = np.abs(force[last]) > 0.5 * np.abs(force[last]).max()
    rows = [
        blind("energy loss of the second half", "mJ", 1e3 * loss(force[last], moved[last]), 1e3 * ours.loss_J,
              1e3 * ours.loss_error_J),
        Row("rows of the second half within the predicted interval", "1", 0.95,
            float(np.mean(np.abs(guess - force)[last] <= prediction.force_error)), low=0.90, high=1.0),
        Row("mean friction while it slides, second half", "N", float(np.abs(force[last][sliding]).mean()),
            float(np.abs(guess[last][sliding]).mean())),
        Row("force, rms difference in the second half", "N", 0.0, float(np.sqrt(np.mean((guess - force)[last] ** 2))),
            scale=float(np.abs(force[last]).max()), tolerance=0.06)]
    at = slice(int(np.argmax(last)), int(np.argmax(last)) + 130)
    return Entry(
        name="tribometer", part="Joints from tests", title="Reciprocating tribometer: half identified, half predicted",
        kind=MEASUREMENT, source="jchristopherson/FrictionModels.jl e60a4bd2, examples/test_data_2.txt (MIT), the "
        "first half of the record", uncertainty="normal force 5.000 ± 0.002 N; force noise 0.01 N; friction changes "
        "from stroke to stroke by 5 %",
        statement="A pin rubs to and fro on a plate, ±0.12 mm under 5 N. The friction and stiffness of the joint are "
        "identified from 48 s. Predict force and energy loss of the following 48 s.", tolerance=0.03,
        reason="change of friction from stroke to stroke", rows=rows,
        picture=Picture("displacement [mm]", "force [N]", [
            Curve("predicted", 1e3 * moved[at], guess[at]), Curve("measured", 1e3 * moved[at], force[at], ours=False)]),
        verdict="Coulomb's law with one stiffness predicts loss and friction of the second half. It does not have the "
        "rise of friction at the start of a stroke, which is the rms difference.")


if __name__ == "__main__":
    show(entry())
