"""The notebooks of examples/, run cell by cell; and the widget that they show, in a browser."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

NOTEBOOKS = sorted((Path(__file__).parents[1] / "examples" / "notebooks").glob("*.ipynb"))


@pytest.mark.parametrize("file", NOTEBOOKS, ids=lambda file: file.stem)
def test_notebook_runs(file: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("anywidget")
    shell = pytest.importorskip("IPython.core.interactiveshell").InteractiveShell()
    monkeypatch.chdir(tmp_path)
    shown: dict[str, int] = {}
    for cell in json.loads(file.read_text(encoding="utf-8"))["cells"]:
        assert not cell.get("outputs")
        if cell["cell_type"] == "code":
            answer = shell.run_cell("".join(cell["source"]))
            answer.raise_error()
            if answer.result is not None:
                built, _ = shell.display_formatter.format(answer.result)
                for kind in built:
                    shown[kind] = shown.get(kind, 0) + 1
    assert shown["text/html"] >= 2 and shown["image/png"] >= 1
    assert shown["application/vnd.jupyter.widget-view+json"] >= 1


def test_there_are_two() -> None:
    assert len(NOTEBOOKS) == 2
