# SPDX-License-Identifier: GPL-3.0-or-later
"""Page of a case that has not been solved: description, drawing, all inputs."""
from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from statejump.core.case import Case
from statejump.core.errors import NotAllowed
from statejump.core.figures import embedded, style
from statejump.kinds import has, require
from statejump.report import labels
from statejump.report.capabilities import CaseDrawing
from statejump.report.inputs import sections_of
from statejump.schema.fields import attached_to_json


class UnsolvedDocument:
    """A case for a page. The other arguments are those of :class:`~.document.Document`.

    :param case: a case of a kind for which a drawing exists
    :raises NotAllowed: the kind of the case cannot be drawn
    """

    template = "unsolved.html"
    kind = "unsolved"
    command_line = ""
    verdict = ("none", "Nothing is solved yet.")

    def __init__(self, case: Case, source: str, identifier: str) -> None:
        if not has(case, CaseDrawing):
            raise NotAllowed("case.kind", case.kind, code="page_only_of_truss", file=case.origin.file, source=source)
        self._case, self.source, self.identifier = case, source, identifier
        self.title, self.case_name, self.text = case.title, case.name, case.origin.text
        self.sentences = labels.described(case)

    def cards(self) -> list[dict[str, Any]]:
        """No number is known yet."""
        return []

    @property
    def picture(self) -> str:
        """The drawing as a data address."""
        with style():
            return embedded(require(self._case, CaseDrawing).draw(self._case))

    def inputs(self) -> list[tuple[str, list[tuple[str, str]]]]:
        """Return the sections of the case with all defaults, as pairs of key and value."""
        return sections_of(json.loads(json.dumps(self._case.with_defaults(), default=attached_to_json)))


def is_case(path: Path) -> bool:
    """Whether an argument is a case file."""
    return path.suffix.lower() == ".toml" and path.is_file()
