# SPDX-License-Identifier: GPL-3.0-or-later
"""Random mutations of a file: bytes of any file, tokens and lines of a text, entries of a parsed document, objects of
an HDF5 file. All randomness comes from the given generator, so the same seed gives the same mutation."""
from __future__ import annotations

import json
import random
import re
from collections.abc import Callable, Iterator
from contextlib import suppress
from copy import deepcopy
from typing import Any

import h5py
import numpy as np

TOKEN = re.compile(rb"[-+]?\d[\w.+-]*|\"[^\"\n]*\"|'[^'\n]*'|\btrue\b|\bfalse\b|[A-Za-z_]\w*")
# Replacements of tokens in texts.
ODD_TOKENS = (
    b"nan", b"inf", b"-inf", b"-1", b"0", b"-0.0", b"1e308", b"1e-320", b"1e999", b"9223372036854775808",
    b"1" + b"0" * 400, b'""', b'"\\u0000"', b'"\\u001b[31m"', b'"../../x"', b'"<script>"', b"[]", b"[[]]", b"{}",
    b"true", b"1979-05-27", b"0x7f", b"1_0", b"'" + b"x" * 5000 + b"'", b"", b"[" * 3000, b"\xff\xfe", b"\x00", b"\r",
    b"\xe2\x80\xae",
)
ODD_VALUES: tuple[Any, ...] = (
    None, True, False, 0, -1, 1, 2**63, 10**400, 0.0, -0.0, 1e-320, 1e308, -1e308, float("nan"), float("inf"), "", "x",
    "\x00", "\x1b[31m", "../../x", "<script>", "é" * 300, [], [[]], [0], [1.0, float("nan")], {}, {"x": 1}, {1: 2},
    b"x", (1, 2), object(),
)
# A data set that is declared larger than this [bytes] is not read.
LARGEST_READ = 10**7
ODD_ARRAYS: tuple[Any, ...] = (
    np.float64(np.nan), np.float64(-1.0), np.int64(-1), np.int64(2**62), np.uint8(200), np.array([], float),
    np.zeros((0, 3)), np.zeros((3, 3, 3, 3)), np.full(7, np.nan), np.full(7, np.inf), np.arange(5),
    np.array([-1, 10**9]), np.bool_(True), np.zeros(4, complex), np.zeros(3, [("a", float), ("b", int)]),
    np.void(b"abc"), np.array([b"\xff\xfe", b"x"]), b"\xff", "x", "{", "[]", "null", '{"a": 1}', "\x00", "a\x1b[31m",
    h5py.Empty("f"), h5py.Empty("S3"), np.zeros(3, "V5"),
)


def spoiled_bytes(content: bytes, others: list[bytes], chance: random.Random) -> bytes:
    """Return the bytes of a file with one to six changes, independent of its format."""
    made = bytearray(content)
    for _ in range(chance.choice((1, 1, 1, 2, 3, 6))):
        at = chance.randrange(len(made) + 1)
        more = min(len(made), at + chance.choice((1, 2, 8, 64, 1024)))
        match chance.randrange(8):
            case 0 if at < len(made):
                made[at] ^= 1 << chance.randrange(8)
            case 1:
                made[at:more] = chance.randbytes(more - at)
            case 2:
                del made[at:more]
            case 3:
                made[at:at] = made[at:more] * chance.choice((1, 2, 50))
            case 4:
                other = chance.choice(others)
                begin = chance.randrange(len(other) + 1)
                made[at:more] = other[begin:begin + chance.choice((4, 64, 2048))]
            case 5:
                del made[at:]
            case 6:
                made[at:more] = chance.choice((b"\x00", b"\xff", b"\x7f")) * (more - at)
            case _:
                made[at:at] = chance.choice(ODD_TOKENS)
    return bytes(made)


def spoiled_text(content: bytes, others: list[bytes], chance: random.Random) -> bytes:
    """Return a text with one to four tokens or lines replaced, dropped, doubled or exchanged."""
    for _ in range(chance.choice((1, 1, 1, 2, 4))):
        lines = content.split(b"\n")
        place = chance.randrange(len(lines))
        match chance.randrange(6):
            case 0:
                del lines[place]
            case 1:
                lines.insert(chance.randrange(len(lines) + 1), lines[place])
            case 2:
                other = chance.randrange(len(lines))
                lines[place], lines[other] = lines[other], lines[place]
            case 3:
                lines[place] = chance.choice(chance.choice(others).split(b"\n"))
            case _:
                found = list(TOKEN.finditer(content))
                if found:
                    token = chance.choice(found)
                    new = chance.choice(ODD_TOKENS) if chance.random() < 0.7 else chance.choice(found)[0]
                    content = content[:token.start()] + new + content[token.end():]
                continue
        content = b"\n".join(lines)
    return content


def _places(node: Any) -> Iterator[tuple[Any, Any]]:
    for key, value in list(node.items() if isinstance(node, dict) else enumerate(node)):
        yield node, key
        if isinstance(value, (dict, list)):
            yield from _places(value)


def spoiled_document(document: dict[str, Any], chance: random.Random) -> dict[str, Any]:
    """Return a parsed document with one to three values replaced, dropped, doubled, renamed or moved."""
    made = deepcopy(document)
    for _ in range(chance.choice((1, 1, 2, 3))):
        places = list(_places(made))
        if not places:
            break
        node, key = chance.choice(places)
        match chance.randrange(6):
            case 0:
                del node[key]
            case 1 if isinstance(node, list):
                node += [deepcopy(node[key]) for _ in range(chance.choice((1, 1, 1000)))]
            case 2 if isinstance(node, dict):
                node[chance.choice((f"{key}x", str(key).upper(), "", "a.b", "\x00"))] = node.pop(key)
            case 3:
                other, there = chance.choice(places)
                node[key] = deepcopy(other[there])
            case 4 if isinstance(node[key], (int, float)) and not isinstance(node[key], bool):
                with suppress(OverflowError):
                    node[key] *= chance.choice((-1, 0, 1e-12, 1e-3, 0.5, 2, 10, 1e3, 1e12))
            case _:
                node[key] = deepcopy(chance.choice(ODD_VALUES))  # a copy, because a later change may modify it
    return made


