"""The documents name tests and files that exist, and each other's sections."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
DOCUMENTS = sorted(ROOT.glob("*.md")) + sorted((ROOT / "docs").rglob("*.md"))
FOLDERS = ("src", "tests", "examples", "benchmarks", "validation")
SOURCES = sorted(path for folder in FOLDERS for path in (ROOT / folder).rglob("*.py"))


def headings(path: Path) -> set[str]:
    """Anchors of a document's headings, as GitHub makes them."""
    lines = re.findall(r"^#+ (.*)$", path.read_text(encoding="utf-8"), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", line.lower()).replace(" ", "-") for line in lines}


@pytest.mark.parametrize("document", DOCUMENTS, ids=lambda path: str(path.relative_to(ROOT)))
def test_named_tests_exist(document: Path) -> None:
    defined = {
        name
        for path in SOURCES
        if "tests" in path.parts
        for name in [path.stem, *re.findall(r"def (test_\w+)", path.read_text(encoding="utf-8"))]
    }
    named = set(re.findall(r"\btest_\w+", document.read_text(encoding="utf-8")))
    assert named <= defined


@pytest.mark.parametrize("document", DOCUMENTS, ids=lambda path: str(path.relative_to(ROOT)))
def test_links_lead_somewhere(document: Path) -> None:
    for target in re.findall(r"\]\(([^)\s]+)\)", document.read_text(encoding="utf-8")):
        if "://" in target:
            continue
        path, _, anchor = target.partition("#")
        file = (document.parent / path) if path else document
        assert file.exists(), target
        assert not anchor or anchor in headings(file), target


def test_cited_sections_of_the_theory_exist() -> None:
    """`docs/theory.md, section 8.2` or `(8.4)` in a comment."""
    theory = (ROOT / "docs" / "theory.md").read_text(encoding="utf-8")
    sections = set(re.findall(r"^#+ ([\d.]+) ", theory, re.MULTILINE))
    equations = set(re.findall(r"\\tag\{(\d+\.\d+)\}", theory))
    cited = 0
    for path in SOURCES:
        text = path.read_text(encoding="utf-8")
        for section, equation in re.findall(r"docs/theory\.md,?\s+(?:sections? ([\d.]*\d)|\((\d+\.\d+)\))", text):
            cited += 1
            assert section in sections or equation in equations, f"{path}: {section}{equation}"
    assert cited > 5
