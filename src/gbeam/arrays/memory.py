"""What the C library does with the memory of arrays that are gone."""

from __future__ import annotations

import ctypes
import sys
from functools import cache

_TRIM, _MMAP = -1, -3  # M_TRIM_THRESHOLD and M_MMAP_THRESHOLD of mallopt(3)
_KEPT = 2**27  # bytes that are kept
_LARGEST = 2**25  # bytes of an array that is made from what is kept: the most that glibc takes


@cache
def keep_memory() -> bool:
    """Keep the memory of arrays that are gone for the next, where glibc is the C library; return whether it is kept.

    For a process of gbeam's own. glibc asks the system anew for every large array, and workers under Dask's nanny hand
    back whatever is free beyond 64 KiB: clearing the pages that come in its place takes up to a third of the time there
    and a twentieth to a tenth elsewhere.
    """
    if sys.platform != "linux":
        return False
    try:
        mallopt = ctypes.CDLL(None).mallopt
    except (OSError, AttributeError):  # another C library
        return False
    return bool(mallopt(_MMAP, _LARGEST) and mallopt(_TRIM, _KEPT))