def spoil_hdf5(file: h5py.File, chance: random.Random) -> None:
    """Change one to three objects or attributes of an HDF5 file that is open for writing."""
    for _ in range(chance.choice((1, 1, 2, 3))):
        names: list[str] = []
        file.visit(names.append)
        name = chance.choice(names) if names else "/"
        # h5py cannot write some values, and some objects have none
        with suppress(ValueError, TypeError, KeyError, RuntimeError, OSError, MemoryError, AttributeError):
            chance.choice(HDF5_CHANGES)(file, name, file[name], chance)


def _drop(file: h5py.File, name: str, found: Any, chance: random.Random) -> None:
    if name in file:
        del file[name]


def _attribute(file: h5py.File, name: str, found: Any, chance: random.Random) -> None:
    holder = found if found.attrs else file
    if not holder.attrs:
        return
    key = chance.choice(sorted(holder.attrs))
    del holder.attrs[key]
    if chance.random() < 0.7:
        holder.attrs[chance.choice((key, key, "unknown"))] = chance.choice(ODD_ARRAYS)


def _replace(file: h5py.File, name: str, found: Any, chance: random.Random) -> None:
    kept = dict(found.attrs)
    del file[name]
    file[name] = chance.choice(ODD_ARRAYS)
    for key, value in kept.items():
        if chance.random() < 0.9:
            file[name].attrs[key] = value


def _reshape(file: h5py.File, name: str, found: Any, chance: random.Random) -> None:
    """Change the length, shape or type of a data set."""
    if not isinstance(found, h5py.Dataset) or found.shape is None or found.size > LARGEST_READ:
        return
    values, kept = found[()], dict(found.attrs)
    if not isinstance(values, np.ndarray) or not values.size:
        values = np.array([values])
    match chance.randrange(4):
        case 0:
            values = values[: max(0, len(values) - chance.choice((1, 2, len(values))))]
        case 1:
            values = np.concatenate([values, values])
        case 2:
            values = values.reshape(chance.choice(((1, -1), (-1, 1), (-1,))))
        case _:
            if values.dtype.kind in "iufb":
                with np.errstate(invalid="ignore", over="ignore"):
                    values = values.astype(chance.choice((np.int8, np.float32, bool, complex, "S8")))
    del file[name]
    file[name] = values
    file[name].attrs.update(kept)


def _value(file: h5py.File, name: str, found: Any, chance: random.Random) -> None:
    """One number of many."""
    if isinstance(found, h5py.Dataset) and found.shape and 0 < found.size <= LARGEST_READ and found.dtype.kind in "iuf":
        values, kept = found[()], dict(found.attrs)
        odd = chance.choice((0, -1, 1, 10**9, np.nan, np.inf, 1e308, 1e-320))
        if values.dtype.kind != "f":
            odd = chance.choice((0, 1, 100, np.iinfo(values.dtype).max, np.iinfo(values.dtype).min))
        values.flat[chance.randrange(values.size)] = odd
        del file[name]
        file[name] = values
        file[name].attrs.update(kept)


def _declared(file: h5py.File, name: str, found: Any, chance: random.Random) -> None:
    """Declare a data set much larger than the file."""
    kept = dict(found.attrs)
    del file[name]
    shape = chance.choice(((10**12,), (10**9,), (10**6, 10**6), (2**40, 3), (200_000_000,)))
    packed = {"compression": "gzip"} if chance.random() < 0.5 else {}
    file.create_dataset(name, shape, chance.choice(("f8", "i8", "S16", "u1")),
                        chunks=tuple(min(each, 64) for each in shape), **packed)
    file[name].attrs.update(kept)


def _link(file: h5py.File, name: str, found: Any, chance: random.Random) -> None:
    """Replace an HDF5 object by a link: to itself, a parent, nothing, another file, a device, a pipe."""
    del file[name]
    target = chance.choice(("itself", "above", "nothing", "file", "device", "raw"))
    if target == "raw":
        outside = chance.choice(("/etc/passwd", "/dev/zero", "/nowhere"))
        file.create_dataset(name, (64,), "u1", external=[(outside, 0, 64)])
    elif target in ("file", "device"):
        file[name] = h5py.ExternalLink("/dev/zero" if target == "device" else "/nowhere.h5", "/x")
    elif target == "above":
        file[name] = file[name.rpartition("/")[0] or "/"]  # a hard link: a circle
    else:
        file[name] = h5py.SoftLink("/" + name if target == "itself" else "/nothing")


def _json(file: h5py.File, name: str, found: Any, chance: random.Random) -> None:
    """Change an entry of a text that is JSON."""
    texts = [key for key in ("scene", "case/resolved") if key in file and isinstance(file[key], h5py.Dataset)]
    if texts:
        key = chance.choice(texts)
        document = spoiled_document(json.loads(file[key].asstr()[()]), chance)
        text = json.dumps(document, default=repr)
        del file[key]
        file.create_dataset(key, data=text, dtype=h5py.string_dtype())


HDF5_CHANGES: tuple[Callable[[h5py.File, str, Any, random.Random], None], ...] = (
    _drop, _attribute, _attribute, _replace, _reshape, _reshape, _value, _value, _declared, _link, _json, _json,
)
