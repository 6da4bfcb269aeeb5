# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs clang-tidy on the engine and on the headers of the kernel, with the compile commands of the build. GCC's
precompiled headers are left out, because Clang cannot read them.

    clang_tidy.py CLANG_TIDY BUILD PATTERN...      PATTERN: a regular expression of the paths of sources

Clang needs five seconds for the headers that a source includes. Therefore eight sources are checked as one batch: a
source that includes all eight. Sources with equal local names go to different batches. If a batch does not compile, its
sources are checked one by one.
"""
from __future__ import annotations

import json
import re
import shlex
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from pathlib import Path

CONFIGURATION = Path(__file__).resolve().parents[2] / ".clang-tidy"
PRECOMPILED = re.compile(r" -Winvalid-pch| -include \S*cmake_pch\.hxx")
PRIVATE = re.compile(r"^namespace \{$(.*?)^\}  // namespace$", re.MULTILINE | re.DOTALL)
# A declaration at the beginning of a line: its text before a parenthesis, a brace or an equals sign.
DECLARED = re.compile(r"^(?![ }/#])[^;{(=\n]*?(\w+)(?: final)?(?=\(| =| \{|\{)", re.MULTILINE)
MOST = 8  # number of sources per batch, which keeps both processors busy to the end
PROCESSES = 2


@dataclass
class Batch:
    """Sources that are compiled with the same options."""

    words: list[str]  # of the command, without source and output
    directory: str
    files: list[Path] = field(default_factory=list)
    names: set[str] = field(default_factory=set)


def private_names(text: str) -> set[str]:
    """Return what a source declares for itself."""
    return {name for block in PRIVATE.findall(text) for name in DECLARED.findall(block)}


def options(command: str) -> list[str]:
    """Return the arguments of a compile command without its source, output and precompiled header."""
    kept, words = [], iter(shlex.split(PRECOMPILED.sub("", command)))
    for word in words:
        if word in ("-o", "-c", "-MF", "-MT"):
            next(words)
        elif word != "-MD":
            kept.append(word)
    return kept


def batches(entries: list[dict[str, str]]) -> list[Batch]:
    """Return the sources in batches, the larger ones first."""
    found: list[Batch] = []
    for entry in sorted(entries, key=lambda entry: entry["file"]):
        file, words = Path(entry["file"]), options(entry["command"])
        names = private_names(file.read_text(encoding="utf-8"))
        for batch in found:
            if batch.words == words and len(batch.files) < MOST and not batch.names & names:
                break
        else:
            batch = Batch(words, entry["directory"])
            found.append(batch)
        batch.files.append(file)
        batch.names |= names
    return sorted(found, key=lambda batch: -len(batch.files))


def run(tidy: str, batch: Batch, folder: Path) -> tuple[int, str]:
    """Check the sources of a batch together; return the exit status and the output of clang-tidy."""
    folder.mkdir()
    source = folder / "batch.cpp"
    source.write_text("".join(f'#include "{file}"\n' for file in batch.files), encoding="utf-8")
    entry = {"directory": batch.directory, "file": str(source),
             "command": shlex.join([*batch.words, "-c", str(source)])}
    (folder / "compile_commands.json").write_text(json.dumps([entry]), encoding="utf-8")
    done = subprocess.run([tidy, "-quiet", "-p", str(folder), f"--config-file={CONFIGURATION}", str(source)],
                          capture_output=True, text=True, check=False)
    if done.returncode != 0 and len(batch.files) > 1:  # names of one source may shadow those of another
        print(f"clang_tidy.py: one by one: {', '.join(file.name for file in batch.files)}", file=sys.stderr)
        alone = [run(tidy, Batch(batch.words, batch.directory, [file]), folder / file.stem)
                 for file in batch.files]
        return max(status for status, _ in alone), "".join(text for _, text in alone)
    return done.returncode, done.stdout


def main(tidy: str, build: Path, patterns: list[str]) -> int:
    """Return the exit status of clang-tidy; 2 if a pattern matches no source."""
    entries = json.loads((build / "compile_commands.json").read_text(encoding="utf-8"))
    for pattern in patterns:
        if not any(re.search(pattern, entry["file"]) for entry in entries):
            print(f"clang_tidy.py: {pattern}: the build has no such source", file=sys.stderr)
            return 2
    chosen = [entry for entry in entries if any(re.search(pattern, entry["file"]) for pattern in patterns)]
    found = batches(chosen)
    with tempfile.TemporaryDirectory() as folder, ThreadPoolExecutor(PROCESSES) as pool:
        places = [Path(folder, str(number)) for number in range(len(found))]
        done = list(pool.map(lambda batch, place: run(tidy, batch, place), found, places))
    for status, text in done:
        if status:
            print(text)
    return max(status for status, _ in done)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1], Path(sys.argv[2]), sys.argv[3:]))
