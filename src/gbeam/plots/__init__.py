"""Figures drawn with Matplotlib, as axes to work on, or as files. `gbeam.figures` describes them; `draw` draws."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
