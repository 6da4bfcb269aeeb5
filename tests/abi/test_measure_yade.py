# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs scripts/measure_yade on the installed YADE: it recognises this YADE and reports every kind of change."""
from __future__ import annotations

import copy
import os
import subprocess
import sys
from pathlib import Path
from typing import Callable

import pytest

SCRIPTS = Path(__file__).resolve().parents[2] / "scripts"
sys.path.insert(0, str(SCRIPTS))

from yade_interface import binary, running, variants  # noqa: E402

FOLDER = Path(os.environ["STATEJUMP_YADE_LIBRARY_DIR"])
VARIANT = os.environ["STATEJUMP_YADE_VARIANT"]


@pytest.fixture(scope="module")
def reference() -> variants.Interface:
    """The variant of the installed YADE."""
    one, = (one for one in variants.known() if one.name == VARIANT)
    return one


@pytest.fixture(scope="module")
def measured(reference: variants.Interface) -> variants.Interface:
    """What is measured of the installed YADE."""
    libraries = binary.Libraries(FOLDER)
    found = running.measure(running.command_of(FOLDER), libraries)
    return variants.Interface(
        "measured",
        {name: libraries.allocated_size(name) for name in reference.sizes},
        found.members,
        {name: libraries.table(name) for name in reference.tables},
        {name: libraries.stored_names(name) for name in reference.stored},
        found.shown,
        running=True,
    )


def test_every_declared_member_is_found_without_help(measured: variants.Interface, reference: variants.Interface):
    assert reference.members
    assert set(reference.members) <= set(measured.members)
    assert variants.differences(measured, reference) == []


def member_moved(one: variants.Interface) -> None:
    one.members["State", "vel"] = (152, one.members["State", "vel"][1])


def member_retyped(one: variants.Interface) -> None:
    one.members["Scene", "iter"] = (one.members["Scene", "iter"][0], "int")


def hidden_member_moved(one: variants.Interface) -> None:
    one.members["Functor", "scene"] = (48, "yade::Scene*")


def member_gone(one: variants.Interface) -> None:
    del one.members["Body", "clumpId"]


def size_changed(one: variants.Interface) -> None:
    one.sizes["FrictPhys"] += 8


def entries_swapped(one: variants.Interface) -> None:
    table = one.tables["Engine"]
    table[14], table[15] = table[15], table[14]


def entry_added(one: variants.Interface) -> None:
    one.tables["Shape"].insert(14, "_ZN4yade5Shape5addedEv")


def stored_name_added(one: variants.Interface) -> None:
    one.stored["Bound"].append("added")


@pytest.mark.parametrize(("change", "says"), [
    (member_moved, ["State.vel: at 152"]),
    (member_retyped, ["Scene.iter: at 448, int"]),
    (hidden_member_moved, ["Functor.scene: at 48"]),
    (member_gone, ["Body.clumpId: not found"]),
    (size_changed, ["size of FrictPhys"]),
    (entries_swapped, ["table of Engine: another order"]),
    (entry_added, ["table of Shape: 29 entries", "table of Shape: new entry 14, _ZN4yade5Shape5addedEv"]),
    (stored_name_added, ["stored attributes of Bound: new added"]),
])
def test_a_change_is_listed_and_nothing_else(
    measured: variants.Interface, reference: variants.Interface, change: Callable[[variants.Interface], None],
    says: list[str],
):
    changed = copy.deepcopy(measured)
    change(changed)
    found = variants.differences(changed, reference)
    assert len(found) == len(says)
    for sentence, beginning in zip(found, says):
        assert sentence.startswith(beginning)


def test_a_changed_binary_is_found(tmp_path: Path, reference: variants.Interface):
    """The changed code allocates 8 more bytes for FrictPhys; the library is examined without being executed."""
    for library in FOLDER.glob("lib*.so"):
        (tmp_path / library.name).symlink_to(library)
    libraries = binary.Libraries(FOLDER)
    found = libraries.find("_ZN4yade15CreateFrictPhysEv")
    assert found
    library, symbol = found
    code = library.bytes_at(symbol.address, 96)
    place = library.data.index(code) + code.index(b"\xbf") + 1
    size = reference.sizes["FrictPhys"]
    changed = library.data[:place] + (size + 8).to_bytes(4, "little") + library.data[place + 4:]
    (tmp_path / library.path.name).unlink()
    (tmp_path / library.path.name).write_bytes(changed)
    done = subprocess.run([str(SCRIPTS / "measure_yade"), str(tmp_path)], capture_output=True, text=True, check=False)
    assert done.returncode == 1
    assert f"size of FrictPhys: {size + 8} bytes, {size} in" in done.stdout


def test_a_member_that_the_binary_has_elsewhere_is_found(tmp_path: Path):
    """In a YADE with known build identifiers, getter and setter of State.vel are shifted by 8 bytes."""
    folder = tmp_path / FOLDER.relative_to("/usr")
    folder.mkdir(parents=True)
    for file in FOLDER.iterdir():
        (folder / file.name).symlink_to(file)
    library = binary.Library(FOLDER / "libyade.so")
    symbol = library.by_name["_ZN4yade5State15pyRegisterClassEN5boost6python3api6objectE"]
    code = library.bytes_at(symbol.address, symbol.size)
    changed = code
    for load in (b"\xb9", b"\xba"):  # mov $144, %ecx and %edx
        assert code.count(load + (144).to_bytes(4, "little")) == 1
        changed = changed.replace(load + (144).to_bytes(4, "little"), load + (152).to_bytes(4, "little"))
    assert library.data.count(code) == 1
    (folder / "libyade.so").unlink()
    (folder / "libyade.so").write_bytes(library.data.replace(code, changed))
    command = f"env YADE_PREFIX={tmp_path} LD_LIBRARY_PATH={folder} yade"
    done = subprocess.run([str(SCRIPTS / "measure_yade"), str(folder), "--yade", command], capture_output=True,
                          text=True, check=False)
    assert done.returncode == 1, done.stderr
    listed = done.stdout.split("differences from it:\n")[1].splitlines()
    assert len(listed) == 1 and listed[0].startswith("  State.vel: at 152, ")


def test_the_command_names_the_variant(tmp_path: Path):
    done = subprocess.run([str(SCRIPTS / "measure_yade"), str(FOLDER), "--variant-only"], capture_output=True,
                          text=True, check=False, cwd=tmp_path)
    assert (done.returncode, done.stdout, done.stderr) == (0, f"{VARIANT}\n", "")
