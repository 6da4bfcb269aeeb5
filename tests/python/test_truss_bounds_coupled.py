# SPDX-License-Identifier: GPL-3.0-or-later
"""Coulomb contacts with coupled normal and tangential stiffness: a settled state does not prove that starts settle.

After Klarbring, Ciavarella, Barber, Int. J. Solids Struct. 44 (2007) 8355: in two coupled contacts a shakedown state
exists, but some starts slip for ever. Such a system must not be certified to settle.
"""
from __future__ import annotations

import numpy as np
import pytest

from statejump.kinds.truss.bounds.clearance_verdict import Stuck, judged, settling
from statejump.kinds.truss.bounds.ranges import Temperatures
from statejump.kinds.truss.bounds.sliding import Joint

SWEEPS = 200  # of the contacts in a step
STEPS = 60  # of a leg between two corners of the temperatures
CORNERS = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
RANGE = Temperatures("two temperatures", np.eye(2), np.zeros(2), np.ones(2))


def contacts(stiffness: np.ndarray, loads: np.ndarray, normal_N: np.ndarray, coefficient: float) -> Stuck:
    """Return two contacts: forces (λ1, λ2, f1, f2) = (λ0, 0) + loads T − stiffness (0, 0, p1, p2)."""
    by = -stiffness[:, 2:]
    return Stuck([Joint("revolute", "1"), Joint("revolute", "2")], np.full(2, coefficient), np.zeros(0), normal_N,
                 np.zeros(2), loads[:2], loads[2:], by[:2], by[2:])


def slid(of: Stuck, slips: np.ndarray, temperature: np.ndarray) -> np.ndarray:
    """Return the slips after a step that ends at a temperature."""
    p = slips.copy()
    for _ in range(SWEEPS):
        moved = 0.0
        for one in range(2):
            f = of.friction_N[one] + of.friction_by_K[one] @ temperature + of.friction_by_slip[one] @ p
            normal = of.normal_N[one] + of.normal_by_K[one] @ temperature + of.normal_by_slip[one] @ p
            assert normal > 0
            for sign in (1.0, -1.0):
                excess = sign * f - of.coefficient[one] * normal
                if excess > 0:
                    slope = sign * of.friction_by_slip[one, one] - of.coefficient[one] * of.normal_by_slip[one, one]
                    p[one] -= excess / slope
                    moved = max(moved, abs(excess / slope))
        if moved < 1e-13:
            break
    return p


def slip_of_cycle(of: Stuck, start: np.ndarray, cycles: int) -> float:
    """Return the sum of slips in the last of some cycles around the corners of the temperatures."""
    p, total = start.copy(), 0.0
    for _ in range(cycles):
        total = 0.0
        for corner, after in zip(CORNERS, np.roll(CORNERS, -1, axis=0)):
            for share in np.linspace(1 / STEPS, 1, STEPS):
                before, p = p, slid(of, p, corner + share * (after - corner))
                total += float(np.abs(p - before).sum())
    return total


# Slip of the second contact raises the normal force of the first one by 0.4 p2; temperature shears only the first one.
COUPLED = np.eye(4)
COUPLED[0, 3] = COUPLED[3, 0] = -0.4
SHEAR = np.array([[0.0, 0.0], [0.0, 0.0], [1.2, 0.0], [0.0, 0.0]])
NORMAL_N, COEFFICIENT = np.array([1.0, 5.0]), 0.5


def test_a_settled_state_exists_but_some_starts_slip_for_ever() -> None:
    of = contacts(COUPLED, SHEAR, NORMAL_N, COEFFICIENT)
    # The first contact settles if the range of its friction, 1.2, is at most 2 μ λ1 = 1 + 0.4 p2.
    assert slip_of_cycle(of, np.array([0.0, 0.0]), 10) == pytest.approx(2 * 0.2, rel=1e-6)
    assert slip_of_cycle(of, np.array([0.0, 0.7]), 10) == 0.0
    # The second contact holds slips up to μ λ2 = 2.5.
    assert settling(of, RANGE)[0] == pytest.approx((1 + 0.4 * 2.5) / 1.2, rel=1e-6)


@pytest.mark.parametrize("least_N", [None, np.array([0.0, 5.0]), np.array([0.9, 5.0])])
def test_such_contacts_are_not_certified(least_N: np.ndarray | None) -> None:
    found = judged(contacts(COUPLED, SHEAR, NORMAL_N, COEFFICIENT), RANGE, least_N)
    assert found.kind == "unknown" and not found.certified and found.factor > 1
    assert "some starts may slip for ever" in found.text


def test_with_enough_least_force_they_are_estimated_to_settle() -> None:
    of = contacts(COUPLED, SHEAR, np.array([2.5, 5.0]), COEFFICIENT)
    assert judged(of, RANGE, np.array([1.3, 5.0])).kind in ("settles", "never_slips")
    for second in np.linspace(-2.4, 2.4, 5):
        assert slip_of_cycle(of, np.array([0.0, second]), 4) < 1e-9
