"""``python -m fuzz.faults``: runs that are interrupted, killed, out of disk, without a cache, or two at once. Linux.

After each, what opens as a result is whole, nothing hidden is left but by SIGKILL, and the next run works.
"""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

TIMES = 20
SCENARIO = """\
title = "faults"
[beam]
length = "300 mm"
section = { shape = "rectangle", width = "20 mm", thickness = "4 mm" }
material = { density = "2700 kg/m^3", youngs_modulus = "70 GPa" }
damping_ratio = 0.01
[model]
kind = "KIND"
modes = { axial = AXIAL, y = 0, z = 1 }
[motion.flight]
kind = "flight"
acceleration = { z = { profile = "constant", level = "6 g" } }
[response]
duration = "0.5 s"
step = "1 ms"
"""
_UNDO = "import os, signal, sys; signal.signal(signal.SIGINT, signal.SIG_DFL); os.execv(sys.argv[1], sys.argv[1:])"


def main() -> int:
    """Run all, or those named by the arguments, and print what goes wrong; status 1 if anything does."""
    faults = 0
    for check in [each for each in CHECKS if each.__name__ in sys.argv[1:] or not sys.argv[1:]]:
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)
            (folder / "s.toml").write_text(SCENARIO.replace("KIND", "FOAM").replace("AXIAL", "0"))
            start, before = time.monotonic(), faults
            for fault in check(folder):
                print(f"    {fault}", flush=True)
                faults += 1
            print(f"{check.__name__}: {faults - before} faults, {time.monotonic() - start:.0f} s", flush=True)
    return 1 if faults else 0


def started(folder: Path, out: str = "out", **environment: str) -> subprocess.Popen[str]:
    """Start a run, in which signals are not ignored as in a job in the background."""
    command = [sys.executable, "-m", "gbeam", "run", "s.toml", "--out", out]
    return subprocess.Popen(
        [sys.executable, "-c", _UNDO, *command],
        cwd=folder,
        env={**os.environ, **environment},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )


def ended(process: subprocess.Popen[str]) -> tuple[int, str]:
    """Exit status and stderr."""
    _, err = process.communicate(timeout=900)
    return process.returncode, err


def handles_signals(process: int) -> bool:
    """True if a process has come so far as to handle SIGTERM; False also where it has ended."""
    try:
        lines = Path(f"/proc/{process}/status").read_text(encoding="utf-8").splitlines()
    except OSError:
        return False
    caught = next((line for line in lines if line.startswith("SigCgt:")), "SigCgt: 0")
    return bool(int(caught.split()[1], 16) >> (signal.SIGTERM - 1) & 1)


def duration(folder: Path) -> float:
    """Time of a whole run from when it handles signals, s."""
    process = started(folder, "undisturbed")
    while not handles_signals(process.pid):
        time.sleep(0.002)
    start = time.monotonic()
    status, err = ended(process)
    assert status == 0, err
    return time.monotonic() - start


def disturbed(folder: Path, number: int, delay: float) -> tuple[int, str]:
    """Exit status and stderr of a run that gets a signal."""
    process = started(folder)
    while not handles_signals(process.pid):
        time.sleep(0.002)
    time.sleep(delay)
    process.send_signal(number)
    return ended(process)


def unsound(folder: Path, *, hidden: bool = False) -> Iterator[str]:
    """List what is wrong with a folder after a fault."""
    from gbeam.io import read_stored

    out = folder / "out"
    names = {each.name for each in out.iterdir()} if out.exists() else set()
    shown = {name for name in names if not name.startswith(".")}
    expected = {each.name for each in (folder / "undisturbed").iterdir()}
    if shown and shown != expected:
        yield f"files are missing: {sorted(expected - shown)[:3]}, or too many: {sorted(shown - expected)[:3]}"
    if (out / "result.nc").exists() and read_stored(out / "result.nc").attrs[""]["outcome"] != "done":
        yield "the result is not whole"
    left = [each.name for place in (folder, out) if place.exists() for each in place.glob(".*")]
    if left and not hidden:
        yield f"left behind: {left}"


