"""The files of a command: a rerun takes away the plots of the run before it, and nothing else."""

from __future__ import annotations

import re
import shutil
from pathlib import Path

import pytest
from matplotlib.figure import Figure

from gbeam.cli import publish, write_json
from gbeam.plots import save

from ..calling import main


def _publish(folder: Path, *stems: str, command: str = "gbeam run") -> list[Path]:
    def make(hidden: Path) -> None:
        write_json(hidden / "facts.json", {})
        for stem in stems:
            figure = Figure(figsize=(1, 1))
            save(figure, hidden, stem, command)

    return publish(folder, make)


def test_a_rerun_removes_the_plots_of_the_run_before_it_and_nothing_else(tmp_path: Path) -> None:
    _publish(tmp_path, "tip", "axes_rate_spin", "tip_of_<Bär> & co")
    _publish(tmp_path, "modes", command="gbeam modes")
    save(Figure(figsize=(1, 1)), tmp_path, "drawn_by_hand")
    kept = {"kept.png", "axes_rate_spin.csv", "notes.svg", "empty.png", "folder.png"}
    shutil.copy(tmp_path / "axes_rate_spin.png", tmp_path / "kept.png")
    (tmp_path / "axes_rate_spin.csv").write_text("gbeam run")
    (tmp_path / "notes.svg").write_bytes(b"\xff<dc:source>gbeam \xff run: notes.svg</dc:source>")
    (tmp_path / "empty.png").touch()
    (tmp_path / "folder.png").mkdir()

    files = _publish(tmp_path, "tip", "loads_slew")
    assert [file.name for file in files] == ["facts.json", "loads_slew.png", "loads_slew.svg", "tip.png", "tip.svg"]
    plots = {f"{stem}.{kind}" for stem in ("tip", "loads_slew", "modes", "drawn_by_hand") for kind in ("png", "svg")}
    assert {file.name for file in tmp_path.iterdir()} == {"facts.json", *kept, *plots}

    # A command without plots leaves all as it is.
    _publish(tmp_path)
    assert {file.name for file in tmp_path.iterdir()} == {"facts.json", *kept, *plots}


@pytest.mark.parametrize("verb", ["check", "static"])
def test_what_a_scenario_means_folds_on_a_narrow_terminal(
    verb: str, fast: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """As do the names of the files that are written."""
    monkeypatch.chdir(tmp_path)
    words = [verb, str(fast), *([] if verb == "check" else ["--at", "0.2 s", "--out", "a/folder"])]
    assert main(words) == 0
    plain = capsys.readouterr().out
    assert max(map(len, plain.splitlines())) > 40  # a file takes any width
    monkeypatch.setenv("COLUMNS", "40")
    monkeypatch.setattr("sys.stdout.isatty", lambda: True)
    assert main(words) == 0
    folded = re.sub(r"\x1b\[[\d;]*m", "", capsys.readouterr().out)
    assert max(map(len, folded.splitlines())) <= 40 and (verb != "check" or folded.split() == plain.split())
