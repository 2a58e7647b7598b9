"""A Chromium for the browser tests: the one that is there, else a headless one from npm, unpacked into .cache/chromium.

`make test` runs this. The npm package @sparticuz/chromium carries the program itself, compressed by Brotli, which Node
unpacks: nothing comes from elsewhere, and no administrator is needed. Where that is impossible it says why, and the
browser tests are skipped.
"""

from __future__ import annotations

import platform
import shutil
import subprocess
import sys
import tarfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

from tests.browser.chromium import INSTALLED, find  # noqa: E402

PACKAGE = "@sparticuz/chromium@153.0.0"
UNPACK = """
const {brotliDecompressSync} = require("zlib"), {readFileSync, writeFileSync} = require("fs");
const [from, into] = process.argv.slice(1);
for (const [name, file] of [["chromium.br", "chromium"], ["al2023.tar.br", "libraries.tar"],
                            ["swiftshader.tar.br", "graphics.tar"], ["fonts.tar.br", "fonts.tar"]])
  writeFileSync(into + "/" + file, brotliDecompressSync(readFileSync(from + "/" + name)));
"""
FONTS = """<?xml version="1.0"?>
<!DOCTYPE fontconfig SYSTEM "fonts.dtd">
<fontconfig>
  <dir>{folder}/fonts</dir>
  <dir>/usr/share/fonts</dir>
  <cachedir>{folder}/fonts-cache</cachedir>
</fontconfig>
"""


def main() -> int:
    browser = find()
    if browser is not None:
        return 0
    if (platform.system(), platform.machine()) != ("Linux", "x86_64"):
        print("browser tests are skipped: no Chromium is there, and npm has one for Linux on x86-64 only")
        return 0
    if not shutil.which("npm") or not shutil.which("node"):
        print("browser tests are skipped: neither Chromium nor npm, which could install one, is there")
        return 0
    folder = INSTALLED.parent
    folder.mkdir(parents=True, exist_ok=True)
    print(f"no Chromium is there: {PACKAGE} from npm goes into {folder.relative_to(ROOT)}")
    try:
        quiet = ("--no-audit", "--no-fund", "--no-save", "--loglevel=error", "--prefix", str(folder))
        subprocess.run(["npm", "install", *quiet, PACKAGE], check=True, timeout=300)
        packed = folder / "node_modules" / "@sparticuz" / "chromium" / "bin"
        subprocess.run(["node", "-e", UNPACK, str(packed), str(folder)], check=True, timeout=120)
        for archive in ("libraries", "graphics", "fonts"):
            with tarfile.open(folder / f"{archive}.tar") as opened:
                opened.extractall(folder, filter="data")
            (folder / f"{archive}.tar").unlink()
        (folder / "fonts.conf").write_text(FONTS.format(folder=folder), encoding="utf-8")
        INSTALLED.chmod(0o755)
        shutil.rmtree(folder / "node_modules")
    except (OSError, subprocess.SubprocessError, tarfile.TarError) as error:
        INSTALLED.unlink(missing_ok=True)
        print(f"browser tests are skipped: Chromium could not be installed from npm: {error}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
