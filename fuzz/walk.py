"""``python -m fuzz.walk``: every verb over every example and every tree of fuzz/trees, or over trees at random.

Each is to end with an answer, a failure in words, or a refusal with its place; its file is to be opened by ``report``
and reproduced by ``rerun``, and to hold no absurd number; its page is to open in a browser without a complaint. Hours;
status 1 if anything is wrong.
"""

from __future__ import annotations

import argparse
import json
import math
import re
import sys
import tempfile
import tomllib
from collections.abc import Iterator, Sequence
from itertools import chain
from pathlib import Path
from typing import Any

from playwright.sync_api import sync_playwright

from fuzz.cases import ROOT, Case, Random
from fuzz.grown import grown
from fuzz.judge import judge
from fuzz.worker import Answer, call, warm_up
from tests.browser.chromium import arguments as quiet
from tests.browser.chromium import environment, find, watch

SECONDS, PATIENCE, MEMORY = 600, 1800, 8 * 2**30
LARGEST = 10.0  # of an estimated error: 1000 %, beyond which it says nothing
_NAN = re.compile(r"(?<![\w.])[-+]?(nan|inf)(?!\w)", re.IGNORECASE)
_SHARE = re.compile(r"(\d[\d.e+]*) %")


def main() -> int:
    """Walk, and print what is wrong."""
    parser = argparse.ArgumentParser(prog="python -m fuzz.walk", description=__doc__)
    parser.add_argument("only", nargs="*", help="stems of scenarios, or words of the command lines")
    parser.add_argument("--grown", type=int, default=0, metavar="N", help="N trees at random, in place of the files")
    parser.add_argument("--seed", type=int, default=0, help="of the first of them")
    options = parser.parse_args()
    warm_up()
    with tempfile.TemporaryDirectory() as folder:
        files = [planted(Path(folder), each) for each in range(options.seed, options.seed + options.grown)]
        faults = walk(files or [*_scenarios("examples"), *_scenarios("fuzz/trees")], options.only)
    print(f"{faults or 'no'} faults")
    return 1 if faults else 0


def _scenarios(folder: str) -> list[Path]:
    return sorted((ROOT / folder).glob("*.toml"))


def planted(folder: Path, seed: int) -> Path:
    """Write the files of a tree at random, and return the scenario's."""
    for name, content in grown(Random(seed)).items():
        file = folder / str(seed) / name.replace("tree", f"grown_{seed}")
        file.parent.mkdir(exist_ok=True)
        file.write_bytes(content)
    return folder / str(seed) / f"grown_{seed}.toml"


def walk(files: Sequence[Path], chosen: Sequence[str]) -> int:
    """Walk the files that are named, by the command lines that have one of the other words; return how many faults."""
    stems = {each.stem for each in files}
    named, words = [each for each in chosen if each in stems], [each for each in chosen if each not in stems]
    faults = 0
    for file in files if not named else [each for each in files if each.stem in named]:
        for arguments in command_lines(tomllib.loads(file.read_text(encoding="utf-8"))):
            if not words or any(word in arguments for word in words):
                line = " ".join([arguments[0], file.stem, *arguments[1:]])
                for fault in walked(arguments[0], str(file), arguments[1:]):
                    print(f"{line}\n    {fault}", flush=True)
                    faults += 1
    return faults


def command_lines(scenario: dict[str, Any]) -> Iterator[list[str]]:
    """Each verb with what it needs for this scenario, once for every motion where one is to be chosen."""
    motions = [["--motion", name] for name in scenario.get("motion", {})] or [[]]
    response = scenario["response"]
    short = ["--set", "response.duration=1 s"] if float(response.get("duration", "0 s").split()[0]) > 1 else []
    value, size = next(_values(scenario, ""))
    figures = {"modes": "modes[0].frequency", "static": "tip.z", "critical-speed": "critical_speed"}
    of_run = []
    if "joints" in scenario:
        *_, last = scenario["bodies"]
        figures["static"], of_run = f"{last}.root.displacement.z", [f"{last}.root.displacement_max"]
    kinds = {name: each["kind"] for name, each in scenario.get("joints", {}).items()}
    turning = [["--turning", f"{name}.angle"] for name, kind in kinds.items() if kind == "revolute"][:1]
    moved = {"revolute": "angle", "prismatic": "displacement"}
    joint = [["--joint", f"{name}.{moved[kind]}"] for name, kind in kinds.items() if kind in moved][:1]
    cases = f"{value}={0.95 * size:g}, {1.05 * size:g}"
    yield ["check"]
    yield ["plan"]
    yield ["run", *short]
    for motion in motions:
        for verb in ("static", "modes", "linearize"):
            yield [verb, *motion]
        for verb in ("campbell", "critical-speed"):
            yield [verb, *motion, *chain(*turning), *(["--to", "30 rpm"] if verb == "campbell" else [])]
        for varied in ("loads", "acceleration"):
            yield ["critical-speed", "--vary", varied, *motion]
    motion = motions[0]
    for verb in ("modes", "static"):
        yield ["sensitivity", "--verb", verb, "--of", figures[verb], "--with", value, *motion]
    yield ["optimize", "--verb", "modes", "--minimise", figures["modes"], "--over", value, *motion]
    yield ["fit", "--data", "d.csv", "--free", value, *motion]
    yield ["shape", "--duration", "2 s", "--angle", "0.1 rad", *motion, *chain(*joint)]
    yield ["place", "--no-proof"]
    yield ["models", *short]
    yield ["sensitivity", "--with", value, *short, *(f"--of={each}" for each in of_run)]
    for verb, figure in figures.items():
        yield ["sweep", "--verb", verb, "--over", cases, "--measure", figure, *motion]
    yield ["sweep", "--over", "response.step=2 ms, 4 ms", *short, *(f"--measure={each}" for each in of_run)]


