# SPDX-License-Identifier: GPL-3.0-or-later
"""Bounds of sliding in oblique impacts: Maw, Barber, Fawcett; Thornton."""
from __future__ import annotations

from manual import CLOSED_FORM, Entry, Row, show

from impact import Sphere, rebound

SPHERE = Sphere(208e9, 0.3, 7850.0, 0.1, 0.3)
SPEED = 5.0


def entry() -> Entry:
    kappa = (2 - SPHERE.poisson) / (2 * (1 - SPHERE.poisson))
    chi = 7 / (4 * kappa)
    unit = SPHERE.friction * kappa * SPEED
    rows = []
    for beyond in (0.1, 0.5, 3.0):
        before = 4 * chi - 1 + beyond
        found = rebound(SPHERE, "mindlin_deresiewicz", SPEED, before * unit)
        rows.append(Row(f"ψ₂ at ψ₁ = 4χ - 1 + {beyond:g}", "1", before - 4 * chi, found.contact_point / unit,
                        scale=before))
        rows.append(Row(f"spin at ψ₁ = 4χ - 1 + {beyond:g}, over 5 μ v/R", "1", -1.0,
                        found.spin * SPHERE.radius_m / (5 * SPHERE.friction * SPEED)))
    return Entry(
        name="thornton", part="Contact and laws", title="Oblique impacts that slide throughout (Maw, Thornton)",
        kind=CLOSED_FORM, source="N. Maw, J. R. Barber, J. N. Fawcett, Wear 38 (1976) 101-114; C. Thornton, rigid-body "
        "theory: ψ₂ = ψ₁ - 4χ, R ω = (5/2) μ (1 + e) v", uncertainty="exact",
        statement="A sphere hits a wall so obliquely that it slides during the whole impact. Find its spin and the "
        "velocity of the contact point, ψ = v_t/(μ κ v), κ = (2 - ν)/(2 (1 - ν)), χ = 7/(4 κ).",
        tolerance=2e-4, reason="steps of the driven contact", rows=rows,
        verdict="Beyond 4χ - 1 the sphere slides throughout, and its spin is that of rigid-body theory.")


if __name__ == "__main__":
    show(entry())
