"""The site's reference has every public name once, and every record that a function returns."""

from __future__ import annotations

import ast
import re
from pathlib import Path

import gbeam

ROOT = Path(__file__).parents[2]
PAGES = {path.stem: path.read_text(encoding="utf-8") for path in (ROOT / "docs" / "api").glob("*.md")}


def test_every_public_name_is_on_one_page() -> None:
    described = [
        name
        for page in PAGES.values()
        for name in re.findall(r"^\.\. auto(?:class|function|data):: (\w+)$", page, re.MULTILINE)
    ]
    assert sorted(described) == gbeam.__all__


def test_every_module_of_results_with_records_is_on_the_page_of_results() -> None:
    folder = Path(gbeam.__file__).parent / "results"
    with_records = {
        "gbeam.results." + ".".join(path.relative_to(folder).with_suffix("").parts)
        for path in folder.rglob("*.py")
        if any(isinstance(node, ast.ClassDef) for node in ast.parse(path.read_text(encoding="utf-8")).body)
    }
    listed = set(re.findall(r"^\.\. automodule:: ([\w.]+)$", PAGES["results"], re.MULTILINE))
    # The one record of comparisons is public; declarations, doors and what all parts have are no result.
    others = {
        "gbeam.results.comparison",
        "gbeam.results.declared",
        "gbeam.results.doors",
        "gbeam.results.facts",
        "gbeam.results.base",
    }
    assert listed | others == with_records
