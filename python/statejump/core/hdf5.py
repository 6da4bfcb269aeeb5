# SPDX-License-Identifier: GPL-3.0-or-later
"""HDF5 files as this project writes and reads them: built in memory, written like any other file, and checked as a
whole before the HDF5 library sees a byte of them, which takes damaged bytes for lengths and addresses.

A file begins with a user block, ``HEAD_BYTES`` that HDF5 leaves to programs ("HDF5 File Format Specification", II.A):
lines of text with the version of this format and the SHA-256 of everything after the block. Any HDF5 reader opens
the file. The checksum finds damage, not malice: whoever makes a file can make its checksum.
"""
from __future__ import annotations

import hashlib
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import IO, TYPE_CHECKING

from statejump.core.errors import Unreadable
from statejump.core.output import write_bytes

if TYPE_CHECKING:
    import h5py

HEAD_BYTES = 512
FORMAT = "statejump HDF5"
VERSION = 1
SIGNATURE = b"\x89HDF\r\n\x1a\n"
AGAIN = "run what made it again"


def head(digest: str) -> bytes:
    """Return the user block of a file whose other bytes have this SHA-256."""
    lines = f"{FORMAT} {VERSION}\nsha256 {digest}\n"
    return lines.encode().ljust(HEAD_BYTES - 1) + b"\n"


@contextmanager
def made(path: Path) -> Iterator[h5py.File]:
    """Yield an HDF5 file in memory that becomes the file of this name at the end, whole or not at all.

    No object keeps a time of its making and no order of creation (which would bring the times back for groups):
    the same contents give the same bytes.

    :raises NotWritten: it cannot be written
    """
    import h5py

    with h5py.File(path.name, "w", driver="core", backing_store=False, libver=("earliest", "v110"),
                   track_order=False) as file:
        yield file
        file.flush()
        image = file.id.get_file_image()
    write_bytes(path, head(hashlib.sha256(image).hexdigest()) + image)


def is_ours(path: Path) -> bool:
    """Whether a file begins like one that :func:`made` wrote, of whatever version."""
    if not path.is_file():
        return False
    with path.open("rb") as stream:
        return stream.read(len(FORMAT)) == FORMAT.encode()


@contextmanager
def opened(path: Path) -> Iterator[h5py.File]:
    """Yield a file that :func:`made` wrote, for reading.

    :raises Unreadable: there is none, it is not ours, of a newer version, cut off or altered; or what is asked of it
        inside of this cannot be read
    """
    if not path.is_file():
        raise Unreadable("no such result file", file=path)
    try:
        with path.open("rb") as stream:
            _check(stream, path)
            import h5py

            with h5py.File(stream, "r") as file:
                yield file
    except (OSError, RuntimeError) as error:
        raise Unreadable("cannot be read", cause=" ".join(str(error).split()), file=path) from None


def _check(stream: IO[bytes], path: Path) -> None:
    """Raise Unreadable unless the bytes are those that were written."""
    block = stream.read(HEAD_BYTES)
    if block.startswith(SIGNATURE):
        raise Unreadable("not a result file", cause="HDF5, but without the checksum that this version writes",
                         remedy=AGAIN, file=path)
    words = block[:-1].decode("ascii", "replace").split()
    if words[:2] != FORMAT.split():
        raise Unreadable("not a result file", cause=f"it does not begin with {FORMAT!r}", file=path)
    if len(words) > 2 and words[2].isdecimal() and int(words[2]) > VERSION:
        raise Unreadable(f"version {words[2]} is newer than {VERSION}, the newest that this statejump reads", file=path)
    digest = hashlib.sha256()
    while more := stream.read(1 << 20):
        digest.update(more)
    if block != head(digest.hexdigest()):
        raise Unreadable("damaged", cause="its checksum is that of other contents: it was cut off or altered",
                         remedy=AGAIN, file=path)
