"""Run the modules, keep what they find, and make docs/validation.md.

Exit status 1 where a row is outside its tolerance without a reason, or a module failed.
"""

from __future__ import annotations

import argparse
import sys
import traceback

from validation import MODULES, page, record


def main() -> int:
    """Run what is asked for."""
    parser = argparse.ArgumentParser(prog="python -m validation", description=__doc__.splitlines()[0])
    parser.add_argument("--only", metavar="NAME", help="modules whose name contains this")
    parser.add_argument("--page", action="store_true", help="run nothing: make the page from the kept results")
    options = parser.parse_args()
    chosen = [name for name in MODULES if not options.only or options.only in name]
    if options.only and not chosen:
        parser.error(f"no module's name contains {options.only!r}; there are {', '.join(MODULES)}")
    wrong = [] if options.page else [name for name in chosen if not run(name)]
    page.write()
    print(f"{page.PAGE.relative_to(page.ROOT)} written")
    if wrong:
        print(f"outside the tolerance without a reason, or failed: {', '.join(wrong)}", file=sys.stderr)
    return 1 if wrong else 0


def run(name: str) -> bool:
    """Run and keep one module; whether every difference is within its tolerance or explained."""
    print(name, flush=True)
    missing = record.missing(name)
    if missing:
        before = record.kept(name)
        print(f"  not run: needs {', '.join(missing)}" + (f"; results of {before.date} kept" if before else ""))
        return True
    try:
        done = record.run(name)
    except Exception:
        traceback.print_exc()
        return False
    done.save()
    print(f"  {len(done.rows)} rows in {done.seconds:.0f} s", flush=True)
    return not done.unexplained


if __name__ == "__main__":
    sys.exit(main())
