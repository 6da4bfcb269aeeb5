# SPDX-License-Identifier: GPL-3.0-or-later
"""Events of a run, found from the states of its contacts at successive samples."""
from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from statejump.core.run import AT_STOP, SEPARATED, SLIP, Event


def kind_of(before: int, after: int, slipped: bool) -> str:
    """Return the kind of event between two states of a contact. Names are those of the reduced spring-slider model.

    :param slipped: whether the contact slipped at an earlier time
    """
    if after == AT_STOP:
        return "stop_reached"
    if before == AT_STOP:
        return "stop_left"
    if after == SEPARATED:
        return "separation"
    if before == SEPARATED:
        return "contact"
    if after == SLIP:
        return "slip" if slipped else "first_slip"
    return "stick"


def from_states(
    time_s: np.ndarray, temperature_change_K: np.ndarray, states: np.ndarray, contacts: Sequence[str]
) -> list[Event]:
    """Return the events of contacts in order of time. The time of an event is the mean of two samples.

    :param states: states (samples, contacts), see ``CONTACT_STATES``
    """
    found: list[Event] = []
    for place, contact in enumerate(contacts):
        state = states[:, place]
        slipped = bool(len(state)) and state[0] == SLIP
        for after in np.flatnonzero(state[1:] != state[:-1]) + 1:
            found.append(Event(
                kind_of(int(state[after - 1]), int(state[after]), slipped),
                float(0.5 * (time_s[after - 1] + time_s[after])),
                float(0.5 * (temperature_change_K[after - 1] + temperature_change_K[after])),
                contact,
                float(0.5 * (time_s[after] - time_s[after - 1])),
            ))
            slipped = slipped or state[after] == SLIP
    return sorted(found, key=lambda event: event.time_s)