def signals(folder: Path) -> Iterator[str]:
    """SIGINT and SIGTERM at twenty times of a run: 130 and 143, one line."""
    whole = duration(folder)
    for number, line in ((signal.SIGINT, "gbeam: interrupted\n"), (signal.SIGTERM, "gbeam: terminated\n")):
        for i in range(TIMES):
            if i % 2:
                shutil.rmtree(folder / "out", ignore_errors=True)
            delay = whole * i / (TIMES - 1)
            status, err = disturbed(folder, number, delay)
            if (status, err) not in ((128 + number, line), (0, "")):
                yield f"{signal.Signals(number).name} after {delay:.2f} s: status {status}, {err[-200:]!r}"
            yield from unsound(folder)


def killed(folder: Path) -> Iterator[str]:
    """SIGKILL at twenty times of a run; the next run removes what is left."""
    whole = duration(folder)
    for i in range(TIMES):
        disturbed(folder, signal.SIGKILL, whole * (0.5 + i / TIMES / 2))
        # Between two renames a killed run may leave files of two runs, each of them whole.
        yield from unsound(folder, hidden=True)
    status, err = ended(started(folder))
    if status != 0:
        yield f"the next run: status {status}, {err[-200:]!r}"
    yield from unsound(folder)


@contextmanager
def small_disk(place: Path, kilobytes: int) -> Iterator[None]:
    """A disk of a size; needs root."""
    place.mkdir(exist_ok=True)
    subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={kilobytes}k", "tmpfs", place], check=True)
    try:
        yield
    finally:
        subprocess.run(["umount", place], check=True)


def full_disk(folder: Path) -> Iterator[str]:
    """A disk that is full after any number of writes: status 1, and the files are elsewhere."""
    duration(folder)
    size = sum(each.stat().st_size for each in (folder / "undisturbed").iterdir()) // 1000
    for i in range(TIMES):
        (folder / "tmp").mkdir()
        with small_disk(folder / "out", 4 + size * i // (TIMES - 2)):
            status, err = ended(started(folder, "out/below", TMPDIR=str(folder / "tmp")))
            left = list((folder / "out").rglob("*"))
            whole = len(left) > len(list((folder / "undisturbed").iterdir()))
            kept = [each.name for each in (folder / "tmp").glob("gbeam-result-*/result.nc")]
            if not ((status == 0 and whole) or (status == 1 and not left and kept and "No space left" in err)):
                yield f"disk {i} of {TIMES}: status {status}, {len(left)} files left, kept {kept}, {err[-200:]!r}"
        shutil.rmtree(folder / "tmp")


def broken_cache(folder: Path) -> Iterator[str]:
    """A cache of compiled programs that is a file, cannot be made, or holds rubbish: the run does without."""
    (folder / "s.toml").write_text(SCENARIO.replace("KIND", "exact").replace("AXIAL", "1"))
    cache, file = folder / "cache", folder / "file"
    file.write_text("x")
    setups: list[tuple[str, Path, Callable[[], None]]] = [
        ("none yet", cache, lambda: None),
        ("filled", cache, lambda: None),
        ("rubbish", cache, lambda: [each.write_bytes(b"rubbish") for each in cache.iterdir()] and None),
        ("empty files", cache, lambda: [each.write_bytes(b"") for each in cache.iterdir()] and None),
        ("a file", file, lambda: None),
        ("below a file", file / "cache", lambda: None),
        ("a device", Path("/dev/full"), lambda: None),
        ("nowhere", Path("/proc/nowhere"), lambda: None),
    ]
    for words, place, prepare in setups:
        prepare()
        status, err = ended(started(folder, JAX_COMPILATION_CACHE_DIR=str(place)))
        others = [line for line in err.splitlines() if "the cache of compiled programs cannot be used" not in line]
        if status != 0 or others or err.count("\n") > 2:
            yield f"cache {words}: status {status}, {err[-300:]!r}"


def two_at_once(folder: Path) -> Iterator[str]:
    """Two runs at once into one folder, new and existing: the files are whole, and of one run."""
    duration(folder)
    for _ in range(3):
        for status, err in [ended(process) for process in [started(folder), started(folder)]]:
            if status != 0:
                yield f"status {status}, {err[-200:]!r}"
        yield from unsound(folder)


CHECKS: tuple[Callable[[Path], Iterator[str]], ...] = (signals, killed, full_disk, broken_cache, two_at_once)

if __name__ == "__main__":
    sys.exit(main())
