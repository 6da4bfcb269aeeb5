#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes a Jupyter notebook from the Markdown page of each tutorial.

    /usr/bin/python3 docs/site/notebooks.py                      writes docs/tutorials/NAME.ipynb, without outputs
    /usr/bin/python3 docs/site/notebooks.py --run build NAME...  with outputs, and the last figure as NAME.png
    /usr/bin/python3 docs/site/notebooks.py --check build NAME   runs it, writes nothing; campaigns have 40 samples

A notebook whose cells did not change keeps its outputs. Blocks of a tutorial:

```python     a cell; all of them share one process
```bash       a cell that bash runs, with statejump on PATH and the repository in $REPOSITORY
```yade       a script in a YADE of its own: a cell that writes it, and one that runs it
```X file=N   a cell that writes the file N
```text       every line must be part of a line that the cell before it printed, in this order
```X          shown only
"""
from __future__ import annotations

import argparse
import base64
import copy
import hashlib
import itertools
import os
import re
import sys
import tempfile
from pathlib import Path

import nbformat
from nbformat import NotebookNode
from nbformat.v4 import new_code_cell, new_markdown_cell, new_notebook

REPOSITORY = Path(__file__).resolve().parents[2]
TUTORIALS = REPOSITORY / "docs" / "tutorials"
BLOCK = re.compile(r"^```([a-z+]*)(?: file=(\S+))?\n(.*?)^```$\n?", re.MULTILINE | re.DOTALL)
# The start message of YADE, with ports and cookies that differ from run to run.
YADES_GREETING = re.compile(
    "Welcome to Yade|Using python version|TCP python prompt|XMLRPC info provider|Running script")
RUN_FOLDER = re.compile(r"/\S*/statejump-notebook-\w+/(run|jupyter)/")
SAMPLES = re.compile(r"(statejump montecarlo .* --samples) \d+")
TIMEOUT_S = 1200  # of a cell; the longest, a thousand masts, takes two minutes on two idle cores


def tutorials() -> list[Path]:
    """Return the sources of all tutorials."""
    return sorted(TUTORIALS.glob("*.md"))


def notebook(text: str) -> NotebookNode:
    """Return the notebook of a page, without outputs. The metadata ``prints`` of a cell holds the lines it must print.
    """
    cells: list[NotebookNode] = []
    shown: list[str] = []

    def add(cell: NotebookNode) -> None:
        # The same page gives the same file: identifiers count, they are not drawn.
        cell["id"] = f"cell-{len(cells)}"
        cells.append(cell)

    def flush() -> None:
        source = "".join(shown).strip("\n")
        shown.clear()
        if source:
            add(new_markdown_cell(source))

    last = 0
    for match in BLOCK.finditer(text):
        shown.append(text[last:match.start()])
        last = match.end()
        language, file, body = match[1], match[2], match[3].rstrip("\n")
        if file:
            codes = [f"%%writefile {file}\n{body}"]
        elif language == "yade":
            file = f"script_{1 + sum(cell.source.startswith('%%writefile script_') for cell in cells)}.py"
            codes = [f"%%writefile {file}\n{body}", f"%%bash -eu\nyade -n -x {file} </dev/null"]
        elif language == "bash":
            codes = [f"%%bash -eu\n{body}"]
        elif language == "python":
            codes = [body]
        elif language == "text":
            flush()
            cells[-1 if cells[-1].cell_type == "code" else -2].metadata["prints"] = body.splitlines()
            continue
        else:
            shown.append(match[0])
            continue
        flush()
        for code in codes:
            add(new_code_cell(code))
    shown.append(text[last:])
    flush()
    made = new_notebook(cells=cells)
    made.metadata["kernelspec"] = {"name": "python3", "display_name": "Python 3", "language": "python"}
    made.metadata["language_info"] = {"name": "python"}
    return made


def stored(made: NotebookNode) -> str:
    """Return the text of a notebook's file."""
    return nbformat.writes(made) + "\n"


