# SPDX-License-Identifier: GPL-3.0-or-later
"""Report page of a truss: jumps of nodes, contributions of joints, sensitivities.

The data are in the result file of ``statejump truss answers``. Without it, the page takes jumps from the histories of a
run, and ranks joints by their motion and heat.
"""
from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from statejump.core.charts import TEMPERATURE, Axis, Chart
from statejump.core.errors import Unreadable
from statejump.core.run import Run
from statejump.core.units import scale_of, text, unit_of
from statejump.kinds.truss.case import TrussCase
from statejump.kinds.truss.elements import ELEMENTS
from statejump.kinds.truss.joints import JOINTS
from statejump.kinds.truss.page_bounds import page_bounds
from statejump.kinds.truss.result import names as names_of
from statejump.kinds.truss.scales import scales
from statejump.kinds.truss.summary import is_guided, is_held
from statejump.report import labels
from statejump.report.drawing import round_down
from statejump.results.contents import Result

SHOWN_JUMP = 0.12  # initial drawn size of the largest jump, as a fraction of the truss' size
MOST_CYCLES = 12  # largest number of cycles in the drawing: the first and the last ones
MOST_BARS = 15
MOST_SENSITIVITIES = 20
LEAST_PERCENT = 5e-3
ROUNDED = 1e-9  # fraction of the largest value of a joint below which a value is rounding
ROUNDED_SURFACE = 1e-12  # rounding of metres or radians, relative to the size of the truss
ROUNDING = "≈ 0"
# Ranking quantities: for joints whose first column is a rotation, and for all others.
TURN, JUMP = "turn", "jump"
Row = dict[str, Any]
_TYPES: dict[str, Any] = {joint.section: joint for joint in JOINTS}


@dataclass(frozen=True)
class Measure:
    """A quantity that ranks joints."""

    key: str
    label: str
    unit: str
    note: str
    signed: bool = False


def _vectors(rows: list[Row], cycles: int) -> np.ndarray:
    """Return the jumps (cycles, items, 3) in rows that are sorted by cycle."""
    found = np.array([[row[f"jump_{axis}_m"] for axis in "xyz"] for row in rows], dtype=float)
    return found.reshape(cycles, -1, 3)


