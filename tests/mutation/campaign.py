#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Mutation testing: counts for each module how many mutants of a random sample the tests detect.

Many C++ mutants share one build, and an environment variable selects one of them at run time (switched.py); the others
are compiled separately. A mutated header is compiled with the tests that include it; a mutated file of a library is
linked into the built test program, before the library. A Python mutant is run with the test files that execute its
statement, in a process forked after the slow imports. Mutants that do not compile do not count. The unmutated sources
must pass.

The seed determines the sample. A journal keeps results, so that a mutant is not run again while its file is unchanged.
equivalent.toml lists survivors that no test can detect, with the reason.

Exit status: 0 every module reaches its score, 1 some module does not, 2 the set-up is wrong.
"""
from __future__ import annotations

import argparse
import math
import random
import sys
import tempfile
import tomllib
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path

from guards import INVALID, KILLED, SURVIVED, Guards, HeaderGuards, LibraryGuards, SetUp
from journal import Journal
from modules import MODULES, Module
from operators import Mutant, mutants
from python_guards import PythonGuards

HERE = Path(__file__).resolve().parent
EQUIVALENT = HERE / "equivalent.toml"


@dataclass
class Score:
    """Results of the mutants of a module."""

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
        """Return Wilson's 95 % interval of the fraction of detected mutants among all mutants."""
        if not self.tried:
            return 0.0, 1.0
        n, z = self.tried, 1.959964
        share, spread = self.killed / n, z * z / n
        middle = (share + spread / 2) / (1 + spread)
        half = z * math.sqrt(share * (1 - share) / n + spread / (4 * n)) / (1 + spread)
        return max(0.0, middle - half), min(1.0, middle + half)

    def row(self) -> str:
        """Return a row of the table of docs/validation/reliability_methods.md."""
        low, high = self.interval()
        share = self.killed / self.tried if self.tried else 0.0
        return (f"| {self.module.name} | {self.population} | {self.tried + len(self.equivalent)} | {self.killed} | "
                f"{len(self.survivors)} | {len(self.equivalent)} | {100 * share:.0f} % | {100 * low:.0f} to "
                f"{100 * high:.0f} % | {100 * self.module.wanted:.0f} % |")


def guards_of(module: Module, root: Path, folder: Path, build: Path, journal: Journal) -> Guards:
    """Return the object that runs the mutants of a module."""
    if module.guards[0].endswith(".py"):
        return PythonGuards(module, root, folder, build, journal)
    return (HeaderGuards if module.guards[0].endswith(".cpp") else LibraryGuards)(module, root, folder, build)


def explained(mutant: Mutant, text: str) -> str | None:
    """Return the listed reason why no test can detect a mutant; None: no reason is listed."""
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
    """Run mutants of a module in random order until the sample is complete."""
    texts = {str(path.relative_to(root)): path.read_text(encoding="utf-8") for path in module.files(root)}
    whole = [mutant for file, text in texts.items() for mutant in mutants(file, text)]
    random.Random(f"{module.name} {seed}").shuffle(whole)
    score = Score(module, len(whole))

    def known(mutant: Mutant) -> str | None:
        """Return the journal's result of a mutant; None: it must be run."""
        found = journal.known.get(journal.key(mutant, texts[mutant.file]))
        return None if found == SURVIVED and explained(mutant, texts[mutant.file]) is None else found

    # Some mutants do not compile, so 5 % more are prepared; further ones are run one by one.
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
    """Yield the modules with the given names; all modules without names. :raises SetUp: a module does not exist"""
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
