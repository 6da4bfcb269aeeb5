# SPDX-License-Identifier: GPL-3.0-or-later
"""Everything that the verdicts are computed from."""
from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from studies.paper.claims.statistics import Groups, TwoSampleTest


@dataclass(frozen=True)
class FirstContact:
    """ΔT [K] of first contact at one clearance, for links without initial vibration; None: no contact occurs."""

    clearance_m: float
    closed_form_K: float | None
    reduced_K: float | None
    dem_K: float | None
    reduced_ringing_K: float | None = None  # of the paper's start from rest
    dem_ringing_K: float | None = None


@dataclass(frozen=True)
class Envelope:
    """Range of θ2 over all runs of one kind, and the range that the clearance allows at the same temperature."""

    runs: str
    count: int
    largest_excess_rad: float  # excess over rigid links with |d| = c; negative: distance to it
    margin_m: float  # increase of |d| [m] for elongation of the links and depth of the contact
    beyond_margin: int  # samples outside of that


CHAOTIC = 1e6  # growth of a small difference above which another code cannot repeat a run


@dataclass(frozen=True)
class Amplification:
    """Two runs of the reduced model whose initial states differ in the direction of link AB."""

    start_rad: float
    at_largest_temperature_rad: float
    at_end_rad: float

    @property
    def is_chaotic(self) -> bool:
        """Whether the difference grows by more than ``CHAOTIC``."""
        return self.at_end_rad > CHAOTIC * self.start_rad


@dataclass(frozen=True)
class Findings:
    """Everything that the verdicts are computed from."""

    start_spread_m: float
    end_shift_reduced_m: np.ndarray  # displacement of the journal in its clearance from start to end, for every run
    end_shift_dem_m: np.ndarray
    first_contacts: tuple[FirstContact, ...]
    tolerance_reduced_K: float
    tolerance_dem_K: float
    onset_K: Groups  # ΔT of first deflection by clearance, from the paper's start; inf: θ2 never changes
    onset_dem_K: tuple[float, ...]
    clearance_limit_m: float  # clearance that the expansion of the links just closes; nan: no closed form
    range_by_friction: Groups
    jump_by_friction: Groups
    friction_coefficient: float  # of the case
    largest_by_spring: Groups
    jump_by_spring: Groups
    static_rigid_rad: float | None
    static_elastic_rad: tuple[float | None, ...]  # by stiffness of the spring
    jump_by_stiffness: Groups  # jumps by the section of the links, relative to that of the case
    free_turn_rad: float  # c/|AC|
    spring_bias_rad: float
    tests: tuple[TwoSampleTest, ...]
    envelopes: tuple[Envelope, ...]
    amplification: Amplification
    spring_stiffness_N_m_per_rad: float  # of the case
    damped: bool  # whether links and pins are damped, so that vibrations decay
    rings: bool  # whether the links start at rest and not with the velocity of their expansion
