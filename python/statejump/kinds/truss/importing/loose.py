# SPDX-License-Identifier: GPL-3.0-or-later
"""Trusses without supports: models of sections, meshes, and free bodies. Users add supports after the import."""
from __future__ import annotations

from collections.abc import Callable
from typing import TypeVar

from statejump.kinds.truss.check_geometry import NoSupport
from statejump.kinds.truss.generate.document import Document

Made = TypeVar("Made")
REMEDY = "hold nodes with --fixed NODE=xyz, or with the key 'fixed' in the case, before it runs"


def checked(document: Document, parse: Callable[[Document], Made]) -> tuple[Made, str | None]:
    """Return the case of a document, and a hint if parts of the truss have no support.

    All other checks run with one node of each unsupported part held.

    :param parse: returns the case of a document
    :raises StatejumpError: another check fails
    """
    try:
        return parse(document), None
    except NoSupport as found:
        loose, hint = set(found.loose), f"{found}; {REMEDY}"
    axes = list("xyz"[:document["truss"]["dimension"]])
    nodes = [{**node, "fixed": axes} if node["name"] in loose else node for node in document["node"]]
    return parse({**document, "node": nodes}), hint
