# SPDX-License-Identifier: GPL-3.0-or-later
"""Thermal growth of the parts of a scene."""
from __future__ import annotations

from typing import Any

import numpy as np

from statejump.results.contents import Result
from statejump.results.scene import resolve


def growth(part: dict[str, Any], result: Result, model: str) -> np.ndarray:
    """Return 1 + thermal strain of a part over the samples: factor of its radii and dimensions."""
    run = result.models[model]
    change = resolve(part.get("temperature_change_K", result.scene["temperature_change_K"]), run, result.names)
    return 1 + part.get("thermal_expansion_per_K", 0.0) * change
