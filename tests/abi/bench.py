# SPDX-License-Identifier: GPL-3.0-or-later
"""Compiles test modules against edited headers that declare YADE's interface, and checks them in a running YADE."""
from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
import threading
from argparse import ArgumentParser, Namespace
from pathlib import Path
from typing import Any

HERE = Path(__file__).resolve().parent
HEADERS = Path("statejump") / "yade_abi"
NO_ALIGNMENT = ["-DEIGEN_DONT_ALIGN", "-DEIGEN_DONT_VECTORIZE"]
# Sources of the guard that do not include the declarations, so they are compiled once.
INDEPENDENT = ["getters", "guard", "memory", "tables", "values"]


def add_options(parser: ArgumentParser) -> None:
    """Add the options for compilation, which CMake passes."""
    parser.add_argument("--compiler", required=True)
    parser.add_argument("--abi", required=True, type=Path, help="folder yade_abi of the sources")
    parser.add_argument("--generated", required=True, type=Path, help="folder of measured_layout.inc")
    parser.add_argument("--variant", required=True, help="of the declared interface")
    parser.add_argument("--package", required=True, type=Path, help="Python part of the plugin")
    parser.add_argument("--include", action="append", default=[], help="Eigen, Python")
    parser.add_argument("--jobs", type=int, default=2)


class Compiler:
    """Builds probe modules in separate folders."""

    def __init__(self, options: Namespace, folder: Path) -> None:
        self.options = options
        self.folder = folder
        self.headers = options.abi / "include"
        self.pch = folder / "third_party.hpp"
        shutil.copy(HERE / "third_party.hpp", self.pch)
        self._run([*self._command(NO_ALIGNMENT, None), "-x", "c++-header", str(self.pch), "-o", f"{self.pch}.gch"])
        self.objects = [self.object(HERE / "probe.cpp")]
        self.objects += [self.object(options.abi / "src" / f"{name}.cpp") for name in INDEPENDENT]

    @staticmethod
    def _run(command: list[str]) -> None:
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        if done.returncode:
            sys.exit(f"failed: {' '.join(command)}\n{done.stderr}")

    def _command(self, alignment: list[str], headers: Path | None, first: list[str] | None = None) -> list[str]:
        command = [self.options.compiler, "-std=c++17", "-O0", "-fPIC", "-fopenmp", "-w",
                   "-DEIGEN_DISABLE_UNALIGNED_ARRAY_ASSERT", "-DBOOST_ALLOW_DEPRECATED_HEADERS",
                   "-DBOOST_BIND_GLOBAL_PLACEHOLDERS", f"-DSTATEJUMP_YADE_VARIANT={self.options.variant}", *alignment]
        if headers:
            command += ["-include", str(self.pch), *(first or []), f"-I{headers}", f"-I{self.options.generated}"]
        return command + [f"-isystem{path}" for path in self.options.include]

    def object(self, source: Path, folder: Path | None = None) -> Path:
        """Compile a source of the interface check; headers generated in the folder take precedence over those of the
        build."""
        target = (folder or self.folder) / f"{source.stem}.o"
        first = [f"-I{folder}"] if folder else []
        self._run([*self._command(NO_ALIGNMENT, self.headers, first), "-c", str(source), "-o", str(target)])
        return target

    def static_asserts_refuse(self, headers: Path, alignment: list[str] = NO_ALIGNMENT) -> bool:
        """Return whether the measurements contradict the declarations at compile time."""
        source = headers / HEADERS / "layout_checks.hpp"
        done = subprocess.run([*self._command(alignment, headers), "-fsyntax-only", "-x", "c++", str(source)],
                              capture_output=True, text=True, check=False)
        return done.returncode != 0

    def module(self, folder: Path, headers: Path, alignment: list[str] = NO_ALIGNMENT,
               objects: list[Path] | None = None) -> str:
        """Build folder/_native.so with the declarations in ``headers``; return the compiler's messages if it fails."""
        folder.mkdir(parents=True, exist_ok=True)
        declared = folder / "declared.o"
        done = subprocess.run(
            [*self._command(alignment, headers), "-DSTATEJUMP_NO_LAYOUT_CHECKS", "-c",
             str(self.options.abi / "src" / "declared.cpp"), "-o", str(declared)],
            capture_output=True, text=True, check=False)
        if done.returncode:
            return done.stderr
        # The YADE that loads the module already has all libraries open; linking them would take longer than compiling.
        self._run([self.options.compiler, "-shared", "-fopenmp", *map(str, objects or self.objects), str(declared),
                   "-o", str(folder / "_native.so")])
        return ""


class Yade:
    """One running YADE that answers requests, each in a forked process."""

    def __init__(self, folder: Path) -> None:
        requests, answers = folder / "requests", folder / "answers"
        for pipe in (requests, answers):
            os.mkfifo(pipe)
        environment = dict(os.environ, STATEJUMP_REQUESTS=str(requests), STATEJUMP_ANSWERS=str(answers),
                           OMP_WAIT_POLICY="PASSIVE", PYTHONDONTWRITEBYTECODE="1")
        self._log = (folder / "yade.log").open("w")
        self._process = subprocess.Popen(["yade", "-n", "-x", str(HERE / "in_yade.py")], env=environment, cwd=folder,
                                         stdin=subprocess.DEVNULL, stdout=self._log, stderr=self._log)
        self._requests = requests.open("w")
        self._answers = answers.open()
        self._lock = threading.Lock()

    def ask(self, task: str, folder: Path) -> dict[str, Any]:
        """Run a task with the module in a folder; return its result, or {"crash": status} if the process ended without
        one."""
        with self._lock:
            self._requests.write(json.dumps({"task": task, "folder": str(folder)}) + "\n")
            self._requests.flush()
            return json.loads(self._answers.readline())

    def close(self) -> None:
        """End YADE."""
        self._requests.close()
        self._answers.close()
        self._process.wait(timeout=60)
        self._log.close()


def edited(text: str, class_name: str | None, edits: list[tuple[str, str]], name: str) -> str:
    """Return the text of a header after each edit was applied exactly once inside of its class."""
    start, end = class_range(text, class_name) if class_name else (0, len(text))
    part = text[start:end]
    for old, new in edits:
        if part.count(old) != 1:
            sys.exit(f"{name}: search text found {part.count(old)} times, not once: {old!r}")
        part = part.replace(old, new)
    return text[:start] + part + text[end:]


def class_range(text: str, class_name: str) -> tuple[int, int]:
    """Return begin and end of a class in a text."""
    head = text.find(f"\nclass {class_name} ")
    while head >= 0 and text[head:text.index("\n", head + 1)].endswith(";"):
        head = text.find(f"\nclass {class_name} ", head + 1)
    if head < 0:
        head = text.find(f"\nclass {class_name}\n")
    if head < 0:
        sys.exit(f"class {class_name} is gone")
    return head, text.index("\n};\n", head) + 1
