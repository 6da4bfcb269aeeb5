# SPDX-License-Identifier: GPL-3.0-or-later
"""The registry of joint types, one file per type. :mod:`.protocol` documents joint types."""
from __future__ import annotations

from typing import Any, ClassVar

from statejump.kinds.truss.joints.ball_joint import BALL_JOINT, BallJoint
from statejump.kinds.truss.joints.hinge import HINGE, Hinge
from statejump.kinds.truss.joints.iwan_joint import IWAN_JOINT, IwanJoint
from statejump.kinds.truss.joints.latch_hinge import LATCH_HINGE, LatchHinge
from statejump.kinds.truss.joints.pad import PAD, Pad
from statejump.kinds.truss.joints.protocol import JointType
from statejump.kinds.truss.joints.revolute import REVOLUTE, Revolute
from statejump.kinds.truss.joints.rigid import RIGID, Rigid
from statejump.kinds.truss.joints.slider import SLIDER, Slider
from statejump.schema.fields import Section, definition, tables

# In the order of results. To add a type, add it to this tuple and to the lists.
JOINTS: tuple[JointType[Any, Any], ...] = (SLIDER, REVOLUTE, LATCH_HINGE, IWAN_JOINT, BALL_JOINT, RIGID, HINGE, PAD)


@definition
class JointLists(Section):
    """The lists of joints that a case has."""

    NAMED: ClassVar[bool] = True  # as the case that has them

    slider: list[Slider] = tables(Slider, "sections [[slider]]")
    revolute: list[Revolute] = tables(Revolute, "sections [[revolute]]")
    latch_hinge: list[LatchHinge] = tables(LatchHinge, "sections [[latch_hinge]]")
    iwan_joint: list[IwanJoint] = tables(IwanJoint, "sections [[iwan_joint]]")
    ball_joint: list[BallJoint] = tables(BallJoint, "sections [[ball_joint]]")
    rigid: list[Rigid] = tables(Rigid, "sections [[rigid]]")
    hinge: list[Hinge] = tables(Hinge, "sections [[hinge]]")
    pad: list[Pad] = tables(Pad, "sections [[pad]]")
