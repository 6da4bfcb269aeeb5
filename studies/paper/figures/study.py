# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes Figures 13 to 16: starts all runs, and writes each file as soon as its runs are finished."""
from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from statejump.core.errors import Interrupted
from statejump.core.results_folder import Results
from statejump.kinds.umbrella.case import UmbrellaCase
from studies.paper import ensembles
from studies.paper.claims.findings import Findings
from studies.paper.claims.measures import all_claims
from studies.paper.common import made_by, refused
from studies.paper.figures.drawing import figure_13, figure_of
from studies.paper.figures.files import write_claims, write_curves, write_ensembles
from studies.paper.figures.findings import findings_of
from studies.paper.figures.runs import Part, Study, Variant, first_contacts, run_variants, stiffness_jumps, studies


@dataclass(frozen=True)
class Figures:
    """Verdicts on the claims of the paper, and the written files."""

    findings: Findings
    written: list[Path]

    def summary_lines(self) -> list[str]:
        """Return the verdicts, as a command prints them."""
        return [f"{claim.verdict}: {claim.statement}" for claim in all_claims(self.findings)]


def make(case: UmbrellaCase, results: Results, part: Part) -> Figures:
    """Run all parts; write each file as soon as its runs are finished.

    :param results: root of the results; gets a folder named after the case
    :param part: called with the name and the number of runs of each part
    :raises NotAllowed: the figures do not support the case
    :raises Interrupted: Ctrl-C; the message names the finished files
    """
    if case.start.mode == "loaded":
        raise refused(case, "start.mode", "loaded", "the figures vary what would load the joint")
    command = made_by("figures", case)
    original, case = case, ensembles.for_ensemble(case)
    written: list[Path] = []
    with results.folder(case.name, original) as folder:
        try:
            known: dict[str, Variant] = {}
            itself = Study("fig13", "joint.radial_clearance_m", (case.joint.radial_clearance_m,), "", "", "")
            (base,) = run_variants(case, itself, known, part)
            with part("fig13, DEM ensemble", case.ensemble.dem_runs) as step:
                dem_ensemble = ensembles.dem_ensemble(case, progress=step)
            written += folder.publish(figure_13(base, dem_ensemble, case.title, folder.staged))
            done = []
            for study in studies(case):
                variants = run_variants(case, study, known, part)
                figure = figure_of(study, variants, case.title, folder.staged)
                done.append((study, variants))
                write_curves(done, folder.staged)
                write_ensembles(done, dem_ensemble, base, folder.staged)
                written += folder.publish(figure)
            contacts = first_contacts(case, [variant.value for variant in done[0][1]], part)
            stiffness = stiffness_jumps(case, base, part)
            findings = findings_of(case, done, base, dem_ensemble, contacts, stiffness)
            write_claims(case, command, findings, folder.staged)
            folder.publish()
        except (KeyboardInterrupt, Interrupted):
            finished = ", ".join(path.name for path in written if path.suffix == ".png") or "nothing"
            raise Interrupted(f"interrupted; finished in {folder.path}: {finished}") from None
    written += [folder.path / name for name in ("curves.csv", "ensembles.csv", "ensembles.json", "README.md")]
    return Figures(findings, written)
