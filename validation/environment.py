"""Versions of what ran, and what is missing."""

from __future__ import annotations

import platform
import re
import shutil
import subprocess
from importlib.metadata import PackageNotFoundError, requires, version

import gbeam

# Needs that are programs: the Debian package, the executable, the argument that prints its version.
PROGRAMS = {"calculix-ccx": ("ccx", "-v")}


def need_version(need: str) -> str | None:
    """Version of a package or program that a module needs; None where it is missing."""
    if need in PROGRAMS:
        program, flag = PROGRAMS[need]
        if shutil.which(program) is None:
            return None
        text = subprocess.run([program, flag], capture_output=True, text=True, check=False).stdout
        match = re.search(r"\d+(\.\d+)+", text)
        return match.group() if match else "unknown"
    try:
        return version(need)
    except PackageNotFoundError:
        return None


def environment() -> dict[str, str]:
    """Versions of gbeam, of Python and of every dependency, and the platform."""
    names = sorted({re.split(r"[^\w\-]", line)[0] for line in requires("gbeam") or [] if "extra ==" not in line})
    return {
        "gbeam": gbeam.__version__,
        "Python": platform.python_version(),
        "platform": f"{platform.system()} {platform.machine()}",
        **{name: version(name) for name in names},
    }
