# SPDX-License-Identifier: GPL-3.0-or-later
"""Loops of known joints with noise, as a rig measures them."""
from __future__ import annotations

import numpy as np

from statejump.identification.loop import read_loop
from statejump.identification.models import MODELS

SINE = 1e-3 * np.sin(np.linspace(0, 4 * np.pi, 401))
JOINT = {"stiffness": 1e6, "friction": 150.0, "preload": 20.0, "clearance_minus": 3e-4, "clearance_plus": 5e-4,
         "preload_stiffness": 2e5, "play": 4e-4, "play_ratio": 0.2, "stop_stiffness": 2e6}
SIGMA = 5.0


def measured(model: str, values: dict[str, float], noise: float = SIGMA, seed: int = 1) -> dict[str, np.ndarray]:
    loop = read_loop({"displacement_m": SINE, "force_N": SINE}, "cycled")
    own = {name: values[name] for name in MODELS[model].parameters}
    force = MODELS[model].answer(own, SINE, loop.memory)
    return {"displacement_m": SINE, "force_N": force + np.random.default_rng(seed).normal(0, noise, len(SINE))}
