#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Breaks a random sample of places of each module and counts how often its tests notice.

Mutants of C++ stand beside the original in one build, from which a variable of the environment chooses (switched.py);
those that cannot are compiled alone. Headers are compiled with the tests that include them, files of a library are
linked before it into the built test program. Mutants of Python are tried by the test files that execute their
statement, in a process forked from one that has the heavy imports behind it. Mutants that do not compile are not
counted. The unmutated sources must pass.

The sample is that of the seed; a result is kept in the journal, so that what was noticed once is not tried again
while its file stays as it was. Survivors that no test can notice are listed in equivalent.toml with the reason.

Exit status: 0 every module has its score, 1 one has not, 2 the set-up is wrong.
"""
from __future__ import annotations

import argparse
import ast
import hashlib
import importlib
import json
import math
import os
import random
import re
import shlex
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time
import tomllib
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from types import FrameType
from typing import Any

from modules import MODULES, Module
from operators import Mutant, mutants
from switched import SWITCH, VARIABLE, switched

HERE = Path(__file__).resolve().parent
EQUIVALENT = HERE / "equivalent.toml"
KILLED, SURVIVED, INVALID = "killed", "survived", "does not compile"
# A mutant that takes longer than this many times the unmutated test has been noticed.
PATIENCE, LEAST_SECONDS = 10, 60
# Test files of Python that are asked of one mutant beside its module's own.
MOST_OTHERS = 6
# Of what a mutant asks beyond the end of an array the assertions of the libraries tell.
ASSERTING = ("-UNDEBUG", "-D_GLIBCXX_ASSERTIONS")
# What tests include and no mutant changes.
COMMON = ("gtest/gtest.h", "Eigen/Core", "Eigen/Geometry", "random", "string", "vector")
HEAVY = ("numpy", "attrs", "h5py", "scipy.optimize", "scipy.stats", "hypothesis", "pytest", "matplotlib.pyplot",
         "pandas")


class SetUp(Exception):
    """The campaign cannot say anything."""


@dataclass
class Score:
    """What became of the mutants of a module."""

    module: Module
    population: int
    killed: int = 0
    survivors: list[str] = field(default_factory=list)
    equivalent: list[str] = field(default_factory=list)
    invalid: int = 0

    @property
    def tried(self) -> int:
        """Mutants that a test could notice."""
        return self.killed + len(self.survivors)

    def interval(self) -> tuple[float, float]:
        """Return the 95 % interval of the share of all mutants that are noticed, after Wilson."""
        if not self.tried:
            return 0.0, 1.0
        n, z = self.tried, 1.959964
        share, spread = self.killed / n, z * z / n
        middle = (share + spread / 2) / (1 + spread)
        half = z * math.sqrt(share * (1 - share) / n + spread / (4 * n)) / (1 + spread)
        return max(0.0, middle - half), min(1.0, middle + half)

    def row(self) -> str:
        """Return a row of the table of docs/reliability.md."""
        low, high = self.interval()
        share = self.killed / self.tried if self.tried else 0.0
        return (f"| {self.module.name} | {self.population} | {self.tried + len(self.equivalent)} | {self.killed} | "
                f"{len(self.survivors)} | {len(self.equivalent)} | {100 * share:.0f} % | {100 * low:.0f} to "
                f"{100 * high:.0f} % | {100 * self.module.wanted:.0f} % |")


def run(
    command: list[str], seconds: float | None = None, cwd: Path | None = None, chosen: int = 0
) -> int | None:
    """Run a command in silence, with a mutant chosen; None: it took longer."""
    process = subprocess.Popen(command, cwd=cwd, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
                               stderr=subprocess.DEVNULL, start_new_session=True,
                               env={**os.environ, VARIABLE: str(chosen)})
    try:
        return process.wait(seconds)
    except subprocess.TimeoutExpired:
        os.killpg(process.pid, signal.SIGKILL)
        process.wait()
        return None


class Guards:
    """Tries mutants of one module in a copy of the sources. ``compare`` says what became of one."""

    def __init__(self, module: Module, root: Path, folder: Path) -> None:
        self.module, self.root, self.folder = module, root, folder
        self.patience: dict[str, float] = {}

    def check(self, guard: str) -> None:
        """Require that a guard passes with the unmutated sources, and measure how long that takes."""
        start = time.monotonic()
        if self.fails(guard, None) is not False:
            raise SetUp(f"{self.module.name}: {guard} fails with the unmutated sources")
        self.patience[guard] = max(LEAST_SECONDS, PATIENCE * (time.monotonic() - start))

    def order(self, mutant: Mutant) -> list[str]:
        """Return the guards of a mutant, that of the same name as its file first."""
        stem = Path(mutant.file).stem
        return sorted(self.module.guards, key=lambda guard: Path(guard).stem.removesuffix("_test") != stem)

    def prepare(self, wanted: list[Mutant]) -> None:
        """Make ready for these mutants, most of which will be tried."""

    def tried(self, mutant: Mutant) -> tuple[str, str]:
        """Return what became of a mutant, and the guard that noticed it."""
        return self.tried_alone(mutant)

    def tried_alone(self, mutant: Mutant) -> tuple[str, str]:
        """Change the sources for this mutant and try it."""
        path = self.folder / mutant.file
        text = path.read_text(encoding="utf-8")
        for guard in self.order(mutant):
            if guard not in self.patience:
                self.check(guard)
            path.write_text(mutant.applied(text), encoding="utf-8")
            try:
                found = self.fails(guard, mutant.file)
            finally:
                path.write_text(text, encoding="utf-8")
            if found is not False:
                return (KILLED if found else INVALID), guard
        return SURVIVED, ""

    def fails(self, guard: str, file: str | None) -> bool | None:
        """Does a guard notice the sources as they stand? None: they do not compile."""
        raise NotImplementedError


class Compiled(Guards):
    """Mutants of C++, compiled by the commands of the build."""

    def __init__(self, module: Module, root: Path, folder: Path, build: Path) -> None:
        super().__init__(module, root, folder)
        self.build = build
        self.ready: dict[int, Mutant] = {}
        self.programs: dict[str, Path] = {}
        entries = json.loads((build / "compile_commands.json").read_text())
        self.commands = {entry["file"]: self._quiet(shlex.split(entry["command"])) for entry in entries}
        for name in ("contact_laws/kernel", "thermal", "engine", "geometry", "tests/cpp"):
            shutil.copytree(root / name, folder / name, dirs_exist_ok=True)

    def _quiet(self, command: list[str]) -> list[str]:
        """Return a command without a launcher, output, warnings, for the copy of the sources."""
        place = next(place for place, word in enumerate(command) if not word.endswith("ccache"))
        kept, words = [], iter(command[place:])
        for word in words:
            if word in ("-o", "-c"):
                next(words)
            elif not re.match(r"-(O\d|g|W)", word):
                kept.append(word.replace(f"{self.root}/", f"{self.folder}/"))
        return [*kept, "-w", *ASSERTING]

    def compile(self, file: str, result: Path, *options: str) -> str | None:
        """Compile a file of the copy; return what the compiler said if it does not compile."""
        command = [*self.commands[str(self.root / file)], *options, "-c", str(self.folder / file), "-o", str(result)]
        done = subprocess.run(command, cwd=self.build, capture_output=True, text=True)
        return None if done.returncode == 0 else done.stderr

    def passes(self, program: Path, guard: str, chosen: int = 0) -> bool:
        """Run a test program, or those of its tests that the guard names, with a mutant chosen, 0 for none."""
        wanted = [f"--gtest_filter={tests}" for _, found, tests in [guard.partition(":")] if found]
        return run([str(program), "--gtest_brief=1", "--gtest_fail_fast", *wanted], self.patience.get(guard, 600),
                   chosen=chosen) == 0

    def prepare(self, wanted: list[Mutant]) -> None:
        """Build the test programs with as many of the mutants as can stand beside the original."""
        self.ready = dict(enumerate(wanted, start=1))
        files = sorted({mutant.file for mutant in wanted})
        originals = {file: (self.folder / file).read_text(encoding="utf-8") for file in files}
        try:
            while not self._built(files, originals):
                pass
        finally:
            for file, text in originals.items():
                (self.folder / file).write_text(text, encoding="utf-8")
        for guard, program in self.programs.items():
            start = time.monotonic()
            if not self.passes(program, guard):
                raise SetUp(f"{self.module.name}: {guard} fails with mutants that are not chosen")
            self.patience[guard] = max(LEAST_SECONDS, PATIENCE * (time.monotonic() - start))

    def _built(self, files: list[str], originals: dict[str, str]) -> bool:
        """Build with the mutants that are left; False: some had to be taken out, to be compiled alone."""
        lines: dict[str, dict[int, tuple[int, int]]] = {}
        for file in files:
            text, lines[file] = switched(
                originals[file], {number: one for number, one in self.ready.items() if one.file == file})
            (self.folder / file).write_text(text, encoding="utf-8")
        kept = {number for found in lines.values() for number in found}
        self.ready = {number: one for number, one in self.ready.items() if number in kept}
        said = self.build_programs(files)
        if said is None:
            return True
        bad: set[int] = set()
        # Of an error within a library the compiler tells which line asked for it.
        for name, line in re.findall(r"^(\S+?):(\d+):\d+: +(?:error:|required from here)", said, re.M):
            file = str(Path(name).resolve()).removeprefix(f"{self.folder.resolve()}/")
            held = lines.get(file, {})
            near = [number for number, (first, last) in held.items() if first <= int(line) <= last]
            # Of a declaration that went wrong the compiler tells where it is used: the last one before is taken out.
            before = [number for number in held if held[number][0] <= int(line)]
            bad.update(near or sorted(before, key=lambda number: held[number][0])[-1:] or held)
        if not bad:
            raise SetUp(f"{self.module.name} does not compile with its mutants:\n{said[:3000]}")
        self.ready = {number: one for number, one in self.ready.items() if number not in bad}
        return False

    def build_programs(self, files: list[str]) -> str | None:
        """Build the test programs; return what the compiler said if it does not compile."""
        raise NotImplementedError

    def tried(self, mutant: Mutant) -> tuple[str, str]:
        number = next((number for number, one in self.ready.items() if one == mutant), None)
        if number is None:
            return self.tried_alone(mutant)
        for guard in self.order(mutant):
            if not self.passes(self.programs[guard], guard, number):
                return KILLED, guard
        return SURVIVED, ""


class HeaderGuards(Compiled):
    """Each test file is compiled with the mutated header, without optimisation, on a precompiled prefix."""

    def __init__(self, module: Module, root: Path, folder: Path, build: Path) -> None:
        super().__init__(module, root, folder, build)
        self.prefix = folder / "prefix.hpp"
        self.prefix.write_text(SWITCH + "".join(f"#include <{name}>\n" for name in COMMON))
        command = self.commands[str(root / module.guards[0])]
        if run([*command, "-O0", "-x", "c++-header", str(self.prefix), "-o", f"{self.prefix}.gch"], cwd=build) != 0:
            raise SetUp("the common headers do not compile")

    def order(self, mutant: Mutant) -> list[str]:
        return [guard for guard in super().order(mutant) if self._includes(self.folder / guard, mutant.file)]

    def _includes(self, source: Path, file: str) -> bool:
        """Does a test include a header, itself or by others?"""
        name, seen = Path(file).name, set[Path]()
        waiting = [source]
        while waiting:
            text = waiting.pop().read_text(encoding="utf-8")
            for found in re.findall(r'#include "statejump/([^"]+)"', text):
                if Path(found).name == name:
                    return True
                for place in self.folder.glob(f"*/include/statejump/{found}"):
                    waiting += [place] if place not in seen else []
                    seen.add(place)
                for place in self.folder.glob(f"*/*/include/statejump/{found}"):
                    waiting += [place] if place not in seen else []
                    seen.add(place)
        return False

    def build_programs(self, files: list[str]) -> str | None:
        for place, guard in enumerate(self.module.guards):
            if any(self._includes(self.folder / guard, file) for file in files):
                said = self._program(guard, self.folder / f"guard{place}")
                if said is not None:
                    return said
                self.programs[guard] = self.folder / f"guard{place}"
        return None

    def _program(self, guard: str, program: Path) -> str | None:
        made = self.folder / "mutant.o"
        said = self.compile(guard, made, "-O0", "-include", str(self.prefix))
        if said is None:
            libraries = ["-lgtest_main", "-lgtest", "-pthread"]
            if run([self.commands[str(self.root / guard)][0], str(made), "-o", str(program), *libraries]) != 0:
                raise SetUp(f"{guard} does not link")
        return said

    def fails(self, guard: str, file: str | None) -> bool | None:
        program = self.folder / "mutant"
        if self._program(guard, program) is not None:
            return None
        return not self.passes(program, guard)


class LibraryGuards(Compiled):
    """The mutated file is compiled alone and linked before its library into the test program of the build."""

    def __init__(self, module: Module, root: Path, folder: Path, build: Path) -> None:
        super().__init__(module, root, folder, build)
        self.prefix = folder / "prefix.hpp"
        self.prefix.write_text(SWITCH)
        # What was compiled last, so that a mutant that has to go does not cost all other files again.
        self.compiled: dict[str, str] = {}

    def build_programs(self, files: list[str]) -> str | None:
        sources = sorted({source for file in files for source in self._sources(file)})
        headers = "".join((self.folder / file).read_text() for file in files if not file.endswith(".cpp"))
        wrong = []
        for source in sources:
            text = headers + (self.folder / source).read_text()
            if self.compiled.get(source) == text:
                continue
            said = self.compile(source, self._object(source), "-O1", "-include", str(self.prefix))
            if said is None:
                self.compiled[source] = text
            else:
                wrong.append(said)
        if wrong:
            return "\n".join(wrong)
        made = [self._object(source) for source in sources]
        for place, guard in enumerate(self.module.guards):
            self.programs[guard] = self.folder / f"guard{place}"
            self._link(guard, made, self.programs[guard])
        return None

    def _object(self, source: str) -> Path:
        return self.folder / (source.replace("/", "_") + ".o")

    def _link(self, guard: str, made: list[Path], program: Path) -> None:
        """Link a test program of the build with other objects of its library."""
        told = subprocess.run(["ninja", "-t", "commands", guard.partition(":")[0]], cwd=self.build,
                              capture_output=True, text=True)
        link = shlex.split(told.stdout.strip().splitlines()[-1].split("&&")[1])
        first = next(place for place, word in enumerate(link) if word.endswith(".a"))
        link[first:first] = map(str, made)
        link[link.index("-o") + 1] = str(program)
        if run([word for word in link if not word.endswith("ccache")], cwd=self.build) != 0:
            raise SetUp(f"{guard} does not link with its mutants")

    def fails(self, guard: str, file: str | None) -> bool | None:
        made: list[Path] = []
        for place, source in enumerate(self._sources(file)):
            made.append(self.folder / f"mutant{place}.o")
            if self.compile(source, made[-1], "-O1") is not None:
                return None
        self._link(guard, made, self.folder / "mutant")
        return not self.passes(self.folder / "mutant", guard)

    def _sources(self, file: str | None) -> list[str]:
        """Return the files to compile for a mutant: itself, or for a header those beside it that include it."""
        if file is None or file.endswith(".cpp"):
            return [file] if file else []
        name, beside = Path(file).name, sorted((self.folder / file).parent.glob("*.cpp"))
        return [str(path.relative_to(self.folder)) for path in beside if f'/{name}"' in path.read_text()
                or f'"{name}"' in path.read_text()]


def statement_lines(text: str, place: int) -> range:
    """Return the lines of the statement of Python at a place, of a compound one those of its head."""
    line, found = text.count("\n", 0, place) + 1, range(0)
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.stmt) and node.end_lineno is not None and node.lineno <= line <= node.end_lineno:
            body = getattr(node, "body", None)
            lines = range(node.lineno, max(node.lineno, body[0].lineno - 1) + 1 if body else node.end_lineno + 1)
            if line in lines and (not found or len(lines) <= len(found)):
                found = lines
    return found or range(line, line + 1)


class PythonGuards(Guards):
    """The test files run in a fork of this process, on a copy of the built package.

    Each runs once under a trace, which tells the lines of all such modules that it executes; the journal keeps that
    while package and test are as they were. A command in a process of its own is not traced.
    """

    def __init__(self, module: Module, root: Path, folder: Path, build: Path, journal: Journal) -> None:
        super().__init__(module, root, folder)
        self.journal = journal
        self.traced = [file.relative_to(root) for one in MODULES if one.guards[0].endswith(".py")
                       for file in one.files(root)]
        digest = hashlib.sha256()
        digest.update(repr(self.traced).encode())
        for file in (*sorted((root / "python").rglob("*.py")),
                     *sorted((build / "python/statejump").glob("_engine*.so")),
                     root / "tests/python/conftest.py"):
            digest.update(file.read_bytes())
        self.package = digest.hexdigest()
        for name in HEAVY:
            importlib.import_module(name)
        ignored = shutil.ignore_patterns("__pycache__", "_engine*")
        shutil.copytree(root / "python", folder / "python", dirs_exist_ok=True, ignore=ignored)
        package = folder / "python" / "statejump"
        for path in [*(build / "python/statejump").glob("_engine*.so"), build / "python/statejump/_paths.py",
                     *(build / "python/statejump/report").glob("page.*"),
                     *(build / "python/statejump/report").glob("notices.txt")]:
            if not (package / path.relative_to(build / "python/statejump")).exists():
                (package / path.relative_to(build / "python/statejump")).symlink_to(path)
        if not (folder / "python/statejump_yade").exists():
            (folder / "python/statejump_yade").symlink_to(build / "python/statejump_yade")
        command = (build / "bin/statejump").read_text().replace(str(build / "python"), str(folder / "python"))
        self.command = folder / "statejump"
        self.command.write_text(command)
        self.command.chmod(0o755)
        self.executed: dict[str, dict[str, list[int]]] = {}
        self.seconds: dict[str, float] = {}

    def prepare(self, wanted: list[Mutant]) -> None:
        for guard in self.module.guards:
            text = self.package + (self.root / guard).read_text(encoding="utf-8")
            key = f"executed by {guard} {hashlib.sha256(text.encode()).hexdigest()[:16]}"
            if key not in self.journal.known:
                start = time.monotonic()
                self.check(guard)
                self.journal.add(key, json.dumps([time.monotonic() - start, json.loads(self._trace.read_text())]))
            self.seconds[guard], self.executed[guard] = json.loads(self.journal.known[key])
            self.patience[guard] = max(LEAST_SECONDS, PATIENCE * self.seconds[guard])

    def order(self, mutant: Mutant) -> list[str]:
        """Return the guards to ask, the quickest first: of those that execute a mutant the module's own and the few
        that execute most of its file in a second. What no trace has seen may be executed by any that executes the file.
        """
        if not self.executed:
            self.prepare([mutant])
        lines = set(statement_lines((self.folder / mutant.file).read_text(encoding="utf-8"), mutant.start))
        whole = {guard: seen[mutant.file] for guard, seen in self.executed.items() if seen[mutant.file]}
        able = [guard for guard, seen in whole.items() if lines.intersection(seen)] or list(whole)
        able.sort(key=lambda guard: self.seconds[guard] / len(whole[guard]))
        own = [guard for guard in able if guard in self.module.own]
        others = [guard for guard in able if guard not in own]
        return sorted(own + others[:MOST_OTHERS], key=self.seconds.__getitem__)

    @property
    def _trace(self) -> Path:
        return self.folder / "executed.json"

    def fails(self, guard: str, file: str | None) -> bool | None:
        child = os.fork()
        if child == 0:
            self._test(guard, traced=file is None)
        patience = time.monotonic() + self.patience.get(guard, 1200)
        while True:
            done, status = os.waitpid(child, os.WNOHANG)
            if done:
                return status != 0
            if time.monotonic() > patience:
                os.killpg(child, signal.SIGKILL)
                os.waitpid(child, 0)
                return True
            time.sleep(0.05)

    def _test(self, guard: str, traced: bool) -> None:
        """Run a test file; the fork ends here."""
        status = 70
        executed = {str(self.folder / file): set[int]() for file in self.traced}

        def line_of(frame: FrameType, event: str, value: Any) -> Any:
            executed[frame.f_code.co_filename].add(frame.f_lineno)
            return line_of

        def call_of(frame: FrameType, event: str, value: Any) -> Any:
            return line_of(frame, event, value) if frame.f_code.co_filename in executed else None

        class Again:
            """Recursion without end ends a trace: each test begins one."""

            @staticmethod
            def pytest_runtest_setup() -> None:
                sys.settrace(call_of if traced else None)

        try:
            os.setsid()
            # A shell has what runs in its background ignore interrupts, and what that starts inherits it.
            signal.signal(signal.SIGINT, signal.default_int_handler)
            with open(os.devnull, "r+b") as nowhere:
                for stream in (0, 1, 2):
                    os.dup2(nowhere.fileno(), stream)
            os.environ.update(STATEJUMP_PYTHON_DIR=str(self.folder / "python"), STATEJUMP_COMMAND=str(self.command),
                              PYTHONDONTWRITEBYTECODE="1", MPLBACKEND="Agg")
            sys.dont_write_bytecode = True
            if traced:
                threading.settrace(call_of)
                sys.settrace(call_of)
            with tempfile.TemporaryDirectory(dir=self.folder) as scratch:
                pytest = importlib.import_module("pytest")
                status = int(pytest.main(["-x", "-q", "-p", "no:cacheprovider", f"--basetemp={scratch}/t",
                                          "--rootdir", str(self.root), str(self.root / guard)], plugins=[Again()]))
            if traced:
                sys.settrace(None)
                self._trace.write_text(json.dumps({
                    str(Path(file).relative_to(self.folder)): sorted(lines) for file, lines in executed.items()}))
        finally:
            os._exit(status)


def guards_of(module: Module, root: Path, folder: Path, build: Path, journal: Journal) -> Guards:
    """Return what tries the mutants of a module."""
    if module.guards[0].endswith(".py"):
        return PythonGuards(module, root, folder, build, journal)
    return (HeaderGuards if module.guards[0].endswith(".cpp") else LibraryGuards)(module, root, folder, build)


class Journal:
    """What was found before, a line each."""

    def __init__(self, path: Path | None) -> None:
        self.path = path
        self.known: dict[str, str] = {}
        if path is not None and path.exists():
            for line in path.read_text(encoding="utf-8").splitlines():
                entry = json.loads(line)
                self.known[entry["key"]] = entry["outcome"]

    @staticmethod
    def key(mutant: Mutant, text: str) -> str:
        """Return the name of a mutant of a text."""
        digest = hashlib.sha256(text.encode()).hexdigest()[:16]
        return f"{mutant.file} {digest} {mutant.start} {mutant.end} {mutant.replacement}"

    def add(self, key: str, outcome: str, **more: object) -> None:
        """Keep what became of a mutant."""
        self.known[key] = outcome
        if self.path is not None:
            with self.path.open("a", encoding="utf-8") as out:
                out.write(json.dumps({"key": key, "outcome": outcome, **more}, ensure_ascii=False) + "\n")


def explained(mutant: Mutant, text: str) -> str | None:
    """Return why no test can notice a mutant; None: nobody has said so."""
    start = text.rfind("\n", 0, mutant.start) + 1
    line = text[start: text.find("\n", mutant.end)]
    for entry in tomllib.loads(EQUIVALENT.read_text(encoding="utf-8")).get("mutant", []):
        if (entry["file"] == mutant.file and entry["line"].strip() in line
                and entry.get("place", 1) == text[start: mutant.start].count(entry["was"]) + 1
                and entry["was"] == text[mutant.start: mutant.end] and entry["is"] == mutant.replacement):
            return str(entry["why"])
    return None


def campaign(module: Module, guards: Callable[[], Guards], root: Path, sample: int, seed: int, journal: Journal,
             tell: Callable[[str], None]) -> Score:
    """Try mutants of a module in random order until as many have been tried as are wanted."""
    texts = {str(path.relative_to(root)): path.read_text(encoding="utf-8") for path in module.files(root)}
    whole = [mutant for file, text in texts.items() for mutant in mutants(file, text)]
    random.Random(f"{module.name} {seed}").shuffle(whole)
    score = Score(module, len(whole))

    def known(mutant: Mutant) -> str | None:
        """Return what is known of a mutant and need not be tried again."""
        found = journal.known.get(journal.key(mutant, texts[mutant.file]))
        return None if found == SURVIVED and explained(mutant, texts[mutant.file]) is None else found

    # Some do not compile; those beyond the sample are then tried alone.
    unknown = [mutant for mutant in whole[: math.ceil(1.05 * sample)] if known(mutant) is None]
    ready = guards() if unknown else None
    if ready is not None:
        ready.prepare(unknown)
    for mutant in whole:
        if score.tried + len(score.equivalent) >= sample:
            break
        text = texts[mutant.file]
        said = f"{module.name}: {mutant.operator}: {mutant.described(text)}"
        outcome, why = known(mutant), explained(mutant, text)
        if outcome is None:
            ready = ready or guards()
            outcome, by = ready.tried(mutant)
            journal.add(journal.key(mutant, text), outcome, module=module.name, mutant=said, by=by)
            tell(f"{outcome}: {said}" + (f" (by {by})" if outcome == KILLED else ""))
        if outcome == KILLED:
            score.killed += 1
        elif outcome == INVALID:
            score.invalid += 1
        elif why:
            score.equivalent.append(f"{said}: {why}")
        else:
            score.survivors.append(said)
    return score


def chosen(names: list[str]) -> Iterator[Module]:
    """Yield the modules of these names, all without any. :raises SetUp: there is no such module"""
    known = {module.name: module for module in MODULES}
    for name in names or known:
        if name not in known:
            raise SetUp(f"no module {name}; there are {', '.join(known)}")
        yield known[name]


def main() -> int:
    """Run the campaign."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--root", type=Path, default=HERE.parents[1], help="the repository")
    parser.add_argument("--build", type=Path, required=True, help="folder of a build with its tests (Ninja)")
    parser.add_argument("--sample", type=int, default=40, help="mutants of each module")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--journal", type=Path, help="file that keeps what was found")
    parser.add_argument("module", nargs="*", help="names of modules; default: all")
    options = parser.parse_args()
    journal = Journal(options.journal)
    missed, rows = False, []
    try:
        for module in chosen(options.module):
            with tempfile.TemporaryDirectory(prefix="statejump-mutants-") as name:
                def ready(module: Module = module, folder: Path = Path(name)) -> Guards:
                    return guards_of(module, options.root.resolve(), folder, options.build.resolve(), journal)

                score = campaign(module, ready, options.root.resolve(), options.sample, options.seed, journal,
                                 lambda text: print(text, flush=True))
            missed |= score.tried == 0 or score.killed < module.wanted * score.tried
            rows.append(score.row())
            print(rows[-1], flush=True)
            for survivor in score.survivors:
                print(f"  survives: {survivor}", flush=True)
    except SetUp as problem:
        print(f"campaign.py: {problem}", file=sys.stderr)
        return 2
    print("\n".join(["", "| module | mutants | tried | noticed | survive | equivalent | score | 95 % interval | "
                     "wanted |", "|---|---:|---:|---:|---:|---:|---:|---|---:|", *rows]))
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main())