def executed(made: NotebookNode, build: Path) -> NotebookNode:
    """Run a notebook in an empty folder, with the package of a build tree; return it with outputs.

    :raises SystemExit: a cell fails, or does not print the lines that its page shows
    """
    from nbclient import NotebookClient
    from nbclient.exceptions import CellExecutionError

    build = build.resolve()
    with tempfile.TemporaryDirectory(prefix="statejump-notebook-") as folder:
        private = Path(folder, "jupyter")
        place = Path(folder, "run")
        place.mkdir()
        private.mkdir()
        os.environ["JUPYTER_RUNTIME_DIR"] = str(private)
        environment = dict(
            os.environ, REPOSITORY=str(REPOSITORY), PYTHONDONTWRITEBYTECODE="1", IPYTHONDIR=str(private),
            PYTHONPATH=f"{build / 'python'}:.", PATH=f"{build / 'bin'}:/usr/bin:{os.environ['PATH']}",
            XDG_DATA_HOME=str(private), STATEJUMP_LAWS="",  # laws of one's own stay in this folder
        )
        try:
            client = NotebookClient(made, timeout=TIMEOUT_S, resources={"metadata": {"path": str(place)}})
            client.execute(env=environment)
        except CellExecutionError as error:
            raise SystemExit(str(error)) from None
    for cell in made.cells:
        if cell.cell_type == "code":
            printed = _printed(cell)
            # yade ends with status 0 whatever happens in a script.
            if "Traceback (most recent call last)" in printed:
                raise SystemExit(f"a script failed:\n{printed}")
            line = _missing(cell.metadata.get("prints", []), printed)
            if line is not None:
                raise SystemExit(f"the cell\n\n{cell.source}\n\ndid not print {line!r}, but\n\n{printed}")
    return made


def _printed(cell: NotebookNode) -> str:
    parts = []
    for output in _joined(cell.outputs):
        if output.output_type == "stream":
            parts.append(output.text)
        elif "data" in output:
            parts.append(output.data.get("text/plain", ""))
    return "\n".join(parts)


def _missing(wanted: list[str], printed: str) -> str | None:
    """Return the first wanted line that was not printed in this order; None: all were printed."""
    lines = iter(printed.splitlines())
    for line in wanted:
        if not any(line in given for given in lines):
            return line
    return None


def page(made: NotebookNode, name: str, folder: Path) -> str:
    """Return an executed notebook as Markdown for Sphinx; its pictures are written into ``folder``."""
    parts = []
    for cell in made.cells:
        if cell.cell_type == "markdown":
            parts.append(cell.source)
            continue
        first = cell.source.partition("\n")[0]
        language = "bash" if first.startswith("%%bash") else "python"
        source = cell.source
        if first.startswith("%%writefile "):
            parts.append(f"File `{first.split()[1]}`:")
            language = "cpp" if first.endswith((".hpp", ".cpp")) else "toml" if first.endswith(".toml") else "python"
        if first.startswith("%%"):
            source = source.partition("\n")[2]
        parts.append(f"```{language}\n{source}\n```")
        if first.startswith("%%writefile "):
            continue  # which says that it was written
        for output in _joined(cell.outputs):
            if output.output_type == "stream":
                parts.append(_text(output.text))
            elif "image/png" in output.get("data", {}):
                data = base64.b64decode(output.data["image/png"])
                picture = f"{name}_{hashlib.sha256(data).hexdigest()[:12]}.png"
                (folder / picture).write_bytes(data)
                parts.append(f"![output of the cell above]({picture})")
            elif "text/html" in output.get("data", {}):
                parts.append(f"````{{raw}} html\n<div class=\"output\">{output.data['text/html']}</div>\n````")
            elif "text/plain" in output.get("data", {}):
                parts.append(_text(output.data["text/plain"]))
    return "\n\n".join(part for part in parts if part) + "\n"


