"""Results made by hand."""

from ..plots.conftest import study

__all__ = ["study"]
