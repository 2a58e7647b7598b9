"""Files written by gbeam, damaged: results and answers for ``report`` and ``rerun``, stores for ``--resume``."""

from __future__ import annotations

import json
import tempfile
from contextlib import redirect_stderr, redirect_stdout
from functools import cache
from io import StringIO
from pathlib import Path

from fuzz.cases import ROOT, Case, Random
from fuzz.damage import damaged
from fuzz.records import SCENARIO, columns
from fuzz.scenarios import change, corrupted

SLEW = ROOT / "examples" / "hubbeam2009_slew_3.toml"
PENDULUM = ROOT / "fuzz" / "trees" / "double_pendulum.toml"
SWEEP = ["--over=motion.slew.radius=0.1 m:1 m:3", "--measure=tip.y", "--verb=static"]
# Verbs on scenarios, and their words: what they write is damaged.
ANSWERS: dict[str, tuple[str, Path, list[str]]] = {
    **{verb: (verb, SLEW, []) for verb in ("check", "modes", "static", "campbell", "linearize", "critical-speed")},
    "sweep": ("sweep", SLEW, SWEEP),
    "sensitivity": ("sensitivity", SLEW, ["--of=tip.y", "--with=beam.length", "--verb=static"]),
    "optimize": ("optimize", SLEW, ["--minimise=tip.y", "--over=beam.length", "--verb=static", "--starts=1"]),
    "shape": ("shape", SLEW, ["--angle=0.1 rad", "--duration=2 s"]),
    "place": ("place", ROOT / "examples" / "zhang2020_example1.toml", ["--no-proof"]),
    **{f"{verb} of a system": (verb, PENDULUM, []) for verb in ("check", "modes", "static", "linearize")},
    "run of a system": ("run", PENDULUM, ["--set=response.duration=0.1 s"]),
}


def result(chosen: Random) -> Case:
    """A result, an answer or a store with some bytes or values changed, or another file in its place."""
    verb = chosen.choice(("rerun", "report"))
    match chosen.randrange(10):
        case 0 | 1 | 2:
            facts = json.loads(chosen.choice(_ending(".json")))
            for _ in range(chosen.choice((1, 1, 3))):
                change(chosen, facts)
            return Case("result", [verb, "a.json"], {"a.json": json.dumps(facts).encode("utf-8", "surrogatepass")})
        case 3 | 4 | 5:
            return _store(chosen)
        case 6:  # a folder that no verb reads
            files = {f"z/{name}": data for name, data in written("sweep").items() if name.startswith("sweep.zarr/")}
            return Case("result", [verb, "z/sweep.zarr"], files)
    name = chosen.choice(("r.nc", "out/result.nc", "r.json"))
    data = chosen.choice(_ending(".nc"))
    if chosen.random() < 0.1:
        data = chosen.choice((b"", b"CDF\x01", b"\x89HDF\r\n\x1a\n", SCENARIO.encode()))
    for _ in range(chosen.choice((1, 1, 2, 5, 50))):
        data = damaged(chosen, data)
    target = "out" if name == "out/result.nc" and chosen.random() < 0.5 else name
    return Case(
        "result", [verb, target, *(["--json"] if verb == "rerun" and chosen.random() < 0.2 else [])], {name: data}
    )


def _store(chosen: Random) -> Case:
    """A sweep that is to be resumed, or begun again, where its store is not whole."""
    files = {f"out/{name}": data for name, data in written("sweep").items() if name.startswith("cases.")}
    for _ in range(chosen.choice((1, 1, 2, 5))):
        name = chosen.choice(list(files))
        if chosen.random() < 0.2:
            del files[name]
            break
        files[name] = (damaged if chosen.random() < 0.5 else corrupted)(chosen, files[name])
    arguments = ["sweep", "s.toml", *SWEEP, "--out", "out"]
    if chosen.random() < 0.8:
        arguments += ["--resume"]
    return Case("result", arguments, {"s.toml": SLEW.read_bytes(), **files})


@cache
def _ending(ending: str) -> list[bytes]:
    """Contents of the files with an ending that all verbs write."""
    files = (file for verb in (*ANSWERS, "run") for file in written(verb).items())
    return [data for name, data in files if name.endswith(ending) and "/" not in name]


@cache
def written(verb: str) -> dict[str, bytes]:
    """The files that a verb writes, by their path in its folder."""
    from gbeam.cli import main

    with tempfile.TemporaryDirectory() as name, redirect_stdout(StringIO()), redirect_stderr(StringIO()):
        out, scenario = Path(name, "out"), Path(name, "s.toml")
        if verb == "run":
            rows = zip(*columns().values(), strict=True)
            lines = [",".join(columns()), *(",".join(f"{value:.6g}" for value in row) for row in rows)]
            record = 'file = "r.csv", time = "t", x = "ax", y = "ay", z = "az", unit = "g", to = "0.5 s"'
            scenario.write_text(SCENARIO.replace("RECORD", record), encoding="utf-8")
            Path(name, "r.csv").write_text("\n".join(lines), encoding="utf-8")
            words = []
        else:
            verb, source, words = ANSWERS[verb]
            scenario.write_bytes(source.read_bytes())
        assert main([verb, str(scenario), *words, "--out", str(out)]) == 0, verb
        return {str(each.relative_to(out)): each.read_bytes() for each in out.rglob("*") if each.is_file()}
