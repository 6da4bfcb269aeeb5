# SPDX-License-Identifier: GPL-3.0-or-later
"""The values of a case for the list on a page."""
from __future__ import annotations

from decimal import Decimal
from typing import Any


def sections_of(values: dict[str, Any]) -> list[tuple[str, list[tuple[str, str]]]]:
    """Return the sections of a case with all defaults, as pairs of key and value. Lists of items are summarised."""
    sections = []
    for section, keys in values.items():
        if isinstance(keys, list) and keys and all(isinstance(item, dict) for item in keys):
            sections.append((f"[{section}]", _summed_up(keys)))
            continue
        if not isinstance(keys, dict):
            if keys is None or keys == []:
                continue
            sections.append((section, [("", f"{len(keys)} entries" if isinstance(keys, list) else str(keys))]))
            continue
        rows = [(key, _shown(value)) for key, value in keys.items() if value is not None]
        if rows and section != "case":
            sections.append((section, rows))
    return sections


def _shown(value: Any) -> str:
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, list):
        return f"{len(value)} values" if len(value) > 8 else ", ".join(str(item) for item in value)
    return f"{value:g}" if isinstance(value, float) else str(value)


def _summed_up(items: list[dict[str, Any]]) -> list[tuple[str, str]]:
    """Summarise items of a list, such as nodes or links, in a few rows: their number and ranges of their values."""
    rows = [("", f"{len(items)} {'entry' if len(items) == 1 else 'entries'}")]
    for key in items[0]:
        values = [item[key] for item in items if item.get(key) is not None]
        if values and all(isinstance(value, (int, float)) and not isinstance(value, bool) for value in values):
            low, high = min(values), max(values)
            rows.append((key, _number(low) if low == high else f"{_number(low)} to {_number(high)}"))
    return rows


def _number(value: float) -> str:
    """Return a number as text with six digits. An integer may be larger than any float."""
    try:
        return f"{value:g}"
    except OverflowError:
        return f"{Decimal(value):.6g}"
