"""Memory that is kept is faster, and nothing else: where glibc is the C library, it says so."""

import platform

from gbeam.arrays.memory import keep_memory


def test_memory_is_kept_where_glibc_is() -> None:
    assert keep_memory() is (platform.libc_ver()[0] == "glibc")
