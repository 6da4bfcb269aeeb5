# SPDX-License-Identifier: GPL-3.0-or-later
"""Parameters of joints, links and elements that may affect a jump."""
from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from statejump.kinds.truss.elements import ELEMENTS
from statejump.kinds.truss.joints import JOINTS
from statejump.kinds.truss.resolved import ResolvedTruss


def parameters(truss: ResolvedTruss) -> list[tuple[str, str, np.ndarray]]:
    """Return section, key and values (items,) of every parameter that may affect a jump."""
    found = [(joint.section, key, values) for joint in JOINTS
             for key, values in joint.parameters(truss.joints[joint.section])]
    found += [("link", key, getattr(truss.links, key)) for key in ("young_modulus_Pa", "cross_section_area_m2")]
    return found + [(element.section, key, getattr(truss.elements[element.section], key)) for element in ELEMENTS
                    for key in element.varied]


def part_of(truss: ResolvedTruss, section: str) -> Any:
    """Return the arrays of a section."""
    return {**truss.joints, **truss.elements, "link": truss.links}[section]


def changed(truss: ResolvedTruss, section: str, key: str, factor: np.ndarray) -> ResolvedTruss:
    """Return the truss with one parameter of every item multiplied by a factor (items,)."""
    part = part_of(truss, section)
    part = replace(part, **{key: getattr(part, key) * factor})
    for element in ELEMENTS:
        if element.section == section:
            return truss.with_elements(**{section: element.changed(truss, part)})
    return truss.with_joints(**{section: part}) if section in truss.joints else replace(truss, links=part)
