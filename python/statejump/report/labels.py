# SPDX-License-Identifier: GPL-3.0-or-later
"""Labels for the keys of result files. This module has the labels common to all kinds; each kind has labels for its
columns, contacts and links (``LABELS``)."""
from __future__ import annotations

from collections.abc import Mapping

from statejump.core.case import Case
from statejump.core.errors import StatejumpError
from statejump.core.units import split_unit, text
from statejump.kinds import has, kind, require
from statejump.report.capabilities import CaseText
from statejump.schema.fields import fields_of, tables_of

MODELS = {"reduced": "Reduced model", "dem": "DEM (YADE)"}
SIDES = {"closed_form": "Closed form", "reduced": "Reduced", "dem": "DEM", "fe": "CalculiX",
         "first": "First", "second": "Second"}
STATES = {"separated": "gap", "stick": "stick", "slip": "slip", "at_stop": "at the stop"}
NAMES = {"young_modulus": "Young's modulus", "poisson_ratio": "Poisson's ratio"}
EVENTS = {
    "first_contact": "first contact", "contact": "contact", "separation": "separation", "first_slip": "first slip",
    "slip": "slip", "stick": "stick", "stop_reached": "stop reached", "stop_unloaded": "stop unloaded",
    "stop_left": "stop left", "reversal": "temperature turns, sticks", "force_sign_change": "axial force changes sign",
    "cycle_end": "end of a cycle", "play_opened": "play opens", "play_closed": "play closes",
    "slack": "goes slack", "taut": "becomes taut",
}
SHAPES = {
    "triangle": "changes by {peak} and back in straight lines",
    "half_sine": "changes by {peak} and back as half a sine",
    "sine": "swings by ± {peak} as a sine", "table": "follows a table, up to {peak} from its start",
}
# Prefix of the key in ``LABELS`` with the meaning of a stage.
STAGE = "stage "


def inside(words: str) -> str:
    """Return a label as it is written inside a sentence: with a small first letter, except for names."""
    kept = words[:2].isupper() or words.startswith(tuple(NAMES.values()))
    return words if kept else words[:1].lower() + words[1:]


class Labels:
    """Labels for the keys of result files of one kind of case.

    :param own: labels of the kind by key; a key may lack its unit
    :param given: whether users name the parts in cases of this kind
    """

    def __init__(self, own: Mapping[str, str] | None = None, given: bool = False) -> None:
        self._own = {**NAMES, **(own or {})}
        self._given = given

    def named(self, name: str, in_sentence: bool = False) -> str:
        """Return the label of a part, link or contact. A name that a user chose is not changed."""
        known = self._own.get(name)
        if known is None and self._given:
            return name
        found = self.plain(name)
        return found.lower() if in_sentence else found

    def plain(self, name: str) -> str:
        """Return a key as words, with a capital letter and without its unit."""
        key = split_unit(name)[0]
        known = self._own.get(name) or self._own.get(key)
        if known is not None:
            return known
        words = key.replace("_", " ").strip()
        return words[:1].upper() + words[1:]

    def parameter(self, path: str) -> str:
        """Return a key of a case file, or its path, as words: ``link.young_modulus_Pa``, ``revolute.*.axis``."""
        section, _, rest = path.partition(".")
        item, _, key = rest.rpartition(".")
        if not rest:
            section, key = "", path
        named = self.plain(key).replace("temperature change", "ΔT")
        if not section:
            return named
        of = self.plain(section)
        of = of if section in self._own else of.lower()
        if item:
            of = f"all {of}s" if item == "*" else f"{of} {item}"
        return f"{named} of {of}"

    def stage(self, name: str) -> tuple[str, str]:
        """Return the name and the meaning of a stage of a model."""
        return self._own.get(name, name), self._own.get(STAGE + name, "")


def of_kind(name: str) -> Labels:
    """Return the labels of a kind of case; for an unknown kind, the labels common to all kinds."""
    try:
        found = kind(name)
        return Labels(found.LABELS, any(tables_of(attribute) for attribute in fields_of(found.Case).values()))
    except StatejumpError:
        return Labels()


def described(case: Case) -> list[str]:
    """Describe a case in sentences: first the description by its kind, then its temperature program."""
    sentences: list[str] = require(case, CaseText).describe(case) if has(case, CaseText) else []
    return [*sentences, _temperature(case)]


def _temperature(case: Case) -> str:
    thermal = case.thermal
    peak = thermal.temperature_change_max_K
    if peak is None:
        peak = max(case.temperature_range_K, key=abs)
    times = "once" if thermal.cycles == 1 else f"{thermal.cycles} times"
    way = SHAPES.get(thermal.shape, "changes by up to {peak}").format(peak=text(peak, "K"))
    returned = ", the return to the reference temperature included" if case.ending is not None and (
        case.ending.returns) else ""
    what = "temperature" if case.member_histories is None else "mean temperature of the members"
    return f"The {what} {way}, {times}; a cycle lasts {text(case.period_s, 's')}{returned}."