def _joined(outputs: list[NotebookNode]) -> list[NotebookNode]:
    """Return the outputs with adjacent printed pieces joined, standard output before standard error. The kernel splits
    printed text differently in each run."""
    found: list[NotebookNode] = []
    for is_stream, some in itertools.groupby(outputs, lambda output: output.output_type == "stream"):
        if not is_stream:
            found.extend(some)
            continue
        streams: dict[str, NotebookNode] = {}
        for output in some:
            if output.name in streams:
                streams[output.name].text += output.text
            else:
                streams[output.name] = output.copy()
        found.extend(streams[name] for name in ("stdout", "stderr") if name in streams)
    return found


def _plain(text: str) -> list[str]:
    lines = re.sub("\x1b\\[[0-9;]*m", "", text).splitlines()  # without colours
    return [line for line in lines if not YADES_GREETING.match(line)]


def _text(text: str) -> str:
    plain = "\n".join(_plain(text))
    return f"````{{code-block}} text\n:class: output\n\n{plain}\n````" if plain.strip() else ""


def without_outputs(made: NotebookNode) -> NotebookNode:
    """Return a copy of a notebook without outputs."""
    bare = copy.deepcopy(made)
    for cell in bare.cells:
        if cell.cell_type == "code":
            cell.outputs, cell.execution_count = [], None
    return bare


def shared(made: NotebookNode) -> NotebookNode:
    """Return an executed notebook to commit: times, versions, folders and YADE's start message are removed."""
    made.metadata["language_info"] = {"name": "python"}
    for cell in made.cells:
        cell.metadata.pop("execution", None)
        if cell.cell_type == "code":
            cell.outputs = _joined(cell.outputs)
            for output in cell.outputs:
                if output.output_type == "stream":
                    output.text = "".join(RUN_FOLDER.sub("", line) + "\n" for line in _plain(output.text))
    return made


def with_outputs(made: NotebookNode, stored_file: Path) -> NotebookNode:
    """Return a notebook with the outputs of a stored notebook.

    :raises SystemExit: their cells differ
    """
    kept = [cell for cell in nbformat.read(stored_file, as_version=4).cells if cell.cell_type == "code"]
    cells = [cell for cell in made.cells if cell.cell_type == "code"]
    if [cell.source for cell in kept] != [cell.source for cell in cells]:
        raise SystemExit(f"{stored_file.name}: not the notebook of its page; run docs/site/notebooks.py --run BUILD")
    for cell, before in zip(cells, kept):
        cell.outputs, cell.execution_count = before.outputs, before.execution_count
    return made


def last_figure(made: NotebookNode) -> bytes | None:
    """Return the last figure of an executed notebook as PNG."""
    figures = [output.data["image/png"] for cell in made.cells if cell.cell_type == "code" for output in cell.outputs
               if "image/png" in output.get("data", {})]
    return base64.b64decode(figures[-1]) if figures else None


def write(source: Path, build: Path | None) -> None:
    """Write the notebook of a page; if a build tree is given, execute it and write its last figure too."""
    target = source.with_suffix(".ipynb")
    made = notebook(source.read_text(encoding="utf-8"))
    if build is not None:
        made = shared(executed(made, build))
        picture = last_figure(made)
        if picture is not None:
            source.with_suffix(".png").write_bytes(picture)
    elif target.exists():
        before = nbformat.read(target, as_version=4)
        if stored(without_outputs(before)) == stored(made):
            return
    target.write_text(stored(made), encoding="utf-8")
    print(target.relative_to(REPOSITORY), file=sys.stderr)


def main() -> None:
    """Write the notebooks beside their pages, or run them."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--run", type=Path, metavar="BUILD", help="build tree whose package executes the notebooks")
    parser.add_argument("--check", type=Path, metavar="BUILD", help="run and write nothing; campaigns have 40 samples")
    parser.add_argument("names", nargs="*", help="tutorials; all if none is given")
    given = parser.parse_args()
    for source in tutorials():
        if given.names and source.stem not in given.names:
            continue
        if given.check:
            executed(notebook(SAMPLES.sub(r"\g<1> 40", source.read_text(encoding="utf-8"))), given.check)
        else:
            write(source, given.run)


if __name__ == "__main__":
    main()
