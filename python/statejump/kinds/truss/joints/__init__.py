# SPDX-License-Identifier: GPL-3.0-or-later
"""The types of joints of a truss, each in a file of its own; what a type brings, :mod:`.protocol` says."""
from __future__ import annotations

from typing import Any

from statejump.kinds.truss.joints.ball_joint import BALL_JOINT
from statejump.kinds.truss.joints.iwan_joint import IWAN_JOINT
from statejump.kinds.truss.joints.latch_hinge import LATCH_HINGE
from statejump.kinds.truss.joints.protocol import JointType
from statejump.kinds.truss.joints.revolute import REVOLUTE
from statejump.kinds.truss.joints.slider import SLIDER

# In the order in which results list them. A case has a list of each: statejump.kinds.truss.sections.TrussSections.
JOINTS: tuple[JointType[Any, Any], ...] = (SLIDER, REVOLUTE, LATCH_HINGE, IWAN_JOINT, BALL_JOINT)
