# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs Python mutants with the test files that execute the mutated statement."""
from __future__ import annotations

import ast
import hashlib
import importlib
import json
import os
import shutil
import signal
import sys
import tempfile
import threading
import time
from pathlib import Path
from types import FrameType
from typing import Any

from guards import LEAST_SECONDS, PATIENCE, Guards
from journal import Journal
from modules import MODULES, Module
from operators import Mutant

# Largest number of test files per mutant besides those of its module.
MOST_OTHERS = 6
HEAVY = ("numpy", "attrs", "h5py", "scipy.optimize", "scipy.stats", "hypothesis", "pytest", "matplotlib.pyplot",
         "pandas")


def statement_lines(text: str, place: int) -> range:
    """Return the lines of the Python statement at a position; for a compound statement only the lines of its head."""
    line, found = text.count("\n", 0, place) + 1, range(0)
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.stmt) and node.end_lineno is not None and node.lineno <= line <= node.end_lineno:
            body = getattr(node, "body", None)
            lines = range(node.lineno, max(node.lineno, body[0].lineno - 1) + 1 if body else node.end_lineno + 1)
            if line in lines and (not found or len(lines) <= len(found)):
                found = lines
    return found or range(line, line + 1)


class PythonGuards(Guards):
    """Runs Python test files as guards, in a fork of this process, on a copy of the built package.

    Each file runs once with a trace of executed lines, which the journal keeps while package and test are unchanged.
    Commands in separate processes are not traced.
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
        """Return the guards (test files) to run for a mutant, the quickest first: of the files that execute the mutant,
        the module's own and the few that execute most lines per second. If no trace has the mutated line, any guard of
        the file may execute it."""
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
        """Run a test file in the fork, which then exits."""
        status = 70
        executed = {str(self.folder / file): set[int]() for file in self.traced}

        def line_of(frame: FrameType, event: str, value: Any) -> Any:
            executed[frame.f_code.co_filename].add(frame.f_lineno)
            return line_of

        def call_of(frame: FrameType, event: str, value: Any) -> Any:
            return line_of(frame, event, value) if frame.f_code.co_filename in executed else None

        class Again:
            """A recursion error ends a trace of executed lines, so each test starts a new one."""

            @staticmethod
            def pytest_runtest_setup() -> None:
                sys.settrace(call_of if traced else None)

        try:
            os.setsid()
            # A shell makes background processes ignore interrupts, and their children inherit this.
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
