# SPDX-License-Identifier: GPL-3.0-or-later
"""Result files in which any one part is missing, or is a number instead of a text or the other way round.

The checksum fits: such a file was made by another program, or on purpose. Whatever the commands need of it and is not
there is one sentence with status 2 that says where, and what they do not need is not missed.
"""
from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path

import h5py
import numpy as np
import pytest

from conftest import REPOSITORY, sealed
from failures import failure

from statejump.core.charts import straight_part

MADE = {  # file: the command that makes it
    "table1/reduced.h5": ("reduced", "table1.toml"),
    "umbrella/reduced.h5": ("reduced", "umbrella.toml"),
    "umbrella_rib/answers.h5": ("truss", "answers", "trusses/umbrella_rib.toml"),
    "umbrella_8/answers.h5": ("truss", "answers", "trusses/umbrella_8.toml"),
}
# Parts that the answers of one rib do not have. The others are spoiled there, with fewer joints.
MORE = ("answers/surface", "models/reduced/history/tension_N")
SAMPLES = 100  # parts do not depend on the number of samples, which is most of a report's time


def without(file: h5py.File, place: str) -> None:
    del file[place]


def retyped(file: h5py.File, place: str) -> None:
    """Texts instead of numbers of the same shape, numbers instead of texts."""
    found, kept = file[place], dict(file[place].attrs)
    is_text, shape = h5py.check_string_dtype(found.dtype) is not None, found.shape
    del file[place]
    if is_text:
        file[place] = np.full(shape, 3.5)
    else:
        file.create_dataset(place, data=np.full(shape, "x", dtype=object), dtype=h5py.string_dtype())
    file[place].attrs.update(kept)


def with_few_samples(case: Path, folder: Path) -> Path:
    """Write a shipped case whose output has few samples."""
    text = case.read_text()
    given = next((line for line in text.splitlines() if line.startswith("samples_per_cycle")), None)
    few = f"samples_per_cycle = {SAMPLES}"
    (folder / case.name).write_text(text.replace(given, few) if given else f"{text}\n[output]\n{few}\n")
    return folder / case.name


def spoiled(whole: Path, path: Path, only: tuple[str, ...]) -> Iterator[str]:
    """Write a file with every part spoiled in turn, or those that begin so, and say which."""
    content, places = whole.read_bytes(), list[str]()
    with h5py.File(whole) as file:
        file.visit(places.append)
        data = {place for place in places if isinstance(file[place], h5py.Dataset)}
    for place in places:
        if not place.startswith(only):
            continue
        for change in (without, retyped) if place in data else (without,):
            path.write_bytes(content)
            with h5py.File(path, "r+") as file:
                change(file, place)
            sealed(path)
            yield f"{change.__name__} {place}"


@pytest.mark.parametrize("name", MADE)
def test_whatever_part_is_missing_or_of_another_type(statejump: Callable, tmp_path: Path, name: str) -> None:
    *command, case = MADE[name]
    many = name.startswith("umbrella_8")
    path = with_few_samples(REPOSITORY / "cases" / case, tmp_path)
    assert statejump(*command, path, "--results", tmp_path, "--quiet", *(["--no-sensitivity"] if many else [])).status == 0
    whole, bad, seen = tmp_path / name, tmp_path / "bad.h5", set()
    for what in spoiled(whole, bad, MORE if many else ("",)):
        compare = [] if command[0] == "truss" else [["compare", bad, whole]]
        for asked in (["report", bad, "-o", "page.html"], *compare):
            done = statejump(*asked)
            assert done.status in (0, 1, 2), f"{what}: {asked[0]}: {done.errors}"
            if done.status == 2:
                assert done.errors.startswith((f"error: {bad}: ", "error: not comparable")), f"{what}: {done}"
                assert done.errors.count("\n") == 1, f"{what}: {done}"
                seen.add(what)
    assert len(seen) > (4 if many else 40)


def test_a_text_that_is_not_utf8(statejump: Callable, tmp_path: Path, cases: Path) -> None:
    """h5py hands such a byte on as half of a pair, with which no page can be written."""
    assert statejump("reduced", cases / "table1.toml", "--results", tmp_path, "--quiet").status == 0
    path = tmp_path / "table1" / "reduced.h5"
    with h5py.File(path, "r+") as file:
        file["provenance"].attrs.create("machine", b"\xff", dtype=h5py.string_dtype())
    sealed(path)
    done = statejump("report", path, "-o", "page.html")
    assert (done.status, done.failure) == (2, failure("result_not_utf8", file=path, object="/provenance@machine"))


def test_numbers_without_an_end(statejump: Callable, tmp_path: Path, cases: Path) -> None:
    """What is beyond any page is one sentence, nothing of numpy beside it; a straight line is not looked for in it."""
    assert statejump("sweep", cases / "campaigns" / "table1_friction.toml", "--results", tmp_path, "--quiet").status == 0
    path = next(tmp_path.glob("*/samples.h5"))
    with h5py.File(path, "r+") as file:
        for outcome in file["outcomes"].values():
            outcome[6] = 1e308
    sealed(path)
    done = statejump("report", path, "-o", "page.html")
    assert done.status == 2 and done.errors.startswith("error: ") and done.errors.count("\n") == 1, done
    assert statejump("reduced", cases / "table1.toml", "--results", tmp_path, "--quiet").status == 0
    path = tmp_path / "table1" / "reduced.h5"
    with h5py.File(path, "r+") as file:
        for energy in file["models/reduced/energy"].values():
            energy[3] = np.inf
    sealed(path)
    done = statejump("report", path, "-o", "page.html")
    assert done.errors.count("\n") == (done.status == 2), done
    assert straight_part(np.array([0.0, np.inf, 1.0]), np.array([0.0, 1.0, 2.0])) is None
    assert straight_part(np.array([0.0, 1e200, 1.0]), np.array([0.0, 1.0, 1e300])) is None
