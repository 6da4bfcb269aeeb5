#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Builds the documentation site: documents of the repository, notebooks of the tutorials, generated references.

    /usr/bin/python3 docs/site/make.py --build build

writes build/docs/html. The test adds ``--to FOLDER``, so that an existing site is not overwritten. Tutorials show the
outputs stored in the notebooks of docs/tutorials; notebooks.py executes these notebooks.

Sources of the references: Doxygen for C++ headers, the imported plugin for YADE classes, autodoc for Python, the
schemas for keys of case files, the help texts for commands. Errors are: a warning, a broken link, a page missing from
the sidebar, and a name in the table of symbols without documentation.
"""
from __future__ import annotations

import argparse
import os
import pkgutil
import re
import shutil
import subprocess
import sys
from pathlib import Path

sys.dont_write_bytecode = True
HERE = Path(__file__).resolve().parent
REPOSITORY = HERE.parents[1]
sys.path.insert(0, str(HERE))
import cpp_pages  # noqa: E402 - these are beside this file
import documents  # noqa: E402
import notebooks  # noqa: E402

DOXYFILE = """
QUIET = YES
WARNINGS = NO
WARN_IF_DOC_ERROR = NO
WARN_IF_INCOMPLETE_DOC = NO
GENERATE_HTML = NO
GENERATE_LATEX = NO
GENERATE_XML = YES
XML_PROGRAMLISTING = NO
RECURSIVE = YES
EXTRACT_ALL = YES
HIDE_FRIEND_COMPOUNDS = YES
EXCLUDE_SYMBOLS = *::detail *::detail::*
ENABLE_PREPROCESSING = YES
MARKDOWN_SUPPORT = YES
MAX_INITIALIZER_LINES = 0
"""
REFERENCE = "docs/reference"
MATHJAX = Path("/usr/share/javascript/mathjax")
# What the configuration TeX-AMS_CHTML loads: 3 of the 50 MB.
MATHJAX_PARTS = ("MathJax.js", "config/TeX-AMS_CHTML.js", "extensions", "jax/element", "jax/input/TeX",
                 "jax/output/CommonHTML", "fonts/HTML-CSS/TeX/woff")
STYLE = """
div.output { overflow-x: auto; }
div.output table { font-size: 0.85em; border-collapse: collapse; }
div.output td, div.output th { padding: 0.1em 0.6em; text-align: right; }
div.output.highlight, div.output > .highlight { border-left: 3px solid #888; }
"""


def heading(text: str, mark: str = "=") -> str:
    """Return a heading of a page."""
    return f"{text}\n{mark * len(text)}\n"


def doxygen(folder: Path) -> Path:
    """Run Doxygen on the public headers; return the folder of the XML files."""
    inputs = " ".join(f'"{REPOSITORY / place}"' for place in cpp_pages.FOLDERS)
    settings = f'{DOXYFILE}INPUT = {inputs}\nOUTPUT_DIRECTORY = "{folder}"\n'
    settings += f"STRIP_FROM_PATH = {inputs}\n"
    subprocess.run(["doxygen", "-"], input=settings, text=True, check=True)
    return folder / "xml"


def python_pages(build: Path) -> dict[str, str]:
    """Return the texts of the Python pages by name: one page per sub-package, and ``index`` for the package."""
    package = build / "python" / "statejump"
    found = [module for module in pkgutil.walk_packages([str(package)], "statejump.")
             if not module.name.rsplit(".", 1)[1].startswith("_")]
    packages = ["statejump"] + [module.name for module in found if module.ispkg]
    made = {}
    for name in packages:
        modules = [name] + sorted(module.name for module in found
                                  if not module.ispkg and module.name.rpartition(".")[0] == name)
        title = "Python package" if name == "statejump" else name
        lines = [heading(title)]
        for module in modules:
            lines += [heading(module, "-"), f".. automodule:: {module}\n   :members:\n   :ignore-module-all:\n"]
        if name == "statejump":
            lines += [heading("Sub-packages", "-"), ".. toctree::\n   :maxdepth: 1\n",
                      *(f"   {other}" for other in packages[1:]), ""]
        made["index" if name == "statejump" else name] = "\n".join(lines)
    return made


def tutorial_pages(source: Path) -> None:
    """Replace the tutorials among the copied documents by their notebooks with outputs."""
    for path in notebooks.tutorials():
        target = source / path.relative_to(REPOSITORY)
        # The staged text, not the repository's: its links are those of the site.
        text = target.read_text(encoding="utf-8")
        made = notebooks.with_outputs(notebooks.notebook(text), path.with_suffix(".ipynb"))
        target.with_suffix(".ipynb").write_text(notebooks.stored(made), encoding="utf-8")
        first, _, rest = notebooks.page(made, path.stem, target.parent).partition("\n")
        note = f"Download this page as an executed {{download}}`Jupyter notebook <{path.stem}.ipynb>`."
        target.write_text(f"{first}\n\n{note}\n{rest}", encoding="utf-8")


def static_files(folder: Path) -> None:
    """Write the style sheet and copy the needed files of Debian's MathJax, so that formulas need no network."""
    folder.mkdir(parents=True)
    (folder / "statejump.css").write_text(STYLE, encoding="utf-8")
    for part in MATHJAX_PARTS:
        target = folder / "mathjax" / part
        target.parent.mkdir(parents=True, exist_ok=True)
        if (MATHJAX / part).is_dir():
            shutil.copytree(MATHJAX / part, target)
        else:
            shutil.copy(MATHJAX / part, target)


def check_references(site: Path) -> None:
    """End the program if a reference in the table of symbols is broken. Sphinx would show it as text, without a
    warning."""
    names = (site / REFERENCE / "names.html").read_text(encoding="utf-8")
    for domain, page in (("cpp", r"cpp/\w+"), ("py", "yade")):
        wanted = len(re.findall(f'class="xref {domain} ', names))
        link = f'<a class="reference internal" href="{page}\\.html#[^>]*><code class="xref {domain} '
        found = len(re.findall(link, names))
        if not 0 < found == wanted:
            sys.exit(f"names: {found} of {wanted} references to {domain} lead somewhere")


def main() -> None:
    """Build the site."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", type=Path, default=REPOSITORY / "build")
    parser.add_argument("--to", type=Path, help="folder of the site; default: docs in the build tree")
    arguments = parser.parse_args()
    build = arguments.build.resolve()
    os.environ["PYTHONPATH"] = str(build / "python")
    os.environ["PYTHONDONTWRITEBYTECODE"] = "1"
    sys.path.insert(0, str(build / "python"))
    import command_pages  # these need the package
    import key_pages

    folder = (arguments.to or build / "docs").resolve()
    shutil.rmtree(folder, ignore_errors=True)
    source = folder / "source"
    reference = source / REFERENCE
    reference.mkdir(parents=True)
    shutil.copy(HERE / "conf.py", source)
    static_files(source / "_static")
    wrong = documents.stage(REPOSITORY, source)
    wrong += command_pages.unlisted((REPOSITORY / "docs" / "reference" / "commands.md").read_text(encoding="utf-8"))
    if wrong:
        sys.exit("\n".join(wrong))
    tutorial_pages(source)

    members = doxygen(folder)
    subprocess.run(
        ["yade", "-n", "-x", str(HERE / "yade_page.py")], check=True, stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL, env={**os.environ, "STATEJUMP_PAGE": str(reference / "yade.rst")},
    )
    if not (reference / "yade.rst").exists():
        sys.exit("the page of the YADE classes was not written: does the plugin load?")
    for part, pages in ("cpp", cpp_pages.pages(REPOSITORY, members)), ("python", python_pages(build)):
        (reference / part).mkdir()
        for name, text in pages.items():
            (reference / part / f"{name}.rst").write_text(text, encoding="utf-8")
    for name, text in (
        ("keys", key_pages.keys_page()),
        ("columns", key_pages.columns_page()),
        ("help", command_pages.help_page()),
        ("names", key_pages.symbols_page((REPOSITORY / REFERENCE / "symbols.md").read_text(encoding="utf-8"), members,
                                         (reference / "yade.rst").read_text(encoding="utf-8"))),
    ):
        (reference / f"{name}.rst").write_text(text, encoding="utf-8")
    documents.add_way(source, {"Reference": [
        ("Keys of case files", f"{REFERENCE}/keys"), ("Columns of histories", f"{REFERENCE}/columns"),
        ("Where each name is documented", f"{REFERENCE}/names"),
        ("Options of the commands", f"{REFERENCE}/help"), ("Python package", f"{REFERENCE}/python/index"),
        ("YADE classes", f"{REFERENCE}/yade"), ("C++ headers", f"{REFERENCE}/cpp/index"),
    ]})

    done = subprocess.run(
        ["/usr/bin/python3", "-m", "sphinx", "-q", "-W", "--keep-going", "-j", "auto", "-b", "html",
         "-D", f"breathe_projects.statejump={members}", str(source), str(folder / "html")],
    )
    if done.returncode:
        sys.exit("the documentation has warnings")
    check_references(folder / "html")
    (folder / "html" / "index.html").write_text(
        '<!DOCTYPE html><meta charset="utf-8"><title>statejump</title>'
        '<meta http-equiv="refresh" content="0; url=docs/index.html"><a href="docs/index.html">statejump</a>\n',
        encoding="utf-8")
    print(folder / "html" / "index.html")


if __name__ == "__main__":
    main()
