"""Install the wheel of dist/ into empty environments and use it there: `make wheels`.

On every supported Python that uv finds, once with the lowest allowed version of every direct dependency and once with
the newest: the first minutes of a user, then the tests of what each dependency is there for. Nothing of the tree is
importable, neither gbeam nor what is installed beside it.

    python .ci/wheels.py [--python 3.11 ...] [--resolution lowest-direct ...] [--keep]
"""

from __future__ import annotations

import argparse
import os
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
UV = shutil.which("uv", path=os.pathsep.join([str(Path(sys.executable).parent), os.environ.get("PATH", "")])) or "uv"
PYTHONS = ("3.11", "3.12", "3.13", "3.14")
RESOLUTIONS = ("lowest-direct", "highest")
EXAMPLE = ROOT / "examples" / "f16_8g_turn.toml"
# Files by h5py, h5netcdf and zarr; JAX; pyuff; rainflow; pint; tree-sitter. The demo needs the others.
TESTS = (
    "tests/io",
    "tests/integrate/test_driver.py",
    "tests/analysis/test_gradients.py",
    "tests/motion/test_record_files.py",
    "tests/comparison/test_fatigue.py",
    "tests/scenario/test_units.py",
    "tests/studies/test_sweep.py::test_files_and_words",
    "tests/scenario/test_locate.py",
)


def main() -> int:
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--python", nargs="+", default=PYTHONS, help="versions, or paths of interpreters")
    parser.add_argument("--resolution", nargs="+", default=RESOLUTIONS, choices=RESOLUTIONS)
    parser.add_argument("--tests", nargs="*", default=TESTS, help="what pytest runs in each environment")
    parser.add_argument("--keep", action="store_true", help="keep the environments in .cache/wheels")
    options = parser.parse_args()
    wheels = sorted((ROOT / "dist").glob("*.whl"))
    if len(wheels) != 1:
        print("dist/ has no wheel, or several: run `make dist` first")
        return 2
    worst = 0
    for python in options.python:
        if subprocess.run([UV, "python", "find", "--quiet", python], capture_output=True).returncode:
            print(f"Python {python}: not installed on this machine, not tried")
            continue
        for resolution in options.resolution:
            start = time.perf_counter()
            fault = attempt(wheels[0], python, resolution, options.tests, keep=options.keep)
            worst = max(worst, int(fault is not None))
            print(
                f"Python {python}, {resolution}: {fault or 'passed'} ({time.perf_counter() - start:.0f} s)", flush=True
            )
    return worst


def attempt(wheel: Path, python: str, resolution: str, tests: Sequence[str], *, keep: bool) -> str | None:
    """Install and use the wheel; what failed, if anything did."""
    folder = ROOT / ".cache" / "wheels" / f"{Path(python).name}-{resolution}"
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    interpreter = folder / "venv" / ("Scripts" if os.name == "nt" else "bin") / "python"
    try:
        run(UV, "venv", "--quiet", "--python", python, folder / "venv")
        into = ("--quiet", "--python", interpreter)
        # Releases without a wheel for this Python and platform are passed over: nothing is compiled here.
        binary = ("--only-binary", ":all:")
        # "Direct" are the requirements of the project, not the wheel, which alone would be lowest.
        run(UV, "pip", "install", *into, "--resolution", resolution, *binary, "-r", ROOT / "pyproject.toml", wheel)
        run(UV, "pip", "check", *into)
        (folder / "versions.txt").write_text(run(UV, "pip", "freeze", *into), encoding="utf-8")
        use(interpreter, folder)
        run(UV, "pip", "install", *into, *binary, "pytest>=8", "hypothesis>=6")
        run(interpreter, "-m", "pytest", "-q", "-x", "-p", "no:cacheprovider", *tests, cwd=ROOT)
    except subprocess.CalledProcessError as error:
        return f"FAILED: {' '.join(map(str, error.cmd))}\n{error.stdout[-1500:]}{error.stderr[-3000:]}"
    finally:
        if not keep:
            shutil.rmtree(folder / "venv", ignore_errors=True)
    return None


def use(interpreter: Path, folder: Path) -> None:
    """Do as a user does first: version, a new scenario, the demo, in a folder from which no tree is importable."""
    gbeam = (interpreter, "-m", "gbeam")
    with tempfile.TemporaryDirectory() as elsewhere:
        run(*gbeam, "--version", cwd=elsewhere)
        run(*gbeam, "new", "new.toml", cwd=elsewhere)
        run(*gbeam, "check", "new.toml", cwd=elsewhere)
        run(*gbeam, "run", EXAMPLE, "--out", folder / "demo", cwd=elsewhere)  # 1 if its own criteria are not met


def run(*command: object, cwd: Path | str | None = None) -> str:
    environment = {name: value for name, value in os.environ.items() if name not in ("PYTHONPATH", "VIRTUAL_ENV")}
    words = [str(word) for word in command]
    return subprocess.run(words, check=True, capture_output=True, text=True, cwd=cwd, env=environment).stdout


if __name__ == "__main__":
    sys.exit(main())
