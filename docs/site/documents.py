# SPDX-License-Identifier: GPL-3.0-or-later
"""Copies the Markdown documents of the repository as pages of the site. Folders are the same, so links stay valid.

A link to a file that is not a page becomes a download. docs/index.md defines the sidebar: each section is a part of it,
with the pages that the section links to, in their order. A page ``index.md`` in another folder is a chapter: its part
of the sidebar has the pages of its folder.
"""
from __future__ import annotations

import re
import shutil
from pathlib import Path
from typing import Iterator

LINK = re.compile(r"(!?)\[((?:[^][]|!\[[^]]*\]\([^)]*\))*)\]\(([^)\s]+)\)")
FENCE = re.compile(r"^(```|~~~).*?^\1\s*?$", re.MULTILINE | re.DOTALL)
START = Path("docs/index.md")


def documents(repository: Path) -> list[Path]:
    """Return the paths of the documents in the repository. The README is not a page of the site."""
    found = [Path(name) for name in ("CHANGELOG.md", "CONTRIBUTING.md")]
    for folder in "docs", "results":
        found += sorted(path.relative_to(repository) for path in (repository / folder).rglob("*.md"))
    return found


def links(text: str) -> Iterator[str]:
    """Yield the targets of links and pictures, also of pictures inside links. Fenced code blocks are skipped."""
    for match in LINK.finditer(FENCE.sub("", text)):
        yield match[3]
        yield from links(match[2])


def local_target(document: Path, target: str) -> Path | None:
    """Return the path in the repository of the file that a link targets; None: another site, or the same page."""
    if re.match(r"[a-z]+:|#", target):
        return None
    parts: list[str] = []
    for part in (document.parent / target.partition("#")[0]).parts:
        if part == "..":
            parts.pop()
        else:
            parts.append(part)
    return Path(*parts)


def stage(repository: Path, source: Path) -> list[str]:
    """Copy documents and their pictures into ``source``; return one sentence for each broken link."""
    pages = documents(repository)
    wrong = []
    for page in pages:
        text = (repository / page).read_text(encoding="utf-8")

        def linked(match: re.Match[str], page: Path = page) -> str:
            inner = LINK.sub(linked, match[2])
            target = local_target(page, match[3])
            if target is None:
                return f"{match[1]}[{inner}]({match[3]})"
            if not (repository / target).exists():
                wrong.append(f"{page}: {match[3]} does not exist")
            elif target == Path("README.md"):
                return f"[{inner}]({up(page)}{START})"
            elif target not in pages and (repository / target).is_dir():
                return inner
            elif target not in pages:
                (source / target).parent.mkdir(parents=True, exist_ok=True)
                shutil.copy(repository / target, source / target)
                if match[2].startswith("!"):  # a role has no pictures: they stand above it
                    return f"{inner}\n\n{{download}}`{target.name} <{match[3]}>`"
                if not match[1]:
                    return f"{{download}}`{inner.replace('`', '')} <{match[3]}>`"
            return f"{match[1]}[{inner}]({match[3]})"

        blocks: list[str] = []

        def kept(match: re.Match[str]) -> str:
            blocks.append(match[0])
            return f"\0{len(blocks) - 1}\0"

        text = LINK.sub(linked, FENCE.sub(kept, text))
        text = re.sub("\0(\\d+)\0", lambda match: blocks[int(match[1])], text)
        (source / page).parent.mkdir(parents=True, exist_ok=True)
        (source / page).write_text(text, encoding="utf-8")
    return wrong


def up(page: Path) -> str:
    """Return the way from a page to the root."""
    return "../" * len(page.parent.parts)


def chapters(text: str, page: Path, source: Path) -> list[str]:
    """Return the pages beside an index page, other than the start page, that it links to."""
    if page.name != START.name or page == START:
        return []
    found = (local_target(page, target) for target in links(text))
    beside = [f"/{target.with_suffix('')}" for target in found
              if target and target.suffix == ".md" and target.parent == page.parent and (source / target).exists()]
    return list(dict.fromkeys(beside))


def add_way(source: Path, generated: dict[str, list[tuple[str, str]]]) -> None:
    """Add tables of contents to the start page: the pages that its sections link to, then generated pages by section.

    :param generated: additional pages (title, page) by the heading of the section
    """
    text = (source / START).read_text(encoding="utf-8")
    listed: list[str] = []
    parts = re.split(r"^(## .*)\n", text, flags=re.MULTILINE)
    for place in range(1, len(parts), 2):
        heading, body = parts[place].removeprefix("## "), parts[place + 1]
        pages = []
        for target in links(body):
            found = local_target(START, target)
            if found and found.suffix == ".md" and (source / found).exists() and found != START:
                pages.append(f"/{found.with_suffix('')}")
        further = generated.pop(heading, [])
        parts[place + 1] = body.rstrip("\n") + "\n" + "".join(f"- [{title}](/{page}.rst)\n" for title, page in further)
        pages += [f"/{page}" for _, page in further]
        pages = [page for page in dict.fromkeys(pages) if page not in listed]
        listed += pages
        if pages:
            parts[place + 1] += f"\n```{{toctree}}\n:hidden:\n:caption: {heading}\n\n" + "\n".join(pages) + "\n```\n\n"
    if generated:
        raise SystemExit(f"{START} has no section {', '.join(generated)}")
    restored = parts[0] + "".join(f"{parts[k]}\n{parts[k + 1]}" for k in range(1, len(parts), 2))
    (source / START).write_text(restored, encoding="utf-8")
    for page in [Path(f"{one.lstrip('/')}.md") for one in listed]:
        inner = chapters((source / page).read_text(encoding="utf-8"), page, source) if (source / page).exists() else []
        if inner:
            with (source / page).open("a", encoding="utf-8") as file:
                file.write("\n```{toctree}\n:hidden:\n\n" + "\n".join(inner) + "\n```\n")
            listed += inner
    reached = {Path(page.lstrip("/")) for page in listed} | {START.with_suffix("")}
    lost = [str(page) for page in (path.relative_to(source) for path in source.rglob("*.md"))
            if page.with_suffix("") not in reached]
    if lost:
        raise SystemExit(f"{START} leads nowhere to {', '.join(sorted(lost))}")
