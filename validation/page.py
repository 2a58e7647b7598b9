"""docs/validation.md, from what the modules found and the chapter of rows that tests assert."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable
from pathlib import Path

from validation import MODULES
from validation.record import Record, heading, kept
from validation.table import AGREES, DIFFERS, EXPLAINED, NOT_COMPARED, Row

ROOT = Path(__file__).parents[1]
VERDICTS = (AGREES, EXPLAINED, DIFFERS, NOT_COMPARED)
PAGE = ROOT / "docs" / "validation.md"
ASSERTED = Path(__file__).parent / "asserted.md"

HEAD = """# What was compared with what

Other codes' answers and published figures beside gbeam's. `make validate` makes the first chapters; each says which
version of the other code ran. A difference above what a row allows is kept, with its reason. The chapters after them
are asserted by tests. "Exact" means geometrically exact, without shear and torsion.
"""


def write() -> None:
    """Make the page from what is kept."""
    PAGE.write_text(page(), encoding="utf-8")


def page() -> str:
    """The page's text."""
    records = {name: kept(name) for name in MODULES}
    environments = list({str(r.environment): r.environment for r in records.values() if r}.values())
    parts = [HEAD, summary([record for record in records.values() if record])]
    for name, record in records.items():
        parts.append(chapter(record, environments) if record else absent(name))
    parts.append(ASSERTED.read_text(encoding="utf-8"))
    if environments:
        parts.append(
            "## Environments\n\n" + "\n".join(f"{i}. {words(e)}" for i, e in enumerate(environments, 1)) + "\n"
        )
    return "\n".join(parts)


def summary(records: list[Record]) -> str:
    """Count the rows of each chapter that agree."""
    lines = ["| chapter | agree | differ, reason given | differ, without | not compared |", "|---|---|---|---|---|"]
    for record in records:
        slug = re.sub(r"[^\w\- ]", "", record.title.lower()).replace(" ", "-")
        counts = Counter(row.verdict for row in record.rows)
        cells = [f"[{record.title}](#{slug})", *(str(counts[verdict]) for verdict in VERDICTS)]
        lines.append("| " + " | ".join(cells) + " |")
    return "\n".join(lines) + "\n"


def absent(name: str) -> str:
    """The chapter of a module that has not run."""
    title, needs = heading(name)
    return f"## {title}\n\nnot run: needs {', '.join(needs)}\n"


def chapter(record: Record, environments: list[dict[str, str]]) -> str:
    """Introduction, versions and table of one module."""
    codes = "".join(f"{name} {version}, " for name, version in record.versions.items())
    ran = f"`validation/{record.name.replace('.', '/')}.py`, {codes}{record.date}, {record.seconds:.0f} s"
    number = environments.index(record.environment) + 1
    return (
        f"## {record.title}\n\n{record.introduction}\n\n{ran}, [environment](#environments) {number}.\n\n"
        f"{table(record.rows)}"
    )


def table(rows: Iterable[Row]) -> str:
    """Markdown table; a case is named once, a source that all rows share stands above, empty remarks have no column."""
    rows = list(rows)
    sources = {row.source for row in rows}
    columns = ["case", "quantity", "reference", "gbeam", "difference", "allowed", "verdict"]
    each_source, any_remark = len(sources) > 1, any(row.remark for row in rows)
    columns += ["source"] * each_source + ["remark"] * any_remark
    lines = [] if each_source else [f"Reference: {next(iter(sources), '')}.\n"]
    lines += ["| " + " | ".join(columns) + " |", "|" + "---|" * len(columns)]
    case = ""
    for row in rows:
        unit = "" if row.unit in {"", "–"} else f", {row.unit}"
        zero = row.reference is not None and float(row.reference) == 0
        allowed = "–" if row.difference is None else f"{row.tolerance:g}" if zero else f"{100 * row.tolerance:.2g} %"
        cells = [
            "" if row.case == case else row.case,
            row.quantity + unit,
            *row.numbers(),
            row.deviation(),
            allowed,
            row.verdict,
        ]
        cells += [row.source] * each_source + [row.remark] * any_remark
        case = row.case
        lines.append("| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |")
    return "\n".join(lines) + "\n"


def words(environment: dict[str, str]) -> str:
    """An environment in one line."""
    return ", ".join(f"{name} {version}" if name != "platform" else version for name, version in environment.items())
