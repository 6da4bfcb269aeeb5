#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Kills commands and checks that their results are complete or absent, never partial.

    kills.py --command build/bin/statejump --python build/python --library build/.../failing_calls.so
        [--most N] [--instants N] [--only NAME ...] [--seed N]

Every command runs in a folder with results of an older run. It is killed at random instants, and before each of its
calls that write, sync, rename, make or remove something in the results. Each of these calls also fails once with ENOSPC
and once with EIO. Then the next run opens the folder as usual. The folder must hold exactly the files of the old run or
of the new run, byte by byte, and no others; the journal of a campaign must hold complete samples. The exit status must
be in docs/reference/mistakes.md, without a traceback.

A short run spends most of its time on starting Python. Therefore nine of ten runs are forks of a server that has loaded
the command's modules (forkserver.py); every tenth run starts the command itself.
"""
from __future__ import annotations

import argparse
import errno
import hashlib
import os
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

from forkserver import Ended, Forkserver

REPOSITORY = Path(__file__).resolve().parents[2]
# What of a command's files is of the day, not of the result.
OF_THE_DAY = ("dem_run.json", "run.json", "samples.journal")
SORTS = ("killed before a call", "a call fails, ENOSPC", "a call fails, EIO", "killed at an instant")
STARTED = 10  # every so many runs the command itself is started


@dataclass
class Subject:
    """A command and the folder of its results. ``{case}`` in the words of the command stands for the case file."""

    name: str
    words: list[str]
    folder: str
    case: str
    old: tuple[str, str]  # what of the case is another in the older run
    calls: int = 0
    counts: dict[str, int] = field(default_factory=dict)
    faults: list[str] = field(default_factory=list)


FRICTION = ("friction_coefficient = 0.3", "friction_coefficient = 0.2")
SUBJECTS = (
    Subject("reduced", ["reduced", "case.toml", "--quiet"], "results/table1", "table1.toml", FRICTION),
    Subject("compare", ["compare", "case.toml", "--quiet"], "results/table1", "table1.toml", FRICTION),
    Subject("laws", ["laws", "--quiet"], "results/laws", "table1.toml", ("", "")),
    Subject("statics", ["statics", "case.toml", "--quiet"], "results/statics_journal", "statics_journal.toml",
            ("title = ", "title = 'old' #")),
    Subject("control", ["control", "case.toml", "--quiet"], "results/table1", "table1.toml", FRICTION),
    Subject("truss draw", ["truss", "draw", "case.toml", "--quiet"], "results/chain_10", "trusses/chain_10.toml",
            ("title = ", "title = 'old' #")),
    Subject("truss answers", ["truss", "answers", "case.toml", "--no-sensitivity", "--quiet"], "results/chain_10",
            "trusses/chain_10.toml", ("title = ", "title = 'old' #")),
    Subject("sweep", ["sweep", "campaign.toml", "--quiet"], "results/campaign_table1_friction", "table1.toml",
            FRICTION),
    Subject("export", ["export", "given.h5", "--to", "results/out", "--frames", "3", "--quiet"], "results/out",
            "table1.toml", FRICTION),
    Subject("report", ["report", "given.h5", "-o", "results/page/report.html", "--quiet"], "results/page",
            "table1.toml", FRICTION),
)


class Campaign:
    """Runs commands in folders of their own. A context manager."""

    def __init__(self, command: Path, python: Path, library: Path, root: Path) -> None:
        self.command, self.library, self.root = command, library, root
        sys.path.insert(0, str(python))
        self.canned = root / "canned"
        self.canned.mkdir()
        self.environment = {**os.environ, "STATEJUMP_YADE": str(self._yade()), "PYTHONDONTWRITEBYTECODE": "1"}
        self.runs = 0
        self.server = Forkserver(command, {**self.environment, "LD_PRELOAD": str(library)}, root)

    def __enter__(self) -> Campaign:
        return self

    def __exit__(self, *ignored: object) -> None:
        self.server.__exit__()

    def _yade(self) -> Path:
        """Return a command that replaces YADE: it returns histories of the reduced model as those of the DEM, because
        only the files are tested."""
        script = self.canned / "yade"
        script.write_text(f'#!/bin/sh\ncp {self.canned}/dem.samples "$STATEJUMP_OUTPUT"\n'
                          'echo "{}" > "$STATEJUMP_OUTPUT.json"\necho \'STATEJUMP {"progress": 1.0}\'\n')
        script.chmod(0o755)
        import numpy as np

        from statejump import load
        from statejump.core.samples import names_line, rows_of

        run = load(REPOSITORY / "cases" / "table1.toml").reduced()
        columns = run.flat()
        stage = columns.pop("stage")
        zero = np.zeros(len(run))
        columns.update(slipping=np.isin(stage, ("S2", "S5")).astype(float),
                       stop_contact=(np.abs(columns["displacement_m"]) > 1e-3 - 1e-12).astype(float))
        columns = {**dict.fromkeys(("contact_energy_J", "kinetic_energy_J", "damping_dissipation_J",
                                    "external_work_J"), zero), **columns}
        (self.canned / "dem.samples").write_bytes(names_line(columns) + rows_of(list(columns.values())))
        return script

    def prepared(self, subject: Subject, old: bool) -> Path:
        """Return a folder with the case file of the older run or of the new run."""
        folder = Path(tempfile.mkdtemp(dir=self.root))
        text = (REPOSITORY / "cases" / subject.case).read_text(encoding="utf-8")
        campaign = (REPOSITORY / "cases/campaigns/table1_friction.toml").read_text(encoding="utf-8")
        campaign = campaign.replace('"../table1.toml"', '"case.toml"')
        if old:
            assert subject.old[0] in text, subject.old
            text = text.replace(*subject.old, 1)
            campaign = campaign.replace("count = 21", "count = 20")
        (folder / "case.toml").write_text(text, encoding="utf-8")
        (folder / "campaign.toml").write_text(campaign, encoding="utf-8")
        if "given.h5" in subject.words:
            self.run(folder, ["reduced", "case.toml", "--quiet", "--results", "given"])
            (folder / "given/table1/reduced.h5").rename(folder / "given.h5")
            shutil.rmtree(folder / "given")
        return folder

    def run(self, folder: Path, words: list[str], kill_after_s: float | None = None, **doom: object) -> Ended:
        """Run the command through the server, every tenth time directly. Its process group is killed after the given
        seconds."""
        more = {name: str(value) for name, value in doom.items()}
        if more:
            more["DOOM_FOLDER"] = str(folder / "results")
        self.runs += 1
        if self.runs % STARTED:
            return self.server.run(folder, words, more, kill_after_s)
        said = self.root / "said by itself"
        with said.open("wb") as stream, subprocess.Popen(
            [str(self.command), *words], cwd=folder, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=stream,
            env={**self.environment, "LD_PRELOAD": str(self.library), **more}, start_new_session=True,
        ) as process:
            try:
                process.wait(timeout=kill_after_s)
            except subprocess.TimeoutExpired:
                os.killpg(process.pid, signal.SIGKILL)
        return Ended(process.returncode, said.read_text(encoding="utf-8", errors="replace"))

    def over(self, folder: Path, subject: Subject, old: Path) -> None:
        """Put the results of the older run into the folder of the next run."""
        shutil.rmtree(folder / "results", ignore_errors=True)
        shutil.copytree(old / "results", folder / "results")

    def judged(self, subject: Subject, folder: Path, known: dict[str, dict[str, str]], how: str) -> None:
        """Open the folder as the next run does, and compare its files with those of the older and the new run."""
        from statejump.core.errors import StatejumpError
        from statejump.core.results_folder import Results

        where = folder / subject.folder
        if subject.name == "report":  # one file, which needs no folder that is held
            for left in where.glob(".*.partial"):
                left.unlink()
        else:
            with Results(where.parent).folder(where.name):
                pass
        found = contents(where)
        if found not in known.values():
            names = {name for which in known.values() for name in which} ^ set(found) or "other contents"
            subject.faults.append(f"{how}: neither the older nor the new files: {names}")
        journal = where / "samples.journal"
        if journal.exists() and journal.stat().st_size:
            try:
                self.check_journal(folder)
            except StatejumpError as refused:
                subject.faults.append(f"{how}: {refused}")

    def check_journal(self, folder: Path) -> None:
        """Open a campaign's journal. :raises Unreadable: a line other than the last one is damaged"""
        from statejump.campaign.campaign_file import load_campaign
        from statejump.campaign.journal import Journal
        from statejump.core.errors import Unreadable

        plan = load_campaign(folder / "campaign.toml", "sweep")
        try:
            with Journal(folder / "results/campaign_table1_friction", plan, restart=False):
                pass
        except Unreadable:
            raise
        except Exception as other:  # of another campaign: the older one's
            if "belongs to another campaign" not in str(other):
                raise

    def of(self, subject: Subject, most: int, instants: int, generator: random.Random) -> None:
        """Run all tests of a command, with at most the given number of each type."""
        old, new = self.prepared(subject, True), self.prepared(subject, False)
        known = {}
        words = subject.words
        for which, folder in (("old", old), ("new", new)):
            (folder / "results").mkdir(exist_ok=True)
            if which == "new":
                self.server.load(folder, words)
                shutil.rmtree(folder / "results")
                (folder / "results").mkdir()
            done = self.run(folder, words)
            assert done.returncode in (0, 1), done.stderr
            known[which] = contents(folder / subject.folder)
        ordinary = done.returncode
        if subject.name == "sweep":
            words = [*words, "--restart"]
        self.over(new, subject, old)
        started = time.monotonic()
        done = self.server.run(new, words, {"DOOM_FOLDER": str(new / "results"), "DOOM_COUNT": str(new / "count")})
        lasted = time.monotonic() - started
        assert done.returncode == ordinary, done.stderr
        subject.calls = int((new / "count").read_text())
        for call in chosen(subject.calls, most, generator):
            self._killed_before(subject, old, new, words, known, call)
        for error in (errno.ENOSPC, errno.EIO):
            for call in chosen(subject.calls, most, generator):
                self._failing(subject, old, new, words, known, call, error, ordinary)
        for _ in range(instants):
            self._killed_after(subject, old, new, words, known, generator.uniform(0, lasted))
        shutil.rmtree(old)
        shutil.rmtree(new)

    def _killed_before(self, subject: Subject, old: Path, new: Path, words: list[str],
                       known: dict[str, dict[str, str]], call: int) -> None:
        self.over(new, subject, old)
        self.run(new, words, DOOM_CALL=call, DOOM_ERROR=0)
        count(subject, "killed before a call")
        self.judged(subject, new, known, f"killed before call {call}")

    def _failing(self, subject: Subject, old: Path, new: Path, words: list[str], known: dict[str, dict[str, str]],
                 call: int, error: int, ordinary: int) -> None:
        self.over(new, subject, old)
        done = self.run(new, words, DOOM_CALL=call, DOOM_ERROR=error)
        how = f"call {call} fails with {errno.errorcode[error]}"
        count(subject, f"a call fails, {errno.errorcode[error]}")
        if done.returncode not in (ordinary, 2) or "Traceback" in done.stderr:
            subject.faults.append(f"{how}: status {done.returncode}: {done.stderr[-300:]}")
        self.judged(subject, new, known, how)
        if done.returncode == ordinary and contents(new / subject.folder) != known["new"]:
            subject.faults.append(f"{how}: status {ordinary} without the new files")

    def _killed_after(self, subject: Subject, old: Path, new: Path, words: list[str],
                      known: dict[str, dict[str, str]], seconds: float) -> None:
        self.over(new, subject, old)
        self.run(new, words, kill_after_s=seconds)
        count(subject, "killed at an instant")
        self.judged(subject, new, known, f"killed after {seconds:.3f} s")


