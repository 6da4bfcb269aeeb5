# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs mutants: each is applied to a copy of the sources, and tests must fail."""
from __future__ import annotations

import json
import os
import re
import shlex
import shutil
import signal
import subprocess
import time
from pathlib import Path

from modules import Module
from operators import Mutant
from switched import SWITCH, VARIABLE, switched

KILLED, SURVIVED, INVALID = "killed", "survived", "does not compile"
# A mutant counts as detected after this multiple of the time of the unmutated test, but at least LEAST_SECONDS.
PATIENCE, LEAST_SECONDS = 10, 60
# Assertions of the libraries detect mutants that access an array beyond its end.
ASSERTING = ("-UNDEBUG", "-D_GLIBCXX_ASSERTIONS")
# What tests include and no mutant changes.
COMMON = ("gtest/gtest.h", "Eigen/Core", "Eigen/Geometry", "random", "string", "vector")


class SetUp(Exception):
    """The campaign cannot say anything."""


def run(
    command: list[str], seconds: float | None = None, cwd: Path | None = None, chosen: int = 0
) -> int | None:
    """Run a command without output, with a mutant selected; None: timeout."""
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
    """Runs mutants of one module in a copy of the sources. ``compare`` returns the result of one mutant."""

    def __init__(self, module: Module, root: Path, folder: Path) -> None:
        self.module, self.root, self.folder = module, root, folder
        self.patience: dict[str, float] = {}

    def check(self, guard: str) -> None:
        """Check that a guard (a test) passes with the unmutated sources, and measure its time."""
        start = time.monotonic()
        if self.fails(guard, None) is not False:
            raise SetUp(f"{self.module.name}: {guard} fails with the unmutated sources")
        self.patience[guard] = max(LEAST_SECONDS, PATIENCE * (time.monotonic() - start))

    def order(self, mutant: Mutant) -> list[str]:
        """Return the guards (tests) of a mutant; first the one named like its file."""
        stem = Path(mutant.file).stem
        return sorted(self.module.guards, key=lambda guard: Path(guard).stem.removesuffix("_test") != stem)

    def prepare(self, wanted: list[Mutant]) -> None:
        """Prepare a build for these mutants, most of which will be run."""

    def tried(self, mutant: Mutant) -> tuple[str, str]:
        """Return the result of a mutant, and the guard (test) that detected it."""
        return self.tried_alone(mutant)

    def tried_alone(self, mutant: Mutant) -> tuple[str, str]:
        """Change the sources for this mutant and run it."""
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
        """Return whether a guard (test) fails with the current sources; None: the sources do not compile."""
        raise NotImplementedError


class Compiled(Guards):
    """Mutants of C++, compiled with the commands of the build."""

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
        """Return a compile command for the copy of the sources, without compiler launcher, output file, warnings and
        precompiled header."""
        place = next(place for place, word in enumerate(command) if not word.endswith("ccache"))
        kept, words = [], iter(command[place:])
        for word in words:
            if word in ("-o", "-c", "-include"):
                next(words)
            elif not re.match(r"-(O\d|g|W)", word):
                kept.append(word.replace(f"{self.root}/", f"{self.folder}/"))
        return [*kept, "-w", *ASSERTING]

    def compile(self, file: str, result: Path, *options: str) -> str | None:
        """Compile a file of the copied sources; return the compiler's messages if it fails."""
        command = [*self.commands[str(self.root / file)], *options, "-c", str(self.folder / file), "-o", str(result)]
        done = subprocess.run(command, cwd=self.build, capture_output=True, text=True)
        return None if done.returncode == 0 else done.stderr

    def passes(self, program: Path, guard: str, chosen: int = 0) -> bool:
        """Run a test program, or only the tests that the guard names, with a mutant selected (0: none)."""
        wanted = [f"--gtest_filter={tests}" for _, found, tests in [guard.partition(":")] if found]
        return run([str(program), "--gtest_brief=1", "--gtest_fail_fast", *wanted], self.patience.get(guard, 600),
                   chosen=chosen) == 0

    def prepare(self, wanted: list[Mutant]) -> None:
        """Build the test programs with all mutants that can share one build."""
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
        """Build with the remaining mutants; return False if some were removed, to be compiled separately."""
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
        # For an error within a library, the compiler reports the line that required it.
        for name, line in re.findall(r"^(\S+?):(\d+):\d+: +(?:error:|required from here)", said, re.M):
            file = str(Path(name).resolve()).removeprefix(f"{self.folder.resolve()}/")
            held = lines.get(file, {})
            near = [number for number, (first, last) in held.items() if first <= int(line) <= last]
            # A wrong declaration causes errors at its uses, so the last mutant before the reported line is removed.
            before = [number for number in held if held[number][0] <= int(line)]
            bad.update(near or sorted(before, key=lambda number: held[number][0])[-1:] or held)
        if not bad:
            raise SetUp(f"{self.module.name} does not compile with its mutants:\n{said[:3000]}")
        self.ready = {number: one for number, one in self.ready.items() if number not in bad}
        return False

    def build_programs(self, files: list[str]) -> str | None:
        """Build the test programs; return the compiler's messages if they do not compile."""
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
    """Compiles each test file with the mutated header, without optimisation but with a precompiled prefix."""

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
        """Return whether a test includes a header, directly or indirectly."""
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
    """Compiles the mutated file of a library, and links it into the test program of the build, before its library."""

    def __init__(self, module: Module, root: Path, folder: Path, build: Path) -> None:
        super().__init__(module, root, folder, build)
        self.prefix = folder / "prefix.hpp"
        self.prefix.write_text(SWITCH)
        # Texts compiled last, so that removing one mutant does not require compiling all other files again.
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
        """Link a test program of the build with replaced object files of its library."""
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
        """Return the files to compile for a mutant: the mutated file itself or, for a header, the files beside it that
        include it."""
        if file is None or file.endswith(".cpp"):
            return [file] if file else []
        name, beside = Path(file).name, sorted((self.folder / file).parent.glob("*.cpp"))
        return [str(path.relative_to(self.folder)) for path in beside if f'/{name}"' in path.read_text()
                or f'"{name}"' in path.read_text()]
