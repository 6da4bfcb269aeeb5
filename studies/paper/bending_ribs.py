# SPDX-License-Identifier: GPL-3.0-or-later
"""Counterpart of the paper's Figures 13 to 16 with ribs that bend: ``python3 -m studies.paper.bending_ribs [FOLDER]``.

Four models of the rib follow the temperature with the quasi-static solver: straight ribs, as in the paper; ribs that
bend; ribs whose outer or inner side is warmer, so that they bow. The paper's rib moves freely in the play before
contact. Its path is then unique only with a biased torsion spring, which loads the joint, so all models have one.
"""
from __future__ import annotations

import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes

import statejump as sj
from statejump.core.figures import panels as new_panels, save, style
from statejump.kinds.truss.generate.document import Document, finished, node
from statejump.kinds.truss.generate.planar import umbrella

RESULTS = Path(__file__).resolve().parents[2] / "results" / "umbrella_bending"
FRICTION, CLEARANCE_M, STIFFNESS_N_m_per_rad = 0.3, 1e-4, 1.0  # friction and clearance of cases/umbrella.toml
CLEARANCES_M = (0.5e-4, 1e-4, 1.5e-4, 2e-4, 3e-4)
FRICTIONS = (0.0, 0.1, 0.3, 0.5)
SPRINGS = (0.01, 0.1, 1.0, 10.0, 100.0)
BIAS_rad, LARGEST_BIAS_N_m = 0.05, 0.05  # stiffer springs have the bias of this moment
SIDE_M = 3e-3  # of the square section, whose area is the paper's
PARTS = 8  # beams of a rib
GRADIENT = 0.2  # temperature difference across the section, over the mean temperature change
POINTER_M2 = 1e-12  # section of links that carry the torsion spring on the last beams of the ribs
INCREMENTS = 200

MODELS = {"straight": "straight ribs", "bends": "ribs that bend", "outside": "bending ribs, outer side warmer",
          "inside": "bending ribs, inner side warmer"}
LINES: dict[str, dict[str, Any]] = {
    "straight": {"color": "#56B4E9", "linewidth": 4.5, "alpha": 0.7},
    "bends": {"color": "#000000", "linewidth": 1.2, "linestyle": (0, (5, 2))},
    "outside": {"color": "#D55E00", "linewidth": 1.6},
    "inside": {"color": "#009E73", "linewidth": 1.6, "linestyle": (0, (1, 1))},
}


@dataclass(frozen=True)
class Cycle:
    """A cycle of one model."""

    change_K: np.ndarray
    deflection_rad: np.ndarray  # of the chord AB since the start
    journal_m: np.ndarray  # (states, 2) of the journal relative to the bearing's centre
    bow_m: float  # largest distance of a node of a rib from its chord

    @property
    def jump_rad(self) -> float:
        """Deflection after the cycle."""
        return float(self.deflection_rad[-1])

    @property
    def largest_rad(self) -> float:
        """Largest deflection of the cycle, with its sign."""
        return float(self.deflection_rad[np.argmax(np.abs(self.deflection_rad))])

    @property
    def range_rad(self) -> float:
        """Largest less smallest deflection."""
        return float(np.ptp(self.deflection_rad))


def document(model: str, friction: float = FRICTION, clearance_m: float = CLEARANCE_M,
             stiffness: float = STIFFNESS_N_m_per_rad, parts: int = PARTS) -> Document:
    """Return the case of a model.

    :param model: one of MODELS
    :param stiffness: of the torsion spring [N m/rad]
    :param parts: beams of a rib
    """
    made = umbrella(1, name=f"umbrella_rib_{model}", friction_coefficient=friction, radial_clearance_m=clearance_m,
                    torsion_stiffness_N_m_per_rad=stiffness, bias_rad=min(BIAS_rad, LARGEST_BIAS_N_m / stiffness))
    if model != "straight":
        _bend(made, {"bends": 0.0, "outside": GRADIENT, "inside": -GRADIENT}[model], parts)
    made["reduced"] = {"increments_per_branch": INCREMENTS}
    return finished(made)


