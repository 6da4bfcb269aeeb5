# SPDX-License-Identifier: GPL-3.0-or-later
"""Joints of a truss in YADE: one file per joint type that the DEM supports, used by ``scene_truss``.

``statejump.kinds.truss.joints`` declares the joint types of all models and rejects those that the DEM lacks.
"""
from truss_joints.ball_joint import BallJoints
from truss_joints.latch_hinge import LatchHinges
from truss_joints.parts import Joints
from truss_joints.revolute import Revolutes
from truss_joints.slider import Sliders

# In the order of statejump.kinds.truss.joints, which is that of the contacts of a result.
JOINTS: tuple[type[Joints], ...] = (Sliders, Revolutes, LatchHinges, BallJoints)
