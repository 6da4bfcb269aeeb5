# SPDX-License-Identifier: GPL-3.0-or-later
"""Reading TOML files: what is wrong with one in a sentence, with its line."""
from __future__ import annotations

import re
import tomllib
from pathlib import Path
from typing import Any

from statejump.core.errors import StatejumpError


def read_toml(path: str | Path, what: str) -> tuple[str, dict[str, Any]]:
    """Return the text of a TOML file and what it holds.

    :param what: what the file is, for the message when it is not there: ``case`` or ``campaign``
    :raises StatejumpError: one sentence with the file and, if it is not TOML, the line
    """
    try:
        text = Path(path).read_bytes().decode("utf-8")
    except FileNotFoundError:
        raise StatejumpError(f"{path}: no such {what} file") from None
    except UnicodeDecodeError:
        raise StatejumpError(f"{path}: not TOML: the file is not UTF-8 text") from None
    except OSError as failure:
        raise StatejumpError(f"{path}: cannot be read: {failure.strerror}") from None
    try:
        return text, tomllib.loads(text)
    except tomllib.TOMLDecodeError as failure:
        match = re.fullmatch(r"(.*) \(at (?:line (\d+), column \d+|end of document)\)", str(failure))
        reason = match[1] if match else str(failure)
        line = match[2] if match and match[2] else str(len(text.splitlines()))
        raise StatejumpError(f"{path}: not TOML, line {line}: {reason}") from None