def _bend(made: Document, gradient: float, parts: int) -> None:
    """Replace the links by rows of beams. Links of almost no section remain beside the last beams: the torsion spring
    acts on them, and they rotate with these beams."""
    at = {one["name"]: np.array(one["position_m"]) for one in made["node"]}
    made["beam"] = []
    for link in made["link"]:
        first, last = link["nodes"]
        inner = [f"{link['name']}{part}" for part in range(1, parts)]
        places = np.linspace(at[first], at[last], parts + 1)
        made["node"] += [node(name, where) for name, where in zip(inner, places[1:-1])]
        # The outer side is to the left of AB and to the right of CB.
        sign = 1.0 if link["name"] == "AB" else -1.0
        keys = {"young_modulus_Pa": link["young_modulus_Pa"], "poisson_ratio": link["poisson_ratio"],
                "thermal_expansion_per_K": link["thermal_expansion_per_K"], "shape": "rectangle",
                "dimensions_m": [SIDE_M, SIDE_M], "gradient_per_m": [sign * gradient / SIDE_M, 0.0]}
        names = [first, *inner, last]
        made["beam"] += [{"name": f"{link['name']}b{part}", "nodes": list(pair), **keys}
                         for part, pair in enumerate(zip(names, names[1:]), start=1)]
        link |= {"nodes": [inner[-1], last], "cross_section_area_m2": POINTER_M2, "ends": "guided"}
        for key in ("stress_free_length_m", "mass_kg"):
            link.pop(key)
    for joint in made["revolute"]:
        del joint["bearing_link"], joint["journal_link"]


def run(model: str, **changed: Any) -> Cycle:
    """Run a model; see :func:`document`."""
    made = document(model, **changed)
    names = [one["name"] for one in made["node"]]
    at = np.array([one["position_m"] for one in made["node"]])
    found = sj.load(made).reduced()
    history = found.history
    place = at + np.asarray(history["displacement_m"].values)[:, :, :2]
    a, b, j, c = (place[:, names.index(name)] for name in "ABJC")

    def angle(of: np.ndarray) -> np.ndarray:
        return np.unwrap(np.arctan2(of[:, 1], of[:, 0]))

    turned = angle(b - a)
    bows = [0.0]
    for name, first, last in (("AB", a, b), ("CB", c, j)):
        along = (last - first) / np.linalg.norm(last - first, axis=1, keepdims=True)
        for inner in (place[:, index] for index, one in enumerate(names) if one.startswith(name)):
            beside = (inner - first)[:, 0] * along[:, 1] - (inner - first)[:, 1] * along[:, 0]
            bows.append(float(np.abs(beside).max()))
    return Cycle(np.asarray(history["temperature_change_K"].values), turned - turned[0], j - b, max(bows))


def figure_13(paths: dict[str, Cycle], folder: Path) -> list[Path]:
    """Draw the deflection of AB and the journal in the play."""
    with style():
        drawing, grid = new_panels(1, 2, (9.4, 4.4))
        left, right = grid.flat
        _curves(left, paths)
        left.set_ylabel("Deflection of AB, θ2 − θ2(0) [mrad]")
        left.set_title("deflection of AB over the cycle", fontsize=9)
        round_ = np.linspace(0, 2 * np.pi, 361)
        right.plot(CLEARANCE_M * 1e6 * np.cos(round_), CLEARANCE_M * 1e6 * np.sin(round_), color="0.6", linewidth=0.9,
                   label="clearance")
        for model, path in paths.items():
            right.plot(*path.journal_m.T * 1e6, **LINES[model], label=MODELS[model])
            right.plot(*path.journal_m[-1] * 1e6, "o", color=LINES[model]["color"], markersize=5)
        right.set_aspect("equal")
        right.set_xlabel("Journal from the bearing, x [µm]")
        right.set_ylabel("y [µm]")
        right.set_title("journal in the play; dots: after the cycle", fontsize=9)
        left.legend(fontsize=8, frameon=False)
        drawing.suptitle("Fig. 13 with ribs that bend", fontsize=11)
        return save(drawing, folder, "fig13")


def _curves(panel: Axes, paths: dict[str, Cycle], reference: Cycle | None = None) -> None:
    for model, path in paths.items():
        less = np.zeros(1)
        if reference is not None:  # without friction, heating and cooling give the same deflections
            half = slice(int(np.argmax(reference.change_K)) + 1)
            less = np.interp(path.change_K, reference.change_K[half], reference.deflection_rad[half])
        panel.plot(path.change_K, (path.deflection_rad - less) * 1e3, **LINES[model], label=MODELS[model])
        panel.plot(path.change_K[-1], path.jump_rad * 1e3, "o", color=LINES[model]["color"], markersize=5)
    panel.set_xlabel("Temperature change [K]")


