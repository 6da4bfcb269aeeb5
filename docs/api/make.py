#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Builds the API reference: C++ headers by Doxygen, YADE classes by importing the plugin, Python by autodoc.

    /usr/bin/python3 docs/api/make.py --build build

writes build/docs/html. A warning is an error; so is a symbol of the README's table that is documented nowhere.
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
import cpp_pages  # noqa: E402 - beside this file

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


def heading(text: str, mark: str = "=") -> str:
    """Return a heading of a page."""
    return f"{text}\n{mark * len(text)}\n"


def doxygen(folder: Path) -> Path:
    """Run Doxygen on the public headers; return the folder of its XML."""
    inputs = " ".join(f'"{REPOSITORY / place}"' for place in cpp_pages.FOLDERS)
    settings = f'{DOXYFILE}INPUT = {inputs}\nOUTPUT_DIRECTORY = "{folder}"\n'
    settings += f"STRIP_FROM_PATH = {inputs}\n"
    subprocess.run(["doxygen", "-"], input=settings, text=True, check=True)
    return folder / "xml"


def python_pages(build: Path) -> dict[str, str]:
    """Return the pages of the Python package: name to text, one page per sub-package and ``index`` for the package."""
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
        if name == "statejump":
            lines += [".. toctree::\n   :maxdepth: 1\n", *(f"   {other}" for other in packages[1:]), ""]
        for module in modules:
            lines += [heading(module, "-"), f".. automodule:: {module}\n   :members:\n   :ignore-module-all:\n"]
        made["index" if name == "statejump" else name] = "\n".join(lines)
    return made


def main() -> None:
    """Build the reference."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", type=Path, default=REPOSITORY / "build")
    build = parser.parse_args().build.resolve()
    os.environ["PYTHONPATH"] = str(build / "python")
    os.environ["PYTHONDONTWRITEBYTECODE"] = "1"
    sys.path.insert(0, str(build / "python"))
    import key_pages  # needs the package

    folder = build / "docs"
    shutil.rmtree(folder, ignore_errors=True)
    source = folder / "source"
    source.mkdir(parents=True)
    for name in "conf.py", "index.rst":
        shutil.copy(HERE / name, source)
    members = doxygen(folder)
    subprocess.run(
        ["yade", "-n", "-x", str(HERE / "yade_page.py")], check=True, stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL, env={**os.environ, "STATEJUMP_PAGE": str(source / "yade.rst")},
    )
    if not (source / "yade.rst").exists():
        sys.exit("the page of the YADE classes was not written: does the plugin load?")
    for part, pages in ("cpp", cpp_pages.pages(REPOSITORY, members)), ("python", python_pages(build)):
        (source / part).mkdir()
        for name, text in pages.items():
            (source / part / f"{name}.rst").write_text(text, encoding="utf-8")
    (source / "keys.rst").write_text(key_pages.keys_page(), encoding="utf-8")
    (source / "symbols.rst").write_text(
        key_pages.symbols_page(
            (REPOSITORY / "README.md").read_text(encoding="utf-8"), members,
            (source / "yade.rst").read_text(encoding="utf-8"),
        ), encoding="utf-8",
    )
    done = subprocess.run(
        ["/usr/bin/python3", "-m", "sphinx", "-q", "-W", "--keep-going", "-j", "auto", "-b", "html",
         "-D", f"breathe_projects.statejump={members}", str(source), str(folder / "html")],
    )
    if done.returncode:
        sys.exit("the reference has warnings")
    # A reference that leads nowhere is shown as text without a word.
    symbols = (folder / "html" / "symbols.html").read_text(encoding="utf-8")
    for domain, page in (("cpp", r"cpp/\w+"), ("py", "yade")):
        wanted = len(re.findall(f'class="xref {domain} ', symbols))
        found = len(re.findall(f'<a class="reference internal" href="{page}\\.html#[^>]*><code class="xref {domain} ', symbols))
        if not 0 < found == wanted:
            sys.exit(f"symbols: {found} of {wanted} references to {domain} lead somewhere")
    print(folder / "html" / "index.html")


if __name__ == "__main__":
    main()
