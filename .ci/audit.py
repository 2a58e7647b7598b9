"""Audit versions in locks for known vulnerabilities: pip-audit asks PyPI's database of advisories.

Every line is looked at, whatever platform or Python it is for. Exit status: 0 none known, 1 some, 2 no answer.
"""

from __future__ import annotations

import json
import re
import subprocess
import sys
import tempfile
from collections.abc import Iterable
from pathlib import Path
from typing import Any

_PINNED = re.compile(r"^([A-Za-z0-9._-]+)==([^\s;\\]+)", re.MULTILINE)


def pinned(locks: Iterable[Path]) -> list[tuple[str, str]]:
    """Return names and versions, each once."""
    return sorted({match for lock in locks for match in _PINNED.findall(lock.read_text(encoding="utf-8"))})


def rounds(versions: list[tuple[str, str]]) -> list[list[tuple[str, str]]]:
    """Return the versions in lists that have each name once, as pip-audit needs them."""
    lists: list[dict[str, str]] = []
    for name, version in versions:
        free = next((each for each in lists if name not in each), None)
        if free is None:
            lists.append(free := {})
        free[name] = version
    return [list(each.items()) for each in lists]


def vulnerable(versions: list[tuple[str, str]]) -> list[str]:
    """Return a line for each known vulnerability.

    Raises
    ------
    RuntimeError
        If the database does not answer.
    """
    with tempfile.TemporaryDirectory() as folder:
        lock, answer = Path(folder) / "lock.txt", Path(folder) / "answer.json"
        lock.write_text("".join(f"{name}=={version}\n" for name, version in versions), encoding="utf-8")
        command = [sys.executable, "-m", "pip_audit", "--requirement", lock, "--no-deps", "--disable-pip"]
        command += ["--progress-spinner", "off", "--format", "json", "--output", answer]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        if not answer.exists():
            said = (done.stderr.strip().splitlines() or ["pip-audit said nothing"])[-1]
            raise RuntimeError(f"{said[:200]}; is there a network?")
        return [
            line for each in json.loads(answer.read_text(encoding="utf-8"))["dependencies"] for line in _lines(each)
        ]


def _lines(package: dict[str, Any]) -> list[str]:
    named = f"{package['name']} {package.get('version', '')}".strip()
    if "skip_reason" in package:
        raise RuntimeError(f"{named} was not looked at: {package['skip_reason']}")
    fixed = [", ".join(each["fix_versions"]) or "none" for each in package["vulns"]]
    return [f"{named}: {each['id']}, mended in {by}" for each, by in zip(package["vulns"], fixed, strict=True)]


def main(locks: list[str]) -> int:
    """Print what is known of the locks' versions."""
    versions = pinned(map(Path, locks))
    try:
        lines = [line for each in rounds(versions) for line in vulnerable(each)]
    except RuntimeError as error:
        print(f"audit: no answer, so nothing is known: {error}", file=sys.stderr)
        return 2
    print(*lines, f"{len(versions)} versions, {len(lines) or 'no'} known vulnerabilities", sep="\n")
    return 1 if lines else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
