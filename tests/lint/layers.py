#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks in the sources of the Python package which module imports which, by layers.

A module imports only from its own layer and from layers to its left in the list; imports for type checkers count. No
more than LARGEST_CIRCLE modules import each other in a circle. An import inside a function has a comment with its
reason, on its line or on the line before it. A function named by a string, such as
``"statejump.present.figures:drawn"``, exists. No attribute is accessed by a literal name; a Protocol declares it
instead. A function has at most LONGEST_FUNCTION lines without its docstring.

    python3 tests/lint/layers.py [--graph] [FOLDER]
"""
from __future__ import annotations

import ast
import re
import sys
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path

PACKAGE = "statejump"
LARGEST_CIRCLE = 3
FUNCTION_IMPORTS = 40
LONGEST_FUNCTION = 60
BY_NAME = ("getattr", "hasattr", "setattr", "delattr")
# From left to right; the longest matching name counts. A package stands for all of its modules without an entry.
LAYERS: tuple[tuple[str, tuple[str, ...]], ...] = (
    ("model", (
        "statejump._version", "statejump.core", "statejump.schema",
        "statejump.results.scene", "statejump.results.events",  # vocabulary of kinds: scenes for drawings, and events
    )),
    ("simulate", ("statejump.core.yade_process",)),
    ("kinds", (
        "statejump.bodies", "statejump.kinds", "statejump.laws", "statejump.fclib", "statejump.surface",
        "statejump.kinds.truss.answers.jumps", "statejump.kinds.truss.answers.reflector",  # outcomes need them
    )),
    ("results", ("statejump.results",)),
    ("campaigns", ("statejump.campaign", "statejump.design.file", "statejump.schema.json_schema")),
    ("design", (
        "statejump.bores", "statejump.control", "statejump.design", "statejump.identification", "statejump.orbit",
        "statejump.kinds.spring_slider.control", "statejump.kinds.truss.answers", "statejump.kinds.truss.control",
        "statejump.kinds.umbrella.quasi_static",
    )),
    ("present", (
        "statejump.core.figures", "statejump.core.html", "statejump.report",
        "statejump.bodies.figure", "statejump.bodies.page", "statejump.bores.picture", "statejump.campaign.plots",
        "statejump.control.plot", "statejump.design.page",
        "statejump.identification.picture", "statejump.laws.curves",
        "statejump.kinds.spring_slider.figure",
        "statejump.kinds.statics.figure", "statejump.kinds.statics.files",
        "statejump.kinds.truss.answers.figure", "statejump.kinds.truss.answers.vtk",
        "statejump.kinds.truss.answers.write", "statejump.kinds.truss.creak",
        "statejump.kinds.truss.bounds", "statejump.kinds.truss.worst", "statejump.kinds.truss.draw_modes",
        "statejump.kinds.truss.modes",
        "statejump.kinds.truss.draw_planar", "statejump.kinds.truss.draw_spatial", "statejump.kinds.truss.figure",
        "statejump.kinds.truss.page", "statejump.kinds.truss.page_bounds",
        "statejump.kinds.umbrella.figure",
    )),
    ("api", ("statejump", "statejump.api", "statejump.body", "statejump.truss")),
    ("cli", ("statejump.cli",)),
)
# Not part of layers and graph: the module of the engine, and the module that CMake writes.
FOUNDATIONS = ("statejump._engine", "statejump._paths")
PLACE = re.compile(r"statejump(\.\w+)+(:\w+)?")


@dataclass
class Import:
    """An import: its position, and the imported modules of the package."""

    module: str
    line: int
    text: str
    targets: list[str]
    in_function: bool
    for_types: bool
    reason: str = ""


@dataclass
class Sources:
    """Modules of the package and their imports."""

    files: dict[str, Path]
    imports: list[Import] = field(default_factory=list)
    places: list[tuple[str, int, str]] = field(default_factory=list)
    names: dict[str, set[str]] = field(default_factory=dict)
    lengths: list[tuple[int, str, int, str]] = field(default_factory=list)  # lines, module, line and name of functions
    by_name: list[tuple[str, int, str]] = field(default_factory=list)  # attributes that are queried by literal names

    def graph(self) -> dict[str, set[str]]:
        """Return the modules that each module imports."""
        found: dict[str, set[str]] = {name: set() for name in self.files}
        for one in self.imports:
            found[one.module].update(target for target in one.targets if target != one.module)
        return found


def module_name(folder: Path, file: Path) -> str:
    """Return the name by which a file is imported."""
    parts = file.relative_to(folder).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def _targets(node: ast.Import | ast.ImportFrom, files: Mapping[str, Path]) -> list[str]:
    if isinstance(node, ast.Import):
        wanted = [one.name for one in node.names]
    else:
        assert node.level == 0 and node.module, "imports are absolute"
        wanted = [f"{node.module}.{one.name}" for one in node.names]
    found = []
    for name in wanted:
        if name.startswith(FOUNDATIONS) or not name.startswith(PACKAGE):
            continue
        while name not in files:
            name = name.rpartition(".")[0]
        found.append(name)
    return found


def _walk(node: ast.AST, in_function: bool = False, for_types: bool = False) -> Iterator[tuple[ast.AST, bool, bool]]:
    """Yield every syntax node, whether it is inside a function, and whether it is only for type checkers."""
    yield node, in_function, for_types
    inside = in_function or isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef, ast.Lambda))
    for child in ast.iter_child_nodes(node):
        typed = isinstance(node, ast.If) and "TYPE_CHECKING" in ast.dump(node.test) and child in node.body
        yield from _walk(child, inside, for_types or typed)


def read(folder: Path) -> Sources:
    """Return the modules below a folder and their imports."""
    found = Sources({module_name(folder, file): file for file in sorted((folder / PACKAGE).rglob("*.py"))})
    for module, file in found.files.items():
        text = file.read_text(encoding="utf-8")
        lines, tree = text.splitlines(), ast.parse(text)
        found.names[module] = _defined(tree)
        for node, in_function, for_types in _walk(tree):
            if isinstance(node, (ast.Import, ast.ImportFrom)):
                near = (lines[node.lineno - 2].strip(), lines[node.lineno - 1].partition("#")[2])
                reason = near[1].strip() or (near[0][1:].strip() if near[0].startswith("#") else "")
                found.imports.append(Import(module, node.lineno, ast.unparse(node), _targets(node, found.files),
                                            in_function, for_types, reason))
            elif isinstance(node, ast.Constant) and isinstance(node.value, str) and PLACE.fullmatch(node.value):
                found.places.append((module, node.lineno, node.value))
            elif isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef)):
                found.lengths.append((_lines(node), module, node.lineno, node.name))
            elif _is_by_name(node):
                found.by_name.append((module, node.lineno, ast.unparse(node)))
    return found


def _lines(function: ast.FunctionDef | ast.AsyncFunctionDef) -> int:
    """Return the lines of a function without those of its docstring."""
    assert function.end_lineno is not None
    lines, first = function.end_lineno - function.lineno + 1, function.body[0]
    if ast.get_docstring(function, clean=False) is not None and first.end_lineno is not None:
        lines -= first.end_lineno - first.lineno + 1
    return lines


def _is_by_name(node: ast.AST) -> bool:
    return (isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id in BY_NAME
            and len(node.args) > 1 and isinstance(node.args[1], ast.Constant))


def _defined(tree: ast.Module) -> set[str]:
    """Return the names defined at the top level of a module."""
    found: set[str] = set()
    for node in tree.body:
        if isinstance(node, (ast.FunctionDef, ast.ClassDef)):
            found.add(node.name)
        elif isinstance(node, (ast.Import, ast.ImportFrom)):
            found.update(one.asname or one.name for one in node.names)
        elif isinstance(node, (ast.Assign, ast.AnnAssign)):
            for target in node.targets if isinstance(node, ast.Assign) else [node.target]:
                found.update(one.id for one in ast.walk(target) if isinstance(one, ast.Name))
    return found


def circles(graph: Mapping[str, set[str]]) -> list[list[str]]:
    """Return the groups of modules that import each other (strongly connected components, Tarjan 1972), the largest
    first."""
    index: dict[str, int] = {}
    low: dict[str, int] = {}
    stack: list[str] = []
    found: list[list[str]] = []

    def visit(name: str) -> None:
        index[name] = low[name] = len(index)
        stack.append(name)
        for target in sorted(graph[name]):
            if target not in index:
                visit(target)
                low[name] = min(low[name], low[target])
            elif target in stack:
                low[name] = min(low[name], index[target])
        if low[name] == index[name]:
            place = stack.index(name)
            if len(stack) - place > 1:
                found.append(sorted(stack[place:]))
            del stack[place:]

    sys.setrecursionlimit(10_000)
    for name in graph:
        if name not in index:
            visit(name)
    return sorted(found, key=len, reverse=True)


def layer_of(module: str) -> int | None:
    """Return the number of a module's layer, counted from the left; None: the module belongs to no layer."""
    known = {name: number for number, (_, names) in enumerate(LAYERS) for name in names}
    while module and module not in known:
        module = module.rpartition(".")[0]
    return known.get(module)


