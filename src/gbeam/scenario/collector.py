"""Collection of the errors of a scenario's objects, so that all are told at once."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

from gbeam.errors import InputError

Built = TypeVar("Built")


class Collector:
    """Collects in `errors` the InputErrors of the constructors that it attempts."""

    def __init__(self) -> None:
        self.errors: list[InputError] = []

    def attempt(self, where: str, make: Callable[..., Built], *args: Any, **options: Any) -> Built | None:
        """Return ``make(*args, **options)``, or None if it raises an InputError, which is kept, placed at `where`."""
        try:
            return make(*args, **options)
        except InputError as error:
            self.errors.append(error.within(where))
            return None
