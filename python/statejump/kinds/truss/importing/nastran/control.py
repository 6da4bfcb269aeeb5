# SPDX-License-Identifier: GPL-3.0-or-later
"""Executive and case control of a Nastran deck. The chosen subcase selects sets of loads and supports."""
from __future__ import annotations

import re
from dataclasses import dataclass, field

from statejump.core.errors import NotAllowed
from statejump.kinds.truss.importing.contract import REFUSED
from statejump.kinds.truss.importing.model import Deck, quoted
from statejump.kinds.truss.importing.nastran.table import CONTROL

COMMAND = re.compile(r"([A-Z][A-Z0-9]*)\s*(?:\(([^)]*)\)?)?\s*=?\s*(.*)$")
HEAT = ("153", "159", "NLSCSH", "NLTCSH")
DYNAMIC_SOLUTIONS = ("108", "109", "111", "112", "118", "129", "DFREQ", "DTRAN", "MFREQ", "MTRAN")
# In these solutions (modes, responses, flutter) SUPORT only defines rigid-body motion and holds nothing.
FREE_SOLUTIONS = (*DYNAMIC_SOLUTIONS, "103", "107", "110", "145", "146", "MODES", "DCEIG", "MCEIG", "FLUTTER")
# Kind of set that a command selects, by name and option of the command.
SELECTED = {
    "SPC": "spc", "LOAD": "load", "MPC": "mpc", "DEFORM": "deform", "SUPORT1": "suport", "NSM": "nsm",
    "TEMPERATURE": "temperature", "TEMPERATURE LOAD": "temperature", "TEMPERATURE BOTH": "temperature",
    "TEMPERATURE INITIAL": "initial", "TEMPERATURE INIT": "initial", "TEMPERATURE MATERIAL": "material",
    "TEMPERATURE MATE": "material",
}


@dataclass
class Control:
    """Content of the executive and case control.

    :param given: whether there is a case control. Without one, a set is used if it is the only one of its kind
    :param chosen: numbers of the selected sets, by kind
    :param solution: value of SOL
    :param autospc: whether directions without stiffness are held
    """

    given: bool = False
    chosen: dict[str, str] = field(default_factory=dict)
    solution: str = ""
    autospc: bool = True

    def solves(self, solutions: tuple[str, ...]) -> bool:
        """Whether the solution is one of these."""
        return self.solution.removeprefix("SE") in solutions


@dataclass
class _Subcase:
    number: int
    line: int
    name: str
    chosen: dict[str, str] = field(default_factory=dict)


def read(deck: Deck, lines: list[tuple[int, str]]) -> Control:
    """Return the selection of the subcase that ``--step`` names, or of the first subcase."""
    cend = next((place for place, (_, text) in enumerate(lines) if text.upper().startswith("CEND")), None)
    control = Control(given=cend is not None)
    for line, text in lines[:cend or 0]:
        words = text.upper().split()
        if words[:1] == ["SOL"] and len(words) > 1:
            control.solution = words[1].strip(",")
            if control.solution in HEAT:
                deck.refuse(f"SOL {control.solution}", "heat_transfer", line, "SOL")
        elif words[:2] == ["APP", "HEAT"]:  # of COSMIC
            deck.refuse("APP HEAT", "heat_transfer", line, "APP")
    common = _Subcase(0, 0, "")
    subcases: list[_Subcase] = []
    continued = False
    for line, text in lines[0 if cend is None else cend + 1:]:
        further, continued = continued, text.endswith(",")
        if further:  # continuation of a SET or of a list of options
            continue
        found = COMMAND.match(text.upper())
        if found is None:
            raise deck.fail(line, "deck_bad_syntax", problem=f"{quoted(text)} is not a command of the case control")
        name, option, value = found[1], (found[2] or "").strip(), found[3].strip()
        if name == "AUTOSPC":
            control.autospc = "NO" not in (value.split() or [option])
            continue
        if name in ("SUBCASE", "SUBCOM", "SYM", "SYMCOM", "REPCASE"):
            number = value.split()[0] if value else ""
            subcases.append(_Subcase(int(number) if number.isdecimal() else len(subcases) + 1, line, name))
            continue
        if name == "OUTPUT":  # commands of plots follow
            if "XY" in option or "PLOT" in option:
                break
            continue
        _command(deck, line, subcases[-1] if subcases else common, name, option, value)
    if common.chosen or subcases:
        control.given = True
    _choose(deck, control, common, subcases)
    return control


def _command(deck: Deck, line: int, of: _Subcase, name: str, option: str, value: str) -> None:
    name = "TEMPERATURE" if len(name) >= 4 and "TEMPERATURE".startswith(name) else name
    known = CONTROL.get(name)
    kind = SELECTED.get(f"{name} {option.split(',')[0].strip()}".strip())
    if kind is None and name in SELECTED:
        kind = SELECTED[name]
    if kind is not None:
        set_name = value.split(",")[0].strip()
        if not set_name.isdecimal():
            raise deck.fail(line, "deck_bad_value", problem=f"{name} = {quoted(value)} is not the number of a set")
        of.chosen[kind] = str(int(set_name))
    elif known is not None and known.use == REFUSED and (name != "ANALYSIS" or value.startswith("HEAT")):
        of.chosen[f"refused {name}"] = str(line)


def _choose(deck: Deck, control: Control, common: _Subcase, subcases: list[_Subcase]) -> None:
    step = deck.options.step
    if step is not None and step not in [one.number for one in subcases] and not (step == 1 and not subcases):
        known = ", ".join(str(one.number) for one in subcases) or "1"
        raise NotAllowed("--step", step, code="undefined_subcase", subcases=known)
    taken = next((one for one in subcases if step in (None, one.number)), common)
    if taken.name and taken.name != "SUBCASE":
        deck.refuse(taken.name, "subcase_combination", taken.line)
    control.chosen = {**common.chosen, **taken.chosen}
    for kind in [one for one in control.chosen if one.startswith("refused ")]:
        name = kind.split()[1]
        deck.refuse(name, CONTROL[name].what, int(control.chosen.pop(kind)))
    for other in subcases:
        if other is not taken and other.chosen != taken.chosen:
            deck.leave(f"{other.name} {other.number}", f"subcase {taken.number} is taken; --step chooses another",
                       other.line)
