#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Fuzz campaign: any mutated file is read, or refused with a message, in bounded time and memory.

    parsers.py --python build/python [--inputs N] [--only NAME ...] [--seed N] [--first N]

Shipped files, and results made from them, are mutated at random and read. The library reads cases, campaigns, journals,
temperatures and tables of nodes, links and joints; the command reads result files, FCLIB files, histories of `laws
--drive` and decks. A refusal must have exit status 2 and one printable line (or the documented status 1 of a command).
Faults are: any other exception, a warning of numpy, a signal, more than MEMORY_BYTES of additional memory, more than
CPU_S seconds. An input depends only on seed, reader and number; `--only NAME --first N --inputs 1` repeats it.

fuzz_mesh.cpp tests meshes. FCLIB files are HDF5 without a checksum; their bytes are not mutated, because this would
test the HDF5 library.
"""
from __future__ import annotations

import argparse
import contextlib
import hashlib
import io
import json
import mmap
import os
import random
import resource
import shutil
import signal
import sys
import tempfile
import tomllib
import traceback
import warnings
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import h5py
import numpy as np

import mutations

REPOSITORY = Path(__file__).resolve().parents[2]
MEMORY_BYTES = 1 << 30  # besides what is there before
CPU_S = 20.0
WALL_S = 300
STATUSES = (0, 1, 2)


class Fault(Exception):
    """What should not have happened."""


@dataclass(frozen=True)
class Reader:
    """A function under test that reads files.

    :param spoiled: makes a mutated input with the generator and writes it into the folder
    :param read: reads the input in the folder; returns whether it was accepted, raises StatejumpError if it was refused
    """

    name: str
    spoiled: Callable[[Path, random.Random], Any]
    read: Callable[[Path, Any], bool]


def command(*words: object) -> bool:
    """Run a command in this process; return whether its exit status is not 2. :raises Fault: invalid status or message
    """
    from statejump.cli import main

    said, errors = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(said), contextlib.redirect_stderr(errors):
        status = main.run([str(word) for word in words])
    sentence = errors.getvalue()
    if status not in STATUSES:
        raise Fault(f"status {status}: {sentence[-3000:]}")
    if status == 2 and not (sentence.startswith("error: ") and sentence.count("\n") == 1):
        raise Fault(f"status 2 without one sentence: {sentence[-3000:]!r}")
    if "\x1b" in sentence + said.getvalue():
        raise Fault("an escape sequence was told")
    return status != 2


def cases(folder: Path) -> Reader:
    """Reader of case files, as text and dict. The JSON of an accepted case must give the same case; every tenth is run.
    """
    from statejump import load
    from statejump.core.errors import StatejumpError
    from statejump.kinds.limits import history_of
    from statejump.kinds.loading import load_case, parse_case

    texts = [path.read_bytes() for path in sorted((REPOSITORY / "cases").rglob("*.toml"))
             if path.parent.name != "campaigns"]
    documents = [tomllib.loads(text.decode()) for text in texts]

    def spoiled(place: Path, chance: random.Random) -> Any:
        run = chance.random() < 0.1
        if chance.random() < 0.4:
            return mutations.spoiled_document(chance.choice(documents), chance), run
        change = mutations.spoiled_bytes if chance.random() < 0.3 else mutations.spoiled_text
        path = place / "case.toml"
        path.write_bytes(change(chance.choice(texts), texts, chance))
        return path, run

    def read(place: Path, given: Any) -> bool:
        source, run = given
        case = load_case(source)
        again = parse_case(json.loads(json.dumps(given_only(case.to_dict()))))
        if again.to_dict() != case.to_dict():
            raise Fault("the case is another one after a round through JSON")
        if run and case.behaviour.has_model("reduced") and history_of(case, "reduced").samples < 20_000:
            with contextlib.suppress(StatejumpError):  # refused in a sentence
                load(source).reduced()
        return True

    return Reader("case", spoiled, read)


def given_only(values: Any) -> Any:
    """Return a case as a dict without None and empty lists, which a case file cannot have."""
    if isinstance(values, dict):
        return {key: given_only(value) for key, value in values.items() if value is not None and value != []}
    return [given_only(value) for value in values] if isinstance(values, list) else values


def campaigns(folder: Path) -> Reader:
    """Campaign files."""
    from statejump.campaign.campaign_file import load_campaign

    texts = [path.read_bytes() for path in sorted((REPOSITORY / "cases/campaigns").glob("*.toml"))]

    def spoiled(place: Path, chance: random.Random) -> Any:
        change = mutations.spoiled_bytes if chance.random() < 0.3 else mutations.spoiled_text
        content = change(chance.choice(texts), texts, chance)
        path = place / "campaign.toml"
        path.write_bytes(content.replace(b'"../', b'"' + str(REPOSITORY / "cases").encode() + b"/"))
        return path, chance.choice(("montecarlo", "sweep"))

    def read(place: Path, given: Any) -> bool:
        load_campaign(*given)
        return True

    return Reader("campaign", spoiled, read)


def journals(folder: Path) -> Reader:
    """Reader of campaign journals: mutated bytes, and mutated lines with a valid checksum."""
    from statejump.campaign.campaign_file import load_campaign
    from statejump.campaign.journal import NAME, Journal, _line
    from statejump.campaign.work import run_samples

    plan = load_campaign(REPOSITORY / "cases/campaigns/table1_friction.toml", "sweep")
    with Journal(folder, plan, restart=True) as journal:
        for begin in range(0, 21, 7):
            journal.add(run_samples(plan.recipe, list(range(begin, begin + 7)))[1])
    content = (folder / NAME).read_bytes()
    values = np.concatenate([batch.values for batch in journal.batches])

    def spoiled(place: Path, chance: random.Random) -> Any:
        if chance.random() < 0.5:
            change = mutations.spoiled_bytes if chance.random() < 0.7 else mutations.spoiled_text
            (place / NAME).write_bytes(change(content, [content], chance))
            return True
        lines = [json.loads(line.partition(b" ")[2]) for line in content.splitlines()]
        spoiled_lines = mutations.spoiled_document({"lines": lines}, chance).get("lines")
        sealed = b""
        for line in spoiled_lines if isinstance(spoiled_lines, list) else []:
            with contextlib.suppress(TypeError, ValueError):  # what JSON does not hold
                sealed += _line(line)
        (place / NAME).write_bytes(sealed)
        return False

    def read(place: Path, torn: bool) -> bool:
        with Journal(place, plan, restart=False) as kept:
            for batch in kept.batches if torn else ():
                if not np.array_equal(batch.values, values[list(batch.indices)], equal_nan=True):
                    raise Fault("an altered value was believed")
        return True

    return Reader("journal", spoiled, read)


def results(folder: Path) -> Reader:
    """Reader of result files and campaign tables: mutated bytes, and mutated objects with a valid checksum."""
    from statejump import load
    from statejump.core.hdf5 import HEAD_BYTES, head

    made = {"slider": load(REPOSITORY / "cases/table1.toml"), "umbrella": load(REPOSITORY / "cases/umbrella.toml"),
            "truss": load(REPOSITORY / "cases/trusses/umbrella_rib.toml")}
    paths = []
    for name, case in made.items():
        command("reduced", case.definition.origin.file, "--results", folder, "--quiet")
        paths.append(folder / case.name / "reduced.h5")
    command("truss", "answers", REPOSITORY / "cases/trusses/umbrella_rib.toml", "--results", folder,
            "--no-sensitivity", "--quiet")
    command("sweep", REPOSITORY / "cases/campaigns/table1_friction.toml", "--results", folder, "--quiet")
    paths += [folder / "umbrella_rib/answers.h5", folder / "campaign_table1_friction/samples.h5"]
    contents = [path.read_bytes() for path in paths]

    def spoiled(place: Path, chance: random.Random) -> Any:
        content, path = chance.choice(contents), place / "given.h5"
        if chance.random() < 0.1:
            path.write_bytes(mutations.spoiled_bytes(content, contents, chance))
        else:
            with changed_hdf5(content[HEAD_BYTES:], chance) as image:
                path.write_bytes(head(hashlib.sha256(image.getvalue()).hexdigest()) + image.getvalue())
        return path, chance.choice(("info", "info", "report", "export", "compare"))

    def read(place: Path, given: Any) -> bool:
        path, what = given
        more = {"info": [], "report": ["-o", place / "page.html"], "compare": [path],
                "export": ["--to", place / "out", "--format", "csv"]}[what]
        return command(what, path, *more)

    return Reader("result", spoiled, read)


@contextlib.contextmanager
def changed_hdf5(image: bytes, chance: random.Random) -> Any:
    """Yield the bytes of an HDF5 file with some of its objects changed."""
    stream = io.BytesIO(image)
    with h5py.File(stream, "r+") as file:
        mutations.spoil_hdf5(file, chance)
    yield stream


def fclib_files(folder: Path) -> Reader:
    """Files of FCLIB, which have no checksum: mutated objects."""
    from statejump import fclib
    from statejump.core.hdf5 import HEAD_BYTES

    numbers = np.random.default_rng(7)
    images = []
    for dimension in (2, 3):
        h = numbers.normal(size=(dimension * 4, 3 * (dimension - 1)))
        problem = fclib.Problem(h @ h.T, h @ numbers.normal(size=h.shape[1]), np.full(4, 0.4), dimension, "pressed")
        fclib.write(folder / "made.hdf5", problem, fclib.solve(problem))
        images.append((folder / "made.hdf5").read_bytes()[HEAD_BYTES:])

    def spoiled(place: Path, chance: random.Random) -> Any:
        path = place / "given.hdf5"
        with changed_hdf5(chance.choice(images), chance) as image:
            path.write_bytes(image.getvalue())
        return path

    return Reader("fclib", spoiled, lambda place, path: command("fclib", "solve", path, "--most-sweeps", 50, "--quiet"))


def drives(folder: Path) -> Reader:
    """Histories of `laws --drive`."""
    from statejump.laws.drive import DRIVEN
    from statejump.laws.traits import catalogue

    seeds = [
        b"slide_m,penetration_depth_m\n0,1e-6\n5e-8,1e-6\n-5e-8,2e-6\n0,-1e-6\n0,1e-6\n",
        b"time_s,slide_x_m,slide_y_m,normal_force_N\n0,0,0,10\n1,1e-7,0,20\n2,1e-7,2e-7,0\n3,0,0,5\n",
        b"time_s,tangential_force_N,normal_force_N\n0,0,10\n1,1,10\n2,-2.5,10\n3,0,10\n",
    ]
    laws = [law.name for kind in DRIVEN for law in catalogue(kind)]

    def spoiled(place: Path, chance: random.Random) -> Any:
        path = place / "history.csv"
        change = mutations.spoiled_bytes if chance.random() < 0.3 else mutations.spoiled_text
        path.write_bytes(change(chance.choice(seeds), seeds, chance))
        return path, chance.choice(laws), chance.choice((1, 1, 7))

    def read(place: Path, given: Any) -> bool:
        path, law, steps = given
        return command(
            "laws", "--drive", path, "--law", law, "--effective-young-modulus", 38.5e9,
            "--effective-shear-modulus", 7.9e9, "--effective-radius", 0.01, "--friction-coefficient", 0.3,
            "--steps-per-row", steps, "--radial-clearance", 1e-4, "--contact-length", 0.01, "--restitution", 0.5,
            "--smallest-impact-speed", 1e-6, "--v0", 1e-4, "--v1", 1e-3, "-o", place / "out.csv", "--quiet",
        )

    return Reader("drive", spoiled, read)


def temperatures(folder: Path) -> Reader:
    """Temperature files of a case, as text and as HDF5."""
    from statejump import load

    seeds = [b"time_s,sun_K,shade_K\n0,0,0\n1.5,10,-3\n4,100,7.5\n9,0,0\n",
             b"time_s,sun_degC,shade_degC\n100,20,20\n101,25,19.5\n120,20,20\n"]
    with h5py.File(folder / "seed.h5", "w") as file:
        file["time_s"], file["temperature_K"] = [0.0, 1.0, 4.0], [[293.15] * 10, [300.0] * 10, [293.15] * 10]
        file["members"] = [f"L{number}" for number in range(1, 11)]
    image = (folder / "seed.h5").read_bytes()
    slider = tomllib.loads((REPOSITORY / "cases/table1.toml").read_text())
    truss = tomllib.loads((REPOSITORY / "cases/trusses/chain_10.toml").read_text())

    def spoiled(place: Path, chance: random.Random) -> Any:
        thermal = {"shape": "table"} | ({"reference_temperature_K": 293.15} if chance.random() < 0.7 else {}) | (
            {"lead_in_s": 5.0} if chance.random() < 0.5 else {})
        if chance.random() < 0.4:
            with changed_hdf5(image, chance) as changed:
                (place / "given.h5").write_bytes(changed.getvalue())
            return truss | {"thermal": thermal | {"members_file": str(place / "given.h5")}}
        change = mutations.spoiled_bytes if chance.random() < 0.3 else mutations.spoiled_text
        (place / "given.csv").write_bytes(change(chance.choice(seeds), seeds, chance))
        return slider | {"thermal": thermal | {"table_file": str(place / "given.csv"), "table_column": "sun"}}

    return Reader("temperatures", spoiled, lambda place, data: load(data).reduced().complete)


def tables(folder: Path) -> Reader:
    """Reader of tables of nodes, links and joints, as text and HDF5. The JSON of an accepted case must give the same
    case."""
    from statejump.core.item_files import write_items
    from statejump.kinds.loading import load_case, parse_case
    from statejump.kinds.truss import generate

    truss = generate.umbrella(3, cable_preload_N=1.0)
    sections = [section for section, part in truss.items() if isinstance(part, list)]
    for section in sections:
        write_items(truss[section], folder / f"{section}.csv")
    seeds = {section: (folder / f"{section}.csv").read_bytes() for section in sections}
    with h5py.File(folder / "seed.h5", "w") as file:
        for key in ("name", "nodes", "stiffness_N_per_m", "preload_N", "cable"):
            file[key] = [item[key] for item in truss["spring"]]
    image = (folder / "seed.h5").read_bytes()

    def spoiled(place: Path, chance: random.Random) -> Any:
        if chance.random() < 0.4:
            section, path = "spring", place / "given.h5"
            with changed_hdf5(image, chance) as changed:
                path.write_bytes(changed.getvalue())
        else:
            section, path = chance.choice(sections), place / "given.csv"
            change = mutations.spoiled_bytes if chance.random() < 0.3 else mutations.spoiled_text
            path.write_bytes(change(seeds[section], list(seeds.values()), chance))
        return {name: part for name, part in truss.items() if name != section} | {"tables": {section: str(path)}}

    def read(place: Path, given: Any) -> bool:
        case = load_case(given)
        if parse_case(json.loads(json.dumps(given_only(case.to_dict())))).to_dict() != case.to_dict():
            raise Fault("the case is another one after a round through JSON")
        return True

    return Reader("table", spoiled, read)


def decks(folder: Path) -> Reader:
    """Trusses of other programs: `truss import`."""
    seeds = {path.name: path.read_bytes() for path in sorted((REPOSITORY / "tests/fuzz/decks").iterdir())}

    def spoiled(place: Path, chance: random.Random) -> Any:
        name = chance.choice(sorted(seeds))
        change = mutations.spoiled_bytes if chance.random() < 0.3 else mutations.spoiled_text
        path = place / f"given{Path(name).suffix}"
        path.write_bytes(change(seeds[name], list(seeds.values()), chance))
        return path

    def read(place: Path, path: Path) -> bool:
        bars = ["--bars", path] if path.suffix == ".csv" else []
        return command("truss", "import", path, *bars, "-o", place / "made.toml", "--density", 2700,
                       "--temperature-change", 100, "--quiet")

    return Reader("deck", spoiled, read)


READERS = (cases, campaigns, journals, results, fclib_files, drives, temperatures, tables, decks)


class Counts:
    """Counters in memory shared by several processes: input number, accepted inputs, refused inputs, faults."""

    def __init__(self) -> None:
        self._shared = np.frombuffer(mmap.mmap(-1, 64), dtype=np.int64)
        self._shared[:] = 0

    def __getitem__(self, name: str) -> int:
        return int(self._shared[("at", "taken", "refused", "faults").index(name)])

    def __setitem__(self, name: str, value: int) -> None:
        self._shared[("at", "taken", "refused", "faults").index(name)] = value


def _used_bytes() -> int:
    return int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()


def one(reader: Reader, folder: Path, seed: int, number: int, counts: Counts) -> None:
    """Give the reader one input and count the outcome."""
    from statejump.core.errors import StatejumpError

    place = folder / "given"
    shutil.rmtree(place, ignore_errors=True)
    place.mkdir()
    chance = random.Random(f"{seed}:{reader.name}:{number}")
    given = reader.spoiled(place, chance)
    # The memory limit does not apply to the mutation itself, because HDF5 may crash when memory ends.
    unlimited = resource.getrlimit(resource.RLIMIT_AS)
    resource.setrlimit(resource.RLIMIT_AS, (_used_bytes() + MEMORY_BYTES, unlimited[1]))
    signal.setitimer(signal.ITIMER_PROF, CPU_S)
    signal.alarm(WALL_S)
    try:
        counts["taken" if reader.read(place, given) else "refused"] += 1
    except StatejumpError as refused:
        sentence = str(refused)
        if refused.exit_status != 2 or "\n" in sentence or not sentence:
            raise Fault(f"no sentence: {sentence!r}") from None
        json.dumps(refused.fields(), allow_nan=False)
        counts["refused"] += 1
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0)
        signal.alarm(0)
        resource.setrlimit(resource.RLIMIT_AS, unlimited)


def _child(reader: Reader, folder: Path, seed: int, last: int, counts: Counts) -> None:
    """Take inputs until all are done."""
    while counts["at"] < last:
        number = counts["at"]
        try:
            one(reader, folder, seed, number, counts)
        except BaseException as fault:  # any of them is a find
            counts["faults"] += 1
            said = str(fault) if isinstance(fault, Fault) else "".join(traceback.format_exception(fault)[-4:])
            print(f"{reader.name} {number}: {type(fault).__name__}: {said}", flush=True)
        counts["at"] = number + 1


def campaign(reader: Reader, folder: Path, seed: int, first: int, inputs: int) -> Counts:
    """Give a reader its inputs, in processes that may crash."""
    counts = Counts()
    counts["at"] = first
    while counts["at"] < first + inputs:
        sys.stdout.flush()
        pid = os.fork()
        if pid == 0:
            status = 1
            try:
                _child(reader, folder, seed, first + inputs, counts)
                status = 0
            finally:
                sys.stdout.flush()
                os._exit(status)
        ended = os.waitstatus_to_exitcode(os.waitpid(pid, 0)[1])
        if ended:
            how = signal.Signals(-ended).name if ended < 0 else f"status {ended}"
            print(f"{reader.name} {counts['at']}: {how}", flush=True)
            counts["faults"] += 1
            counts["at"] += 1
    return counts


def main() -> int:
    """Run the campaign and print the faults; return 1 if there are any."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--python", type=Path, required=True, help="the built package")
    parser.add_argument("--inputs", type=int, default=10_000, help="for each reader")
    parser.add_argument("--only", nargs="*", help="names of readers")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--first", type=int, default=0, help="number of the first input")
    given = parser.parse_args()
    sys.path.insert(0, str(given.python.resolve()))
    os.environ["MPLBACKEND"] = "agg"
    warnings.simplefilter("error", RuntimeWarning)  # numpy's, which would stand beside the sentence
    faults = 0
    shared = "/dev/shm" if os.access("/dev/shm", os.W_OK) else None  # nothing of it need outlive the machine
    with tempfile.TemporaryDirectory(prefix="parsers-", dir=shared) as root:
        for make in READERS:
            folder = Path(root) / make.__name__
            folder.mkdir()
            if given.only and make.__name__ not in given.only:
                continue
            counts = campaign(make(folder), folder, given.seed, given.first, given.inputs)
            print(f"{make.__name__}: inputs {given.inputs}, taken {counts['taken']}, refused {counts['refused']}, "
                  f"faults {counts['faults']}", flush=True)
            faults += counts["faults"]
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
