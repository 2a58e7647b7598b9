"""Rows of evidence: their verdicts, their numbers, and the page that is made of them."""

from __future__ import annotations

from importlib import import_module

import pytest

from validation import MODULES, page, record
from validation import __main__ as main
from validation.table import AGREES, DIFFERS, EXPLAINED, NOT_COMPARED, Row


def row(reference: float | str | None, ours: float | str | None, tolerance: float, remark: str = "") -> Row:
    return Row("case", "tip", reference, ours, "m", tolerance, "a code", remark)


@pytest.mark.parametrize(
    ("reference", "ours", "tolerance", "remark", "verdict"),
    [
        (2.0, 2.001, 1e-3, "", AGREES),
        (-2.0, -2.001, 1e-3, "", AGREES),
        (2.0, 2.01, 1e-3, "", DIFFERS),
        (2.0, -2.0, 1e-3, "", DIFFERS),
        (2.0, 2.01, 1e-3, "shear", EXPLAINED),
        (0.0, 1e-9, 1e-8, "", AGREES),
        (0.0, 1e-7, 1e-8, "", DIFFERS),
        ("0.020", 0.0202, 0.02, "", AGREES),
        (2.0, float("nan"), 1e-3, "shear", DIFFERS),
        (None, 2.0, 1e-3, "not legible", NOT_COMPARED),
    ],
)
def test_verdict(reference: float, ours: float, tolerance: float, remark: str, verdict: str) -> None:
    assert row(reference, ours, tolerance, remark).verdict == verdict


def test_what_is_not_compared_says_why() -> None:
    with pytest.raises(ValueError, match="no remark says why"):
        row(None, 2.0, 1e-3)


@pytest.mark.parametrize(
    ("reference", "ours", "shown"),
    [
        (2.0, 2.0, ("2.000", "2.000")),
        (2.25654, 2.256571, ("2.256540", "2.256571")),
        (2.0, 2.5, ("2.000", "2.500")),
        ("0.02", 0.0205, ("0.02", "0.02050")),
        (0.0, 1.23456e-9, ("0", "1.2e-09")),
        (1.5e9, 1.5e9, ("1.500e+09", "1.500e+09")),
        ("2.7667e3", 2766.7, ("2.7667e3", "2766.7")),
    ],
)
def test_numbers_show_their_difference(reference: float | str, ours: float, shown: tuple[str, str]) -> None:
    assert row(reference, ours, 1e-3).numbers() == shown


def test_page_is_made_from_what_is_kept() -> None:
    assert page.PAGE.read_text(encoding="utf-8") == page.page()


@pytest.mark.parametrize("name", MODULES)
def test_kept_results_are_explained(name: str) -> None:
    answer = record.kept(name)
    assert answer is None or (answer.rows and not answer.unexplained)


def test_every_module_is_listed() -> None:
    folders = (page.ROOT / "validation" / folder for folder in ("codes", "published", "accuracy"))
    modules = {f"{folder.name}.{path.stem}" for folder in folders for path in folder.glob("*.py")}
    assert {name for name in modules if has_rows(name)} == set(MODULES)


def has_rows(name: str) -> bool:
    source = (page.ROOT / "validation" / name.replace(".", "/")).with_suffix(".py").read_text(encoding="utf-8")
    return "\ndef rows() -> Iterator[Row]:" in source


def test_what_is_missing_is_said(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    """Without the program a module does not run, and its kept results stay."""
    monkeypatch.setattr(record, "need_version", lambda need: None if need == "calculix-ccx" else "1")
    assert main.run("codes.calculix")
    assert "not run: needs calculix-ccx; results of" in capsys.readouterr().out
    assert page.absent("codes.calculix").endswith("\n\nnot run: needs calculix-ccx, numpy, scipy\n")


def test_a_difference_without_a_reason_is_reported(monkeypatch: pytest.MonkeyPatch) -> None:
    module = import_module("validation.table")
    monkeypatch.setattr(module, "TITLE", "Title", raising=False)
    monkeypatch.setattr(module, "NEEDS", ("numpy",), raising=False)
    monkeypatch.setattr(module, "rows", lambda: iter([row(2.0, 2.1, 1e-3), row(2.0, 2.0, 1e-3)]), raising=False)
    done = record.run("table")
    assert done.unexplained == [row(2.0, 2.1, 1e-3)]
    text = page.chapter(done, [done.environment])
    assert page.summary([done]).endswith("| [Title](#title) | 1 | 0 | 1 | 0 |\n")
    assert "| case | tip, m | 2.000 | 2.100 | +5 % | 0.1 % | DIFFERS |" in text
