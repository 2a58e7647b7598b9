"""What all tests share."""

import gc
from collections.abc import Iterator

import jax
import pytest


@pytest.fixture(autouse=True, scope="module")
def _release_programs() -> Iterator[None]:
    """Let go of compiled programs after each file: each holds memory maps, of which a process may have only so many."""
    yield
    jax.clear_caches()
    gc.collect()
