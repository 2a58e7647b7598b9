"""``python -m fuzz``: malformed inputs; prints what is wrong and keeps a file that repeats it; status 1 if any is."""

from __future__ import annotations

import argparse
import base64
import json
import random
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path

from fuzz.app import app
from fuzz.bodies import body
from fuzz.cases import Case, make
from fuzz.commands import command
from fuzz.fixes import circle
from fuzz.judge import judge
from fuzz.records import measured, record
from fuzz.results import result
from fuzz.scenarios import scenario
from fuzz.sweeps import sweep
from fuzz.worker import Answer, call, warm_up
from gbeam.printable import shortened

KINDS = {
    "scenario": scenario,
    "record": record,
    "fixes": measured,
    "body": body,
    "command": command,
    "result": result,
    "sweep": sweep,
    "app": app,
}
FINDINGS = Path(__file__).parent / "findings"


def main() -> int:
    """Run the cases of a seed, or repeat one."""
    parser = argparse.ArgumentParser(prog="python -m fuzz", description=__doc__)
    parser.add_argument("--count", type=int, default=10_000)
    parser.add_argument("--first", type=int, default=0, help="number of the first case")
    parser.add_argument("--seed", type=int, default=None, help="by default another one each time")
    parser.add_argument("--only", choices=KINDS, help="one kind of input")
    parser.add_argument("--repeat", type=Path, help="a file of fuzz/findings")
    options = parser.parse_args()
    warm_up()
    if options.repeat:
        case = _loaded(options.repeat)
        answer = _called(case)
        print(answer.out, answer.err, answer.traceback, f"status {answer.status}, {answer.seconds:.1f} s", sep="\n")
        if case.kind == "fixes":
            print(circle(case, _called))
        return 0
    seed = random.SystemRandom().randrange(10**6) if options.seed is None else options.seed
    kinds = KINDS if options.only is None else {options.only: KINDS[options.only]}
    print(f"seed {seed}: python -m fuzz --seed {seed} repeats it", flush=True)
    faults = run(seed, range(options.first, options.first + options.count), kinds)
    return 1 if faults else 0


def run(seed: int, numbers: range, kinds: dict = KINDS) -> Counter[str]:
    """Run cases by number; print and keep the first of every fault."""
    faults: Counter[str] = Counter()
    statuses: Counter[tuple[str, int]] = Counter()
    slowest, largest, start = (0.0, 0), 0, time.monotonic()
    for number in numbers:
        case = make(seed, number, kinds)
        answer = _called(case)
        statuses[case.kind, answer.status] += 1
        if number % 500 == 499:
            print(f"{number + 1} …", flush=True)
        slowest, largest = max(slowest, (answer.seconds, number)), max(largest, answer.memory)
        if fault := judge(case, answer) or (circle(case, _called) if case.kind == "fixes" else ""):
            faults[fault] += 1
            if faults[fault] == 1:
                words = shortened(" ".join(case.arguments))
                print(f"{number}: {fault}\n    gbeam {words}\n    {_kept(seed, number, case)}", flush=True)
    seconds = time.monotonic() - start
    print(f"\n{len(numbers)} cases in {seconds:.0f} s; slowest {slowest[0]:.1f} s (case {slowest[1]}), ", end="")
    print(f"most memory {largest / 2**20:.0f} MiB")
    for kind in kinds:
        counts = (f"{count} with status {each[1]}" for each, count in sorted(statuses.items()) if each[0] == kind)
        print(f"  {kind}: {', '.join(counts)}")
    print("\n".join(f"{count:6d}  {fault}" for fault, count in faults.most_common()) or "no faults", flush=True)
    return faults


def _called(case: Case) -> Answer:
    with tempfile.TemporaryDirectory() as folder:
        return call(case, Path(folder))


def _kept(seed: int, number: int, case: Case) -> Path:
    """Keep a case in a file that ``--repeat`` takes."""
    FINDINGS.mkdir(exist_ok=True)
    file = FINDINGS / f"{seed}-{number}.json"
    files = {name: base64.b64encode(data).decode() for name, data in case.files.items()}
    file.write_text(json.dumps({"kind": case.kind, "arguments": case.arguments, "files": files}))
    return file


def _loaded(file: Path) -> Case:
    kept = json.loads(file.read_text(encoding="utf-8"))
    return Case(kept["kind"], kept["arguments"], {name: base64.b64decode(data) for name, data in kept["files"].items()})


if __name__ == "__main__":
    sys.exit(main())
