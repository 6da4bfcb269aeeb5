# SPDX-License-Identifier: GPL-3.0-or-later
"""Law of joints that rotate about an axis: free play, stiffness beyond it, friction and a preload moment."""
from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from math import inf
from typing import Any, ClassVar, Protocol, cast

import numpy as np

from statejump.kinds.truss.arrays import References, column
from statejump.kinds.truss.joints.protocol import ArraysType, ItemType, JointType, count, scaled, spread
from statejump.kinds.truss.resolved import ResolvedTruss

MOMENT = "against the rotation: preload, stiffness beyond the play, friction"


class Playing(Protocol):
    """Items with this law."""

    deadband_rad: float
    stiffness_N_m_per_rad: float
    friction_moment_N_m: float


class PlayingArrays(Protocol):
    """Arrays of these items."""

    names: Sequence[str]
    deadband_rad: np.ndarray
    stiffness_N_m_per_rad: np.ndarray
    friction_moment_N_m: np.ndarray
    friction_stiffness_N_m_per_rad: np.ndarray  # inf: neither given nor stiff beyond the play
    preload_moment_N_m: np.ndarray


class HingeLaw(JointType[ItemType, ArraysType]):
    """A joint type with this law; its columns are the rotation and the moment."""

    noun: ClassVar[str]  # for one of its items
    turns = True
    varied = ("deadband_rad", "stiffness_N_m_per_rad", "friction_moment_N_m", "preload_moment_N_m")

    def derived(self, items: Sequence[ItemType], known: References) -> dict[str, Any]:
        sticking = column(items, "friction_stiffness_N_m_per_rad")
        beyond = column(items, "stiffness_N_m_per_rad")
        return {"friction_stiffness_N_m_per_rad": np.where(
            np.isnan(sticking), np.where(beyond > 0, beyond, inf), sticking)}

    def engine_arrays(self, truss: ResolvedTruss, joints: ArraysType) -> dict[str, Any]:
        law = cast(PlayingArrays, joints)
        sticking = law.friction_stiffness_N_m_per_rad if truss.sticking != "rigid" else np.full(len(law.names), inf)
        return {"friction_stiffness_N_m_per_rad": sticking}

    def legend(self, joints: ArraysType) -> str:
        return f"{self.noun}, play ±{scaled(cast(PlayingArrays, joints).deadband_rad, 1e3, 'mrad')}"

    def describe(self, items: Sequence[ItemType]) -> str:
        hinges = cast("Sequence[Playing]", items)
        return (
            f"{count(items, self.noun)} with a free play of ±"
            f"{spread((hinge.deadband_rad for hinge in hinges), 'rad')}, "
            f"{spread((hinge.stiffness_N_m_per_rad for hinge in hinges), 'N m/rad')} beyond it, friction of "
            f"{spread((hinge.friction_moment_N_m for hinge in hinges), 'N m')}."
        )

    def friction_N_m(self, joints: ArraysType, state: Mapping[str, np.ndarray]) -> np.ndarray:
        """Return the friction moment [N m] of each joint in a state."""
        law = cast(PlayingArrays, joints)
        rotation, moment = (state[one.name] for one in self.columns)
        beyond = rotation - np.clip(rotation, -law.deadband_rad, law.deadband_rad)
        return np.asarray(moment - (law.preload_moment_N_m + law.stiffness_N_m_per_rad * beyond))

    def carried_friction(self, joints: ArraysType, at: Mapping[str, np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
        return np.abs(self.friction_N_m(joints, at)), cast(PlayingArrays, joints).friction_moment_N_m

    def without_friction(self, truss: ResolvedTruss) -> ResolvedTruss:
        joints = truss.joints[self.section]
        return truss.with_joints(**{self.section: replace(joints, friction_moment_N_m=0 * joints.friction_moment_N_m)})
