"""The command line, called in this process."""

from __future__ import annotations

from ..calling import gbeam

__all__ = ["gbeam"]
