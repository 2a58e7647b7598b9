"""The command line, called in this process."""

from __future__ import annotations

from ..calling import gbeam, with_figures

__all__ = ["gbeam", "with_figures"]
