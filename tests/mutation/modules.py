# SPDX-License-Identifier: GPL-3.0-or-later
"""Modules of the mutation campaign, and the tests that must detect their mutants."""
from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
KERNEL = "contact_laws/kernel/include/statejump/kernel"


@dataclass(frozen=True)
class Module:
    """Files that are mutated one at a time, and their tests, the cheapest first.

    :param sources: patterns of the files, relative to the repository
    :param guards: tests. For headers: test files, each compiled with the mutant. For Python: test files; those that
        execute a mutant are run. For a library: built test programs, into which the mutant is linked; names of single
        tests may follow a colon
    :param wanted: smallest required fraction of detected mutants
    :param own: Python test files that run every mutant whose statement they execute
    """

    name: str
    sources: tuple[str, ...]
    guards: tuple[str, ...]
    wanted: float = 0.85
    own: tuple[str, ...] = ()

    def files(self, root: Path) -> list[Path]:
        """Return the files, in order."""
        return sorted(path for pattern in self.sources for path in root.glob(pattern))


def _tests(folder: str) -> tuple[str, ...]:
    """Return the test files in a folder of tests/cpp, the shortest file first, because it takes the least time."""
    files = sorted((ROOT / "tests" / "cpp" / folder).glob("*_test.cpp"), key=lambda file: file.stat().st_size)
    return tuple(str(file.relative_to(ROOT)) for file in files)


# All tests of the kernel and of its laws.
_KERNEL_TESTS = _tests("kernel")
_LAW_TESTS = _tests("laws")


def _engine(name: str, *more: str) -> Module:
    return Module(name, (f"engine/src/{name}/**/*.cpp", *more), (f"{name}_tests",))


def _quick() -> tuple[str, ...]:
    """Return the test files of tests/python that ctest labels quick."""
    folder = ROOT / "tests" / "python"
    slow = re.findall(r"python_(\w+)", (folder / "CMakeLists.txt").read_text(encoding="utf-8"))
    return tuple(name for name in sorted(file.stem.removeprefix("test_") for file in folder.glob("test_*.py"))
                 if name not in slow)


def _python(name: str, sources: tuple[str, ...], *own: str) -> Module:
    """Return a module with these test files and all quick ones."""
    files, others = ([f"tests/python/test_{test}.py" for test in tests]
                     for tests in (own, (test for test in _quick() if test not in own)))
    return Module(name, tuple(f"python/statejump/{source}" for source in sources), (*files, *others), own=tuple(files))


MODULES = [
    Module("kernel", (f"{KERNEL}/*.hpp",), (*_KERNEL_TESTS, *_LAW_TESTS), 0.95),
    Module("laws", (f"{KERNEL}/laws/*.hpp",), (*_LAW_TESTS, *_KERNEL_TESTS), 0.95),
    Module("thermal", ("thermal/include/statejump/thermal/*.hpp",), ("tests/cpp/thermal/program_test.cpp",)),
    _engine("spring_slider"),
    _engine("linkage", "engine/src/linkage/rates.hpp"),
    _engine("rest_set", "engine/src/rest_set/arcs.hpp"),
    _engine("complementarity"),
    # Random trusses take nine tenths of the time, so they run only the mutants that other tests do not detect.
    Module("truss", ("engine/src/truss/**/*.cpp",), ("truss_tests:-*RandomTrusses*", "truss_tests:*RandomTrusses*")),
    Module("geometry", ("geometry/src/**/*.cpp",), ("geometry_tests",)),
    _python("schema", ("schema/*.py",), "schema_rules", "schema", "limits"),
    _python("validation", ("kinds/*/case.py", "kinds/truss/checks.py"), "case_checks", "schema", "statics"),
    _python("verdicts", ("kinds/*/compare.py", "core/comparison.py", "results/difference.py"), "comparisons",
            "verdict_rows"),
]
