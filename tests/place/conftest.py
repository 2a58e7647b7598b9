"""The beam and the motions that comparisons have."""

from __future__ import annotations

from ..comparison.conftest import flight, load, settings, spin, structure

__all__ = ["flight", "load", "settings", "spin", "structure"]