def _wrong_layers(sources: Sources) -> Iterator[str]:
    if not LAYERS:
        return
    title = [name for name, _ in LAYERS]
    for module in sources.files:
        if layer_of(module) is None:
            yield f"{module}: has no layer; add it to LAYERS"
    for one in sources.imports:
        own = layer_of(one.module)
        for target in one.targets:
            other = layer_of(target)
            if own is not None and other is not None and other > own:
                yield (f"{one.module}:{one.line}: layer '{title[own]}' imports {target} of layer '{title[other]}'; "
                       "move what it needs to the left")
    for name in (name for _, names in LAYERS for name in names):
        if name not in sources.files:
            yield f"LAYERS: there is no module {name}; remove it"


def _wrong_places(sources: Sources) -> Iterator[str]:
    for module, line, place in sources.places:
        wanted, _, name = place.partition(":")
        if name and (wanted not in sources.files or name not in sources.names[wanted]):
            yield f"{module}:{line}: there is no {place}; name a function that exists"


def violations(sources: Sources) -> list[str]:
    """Return the violations of the rules, one sentence each."""
    found = [*_wrong_layers(sources), *_wrong_places(sources)]
    for circle in circles(sources.graph()):
        if len(circle) > LARGEST_CIRCLE:
            found.append(f"{len(circle)} modules import each other in a circle, {LARGEST_CIRCLE} may: "
                         f"{', '.join(circle)}")
    found += [f"{module}:{line}: {name} has {lines} lines, {LONGEST_FUNCTION} may be; split it"
              for lines, module, line, name in sources.lengths if lines > LONGEST_FUNCTION]
    found += [f"{module}:{line}: {text} names an attribute by a string; declare it in a Protocol"
              for module, line, text in sources.by_name]
    inside = [one for one in sources.imports if one.in_function]
    if len(inside) > FUNCTION_IMPORTS:
        found.append(f"{len(inside)} imports are inside functions, {FUNCTION_IMPORTS} may be; move them to the top")
    if LAYERS:
        found += [f"{one.module}:{one.line}: '{one.text}' is inside a function; move it to the top or state the reason"
                  for one in inside if not one.reason]
    return found


