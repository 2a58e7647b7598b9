"""What all tests share."""

import gc
import os
import sys
from collections.abc import Iterator
from importlib.metadata import version
from pathlib import Path

import pytest

# As the command line does: a beam's matrices are small, and the threads of two processes would wait for one another.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
# Compiled programs are kept from run to run, in the project's own ignored folder.
os.environ.setdefault("JAX_COMPILATION_CACHE_DIR", str(Path(__file__).parents[1] / ".cache" / "jax"))
# The way in which these versions fuse loops costs a quarter of the suite's processor time; to later ones, which do
# not know the flag, it is fatal.
if version("jaxlib").startswith(("0.8.", "0.9.", "0.10.")):
    os.environ.setdefault("XLA_FLAGS", "--xla_cpu_use_fusion_emitters=false")

MAPS = Path("/proc/self/maps")
MOST_MAPS = 30_000  # of the 65,530 memory maps that a process may have by default


@pytest.fixture(autouse=True, scope="module")
def _release_programs() -> Iterator[None]:
    """Let go of compiled programs, each of which holds memory maps, where these run out."""
    yield
    if "jax" in sys.modules and MAPS.exists() and len(MAPS.read_bytes().splitlines()) > MOST_MAPS:
        import jax

        jax.clear_caches()
        gc.collect()
