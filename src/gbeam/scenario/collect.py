"""Build part after part and keep the errors, so that one mistake does not hide the next."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

from gbeam.errors import InputError

T = TypeVar("T")


class Collector:
    """Collects the InputErrors of what it attempts, in `errors`."""

    def __init__(self) -> None:
        self.errors: list[InputError] = []

    def attempt(self, where: str, make: Callable[..., T], *args: Any, **options: Any) -> T | None:
        """Return ``make(*args, **options)``; None, with its error kept as one of `where`, if it refuses."""
        try:
            return make(*args, **options)
        except InputError as error:
            self.errors.append(error.within(where))
            return None
