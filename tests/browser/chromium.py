"""The Chromium of the browser tests."""

from __future__ import annotations

import os
import shutil
from pathlib import Path
from typing import Any

# What .ci/browser.py installs where there is none.
INSTALLED = Path(__file__).parents[2] / ".cache" / "chromium" / "chromium"
NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "chrome")
PLACES = ("/usr/bin/chromium", "/Applications/Google Chrome.app/Contents/MacOS/Google Chrome")
QUIET = (
    "--no-sandbox",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--disable-quic",
    "--disable-dev-shm-usage",
    # WebGL without a graphics card.
    "--use-gl=angle",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--ignore-gpu-blocklist",
    "--disable-gpu-compositing",  # what is not WebGL by plain software, which takes half the time of SwiftShader
)


def find() -> Path | None:
    """The program of GBEAM_CHROMIUM, of the system, or installed from npm; None where there is none."""
    named = os.environ.get("GBEAM_CHROMIUM")
    if named:
        return Path(named)
    on_path = (shutil.which(name) for name in NAMES)
    every = [Path(each) for each in (*on_path, *PLACES) if each]
    return next((each for each in (*every, INSTALLED) if each.is_file()), None)


def arguments(program: Path) -> list[str]:
    """Arguments of the command line; the one from npm starts its processes without a zygote."""
    return [*QUIET, "--no-zygote"] if program == INSTALLED else [*QUIET]


def environment(program: Path) -> dict[str, str]:
    """With the libraries and fonts that come with the one from npm."""
    folder = program.parent
    variables = {"LD_LIBRARY_PATH": str(folder / "lib"), "FONTCONFIG_PATH": str(folder)} if program == INSTALLED else {}
    return {**os.environ, **variables}


def watch(page: Any) -> list[str]:
    """Start a list of what a page complains of, or requests from elsewhere."""
    faults: list[str] = []
    # Reading pixels from software's WebGL is slow, and Chromium says so.
    page.on("console", lambda said: faults.append(said.text) if "GPU stall" not in said.text else None)
    page.on("pageerror", lambda error: faults.append(str(error)))
    page.on("request", lambda asked: faults.append(asked.url) if not asked.url.startswith(("file:", "data:")) else None)
    return faults
