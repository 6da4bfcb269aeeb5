# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes the pages of the C++ headers, one per subject: each header has a heading, with its symbols in source order."""
from __future__ import annotations

import xml.etree.ElementTree as xml
from collections import Counter
from dataclasses import dataclass
from fnmatch import fnmatch
from pathlib import Path

FOLDERS = ("contact_laws/kernel/include", "thermal/include", "engine/include", "geometry/include")
# Page, title, headers.
SUBJECTS = (
    ("kernel", "Kernel: contact of joints", ("statejump/kernel/*.hpp",)),
    ("laws", "Kernel: catalogue of laws", ("statejump/kernel/laws/*.hpp",)),
    ("thermal", "Temperature programs", ("statejump/thermal/*.hpp",)),
    ("spring_slider", "Engine: bar on a slider", ("statejump/spring_slider/*.hpp",)),
    ("linkage", "Engine: dynamics of the umbrella rib", ("statejump/linkage/*.hpp",)),
    ("loops", "Engine: quasi-static path of a loaded joint", ("statejump/joint_loop/*.hpp",)),
    ("truss", "Engine: trusses", ("statejump/truss/*.hpp",)),
    ("rest_sets", "Engine: rest sets", ("statejump/rest_set/*.hpp",)),
    ("failures", "Engine: failures", ("statejump/*.hpp",)),
    ("geometry", "Geometry: bores of triangles", ("statejump/geometry/*.hpp",)),
)
DIRECTIVES = {
    "class": "doxygenclass", "struct": "doxygenstruct", "union": "doxygenunion", "function": "doxygenfunction",
    "enum": "doxygenenum", "typedef": "doxygentypedef", "variable": "doxygenvariable",
}


@dataclass(frozen=True, order=True)
class Symbol:
    """What a header declares outside of classes."""

    header: str  # as it is included
    line: int
    kind: str
    name: str
    arguments: str  # of a function


def symbols(members: Path) -> list[Symbol]:
    """Return what all headers declare, in their order, from Doxygen's XML."""
    found = []
    compounds = [entry for entry in xml.parse(members / "index.xml").getroot()]
    classes = {entry.findtext("name") for entry in compounds if entry.get("kind") in ("class", "struct", "union")}

    def add(entry: xml.Element, kind: str, name: str) -> None:
        place = entry.find("location")
        if place is None:
            raise SystemExit(f"Doxygen does not say where {name} is")
        found.append(Symbol(place.get("file") or "", int(place.get("line") or 0), kind, name,
                            entry.findtext("argsstring") or ""))

    for compound in compounds:
        kind, name = compound.get("kind") or "", compound.findtext("name") or ""
        if kind != "namespace" and (name not in classes or name.rpartition("::")[0] in classes):
            continue  # files and folders; a class in a class is shown with it
        content = xml.parse(members / f"{compound.get('refid')}.xml").getroot().find("compounddef")
        assert content is not None
        if kind == "namespace":
            for member in content.iter("memberdef"):
                add(member, member.get("kind") or "", f"{name}::{member.findtext('name')}")
        else:
            add(content, kind, name)
    return sorted(found)


def _directive(symbol: Symbol, overloaded: bool) -> str:
    name = symbol.name + (symbol.arguments if overloaded else "")
    members = "   :members:\n" if symbol.kind in ("class", "struct", "union") else ""
    return f".. {DIRECTIVES[symbol.kind]}:: {name}\n{members}"


def _heading(text: str, mark: str) -> str:
    return f"{text}\n{mark * len(text)}\n"


def pages(repository: Path, members: Path) -> dict[str, str]:
    """Return the texts of the pages by name; the page ``index`` links the others.

    :raises SystemExit: a header belongs to no subject or to two
    """
    declared = symbols(members)
    count = Counter(symbol.name for symbol in declared if symbol.kind == "function")
    headers = {
        path.relative_to(repository / folder).as_posix(): path.relative_to(repository).as_posix()
        for folder in FOLDERS for path in sorted((repository / folder).rglob("*.hpp"))
    }
    strangers = {symbol.header for symbol in declared} - set(headers)
    if strangers:
        raise SystemExit(f"no such headers: {', '.join(sorted(strangers))}")
    subjects: dict[str, list[str]] = {name: [] for name, _, _ in SUBJECTS}
    for header in headers:
        # * of fnmatch passes folders: the longest pattern is the closest.
        matching = [(len(pattern), name) for name, _, patterns in SUBJECTS for pattern in patterns
                    if fnmatch(header, pattern)]
        if not matching:
            raise SystemExit(f"{headers[header]} belongs to no subject of {Path(__file__).name}")
        subjects[max(matching)[1]].append(header)
    made = {"index": "\n".join([
        _heading("C++ headers", "="), "Namespaces ``statejump``, ``statejump::kernel``, ``statejump::kernel::laws``, "
        f"``statejump::geometry``; below ``{'``, ``'.join(FOLDERS)}``.\n",
        ".. toctree::\n   :maxdepth: 2\n", *(f"   {name}" for name, _, _ in SUBJECTS), "",
    ])}
    for name, title, _ in SUBJECTS:
        lines = [_heading(title, "=")]
        for header in subjects[name]:
            lines += [_heading(f"``{header}``", "-"), f"In ``{headers[header]}``.\n"]
            lines += [_directive(symbol, count[symbol.name] > 1) for symbol in declared if symbol.header == header]
        made[name] = "\n".join(lines)
    return made
