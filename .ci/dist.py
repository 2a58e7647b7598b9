"""Build the sdist and the wheel into dist/, and check what a release must hold: `make dist`.

The wheel is built from the sdist. It has to be, byte by byte, the one that the tree gives, and to hold every file of
the package, the examples that the app offers, and no test, benchmark or other example.
"""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
import tarfile
import tomllib
import zipfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
DIST = ROOT / "dist"
UV = Path(sys.executable).with_name("uv")  # installed beside this Python
NEEDED_TO_BUILD_AND_TEST = (
    "pyproject.toml",
    "README.md",
    "LICENSE",
    "NOTICE",
    "CHANGELOG.md",
    "Makefile",
    "tests/conftest.py",
)


def main() -> int:
    shutil.rmtree(DIST, ignore_errors=True)
    run("build", "--quiet", "--out-dir", DIST, ROOT)
    (DIST / ".gitignore").unlink(missing_ok=True)
    wheel, sdist = only("*.whl"), only("*.tar.gz")
    # Without the extra twine does not render Markdown, and passes everything.
    run("tool", "run", "--quiet", "--with", "readme-renderer[md]", "twine", "check", "--strict", wheel, sdist)
    faults = [*wheel_faults(wheel), *sdist_faults(sdist), *difference_from_tree(wheel)]
    print("\n".join(faults) or f"{wheel.name} and {sdist.name} are complete.")
    return 1 if faults else 0


def wheel_faults(wheel: Path) -> list[str]:
    with zipfile.ZipFile(wheel) as archive:
        held = {re.sub(r"^[^/]*\.dist-info/licenses/", "", name) for name in archive.namelist()}
    held = {name for name in held if ".dist-info/" not in name}
    package, settings = ROOT / "src", tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    expected = {
        path.relative_to(package).as_posix()
        for path in (package / "gbeam").rglob("*")
        if path.is_file() and "__pycache__" not in path.parts
    } | {*settings["tool"]["hatch"]["build"]["targets"]["wheel"]["force-include"].values()}
    expected |= {*settings["project"]["license-files"]}
    return [f"{wheel.name} lacks {name}" for name in sorted(expected - held)] + [
        f"{wheel.name} should not hold {name}" for name in sorted(held - expected)
    ]


def sdist_faults(sdist: Path) -> list[str]:
    with tarfile.open(sdist) as archive:
        held = {name.partition("/")[2] for name in archive.getnames()}
    return [f"{sdist.name} lacks {name}" for name in NEEDED_TO_BUILD_AND_TEST if name not in held]


def difference_from_tree(wheel: Path) -> list[str]:
    direct = DIST / "from-tree"
    run("build", "--quiet", "--wheel", "--out-dir", direct, ROOT)
    same = (direct / wheel.name).read_bytes() == wheel.read_bytes()
    shutil.rmtree(direct)
    return [] if same else [f"{wheel.name}: the sdist and the tree build different wheels"]


def only(pattern: str) -> Path:
    (path,) = DIST.glob(pattern)
    return path


def run(*arguments: object) -> None:
    subprocess.run([str(UV), *map(str, arguments)], check=True)


if __name__ == "__main__":
    sys.exit(main())
