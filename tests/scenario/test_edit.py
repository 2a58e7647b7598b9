"""A scenario's text with entries changed: they have their new values, and every other character stays."""

from __future__ import annotations

import json
import tomllib
from difflib import ndiff
from pathlib import Path

import pytest

from gbeam import InputError
from gbeam.scenario import Source, edited, parse

from ..scenarios import EVERY_MOTION

CHANGES = {"control_point": "217.94 mm", "mounting": "inverted", "smoothing": "60 ms"}
HEADER = """\
# what it is about
[motion.spin]   # the machine
kind = "centrifuge"
  control_point = "150 mm"  # µ: of the \\"specimen\\"
smoothing = 0.05 # s
[response]
duration = "1 s"
"""
LAYOUTS = {
    "a header": HEADER,
    "no newline at the end": '[motion.spin]\nkind = "x"\ncontrol_point = 0.1',
    "windows": HEADER.replace("\n", "\r\n"),
    "dotted keys": '[motion]\nspin.kind = "x" # é\nspin.control_point = 0.1\nspin.smoothing = 0\n',
    "inline": '[motion]\nspin = { kind = "x", control_point = "1 m" } # inline\n',
    "no control point": '[motion.spin]\nkind = "x" # comment\n\n[response]\n',
    "lines": '[motion.spin]\nkind = "x"\ncontrol_point = """\n1 m"""\n',
    "json": json.dumps({"motion": {"spin": {"control_point": 1, "kind": "x"}}, "title": "t"}, indent=2),
    "json on a line": '{"motion": {"spin": {"kind": "x"}}}',
}


@pytest.mark.parametrize("text", LAYOUTS.values(), ids=LAYOUTS)
def test_entries_change_and_the_rest_stays(text: str) -> None:
    source = Source("s", text, Path(), {})
    changed = edited(source, ("motion", "spin"), CHANGES)
    before, after = parse("s", text), parse("s", changed)
    before["motion"]["spin"] |= CHANGES
    assert after == before
    for comment in ("# what it is about", "# the machine", '# µ: of the \\"specimen\\"', "# s", "# é", "# inline"):
        assert changed.count(comment) == text.count(comment)
    lost = [line for line in ndiff(text.splitlines(), changed.splitlines()) if line.startswith("- ")]
    assert len(lost) <= 2  # the lines of what was there already
    assert changed.count("\r") in (0, changed.count("\n"))


def test_the_scenarios_of_the_tests(tmp_path: Path) -> None:
    changed = edited(Source("s", EVERY_MOTION, tmp_path, {}), ("motion", "spin"), {"control_point": "1 mm"})
    assert changed == EVERY_MOTION.replace('control_point = "150 mm"', 'control_point = "1 mm"')
    assert tomllib.loads(changed)["motion"]["spin"]["control_point"] == "1 mm"


@pytest.mark.parametrize("text", ['title = "x"\n', "[motion]\nspin = 3\n"])
def test_what_cannot_be_changed_is_refused_with_what_to_write(text: str) -> None:
    with pytest.raises(InputError, match=r"write it yourself: motion\.spin\.control_point=217\.94 mm"):
        edited(Source("s", text, Path(), {}), ("motion", "spin"), CHANGES)
