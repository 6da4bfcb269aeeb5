# SPDX-License-Identifier: GPL-3.0-or-later
"""Campaigns with ``yade-batch``: parameter table, and data for its script."""
from __future__ import annotations

import json
from pathlib import Path
from typing import Any
from urllib.parse import quote, unquote

from statejump.campaign.campaign_file import load_campaign
from statejump.campaign.plan import MONTECARLO, Plan
from statejump.core.errors import NotAllowed
from statejump.core.output import write_atomically
from statejump.core.samples import read_samples
from statejump.kinds import of, require
from statejump.kinds.loading import parse_case
from statejump.kinds.protocol import DemResult
from statejump.schema.paths import filled


def column_of(path: str) -> str:
    """Return the column name of a varied key in a table of yade-batch, which requires names of Python variables."""
    return path.replace(".", "__")


def write_table(campaign: Plan, path: Path) -> None:
    """Write the table of yade-batch with one line per sample, for ``yade_scripts/runner/batch_case.py``.

    That script reads the values from the columns, and the case and the names of outcomes from the campaign file.
    """
    if campaign.file is None or "dem" not in of(campaign.case).campaign_models():
        raise NotAllowed("--yade-batch", code="no_yade_batch_of_kind", file=campaign.file, kind=campaign.case.kind)
    columns = [column_of(parameter.keys[0]) for parameter in campaign.vary]
    # Values in the table must not contain blanks or '#'.
    file = quote(str(campaign.file.resolve()))
    with write_atomically(path) as stream:
        stream.write(f"# statejump {campaign.command} {campaign.name}: {campaign.samples} samples\n")
        stream.write(" ".join(["description", "campaign", "command", "sample", *columns]) + "\n")
        for index in range(campaign.samples):
            cells = [f"sample_{index}", f"'{file}'", f"'{campaign.command}'", index, *campaign.values(index)]
            stream.write(" ".join(map(str, cells)) + "\n")


class BatchSample:
    """One line of the table, for the script that runs it."""

    def __init__(self, line: dict[str, Any]) -> None:
        """:raises StatejumpError: the campaign file or the sampled case is invalid"""
        path, command = Path(unquote(line["campaign"])), line.get("command", MONTECARLO)
        self.campaign, self.index = load_campaign(path, command), int(line["sample"])
        self.case = parse_case(filled(self.campaign.case_data, [
            (key, line[column_of(parameter.keys[0])]) for parameter in self.campaign.vary for key in parameter.keys
        ]))

    def dem_values(self) -> dict[str, Any]:
        """Return what the scene needs."""
        return of(self.case).dem_values(self.case)

    def outcomes(self, samples: Path) -> dict[str, float]:
        """Return the outcomes of a DEM run from its file of samples and from the JSON file beside it."""
        about = json.loads(samples.with_name(samples.name + ".json").read_text(encoding="utf-8"))
        case = self.case
        run = require(case, DemResult).dem_run(case, read_samples(samples), about)
        found: dict[str, float] = of(case).recorded(case, run)
        return found
