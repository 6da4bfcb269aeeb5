# SPDX-License-Identifier: GPL-3.0-or-later
"""HDF5 files of this project: built in memory, written like any other file, and checked as a whole before the HDF5
library reads them, because the library would treat damaged bytes as lengths and addresses.

A file begins with a user block, ``HEAD_BYTES`` that HDF5 leaves to programs ("HDF5 File Format Specification", II.A):
lines of text with the version of this format and the SHA-256 of everything after the block. Any HDF5 reader opens the
file. The checksum finds damage, not malice, because anyone can compute it.
"""
from __future__ import annotations

import hashlib
import math
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import IO, TYPE_CHECKING, Any

import numpy as np

from statejump.core import libraries
from statejump.core.errors import Unreadable
from statejump.core.output import write_bytes
from statejump.core.reading import is_file

if TYPE_CHECKING:
    import h5py

HEAD_BYTES = 512
FORMAT = "statejump HDF5"
VERSION = 1
MOST_PACKED = 1100  # largest ratio of compression: deflate makes 258 bytes of two bits (RFC 1951), 1032 of a byte
SIGNATURE = b"\x89HDF\r\n\x1a\n"
AGAIN = "run what made it again"


def head(digest: str) -> bytes:
    """Return the user block for a file whose remaining bytes have this SHA-256."""
    lines = f"{FORMAT} {VERSION}\nsha256 {digest}\n"
    return lines.encode().ljust(HEAD_BYTES - 1) + b"\n"


@contextmanager
def made(path: Path) -> Iterator[h5py.File]:
    """Yield an HDF5 file in memory. At the end it is written to the given path, completely or not at all.

    Objects store neither times nor a creation order (which would add times for groups). The same contents therefore
    give the same bytes.

    :raises NotWritten: it cannot be written
    """
    h5py = libraries.h5py()

    with h5py.File(path.name, "w", driver="core", backing_store=False, libver=("earliest", "v110"),
                   track_order=False) as file:
        yield file
        file.flush()
        image = file.id.get_file_image()
    write_bytes(path, head(hashlib.sha256(image).hexdigest()) + image)


def is_ours(path: Path) -> bool:
    """Return whether a file begins like the files that :func:`made` writes, in any version of the format."""
    if not is_file(path):
        return False
    with path.open("rb") as stream:
        return stream.read(len(FORMAT)) == FORMAT.encode()


@contextmanager
def opened(path: Path) -> Iterator[h5py.File]:
    """Yield a file that :func:`made` wrote, for reading.

    :raises Unreadable: the file does not exist, is of another kind, has a newer version, or is damaged; or a requested
        part cannot be read
    """
    if not is_file(path):
        raise Unreadable(code="result_file_not_found", file=path)
    try:
        with path.open("rb") as stream:
            _check(stream, path)
            h5py = libraries.h5py()

            with h5py.File(stream, "r") as file:
                yield file
    except (OSError, RuntimeError, MemoryError) as error:
        raise Unreadable(code="read_failed", cause=" ".join(str(error).split()), file=path) from None


@contextmanager
def foreign(path: Path) -> Iterator[dict[str, h5py.Group | h5py.Dataset]]:
    """Yield the objects of an HDF5 file of another program by path; ``/`` is the file itself. See :func:`objects`.

    :raises Unreadable: the file is not HDF5, or a requested part cannot be read
    """
    h5py = libraries.h5py()

    try:
        if not h5py.is_hdf5(path):
            raise Unreadable(code="not_hdf5", file=path)
        with h5py.File(path, "r") as file:
            yield {"/": file, **objects(file, path)}
    except (OSError, RuntimeError, MemoryError) as error:
        raise Unreadable(code="read_failed", cause=" ".join(str(error).split()), file=path) from None


def _check(stream: IO[bytes], path: Path) -> None:
    """Raise Unreadable unless the checksum fits."""
    block = stream.read(HEAD_BYTES)
    if block.startswith(SIGNATURE):
        raise Unreadable(code="result_without_checksum", remedy=AGAIN, file=path)
    words = block[:-1].decode("ascii", "replace").split()
    if words[:2] != FORMAT.split():
        raise Unreadable(code="no_result_format", file=path, begin=FORMAT)
    if len(words) > 2 and words[2].isdecimal() and int(words[2]) > VERSION:
        raise Unreadable(code="result_newer", file=path, found=words[2], newest=VERSION)
    digest = hashlib.sha256()
    while more := stream.read(1 << 20):
        digest.update(more)
    if block != head(digest.hexdigest()):
        raise Unreadable(code="result_checksum", remedy=AGAIN, file=path)


def objects(file: h5py.File, path: Path) -> dict[str, h5py.Group | h5py.Dataset]:
    """Return the groups and data sets of a file by path, without the root ``/``. First check that reading them stays
    within the file and takes memory in proportion to its size.

    :raises Unreadable: an object is of another kind or has two paths, a link leads to another file, the numbers of a
        data set are in another file, or a data set declares more numbers than its bytes can hold
    """
    h5py = libraries.h5py()

    found: dict[str, Any] = {}
    seen = {h5py.h5o.get_info(file.id).addr}
    size = path.stat().st_size
    groups = [("", file)]
    unwritten = 0  # bytes of data sets that are not in the file
    while groups:
        parent, group = groups.pop()
        for name in group:
            place = f"{parent}/{name}"
            if not isinstance(group.get(name, getlink=True), h5py.HardLink):
                raise Unreadable(code="result_link", file=path, object=place)
            item = group[name]
            address = h5py.h5o.get_info(item.id).addr
            if address in seen or not isinstance(item, (h5py.Group, h5py.Dataset)):
                raise Unreadable(code="result_no_object", file=path, object=place)
            seen.add(address)
            if isinstance(item, h5py.Group):
                groups.append((place, item))
            else:
                unwritten += _check_stored(item, place, size - unwritten // MOST_PACKED, path)
            found[place] = item
    for place, item in {"/": file, **found}.items():
        _check_texts(item, place, path)
    return found


def _check_texts(item: h5py.Group | h5py.Dataset, place: str, path: Path) -> None:
    """Raise Unreadable if an object's name or attribute is not valid UTF-8, which the HTML report could not show."""
    texts = {place: place, **{f"{place}@{key}": value for key, value in item.attrs.items()}}
    for called, value in texts.items():
        try:
            for text in (called, *np.ravel(value).tolist()):
                str(text).encode()
        except UnicodeEncodeError:
            shown = called.encode("ascii", "backslashreplace").decode()
            raise Unreadable(code="result_not_utf8", file=path, object=shown) from None


def _check_stored(item: h5py.Dataset, place: str, size: int, path: Path) -> int:
    """Raise Unreadable if the numbers of a data set are in another file, or if it declares more numbers than its bytes
    can hold. Return how many bytes were never written; there, a valid data set has its fill value.

    :param size: number of bytes of the file, without the unwritten bytes of its data sets
    """
    h5py = libraries.h5py()

    made = item.id.get_create_plist()
    if made.get_external_count() or made.get_layout() == h5py.h5d.VIRTUAL:
        raise Unreadable(code="result_external", file=path, object=place)
    values = 0 if item.shape is None else math.prod(item.shape)
    declared = item.dtype.itemsize * max(values, math.prod(item.chunks) if item.chunks else 0)
    written = item.id.get_space_status() == h5py.h5d.SPACE_STATUS_ALLOCATED
    stored = min(size, item.id.get_storage_size())
    if declared > MOST_PACKED * (stored if written else size):
        raise Unreadable(code="result_claims_too_much", file=path, object=place)
    return 0 if written else int(declared)
