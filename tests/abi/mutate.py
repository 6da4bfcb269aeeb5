#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Mutation test of the guard (interface check): it must refuse every wrong declaration of YADE's interface.

Every mutation edits a copy of the headers that declare the interface; the copy is compiled without static assertions.
The guard inside a running YADE must report the mutation without build identifiers, before it calls any code of YADE. A
crash is no refusal. An edit without effect on sizes, members and virtual function tables is replaced by another.
"""
from __future__ import annotations

import argparse
import collections
import concurrent.futures
import re
import shutil
import sys
import tempfile
import time
from pathlib import Path

from bench import HEADERS, NO_ALIGNMENT, Compiler, Yade, add_options
from mutations import Mutation, Random, named

# Checks that neither call code of YADE nor write to its objects.
HARMLESS = {"compiler", "loader", "size", "table", "getter", "coverage"}


class Examination:
    """Examines mutations and counts what saw them."""

    def __init__(self, compiler: Compiler, yade: Yade) -> None:
        self.compiler = compiler
        self.yade = yade
        unchanged = compiler.folder / "unmutated"
        words = compiler.module(unchanged, compiler.headers)
        if words:
            sys.exit(f"the declarations do not compile:\n{words}")
        said = yade.ask("checks", unchanged)
        if said.get("check") != "":
            sys.exit(f"the declarations as they are are refused: {said}")
        self.description = said["description"]

    def examine(self, mutation: Mutation) -> tuple[str, str, str]:
        """Return the check that detected a mutation, its message, and a fault of the interface check (empty: none). The
        check is "" for an edit without effect."""
        place = self.compiler.folder / mutation.name.replace(" ", "_")
        headers = place / "include"
        try:
            shutil.copytree(self.compiler.headers, headers)
            (headers / HEADERS / f"{mutation.header}.hpp").write_text(mutation.changed)
            alignment = [] if mutation.aligned else NO_ALIGNMENT
            if self.compiler.module(place, headers, alignment):
                return "compiler", "(does not compile)", ""
            said = self.yade.ask("checks", place)
            if "crash" in said:
                return "crash", f"(status {said['crash']})", "YADE crashed"
            if "error" in said:  # YADE lacks a function, so the module cannot be loaded
                return "loader", said["error"], ""
            if said["description"] == self.description:
                return "", "", "changes nothing" if mutation.check else ""
            wrong = ""
            if not said["check"]:
                wrong = "the guard accepts it"
            elif mutation.check not in ("", said["check"]):
                wrong = f"refused, but not by the check meant ({mutation.check})"
            return said["check"], said["sentence"], wrong
        finally:
            shutil.rmtree(place, ignore_errors=True)


def unmutated(compiler: Compiler, yade: Yade) -> tuple[str, str]:
    """Return message and fault of the interface check for unchanged declarations, which it must accept without change
    of the user's scene."""
    place = compiler.folder / "unmutated"
    if compiler.static_asserts_refuse(compiler.headers):
        return "", "static assertions refuse it"
    said = yade.ask("scene", place)
    if "check" not in said:
        return "", f"no answer: {said}"
    if said["check"]:
        return said["sentence"], "the guard refuses it"
    return f"(accepted in {1000 * said['seconds']:.1f} ms)", "" if said["same"] else "the user's scene changed"


def other_build(compiler: Compiler, yade: Yade) -> tuple[str, str]:
    """Return message and fault of the interface check for a library with an unknown build identifier: the message must
    contain a command."""
    place = compiler.folder / "other_build"
    package = place / "statejump_yade"
    package.mkdir(parents=True)
    for file in compiler.options.package.glob("*.py"):
        shutil.copy(file, package)
    generated = place / HEADERS
    generated.mkdir(parents=True)
    table = (compiler.options.generated / HEADERS / "known_binaries.inc").read_text()
    row = int(re.search(r"built_for_row = (\d+)", table)[1])
    known = re.findall(r'"([0-9a-f]{40})"', table)[3 * row + 2]
    (generated / "known_binaries.inc").write_text(table.replace(known, "0" * 40))
    guard = compiler.object(compiler.options.abi / "src" / "guard.cpp", place)
    objects = [one for one in compiler.objects if one.stem != "guard"] + [guard]
    compiler.module(package, compiler.headers, objects=objects)
    said = yade.ask("package", place)
    sentence = said.get("sentence", "")
    if not sentence.startswith(f"statejump_yade refuses to load: libpkg_dem.so has build identifier {known}"):
        return str(said), "the import does not name the library and its build identifier"
    if "scripts/measure_yade" not in sentence:
        return sentence, "the command that measures is not named"
    return sentence, "more than one sentence" if "\n" in sentence or said["cause"] else ""


