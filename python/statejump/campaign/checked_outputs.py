# SPDX-License-Identifier: GPL-3.0-or-later
"""Check of the requested outputs with a run of the case, before a campaign begins."""
from __future__ import annotations

from collections.abc import Sequence

from statejump.campaign.outputs import parts, values
from statejump.campaign.work import sampled
from statejump.core.case import Case
from statejump.core.errors import NotAllowed


def checked(given: Sequence[str], case: Case) -> tuple[str, ...]:
    """Return the outputs after computing them for a run of the reduced model.

    :raises NotAllowed: one is invalid
    """
    names = tuple(given)
    for place, name in enumerate(names):
        parts(name)
        if name in names[:place]:
            raise NotAllowed("outputs", name, code="duplicate")
    if names:
        values(names, sampled(case, "reduced", names))
    return names
