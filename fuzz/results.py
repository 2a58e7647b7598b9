"""Result files that are damaged: ``gbeam rerun`` reads them."""

from __future__ import annotations

import json
import tempfile
from contextlib import redirect_stdout
from functools import cache
from io import StringIO
from pathlib import Path

from fuzz.cases import ROOT, Case, Random
from fuzz.records import SCENARIO, columns
from fuzz.scenarios import change, corrupted


def result(chosen: Random) -> Case:
    """A result with some bytes or values changed, or another file in its place."""
    if chosen.random() < 0.4:
        facts = json.loads(sound_json())
        for _ in range(chosen.choice((1, 1, 3))):
            change(chosen, facts)
        return Case(
            "result", ["rerun", "modes.json"], {"modes.json": json.dumps(facts).encode("utf-8", "surrogatepass")}
        )
    data = (
        sound() if chosen.random() < 0.9 else chosen.choice((b"", b"CDF\x01", b"\x89HDF\r\n\x1a\n", SCENARIO.encode()))
    )
    for _ in range(chosen.choice((1, 1, 2, 5, 50))):
        data = corrupted(chosen, data)
    return Case("result", ["rerun", "r.nc", *(["--json"] if chosen.random() < 0.2 else [])], {"r.nc": data})


@cache
def sound() -> bytes:
    """A sound result."""
    from gbeam.cli import main

    rows = zip(*columns().values(), strict=True)
    lines = [",".join(columns()), *(",".join(f"{value:.6g}" for value in row) for row in rows)]
    record = 'file = "r.csv", time = "t", x = "ax", y = "ay", z = "az", unit = "g"'
    with tempfile.TemporaryDirectory() as name, redirect_stdout(StringIO()):
        scenario = Path(name, "s.toml")
        scenario.write_text(SCENARIO.replace("RECORD", record), encoding="utf-8")
        Path(name, "r.csv").write_text("\n".join(lines), encoding="utf-8")
        assert main(["run", str(scenario), "--out", name, "--set", "response.duration=0.5 s"]) == 0
        return Path(name, "result.nc").read_bytes()


@cache
def sound_json() -> bytes:
    """The sound JSON of a verb."""
    from gbeam.cli import main

    with tempfile.TemporaryDirectory() as name, redirect_stdout(StringIO()):
        assert main(["modes", str(ROOT / "examples" / "hubbeam2009_slew_3.toml"), "--out", name]) == 0
        return Path(name, "modes.json").read_bytes()
