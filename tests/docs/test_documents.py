# SPDX-License-Identifier: GPL-3.0-or-later
"""Documents of the repository: links, scripts in the README, committed results."""
from __future__ import annotations

import importlib
import re
import subprocess
import sys
from pathlib import Path

import pytest

REPOSITORY = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(REPOSITORY / "docs" / "site"))
import documents  # noqa: E402 - beside the documents

README = REPOSITORY / "README.md"
PAGES = [Path("README.md"), *documents.documents(REPOSITORY)]
TUTORIALS = sorted((REPOSITORY / "docs" / "tutorials").glob("*.md"))


def tracked(*arguments: str) -> list[str]:
    """Return the files tracked by git; skip the test outside of a git clone."""
    done = subprocess.run(["git", "ls-files", *arguments], cwd=REPOSITORY, capture_output=True, text=True)
    if done.returncode:
        pytest.skip("not a clone")
    return done.stdout.splitlines()


@pytest.mark.parametrize("page", PAGES, ids=str)
def test_links_lead_to_files_of_the_repository(page: Path) -> None:
    known = set(tracked())
    folders = {str(parent) for name in known for parent in Path(name).parents}
    for target in documents.links((REPOSITORY / page).read_text(encoding="utf-8")):
        found = documents.local_target(page, target)
        assert found is None or str(found) in known | folders, f"{page} links to {target}"


def test_the_first_page_leads_to_every_other() -> None:
    start = documents.START
    targets = documents.links((REPOSITORY / start).read_text(encoding="utf-8"))
    reached = {Path("README.md"), start, *(documents.local_target(start, target) for target in targets)}
    for page in [page for page in PAGES if page in reached and page != start]:
        inner = documents.chapters((REPOSITORY / page).read_text(encoding="utf-8"), page, REPOSITORY)
        reached |= {Path(f"{name.lstrip('/')}.md") for name in inner}
    assert [str(page) for page in PAGES if page not in reached] == []


def test_results_that_are_kept_are_shown() -> None:
    shown = {str(documents.local_target(page, target)) for page in PAGES
             for target in documents.links((REPOSITORY / page).read_text(encoding="utf-8"))}
    assert [name for name in tracked("results") if name not in shown] == []


def test_nothing_is_kept_that_is_ignored() -> None:
    assert tracked("--cached", "--ignored", "--exclude-standard") == []


# All pages except generated ones (reports, cards of decks, mistakes) and the changelog, which grows.
WRITTEN = [page for page in PAGES
           if page.parts[0] != "results" and page.name not in ("CHANGELOG.md", "decks.md", "mistakes.md")]


@pytest.mark.parametrize("page", WRITTEN, ids=str)
def test_pages_are_short(page: Path) -> None:
    most = 120 if page.name == "README.md" else 200
    assert len((REPOSITORY / page).read_text(encoding="utf-8").splitlines()) <= most


def test_headings_that_links_name_exist() -> None:
    for page in PAGES:
        for target in documents.links((REPOSITORY / page).read_text(encoding="utf-8")):
            if "#" in target and not re.match("[a-z]+:", target):
                file = documents.local_target(page, target) or page
                text = (REPOSITORY / file).read_text(encoding="utf-8")
                anchors = {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-")
                           for heading in re.findall("^#+ (.*)$", text, re.MULTILINE)}
                assert target.partition("#")[2] in anchors, f"{page}: {target}"


@pytest.mark.parametrize("page", TUTORIALS, ids=lambda page: page.stem)
def test_notebook_is_that_of_its_page(page: Path) -> None:
    pytest.importorskip("nbformat", reason="the packages of the documents are not installed")
    notebooks = importlib.import_module("notebooks")
    made = notebooks.stored(notebooks.notebook(page.read_text(encoding="utf-8")))
    kept = notebooks.nbformat.read(page.with_suffix(".ipynb"), as_version=4)
    assert notebooks.stored(notebooks.without_outputs(kept)) == made, "run docs/site/notebooks.py"


def test_files_that_contributing_lists_exist() -> None:
    text = (REPOSITORY / "CONTRIBUTING.md").read_text(encoding="utf-8")
    for heading in "Adding a kind", "Adding a law", "Adding an element", "Adding a joint":
        section = text.split(f"## {heading}\n", 1)[1].split("\n## ", 1)[0]
        listed = [name for block in section.split("```\n")[1::2] for name in block.split()]
        assert listed
        # NAME stands for a new file, whose folder must exist.
        lost = [name for name in listed if not (REPOSITORY / name.partition("NAME")[0]).parent.exists()
                or "NAME" not in name and not (REPOSITORY / name).exists()]
        assert lost == [], heading
