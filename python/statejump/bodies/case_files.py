# SPDX-License-Identifier: GPL-3.0-or-later
"""Condensed bodies of cases: loading a case replaces the name of a file by its content, as for temperatures. Result
files and samples of a campaign therefore need none of the files."""
from __future__ import annotations

import base64
import binascii
import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from statejump.bodies.body import CondensedBody
from statejump.bodies.files import read_body, write_body
from statejump.core.errors import NotAllowed, StatejumpError

SECTION, FILE, CONTENT, BYTES = "body", "body_file", "content", "hdf5_base64"
_NAME = "body.h5"


def to_json(body: CondensedBody) -> dict[str, Any]:
    """Return a body as a value of JSON: the bytes of its file."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, _NAME)
        write_body(path, body)
        return {BYTES: base64.b64encode(path.read_bytes()).decode("ascii")}


def from_json(given: Mapping[str, Any]) -> CondensedBody:
    """Return the body of a value of JSON. :raises StatejumpError: it contains no body"""
    try:
        content = base64.b64decode(given[BYTES], validate=True)
    except (KeyError, TypeError, binascii.Error):
        raise NotAllowed(f"{SECTION}.{CONTENT}", code="not_from_file") from None
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, _NAME)
        path.write_bytes(content)
        return read_body(path)


def with_bodies(data: Mapping[str, Any], folder: Path | None) -> Mapping[str, Any]:
    """Return a parsed case file in which the contents of bodies replace the names of their files. Without bodies,
    return the document itself. The checks of the case find other faults.

    :param folder: folder to which relative paths refer; None: files are not read
    :raises StatejumpError: a file cannot be read or is invalid: one sentence with its name
    """
    items = data.get(SECTION)
    if not isinstance(items, list):
        return data
    return {**data, SECTION: [_with_content(item, folder) for item in items]}


def _with_content(item: Any, folder: Path | None) -> Any:
    if not isinstance(item, Mapping):
        return item
    content, file = item.get(CONTENT), item.get(FILE)
    if isinstance(content, Mapping):
        return {**item, CONTENT: from_json(content)}
    if not isinstance(file, str) or folder is None or content is not None:
        return item
    try:
        found = read_body(folder / file)
    except StatejumpError as refused:
        refused.item = refused.item or f"body {item.get('name')!r}"
        raise
    return {**{key: value for key, value in item.items() if key != FILE}, CONTENT: found}


def save_bodies(items: list[Any], path: Path) -> list[Any]:
    """Write the bodies of a case beside its file; return its items with the names of the files.

    :raises NotWritten: a file cannot be written
    """
    made = []
    for item in items:
        content = item.get(CONTENT)
        if isinstance(content, CondensedBody):
            beside = path.with_name(f"{path.stem}_{item['name']}.h5")
            write_body(beside, content)
            item = {**{key: value for key, value in item.items() if key != CONTENT}, FILE: beside.name}
        made.append(item)
    return made
