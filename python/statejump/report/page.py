# SPDX-License-Identifier: GPL-3.0-or-later
"""Combines documents, script and style into one self-contained HTML file."""
from __future__ import annotations

import json
import math
from collections.abc import Iterator, Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import Any

from jinja2 import ChoiceLoader, Environment, FileSystemLoader, StrictUndefined
from markupsafe import Markup

from statejump._version import __version__
from statejump.core import units
from statejump.core.errors import NotWritten, StatejumpError, Unreadable
from statejump.core.output import write_atomically
from statejump.report import labels
from statejump.report.campaign import CampaignDocument
from statejump.report.document import Document
from statejump.report.unsolved import UnsolvedDocument

HERE = Path(__file__).resolve().parent
SCRIPT, STYLE, NOTICES = "page.js", "page.css", "notices.txt"


def _asset(name: str) -> str:
    path = HERE / name
    try:
        return path.read_text(encoding="utf-8")
    except OSError:
        raise StatejumpError(code="page_script_missing", script=path) from None


def embedded_json(data: Any) -> Markup:
    """Return data as JSON that is safe inside a script element, because no text in it can end the element."""
    dumped = json.dumps(data, ensure_ascii=True, allow_nan=False, separators=(",", ":"))
    return Markup(dumped.replace("&", "\\u0026").replace("<", "\\u003c").replace(">", "\\u003e"))


def _not_finite(data: Any, place: str = "") -> Iterator[str]:
    """Yield the paths of those numbers in the page's data that are infinite or NaN."""
    if isinstance(data, Mapping):
        for key, value in data.items():
            yield from _not_finite(value, f"{place}.{key}" if place else str(key))
    elif isinstance(data, (list, tuple)):
        for number, value in enumerate(data):
            yield from _not_finite(value, f"{place}[{number}]")
    elif isinstance(data, float) and not math.isfinite(data):
        yield place


def _payload(document: Document | CampaignDocument) -> dict[str, Any]:
    """Return the page's data of a document. :raises Unreadable: a number in the data is not finite"""
    data = document.payload()
    wrong = next(_not_finite(data), None)
    if wrong is not None:
        raise Unreadable(code="page_not_finite", case=document.title, entry=wrong)
    return data


def embedded_code(source: str, element: str) -> Markup:
    """Return a script or style that is safe in its HTML element. :raises ValueError: it would end the element"""
    if f"</{element}" in source.lower():
        raise ValueError(f"the {element} contains </{element}")
    return Markup(source)


@cache
def _environment(folders: tuple[Path, ...]) -> Environment:
    """Return the template environment of the page and of given folders, cached because templates compile slowly."""
    environment = Environment(
        loader=ChoiceLoader([FileSystemLoader(folder) for folder in (HERE, *folders)]),
        autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True,
    )
    environment.filters["quantity"] = units.text
    return environment


def render(documents: Sequence[Document | CampaignDocument | UnsolvedDocument]) -> str:
    """Return the page."""
    script, style, notices = _asset(SCRIPT), _asset(STYLE), _asset(NOTICES)
    parts = {
        document.part.template.parent
        for document in documents if isinstance(document, Document) and document.part is not None
    }
    return _environment(tuple(sorted(parts))).get_template("page.html").render(
        documents=documents,
        title=documents[0].title if len(documents) == 1 else f"{len(documents)} runs",
        version=__version__,
        models=labels.MODELS,
        sides=labels.SIDES,
        data=embedded_json({
            "runs": [_payload(document) for document in documents if isinstance(document, Document)],
            "campaigns": [_payload(document) for document in documents if isinstance(document, CampaignDocument)],
        }),
        script=embedded_code(script, "script"),
        style=embedded_code(style, "style"),
        notices=notices,
    )


def write(documents: Sequence[Document | CampaignDocument | UnsolvedDocument], path: Path) -> None:
    """Write the page; StatejumpError if it cannot be written."""
    text = render(documents)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise NotWritten(code="write_failed", file=path, cause=error.strerror or str(error)) from None
    with write_atomically(path) as stream:
        stream.write(text)
