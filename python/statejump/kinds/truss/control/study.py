# SPDX-License-Identifier: GPL-3.0-or-later
"""Control of the jump of a node of a truss: search for the smallest spring, preload, friction or other parameter that
keeps the jump at or below a bound, and for the best of several candidates."""
from __future__ import annotations

from collections.abc import Sequence

from statejump.control.study import DesignChoices, Line, Study, Sweep, check_wanted, number, refuse_runs, with_notes
from statejump.core.errors import NotAllowed
from statejump.core.notes import Note
from statejump.core.progress import OnProgress, one_of
from statejump.core.units import plain
from statejump.kinds.truss.answers.jumps import most_moved, quick_path, rounding_m
from statejump.kinds.truss.answers.verdict import RESOLVED
from statejump.kinds.truss.case import TrussCase
from statejump.kinds.truss.control.candidates import candidates
from statejump.kinds.truss.control.search import Jump, Search, jump_of
from statejump.kinds.truss.references import known_name

RESULTS = {"jump_m": "|jump| [µm]"}
LINES: dict[str, Line] = {
    "jump_m": ("quasi-static path", dict(color="#E69F00", linewidth=2.0, marker="o", markersize=3.5)),
}
MICRO = 1e6


@with_notes
def control(
    case: TrussCase, jump_below: float | None = None, runs: int | None = None, with_dem: bool = False,
    on_progress: OnProgress = lambda share: None, choices: DesignChoices = DesignChoices(),
) -> Study:
    """Sweep every candidate, and search for the values that keep the jump of a node at or below a bound.

    :param jump_below: largest allowed jump [m]; None: half of the jump of the case
    :param runs: must be None, because the case has only one path
    :param with_dem: not available for trusses, see ``statejump compare``
    :param choices: node, allowed springs, parameters that may be scaled; empty: the study chooses
    :raises StatejumpError: the input is invalid, or the case has no path
    """
    check_wanted(jump_below, "m")
    refuse_runs(runs, case)
    if with_dem:
        raise NotAllowed("--dem", code="dem_of_control", case=case.name)
    truss, increments = case.resolve(), case.reduced_settings.increments_per_branch
    names = truss.nodes.names
    if choices.node is not None:
        known_name("--node", choices.node, choices.node, dict.fromkeys(names), "node", case=case.name)
    asked = candidates(case, choices)
    node = most_moved(quick_path(truss, increments)) if choices.node is None else names.index(choices.node)
    now = jump_of(truss, node, increments)
    jumps = now.size_m > rounding_m(now.path)
    wanted = now.size_m / 2 if jump_below is None and jumps else jump_below
    measure = (f"quasi-static path of the truss, solved again for every value; jump of node {names[node]} over "
               f"{case.thermal.cycles} cycle(s)")
    result = Study(measure, "m", "µm", MICRO, RESULTS, now.size_m if jumps else 0.0, wanted, "|State jump| [µm]", LINES)
    result.recommendation["node"] = names[node]
    searches = [Search(one, Sweep(one.parameter, one.label, one.unit, 1.0, one.own, []), node, increments)
                for one in asked]
    for done, search in enumerate(searches):
        part = one_of(on_progress, done, len(searches))
        search.scan(lambda share, part=part: part(0.7 * share))  # type: ignore[misc]
        result.sweeps.append(search.sweep)
        if wanted is not None:
            search.narrow(wanted)
            if search.value is not None:
                search.tell_value(now, wanted, names[node])
            result.sentences.append(_sentence(search, wanted))
            result.remarks += _remarks(search, now, wanted)
        part(1.0)
    if wanted is None:
        result.sentences.append(Note("nothing_to_control", what="The node does not jump"))
    else:
        result.recommendation["candidates"] = [
            search.found or {"parameter": search.sweep.parameter, "value": None, "monotone": not search.turns}
            for search in searches]
        _best(result, "best_spring", [search for search in searches if search.candidate.is_spring])
        if choices.scale:
            _best(result, "best_scale", [search for search in searches if not search.candidate.is_spring])
        elif not choices.add_spring:
            result.sentences.append(Note("no_key_free"))
    return result


def _shown(search: Search, value: float) -> str:
    return f"{value:.6g} N/m" if search.candidate.is_spring else f"{value:.6g} times its value"


def _subject(search: Search) -> str:
    label = search.candidate.label.removesuffix(", times")
    return f"A {label[0].lower()}{label[1:]}" if search.candidate.is_spring else label


def _sentence(search: Search, wanted: float) -> Note:
    low, high = (_shown(search, row.value) for row in (search.sweep.rows[0], search.sweep.rows[-1]))
    asked, subject = plain(wanted, "m"), _subject(search)
    if search.value is None:
        reached = [row for row in search.sweep.rows if row.results.get("jump_m") is not None]
        least = min(reached, key=lambda row: float(row.results["jump_m"] or 0.0), default=None)
        text = "" if least is None else (f"; the smallest jump of them is {plain(least.results['jump_m'], 'm')}, with "
                                         f"{_shown(search, least.value)}")
        return Note("no_value_found", subject=subject, low=low, high=high, wanted=asked, least=text)
    found = search.found
    if search.value == search.candidate.own:
        return Note("nothing_needed", subject=subject, jump=plain(found["jump_with_it_m"], "m"))
    elasticity, verdict = found["elasticity"], found["verdict"]
    if verdict == "smooth":
        derivative = (f"the path is smooth: 1 % more changes the jump by {number(elasticity, 3)} %, by differences of "
                      "1 and of 0.5 %")
    elif verdict.startswith("failed"):
        derivative = f"the derivative {verdict}"
    else:
        derivative = f"the derivative is {verdict}: only another solution shows the effect"
    return Note("smallest_change", subject=subject, value=_shown(search, search.value), wanted=asked,
                found_by=found["found_by"], jump=plain(found["jump_with_it_m"], "m"), derivative=derivative,
                verdict=verdict, elasticity=elasticity)


def _remarks(search: Search, now: Jump, wanted: float) -> list[Note]:
    found, subject, said = search.found, search.candidate.parameter, list[Note]()
    if search.turns:
        at = ", ".join(number(turn) for turn in search.turns)
        said.append(Note("jump_not_monotone", parameter=subject, at=at, turns=tuple(search.turns)))
    failed = sum(bool(row.note) for row in search.sweep.rows)
    if failed:
        said.append(Note("values_without_path", parameter=subject, failed=failed))
    if found.get("leaps"):
        said.append(Note("jump_leaps", parameter=subject))
    if found and search.value != search.candidate.own and not found["joints_go_as_in_the_case"]:
        said.append(Note("joints_differ", parameter=subject))
    if found and abs(found["jump_with_twice_the_increments_m"] - found["jump_with_it_m"]) > RESOLVED * wanted:
        said.append(Note("increments_too_few", parameter=subject,
                         jump=plain(found["jump_with_twice_the_increments_m"], "m")))
    return said


def _best(result: Study, name: str, searches: Sequence[Search]) -> None:
    if len(searches) < 2:
        return
    reaching = [search for search in searches if search.value is not None]
    if not reaching:
        return
    best = min(reaching, key=lambda search: search.candidate.size(search.value or search.candidate.own))
    assert best.value is not None
    result.recommendation[name] = best.candidate.parameter
    if best.value == best.candidate.own:
        return
    what = "softest spring" if best.candidate.is_spring else "smallest relative change"
    result.sentences.append(Note("best_of_several", asked=len(searches), reaching=len(reaching), what=what,
                                 parameter=best.candidate.parameter, value=_shown(best, best.value)))