def figure(name: str, title: str, heads: Sequence[str], rows: Sequence[dict[str, Cycle]],
           references: Sequence[Cycle], label: str, folder: Path) -> list[Path]:
    """Draw the deflections for the values of one parameter, and the jumps over it. Deflections are less those of
    straight ribs without friction."""
    with style():
        drawing, grid = new_panels(2, 3, (11.4, 7.2))
        flat = list(grid.flat)
        for panel, head, paths, reference in zip(flat, heads, rows, references):
            _curves(panel, paths, reference)
            panel.set_title(head, fontsize=9)
            panel.set_ylabel("θ2 − θ2(0), less straight at μ = 0 [mrad]", fontsize=8)
        summary = flat[len(rows)]
        for model in MODELS:
            summary.plot(range(len(rows)), [abs(paths[model].jump_rad) * 1e3 for paths in rows], marker="o",
                         **{**LINES[model], "linewidth": 1.0}, label=MODELS[model])
        summary.set_xticks(range(len(rows)))
        summary.set_xticklabels([head.split("=")[-1].split()[0] for head in heads])
        summary.set_xlabel(label)
        summary.set_ylabel("|jump| of θ2 [mrad]")
        summary.set_title("state jump", fontsize=9)
        summary.set_ylim(bottom=0)
        strip = 0.3 / drawing.get_figheight()  # for the legend
        drawing.get_layout_engine().set(rect=(0, strip, 1, 1 - strip))
        drawing.legend(*flat[0].get_legend_handles_labels(), loc="lower center", ncol=4, frameon=False)
        for panel in flat[len(rows) + 1:]:
            panel.axis("off")
        drawing.suptitle(title, fontsize=11)
        return save(drawing, folder, name)


def table(head: str, marks: Sequence[str], rows: Sequence[dict[str, Cycle]]) -> list[str]:
    """Return a Markdown table of jumps, largest deflections and ranges."""
    lines = [f"| {head} | model | largest deflection [mrad] | range [mrad] | jump of θ2 [µrad] | largest bow [µm] |",
             "|---|---|---:|---:|---:|---:|"]
    for mark, paths in zip(marks, rows):
        for model, path in paths.items():
            jump = 1e6 * path.jump_rad
            lines.append(f"| {mark} | {MODELS[model]} | {1e3 * path.largest_rad:.3f} | {1e3 * path.range_rad:.3f} | "
                         f"{0.0 if abs(jump) < 0.05 else jump:.1f} | {1e6 * path.bow_m:.1f} |")
    return lines


HEAD = f"""# Umbrella rib that bends

`python3 -m studies.paper.bending_ribs` makes this page. It repeats Figures 13 to 16 of Chen et al. (2021) with ribs
that bend beside straight ones.

![Figure 13 with ribs that bend](fig13.png)

All models follow one cycle of 100 K with the quasi-static solver: Coulomb friction of {FRICTION:g}, clearance of
{CLEARANCE_M * 1e3:g} mm, torsion spring of {STIFFNESS_N_m_per_rad:g} N m/rad. A quasi-static path needs a loaded joint,
so the spring has a bias of {BIAS_rad:g} rad; stiffer springs have the same moment. The paper's spring has no bias, and
its rib moves dynamically; [its figures](../umbrella/README.md) show chaotic motions. Compare the models of this page
with each other, not with those figures.

Ribs that bend are {PARTS} beams each, with a square section of 3 mm, whose area is the paper's. With a warmer side, the
difference between both sides is {GRADIENT:g} of the temperature change. It rotates the free ends of the ribs against
their chords by 4.0 mrad (AB) and 7.9 mrad (CB). The chord of AB rotates by 5.6 mrad.

The curves of Figures 14 to 16 are the deflections less those of straight ribs without friction.

## Findings

- Bending alone changes the largest deflection by at most {{soft:.1%}}; with the spring of 100 N m/rad by {{stiff:.1%}}.
- Bending alone reduces the jump of Figure 13 from {{straight:.0f}} to {{bends:.0f}} µrad. The ribs follow a part of the
  rotation in the joint elastically, so less of it is slip.
- A gradient changes the state jump as much as clearance or friction do. With a warmer inner side, the jump of Figure
  13 is {{inside:.0f}} µrad. With a warmer outer side it is {{outside:.0f}} µrad: the ends of the ribs rotate so that
  the journal rolls without slip.
- The largest jumps are at other clearances and frictions than with straight ribs:

| figure | straight ribs | ribs that bend | outer side warmer | inner side warmer |
|---|---|---|---|---|
{{largest}}

- Without friction there is no jump in any model (Figure 15).
- Twice as many beams per rib change the largest deflections by at most {{mesh:.2%}}, and the jump of ribs that bend
  without gradient by {{mesh_jump:.1f}} µrad. The torsion spring acts on the last beam of each rib, over its length.
"""


