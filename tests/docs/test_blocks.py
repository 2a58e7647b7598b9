"""Every code block of the documents runs, and prints what the page says."""

from __future__ import annotations

from pathlib import Path

import pytest

from gbeam.cli import FIGURES
from gbeam.plots import write_figures

from .pages import NOT_CODE, PAGES, ROOT, RUN, Block, Reader, blocks, commands

SLOW = {
    "docs/howto/flight_record.md",  # plans and places the F-16's flight
    "README.md",
    "docs/tutorials/flight_on_a_centrifuge.md",
    "docs/howto/many_machines.md",  # starts two clusters
    "docs/howto/shape_a_command.md",  # compiles the exact model
}
RUNNABLE = [page for page in PAGES if any(block.language in RUN for block in blocks(page))]


@pytest.fixture(scope="module")
def reader(tmp_path_factory: pytest.TempPathFactory) -> Reader:
    """One reader of all pages, in a folder with the examples."""
    folder = tmp_path_factory.mktemp("reader")
    (folder / "examples").symlink_to(ROOT / "examples")
    return Reader(folder)


def named(page: Path) -> str:
    return str(page.relative_to(ROOT))


@pytest.mark.parametrize(
    "page",
    [pytest.param(p, id=named(p), marks=[pytest.mark.slow] if named(p) in SLOW else []) for p in RUNNABLE],
)
def test_page_runs(page: Path, reader: Reader, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(reader.folder)
    monkeypatch.delenv(FIGURES)  # pages name them
    # The figures of a run take half its time, and are tested elsewhere.
    monkeypatch.setattr(
        "gbeam.plots.output.write_figures", lambda *of: [] if of[2] == "gbeam run" else write_figures(*of)
    )
    reader.read(page)


def test_every_block_is_run_or_shown() -> None:
    for page in PAGES:
        for block in blocks(page):
            assert block.language in RUN or block.language.startswith(NOT_CODE), f"{named(page)}:{block.line}"


def test_a_wrong_output_is_noticed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    page = ROOT / "docs" / "page.md"
    monkeypatch.setattr(
        "tests.docs.pages.blocks", lambda _: [Block("python", "print(2 + 2)", 1), Block("text", "5", 2)]
    )
    with pytest.raises(AssertionError, match=r"page\.md:2 expects\n5\nbut gbeam prints\n4"):
        Reader(tmp_path).read(page)


def test_commands_have_their_outputs() -> None:
    block = Block("console", "$ gbeam check a.toml\nwrong\n$ echo $?\n2\n", 1)
    assert list(commands(block)) == [("gbeam check a.toml", "wrong\n"), ("echo $?", "2\n")]


def test_the_readmes_python_is_short() -> None:
    (block,) = [each for each in blocks(ROOT / "README.md") if each.language == "python"]
    assert len(block.text.strip().splitlines()) <= 12
