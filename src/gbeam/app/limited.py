"""Start gbeam with limits of memory and processor time: ``python -m gbeam.app.limited BYTES SECONDS ARGUMENTS``."""

from __future__ import annotations

import os
import sys

from gbeam.guards.limits import restrict


def main() -> None:
    """Set the limits, which stay, and become `python -m gbeam ARGUMENTS`."""
    memory, seconds, *arguments = sys.argv[1:]
    command = [sys.executable, "-m", "gbeam", *arguments]
    if sys.platform == "win32":  # has no such limits, and starts another process where others become one
        import subprocess

        sys.exit(subprocess.call(command))
    restrict(int(memory), int(seconds))
    os.execv(sys.executable, command)


if __name__ == "__main__":
    main()
