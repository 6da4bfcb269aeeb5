# SPDX-License-Identifier: GPL-3.0-or-later
"""Page and tables of the checks of a body."""
from __future__ import annotations

from base64 import b64encode
from html import escape
from pathlib import Path

from statejump.bodies.figure import drawn
from statejump.bodies.quantities import BodyCheck
from statejump.core.figures import save
from statejump.core.output import write_atomically
from statejump.core.tables import html_table, write_csv

HEAD = """<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"><title>{title}</title>
<style>body {{ font: 15px/1.45 system-ui, sans-serif; max-width: 75em; margin: 2em auto; padding: 0 1em; }}
table {{ border-collapse: collapse; }}
td, th {{ padding: .15em .8em; border-bottom: 1px solid #ddd; text-align: left; }}
img {{ max-width: 100%; }}</style></head><body>
"""


def write(checked: BodyCheck, folder: Path, name: str) -> list[Path]:
    """Write ``check.csv``, ``shapes.png``, ``shapes.svg`` and the page ``check.html``; return their paths."""
    table = write_csv(folder / "check.csv", ("quantity", "value", "unit", "bound", "passed"),
                      [(row.name, row.value, row.unit, row.bound, row.passed) for row in checked.rows])
    pictures = save(drawn(checked.body, checked), folder, "shapes")
    parts = [HEAD.format(title=escape(name)), f"<h1>{escape(name)}</h1><p>{escape(checked.body.source)}</p>"]
    parts += [f"<p>warning: {escape(note)}</p>" for note in checked.body.notes]
    for shown in checked.tables():
        parts.append(f"<h2>{escape(shown.title)}</h2>{html_table(shown.header, shown.rows)}")
    image = b64encode(pictures[0].read_bytes()).decode("ascii")
    parts.append(f'<h2>Free shapes and modes</h2><img alt="shapes" src="data:image/png;base64,{image}">')
    page = folder / "check.html"
    with write_atomically(page) as stream:
        stream.write("\n".join([*parts, "</body></html>\n"]))
    return [page, table, *pictures]
