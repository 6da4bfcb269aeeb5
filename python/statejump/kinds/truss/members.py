# SPDX-License-Identifier: GPL-3.0-or-later
"""Warnings for links whose axial force exceeds Euler's load or the yield strength.

Both models keep links straight and elastic at any force. Springs and cables have no section and are not checked.
"""
from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from statejump.core.units import plain
from statejump.kinds.truss.resolved import Links


def warnings(links: Links, time_s: np.ndarray, temperature_change_K: np.ndarray, axial_force_N: np.ndarray
             ) -> tuple[str, ...]:
    """Return one sentence on buckling and one on yielding, each for the worst link.

    :param axial_force_N: (times, links), compression positive
    """
    if not axial_force_N.size:
        return ()
    places = np.arange(len(links.names))

    def sentence(at: np.ndarray, load: np.ndarray, parts: Sequence[str]) -> list[str]:
        """Return the sentence about links whose load ratio exceeds 1 at these samples. ``parts``: load of the worst
        link, exceeded limit, behaviour of the models."""
        beyond = np.flatnonzero(load > 1)
        if not len(beyond):
            return []
        worst = int(np.argmax(load))
        more = len(beyond) - 1
        others = "" if not more else f", and so {'does 1 other link' if more == 1 else f'do {more} other links'}"
        when = (f"at a temperature change of {plain(float(temperature_change_K[at[worst]]), 'K', 4)} "
                f"(t = {plain(float(time_s[at[worst]]), 's', 4)})")
        return [f"link {links.names[worst]!r} {parts[0]} {when} {parts[1]}{others}: {parts[2]}"]

    pressed = np.argmax(axial_force_N, axis=0)
    compression, euler = axial_force_N[pressed, places], links.euler_load_N
    worst = int(np.argmax(compression / euler))
    found = sentence(pressed, compression / euler, (
        f"is compressed by {plain(float(compression[worst]), 'N', 4)}",
        f"beyond its Euler load of {plain(float(euler[worst]), 'N', 4)} ({links.ends[worst].replace('_', '-')}, I = "
        f"{links.second_moment_of_area_m4[worst]:.4g} m4)", "the models keep links straight"))
    loaded = np.argmax(np.abs(axial_force_N), axis=0)
    stress = np.abs(axial_force_N[loaded, places]) / links.cross_section_area_m2
    worst = int(np.argmax(stress / links.yield_strength_Pa))
    return (*found, *sentence(loaded, stress / links.yield_strength_Pa, (
        f"is stressed by {plain(float(stress[worst]), 'Pa', 4)}",
        f"beyond its yield strength of {plain(float(links.yield_strength_Pa[worst]), 'Pa', 4)}",
        "the models keep links elastic")))