def _print_graph(sources: Sources) -> None:
    graph = sources.graph()
    kinds: dict[tuple[str, str], set[str]] = {}
    for one in sources.imports:
        mark = "type" if one.for_types else "function" if one.in_function else "top"
        for target in one.targets:
            kinds.setdefault((one.module, target), set()).add(mark)
    for circle in circles(graph):
        print(f"circle of {len(circle)}")
        for name in circle:
            print(f"    {name}: " + ", ".join(
                f"{target} ({', '.join(sorted(kinds[name, target]))})" for target in sorted(graph[name])
                if target in circle and target != name))
    for one in sources.imports:
        if one.in_function:
            print(f"in function: {one.module}:{one.line}: {one.text}  # {one.reason}")


def main(arguments: list[str]) -> int:
    """Print numbers and violations; return 1 if there are any."""
    folders = [one for one in arguments if not one.startswith("-")]
    sources = read(Path(folders[0]) if folders else Path(__file__).parents[2] / "python")
    if "--graph" in arguments:
        _print_graph(sources)
    largest = max(map(len, circles(sources.graph())), default=1)
    inside = sum(one.in_function for one in sources.imports)
    functions = sum(":" in place for _, _, place in sources.places)
    print(f"{len(sources.files)} modules, largest circle {largest}, {inside} imports inside functions, "
          f"{functions} functions of later layers named by strings, longest function {max(sources.lengths)[0]} lines, "
          f"{len(sources.by_name)} attributes queried by literal names")
    wrong = violations(sources)
    print("\n".join(wrong), end="\n" if wrong else "")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
