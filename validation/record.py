"""Record of what one module found: kept as JSON, so that the page can be made again after any one of them ran."""

from __future__ import annotations

import ast
import json
import time
from dataclasses import asdict, dataclass
from datetime import UTC, datetime
from importlib import import_module
from inspect import cleandoc
from pathlib import Path

from validation.environment import environment, need_version
from validation.table import DIFFERS, Row

RESULTS = Path(__file__).parent / "results"


@dataclass(frozen=True)
class Record:
    """A chapter of the page: rows, or none where a need is missing."""

    name: str
    title: str
    introduction: str
    needs: tuple[str, ...]
    date: str
    seconds: float
    versions: dict[str, str]
    environment: dict[str, str]
    rows: tuple[Row, ...]

    @property
    def unexplained(self) -> list[Row]:
        """Rows outside their tolerance for which no reason is given."""
        return [row for row in self.rows if row.verdict == DIFFERS]

    def save(self) -> None:
        """Write it to `results/`."""
        RESULTS.mkdir(exist_ok=True)
        text = json.dumps(asdict(self), indent=1, ensure_ascii=False, default=float)
        path_of(self.name).write_text(text + "\n", encoding="utf-8")


def path_of(name: str) -> Path:
    """File of a module's record."""
    return RESULTS / f"{name}.json"


def heading(name: str) -> tuple[str, tuple[str, ...]]:
    """TITLE and NEEDS of a module, read without importing it: what it needs may be missing."""
    source = Path(__file__).parent.joinpath(*name.split(".")).with_suffix(".py").read_text(encoding="utf-8")
    named = {
        target.id: node.value
        for node in ast.parse(source).body
        if isinstance(node, ast.Assign)
        for target in node.targets
        if isinstance(target, ast.Name)
    }
    return ast.literal_eval(named["TITLE"]), ast.literal_eval(named["NEEDS"])


def missing(name: str) -> list[str]:
    """Packages that a module needs and this machine lacks."""
    return [need for need in heading(name)[1] if need_version(need) is None]


def run(name: str) -> Record:
    """Run a module; its needs must be there."""
    module = import_module(f"validation.{name}")
    began = time.perf_counter()
    rows = []
    for row in module.rows():
        rows.append(rounded(row))
        print(f"  {row.verdict}: {row.case}, {row.quantity}: {' | '.join(row.numbers())} {row.unit}", flush=True)
    return Record(
        name=name,
        title=module.TITLE,
        introduction=cleandoc(module.__doc__),
        needs=tuple(module.NEEDS),
        date=datetime.now(UTC).date().isoformat(),
        seconds=round(time.perf_counter() - began, 1),
        versions={need: str(need_version(need)) for need in module.NEEDS},
        environment=environment(),
        rows=tuple(rows),
    )


def rounded(row: Row) -> Row:
    """The row with numbers of ten digits: more would differ from one processor to the next."""

    def short(value: float | str | None) -> float | str | None:
        return value if value is None or isinstance(value, str) else float(f"{float(value):.10g}")

    return Row(**asdict(row) | {"reference": short(row.reference), "ours": short(row.ours)})


def kept(name: str) -> Record | None:
    """Rows of the module when it last ran."""
    path = path_of(name)
    if not path.exists():
        return None
    data = json.loads(path.read_text(encoding="utf-8"))
    return Record(**data | {"rows": tuple(Row(**row) for row in data["rows"]), "needs": tuple(data["needs"])})
