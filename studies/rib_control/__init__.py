# SPDX-License-Identifier: GPL-3.0-or-later
"""Control of the state jump of the paper's rib (conclusion c). The case kind ``umbrella`` is extended by a control
study, which ``statejump`` loads as a user-defined kind::

    STATEJUMP_KINDS=studies.rib_control:KIND statejump control cases/umbrella_bias.toml
"""
from __future__ import annotations

from statejump.core.later import Later
from statejump.kinds.umbrella import Umbrella


class ControlledUmbrella(Umbrella):
    """The kind ``umbrella`` that answers ``statejump control``."""

    control = Later("studies.rib_control.study:control")


KIND = ControlledUmbrella()
