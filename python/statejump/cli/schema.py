# SPDX-License-Identifier: GPL-3.0-or-later
"""``statejump schema``: JSON Schemas of case and campaign files."""
from __future__ import annotations

from pathlib import Path

import click

from statejump.core.output import check_suffix, write_atomically
from statejump.schema.json_schema import ANY, schema, to_json, write_all


@click.command("schema")
@click.argument("kind", metavar="[KIND]", default=ANY)
@click.option("-o", "--output", metavar="FILE", type=click.Path(path_type=Path), help="File to write instead.")
@click.option("--all", "folder", metavar="FOLDER", type=click.Path(path_type=Path, file_okay=False),
              help="Write every schema into a folder.")
def schema_command(kind: str, output: Path | None, folder: Path | None) -> None:
    """JSON Schema of case files of KIND, or of campaigns: case (every kind), spring_slider, umbrella,
    statics, truss, montecarlo, sweep; or of design files: design.

    \b
    Examples:
      statejump schema truss
      statejump schema -o case.schema.json
    """
    if folder is not None:
        write_all(folder)
        return
    text = to_json(schema(kind))
    if output is None:
        click.echo(text, nl=False)
        return
    check_suffix("--output", output, ".json")
    with write_atomically(output) as stream:
        stream.write(text)
