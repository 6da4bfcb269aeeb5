# SPDX-License-Identifier: GPL-3.0-or-later
"""Reader and writer of TOML files. A faulty file causes an error of one sentence with the line."""
from __future__ import annotations

import re
import sys
import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import tomli_w

from statejump.core.errors import Unreadable, size

LARGEST_BYTES = 1 << 28  # ten times the size of a truss of 100 000 joints


def read_toml(path: str | Path, what: str) -> tuple[str, dict[str, Any]]:
    """Return the text of a TOML file and its parsed content.

    :param what: type of the file, for the message that it does not exist: ``case`` or ``campaign``
    :raises Unreadable: the file does not exist or is not TOML; one sentence with the file and the line
    """
    try:
        with Path(path).open("rb") as stream:
            content = stream.read(LARGEST_BYTES + 1)  # a device has no end
        if len(content) > LARGEST_BYTES:
            raise Unreadable(code="file_too_large", file=path, largest=size(LARGEST_BYTES))
        text = content.decode("utf-8-sig")  # editors of Windows write a byte order mark
    except FileNotFoundError:
        raise Unreadable(code="case_file_not_found", file=path, of=what) from None
    except UnicodeDecodeError:
        raise Unreadable(code="toml_not_utf8", file=path) from None
    except OSError as failure:
        raise Unreadable(code="read_failed", cause=failure.strerror, file=path) from None
    try:
        return text, tomllib.loads(text)
    except tomllib.TOMLDecodeError as failure:
        reason, line = _reason(failure, text)
        raise Unreadable(code="not_toml_at_line", cause=reason, file=path, line=line) from None
    except RecursionError:
        raise Unreadable(code="toml_too_deep", file=path) from None
    except ValueError as failure:  # Python refuses to convert the digits to a number
        raise Unreadable(code="not_toml", cause=" ".join(str(failure).split(";")[0].split()), file=path) from None


def _reason(failure: tomllib.TOMLDecodeError, text: str) -> tuple[str, int]:
    """Return the reason and the line in an error of the TOML parser. In Python 3.14 they are attributes of the error;
    before, they are the two halves of its message."""
    if sys.version_info >= (3, 14):
        return str(failure.msg), int(failure.lineno)
    reason, _, place = str(failure).rpartition(" (at ")
    words = place.replace(",", " ").split()
    last = len(text.splitlines())
    return reason or str(failure), int(words[1]) if words[:1] == ["line"] else last


def to_toml(made: Mapping[str, Any]) -> str:
    """Return a document as TOML, short lists on one line."""
    text = tomli_w.dumps(dict(made))
    # The writer puts every entry of a list on its own line; texts contain no line ends.
    return re.sub(r"\[\n((?:    [^\n]*,\n)+)\]", _on_one_line, text)


def _on_one_line(match: re.Match[str]) -> str:
    items = [line.strip().rstrip(",") for line in match[1].splitlines()]
    line = "[" + ", ".join(items) + "]"
    return line if len(line) <= 100 else match[0]
