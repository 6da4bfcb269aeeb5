# SPDX-License-Identifier: GPL-3.0-or-later
"""Hinge with friction between two beams under a gradient: the angle that stays."""
from __future__ import annotations

from manual import CLOSED_FORM, Entry, Row, node, show, truss


def entry() -> Entry:
    young, width, height, length, spring, friction = 70e9, 0.02, 0.01, 1.0, 40.0, 1.0
    beam = {"young_modulus_Pa": young, "shape": "rectangle", "dimensions_m": [height, width],
            "thermal_expansion_per_K": 23e-6, "temperature_fraction": 0.0, "gradient_per_m": [1 / height, 0.0]}
    case = truss("hinge_residual", [
        node("A", 0.0, 0.0, clamped=True), node("B", length, 0.0), node("C", length, 0.0),
        {**node("D", 2 * length, 0.0), "fixed_rotations": ["z"]}], 20.0,
        beam=[{"name": "AB", "nodes": ["A", "B"], **beam}, {"name": "CD", "nodes": ["C", "D"], **beam}],
        hinge=[{"name": "H", "nodes": ["B", "C"], "stiffness_N_m_per_rad": spring, "friction_moment_N_m": friction}])
    angle = abs(float(case.reduced()["beam_hinge_rotation_rad"][-1, 0]))
    # Both beams turn back until their moment (E I/2 L) φ and that of the spring are held by friction.
    exact = friction / (spring + young * width * height**3 / 12 / (2 * length))
    return Entry(
        name="hinge_residual", part="Beams and frames", title="Residual angle of a hinge with friction",
        kind=CLOSED_FORM,
        source="linear beam theory: φ = M_c/(K + E I/2L); the script evaluates it", uncertainty="exact",
        statement="Two beams of 1 m between a clamp and a guided clamp meet in a hinge with a spring of 40 N m/rad and "
        "friction of 1 N m. A gradient of 20 K over 10 mm comes and goes. Find the angle that stays.",
        case=case, tolerance=2e-4, reason="solver entries",
        rows=[Row("residual angle", "rad", exact, angle)], verdict="The hinge keeps the angle that friction holds.")


if __name__ == "__main__":
    show(entry())
