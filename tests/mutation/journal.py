# SPDX-License-Identifier: GPL-3.0-or-later
"""What a campaign of mutants found before."""
from __future__ import annotations

import hashlib
import json
from pathlib import Path

from operators import Mutant


class Journal:
    """What was found before, a line each."""

    def __init__(self, path: Path | None) -> None:
        self.path = path
        self.known: dict[str, str] = {}
        if path is not None and path.exists():
            for line in path.read_text(encoding="utf-8").splitlines():
                entry = json.loads(line)
                self.known[entry["key"]] = entry["outcome"]

    @staticmethod
    def key(mutant: Mutant, text: str) -> str:
        """Return the key of a mutant of a text."""
        digest = hashlib.sha256(text.encode()).hexdigest()[:16]
        return f"{mutant.file} {digest} {mutant.start} {mutant.end} {mutant.replacement}"

    def add(self, key: str, outcome: str, **more: object) -> None:
        """Keep what became of a mutant."""
        self.known[key] = outcome
        if self.path is not None:
            with self.path.open("a", encoding="utf-8") as out:
                out.write(json.dumps({"key": key, "outcome": outcome, **more}, ensure_ascii=False) + "\n")