@dataclass(frozen=True)
class Study:
    """A figure: the values of one parameter, and the cycles of all models, with a reference for each value."""

    name: str
    title: str
    column: str
    heads: list[str]
    label: str
    cycles: list[dict[str, Cycle]]
    references: list[Cycle]  # straight ribs without friction

    @property
    def marks(self) -> list[str]:
        """The values as text of the page."""
        return [head.replace("$K_M$", "K_M") for head in self.heads]


def studies() -> Iterator[Study]:
    """Run all models for Figures 14 to 16."""
    for key, values, name, column, head, label, scale in (
            ("clearance_m", CLEARANCES_M, "fig14", "clearance", "c = {:g} mm", "Clearance c [mm]", 1e3),
            ("friction", FRICTIONS, "fig15", "friction", "μ = {:g}", "Friction coefficient μ", 1.0),
            ("stiffness", SPRINGS, "fig16", "torsion spring", "$K_M$ = {:g} N m/rad", "Stiffness $K_M$ [N m/rad]",
             1.0)):
        yield Study(
            name, f"Fig. {name[3:]} with ribs that bend: {column}", column,
            [head.format(value * scale) for value in values], label,
            [{model: run(model, **{key: value}) for model in MODELS} for value in values],
            [run("straight", **{key: value, "friction": 0.0}) for value in values])


def _largest(study: Study) -> str:
    """Return the table row of the largest jumps of a figure."""
    cells = [study.name[3:]]
    for model in MODELS:
        jumps = [abs(1e6 * paths[model].jump_rad) for paths in study.cycles]
        cells.append(f"{max(jumps):.0f} µrad at {study.marks[int(np.argmax(jumps))]}" if max(jumps) > 0.05 else "none")
    return f"| {' | '.join(cells)} |"


def page(base: dict[str, Cycle], finer: dict[str, Cycle], done: Sequence[Study]) -> str:
    """Return the page.

    :param base: the models of Figure 13
    :param finer: ribs that bend, with twice as many beams
    """
    changes = [(abs(paths["bends"].largest_rad / paths["straight"].largest_rad - 1), head)
               for study in done for head, paths in zip(study.heads, study.cycles)]
    head = HEAD.format(
        soft=max(change for change, head in changes if "100 N" not in head),
        stiff=max(change for change, head in changes if "100 N" in head),
        **{model: abs(1e6 * path.jump_rad) for model, path in base.items()},
        mesh=max(abs(path.largest_rad / base[model].largest_rad - 1) for model, path in finer.items()),
        largest="\n".join(map(_largest, done)),
        mesh_jump=1e6 * abs(finer["bends"].jump_rad - base["bends"].jump_rad))
    lines = [head, "## Figure 13", "", *table("figure", ["13"], [base])]
    for study in done:
        lines += ["", f"## Figure {study.name[3:]}", "", f"![{study.title}]({study.name}.png)", "",
                  *table(study.column, study.marks, study.cycles)]
    return "\n".join(lines) + "\n"


def main() -> None:
    """Run all models; write figures and page."""
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else RESULTS
    folder.mkdir(parents=True, exist_ok=True)
    base = {model: run(model) for model in MODELS}
    finer = {model: run(model, parts=2 * PARTS) for model in MODELS if model != "straight"}
    figure_13(base, folder)
    done = list(studies())
    for study in done:
        figure(study.name, study.title, study.heads, study.cycles, study.references, study.label, folder)
    (folder / "README.md").write_text(page(base, finer, done), encoding="utf-8")


if __name__ == "__main__":
    main()
