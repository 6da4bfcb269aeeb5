# SPDX-License-Identifier: GPL-3.0-or-later
"""What a campaign of mutants breaks, and which tests have to notice."""
from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
KERNEL = "contact_laws/kernel/include/statejump/kernel"


@dataclass(frozen=True)
class Module:
    """Files that are broken one at a time, and the tests that guard them, those that cost least first.

    :param sources: patterns of the files, from the repository
    :param guards: test files of headers (each is compiled with the mutant) and of Python; names of the built test
        programs of a library, into which the mutant is linked
    :param wanted: least share of mutants that has to be noticed
    """

    name: str
    sources: tuple[str, ...]
    guards: tuple[str, ...]
    wanted: float = 0.85

    def files(self, root: Path) -> list[Path]:
        """Return the files, in order."""
        return sorted(path for pattern in self.sources for path in root.glob(pattern))


def _tests(folder: str) -> tuple[str, ...]:
    """Return the test files of a folder of tests/cpp, the shortest first: they cost least."""
    files = sorted((ROOT / "tests" / "cpp" / folder).glob("*_test.cpp"), key=lambda file: file.stat().st_size)
    return tuple(str(file.relative_to(ROOT)) for file in files)


# Every test of the kernel, and of what is a law of it.
_KERNEL_TESTS = _tests("kernel")
_LAW_TESTS = _tests("laws")


def _engine(name: str, *more: str) -> Module:
    return Module(name, (f"engine/src/{name}/**/*.cpp", *more), (f"{name}_tests",))


def _python(name: str, sources: tuple[str, ...], *tests: str) -> Module:
    return Module(name, tuple(f"python/statejump/{source}" for source in sources),
                  tuple(f"tests/python/test_{test}.py" for test in tests))


MODULES = [
    Module("kernel", (f"{KERNEL}/*.hpp",), (*_KERNEL_TESTS, *_LAW_TESTS), 0.95),
    Module("laws", (f"{KERNEL}/laws/*.hpp",), (*_LAW_TESTS, *_KERNEL_TESTS), 0.95),
    Module("thermal", ("thermal/include/statejump/thermal/*.hpp",), ("tests/cpp/thermal/program_test.cpp",)),
    _engine("spring_slider"),
    _engine("linkage", "engine/src/linkage/rates.hpp"),
    _engine("rest_set", "engine/src/rest_set/arcs.hpp"),
    _engine("complementarity"),
    _engine("truss"),
    Module("geometry", ("geometry/src/**/*.cpp",), ("geometry_tests",)),
    _python("schema", ("schema/*.py",), "schema", "bad_input", "properties", "case_as_dict", "limits",
            "truss_campaign"),
    _python("validation", ("kinds/*/case.py", "kinds/truss/checks.py", "kinds/fclib/case.py"), "bad_input", "schema",
            "truss_case", "umbrella_case", "thermal_tables", "fclib", "statics"),
    _python("verdicts", ("kinds/*/compare.py", "core/comparison.py", "results/difference.py"), "verdict_rows",
            "not_finite", "result_file", "truss_compare", "end_to_end", "umbrella_compare"),
]
