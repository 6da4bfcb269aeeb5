# SPDX-License-Identifier: GPL-3.0-or-later
"""Parameters of the joint of an umbrella case for the curves of contact laws."""
from __future__ import annotations

from statejump.kinds.umbrella.case import UmbrellaCase
from statejump.laws.curves import Joint, reduced_mass_kg


def joint(case: UmbrellaCase) -> Joint:
    """Return the joint of a case."""
    return Joint(
        case.title, case.joint.journal_radius_m, case.bearing_radius_m, case.joint.contact_length_m,
        case.effective_young_modulus_Pa, reduced_mass_kg(case.link_ab.mass_kg, case.link_bc.mass_kg),
    )
