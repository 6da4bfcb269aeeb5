# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks of items that several sections of a truss share: names, ends, axes, rotating links."""
from __future__ import annotations

import difflib
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from statejump.core.errors import MissingKey, NotAllowed
from statejump.kinds.truss.arrays import GROUND, SAME_DIRECTION, said
from statejump.kinds.truss.resolved import ResolvedTruss
from statejump.schema.item_tables import NONE, UNKNOWN, ItemColumns, ItemIndex
from statejump.schema.texts import BLOCK

MOST_LISTED = 5


def listed(names: list[str]) -> str:
    """Return the first names as a list in a sentence."""
    return ", ".join(repr(name) for name in names[:MOST_LISTED]) + (", ..." if len(names) > MOST_LISTED else "")


def known_name(key: str, value: Any, name: str, known: Mapping[str, Any], what: str, **where: Any) -> None:
    """Raise NotAllowed if a name is unknown. The remedy suggests the most similar known name."""
    if name in known:
        return
    nearest = difflib.get_close_matches(name, list(known), n=1, cutoff=0.5)
    where |= {"nodes": (name,) if what == "node" else (), "what_it_is": what, "name": name}
    if nearest:
        raise NotAllowed(key, value, code="misspelt_reference", meant=nearest[0], **where)
    if known:
        raise NotAllowed(key, value, code="undefined_reference", known=listed(list(known)), **where)
    raise NotAllowed(key, value, code="reference_without_section", **where)


def known_nodes(names: list[str], least: int, nodes: Mapping[str, Any], where: Mapping[str, Any]) -> None:
    """Raise NotAllowed unless ``nodes`` of an item names two different nodes, or one node if ``least`` is 1."""
    if not least <= len(names) <= 2:
        many = "2 nodes" if least == 2 else "1 node, on ground, or 2 nodes"
        raise NotAllowed("nodes", names, code="wrong_number_of_nodes", wanted=many, **where)
    for name in names:
        if name not in nodes:
            known_name("nodes", names, name, nodes, "node", **where)
    if len(names) == 2 and names[0] == names[1]:
        raise NotAllowed("nodes", names, code="equal_nodes", **where)


def known_links(names: list[str], links: Mapping[str, Any], where: Mapping[str, Any]) -> None:
    """Raise NotAllowed unless ``links`` of an item names one link or two different links."""
    if not 1 <= len(names) <= 2:
        raise NotAllowed("links", names, code="wrong_number_of_links", **where)
    for name in names:
        known_name("links", names, name, links, "link", **where)
    if len(names) == 2 and names[0] == names[1]:
        raise NotAllowed("links", names, code="equal_links", **where)


@dataclass(frozen=True)
class Around:
    """Arrays for the checks of joints in columns."""

    nodes: ItemIndex
    links: ItemIndex
    turns: np.ndarray  # (nodes,) bool: it determines the rotation of its part: it has a support, or beams rotate it
    link_nodes: np.ndarray  # (links, k) indices of the nodes of each link


def wrong_ends(places: np.ndarray, least: int) -> np.ndarray:
    """Return which items (n,) do not name two different items, or one item if ``least`` is 1.

    :param places: indices of the named items (n, k), as :class:`~statejump.schema.item_tables.ItemIndex` returns them
    """
    count = (places != NONE).sum(axis=1)
    ends = np.sort(places, axis=1)[:, -2:]
    alike = (ends[:, 0] == ends[:, -1]) & (count == 2)
    return np.asarray((count < least) | (count > 2) | (places == UNKNOWN).any(axis=1) | alike)


def wrong_vectors(items: ItemColumns[Any], key: str, dimension: int, direction: bool) -> np.ndarray:
    """Return the items (n,) for which :func:`vector` raises an error."""
    given = items.numbers(key)
    if given.ndim == 1:
        return ~np.isnan(given)
    there = ~np.isnan(given).all(axis=1)
    return there if given.shape[1] != dimension else np.asarray(there & ~given.any(axis=1) & direction)


def wrong_axes(items: ItemColumns[Any], dimension: int) -> np.ndarray:
    """Return the items (n,) for which :func:`axis_of_rotation` raises an error."""
    there = said(items, "axis")
    return there if dimension == 2 else ~there | wrong_vectors(items, "axis", dimension, True)


def vector(key: str, value: list[float] | None, unit: str, dimension: int, direction: bool, **where: Any) -> None:
    """Raise NotAllowed if the length of a vector is not the dimension of the truss, or if a direction is zero."""
    if value is None:
        return
    if len(value) != dimension:
        raise NotAllowed(key, value, code="wrong_dimension", dimension=dimension, unit=unit, **where)
    if direction and not any(value):
        raise NotAllowed(key, value, code="zero_vector", **where)


def axis_of_rotation(axis: list[float] | None, dimension: int, where: Mapping[str, Any]) -> None:
    """Raise an error unless the item has an axis of rotation in a spatial truss, and none in a planar truss."""
    if dimension == 2 and axis is not None:
        raise NotAllowed("axis", axis, code="planar_axis", **where)
    if dimension == 3 and axis is None:
        raise MissingKey("axis", code="axis_missing", **where)
    vector("axis", axis, "-", dimension, True, **where)


def turned_links(truss: ResolvedTruss, section: str, items: Any) -> None:
    """Raise NotAllowed unless the two links between which an item acts meet at a position and form an angle.

    :param items: arrays of the items, with names, links (k, 2) and axis (k, 3)
    """
    joined = np.unique(_pair_codes(truss, *truss.joined().T))
    for start in range(0, len(items.links), BLOCK):
        _turned_links(truss, section, items, slice(start, start + BLOCK), joined)


def _turned_links(truss: ResolvedTruss, section: str, items: Any, rows: slice, joined: np.ndarray) -> None:
    """Apply :func:`turned_links` to some rows. ``joined`` has the codes of all pairs of nodes that joints couple."""
    links, pairs, axes = truss.links, items.links[rows], items.axis[rows]
    turned = pairs != GROUND
    ends = links.nodes[pairs]  # (k, 2 links, 2 ends)
    ones, others = ends[:, 0, :, None], ends[:, 1, None, :]
    codes = _pair_codes(truss, ones, others)
    meet = ones == others
    if len(joined):
        meet |= joined[np.minimum(np.searchsorted(joined, codes), len(joined) - 1)] == codes
    apart = turned.all(axis=1) & ~meet.any(axis=(1, 2))
    along = np.zeros_like(turned)
    if truss.dimension == 3:
        spans = np.diff(truss.nodes.position_m[ends], axis=2)[:, :, 0]
        sines = np.linalg.norm(np.cross(spans, axes[:, None]), axis=2) / np.linalg.norm(spans, axis=2)
        along = turned & (sines < SAME_DIRECTION)
    wrong = apart | along.any(axis=1)
    if not wrong.any():
        return
    index = int(np.argmax(wrong))
    where = f"{section} {items.names[rows][index]!r}"
    if apart[index]:
        raise NotAllowed("links", [links.names[link] for link in pairs[index]], code="links_not_adjacent", item=where)
    raise NotAllowed("axis", axes[index].tolist(), code="axis_along_link", item=where,
                     link=links.names[pairs[index, int(np.argmax(along[index]))]])


def _pair_codes(truss: ResolvedTruss, ones: np.ndarray, others: np.ndarray) -> np.ndarray:
    """Return a code for every pair of nodes, the same for both orders of the nodes."""
    return np.minimum(ones, others, dtype=np.int64) * len(truss.nodes.names) + np.maximum(ones, others)
