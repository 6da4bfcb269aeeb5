# SPDX-License-Identifier: GPL-3.0-or-later
"""What makes the state jump of the paper's rib smaller, its conclusion (c): the kind ``umbrella`` with a study of its
control. The command takes it as a kind of one's own::

    STATEJUMP_KINDS=studies.rib_control:KIND statejump control cases/umbrella_bias.toml
"""
from __future__ import annotations

from statejump.core.later import Later
from statejump.kinds.umbrella import Umbrella


class ControlledUmbrella(Umbrella):
    """The kind ``umbrella`` that answers ``statejump control``."""

    control = Later("studies.rib_control.study:control")


KIND = ControlledUmbrella()