MEASURED = b"mode,frequency [Hz]\n1,12\n2,60\n"


def walked(verb: str, scenario: str, arguments: list[str]) -> Iterator[str]:
    """Run a verb, then ``report`` and ``rerun`` on its file, and open its page; yield what is wrong."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "d.csv").write_bytes(MEASURED)
        pages = [] if verb == "check" else ["--report"]
        answer = _called([verb, scenario, *arguments, "--out", "out", *pages], folder)
        print(f"{answer.seconds:6.1f} s, status {answer.status}: {verb} {scenario} {' '.join(arguments)}", flush=True)
        yield from _wrong(Case("walk", [verb]), answer)
        if answer.status == 2:
            print("    " + answer.err.strip().splitlines()[-1][:150])
        for file in sorted((folder / "out").glob("*")):
            if file.suffix in (".json", ".nc") and file.stem != "command":
                yield from (f"{file.name}: {each}" for each in _absurd(file))
                for again in ("report", "rerun") if pages else ("rerun",):
                    answer = _called([again, str(file)], folder)
                    yield from (f"{again}: {each}" for each in _wrong(Case("walk", [again]), answer))
                    if answer.status:
                        yield f"{again} of {file.name} ends with {answer.status}: {answer.err[-300:]}"
        yield from _complaints(sorted((folder / "out").glob("*.html")))


def _called(arguments: list[str], folder: Path) -> Answer:
    return call(Case("walk", arguments), folder, SECONDS, PATIENCE, MEMORY)


def _values(table: dict[str, Any], path: str) -> Iterator[tuple[str, float]]:
    """Paths of lengths, masses and damping ratios of beams and bodies, and their numbers in SI."""
    for key in ("length", "mass", "damping_ratio"):
        if isinstance(table.get(key), str | float):
            number, _, unit = str(table[key]).partition(" ")
            yield f"{path}.{key}", float(number) * {"mm": 1e-3, "g": 1e-3, "%": 1e-2}.get(unit, 1.0)
    for key in ("beam", "bodies") if not path else table:
        if isinstance(table.get(key), dict):
            yield from _values(table[key], f"{path}.{key}".lstrip("."))


def _wrong(case: Case, answer: Answer) -> Iterator[str]:
    if fault := judge(case, answer, MEMORY):
        yield fault
    for line in (answer.out + answer.err).splitlines():
        if _NAN.search(line) or any(float(each) > 100 * LARGEST for each in _SHARE.findall(line)):
            yield f"absurd: {line.strip()}"


def _absurd(file: Path) -> Iterator[str]:
    """Yield the names of numbers in the JSON of a result that are none, or errors that say nothing."""
    for name, number in _numbers(json.loads(file.read_text(encoding="utf-8")) if file.suffix == ".json" else {}, ""):
        if not math.isfinite(number) or ("error" in name and number > LARGEST):
            yield f"{name} is {number:g}"


def _numbers(value: Any, path: str) -> Iterator[tuple[str, float]]:
    if isinstance(value, dict | list):
        for key, each in value.items() if isinstance(value, dict) else enumerate(value):
            yield from _numbers(each, f"{path}.{key}")
    elif isinstance(value, float):
        yield path, value


def _complaints(pages: list[Path]) -> Iterator[str]:
    """Open pages, each at once, and yield what they say on the console, request or fail in."""
    program = find()
    if not pages or program is None:
        return
    with sync_playwright() as started:
        browser = started.chromium.launch(executable_path=str(program), args=quiet(program), env=environment(program))
        for file in pages:
            page = browser.new_page()
            faults = watch(page)
            page.goto(file.as_uri())
            page.wait_for_selector("html[data-gbeam]")
            if (text := _NAN.search(page.inner_text("body"))) is not None:
                faults.append(f"{text[0]} in its text")
            yield from (f"{file.name}: {each}" for each in faults)
        browser.close()


if __name__ == "__main__":
    sys.exit(main())
