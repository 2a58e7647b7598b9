"""Judge every mutant, or those whose names hold some words: python -m mutants [WORDS] [--room ROOM] [--jobs N].

Exit status 0 where the tests catch all of them, else 1. First the same tests run on the source as it is: a test that
fails there catches nothing.
"""

from __future__ import annotations

import argparse
import sys
from concurrent.futures import ThreadPoolExecutor

from mutants.mutant import CAUGHT, SOURCE, Mutant, judge, mutants, run_tests


def main() -> int:
    parser = argparse.ArgumentParser(prog="python -m mutants", description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("words", nargs="*", help="part of the names of mutants")
    parser.add_argument("--room", default="", help="folder of the package in which they are, such as solids")
    parser.add_argument("--jobs", type=int, default=1, help="how many are judged at a time")
    options = parser.parse_args()
    words, room = " ".join(options.words), options.room and f"{options.room}/"
    chosen = [each for each in mutants() if words in each.name and each.file.startswith(room)]
    if not sound(chosen):
        return 1
    width = max((len(each.name) for each in chosen), default=0)
    survivors = 0
    with ThreadPoolExecutor(options.jobs) as pool:
        for verdict in pool.map(judge, chosen):
            survivors += verdict.outcome != CAUGHT
            print(
                f"{verdict.mutant.name:{width}}  {verdict.outcome} {verdict.seconds:5.1f} s  {verdict.by}", flush=True
            )
    print(f"{len(chosen) - survivors} of {len(chosen)} mutants caught")
    return 1 if survivors else 0


def sound(chosen: list[Mutant]) -> bool:
    """True if the tests pass where nothing is wrong."""
    tests = tuple(sorted({test for each in chosen for test in each.tests}))
    status, output = run_tests(tests, SOURCE.parent) if tests else (1, "no mutant has such a name")
    if status:
        print(f"without any mutant the tests fail:\n{output[-2000:]}")
    return status == 0


if __name__ == "__main__":
    sys.exit(main())
