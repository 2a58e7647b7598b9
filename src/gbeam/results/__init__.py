"""Frozen records of arrays and words: what every analysis returns. No model, solver or computation inside."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
