# SPDX-License-Identifier: GPL-3.0-or-later
"""The command ``report``."""
from __future__ import annotations

import os
from pathlib import Path

import click
import numpy as np

from statejump.cli.terminal import QUIET, loaded, make_console
from statejump.core.errors import Unreadable
from statejump.core.output import check_suffix
from statejump.results.layout import SUFFIX

PAGE = "report.html"
BUDGET_BYTES = 7e6  # size of the histories of all runs [bytes]; a page stays below 10 MB


def result_files(run: Path) -> list[Path]:
    """Return the result files that an argument means: a file itself, or the files in a results folder or in its
    subfolders. In a folder, a comparison supersedes the files of single models, but not the answers on a truss.

    :raises Unreadable: the folder contains no result file
    """
    if not os.path.isdir(run):
        return [run]
    for pattern in (f"*{SUFFIX}", f"*/*{SUFFIX}"):
        found = sorted(run.glob(pattern))
        if found:
            compared = {path.parent for path in found if path.stem == "comparison"}
            return [path for path in found if path.parent not in compared or path.stem in ("comparison", "answers")]
    raise Unreadable(code="result_file_missing", file=run, suffix=SUFFIX)


def _target(output: Path | None, runs: tuple[Path, ...], files: list[Path]) -> Path:
    if output is not None:
        return output / PAGE if os.path.isdir(output) else output
    if len(runs) == 1 and os.path.isdir(runs[0]):
        return runs[0] / PAGE
    return files[0].parent / PAGE if len(files) == 1 else Path(PAGE)


def _source(file: Path, files: list[Path]) -> str:
    """Return the name of a file on the page: the file name, with its folder if the page has several files."""
    return file.name if len(files) == 1 else f"{file.absolute().parent.name}/{file.name}"


@click.command("report")
@click.argument("runs", metavar="RUN...", nargs=-1, required=True, type=click.Path(path_type=Path))
@click.option(
    "-o", "--output", type=click.Path(path_type=Path),
    help=f"The page.  [default: {PAGE} beside the run, of several runs in the current folder]",
)
@QUIET
def report_command(runs: tuple[Path, ...], output: Path | None, quiet: bool) -> None:
    """One HTML page of RUN...: comparison, loops, events, energies, 3-D replay; of a campaign its
    distributions. A RUN is a result file, a campaign's samples.h5 or a results folder, or the case file
    of a truss that is not solved yet; the page needs nothing beside it, no network either.

    \b
    Example:
      statejump report results/table1
    """
    from statejump.report import page  # imports Jinja2 and the report (0.3 s), which --help does not need
    from statejump.report.campaign import CampaignDocument, is_campaign  # as page
    from statejump.report.document import Document, of_file  # as page
    from statejump.report.unsolved import UnsolvedDocument, is_case  # as page

    console = make_console(quiet)
    if output is not None and not os.path.isdir(output):
        check_suffix("--output", output, ".html", ".htm")
    files = list(dict.fromkeys(path for run in runs for path in result_files(run)))
    with np.errstate(over="ignore", invalid="ignore"):  # the page refuses numbers that are not finite
        documents: list[Document | CampaignDocument | UnsolvedDocument] = [
            UnsolvedDocument(loaded(path), _source(path, files), f"run{place}") if is_case(path)
            else CampaignDocument(path, f"run{place}", _source(path, files)) if is_campaign(path)
            else of_file(path, _source(path, files), f"run{place}", BUDGET_BYTES / len(files))
            for place, path in enumerate(files, start=1)
        ]
        target = _target(output, runs, files)
        page.write(documents, target)
    for document in documents:
        if isinstance(document, UnsolvedDocument):
            continue
        if isinstance(document, CampaignDocument):
            console.print(f"{document.title}: {document.samples:,} samples, {len(document.failed):,} failed")
            continue
        for kept in document.kept:
            console.print(
                f"{document.result.name}, {kept.model}: {kept.kept:,} of {kept.samples:,} samples kept, "
                f"error {kept.error:.2g} of a column's range"
            )
    console.print(f"page: {target} ({target.stat().st_size / 1e6:.2f} MB)")
