# SPDX-License-Identifier: GPL-3.0-or-later
"""Documents as the text of TOML files."""
from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any

import tomli_w


def to_toml(made: Mapping[str, Any]) -> str:
    """Return a document as TOML, short lists on one line."""
    text = tomli_w.dumps(dict(made))
    # The writer puts every entry of a list on its own line; texts contain no line ends.
    return re.sub(r"\[\n((?:    [^\n]*,\n)+)\]", _on_one_line, text)


def _on_one_line(match: re.Match[str]) -> str:
    items = [line.strip().rstrip(",") for line in match[1].splitlines()]
    line = "[" + ", ".join(items) + "]"
    return line if len(line) <= 100 else match[0]