def main() -> int:
    """Examine all mutations; return 0 if the interface check handles all of them."""
    parser = argparse.ArgumentParser(description=__doc__)
    add_options(parser)
    parser.add_argument("--random", type=int, default=0, help="so many mutations at random beside the listed ones")
    parser.add_argument("--seconds", type=float, default=float("inf"), help="no further random ones after this time")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", default="", help="regular expression: just these of the listed mutations")
    options = parser.parse_args()
    start = time.monotonic()
    failures = same = 0
    counts: collections.Counter[tuple[str, str]] = collections.Counter()
    called = crashes = elsewhere = 0
    with tempfile.TemporaryDirectory(prefix="statejump-abi-") as name:
        compiler = Compiler(options, Path(name))
        yade = Yade(Path(name))
        examination = Examination(compiler, yade)
        for title, examine in (("unmutated", unmutated), ("other_build", other_build)):
            sentence, wrong = examine(compiler, yade)
            failures += bool(wrong)
            print(f"{'FAILED' if wrong else 'ok':6} {title:38} {sentence}  {wrong}", flush=True)
        listed = [one for one in named(compiler.headers) if re.search(options.only, one.name)]
        source = Random(compiler.headers, options.seed)
        with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
            waiting = {pool.submit(examination.examine, one): one for one in listed}
            made = 0
            # Half of the random mutations are in parts that the list does not edit.
            wanted = {True: options.random // 2, False: options.random - options.random // 2}

            def another() -> bool:
                return max(wanted.values()) > 0 and time.monotonic() - start < options.seconds

            while waiting or another():
                while another() and len(waiting) < 2 * options.jobs:
                    in_list = wanted[True] > wanted[False]
                    made += 1
                    wanted[in_list] -= 1
                    one = source.mutation(made, in_list)
                    waiting[pool.submit(examination.examine, one)] = one
                done, _ = concurrent.futures.wait(waiting, return_when=concurrent.futures.FIRST_COMPLETED)
                for task in done:
                    one = waiting.pop(task)
                    check, sentence, wrong = task.result()
                    if not check and not wrong:  # no mutation: make another one
                        same += 1
                        wanted[one.listed] += 1
                        continue
                    failures += bool(wrong)
                    counts[one.kind, check] += 1
                    called += check not in HARMLESS
                    crashes += check == "crash"
                    elsewhere += one.kind != "listed" and not one.listed
                    if wrong or one.kind == "listed":
                        print(f"{'FAILED' if wrong else 'ok':6} {one.name:38} {check:9} {sentence}"
                              + (f"  <-- {wrong}" if wrong else ""), flush=True)
                        if wrong and one.kind != "listed":
                            Path(f"mutation_{one.name.replace(' ', '_')}.hpp").write_text(one.changed)
        yade.close()
    checks = sorted({check for _, check in counts})
    print(f"\n{'':18}" + "".join(f"{check:>10}" for check in checks) + f"{'all':>10}")
    for kind in sorted({kind for kind, _ in counts}):
        row = [counts[kind, check] for check in checks]
        print(f"{kind:18}" + "".join(f"{count:10d}" for count in row) + f"{sum(row):10d}")
    print(f"{sum(counts.values())} mutations, {elsewhere} of them in parts of classes that the list leaves alone; "
          f"{failures} not as they should be, {crashes} crashes; {called} were refused by checks that call YADE's "
          f"functions on objects of the guard's own; "
          f"{same} edits changed nothing; {time.monotonic() - start:.0f} s")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
