# SPDX-License-Identifier: GPL-3.0-or-later
"""Campaigns in YADE's own way: a parameter table for ``yade-batch`` and what its script needs."""
from __future__ import annotations

import json
from pathlib import Path
from typing import Any
from urllib.parse import quote, unquote

from statejump.core import yade_process as dem
from statejump.kinds.registry import parse_case
from statejump.core.errors import StatejumpError
from statejump.core.history import History
from statejump.core.output import write_atomically
from statejump.campaign.campaign_file import MONTECARLO, Campaign, load_campaign
from statejump.campaign.outcomes import KINDS
from statejump.campaign.work import NAME


def column_of(path: str) -> str:
    """Column of a varied key: yade-batch wants names of Python variables."""
    return path.replace(".", "__")


def write_table(campaign: Campaign, path: Path) -> None:
    """Write the table: one line per sample, to be run by ``yade_scripts/runner/batch_case.py``.

    The script takes the values from their columns; the campaign file tells case and outcomes.
    """
    if KINDS[campaign.case.kind].of_dem_run is None:
        raise StatejumpError(f"{campaign.file}: --yade-batch is not allowed: no such campaign runs {campaign.case.kind!r}")
    columns = [column_of(parameter.keys[0]) for parameter in campaign.vary]
    # Tables have neither blanks nor '#' in a value.
    file = quote(str(campaign.file.resolve()))
    with write_atomically(path) as stream:
        stream.write(f"# statejump {campaign.command} {campaign.name}: {campaign.samples} samples\n")
        stream.write(" ".join(["description", "campaign", "command", "sample", *columns]) + "\n")
        for index in range(campaign.samples):
            cells = [f"sample_{index}", f"'{file}'", f"'{campaign.command}'", index, *campaign.values(index)]
            stream.write(" ".join(map(str, cells)) + "\n")


class BatchSample:
    """One line of the table, for the script."""

    def __init__(self, line: dict[str, Any]) -> None:
        """:raises StatejumpError: the campaign file or the sampled case is bad"""
        path, command = Path(unquote(line["campaign"])), line.get("command", MONTECARLO)
        self.campaign, self.index = load_campaign(path, command), int(line["sample"])
        data = {section: dict(keys) for section, keys in self.campaign.case_data.items()}
        for parameter in self.campaign.vary:
            value = line[column_of(parameter.keys[0])]
            for key in parameter.keys:
                section, name = key.split(".")
                data.setdefault(section, {})[name] = value
        self.case = parse_case(data, NAME)
        self.kind = KINDS[self.case.kind]

    def resolved(self) -> dict[str, Any]:
        """What the scene needs."""
        return self.kind.resolved(self.case)

    def outcomes(self, history: Path) -> dict[str, float]:
        """Outcomes of a run that left its history, and its summary beside it."""
        summary = json.loads(history.with_name(history.name + ".json").read_text(encoding="utf-8"))
        return self.kind.of_dem_run(self.case, dem.DemRun(History.read_csv(history), summary))
