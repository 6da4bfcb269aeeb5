# SPDX-License-Identifier: GPL-3.0-or-later
"""Changes made by the mutation campaign, and its counts."""
from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).resolve().parent))

from campaign import Score, campaign, explained  # noqa: E402
from journal import Journal  # noqa: E402
from modules import MODULES, Module  # noqa: E402
from operators import Mutant, mutants  # noqa: E402
from python_guards import statement_lines  # noqa: E402
from switched import SWITCH, VARIABLE, switched  # noqa: E402

REPOSITORY = Path(__file__).resolve().parents[2]
CPP = """// a < b in a comment
#include <cmath>
double f(double a, const double* b) {
  const char* text = "a < b && 1";
  if (a < 2.0 && !text) return -a;
  double c = a + *b;
  c *= 0.5;
  return std::max(c, a);
}
"""
# If a statement with an else is removed, the else still belongs to its if.
BRANCHED = CPP.replace("  c *= 0.5;\n", "  if (text)\n    c *= 0.5;\n  else\n    c *= 0.5;\n")
PYTHON = '''"""1 < 2 in a text"""
def f(a: int = 3, b: "int | None" = None) -> float:
    if a < 2 and b is None:
        raise ValueError(f"{a + 1} is not allowed")
    return -a * 0.5
'''


def changes(file: str, text: str) -> set[tuple[str, str, str]]:
    return {(one.operator, text[one.start: one.end], one.replacement) for one in mutants(file, text)}


def test_changes_of_cpp() -> None:
    assert changes("f.cpp", CPP) == {
        ("relational", "<", ">="), ("boundary", "<", "<="), ("logical", "&&", "||"),
        ("sign", "-", ""), ("arithmetic", "+", "-"), ("arithmetic", "*=", "/="), ("constant", "0.5", "1.0"),
        ("function", "max", "min"), ("removed statement", "c *= 0.5;", ";"),
        ("removed statement", "if (a < 2.0 && !text) return -a;", ";"),
    }


def test_changes_of_python() -> None:
    assert changes("f.py", PYTHON) == {
        ("constant", "3", "4"), ("relational", "<", ">="), ("boundary", "<", "<="), ("constant", "2", "3"),
        ("logical", "and", "or"), ("relational", "is", "is not"), ("arithmetic", "*", "/"), ("sign", "-a", "a"),
        ("constant", "0.5", "1.0"), ("condition", "a < 2 and b is None", "(not (a < 2 and b is None))"),
        ("removed statement", 'raise ValueError(f"{a + 1} is not allowed")', "pass"),
    }
    for one in mutants("f.py", PYTHON):
        compile(one.applied(PYTHON), "f.py", "exec")


def test_lines_of_a_statement_of_python() -> None:
    """The lines of a compound statement are only its head. Otherwise tests of its body would be run in vain."""
    text = "x = (1 +\n     2)\ndef f(a=3,\n      b=4):\n    if a < 5: return 6\n    return 7\n"

    def lines(what: str) -> list[int]:
        return list(statement_lines(text, text.index(what)))

    assert [lines(what) for what in ("1 +", "2)", "3,", "4)", "< 5", "6", "7")] == [
        [1, 2], [1, 2], [3, 4], [3, 4], [5], [5], [6]]


def test_build_with_all_mutants_is_each_of_them(tmp_path: Path) -> None:
    """One build holds the original of f(1, &3) and all mutants. Each is compared with the separately compiled mutant.
    """
    numbered = dict(enumerate(mutants("f.cpp", BRANCHED), start=1))
    main = ('#include <cstdio>\nint main() {\n  const double b = 3;\n'
            '  for (double a : {1.0, 2.0, 5.0}) std::printf("%g ", f(a, &b));\n}\n')

    def built(text: str, name: str) -> Path:
        source = tmp_path / f"{name}.cpp"
        source.write_text(SWITCH.replace("#pragma once\n", "") + "#include <algorithm>\n" + text + main)
        subprocess.run([os.environ.get("CXX", "c++"), "-std=c++17", "-w", source, "-o", tmp_path / name], check=True)
        return tmp_path / name

    def told(program: Path, number: int = 0) -> str:
        return subprocess.run([program], env={**os.environ, VARIABLE: str(number)}, capture_output=True, text=True,
                              check=True).stdout

    left, rounds, seen = dict(numbered), 0, set()
    while left and rounds < 6:  # mutants of one statement exclude each other
        text, lines = switched(BRANCHED, left)
        assert text.count("\n") == BRANCHED.count("\n")
        program = built(text, f"all{rounds}")
        assert told(program) == told(built(BRANCHED, "original"))
        for number in lines:
            alone = built(numbered[number].applied(BRANCHED), f"one{number}")
            assert told(program, number) == told(alone), numbered[number]
        seen |= set(lines)
        left = {number: one for number, one in left.items() if number not in lines}
        rounds += bool(lines) or 6
    assert seen == set(numbered)


def test_module_files_and_tests_exist() -> None:
    for module in MODULES:
        assert module.files(REPOSITORY), module.name
        for guard in module.guards:
            assert guard.partition(":")[0].endswith("_tests") or (REPOSITORY / guard).is_file(), guard


def test_explained_mutants_are_still_there() -> None:
    """Explanations for lines that no longer exist must be removed."""
    import tomllib

    text = (Path(__file__).resolve().parent / "equivalent.toml").read_text()
    for entry in tomllib.loads(text).get("mutant", []):
        source = (REPOSITORY / entry["file"]).read_text()
        assert any(explained(one, source) == entry["why"] for one in mutants(entry["file"], source)), entry


class Oracle:
    """Detects mutants that change a number; a mutant that removes a statement does not compile."""

    def prepare(self, wanted: list[Mutant]) -> None:
        """Nothing to make ready."""

    def tried(self, mutant: Mutant) -> tuple[str, str]:
        """Return what becomes of a mutant."""
        if mutant.operator == "removed statement":
            return "does not compile", ""
        return ("killed", "oracle") if mutant.operator == "constant" else ("survived", "")


def test_score_and_journal(tmp_path: Path) -> None:
    (tmp_path / "f.cpp").write_text(CPP)
    module, journal, said = Module("one", ("f.cpp",), ("f_tests",)), Journal(tmp_path / "journal"), []
    score = campaign(module, Oracle, tmp_path, 100, 1, journal, said.append)
    assert (score.population, score.killed, len(score.survivors), score.invalid) == (10, 1, 7, 2) and len(said) == 10
    again = campaign(module, Oracle, tmp_path, 100, 1, Journal(tmp_path / "journal"), said.append)
    assert again.killed == 1 and len(said) == 17  # only survivors are tried again
    (tmp_path / "f.cpp").write_text(CPP + "\n")
    campaign(module, Oracle, tmp_path, 3, 1, Journal(tmp_path / "journal"), said.append)
    assert len(said) >= 20


def test_interval_by_hand() -> None:
    """Wilson's interval for 8 of 10 is 49 to 94 %."""
    low, high = Score(MODULES[0], 100, 8, ["", ""]).interval()
    assert (low, high) == pytest.approx((0.4902, 0.9433), abs=5e-5)