class TrussPart:
    """The section of the report page that only trusses have.

    :param result: a truss with the history of its nodes, see :func:`page`
    """

    template = Path(__file__).with_name("truss.html")
    units = {"truss_node_m": "m", "truss_slide_m": "m", "truss_turn_rad": "rad", "truss_journal_x_m": "m",
             "truss_journal_y_m": "m", "truss_journal_m": "m", "truss_link_N": "N"}

    def __init__(self, result: Result, case: TrussCase) -> None:
        self.result, self.case, self.answers = result, case, result.answers
        self.model = next(iter(result.models))
        self._run = result.models[self.model]
        self.nodes = result.names["nodes"]
        self._number = {name: place for place, name in enumerate(self.nodes)}
        self._labels = labels.Labels()
        self.cycles = case.thermal.cycles
        self._ends = self._cycle_ends(self._run)
        if self.answers is None:
            self.cycles = max(len(self._ends) - 1, 1)
            self.node_jumps = self._since_start(self._run, "history", "displacement_m")
        else:
            self.cycles = len(self.answers.tables["cycles"])
            self.node_jumps = _vectors(self.answers.tables["node_jumps"], self.cycles)
        self._rounding_m = scales(case.resolve(), self._run.history["displacement_m"].values).rounding_m
        sizes = np.linalg.norm(self.node_jumps, axis=2, keepdims=True)
        self.node_jumps = np.where(sizes > self._rounding_m, self.node_jumps, 0.0)
        self._size_m = np.linalg.norm(self.node_jumps[-1], axis=1)
        self.joints = self._joints()
        self.measures = self._measures()
        self.bounds = page_bounds(case, self._run.history["displacement_m"].values)
        self.columns = {model: self._curves(run) for model, run in result.models.items()}

    def _cycle_ends(self, run: Run) -> np.ndarray:
        """Return the indices of the first sample and of the samples nearest to the end of each cycle."""
        time, period = run.time_s, self.case.period_s
        whole = int(math.floor(float(time[-1]) / period + 1e-6))
        wanted = period * np.arange(min(self.cycles, whole) + 1) if whole else time[[0, -1]]
        return np.abs(time[:, None] - wanted).argmin(axis=0)

    def _since_start(self, run: Run, group: str, name: str) -> np.ndarray:
        values = getattr(run, group)[name].values[self._cycle_ends(run)]
        return values[1:] - values[0]

    @property
    def _first(self) -> int:
        """Return the node whose jump the page reports: the output of the answers, else the node that moves most."""
        named = self.answers.output.partition("node:")[2] if self.answers is not None else ""
        return self._number[named] if named in self._number else int(np.argmax(self._size_m))

    # ---------------------------------------------------------------- joints

    def _joints(self) -> list[Row]:
        """Return one row for every joint in the order of the file: name, kind, node, and quantities to rank."""
        truss = self.case.resolve()
        found: list[Row] = []
        for joint in JOINTS:
            joints = truss.joints[joint.section]
            if len(joints.names):
                found += [{"name": name, "kind": joint.section, "called": joint.section.replace("_", " "),
                           "node": int(node)} for name, node in zip(joints.names, joint.place_nodes(truss, joints))]
        self._read_off(found)
        if self.answers is None:
            return found
        moved = {(row["kind"], row["joint"]): row for row in self.answers.tables["joint_jumps"]
                 if row["cycle"] == self.cycles}
        held = {(row["kind"], row["joint"]): row for row in self.answers.tables.get("contributions", [])}
        for row in found:
            key = (row["kind"], row["name"])
            if key in moved:
                row["jump"], row["heat"] = moved[key]["jump_m"], moved[key]["dissipation_J"]
                row["heat_of_cycle"] = moved[key]["dissipation_of_cycle_J"]
            if key in held:
                row["contribution"], row["share"] = held[key]["contribution"], held[key]["share"]
        return found

    def _read_off(self, joints: list[Row]) -> None:
        """Add the distance of each joint from its start, and its frictional heat, from the histories of the run."""
        run = self._run
        contacts = self._since_start(run, "contacts", "dissipation_J") if "dissipation_J" in run.contacts else None
        first = 0
        for joint in JOINTS:
            rows, place = [row for row in joints if row["kind"] == joint.section], joint.columns[0].name
            if rows and place in run.history:
                moved = self._since_start(run, "history", place)[-1]
                sizes = np.abs(moved) if moved.ndim == 1 else np.linalg.norm(moved, axis=1)
                for row, size in zip(rows, sizes):
                    row[TURN if unit_of(place) == "rad" else JUMP] = float(size)
            own, heat = f"{joint.section}_dissipation_J", np.zeros((0, 0))
            if joint.has_contacts and contacts is not None:
                heat, first = contacts[:, first:first + len(rows)], first + len(rows)
            elif own in run.history:
                heat = self._since_start(run, "history", own)
            for row, spent in zip(rows, heat.T):
                row["heat"] = float(spent[-1])
                row["heat_of_cycle"] = float(spent[-1] - (spent[-2] if len(spent) > 1 else 0.0))

    def _measures(self) -> list[Measure]:
        keys = set().union(*self.joints)
        unit = self.answers.unit if self.answers is not None else "m"
        every = [
            Measure("contribution", "Contribution to the jump", unit,
                    "What the friction of a joint holds of the output's jump, with its sign; all together give the "
                    "jump.",
                    True),
            Measure("heat", "Heat of friction", "J", "Heat of the joint's friction over all cycles: where it slips, "
                    "not what holds the jump."),
            Measure(JUMP, "Jump of the joint", "m", "How far a slider, a journal in its bearing or a ball in its "
                    "socket, is from where it started: where it moved, not what holds the jump."),
            Measure(TURN, "Turn of the hinge", "rad", "How far a hinge is turned from where it started: where it "
                    "moved, not what holds the jump."),
        ]
        return [measure for measure in every
                if measure.key in keys and any(joint.get(measure.key) for joint in self.joints)]

    def ranking(self) -> list[Row]:
        """Return the rows of the table of joints as texts, ranked by the first of their quantities."""
        if not self.measures:
            return []
        first = self.measures[0].key
        order = sorted(self.joints, key=lambda joint: -abs(joint.get(first, 0.0)))
        return [{**joint, "text": self._texts(joint)} for joint in order[:MOST_BARS]]

    def _largest(self, measure: Measure) -> float:
        return max(abs(joint.get(measure.key, 0.0)) for joint in self.joints)

    def _texts(self, joint: Row) -> dict[str, str]:
        found = {}
        for measure in self.measures:
            if measure.key not in joint:
                continue
            value = joint[measure.key]
            rounding = abs(value) < ROUNDED * self._largest(measure)
            found[measure.key] = ROUNDING if rounding else text(value, measure.unit, 4)
            found[f"{measure.key}_short"] = ROUNDING if rounding else text(value, measure.unit, 3)
        if "share" in joint:
            share = 100 * joint["share"]
            shown = f"{share:.3g}" if abs(share) >= 1 else f"{share:.2f}"
            found["share"] = f"{shown}\u202f%".replace("-", "−") if abs(share) >= LEAST_PERCENT else ROUNDING
        if "heat_of_cycle" in joint and self.cycles > 1:
            found["heat_of_cycle"] = text(joint["heat_of_cycle"], "J", 4)
        return found

    # ---------------------------------------------------------------- words and tables

    @property
    def verdict(self) -> str:
        """Return the verdict of the answers on the cycles, as a sentence; "" without answers."""
        verdict = "" if self.answers is None else self.answers.verdict_text
        return f"{verdict[:1].upper()}{verdict[1:]}." if verdict else ""

    def cards(self) -> list[Row]:
        """Return the jump of the output of the answers, as a number for the top of the page."""
        if self.answers is None:
            return []
        jump = text(self.answers.summary["jump"].value, self.answers.unit)
        return [{"label": f"Jump of the output {self.answers.output}", "values": [(self.answers.verdict, jump)]}]

    @property
    def sentences(self) -> list[str]:
        """The results in sentences."""
        if self.answers is None:
            return self._without_answers()
        numbers, unit = self.answers.summary, self.answers.unit
        found = [f"Output: {self.answers.text}. It jumps by {text(numbers['jump'].value, unit, 4)} over "
                 f"{_cycles(self.cycles)}."]
        verdict = self.answers.verdict_text
        found.append(f"Over the cycles: {verdict}.")
        if "sum_of_contributions" in numbers:
            total = text(numbers["sum_of_contributions"].value, unit, 4)
            error = numbers["sum_error_relative"].value
            found.append(f"The contributions of all joints add up to {total}, the jump but for {error:.1g} of it.")
        return found

    def _without_answers(self) -> list[str]:
        name = self.nodes[self._first]
        if self._size_m.max() <= self._rounding_m:
            return ["No node is away from where it began by more than rounding."]
        moved = {model: self._since_start(run, "history", "displacement_m")[-1, self._first]
                 for model, run in self.result.models.items()}
        jumps = [f"{text(float(np.linalg.norm(way)), 'm', 4)} in the {labels.inside(labels.MODELS[model])}"
                 for model, way in moved.items()]
        which = "jumps" if self.case.has_jump else "is displaced"
        found = [f"The node that {which} most, {name}, is after {_cycles(self.cycles)} away from where it began by "
                 f"{' and '.join(jumps)}."]
        if self.joints:
            by = "how far they moved" + (" and by the heat of their friction" if any(
                measure.key == "heat" for measure in self.measures) else "")
            found.append(f"This file has no contributions of joints: they are ranked by {by}, which is not what holds "
                         "the jump. 'statejump truss answers' finds the contributions.")
        return found

    @property
    def notes(self) -> list[str]:
        """Return the remarks of the answers. They omit the warnings of the run, which the head of the page shows."""
        return [] if self.answers is None else [
            note[:1].upper() + note[1:] + "." for note in self.answers.notes if note not in self.result.warnings]

    def cycle_rows(self) -> list[Row]:
        """Return the rows of the table of cycles; if there are many cycles, the first and the last rows."""
        rows = self.answers.tables.get("cycles", []) if self.answers is not None else []
        return [rows[place] for place in _some(len(rows), MOST_CYCLES)] if len(rows) > 1 else []

    def surface(self) -> list[Row]:
        """Return the rows of the table of the reflecting surface."""
        rows = self.answers.tables.get("surface", []) if self.answers is not None else []
        size = float(np.ptp(self._run.history["position_m"].values[0], axis=0).max())

        def shown(key: str, value: Any) -> str:
            if not isinstance(value, float):
                return value or "–"
            unit = unit_of(key)
            rounding = unit in ("m", "rad") and 0 < abs(value) < ROUNDED_SURFACE * size
            return ROUNDING if rounding else text(value, unit, 5)

        places = (*range(min(2, len(rows))), *(2 + place for place in _some(len(rows) - 2, 6)))
        return [{key: shown(key, value) for key, value in rows[place].items()} for place in places]

    @property
    def focuses(self) -> bool:
        """Whether the surface has a focal length."""
        rows = self.answers.tables.get("surface", []) if self.answers is not None else []
        return any(row["focal_length_m"] is not None for row in rows)

    def sensitivities(self) -> tuple[list[Row], int]:
        """Return the rows of the table of sensitivities, the largest first, and the number of omitted rows."""
        rows = self.answers.tables.get("sensitivities", []) if self.answers is not None else []
        ranked = sorted(rows, key=lambda row: -abs(row["elasticity"] or 0.0))
        most = max((abs(row["elasticity"] or 0.0) for row in ranked), default=0.0)
        shown = [
            {**row, "name": self._labels.parameter(row["parameter"]), "key": row["parameter"],
             "bar": 100 * (row["elasticity"] or 0.0) / most if most else 0.0,
             "text": "–" if row["elasticity"] is None else f"{row['elasticity']:+.3g}".replace("-", "−"),
             "given": "differs" if row["value"] is None else text(row["value"], unit_of(row["parameter"]), 4)}
            for row in ranked[:MOST_SENSITIVITIES]
        ]
        return shown, len(ranked) - len(shown)

    # ---------------------------------------------------------------- curves

    def charts(self) -> list[Chart]:
        """Return loops of the node, of the first joint in the ranking, and of the link with the largest force."""
        found = [Chart(TEMPERATURE, Axis("truss_node_m", f"Node {self.nodes[self._first]} along its jump"),
                       f"Loop of node {self.nodes[self._first]}", marks=True)]
        joint = self._leading()
        if joint is not None:
            found.append(self._way(joint))
        link = self._hardest_link()
        if link is not None:
            found.append(Chart(TEMPERATURE, Axis("truss_link_N", f"Axial force of {link}"),
                               f"Largest axial force, link {link}: compression positive"))
        return found

    def _way(self, joint: Row) -> Chart:
        """Return the chart of a joint's position."""
        kind, name = _TYPES[joint["kind"]], joint["name"]
        if not kind.columns[0].vector:
            key, what = ("truss_turn_rad", "Rotation") if unit_of(kind.columns[0].name) == "rad" else (
                "truss_slide_m", "Slide")
            return Chart(TEMPERATURE, Axis(key, f"{what} of {name}"), f"Loop of {joint['called']} {name}")
        parts = f"{kind.inner.capitalize()} − {kind.outer} centre"
        if self.case.truss.dimension == 3:
            return Chart(TEMPERATURE, Axis("truss_journal_m", f"{parts}, {name}"),
                         f"Way of the {kind.inner} of {name} from its start")
        joints = self.case.resolve().joints[kind.section]
        clearance = float(joints.radial_clearance_m[joints.names.index(name)])
        return Chart(Axis("truss_journal_x_m", f"{parts}, along x"), Axis("truss_journal_y_m", "along y"),
                     f"{kind.inner.capitalize()} of {name} in its clearance", equal=True, rings_m=(clearance,))

    def _leading(self) -> Row | None:
        if not self.measures:
            return None
        first = self.measures[0].key
        return max(self.joints, key=lambda joint: abs(joint.get(first, 0.0)))

    def _hardest_link(self) -> str | None:
        force = self._run.links["axial_force_N"]
        if not force.values.size or not np.abs(force.values).max() > 0:
            return None
        return self.result.names["links"][int(np.argmax(np.abs(force.values).max(axis=0)))]

    def _curves(self, run: Run) -> dict[str, np.ndarray]:
        names, way = self.result.names, self.node_jumps[-1, self._first]
        size = float(np.linalg.norm(way))
        moved = run.history["displacement_m"].values[:, self._first]
        found = {"truss_node_m": (moved - moved[0]) @ (way / size if size > 0 else np.array([1.0, 0.0, 0.0]))}
        joint, link = self._leading(), self._hardest_link()
        if joint is not None:
            kind = _TYPES[joint["kind"]]
            column = kind.columns[0]
            place = run.history[column.name].values[:, names[kind.items].index(joint["name"])]
            if not column.vector:
                found["truss_turn_rad" if unit_of(column.name) == "rad" else "truss_slide_m"] = place
            else:
                found.update({f"truss_journal_{axis}_m": place[:, number] for number, axis in enumerate("xy")})
                found["truss_journal_m"] = np.linalg.norm(place - place[0], axis=1)
        if link is not None:
            found["truss_link_N"] = run.links["axial_force_N"].values[:, names["links"].index(link)]
        return found

    # ---------------------------------------------------------------- drawing

    def payload(self, encoded: Callable[[np.ndarray], Any]) -> Row:
        """Return the truss data for the script of the page.

        :param encoded: converts an array to the page's encoding
        """
        start = self._run.history["position_m"].values[0]
        size = float(np.ptp(start, axis=0).max())
        largest = float(self._size_m.max())
        truss = self.case.resolve()
        elements = [("link" if one.bends else "spring", one.names_of_ends(truss.elements[one.section]))
                    for one in ELEMENTS]
        between = [("link", truss.links.names), *elements]
        lines = [{"nodes": [int(node) for node in nodes], "kind": kind, "name": name}
                 for (kind, names), ends in zip(between, truss.ends()) for name, nodes in zip(names, ends)]
        # Magnified jumps draw journals outside of their bearings, so a line connects each pair.
        for joint in (one for one in JOINTS if one.columns[0].vector):
            joints = truss.joints[joint.section]
            lines += [{"nodes": [int(node) for node in nodes], "kind": "journal", "name": name}
                      for name, nodes in zip(joints.names, joint.joined(joints))]
        return {
            "dimension": self.case.truss.dimension,
            "nodes": self.nodes,
            "start": encoded(np.ascontiguousarray(start).ravel()),
            "lines": lines,
            "held": [place for place, item in enumerate(self.case.node) if is_held(self.case, item)],
            "guided": [place for place, item in enumerate(self.case.node) if is_guided(self.case, item)],
            "cycles": [{"cycle": place + 1, "jump": encoded(self.node_jumps[place].ravel())}
                       for place in _some(len(self.node_jumps), MOST_CYCLES)],
            "jumps": [text(float(size), "m", 4) for size in self._size_m],
            "largest_m": largest,
            "magnification": round_down(SHOWN_JUMP * size / largest) if largest > 0 else 1.0,
            "joints": [{**joint, "text": self._texts(joint)} for joint in self.joints],
            "measures": [
                {"key": measure.key, "label": measure.label, "note": measure.note, "signed": measure.signed,
                 **dict(zip(("scale", "unit"), scale_of(measure.unit, self._largest(measure))))}
                for measure in self.measures
            ],
            "most": MOST_BARS,
        }


def _some(count: int, most: int) -> list[int]:
    """Return all indices of ``count`` items or, if these are too many, the first and the last indices."""
    return list(range(count)) if count <= most else [*range(most // 2), *range(count - most + most // 2, count)]


def _cycles(count: int) -> str:
    return "one cycle" if count == 1 else f"{count} cycles"


def page(result: Result, case: TrussCase) -> TrussPart | None:
    """Return the page section of a truss; None if the result has no history of its nodes."""
    if not result.models:
        return None
    run = next(iter(result.models.values()))
    if not {"position_m", "displacement_m"} <= set(run.history) or not len(run.time_s):
        return None
    for items, wanted in names_of(case).items():
        if result.names.get(items, wanted) != wanted:
            raise Unreadable(code="names_of_other_case", items=items)
    return TrussPart(result, case)
