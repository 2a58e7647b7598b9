"""Parameters of a test that are combined: some combinations show all that there is, the others are thorough."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from itertools import product
from typing import Any

import pytest


def crossed(usual: Callable[..., bool], *values: Iterable[Any]) -> list[Any]:
    """Combine values into the parameters of a test; combinations that are not usual are left to make thorough."""
    return [pytest.param(*each, marks=() if usual(*each) else pytest.mark.thorough) for each in product(*values)]
