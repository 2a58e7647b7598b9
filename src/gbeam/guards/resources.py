"""Limits of the operating system on this process; nothing heavy is imported here, since they come first."""

from __future__ import annotations

import sys

_END_WITH_PARENT = 1  # PR_SET_PDEATHSIG of prctl(2)


def restrict(memory: int, seconds: int) -> None:
    """Limit this process and what it becomes to an address space, bytes, and a processor time, s.

    Windows has neither limit, and macOS none of memory. A lower limit that was inherited stays.
    """
    if sys.platform == "win32":
        return
    import resource

    wanted = {resource.RLIMIT_CPU: (seconds, seconds + 5), resource.RLIMIT_CORE: (0, 0)}
    if sys.platform != "darwin":
        wanted[resource.RLIMIT_AS] = (memory, memory)
    for kind, ends in wanted.items():
        before = resource.getrlimit(kind)[1]
        soft, hard = (end if before == resource.RLIM_INFINITY else min(end, before) for end in ends)
        resource.setrlimit(kind, (soft, hard))


def end_with_parent() -> None:
    """Let the system kill this process where the one that started it ends first; Linux alone does."""
    if sys.platform == "linux":
        import ctypes
        import signal

        ctypes.CDLL(None).prctl(_END_WITH_PARENT, signal.SIGKILL)
