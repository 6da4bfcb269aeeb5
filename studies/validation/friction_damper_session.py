# SPDX-License-Identifier: GPL-3.0-or-later
"""Measured friction damper with backlash: identified in one session, other amplitudes and speeds in another session."""
from __future__ import annotations

from loops import blind, read
from manual import MEASUREMENT, Curve, Entry, Picture, show

import numpy as np

import statejump as sj
from statejump.identification.result import Identification

# Amplitude [mm] and energy loss of the second, third and fourth whole cycle [J] of the later session, by frequency.
LATER = {"0.25 Hz": ((12.83, (414.4, 407.4, 400.6)), (25.53, (941.7, 948.3, 947.5)), (38.30, (1549.4, 1538.3, 1528.1))),
         "0.5 Hz": ((12.81, (396.2, 389.3, 392.9)), (25.58, (953.4, 953.5, 954.0)), (38.37, (1565.7, 1566.6, 1568.1))),
         "1 Hz": ((12.85, (390.6, 388.5, 408.9)), (25.66, (906.1, 903.7, 912.3)), (36.61, (1392.0, 1424.7, 1411.7)))}


def identified() -> Identification:
    """Return the joint of the loop of 0.5 Hz and 25 mm."""
    data = read("friction_damper.csv")
    return sj.identify({"displacement_m": data["displacement_m"], "force_N": data["force_N"]},
                       model=["coulomb_play", "coulomb_soft_play"])


def cycle(found: Identification, amplitude_mm: float) -> tuple[float, float]:
    """Return energy loss of one cycle and half of the width of its interval [J]."""
    path = 1e-3 * amplitude_mm * np.sin(np.linspace(0, 4 * np.pi, 1601))
    two = found.predict(path)
    first = found.predict(path[:801])
    return two.loss_J - first.loss_J, two.loss_error_J * (1 - first.loss_J / two.loss_J)


def entry() -> Entry:
    found = identified()
    rows = []
    for frequency, tests in LATER.items():
        for amplitude, losses in tests:
            ours, half = cycle(found, amplitude)
            measured = float(np.mean(losses))
            rows.append(blind(f"loss of a cycle, {amplitude:g} mm, {frequency}", "J", measured, ours, half))
    sweep = [5.0 * k for k in range(1, 9)]
    return Entry(
        name="friction_damper_session", part="Joints from tests",
        title="Friction damper with backlash: one session identified, another predicted", kind=MEASUREMENT,
        source="ARTS-Laboratory/Dataset-Friction-Damper-with-Backlash 0e09aa9d, dataset 2, 0.5 Hz, 30 lb, 1 in "
        "(identified) and dataset 3, 30 lb, 0.5 to 1.5 in, 0.25 to 1 Hz (predicted) (CC BY-SA 4.0); the losses are "
        "integrals of F du over cycles of dataset 3",
        uncertainty="cycles of one test differ by up to 5 %, speeds by up to 10 %; the source does not say what was "
        "changed between the sessions",
        statement="The damper of the entry friction_damper is identified from one loop of ±25 mm at 0.5 Hz. In a later "
        "session it moved by ±13, ±25 and ±38 mm at 0.25, 0.5 and 1 Hz. Predict the energy loss of a cycle.",
        tolerance=0.1, reason="prediction interval at 95 % of the identified loop", rows=rows,
        picture=Picture("amplitude [mm]", "loss of a cycle [J]", [
            Curve("predicted", sweep, [cycle(found, amplitude)[0] for amplitude in sweep]),
            Curve("measured", [amplitude for tests in LATER.values() for amplitude, _ in tests],
                  [float(np.mean(losses)) for tests in LATER.values() for _, losses in tests], ours=False)]),
        verdict="The predicted losses are 5 to 14 % too small, 10 % on average; three of nine are outside. Split of "
        "the cause: a common factor of 0.90 explains all but 3 % (standard deviation), which is within the interval. "
        "Amplitude and speed are therefore predicted; the friction of the later session is higher. One loop cannot "
        "show how a joint changes between sessions: its interval holds for the same mounting.")


if __name__ == "__main__":
    show(entry())