def contents(folder: Path) -> dict[str, str]:
    """Return the digests of the files below a folder by name; for files that contain the date, only their presence."""
    found = {}
    for path in sorted(folder.rglob("*")):
        if path.is_file() and path.name != "samples.journal":
            content = b"" if path.name in OF_THE_DAY else path.read_bytes()
            found[str(path.relative_to(folder))] = hashlib.sha256(content).hexdigest()
    return found


def chosen(calls: int, most: int, generator: random.Random) -> Iterator[int]:
    """Yield the calls that are made to fail: all, or the given number of them, always with the last ones, which
    publish."""
    if calls <= most:
        yield from range(1, calls + 1)
        return
    last = min(most // 2, calls)
    yield from sorted(generator.sample(range(1, calls - last + 1), most - last))
    yield from range(calls - last + 1, calls + 1)


def told(name: str, counts: dict[str, int], faults: int) -> None:
    """Print what was tried and found."""
    tried = ", ".join(f"{sort} {number}" for sort, number in counts.items())
    print(f"{name}: {tried}; ends {sum(counts.values())}; faults {faults}", flush=True)


def count(subject: Subject, sort: str) -> None:
    """Count one end of a command."""
    subject.counts[sort] = subject.counts.get(sort, 0) + 1


def main() -> int:
    """Run the campaign and print the faults found; return 1 if there are any."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    for name in ("command", "python", "library"):
        parser.add_argument(f"--{name}", type=Path, required=True)
    parser.add_argument("--most", type=int, default=1000, help="ends of each sort at a call, for each command")
    parser.add_argument("--instants", type=int, help="kills at random instants for each command; as many by default")
    parser.add_argument("--only", nargs="*", help="names of commands")
    parser.add_argument("--seed", type=int, default=1)
    given = parser.parse_args()
    generator, faults, total = random.Random(given.seed), 0, dict.fromkeys(SORTS, 0)
    with tempfile.TemporaryDirectory(prefix="kills-") as root, Campaign(
        given.command.resolve(), given.python.resolve(), given.library.resolve(), Path(root)
    ) as campaign:
        for subject in SUBJECTS:
            if given.only and subject.name not in given.only:
                continue
            campaign.of(subject, given.most, given.most if given.instants is None else given.instants, generator)
            told(f"{subject.name}, {subject.calls} calls", subject.counts, len(subject.faults))
            for fault in subject.faults:
                print(f"  {fault}", flush=True)
            faults += len(subject.faults)
            for sort, number in subject.counts.items():
                total[sort] += number
    told("all", total, faults)
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
